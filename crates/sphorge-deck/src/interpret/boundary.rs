//! Walls, symmetry planes, periodic axes, prescribed motion.

use super::{Names, check_axis, described, exactly_one, vector, wrong_length};
use crate::choice::ContactWord;
use crate::defaults;
use crate::fault::{Fault, Problems};
use crate::method::WallContactKind;
use crate::raw::{RawContact, RawMotion, RawPeriodic, RawPlane, RawSegment, RawSymmetry, RawWall, Rows};
use crate::value::{Choice, Given, Kind, ScalarOr, Velocity, VelocityOrFree};
use crate::written::Literal;
use sphorge_engine::model::{
    Body, Dimensions, Formulation, MotionAxis, PrescribedMotion, Solid, SymmetryPlane, TimeTable, Wall, WallContact,
    WallSurface,
};
use sphorge_physics::parameter::Bound;
use std::ops::Range;

/// What walls meet.
pub(crate) struct Walled<'a> {
    pub(crate) spacing: Option<f64>,
    pub(crate) usual: WallContactKind,
    pub(crate) formulation: Option<Formulation>,
    pub(crate) bodies: &'a [Option<Body>],
    /// Of materials, by their index, whether they have strength.
    pub(crate) has_strength: &'a dyn Fn(usize) -> bool,
    /// Of bodies, the speed at which a bar of its material yields on a rigid wall, m/s, if it has strength and does not break.
    pub(crate) yield_speed: &'a dyn Fn(&Body) -> Option<f64>,
    pub(crate) dimensions: Dimensions,
}

impl Walled<'_> {
    fn has_facets(&self) -> bool {
        !matches!(self.formulation, Some(Formulation::UpdatedLagrangian))
    }

    /// Whether a wall pushes at facets where the deck does not say: where particles would be wrong.
    fn needs_facets(&self, surface: &WallSurface, velocity: &[TimeTable; 3]) -> bool {
        let is_round = |normal: &[f64; 3]| {
            let towards = normal.map(|c| -c);
            let of = |body: &Body| (self.has_strength)(body.material) && body.shape.is_round_towards(towards);
            self.bodies.iter().flatten().any(of)
        };
        self.has_facets()
            && match surface {
                WallSurface::Segment { .. } => true,
                WallSurface::Plane { normal, .. } => is_round(normal) || self.are_met_gently(normal, velocity),
            }
    }

    /// Whether all bodies have strength, do not break, and none strikes a plane so fast that it yields at once. What stands on a plane tips over its edge, and not
    /// half a spacing before it; what is pressed on it is closed by half as much.
    ///
    /// Feet of bars that are crushed are as wide with particles, which cards can do, too.
    fn are_met_gently(&self, normal: &[f64; 3], velocity: &[TimeTable; 3]) -> bool {
        let fastest =
            |axis: usize, sign: f64| velocity[axis].points.iter().map(move |(_, v)| sign * v).fold(0.0, f64::max);
        let of_wall: f64 = (0..3).map(|a| normal[a].abs() * fastest(a, normal[a].signum())).sum();
        let is_gentle = |body: &Body| {
            let [least, most] = body.velocity_bounds(self.dimensions);
            let towards: f64 = (0..3).map(|a| -normal[a] * if normal[a] > 0.0 { least[a] } else { most[a] }).sum();
            !matches!(body.shape.solid, Solid::Cloud { .. })
                && (self.yield_speed)(body).is_some_and(|limit| towards.max(0.0) + of_wall < limit)
        };
        self.dimensions != Dimensions::One && self.bodies.iter().flatten().all(is_gentle)
    }
}

