//! `docs/deck-reference.md` is written from the declarations of the keys; the test compares. After a change,
//! `UPDATE_REFERENCE=1 cargo test -p sphorge-deck --lib reference` writes it anew.

use crate::{keys::toml_text, schema, unit};
use serde_json::{Map, Value};
use sphorge_engine::particles::FIELDS;
use std::{collections::VecDeque, fmt::Write, path::Path};

const HEAD: &str = r#"# Deck reference

*Generated from the declarations in `crates/sphorge-deck/src/raw`; see `crates/sphorge-deck/src/tests/reference.rs`.*

A deck is a [TOML](https://toml.io) file. The command line can change any key without touching the file:
`--set particles.spacing="0.6 mm"`. An entry of a list is selected by its name, a motion by its region, or by its index from 0:
`--set body.bar.velocity.1="-250 m/s"`, `--set body.0.material=ofhc-copper`. The deck as run is stored with the results.

## Quantities

A quantity is a text with a number and a unit, such as `"25.46 mm"`, `"452 J/(kg K)"` or `"7.89 g/cm^3"`, or a plain number
in SI units. A unit is a product of the symbols below, with `/`, powers (`m^2`, `m2`, `s^-1`) and brackets. `J/kg K` is
refused because it is ambiguous. Symbols marked * take the prefixes n, u (µ), m, c, d, k, M, G.

"#;

const VECTORS: &str = r#"
A vector has one component per axis: `dimensions = "3d"` three, `"plane-strain"` two, `"1d"` one. Further components may be
given if they are zero.

## How shapes are filled

A lattice is anchored to its shape and rotates with it, so a symmetric shape gets a symmetric lattice.

- **Boxes, and cylinders along their axis.** The number of cells is the length over the spacing, rounded. The lattice is
  centred: if the length is not a multiple of the spacing, the ends are over- or underfilled by less than a quarter of a
  spacing each.
- **Discs, spheres, and sections of cylinders, ogives and bars of revolution.** The lattice is centred with a cell corner
  on the centre or axis, and the particles whose centre is inside the shape are kept. With `placement = "on-faces"` a
  particle sits on the centre or axis. A polygon has the lattice of its bounding box.
- **Combined shapes** continue the lattice of their first part: a plate with a hole has the lattice of the plate, a bar
  with a head that of the bar.
- **Mass.** The mass of a particle is density times spacing to the power of the dimensions (per metre of thickness in plane
  strain, per square metre in one dimension). The mass of a body therefore differs from that of its shape by rounding;
  `sphorge check` and the summary of a run report both. Masses are not scaled to the mass of the shape: the initial density
  is the reference density, and particles fill the space they represent.
- **Notes.** `check` and `run` print a note with the nearest spacings that fit if the two masses differ by more than 1 %, or
  if the first layer of a body on a square or cubic lattice is not half a spacing (within 0.05 spacings) from the symmetry
  plane or wall at which the body ends.
- **`lattice = "hexagonal"`.** Neighbouring rows are shifted by half a particle distance. In three dimensions, layers across
  the third axis (or across the axis of the bar) are stacked as in hexagonal close packing. A particle represents the same
  area or volume as in the square or cubic lattice of the same spacing; neighbours are 1.075 spacings apart in two
  dimensions, 1.122 in three.
- **`lattice = "rings"`.** A whole number of rings of equal width between hole and surface, with equally spaced particles in
  the middle of each ring, and a whole number of slices along a cylinder. The four particles around the centre are at the
  centroids of their quarters. Each ring has a multiple of four particles and none on the two axes across, so that symmetry
  planes through the centre divide it into equal halves and quarters. A particle has the mass of its share of the ring, so
  the body has exactly the mass of its shape. Further parts of a `difference` or `intersection` cut particles away. The
  total Lagrangian form uses rings by default for all bodies that they can fill: corners of a cubic lattice protrude from a
  round surface, and a bar of 12 particles across gets a foot 4 % too wide.
- **Thickness and contact.** A body has to be at least one spacing thick. Bodies that touch share a face: their outermost
  particles are then one spacing apart. Bodies whose particles are closer than half of that overlap and are refused.
"#;

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// A definition the schema refers to.
fn resolve(value: &Value) -> &Value {
    let pointer = value.get("$ref").and_then(Value::as_str).and_then(|r| r.strip_prefix('#'));
    pointer.and_then(|pointer| schema().pointer(pointer)).unwrap_or(value)
}

fn properties(value: &Value) -> Option<&Map<String, Value>> {
    resolve(value).get("properties")?.as_object()
}

/// The alternatives of a value.
fn options(value: &Value) -> Vec<&Value> {
    match value.get("anyOf").and_then(Value::as_array) {
        Some(options) => options.iter().flat_map(options_of).collect(),
        None => vec![value],
    }
}

fn options_of(value: &Value) -> Vec<&Value> {
    options(value)
}

/// What can be written, in a few words; tables are left to their own sections.
fn form(value: &Value) -> String {
    let forms: Vec<String> = options(value).into_iter().map(one_form).collect();
    forms.join(" or ")
}

fn one_form(value: &Value) -> String {
    let target = resolve(value);
    if let Some(word) = target.get("const") {
        return format!("`{}`", toml_text(word));
    }
    if let Some(words) = target.get("oneOf").and_then(Value::as_array) {
        if words.len() == FIELDS.len() {
            return "a [field](#fields)".to_owned();
        }
        return words.iter().map(|w| format!("`{}`", toml_text(&w["const"]))).collect::<Vec<_>>().join(", ");
    }
    let unit = target.get("x-unit").and_then(Value::as_str);
    let is_list = target.get("type").is_some_and(|t| t == "array");
    match (unit, is_list) {
        (Some(""), false) => "number".to_owned(),
        (Some(unit), false) => format!("quantity, {unit}"),
        (Some(""), true) => "vector of numbers".to_owned(),
        (Some(unit), true) => format!("vector, {unit}"),
        (None, true) if target.get("prefixItems").is_some() => {
            let entries = target["prefixItems"].as_array().into_iter().flatten();
            let entries: Vec<_> = entries.map(|entry| form(entry).replace("quantity, ", "quantity in ")).collect();
            format!("[{}]", entries.join(", "))
        }
        (None, true) => match target.get("items").map(form).unwrap_or_default().as_str() {
            "table, below" => "list of tables, below".to_owned(),
            entries => format!("list of: {entries}"),
        },
        (None, false) => match target.get("type") {
            Some(Value::String(kind)) => match kind.as_str() {
                "string" => "text".to_owned(),
                "integer" => "whole number".to_owned(),
                "boolean" => "`true`, `false`".to_owned(),
                _ => "table, below".to_owned(),
            },
            _ => "number or quantity".to_owned(),
        },
    }
}

/// Meaning of a key, with the meanings of the words it chooses from.
fn meaning(value: &Value) -> String {
    let mut text = value.get("description").and_then(Value::as_str).unwrap_or_default().to_owned();
    for option in options(value) {
        let words = resolve(option).get("oneOf").and_then(Value::as_array);
        for word in words.into_iter().flatten().filter(|words| words.get("description").is_some()) {
            if resolve(option)["oneOf"]
                .as_array()
                .is_some_and(|all| all.len() == FIELDS.len() || all.len() <= 3 && is_axis(all))
            {
                break;
            }
            let _ = write!(
                text,
                "<br>`{}`: {}",
                word["const"].as_str().unwrap_or_default(),
                word["description"].as_str().unwrap_or_default()
            );
        }
    }
    text
}

fn is_axis(words: &[Value]) -> bool {
    words.first().is_some_and(|word| word["const"] == "x")
}

fn default_of(key: &str, table: &Value, value: &Value) -> String {
    let required = resolve(table).get("required").and_then(Value::as_array);
    if required.is_some_and(|required| required.iter().any(|name| name == key)) {
        return "**required**".to_owned();
    }
    if let Some(text) = value.get("x-default").and_then(Value::as_str) {
        return text.to_owned();
    }
    match value.get("default") {
        Some(Value::String(text)) if text.is_empty() => "none".to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Array(list)) if list.is_empty() => "none".to_owned(),
        Some(Value::Object(_)) | None => String::new(),
        Some(other) => other.to_string(),
    }
}

