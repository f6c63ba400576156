//! What can go wrong with a picture.

use crate::{deck::DeckReport, output::OutputError};
use std::path::PathBuf;

/// Why there is no picture.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PlotError {
    /// A file of the run cannot be read, or the picture cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(#[from] OutputError),
    /// The frames do not have that field.
    #[error("the frames have no field `{name}`")]
    #[diagnostic(
        code(sphorge::plot::field),
        help("{near}the frames have: {available}; a component is written as in `stress.xy`")
    )]
    Field {
        /// What was asked for.
        name: String,
        /// The fields that it may be a slip for, as a question.
        near: String,
        /// What there is.
        available: String,
    },
    /// The frames do not have that body.
    #[error("the frames have no body `{name}`")]
    #[diagnostic(code(sphorge::plot::body), help("{near}the frames have: {available}"))]
    Body {
        /// What was asked for.
        name: String,
        /// The bodies that it may be a slip for, as a question.
        near: String,
        /// What there is.
        available: String,
    },
    /// The history does not have that column.
    #[error("the history has no column `{name}`")]
    #[diagnostic(code(sphorge::plot::column), help("{near}the history has: {available}"))]
    Column {
        /// What was asked for.
        name: String,
        /// The columns that it may be a slip for, as a question.
        near: String,
        /// What there is.
        available: String,
    },
    /// The deck of the run, which says what is measured, cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(DeckReport),
    /// The run does not have that frame.
    #[error("there is no frame {number}: {there}")]
    #[diagnostic(code(sphorge::plot::frame), help("choose one of them, `first`, `last`, or a time such as \"12 us\""))]
    Frame {
        /// Its number.
        number: usize,
        /// The frames that there are.
        there: String,
    },
    /// There is nothing to draw.
    #[error("there is nothing to draw: {reason}")]
    #[diagnostic(code(sphorge::plot::empty))]
    Empty {
        /// What is missing.
        reason: String,
    },
    /// The deck does not have the planes of symmetry in which images are to be shown.
    #[error("there are no images to show: {reason}")]
    #[diagnostic(
        code(sphorge::plot::mirror),
        help("leave out `--mirror`, or name planes by their axes: `--mirror=x,y`")
    )]
    Mirror {
        /// What planes there are.
        reason: String,
    },
    /// A section is beside all bodies.
    #[error("the section cuts nothing: it is at {place} ({along}), and the bodies are between {low} and {high}")]
    #[diagnostic(code(sphorge::plot::section), help("choose a place between; `--section` alone cuts in the middle"))]
    Section {
        /// Axis or direction in which places are measured.
        along: String,
        /// Where it is.
        place: String,
        /// Where bodies begin.
        low: String,
        /// Where they end.
        high: String,
    },
    /// A section along a plane in which all particles are.
    #[error("the section cuts nothing: it lies in the plane of the problem")]
    #[diagnostic(
        code(sphorge::plot::flat_section),
        help("leave out `--section`: the picture shows all of the plane; `--section=x` cuts along an axis")
    )]
    FlatSection,
    /// The page is too small or too large.
    #[error("a picture of {width} x {height} pixels cannot be made")]
    #[diagnostic(code(sphorge::plot::size), help("choose sides between 200 and 20000 pixels"))]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The name of the file asks for a form that is not written.
    #[error("{} is not the name of a picture", path.display())]
    #[diagnostic(code(sphorge::plot::format), help("end it with .png or .svg; an animation is a .png"))]
    Format {
        /// The name.
        path: PathBuf,
    },
    /// The picture could not be encoded.
    #[error("the picture could not be encoded: {reason}")]
    #[diagnostic(code(sphorge::plot::encode))]
    Encode {
        /// What the encoder said.
        reason: String,
    },
}

impl From<png::EncodingError> for PlotError {
    fn from(error: png::EncodingError) -> Self {
        Self::Encode { reason: error.to_string() }
    }
}
