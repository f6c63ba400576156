//! Form of a deck, checked against what is expected: unknown keys, missing keys and values of the wrong form, all of them at
//! once, each with what is known or expected there.

use super::declare::Read;
use super::expected::{Expected, Form, Key, lines};
use super::fault::{Entries, Fault, Problems};
use super::foreign;
use super::raw::RawDeck;
use super::suggest::{listed, nearest};
use super::written::{self, Content, Literal, Written, key_span};
use std::ops::Range;
use toml_edit::{Item, Table, TableLike};

/// What is expected of a whole deck.
pub(crate) const DECK: &Expected = RawDeck::EXPECTED;

/// Reads the text of `problems`, whose faults of form go to `problems`: what has one is left out, so that what is wrong with the rest can
/// be told with it. `None` if nothing can be read.
pub(crate) fn read<T: Read>(problems: &mut Problems) -> Option<T> {
    let document = written::parse(problems)?;
    let whole = Written::Table(document.as_table());
    check(whole, T::EXPECTED, None, "", problems);
    if !problems.is_empty() {
        problems.form_is_checked(entries(document.as_table(), T::EXPECTED));
    }
    T::read(whole)
}

/// Where the entries of a deck stand.
fn entries(deck: &Table, expected: &Expected) -> Entries {
    let mut places = Vec::new();
    let mut entry = 0;
    for (name, item) in deck.iter() {
        let key = key_span(deck, name).start;
        let is_named = matches!(expected.key(name), Some((Expected::Named(_), _)));
        match Written::Item(item).content() {
            Content::List(list) if !list.is_empty() => {
                places.push((key, entry));
                for written in list {
                    entry += 1;
                    collect(written, entry, &mut places);
                }
            }
            Content::Table(named) if is_named => {
                for (name, item) in named.iter() {
                    entry += 1;
                    places.push((key_span(named, name).start, entry));
                    collect(Written::Item(item), entry, &mut places);
                }
            }
            Content::List(_) | Content::Scalar(_) | Content::Table(_) => {
                places.push((key, entry));
                collect(Written::Item(item), entry, &mut places);
            }
        }
        entry += 1;
    }
    Entries::new(places)
}

/// Where something begins, and all that is in it.
fn collect(written: Written<'_>, entry: usize, places: &mut Vec<(usize, usize)>) {
    places.extend(written.place().map(|place| (place.start, entry)));
    match written.content() {
        Content::Scalar(_) => {}
        Content::List(list) => list.into_iter().for_each(|written| collect(written, entry, places)),
        Content::Table(table) => {
            for (name, item) in table.iter() {
                places.extend(table.key(name).and_then(toml_edit::Key::span).map(|at| (at.start, entry)));
                collect(Written::Item(item), entry, places);
            }
        }
    }
}

/// Reports every fault of form of what is written at `path`, and says whether it can be read all the same; `key` is the one it is the
/// value of, or part of the value.
fn check(written: Written<'_>, expected: &Expected, key: Option<&Key>, path: &str, problems: &mut Problems) -> bool {
    let content = written.content();
    let form = match &content {
        Content::Table(_) => Form::Table,
        Content::List(_) => Form::List,
        Content::Scalar(_) => Form::Scalar,
    };
    if !expected.allows(form) {
        let fault = wrong_form(form, expected, key, path, written.span());
        let quoted_list = match &content {
            Content::Scalar(Literal::Text(text))
                if text.starts_with('[') && !text.starts_with("[[[") && expected.allows(Form::List) =>
            {
                Some(text)
            }
            _ => None,
        };
        let has_two_brackets = matches!(written, Written::Item(Item::ArrayOfTables(_)));
        problems.push(match has_two_brackets && expected.allows(Form::Table) {
            true => fault.help(format!("there is one such table, and a single table has one bracket: [{path}]")),
            false => match quoted_list {
                Some(text) if !text.trim_end().ends_with(']') => {
                    fault.help("a list ends with a bracket: [\"...\", \"...\"]")
                }
                Some(_) => {
                    fault.help("a list has no quotes around it, each text in it has its own: [\"...\", \"...\"]")
                }
                None => fault,
            },
        });
        return false;
    }
    match content {
        // Faults of the deck as a whole have no place.
        Content::Table(table) if path.is_empty() => check_table(table, expected, path, 0..0, problems),
        Content::Table(table) => check_table(table, expected, path, written.span(), problems),
        Content::List(entries) => check_list(entries, expected, key, path, written.span(), problems),
        Content::Scalar(_) => true,
    }
}

