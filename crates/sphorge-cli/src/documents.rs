//! Tests that keep the documents true: the paths they name exist, the commands they show parse.

mod architecture;

use crate::arguments::Arguments;
use clap::{CommandFactory, Parser};
use std::{
    fs,
    path::{Path, PathBuf},
};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Code spans and link targets of a Markdown text, fenced blocks left out.
fn spans_and_links(text: &str) -> (Vec<String>, Vec<String>) {
    let prose: String = text.split("```").step_by(2).collect();
    let spans = prose.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    let links = prose.split("](").skip(1).filter_map(|rest| rest.split(')').next()).map(str::to_owned).collect();
    (spans, links)
}

/// The text with the paths in its tables as they are from the top of the repository: in a column whose heading names a folder, they
/// start there, unless they are at the top.
fn expanded(text: &str) -> String {
    let (mut folders, mut is_inside) = (Vec::new(), false);
    let mut lines = Vec::new();
    for line in text.lines() {
        let is_row = line.starts_with('|');
        let cells: Vec<Vec<&str>> = line.split('|').map(|cell| cell.split('`').collect()).collect();
        if is_row && !is_inside {
            folders = cells.iter().map(|cell| cell.get(1).copied().filter(|span| span.ends_with('/'))).collect();
        }
        let cell = |(column, cell): (usize, &Vec<&str>)| {
            let folder = folders.get(column).copied().flatten().filter(|_| is_row && is_inside);
            let span = |(k, part): (usize, &&str)| match folder {
                Some(folder) if k % 2 == 1 && is_path(part) && !root().join(part).exists() => format!("{folder}{part}"),
                _ => (*part).to_owned(),
            };
            cell.iter().enumerate().map(span).collect::<Vec<_>>().join("`")
        };
        lines.push(cells.iter().enumerate().map(cell).collect::<Vec<_>>().join("|"));
        is_inside = is_row;
    }
    lines.join("\n")
}

/// Pages of the user guide.
fn guide() -> Vec<String> {
    let files = fs::read_dir(root().join("docs/guide")).expect("the guide");
    let names = files.map(|file| file.expect("a page").file_name().into_string().expect("a name in UTF-8"));
    let pages: Vec<_> = names.map(|name| format!("docs/guide/{name}")).chain(["docs/README.md".to_owned()]).collect();
    assert!(pages.len() > 6, "{pages:?}");
    pages
}

/// Whether a code span is meant as a file or folder of the repository: by its ending, and not one a run writes.
fn is_path(span: &str) -> bool {
    let made_by_a_run = ["out/", "DIR/", "fields/", "plots/", "fields.pvd", "deck.toml", "my.toml"];
    let named = [".rs", ".toml", ".md", ".py", ".png", ".ttf"].iter().any(|ending| span.ends_with(ending));
    (named || span.ends_with('/'))
        && !span.contains(char::is_whitespace)
        && !made_by_a_run.iter().any(|own| span.starts_with(own))
}

#[test]
fn every_path_in_the_documents_exists() {
    for document in ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "AGENTS.md", "docs/design.md"] {
        let (spans, links) = spans_and_links(&expanded(&read(document)));
        let mut missing: Vec<_> =
            spans.iter().filter(|span| is_path(span)).filter(|span| !root().join(span.as_str()).exists()).collect();
        missing.extend(links.iter().filter(|link| !link.contains("://") && !leads_somewhere(document, link)));
        assert!(missing.is_empty(), "{document} names what is not there: {missing:?}");
    }
}

