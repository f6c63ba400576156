//! Form of a deck, checked against its schema: unknown keys, missing keys and values of the wrong form, all of them at once,
//! each with what is known or expected there.

use super::report::{Fault, Problems, listed, nearest};
use super::schema::{Form, Node};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Reports every fault of form of a deck.
pub(crate) fn check_deck(deck: &DeTable<'_>, problems: &mut Problems) {
    check_table(deck, Node::deck(), "", 0..0, problems);
}

fn check(value: &Spanned<DeValue<'_>>, node: Node<'_>, path: &str, problems: &mut Problems) {
    let form = match value.get_ref() {
        DeValue::Table(_) => Form::Table,
        DeValue::Array(_) => Form::List,
        _ => Form::Scalar,
    };
    if !node.allows(form) {
        problems.push(wrong_form(form, node, path, value.span()));
        return;
    }
    match value.get_ref() {
        DeValue::Table(table) => check_table(table, node, path, value.span(), problems),
        DeValue::Array(entries) => {
            let (least, most) = node.length();
            let count = entries.len() as u64;
            if count < least || count > most {
                let wanted = if least == most { least.to_string() } else { format!("{least} to {most}") };
                let message = format!("expected {wanted} entries in `{path}`, found {count}");
                problems.push(Fault::new("wrong-length", message, value.span(), "this list"));
                return;
            }
            for (index, entry) in entries.iter().enumerate() {
                if let Some(item) = node.item(index) {
                    check(entry, item, path, problems);
                }
            }
        }
        _ => {}
    }
}

fn check_table(table: &DeTable<'_>, node: Node<'_>, path: &str, at: Range<usize>, problems: &mut Problems) {
    for (key, value) in table {
        let name: &str = key.get_ref();
        match node.key(name) {
            Some(child) => check(value, child, &joined(path, name), problems),
            None => problems.push(unknown(name, node, path).at(key.span())),
        }
    }
    for name in node.required().into_iter().filter(|name| !table.contains_key(*name)) {
        problems.push(missing(name, node, path, at.clone()));
    }
}

fn joined(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// What stands at a place, in a sentence that follows "write" or "expected".
fn wanted(node: Node<'_>) -> String {
    let keys: Vec<&str> = node.keys().into_iter().map(|(key, _)| key).collect();
    let mut forms = Vec::new();
    if node.allows(Form::Scalar) {
        forms.push("a single value".to_owned());
    }
    if node.allows(Form::List) {
        forms.push("a list".to_owned());
    }
    if node.allows(Form::Table) {
        forms.push(if keys.is_empty() {
            "a table".to_owned()
        } else {
            format!("a table with {}", listed(keys, "and"))
        });
    }
    forms.join(" or ")
}

fn example(name: &str, node: Node<'_>) -> Option<String> {
    let value = node.own("examples")?.as_array()?.first()?;
    Some(format!("{name} = {}", toml_text(value)))
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

fn wrong_form(found: Form, node: Node<'_>, path: &str, at: Range<usize>) -> Fault {
    let found = match found {
        Form::Scalar => "a single value",
        Form::List => "a list",
        Form::Table => "a table",
    };
    let fault = Fault::new("wrong-type", format!("`{path}` must be {}", wanted(node)), at, format!("found {found}"));
    match example(path.rsplit('.').next().unwrap_or(path), node) {
        Some(example) => fault.help(format!("for example {example}")),
        None => fault,
    }
}

fn missing(name: &str, table: Node<'_>, path: &str, at: Range<usize>) -> Fault {
    let place = if path.is_empty() { "the deck".to_owned() } else { format!("`{path}`") };
    // Only the line a table starts on; an inline table is marked whole.
    let fault = Fault::new("missing-key", format!("{place} has no `{name}`"), at, "missing here");
    let Some(node) = table.key(name) else { return fault };
    let meaning = node.own("description").and_then(|d| d.as_str()).unwrap_or_default();
    let shown = match example(name, node) {
        Some(example) => example,
        None if path.is_empty() => format!("[{name}] with {}", wanted(node)),
        None => format!("{name}: {}", wanted(node)),
    };
    fault.help(format!("add {shown}    ({})", meaning.trim_end_matches('.')))
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
pub(crate) fn unknown(name: &str, node: Node<'_>, path: &str) -> Unknown {
    let options: Vec<&str> = node.keys().into_iter().map(|(key, _)| key).collect();
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
    let holds = |node: Node<'_>| node.keys().iter().any(|(key, _)| *key == name);
    let tables = Node::deck().keys().into_iter();
    tables.filter(|(_, node)| holds(*node) || node.item(0).is_some_and(holds)).map(|(key, _)| key).collect()
}
