//! Declared measures.

use super::{Names, check_axis, exactly_one, vector};
use crate::choice::{AxisWord, FieldWord};
use crate::defaults;
use crate::fault::{Fault, Problems};
use crate::quantity::QuantityKind;
use crate::raw::{
    RawAlongAxis, RawCloud, RawCrater, RawExtreme, RawFieldMeasure, RawFragments, RawFrontSpeed, RawMeasure,
    RawPerforation, RawSelection, RawValue,
};
use crate::suggest::listed;
use crate::unit::parse_unit;
use crate::value::{Choice, Word};
use sphorge_engine::model::{
    CloudExtent, CraterEdge, Dimensions, Extremum, Formulation, FragmentQuantity, Measure, MeasureKind,
    ParticleSelection, Perforation,
};
use sphorge_engine::particles::{ColumnKind, DEFORMATION_GRADIENT, FieldInfo};
use sphorge_physics::parameter::Bound;

/// What measures can refer to.
pub(crate) struct Scene<'a> {
    pub(crate) dimensions: Dimensions,
    /// None if the method could not be read.
    pub(crate) formulation: Option<Formulation>,
    pub(crate) bodies: &'a Names,
    pub(crate) regions: &'a Names,
}

impl Scene<'_> {
    /// Refuses a field that the formulation does not know.
    pub(crate) fn check_field(&self, field: &str, at: std::ops::Range<usize>, problems: &mut Problems) {
        if field == DEFORMATION_GRADIENT && self.formulation == Some(Formulation::UpdatedLagrangian) {
            let message = format!("the updated Lagrangian form does not know the field `{field}`");
            let help =
                "leave it out, or choose the total Lagrangian form, the default: `search = \"total-lagrangian\"`";
            problems.push(Fault::new("unsupported-field", message, at, "here").help(help));
        }
    }
}

/// All measures of a deck.
pub(crate) fn measures(raw: &[RawMeasure], scene: &Scene<'_>, problems: &mut Problems) -> Option<Vec<Measure>> {
    Names::collect("measure", raw.iter().map(|m| &m.name), problems);
    let read: Vec<_> = raw.iter().map(|m| measure(m, scene, problems)).collect();
    read.into_iter().collect()
}

