//! Shapes.

use super::{cloud::cloud, described, exactly_one, limits, vector};
use crate::fault::{Fault, Problems};
use crate::raw::{RawBall, RawBox, RawCylinder, RawOgive, RawPolygon, RawRevolution, RawRotate, RawShape, RawTable};
use crate::value::{Given as GivenValue, Length, Number, VectorOf};
use crate::written::Spanned;
use sphorge_engine::model::{Dimensions, Operation, Shape, Solid, Transform};
use sphorge_physics::parameter::Bound;
use std::ops::Range;

/// What a shape is made of.
enum Given<'a> {
    Box(&'a RawBox),
    Disc(&'a RawBall),
    Sphere(&'a RawBall),
    Cylinder(&'a RawCylinder),
    Revolution(&'a RawRevolution),
    Ogive(&'a RawOgive),
    Polygon(&'a RawPolygon),
    Table(&'a RawTable),
    Composed(Operation, &'a [Spanned<RawShape>]),
}

/// The shape of a body: a placed solid, or particles from a file; `at` marks what it belongs to.
pub(crate) fn body_shape(
    raw: &RawShape,
    dimensions: Dimensions,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<Shape> {
    placed(raw, dimensions, at, true, problems)
}

/// A placed solid; `at` marks what it belongs to.
pub(crate) fn shape(
    raw: &RawShape,
    dimensions: Dimensions,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<Shape> {
    placed(raw, dimensions, at, false, problems)
}

fn placed(
    raw: &RawShape,
    dimensions: Dimensions,
    at: Range<usize>,
    can_be_table: bool,
    problems: &mut Problems,
) -> Option<Shape> {
    let composed = |operation, parts| Given::Composed(operation, parts);
    let options = vec![
        ("box", raw.cuboid.as_ref().map(Given::Box)),
        ("disc", raw.disc.as_ref().map(Given::Disc)),
        ("sphere", raw.sphere.as_ref().map(Given::Sphere)),
        ("cylinder", raw.cylinder.as_ref().map(Given::Cylinder)),
        ("revolution", raw.revolution.as_ref().map(Given::Revolution)),
        ("ogive", raw.ogive.as_ref().map(Given::Ogive)),
        ("polygon", raw.polygon.as_ref().map(Given::Polygon)),
        ("table", raw.table.as_ref().map(Given::Table)),
        ("union", raw.union.as_deref().map(|parts| composed(Operation::Union, parts))),
        ("difference", raw.difference.as_deref().map(|parts| composed(Operation::Difference, parts))),
        ("intersection", raw.intersection.as_deref().map(|parts| composed(Operation::Intersection, parts))),
    ];
    let given = exactly_one(options, "a shape", at.clone(), problems);
    let transform = transform(raw, dimensions, at.clone(), problems);
    let solid = match given? {
        Given::Table(table) if can_be_table => cloud(table, dimensions, problems),
        Given::Table(table) => {
            let message = "particles from a file cannot be part of another shape or a region";
            problems.push(Fault::new("table-as-part", message, table.file.span(), "must be the whole shape of a body"));
            None
        }
        given => solid(given, dimensions, at, problems),
    };
    Some(Shape { solid: solid?, transform: transform? })
}

fn solid(given: Given<'_>, dimensions: Dimensions, at: Range<usize>, problems: &mut Problems) -> Option<Solid> {
    let round = "`box`, `sphere` or `cylinder`";
    match given {
        Given::Box(cuboid) => solid_box(cuboid, dimensions, problems),
        Given::Disc(ball) => {
            only_in(Dimensions::PlaneStrain, "disc", round, dimensions, ball.radius.span(), problems)?;
            solid_ball(ball, dimensions, problems)
        }
        Given::Sphere(ball) => {
            only_in(Dimensions::Three, "sphere", "`box` or `disc`", dimensions, ball.radius.span(), problems)?;
            solid_ball(ball, dimensions, problems)
        }
        Given::Cylinder(cylinder) => {
            only_in(Dimensions::Three, "cylinder", "`box` or `disc`", dimensions, cylinder.radius.span(), problems)?;
            solid_cylinder(cylinder, dimensions, problems)
        }
        Given::Revolution(bar) => {
            not_in_one("revolution", dimensions, bar.axis.span.clone(), problems)?;
            revolution(bar, dimensions, problems)
        }
        Given::Ogive(bar) => {
            not_in_one("ogive", dimensions, bar.radius.span(), problems)?;
            ogive(bar, dimensions, problems)
        }
        Given::Polygon(polygon) => {
            let at = polygon.corners.first().map_or(at, |c| c.span.clone());
            only_in(Dimensions::PlaneStrain, "polygon", "`box` or `revolution`", dimensions, at.clone(), problems)?;
            solid_polygon(polygon, at, problems)
        }
        Given::Table(_) => None,
        Given::Composed(operation, parts) => {
            if parts.is_empty() {
                problems.push(Fault::new("empty-shape", "a composed shape needs at least one part", at, "has none"));
                return None;
            }
            if !is_short(parts, limits::PARTS, "parts", |part| part.span(), problems) {
                return None;
            }
            let read: Vec<_> =
                parts.iter().map(|part| shape(part.get_ref(), dimensions, part.span(), problems)).collect();
            Some(Solid::Composed { operation, parts: read.into_iter().collect::<Option<_>>()? })
        }
    }
}

fn not_in_one(what: &str, dimensions: Dimensions, at: Range<usize>, problems: &mut Problems) -> Option<()> {
    if dimensions != Dimensions::One {
        return Some(());
    }
    let message = format!("{}: there is no {what}", described(dimensions));
    problems.push(Fault::new("wrong-dimensions", message, at, "part of it").help("use `box`"));
    None
}

fn only_in(
    wanted: Dimensions,
    what: &str,
    instead: &str,
    found: Dimensions,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<()> {
    if wanted == found {
        return Some(());
    }
    let message = format!("{}: there is no {what}", described(found));
    let instead = if found == Dimensions::One { "`box`" } else { instead };
    problems.push(Fault::new("wrong-dimensions", message, at, "part of it").help(format!("use {instead}")));
    None
}

fn solid_box(raw: &RawBox, dimensions: Dimensions, problems: &mut Problems) -> Option<Solid> {
    let (min, max) = (vector(&raw.min, dimensions, problems), vector(&raw.max, dimensions, problems));
    let (min, max) = (min?, max?);
    check_corners(&raw.min, &raw.max, min, max, dimensions, problems)?;
    Some(Solid::Box { min, max })
}

/// Corners of a box in the right order.
pub(crate) fn check_corners<K>(
    raw_min: &VectorOf<K>,
    raw_max: &VectorOf<K>,
    min: [f64; 3],
    max: [f64; 3],
    dimensions: Dimensions,
    problems: &mut Problems,
) -> Option<()> {
    for axis in 0..dimensions.count() {
        if min[axis] >= max[axis] {
            let message = format!("along {} the box ends where it begins or before", ["x", "y", "z"][axis]);
            let at = raw_max.components.get(axis).map_or(raw_max.span.clone(), |c| c.span());
            let from = raw_min.components.get(axis).map_or(raw_min.span.clone(), |c| c.span());
            problems.push(
                Fault::new("out-of-range", message, at, "must be above `min`")
                    .also(from, "`min` here")
                    .help("swap the two"),
            );
            return None;
        }
    }
    Some(())
}

/// The radius of a hole, smaller than the radius around it.
fn hole(
    inner: Option<&GivenValue<Length>>,
    radius: &GivenValue<Length>,
    problems: &mut Problems,
) -> Option<(f64, f64)> {
    let outer = radius.positive(problems);
    let Some(inner) = inner else { return Some((outer?, 0.0)) };
    let (outer, hole) = (outer, inner.within(Bound::NonNegative, problems));
    let (outer, hole) = (outer?, hole?);
    if hole >= outer {
        let fault =
            Fault::new("out-of-range", "the hole is as wide as the shape", inner.span(), "must be below `radius`");
        problems.push(fault.also(radius.span(), "`radius` here"));
        return None;
    }
    Some((outer, hole))
}

fn solid_ball(raw: &RawBall, dimensions: Dimensions, problems: &mut Problems) -> Option<Solid> {
    let centre = vector(&raw.centre, dimensions, problems);
    let (radius, inner_radius) = hole(raw.inner_radius.as_ref(), &raw.radius, problems)?;
    Some(Solid::Ball { centre: centre?, radius, inner_radius })
}

/// Two points that are not one.
fn ends(
    raw_from: &VectorOf<Length>,
    raw_to: &VectorOf<Length>,
    what: &str,
    dimensions: Dimensions,
    problems: &mut Problems,
) -> Option<([f64; 3], [f64; 3], f64)> {
    let (from, to) = (vector(raw_from, dimensions, problems), vector(raw_to, dimensions, problems));
    let (from, to) = (from?, to?);
    let length = (0..3).map(|k| (to[k] - from[k]).powi(2)).sum::<f64>().sqrt();
    if length == 0.0 {
        let message = format!("the {what} has no length");
        problems.push(Fault::new("out-of-range", message, raw_to.span.clone(), "the same as `from`"));
        return None;
    }
    Some((from, to, length))
}

fn solid_cylinder(raw: &RawCylinder, dimensions: Dimensions, problems: &mut Problems) -> Option<Solid> {
    let radii = hole(raw.inner_radius.as_ref(), &raw.radius, problems);
    let (from, to, _) = ends(&raw.from, &raw.to, "cylinder", dimensions, problems)?;
    let (radius, inner_radius) = radii?;
    Some(Solid::Cylinder { from, to, radius, inner_radius })
}

/// Unit vector along a direction; `what` it is the direction of.
pub(crate) fn direction(
    raw: &VectorOf<Number>,
    what: &str,
    dimensions: Dimensions,
    problems: &mut Problems,
) -> Option<[f64; 3]> {
    let direction = vector(raw, dimensions, problems)?;
    let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        return Some(direction.map(|c| c / length));
    }
    let message = format!("the {what} has no direction");
    problems.push(Fault::new("out-of-range", message, raw.span.clone(), "must not be zero"));
    None
}

/// Pairs of lengths, whatever the dimensions of the deck.
fn pairs(raw: &[VectorOf<Length>], what: &str, problems: &mut Problems) -> Option<Vec<[f64; 2]>> {
    if !is_short(raw, limits::OUTLINE, "points of its outline", |point| point.span.clone(), problems) {
        return None;
    }
    let read: Vec<Option<[f64; 2]>> = raw
        .iter()
        .map(|point| match point.components.as_slice() {
            [a, b] => a.si(problems).zip(b.si(problems)).map(|(a, b)| [a, b]),
            other => {
                let message = format!("expected {what}, found {}", other.len());
                problems.push(
                    Fault::new("wrong-length", message, point.span.clone(), "two lengths")
                        .help("write [\"10 mm\", \"5 mm\"]"),
                );
                None
            }
        })
        .collect();
    read.into_iter().collect()
}

fn revolution(raw: &RawRevolution, dimensions: Dimensions, problems: &mut Problems) -> Option<Solid> {
    let from = raw.from.as_ref().map_or(Some([0.0; 3]), |f| vector(f, dimensions, problems));
    let axis = direction(&raw.axis, "axis", dimensions, problems);
    let profile = pairs(&raw.profile, "an axial distance and a radius", problems)?;
    let fault =
        |k: usize, message: &str, label: &str| Fault::new("bad-profile", message, raw.profile[k].span.clone(), label);
    if profile.len() < 2 {
        let at = raw.profile.first().map_or(raw.axis.span.clone(), |p| p.span.clone());
        problems.push(Fault::new("bad-profile", "a profile needs at least two points", at, "too few"));
        return None;
    }
    if let Some(k) = profile.iter().position(|p| p[1] < 0.0) {
        problems.push(fault(k, "a radius cannot be negative", "negative radius"));
        return None;
    }
    if let Some(k) = (1..profile.len()).find(|&k| profile[k][0] < profile[k - 1][0]) {
        let help = "list the points along the axis; a hole is a `difference`";
        problems.push(
            fault(k, "a profile cannot turn back", "before the point above")
                .also(raw.profile[k - 1].span.clone(), "this one")
                .help(help),
        );
        return None;
    }
    let last = profile.len() - 1;
    if profile[last][0] == profile[0][0] {
        problems.push(fault(last, "the profile has no length", "where it begins"));
        return None;
    }
    if profile.iter().all(|p| p[1] == 0.0) {
        problems.push(fault(last, "the profile has no width", "every radius is zero"));
        return None;
    }
    Some(Solid::Revolution { from: from?, axis: axis?, profile })
}

fn ogive(raw: &RawOgive, dimensions: Dimensions, problems: &mut Problems) -> Option<Solid> {
    let radius = raw.radius.positive(problems);
    let (from, to, length) = ends(&raw.from, &raw.to, "ogive", dimensions, problems)?;
    let radius = radius?;
    let options = vec![("nose-length", raw.nose_length.as_ref()), ("head-radius", raw.head_radius.as_ref())];
    let given = exactly_one(options, "an ogive", raw.radius.span(), problems)?;
    let value = given.positive(problems)?;
    if value < radius * (1.0 - 1e-9) {
        let message = "the nose is blunter than a hemisphere";
        problems.push(
            Fault::new("out-of-range", message, given.span(), "must be at least `radius`")
                .also(raw.radius.span(), "`radius` here"),
        );
        return None;
    }
    let nose_length = if raw.nose_length.is_some() { value } else { (radius * (2.0 * value - radius)).sqrt() };
    if nose_length > length * (1.0 + 1e-9) {
        let message = format!("the nose is {:.4} mm long, the whole bar {:.4} mm", nose_length * 1e3, length * 1e3);
        problems.push(Fault::new("out-of-range", message, given.span(), "longer than from `from` to `to`"));
        return None;
    }
    Some(Solid::Ogive { from, to, radius, nose_length: nose_length.min(length) })
}

fn solid_polygon(raw: &RawPolygon, at: Range<usize>, problems: &mut Problems) -> Option<Solid> {
    let corners = pairs(&raw.corners, "x and y", problems)?;
    if corners.len() < 3 {
        let message = format!("a polygon has at least three corners, this one {}", corners.len());
        problems.push(Fault::new("bad-polygon", message, at, "too few"));
        return None;
    }
    if let Some((a, b)) = crossing(&corners) {
        let fault = Fault::new(
            "bad-polygon",
            "the outline of the polygon crosses itself",
            raw.corners[b].span.clone(),
            "the edge that begins here",
        );
        problems.push(
            fault
                .also(raw.corners[a].span.clone(), "crosses the one that begins here")
                .help("list the corners in order along the outline"),
        );
        return None;
    }
    let next = corners.iter().cycle().skip(1);
    if corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() == 0.0 {
        problems.push(Fault::new("bad-polygon", "the polygon has no area", at, "its corners are in a line"));
        return None;
    }
    Some(Solid::Polygon { corners })
}

/// Two edges of a closed line, by their first corners, that cross. Edges are taken from left to right, and compared with those before
/// that reach as far.
fn crossing(corners: &[[f64; 2]]) -> Option<(usize, usize)> {
    let side = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let n = corners.len();
    let edge = |k: usize| (corners[k], corners[(k + 1) % n]);
    let cross = |i: usize, j: usize| {
        let ((a, b), (c, d)) = (edge(i), edge(j));
        side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
    };
    let reach = |k: usize| {
        let (a, b) = edge(k);
        (a[0].min(b[0]), a[0].max(b[0]))
    };
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| reach(a).0.total_cmp(&reach(b).0));
    let mut near: Vec<usize> = Vec::new();
    for edge in order {
        let left = reach(edge).0;
        near.retain(|&other| reach(other).1 >= left);
        if let Some(&other) = near.iter().find(|&&other| cross(edge, other)) {
            return Some((edge.min(other), edge.max(other)));
        }
        near.push(edge);
    }
    None
}

/// Whether a list of a shape is no longer than it can be; reported at its first entry beyond.
fn is_short<T>(list: &[T], most: usize, what: &str, at: impl Fn(&T) -> Range<usize>, problems: &mut Problems) -> bool {
    let Some(extra) = list.get(most) else { return true };
    let message = format!("a shape can have {most} {what}, this one has {}", list.len());
    problems.push(Fault::new("too-many", message, at(extra), "one too many"));
    false
}

fn transform(raw: &RawShape, dimensions: Dimensions, at: Range<usize>, problems: &mut Problems) -> Option<Transform> {
    let shift = raw.shift.as_ref().map_or(Some([0.0; 3]), |s| vector(s, dimensions, problems));
    let Some(rotate) = &raw.rotate else {
        return Some(Transform { translation: shift?, ..Transform::default() });
    };
    if dimensions == Dimensions::One {
        problems.push(
            Fault::new("wrong-dimensions", "a shape cannot be rotated in one dimension", at, "has a `rotate`")
                .help("leave `rotate` out"),
        );
        return None;
    }
    let about = rotate.about.as_ref().map_or(Some([0.0; 3]), |a| vector(a, dimensions, problems));
    let angle = rotate.angle.si(problems);
    let axis = rotation_axis(rotate, dimensions, problems);
    let (shift, about) = (shift?, about?);
    let mut transform = Transform::about_axis(axis?, angle?, about);
    for k in 0..3 {
        transform.translation[k] += shift[k];
    }
    Some(transform)
}

fn rotation_axis(raw: &RawRotate, dimensions: Dimensions, problems: &mut Problems) -> Option<[f64; 3]> {
    let Some(axis) = &raw.axis else {
        if dimensions == Dimensions::PlaneStrain {
            return Some([0.0, 0.0, 1.0]);
        }
        let fault = Fault::new(
            "missing-key",
            "in three dimensions a rotation needs an `axis`",
            raw.angle.span(),
            "has no `axis`",
        );
        problems.push(fault.help("add `axis = [0, 0, 1]`").if_its_entry_is_whole());
        return None;
    };
    // An axis has three components even where positions have two.
    let direction = vector(axis, Dimensions::Three, problems)?;
    let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        problems.push(Fault::new("out-of-range", "the axis has no direction", axis.span.clone(), "must not be zero"));
        return None;
    }
    if dimensions == Dimensions::PlaneStrain && (direction[0] != 0.0 || direction[1] != 0.0) {
        problems.push(Fault::new(
            "wrong-dimensions",
            "in plane strain shapes are rotated about z",
            axis.span.clone(),
            "another axis",
        ));
        return None;
    }
    Some(direction.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_crossing_is_found_if_any_two_edges_cross(raw in prop::collection::vec((0u8..9, 0u8..9), 3..9)) {
            let corners: Vec<[f64; 2]> = raw.iter().map(|&(x, y)| [f64::from(x), f64::from(y)]).collect();
            let side = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
            let edge = |k: usize| (corners[k], corners[(k + 1) % corners.len()]);
            let cross = |i: usize, j: usize| {
                let ((a, b), (c, d)) = (edge(i), edge(j));
                side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
            };
            let any = (0..corners.len()).any(|i| (0..i).any(|j| cross(i, j)));
            match crossing(&corners) {
                Some((i, j)) => prop_assert!(i < j && cross(i, j)),
                None => prop_assert!(!any),
            }
        }
    }
}
