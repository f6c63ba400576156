//! Pictures of a run: particles coloured by a field, and curves of the history.
//!
//! Everything is read back from the files of the run, so that a run can be pictured while it goes on, and later.

mod axis;
mod cell;
mod chart;
mod clip;
mod color;
mod color_bar;
mod columns;
mod curves;
mod derived;
mod error;
mod field;
mod field_page;
mod field_picture;
mod filter;
mod font;
mod frame_choice;
mod history;
mod legend;
mod light;
mod mark;
mod mirror;
mod page;
mod paper;
mod pixels;
mod save;
mod scene;
mod section;
mod solid;
mod spans;
mod splat;
mod standard;
mod svg;
mod title;
mod view;
mod walls;

pub use color::ColorMap;
pub use columns::ColumnsPicture;
pub use curves::CurvesPicture;
pub use error::PlotError;
pub use field::{animate_field, plot_each_frame, plot_field, plot_field_of_runs};
pub use field_picture::FieldPicture;
pub use filter::Condition;
pub use frame_choice::FrameChoice;
pub use history::{HistoryPicture, common_measures, plot_columns, plot_columns_of_runs, plot_history, plot_overlay};
pub use mirror::Mirror;
pub use paper::{Paper, PictureFormat};
pub use section::Section;
pub use standard::plot_run;
pub use view::View;

pub(crate) use color::LINES;
pub(crate) use color_bar::{FLAG_COLORS, NO_VALUE, SINGLE_COLOR, body_color};
pub(crate) use derived::Derived;
pub(crate) use filter::body_number;
pub(crate) use frame_choice::no_frame;
pub(crate) use history::unknown_column;
pub(crate) use light::{DARKEST, LIGHT};
pub(crate) use mirror::mirrored;
pub(crate) use scene::{FLAGS, Missed, cuts_something, field_label, joined_cells, missed, ranges, split, values};
pub(crate) use standard::default_fields;
pub(crate) use title::title_with;
pub(crate) use view::upright;

#[cfg(test)]
mod tests;
