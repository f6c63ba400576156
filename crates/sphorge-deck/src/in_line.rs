//! Lattices of two bodies that lie in line where they strike each other fast.

use super::impacts::each_impact;
use sphorge_engine::Particles;
use sphorge_engine::model::{Dimensions, Model};
use std::collections::BTreeSet;

/// Speed of an impact over the slower sound speed from which on bodies with lattices in line pass into each other: copper does not at 1.0 km/s, hardly at 1.2, and
/// does at 1.5.
const FAST: f64 = 0.3;
/// Share of that speed along the normal: what strikes obliquely slides.
const STRAIGHT: f64 = 0.95;
/// Distance of edges of cells of both bodies, in spacings, within which they are in line: a shift by 0.004 spacings heals most of it.
const IN_LINE: f64 = 0.002;
/// Share of the cells of a face with such edges from which on it is told: one in eight.
const TOLD: usize = 8;
/// Distance from the end of a body within which particles are of its face, in spacings.
const AT_FACE: f64 = 0.75;
/// Most particles of a face that are looked at.
const MOST: usize = 400;

/// Pairs of bodies that meet fast with lattices in line, with what to do.
pub(crate) fn in_line(model: &Model, particles: &Particles) -> Vec<String> {
    if !model.has_facets() || model.dimensions == Dimensions::One {
        return Vec::new();
    }
    let sound = |body: usize| model.materials[model.bodies[body].material].equation_of_state.reference_sound_speed();
    let mut fast = BTreeSet::new();
    each_impact(model, &mut |impact| {
        let Some(other) = impact.other else { return };
        let is_fast = impact.normal > FAST * sound(impact.body).min(sound(other));
        if is_fast && impact.normal > STRAIGHT * impact.speed {
            fast.insert((impact.body, other, impact.axis));
        }
    });
    let fast = fast.into_iter().filter(|&(a, b, axis)| are_in_line(model, particles, [a, b], axis));
    let named: BTreeSet<(usize, usize)> = fast.map(|(a, b, _)| (a, b)).collect();
    let told = |(a, b): (usize, usize)| {
        format!(
            "bodies `{}` and `{}` strike each other fast with the lattices of their particles in line: where their sides are free, they then pass into each other. \
             Shift one of them along their face by a tenth of a spacing",
            model.bodies[a].name, model.bodies[b].name
        )
    };
    named.into_iter().map(told).collect()
}

/// Whether cells at the faces with which bodies meet along an axis have edges in line, across an axis along which something is free to move.
fn are_in_line(model: &Model, particles: &Particles, bodies: [usize; 2], along: usize) -> bool {
    let is_held = |axis: usize| {
        model.periodic[axis].is_some() || model.symmetry.iter().filter(|plane| plane.axis == axis).count() == 2
    };
    let across: Vec<usize> = (0..model.dimensions.count()).filter(|&axis| axis != along).collect();
    if across.iter().all(|&axis| is_held(axis)) {
        return false;
    }
    let spacing = bodies.map(|body| model.bodies[body].spacing);
    let members =
        bodies.map(|body| (0..particles.len()).filter(|&i| particles.body[i] as usize == body).collect::<Vec<_>>());
    let place = |i: usize| particles.position[i][along];
    let ends = [0, 1].map(|k| {
        let places = members[k].iter().map(|&i| place(i));
        places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    });
    let is_below = ends[0][0] < ends[1][0];
    let face = |k: usize| {
        let end = ends[k][usize::from((k == 0) == is_below)];
        let at_face = members[k].iter().filter(move |&&i| (place(i) - end).abs() < AT_FACE * spacing[k]);
        at_face.copied().collect::<Vec<usize>>()
    };
    let faces = [face(0), face(1)];
    let few = usize::from(faces[1].len() < faces[0].len());
    let finer = spacing[0].min(spacing[1]);
    // Cells of a square lattice end half a spacing from their particle.
    let are_near = |i: usize, j: usize, axis: usize| {
        let apart = particles.position[i][axis] - particles.position[j][axis];
        let half = [0.5 * (spacing[0] + spacing[1]), 0.5 * (spacing[0] - spacing[1])];
        half.iter().any(|half| (apart.abs() - half.abs()).abs() < IN_LINE * finer)
    };
    let looked_at = &faces[few][..faces[few].len().min(MOST)];
    let is_in_line = |&&i: &&usize| faces[1 - few].iter().any(|&j| across.iter().all(|&axis| are_near(i, j, axis)));
    let count = looked_at.iter().filter(is_in_line).count();
    count > 0 && TOLD * count >= looked_at.len()
}

#[cfg(test)]
mod tests {
    use crate::load_text;

    /// Whether a note speaks of lattices in line in an impact of two plates of copper, with keys of the deck changed.
    fn is_told(changes: &[(&str, &str)]) -> bool {
        let deck = "dimensions = \"plane-strain\"\nparticles = { spacing = \"0.25 mm\" }\ntime = { end = \"1 us\" }\n\
                    [[body]]\nname = \"a\"\nmaterial = \"ofhc-copper\"\nvelocity = [\"0 m/s\", \"-2000 m/s\"]\n\
                    shape = { box = { min = [\"0 mm\", \"0 mm\"], max = [\"6 mm\", \"3 mm\"] } }\n\
                    [[body]]\nname = \"b\"\nmaterial = \"ofhc-copper\"\n\
                    shape = { box = { min = [\"-1 mm\", \"-4 mm\"], max = [\"7 mm\", \"0 mm\"] } }\n";
        let changes: Vec<_> = changes.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
        let setup = load_text("plates", deck, &changes).unwrap_or_else(|report| panic!("{report:?}"));
        setup.notes.iter().any(|note| note.contains("`a` and `b` strike each other fast with the lattices"))
    }

    #[test]
    fn plates_that_meet_fast_with_lattices_in_line_are_told() {
        assert!(is_told(&[]));
        // A plate that flies up; edges of every second, third, fifth cell.
        assert!(is_told(&[("body.a.velocity.1", "0 m/s"), ("body.b.velocity", "[\"0 m/s\", \"2000 m/s\"]")]));
        for spacing in ["0.125 mm", "0.08333333333333333 mm", "0.2 mm"] {
            assert!(is_told(&[("body.a.spacing", spacing)]), "{spacing}");
        }
        // Slower, oblique, apart, shifted, by another contact or method, or held by planes.
        for sound in [
            &[("body.a.velocity.1", "-1000 m/s")][..],
            &[("body.a.velocity.0", "1000 m/s")],
            &[("body.a.velocity.1", "2000 m/s")],
            &[("body.a.shape.shift", "[\"0.025 mm\", 0]")],
            &[("body.a.spacing", "0.125 mm"), ("body.a.shape.shift", "[\"0.025 mm\", 0]")],
            &[("contact", "{ penalty = { surfaces = \"overlap\" } }")],
            &[("method", "updated-lagrangian")],
            &[("symmetry", "[{ axis = \"x\", at = \"-1 mm\" }, { axis = \"x\", at = \"7 mm\", side = \"negative\" }]")],
        ] {
            assert!(!is_told(sound), "{sound:?}");
        }
    }
}
