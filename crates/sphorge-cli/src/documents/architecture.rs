//! `ARCHITECTURE.md`: its drawing of the crates beside their manifests, and its tables beside the files there are.

use super::{expanded, read, root, spans_and_links};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;

type Imports = BTreeSet<(String, String)>;

/// What the crates of the workspace import of each other: as they are used, and in their tests alone.
fn imports() -> (Imports, Imports) {
    let (mut used, mut in_tests) = (Imports::new(), Imports::new());
    for folder in fs::read_dir(root().join("crates")).expect("the crates") {
        let name = folder.expect("a crate").file_name().into_string().expect("a name in UTF-8");
        let mut section = String::new();
        for line in read(&format!("crates/{name}/Cargo.toml")).lines() {
            if line.starts_with('[') {
                line.clone_into(&mut section);
            }
            let imported = line.split(|c: char| !c.is_alphanumeric() && c != '-').next().unwrap_or_default();
            if !imported.starts_with("sphorge") {
                continue;
            }
            let pair = (name.clone(), imported.to_owned());
            match section.as_str() {
                "[dependencies]" => used.insert(pair),
                "[dev-dependencies]" => in_tests.insert(pair),
                _ => false,
            };
        }
    }
    let tests_alone = &in_tests - &used;
    (used, tests_alone)
}

/// A drawing of boxes with a name in each, and lines between them that end in arrowheads.
struct Drawing {
    rows: Vec<Vec<char>>,
    /// Name, and first and last row and column.
    boxes: Vec<(String, [usize; 4])>,
}

/// Right, down, left, up.
const WAYS: [(isize, isize); 4] = [(0, 1), (1, 0), (0, -1), (-1, 0)];

impl Drawing {
    fn new(text: &str) -> Self {
        let rows: Vec<Vec<char>> = text.lines().map(|line| line.chars().collect()).collect();
        let mut boxes = Vec::new();
        for (r, row) in rows.iter().enumerate() {
            let bars: Vec<usize> = (0..row.len()).filter(|c| row[*c] == '|').collect();
            for ends in bars.windows(2) {
                let inside: String = row[ends[0] + 1..ends[1]].iter().collect();
                if inside.trim().starts_with("sphorge") {
                    boxes.push((inside.trim().to_owned(), [r - 1, r + 1, ends[0], ends[1]]));
                }
            }
        }
        Self { rows, boxes }
    }

    fn at(&self, (r, c): (usize, usize)) -> char {
        self.rows.get(r).and_then(|row| row.get(c)).copied().unwrap_or(' ')
    }

    fn box_at(&self, (r, c): (usize, usize)) -> Option<&str> {
        let has = |[top, bottom, left, right]: [usize; 4]| (top..=bottom).contains(&r) && (left..=right).contains(&c);
        self.boxes.iter().find(|(_, edges)| has(*edges)).map(|(name, _)| name.as_str())
    }

    /// The ways on which a line goes on from a place.
    fn open(&self, place: (usize, usize)) -> &'static [usize] {
        match self.at(place) {
            _ if self.box_at(place).is_some() => &[],
            '-' => &[0, 2],
            '|' => &[1, 3],
            '+' => &[0, 1, 2, 3],
            '<' => &[0],
            '^' => &[1],
            '>' => &[2],
            'v' => &[3],
            _ => &[],
        }
    }

    fn beside((r, c): (usize, usize), way: usize) -> Option<(usize, usize)> {
        Some((r.checked_add_signed(WAYS[way].0)?, c.checked_add_signed(WAYS[way].1)?))
    }

    /// From every box at a line to every box at its arrowheads.
    fn arrows(&self) -> Imports {
        let (mut seen, mut arrows) = (BTreeSet::new(), Imports::new());
        let places = (0..self.rows.len()).flat_map(|r| (0..self.rows[r].len()).map(move |c| (r, c)));
        for start in places {
            let (mut from, mut to, mut left) = (Vec::new(), Vec::new(), vec![start]);
            while let Some(place) = left.pop() {
                if !seen.insert(place) {
                    continue;
                }
                for way in self.open(place) {
                    let Some(next) = Self::beside(place, *way) else { continue };
                    let is_arrowhead = matches!(self.at(place), '<' | '>' | '^' | 'v');
                    if let Some(name) = self.box_at(next)
                        && !is_arrowhead
                    {
                        from.push(name);
                    } else if self.open(next).contains(&((way + 2) % 4)) {
                        left.push(next);
                    }
                    if is_arrowhead {
                        let head = Self::beside(place, (way + 2) % 4).and_then(|head| self.box_at(head));
                        to.extend(head);
                    }
                }
            }
            arrows.extend(from.iter().flat_map(|a| to.iter().map(|b| ((*a).to_owned(), (*b).to_owned()))));
        }
        arrows
    }
}

