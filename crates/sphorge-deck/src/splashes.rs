//! What is said of fluids that splash in the total Lagrangian form, which holds them together.

use super::advice::{Impact, impacts};
use sphorge_engine::Particles;
use sphorge_engine::model::{Body, Dimensions, Formulation, Model, SymmetryPlane};

/// Speed of an impact over the sound speed from which on a fluid splashes.
const SPLASHES: f64 = 0.01;

/// Fluids that splash in a form that holds them together.
pub(crate) fn notes(model: &Model, particles: &Particles) -> Vec<String> {
    if !matches!(model.formulation, Formulation::TotalLagrangian { .. }) || model.dimensions == Dimensions::One {
        return Vec::new();
    }
    let sound_speed = |index: usize| {
        let material = &model.materials[model.bodies[index].material];
        material.equation_of_state.reference_sound_speed()
    };
    let splashes = |(index, impact): &(usize, Impact)| {
        impact.damage_number.is_infinite() && impact.speed > SPLASHES * sound_speed(*index)
    };
    let impacts = impacts(model, particles).into_iter().enumerate().filter(splashes);
    impacts
        .filter(|(index, _)| !is_enclosed(model, &model.bodies[*index]))
        .map(|(_, Impact { body, speed, .. })| {
            format!(
                "body `{body}` has no strength and meets what it strikes at {speed:.0} m/s: it splashes. In the total Lagrangian form a fluid \
                 is held together until it is stretched fourfold, and rebounds; choose `method = \"updated-lagrangian\"` for it"
            )
        })
        .collect()
}

/// Whether a body fills what is between two planes of symmetry, or all of a period, along all axes but one: nothing of it can splash.
fn is_enclosed(model: &Model, body: &Body) -> bool {
    let (low, high) = body.shape.bounds(model.dimensions);
    let ends = |axis: usize, side: f64, at: f64| {
        let is_there = |plane: &SymmetryPlane| {
            plane.axis == axis && plane.side == side && (plane.position - at).abs() < 0.5 * body.spacing
        };
        model.symmetry.iter().any(is_there)
    };
    let is_held =
        |axis: usize| model.periodic[axis].is_some() || ends(axis, 1.0, low[axis]) && ends(axis, -1.0, high[axis]);
    (0..model.dimensions.count()).filter(|axis| is_held(*axis)).count() + 1 >= model.dimensions.count()
}

#[cfg(test)]
mod tests {
    use crate::load_text;

    #[test]
    fn a_fluid_that_splashes_in_the_default_form_hears_of_the_one_that_lets_it() {
        let bird = |changes: &[(&str, &str)]| {
            let deck = "dimensions = \"plane-strain\"\nparticles = { spacing = \"2 mm\" }\ntime = { end = \"1 us\" }\n[material.fluid]\n\
                        density = \"950 kg/m^3\"\nequation-of-state = { mie-gruneisen = { sound-speed = \"1483 m/s\", shock-slope = 1.75, \
                        gruneisen = 0.0 } }\nstrength = \"none\"\n[[body]]\nname = \"bird\"\nmaterial = \"fluid\"\nshape = { box = { min = [0, 0], \
                        max = [\"16 mm\", \"40 mm\"] } }\nvelocity = [0, \"-116 m/s\"]\n[[wall]]\nname = \"target\"\nplane = { point = [0, 0], normal = \
                        [0, 1] }\n";
            let changes: Vec<_> = changes.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
            load_text("bird", deck, &changes).unwrap().notes
        };
        let told = bird(&[]);
        assert!(
            told.len() == 1 && told[0].contains("strikes at 116 m/s") && told[0].contains("updated-lagrangian"),
            "{told:?}"
        );
        assert_eq!(bird(&[("method", "updated-lagrangian")]), [""; 0]);
        // It flows, and does not splash; what flies away strikes nothing.
        assert_eq!(bird(&[("body.bird.velocity.1", "-10 m/s")]), [""; 0]);
        assert!(!bird(&[("body.bird.velocity.1", "116 m/s")]).join("").contains("splashes"));
        // Nor does what fills all that is between two planes of symmetry.
        let between =
            |side: &str| format!("[{{ axis = \"x\" }}, {{ axis = \"x\", at = \"{side} mm\", side = \"negative\" }}]");
        assert_eq!(bird(&[("symmetry", &between("16"))]), [""; 0]);
        assert!(bird(&[("symmetry", &between("20"))]).join("").contains("splashes"));
    }
}
