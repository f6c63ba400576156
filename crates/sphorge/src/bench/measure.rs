//! One measurement: warm up, step against the clock, divide.

use super::{BenchRow, KernelClock, StageShares};
use crate::{
    deck::Setup,
    engine::{EngineKind, RunFailure, Simulation},
    run::repeat::Repeater,
};
use std::time::Instant;

/// Steps before the clock starts: memory is touched, lists have their size, frequencies have settled.
const WARM_UP_STEPS: u64 = 3;
/// Fewest steps that are measured.
const LEAST_STEPS: u64 = 5;

/// A measurement, and why its kernels were not timed where they should have been.
pub(super) type Timed = (BenchRow, Option<RunFailure>);

/// Steps a model for `seconds` of wall-clock time in the present thread pool, and as long again with a clock for its kernels: a start can take longer
/// than both.
pub(super) fn measure(
    (kind, clock): (&dyn EngineKind, Option<&KernelClock>),
    setup: Setup,
    precision: &str,
    search: &str,
    seconds: f64,
) -> Result<Timed, RunFailure> {
    let case = setup.model.name.clone();
    let particles = setup.particles.len();
    let kind = clock.map_or(kind, |clock| &*clock.engine);
    let mut simulation = Simulation::start(kind, setup.model, setup.particles)?;
    // One of all steps: to keep a state can take longer than a step.
    let mut repeater = Repeater::new(&simulation);
    for _ in 0..WARM_UP_STEPS {
        repeater.step(&mut simulation)?;
    }
    let before = simulation.stage_seconds();
    let measured = steps((&mut repeater, &mut simulation), seconds)?;
    let after = simulation.stage_seconds();
    let device = simulation.device();
    let parts = if device.is_some() { 1 } else { rayon::current_num_threads() };
    let per_second_per_core = 1.0 / (measured.wall_seconds * parts as f64);
    let mut row = BenchRow {
        case,
        precision: precision.to_owned(),
        search: search.to_owned(),
        particles,
        mean_neighbors: simulation.mean_neighbors(),
        steps: measured.steps,
        wall_seconds: measured.wall_seconds,
        particle_steps_per_second_per_core: (particles as u64 * measured.steps) as f64 * per_second_per_core,
        share_of_bare_loop: None,
        pairs_per_second_per_core: measured.pairs as f64 * per_second_per_core,
        searched_fraction: measured.searched / measured.steps as f64,
        stage_shares: StageShares::between(before, after),
        bytes_per_particle: simulation.memory_bytes() as f64 / particles.max(1) as f64,
        device,
        kernels: Vec::new(),
    };
    let of_kernels = clock.map(|clock| clock.measure((&mut repeater, &mut simulation), seconds));
    let failure = match of_kernels {
        Some(Ok(measured)) => {
            (row.stage_shares, row.kernels) = measured;
            None
        }
        Some(Err(failure)) => Some(failure),
        None => None,
    };
    Ok((row, failure))
}

/// What steps have done.
pub(super) struct Measured {
    pub(super) steps: u64,
    pairs: u64,
    searched: f64,
    wall_seconds: f64,
}

/// Steps for so many seconds, and a few times at least. A step that is repeated counts as often as it is taken.
pub(super) fn steps(
    (repeater, simulation): (&mut Repeater, &mut Simulation),
    seconds: f64,
) -> Result<Measured, RunFailure> {
    let start = Instant::now();
    let mut measured = Measured { steps: 0, pairs: 0, searched: 0.0, wall_seconds: 0.0 };
    while measured.steps < LEAST_STEPS || start.elapsed().as_secs_f64() < seconds {
        let report = repeater.step(simulation)?;
        measured.steps += 1;
        measured.pairs += report.pairs;
        measured.searched += report.searched_fraction;
    }
    measured.wall_seconds = start.elapsed().as_secs_f64();
    Ok(measured)
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
        let (row, _) = measure((&crate::engine::Cpu, None), setup, "mixed", "skin", 0.0).unwrap();
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