fn example(value: &Value) -> String {
    let first = value.get("examples").and_then(Value::as_array).and_then(|examples| examples.first());
    first.map(|e| format!("`{}`", toml_text(e))).unwrap_or_default()
}

/// A table of the deck that gets a section.
struct Section<'a> {
    paths: Vec<String>,
    table: &'a Value,
}

/// Tables below a value: what to append to the path, and the table.
fn tables_below(value: &Value) -> Vec<(String, &Value)> {
    let mut found = Vec::new();
    for option in options(value) {
        let target = resolve(option);
        if properties(target).is_some() {
            found.push((String::new(), target));
        } else if let Some(items) = target.get("items").filter(|_| target.get("x-unit").is_none()) {
            found.extend(tables_below(items));
        } else if let Some(any) = target.get("additionalProperties").filter(|v| v.is_object()) {
            found.extend(tables_below(any).into_iter().map(|(rest, table)| (format!(".NAME{rest}"), table)));
        }
    }
    found
}

fn sections() -> Vec<Section<'static>> {
    let mut sections: Vec<Section<'static>> = vec![Section { paths: vec![String::new()], table: schema() }];
    let mut open = VecDeque::from([0]);
    while let Some(index) = open.pop_front() {
        let (path, table) = (sections[index].paths[0].clone(), sections[index].table);
        for (key, value) in properties(table).into_iter().flatten() {
            for (rest, below) in tables_below(value) {
                let path = if path.is_empty() { format!("{key}{rest}") } else { format!("{path}.{key}{rest}") };
                match sections.iter_mut().find(|s| std::ptr::eq(s.table, below)) {
                    Some(section) => section.paths.push(path),
                    None => {
                        sections.push(Section { paths: vec![path], table: below });
                        open.push_back(sections.len() - 1);
                    }
                }
            }
        }
    }
    // Tables follow the table they belong to.
    let mut ordered: Vec<Section<'static>> = Vec::new();
    for section in sections {
        let path = &section.paths[0];
        let parent = path.rsplit_once('.').map_or(path.as_str(), |(parent, _)| parent);
        let after = ordered.iter().rposition(|s| s.paths[0] == parent || s.paths[0].starts_with(&format!("{parent}.")));
        match after {
            Some(at) if path.contains('.') => ordered.insert(at + 1, section),
            _ => ordered.push(section),
        }
    }
    ordered
}

