//! What a picture of particles shows: frames read, projected, coloured by a field.

use super::{
    FieldPicture, PlotError, View,
    light::light,
    mark::Mark,
    spans::{NamedSpan, model_of, spans},
    view::Projection,
};
use crate::{
    output::{FrameFile, RunDirectory, read_series},
    particles::find_field,
};

/// The particles of one frame.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// Name of the run; empty if it is the only one.
    pub(super) name: String,
    pub(super) time: f64,
    /// Mean of the field over all particles of the frame, also those that a section leaves out.
    pub(super) mean: f64,
    pub(super) marks: Vec<Mark>,
    /// Measures to show.
    pub(super) spans: Vec<NamedSpan>,
}

/// Fields that are one or zero, and what zero and one mean.
const FLAGS: [(&str, [&str; 2]); 1] = [("adapted", ["kept", "searched"])];

/// All panels of a picture and what they have in common.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    /// Frames of the first run, then those of the next.
    pub(super) panels: Vec<Panel>,
    /// Frames of each run.
    pub(super) frames: usize,
    /// Words for zero and one, where the field has no other values.
    pub(super) flag: Option<[&'static str; 2]>,
    pub(super) view: View,
    pub(super) projection: Projection,
    /// More than one layer of particles towards the eye.
    pub(super) deep: bool,
    /// Particles on a line along x.
    pub(super) line: bool,
    /// Field and component for people, and its unit.
    pub(super) label: String,
    pub(super) unit: &'static str,
    /// Smallest and largest value shown.
    pub(super) extremes: (f64, f64),
    /// The values but for the outermost half percent on each side.
    pub(super) bulk: (f64, f64),
    /// Smallest and largest place shown, right then up, m.
    pub(super) window: [(f64, f64); 2],
}

impl Scene {
    pub(super) fn read(runs: &[(&str, &RunDirectory)], picture: &FieldPicture) -> Result<Self, PlotError> {
        let mut panels = Vec::new();
        let mut view = picture.view;
        let mut deep = false;
        let mut line = false;
        let (name, component) = match picture.field.split_once('.') {
            Some((name, component)) => (name, Some(component)),
            None => (picture.field.as_str(), None),
        };
        let mut label = String::new();
        for &(run_name, run) in runs {
            let series = read_series(run)?;
            let model = if picture.measures { Some(model_of(run)?) } else { None };
            for choice in &picture.frames {
                let mut frame = FrameFile::open(choice.pick(&series)?)?;
                deep |= frame.header.dimensions == 3;
                line |= frame.header.dimensions == 1;
                let view = *view.get_or_insert(if frame.header.dimensions == 3 { View::Corner } else { View::Xy });
                let values = values(&mut frame, name, component, &picture.field)?;
                label = field_label(name, component, values.width > 1);
                let spans = model.as_ref().map_or(Ok(Vec::new()), |model| spans(model, &mut frame))?;
                let section = picture.section.then_some(view);
                let panel = panel(&mut frame, view.projection(), values.values, section)?;
                panels.push(Panel { name: run_name.to_owned(), spans, ..panel });
            }
        }
        let marks = || panels.iter().flat_map(|panel: &Panel| &panel.marks);
        let mut values: Vec<f64> = marks().map(|mark| mark.value).filter(|value| value.is_finite()).collect();
        let side = |place: fn(&Mark) -> f64| {
            marks()
                .map(|mark| (place(mark), 0.5 * mark.spacing))
                .filter(|(x, _)| x.is_finite())
                .map(|(x, half)| (x - half, x + half))
                .reduce(wider)
        };
        let window = side(|mark| mark.right).zip(side(|mark| mark.up));
        let nothing = || PlotError::Empty { reason: "no particle with a finite position and value".into() };
        let ((right, up), (extremes, bulk)) = window.zip(ranges(&mut values)).ok_or_else(nothing)?;
        // Particles of no known size all in one place still take room.
        let size = (right.1 - right.0).max(up.1 - up.0);
        let room = if size > 0.0 { 1e-3 * size } else { 1.0 };
        let [right, up] =
            [right, up].map(|(low, high)| if high - low < room { (low - room, high + room) } else { (low, high) });
        let view = view.unwrap_or_default();
        Ok(Self {
            frames: picture.frames.len(),
            flag: FLAGS.iter().find(|(field, _)| *field == name).map(|(_, words)| *words),
            view,
            projection: view.projection(),
            deep,
            line,
            label,
            unit: find_field(name).map_or("", |field| field.unit),
            extremes,
            bulk,
            window: picture.window.unwrap_or([right, up]),
            panels,
        })
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

struct Values {
    width: usize,
    values: Vec<f64>,
}

/// One number a particle: the component, the scalar, or the norm.
fn values(frame: &mut FrameFile, name: &str, component: Option<&str>, asked: &str) -> Result<Values, PlotError> {
    let available = frame.arrays().iter().map(|array| array.name.as_str()).collect::<Vec<_>>().join(", ");
    let unknown = || PlotError::Field { name: asked.to_owned(), available };
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

/// The particles of a frame on the plane of the picture; with `section`, without those before the middle.
fn panel(
    frame: &mut FrameFile,
    projection: Projection,
    values: Vec<f64>,
    section: Option<View>,
) -> Result<Panel, PlotError> {
    let positions = frame.positions()?;
    let bodies = frame.column("body")?.map(|column| column.values);
    let spacings = &frame.header.body_spacing;
    let spacing = |i: usize| {
        let body = bodies.as_ref().map_or(0, |bodies| bodies[i] as usize);
        spacings.get(body).or(spacings.first()).copied().unwrap_or(0.0)
    };
    // A corner view is cut across the axis that points most towards the eye.
    let across: [f64; 3] = match section {
        Some(View::Corner) => [0.0, 0.0, 1.0],
        _ => projection.towards,
    };
    let depth = |p: &[f64; 3]| (0..3).map(|k| across[k] * p[k]).sum::<f64>();
    let span = positions.iter().map(depth).filter(|z| z.is_finite()).map(|z| (z, z)).reduce(wider);
    let limit = match (section, span) {
        // The middle layer of an odd number stays.
        (Some(_), Some((low, high))) => 0.5 * (low + high) + 1e-6 * (high - low),
        _ => f64::INFINITY,
    };
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let mut marks: Vec<Mark> = positions
        .iter()
        .zip(values)
        .enumerate()
        .filter(|(_, (p, _))| depth(p) <= limit)
        .map(|(i, (p, value))| {
            let [right, up, towards] = projection.apply(*p);
            Mark { right, up, towards, spacing: spacing(i), value, light: 1.0 }
        })
        .collect();
    if frame.header.dimensions == 3 {
        light(&mut marks);
    }
    Ok(Panel { name: String::new(), time: frame.header.time, mean, marks, spans: Vec::new() })
}
