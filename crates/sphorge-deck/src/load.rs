//! The way from a text to a setup.

use super::fault::Problems;
use super::interpret::{Interpreted, interpret};
use super::raw::RawDeck;
use super::report::DeckReport;
use super::slips::{slips, slips_unless_driven};
use super::{advice, closeness, driven, heat, keys, linear_law, overrides, placement, quarters};
use sphorge_engine::{
    Particles,
    geometry::{self, FilledMass},
    model::{Model, Solid},
};
use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Read},
    path::Path,
};

/// A problem ready to be run.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The validated model.
    pub model: Model,
    /// Its particles, body by body.
    /// The rest of their columns comes with [`Particles::complete`], which a simulation that starts with them calls.
    pub particles: Particles,
    /// What the particles of each body weigh, beside its shape.
    pub masses: Vec<FilledMass>,
    /// The deck as run, overrides worked in.
    pub deck_text: String,
    /// What the user should know before the run, such as keys that the chosen form does without, a material that is
    /// probably not meant, or a spacing that does not fit a body.
    pub notes: Vec<String>,
    /// What is only true where no program gives loads or velocities: that nothing moves, or meets nothing.
    pub notes_unless_driven: Vec<String>,
    /// What is doubtful of materials of the catalogue that the deck uses as they are published: no choice of the deck, so that `run` does
    /// not say it of every run, `check` and `sphorge materials NAME` do.
    pub catalogue_notes: Vec<String>,
}

impl Setup {
    /// Both kinds of notes of a run that no program drives.
    pub fn all_notes(&self) -> Vec<String> {
        self.notes_unless_driven.iter().chain(&self.notes).cloned().collect()
    }
}

/// Longest deck, bytes: read in seconds. Numbers by the thousand belong into a file of their own.
const LONGEST: u64 = 8 << 20;

/// The text of a deck, which may come through a pipe, but not without end.
fn read_text(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    let length = File::open(path)?.take(LONGEST + 1).read_to_end(&mut bytes)? as u64;
    if length > LONGEST {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, "it is longer than 8 MB, the limit for decks"));
    }
    String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, not_utf8(error.as_bytes())))
}

/// Where a text is not UTF-8, in words.
fn not_utf8(bytes: &[u8]) -> String {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return "line 1: it is UTF-16, not UTF-8".to_owned();
    }
    let valid = std::str::from_utf8(bytes).map_or_else(|error| error.valid_up_to(), str::len);
    let read = String::from_utf8_lossy(&bytes[..valid]);
    let (line, column) = (read.matches('\n').count() + 1, read.lines().last().unwrap_or_default().chars().count() + 1);
    let column = if read.ends_with('\n') { 1 } else { column };
    let byte = bytes.get(valid).copied().unwrap_or_default();
    format!("line {line}, column {column}: byte {byte:#04x} is not UTF-8")
}

/// Reads a deck file and fills its bodies with no more than `most_particles`; the file stem names the model.
///
/// # Errors
/// Everything that is wrong with the file, the overrides or the deck.
pub fn load(path: &Path, overrides: &[(String, String)], most_particles: f64) -> Result<Setup, DeckReport> {
    load_text_of(path, &read_deck(path)?, overrides, most_particles)
}

/// The same of a file whose text has been read before.
///
/// # Errors
/// Everything that is wrong with the overrides or the deck.
pub fn load_text_of(
    path: &Path,
    text: &str,
    overrides: &[(String, String)],
    most_particles: f64,
) -> Result<Setup, DeckReport> {
    let shown = path.display().to_string();
    let name = path.file_stem().map_or_else(|| "deck".to_owned(), |stem| stem.to_string_lossy().into_owned());
    read(&shown, &name, text, path.parent(), overrides, most_particles)
}

/// The text of a deck file.
///
/// # Errors
/// It cannot be read, is no text or too long.
pub fn read_deck(path: &Path) -> Result<String, DeckReport> {
    let shown = path.display().to_string();
    read_text(path).map_err(|error| {
        let help = match error.kind() {
            _ if path.is_dir() => "this is a folder; name a deck, a .toml file",
            io::ErrorKind::InvalidData => "a deck is UTF-8 text: save it as UTF-8",
            io::ErrorKind::FileTooLarge => "put thousands of particles into a CSV file: `shape = { table = ... }`",
            _ => "check the path of the deck",
        };
        DeckReport::placeless(&shown, "unreadable", format!("cannot read `{shown}`: {error}"), Some(help.to_owned()))
    })
}

