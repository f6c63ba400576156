//! The JSON schema of a deck, written from what is expected at each place.

use super::expected::{Expected, Key, TableKeys, Words, lines};
use super::keys::DECK;
use super::quantity::QuantityKind;
use serde_json::{Map, Value};
use std::sync::LazyLock;

static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
    let mut definitions = Definitions::default();
    let mut root = Map::new();
    root.insert("$schema".to_owned(), "https://json-schema.org/draft/2020-12/schema".into());
    root.insert("title".to_owned(), "Sphorge deck".into());
    if let Some(deck) = DECK.table() {
        root.append(&mut definitions.table(deck));
    }
    root.insert("$defs".to_owned(), Value::Object(definitions.0));
    Value::Object(root)
});

/// The JSON schema (draft 2020-12) of a deck, for editors and other programs.
///
/// Beside the standard keywords, `x-unit` is the SI unit of a quantity.
pub fn schema() -> &'static Value {
    &SCHEMA
}

/// What is described once and referred to, by name.
#[derive(Default)]
struct Definitions(Map<String, Value>);

fn map<const N: usize>(entries: [(&str, Value); N]) -> Map<String, Value> {
    let mut map = Map::new();
    add(&mut map, entries);
    map
}

fn add<const N: usize>(map: &mut Map<String, Value>, entries: [(&str, Value); N]) {
    for (keyword, value) in entries {
        map.insert(keyword.to_owned(), value);
    }
}

fn number_or_text() -> Map<String, Value> {
    map([("type", Value::Array(vec!["number".into(), "string".into()]))])
}

impl Definitions {
    /// A reference to the description of what is expected, which is written at the first.
    fn refer(&mut self, name: &str, expected: &Expected) -> Map<String, Value> {
        if !self.0.contains_key(name) {
            // Holds the place: a shape is made of shapes.
            self.0.insert(name.to_owned(), Value::Null);
            let description = self.described(expected);
            self.0.insert(name.to_owned(), Value::Object(description));
        }
        map([("$ref", format!("#/$defs/{name}").into())])
    }

    /// What is expected, by reference where it has a name.
    fn named(&mut self, expected: &Expected) -> Map<String, Value> {
        match expected {
            Expected::Words(words) => self.refer(words.name, expected),
            Expected::Quantity(name, _) => self.refer(name, expected),
            Expected::Vector(Expected::Quantity(name, _)) => self.refer(&format!("{name}Vector"), expected),
            Expected::Table(table) | Expected::Laws(table) => self.refer(table().name, expected),
            _ => self.described(expected),
        }
    }

    fn value(&mut self, expected: &Expected) -> Value {
        Value::Object(self.named(expected))
    }

    fn described(&mut self, expected: &Expected) -> Map<String, Value> {
        match expected {
            Expected::Text => map([("type", "string".into())]),
            Expected::Flag => map([("type", "boolean".into())]),
            Expected::Count => map([("type", "integer".into()), ("minimum", 0.into())]),
            Expected::Level => number_or_text(),
            Expected::Word(word) => map([("const", (*word).into())]),
            Expected::Words(words) => one_of(words),
            Expected::Constant(kind) => quantity(kind),
            Expected::Quantity(_, kind) => {
                let text = format!("{} {}: {}, or a plain number in SI", kind.article(), kind.name, kind.examples);
                let mut described = quantity(kind);
                add(&mut described, [("description", text.into())]);
                described
            }
            Expected::Vector(component) => {
                let mut vector = map([("type", "array".into()), ("items", self.value(component))]);
                add(&mut vector, [("minItems", 1.into()), ("maxItems", 3.into())]);
                if let Expected::Quantity(_, kind) = component {
                    let text = format!("one {} per axis of the deck", kind.name);
                    add(&mut vector, [("description", text.into()), ("x-unit", kind.si_unit.into())]);
                }
                vector
            }
            Expected::List(entry) => map([("type", "array".into()), ("items", self.value(entry))]),
            Expected::Pair(first, second) => {
                let entries = vec![self.value(first), self.value(second)];
                let mut pair = map([("type", "array".into()), ("prefixItems", entries.into())]);
                add(&mut pair, [("minItems", 2.into()), ("maxItems", 2.into())]);
                pair
            }
            Expected::Table(table) => self.table(table()),
            Expected::Law(table) => self.table(table),
            Expected::Laws(table) => {
                let mut laws = self.table(table());
                add(&mut laws, [("maxProperties", 1.into())]);
                laws
            }
            Expected::Named(any) => map([("type", "object".into()), ("additionalProperties", self.value(any))]),
            Expected::Either(one, other) => map([("anyOf", vec![self.value(one), self.value(other)].into())]),
        }
    }

    fn table(&mut self, table: &TableKeys) -> Map<String, Value> {
        let mut described = Map::new();
        if !table.comment.is_empty() {
            add(&mut described, [("description", lines(&table.comment).into())]);
        }
        let mut properties = Map::new();
        let mut required: Vec<Value> = Vec::new();
        for key in table.keys.iter() {
            properties.insert(key.name.to_owned(), Value::Object(self.key(key)));
            if key.required {
                required.push(key.name.into());
            }
        }
        let properties = ("properties", properties.into());
        add(&mut described, [("type", "object".into()), properties, ("additionalProperties", false.into())]);
        if !required.is_empty() {
            add(&mut described, [("required", required.into())]);
        }
        described
    }

    fn key(&mut self, key: &Key) -> Map<String, Value> {
        let mut described = map([("description", lines(&key.comment).into())]);
        described.append(&mut self.named(&key.expected));
        if let Some(example) = key.example() {
            add(&mut described, [("examples", vec![example].into())]);
        }
        if let Some(default) = key.default() {
            add(&mut described, [("default", default)]);
        }
        if let Some(otherwise) = key.otherwise {
            add(&mut described, [("x-default", otherwise.into())]);
        }
        described
    }
}

fn quantity(kind: &QuantityKind) -> Map<String, Value> {
    let mut described = number_or_text();
    add(&mut described, [("x-unit", kind.si_unit.into())]);
    described
}

fn one_of(words: &Words) -> Map<String, Value> {
    let option = |(word, meaning): (&str, &str)| map([("const", word.into()), ("description", meaning.into())]);
    let options: Vec<Value> = (words.words)().into_iter().map(|word| Value::Object(option(word))).collect();
    map([("description", words.what.into()), ("oneOf", options.into())])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_through_references_options_and_lists() {
        let at = |expected: &Expected, name: &str| *expected.key(name).unwrap().0;
        let body = *at(DECK, "body").item(0).unwrap();
        let cuboid = at(&at(&body, "shape"), "box");
        assert_eq!(cuboid.keys().iter().map(|key| key.name).collect::<Vec<_>>(), ["min", "max"]);
        assert_eq!(at(&cuboid, "min").length(), (1, 3));
        let search = at(DECK, "search");
        assert_eq!(at(&search, "skin").keys()[0].name, "fraction");
        let iron = at(&at(DECK, "material"), "any-name");
        let cook = at(&at(&iron, "strength"), "johnson-cook");
        let Expected::Constant(kind) = at(&cook, "A") else { panic!("a constant expected") };
        assert_eq!(kind.si_unit, "Pa");
        assert!(cook.key("E").is_none());
    }

    #[test]
    fn the_schema_speaks_of_no_null() {
        assert!(!schema().to_string().contains("null"));
    }
}
