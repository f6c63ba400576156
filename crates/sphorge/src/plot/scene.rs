//! What a picture of particles shows: frames read, projected, coloured by a field.

use super::{
    FieldPicture, PlotError, View,
    cell::{HalfSpace, dot},
    derived::Derived,
    filter::kept,
    light::light,
    mark::Mark,
    mirror::{Sample, mirror, mirrored},
    section::{Section, axis_of},
    solid::{Cells, Solid},
    spans::{NamedSpan, model_of, spans},
    view::{Projection, upright},
    walls::{Bounds, PlacedWall, walls},
};
use crate::{
    cells::{Deformation, JoinedCells, NONE, Nodes},
    deck::{did_you_mean, load_model, names_like},
    geometry::cell_corners,
    model::{Formulation, Model, SymmetryPlane},
    number::quantity,
    output::{FrameFile, OutputError, RunDirectory, field_unit, read_series},
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
    /// Number of particles of the frame, shown or not.
    pub(super) of: usize,
    pub(super) marks: Vec<Mark>,
    /// Bodies in space, where the cells of particles are known.
    pub(super) solid: Solid,
    /// The plane of a section: to the right, up, towards the eye, m.
    pub(super) cut: Option<HalfSpace>,
    /// Of a plane that was given and cuts nothing, what there is to cut.
    missed: Option<Missed>,
    /// Of a section along which all particles are, as it can be in a plane problem.
    is_flat: bool,
    pub(super) walls: Vec<PlacedWall>,
    /// Measures to show.
    pub(super) spans: Vec<NamedSpan>,
}

/// A section beside all bodies, along its normal, m.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Missed {
    along: String,
    place: f64,
    bodies: (f64, f64),
}

/// Refuses a section that meets no body in any panel.
///
/// # Errors
/// [`PlotError::Section`], which says where bodies are; [`PlotError::FlatSection`] where all bodies lie along it.
pub(super) fn meets<'a>(panels: impl IntoIterator<Item = &'a Panel> + Clone) -> Result<(), PlotError> {
    let mut all = panels.clone().into_iter().peekable();
    if all.peek().is_some() && all.all(|panel| panel.is_flat) {
        return Err(PlotError::FlatSection);
    }
    cuts_something(panels.into_iter().map(|panel| panel.missed.clone()))
}

/// The same of what each picture misses; none of one that the section meets.
///
/// # Errors
/// [`PlotError::Section`].
pub(crate) fn cuts_something(pictures: impl IntoIterator<Item = Option<Missed>>) -> Result<(), PlotError> {
    let mut around: Option<Missed> = None;
    for missed in pictures {
        let Some(missed) = missed else { return Ok(()) };
        let bodies = around.map_or(missed.bodies, |other| wider(other.bodies, missed.bodies));
        around = Some(Missed { bodies, ..missed });
    }
    let Some(Missed { along, place, bodies: (low, high) }) = around else { return Ok(()) };
    // Ends that miss zero by round-off are zero.
    let round_off = 1e-9 * (high - low).max(place.abs());
    let [place, low, high] = [place, low, high].map(|x| quantity(if x.abs() < round_off { 0.0 } else { x }, "m"));
    Err(PlotError::Section { along, place, low, high })
}

/// Fields that are one or zero, and what zero and one mean.
pub(crate) const FLAGS: [(&str, [&str; 2]); 1] = [("adapted", ["kept", "searched"])];

/// Of so many frames one may be left out at each end where limits are chosen.
const FRAMES_LEFT_OUT: usize = 10;

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

/// A panel, what it has in common with others, and the names of its bodies.
pub(super) struct Shown {
    pub(super) panel: Panel,
    pub(super) look: Look,
    bodies: Vec<String>,
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
    /// Names of bodies, where these are what is coloured.
    pub(super) bodies: Vec<String>,
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
    /// Cells of the particles, where they follow from the deck.
    cells: JoinedCells,
}