/// The text of a deck with overrides worked in, whatever else may be wrong with it.
///
/// # Errors
/// What is wrong with the overrides: an unknown key, an entry that the deck does not have.
pub fn with_overrides(text: &str, overrides: &[(String, String)]) -> Result<String, DeckReport> {
    match overrides::apply(text, overrides) {
        // Reading it will tell.
        None => Ok(text.to_owned()),
        Some((changed, refused)) if refused.is_empty() => Ok(changed),
        Some((_, refused)) => Err(DeckReport::joined("--set", refused)),
    }
}

/// The numbers of the first two keys that set the same place of a deck, or one a part of what the other sets, however they are written:
/// `body.0.velocity` and `body.bar.velocity.1`. Keys that lead nowhere are none of them.
pub fn overlapping_keys(text: &str, keys: &[&str]) -> Option<(usize, usize)> {
    overrides::overlapping(text, keys)
}

/// The first of some keys that were set whose value is undone by setting another one: the same, however it is written, or what it is a part of.
pub fn undone_by<'a>(text: &str, set: &'a [(String, String)], key: &str) -> Option<&'a str> {
    let whole = with_overrides(text, set);
    let text = whole.as_deref().unwrap_or(text);
    set.iter().map(|(known, _)| known.as_str()).find(|known| *known == key || overrides::is_within(text, known, key))
}

/// The model of a deck file, without particles.
///
/// # Errors
/// Everything that is wrong with the file or the deck.
pub fn load_model(path: &Path) -> Result<Model, DeckReport> {
    let shown = path.display().to_string();
    let text = read_text(path).map_err(|error| {
        DeckReport::placeless(&shown, "unreadable", format!("cannot read `{shown}`: {error}"), None)
    })?;
    let mut problems = Problems::new(&shown, &text).with_folder(path.parent().unwrap_or(Path::new("")));
    Ok(read_model("deck", &mut problems)?.model)
}

/// The model of a deck in memory, without particles.
///
/// # Errors
/// What is wrong with the overrides or the deck, apart from the placement of bodies.
pub fn load_text_model(name: &str, text: &str, overrides: &[(String, String)]) -> Result<Model, DeckReport> {
    let text = with_overrides(text, overrides)?;
    let mut problems = Problems::new(name, &text);
    Ok(read_model(name, &mut problems)?.model)
}

/// Reads a deck from memory, of any number of particles a run can have; `name` names the model and stands in diagnostics.
///
/// # Errors
/// Everything that is wrong with the overrides or the deck.
pub fn load_text(name: &str, text: &str, overrides: &[(String, String)]) -> Result<Setup, DeckReport> {
    load_text_within(name, text, overrides, geometry::MAX_PARTICLES)
}

/// The same, with no more than `most_particles`.
///
/// # Errors
/// Everything that is wrong with the overrides or the deck.
pub fn load_text_within(
    name: &str,
    text: &str,
    overrides: &[(String, String)],
    most_particles: f64,
) -> Result<Setup, DeckReport> {
    read(name, name, text, None, overrides, most_particles)
}

