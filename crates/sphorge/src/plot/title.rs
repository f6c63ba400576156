//! The title of a run in a picture.

use crate::output::{RunDirectory, Summary};

/// Title of a run, or the name of its folder while there is no summary.
pub(super) fn run_title(run: &RunDirectory) -> String {
    let folder = || run.path().file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    Summary::read(run).map_or_else(|_| folder(), |summary| summary.title)
}
