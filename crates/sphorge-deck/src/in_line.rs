//! Lattices of two bodies that lie in line where they strike each other fast.

use sphorge_engine::Particles;
use sphorge_engine::model::{Dimensions, Model};

/// Speed of an impact over the slower sound speed from which on plates with lattices in line pass into each other: copper at 1.1 km/s does not, at 1.5 km/s it does.
const FAST: f64 = 0.3;
/// Distance of columns of both bodies, in spacings, within which they are in line: a shift by 0.004 spacings heals most of it.
const IN_LINE: f64 = 0.002;
/// Share of a column's length along the motion within which particles are of the face, in spacings.
const AT_FACE: f64 = 0.75;
/// Most particles of a face that are looked at.
const MOST: usize = 400;

/// Pairs of bodies that meet fast with lattices in line, with what to do.
pub(crate) fn in_line(model: &Model, particles: &Particles) -> Vec<String> {
    if !model.has_facets() || model.dimensions == Dimensions::One {
        return Vec::new();
    }
    let pairs = (0..model.bodies.len()).flat_map(|a| (a + 1..model.bodies.len()).map(move |b| (a, b)));
    pairs.filter(|&(a, b)| are_in_line(model, particles, a, b)).map(|(a, b)| told(model, a, b)).collect()
}

fn told(model: &Model, a: usize, b: usize) -> String {
    let [a, b] = [a, b].map(|body| &model.bodies[body].name);
    format!(
        "bodies `{a}` and `{b}` strike each other fast with the lattices of their particles in line: free sides then let them pass into each other. Shift one of them \
         along their face by a tenth of a spacing"
    )
}

/// Mean velocity and box of a body.
fn motion(particles: &Particles, body: usize) -> Option<([f64; 3], [[f64; 2]; 3])> {
    let (mut sum, mut count, mut ends) = ([0.0; 3], 0.0, [[f64::INFINITY, f64::NEG_INFINITY]; 3]);
    for (i, _) in particles.body.iter().enumerate().filter(|(_, of)| **of as usize == body) {
        count += 1.0;
        for k in 0..3 {
            sum[k] += particles.velocity[i][k];
            ends[k] = [ends[k][0].min(particles.position[i][k]), ends[k][1].max(particles.position[i][k])];
        }
    }
    (count > 0.0).then(|| (sum.map(|sum| sum / count), ends))
}

fn are_in_line(model: &Model, particles: &Particles, a: usize, b: usize) -> bool {
    let (Some((velocity_a, box_a)), Some((velocity_b, box_b))) = (motion(particles, a), motion(particles, b)) else {
        return false;
    };
    let relative: [f64; 3] = std::array::from_fn(|k| velocity_a[k] - velocity_b[k]);
    let speed = relative.iter().map(|c| c * c).sum::<f64>().sqrt();
    let sound = |body: usize| model.materials[model.bodies[body].material].equation_of_state.reference_sound_speed();
    let along = (0..3).max_by(|&k, &l| relative[k].abs().total_cmp(&relative[l].abs())).unwrap_or(0);
    // Oblique impacts slide.
    if speed < FAST * sound(a).min(sound(b)) || relative[along].abs() < 0.95 * speed {
        return false;
    }
    // Sides that planes hold on both ends let nothing give way.
    let held = |axis: usize| {
        model.periodic[axis].is_some() || model.symmetry.iter().filter(|plane| plane.axis == axis).count() == 2
    };
    let across: Vec<usize> = (0..model.dimensions.count()).filter(|&axis| axis != along && !held(axis)).collect();
    if across.is_empty() {
        return false;
    }
    // The face of each that looks at the other.
    let is_above = box_a[along][0] > box_b[along][0];
    let spacing = |body: usize| model.bodies[body].spacing;
    let face = |body: usize, ends: &[[f64; 2]; 3], looks_down: bool| -> Vec<usize> {
        let end = ends[along][usize::from(!looks_down)];
        let is_at_face = |i: &usize| (particles.position[*i][along] - end).abs() < AT_FACE * spacing(body);
        (0..particles.len()).filter(|i| particles.body[*i] as usize == body).filter(is_at_face).collect()
    };
    let (ours, theirs) = (face(a, &box_a, is_above), face(b, &box_b, !is_above));
    let finer = spacing(a).min(spacing(b));
    // A quarter of the columns is enough: of lattices of 4 to 5 as many.
    let is_near = |&&i: &&usize| {
        theirs.iter().take(10 * MOST).any(|&j| {
            across.iter().all(|&k| (particles.position[i][k] - particles.position[j][k]).abs() < IN_LINE * finer)
        })
    };
    let looked_at = ours.len().min(MOST);
    looked_at > 3 && ours.iter().take(MOST).filter(is_near).count() > looked_at / 4
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
        // Slower, shifted, or by another contact or method.
        for sound in [
            ("body.a.velocity.1", "-1000 m/s"),
            ("body.a.shape.shift", "[\"0.02 mm\", 0]"),
            ("contact", "{ penalty = { surfaces = \"overlap\" } }"),
            ("method", "updated-lagrangian"),
            ("symmetry", "[{ axis = \"x\", at = \"-1 mm\" }, { axis = \"x\", at = \"7 mm\", side = \"negative\" }]"),
        ] {
            assert!(!is_told(&[sound]), "{sound:?}");
        }
        // A plate that flies up, and rings of another lattice.
        assert!(is_told(&[("body.a.velocity.1", "0 m/s"), ("body.b.velocity", "[\"0 m/s\", \"2000 m/s\"]")]));
    }
}
