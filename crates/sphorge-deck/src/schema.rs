//! The JSON schema of a deck, and walks over it: the keys a table knows, wherever they are asked for.

use super::raw::RawDeck;
use schemars::{Schema, generate::SchemaSettings, transform::RecursiveTransform};
use serde_json::{Map, Value};
use std::sync::LazyLock;

/// TOML has no null, so a key that may be left out is described without it.
fn without_null(schema: &mut Schema) {
    let is_null = |option: &Value| option.get("type").is_some_and(|t| t == "null");
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|t| t != "null");
        if let [one] = types.as_slice() {
            let one = one.clone();
            schema.insert("type".to_owned(), one);
        }
    }
    if let Some(Value::Array(options)) = schema.get_mut("anyOf") {
        options.retain(|option| !is_null(option));
        if let [Value::Object(one)] = options.as_slice() {
            let one = one.clone();
            schema.remove("anyOf");
            for (key, value) in one {
                if schema.get(&key).is_none() {
                    schema.insert(key, value);
                }
            }
        }
    }
}

static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
    let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(without_null));
    settings.into_generator().into_root_schema_for::<RawDeck>().to_value()
});

/// The JSON schema (draft 2020-12) of a deck, for editors and other programs.
///
/// Beside the standard keywords, `x-unit` is the SI unit of a quantity.
pub fn schema() -> &'static Value {
    &SCHEMA
}

/// Form of a value in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// A single value.
    Scalar,
    /// A list.
    List,
    /// A table.
    Table,
}

/// One place in the schema.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<'a>(&'a Value);

impl Node<'static> {
    /// The whole deck.
    pub(crate) fn deck() -> Self {
        Node(schema())
    }
}

impl<'a> Node<'a> {
    /// The schemas this one stands for: references followed, alternatives spread out.
    fn alternatives(self) -> Vec<&'a Map<String, Value>> {
        let mut found = Vec::new();
        let mut open = vec![self.0];
        while let Some(value) = open.pop() {
            let Some(map) = value.as_object() else { continue };
            if let Some(target) = map.get("$ref").and_then(Value::as_str) {
                open.extend(target.strip_prefix('#').and_then(|pointer| schema().pointer(pointer)));
            }
            for key in ["anyOf", "oneOf", "allOf"] {
                open.extend(map.get(key).and_then(Value::as_array).into_iter().flatten());
            }
            found.push(map);
        }
        found
    }

    /// Keys of the table, with their schemas, in the order of declaration.
    pub(crate) fn keys(self) -> Vec<(&'a str, Node<'a>)> {
        let tables = self.alternatives().into_iter().filter_map(|map| map.get("properties")?.as_object());
        tables.flat_map(|properties| properties.iter().map(|(key, value)| (key.as_str(), Node(value)))).collect()
    }

    /// Schema of every value of a table with free keys.
    pub(crate) fn any_key(self) -> Option<Node<'a>> {
        self.alternatives()
            .into_iter()
            .find_map(|map| map.get("additionalProperties").filter(|v| v.is_object()).map(Node))
    }

    /// Schema of the value of a key.
    pub(crate) fn key(self, name: &str) -> Option<Node<'a>> {
        self.keys().into_iter().find(|(key, _)| *key == name).map(|(_, node)| node).or_else(|| self.any_key())
    }

    /// Schema of the `index`th entry of a list.
    pub(crate) fn item(self, index: usize) -> Option<Node<'a>> {
        self.alternatives().into_iter().find_map(|map| {
            let at = |entries: &'a Value| entries.as_array()?.get(index);
            map.get("prefixItems").and_then(at).or_else(|| map.get("items").filter(|v| v.is_object())).map(Node)
        })
    }

    /// Keys a table must have.
    pub(crate) fn required(self) -> Vec<&'a str> {
        let lists = self.alternatives().into_iter().filter_map(|map| map.get("required")?.as_array());
        lists.flatten().filter_map(Value::as_str).collect()
    }

    /// Fewest and most entries of a list.
    pub(crate) fn length(self) -> (u64, u64) {
        let bound = |keyword: &str| self.alternatives().into_iter().find_map(|map| map.get(keyword)?.as_u64());
        (bound("minItems").unwrap_or(0), bound("maxItems").unwrap_or(u64::MAX))
    }

    /// Whether a value of this form can stand here.
    pub(crate) fn allows(self, form: Form) -> bool {
        self.alternatives().into_iter().any(|map| {
            let of = |name: &str| match name {
                "object" => Form::Table,
                "array" => Form::List,
                _ => Form::Scalar,
            };
            match map.get("type") {
                Some(Value::String(name)) => of(name) == form,
                Some(Value::Array(names)) => names.iter().filter_map(Value::as_str).any(|name| of(name) == form),
                _ => map.contains_key("const") && form == Form::Scalar,
            }
        })
    }

    /// A value of this schema itself, not of what it refers to.
    pub(crate) fn own(self, keyword: &str) -> Option<&'a Value> {
        self.0.get(keyword)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_through_references_options_and_lists() {
        let deck = Node::deck();
        let body = deck.key("body").unwrap().item(0).unwrap();
        let cuboid = body.key("shape").unwrap().key("box").unwrap();
        assert_eq!(cuboid.keys().iter().map(|(key, _)| *key).collect::<Vec<_>>(), ["min", "max"]);
        assert_eq!(cuboid.key("min").unwrap().length(), (1, 3));
        let search = deck.key("search").unwrap();
        assert_eq!(search.key("skin").unwrap().keys()[0].0, "fraction");
        let iron = deck.key("material").unwrap().key("any-name").unwrap();
        let cook = iron.key("strength").unwrap().key("johnson-cook").unwrap();
        assert_eq!(cook.key("A").unwrap().own("x-unit").unwrap(), "Pa");
        assert!(cook.key("E").is_none());
    }

    #[test]
    fn the_schema_speaks_of_no_null() {
        assert!(!schema().to_string().contains("null"));
    }
}
