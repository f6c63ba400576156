//! What is wrong with a deck: every fault with its line, what was expected and what to do.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::{
    fmt,
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Most faults of a deck that are told; a thousand say no more.
const TOLD: usize = 20;
/// Longest message, and longest lines of a deck around a fault, that are shown, in bytes.
const LONGEST_MESSAGE: usize = 1000;
const LONGEST_LINE: usize = 4000;

/// One fault of a deck.
#[derive(Clone, Debug)]
pub struct Problem {
    code: &'static str,
    message: String,
    labels: Vec<(Range<usize>, String)>,
    help: Option<String>,
    source: Arc<NamedSource<String>>,
}

impl Problem {
    /// Short name of the kind of fault, such as `unknown-key`.
    pub fn code(&self) -> &'static str {
        self.code
    }

    /// Bytes of the deck the fault is at, and what the label there says; the first label is the main one.
    pub fn labels(&self) -> &[(Range<usize>, String)] {
        &self.labels
    }

    /// What to do.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// One-based line of the main label, if the fault has a place.
    pub fn line(&self) -> Option<usize> {
        let start = self.labels.first()?.0.start;
        Some(1 + self.source.inner().bytes().take(start).filter(|&b| b == b'\n').count())
    }
}

impl Problem {
    /// Whether the lines of the labels, and those before and after them, are short enough to be shown.
    fn fits(&self) -> bool {
        /// Bytes to the end of the next line.
        fn reach<'a>(bytes: impl Iterator<Item = &'a u8>) -> usize {
            let mut ends = 0;
            let is_near = |byte: &&u8| {
                ends += usize::from(**byte == b'\n');
                ends < 2
            };
            bytes.take(LONGEST_LINE).take_while(is_near).count()
        }
        let text = self.source.inner().as_bytes();
        self.labels.iter().all(|(at, _)| {
            let (start, end) = (at.start.min(text.len()), at.end.min(text.len()));
            end.saturating_sub(start) + reach(text[..start].iter().rev()) + reach(text[end..].iter()) < LONGEST_LINE
        })
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (false, Some(line)) = (self.fits(), self.line()) {
            write!(f, "line {line}: ")?;
        }
        match self.message.char_indices().find(|(at, _)| *at >= LONGEST_MESSAGE) {
            Some((end, _)) => write!(f, "{} ...", &self.message[..end]),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for Problem {}

impl Diagnostic for Problem {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.code))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        (!self.labels.is_empty() && self.fits()).then_some(self.source.as_ref() as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        if !self.fits() {
            return None;
        }
        Some(Box::new(self.labels.iter().map(|(at, text)| LabeledSpan::new(Some(text.clone()), at.start, at.len()))))
    }
}

/// Why a deck cannot be run: one or more [`Problem`]s, in the order of the text.
#[derive(Clone, Debug)]
pub struct DeckReport {
    name: String,
    problems: Vec<Problem>,
}

impl DeckReport {
    /// The faults, in the order of the text; never empty.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// A fault that has no place in a text, such as a file that cannot be read.
    pub(crate) fn placeless(name: &str, code: &'static str, message: String, help: Option<String>) -> Self {
        let source = Arc::new(NamedSource::new(name, String::new()));
        Self { name: name.to_owned(), problems: vec![Problem { code, message, labels: Vec::new(), help, source }] }
    }

    fn only(&self) -> Option<&Problem> {
        match self.problems.as_slice() {
            [one] => Some(one),
            _ => None,
        }
    }
}

impl fmt::Display for DeckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.only() {
            Some(problem) => problem.fmt(f),
            None if self.problems.len() > TOLD => {
                write!(f, "{} faults in {}, the first {TOLD} are", self.problems.len(), self.name)
            }
            None => write!(f, "{} faults in {}", self.problems.len(), self.name),
        }
    }
}

impl std::error::Error for DeckReport {}

impl Diagnostic for DeckReport {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.only().and_then(Diagnostic::code)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.only().and_then(Diagnostic::help)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.only().and_then(Diagnostic::source_code)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.only().and_then(Diagnostic::labels)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        match self.only() {
            Some(_) => None,
            None => Some(Box::new(self.problems.iter().take(TOLD).map(|p| p as &dyn Diagnostic))),
        }
    }
}

