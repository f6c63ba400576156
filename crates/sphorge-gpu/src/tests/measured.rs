//! What is counted and timed on a GPU.

use super::card::{card, gpu};
use super::engine::start;
use crate::Gpu;
use crate::device::Profile;

const PLATE: (&str, &[(&str, &str)]) =
    ("taylor-plate", &[("particles.spacing", "\"0.6 mm\""), ("search", "\"every-step\"")]);

#[test]
fn neighbours_of_a_step_are_those_of_all_particles() {
    // What is copied back of the finer was reduced by a pass, that of the coarser was not.
    for (spacing, is_reduced) in [("\"0.2 mm\"", true), ("\"0.9 mm\"", false)] {
        let mut simulation = start(&gpu(), PLATE.0, &[("particles.spacing", spacing), PLATE.1[1]]);
        assert_eq!(simulation.particles().unwrap().len() > 256 * 16, is_reduced);
        for _ in 0..3 {
            let pairs = simulation.step(None).unwrap().pairs;
            let particles = simulation.particles().unwrap();
            let neighbors: u64 = particles.neighbors.iter().map(|count| u64::from(*count)).sum();
            assert!(neighbors > 10 * particles.len() as u64);
            assert_eq!(pairs, neighbors);
        }
    }
}

#[test]
fn profiling_times_kernels_without_changing_the_run() {
    let card = card();
    let profile = Profile::default();
    let timed = Gpu { profile: Some(profile.clone()), ..gpu() };
    let [plain, timed] = [gpu(), timed].map(|kind| {
        let mut simulation = start(&kind, PLATE.0, PLATE.1);
        for step in 0..6 {
            // In a pause nothing is timed.
            profile.pause(step < 2);
            simulation.step(None).unwrap();
        }
        let particles = simulation.particles().unwrap();
        (particles.len(), simulation.mean_neighbors(), particles.velocity)
    });
    assert!(plain == timed, "what is counted changes what is computed");
    let kernels = profile.take();
    let (count, neighbors, _) = plain;
    let forces = kernels.iter().find(|of| of.kernel == "forces").unwrap();
    // Seven evaluations, three of them in a pause; of the others one was counted instead.
    assert_eq!(forces.launches, 3);
    assert!(forces.seconds > 0.0);
    let work = forces.work.unwrap();
    let per_pair = work.operations / (count as f64 * neighbors);
    assert!((30.0..300.0).contains(&per_pair), "{per_pair} operations of a pair");
    assert!(kernels.windows(2).all(|pair| pair[0].seconds >= pair[1].seconds));
    assert!(profile.take().is_empty());
    let limits = card.yardstick().unwrap();
    assert!(limits.bytes_per_second > 1e6 && limits.operations_per_second > 1e6 && limits.launch_seconds > 0.0);
}
