//! Bodies.

use super::{material::Chosen, shape::body_shape, vector, velocity};
use crate::fault::{Fault, Problems};
use crate::method;
use crate::raw::{RawBody, RawParticles, RawSpin};
use crate::value::{Choice, Choices, Given, Number, ScalarOr};
use sphorge_engine::geometry::rings_fill;
use sphorge_engine::model::{Arrangement, Body, Dimensions, Lattice, LatticePlacement, Shape, Solid};
use sphorge_physics::parameter::Bound;
use std::ops::Range;

/// Smoothing lengths below miss neighbours, above smear several of them; h over spacing.
const SMOOTHING_RANGE: Bound = Bound::Between(0.6, 4.0);

/// What bodies take from `[particles]`.
pub(crate) struct ParticleDefaults {
    spacing: Option<f64>,
    smoothing: Option<f64>,
    /// None where it is not given; the outer one where what is given is wrong.
    arrangement: Option<Option<Arrangement>>,
    /// Arrangement of bodies that rings can fill, where none is given.
    round: Arrangement,
    placement: Option<LatticePlacement>,
}

impl ParticleDefaults {
    /// `spacing` has been read already; `usual` is what the method has for keys that are left out.
    pub(crate) fn read(
        raw: Option<&RawParticles>,
        spacing: Option<f64>,
        usual: &method::Choices,
        problems: &mut Problems,
    ) -> Self {
        Self {
            spacing,
            smoothing: smoothing(raw.and_then(|r| r.smoothing.as_ref()), Some(usual.smoothing), problems),
            arrangement: raw.and_then(|r| r.lattice.as_ref()).map_or(Some(None), |word| word.get(problems).map(Some)),
            round: usual.round,
            placement: chosen(raw.and_then(|r| r.placement.as_ref()), Some(LatticePlacement::default()), problems),
        }
    }
}

fn smoothing(given: Option<&Given<Number>>, default: Option<f64>, problems: &mut Problems) -> Option<f64> {
    given.map_or(default, |s| s.within(SMOOTHING_RANGE, problems))
}

fn chosen<C: Choices>(
    given: Option<&Choice<C>>,
    default: Option<C::Value>,
    problems: &mut Problems,
) -> Option<C::Value> {
    given.map_or(default, |word| word.get(problems))
}

/// The arrangement of a body, if it can fill the shape.
fn lattice(
    raw: &RawBody,
    shape: Option<&Shape>,
    dimensions: Dimensions,
    particles: &ParticleDefaults,
    problems: &mut Problems,
) -> Option<Lattice> {
    let given = raw.lattice.as_ref().map_or(particles.arrangement, |word| word.get(problems).map(Some));
    let placement = chosen(raw.placement.as_ref(), particles.placement, problems);
    let (given, placement, shape) = (given?, placement?, shape?);
    if matches!(shape.solid, Solid::Cloud { .. }) {
        return Some(Lattice::default());
    }
    let is_round = placement == LatticePlacement::CellCentres && rings_fill(shape, dimensions);
    let arrangement = given.unwrap_or(if is_round { particles.round } else { Arrangement::default() });
    let at = raw.lattice.as_ref().map_or(raw.name.span(), |word| word.span());
    if arrangement == Arrangement::Rings && !rings_fill(shape, dimensions) {
        let message = "rings fill a `disc`, a `cylinder`, or a `difference` or `intersection` that begins with one";
        problems.push(
            Fault::new("wrong-lattice", message, at, "this body is none").help("use \"square\" or \"hexagonal\""),
        );
        return None;
    }
    if arrangement != Arrangement::Square && placement != LatticePlacement::CellCentres {
        let message = "only the square lattice can have its particles on the faces";
        let at = raw.placement.as_ref().map_or(at, |word| word.span());
        problems.push(Fault::new("wrong-lattice", message, at, "with another lattice").help("leave `placement` out"));
        return None;
    }
    Some(Lattice { arrangement, placement })
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
    let shape = body_shape(&raw.shape, dimensions, raw.name.span(), problems);
    let velocity = raw.velocity.as_ref().map_or(Some([0.0; 3]), |v| vector(v, dimensions, problems));
    let spin = raw.spin.as_ref().map_or(Some(([0.0; 3], [0.0; 3])), |s| spin(s, dimensions, raw.name.span(), problems));
    let spacing = raw.spacing.as_ref().map_or(particles.spacing, |s| s.spacing(problems));
    let ratio = smoothing(raw.smoothing.as_ref(), particles.smoothing, problems);
    let lattice = lattice(raw, shape.as_ref(), dimensions, particles, problems);
    let temperature = raw.temperature.as_ref().map(|t| t.within(Bound::NonNegative, problems));
    let material = material?;
    let gradient = raw
        .velocity_gradient
        .as_ref()
        .map_or(Some(([[0.0; 3]; 3], [0.0; 3])), |g| velocity::gradient(g, dimensions, raw.name.span(), problems));
    let profile = raw.velocity_profile.as_ref().map(|p| velocity::profile(p, dimensions, raw.name.span(), problems));
    let radial = raw.radial_velocity.as_ref().map(|r| velocity::radial(r, dimensions, raw.name.span(), problems));
    let (spin, spin_centre) = spin?;
    let (velocity_gradient, gradient_centre) = gradient?;
    Some(Body {
        name: raw.name.text(problems)?.to_owned(),
        material,
        shape: shape?,
        lattice: lattice?,
        spacing: spacing?,
        smoothing_length: ratio? * spacing?,
        velocity: velocity?,
        spin,
        spin_centre,
        velocity_gradient,
        gradient_centre,
        velocity_profile: profile.map_or(Some(None), |p| p.map(Some))?,
        radial_velocity: radial.map_or(Some(None), |r| r.map(Some))?,
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
            problems.push(
                Fault::new("wrong-dimensions", "a body cannot spin in one dimension", at, "has a `spin`")
                    .help("leave `spin` out"),
            );
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