pub(super) fn read(
    shown: &str,
    name: &str,
    text: &str,
    folder: Option<&Path>,
    overrides: &[(String, String)],
    most_particles: f64,
) -> Result<Setup, DeckReport> {
    let mut deck_text = text.to_owned();
    let mut shown = shown.to_owned();
    let mut has_other_lines = false;
    if !overrides.is_empty()
        && let Some((changed, refused)) = overrides::apply(text, overrides)
    {
        shown.push_str(", with --set");
        if !refused.is_empty() {
            return Err(with_faults_of_the_rest(refused, &shown, name, &changed, folder));
        }
        let lines = |text: &str| text.matches('\n').count();
        has_other_lines = lines(text) != lines(&changed);
        deck_text = changed;
    }
    let mut problems = Problems::new(&shown, &deck_text).with_folder(folder.unwrap_or(Path::new("")));
    if has_other_lines {
        problems.hide_lines();
    }
    let Interpreted { model, places, mut notes, catalogue_notes, without_conductivity, with_odd_moduli, asks_for_heat } =
        read_model(name, &mut problems)?;
    match geometry::fill(&model, most_particles) {
        Ok(particles) => {
            placement::check_tracers(&model, &particles, &places, &mut problems);
            heat::check_faces(&model, &particles, &places, &mut problems);
            notes.extend(placement::check_pressed(&model, &particles, &places, &mut problems));
            problems.check()?;
            let masses = geometry::filled_masses(&model, &particles);
            notes.extend(placement::notes(&model, &particles, &masses));
            notes.extend(slips(&model, &particles));
            notes.extend(advice::doubts(&model, &particles, &with_odd_moduli));
            notes.extend(linear_law::notes(&model));
            notes.extend(heat::notes(&model, &particles, &without_conductivity, asks_for_heat));
            notes.extend(closeness::notes(&model, &particles));
            notes.extend(quarters::notes(&model, &particles));
            let mut notes_unless_driven: Vec<String> = driven::note(&deck_text).into_iter().collect();
            notes_unless_driven.extend(slips_unless_driven(&model, &particles));
            for note in notes.iter_mut().chain(&mut notes_unless_driven) {
                *note = places.subjects.with_line(std::mem::take(note), &problems);
            }
            let deck_text = with_whole_paths(deck_text, &model)?;
            Ok(Setup { deck_text, model, particles, masses, notes, notes_unless_driven, catalogue_notes })
        }
        Err(errors) => {
            for error in errors {
                problems.push(placement::fault(error, &model, &places));
            }
            Err(problems.report("the bodies could not be filled"))
        }
    }
}

/// What is wrong with overrides, and what else is wrong with the deck and the overrides that could be worked in.
fn with_faults_of_the_rest(
    mut refused: Vec<DeckReport>,
    shown: &str,
    name: &str,
    changed: &str,
    folder: Option<&Path>,
) -> DeckReport {
    let mut problems = Problems::new(shown, changed).with_folder(folder.unwrap_or(Path::new("")));
    problems.lacks_a_key();
    let raw: Option<RawDeck> = keys::read(&mut problems);
    // Without a model where keys are missing, which is no fault of its own.
    let _ = raw.and_then(|raw| interpret(&raw, name, &mut problems));
    refused.extend(problems.check().err());
    DeckReport::joined(shown, refused)
}

/// A deck that finds its tables from any folder.
fn with_whole_paths(text: String, model: &Model) -> Result<String, DeckReport> {
    let whole = model.bodies.iter().enumerate().filter_map(|(index, body)| {
        let Solid::Cloud { file, .. } = &body.shape.solid else { return None };
        let path = std::path::absolute(file).ok()?;
        Some((index, path.to_str()?.to_owned()))
    });
    let whole: BTreeMap<_, _> = whole.collect();
    Ok(if whole.is_empty() { text } else { overrides::with_files(&text, &whole)?.unwrap_or(text) })
}

/// The model of the text of `problems`, without particles.
pub(super) fn read_model(name: &str, problems: &mut Problems) -> Result<Interpreted, DeckReport> {
    let raw: Option<RawDeck> = keys::read(problems);
    let interpreted = raw.and_then(|raw| interpret(&raw, name, problems));
    problems.check()?;
    interpreted.ok_or_else(|| problems.report("the deck has errors"))
}

#[cfg(test)]
mod tests {
    use super::read_deck;

    #[test]
    fn where_a_deck_is_not_utf8_is_told() {
        let told = |bytes: &[u8]| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("t.toml");
            std::fs::write(&path, bytes).unwrap();
            let report = read_deck(&path).unwrap_err();
            format!("{report}; {}", report.problems()[0].help().unwrap_or_default())
        };
        let latin = told(b"# a\ntitle = \"Stahltr\xe4ger\"\n");
        assert!(
            latin.contains("line 2, column 17") && latin.contains("0xe4") && latin.contains("save it as UTF-8"),
            "{latin}"
        );
        assert!(told(b"# a\n\xb5").contains("line 2, column 1:"));
        let wide = told(b"\xff\xfet\0i\0");
        assert!(wide.contains("line 1: it is UTF-16") && wide.contains("save it as UTF-8"), "{wide}");
    }
}
