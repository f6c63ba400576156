//! What a picture of particles shows: frames read, projected, coloured by a field.

use super::{
    FieldPicture, PlotError, View,
    light::light,
    mark::Mark,
    mirror::{Sample, mirror},
    spans::{NamedSpan, model_of, spans},
    view::Projection,
    walls::{Bounds, PlacedWall, walls},
};
use crate::{
    deck::{did_you_mean, load_model, names_like},
    model::Model,
    output::{FrameFile, RunDirectory, read_series},
    particles::find_field,
};
use std::path::{Path, PathBuf};

/// The particles of one frame.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// Name of the run; empty if it is the only one.
    pub(super) name: String,
    pub(super) time: f64,
    /// Mean of the field over all particles of the frame, also those that a section leaves out.
    pub(super) mean: f64,
    /// Number of particles of the frame that are shown, images in planes of symmetry left out.
    pub(super) count: usize,
    pub(super) marks: Vec<Mark>,
    pub(super) walls: Vec<PlacedWall>,
    /// Measures to show.
    pub(super) spans: Vec<NamedSpan>,
}

/// Fields that are one or zero, and what zero and one mean.
const FLAGS: [(&str, [&str; 2]); 1] = [("adapted", ["kept", "searched"])];

/// What panels have in common: what is shown, and how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub(super) view: View,
    /// More than one layer of particles towards the eye.
    pub(super) deep: bool,
    /// Particles on a line along x.
    pub(super) line: bool,
    /// The field has several components, of which none is chosen.
    norm: bool,
}

/// The places and values of panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    /// Smallest and largest value shown.
    pub(super) extremes: (f64, f64),
    /// The values but for the outermost half percent on each side.
    pub(super) bulk: (f64, f64),
    /// Smallest and largest place shown, right then up, m.
    pub(super) window: [(f64, f64); 2],
}

/// All panels of a picture and what they have in common.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    /// Frames of the first run, then those of the next.
    pub(super) panels: Vec<Panel>,
    /// Frames of each run.
    pub(super) frames: usize,
    /// Words for zero and one, where the field has no other values.
    pub(super) flag: Option<[&'static str; 2]>,
    pub(super) look: Look,
    pub(super) projection: Projection,
    /// Field and component for people, and its unit.
    pub(super) label: String,
    pub(super) unit: &'static str,
    pub(super) extent: Extent,
}

/// A run whose frames are pictured.
pub(super) struct Source {
    name: String,
    /// Times and files of its frames.
    pub(super) series: Vec<(f64, PathBuf)>,
    /// The deck, for walls and planes of symmetry; a run whose deck cannot be read is pictured without.
    model: Option<Model>,
    measures: bool,
}

impl Source {
    pub(super) fn open(name: &str, run: &RunDirectory, picture: &FieldPicture) -> Result<Self, PlotError> {
        let series = read_series(run)?;
        let model = if picture.measures { Some(model_of(run)?) } else { load_model(&run.deck()).ok() };
        if picture.mirror && model.as_ref().is_none_or(|model| model.symmetry.is_empty()) {
            return Err(PlotError::Empty { reason: "the deck has no plane of symmetry to mirror in".to_owned() });
        }
        Ok(Self { name: name.to_owned(), series, model, measures: picture.measures })
    }

    /// Reads one frame.
    pub(super) fn panel(&self, file: &Path, picture: &FieldPicture) -> Result<(Panel, Look), PlotError> {
        let (field, component) = split(&picture.field);
        let mut frame = FrameFile::open(file)?;
        let dimensions = frame.header.dimensions;
        let view = picture.view.unwrap_or(if dimensions == 3 { View::Corner } else { View::Xy });
        let values = values(&mut frame, field, component, &picture.field)?;
        let look = Look { view, deep: dimensions == 3, line: dimensions == 1, norm: values.width > 1 };
        let spans = match &self.model {
            Some(model) if self.measures => spans(model, &mut frame)?,
            _ => Vec::new(),
        };
        let mean = values.values.iter().sum::<f64>() / values.values.len().max(1) as f64;
        let samples = samples(&mut frame, values.values)?;
        let (samples, count) = self.shown(samples, picture, view);
        let projection = view.projection();
        let placed = match (&self.model, bounds(&samples)) {
            (Some(model), Some(bounds)) => walls(model, frame.header.time, &projection, &bounds),
            _ => Vec::new(),
        };
        let project = |sample: &Sample| {
            let [right, up, towards] = projection.apply(sample.position);
            Mark { right, up, towards, spacing: sample.spacing, value: sample.value, light: 1.0 }
        };
        let mut marks: Vec<Mark> = samples.iter().map(project).collect();
        if look.deep {
            light(&mut marks);
        }
        let time = frame.header.time;
        Ok((Panel { name: self.name.clone(), time, mean, count, marks, walls: placed, spans }, look))
    }

