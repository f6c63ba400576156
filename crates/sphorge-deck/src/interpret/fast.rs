//! What the speed at which bodies meet decides where a deck does not.

use crate::impacts::each_impact;
use crate::raw::RawNumerics;
use crate::value::ScalarOr;
use sphorge_engine::model::{Body, Material, Model};
use sphorge_engine::reduction::extent_between_planes;

/// Share of the sound speed at which bodies meet each other, or something rigid, beyond which viscosity of shocks acts, and from which on all of it does. Bars
/// that strike walls at 300 m/s have 0.08, blocks of copper that strike each other at 400 m/s 0.10, plates of copper that meet at 500 m/s 0.127.
const FAST: [f64; 2] = [0.115, 0.125];
/// The same between plates ([`flatness`]), in which shocks of any strength arrive at the far side before the edges are heard of: of copper 39 and 59 m/s.
const FAST_PLATES: [f64; 2] = [0.01, 0.015];
/// Width over thickness up to which bodies are none, and from which on they are plates.
const WIDE: [f64; 2] = [1.5, 2.0];

/// Viscosity of shocks of a model, of which the method has `usual` where impacts are fast, unless the deck gives any viscosity itself; and a note where it
/// leaves this one out by giving another.
pub(crate) fn viscosity_of_shocks(raw: &RawNumerics, usual: f64, model: &Model) -> (f64, Option<String>) {
    let given = model.numerics.viscosity_of_shocks;
    let by_default = || usual * share_of_impacts(model);
    if usual == 0.0 {
        return (given, None);
    }
    match &raw.viscosity {
        // `viscosity = false` leaves no quadratic part.
        None | Some(ScalarOr::Scalar(_)) if model.numerics.viscosity_beta == 0.0 => (given, None),
        None | Some(ScalarOr::Scalar(_)) => (by_default(), None),
        Some(ScalarOr::Composed(table, _)) if table.shocks.is_some() => (given, None),
        Some(ScalarOr::Composed(table, _)) if table.alpha.is_none() && table.beta.is_none() => (by_default(), None),
        Some(ScalarOr::Composed(..)) => {
            let left_out = by_default();
            let has_some = model.numerics.viscosity_alpha > 0.0 || model.numerics.viscosity_beta > 0.0;
            let note = (left_out > 0.0 && has_some).then(|| {
                format!(
                    "`numerics.viscosity` gives `alpha` or `beta`, which leaves out the viscosity of shocks that bodies have by default where they meet so \
                     fast: particles behind the shocks will swing by a third of the pressure and more; add `shocks = {left_out}` to it, or `shocks = 0` if \
                     it is meant so"
                )
            });
            (given, note)
        }
    }
}

/// Share of the way between two numbers, from zero to one.
fn between([from, to]: [f64; 2], value: f64) -> f64 {
    ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// Largest share for the speed over that of sound at which bodies meet each other, walls, planes of symmetry or what is moved, by the velocities of the start.
fn share_of_impacts(model: &Model) -> f64 {
    let sound = |body: &Body| model.materials[body.material].equation_of_state.reference_sound_speed();
    let mut most = 0.0_f64;
    each_impact(model, &mut |impact| {
        let bodies = [Some(impact.body), impact.other].map(|body| body.map(|index| &model.bodies[index]));
        let slower = bodies.iter().flatten().map(|body| sound(body)).fold(f64::INFINITY, f64::min);
        let flatness = flatness(model, bodies, impact.axis);
        let of_plates = flatness * between(FAST_PLATES, impact.normal / slower);
        most = most.max(between(FAST, impact.speed / slower)).max(of_plates);
    });
    most
}

/// How far bodies that meet along an axis are plates that do not break, from zero to one: the narrower of them is much wider than the thinner of them is
/// thick.
fn flatness(model: &Model, bodies: [Option<&Body>; 2], along: usize) -> f64 {
    // In what breaks more layers would tear at once, side by side: fronts are smoother.
    if model.materials.iter().any(Material::breaks) {
        return 0.0;
    }
    let (mut thickness, mut width) = (f64::INFINITY, f64::INFINITY);
    for body in bodies.into_iter().flatten() {
        let (low, high) = body.shape.bounds(model.dimensions);
        thickness = thickness.min(high[along] - low[along]);
        for axis in (0..model.dimensions.count()).filter(|axis| *axis != along && model.periodic[*axis].is_none()) {
            // Of a body at a plane of symmetry the other half is behind it; between two there is no end.
            let planes = model.symmetry.iter().filter(|plane| plane.axis == axis).count();
            let own = extent_between_planes(model, axis, low[axis], high[axis]);
            width = width.min(if planes > 1 { f64::INFINITY } else { (1 + planes) as f64 * own });
        }
    }
    between(WIDE, width / thickness)
}
