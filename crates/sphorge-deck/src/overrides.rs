//! `--set path=value`: changes worked into the text of a deck before it is read, so that what is stored is what is run.
//!
//! A path follows the keys of the deck; an entry of a list is chosen by its place (from 0) or by its `name`, one without a name by its `region`:
//! `particles.spacing`, `body.bar.velocity.1`, `body.0.material`, `material.armco-iron.density`.

use super::expected::{Expected, Form};
use super::fault::{Fault, Problems};
use super::keys::{self, DECK};
use super::report::DeckReport;
use super::suggest::suggest;
use std::collections::BTreeMap;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Key, Table, TableLike, Value};

/// The text with the overrides worked in, and what is wrong with those that are not; `None` if the text is no TOML, which reading it will
/// report.
pub(crate) fn apply(text: &str, overrides: &[(String, String)]) -> Option<(String, Vec<DeckReport>)> {
    let mut document = text.parse::<DocumentMut>().ok()?;
    let mut refused = Vec::new();
    for (path, value) in overrides {
        let mut problems = Problems::new("--set", &format!("{path}={value}"));
        if let Err(fault) = set(&mut document, path, value) {
            problems.push(fault);
        }
        refused.extend(problems.check().err());
    }
    Some((document.to_string(), refused))
}

/// The text with other files of particles for the bodies at these places of the list.
pub(crate) fn with_files(text: &str, files: &BTreeMap<usize, String>) -> Result<Option<String>, DeckReport> {
    let Ok(mut document) = text.parse::<DocumentMut>() else { return Ok(None) };
    let path: Vec<_> = ["shape", "table", "file"].map(|key| Segment { key: key.to_owned(), at: 0..0 }).into();
    let set = |(index, place): (usize, Place<'_>)| match (files.get(&index), body()) {
        (Some(file), Some(expected)) => set_in(place, expected, &path, "body", Value::from(file.as_str())),
        _ => Ok(()),
    };
    let changed: Result<(), Fault> = match document.get_mut("body") {
        Some(Item::ArrayOfTables(tables)) => {
            tables.iter_mut().map(|table| Place::Table(table, false)).enumerate().try_for_each(set)
        }
        Some(Item::Value(Value::Array(entries))) => entries.iter_mut().map(Place::Value).enumerate().try_for_each(set),
        _ => Ok(()),
    };
    let mut problems = Problems::new("--set", text);
    changed.unwrap_or_else(|fault| problems.push(fault));
    problems.check()?;
    Ok(Some(document.to_string()))
}

/// What is expected of a body.
fn body() -> Option<&'static Expected> {
    DECK.key("body").and_then(|(list, _)| list.item(0))
}

/// A value as TOML, or as the text it is; texts in a list need no quotes either, which shells take away.
pub(crate) fn parse_value(text: &str) -> Value {
    match text.trim().parse::<Value>() {
        Ok(Value::Datetime(_)) | Err(_) => bare_list(text.trim()).unwrap_or_else(|| Value::from(text.trim())),
        Ok(value) => value,
    }
}

/// A list of which some texts have no quotes: `[0, 0, -250 m/s]`.
fn bare_list(text: &str) -> Option<Value> {
    if !text.starts_with('[') || text.contains(['{', '}', '"', '\'', '=']) {
        return None;
    }
    let mut toml = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['[', ']', ',']) {
        toml += &bare_entry(&rest[..at]);
        toml += &rest[at..=at];
        rest = &rest[at + 1..];
    }
    toml += rest;
    toml.parse::<Value>().ok()
}

/// An entry of a list as TOML.
fn bare_entry(text: &str) -> String {
    match text.trim() {
        "" => String::new(),
        entry => parse_value(entry).to_string(),
    }
}

/// A segment of a path and its place in it.
struct Segment {
    key: String,
    at: std::ops::Range<usize>,
}

fn segments(path: &str) -> Result<Vec<Segment>, Fault> {
    let whole = 0..path.len();
    let keys = Key::parse(path).map_err(|_| {
        Fault::new("override", format!("`{path}` is not a path of keys"), whole, "this path")
            .help("join keys with dots: particles.spacing, body.bar.velocity, body.0.material")
    })?;
    let mut from = 0;
    let mut found = Vec::with_capacity(keys.len());
    for key in keys {
        let start = path[from..].find(key.get()).map_or(from, |offset| from + offset);
        let end = (start + key.get().len()).min(path.len());
        found.push(Segment { key: key.get().to_owned(), at: start..end });
        from = end;
    }
    Ok(found)
}