    /// What a picture shows of the particles, and how many of them are no images.
    fn shown(&self, mut samples: Vec<Sample>, picture: &FieldPicture, view: View) -> (Vec<Sample>, usize) {
        let planes = self.model.as_ref().map_or(&[][..], |model| &model.symmetry[..]);
        let (_, component) = split(&picture.field);
        let own = samples.len();
        let across = picture.section.then(|| section_axis(view, &samples));
        for plane in planes {
            // A cut goes through the plane of symmetry, where the whole body has its middle.
            if picture.mirror || across == Some(plane.axis) {
                mirror(&mut samples, plane, component.unwrap_or_default());
            }
        }
        let Some(across) = across else { return (samples, own) };
        let side = if view.projection().towards[across] < 0.0 { -1.0 } else { 1.0 };
        let depth = |sample: &Sample| side * sample.position[across];
        let span = samples.iter().map(depth).filter(|z| z.is_finite()).map(|z| (z, z)).reduce(wider);
        let plane = planes.iter().find(|plane| plane.axis == across);
        // The middle layer of an odd number stays.
        let limit = span.map_or(f64::INFINITY, |(low, high)| {
            plane.map_or(0.5 * (low + high), |plane| side * plane.position) + 1e-6 * (high - low)
        });
        let kept = |(k, sample): (usize, Sample)| (depth(&sample) <= limit).then_some((k, sample));
        let kept: Vec<_> = samples.into_iter().enumerate().filter_map(kept).collect();
        // An image stands where its particle does in the order of a copy: those of one particle count once.
        let mut shown = vec![false; own];
        kept.iter().for_each(|(k, _)| shown[k % own] = true);
        let count = shown.into_iter().filter(|shown| *shown).count();
        (kept.into_iter().map(|(_, sample)| sample).collect(), count)
    }
}

/// The axis a section is across: towards the eye, and from a corner along the body where that is long.
fn section_axis(view: View, samples: &[Sample]) -> usize {
    match view {
        View::Xy => 2,
        View::Xz => 1,
        View::Yz => 0,
        View::Corner => {
            let size = bounds(samples).map_or([0.0; 3], |bounds| bounds.map(|(low, high)| high - low));
            if size[2] > 1.5 * size[0].max(size[1]) { 0 } else { 2 }
        }
    }
}

impl Scene {
    pub(super) fn read(runs: &[(&str, &RunDirectory)], picture: &FieldPicture) -> Result<Self, PlotError> {
        let mut panels = Vec::new();
        for &(name, run) in runs {
            let source = Source::open(name, run, picture)?;
            for choice in &picture.frames {
                panels.push(source.panel(choice.pick(&source.series)?, picture)?);
            }
        }
        let extent = panels.iter().filter_map(|(panel, _)| panel.extent()).reduce(Extent::joined);
        Self::of(panels, extent, picture)
    }

    /// A picture of panels at a given extent.
    pub(super) fn of(
        panels: Vec<(Panel, Look)>,
        extent: Option<Extent>,
        picture: &FieldPicture,
    ) -> Result<Self, PlotError> {
        let nothing = || PlotError::Empty { reason: "no particle with a finite position and value".into() };
        let (extent, first) = extent.zip(panels.first().map(|panel| panel.1)).ok_or_else(nothing)?;
        // The view of the first frame is that of all; runs of unlike dimensions are seen together as the deepest.
        let deep = panels.iter().any(|(_, look)| look.deep);
        let line = panels.iter().all(|(_, look)| look.line);
        let look = Look { deep, line, ..first };
        let (name, component) = split(&picture.field);
        Ok(Self {
            frames: picture.frames.len(),
            flag: FLAGS.iter().find(|(field, _)| *field == name).map(|(_, words)| *words),
            projection: look.view.projection(),
            label: field_label(name, component, look.norm),
            look,
            unit: find_field(name).map_or("", |field| field.unit),
            extent: Extent { window: picture.window.unwrap_or(roomy(extent.window)), ..extent },
            panels: panels.into_iter().map(|(panel, _)| panel).collect(),
        })
    }
}

/// Particles of no known size all in one place still take room.
fn roomy([right, up]: [(f64, f64); 2]) -> [(f64, f64); 2] {
    let size = (right.1 - right.0).max(up.1 - up.0);
    let room = if size > 0.0 { 1e-3 * size } else { 1.0 };
    [right, up].map(|(low, high)| if high - low < room { (low - room, high + room) } else { (low, high) })
}

