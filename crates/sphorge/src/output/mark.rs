//! The mark of a run: `.sphorge-run`, which only a run writes, names each file that the run has written.
//!
//! A folder is known as that of a run by it, and what a later run with `--overwrite` removes are the files that it names. Each name is there before
//! the file is. It is a text, one name a line; a name that ends in `/` is that of a folder of numbered files.

use super::{
    atomic::Durability,
    checkpoint::is_checkpoint,
    checkpoint_parts::is_parts_folder,
    directory::{DECK, FIELDS, FILES, PLOTS, is_frame, is_frame_folder},
    folder::{Folder, Kind, identity_of_file, random_name},
};
use std::{
    collections::BTreeSet,
    fs::File,
    io::{self, Read, Write},
    sync::{Mutex, MutexGuard, PoisonError},
};

/// Name of the file.
pub(crate) const MARK: &str = ".sphorge-run";
/// How its text begins.
const HEAD: &str = "Files of a run of Sphorge";
/// Names of a million frames take a third of it.
const LONGEST: u64 = 1 << 26;

/// What the mark in a folder says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Marked {
    /// Of this run alone; a run that is resumed keeps it.
    pub(super) run: String,
    /// Files, and folders of files, that the run has written.
    pub(super) names: BTreeSet<String>,
}

impl Marked {
    /// Of a new run.
    pub(super) fn new() -> Self {
        Self { run: format!("{}{}", random_name(), random_name()), names: BTreeSet::new() }
    }

    /// Reads the mark of a folder; nothing where there is none that a run has written.
    pub(super) fn read(folder: &Folder) -> Option<Self> {
        let mut text = Vec::new();
        folder.open_file(MARK).ok()?.take(LONGEST + 1).read_to_end(&mut text).ok()?;
        if text.len() as u64 > LONGEST {
            return None;
        }
        // A power cut may have left a torn end.
        let text = String::from_utf8_lossy(&text);
        let mut lines = text.lines();
        let run = lines.next()?.strip_prefix(HEAD)?.trim().to_owned();
        let names = lines.filter(|name| is_of_a_run(name)).map(str::to_owned).collect();
        is_run(&run).then_some(Self { run, names })
    }

    fn text(&self) -> String {
        let mut text = format!("{HEAD} {}\n", self.run);
        for name in &self.names {
            text.push_str(name);
            text.push('\n');
        }
        text
    }
}

/// Whether a text may tell a run from others.
fn is_run(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_hexdigit())
}

/// Whether a run gives files such a name: whoever has written a mark, nothing else is removed by it.
fn is_of_a_run(name: &str) -> bool {
    match name.split_once('/') {
        None => name == DECK || FILES.contains(&name) || is_checkpoint(name),
        Some((FIELDS, rest)) => is_frame(rest) || rest.strip_suffix('/').is_some_and(is_frame_folder),
        Some((PLOTS, rest)) => is_picture(rest),
        Some((folder, "")) => is_parts_folder(folder),
        Some(_) => false,
    }
}

/// Whether a file may be a picture of `plot`.
pub(super) fn is_picture(name: &str) -> bool {
    let is_plain = |c: char| !c.is_control() && !matches!(c, '/' | '\\');
    [".png", ".svg"].iter().any(|ending| name.len() > ending.len() && name.ends_with(ending))
        && !name.starts_with('.')
        && name.chars().all(is_plain)
}

/// The mark of a run that writes to its folder.
#[derive(Debug)]
pub(super) struct Mark(Mutex<State>);

#[derive(Debug)]
struct State {
    folder: Folder,
    marked: Marked,
    was_there: bool,
    /// To add to its end.
    file: Option<File>,
}

impl Mark {
    /// Writes the mark in the place of a former one.
    pub(super) fn write(folder: &Folder, marked: Marked) -> io::Result<Self> {
        let mut state = State { folder: folder.clone(), marked, was_there: true, file: None };
        state.write()?;
        Ok(Self(Mutex::new(state)))
    }

