//! Quarters of round bodies that are not held where they are cut: without planes of symmetry they are no part of a whole.

use sphorge_engine::Particles;
use sphorge_engine::model::{
    Dimensions, Model, MotionAxis, Operation, PrescribedMotion, Shape, Solid, Transform, WallSurface,
};

const AXES: [&str; 3] = ["x", "y", "z"];

/// One sentence for each body that is a quarter of a round one, with the planes that nothing holds it at.
///
/// A body counts as one if it is cut out of a solid of revolution along both planes through its axis, so that both could be planes of symmetry:
/// bodies that only begin at a plane are many.
pub(crate) fn notes(model: &Model, particles: &Particles) -> Vec<String> {
    if model.dimensions != Dimensions::Three {
        return Vec::new();
    }
    let round: Vec<_> = model.bodies.iter().map(|body| turned_about(&body.shape)).collect();
    if round.iter().all(Option::is_none) {
        return Vec::new();
    }
    // In one pass: there may be as many bodies as particles.
    let mut ends = vec![[(f64::INFINITY, f64::NEG_INFINITY); 3]; round.len()];
    for (body, position) in particles.body.iter().zip(&particles.position) {
        for (ends, x) in ends[*body as usize].iter_mut().zip(position) {
            *ends = (ends.0.min(*x), ends.1.max(*x));
        }
    }
    let cut = round.iter().zip(&ends).enumerate().filter_map(|(body, (round, ends))| {
        let (along, centre) = (*round)?;
        is_cut(along, centre, ends, model.bodies[body].spacing).then_some((body, along, centre))
    });
    cut.filter_map(|(body, along, centre)| note(model, particles, body, along, centre)).collect()
}

/// Whether a body turned about an axis through a point begins at both planes through it, if these are its lowest and highest coordinates, m.
fn is_cut(along: usize, centre: [f64; 3], ends: &[(f64, f64); 3], spacing: f64) -> bool {
    (0..3).filter(|axis| *axis != along).all(|axis| {
        let (low, high) = (ends[axis].0 - centre[axis], ends[axis].1 - centre[axis]);
        let (near, far) = if high > -low { (low, high) } else { (-high, -low) };
        (-1e-6 * spacing..spacing).contains(&near) && far > 2.0 * spacing
    })
}

/// What there is to say of a body that is cut, unless it is held there.
fn note(model: &Model, particles: &Particles, index: usize, along: usize, centre: [f64; 3]) -> Option<String> {
    let body = &model.bodies[index];
    let is_driven = |axis: usize| {
        let drives = |motion: &PrescribedMotion, regions| {
            regions >> motion.region & 1 == 1 && !matches!(motion.axes[axis], MotionAxis::Free)
        };
        let own = particles.body.iter().zip(&particles.regions).filter(|(of, _)| **of as usize == index);
        !model.motions.is_empty()
            && own.into_iter().any(|(_, regions)| model.motions.iter().any(|motion| drives(motion, *regions)))
    };
    let is_held = |axis: usize| {
        model.symmetry.iter().any(|plane| plane.axis == axis)
            || model.periodic[axis].is_some()
            || model.walls.iter().any(|wall| is_across(&wall.surface, axis))
            || is_driven(axis)
    };
    let across = (0..3).filter(|axis| *axis != along);
    let free: Vec<usize> = across.filter(|axis| !is_held(*axis)).collect();
    let planes: Vec<String> = free.iter().map(|k| format!("{} = {} mm", AXES[*k], plain(1e3 * centre[*k]))).collect();
    let keys: Vec<String> = free.iter().map(|k| format!("`axis = \"{}\"`", AXES[*k])).collect();
    (!free.is_empty()).then(|| {
        format!(
            "body `{}` is a quarter of a round one, and nothing holds it where it is cut, at {}: add [[symmetry]] with {}, or make it whole",
            body.name,
            planes.join(" and "),
            keys.join(", and one with ")
        )
    })
}

/// Whether a wall may hold particles along an axis.
fn is_across(surface: &WallSurface, axis: usize) -> bool {
    match surface {
        WallSurface::Plane { normal, .. } => normal[axis] != 0.0,
        WallSurface::Segment { .. } => true,
    }
}

/// A number without a sign of zero.
fn plain(x: f64) -> f64 {
    x + 0.0
}

