//! Decks, and what is shipped.

use crate::{errors, guard, words::of_python};
use pyo3::{
    exceptions::{PyKeyError, PyValueError},
    prelude::*,
    types::PyDict,
};
use sphorge::{
    deck::{self, DeckReport, Setup, did_you_mean},
    decks as shipped,
    material::{self, ConstantLine, LawListing},
    output::measure_unit,
};
use sphorge_cli::particle_limit;
use std::path::PathBuf;
use toml_edit::{DocumentMut, Item, Key, Value};

/// A deck with changes.
#[pyclass(module = "sphorge._sphorge")]
#[derive(Clone)]
pub(crate) struct Deck {
    name: String,
    /// Where the text is from, if from a file.
    path: Option<PathBuf>,
    text: String,
    overrides: Vec<(String, String)>,
}

impl Deck {
    /// Reads and fills it.
    pub(crate) fn load(&self) -> Result<Setup, DeckReport> {
        self.load_with(&[])
    }

    /// The same with more changes.
    pub(crate) fn load_with(&self, more: &[(String, String)]) -> Result<Setup, DeckReport> {
        let overrides = [&self.overrides[..], more].concat();
        match &self.path {
            Some(path) => deck::load_text_of(path, &self.text, &overrides, particle_limit()),
            None => deck::load_text_within(&self.name, &self.text, &overrides, particle_limit()),
        }
    }

    /// A key that is set already and would be undone by setting this one.
    pub(crate) fn sets(&self, key: &str) -> Option<&str> {
        deck::undone_by(&self.text, &self.overrides, key)
    }
}

#[pymethods]
impl Deck {
    /// A deck of this text.
    #[staticmethod]
    fn of_text(name: String, text: String) -> Self {
        Self { name, path: None, text, overrides: Vec::new() }
    }

    /// A deck file.
    #[staticmethod]
    fn of_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let text = guard::detached(py, || deck::read_deck(&path))?.map_err(|report| errors::deck(py, &report))?;
        let name = path.file_stem().map_or_else(|| "deck".to_owned(), |stem| stem.to_string_lossy().into_owned());
        Ok(Self { name, path: Some(path), text, overrides: Vec::new() })
    }

    /// A shipped deck.
    #[staticmethod]
    fn shipped(py: Python<'_>, name: &str) -> PyResult<Self> {
        match shipped::find(name) {
            Some(found) => Ok(Self::of_text(found.name.to_owned(), found.text.to_owned())),
            None => {
                let near = did_you_mean(shipped::like(name));
                let hint = format!(
                    "{near}give the path of a deck file, or the name of a shipped deck: `sphorge.decks` lists them"
                );
                Err(errors::bad_input(py, &format!("there is no deck `{name}`"), &hint))
            }
        }
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The text with all changes.
    #[getter]
    fn text(&self, py: Python<'_>) -> PyResult<String> {
        deck::with_overrides(&self.text, &self.overrides).map_err(|report| errors::deck(py, &report))
    }

    /// A deck of what `name` and `source` tell of another one.
    #[staticmethod]
    fn of_parts(name: String, path: Option<PathBuf>, text: String, overrides: Vec<(String, String)>) -> Self {
        Self { name, path, text, overrides }
    }

    /// Where the text is from, if from a file, the text without changes, and the changes.
    fn source(&self) -> (Option<PathBuf>, &str, Vec<(String, String)>) {
        (self.path.clone(), &self.text, self.overrides.clone())
    }

    /// Refuses keys of which one would undo what another one sets, or the deck does.
    pub(crate) fn refuse_overlapping(&self, py: Python<'_>, keys: Vec<String>) -> PyResult<()> {
        let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
        if let Some((key, set)) = keys.iter().find_map(|key| self.sets(key).map(|set| (*key, set))) {
            let what = if set == key {
                format!("`{set}` is set and varied")
            } else {
                format!("`{set}` is set, and `{key}`, which is varied, sets the same")
            };
            return Err(errors::bad_input(py, &what, "leave it out of one of the two"));
        }
        match deck::overlapping_keys(&self.text(py)?, &keys) {
            None => Ok(()),
            Some((a, b)) => {
                let what = format!("`{}` and `{}` set the same", keys[a], keys[b]);
                Err(errors::bad_input(
                    py,
                    &what,
                    "a vector and its components, or two names of one key, cannot be varied together: choose one",
                ))
            }
        }
    }

    fn copy(&self) -> Self {
        self.clone()
    }

    /// Sets a key, as `--set` does.
    fn set(&mut self, py: Python<'_>, key: String, value: String) -> PyResult<()> {
        let set = [&self.overrides[..], &[(key.clone(), value.clone())]].concat();
        deck::with_overrides(&self.text, &set).map_err(|report| errors::deck(py, &report))?;
        self.overrides.retain(|(known, _)| *known != key);
        self.overrides.push((key, value));
        Ok(())
    }

    /// What a key is set to, in JSON; fails where the deck does not say.
    fn get(&self, py: Python<'_>, key: &str) -> PyResult<String> {
        let text = self.text(py)?;
        let document = text.parse::<DocumentMut>().map_err(|error| PyValueError::new_err(error.to_string()))?;
        let missing = || PyKeyError::new_err(format!("the deck does not set `{key}`"));
        let mut at = json(document.as_item());
        for segment in Key::parse(key).map_err(|_| PyKeyError::new_err(format!("`{key}` is not a path of keys")))? {
            let segment = segment.get();
            at = match at {
                serde_json::Value::Object(mut table) => table.remove(segment).ok_or_else(missing)?,
                serde_json::Value::Array(mut entries) => {
                    let named = entries
                        .iter()
                        .position(|entry| entry.get("name").and_then(|name| name.as_str()) == Some(segment));
                    let k =
                        named.or_else(|| segment.parse().ok()).filter(|k| *k < entries.len()).ok_or_else(missing)?;
                    entries.swap_remove(k)
                }
                _ => return Err(missing()),
            };
        }
        Ok(at.to_string())
    }

    /// Reads and fills the deck: particles and masses of its bodies, and what there is to note.
    fn check<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let deck = self.clone();
        let setup = guard::in_pool(py, move || deck.load())?.map_err(|report| errors::deck(py, &report))?;
        let bodies = PyDict::new(py);
        for (body, filled) in setup.model.bodies.iter().zip(&setup.masses) {
            let of = PyDict::new(py);
            of.set_item("particles", filled.particles)?;
            of.set_item("mass", filled.mass)?;
            of.set_item("shape_mass", filled.shape_mass)?;
            of.set_item("spacing", body.spacing)?;
            bodies.set_item(&body.name, of)?;
        }
        let told = PyDict::new(py);
        told.set_item("title", &setup.model.title)?;
        told.set_item("particles", setup.particles.len())?;
        told.set_item("bodies", bodies)?;
        told.set_item("measures", setup.model.measures.iter().map(|of| of.name.clone()).collect::<Vec<_>>())?;
        let units = PyDict::new(py);
        for of in &setup.model.measures {
            units.set_item(&of.name, measure_unit(&of.kind, setup.model.dimensions))?;
        }
        told.set_item("measure_units", units)?;
        told.set_item("notes", setup.all_notes().iter().map(|note| of_python(note)).collect::<Vec<_>>())?;
        Ok(told)
    }
}