/// What a picture shows of the particles that are kept.
struct Left {
    samples: Vec<Sample>,
    /// How many of them are no images.
    count: usize,
    /// The plane of a section.
    cut: Option<HalfSpace>,
    /// Of one that cuts nothing.
    missed: Option<Missed>,
    /// Whether it goes along all axes of the problem.
    is_flat: bool,
    /// Planes in which images stand, with their numbers in the deck.
    mirrors: Vec<(usize, SymmetryPlane)>,
    /// Number of each before the section, images of the first plane after the particles themselves, and so on.
    numbers: Vec<usize>,
}

impl Source {
    pub(super) fn open(name: &str, run: &RunDirectory, picture: &FieldPicture) -> Result<Self, PlotError> {
        let series = read_series(run)?;
        let model = if picture.measures { Some(model_of(run)?) } else { load_model(&run.deck()).ok() };
        // Refuses planes that the deck does not have.
        let _ = mirrored(model.as_ref(), picture.mirror)?;
        let is_total = |model: &&Model| matches!(model.formulation, Formulation::TotalLagrangian { .. });
        let cells = match (model.as_ref().filter(is_total), series.first()) {
            (Some(model), Some((_, first))) => joined_cells(model, &mut FrameFile::open(first)?)?,
            _ => JoinedCells::default(),
        };
        Ok(Self { name: name.to_owned(), series, model, measures: picture.measures, cells })
    }

    /// Reads one frame.
    pub(super) fn panel(&self, file: &Path, picture: &FieldPicture) -> Result<Shown, PlotError> {
        let (field, component) = split(&picture.field);
        let mut frame = FrameFile::open(file)?;
        let dimensions = frame.header.dimensions;
        let view = picture.view.unwrap_or(if dimensions == 3 { View::Corner { up: None } } else { View::Xy });
        let view = self.model.as_ref().map_or(view, |model| view.with_up(upright(model)));
        let values = values(&mut frame, field, component, &picture.field, || self.start())?;
        let look = Look { view, deep: dimensions == 3, line: dimensions == 1, norm: values.width > 1 };
        let spans = match &self.model {
            Some(model) if self.measures => spans(model, &mut frame)?,
            _ => Vec::new(),
        };
        let mean = values.values.iter().sum::<f64>() / values.values.len().max(1) as f64;
        let positions = frame.positions()?;
        let deformation = Deformation::read(&mut frame)?;
        let nodes = deformation.map_or_else(Nodes::default, |of| self.cells.at(&positions, &of));
        let mut samples = samples(&mut frame, values.values, &positions, &self.cells.corners(&positions, &nodes))?;
        let kept = kept(&mut frame, picture, |frame, field| {
            let (name, component) = split(field);
            Ok(self::values(frame, name, component, field, || self.start())?.values)
        })?;
        let is_kept = |i: usize| kept.as_ref().is_none_or(|kept| kept[i]);
        let own: Vec<u32> = (0..positions.len() as u32).filter(|i| is_kept(*i as usize)).collect();
        if kept.is_some() {
            let mut k = 0..;
            samples.retain(|_| k.next().is_some_and(is_kept));
        }
        let Left { samples, count, cut, missed, is_flat, mirrors, numbers } = self.left(samples, picture, &look);
        let projection = view.projection();
        let mut solid = Solid::default();
        if look.deep && !nodes.places.is_empty() {
            let mut marks = vec![NONE; positions.len() << mirrors.len()];
            for (mark, number) in numbers.iter().enumerate() {
                let (image, particle) = (number / own.len(), own[number % own.len()] as usize);
                marks[image * positions.len() + particle] = mark as u32;
            }
            let spacing = samples.iter().map(|sample| sample.spacing).fold(0.0, f64::max);
            let cells = Cells {
                joined: &self.cells,
                nodes: &nodes,
                positions: &positions,
                is_kept: kept.as_deref(),
                mirrors: &mirrors,
                marks: &marks,
                cut: cut.map(|cut| (cut, spacing)),
            };
            solid = Solid::new(&cells, &projection);
        }
        let placed = match (&self.model, bounds(&samples)) {
            (Some(model), Some(bounds)) => walls(model, frame.header.time, &projection, &bounds),
            _ => Vec::new(),
        };
        let mut marks: Vec<Mark> = samples.iter().map(|sample| sample.mark(&projection)).collect();
        if look.deep {
            light(&mut marks);
        }
        let time = frame.header.time;
        let cut = cut.map(|cut| HalfSpace { normal: projection.apply(cut.normal), ..cut });
        let panel = Panel {
            name: self.name.clone(),
            time,
            mean,
            count,
            of: positions.len(),
            marks,
            solid,
            cut,
            missed,
            is_flat,
            walls: placed,
            spans,
        };
        let bodies = frame.bodies.iter().map(|body| body.name.clone());
        Ok(Shown { panel, look, bodies: if picture.field == "body" { bodies.collect() } else { Vec::new() } })
    }