    /// The mark of a run that goes on. Where it is lost, it is written again with the first file: whatever in the folder has the name of a file of a run
    /// is taken for one.
    pub(super) fn resumed(folder: &Folder) -> io::Result<Self> {
        let read = Marked::read(folder);
        let was_there = read.is_some();
        let marked = match read {
            Some(marked) => marked,
            None => Marked { names: found_names(folder)?, ..Marked::new() },
        };
        Ok(Self(Mutex::new(State { folder: folder.clone(), marked, was_there, file: None })))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What tells the run from all others.
    pub(super) fn run(&self) -> String {
        self.state().marked.run.clone()
    }

    /// Takes this run for that of the mark, if it is lost.
    pub(super) fn adopt(&self, run: &str) {
        let state = &mut *self.state();
        if !state.was_there && is_run(run) {
            run.clone_into(&mut state.marked.run);
        }
    }

    /// Whether the folder had a mark.
    pub(super) fn was_there(&self) -> bool {
        self.state().was_there
    }

    /// All names.
    pub(super) fn names(&self) -> BTreeSet<String> {
        self.state().marked.names.clone()
    }

    /// Whether a file of this name is one of the run.
    pub(super) fn has(&self, name: &str) -> bool {
        self.state().marked.names.contains(name)
    }

    /// Notes that the run writes a file of this name.
    pub(super) fn add(&self, name: &str) -> io::Result<()> {
        self.state().add(name)
    }

    /// Leaves out names of files that are no more.
    pub(super) fn forget(&self, is_gone: impl Fn(&str) -> bool) -> io::Result<()> {
        let state = &mut *self.state();
        state.marked.names.retain(|name| !is_gone(name));
        state.write()
    }
}

impl State {
    fn write(&mut self) -> io::Result<()> {
        let text = self.marked.text();
        self.folder.write(MARK, Durability::Disk, |out| out.write_all(text.as_bytes()))?;
        self.file = Some(self.folder.open_to_append(MARK)?);
        self.was_there = true;
        Ok(())
    }

    fn add(&mut self, name: &str) -> io::Result<()> {
        let is_new = self.marked.names.insert(name.to_owned());
        if self.was_there && !is_new {
            return Ok(());
        }
        if let Some(file) = self.appendable().filter(|_| self.was_there) {
            let file = self.file.insert(file);
            file.write_all(format!("{name}\n").as_bytes())?;
            // A checkpoint counts on all that was written before it.
            return if is_checkpoint(name) { file.sync_data() } else { Ok(()) };
        }
        // Pictures were noted by others.
        if let Some(found) = Marked::read(&self.folder).filter(|found| found.run == self.marked.run) {
            self.marked.names.extend(found.names);
        }
        self.write()
    }

    /// The file, to add to its end, unless it is lost, or another, or has a second name, as in a copy by links: it is written anew then.
    fn appendable(&mut self) -> Option<File> {
        let file = self.file.take().or_else(|| self.folder.open_to_append(MARK).ok())?;
        let is_own = identity_of_file(&file).ok() == self.folder.identity_of(MARK).ok();
        Some(file).filter(|_| is_own)
    }
}

/// What in a folder has the name of a file of a run, but for pictures.
fn found_names(folder: &Folder) -> io::Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    let mut add = |inside: &str, found: Vec<(String, Kind)>| {
        let name = |(name, kind): (String, Kind)| match kind {
            Kind::File => Some(format!("{inside}{name}")),
            Kind::Folder => Some(format!("{inside}{name}/")),
            Kind::Other => None,
        };
        names.extend(found.into_iter().filter_map(name).filter(|name| is_of_a_run(name)));
    };
    add("", folder.entries()?);
    if let Ok(fields) = folder.inside(FIELDS) {
        add("fields/", fields.entries()?);
    }
    Ok(names)
}

