//! Bodies and shapes.

use super::{described, exactly_one, material::Chosen, vector};
use crate::deck::defaults;
use crate::deck::raw::{RawBall, RawBody, RawBox, RawCylinder, RawParticles, RawRotate, RawShape, RawSpin};
use crate::deck::report::{Fault, Problems};
use crate::deck::value::{Choice, Given, Number, ScalarOr, VectorOf};
use crate::model::{Body, Dimensions, Lattice, LatticePlacement, Shape, Solid, Transform};
use sphorge_physics::parameter::Bound;
use std::ops::Range;

/// Smoothing lengths below miss neighbours, above smear several of them; h over spacing.
const SMOOTHING_RANGE: Bound = Bound::Between(0.6, 4.0);

/// What bodies take from `[particles]`.
pub(crate) struct ParticleDefaults {
    spacing: Option<f64>,
    smoothing: Option<f64>,
    placement: Option<LatticePlacement>,
}

impl ParticleDefaults {
    /// `spacing` has been read already.
    pub(crate) fn read(raw: &RawParticles, spacing: Option<f64>, problems: &mut Problems) -> Self {
        Self {
            spacing,
            smoothing: smoothing(raw.smoothing.as_ref(), Some(defaults::SMOOTHING), problems),
            placement: placement(raw.placement.as_ref(), Some(LatticePlacement::default()), problems),
        }
    }
}

fn smoothing(given: Option<&Given<Number>>, default: Option<f64>, problems: &mut Problems) -> Option<f64> {
    given.map_or(default, |s| s.within(SMOOTHING_RANGE, problems))
}

fn placement(
    given: Option<&Choice<crate::deck::choice::PlacementWord>>,
    default: Option<LatticePlacement>,
    problems: &mut Problems,
) -> Option<LatticePlacement> {
    given.map_or(default, |p| p.get(problems))
}

/// A body.
pub(crate) fn body(
    raw: &RawBody,
    dimensions: Dimensions,
    particles: &ParticleDefaults,
    materials: &mut Chosen<'_>,
    problems: &mut Problems,
) -> Option<Body> {
    let material = materials.choose(&raw.material, problems);
    let shape = shape(&raw.shape, dimensions, raw.name.span(), problems);
    let velocity = raw.velocity.as_ref().map_or(Some([0.0; 3]), |v| vector(v, dimensions, problems));
    let spin = raw.spin.as_ref().map_or(Some(([0.0; 3], [0.0; 3])), |s| spin(s, dimensions, raw.name.span(), problems));
    let spacing = raw.spacing.as_ref().map_or(particles.spacing, |s| s.positive(problems));
    let ratio = smoothing(raw.smoothing.as_ref(), particles.smoothing, problems);
    let placement = placement(raw.placement.as_ref(), particles.placement, problems);
    let temperature = raw.temperature.as_ref().map(|t| t.within(Bound::NonNegative, problems));
    let material = material?;
    let (spin, spin_centre) = spin?;
    Some(Body {
        name: raw.name.text(problems)?.to_owned(),
        material,
        shape: shape?,
        lattice: Lattice { placement: placement? },
        spacing: spacing?,
        smoothing_length: ratio? * spacing?,
        velocity: velocity?,
        spin,
        spin_centre,
        temperature: temperature.unwrap_or_else(|| materials.reference_temperature(material))?,
    })
}