    /// Positions of the particles in the first frame, m.
    fn start(&self) -> Result<Vec<[f64; 3]>, PlotError> {
        let nothing = || PlotError::Empty { reason: "the run has no frame".to_owned() };
        let (_, first) = self.series.first().ok_or_else(nothing)?;
        Ok(FrameFile::open(first)?.positions()?)
    }

    /// What a picture shows of the particles.
    fn left(&self, mut samples: Vec<Sample>, picture: &FieldPicture, look: &Look) -> Left {
        let planes = mirrored(self.model.as_ref(), picture.mirror).unwrap_or_default();
        let (_, component) = split(&picture.field);
        let own = samples.len();
        let size = bounds(&samples).map_or([0.0; 3], |bounds| bounds.map(|(low, high)| high - low));
        let cut = picture.section.map(|section| (section, section.normal(look.view, size)));
        let middle = picture.section == Some(Section::Middle);
        let across = cut.and_then(|(_, normal)| axis_of(normal)).filter(|_| middle);
        // A cut goes through the plane of symmetry, where the whole body has its middle.
        let is_shown = |plane: &SymmetryPlane| picture.mirror.is_some() || across == Some(plane.axis);
        let mirrors: Vec<_> = planes.iter().copied().filter(|(_, plane)| is_shown(plane)).collect();
        for (_, plane) in &mirrors {
            mirror(&mut samples, plane, component.unwrap_or_default());
        }
        let Some((section, normal)) = cut else {
            let numbers = (0..samples.len()).collect();
            return Left { samples, count: own, cut: None, missed: None, is_flat: false, mirrors, numbers };
        };
        let axes = if look.line { 1 } else { 2 + usize::from(look.deep) };
        let is_flat = normal[..axes].iter().all(|x| x.abs() < 1e-9);
        let missed = missed(samples.iter().map(|sample| (sample.position, sample.spacing)), section);
        let depth = |sample: &Sample| dot(normal, sample.position);
        let span = samples.iter().map(depth).filter(|z| z.is_finite()).map(|z| (z, z)).reduce(wider);
        let given = match section {
            Section::Across { point: Some(point), .. } => Some(dot(normal, point)),
            Section::Across { point: None, .. } | Section::Middle => {
                let plane = across.and_then(|axis| planes.iter().find(|(_, plane)| plane.axis == axis));
                plane.map(|(_, plane)| normal[plane.axis] * plane.position)
            }
        };
        // The middle layer of an odd number stays.
        let offset =
            span.map_or(f64::INFINITY, |(low, high)| given.unwrap_or(0.5 * (low + high)) + 1e-6 * (high - low));
        // A cell in space is cut by the plane, a ball stays whole.
        let lowest = |sample: &Sample| {
            let corners = sample.cell.iter().flatten().filter(|_| look.deep);
            let from_middle = corners.map(|corner| dot(normal, corner.map(f64::from))).fold(0.0, f64::min);
            depth(sample) + from_middle
        };
        // A cell that only touches the plane is not seen.
        let touching = |sample: &Sample| if sample.cell.is_some() && look.deep { 1e-3 * sample.spacing } else { 0.0 };
        let kept =
            |(k, sample): (usize, Sample)| (lowest(&sample) + touching(&sample) <= offset).then_some((k, sample));
        let kept: Vec<_> = samples.into_iter().enumerate().filter_map(kept).collect();
        // An image stands where its particle does in the order of a copy: those of one particle count once.
        let mut shown = vec![false; own];
        kept.iter().for_each(|(k, _)| shown[k % own] = true);
        let count = shown.into_iter().filter(|shown| *shown).count();
        let (numbers, samples) = kept.into_iter().unzip();
        Left { samples, count, cut: Some(HalfSpace { normal, offset }), missed, is_flat, mirrors, numbers }
    }
}

