//! Neighbour lists that are kept on a GPU, beside the processor's engine.

use super::card::gpu;
use super::engine::{conserves_and_repeats, start};
use sphorge_engine::{Cpu, EngineKind, Simulation};

/// The bullet of the paper, coarse, through the middle of the plate.
pub(super) const BULLET: [(&str, &str); 3] = [
    ("particles.spacing", "\"12 mm\""),
    ("body.bullet.spacing", "\"12 mm\""),
    (
        "body.plate.shape",
        "{ box = { min = [\"-102 mm\", \"-102 mm\", \"-30 mm\"], max = [\"102 mm\", \"102 mm\", \"0 mm\"] } }",
    ),
];

/// Mean velocity of a body along an axis, m/s.
fn speed(simulation: &Simulation, body: usize, axis: usize) -> f64 {
    let ledger = simulation.ledger().unwrap();
    ledger.bodies[body].momentum[axis] / ledger.bodies[body].mass
}

/// Runs of both engines: the share that is searched of each of the first steps, and of all to a time, s, and how fast a body is along an axis at
/// the end, which is to be as near as that.
pub(super) fn compare(
    deck: &str,
    overrides: &[(&str, &str)],
    (steps, end): (usize, f64),
    (body, axis, near): (usize, usize, f64),
) {
    let [theirs, ours] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
        let mut simulation = start(kind, deck, overrides);
        let (mut fractions, mut searched, mut neighbors) = (Vec::new(), (Vec::new(), Vec::new()), Vec::new());
        while simulation.time() < end {
            fractions.push(simulation.step(Some(end)).unwrap().searched_fraction);
            if fractions.len() == steps {
                let p = simulation.particles().unwrap();
                let adapted: u32 = p.adapted.iter().sum();
                assert_eq!(f64::from(adapted) / p.len() as f64, fractions[steps - 1], "{}", kind.name());
                searched = (p.adapted, p.last_searched);
                neighbors = p.neighbors;
            }
        }
        let mean = fractions.iter().sum::<f64>() / fractions.len() as f64;
        (fractions, mean, speed(&simulation, body, axis), searched, neighbors)
    });
    assert!(theirs.0[..steps].iter().any(|share| *share > 0.0) && theirs.1 < 0.9, "{}", theirs.1);
    assert_eq!(ours.0[..steps], theirs.0[..steps]);
    assert!((ours.1 - theirs.1).abs() < 0.02 * theirs.1, "searched {} on the card, {}", ours.1, theirs.1);
    assert_eq!(ours.3, theirs.3);
    // Rows that are patched have the neighbours they gained.
    assert_eq!(ours.4, theirs.4);
    let (ours, theirs) = (ours.2, theirs.2);
    assert!((ours - theirs).abs() < near * theirs.abs(), "{ours} m/s on the card, {theirs}");
}

#[test]
fn lists_with_a_skin_are_searched_again_when_the_cpu_does() {
    let plate = [("particles.spacing", "\"0.6 mm\""), ("search", "\"skin\"")];
    compare("taylor-plate", &plate, (100, 8e-6), (0, 1, 1e-3));
    // In flight no two close in.
    let far = ("wall.0.plane", "{ point = [\"0 mm\", \"-0.6 mm\"], normal = [0, 1] }");
    compare("taylor-plate", &[&plate[..], &[far]].concat(), (150, 8e-6), (0, 1, 1e-3));
}

#[test]
fn the_bullet_of_the_paper_matches_the_cpu_with_its_skin() {
    // Twenty steps later the last digits decide which pairs are within the support.
    compare("bullet", &BULLET, (80, 0.2e-3), (1, 2, 5e-3));
}

#[test]
fn pairs_beyond_the_support_do_not_limit_the_step() {
    // The disc comes at 6 km/s, its nearest particles beyond the kernel and within the skin.
    let disc = [
        ("particles.spacing", "\"0.8 mm\""),
        ("body.disc.shape", "{ disc = { centre = [\"0 mm\", \"6.4 mm\"], radius = \"5 mm\" } }"),
        ("search", "{ skin = { fraction = 0.4 } }"),
    ];
    let steps = |search: &'static str, kind: &dyn EngineKind| {
        let mut simulation = start(kind, "penetration", &[&disc[..2], &[("search", search)]].concat());
        [(); 2].map(|()| simulation.step(None).unwrap().dt)
    };
    let theirs = steps(disc[2].1, &Cpu);
    for search in [disc[2].1, "\"every-step\""] {
        for (ours, theirs) in steps(search, &gpu()).into_iter().zip(theirs) {
            assert!((ours / theirs - 1.0).abs() < 1e-5, "{search}: {ours} s on the card, {theirs}");
        }
    }
}

#[test]
fn a_state_with_verlet_lists_resumes_to_the_same_bits() {
    conserves_and_repeats("bullet", &BULLET, 40e-6);
}

/// The bullet searched by a rule, through a plate so large that most of it is not.
fn bullet(rule: &'static str) -> Vec<(&'static str, &'static str)> {
    let plate = "{ box = { min = [\"-222 mm\", \"-222 mm\", \"-30 mm\"], max = [\"222 mm\", \"222 mm\", \"0 mm\"] } }";
    [&BULLET[..2], &[("body.plate.shape", plate), ("search", rule)]].concat()
}

#[test]
fn the_guarded_adaptive_search_matches_the_cpu() {
    compare("bullet", &bullet("\"adaptive\""), (120, 0.1e-3), (1, 2, 5e-3));
}

#[test]
fn pairs_of_searched_and_other_particles_are_in_both_rows() {
    // Few flow by so much in a step, and neighbours come and go on the border of those. Pairs that one row alone has take momentum.
    let rule = ("search", "{ adaptive = { plastic-strain-threshold = 2e-3, strain-bound = 0.02 } }");
    conserves_and_repeats("taylor-plate", &[("particles.spacing", "\"0.6 mm\""), rule], 4e-6);
}

#[test]
fn the_adaptive_search_as_published_matches_the_cpu() {
    compare("bullet", &bullet("{ adaptive = { guard = \"none\", accumulate = true } }"), (60, 60e-6), (1, 2, 5e-3));
}

#[test]
fn the_adaptive_search_by_corrected_gradients_and_beside_planes_matches_the_cpu() {
    let plate = [
        ("particles.spacing", "\"0.6 mm\""),
        ("search", "\"adaptive\""),
        ("numerics.gradient-correction", "\"linear\""),
        ("symmetry", "[{ axis = \"x\" }]"),
        ("body.plate.shape", "{ box = { min = [\"0 mm\", \"0 mm\"], max = [\"3.6 mm\", \"12 mm\"] } }"),
    ];
    compare("taylor-plate", &plate, (60, 4e-6), (0, 1, 1e-3));
    compare("taylor-plate", &[&plate[..2], &plate[3..]].concat(), (60, 4e-6), (0, 1, 1e-3));
}

#[test]
fn patched_rows_are_reproducible_and_conserve_momentum() {
    conserves_and_repeats("bullet", &bullet("\"adaptive\""), 15e-6);
}