fn spin(
    raw: &RawSpin,
    dimensions: Dimensions,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<([f64; 3], [f64; 3])> {
    let centre = raw.centre.as_ref().map_or(Some([0.0; 3]), |c| vector(c, dimensions, problems));
    let mut rate = [0.0; 3];
    match (&raw.rate, dimensions) {
        (_, Dimensions::One) => {
            problems.push(Fault::new("wrong-dimensions", "a body cannot spin in one dimension", at, "has a `spin`"));
            return None;
        }
        (ScalarOr::Scalar(value), Dimensions::PlaneStrain) => rate[2] = value.si(problems)?,
        (ScalarOr::Scalar(value), Dimensions::Three) => {
            let fault = Fault::new(
                "wrong-dimensions",
                "in three dimensions a spin is a vector",
                value.span(),
                "a single value",
            );
            problems.push(fault.help("write three components: rate = [\"0 rpm\", \"0 rpm\", \"1200 rpm\"]"));
            return None;
        }
        (ScalarOr::Composed(components, at), _) => {
            if components.len() != 3 {
                let message = format!("expected 3 components, found {}", components.len());
                problems.push(Fault::new("wrong-dimensions", message, at.clone(), "an angular velocity"));
                return None;
            }
            for (axis, component) in components.iter().enumerate() {
                rate[axis] = component.si(problems)?;
            }
            if dimensions == Dimensions::PlaneStrain && (rate[0] != 0.0 || rate[1] != 0.0) {
                let fault =
                    Fault::new("wrong-dimensions", "in plane strain a body spins about z", at.clone(), "another axis");
                problems.push(fault);
                return None;
            }
        }
    }
    Some((rate, centre?))
}

/// A placed solid; `at` marks what it belongs to.
pub(crate) fn shape(
    raw: &RawShape,
    dimensions: Dimensions,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<Shape> {
    enum Given<'a> {
        Box(&'a RawBox),
        Disc(&'a RawBall),
        Sphere(&'a RawBall),
        Cylinder(&'a RawCylinder),
    }
    let options = vec![
        ("box", raw.cuboid.as_ref().map(Given::Box)),
        ("disc", raw.disc.as_ref().map(Given::Disc)),
        ("sphere", raw.sphere.as_ref().map(Given::Sphere)),
        ("cylinder", raw.cylinder.as_ref().map(Given::Cylinder)),
    ];
    let given = exactly_one(options, "a shape", at.clone(), problems);
    let transform = transform(raw, dimensions, at.clone(), problems);
    let solid = match given? {
        Given::Box(cuboid) => solid_box(cuboid, dimensions, problems),
        Given::Disc(ball) => only_in(
            Dimensions::PlaneStrain,
            "disc",
            "`box`, `sphere` or `cylinder`",
            dimensions,
            ball.radius.span(),
            problems,
        )
        .and_then(|()| solid_ball(ball, dimensions, problems)),
        Given::Sphere(ball) => {
            only_in(Dimensions::Three, "sphere", "`box` or `disc`", dimensions, ball.radius.span(), problems)
                .and_then(|()| solid_ball(ball, dimensions, problems))
        }
        Given::Cylinder(cylinder) => {
            only_in(Dimensions::Three, "cylinder", "`box` or `disc`", dimensions, cylinder.radius.span(), problems)
                .and_then(|()| solid_cylinder(cylinder, dimensions, problems))
        }
    };
    Some(Shape { solid: solid?, transform: transform? })
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
    problems
        .push(Fault::new("wrong-dimensions", message, at, format!("part of a {what}")).help(format!("use {instead}")));
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

fn solid_ball(raw: &RawBall, dimensions: Dimensions, problems: &mut Problems) -> Option<Solid> {
    let (centre, radius) = (vector(&raw.centre, dimensions, problems), raw.radius.positive(problems));
    Some(Solid::Ball { centre: centre?, radius: radius? })
}

fn solid_cylinder(raw: &RawCylinder, dimensions: Dimensions, problems: &mut Problems) -> Option<Solid> {
    let (from, to) = (vector(&raw.from, dimensions, problems), vector(&raw.to, dimensions, problems));
    let radius = raw.radius.positive(problems);
    let (from, to) = (from?, to?);
    if from == to {
        problems.push(Fault::new(
            "out-of-range",
            "the cylinder has no length",
            raw.to.span.clone(),
            "the same as `from`",
        ));
        return None;
    }
    Some(Solid::Cylinder { from, to, radius: radius? })
}

fn transform(raw: &RawShape, dimensions: Dimensions, at: Range<usize>, problems: &mut Problems) -> Option<Transform> {
    let shift = raw.shift.as_ref().map_or(Some([0.0; 3]), |s| vector(s, dimensions, problems));
    let Some(rotate) = &raw.rotate else {
        return Some(Transform { translation: shift?, ..Transform::default() });
    };
    if dimensions == Dimensions::One {
        problems.push(Fault::new("wrong-dimensions", "a shape cannot turn in one dimension", at, "has a `rotate`"));
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
            "about what?",
        );
        problems.push(fault.help("add `axis = [0, 0, 1]`"));
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
            "in plane strain shapes turn about z",
            axis.span.clone(),
            "another axis",
        ));
        return None;
    }
    Some(direction.map(|c| c / length))
}