fn set(document: &mut DocumentMut, path: &str, value: &str) -> Result<(), Fault> {
    let segments = segments(path)?;
    set_in_table(document.as_table_mut(), DECK, &segments, "", parse_value(value), false)
}

/// The first two of these paths that lead to the same place of a deck, or one into what the other leads to, however they are written.
pub(crate) fn overlapping(text: &str, paths: &[&str]) -> Option<(usize, usize)> {
    let document = text.parse::<DocumentMut>().ok()?;
    // What leads nowhere is told when it is set.
    let places: Vec<_> = paths.iter().map(|path| place_of(&document, path)).collect();
    let is_in = |a: &[String], b: &[String]| a.starts_with(b) || b.starts_with(a);
    let overlap = |b: usize, a: usize| places[a].as_ref().zip(places[b].as_ref()).is_some_and(|(a, b)| is_in(a, b));
    (0..paths.len()).find_map(|b| (0..b).find(|&a| overlap(b, a)).map(|a| (a, b)))
}

/// Whether a path leads to the same place of a deck as another, or into what that leads to.
pub(crate) fn is_within(text: &str, path: &str, whole: &str) -> bool {
    let deck = text.parse::<DocumentMut>().ok();
    let places = deck.and_then(|deck| place_of(&deck, path).zip(place_of(&deck, whole)));
    places.is_some_and(|(place, whole)| place.starts_with(&whole))
}

/// Where a path leads: names in tables, and numbers in lists, whose entries may have been chosen by name.
fn place_of(document: &DocumentMut, path: &str) -> Option<Vec<String>> {
    let mut at = Some(Seen::Item(document.as_item()));
    let mut place = Vec::new();
    for segment in segments(path).ok()? {
        let index = match at.and_then(Seen::names) {
            Some(names) => Some(choose(names, &segment, "").ok()?),
            None => None,
        };
        at = at.and_then(|seen| seen.child(&segment.key, index));
        place.push(index.map_or(segment.key, |index| index.to_string()));
    }
    Some(place)
}

