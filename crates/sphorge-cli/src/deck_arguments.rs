//! Arguments that name a deck and change it, shared by the commands that read decks.

use crate::{failure::Failure, memory};
use clap::{Args, ValueEnum};
use sphorge::deck::{self, DeckReport, Setup};
use sphorge::decks::{self, ShippedDeck};
use sphorge::output::RunDirectory;
use std::{
    ffi::{OsStr, OsString},
    path::{Path, PathBuf},
};

/// A deck with changes.
#[derive(Debug, Args)]
pub(crate) struct DeckArguments {
    /// A deck file, or the name of a shipped deck (`sphorge decks` lists them)
    #[arg(value_name = "DECK")]
    deck: PathBuf,
    /// Set a key of the deck, such as `particles.spacing="0.2 mm"` or `body.bar.velocity=["0 m/s","-150 m/s"]`; can be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<(String, String)>,
    /// Precision of the pair sums; overrides `numerics.precision` of the deck
    #[arg(long, value_name = "PRECISION")]
    precision: Option<PrecisionArgument>,
}

/// Arithmetic of the pair sums.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum PrecisionArgument {
    /// Pair sums in single precision, accumulated in double precision
    Mixed,
    /// Everything in double precision
    Double,
}

/// Splits at the first `=`: values may hold more of them.
pub(crate) fn parse_override(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((path, value)) if value.trim_start().starts_with(is_typographic_quote) => {
            let plain = value.replace(is_typographic_quote, "");
            Err(format!("the quotes around the value are typographic ones: write '{}={}'", path.trim(), plain.trim()))
        }
        Some((path, value)) if !path.trim().is_empty() => Ok((path.trim().to_owned(), value.trim().to_owned())),
        _ => Err("write the key, `=` and the value: `time.end=\"30 us\"`".to_owned()),
    }
}

/// Whether a character is a quote that word processors and web pages put in the place of plain ones.
pub(crate) fn is_typographic_quote(c: char) -> bool {
    matches!(c, '\u{2018}'..='\u{201f}' | '\u{ab}' | '\u{bb}')
}

/// A deck that is there, with changes.
pub(crate) struct FoundDeck {
    source: Source,
    overrides: Vec<(String, String)>,
    name: String,
}

enum Source {
    Shipped(&'static ShippedDeck),
    File(PathBuf),
}

impl DeckArguments {
    /// Finds the deck: a file if there is one, otherwise a shipped deck of that bare name.
    ///
    /// # Errors
    /// There is neither.
    pub(crate) fn find(self) -> Result<FoundDeck, Failure> {
        let named =
            run_of(&self.deck).unwrap_or_else(|| self.deck.file_stem().unwrap_or(self.deck.as_os_str()).to_owned());
        let name = named.to_string_lossy().into_owned();
        let bare = self.deck.components().count() == 1;
        let source = match decks::find(&name).filter(|_| bare) {
            _ if self.deck.is_dir() => return Err(is_a_folder(&self.deck)),
            _ if self.deck.exists() => Source::File(self.deck),
            Some(shipped) => Source::Shipped(shipped),
            None => return Err(missing(&self.deck, &name)),
        };
        let mut overrides = self.overrides;
        if let Some(precision) = self.precision {
            let word = match precision {
                PrecisionArgument::Mixed => "mixed",
                PrecisionArgument::Double => "double",
            };
            overrides.push(("numerics.precision".to_owned(), format!("\"{word}\"")));
        }
        Ok(FoundDeck { source, overrides, name })
    }
}

impl FoundDeck {
    /// Name of the deck without folder and extension: names the output folder.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Reads the deck and fills its bodies.
    ///
    /// # Errors
    /// Something is wrong with it.
    pub(crate) fn load(&self) -> Result<Setup, Failure> {
        self.load_with(&[]).map_err(|report| Failure::BadInput(report.into()))
    }

    /// The same with more changes.
    ///
    /// # Errors
    /// Something is wrong with it.
    pub(crate) fn load_with(&self, more: &[(String, String)]) -> Result<Setup, DeckReport> {
        let overrides = [&self.overrides[..], more].concat();
        let limit = memory::particle_limit();
        match &self.source {
            Source::Shipped(shipped) => deck::load_text_within(shipped.name, shipped.text, &overrides, limit),
            Source::File(path) => deck::load(path, &overrides, limit),
        }
    }