/// A wall.
pub(crate) fn wall(
    raw: &RawWall,
    dimensions: Dimensions,
    walled: &Walled<'_>,
    problems: &mut Problems,
) -> Option<Wall> {
    enum Surface<'a> {
        Plane(&'a RawPlane),
        Segment(&'a RawSegment),
    }
    let options = vec![
        ("plane", raw.plane.as_ref().map(Surface::Plane)),
        ("segment", raw.segment.as_ref().map(Surface::Segment)),
    ];
    let surface = match exactly_one(options, "a wall", raw.name.span(), problems) {
        Some(Surface::Plane(p)) => plane(p, dimensions, problems),
        Some(Surface::Segment(s)) => segment(s, dimensions, problems),
        None => None,
    };
    let velocity = match &raw.velocity {
        None => Some([0.0; 3].map(TimeTable::constant)),
        Some(axes) => wall_velocity(axes, raw.name.span(), dimensions, problems),
    };
    let contact = contact(raw.contact.as_ref(), surface.as_ref().zip(velocity.as_ref()), walled, problems);
    Some(Wall { name: raw.name.text(problems)?.to_owned(), surface: surface?, velocity: velocity?, contact: contact? })
}

fn plane(raw: &RawPlane, dimensions: Dimensions, problems: &mut Problems) -> Option<WallSurface> {
    let (point, normal) = (vector(&raw.point, dimensions, problems), vector(&raw.normal, dimensions, problems));
    let (point, normal) = (point?, normal?);
    let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        let fault =
            Fault::new("out-of-range", "the normal has no direction", raw.normal.span.clone(), "must not be zero");
        problems.push(fault.help("it points from the wall towards the material, for example [0, 1]"));
        return None;
    }
    Some(WallSurface::Plane { point, normal: normal.map(|c| c / length) })
}

fn segment(raw: &RawSegment, dimensions: Dimensions, problems: &mut Problems) -> Option<WallSurface> {
    if dimensions != Dimensions::PlaneStrain {
        let message = format!("{}: walls are planes", described(dimensions));
        problems.push(Fault::new("wrong-dimensions", message, raw.from.span.clone(), "a segment").help("use `plane`"));
        return None;
    }
    let (from, to) = (vector(&raw.from, dimensions, problems), vector(&raw.to, dimensions, problems));
    let (from, to) = (from?, to?);
    if from == to {
        problems.push(Fault::new(
            "out-of-range",
            "the segment has no length",
            raw.to.span.clone(),
            "the same as `from`",
        ));
        return None;
    }
    Some(WallSurface::Segment { from, to })
}

