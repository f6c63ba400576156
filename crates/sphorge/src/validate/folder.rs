//! The folder of a validation.

use super::{Report, ValidateError, earlier};
use crate::output::{
    Claim, Durability, Folder as OpenedFolder, OutputError, is_empty, most, read_regular_file, remove_unfinished,
};
use std::{
    fs,
    io::{self, Read, Write},
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

/// A folder this validation alone writes to.
#[derive(Debug)]
pub(super) struct Folder {
    path: PathBuf,
    claim: Claim,
}

impl Folder {
    /// Makes the folder, or takes over that of a former validation, by the same program if it is to be gone on with.
    pub(super) fn claim(path: &Path, resume: bool) -> Result<Self, ValidateError> {
        let unwritable = |source| OutputError::Unwritable { path: path.to_owned(), source };
        fs::create_dir_all(path).map_err(unwritable)?;
        let opened = OpenedFolder::open(path).map_err(unwritable)?;
        let is_marked = opened.open_file(MARK).is_ok();
        if !is_marked && !is_empty(&opened) {
            return Err(ValidateError::NotAValidation { path: path.to_owned() });
        }
        if resume && is_marked {
            earlier::check_program(&path.join(MARK))?;
        }
        let folder = Self { path: path.to_owned(), claim: Claim::take(opened, false)? };
        let opened = folder.claim.folder();
        // What a validation that was killed was about to write, itself or in its runs and pictures.
        remove_unfinished(opened, DEEPEST).map_err(unwritable)?;
        // The old report does not belong to the runs that are about to replace the old ones.
        [MARKDOWN, HTML, JSON].iter().try_for_each(|name| opened.remove_file(name)).map_err(unwritable)?;
        if resume && is_marked {
            return Ok(folder);
        }
        let program = earlier::program().unwrap_or_else(|| "an unknown program".to_owned());
        let mark = format!(
            "Written by `sphorge validate` and replaced by the next validation in this folder, unless that continues \
             it with `--resume`:\n{program}\n"
        );
        opened.write(MARK, Durability::Disk, |out| out.write_all(mark.as_bytes())).map_err(unwritable)?;
        Ok(folder)
    }

    /// Notes in the mark that a run in a folder of this validation begins: what else is there is of another one.
    ///
    /// # Errors
    /// [`ValidateError::Lost`]; or the mark cannot be written to, or the folder of the run, or that of its case, is a link, which is not followed.
    pub(super) fn note_begin(&self, run: &Path) -> Result<(), ValidateError> {
        let folder = self.claim.check()?;
        let name = self.relative(run);
        let unwritable = |path: PathBuf| move |source| OutputError::Unwritable { path, source };
        if let Some((case, _)) = name.rsplit_once('/') {
            folder.make_inside(case).map_err(unwritable(self.path.join(case)))?;
        }
        match folder.inside(&name) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            opened => drop(opened.map_err(unwritable(run.to_owned()))?),
        }
        if self.has_begun(run) {
            return Ok(());
        }
        let line = format!("{name}\n");
        let noted = match folder.open_to_append(MARK) {
            Ok(mut mark) => mark.write_all(line.as_bytes()),
            // It has a second name, as in a copy by links, which keeps what it says.
            Err(_) => self.mark().and_then(|mark| {
                folder.write(MARK, Durability::Disk, |out| out.write_all(&[&mark, line.as_bytes()].concat()))
            }),
        };
        Ok(noted.map_err(unwritable(self.path.join(MARK)))?)
    }

    /// What the mark says.
    fn mark(&self) -> io::Result<Vec<u8>> {
        let mut text = Vec::new();
        self.claim.folder().open_file(MARK)?.take(most::TEXT).read_to_end(&mut text)?;
        Ok(text)
    }

    /// Whether this validation has begun the run in a folder.
    pub(super) fn has_begun(&self, run: &Path) -> bool {
        String::from_utf8_lossy(&self.mark().unwrap_or_default()).lines().any(|line| line == self.relative(run))
    }

    /// Folder of a run.
    pub(super) fn run(&self, case: &str, label: &str) -> PathBuf {
        self.path.join(case).join(slug(label))
    }

    /// Folder of the pictures of a case, made where it is not there.
    ///
    /// # Errors
    /// It cannot be made, or is a link, which is not followed; or the folder of the validation is lost.
    pub(super) fn pictures(&self, case: &str) -> Result<PathBuf, OutputError> {
        let path = self.path.join(case).join("pictures");
        let made = self.claim.check()?.make_inside(&format!("{case}/pictures"));
        made.map(|_| path.clone()).map_err(|source| OutputError::Unwritable { path, source })
    }

    /// A path inside, relative to the report.
    pub(super) fn relative(&self, path: &Path) -> String {
        let inside = path.strip_prefix(&self.path).unwrap_or(path);
        inside.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
    }

    /// Writes the report in its three forms.
    pub(super) fn write(&self, report: &Report) -> Result<(), ValidateError> {
        let write = |name: &str, text: String| {
            let written = self.claim.check()?.write(name, Durability::Disk, |out| out.write_all(text.as_bytes()));
            written.map_err(|source| ValidateError::Report(OutputError::Write { path: self.path.join(name), source }))
        };
        write(MARKDOWN, report.markdown())?;
        write(HTML, report.html(&|file| read_regular_file(&self.path.join(file), most::PICTURE).ok()))?;
        let json = serde_json::to_string_pretty(report).map_err(|error| {
            ValidateError::Report(OutputError::Write { path: self.path.join(JSON), source: error.into() })
        })?;
        write(JSON, json + "\n")
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
    use crate::validate::Effort;

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
            let folder = Folder::claim(&path, false).unwrap();
            fs::remove_file(path.join(MARK)).unwrap();
            std::os::unix::fs::symlink(&own, path.join(MARK)).unwrap();
            assert!(folder.note_begin(&path.join("iron-plate/skin")).is_err());
            drop(folder);
            assert!(matches!(Folder::claim(&path, true), Err(ValidateError::NotAValidation { .. })));
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

    #[test]
    fn two_validations_do_not_share_a_folder_and_one_that_lost_it_stops() {
        let place = tempfile::tempdir().unwrap();
        let (path, moved) = (place.path().join("validate"), place.path().join("moved"));
        let first = Folder::claim(&path, false).unwrap();
        let run = path.join("iron-plate/skin");
        first.note_begin(&run).unwrap();
        fs::write(path.join(".sphorge-12.unfinished"), "").unwrap();
        for resume in [false, true] {
            let refused = Folder::claim(&path, resume).map(drop);
            assert!(matches!(refused, Err(ValidateError::Locked { .. })), "{refused:?}");
        }
        assert!(first.has_begun(&run) && path.join(".sphorge-12.unfinished").exists());
        fs::rename(&path, &moved).unwrap();
        let second = Folder::claim(&path, false).unwrap();
        assert!(matches!(first.note_begin(&path.join("bullet/coarse")), Err(ValidateError::Lost { .. })));
        assert!(matches!(first.pictures("bullet"), Err(OutputError::Lost { .. })));
        assert!(matches!(first.write(&Report::new(Effort::Quick, 1)), Err(ValidateError::Lost { .. })));
        assert!(!path.join("bullet").exists() && !path.join(HTML).exists() && !second.has_begun(&run));
        // One that was killed has ended.
        drop((first, second));
        fs::remove_dir_all(&path).unwrap();
        fs::create_dir(&path).unwrap();
        fs::write(path.join(".sphorge-lock"), "").unwrap();
        Folder::claim(&path, false).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn nothing_in_it_that_leads_elsewhere_is_written_through() {
        let place = tempfile::tempdir().unwrap();
        let (path, own) = (place.path().join("validate"), place.path().join("own"));
        fs::create_dir_all(own.join("skin")).unwrap();
        let folder = Folder::claim(&path, false).unwrap();
        fs::create_dir(path.join("bullet")).unwrap();
        for link in ["iron-plate", "bullet/coarse", "bullet/pictures"] {
            std::os::unix::fs::symlink(&own, path.join(link)).unwrap();
        }
        for run in ["iron-plate/skin", "bullet/coarse"] {
            let refused = folder.note_begin(&path.join(run)).unwrap_err();
            assert!(matches!(refused, ValidateError::Output(OutputError::Unwritable { .. })), "{refused:?}");
        }
        assert!(folder.pictures("iron-plate").is_err() && folder.pictures("bullet").is_err());
        assert_eq!(fs::read_dir(&own).unwrap().count(), 1);
        // A copy by links keeps its mark.
        let copy = place.path().join("copy.txt");
        fs::hard_link(path.join(MARK), &copy).unwrap();
        let copied = fs::read(&copy).unwrap();
        for run in ["bullet/fine", "bullet/finer"].map(|run| path.join(run)) {
            folder.note_begin(&run).unwrap();
            assert!(folder.has_begun(&run));
        }
        assert_eq!(fs::read(&copy).unwrap(), copied);
    }
}