impl Sample {
    /// Where it is on the plane of a picture.
    fn mark(&self, projection: &Projection) -> Mark {
        let [right, up, towards] = projection.apply(self.position);
        let turned = |corner: [f32; 3]| projection.apply(corner.map(f64::from)).map(|x| x as f32);
        let cell = self.cell.map(|corners| corners.map(turned));
        let (spacing, value, body) = (self.spacing, self.value, self.body);
        Mark { right, up, towards, spacing, value, light: 1.0, body, cell }
    }
}

impl Scene {
    pub(super) fn read(runs: &[(&str, &RunDirectory)], picture: &FieldPicture) -> Result<Self, PlotError> {
        let mut panels: Vec<Shown> = Vec::new();
        for &(name, run) in runs {
            let source = Source::open(name, run, picture)?;
            for choice in &picture.frames {
                // All are seen as the first is.
                let view = panels.first().map(|first| first.look.view).or(picture.view);
                let picture = FieldPicture { view, ..picture.clone() };
                panels.push(source.panel(choice.pick(&source.series)?, &picture)?);
            }
        }
        meets(panels.iter().map(|shown| &shown.panel))?;
        let extents: Vec<Extent> = panels.iter().filter_map(|shown| shown.panel.extent()).collect();
        Self::of(panels, Extent::of(&extents), picture)
    }

    /// A picture of panels at a given extent.
    pub(super) fn of(panels: Vec<Shown>, extent: Option<Extent>, picture: &FieldPicture) -> Result<Self, PlotError> {
        let reason = match picture.conditions.is_empty() {
            true => "no particle has a finite position and value",
            false => "no particle meets the conditions",
        };
        let nothing = || PlotError::Empty { reason: reason.to_owned() };
        let (extent, first) = extent.zip(panels.first().map(|shown| shown.look)).ok_or_else(nothing)?;
        // The view of the first frame is that of all; runs of unlike dimensions are seen together as the deepest.
        let deep = panels.iter().any(|shown| shown.look.deep);
        let line = panels.iter().all(|shown| shown.look.line);
        let look = Look { deep, line, ..first };
        let (name, component) = split(&picture.field);
        Ok(Self {
            frames: picture.frames.len(),
            flag: FLAGS.iter().find(|(field, _)| *field == name).map(|(_, words)| *words),
            bodies: panels
                .iter()
                .map(|shown| &shown.bodies)
                .max_by_key(|names| names.len())
                .cloned()
                .unwrap_or_default(),
            projection: look.view.projection(),
            label: field_label(name, component, look.norm),
            look,
            unit: find_field(name).map_or("", |field| field_unit(field, if line { 1 } else { 2 + usize::from(deep) })),
            extent: Extent { window: picture.window.unwrap_or(roomy(extent.window)), ..extent },
            panels: panels.into_iter().map(|shown| shown.panel).collect(),
        })
    }
}

