//! The title of a run in a picture.

use crate::{
    deck::load_model,
    model::Model,
    output::{RunDirectory, Summary},
};

/// Title of a run, with the names of what its checks found broken once it has ended; that of its deck before, or the name of its folder.
pub(crate) fn run_title(run: &RunDirectory) -> String {
    title_with(run, load_model(&run.deck()).ok().as_ref())
}

/// The same of a run whose deck is known.
pub(crate) fn title_with(run: &RunDirectory, model: Option<&Model>) -> String {
    let folder = || run.path().file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let of_deck = || model.map(|model| model.title.clone()).filter(|title| !title.is_empty());
    Summary::read(run).map_or_else(|_| of_deck().unwrap_or_else(folder), |summary| titled(&summary))
}

/// Titles of runs, each once; of many that differ, that of the first and how many there are.
pub(super) fn title_of(runs: &[(&str, &RunDirectory)]) -> String {
    const MOST: usize = 3;
    let mut titles: Vec<String> = Vec::new();
    for title in runs.iter().map(|(_, run)| run_title(run)) {
        if !titles.contains(&title) {
            titles.push(title);
        }
    }
    match &titles[..] {
        [first, others @ ..] if others.len() >= MOST => format!("{first} and {} others", others.len()),
        several => several.join("; "),
    }
}

fn titled(summary: &Summary) -> String {
    let names: Vec<&str> = summary.warnings.iter().map(|warning| warning.name.as_str()).collect();
    if names.is_empty() { summary.title.clone() } else { format!("{} [warnings: {}]", summary.title, names.join(", ")) }
}