/// A fault being described.
#[derive(Debug)]
pub(crate) struct Fault {
    code: &'static str,
    message: String,
    labels: Vec<(Range<usize>, String)>,
    help: Option<String>,
}

impl Fault {
    /// A fault at `at`, with the text of the label there.
    pub(crate) fn new(
        code: &'static str,
        message: impl Into<String>,
        at: Range<usize>,
        label: impl Into<String>,
    ) -> Self {
        Self { code, message: message.into(), labels: vec![(at, label.into())], help: None }
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
}

/// Collects the faults of one text.
#[derive(Debug)]
pub(crate) struct Problems {
    source: Arc<NamedSource<String>>,
    folder: PathBuf,
    faults: Vec<Fault>,
}

impl Problems {
    /// `name` as shown to the user, and the text labels point into.
    pub(crate) fn new(name: &str, text: &str) -> Self {
        let source = Arc::new(NamedSource::new(name, text.to_owned()).with_language("TOML"));
        Self { source, folder: PathBuf::new(), faults: Vec::new() }
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
        self.source.inner()
    }

    pub(crate) fn push(&mut self, fault: Fault) {
        self.faults.push(fault);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// Everything that is wrong, or `otherwise` if no fault has been found although there must be one.
    pub(crate) fn report(&mut self, otherwise: &str) -> DeckReport {
        match self.check() {
            Err(report) => report,
            Ok(()) => {
                let help = "this is a fault of Sphorge, please report it with the deck".to_owned();
                DeckReport::placeless(self.source.name(), "internal", otherwise.to_owned(), Some(help))
            }
        }
    }

    /// Nothing if nothing is wrong, else everything that is.
    pub(crate) fn check(&mut self) -> Result<(), DeckReport> {
        if self.faults.is_empty() {
            return Ok(());
        }
        let mut faults = std::mem::take(&mut self.faults);
        faults.sort_by_key(|f| f.labels.first().map_or(0, |l| l.0.start));
        let end = self.text().len();
        let inside = |(at, text): (Range<usize>, String)| (at.start.min(end)..at.end.min(end), text);
        let problems = faults
            .into_iter()
            .map(|f| Problem {
                code: f.code,
                message: f.message,
                labels: f.labels.into_iter().map(inside).collect(),
                help: f.help,
                source: Arc::clone(&self.source),
            })
            .collect();
        Err(DeckReport { name: self.source.name().to_owned(), problems })
    }
}

/// The option most like `word`, if one is near enough to be meant.
pub(crate) fn nearest<'a>(word: &str, options: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let folded = word.to_lowercase().replace(['_', ' '], "-");
    let mut best = None;
    for option in options {
        let mut score = strsim::normalized_damerau_levenshtein(&folded, &option.to_lowercase());
        if folded.len() >= 3 && (option.starts_with(&folded) || folded.starts_with(option) || option.ends_with(&folded))
        {
            score = score.max(0.6);
        }
        if score >= 0.5 && best.is_none_or(|(s, _)| score > s) {
            best = Some((score, option));
        }
    }
    best.map(|(_, option)| option)
}

/// `a`, `b` or `c`, quoted for people.
pub(crate) fn listed<'a>(options: impl IntoIterator<Item = &'a str>, joint: &str) -> String {
    let quoted: Vec<String> = options.into_iter().map(|o| format!("`{o}`")).collect();
    match quoted.as_slice() {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [head @ .., last] => format!("{} {joint} {last}", head.join(", ")),
    }
}

/// The help of a name that is not among the options: the nearest one, and all of them if they are few.
pub(crate) fn suggest<'a>(word: &str, options: impl IntoIterator<Item = &'a str> + Clone, what: &str) -> String {
    let count = options.clone().into_iter().count();
    let near = nearest(word, options.clone()).map(|n| format!("did you mean `{n}`? "));
    let all = match count {
        0 => format!("The deck has no {what}."),
        1..=30 => format!("There {} {}.", if count == 1 { "is" } else { "are" }, listed(options, "and")),
        _ => String::new(),
    };
    (near.unwrap_or_default() + &all).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_slips_and_gives_up_on_strangers() {
        let keys = ["spacing", "smoothing", "placement"];
        assert_eq!(nearest("spaceing", keys), Some("spacing"));
        assert_eq!(nearest("Spacing", keys), Some("spacing"));
        assert_eq!(nearest("zzz", keys), None);
        assert_eq!(nearest("", keys), None);
    }

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
