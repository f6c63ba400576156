//! What is written in a deck, with its place in the text: one view of everything TOML can hold.

use super::fault::{Fault, Problems};
use std::ops::Range;
use toml_edit::{Document, Item, Table, TableLike, Value};

/// A value that is not looked into further.
#[derive(PartialEq)]
pub(crate) enum Literal {
    Integer(i64),
    Number(f64),
    Text(String),
    Boolean(bool),
    /// A date or a time, for which a deck has no use.
    Date,
}

/// Something and its place.
pub(crate) struct Spanned<T> {
    value: T,
    span: Range<usize>,
}

impl<T> Spanned<T> {
    pub(crate) fn new(value: T, span: Range<usize>) -> Self {
        Self { value, span }
    }

    pub(crate) fn get_ref(&self) -> &T {
        &self.value
    }

    pub(crate) fn span(&self) -> Range<usize> {
        self.span.clone()
    }
}

/// Something written: the value of a key, or an entry of a list.
#[derive(Clone, Copy)]
pub(crate) enum Written<'a> {
    Item(&'a Item),
    Value(&'a Value),
    Table(&'a Table),
}

/// What it holds.
pub(crate) enum Content<'a> {
    Scalar(Literal),
    List(Vec<Written<'a>>),
    Table(&'a dyn TableLike),
}

impl<'a> Written<'a> {
    pub(crate) fn content(self) -> Content<'a> {
        match self {
            Self::Table(table) | Self::Item(Item::Table(table)) => Content::Table(table),
            Self::Item(Item::ArrayOfTables(tables)) => Content::List(tables.iter().map(Self::Table).collect()),
            Self::Item(Item::Value(value)) | Self::Value(value) => content(value),
            Self::Item(Item::None) => Content::List(Vec::new()),
        }
    }

    /// Its bytes in the text; of a table under a header that header.
    pub(crate) fn span(self) -> Range<usize> {
        self.place().unwrap_or(0..0)
    }

    /// The same; `None` for a table that has no header.
    pub(crate) fn place(self) -> Option<Range<usize>> {
        match self {
            Self::Table(table) => table.span(),
            // Not all that stands between the first header and the last.
            Self::Item(Item::ArrayOfTables(tables)) => tables.iter().next().and_then(Table::span),
            Self::Item(item) => item.span(),
            Self::Value(value) => value.span(),
        }
    }
}

fn content(value: &Value) -> Content<'_> {
    match value {
        Value::InlineTable(table) => Content::Table(table),
        Value::Array(entries) => Content::List(entries.iter().map(Written::Value).collect()),
        Value::Integer(number) => Content::Scalar(Literal::Integer(*number.value())),
        Value::Float(number) => Content::Scalar(Literal::Number(*number.value())),
        Value::String(text) => Content::Scalar(Literal::Text(text.value().clone())),
        Value::Boolean(flag) => Content::Scalar(Literal::Boolean(*flag.value())),
        Value::Datetime(_) => Content::Scalar(Literal::Date),
    }
}

/// Where a key of a table stands.
pub(crate) fn key_span(table: &dyn TableLike, key: &str) -> Range<usize> {
    table.key(key).and_then(toml_edit::Key::span).unwrap_or(0..0)
}

/// The text of `problems` as TOML; `None` with a fault in `problems`.
pub(crate) fn parse(problems: &mut Problems) -> Option<Document<String>> {
    // What follows the first slip of syntax is mostly its echo, and is not told.
    let parsed = Document::parse(problems.text().to_owned());
    parsed
        .map_err(|error| {
            let at = error.span().unwrap_or(0..0);
            let (message, help) = told(error.message().trim(), &at, problems.text());
            problems.push(Fault::new("toml", message, at, "here").help(help));
        })
        .ok()
}

/// Quotes that word processors and web pages put in the place of plain ones.
pub(crate) const TYPOGRAPHIC: &[char] =
    &['\u{201c}', '\u{201d}', '\u{201e}', '\u{201f}', '\u{2018}', '\u{2019}', '\u{ab}', '\u{bb}'];

/// What a user is told of a slip of syntax: what the parser says of it, or what it means in a deck.
fn told(message: &str, at: &Range<usize>, text: &str) -> (String, &'static str) {
    let word = text.get(at.clone()).unwrap_or_default();
    let before = text.get(..at.start).unwrap_or_default().trim_end();
    if let Some(quote) = word.chars().find(|c| TYPOGRAPHIC.contains(c)) {
        return (
            format!("`{quote}` is a typographic quote, not one of a deck"),
            "write the plain quote \" before and behind the text; word processors replace it",
        );
    }
    if message.contains("must be quoted") {
        return (
            format!("`{word}` must be in quotes"),
            "words and quantities are text: search = \"skin\", spacing = \"0.3 mm\"",
        );
    }
    if before.ends_with('=') && message.contains("expected `'`") {
        return ("a value is missing".to_owned(), "write key = value");
    }
    let line =
        text.get(..at.start).map_or("", |before| &text[before.rfind('\n').map_or(0, |end| end + 1)..]).trim_start();
    if ["//", "/*", ";", "$", "*", "!", "%", "--"].iter().any(|mark| line.starts_with(mark)) {
        return (
            message.to_owned(),
            "comments begin with #, and nothing is included; a deck is TOML: key = value, [table], [[list of tables]]",
        );
    }
    if text.get(at.start..).is_some_and(|rest| rest.starts_with(|c: char| c.is_control() && !c.is_whitespace())) {
        let help = "leave it out; text can hold it as an escape: \"\\u001B\"";
        return ("a deck cannot contain a control character".to_owned(), help);
    }
    match message {
        "duplicate key" => (
            format!("`{word}` is given twice"),
            "remove one of them; an entry of a list of tables has two brackets: [[body]]",
        ),
        "integer number overflowed" => (
            "the number is too large".to_owned(),
            "the largest whole number is 9223372036854775807; write a larger one with a decimal point",
        ),
        _ if message.contains("recurs") => {
            ("brackets are nested too deeply".to_owned(), "at most 80 levels are possible")
        }
        _ => (message.to_owned(), "a deck is TOML: key = value, text in quotes, [table], [[list of tables]]"),
    }
}
