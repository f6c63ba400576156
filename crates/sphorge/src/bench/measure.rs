//! One measurement: warm up, step against the clock, divide.

use super::{BenchRow, StageShares};
use crate::{
    deck::Setup,
    engine::{RunFailure, Simulation},
};
use std::time::Instant;

/// Steps before the clock starts: memory is touched, lists have their size, frequencies have settled.
const WARM_UP_STEPS: u64 = 3;
/// Fewest steps that are measured.
const LEAST_STEPS: u64 = 5;

/// Steps a model for `seconds` of wall-clock time in the present thread pool.
pub(super) fn measure(setup: Setup, precision: &str, search: &str, seconds: f64) -> Result<BenchRow, RunFailure> {
    let case = setup.model.name.clone();
    let particles = setup.particles.len();
    let mut simulation = Simulation::new(setup.model, setup.particles);
    for _ in 0..WARM_UP_STEPS {
        simulation.step(None)?;
    }
    let before = simulation.stage_seconds();
    let start = Instant::now();
    let (mut steps, mut pairs, mut searched) = (0, 0, 0.0);
    while steps < LEAST_STEPS || start.elapsed().as_secs_f64() < seconds {
        let report = simulation.step(None)?;
        steps += 1;
        pairs += report.pairs;
        searched += report.searched_fraction;
    }
    let wall_seconds = start.elapsed().as_secs_f64();
    let per_second_per_core = 1.0 / (wall_seconds * rayon::current_num_threads() as f64);
    Ok(BenchRow {
        case,
        precision: precision.to_owned(),
        search: search.to_owned(),
        particles,
        mean_neighbors: simulation.mean_neighbors(),
        steps,
        wall_seconds,
        particle_steps_per_second_per_core: (particles as u64 * steps) as f64 * per_second_per_core,
        share_of_bare_loop: None,
        pairs_per_second_per_core: pairs as f64 * per_second_per_core,
        searched_fraction: searched / steps as f64,
        stage_shares: StageShares::between(before, simulation.stage_seconds()),
        bytes_per_particle: simulation.memory_bytes() as f64 / particles.max(1) as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_fit_together() {
        let deck = r#"
            dimensions = "plane-strain"
            method = "updated-lagrangian"
            particles.spacing = "1 mm"
            time.end = "1 ms"
            [[body]]
            name = "square"
            material = "armco-iron"
            shape = { box = { min = ["0 mm", "0 mm"], max = ["10 mm", "10 mm"] } }
        "#;
        let setup = crate::deck::load_text("square", deck, &[]).unwrap();
        let row = measure(setup, "mixed", "skin", 0.0).unwrap();
        assert_eq!((row.case.as_str(), row.particles, row.steps), ("square", 100, LEAST_STEPS));
        // At rest every step has the same pairs.
        let ratio = row.pairs_per_second_per_core / row.particle_steps_per_second_per_core;
        assert!((ratio / row.mean_neighbors - 1.0).abs() < 1e-12);
        let cores = rayon::current_num_threads() as f64;
        let steps = row.particle_steps_per_second_per_core * row.wall_seconds * cores;
        assert!((steps / (100 * LEAST_STEPS) as f64 - 1.0).abs() < 1e-12);
        assert_eq!(row.searched_fraction, 0.0);
        assert!(row.bytes_per_particle > 500.0);
    }
}