#[test]
fn arrows_of_a_drawing() {
    let text = "+-----------+    +-----------+\n\
                | sphorge-a |-+->| sphorge-b |\n\
                +-----------+ |  +-----------+\n\
                \u{20}     |       |        |\n\
                \u{20}     v       |        |\n\
                +-----------+ |        |\n\
                | sphorge-c |<+        |\n\
                +-----------+<---------+\n";
    let pair = |a: &str, b: &str| (format!("sphorge-{a}"), format!("sphorge-{b}"));
    assert_eq!(Drawing::new(text).arrows(), Imports::from([pair("a", "b"), pair("a", "c"), pair("b", "c")]));
}

#[test]
fn the_drawing_of_the_crates_is_that_of_their_manifests() {
    let text = read("ARCHITECTURE.md");
    let (used, in_tests) = imports();
    let drawing = text.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a drawing");
    assert_eq!(Drawing::new(drawing).arrows(), used, "imports of crates");
    // The table beside it has every crate, and what their tests import.
    let rows = text.lines().filter(|line| line.starts_with("| `crates/")).map(|line| line.split('|').map(str::trim));
    let rows: BTreeMap<String, String> = rows
        .filter_map(|mut cells| {
            let name = cells.nth(1)?.trim_matches('`').strip_prefix("crates/")?.trim_end_matches('/').to_owned();
            Some((name, cells.nth(1)?.to_owned()))
        })
        .collect();
    let split = |imported: &str| imported.split(", ").filter(|s| !s.is_empty()).map(str::to_owned).collect::<Vec<_>>();
    let stated = rows.iter().flat_map(|(name, imported)| split(imported).into_iter().map(move |of| (name.clone(), of)));
    assert_eq!(stated.collect::<Imports>(), in_tests, "imports of tests");
    let folders = fs::read_dir(root().join("crates")).expect("the crates");
    let folders: BTreeSet<String> = folders.map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(rows.into_keys().collect::<BTreeSet<_>>(), folders);
}

#[test]
fn the_map_names_every_file_of_the_laws_and_of_the_engines_that_must_follow_them() {
    let (spans, _) = spans_and_links(&expanded(&read("ARCHITECTURE.md")));
    // They hold what all others use, or only declare them.
    const NOT_TO_CHANGE: [&str; 8] =
        ["lib.rs", "mod.rs", "dimension.rs", "history.rs", "parameter.rs", "real.rs", "tensor.rs", "test_cloud.rs"];
    let mut files = 0;
    for folder in ["crates/sphorge-physics/src", "crates/sphorge-oracle/src", "crates/sphorge-gpu/src/engine/kernels"] {
        for file in fs::read_dir(root().join(folder)).expect("a folder") {
            let name = file.expect("a file").file_name().into_string().expect("a name in UTF-8");
            // What is in the folder of a module is named with the module.
            let path = format!("{folder}/{}", name.trim_end_matches(".rs"));
            let is_named = spans.iter().any(|span| {
                span.strip_prefix(&path).is_some_and(|rest| rest.starts_with('/') || rest.starts_with(".rs"))
            });
            assert!(is_named || NOT_TO_CHANGE.contains(&name.as_str()), "ARCHITECTURE.md does not name {path}");
            files += 1;
        }
    }
    assert!(files > 60, "{files}");
}

#[test]
fn the_map_is_short() {
    let text = read("ARCHITECTURE.md");
    assert!(text.lines().count() < 200, "a map that is longer is not read: explain in docs/design.md");
    for row in text.lines().filter(|line| line.starts_with('|')) {
        let words = row.split_whitespace().filter(|word| *word != "|").count();
        assert!(words <= 60, "{words} words: {row}");
    }
}