enum Given<'a> {
    Extent(&'a RawAlongAxis),
    Diameter(&'a RawAlongAxis),
    Maximum(&'a RawExtreme),
    Minimum(&'a RawExtreme),
    Mean(&'a RawFieldMeasure),
    Value(&'a RawValue),
    FrontSpeed(&'a RawFrontSpeed),
    Period(&'a RawFieldMeasure),
    ReversalTime(&'a RawAlongAxis),
    Crater(&'a RawCrater),
    Cloud(CloudExtent, &'a RawCloud),
    Fragments(&'a RawFragments),
}

fn measure(raw: &RawMeasure, scene: &Scene<'_>, problems: &mut Problems) -> Option<Measure> {
    let options = vec![
        ("extent", raw.extent.as_ref().map(Given::Extent)),
        ("diameter", raw.diameter.as_ref().map(Given::Diameter)),
        ("maximum", raw.maximum.as_ref().map(Given::Maximum)),
        ("minimum", raw.minimum.as_ref().map(Given::Minimum)),
        ("mean", raw.mean.as_ref().map(Given::Mean)),
        ("value", raw.value.as_ref().map(Given::Value)),
        ("front-speed", raw.front_speed.as_ref().map(Given::FrontSpeed)),
        ("period", raw.period.as_ref().map(Given::Period)),
        ("reversal-time", raw.reversal_time.as_ref().map(Given::ReversalTime)),
        ("crater-diameter", raw.crater_diameter.as_ref().map(Given::Crater)),
        ("cloud-length", raw.cloud_length.as_ref().map(|cloud| Given::Cloud(CloudExtent::Length, cloud))),
        ("cloud-width", raw.cloud_width.as_ref().map(|cloud| Given::Cloud(CloudExtent::Width, cloud))),
        ("fragments", raw.fragments.as_ref().map(Given::Fragments)),
    ];
    let kind = match exactly_one(options, "a measure", raw.name.span(), problems)? {
        Given::Extent(m) => {
            let (selection, axis) = along_axis(m, scene, problems);
            MeasureKind::Extent { selection: selection?, axis: axis? }
        }
        Given::Diameter(m) => {
            let selection = read_selection(m.selection(), scene, problems);
            // A section of the plane has its axis across it.
            let axis = match (scene.dimensions, m.axis.get(problems)) {
                (Dimensions::PlaneStrain, Some(2)) => Some(2),
                (_, axis) => axis.and_then(|axis| check_axis(axis, m.axis.span(), scene.dimensions, problems)),
            };
            MeasureKind::Diameter { selection: selection?, axis: axis? }
        }
        Given::Maximum(m) => extreme(m, Extremum::Maximum, scene, problems)?,
        Given::Minimum(m) => extreme(m, Extremum::Minimum, scene, problems)?,
        Given::Mean(m) => {
            let (selection, field) = of_field(m, scene, problems);
            let (field, component) = field?;
            MeasureKind::Mean { selection: selection?, field: field.name.to_owned(), component }
        }
        Given::Period(m) => {
            let (selection, field) = of_field(m, scene, problems);
            let (field, component) = field?;
            MeasureKind::Period { selection: selection?, field: field.name.to_owned(), component }
        }
        Given::Value(m) => {
            let selection = read_selection(m.selection(), scene, problems);
            let field = read_field(&m.field, m.component.as_ref(), scene, problems);
            let point = vector(&m.point, scene.dimensions, problems);
            let (field, component) = field?;
            MeasureKind::Value { selection: selection?, field: field.name.to_owned(), component, point: point? }
        }
        Given::FrontSpeed(m) => front_speed(m, scene, problems)?,
        Given::ReversalTime(m) => {
            let (selection, axis) = along_axis(m, scene, problems);
            MeasureKind::ReversalTime { selection: selection?, axis: axis? }
        }
        Given::Crater(m) => {
            let perforation = perforation(m.perforation(), scene, problems);
            let edge = m.edge.as_ref().map_or(Some(CraterEdge::Clear), |e| e.get(problems));
            MeasureKind::CraterDiameter { perforation: perforation?, edge: edge? }
        }
        Given::Cloud(extent, m) => {
            let perforation = perforation(m.perforation(), scene, problems);
            let leave_out = m.leave_out.as_ref().map_or(Some(0.0), |s| s.within(Bound::Between(0.0, 0.5), problems));
            MeasureKind::Cloud { perforation: perforation?, extent, leave_out: leave_out? }
        }
        Given::Fragments(m) => {
            let body = scene.bodies.find(&m.body, problems);
            let quantity = m.of.as_ref().map_or(Some(FragmentQuantity::Number), |of| of.get(problems));
            let link = m.link.as_ref().map_or(Some(defaults::LINK), |l| l.within(Bound::Between(1.0, 10.0), problems));
            let least = m.least.as_ref().map_or(Some(defaults::LEAST_FRAGMENT), |n| n.positive(problems));
            MeasureKind::Fragments { body: body?, quantity: quantity?, link: link?, least: least? }
        }
    };
    Some(Measure { name: raw.name.text(problems)?.to_owned(), kind })
}

fn along_axis(
    raw: &RawAlongAxis,
    scene: &Scene<'_>,
    problems: &mut Problems,
) -> (Option<ParticleSelection>, Option<usize>) {
    (read_selection(raw.selection(), scene, problems), read_axis(&raw.axis, scene, problems))
}

fn perforation(raw: RawPerforation<'_>, scene: &Scene<'_>, problems: &mut Problems) -> Option<Perforation> {
    if scene.dimensions == Dimensions::One {
        let message = "the deck is one-dimensional: a plate cannot be perforated";
        problems.push(Fault::new("wrong-dimensions", message, raw.body.span(), "of this body"));
        return None;
    }
    let plate = scene.bodies.find(raw.body, problems);
    let axis = read_axis(raw.axis, scene, problems);
    let direction = raw.side.map_or(Some(1.0), |s| s.get(problems));
    let point = raw.point.map_or(Some([0.0; 3]), |p| vector(p, scene.dimensions, problems));
    let link = raw.link.map_or(Some(defaults::LINK), |l| l.within(Bound::Between(1.0, 10.0), problems));
    Some(Perforation { plate: plate?, axis: axis?, direction: direction?, point: point?, link: link? })
}

fn of_field(
    raw: &RawFieldMeasure,
    scene: &Scene<'_>,
    problems: &mut Problems,
) -> (Option<ParticleSelection>, Option<(&'static FieldInfo, Option<usize>)>) {
    (read_selection(raw.selection(), scene, problems), read_field(&raw.field, raw.component.as_ref(), scene, problems))
}

fn extreme(raw: &RawExtreme, extremum: Extremum, scene: &Scene<'_>, problems: &mut Problems) -> Option<MeasureKind> {
    let selection = read_selection(raw.selection(), scene, problems);
    let field = read_field(&raw.field, raw.component.as_ref(), scene, problems);
    let over_time = raw.over_time.as_ref().map_or(Some(false), |o| o.get(problems));
    let (field, component) = field?;
    Some(MeasureKind::Extreme {
        selection: selection?,
        field: field.name.to_owned(),
        component,
        extremum,
        over_time: over_time?,
    })
}

fn front_speed(raw: &RawFrontSpeed, scene: &Scene<'_>, problems: &mut Problems) -> Option<MeasureKind> {
    let selection = read_selection(raw.selection(), scene, problems);
    let field = read_field(&raw.field, raw.component.as_ref(), scene, problems);
    let axis = read_axis(&raw.axis, scene, problems);
    let direction = raw.side.as_ref().map_or(Some(1.0), |s| s.get(problems));
    let during = match &raw.during {
        None => Some((0.0, f64::INFINITY)),
        Some(times) => match times.components.as_slice() {
            [first, last] => match (first.si(problems), last.si(problems)) {
                (Some(a), Some(b)) if a < b => Some((a, b)),
                (Some(_), Some(_)) => {
                    problems.push(Fault::new(
                        "time-order",
                        "the last time must be later than the first",
                        last.span(),
                        "not later",
                    ));
                    None
                }
                _ => None,
            },
            other => {
                let message = format!("expected a first and a last time, found {}", other.len());
                problems.push(
                    Fault::new("wrong-dimensions", message, times.span.clone(), "two times")
                        .help("write [\"1 us\", \"4 us\"]"),
                );
                None
            }
        },
    };
    let (field, component) = field?;
    let level = raw.level.quantity(unit_of(field), problems);
    Some(MeasureKind::FrontSpeed {
        selection: selection?,
        field: field.name.to_owned(),
        component,
        axis: axis?,
        level: level?,
        direction: direction?,
        window: during?,
    })
}

/// The kind of quantity a field holds.
fn unit_of(field: &FieldInfo) -> QuantityKind {
    let kind = QuantityKind { name: field.name, si_unit: field.unit, ..QuantityKind::NUMBER };
    match parse_unit(field.unit) {
        Ok(unit) if !field.unit.is_empty() => {
            QuantityKind { dimension: unit.dimension, examples: QuantityKind::examples_of(unit.dimension), ..kind }
        }
        _ => kind,
    }
}

fn read_axis(given: &Choice<AxisWord>, scene: &Scene<'_>, problems: &mut Problems) -> Option<usize> {
    let axis = given.get(problems)?;
    check_axis(axis, given.span(), scene.dimensions, problems)
}

fn read_selection(raw: RawSelection<'_>, scene: &Scene<'_>, problems: &mut Problems) -> Option<ParticleSelection> {
    let body = raw.body.map_or(Some(None), |b| scene.bodies.find(b, problems).map(Some));
    let region = raw.region.map_or(Some(None), |r| scene.regions.find(r, problems).map(Some));
    let window = match raw.window {
        None => Some(None),
        Some(w) => match (vector(&w.min, scene.dimensions, problems), vector(&w.max, scene.dimensions, problems)) {
            (Some(min), Some(max)) => super::shape::check_corners(&w.min, &w.max, min, max, scene.dimensions, problems)
                .map(|()| Some(unbounded_across(min, max, scene.dimensions))),
            _ => None,
        },
    };
    Some(ParticleSelection { body: body?, region: region?, window: window? })
}

/// A window that ends on no axis the deck does not have.
fn unbounded_across(mut min: [f64; 3], mut max: [f64; 3], dimensions: Dimensions) -> ([f64; 3], [f64; 3]) {
    for axis in dimensions.count()..3 {
        (min[axis], max[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    (min, max)
}

/// Names of the components of a field, in the order of [`ColumnKind`].
fn components(kind: ColumnKind) -> &'static [&'static str] {
    match kind {
        ColumnKind::Scalar | ColumnKind::Integer => &[],
        ColumnKind::Vector => &["x", "y", "z"],
        ColumnKind::Symmetric => &["xx", "yy", "zz", "xy", "yz", "xz"],
        ColumnKind::Tensor => &["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"],
    }
}

fn read_field(
    given: &Choice<FieldWord>,
    component: Option<&Word>,
    scene: &Scene<'_>,
    problems: &mut Problems,
) -> Option<(&'static FieldInfo, Option<usize>)> {
    let field = given.get(problems);
    let word = component.map(|c| (c.text(problems).map(str::to_owned), c.span()));
    let field = field?;
    scene.check_field(field.name, given.span(), problems);
    let Some((name, at)) = word else { return Some((field, None)) };
    let name = name?;
    let names = components(field.kind);
    let index = names.iter().position(|n| *n == name);
    if index.is_none() {
        let (message, help) = if names.is_empty() {
            (format!("`{}` is a scalar and has no components", field.name), "leave `component` out".to_owned())
        } else {
            let help = format!("it has {}", listed(names.iter().copied(), "and"));
            (format!("`{}` has no component `{name}`", field.name), help)
        };
        problems.push(Fault::new("unknown-name", message, at, "this component").help(help));
    }
    Some((field, Some(index?)))
}
