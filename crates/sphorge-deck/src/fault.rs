//! Faults as they are found, collected until they are told.

use super::printable::{printable, printable_in_place};
use super::report::{DeckReport, Problem};
use miette::NamedSource;
use std::{
    collections::{BTreeMap, BTreeSet},
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Most faults that are kept, the first in the text; the others are counted. Millions would fill the memory.
const KEPT: usize = 1000;

/// When a fault is but the echo of another one, and is not told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Echo {
    Never,
    /// It says that something is missing, which may be what has a fault of form in the same entry.
    OfItsEntry,
    /// It says that there is no such name, and the entry of that name may be one that could not be read.
    OfAnyEntry,
}

/// A fault being described.
#[derive(Debug)]
pub(crate) struct Fault {
    code: &'static str,
    message: String,
    labels: Vec<(Range<usize>, String)>,
    help: Option<String>,
    echo: Echo,
}

impl Fault {
    /// A fault at `at`, with the text of the label there.
    #[cfg_attr(test, track_caller)]
    pub(crate) fn new(
        code: &'static str,
        message: impl Into<String>,
        at: Range<usize>,
        label: impl Into<String>,
    ) -> Self {
        #[cfg(test)]
        sites::note();
        Self { code, message: message.into(), labels: vec![(at, label.into())], help: None, echo: Echo::Never }
    }

    /// What to do about it.
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Another place that has to do with it.
    pub(crate) fn also(mut self, at: Range<usize>, label: impl Into<String>) -> Self {
        self.labels.push((at, label.into()));
        self
    }

    /// Not told where another key of the same entry has a fault of form: it may be the one that is missing.
    pub(crate) fn if_its_entry_is_whole(self) -> Self {
        Self { echo: Echo::OfItsEntry, ..self }
    }

    /// Not told where an entry of the deck could not be read: it may be the one that is missing.
    pub(crate) fn if_all_entries_are_read(self) -> Self {
        Self { echo: Echo::OfAnyEntry, ..self }
    }

    fn start(&self) -> usize {
        self.labels.first().map_or(0, |label| label.0.start)
    }
}

/// Where the entries of a deck stand: single keys, tables, and each table of a list.
#[derive(Debug, Default)]
pub(crate) struct Entries {
    /// Where something of an entry begins, and which entry it is; in the order of the text.
    places: Vec<(usize, usize)>,
}

impl Entries {
    /// From the places of each entry.
    pub(crate) fn new(mut places: Vec<(usize, usize)>) -> Self {
        places.sort_unstable();
        Self { places }
    }

    /// The entry a byte of the text belongs to.
    fn at(&self, byte: usize) -> Option<usize> {
        let after = self.places.partition_point(|&(start, _)| start <= byte);
        Some(self.places[after.checked_sub(1)?].1)
    }
}

/// Collects the faults of one text.
#[derive(Debug)]
pub(crate) struct Problems {
    source: Arc<NamedSource<String>>,
    /// The text, where it is not shown as it is.
    hidden: Option<String>,
    folder: PathBuf,
    faults: Vec<Fault>,
    /// Faults that are counted and not kept.
    more: usize,
    entries: Entries,
    /// Entries with faults of form.
    spoiled: BTreeSet<usize>,
    /// Whether entries could not be read.
    lacks_entries: bool,
    /// Whether keys that were to be set were not.
    lacks_keys: bool,
    /// Whether keys that were set have moved the lines of the text.
    has_other_lines: bool,
    /// What is probably not meant, by its place.
    doubts: BTreeMap<usize, String>,
}

impl Problems {
    /// `name` as shown to the user, and the text labels point into.
    pub(crate) fn new(name: &str, text: &str) -> Self {
        let shown = printable_in_place(text);
        let hidden = shown.is_some().then(|| text.to_owned());
        let source = NamedSource::new(printable(name), shown.unwrap_or_else(|| text.to_owned())).with_language("TOML");
        Self {
            source: Arc::new(source),
            hidden,
            folder: PathBuf::new(),
            faults: Vec::new(),
            more: 0,
            entries: Entries::default(),
            spoiled: BTreeSet::new(),
            lacks_entries: false,
            lacks_keys: false,
            has_other_lines: false,
            doubts: BTreeMap::new(),
        }
    }

    /// The folder files named in the text are sought in; the working directory if not given.
    pub(crate) fn with_folder(self, folder: &Path) -> Self {
        Self { folder: folder.to_owned(), ..self }
    }

    /// A file named in the text.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The text labels point into.
    pub(crate) fn text(&self) -> &str {
        self.hidden.as_ref().unwrap_or_else(|| self.source.inner())
    }

    pub(crate) fn push(&mut self, fault: Fault) {
        self.faults.push(fault);
        if self.faults.len() >= 2 * KEPT {
            self.faults.sort_by_key(Fault::start);
            self.more += self.faults.len() - KEPT;
            self.faults.truncate(KEPT);
        }
    }

    /// Whether there are more faults than are kept: it is enough to count others.
    pub(crate) fn is_full(&self) -> bool {
        self.faults.len() >= KEPT
    }

    /// A fault beyond those that are kept.
    pub(crate) fn count_another(&mut self) {
        self.more += 1;
    }

    /// Something at this place that can be read and is probably not meant; what is read twice is told once.
    pub(crate) fn doubt(&mut self, at: &Range<usize>, note: String) {
        if self.doubts.len() < KEPT {
            self.doubts.insert(at.start, note);
        }
    }

