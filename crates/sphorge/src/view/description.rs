//! What the page is told of a run, as JSON; particles and histories are told as numbers, not here.

use super::{
    ViewError,
    run::{BODY, Known, POSITION, fitting},
    text::explained,
};
use crate::{
    model::{Formulation, Model, SymmetryPlane, WallSurface},
    output::{FrameFile, RunDirectory, Summary},
    plot::{FLAG_COLORS, FLAGS, View, body_color, field_label, split, title_with},
};
use serde::Serialize;

/// What there is of a run now.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Description {
    name: String,
    title: String,
    /// In a word: that of the summary, or whether a run without one seems to go on.
    status: &'static str,
    /// Time that it has come to, s.
    reached: Option<f64>,
    /// Time at which the deck ends it, s.
    end: Option<f64>,
    /// Whether more frames may come.
    pub(super) is_open: bool,
    /// Tells whether it is still the same run.
    identity: String,
    /// What is wrong with the folder, if it cannot be read now.
    error: Option<String>,
    /// Names of the checks that have warned, as far as they are known: a run names them in its summary.
    pub(super) warnings: Vec<String>,
    /// How many have.
    warned: usize,
    pub(super) dimensions: usize,
    count: usize,
    /// Place that positions are counted from, m.
    origin: [f64; 3],
    /// Times of the frames, s.
    pub(super) times: Vec<f64>,
    pub(super) fields: Vec<FieldDescription>,
    bodies: Vec<BodyDescription>,
    /// Whether cells may follow from the deck.
    pub(super) has_cells: bool,
    /// Directions of view by name: axes to the right, up, towards the eye.
    views: Vec<(&'static str, [[f64; 3]; 3])>,
    /// Planes of symmetry in which images can be shown: axis and place, m.
    symmetry: Vec<(usize, f64)>,
    walls: Vec<WallDescription>,
    pub(super) columns: Vec<ColumnDescription>,
    /// Rows of the history.
    rows: usize,
}

/// A field.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct FieldDescription {
    pub(super) name: String,
    pub(super) label: String,
    pub(super) unit: String,
    pub(super) width: usize,
    pub(super) components: Vec<String>,
}

/// A column of the history.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ColumnDescription {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) meaning: String,
    pub(super) is_measure: bool,
}

#[derive(Clone, Debug, Serialize)]
struct BodyDescription {
    name: String,
    material: String,
    /// Between its particles at the start, m.
    spacing: f64,
    /// Where it is told by its colour.
    color: [u8; 3],
}

#[derive(Clone, Debug, Serialize)]
struct WallDescription {
    name: String,
    /// A point of a plane, or the first of a segment, m.
    point: [f64; 3],
    /// Normal of a plane, to the material.
    normal: Option<[f64; 3]>,
    /// The other end of a segment, m.
    to: Option<[f64; 3]>,
    /// How far it has moved at each frame, m; empty where it never does.
    moved: Vec<[f64; 3]>,
}

/// All of one particle.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Particle {
    pub(super) particle: usize,
    /// m.
    pub(super) position: [f64; 3],
    pub(super) body: Option<String>,
    pub(super) fields: Vec<ParticleField>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct ParticleField {
    pub(super) name: String,
    /// By component; not finite ones are `null`.
    pub(super) values: Vec<f64>,
}

/// A field that is one or zero: words and colours for zero and one.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Flag {
    name: &'static str,
    words: [&'static str; 2],
    colors: [[u8; 3]; 2],
}

/// All of them.
pub(super) fn flags() -> Vec<Flag> {
    FLAGS.iter().map(|(name, words)| Flag { name, words: *words, colors: FLAG_COLORS }).collect()
}