/// What there is to cut where a plane that was given cuts nothing, of particles at places with their spacings, m.
pub(crate) fn missed(particles: impl Iterator<Item = ([f64; 3], f64)>, section: Section) -> Option<Missed> {
    let Section::Across { normal, point: Some(point) } = section else { return None };
    let length = dot(normal, normal).sqrt();
    let normal = normal.map(|x| x / length);
    let side = |(position, spacing): ([f64; 3], f64)| {
        let middle = dot(normal, position);
        (middle - 0.5 * spacing, middle + 0.5 * spacing)
    };
    let bodies = particles.map(side).filter(|(low, _)| low.is_finite()).reduce(wider)?;
    let place = dot(normal, point);
    let along = axis_of(normal).map_or("along the normal".to_owned(), |axis| ["x", "y", "z"][axis].to_owned());
    // In the direction of the axis, whatever the sign of the normal.
    let turned = axis_of(normal).is_some_and(|axis| normal[axis] < 0.0);
    let (place, bodies) = if turned { (-place, (-bodies.1, -bodies.0)) } else { (place, bodies) };
    (place <= bodies.0 || place >= bodies.1).then_some(Missed { along, place, bodies })
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
        let side = |place: fn(&Mark) -> f64, axis: usize| {
            let places = self.marks.iter().map(|mark| (place(mark), mark.reach(axis)));
            places.filter(|(x, _)| x.is_finite()).map(|(x, (low, high))| (x + low, x + high)).reduce(wider)
        };
        let window = [side(|mark| mark.right, 0)?, side(|mark| mark.up, 1)?];
        let (extremes, bulk) = ranges(&mut values)?;
        let reached = self.walls.iter().flat_map(|wall| wall.reach(window));
        let window = reached.fold(window, |[right, up], [x, y]| [wider(right, (x, x)), wider(up, (y, y))]);
        Some(Extent { extremes, bulk, window })
    }
}

impl Extent {
    /// What several panels have in common; none of none. The bulk is that of nine of ten panels: a shock that is there in a few of many
    /// frames would leave one colour to all others.
    pub(super) fn of(panels: &[Self]) -> Option<Self> {
        let joined = panels.iter().copied().reduce(|a, b| Self {
            extremes: wider(a.extremes, b.extremes),
            bulk: wider(a.bulk, b.bulk),
            window: [0, 1].map(|k| wider(a.window[k], b.window[k])),
        })?;
        let left_out = panels.len() / FRAMES_LEFT_OUT;
        let end = |of: fn(&Self) -> f64| {
            let mut ends: Vec<f64> = panels.iter().map(of).collect();
            ends.sort_by(f64::total_cmp);
            ends
        };
        let (lows, highs) = (end(|panel| panel.bulk.0), end(|panel| panel.bulk.1));
        Some(Self { bulk: (lows[left_out], highs[highs.len() - 1 - left_out]), ..joined })
    }
}

