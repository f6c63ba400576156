//! The JSON schema of a deck, written from what is expected at each place.

use super::expected::{Expected, Key, TableKeys, Words, lines};
use super::keys::DECK;
use super::quantity::QuantityKind;
use serde_json::{Map, Value, json};
use std::sync::LazyLock;

static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
    let mut definitions = Definitions::default();
    let mut root = Map::new();
    root.insert("$schema".to_owned(), "https://json-schema.org/draft/2020-12/schema".into());
    root.insert("title".to_owned(), "Sphorge deck".into());
    if let Some(deck) = DECK.table() {
        root.extend(definitions.table(deck));
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

fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

impl Definitions {
    /// A reference to what `describe` makes of it, once.
    fn refer(&mut self, name: &str, describe: impl FnOnce(&mut Self) -> Value) -> Value {
        if !self.0.contains_key(name) {
            // Holds the place: a shape is made of shapes.
            self.0.insert(name.to_owned(), Value::Null);
            let description = describe(self);
            self.0.insert(name.to_owned(), description);
        }
        json!({ "$ref": format!("#/$defs/{name}") })
    }

    fn value(&mut self, expected: &Expected) -> Value {
        match *expected {
            Expected::Text => json!({ "type": "string" }),
            Expected::Flag => json!({ "type": "boolean" }),
            Expected::Count => json!({ "type": "integer", "minimum": 0 }),
            Expected::Level => json!({ "type": ["number", "string"] }),
            Expected::Word(word) => json!({ "const": word }),
            Expected::Words(words) => self.refer(words.name, |_| one_of(words)),
            Expected::Quantity("", kind) => json!({ "type": ["number", "string"], "x-unit": kind.si_unit }),
            Expected::Quantity(name, kind) => self.refer(name, |_| quantity(kind)),
            Expected::Vector(component) => match *component {
                Expected::Quantity(name, kind) => {
                    self.refer(&format!("{name}Vector"), |this| vector(kind, this.value(component)))
                }
                ref other => json!({ "type": "array", "items": self.value(other) }),
            },
            Expected::List(entry) => json!({ "type": "array", "items": self.value(entry) }),
            Expected::Pair(first, second) => {
                let entries = [self.value(first), self.value(second)];
                json!({ "type": "array", "prefixItems": entries, "minItems": 2, "maxItems": 2 })
            }
            Expected::Table(table) => self.refer(table().name, |this| Value::Object(this.table(table()))),
            Expected::Law(table) => Value::Object(self.table(table)),
            Expected::Laws(table) => self.refer(table().name, |this| {
                let mut table = this.table(table());
                table.insert("maxProperties".to_owned(), 1.into());
                Value::Object(table)
            }),
            Expected::Named(any) => json!({ "type": "object", "additionalProperties": self.value(any) }),
            Expected::Either(one, other) => json!({ "anyOf": [self.value(one), self.value(other)] }),
        }
    }

    fn table(&mut self, table: &TableKeys) -> Map<String, Value> {
        let mut map = Map::new();
        if !table.comment.is_empty() {
            map.insert("description".to_owned(), lines(&table.comment).into());
        }
        let keys: Map<String, Value> = table.keys.iter().map(|key| (key.name.to_owned(), self.key(key))).collect();
        map.extend(object(json!({ "type": "object", "properties": keys, "additionalProperties": false })));
        let required: Vec<&str> = table.keys.iter().filter(|key| key.required).map(|key| key.name).collect();
        if !required.is_empty() {
            map.insert("required".to_owned(), required.into());
        }
        map
    }

    fn key(&mut self, key: &Key) -> Value {
        let mut map = Map::new();
        map.insert("description".to_owned(), lines(&key.comment).into());
        map.extend(object(self.value(&key.expected)));
        if let Some(example) = key.example() {
            map.insert("examples".to_owned(), json!([example]));
        }
        if let Some(default) = key.default() {
            map.insert("default".to_owned(), default);
        }
        if let Some(otherwise) = key.otherwise {
            map.insert("x-default".to_owned(), otherwise.into());
        }
        Value::Object(map)
    }
}

fn quantity(kind: QuantityKind) -> Value {
    json!({
        "description": format!("{} {}: {}, or a plain number in SI", kind.article(), kind.name, kind.examples),
        "type": ["number", "string"],
        "x-unit": kind.si_unit,
    })
}

fn vector(kind: QuantityKind, component: Value) -> Value {
    json!({
        "description": format!("one {} per axis of the deck", kind.name),
        "type": "array", "items": component, "minItems": 1, "maxItems": 3, "x-unit": kind.si_unit,
    })
}

fn one_of(words: Words) -> Value {
    let options: Vec<Value> =
        (words.words)().into_iter().map(|(word, meaning)| json!({ "const": word, "description": meaning })).collect();
    json!({ "description": words.what, "oneOf": options })
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
        let Expected::Quantity(_, kind) = at(&cook, "A") else { panic!("a quantity expected") };
        assert_eq!(kind.si_unit, "Pa");
        assert!(cook.key("E").is_none());
    }

    #[test]
    fn the_schema_speaks_of_no_null() {
        assert!(!schema().to_string().contains("null"));
    }
}
