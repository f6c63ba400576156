//! Pictures of a run: particles coloured by a field, and curves of the history.
//!
//! Everything is read back from the files of the run, so that a run can be pictured while it goes on, and later.

mod canvas;
mod chart;
mod color;
mod error;
mod field;
mod field_picture;
mod frame_choice;
mod history;
mod light;
mod mark;
mod scene;
mod spans;
mod splat;
mod standard;
mod title;
mod view;

pub use color::ColorMap;
pub use error::PlotError;
pub use field::{plot_field, plot_field_of_runs};
pub use field_picture::FieldPicture;
pub use frame_choice::FrameChoice;
pub use history::{HistoryPicture, plot_columns, plot_history, plot_overlay};
pub use standard::plot_run;
pub use view::View;

#[cfg(test)]
mod tests;
