//! Arguments that name a deck and change it, shared by the commands that read decks.

use crate::{failure::Failure, memory};
use clap::{Args, ValueEnum};
use sphorge::deck::{self, DeckReport, Setup};
use sphorge::decks::{self, ShippedDeck};
use sphorge::output::RunDirectory;
use std::path::{Path, PathBuf};

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
        Some((path, value)) if !path.trim().is_empty() => Ok((path.trim().to_owned(), value.trim().to_owned())),
        _ => Err("write the key, `=` and the value: `time.end=\"30 us\"`".to_owned()),
    }
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
        let name = self.deck.file_stem().unwrap_or(self.deck.as_os_str()).to_string_lossy().into_owned();
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
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut decks: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    decks.sort();
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

/// Most decks that are listed.
const MOST_LISTED: usize = 8;

fn missing(path: &Path, name: &str) -> Failure {
    let near = decks::like(name);
    let help = if near.is_empty() {
        "give the path of a deck file, or the name of a shipped deck: `sphorge decks` lists them".to_owned()
    } else {
        deck::did_you_mean(near) + "`sphorge decks` lists all shipped decks"
    };
    Failure::bad_input(format!("there is no deck `{}`", path.display()), help)
}
