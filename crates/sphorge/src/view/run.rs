//! A run that is shown: its files are read whenever the page asks, so that a run that goes on is seen as it is.

use super::{
    ViewError, ViewSettings,
    array::Array,
    description::{Description, FieldDescription, Particle, ParticleField},
    history::History,
    nodes::FrameNodes,
};
use crate::{
    cells::{Deformation, JoinedCells, Nodes},
    deck::load_model,
    model::{Formulation, Model},
    output::{FrameFile, HistoryTable, OutputError, RunDirectory, Summary, read_series},
    particles::find_field,
    plot::{
        Derived, FrameChoice, Mirror, Missed, PlotError, Section, View, body_number, default_fields, field_label,
        joined_cells, mirrored, missed, no_frame, split, upright, values,
    },
};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

/// Positions of the particles, which are no field.
pub(super) const POSITION: &str = "position";
/// Field with the number of the body.
pub(super) const BODY: &str = "body";

/// A run that is shown.
#[derive(Debug)]
pub(super) struct ViewedRun {
    /// Name of its folder.
    pub(super) name: String,
    path: PathBuf,
    known: Mutex<Known>,
    /// Held while cells are joined: the page asks for them and for their corners at once.
    joining: Mutex<()>,
    history: History,
}

/// What does not change while a run goes on.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    /// Of which run this is known: another one may have taken the folder.
    pub(super) identity: String,
    /// The deck, if it can be read.
    pub(super) model: Option<Arc<Model>>,
    cells: Option<Arc<JoinedCells>>,
    /// Positions in the first frame, m.
    start: Option<Arc<Vec<[f64; 3]>>>,
    /// Checks that had warned when the run last stopped: where it goes on, its summary is gone.
    warnings: Vec<String>,
}