impl Description {
    fn empty(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            title: name.to_owned(),
            status: "without a frame",
            reached: None,
            end: None,
            is_open: true,
            identity: String::new(),
            error: None,
            warnings: Vec::new(),
            warned: 0,
            dimensions: 0,
            count: 0,
            origin: [0.0; 3],
            times: Vec::new(),
            fields: Vec::new(),
            bodies: Vec::new(),
            has_cells: false,
            views: Vec::new(),
            symmetry: Vec::new(),
            walls: Vec::new(),
            columns: Vec::new(),
            rows: 0,
        }
    }

    /// A run that has not written a frame.
    pub(super) fn waiting(name: &str, directory: &RunDirectory, known: &Known) -> Self {
        let end = known.model.as_ref().map(|model| model.time.end);
        let title = title_with(directory, known.model.as_deref());
        Self { title, status: going_on(directory), identity: known.identity.clone(), end, ..Self::empty(name) }
    }

    /// A folder that cannot be read.
    pub(super) fn broken(name: &str, error: &ViewError) -> Self {
        Self { status: "cannot be read", error: Some(explained(error)), ..Self::empty(name) }
    }

    /// A run with frames.
    pub(super) fn of(
        name: &str,
        directory: &RunDirectory,
        known: &Known,
        frame: &FrameFile,
        fields: Vec<FieldDescription>,
        times: Vec<f64>,
        origin: [f64; 3],
        (columns, rows, last): (Vec<ColumnDescription>, usize, Option<f64>),
    ) -> Self {
        let model = known.model.as_deref();
        let read = Summary::read(directory);
        let is_damaged = read.is_err() && directory.summary().exists();
        let summary = read.ok();
        let dimensions = frame.header.dimensions;
        let spacing = |k: usize| frame.header.body_spacing.get(k).or(frame.header.body_spacing.first()).copied();
        let bodies = frame.bodies.iter().enumerate().map(|(k, body)| BodyDescription {
            name: body.name.clone(),
            material: body.material.clone(),
            spacing: spacing(k).unwrap_or(0.0),
            color: body_color(k),
        });
        let axes = |view: View| {
            let projection = fitting(Some(view), dimensions, model).projection();
            [projection.right, projection.up, projection.towards]
        };
        let named = [("corner", View::Corner { up: None }), ("xy", View::Xy), ("xz", View::Xz), ("yz", View::Yz)];
        let views = if dimensions == 3 { &named[..] } else { &named[1..2] };
        Self {
            title: title_with(directory, model),
            status: match &summary {
                Some(summary) => summary.status.name(),
                None if is_damaged => "ended, with a damaged summary",
                None => going_on(directory),
            },
            // Rows are written more often than frames.
            reached: times.last().copied().into_iter().chain(last).reduce(f64::max),
            end: model.map(|model| model.time.end),
            is_open: summary.is_none() && !is_damaged,
            identity: known.identity.clone(),
            warnings: summary
                .iter()
                .flat_map(|summary| &summary.warnings)
                .map(|warning| warning.name.clone())
                .collect(),
            dimensions,
            count: frame.count,
            origin,
            fields,
            bodies: bodies.collect(),
            has_cells: model.is_some_and(|model| {
                matches!(model.formulation, Formulation::TotalLagrangian { .. }) && dimensions > 1
            }),
            views: views.iter().map(|(name, view)| (*name, axes(*view))).collect(),
            walls: model.map_or_else(Vec::new, |model| walls(model, &times)),
            columns,
            rows,
            times,
            ..Self::empty(name)
        }
    }
}

impl Description {
    /// The same with the checks that have warned: so many by the history, and as many of a run that goes on as were named when it last stopped.
    pub(super) fn with_warnings(mut self, warned: usize, named_before: &[String]) -> Self {
        if self.is_open {
            // They are in the order in which they were first seen, so that a run that goes on from an earlier state has the first of them.
            self.warnings = named_before.iter().take(warned).cloned().collect();
        }
        self.warned = warned.max(self.warnings.len());
        self
    }

    /// The same with planes in which images can be shown.
    pub(super) fn with_images<'a>(mut self, planes: impl Iterator<Item = &'a SymmetryPlane>) -> Self {
        self.symmetry = planes.map(|plane| (plane.axis, plane.position)).collect();
        self
    }

    /// The same for a page that has some frames, and these arrays of them.
    pub(super) fn of_frames(mut self, kept: &[usize], names: &[String]) -> Self {
        let times = &self.times;
        self.times = kept.iter().filter_map(|frame| times.get(*frame).copied()).collect();
        for wall in &mut self.walls {
            let moved = &wall.moved;
            wall.moved = kept.iter().filter_map(|frame| moved.get(*frame).copied()).collect();
        }
        // A component is a field of its own there.
        let single = |name: &String| {
            let (field, component) = split(name);
            let field = self.fields.iter().find(|known| known.name == field)?;
            let label = field_label(&field.name, component, component.is_none() && field.width > 1);
            Some(FieldDescription { name: name.clone(), label, width: 1, components: Vec::new(), ..field.clone() })
        };
        let is_field = |name: &&String| name.as_str() != POSITION;
        let mut fields: Vec<FieldDescription> = names.iter().filter(is_field).filter_map(single).collect();
        fields.extend(self.fields.iter().filter(|field| field.name == BODY).cloned());
        self.fields = fields;
        self.is_open = false;
        self
    }
}

/// What a run without a summary does.
fn going_on(directory: &RunDirectory) -> &'static str {
    if directory.is_written() { "running" } else { "interrupted" }
}

fn walls(model: &Model, times: &[f64]) -> Vec<WallDescription> {
    let described = |wall: &crate::model::Wall| {
        let at =
            |time: f64| -> [f64; 3] { std::array::from_fn(|axis| wall.velocity[axis].integral(0.0, time.max(0.0))) };
        let moved: Vec<[f64; 3]> = times.iter().map(|time| at(*time)).collect();
        let stands = moved.iter().all(|moved| moved.iter().all(|x| *x == 0.0));
        let (point, normal, to) = match wall.surface {
            WallSurface::Plane { point, normal } => (point, Some(normal), None),
            WallSurface::Segment { from, to } => (from, None, Some(to)),
        };
        WallDescription {
            name: wall.name.to_string(),
            point,
            normal,
            to,
            moved: if stands { Vec::new() } else { moved },
        }
    };
    model.walls.iter().map(described).collect()
}
