//! How the page looks when it opens.

use crate::{
    output::FrameFile,
    plot::{ColorMap, FrameChoice, Mirror, Section, View, cuts_something},
};
use serde::Serialize;

use super::{ViewError, run::ViewedRun};

/// What the page shows when it opens; all of it can be changed there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewSettings {
    /// Fields, or components as in `stress.xy`: the first is shown, a single page has all of them. Those of the standard pictures if there are none.
    pub fields: Vec<String>,
    /// Colours; automatic if not given.
    pub color_map: Option<ColorMap>,
    /// Values of the ends of the colour bar, SI; those of all frames if not given.
    pub range: Option<(f64, f64)>,
    /// Direction of view; the plane of a plane problem, a corner of a solid one if not given.
    pub view: Option<View>,
    /// Leave out what is in front of a plane.
    pub section: Option<Section>,
    /// Frame; the last if not given.
    pub frame: Option<FrameChoice>,
    /// Show these bodies alone; all if there are none.
    pub bodies: Vec<String>,
    /// Show the images of particles in these planes of symmetry, too; those that halve bodies can be shown later if not given.
    pub mirror: Option<Mirror>,
    /// Columns of the history; the measures if there are none.
    pub columns: Vec<String>,
}

/// The same for the page.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Start {
    /// Field; none where the runs have none in common yet.
    field: Option<String>,
    map: Option<&'static str>,
    range: Option<(f64, f64)>,
    /// Axes of the page: to the right, up, towards the eye.
    view: Option<[[f64; 3]; 3]>,
    section: Option<StartSection>,
    /// Time, s.
    time: Option<f64>,
    bodies: Vec<String>,
    mirror: bool,
    columns: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct StartSection {
    normal: [f64; 3],
    point: Option<[f64; 3]>,
}

impl ViewSettings {
    /// What the page is told of it. A run without a frame tells no view.
    pub(super) fn start(&self, runs: &[ViewedRun]) -> Start {
        let first = runs.first();
        let series = first.and_then(|run| run.series().ok()).unwrap_or_default();
        let view = first.and_then(|run| run.view(self.view));
        let section = self.section.zip(view).map(|(section, view)| {
            let last = series.last().and_then(|(_, file)| FrameFile::open(file).ok());
            let positions = last.and_then(|mut frame| frame.positions().ok()).unwrap_or_default();
            let size = std::array::from_fn(|axis| {
                let along = positions.iter().map(|p| p[axis]).filter(|x| x.is_finite());
                let (low, high) =
                    along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
                (high - low).max(0.0)
            });
            let point = match section {
                Section::Across { point, .. } => point,
                Section::Middle => None,
            };
            StartSection { normal: section.normal(view, size), point }
        });
        let frame = self.frame.and_then(|choice| choice.find(&series));
        Start {
            field: self.fields.first().cloned().or_else(|| first_field(runs)),
            map: self.color_map.map(map_name),
            range: self.range,
            view: self.view.and(view).map(|view| {
                let projection = view.projection();
                [projection.right, projection.up, projection.towards]
            }),
            section,
            time: frame.map(|(time, _)| *time),
            bodies: self.bodies.clone(),
            mirror: self.mirror.is_some(),
            columns: self.columns.clone(),
        }
    }

    /// Whether runs that have frames have what is asked for.
    ///
    /// # Errors
    /// [`ViewError::Plot`] for a field, a body, a column or a frame that a run does not have, for planes of symmetry that none has, and for a section beside the bodies of all runs.
    pub(super) fn check(&self, runs: &[ViewedRun]) -> Result<(), ViewError> {
        runs.iter().try_for_each(|run| run.check(self))?;
        if let Some(mirror) = self.mirror {
            // Of several runs, one with such planes is enough.
            let mut refused = runs.iter().map(|run| run.has_images(mirror)).collect::<Vec<_>>();
            if refused.iter().all(Result::is_err)
                && let Some(Err(first)) = refused.drain(..).next()
            {
                return Err(first);
            }
        }
        let Some(section) = self.section else { return Ok(()) };
        // A run without a frame may have bodies there when it has one.
        let missed = runs.iter().map(|run| run.missed(section, self)).collect::<Result<Vec<_>, _>>()?;
        Ok(cuts_something(missed)?)
    }
}

/// What is shown first where no field is named: the first that all runs with frames have.
pub(super) fn first_field(runs: &[ViewedRun]) -> Option<String> {
    let mut known = runs.iter().filter_map(ViewedRun::field_names);
    let mut names = known.next()?;
    for others in known {
        names.retain(|name| others.contains(name));
    }
    names.into_iter().next()
}

pub(super) fn map_name(map: ColorMap) -> &'static str {
    match map {
        ColorMap::Viridis => "viridis",
        ColorMap::Inferno => "inferno",
        ColorMap::Diverging => "diverging",
    }
}
