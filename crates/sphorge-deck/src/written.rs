//! What is written in a deck, with its place in the text: one view of everything TOML can hold.

use super::report::{Fault, Problems};
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
        let span = match self {
            Self::Table(table) => table.span(),
            // Not all that stands between the first header and the last.
            Self::Item(Item::ArrayOfTables(tables)) => tables.iter().next().and_then(Table::span),
            Self::Item(item) => item.span(),
            Self::Value(value) => value.span(),
        };
        span.unwrap_or(0..0)
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
            let fault = Fault::new("toml", error.message().trim(), at, "here");
            problems.push(fault.help("a deck is TOML: key = value, text in quotes, [table], [[list of tables]]"));
        })
        .ok()
}
