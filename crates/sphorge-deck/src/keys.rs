//! Form of a deck, checked against what is expected: unknown keys, missing keys and values of the wrong form, all of them at
//! once, each with what is known or expected there.

use super::declare::Read;
use super::expected::{Expected, Form, Key, lines};
use super::raw::RawDeck;
use super::report::{Fault, Problems, listed, nearest};
use super::written::{self, Content, Written, key_span};
use std::ops::Range;
use toml_edit::TableLike;

/// What is expected of a whole deck.
pub(crate) const DECK: &Expected = RawDeck::EXPECTED;

/// Reads the text of `problems`; `None` with its faults of form in `problems`.
pub(crate) fn read<T: Read>(problems: &mut Problems) -> Option<T> {
    let document = written::parse(problems)?;
    let whole = Written::Table(document.as_table());
    check(whole, T::EXPECTED, None, "", problems);
    if problems.is_empty() { T::read(whole) } else { None }
}

/// Reports every fault of form of what is written at `path`.
fn check(written: Written<'_>, expected: &Expected, key: Option<&Key>, path: &str, problems: &mut Problems) {
    let content = written.content();
    let form = match &content {
        Content::Table(_) => Form::Table,
        Content::List(_) => Form::List,
        Content::Scalar(_) => Form::Scalar,
    };
    if !expected.allows(form) {
        problems.push(wrong_form(form, expected, key, path, written.span()));
        return;
    }
    match content {
        // Faults of the deck as a whole have no place.
        Content::Table(table) if path.is_empty() => check_table(table, expected, path, 0..0, problems),
        Content::Table(table) => check_table(table, expected, path, written.span(), problems),
        Content::List(entries) => {
            let (least, most) = expected.length();
            let count = entries.len();
            if count < least || count > most {
                let wanted = if least == most { least.to_string() } else { format!("{least} to {most}") };
                let message = format!("expected {wanted} entries in `{path}`, found {count}");
                problems.push(Fault::new("wrong-length", message, written.span(), "this list"));
                return;
            }
            for (index, entry) in entries.into_iter().enumerate() {
                if let Some(item) = expected.item(index) {
                    check(entry, item, None, path, problems);
                }
            }
        }
        Content::Scalar(_) => {}
    }
}

fn check_table(table: &dyn TableLike, expected: &Expected, path: &str, at: Range<usize>, problems: &mut Problems) {
    for (name, item) in table.iter() {
        match expected.key(name) {
            Some((inner, key)) => check(Written::Item(item), inner, key, &joined(path, name), problems),
            None => problems.push(unknown(name, expected, path).at(key_span(table, name))),
        }
    }
    for key in expected.keys().iter().filter(|key| key.required && !table.contains_key(key.name)) {
        problems.push(missing(key, path, at.clone()));
    }
}

fn joined(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// What stands at a place, in a sentence that follows "write" or "expected".
fn wanted(expected: &Expected) -> String {
    let keys = names(expected);
    let mut forms = Vec::new();
    if expected.allows(Form::Scalar) {
        forms.push("a single value".to_owned());
    }
    if expected.allows(Form::List) {
        forms.push("a list".to_owned());
    }
    if expected.allows(Form::Table) {
        forms.push(if keys.is_empty() {
            "a table".to_owned()
        } else {
            format!("a table with {}", listed(keys, "and"))
        });
    }
    forms.join(" or ")
}

fn names(expected: &Expected) -> Vec<&'static str> {
    expected.keys().iter().map(|key| key.name).collect()
}

fn example(key: &Key) -> Option<String> {
    Some(format!("{} = {}", key.name, toml_text(&key.example()?)))
}

/// A JSON value as TOML.
pub(crate) fn toml_text(value: &serde_json::Value) -> String {
    use serde_json::Value;
    match value {
        Value::Array(entries) => format!("[{}]", entries.iter().map(toml_text).collect::<Vec<_>>().join(", ")),
        Value::Object(map) => {
            let pairs: Vec<String> = map.iter().map(|(key, value)| format!("{key} = {}", toml_text(value))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
        other => other.to_string(),
    }
}

fn wrong_form(found: Form, expected: &Expected, key: Option<&Key>, path: &str, at: Range<usize>) -> Fault {
    let found = match found {
        Form::Scalar => "a single value",
        Form::List => "a list",
        Form::Table => "a table",
    };
    let fault =
        Fault::new("wrong-type", format!("`{path}` must be {}", wanted(expected)), at, format!("found {found}"));
    match key.and_then(example) {
        Some(example) => fault.help(format!("for example {example}")),
        None => fault,
    }
}

fn missing(key: &Key, path: &str, at: Range<usize>) -> Fault {
    let name = key.name;
    let place = if path.is_empty() { "the deck".to_owned() } else { format!("`{path}`") };
    // Only the line a table starts on; an inline table is marked whole.
    let fault = Fault::new("missing-key", format!("{place} has no `{name}`"), at, "missing here");
    let shown = match example(key) {
        Some(example) => example,
        None if path.is_empty() => format!("[{name}] with {}", wanted(&key.expected)),
        None => format!("{name}: {}", wanted(&key.expected)),
    };
    fault.help(format!("add {shown}    ({})", lines(&key.comment).trim_end_matches('.')))
}

/// An unknown key, still without a place.
pub(crate) struct Unknown {
    message: String,
    help: String,
}

impl Unknown {
    /// The fault at a place.
    pub(crate) fn at(self, at: Range<usize>) -> Fault {
        Fault::new("unknown-key", self.message, at, "not known here").help(self.help)
    }
}

/// What to say of a key that the table at `path` does not know.
pub(crate) fn unknown(name: &str, expected: &Expected, path: &str) -> Unknown {
    let options = names(expected);
    let place = if path.is_empty() { "at the top of a deck".to_owned() } else { format!("in `{path}`") };
    let message = format!("unknown key `{name}` {place}");
    // A key that is right elsewhere is meant, rather than one that looks alike here.
    let elsewhere = tables_with(name);
    let elsewhere = (!elsewhere.is_empty()).then(|| format!("`{name}` belongs to {}. ", listed(elsewhere, "or")));
    let near = || nearest(name, options.iter().copied()).map(|n| format!("did you mean `{n}`? "));
    let help = elsewhere.or_else(near).unwrap_or_default() + &format!("Known keys: {}.", listed(options, "and"));
    Unknown { message, help }
}

/// Tables of the deck, one level down, that know a key.
fn tables_with(name: &str) -> Vec<&'static str> {
    let holds = |expected: &Expected| expected.keys().iter().any(|key| key.name == name);
    let tables = DECK.keys().iter();
    tables.filter(|key| holds(&key.expected) || key.expected.item(0).is_some_and(holds)).map(|key| key.name).collect()
}