    /// A key that is set already and would be undone by setting this one.
    pub(crate) fn sets(&self, key: &str) -> Option<&str> {
        let text = match &self.source {
            Source::Shipped(shipped) => shipped.text.to_owned(),
            // What cannot be read is told when the deck is.
            Source::File(path) => deck::read_deck(path).unwrap_or_default(),
        };
        deck::undone_by(&text, &self.overrides, key)
    }

    /// Refuses keys that are set and varied.
    pub(crate) fn refuse_set_keys<'a>(&self, mut varied: impl Iterator<Item = &'a str>) -> Result<(), Failure> {
        let Some((varied, set)) = varied.find_map(|key| self.sets(key).map(|set| (key, set))) else { return Ok(()) };
        let what = if set == varied {
            format!("`{set}` is set and varied")
        } else {
            format!("`{set}` is set, and `{varied}`, which is varied, sets the same")
        };
        Err(Failure::bad_input(what, "leave out its `--set`, or `--precision`"))
    }
}

/// Name of the run that a deck was stored by: the deck itself is always called `deck.toml`.
fn run_of(deck: &Path) -> Option<OsString> {
    let folder = deck.parent().filter(|_| deck.file_name().is_some_and(|name| name == "deck.toml"))?;
    let folder = std::path::absolute(folder).ok()?;
    RunDirectory::is_run(&folder).then(|| folder.file_name().map(OsStr::to_owned)).flatten()
}

/// Says what a folder holds that was given in place of a deck.
fn is_a_folder(path: &Path) -> Failure {
    if let Ok(run) = RunDirectory::open(path) {
        let (run, deck) = (run.path().display(), path.join("deck.toml"));
        return Failure::bad_input(
            format!("{run} is the folder of a run, not a deck"),
            format!(
                "`sphorge resume {run}` continues the run; `sphorge run {} -o DIR` runs its deck again",
                deck.display()
            ),
        );
    }
    let decks = decks_in(path);
    let few: Vec<String> = decks.iter().take(MOST_LISTED).map(|deck| format!("`{}`", deck.display())).collect();
    let help = match decks.len().saturating_sub(MOST_LISTED) {
        _ if decks.is_empty() => {
            "give the path of a deck file, or the name of a shipped deck: `sphorge decks` lists them".to_owned()
        }
        0 => format!("give the path of a deck file: in this folder are {}", few.join(", ")),
        more => format!("give the path of a deck file: in this folder are {} and {more} more", few.join(", ")),
    };
    Failure::bad_input(format!("{} is a folder, not a deck", path.display()), help)
}

/// The files in a folder that may be decks, in order.
fn decks_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_deck = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml") && path.is_file();
    let mut decks: Vec<PathBuf> = entries.filter(is_deck).collect();
    decks.sort();
    decks
}

/// Most decks that are listed.
const MOST_LISTED: usize = 8;

/// Decks in the folder of a path whose names are like its own.
fn decks_beside(path: &Path, name: &str) -> Vec<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let decks: Vec<(String, String)> = decks_in(folder)
        .iter()
        .filter_map(|deck| {
            let file = deck.file_name()?;
            Some((deck.file_stem()?.to_str()?.to_owned(), path.with_file_name(file).to_str()?.to_owned()))
        })
        .collect();
    let like = deck::names_like(name, decks.iter().map(|(stem, _)| stem.as_str()));
    decks.iter().filter(|(stem, _)| like.contains(&stem.as_str())).map(|(_, path)| path.clone()).collect()
}

fn missing(path: &Path, name: &str) -> Failure {
    let near = decks::like(name);
    let beside = decks_beside(path, name);
    let help = if !beside.is_empty() {
        deck::did_you_mean(beside.iter().map(String::as_str)) + "`sphorge decks` lists the shipped decks"
    } else if near.is_empty() {
        "give the path of a deck file, or the name of a shipped deck: `sphorge decks` lists them".to_owned()
    } else {
        deck::did_you_mean(near) + "`sphorge decks` lists all shipped decks"
    };
    Failure::bad_input(format!("there is no deck `{}`", path.display()), help)
}