/// What is written in a deck, as JSON.
fn json(item: &Item) -> serde_json::Value {
    use serde_json::Value as Json;
    fn of_value(value: &Value) -> Json {
        match value {
            Value::String(text) => Json::from(text.value().as_str()),
            Value::Integer(number) => Json::from(*number.value()),
            Value::Float(number) => Json::from(*number.value()),
            Value::Boolean(flag) => Json::from(*flag.value()),
            Value::Datetime(time) => Json::from(time.value().to_string()),
            Value::Array(entries) => entries.iter().map(of_value).collect(),
            Value::InlineTable(table) => table.iter().map(|(key, value)| (key.to_owned(), of_value(value))).collect(),
        }
    }
    match item {
        Item::None => Json::Null,
        Item::Value(value) => of_value(value),
        Item::Table(table) => table.iter().map(|(key, item)| (key.to_owned(), json(item))).collect(),
        Item::ArrayOfTables(tables) => {
            let entries =
                tables.iter().map(|table| table.iter().map(|(key, item)| (key.to_owned(), json(item))).collect());
            Json::Array(entries.map(Json::Object).collect())
        }
    }
}

/// Names and titles of the shipped decks.
#[pyfunction]
pub(crate) fn decks() -> Vec<(String, String)> {
    shipped::DECKS.iter().map(|deck| (deck.name.to_owned(), deck.title())).collect()
}

/// Reads a quantity such as `1 us` in an SI unit.
#[pyfunction]
pub(crate) fn quantity(text: &str, unit: &str) -> PyResult<f64> {
    deck::read_quantity(text, unit).map_err(PyValueError::new_err)
}

/// Reads the difference of two quantities in an SI unit: `5 degC` is 5 K.
#[pyfunction]
pub(crate) fn difference(text: &str, unit: &str) -> PyResult<f64> {
    deck::read_difference(text, unit).map_err(PyValueError::new_err)
}

/// Reads a value of a key as a number: its SI value and unit; nothing if it is none, or one that the key does not take.
#[pyfunction]
pub(crate) fn quantity_of_key(key: &str, value: &str) -> Option<(f64, &'static str)> {
    deck::quantity_of_key(key, value)
}

fn constants<'py>(py: Python<'py>, lines: &[ConstantLine]) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    for line in lines.iter().filter(|line| line.value.is_some()) {
        let of = PyDict::new(py);
        of.set_item("value", line.value)?;
        of.set_item("unit", line.unit)?;
        of.set_item("symbol", line.symbol)?;
        of.set_item("meaning", line.meaning)?;
        told.set_item(line.key, of)?;
    }
    Ok(told)
}

fn law<'py>(py: Python<'py>, law: &LawListing) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    told.set_item("key", law.key)?;
    told.set_item("name", law.name)?;
    told.set_item("reference", law.reference)?;
    told.set_item("constants", constants(py, &law.constants)?)?;
    Ok(told)
}

/// The catalogue of materials.
#[pyfunction]
pub(crate) fn materials(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let told = PyDict::new(py);
    for material in guard::detached(py, material::catalogue)? {
        let of = PyDict::new(py);
        of.set_item("description", &material.description)?;
        of.set_item("reference", &material.reference)?;
        of.set_item("note", &material.note)?;
        of.set_item("doubts", &material.doubts)?;
        of.set_item("constants", constants(py, &material.constants)?)?;
        of.set_item("equation_of_state", material.equation_of_state.as_ref().map(|of| law(py, of)).transpose()?)?;
        of.set_item("strength", material.strength.as_ref().map(|of| law(py, of)).transpose()?)?;
        of.set_item("damage", material.damage.as_ref().map(|of| law(py, of)).transpose()?)?;
        of.set_item("missing", &material.missing)?;
        told.set_item(&material.name, of)?;
    }
    Ok(told)
}
