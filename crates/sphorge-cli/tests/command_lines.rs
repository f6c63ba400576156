//! The folder `command_lines`: command lines that ask for what cannot be, each with what a user is told, to be read in a review. After a
//! change, `UPDATE_CORPUS=1 cargo test -p sphorge-cli --test command_lines` writes it anew.
//!
//! The first line of a file is the command, its arguments apart by blanks or in single quotes; in it `\xNN` is a byte, and
//! `{TEXT*N}` a text N times. What only programs without a feature say is in a folder of its own.
#![cfg(unix)]

mod common;

use common::Place;
use std::{
    ffi::OsString,
    fs,
    os::unix::ffi::OsStringExt,
    path::{Path, PathBuf},
};

/// The arguments of a line.
fn arguments(line: &str) -> Vec<OsString> {
    let mut arguments = Vec::new();
    let mut current: Option<Vec<u8>> = None;
    let mut is_quoted = false;
    let mut rest = line.chars();
    while let Some(c) = rest.next() {
        match c {
            '\'' => {
                is_quoted = !is_quoted;
                current.get_or_insert_default();
            }
            ' ' if !is_quoted => arguments.extend(current.take().map(OsString::from_vec)),
            '\\' if rest.as_str().starts_with('x') => {
                let digits: String = rest.by_ref().skip(1).take(2).collect();
                current.get_or_insert_default().push(u8::from_str_radix(&digits, 16).expect("two digits"));
            }
            '{' if is_repeated(rest.as_str()) => {
                let inner: String = rest.by_ref().take_while(|&c| c != '}').collect();
                let (text, count) = inner.rsplit_once('*').expect("a text and a number");
                current.get_or_insert_default().extend(text.repeat(count.parse().expect("a number")).bytes());
            }
            c => current.get_or_insert_default().extend(c.to_string().bytes()),
        }
    }
    arguments.extend(current.map(OsString::from_vec));
    arguments
}

/// Whether `TEXT*N}` follows.
fn is_repeated(rest: &str) -> bool {
    let inner = rest.split_once('}').and_then(|(inner, _)| inner.rsplit_once('*'));
    inner.is_some_and(|(_, count)| !count.is_empty() && count.bytes().all(|b| b.is_ascii_digit()))
}

/// What is told of a command, and how it ends.
fn told(line: &str, place: &Place) -> String {
    let arguments = arguments(line.strip_prefix("$ sphorge").expect("a command of sphorge"));
    let output = place.command(&[]).args(arguments).output().expect("the program starts");
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(!err.contains("panicked"), "{line}: {err}");
    assert!(out.is_empty(), "{line} prints: {out}");
    let lines: Vec<&str> = err.lines().map(str::trim_end).collect();
    assert!(err.len() < 3000 && lines.iter().all(|line| !line.contains(char::is_control)), "{line}: {err:?}");
    format!("{line}\n(exit code {})\n{}\n", output.status.code().unwrap_or(-1), lines.join("\n"))
}

#[test]
fn what_is_told_of_bad_command_lines_is_what_was_read_in_a_review() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command_lines");
    let files_in = |folder: PathBuf| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = files_in(folder.clone()).filter(|path| path.is_file()).collect();
    for (without, has) in [("without-gpu", common::has_gpu()), ("without-mpi", common::has_mpi())] {
        files.extend(files_in(folder.join(without)).filter(|_| !has));
    }
    files.sort();
    assert!(files.len() > 20);
    let place = Place::new();
    fs::write(place.path("no-text.toml"), b"title = \"\xff\xfe\"\n").unwrap();
    fs::write(place.path("long-line.toml"), format!("title = \"{}\n", "a".repeat(1_000_000))).unwrap();
    fs::create_dir(place.path("folder")).unwrap();
    fs::create_dir(place.path("decks-here")).unwrap();
    fs::write(place.path("decks-here/one.toml"), "title = \"one\"\n").unwrap();
    fs::write(place.path("decks-here/two.toml"), "title = \"two\"\n").unwrap();
    place.run(&["run", "heat-slab", "--set", "time.max-steps=2", "-o", "runs/bar", "--quiet"]).expect_code(0);
    place.run(&["run", "heat-slab", "--set", "time.max-steps=2", "-o", "a-run", "--quiet"]).expect_code(0);
    // As a run that was killed before its first checkpoint leaves it.
    place.run(&["run", "heat-slab", "--set", "time.max-steps=2", "-o", "killed", "--quiet"]).expect_code(0);
    fs::remove_file(place.path("killed/summary.json")).unwrap();
    let mut changed = Vec::new();
    for path in files {
        let expected = fs::read_to_string(&path).unwrap();
        let told = told(expected.lines().next().expect("a command"), &place);
        if told != expected {
            changed.push(format!("{} was\n{expected}\nand is\n{told}", path.display()));
            if std::env::var_os("UPDATE_CORPUS").is_some() {
                fs::write(&path, told).unwrap();
            }
        }
        assert!(!place.path("out").exists(), "{} leaves something behind", path.display());
    }
    let is_update = std::env::var_os("UPDATE_CORPUS").is_some();
    assert!(is_update || changed.is_empty(), "{}\nUPDATE_CORPUS=1 writes them anew", changed.join("\n"));
}
