//! What is wrong with a deck: every fault with its line, what was expected and what to do.

use super::printable::printable;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::{fmt, ops::Range, sync::Arc};

/// Most faults of a deck that are told; a thousand say no more.
const TOLD: usize = 20;
/// Longest message, and longest lines of a deck around a fault, that are shown, in bytes.
const LONGEST_MESSAGE: usize = 400;
const LONGEST_LINE: usize = 4000;

/// One fault of a deck.
#[derive(Clone, Debug)]
pub struct Problem {
    pub(super) code: &'static str,
    pub(super) message: String,
    pub(super) labels: Vec<(Range<usize>, String)>,
    pub(super) help: Option<String>,
    pub(super) source: Arc<NamedSource<String>>,
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
    pub(super) name: String,
    pub(super) problems: Vec<Problem>,
    /// Faults beyond those that are kept.
    pub(super) more: usize,
}

impl DeckReport {
    /// The faults, in the order of the text, the first thousand of them; never empty.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// A fault that has no place in a text, such as a file that cannot be read.
    #[cfg_attr(test, track_caller)]
    pub(crate) fn placeless(name: &str, code: &'static str, message: String, help: Option<String>) -> Self {
        #[cfg(test)]
        super::fault::sites::note();
        let name = printable(name).into_owned();
        let source = Arc::new(NamedSource::new(&name, String::new()));
        let problem = Problem { code, message: printable(&message).into_owned(), labels: Vec::new(), help, source };
        Self { name, problems: vec![problem], more: 0 }
    }

    /// One report of several texts.
    pub(crate) fn joined(name: &str, reports: Vec<Self>) -> Self {
        let more = reports.iter().map(|report| report.more).sum();
        let problems = reports.into_iter().flat_map(|report| report.problems).collect();
        Self { name: printable(name).into_owned(), problems, more }
    }

    fn count(&self) -> usize {
        self.problems.len() + self.more
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
            None if self.count() > TOLD => {
                write!(f, "{} faults in {}, the first {TOLD} are", self.count(), self.name)
            }
            None => write!(f, "{} faults in {}", self.count(), self.name),
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
