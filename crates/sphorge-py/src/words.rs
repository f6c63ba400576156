//! Texts of the command line in the words of Python: `--overwrite` is `overwrite=True`.

use sphorge::deck::names_like;

/// Options without a value.
const FLAGS: [&str; 6] = ["overwrite", "checkpoint-at-end", "section", "animate", "mirror", "measures"];
/// Options that the functions of Python do not have.
const ELSEWHERE: [&str; 4] = ["no-lock", "strict", "quick", "resume"];

/// The same for what a process of the command line has told.
#[pyo3::pyfunction]
pub(crate) fn words(text: &str) -> String {
    of_python(text)
}

/// `did you mean ...? `, if a name is like some of these, else nothing.
#[pyo3::pyfunction]
pub(crate) fn did_you_mean(name: &str, names: Vec<String>) -> String {
    sphorge::deck::did_you_mean(names_like(name, names.iter().map(String::as_str)))
}

/// A text with all options in it, which are in backticks, as arguments of functions.
pub(crate) fn of_python(text: &str) -> String {
    // What there is no argument for.
    let text = text.replace("`--from` below `--to`", "the lower speed of `between` first");
    let text = text.replace("pass `--no-lock`", "remove the file `.sphorge-lock` in the folder").replace(
        "build the program with `cargo build --release --features gpu`, or the package for Python with",
        "build the package with",
    );
    let mut parts = text.split('`');
    let mut told = parts.next().unwrap_or_default().to_owned();
    let mut is_code = true;
    for part in parts {
        told.push('`');
        told.push_str(&match is_code.then(|| argument(part)).flatten() {
            Some(argument) => argument,
            None => part.to_owned(),
        });
        is_code = !is_code;
    }
    told
}

/// An option with its value as an argument, or a command as what does the same.
fn argument(code: &str) -> Option<String> {
    match code {
        "sphorge run" => return Some("sphorge.Simulation".to_owned()),
        "sphorge resume" => return Some("sphorge.Simulation.resume".to_owned()),
        "sphorge decks" => return Some("sphorge.decks".to_owned()),
        "sphorge materials" => return Some("sphorge.materials".to_owned()),
        "sphorge check" => return Some("deck.check()".to_owned()),
        "sphorge plot" => return Some("run.plot".to_owned()),
        _ => {}
    }
    if let Some(folder) = code.strip_prefix("sphorge resume ") {
        return Some(format!("sphorge.Simulation.resume(\"{folder}\")"));
    }
    if let Some(place) = code.strip_prefix("-o") {
        return place
            .is_empty()
            .then(|| "out".to_owned())
            .or_else(|| place.starts_with(' ').then(|| "out=...".to_owned()));
    }
    let option = code.strip_prefix("--").filter(|option| option.starts_with(|c: char| c.is_ascii_lowercase()))?;
    let (name, value) = match option.find([' ', '=']) {
        Some(at) => (&option[..at], Some(option[at + 1..].trim())),
        None => (option, None),
    };
    if ELSEWHERE.contains(&name) {
        return Some(format!("sphorge ... {code}"));
    }
    // Names that are words of the language.
    let keyword = if matches!(name, "from" | "to") { "between".to_owned() } else { name.replace('-', "_") };
    Some(match value {
        None if FLAGS.contains(&name) => format!("{keyword}=True"),
        None => keyword,
        Some(value) => match (name, value.split_once('=')) {
            ("set", Some((key, "..."))) => format!("set={{\"{key}\": ...}}"),
            ("set", Some((key, value))) => format!("set={{\"{key}\": {}}}", quoted(value)),
            ("vary", Some((key, values))) => {
                let values: Vec<_> = values.trim_matches('"').split(',').map(quoted).collect();
                format!("{{\"{key}\": [{}]}}", values.join(", "))
            }
            _ if value.starts_with('<') => keyword,
            _ if value.contains(',') => {
                format!("{keyword}=[{}]", value.split(',').map(quoted).collect::<Vec<_>>().join(", "))
            }
            _ => format!("{keyword}={}", quoted(value)),
        },
    })
}

/// A value of an option as one of Python: numbers and names for values stay.
fn quoted(value: &str) -> String {
    let value = value.trim().trim_matches('"');
    let stays =
        value.parse::<f64>().is_ok() || value.chars().all(|c| c.is_ascii_uppercase() || matches!(c, '.' | '{' | '}'));
    if stays { value.to_owned() } else { format!("\"{value}\"") }
}