/// Smallest and largest value, and the same without the outermost half percent on each side.
pub(crate) fn ranges(values: &mut [f64]) -> Option<((f64, f64), (f64, f64))> {
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
pub(crate) fn split(field: &str) -> (&str, Option<&str>) {
    field.split_once('.').map_or((field, None), |(name, component)| (name, Some(component)))
}

/// A number of each particle.
pub(crate) struct Values {
    /// Components that these numbers are the norm of.
    pub(crate) width: usize,
    pub(crate) values: Vec<f64>,
}

/// One number a particle: the component, the scalar, or the norm. `start` reads where particles were.
pub(crate) fn values(
    frame: &mut FrameFile,
    name: &str,
    component: Option<&str>,
    asked: &str,
    start: impl Fn() -> Result<Vec<[f64; 3]>, PlotError>,
) -> Result<Values, PlotError> {
    let derived = Derived::of(name, frame);
    let available: Vec<String> =
        frame.arrays().iter().map(|array| array.name.clone()).chain(Derived::all(frame)).collect();
    let names = || available.iter().map(String::as_str);
    // One that is there lacks the component.
    let near = if names().any(|known| known == name) { String::new() } else { did_you_mean(names_like(name, names())) };
    let unknown = || PlotError::Field { name: asked.to_owned(), near, available: available.join(", ") };
    let column = match derived {
        Some(derived) => derived.column(frame, start)?,
        None => frame.column(name)?,
    };
    let array = frame.arrays().iter().find(|array| array.name == name);
    let components = match (array, derived) {
        (Some(array), _) => array.components.clone(),
        (None, Some(derived)) => derived.components().iter().map(|name| (*name).to_owned()).collect(),
        (None, None) => Vec::new(),
    };
    let Some(column) = column else { return Err(unknown()) };
    let rows = column.values.chunks_exact(column.width.max(1));
    let values = match component {
        Some(component) => {
            let k = components.iter().position(|c| c.eq_ignore_ascii_case(component)).ok_or_else(unknown)?;
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

pub(crate) fn field_label(name: &str, component: Option<&str>, is_norm: bool) -> String {
    let words = name.replace('_', " ").replace("von mises", "von Mises");
    match component {
        Some(component) => format!("{words} {}", component.to_lowercase()),
        None if is_norm => format!("{words} (magnitude)"),
        None => words,
    }
}

/// The cells of the particles that fill the bodies of a model, which are those of its first frame.
pub(crate) fn joined_cells(model: &Model, first: &mut FrameFile) -> Result<JoinedCells, OutputError> {
    let start = first.positions()?;
    let bodies = first.column("body")?.map_or_else(|| vec![0.0; start.len()], |column| column.values);
    Ok(JoinedCells::new(&start, &cell_corners(model), &bodies, first.header.dimensions, &model.symmetry))
}

/// The particles of a frame at these positions, with the corners of their cells from there where these are known.
fn samples(
    frame: &mut FrameFile,
    values: Vec<f64>,
    positions: &[[f64; 3]],
    corners: &[[[f32; 3]; 8]],
) -> Result<Vec<Sample>, PlotError> {
    let bodies = frame.column("body")?.map(|column| column.values);
    let dimensions = frame.header.dimensions;
    let spacings = &frame.header.body_spacing;
    let body = |i: usize| bodies.as_ref().map_or(0, |bodies| bodies[i] as usize);
    let spacing = |i: usize| spacings.get(body(i)).or(spacings.first()).copied().unwrap_or(0.0);
    let cell = |i: usize| {
        let corner = |k: usize| {
            // As thick as the particles are apart where the deck has no such axis.
            let thick = |a: usize| if a < dimensions { 0.0 } else { ((k >> a & 1) as f64 - 0.5) * spacing(i) };
            std::array::from_fn(|a| corners[i][k][a] + thick(a) as f32)
        };
        std::array::from_fn(corner)
    };
    let sample = |(i, (position, value))| Sample {
        position,
        value,
        spacing: spacing(i),
        body: body(i).min(usize::from(u16::MAX)) as u16,
        cell: corners.get(i).filter(|own| own.as_flattened().iter().all(|x| x.is_finite())).map(|_| cell(i)),
    };
    Ok(positions.iter().copied().zip(values).enumerate().map(sample).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_beside_bodies_says_where_they_are_without_round_off() {
        let missed = Missed { along: "z".to_owned(), place: 0.05, bodies: (-1.301e-18, 0.03) };
        let Err(PlotError::Section { low, high, place, .. }) = cuts_something([Some(missed)]) else {
            panic!("it is met")
        };
        assert_eq!([low.as_str(), high.as_str(), place.as_str()], ["0 m", "30 mm", "50 mm"]);
    }

    #[test]
    fn one_frame_of_ten_does_not_set_the_limits_of_all() {
        let of = |bulk: (f64, f64)| Extent { extremes: (-9.0, bulk.1), bulk, window: [(0.0, 1.0); 2] };
        let mut panels: Vec<Extent> = (0..20).map(|k| of((0.0, 1.0 + 0.01 * f64::from(k)))).collect();
        (panels[3].bulk, panels[3].extremes.1) = ((-50.0, 100.0), 200.0);
        (panels[7].bulk, panels[7].extremes.1) = ((-70.0, 90.0), 90.0);
        let all = Extent::of(&panels).unwrap();
        assert_eq!((all.bulk, all.extremes), ((0.0, 1.19), (-9.0, 200.0)));
        // Of a few, each counts.
        assert_eq!(Extent::of(&panels[..9]).unwrap().bulk, (-70.0, 100.0));
        assert!(Extent::of(&[]).is_none());
    }
}