/// Notes in the mark of a folder that a picture of this name is of its run, if it is the folder of one.
pub(super) fn add_picture(folder: &Folder, name: &str) -> io::Result<()> {
    let name = format!("{PLOTS}/{name}");
    match Marked::read(folder) {
        Some(mut marked) if is_of_a_run(&name) && !marked.names.contains(&name) => match folder.open_to_append(MARK) {
            Ok(mut file) => file.write_all(format!("{name}\n").as_bytes()),
            // It has a second name, as in a copy by links.
            Err(_) => {
                marked.names.insert(name);
                folder.write(MARK, Durability::Disk, |out| out.write_all(marked.text().as_bytes()))
            }
        },
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn names_are_added_once_and_read_again() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        assert_eq!(Marked::read(&folder), None);
        let mark = Mark::write(&folder, Marked::new()).unwrap();
        let names = ["fields/000001.vtp", "deck.toml", "fields/000002/", "checkpoint-000000000012-parts-Ab3/"];
        for name in names.iter().chain(&names) {
            mark.add(name).unwrap();
        }
        add_picture(&folder, "pressure-last.png").unwrap();
        add_picture(&folder, "pressure-last.png").unwrap();
        let marked = Marked::read(&folder).unwrap();
        assert_eq!(marked.run, mark.run());
        assert_eq!(marked.names.len(), 5);
        assert!(names.iter().all(|name| marked.names.contains(*name)));
        assert_eq!(fs::read_to_string(place.path().join(MARK)).unwrap().lines().count(), 6);
    }

    #[test]
    fn a_mark_that_is_lost_or_has_a_second_name_is_written_anew_with_all_names() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        let (path, copy) = (place.path().join(MARK), place.path().join("copy"));
        let mark = Mark::write(&folder, Marked::new()).unwrap();
        mark.add("deck.toml").unwrap();
        let has = |names: &[&str]| {
            let marked = Marked::read(&folder).unwrap();
            assert_eq!(
                (marked.run, marked.names.into_iter().collect::<Vec<_>>()),
                (mark.run(), names.iter().map(|name| (*name).to_owned()).collect())
            );
        };
        // As by `cp -al`: what draws and what goes on leave the copy alone.
        fs::hard_link(&path, &copy).unwrap();
        let copied = fs::read(&copy).unwrap();
        add_picture(&folder, "a.png").unwrap();
        has(&["deck.toml", "plots/a.png"]);
        mark.add("fields/000001.vtp").unwrap();
        let all = ["deck.toml", "fields/000001.vtp", "plots/a.png"];
        has(&all);
        assert_eq!(fs::read(&copy).unwrap(), copied);
        fs::remove_file(&copy).unwrap();
        fs::hard_link(&path, &copy).unwrap();
        let copied = fs::read(&copy).unwrap();
        let resumed = Mark::resumed(&folder).unwrap();
        resumed.add("history.csv").unwrap();
        has(&["deck.toml", "fields/000001.vtp", "history.csv", "plots/a.png"]);
        assert_eq!(fs::read(&copy).unwrap(), copied);
        // Removed while the run writes.
        fs::remove_file(&path).unwrap();
        mark.add("summary.json").unwrap();
        has(&[&all[..], &["summary.json"]].concat());
    }

    #[test]
    fn a_mark_that_somebody_has_made_up_names_nothing_but_files_of_a_run() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        let foreign = "../deck.toml\n/etc/passwd\nnotes.txt\nfields/../../a.vtp\nfields/mine.vtp\nplots/../deck.toml\nplots/../a.png\n\
                       plots/a/b.png\nplots/.png\n..\n.\nfields/\n/\n";
        fs::write(place.path().join(MARK), format!("{HEAD} 12ab\nfields/000012.vtp\n{foreign}")).unwrap();
        let marked = Marked::read(&folder).unwrap();
        assert_eq!(marked.names.into_iter().collect::<Vec<_>>(), ["fields/000012.vtp"]);
        fs::write(place.path().join(MARK), "my notes").unwrap();
        assert_eq!(Marked::read(&folder), None);
    }
}
