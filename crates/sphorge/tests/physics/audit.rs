//! What audits count, beside every pair of particles and images tested.

use super::setup::simulation;
use sphorge::decks;
use sphorge::engine::{Audit, Simulation};
use std::collections::{HashMap, HashSet};

/// Particle, the source of its neighbour, and which image of that it is.
type Pair = (usize, usize, usize);

/// Pairs within the kernel support of particles and images at these positions, m, each from both ends.
fn pairs(simulation: &Simulation, positions: &[[f64; 3]]) -> HashSet<Pair> {
    let (model, h) = (simulation.model(), &simulation.particles().unwrap().smoothing_length);
    let support = model.numerics.kernel.support();
    let images = |x: [f64; 3]| {
        let mut images = vec![x];
        for plane in &model.symmetry {
            for k in 0..images.len() {
                let mut image = images[k];
                image[plane.axis] = 2.0 * plane.position - image[plane.axis];
                images.push(image);
            }
        }
        for (axis, cell) in model.periodic.iter().enumerate() {
            let Some((low, high)) = *cell else { continue };
            let inner = images.clone();
            for length in [high - low, low - high] {
                images.extend(inner.iter().map(|x| [0, 1, 2].map(|a| if a == axis { x[a] + length } else { x[a] })));
            }
        }
        images
    };
    let mut pairs = HashSet::new();
    for (j, &source) in positions.iter().enumerate() {
        for (k, image) in images(source).into_iter().enumerate() {
            for (i, x) in positions.iter().enumerate().filter(|&(i, _)| k > 0 || i != j) {
                let reach = support * 0.5 * (h[i] + h[j]);
                if (0..3).map(|a| (x[a] - image[a]).powi(2)).sum::<f64>() < reach * reach {
                    pairs.insert((i, j, k));
                }
            }
        }
    }
    pairs
}

/// Positions by the number of the particle, m.
fn by_number(simulation: &Simulation) -> HashMap<u32, [f64; 3]> {
    let p = simulation.particles().unwrap();
    p.id.iter().copied().zip(p.position.iter().copied()).collect()
}

/// Steps to a time, s, and hands every audit on with the simulation as it is.
fn audits(text: &str, overrides: &[(&str, &str)], end: f64, mut check: impl FnMut(&Simulation, Audit)) {
    let mut simulation = simulation(text, overrides);
    let mut any = false;
    while simulation.time() < end {
        if let Some(audit) = simulation.step(None).unwrap().audit {
            check(&simulation, audit);
            any = true;
        }
    }
    assert!(any);
}

#[test]
fn images_that_came_near_after_the_start_are_counted() {
    let bar = [
        ("particles.spacing", "\"0.95 mm\""),
        ("search", "{ total-lagrangian = { renewal = 0, self-contact = false } }"),
        ("audit", "20"),
    ];
    let text = decks::find("copper-bar").unwrap().text;
    let at_start = by_number(&simulation(text, &bar));
    let mut new_images = 0;
    audits(text, &bar, 8e-6, |simulation, audit| {
        let p = simulation.particles().unwrap();
        let reference: Vec<_> = p.id.iter().map(|id| at_start[id]).collect();
        let (now, then) = (pairs(simulation, &p.position), pairs(simulation, &reference));
        let counts = [now.len(), now.difference(&then).count(), then.difference(&now).count()];
        assert_eq!([audit.pairs, audit.missed_pairs, audit.stale_pairs], counts.map(|count| count as u64));
        // Of images that have no pair in the reference configuration.
        let images: HashSet<_> = then.iter().map(|&(_, j, k)| (j, k)).collect();
        new_images += now.iter().filter(|&&(_, j, k)| !images.contains(&(j, k))).count();
    });
    assert!(new_images > 10, "{new_images}");
}

/// A striker that flies at a post and at its own image, which is far from it at the start.
const OBLIQUE: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
search = { total-lagrangian = { renewal = 0 } }
contact = { penalty = { friction = 0.2 } }
time = { end = "20 us" }
audit = 20
symmetry = [{ axis = "x" }]

[[body]]
name = "post"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["3 mm", "4 mm"] } }

[[body]]
name = "striker"
material = "ofhc-copper"
shape = { box = { min = ["2 mm", "4.6 mm"], max = ["5 mm", "8 mm"] } }
velocity = ["-250 m/s", "-150 m/s"]
"#;

#[test]
fn images_that_the_contact_has_found_are_not_missed() {
    let mut of_images = 0;
    audits(OBLIQUE, &[], 16e-6, |simulation, audit| {
        let p = simulation.particles().unwrap();
        let now = pairs(simulation, &p.position);
        assert_eq!(audit.pairs, now.len() as u64);
        assert_eq!(audit.missed_foreign_pairs, 0, "{audit:?}");
        of_images += now.iter().filter(|&&(i, j, k)| k > 0 && p.body[i] != p.body[j]).count();
    });
    assert!(of_images > 10, "{of_images}");
}

/// Two parts of a body in a periodic cell that pass each other and leave it at both ends: what has an initial configuration is not brought back.
const PASSING: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
search = { total-lagrangian = { renewal = 0 } }
time = { end = "40 us" }
audit = 10
periodic = { y = ["0 mm", "6 mm"] }

[[body]]
name = "parts"
material = "armco-iron"
shape.union = [
    { box = { min = ["0 mm", "0 mm"], max = ["3 mm", "3 mm"] } },
    { box = { min = ["3.6 mm", "2 mm"], max = ["6 mm", "5 mm"] } },
]

[[region]]
name = "left"
body = "parts"
shape = { box = { min = ["0 mm", "0 mm"], max = ["3 mm", "3 mm"] } }

[[region]]
name = "right"
body = "parts"
shape = { box = { min = ["3.6 mm", "2 mm"], max = ["6 mm", "5 mm"] } }

[[motion]]
region = "left"
velocity = ["0 m/s", "-150 m/s"]

[[motion]]
region = "right"
velocity = ["0 m/s", "150 m/s"]
"#;

#[test]
fn images_of_parts_that_have_left_their_periodic_cell_are_counted() {
    let mut of_images = 0;
    audits(PASSING, &[], 24e-6, |simulation, audit| {
        let p = simulation.particles().unwrap();
        let now = pairs(simulation, &p.position);
        assert_eq!(audit.pairs, now.len() as u64);
        let is_left = |i: usize| p.position[i][0] < 3.3e-3;
        // Farther from the ends than a particle of the cell may be to have an image.
        let far = |i: usize| (1.5e-3..4.5e-3).contains(&p.position[i][1]);
        of_images += now.iter().filter(|&&(i, j, k)| k > 0 && is_left(i) != is_left(j) && far(j)).count();
    });
    assert!(of_images > 10, "{of_images}");
}
