//! Writing to the terminal without ever panicking: a reader that goes away (`sphorge materials | head -1`) is no error.
//!
//! No text that is not of this program reaches a terminal, a file or a pipe as it is: names of files and folders, titles, and what is told of damaged
//! files may hold sequences that move the cursor, colour or hide what follows. They are written out.

use crate::failure::Failure;
use miette::{
    Diagnostic, IntoDiagnostic, LabeledSpan, MietteHandlerOpts, Report, ReportHandler, Severity, SourceCode, WrapErr,
};
use sphorge::deck::moves_the_cursor;
use std::{
    error::Error,
    fmt,
    io::{self, Write},
    path::Path,
};
use textwrap::{WordSeparator, WordSplitter};

/// Prints text to standard output.
///
/// # Errors
/// Anything but a closed pipe, such as a full disk behind a redirection.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(plain(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::Failed(
            Err::<(), _>(error).into_diagnostic().wrap_err("cannot write to standard output").unwrap_err(),
        )),
        _ => Ok(()),
    }
}

/// Prints a line to standard error; there is nobody left to tell if that fails.
pub(crate) fn note(line: &str) {
    let _ = writeln!(io::stderr(), "{}", one_line(line));
}

/// Prints lines to standard error.
pub(crate) fn note_lines(lines: &str) {
    let _ = writeln!(io::stderr(), "{}", plain(lines));
}

/// Prints a diagnostic to standard error.
pub(crate) fn report(report: &Report) {
    let _ = write!(io::stderr(), "{:?}", Shown(&Plain::of(report.as_ref())));
}

/// A diagnostic as a terminal without colours shows it, for whoever shows it elsewhere.
pub fn text_of(diagnostic: &dyn Diagnostic) -> String {
    text_of_in(diagnostic, str::to_owned)
}

/// The same in other words: of each message, hint and label.
pub fn text_of_in(diagnostic: &dyn Diagnostic, words: fn(&str) -> String) -> String {
    struct Uncoloured<'a>(Plain<'a>);
    impl fmt::Debug for Uncoloured<'_> {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            let options = options().color(false).unicode(true).width(100).force_graphical(true);
            options.build().debug(&self.0, f)
        }
    }
    format!("{:?}", Uncoloured(Plain::in_words(diagnostic, words))).trim_end().to_owned()
}

/// The text with everything written out that would do something to a terminal, but for ends of lines and tabs.
pub(crate) fn plain(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c != '\n' && c != '\t' && moves_the_cursor(c) {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// The same as one line: a name with an end of line in it could pass for another line of the program.
fn one_line(text: &str) -> String {
    plain(text).replace('\n', "\\n")
}

/// A path as part of a line.
pub(crate) fn path(path: &Path) -> String {
    one_line(&path.display().to_string())
}

/// A path in a command that can be pasted into a shell: quoted where the shell would read it as anything else.
pub(crate) fn path_in_command(path: &Path) -> String {
    let shown = self::path(path);
    shlex::try_quote(&shown).map_or_else(|_| shown.clone(), |quoted| quoted.into_owned())
}

/// How miette shows diagnostics: lines are broken at spaces alone, so that keys and paths can be copied. A path that is longer than a line stands out of it.
fn options() -> MietteHandlerOpts {
    MietteHandlerOpts::new()
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::NoHyphenation)
        .break_words(false)
}

/// A diagnostic as miette shows it.
struct Shown<'a>(&'a Plain<'a>);

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        options().build().debug(self.0, f)
    }
}

/// A diagnostic whose texts are plain: colours are added by who shows it.
#[derive(Debug)]
struct Plain<'a> {
    of: &'a dyn Diagnostic,
    words: fn(&str) -> String,
    message: String,
    cause: Option<Cause>,
    source: Option<Box<Plain<'a>>>,
    related: Vec<Plain<'a>>,
}

/// What caused an error, in words.
#[derive(Debug)]
struct Cause {
    message: String,
    cause: Option<Box<Cause>>,
}

impl Cause {
    fn of(error: &dyn Error, words: fn(&str) -> String) -> Self {
        let cause = error.source().map(|cause| Box::new(Self::of(cause, words)));
        Self { message: words(&plain(&error.to_string())), cause }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Error for Cause {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_ref().map(|cause| &**cause as _)
    }
}

impl<'a> Plain<'a> {
    fn of(diagnostic: &'a dyn Diagnostic) -> Self {
        Self::in_words(diagnostic, str::to_owned)
    }

    fn in_words(diagnostic: &'a dyn Diagnostic, words: fn(&str) -> String) -> Self {
        let of = |diagnostic| Self::in_words(diagnostic, words);
        Self {
            of: diagnostic,
            words,
            message: words(&plain(&diagnostic.to_string())),
            cause: diagnostic.source().map(|cause| Cause::of(cause, words)),
            source: diagnostic.diagnostic_source().map(|source| Box::new(of(source))),
            related: diagnostic.related().into_iter().flatten().map(of).collect(),
        }
    }
}

impl fmt::Display for Plain<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Error for Plain<'_> {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_ref().map(|cause| cause as _)
    }
}