/// The coordinate axis that a shape, or what it is cut out of, is turned about, and a point of that axis, m.
fn turned_about(shape: &Shape) -> Option<(usize, [f64; 3])> {
    if shape.transform.rotation != Transform::default().rotation {
        return None;
    }
    let (from, direction) = match &shape.solid {
        Solid::Cylinder { from, to, .. } | Solid::Ogive { from, to, .. } => {
            (*from, std::array::from_fn(|k| to[k] - from[k]))
        }
        Solid::Revolution { from, axis, .. } => (*from, *axis),
        Solid::Composed { operation, parts } => {
            let looked_at = match operation {
                Operation::Intersection => parts.len(),
                Operation::Difference => 1,
                Operation::Union => 0,
            };
            let (along, centre) = parts.iter().take(looked_at).find_map(turned_about)?;
            return Some((along, shifted(centre, &shape.transform)));
        }
        Solid::Box { .. } | Solid::Ball { .. } | Solid::Polygon { .. } | Solid::Cloud { .. } => return None,
    };
    let lengths: [f64; 3] = direction;
    let along = (0..3).find(|k| (0..3).all(|other| other == *k || lengths[other] == 0.0))?;
    Some((along, shifted(from, &shape.transform)))
}

fn shifted(point: [f64; 3], transform: &Transform) -> [f64; 3] {
    std::array::from_fn(|k| point[k] + transform.translation[k])
}

#[cfg(test)]
mod tests {
    use crate::load_text;

    const QUARTER: &str = "dimensions = \"3d\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"1 us\" }\n[[body]]\nname = \"bar\"\nmaterial = \
                           \"armco-iron\"\nvelocity = [0, 0, 1]\nshape = { intersection = [{ cylinder = { from = [0, 0, 0], to = [0, 0, \"9 mm\"], radius \
                           = \"5 mm\" } }, { box = { min = [0, 0, 0], max = [\"9 mm\", \"9 mm\", \"9 mm\"] } }] }\n";
    const SYMMETRY: &str = "[[symmetry]]\naxis = \"x\"\n[[symmetry]]\naxis = \"y\"\n";

    fn notes(deck: &str) -> Vec<String> {
        let notes = load_text("bar", deck, &[]).unwrap_or_else(|report| panic!("{report}")).all_notes();
        notes.into_iter().filter(|note| note.contains("quarter")).collect()
    }

    #[test]
    fn a_quarter_that_nothing_holds_is_told() {
        let told = notes(QUARTER);
        assert!(told.len() == 1 && told[0].contains("cut, at x = 0 mm and y = 0 mm: add"), "{told:?}");
        let told = notes(&format!("{QUARTER}[[symmetry]]\naxis = \"y\"\n"));
        assert!(
            told.len() == 1 && told[0].contains("cut, at x = 0 mm: add [[symmetry]] with `axis = \"x\"`,"),
            "{told:?}"
        );
        let floor = "[[wall]]\nname = \"floor\"\nplane = { point = [0, 0, 0], normal = [0, 0, 1] }\n";
        assert_eq!(notes(&format!("{QUARTER}{floor}")).len(), 1);
        // Cut on the other side.
        let other = QUARTER.replace("min = [0, 0, 0], max = [\"9 mm\"", "min = [\"-9 mm\", 0, 0], max = [0");
        assert_eq!(notes(&other).len(), 1);
    }

    #[test]
    fn what_is_held_or_is_no_quarter_is_not() {
        let hold =
            "[[region]]\nname = \"end\"\nbody = \"bar\"\n[[motion]]\nregion = \"end\"\nvelocity = [0, 0, \"free\"]\n";
        let walls = "[[wall]]\nname = \"a\"\nplane = { point = [0, 0, 0], normal = [1, 0, 0] }\n[[wall]]\nname = \"b\"\nplane = { point = [0, 0, 0], normal = [0, 1, 0] }\n";
        for more in [SYMMETRY, hold, walls] {
            assert_eq!(notes(&format!("{QUARTER}{more}")), [""; 0], "{more}");
        }
        // A whole bar, a half, a bar beside the planes, and a block that begins at them.
        for (old, new) in [
            ("min = [0, 0, 0]", "min = [\"-9 mm\", \"-9 mm\", 0]"),
            ("min = [0, 0, 0]", "min = [\"-9 mm\", 0, 0]"),
            (
                "from = [0, 0, 0], to = [0, 0, \"9 mm\"]",
                "from = [\"6 mm\", \"6 mm\", 0], to = [\"6 mm\", \"6 mm\", \"9 mm\"]",
            ),
            ("{ cylinder = { from = [0, 0, 0], to = [0, 0, \"9 mm\"], radius = \"5 mm\" } }, ", ""),
        ] {
            let deck = QUARTER.replace(old, new);
            assert_ne!(deck, QUARTER);
            assert_eq!(notes(&deck), [""; 0], "{new}");
        }
    }
}