    /// What is at this place may well be meant.
    pub(crate) fn drop_doubt(&mut self, at: &Range<usize>) {
        self.doubts.remove(&at.start);
    }

    /// What is probably not meant so far, in the order of the text, each with its line.
    pub(crate) fn take_doubts(&mut self) -> Vec<String> {
        let doubts = std::mem::take(&mut self.doubts);
        doubts.into_iter().map(|(start, note)| self.at_line(&(start..start), note)).collect()
    }

    /// Lines of the text are not those of the file that the user knows: notes name none.
    pub(crate) fn hide_lines(&mut self) {
        self.has_other_lines = true;
    }

    /// A note with the line that it is about before it, unless it has no place.
    pub(crate) fn at_line(&self, at: &Range<usize>, note: String) -> String {
        match self.text().get(..at.start) {
            Some(before) if !self.has_other_lines && *at != (0..0) => {
                format!("line {}: {note}", 1 + before.matches('\n').count())
            }
            _ => note,
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// How many there are so far.
    pub(crate) fn count(&self) -> usize {
        self.faults.len() + self.more
    }

    /// Takes the faults so far for those of form: what is missing in their entries is not told.
    pub(crate) fn form_is_checked(&mut self, entries: Entries) {
        // Those of the deck as a whole have no place.
        let placed = self.faults.iter().filter(|fault| fault.labels.first().is_some_and(|label| label.0 != (0..0)));
        self.spoiled = placed.filter_map(|fault| entries.at(fault.start())).collect();
        self.entries = entries;
    }

    /// An entry cannot be read: names may be missing.
    pub(crate) fn lacks_an_entry(&mut self) {
        self.lacks_entries = true;
    }

    /// A key cannot be set: what is missing may be that.
    pub(crate) fn lacks_a_key(&mut self) {
        self.lacks_keys = true;
    }

    fn is_echo(&self, fault: &Fault) -> bool {
        match fault.echo {
            Echo::Never => self.lacks_keys && fault.code == "missing-key",
            Echo::OfItsEntry if self.lacks_keys => true,
            Echo::OfItsEntry => self.entries.at(fault.start()).is_some_and(|entry| self.spoiled.contains(&entry)),
            Echo::OfAnyEntry => self.lacks_entries,
        }
    }

    /// Everything that is wrong, or `otherwise` if no fault has been found although there must be one.
    pub(crate) fn report(&mut self, otherwise: &str) -> DeckReport {
        match self.check() {
            Err(report) => report,
            Ok(()) => {
                let help = "this is a bug in Sphorge; please report it with the deck".to_owned();
                DeckReport::placeless(self.source.name(), "internal", otherwise.to_owned(), Some(help))
            }
        }
    }

    /// Nothing if nothing is wrong, else everything that is.
    pub(crate) fn check(&mut self) -> Result<(), DeckReport> {
        let mut faults = std::mem::take(&mut self.faults);
        faults.retain(|fault| !self.is_echo(fault));
        if faults.is_empty() {
            return Ok(());
        }
        faults.sort_by_key(Fault::start);
        // What is read twice is told once.
        faults.dedup_by(|b, a| (a.code, &a.message, &a.labels) == (b.code, &b.message, &b.labels));
        let more = std::mem::take(&mut self.more) + faults.len().saturating_sub(KEPT);
        faults.truncate(KEPT);
        let end = self.text().len();
        let inside = |(at, text): (Range<usize>, String)| {
            let start = at.start.min(end);
            (start..at.end.clamp(start, end), printable(&text).into_owned())
        };
        let problems = faults
            .into_iter()
            .map(|f| Problem {
                code: f.code,
                message: printable(&f.message).into_owned(),
                labels: f.labels.into_iter().map(inside).collect(),
                help: f.help.map(|help| printable(&help).into_owned()),
                source: Arc::clone(&self.source),
            })
            .collect();
        Err(DeckReport { name: self.source.name().to_owned(), problems, more })
    }
}

/// Which lines of the sources have told of a fault, so that a test can ask for those no bad deck reaches.
#[cfg(test)]
pub(crate) mod sites {
    use std::{cell::RefCell, collections::BTreeSet, panic::Location};

    thread_local! {
        static SEEN: RefCell<BTreeSet<(String, u32)>> = const { RefCell::new(BTreeSet::new()) };
    }

    /// Keeps the line that called the caller.
    #[track_caller]
    pub(crate) fn note() {
        let at = Location::caller();
        SEEN.with_borrow_mut(|seen| seen.insert((at.file().to_owned(), at.line())));
    }

    /// File and line of all that this thread has kept.
    pub(crate) fn seen() -> BTreeSet<(String, u32)> {
        SEEN.with_borrow(Clone::clone)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use miette::Diagnostic;

    #[test]
    fn a_report_of_one_speaks_for_itself_and_of_several_relates_them() {
        let mut problems = Problems::new("d", "a\nb\nc");
        problems.push(Fault::new("x", "late", 4..5, "here"));
        let one = problems.check().unwrap_err();
        assert_eq!((one.to_string().as_str(), one.problems()[0].line()), ("late", Some(3)));
        assert!(Diagnostic::related(&one).is_none());
        problems.push(Fault::new("x", "late", 4..5, "here"));
        problems.push(Fault::new("y", "early", 0..900, "here"));
        let two = problems.check().unwrap_err();
        assert_eq!(two.problems()[0].to_string(), "early");
        assert_eq!(two.problems()[0].labels()[0].0, 0..5);
        assert_eq!(Diagnostic::related(&two).unwrap().count(), 2);
        assert!(problems.check().is_ok());
    }
}