fn write_section(text: &mut String, section: &Section<'_>) {
    let level = if section.paths[0].replace(".NAME", "").contains('.') { "###" } else { "##" };
    let title = if section.paths[0].is_empty() {
        "Top of the deck".to_owned()
    } else {
        section.paths.iter().map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ")
    };
    let _ = write!(text, "\n{level} {title}\n\n");
    if let Some(description) = section.table.get("description").and_then(Value::as_str) {
        let _ = write!(text, "{}\n\n", description.trim());
    }
    let keys = properties(section.table);
    if keys.is_none_or(Map::is_empty) {
        text.push_str("No keys.\n");
        return;
    }
    text.push_str("| key | value | default | meaning | example |\n| --- | --- | --- | --- | --- |\n");
    for (key, value) in keys.into_iter().flatten() {
        let row =
            [format!("`{key}`"), form(value), default_of(key, section.table, value), meaning(value), example(value)];
        let _ = writeln!(text, "| {} |", row.map(|c| cell(&c)).join(" | "));
    }
}

fn reference() -> String {
    let mut text = HEAD.to_owned();
    text.push_str("| symbol | in SI units |\n| --- | --- |\n");
    for (symbol, value, prefixes) in unit::table() {
        let star = if prefixes { " *" } else { "" };
        let _ = writeln!(text, "| `{symbol}`{star} | {value} |");
    }
    text.push_str(VECTORS);
    for section in sections() {
        write_section(&mut text, &section);
    }
    text.push_str("\n## Fields\n\nNames for `output.fields` and for measures. *default*: written to frames unless `output.fields` says otherwise.\n\n");
    text.push_str("| field | unit | default | meaning |\n| --- | --- | --- | --- |\n");
    for field in FIELDS.iter() {
        let usual = if field.default_output { "yes" } else { "" };
        let _ = writeln!(text, "| `{}` | {} | {usual} | {} |", field.name, field.unit, cell(field.meaning));
    }
    text
}

#[test]
fn the_reference_page_is_that_of_the_declarations() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/deck-reference.md");
    let wanted = reference();
    if std::env::var_os("UPDATE_REFERENCE").is_some() {
        std::fs::write(&path, &wanted).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == wanted,
        "docs/deck-reference.md is out of date: UPDATE_REFERENCE=1 cargo test -p sphorge-deck --lib reference"
    );
}

#[test]
fn every_key_is_explained() {
    for section in sections() {
        for (key, value) in properties(section.table).into_iter().flatten() {
            let place = format!("{}.{key}", section.paths[0]);
            assert!(value.get("description").is_some_and(|d| !d.as_str().unwrap_or_default().is_empty()), "{place}");
            let table = !tables_below(value).is_empty();
            let default = default_of(key, section.table, value);
            assert!(table || !default.is_empty(), "{place} has no default");
        }
    }
}
