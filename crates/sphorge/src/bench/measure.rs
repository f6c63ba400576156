//! One measurement: warm up, step against the clock, divide.

use super::BenchRow;
use crate::{
    deck::{DeckReport, Setup},
    engine::{RunFailure, Simulation, StageSeconds},
};
use serde::Serialize;
use std::time::Instant;

/// Steps before the clock starts: memory is touched, lists have their size, frequencies have settled.
const WARM_UP_STEPS: u64 = 3;
/// Fewest steps that are measured.
const LEAST_STEPS: u64 = 5;

/// What can stop a benchmark.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum BenchError {
    /// No pool of threads.
    #[error("cannot start the threads: {0}")]
    #[diagnostic(help("ask for fewer with `--threads N`"))]
    Threads(String),
    /// A shipped deck cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(DeckReport),
    /// A shipped deck cannot be stepped.
    #[error(transparent)]
    Failed(#[from] RunFailure),
}

/// Share of the measured time by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageShares {
    /// Neighbour search.
    pub search: f64,
    /// Velocity gradient and density rate.
    pub kinematics: f64,
    /// Constitutive update.
    pub stress: f64,
    /// Forces.
    pub forces: f64,
    /// Integration, guard, time step.
    pub integrate: f64,
}

impl StageShares {
    /// Shares of the time that passed between two readings of the stage clock.
    fn between(before: StageSeconds, after: StageSeconds) -> Self {
        let search = after.search - before.search;
        let kinematics = after.kinematics - before.kinematics;
        let stress = after.stress - before.stress;
        let forces = after.forces - before.forces;
        let integrate = after.integrate - before.integrate;
        let all = search + kinematics + stress + forces + integrate;
        let share = |seconds: f64| if all > 0.0 { seconds / all } else { 0.0 };
        Self {
            search: share(search),
            kinematics: share(kinematics),
            stress: share(stress),
            forces: share(forces),
            integrate: share(integrate),
        }
    }
}

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
    fn shares_are_of_the_time_between_the_readings() {
        let before =
            StageSeconds { search: 1.0, kinematics: 1.0, stress: 1.0, forces: 1.0, integrate: 1.0, output: 9.0 };
        let after =
            StageSeconds { search: 3.0, kinematics: 2.0, stress: 1.5, forces: 5.0, integrate: 1.5, output: 99.0 };
        let shares = StageShares::between(before, after);
        let expected = StageShares { search: 0.25, kinematics: 0.125, stress: 0.0625, forces: 0.5, integrate: 0.0625 };
        assert_eq!(shares, expected);
        assert_eq!(StageShares::between(after, after), StageShares::default());
    }

    #[test]
    fn rates_fit_together() {
        let deck = r#"
            dimensions = "plane-strain"
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
