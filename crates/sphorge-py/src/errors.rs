//! Exceptions: classes of the Python file `_errors.py`, with the text that a terminal would show.

use crate::words::of_python;
use miette::Diagnostic;
use pyo3::{exceptions::PyRuntimeError, prelude::*, types::PyDict};
use sphorge::{
    deck::DeckReport,
    fragments::FragmentError,
    output::{FailureRecord, OutputError},
    run::{ResumeError, RunError},
    sweep::SweepError,
};
use sphorge_cli::text_of_in;

/// What a terminal would show, in the words of Python.
fn text_of(diagnostic: &dyn Diagnostic) -> String {
    let text = text_of_in(diagnostic, of_python);
    // Names of what texts are from.
    text.replace(", with --set", ", with what was set").replace("[--set", "[what was set")
}

/// An exception of a class of `_errors.py`, with a text and what else is known.
fn make(py: Python<'_>, class: &str, text: &str, fill: impl FnOnce(&Bound<'_, PyDict>) -> PyResult<()>) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let details = PyDict::new(py);
        fill(&details)?;
        let class = py.import("sphorge._errors")?.getattr(class)?;
        Ok(PyErr::from_value(class.call((text,), Some(&details))?))
    };
    // Not even the class could be had.
    made().unwrap_or_else(|error| error)
}

fn hint_of(diagnostic: &dyn Diagnostic) -> Option<String> {
    let own = diagnostic.help().map(|help| of_python(&help.to_string()));
    own.or_else(|| diagnostic.diagnostic_source().and_then(hint_of))
}

/// One of our errors with its text and what to do.
fn plain(py: Python<'_>, class: &str, diagnostic: &dyn Diagnostic) -> PyErr {
    make(py, class, &text_of(diagnostic), |details| details.set_item("hint", hint_of(diagnostic)))
}

/// Bad input that has no place in a deck.
pub(crate) fn bad_input(py: Python<'_>, message: &str, hint: &str) -> PyErr {
    make(py, "SphorgeError", message, |details| details.set_item("hint", hint))
}

/// What a diagnostic that has no type of its own says.
pub(crate) fn report(py: Python<'_>, report: &miette::Report) -> PyErr {
    plain(py, "SphorgeError", report.as_ref())
}

/// A fault of ours.
pub(crate) fn internal(py: Python<'_>, message: &str) -> PyErr {
    let text = format!("this is a bug in Sphorge: {message}\nPlease report it together with the deck.");
    make(py, "InternalError", &text, |_| Ok(()))
}

/// Faults of a deck; `whole` is what they are told with.
fn of_deck(py: Python<'_>, deck: &DeckReport, whole: &dyn Diagnostic) -> PyErr {
    make(py, "DeckError", &text_of(whole), |details| {
        let problems: Vec<_> = deck
            .problems()
            .iter()
            .map(|problem| {
                (of_python(&problem.to_string()), problem.line(), problem.help().map(of_python), problem.code())
            })
            .collect();
        details.set_item("problems", problems)
    })
}

/// Faults of a deck.
pub(crate) fn deck(py: Python<'_>, report: &DeckReport) -> PyErr {
    of_deck(py, report, report)
}

/// Trouble with files.
pub(crate) fn output(py: Python<'_>, error: &OutputError) -> PyErr {
    plain(py, "FolderError", error)
}

/// A run that could not be made, or failed.
pub(crate) fn run(py: Python<'_>, error: &RunError) -> PyErr {
    match error {
        RunError::Failed { failure, .. } => failed(py, failure, error),
        RunError::Directory(error) => output(py, error),
        RunError::Output { .. } => plain(py, "FolderError", error),
        RunError::Threads { .. } | RunError::Unsupported { .. } | RunError::Start { .. } => {
            plain(py, "SphorgeError", error)
        }
    }
}

fn failed(py: Python<'_>, failure: &FailureRecord, error: &RunError) -> PyErr {
    make(py, "RunFailed", &text_of(error), |details| {
        details.set_item("hint", hint_of(error))?;
        details.set_item("step", failure.step)?;
        details.set_item("time", failure.time)?;
        details.set_item("field", failure.field.as_deref())?;
        details.set_item("particle", failure.particle)?;
        details.set_item("body", failure.body.as_deref())?;
        details.set_item("position", failure.position)
    })
}

/// A run that could not go on.
pub(crate) fn resume(py: Python<'_>, error: &ResumeError) -> PyErr {
    match error {
        ResumeError::Run(error) => run(py, error),
        ResumeError::Deck(report) => deck(py, report),
        ResumeError::Directory(error) => output(py, error),
        ResumeError::NoCheckpoint { .. }
        | ResumeError::Unstepped { .. }
        | ResumeError::NotChangeable { .. }
        | ResumeError::Ended { .. }
        | ResumeError::EndPassed { .. }
        | ResumeError::Driven { .. }
        | ResumeError::Listed { .. } => plain(py, "SphorgeError", error),
    }
}

/// A sweep that could not be made.
pub(crate) fn sweep(py: Python<'_>, error: &SweepError) -> PyErr {
    match error {
        SweepError::Deck { source, .. } => of_deck(py, source, error),
        SweepError::Output(error) => output(py, error),
        SweepError::Another { .. } | SweepError::Locked { .. } => plain(py, "FolderError", error),
        SweepError::Varied { .. }
        | SweepError::Unsupported { .. }
        | SweepError::Unknown { .. }
        | SweepError::Stopped => plain(py, "SphorgeError", error),
    }
}

/// Fragments that cannot be found.
pub(crate) fn fragments(py: Python<'_>, error: &FragmentError) -> PyErr {
    match error {
        FragmentError::Output(error) => output(py, error),
        FragmentError::Deck { .. } | FragmentError::OtherParticles { .. } => plain(py, "FolderError", error),
        FragmentError::Choice(_) | FragmentError::Field { .. } | FragmentError::Option { .. } => {
            plain(py, "SphorgeError", error)
        }
    }
}

/// Something that an object of Python cannot be asked now.
pub(crate) fn misuse(message: &str) -> PyErr {
    PyRuntimeError::new_err(message.to_owned())
}
