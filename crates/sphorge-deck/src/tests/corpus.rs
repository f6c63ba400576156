//! The folder `corpus`: decks that cannot be run, each with what a user is told of it beside it, to be read in a review. After a change,
//! `UPDATE_CORPUS=1 cargo test -p sphorge-deck --lib corpus` writes it anew.
//!
//! Lines of a deck that begin with `#set ` are given as `--set`.

use crate::fault::sites;
use crate::load;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Particles that fit the memory of the machine that would run the decks.
const MOST_PARTICLES: f64 = 1e6;

/// Faults that no deck has.
const OF_NO_DECK: [&str; 4] = [
    // Files that cannot be read; told by the tests of the command line.
    "\"unreadable\"",
    // Bad input that would be ours.
    "\"internal\"",
    // What makes the faults of values and keys, which count where they are told.
    "Fault::new(code, expected",
    "Fault::new(\"unknown-key\", self.message",
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus")
}

/// Files of a folder with this extension, by their names.
fn files(folder: &Path, extension: &str) -> BTreeMap<String, PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let chosen = entries.filter(|path| path.extension().is_some_and(|found| found == extension));
    chosen.map(|path| (path.file_stem().unwrap().to_str().unwrap().to_owned(), path)).collect()
}

/// What the program says of a deck, on a terminal of 100 columns without colours.
fn told(name: &str, deck: &str) -> String {
    let set = |line: &str| {
        let (path, value) = line.strip_prefix("#set ")?.split_once('=').unwrap();
        Some((path.trim().to_owned(), value.trim().to_owned()))
    };
    let overrides: Vec<_> = deck.lines().filter_map(set).collect();
    let report = match load::read(&format!("{name}.toml"), name, deck, Some(&folder()), &overrides, MOST_PARTICLES) {
        Ok(_) => panic!("no fault is found in {name}.toml"),
        Err(report) => report,
    };
    let theme = miette::GraphicalTheme::unicode_nocolor();
    let mut text = String::new();
    let handler = miette::GraphicalReportHandler::new_themed(theme).with_width(100);
    let handler = handler.with_word_separator(textwrap::WordSeparator::AsciiSpace);
    let handler = handler.with_word_splitter(textwrap::WordSplitter::NoHyphenation);
    handler.render_report(&mut text, &report).unwrap();
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    lines.join("\n").trim_start_matches('\n').to_owned() + "\n"
}

/// Every line of the sources that tells of a fault.
fn all_sites(folder: &Path, found: &mut BTreeMap<(String, u32), String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("tests") {
            all_sites(&path, found);
        }
        if path.extension().is_none_or(|extension| extension != "rs") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let sources = text.split("\n#[cfg(test)]\nmod tests").next().unwrap();
        let lines: Vec<&str> = sources.lines().collect();
        for (k, line) in lines.iter().enumerate() {
            let is_site =
                ["Fault::new(", ".fault(", "placeless(", ".error(", "refused("].iter().any(|s| line.contains(s));
            // The code may stand on the next line.
            let code = format!("{} {}", line.trim(), lines.get(k + 1).map_or("", |next| next.trim()));
            if is_site && !line.contains("fn ") && !OF_NO_DECK.iter().any(|known| code.contains(known)) {
                found.insert((place(&path), k as u32 + 1), line.trim().to_owned());
            }
        }
    }
}

/// A source file, from the folder of the sources.
fn place(path: &Path) -> String {
    let text = path.to_str().unwrap().replace('\\', "/");
    text.rsplit_once("sphorge-deck/src/").map_or(text.clone(), |(_, file)| file.to_owned())
}

#[test]
fn what_is_told_of_bad_decks_is_what_was_read_in_a_review() {
    let is_update = std::env::var_os("UPDATE_CORPUS").is_some();
    let (decks, mut texts) = (files(&folder(), "toml"), files(&folder(), "txt"));
    let mut changed = Vec::new();
    for (name, path) in &decks {
        let told = told(name, &fs::read_to_string(path).unwrap());
        let expected = texts.remove(name).map(|path| fs::read_to_string(path).unwrap().replace("\r\n", "\n"));
        if expected.as_ref() == Some(&told) {
            continue;
        }
        if is_update {
            fs::write(path.with_extension("txt"), &told).unwrap();
        }
        changed.push(format!("{name}.txt was\n{}\nand is\n{told}", expected.unwrap_or_default()));
    }
    assert!(texts.is_empty(), "without a deck: {texts:?}");
    assert!(is_update || changed.is_empty(), "{}\nUPDATE_CORPUS=1 writes them anew", changed.join("\n"));

    let seen: BTreeSet<_> = sites::seen().into_iter().map(|(file, line)| (place(Path::new(&file)), line)).collect();
    let mut unseen = BTreeMap::new();
    all_sites(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut unseen);
    assert!(unseen.len() > 100, "{unseen:?}");
    unseen.retain(|site, _| !seen.contains(site));
    let lines: Vec<_> = unseen.iter().map(|((file, line), text)| format!("src/{file}:{line}: {text}")).collect();
    assert!(lines.is_empty(), "no deck of the corpus is told of\n{}", lines.join("\n"));
}