fn contact(
    raw: Option<&ScalarOr<Choice<ContactWord>, RawContact>>,
    surface: Option<(&WallSurface, &[TimeTable; 3])>,
    walled: &Walled<'_>,
    problems: &mut Problems,
) -> Option<WallContact> {
    let spacing = walled.spacing;
    let usual = surface.is_some_and(|(surface, velocity)| walled.needs_facets(surface, velocity));
    let strength = |at_facets| if at_facets { defaults::FACET_PENALTY } else { defaults::PENALTY };
    let of_kind = |kind| match kind {
        WallContactKind::MonaghanKos => spacing.map(|range| WallContact::MonaghanKos { range }),
        WallContactKind::Penalty => {
            let (stiffness, damping, friction) = strength(usual);
            Some(WallContact::Penalty { stiffness, damping, friction, at_facets: usual })
        }
    };
    let (table, at) = match raw {
        None => return of_kind(walled.usual),
        Some(ScalarOr::Scalar(word)) => return of_kind(word.get(problems)?),
        Some(ScalarOr::Composed(table, at)) => (table, at.clone()),
    };
    enum Law<'a> {
        Kos(&'a crate::raw::RawMonaghanKos),
        Penalty(&'a crate::raw::RawPenalty),
    }
    let options = vec![
        ("monaghan-kos", table.monaghan_kos.as_ref().map(Law::Kos)),
        ("penalty", table.penalty.as_ref().map(Law::Penalty)),
    ];
    match exactly_one(options, "a contact", at, problems)? {
        Law::Kos(kos) => {
            let range = kos.range.as_ref().map_or(spacing, |r| r.positive(problems));
            Some(WallContact::MonaghanKos { range: range? })
        }
        Law::Penalty(p) => {
            let friction = defaults::PENALTY.2;
            let friction = p.friction.as_ref().map_or(Some(friction), |f| f.within(Bound::NonNegative, problems));
            let at_facets = match &p.surfaces {
                Some(word) => word.get(problems)?,
                None => usual,
            };
            if let (true, false, Some(word)) = (at_facets, walled.has_facets(), &p.surfaces) {
                let message = "facets follow the deformation of cells, which the updated Lagrangian form does not have";
                let fault = Fault::new("not-together", message, word.span(), "not possible");
                problems.push(fault.help("leave `surfaces` out, or use `method = \"total-lagrangian\"`"));
                return None;
            }
            let (stiffness, damping, _) = strength(at_facets);
            let stiffness = p.stiffness.as_ref().map_or(Some(stiffness), |s| s.positive(problems));
            let damping = p.damping.as_ref().map_or(Some(damping), |d| d.within(Bound::Between(0.0, 1.0), problems));
            Some(WallContact::Penalty { stiffness: stiffness?, damping: damping?, friction: friction?, at_facets })
        }
    }
}

fn wall_velocity(
    axes: &[ScalarOr<Given<Velocity>, Rows<Velocity>>],
    at: Range<usize>,
    dimensions: Dimensions,
    problems: &mut Problems,
) -> Option<[TimeTable; 3]> {
    if axes.len() != dimensions.count() {
        problems.push(wrong_length(
            dimensions,
            Some("velocity"),
            axes.len(),
            at,
            "\"10 m/s\" or [[\"0 s\", \"0 m/s\"], [\"5 ms\", \"1 m/s\"]]",
        ));
        return None;
    }
    let mut tables = [0.0; 3].map(TimeTable::constant);
    let read: Vec<_> = axes
        .iter()
        .map(|axis| match axis {
            ScalarOr::Scalar(value) => value.si(problems).map(TimeTable::constant),
            ScalarOr::Composed(rows, at) => time_table(rows, at.clone(), problems),
        })
        .collect();
    for (table, axis) in tables.iter_mut().zip(read) {
        *table = axis?;
    }
    Some(tables)
}

/// Rows of time and value; times must increase.
fn time_table<K: Kind>(rows: &Rows<K>, at: Range<usize>, problems: &mut Problems) -> Option<TimeTable> {
    if rows.is_empty() {
        problems.push(Fault::new("empty-table", "the time table has no rows", at, "empty"));
        return None;
    }
    let mut points: Vec<(f64, f64)> = Vec::with_capacity(rows.len());
    let mut sound = true;
    for (k, (time, value)) in rows.iter().enumerate() {
        let (Some(t), Some(v)) = (time.si(problems), value.si(problems)) else {
            sound = false;
            continue;
        };
        if sound && points.last().is_some_and(|&(before, _)| t <= before) {
            let fault = Fault::new(
                "time-order",
                "the times of a table must increase",
                time.span(),
                "not later than the row before",
            );
            problems.push(fault.also(rows[k - 1].0.span(), "the row before"));
            sound = false;
        }
        points.push((t, v));
    }
    sound.then_some(TimeTable { points })
}

/// Lower and upper end of the cell on each periodic axis, m.
pub(crate) type Cells = [Option<(f64, f64)>; 3];

/// Periodic axes, and where each stands in the deck.
pub(crate) fn periodic(
    raw: &RawPeriodic,
    dimensions: Dimensions,
    problems: &mut Problems,
) -> (Cells, [Range<usize>; 3]) {
    let mut cells = [None; 3];
    let mut places = [0..0, 0..0, 0..0];
    for (axis, given) in [&raw.x, &raw.y, &raw.z].into_iter().enumerate() {
        let Some(ends) = given else { continue };
        places[axis] = ends.span.clone();
        if check_axis(axis, ends.span.clone(), dimensions, problems).is_none() {
            continue;
        }
        let [lower, upper] = ends.components.as_slice() else {
            let message = format!("expected both ends of the cell, found {}", ends.components.len());
            let fault = Fault::new("wrong-dimensions", message, ends.span.clone(), "a lower and an upper end");
            problems.push(fault.help("write [\"0 mm\", \"5 mm\"]"));
            continue;
        };
        if let (Some(low), Some(high)) = (lower.si(problems), upper.si(problems)) {
            if low < high {
                cells[axis] = Some((low, high));
            } else {
                let fault = Fault::new(
                    "out-of-range",
                    "the cell ends where it begins or before",
                    upper.span(),
                    "must be above the lower end",
                );
                problems.push(fault);
            }
        }
    }
    (cells, places)
}

/// Symmetry planes.
pub(crate) fn symmetry(
    raw: &[RawSymmetry],
    periodic: &Cells,
    dimensions: Dimensions,
    problems: &mut Problems,
) -> Option<Vec<SymmetryPlane>> {
    let read: Vec<_> = raw
        .iter()
        .map(|plane| {
            let axis =
                plane.axis.get(problems).and_then(|axis| check_axis(axis, plane.axis.span(), dimensions, problems));
            let position = plane.at.as_ref().map_or(Some(0.0), |p| p.si(problems));
            let side = plane.side.as_ref().map_or(Some(1.0), |s| s.get(problems));
            Some(SymmetryPlane { axis: axis?, position: position?, side: side? })
        })
        .collect();
    for (k, plane) in read.iter().enumerate().filter_map(|(k, p)| p.map(|p| (k, p))) {
        let at = raw[k].axis.span();
        if periodic[plane.axis].is_some() {
            problems.push(
                Fault::new("conflict", "this axis is periodic already", at.clone(), "and has a symmetry plane")
                    .help("leave one of the two out"),
            );
        }
        for (j, other) in read[..k].iter().enumerate().filter_map(|(j, p)| p.map(|p| (j, p))) {
            if other.axis != plane.axis {
                continue;
            }
            let first = raw[j].axis.span();
            if other.side == plane.side {
                let fault = Fault::new(
                    "conflict",
                    "two symmetry planes of one axis have the material on the same side",
                    at.clone(),
                    "second",
                );
                problems.push(fault.also(first, "first").help("leave one of them out, or change its `side`"));
            } else if (plane.position - other.position) * plane.side >= 0.0 {
                let fault =
                    Fault::new("conflict", "there is no space between the two symmetry planes", at.clone(), "second");
                problems
                    .push(fault.also(first, "first").help("material is on the `side` of each: check `at` and `side`"));
            }
        }
    }
    read.into_iter().collect()
}

/// Fixed or driven particles.
pub(crate) fn motion(
    raw: &RawMotion,
    regions: &Names,
    dimensions: Dimensions,
    problems: &mut Problems,
) -> Option<PrescribedMotion> {
    let region = regions.find(&raw.region, problems);
    if raw.velocity.len() != dimensions.count() {
        let examples = "\"0 m/s\", \"free\" or [[\"0 s\", \"0 m/s\"], [\"5 ms\", \"1 m/s\"]]";
        problems.push(wrong_length(dimensions, Some("velocity"), raw.velocity.len(), raw.region.span(), examples));
        return None;
    }
    let mut axes = [MotionAxis::Free, MotionAxis::Free, MotionAxis::Free];
    let read: Vec<_> = raw
        .velocity
        .iter()
        .map(|axis| match axis {
            ScalarOr::Scalar(VelocityOrFree(scalar)) if scalar.literal == Literal::Text("free".to_owned()) => {
                Some(MotionAxis::Free)
            }
            ScalarOr::Scalar(VelocityOrFree(scalar)) => {
                scalar.quantity(Velocity::KIND, problems).map(|v| MotionAxis::Velocity(TimeTable::constant(v)))
            }
            ScalarOr::Composed(rows, at) => time_table(rows, at.clone(), problems).map(MotionAxis::Velocity),
        })
        .collect();
    for (target, axis) in axes.iter_mut().zip(read) {
        *target = axis?;
    }
    Some(PrescribedMotion { region: region?, axes })
}