impl ViewedRun {
    /// Runs that have written something, with names that tell them apart.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub(super) fn open_all(folders: &[PathBuf]) -> Result<Vec<Self>, ViewError> {
        let mut runs = folders.iter().map(|folder| Self::open(folder)).collect::<Result<Vec<_>, _>>()?;
        let paths: Vec<PathBuf> = runs.iter().map(|run| run.path.canonicalize().unwrap_or(run.path.clone())).collect();
        for (run, name) in runs.iter_mut().zip(told_apart(&paths)) {
            run.name = name;
        }
        Ok(runs)
    }

    /// A run that has written something.
    ///
    /// # Errors
    /// [`ViewError::Output`] without such a folder, or if no run has written to it.
    pub(super) fn open(path: &Path) -> Result<Self, ViewError> {
        RunDirectory::open(path)?;
        Ok(Self::awaited(path))
    }

    /// A run that is about to be made.
    pub(super) fn awaited(path: &Path) -> Self {
        // The folder itself, where the path says `..`.
        let whole = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let name = whole.file_name().map_or_else(|| "run".to_owned(), |name| name.to_string_lossy().into_owned());
        let (known, joining) = (Mutex::default(), Mutex::default());
        Self { name, path: path.to_owned(), known, joining, history: History::default() }
    }

    pub(super) fn directory(&self) -> Result<RunDirectory, OutputError> {
        RunDirectory::open(&self.path)
    }

    /// What of its files cannot be read, in words.
    pub(super) fn damage(&self) -> Vec<String> {
        let Ok(directory) = self.directory() else { return Vec::new() };
        let summary = Summary::read(&directory).err().filter(|_| directory.summary().exists());
        let summary =
            summary.map(|error| format!("`{}`: how the run ended is not known: {}", self.name, error.chain()));
        let history = HistoryTable::read(&directory).err();
        let history = history.map(|error| format!("`{}`: there are no curves: {}", self.name, error.chain()));
        summary.into_iter().chain(history).collect()
    }

    /// Times and files of the frames.
    pub(super) fn series(&self) -> Result<Vec<(f64, PathBuf)>, OutputError> {
        read_series(&self.directory()?)
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is known of the run that has the folder now.
    pub(super) fn known(&self, directory: &RunDirectory) -> Known {
        // A run of an earlier version has no mark; its deck does not change.
        let identity = directory.identity().unwrap_or_else(|| "unmarked".to_owned());
        let mut known = self.lock();
        if known.identity != identity {
            let model = load_model(&directory.deck()).ok().map(Arc::new);
            *known = Known { identity, model, ..Known::default() };
        }
        known.clone()
    }

    /// The deck of the run, if it can be read.
    pub(super) fn model(&self) -> Result<Option<Arc<Model>>, ViewError> {
        Ok(self.known(&self.directory()?).model)
    }

    /// Keeps the names of checks that have warned in a run.
    fn remember(&self, identity: &str, warnings: &[String]) {
        let mut now = self.lock();
        if now.identity == identity && now.warnings != warnings {
            now.warnings = warnings.to_vec();
        }
    }

    /// The view that is meant, or fits best; none of a run without frames.
    pub(super) fn view(&self, asked: Option<View>) -> Option<View> {
        let directory = self.directory().ok()?;
        let (_, last) = read_series(&directory).ok()?.pop()?;
        let dimensions = FrameFile::open(&last).ok()?.header.dimensions;
        Some(fitting(asked, dimensions, self.known(&directory).model.as_deref()))
    }

    /// Positions in the first frame, m.
    fn start(&self, directory: &RunDirectory) -> Result<Arc<Vec<[f64; 3]>>, ViewError> {
        let known = self.known(directory);
        if let Some(start) = known.start {
            return Ok(start);
        }
        let series = read_series(directory)?;
        let start = match series.first() {
            Some((_, first)) => Arc::new(FrameFile::open(first)?.positions()?),
            None => return Err(no_frame(0, 0).into()),
        };
        let mut now = self.lock();
        if now.identity == known.identity {
            now.start = Some(Arc::clone(&start));
        }
        Ok(start)
    }

    /// The place that positions are counted from, m: the middle of the first frame, so that single precision does.
    pub(super) fn origin(&self, directory: &RunDirectory) -> Result<[f64; 3], ViewError> {
        let start = self.start(directory)?;
        Ok(std::array::from_fn(|axis| {
            let along = start.iter().map(|p| p[axis]).filter(|x| x.is_finite());
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            if low <= high { 0.5 * (low + high) } else { 0.0 }
        }))
    }

    /// Opens a frame.
    pub(super) fn frame(&self, number: usize) -> Result<(RunDirectory, FrameFile), ViewError> {
        let directory = self.directory()?;
        let series = read_series(&directory)?;
        let (_, file) = series.get(number).ok_or_else(|| no_frame(number, series.len()))?;
        Ok((directory, FrameFile::open(file)?))
    }

    /// Numbers of the particles of a frame: positions, the deformation gradient, or one of a field.
    ///
    /// # Errors
    /// [`ViewError::Plot`] if there is no such frame or field, [`ViewError::Output`] if it cannot be read.
    pub(super) fn array(&self, number: usize, name: &str) -> Result<Array, ViewError> {
        let (directory, mut frame) = self.frame(number)?;
        match name {
            POSITION => Ok(Array::of_positions(&frame.positions()?, self.origin(&directory)?)),
            _ => Ok(Array::of_field(&self.field(&directory, &mut frame, name)?)),
        }
    }

    /// A number of each particle, as pictures have it.
    fn field(&self, directory: &RunDirectory, frame: &mut FrameFile, asked: &str) -> Result<Vec<f64>, ViewError> {
        let (name, component) = split(asked);
        let start = || self.start(directory).map(|start| start.to_vec()).map_err(into_plot);
        Ok(values(frame, name, component, asked, start)?.values)
    }

    /// Cells; none where they do not follow from the deck.
    pub(super) fn cells(&self) -> Result<Arc<JoinedCells>, ViewError> {
        let directory = self.directory()?;
        let _alone = self.joining.lock().unwrap_or_else(PoisonError::into_inner);
        let known = self.known(&directory);
        if let Some(cells) = known.cells {
            return Ok(cells);
        }
        let (_, mut first) = self.frame(0)?;
        let is_total = |model: &&Arc<Model>| matches!(model.formulation, Formulation::TotalLagrangian { .. });
        let cells = match known.model.as_ref().filter(is_total) {
            Some(model) => joined_cells(model, &mut first)?,
            None => JoinedCells::default(),
        };
        let cells = Arc::new(cells);
        let mut now = self.lock();
        if now.identity == known.identity {
            now.cells = Some(Arc::clone(&cells));
        }
        Ok(cells)
    }

    /// Where the corners of cells are in a frame; nothing where there are no cells.
    pub(super) fn nodes(&self, number: usize) -> Result<FrameNodes, ViewError> {
        let (directory, mut frame) = self.frame(number)?;
        let cells = self.cells()?;
        let nodes = match Deformation::read(&mut frame)? {
            Some(deformation) => cells.at(&frame.positions()?, &deformation),
            None => Nodes::default(),
        };
        Ok(FrameNodes::new(nodes, self.origin(&directory)?))
    }

    /// A column of the history, thinned.
    pub(super) fn column(&self, column: usize, most: usize) -> Result<Vec<f64>, ViewError> {
        self.history.column(&self.directory()?, column, most)
    }

    /// Everything a frame says of one particle.
    pub(super) fn particle(&self, number: usize, particle: usize) -> Result<Particle, ViewError> {
        let (directory, mut frame) = self.frame(number)?;
        let positions = frame.positions()?;
        let missing =
            || PlotError::Empty { reason: format!("the frame has {} particles, numbered from 0", positions.len()) };
        let position = *positions.get(particle).ok_or_else(missing)?;
        let mut fields = Vec::new();
        for field in self.fields(&frame) {
            let derived = Derived::of(&field.name, &frame);
            let column = match derived {
                Some(derived) => derived
                    .column(&mut frame, || self.start(&directory).map(|start| start.to_vec()).map_err(into_plot))?,
                None => frame.column(&field.name)?,
            };
            let Some(column) = column else { continue };
            let row = column.values.chunks_exact(column.width.max(1)).nth(particle).unwrap_or_default();
            fields.push(ParticleField { name: field.name, values: row.iter().map(|x| f64::from(*x)).collect() });
        }
        let body = fields.iter().find(|field| field.name == BODY).and_then(|field| field.values.first().copied());
        let body = body.and_then(|body| frame.bodies.get(body as usize).cloned());
        Ok(Particle { particle, position, body: body.map(|body| body.name), fields })
    }

    /// The fields of a frame, those of the standard pictures first.
    pub(super) fn fields(&self, frame: &FrameFile) -> Vec<FieldDescription> {
        let own = frame.arrays().iter().map(|array| FieldDescription {
            name: array.name.clone(),
            label: field_label(&array.name, None, false),
            unit: array.unit.clone(),
            width: array.width,
            components: array.components.iter().map(|name| name.to_lowercase()).collect(),
        });
        let derived = Derived::all(frame).map(|name| {
            let components = Derived::of(&name, frame).map_or(&[][..], Derived::components);
            FieldDescription {
                label: field_label(&name, None, false),
                unit: find_field(&name).map_or("", |field| field.unit).to_owned(),
                width: components.len().max(1),
                components: components.iter().map(|name| name.to_lowercase()).collect(),
                name,
            }
        });
        let mut fields: Vec<FieldDescription> = own.chain(derived).collect();
        let model = self.model().ok().flatten();
        let usual = default_fields(model.as_deref(), |name| fields.iter().any(|field| field.name == name));
        let rank = |field: &FieldDescription| usual.iter().position(|name| *name == field.name);
        fields.sort_by_key(|field| rank(field).unwrap_or(usual.len()));
        fields
    }

    /// What there is of the run now, with the planes of symmetry in which images can be shown.
    pub(super) fn describe(&self, mirror: Option<Mirror>) -> Description {
        let described = self.directory().map_err(ViewError::from).and_then(|directory| {
            let known = self.known(&directory);
            // A run that is about to write its first frame has no list of frames yet.
            let series = if directory.series().exists() { read_series(&directory)? } else { Vec::new() };
            let Some((_, last)) = series.last() else {
                return Ok(Description::waiting(&self.name, &directory, &known));
            };
            let frame = FrameFile::open(last)?;
            let fields = self.fields(&frame);
            let times: Vec<f64> = series.iter().map(|(time, _)| *time).collect();
            let origin = self.origin(&directory)?;
            let (columns, rows) = self.history.columns(&directory);
            let columns = (columns, rows, self.history.last(&directory, "time"));
            // Of several runs, some may have no such planes.
            let planes = mirrored(known.model.as_deref(), mirror).unwrap_or_default();
            let described = Description::of(&self.name, &directory, &known, &frame, fields, times, origin, columns);
            if !described.is_open {
                self.remember(&known.identity, &described.warnings);
            }
            let warned = self.history.last(&directory, "warnings").map_or(0, |count| count as usize);
            let described = described.with_warnings(warned, &known.warnings);
            Ok(described.with_images(planes.iter().map(|(_, plane)| plane)))
        });
        described.unwrap_or_else(|error| Description::broken(&self.name, &error))
    }

    /// Names of the fields of the last frame in the order of [`Self::fields`]; nothing of a run without a frame.
    pub(super) fn field_names(&self) -> Option<Vec<String>> {
        let (_, last) = self.series().ok()?.pop()?;
        let frame = FrameFile::open(&last).ok()?;
        Some(self.fields(&frame).into_iter().map(|field| field.name).collect())
    }

    /// What there is to cut where a section cuts nothing of the bodies that are shown; nothing where it cuts something, or there is no frame.
    pub(super) fn missed(&self, section: Section, settings: &ViewSettings) -> Result<Option<Missed>, ViewError> {
        let directory = self.directory()?;
        let series = if directory.series().exists() { read_series(&directory)? } else { Vec::new() };
        if series.is_empty() {
            return Ok(None);
        }
        let mut frame = FrameFile::open(settings.frame.unwrap_or(FrameChoice::Last).pick(&series)?)?;
        let shown = settings.bodies.iter().map(|body| body_number(&frame, body)).collect::<Result<Vec<_>, _>>()?;
        let mut positions = frame.positions()?;
        if !shown.is_empty()
            && let Some(bodies) = frame.column(BODY)?
        {
            let mut bodies = bodies.values.iter();
            positions.retain(|_| bodies.next().is_some_and(|body| shown.contains(&(*body as usize))));
        }
        let known = self.known(&directory);
        let planes = settings.mirror.map(|mirror| mirrored(known.model.as_deref(), Some(mirror)).unwrap_or_default());
        for (_, plane) in planes.into_iter().flatten() {
            let image = |p: &[f64; 3]| -> [f64; 3] {
                std::array::from_fn(|axis| if axis == plane.axis { 2.0 * plane.position - p[axis] } else { p[axis] })
            };
            let images: Vec<_> = positions.iter().map(image).collect();
            positions.extend(images);
        }
        let spacing = frame.header.body_spacing.iter().copied().fold(0.0, f64::max);
        Ok(missed(positions.into_iter().map(|position| (position, spacing)), section))
    }

    /// Whether the deck has the planes of symmetry that are asked for.
    pub(super) fn has_images(&self, mirror: Mirror) -> Result<(), ViewError> {
        let known = self.known(&self.directory()?);
        Ok(mirrored(known.model.as_deref(), Some(mirror)).map(|_| ())?)
    }

    /// Whether the run has what is asked for, as far as it has a frame.
    pub(super) fn check(&self, settings: &ViewSettings) -> Result<(), ViewError> {
        let directory = self.directory()?;
        if !directory.series().exists() {
            return Ok(());
        }
        let series = read_series(&directory)?;
        let Some((_, last)) = series.last() else { return Ok(()) };
        let mut frame = FrameFile::open(last)?;
        for field in &settings.fields {
            self.field(&directory, &mut frame, field)?;
        }
        for body in &settings.bodies {
            body_number(&frame, body)?;
        }
        if let Some(choice) = settings.frame {
            choice.pick(&series)?;
        }
        self.history.check(&directory, &settings.columns)
    }
}

