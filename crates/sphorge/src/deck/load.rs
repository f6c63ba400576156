//! The way from a text to a setup.

use super::interpret::{self, interpret};
use super::placement;
use super::raw::{RawDeck, RawMaterial};
use super::report::{DeckReport, Fault, Problems};
use crate::material::Constants;
use crate::{Particles, geometry, model::Model};
use serde::de::DeserializeOwned;
use std::{collections::BTreeMap, path::Path};
use toml::Spanned;

/// A problem ready to be run.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The validated model.
    pub model: Model,
    /// Its particles, body by body.
    pub particles: Particles,
    /// The deck as run, overrides worked in.
    pub deck_text: String,
}

/// Reads a deck file; the file stem names the model.
///
/// # Errors
/// Everything that is wrong with the file, the overrides or the deck.
pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Setup, DeckReport> {
    let shown = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| {
        let help =
            if path.is_dir() { "this is a folder; name a deck, a .toml file" } else { "check the path of the deck" };
        DeckReport::placeless(&shown, "unreadable", format!("cannot read `{shown}`: {error}"), Some(help.to_owned()))
    })?;
    let name = path.file_stem().map_or_else(|| "deck".to_owned(), |stem| stem.to_string_lossy().into_owned());
    read(&shown, &name, &text, overrides)
}

/// Reads a deck from memory; `name` names the model and stands in diagnostics.
///
/// # Errors
/// Everything that is wrong with the overrides or the deck.
pub fn load_text(name: &str, text: &str, overrides: &[(String, String)]) -> Result<Setup, DeckReport> {
    read(name, name, text, overrides)
}

fn read(shown: &str, name: &str, text: &str, overrides: &[(String, String)]) -> Result<Setup, DeckReport> {
    if let Some((path, _)) = overrides.first() {
        return Err(DeckReport::placeless(shown, "override", format!("`{path}` cannot be set from outside yet"), None));
    }
    let deck_text = text.to_owned();
    let mut problems = Problems::new(shown, &deck_text);
    let raw: RawDeck = parse(&mut problems)?;
    let interpreted = interpret(&raw, name, &mut problems);
    problems.check()?;
    let Some((model, places)) = interpreted else {
        let message = "the deck could not be interpreted, and no fault was found in it".to_owned();
        return Err(DeckReport::placeless(shown, "internal", message, None));
    };
    match geometry::fill(&model) {
        Ok(particles) => Ok(Setup { model, particles, deck_text }),
        Err(errors) => {
            for error in errors {
                problems.push(placement::fault(error, &model, &places));
            }
            problems.check()?;
            Err(DeckReport::placeless(shown, "internal", "the bodies could not be filled".to_owned(), None))
        }
    }
}

/// Reads the text of `problems` into raw structs.
fn parse<T: DeserializeOwned>(problems: &mut Problems) -> Result<T, DeckReport> {
    match toml::from_str(problems.text()) {
        Ok(raw) => Ok(raw),
        Err(error) => {
            let at = error.span().unwrap_or(0..0);
            problems.push(Fault::new("toml", error.message().to_owned(), at, "here"));
            problems.check()?;
            Err(DeckReport::placeless("deck", "internal", error.to_string(), None))
        }
    }
}

/// Reads a text of `[NAME]` tables of materials, as in a deck below `material`.
pub(crate) fn read_materials(shown: &str, text: &str) -> Result<Vec<(String, Constants)>, DeckReport> {
    let mut problems = Problems::new(shown, text);
    let raw: BTreeMap<Spanned<String>, RawMaterial> = parse(&mut problems)?;
    let entries = raw
        .iter()
        .map(|(name, material)| (name.get_ref().clone(), interpret::material::constants(material, &mut problems)))
        .collect();
    problems.check()?;
    Ok(entries)
}