/// An entry of a document that is only looked at.
#[derive(Clone, Copy)]
enum Seen<'a> {
    Item(&'a Item),
    Value(&'a Value),
    Table(&'a Table),
}

impl<'a> Seen<'a> {
    /// Names of the entries of a list.
    fn names(self) -> Option<Vec<Option<String>>> {
        match self {
            Self::Item(Item::ArrayOfTables(tables)) => Some(tables.iter().map(name_of).collect()),
            Self::Item(Item::Value(Value::Array(entries))) | Self::Value(Value::Array(entries)) => {
                Some(entries.iter().map(name_in).collect())
            }
            _ => None,
        }
    }

    fn child(self, key: &str, index: Option<usize>) -> Option<Self> {
        match (self, index) {
            (Self::Item(Item::Table(table)) | Self::Table(table), None) => table.get(key).map(Self::Item),
            (Self::Item(Item::Value(Value::InlineTable(table))) | Self::Value(Value::InlineTable(table)), None) => {
                table.get(key).map(Self::Value)
            }
            (Self::Item(Item::ArrayOfTables(tables)), Some(index)) => tables.get(index).map(Self::Table),
            (Self::Item(Item::Value(Value::Array(entries))) | Self::Value(Value::Array(entries)), Some(index)) => {
                entries.get(index).map(Self::Value)
            }
            _ => None,
        }
    }
}

/// What names an entry of a list: motions have no name of their own, but a region.
const NAMES: [&str; 2] = ["name", "region"];

/// Name of an entry of a list.
fn name_in(entry: &Value) -> Option<String> {
    let table = entry.as_inline_table()?;
    NAMES.iter().find_map(|key| table.get(key)).and_then(Value::as_str).map(str::to_owned)
}

/// The same of one under a header.
fn name_of(table: &Table) -> Option<String> {
    NAMES.iter().find_map(|key| table.get(key)).and_then(Item::as_str).map(str::to_owned)
}

/// An entry of a document a path can lead through.
enum Place<'a> {
    Item(&'a mut Item),
    Value(&'a mut Value),
    Table(&'a mut dyn TableLike, bool),
}

fn set_in_table(
    table: &mut dyn TableLike,
    expected: &Expected,
    path: &[Segment],
    above: &str,
    value: Value,
    inline: bool,
) -> Result<(), Fault> {
    let [segment, rest @ ..] = path else { return Ok(()) };
    let Some((child, _)) = expected.key(&segment.key) else {
        return Err(keys::unknown(&segment.key, expected, above).at(segment.at.clone()));
    };
    let here = if above.is_empty() { segment.key.clone() } else { format!("{above}.{}", segment.key) };
    if rest.is_empty() {
        let mut value = value;
        // The comment behind a value stays.
        if let Some(old) = table.get(&segment.key).and_then(Item::as_value) {
            *value.decor_mut() = old.decor().clone();
        }
        table.insert(&segment.key, Item::Value(value));
        return Ok(());
    }
    let composed = |item: &Item| item.is_table_like() || item.is_array() || item.is_array_of_tables();
    if !table.get(&segment.key).is_some_and(composed) {
        if !child.allows(Form::Table) {
            return Err(nothing_below(&segment.key, child, &rest[0], table.contains_key(&segment.key)));
        }
        // `search = "skin"` gives way to `search.skin.fraction`.
        let empty = if inline { Item::Value(Value::InlineTable(InlineTable::new())) } else { Item::Table(implicit()) };
        table.insert(&segment.key, empty);
    }
    match table.get_mut(&segment.key) {
        Some(item) => set_in(Place::Item(item), child, rest, &here, value),
        None => Ok(()),
    }
}

/// A table whose header is left out as long as nothing but tables is in it.
fn implicit() -> Table {
    let mut table = Table::new();
    table.set_implicit(true);
    table
}

fn nothing_below(name: &str, expected: &Expected, next: &Segment, present: bool) -> Fault {
    let at = next.at.clone();
    if expected.allows(Form::List) && !present {
        let fault = Fault::new("override", format!("the deck has no `{name}` to change"), at, "not in the deck");
        return fault.help("only what is in the deck can be changed; add the entry to the deck");
    }
    Fault::new("override", format!("`{name}` is a single value"), at, "has no entries").help("end the path here")
}

fn set_in(place: Place<'_>, expected: &Expected, path: &[Segment], above: &str, value: Value) -> Result<(), Fault> {
    match place {
        Place::Table(table, inline) => set_in_table(table, expected, path, above, value, inline),
        Place::Item(Item::Table(table)) => set_in_table(table, expected, path, above, value, false),
        Place::Item(Item::ArrayOfTables(tables)) => {
            let names = tables.iter().map(name_of).collect();
            let index = choose(names, &path[0], above)?;
            match (tables.get_mut(index), path.len()) {
                (Some(_), 1) => Err(whole_entry(&path[0])),
                (Some(table), _) => descend(Place::Table(table, false), expected, index, path, above, value),
                (None, _) => Ok(()),
            }
        }
        Place::Item(Item::Value(inner)) | Place::Value(inner) => match inner {
            Value::InlineTable(table) => set_in_table(table, expected, path, above, value, true),
            Value::Array(entries) => set_in_array(entries, expected, path, above, value),
            _ => Err(nothing_below(above, expected, &path[0], true)),
        },
        Place::Item(Item::None) => Ok(()),
    }
}

fn set_in_array(
    entries: &mut Array,
    expected: &Expected,
    path: &[Segment],
    above: &str,
    value: Value,
) -> Result<(), Fault> {
    let index = choose(entries.iter().map(name_in).collect(), &path[0], above)?;
    match (entries.get_mut(index), path.len()) {
        (Some(entry), 1) => {
            let decor = entry.decor().clone();
            *entry = value;
            *entry.decor_mut() = decor;
            Ok(())
        }
        (Some(entry), _) => descend(Place::Value(entry), expected, index, path, above, value),
        (None, _) => Ok(()),
    }
}

fn descend(
    place: Place<'_>,
    expected: &Expected,
    index: usize,
    path: &[Segment],
    above: &str,
    value: Value,
) -> Result<(), Fault> {
    match expected.item(index) {
        Some(item) => set_in(place, item, &path[1..], &format!("{above}.{}", path[0].key), value),
        None => Err(nothing_below(above, expected, &path[0], true)),
    }
}

fn whole_entry(segment: &Segment) -> Fault {
    let fault = Fault::new("override", "a whole entry cannot be replaced", segment.at.clone(), "this entry");
    fault.help("add one of its keys to the path")
}

/// The entry of a list a segment chooses, by place or by name.
fn choose(names: Vec<Option<String>>, segment: &Segment, list: &str) -> Result<usize, Fault> {
    let by_place = segment.key.parse::<usize>().ok().filter(|&index| index < names.len());
    let named = |name: &Option<String>| name.as_deref() == Some(segment.key.as_str());
    let by_name = names.iter().position(named);
    if let Some(last) = names.iter().rposition(named).filter(|last| by_name != Some(*last)) {
        let message = format!("`{list}` has several entries `{}`", segment.key);
        let help = format!("choose one by its place, such as {list}.{} or {list}.{last}", by_name.unwrap_or(0));
        return Err(Fault::new("override", message, segment.at.clone(), "not clear").help(help));
    }
    by_name.or(by_place).ok_or_else(|| {
        let message = format!("`{list}` has no entry `{}`", segment.key);
        let known: Vec<&str> = names.iter().flatten().map(String::as_str).collect();
        let help = if known.is_empty() {
            format!("its entries are numbered from 0 to {}", names.len().saturating_sub(1))
        } else {
            suggest(&segment.key, known.iter().copied(), "such entry")
        };
        Fault::new("override", message, segment.at.clone(), "not in the deck").help(help)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const DECK: &str = r#"
title = "t"
search = "skin"

[particles]
spacing = "0.3 mm" # fine

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["1 mm", "1 mm"] } }

[[body]]
name = "plate"
velocity = ["0 m/s", "1 m/s"]

[output]
fields = ["velocity"]
"#;

    fn with(path: &str, value: &str) -> String {
        let (text, refused) = apply(DECK, &[(path.to_owned(), value.to_owned())]).unwrap();
        assert!(refused.is_empty(), "{refused:?}");
        text
    }

    fn refused(path: &str, value: &str) -> (String, String) {
        let (text, refused) = apply(DECK, &[(path.to_owned(), value.to_owned())]).unwrap();
        assert_eq!(text, DECK);
        let problem = &refused[0].problems()[0];
        (problem.to_string(), problem.help().unwrap_or_default().to_owned())
    }

    #[test]
    fn values_are_toml_or_else_text_and_comments_stay() {
        assert!(with("particles.spacing", "0.6 mm").contains("spacing = \"0.6 mm\" # fine"));
        assert!(with("particles.spacing", "\"0.6 mm\"").contains("spacing = \"0.6 mm\" # fine"));
        assert!(with("particles.spacing", "6e-4").contains("spacing = 6e-4 # fine"));
        assert!(with("title", "2020-01-01").contains("title = \"2020-01-01\""));
        assert!(with("output.fields", "[\"stress\"]").contains("fields = [\"stress\"]"));
    }

    #[test]
    fn texts_in_a_list_need_no_quotes() {
        let velocity = |text: &str| with("body.plate.velocity", text);
        assert!(velocity("[0 m/s,-250 m/s]").contains("velocity = [\"0 m/s\",\"-250 m/s\"]"));
        assert!(velocity("[0, -250 m/s]").contains("velocity = [0,\"-250 m/s\"]"));
        assert!(with("output.fields", "[velocity, stress]").contains("fields = [\"velocity\",\"stress\"]"));
        let table = with("body.plate.velocity", "[[0 s, 1], [1 us, -2 m/s]]");
        assert!(table.contains("velocity = [[\"0 s\",1],[\"1 us\",\"-2 m/s\"]]"), "{table}");
        // What is no list stays the text it is.
        for text in ["[", "[a", "[a]]", "]a[", "[a] b", "[,]"] {
            assert!(!matches!(parse_value(text), Value::Array(_)), "{text}");
        }
    }

    #[test]
    fn motions_are_reached_by_their_region() {
        let motion = |region: &str| format!("\n[[motion]]\nregion = \"{region}\"\nvelocity = [\"0 m/s\", \"1 m/s\"]\n");
        let set = |deck: &str, path: &str| apply(deck, &[(path.to_owned(), "7 m/s".to_owned())]).unwrap();
        let deck = format!("{DECK}{}{}", motion("left"), motion("right"));
        let (text, refused) = set(&deck, "motion.right.velocity.1");
        assert!(refused.is_empty() && text == set(&deck, "motion.1.velocity.1").0 && text != deck, "{refused:?}");
        let twice = format!("{DECK}{}{}", motion("left"), motion("left"));
        let problem = set(&twice, "motion.left.velocity.1").1[0].problems()[0].to_string();
        assert!(problem.contains("several entries `left`"), "{problem}");
    }

    #[test]
    fn entries_of_lists_are_reached_by_place_and_by_name() {
        assert!(with("body.plate.velocity.1", "7 m/s").contains("velocity = [\"0 m/s\", \"7 m/s\"]"));
        assert_eq!(with("body.1.velocity.1", "7 m/s"), with("body.plate.velocity.1", "7 m/s"));
        assert!(with("body.bar.shape.box.max.0", "2 mm").contains("max = [\"2 mm\", \"1 mm\"]"));
        assert!(with("body.bar.spin.rate", "5 rpm").contains("[body.spin]\nrate = \"5 rpm\""));
        assert!(with("output.fields.0", "stress").contains("fields = [\"stress\"]"));
    }

    #[test]
    fn tables_that_are_not_there_are_made() {
        assert!(with("numerics.viscosity.alpha", "2").contains("[numerics.viscosity]\nalpha = 2"));
        let skin = with("search.skin.fraction", "0.2");
        assert!(skin.contains("fraction = 0.2") && !skin.contains("\"skin\""), "{skin}");
        assert!(with("material.armco-iron.strength.johnson-cook.A", "1 GPa").contains("A = \"1 GPa\""));
    }

    #[test]
    fn paths_to_one_place_are_found_however_they_are_written() {
        let of = |a: &str, b: &str| overlapping(DECK, &["title", a, b]);
        for (a, b) in [
            ("particles.spacing", "\"particles\".'spacing'"),
            ("body.1.velocity.1", "body.plate.velocity.1"),
            ("body.plate.velocity", "body.plate.velocity.1"),
            ("body.1.velocity.0", "body.plate.velocity"),
            ("body.bar.shape.box.max.1", "body.0.shape.box.max.01"),
            ("search", "search.skin.fraction"),
            ("numerics.viscosity", "numerics.viscosity.alpha"),
            ("material.iron.strength", "material.\"iron\".strength.johnson-cook.A"),
            ("output.fields", "output.fields.0"),
        ] {
            assert_eq!(of(a, b), Some((1, 2)), "{a} {b}");
            assert_eq!(of(b, a), Some((1, 2)), "{b} {a}");
        }
        assert!(is_within(DECK, "body.1.velocity.1", "body.plate.velocity"));
        assert!(is_within(DECK, "title", "\"title\"") && !is_within(DECK, "body.1.velocity", "body.plate.velocity.1"));
        for (a, b) in [
            ("body.0.velocity.1", "body.plate.velocity.1"),
            ("body.plate.velocity.0", "body.plate.velocity.1"),
            ("particles.spacing", "particles.smoothing"),
            ("body.bar.shape.box.min", "body.bar.shape.box.max"),
            // What leads nowhere is refused elsewhere.
            ("body.rod.velocity", "body.rod.velocity"),
        ] {
            assert_eq!(of(a, b), None, "{a} {b}");
        }
    }

    #[test]
    fn what_is_not_there_is_refused_with_the_nearest() {
        let (message, help) = refused("particles.spaceing", "1 mm");
        assert_eq!(message, "unknown key `spaceing` in `particles`");
        assert!(help.starts_with("did you mean `spacing`?"), "{help}");
        for (path, meant) in [
            ("contact.friction", "did you mean `contact.penalty.friction`?"),
            ("body.bar.box", "did you mean `body.bar.shape.box`?"),
            ("time.step-control.courant", "did you mean `time.courant`?"),
            ("particles.title", "`title` belongs to the top of the deck;"),
            ("output.friction", "did you mean `contact.penalty.friction` or `wall.contact.penalty.friction`?"),
            ("particles.alpha", "did you mean `numerics.viscosity.alpha`"),
            ("particles.end", "`end` belongs to `time`;"),
        ] {
            let (_, help) = refused(path, "1");
            assert!(help.starts_with(meant), "{path}: {help}");
        }
        let (message, help) = refused("body.plat.velocity", "[]");
        assert_eq!(message, "`body` has no entry `plat`");
        assert!(help.starts_with("did you mean `plate`?"), "{help}");
        assert_eq!(refused("wall.anvil.contact", "penalty").0, "the deck has no `wall` to change");
        assert_eq!(refused("title.x", "1").0, "`title` is a single value");
        assert_eq!(refused("body.0", "1").0, "a whole entry cannot be replaced");
        assert_eq!(refused("body.7.name", "1").0, "`body` has no entry `7`");
        for path in ["", ".", "a..b", "particles.", "\"", "particles.spacing.x"] {
            refused(path, "1");
        }
    }
}
