//! Runs in a browser: a page that a small server on this machine gives data to, or one file that has all it shows.
//!
//! Both show the same page, the files of `page/`. It draws by WebGL: particles as their deformed cells, the fields of pictures
//! ([`crate::plot`]) in their colours, and the history under them. A finished run and one that goes on are read in the same way, and nothing in
//! their folders is written.

mod array;
mod description;
mod error;
mod history;
mod http;
mod nodes;
mod packed;
mod parts;
mod request;
mod run;
mod serve;
mod settings;
mod single;
mod text;

pub use error::ViewError;
pub use serve::{Viewer, first_field};
pub use settings::ViewSettings;
pub use single::{SinglePage, save_single_page};

#[cfg(test)]
mod tests;