/// The anchors of the headings of a Markdown text, as GitHub and mdbook make them.
fn anchors(text: &str) -> Vec<String> {
    let prose = text.split("```").step_by(2).flat_map(str::lines);
    let headings = prose.filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    headings.map(|heading| heading.to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")).collect()
}

/// Whether a page has a file beside it, and a heading in that file, to which it links.
fn leads_somewhere(page: &str, link: &str) -> bool {
    let (file, heading) = link.split_once('#').unwrap_or((link, ""));
    let path = root().join(page);
    let target = if file.is_empty() { path } else { path.with_file_name(file) };
    target.exists()
        && (heading.is_empty() || anchors(&fs::read_to_string(target).unwrap()).contains(&heading.to_owned()))
}

#[test]
fn every_link_of_the_book_leads_to_a_page_and_a_heading() {
    let files = fs::read_dir(root().join("docs")).expect("the book");
    let names = files.map(|file| file.expect("a page").file_name().into_string().expect("a name in UTF-8"));
    let pages = names.filter(|name| name.ends_with(".md")).map(|name| format!("docs/{name}"));
    let pages: std::collections::BTreeSet<String> = pages.chain(guide()).collect();
    let mut links = 0;
    for page in &pages {
        for link in spans_and_links(&read(page)).1.iter().filter(|link| !link.contains("://")) {
            assert!(leads_somewhere(page, link), "{page}: {link}: no such file, or no such heading in it");
            links += 1;
        }
    }
    assert!(links > 80, "{links}");
}

#[test]
fn the_gallery_has_every_shipped_deck_as_it_is_with_its_pictures() {
    let text = read("docs/guide/gallery.md");
    for deck in sphorge::decks::DECKS {
        let section = text.split(&format!("\n## {}\n", deck.name)).nth(1).unwrap_or_else(|| panic!("no {}", deck.name));
        let section = section.split("\n## ").next().unwrap_or_default();
        let shown = section.split("```toml\n").nth(1).and_then(|rest| rest.split("\n```").next());
        assert_eq!(shown, Some(deck.text.trim_end()), "{}: make the gallery again with scripts/gallery.py", deck.name);
        assert!(section.contains(&format!("sphorge run {}\n", deck.name)) || section.contains("Coarser than shipped"));
        for picture in [format!("{}.webp", deck.name), format!("{}-moving.webp", deck.name)] {
            let path = root().join("docs/images/gallery").join(&picture);
            let bytes = fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            assert!(bytes.starts_with(b"RIFF") && bytes[8..12] == *b"WEBP" && section.contains(&picture));
        }
    }
}

#[test]
fn the_theory_names_the_code_of_every_law() {
    let text = read("docs/theory.md");
    let (spans, _) = spans_and_links(&text);
    let sources = ["crates/sphorge-physics/src", "crates/sphorge-engine/src"].map(|base| root().join(base));
    let mut named = Vec::new();
    for (file, item) in spans.iter().filter_map(|span| span.split_once("::")) {
        let found = sources.iter().find_map(|base| fs::read_to_string(base.join(file)).ok());
        let code = found.unwrap_or_else(|| panic!("there is no file {file}"));
        let declares = |keyword: &str| {
            code.split(&format!("{keyword} {item}"))
                .skip(1)
                .any(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        };
        assert!(["fn", "struct", "trait"].into_iter().any(declares), "{file} has no `{item}`");
        named.push(file.to_owned());
    }
    // Equations are numbered without gaps.
    let numbers = text.lines().filter_map(|line| line.strip_prefix('(')?.split_once(')')?.0.parse().ok());
    let numbers: Vec<usize> = numbers.collect();
    assert!(numbers.len() > 30 && numbers.iter().copied().eq(1..=numbers.len()), "{numbers:?}");
    // No file of formulas is left out; these hold none, or none of their own.
    const NO_FORMULAS: [&str; 10] = [
        "lib.rs",
        "mod.rs",
        "dimension.rs",
        "history.rs",
        "parameter.rs",
        "real.rs",
        "tensor.rs",
        "tests.rs",
        "test_law.rs",
        "test_cloud.rs",
    ];
    let mut folders = vec![sources[0].clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            let short = path.strip_prefix(&sources[0]).unwrap().to_str().unwrap();
            if path.is_dir() {
                folders.push(path);
            } else if !NO_FORMULAS.contains(&name) {
                assert!(named.iter().any(|file| file == short), "docs/theory.md does not name {short}");
            }
        }
    }
}

/// Words of a shell line; quotes group, a comment ends it.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in line.chars() {
        match (c, quote) {
            (c, Some(q)) if c == q => quote = None,
            ('"' | '\'', None) => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            ('#', None) if word.is_none() => break,
            (c, None) if c.is_whitespace() => words.extend(word.take()),
            (c, _) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

/// Arguments of `sphorge` in a shell line, through `cargo run` or not; redirections left out.
fn arguments(line: &str) -> Option<Vec<String>> {
    let words = words(line);
    let own = match words.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["sphorge", ..] => words[1..].to_vec(),
        ["cargo", "run", "--release", "--", ..] => words[4..].to_vec(),
        ["cargo", "run", "--release", "--features", "gpu" | "mpi" | "gpu,mpi", "--", ..] => words[6..].to_vec(),
        ["mpirun", "-n", _, "sphorge", ..] => words[4..].to_vec(),
        _ => return None,
    };
    Some(own.into_iter().take_while(|word| !matches!(word.as_str(), ">" | "|")).collect())
}

fn assert_parses(line: &str, arguments: Vec<String>) {
    let words = std::iter::once("sphorge".to_owned()).chain(arguments);
    if let Err(error) = Arguments::try_parse_from(words) {
        panic!("`{line}` does not parse: {error}");
    }
}

#[test]
fn every_deck_in_the_guide_can_be_run() {
    let mut decks = 0;
    for page in guide().into_iter().chain(["README.md".to_owned()]) {
        let text = read(&page);
        let fenced = text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
        // The others show parts of decks.
        for deck in fenced.filter(|deck| deck.starts_with("title =")) {
            if let Err(report) = sphorge::deck::load_text("guide", deck, &[]) {
                panic!("{page}: a deck cannot be run: {:?}\n{deck}", report.problems());
            }
            decks += 1;
        }
    }
    assert!(decks >= 3, "{decks}");
}

#[test]
fn every_command_in_the_documents_parses() {
    let others = [
        "README.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
        "AGENTS.md",
        "docs/adaptive-search.md",
        "docs/cluster.md",
        "docs/gpu.md",
        "docs/validation.md",
        "docs/warnings.md",
    ];
    for document in others.map(str::to_owned).into_iter().chain(guide()) {
        for line in read(&document).split("```sh").skip(1).flat_map(|s| s.split("```").next()).flat_map(str::lines) {
            match arguments(line) {
                Some(arguments) => assert_parses(line, arguments),
                None => assert!(is_known_shell(&words(line)), "{document}: what does `{line}` run?"),
            }
        }
    }
}

#[test]
fn the_page_of_warnings_has_every_check_with_its_limit() {
    use sphorge::model::WarningKind;
    let text = read("docs/warnings.md");
    // The tables of decks and notes are those of crates/sphorge/tests/warnings.rs.
    let checks = text.split("\n## ").find(|section| section.starts_with("The checks\n")).expect("a section of checks");
    let rows: Vec<Vec<&str>> = checks
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    let found: Vec<(&str, f64, bool)> = rows
        .iter()
        .map(|row| {
            let mut words = row[3].split(' ');
            let is_floor = words.next() == Some("below");
            (row[1].trim_matches('`'), words.next().unwrap().parse().unwrap(), is_floor)
        })
        .collect();
    let wanted = WarningKind::ALL.map(|kind| (kind.name(), kind.info().limit, kind.info().is_floor));
    assert_eq!(found, wanted);
}

/// Shell lines that are not ours to parse, with the paths in them that must exist.
fn is_known_shell(words: &[String]) -> bool {
    match words.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] | ["git", "clone", ..] | ["cd", ..] | ["paraview", ..] | ["pip", "install", ..] => true,
        ["cargo", "test", "--workspace"] | ["cargo", "clippy", ..] | ["cargo", "doc", ..] => true,
        ["cargo", "build", "--release", "--features", "gpu" | "mpi"] => true,
        ["cargo", "test" | "mutants", "-p", package, ..] => root().join("crates").join(package).exists(),
        ["mdbook", "build", folder] => root().join(folder).join("book.toml").exists(),
        ["cargo", "install", "--path", path] => root().join(path).join("Cargo.toml").exists(),
        [variable, rest @ ..] if variable.contains('=') && !rest.is_empty() => is_known_shell(&words[1..]),
        [script] | ["python3", script, ..] => root().join(script).exists(),
        [script @ ("scripts/cuda_stand_in.sh" | "scripts/fuzz.sh" | "scripts/measure_gpu.sh"), ..] => {
            root().join(script).exists()
        }
        _ => false,
    }
}

#[test]
fn every_example_in_the_help_parses() {
    let mut commands = vec![Arguments::command()];
    commands.extend(Arguments::command().get_subcommands().cloned());
    let mut examples = 0;
    for command in commands {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        for line in help.lines().filter(|line| line.starts_with("  sphorge ")) {
            // What an example is for stands behind it, set off by several spaces.
            let line = line.trim().split("   ").next().unwrap_or_default();
            assert_parses(line, arguments(line).unwrap_or_default());
            examples += 1;
        }
    }
    assert!(examples > 10, "only {examples} examples found");
}

#[test]
fn the_command_line_is_well_formed() {
    Arguments::command().debug_assert();
}

#[test]
fn shell_words() {
    let line = r#"sphorge run a.toml --set 'x="1 mm"' --set y="2 mm"  # why"#;
    assert_eq!(words(line), ["sphorge", "run", "a.toml", "--set", r#"x="1 mm""#, "--set", "y=2 mm"]);
    assert_eq!(arguments("sphorge schema > deck.json"), Some(vec!["schema".to_owned()]));
}