impl Diagnostic for Plain<'_> {
    fn code<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        let code = self.of.code()?.to_string();
        // Diagnostics are named by their path in the library, which is nothing to a user: `sphorge::output::not_a_run` is `not-a-run`.
        let name = code.rsplit("::").next().unwrap_or_default().replace('_', "-");
        Some(Box::new(name))
    }
    fn severity(&self) -> Option<Severity> {
        self.of.severity()
    }
    fn help<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        self.of.help().map(|help| Box::new((self.words)(&plain(&help.to_string()))) as _)
    }
    fn url<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        self.of.url()
    }
    /// Texts of users are plain there already: labels point into them.
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.of.source_code()
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let words = self.words;
        let plain = move |label: LabeledSpan| {
            let text = label.label().map(|text| words(&plain(text)));
            let place = *label.inner();
            if label.primary() {
                LabeledSpan::new_primary_with_span(text, place)
            } else {
                LabeledSpan::new_with_span(text, place)
            }
        };
        self.of.labels().map(|labels| Box::new(labels.map(plain)) as _)
    }
    fn related<'b>(&'b self) -> Option<Box<dyn Iterator<Item = &'b dyn Diagnostic> + 'b>> {
        let related = self.related.iter().map(|related| related as &dyn Diagnostic);
        (!self.related.is_empty()).then(|| Box::new(related) as _)
    }
    fn diagnostic_source(&self) -> Option<&dyn Diagnostic> {
        self.source.as_ref().map(|source| &**source as _)
    }
}

/// A value as readable JSON, with everything as an escape sequence that would do something to a terminal.
///
/// # Errors
/// It cannot be written as JSON.
pub(crate) fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    let text =
        serde_json::to_string_pretty(value).into_diagnostic().wrap_err("cannot write JSON").map_err(Failure::Failed)?;
    // Outside of strings there are ends of lines alone.
    let escaped = |c: char| match c {
        '\n' => "\n".to_owned(),
        c if moves_the_cursor(c) => c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")).collect(),
        c => c.to_string(),
    };
    Ok(if text.chars().any(|c| c != '\n' && moves_the_cursor(c)) { text.chars().map(escaped).collect() } else { text })
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    const FOREIGN: &str = "a\u{1b}[31mred\r\u{9b}2J\u{202e}é\tb\n";

    #[test]
    fn a_diagnostic_is_named_by_a_word() {
        let error = sphorge::output::OutputError::NotARun { path: "out".into() };
        let text = text_of(&error);
        assert!(text.starts_with("not-a-run\n") && !text.contains("::"), "{text}");
    }

    #[test]
    fn a_path_that_is_longer_than_a_line_is_whole() {
        let folder = PathBuf::from(format!("/{}/run of the plate", "a-long-name/".repeat(20)));
        let error = sphorge::output::OutputError::NotARun { path: folder.clone() };
        let text = text_of(&error);
        let long = folder.to_str().unwrap().split(' ').next().unwrap();
        assert!(text.lines().any(|line| line.contains(long)), "{text}");
    }

    #[test]
    fn what_moves_the_cursor_or_colours_is_written_out() {
        assert_eq!(plain(FOREIGN), "a\\u{1b}[31mred\\r\\u{9b}2J\\u{202e}é\tb\n");
        assert_eq!(path(Path::new(FOREIGN)), "a\\u{1b}[31mred\\r\\u{9b}2J\\u{202e}é\tb\\n");
    }

    #[test]
    fn every_text_of_a_diagnostic_is_plain_and_its_colours_stay() {
        #[derive(Debug)]
        struct Foreign;
        impl fmt::Display for Foreign {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(FOREIGN)
            }
        }
        impl Error for Foreign {}
        let report = Err::<(), _>(Foreign).into_diagnostic().wrap_err(FOREIGN).unwrap_err();
        let nested = miette::miette!(help = FOREIGN, labels = vec![LabeledSpan::at(0..1, FOREIGN)], "{FOREIGN}");
        for report in [report, nested.with_source_code("abc")] {
            let handler = |color| {
                let options = options().color(color).force_graphical(true).unicode(true).width(200);
                let mut text = String::new();
                struct By<'a>(miette::MietteHandler, &'a Report);
                impl fmt::Debug for By<'_> {
                    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                        self.0.debug(&Plain::of(self.1.as_ref()), f)
                    }
                }
                text.push_str(&format!("{:?}", By(options.build(), &report)));
                text
            };
            let text = handler(false);
            assert!(!text.contains(['\u{1b}', '\r', '\u{9b}', '\u{202e}']), "{text:?}");
            assert!(text.matches("\\u{1b}[31mred").count() >= 2, "{text}");
            assert!(handler(true).contains('\u{1b}'));
        }
    }

    #[test]
    fn json_keeps_what_it_says() {
        let text = json(&[FOREIGN]).unwrap();
        assert!(!text.contains(|c| c != '\n' && moves_the_cursor(c)), "{text:?}");
        assert_eq!(serde_json::from_str::<Vec<String>>(&text).unwrap(), [FOREIGN]);
    }
}