fn check_list(
    entries: Vec<Written<'_>>,
    expected: &Expected,
    key: Option<&Key>,
    path: &str,
    at: Range<usize>,
    problems: &mut Problems,
) -> bool {
    let (least, most) = expected.length();
    let count = entries.len();
    if count < least || count > most {
        let wanted = if least == most { least.to_string() } else { format!("{least} to {most}") };
        let plural = if most == 1 { "entry" } else { "entries" };
        let message = format!("expected {wanted} {plural} in `{path}`, found {count}");
        problems.push(with_example(Fault::new("wrong-length", message, at, "this list"), key));
        return false;
    }
    let mut is_read = true;
    for (index, entry) in entries.into_iter().enumerate() {
        let Some(item) = expected.item(index) else { continue };
        if check(entry, item, key, path, problems) {
            continue;
        }
        // A table of a list has a name others may refer to; a number of a list is a part of something.
        if item.table().is_some() {
            problems.lacks_an_entry();
        } else {
            is_read = false;
        }
    }
    is_read
}

fn check_table(
    table: &dyn TableLike,
    expected: &Expected,
    path: &str,
    at: Range<usize>,
    problems: &mut Problems,
) -> bool {
    let mut meant = Vec::new();
    let mut is_read = true;
    for (name, item) in table.iter() {
        match expected.key(name) {
            Some((inner, key)) => {
                let value_is_read = check(Written::Item(item), inner, key, &joined(path, name), problems);
                is_read &= value_is_read || key.is_some_and(|key| !key.required);
                // What a deck names itself, or a list of such.
                if !value_is_read && (key.is_none() || path.is_empty()) {
                    problems.lacks_an_entry();
                }
            }
            None if problems.is_full() => problems.count_another(),
            None => {
                let unknown = unknown(name, expected, path);
                if path.is_empty() {
                    problems.lacks_an_entry();
                }
                meant.extend(unknown.meant);
                problems.push(unknown.at(key_span(table, name)));
            }
        }
    }
    for key in expected.keys().iter().filter(|key| key.required && !table.contains_key(key.name)) {
        is_read = false;
        // The slip has been told.
        if !meant.contains(&key.name) {
            problems.push(missing(key, path, at.clone()));
        }
    }
    is_read
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

/// A value of the key as one may write it: that of its declaration, or the keys that a table must have.
fn example(key: &Key) -> Option<String> {
    let value = match key.example() {
        Some(value) => toml_text(&value),
        None => {
            let required: Option<Vec<String>> =
                key.expected.keys().iter().filter(|inner| inner.required).map(example).collect();
            let required = required.filter(|keys| !keys.is_empty())?;
            format!("{{ {} }}", required.join(", "))
        }
    };
    Some(format!("{} = {value}", key.name))
}

fn with_example(fault: Fault, key: Option<&Key>) -> Fault {
    match key.and_then(example) {
        Some(example) => fault.help(format!("for example {example}")),
        None => fault,
    }
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
    match key {
        // A list of tables has two brackets.
        Some(_) if found == "a table" && expected.item(0).is_some_and(|entry| !entry.keys().is_empty()) => {
            fault.help(format!("a list of tables has two brackets: [[{path}]]"))
        }
        Some(key) if matches!(expected, Expected::Vector(_)) => match example(key) {
            Some(example) => {
                fault.help(format!("for example {example}, with as many components as the deck has dimensions"))
            }
            None => fault,
        },
        _ => with_example(fault, key),
    }
}

fn missing(key: &Key, path: &str, at: Range<usize>) -> Fault {
    let name = key.name;
    let place = if path.is_empty() { "the deck".to_owned() } else { format!("`{path}`") };
    // Only the line a table starts on; an inline table is marked whole.
    let fault = Fault::new("missing-key", format!("{place} has no `{name}`"), at, "missing here");
    let shown = match example(key) {
        Some(example) => example,
        None => format!("{name}, {}", wanted(&key.expected)),
    };
    let meaning = lines(&key.comment).replace('\n', " ");
    fault.help(format!("add {shown}    ({})", meaning.trim_end_matches('.')))
}

/// An unknown key, still without a place.
pub(crate) struct Unknown {
    message: String,
    help: String,
    /// The key of this table that is probably meant.
    meant: Option<&'static str>,
}

impl Unknown {
    /// The fault at a place.
    #[cfg_attr(test, track_caller)]
    pub(crate) fn at(self, at: Range<usize>) -> Fault {
        Fault::new("unknown-key", self.message, at, "not known here").help(self.help)
    }
}

/// What to say of a key that the table at `path` does not know.
pub(crate) fn unknown(name: &str, expected: &Expected, path: &str) -> Unknown {
    let options = names(expected);
    let place = if path.is_empty() { "at the top of a deck".to_owned() } else { format!("in `{path}`") };
    let message = format!("unknown key `{name}` {place}");
    let half = options.iter().copied().find(|key| key.contains("radius") && *key == name.replace("diameter", "radius"));
    if let Some(radius) = half {
        let help = format!("write `{radius}`, half of it; known keys: {}", listed(options, "and"));
        return Unknown { message, help, meant: Some(radius) };
    }
    if let Some(instead) = foreign::instead(name, path) {
        return Unknown {
            message,
            help: format!("{}; known keys: {}", instead.trim_end().trim_end_matches('.'), listed(options, "and")),
            meant: None,
        };
    }
    // A key that is right elsewhere is meant, rather than one that looks alike here.
    let elsewhere = along(name, expected, path).or_else(|| {
        let tables = tables_with(name);
        (!tables.is_empty()).then(|| format!("`{name}` belongs to {}; ", listed(tables, "or")))
    });
    let meant = if elsewhere.is_some() { None } else { nearest(name, options.iter().copied()) };
    let near = || match meant {
        Some(key) => Some(format!("did you mean `{key}`? ")),
        None => question(anywhere(name)),
    };
    let help = elsewhere.or_else(near).unwrap_or_default() + &format!("known keys: {}", listed(options, "and"));
    Unknown { message, help, meant }
}

/// How far tables are searched for a key, and most places that are suggested: a key of more is meant nowhere rather than somewhere.
const DEEPEST: usize = 4;
const MOST_PLACES: usize = 3;

fn question(places: Vec<String>) -> Option<String> {
    let is_few = (1..=MOST_PLACES).contains(&places.len());
    is_few.then(|| format!("did you mean {}? ", listed(places.iter().map(String::as_str), "or")))
}

/// Paths below a table that lead to a key of this name, at a depth.
fn below(name: &str, expected: &Expected, path: &str, depth: usize, found: &mut Vec<String>) {
    if let Expected::Named(any) = expected {
        return below(name, any, &joined(path, "NAME"), depth, found);
    }
    for key in expected.keys() {
        let here = joined(path, key.name);
        if depth > 1 {
            below(name, &key.expected, &here, depth - 1, found);
            if let Some(entry) = key.expected.item(0) {
                below(name, entry, &here, depth - 1, found);
            }
        } else if key.name == name && !found.contains(&here) {
            found.push(here);
        }
    }
}

/// The question for a key that this table does not know, but one below it or that it is in does.
fn along(name: &str, expected: &Expected, path: &str) -> Option<String> {
    // At the top of a deck, tables are named.
    if path.is_empty() {
        return None;
    }
    for depth in 2..=DEEPEST {
        let mut found = Vec::new();
        below(name, expected, path, depth, &mut found);
        if !found.is_empty() {
            return question(found);
        }
    }
    let (mut tables, mut table, mut here) = (Vec::new(), DECK, String::new());
    for segment in path.split('.') {
        tables.push((table, here.clone()));
        here = joined(&here, segment);
        // Else the name or number of an entry of a list.
        if let Some((inner, _)) = table.key(segment) {
            table = inner.item(0).filter(|entry| !entry.keys().is_empty()).unwrap_or(inner);
        }
    }
    let knows = |table: &Expected| table.keys().iter().any(|key| key.name == name);
    let above = tables.into_iter().rev().find(|(table, _)| knows(table))?.1;
    Some(match above.as_str() {
        "" => format!("`{name}` belongs to the top of the deck; "),
        _ => format!("did you mean `{above}.{name}`? "),
    })
}

/// Where a deck knows a key.
fn anywhere(name: &str) -> Vec<String> {
    let mut found = Vec::new();
    for depth in 2..=DEEPEST {
        below(name, DECK, "", depth, &mut found);
    }
    found
}

/// Tables of the deck, one level down, that know a key.
fn tables_with(name: &str) -> Vec<&'static str> {
    let holds = |expected: &Expected| expected.keys().iter().any(|key| key.name == name);
    let tables = DECK.keys().iter();
    tables.filter(|key| holds(&key.expected) || key.expected.item(0).is_some_and(holds)).map(|key| key.name).collect()
}
