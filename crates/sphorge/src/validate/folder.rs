//! The folder of a validation.

use super::{Report, ValidateError, earlier};
use crate::output::{
    Durability, Folder as OpenedFolder, OutputError, most, read_regular_file, remove_unfinished, write_file,
};
use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
};

/// File that marks the folder of a validation, there from the start.
const MARK: &str = "validation.txt";
/// Files of the report.
const MARKDOWN: &str = "report.md";
const HTML: &str = "report.html";
const JSON: &str = "report.json";

/// Folders in folders of a validation: case, run, frames, pieces.
const DEEPEST: usize = 4;

/// A folder this validation may write to.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folder, or takes over that of a former validation, by the same program if it is to be gone on with.
    pub(super) fn claim(path: &Path, resume: bool) -> Result<Self, ValidateError> {
        let unwritable = |source| OutputError::Unwritable { path: path.to_owned(), source };
        match fs::read_dir(path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => fs::create_dir_all(path).map_err(unwritable)?,
            Err(e) => return Err(unwritable(e).into()),
            Ok(mut entries) => {
                if entries.next().is_some() && !path.join(MARK).is_file() {
                    return Err(ValidateError::NotAValidation { path: path.to_owned() });
                }
            }
        }
        let mark = path.join(MARK);
        if resume && mark.is_file() {
            earlier::check_program(&mark)?;
        }
        let folder = Self { path: path.to_owned() };
        // What a validation that was killed was about to write, itself or in its runs and pictures.
        OpenedFolder::open(path).and_then(|opened| remove_unfinished(&opened, DEEPEST)).map_err(unwritable)?;
        // The old report does not belong to the runs that are about to replace the old ones.
        for name in [MARKDOWN, HTML, JSON] {
            match fs::remove_file(path.join(name)) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(unwritable(e).into()),
                _ => {}
            }
        }
        if resume && mark.is_file() {
            return Ok(folder);
        }
        write_file(&mark, Durability::Disk, |out| {
            let program = earlier::program().unwrap_or_else(|| "an unknown program".to_owned());
            writeln!(
                out,
                "Written by `sphorge validate` and replaced by the next validation in this folder, unless that \
                 continues it with `--resume`:"
            )?;
            writeln!(out, "{program}")
        })?;
        Ok(folder)
    }

    /// Notes in the mark that a run in a folder of this validation begins: what else is there is of another one.
    pub(super) fn note_begin(&self, run: &Path) -> Result<(), OutputError> {
        if self.has_begun(run) {
            return Ok(());
        }
        let path = self.path.join(MARK);
        let unwritable = |source| OutputError::Unwritable { path: path.clone(), source };
        let mut mark =
            OpenedFolder::open(&self.path).and_then(|folder| folder.open_to_append(MARK)).map_err(unwritable)?;
        writeln!(mark, "{}", self.relative(run)).map_err(unwritable)
    }

    /// Whether this validation has begun the run in a folder.
    pub(super) fn has_begun(&self, run: &Path) -> bool {
        let mark = read_regular_file(&self.path.join(MARK), most::TEXT).unwrap_or_default();
        String::from_utf8_lossy(&mark).lines().any(|line| line == self.relative(run))
    }

    /// Folder of a run.
    pub(super) fn run(&self, case: &str, label: &str) -> PathBuf {
        self.path.join(case).join(slug(label))
    }

    /// Folder of the pictures of a case.
    pub(super) fn pictures(&self, case: &str) -> PathBuf {
        self.path.join(case).join("pictures")
    }

    /// A path inside, relative to the report.
    pub(super) fn relative(&self, path: &Path) -> String {
        let inside = path.strip_prefix(&self.path).unwrap_or(path);
        inside.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
    }

    /// Writes the report in its three forms.
    pub(super) fn write(&self, report: &Report) -> Result<(), OutputError> {
        let text = |name: &str, text: String| {
            write_file(&self.path.join(name), Durability::Disk, |out| out.write_all(text.as_bytes()))
        };
        text(MARKDOWN, report.markdown())?;
        text(HTML, report.html(&|file| read_regular_file(&self.path.join(file), most::PICTURE).ok()))?;
        write_file(&self.path.join(JSON), Durability::Disk, |out| {
            serde_json::to_writer_pretty(&mut *out, report)?;
            out.write_all(b"\n")
        })?;
        Ok(())
    }
}

/// A label as the name of a folder.
pub(super) fn slug(label: &str) -> String {
    let keep = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c.to_ascii_lowercase() } else { '-' };
    let mut name = String::new();
    for c in label.chars().map(keep) {
        if c != '-' || !name.ends_with('-') {
            name.push(c);
        }
    }
    name.trim_matches('-').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_become_names_of_folders() {
        assert_eq!(slug("plain sums, 0.4 mm"), "plain-sums-0.4-mm");
        assert_eq!(slug("Leapfrog"), "leapfrog");
    }

    #[test]
    fn a_folder_of_something_else_is_refused_and_a_former_validation_is_replaced() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("validate");
        Folder::claim(&path, false).unwrap();
        fs::write(path.join("report.md"), "old").unwrap();
        Folder::claim(&path, false).unwrap();
        assert!(!path.join("report.md").exists());

        // What was left unfinished goes, and nothing else does.
        let left =
            ["", "iron-plate", "iron-plate/skin/fields"].map(|inside| path.join(inside).join(".sphorge-12.unfinished"));
        fs::create_dir_all(path.join("iron-plate/skin/fields")).unwrap();
        for file in left.iter().chain([&path.join("iron-plate/.sphorge-notes"), &path.join("a.unfinished")]) {
            fs::write(file, "").unwrap();
        }
        Folder::claim(&path, false).unwrap();
        assert!(left.iter().all(|file| !file.exists()));
        assert!(path.join("iron-plate/.sphorge-notes").exists() && path.join("a.unfinished").exists());
        #[cfg(unix)]
        {
            let own = place.path().join("own.txt");
            fs::write(&own, "mine").unwrap();
            fs::remove_file(path.join(MARK)).unwrap();
            std::os::unix::fs::symlink(&own, path.join(MARK)).unwrap();
            let folder = Folder { path: path.clone() };
            assert!(folder.note_begin(&path.join("iron-plate/skin")).is_err());
            assert_eq!(fs::read_to_string(&own).unwrap(), "mine");
        }

        let other = place.path().join("thesis");
        fs::create_dir(&other).unwrap();
        Folder::claim(&other, false).unwrap();
        fs::remove_file(other.join(MARK)).unwrap();
        fs::write(other.join("report.md"), "mine").unwrap();
        assert!(matches!(Folder::claim(&other, false), Err(ValidateError::NotAValidation { .. })));
        assert_eq!(fs::read_to_string(other.join("report.md")).unwrap(), "mine");
    }
}
