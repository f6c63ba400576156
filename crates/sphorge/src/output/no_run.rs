//! What lies where the folder of a run was expected, and which folder may be meant.

use super::{
    RunDirectory,
    directory::{DECK, FILES},
};
use sphorge_deck::{did_you_mean, names_like};
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// Most runs that are listed.
const MOST_LISTED: usize = 8;
/// Where commands put runs unless they are told otherwise.
const USUAL: &str = "out";

/// What is there, in words that end a sentence, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoRun {
    what: String,
    help: String,
}

impl NoRun {
    /// What is there.
    pub(super) fn what(&self) -> &str {
        &self.what
    }

    /// What to do.
    pub(super) fn help(&self) -> &str {
        &self.help
    }

    /// Looks at a path; nothing where the folder of a run is there, or what cannot be looked at.
    pub(super) fn at(path: &Path) -> Option<Self> {
        match fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => {
                (!looks_like_a_run(path) && fs::read_dir(path).is_ok()).then(|| Self::of_folder(path))
            }
            Ok(_) => Some(Self::of_file(path)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Some(Self { what: "it does not exist".to_owned(), help: Self::near(path) })
            }
            Err(_) => None,
        }
    }

    fn of_file(path: &Path) -> Self {
        if let Some(run) = run_around(path) {
            let what = format!("it is a file of the run in {}", run.display());
            return Self { what, help: format!("give the folder: {}", run.display()) };
        }
        let is_deck = path.extension().is_some_and(|ending| ending == "toml");
        let what = "it is a file".to_owned();
        let name = path.file_stem().map(Path::new).unwrap_or(path);
        let mut runs = runs_in(&path.with_file_name(USUAL));
        runs.retain(|run| run.file_name() == Some(name.as_os_str()));
        let help = match &runs[..] {
            [run] if is_deck => format!("runs are folders: the one of this deck may be {}", run.display()),
            _ if is_deck => {
                format!("runs are folders: `sphorge run {}` makes one, out/{}", path.display(), name.display())
            }
            _ => Self::near(path),
        };
        Self { what, help }
    }

    fn of_folder(path: &Path) -> Self {
        if let Some(run) = run_around(path) {
            return Self {
                what: format!("it is a folder in that of the run in {}", run.display()),
                help: format!("give the folder of the run: {}", run.display()),
            };
        }
        let mut runs = runs_in(path);
        if runs.is_empty() {
            runs = runs_in(&path.join(USUAL));
        }
        let what = "it is a folder that no run has written".to_owned();
        Self {
            what,
            help: if runs.is_empty() {
                Self::near(path)
            } else {
                format!("give one of the runs in it: {}", list(&runs))
            },
        }
    }

    /// Runs beside a path, and where commands put them.
    fn near(path: &Path) -> String {
        let above = path.parent().filter(|above| !above.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut runs = runs_in(above);
        runs.extend(runs_in(Path::new(USUAL)));
        runs.retain(|run| run != path);
        runs.sort();
        runs.dedup();
        let paths: Vec<String> = runs.iter().map(|run| run.display().to_string()).collect();
        let name = |path: &str| {
            Path::new(path).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        };
        let names: Vec<String> = paths.iter().map(|path| name(path)).collect();
        let like = names_like(&name(&path.to_string_lossy()), names.iter().map(String::as_str));
        let meant: Vec<&str> = paths
            .iter()
            .zip(&names)
            .filter(|(_, name)| like.contains(&name.as_str()))
            .map(|(path, _)| path.as_str())
            .collect();
        if !meant.is_empty() {
            return did_you_mean(meant).trim_end().to_owned();
        }
        if runs.is_empty() {
            "give the folder of a run: `sphorge run` writes to out/<deck name> unless `-o` names another".to_owned()
        } else {
            format!("give the folder of a run, such as {}", list(&runs))
        }
    }
}

/// Whether a folder has anything that a run writes.
fn looks_like_a_run(path: &Path) -> bool {
    let has_files = || FILES.iter().chain([&DECK]).any(|name| path.join(name).is_file());
    // The mark names every file of the run: it is long, and the last to be read.
    has_files() || RunDirectory::has_checkpoint_in(path) || RunDirectory::is_run(path)
}

/// The run whose folder a path is in: at most two folders above, where pieces of frames are.
fn run_around(path: &Path) -> Option<PathBuf> {
    let whole = fs::canonicalize(path).ok()?;
    let depth = whole.ancestors().skip(1).take(3).position(RunDirectory::is_run)?;
    let above = path.ancestors().nth(depth + 1).filter(|above| !above.as_os_str().is_empty());
    Some(above.map_or_else(|| whole.ancestors().nth(depth + 1).map(Path::to_owned).unwrap_or_default(), Path::to_owned))
}

/// Folders of runs right in a folder, in order.
fn runs_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut runs: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| RunDirectory::is_run(path)).collect();
    runs.iter_mut().for_each(|run| {
        if let Ok(short) = run.strip_prefix(".") {
            *run = short.to_owned();
        }
    });
    runs.sort();
    runs
}

/// Runs in a text, the first of many.
fn list(runs: &[PathBuf]) -> String {
    let few: Vec<String> = runs.iter().take(MOST_LISTED).map(|run| run.display().to_string()).collect();
    let more = runs.len().saturating_sub(MOST_LISTED);
    few.join(", ") + &if more == 0 { String::new() } else { format!(" or one of {more} more") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::OutputError;

    fn told(path: &Path) -> (String, String) {
        let Err(OutputError::NoRun { found, .. }) = RunDirectory::open(path) else {
            panic!("{} is a run", path.display())
        };
        (found.what, found.help)
    }

    #[test]
    fn what_is_no_run_is_named_with_the_run_that_may_be_meant() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        drop(RunDirectory::begin(&path("out/bar"), false, false, Some("title = 1\n")).unwrap());
        drop(RunDirectory::begin(&path("out/plate"), false, false, Some("title = 1\n")).unwrap());
        RunDirectory::open(&path("out/bar")).unwrap();
        fs::write(path("bar.toml"), "title = 1\n").unwrap();
        fs::write(path("other.toml"), "title = 1\n").unwrap();
        let names = |help: &str, run: &str| help.contains(&path(run).display().to_string());
        // A slip of the pen, and the folder above.
        let (what, help) = told(&path("out/baar"));
        assert!(what == "it does not exist" && help.starts_with("did you mean") && names(&help, "out/bar"), "{help}");
        assert!(!names(&help, "out/plate"), "{help}");
        for above in [&path("out"), folder.path()] {
            let (what, help) = told(above);
            assert!(
                what.contains("no run has written") && names(&help, "out/bar") && names(&help, "out/plate"),
                "{help}"
            );
        }
        // A deck, whether it was run or not; what is inside of a run.
        let (_, help) = told(&path("bar.toml"));
        assert!(help.starts_with("runs are folders: the one") && names(&help, "out/bar"), "{help}");
        let (_, help) = told(&path("other.toml"));
        assert!(help.contains("sphorge run") && help.contains("other.toml"), "{help}");
        for inside in ["out/bar/deck.toml", "out/bar/fields"] {
            let (what, help) = told(&path(inside));
            assert!(
                what.contains("of the run in") && help.ends_with("bar") && names(&help, "out/bar"),
                "{what} {help}"
            );
        }
    }
}