/// The shortest ends of paths that tell them apart; equal paths are numbered.
fn told_apart(paths: &[PathBuf]) -> Vec<String> {
    let parts: Vec<Vec<String>> = paths
        .iter()
        .map(|path| path.components().rev().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect())
        .collect();
    let name = |k: usize| {
        let own = &parts[k];
        let is_alone = |length: &usize| {
            parts.iter().all(|other| other == own || other.iter().take(*length).ne(own.iter().take(*length)))
        };
        let length = (1..=own.len()).find(is_alone).unwrap_or(own.len());
        let words: Vec<&str> = own.iter().take(length).rev().map(String::as_str).collect();
        let before = parts[..k].iter().filter(|other| *other == own).count();
        let number = if before > 0 { format!(" ({})", before + 1) } else { String::new() };
        format!("{}{number}", words.join("/"))
    };
    (0..paths.len()).map(name).collect()
}

/// The view that is meant, or fits best, with the axis that points up.
pub(super) fn fitting(asked: Option<View>, dimensions: usize, model: Option<&Model>) -> View {
    let view = asked.unwrap_or(if dimensions == 3 { View::Corner { up: None } } else { View::Xy });
    model.map_or(view, |model| view.with_up(upright(model)))
}

/// An error while the first frame is read, for what reads it in the middle of a picture.
fn into_plot(error: ViewError) -> PlotError {
    match error {
        ViewError::Plot(error) => error,
        ViewError::Output(error) => PlotError::Output(error),
        other => PlotError::Empty { reason: other.to_string() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_name_are_told_apart_by_the_folders_above() {
        let names = |paths: &[&str]| told_apart(&paths.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(names(&["/a/run", "/b/other"]), ["run", "other"]);
        assert_eq!(names(&["/a/x/run", "/b/x/run", "/c"]), ["a/x/run", "b/x/run", "c"]);
        assert_eq!(names(&["/a/run", "/a/run", "/b/run"]), ["a/run", "a/run (2)", "b/run"]);
    }
}