impl Panel {
    /// Where its particles and walls are and what their values are; none without a particle that has a place and a value.
    pub(super) fn extent(&self) -> Option<Extent> {
        let mut values: Vec<f64> = self.marks.iter().map(|mark| mark.value).filter(|value| value.is_finite()).collect();
        let side = |place: fn(&Mark) -> f64| {
            let places = self.marks.iter().map(|mark| (place(mark), 0.5 * mark.spacing));
            places.filter(|(x, _)| x.is_finite()).map(|(x, half)| (x - half, x + half)).reduce(wider)
        };
        let window = [side(|mark| mark.right)?, side(|mark| mark.up)?];
        let (extremes, bulk) = ranges(&mut values)?;
        let reached = self.walls.iter().flat_map(|wall| wall.reach(window));
        let window = reached.fold(window, |[right, up], [x, y]| [wider(right, (x, x)), wider(up, (y, y))]);
        Some(Extent { extremes, bulk, window })
    }
}

impl Extent {
    pub(super) fn joined(self, other: Self) -> Self {
        Self {
            extremes: wider(self.extremes, other.extremes),
            bulk: wider(self.bulk, other.bulk),
            window: [0, 1].map(|k| wider(self.window[k], other.window[k])),
        }
    }
}

/// Smallest and largest value, and the same without the outermost half percent on each side.
fn ranges(values: &mut [f64]) -> Option<((f64, f64), (f64, f64))> {
    let outside = values.len() / 200;
    let last = values.len().checked_sub(1)?;
    let mut at = |k: usize| *values.select_nth_unstable_by(k, f64::total_cmp).1;
    Some(((at(0), at(last)), (at(outside), at(last - outside))))
}

fn wider(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

fn bounds(samples: &[Sample]) -> Option<Bounds> {
    let finite = samples.iter().map(|sample| sample.position).filter(|p| p.iter().all(|x| x.is_finite()));
    finite.map(|p| p.map(|x| (x, x))).reduce(|a, b| std::array::from_fn(|k| wider(a[k], b[k])))
}

/// Name and component of a field as it is asked for.
fn split(field: &str) -> (&str, Option<&str>) {
    field.split_once('.').map_or((field, None), |(name, component)| (name, Some(component)))
}

struct Values {
    width: usize,
    values: Vec<f64>,
}

/// One number a particle: the component, the scalar, or the norm.
fn values(frame: &mut FrameFile, name: &str, component: Option<&str>, asked: &str) -> Result<Values, PlotError> {
    let available = frame.arrays().iter().map(|array| array.name.as_str()).collect::<Vec<_>>().join(", ");
    let names = || frame.arrays().iter().map(|array| array.name.as_str());
    // One that is there lacks the component.
    let near = if names().any(|known| known == name) { String::new() } else { did_you_mean(names_like(name, names())) };
    let unknown = || PlotError::Field { name: asked.to_owned(), near, available };
    let array = frame.arrays().iter().find(|array| array.name == name).cloned();
    let Some((array, column)) = array.zip(frame.column(name)?) else { return Err(unknown()) };
    let rows = column.values.chunks_exact(column.width.max(1));
    let values = match component {
        Some(component) => {
            let k = array.components.iter().position(|c| c.eq_ignore_ascii_case(component)).ok_or_else(unknown)?;
            rows.map(|row| f64::from(row[k])).collect()
        }
        None if column.width == 1 => rows.map(|row| f64::from(row[0])).collect(),
        None => {
            // The off-diagonal components of a symmetric tensor stand for two.
            let weight = |k: usize| if column.width == 6 && k >= 3 { 2.0 } else { 1.0 };
            let square = |(k, x): (usize, &f32)| weight(k) * f64::from(*x).powi(2);
            rows.map(|row| row.iter().enumerate().map(square).sum::<f64>().sqrt()).collect()
        }
    };
    Ok(Values { width: if component.is_some() { 1 } else { column.width }, values })
}

fn field_label(name: &str, component: Option<&str>, is_norm: bool) -> String {
    let words = name.replace('_', " ").replace("von mises", "von Mises");
    match component {
        Some(component) => format!("{words} {}", component.to_lowercase()),
        None if is_norm => format!("magnitude of {words}"),
        None => words,
    }
}

/// The particles of a frame.
fn samples(frame: &mut FrameFile, values: Vec<f64>) -> Result<Vec<Sample>, PlotError> {
    let positions = frame.positions()?;
    let bodies = frame.column("body")?.map(|column| column.values);
    let spacings = &frame.header.body_spacing;
    let spacing = |i: usize| {
        let body = bodies.as_ref().map_or(0, |bodies| bodies[i] as usize);
        spacings.get(body).or(spacings.first()).copied().unwrap_or(0.0)
    };
    let sample = |(i, (position, value))| Sample { position, value, spacing: spacing(i) };
    Ok(positions.into_iter().zip(values).enumerate().map(sample).collect())
}
