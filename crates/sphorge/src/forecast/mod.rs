//! What a run would take: inspects the model, then takes a few real steps and writes nothing.

use crate::{
    deck::Setup,
    engine::{EngineKind, LimitReason, RunFailure, Simulation, Unsupported, persist::ByteCount},
    geometry::FilledMass,
    model::{Body, Dimensions, Model},
    observed::Observed,
    output::{mass_unit, uncompressed_bytes},
    run::repeat::Repeater,
};
use std::{sync::Arc, time::Instant};

/// How to forecast.
#[derive(Clone, Debug)]
pub struct ForecastOptions {
    /// What would compute.
    pub engine: Arc<dyn EngineKind>,
    /// Number of threads; all the machine has if not given.
    pub threads: Option<usize>,
    /// Wall-clock seconds to spend on steps, at least one step is taken.
    pub seconds: f64,
}

/// What a run would take.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// Title of the deck.
    pub title: String,
    /// Space dimensions.
    pub dimensions: Dimensions,
    /// The bodies in deck order.
    pub bodies: Vec<BodyForecast>,
    /// End time, s.
    pub end: f64,
    /// The first time step, s.
    pub first_step: f64,
    /// What limits it.
    pub first_reason: LimitReason,
    /// Steps to the end at the mean size of the steps taken here; may be more than anybody waits for.
    pub expected_steps: f64,
    /// Most steps the deck allows.
    pub most_steps: Option<u64>,
    /// Neighbours a particle has on average.
    pub mean_neighbors: f64,
    /// Threads in use.
    pub threads: usize,
    /// Name of the device that computes, where that is not the processor.
    pub device: Option<String>,
    /// Wall-clock seconds of a step.
    pub seconds_per_step: f64,
    /// Wall-clock seconds of the whole run, writing left out.
    pub run_seconds: f64,
    /// Bytes of columns, lists and scratch, of the device that computes.
    pub memory_bytes: u64,
    /// Frames that would be written.
    pub frames: u64,
    /// Bytes of all frames before they are compressed, and of the history.
    pub output_bytes: u64,
}

/// One body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyForecast {
    /// Name in the deck.
    pub name: String,
    /// Name of the material.
    pub material: String,
    /// Spacing, m.
    pub spacing: f64,
    /// Its particles.
    pub filled: FilledMass,
}

impl Forecast {
    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.bodies.iter().map(|body| body.filled.particles).sum()
    }

    /// Unit of the masses.
    pub fn mass_unit(&self) -> &'static str {
        mass_unit(self.dimensions.count())
    }
}

/// Why there is no forecast.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ForecastError {
    /// No pool of threads.
    #[error("cannot start the threads: {0}")]
    #[diagnostic(help("ask for fewer with `--threads N`"))]
    Threads(String),
    /// The engine does not run such a model.
    #[error("the engine `{engine}` does not run this deck: {unsupported}")]
    #[diagnostic(help("{}", unsupported.help))]
    Unsupported {
        /// Name of the engine.
        engine: &'static str,
        /// What it cannot do.
        unsupported: Unsupported,
    },
    /// The engine does not start: there is no such device, or no room on it.
    #[error("the engine `{engine}` did not start: {failure}")]
    Start {
        /// Name of the engine.
        engine: &'static str,
        /// Why.
        failure: Box<RunFailure>,
    },
    /// The deck can be read but not stepped.
    #[error("the run fails: {0}")]
    Failed(RunFailure),
}

impl From<RunFailure> for ForecastError {
    fn from(failure: RunFailure) -> Self {
        Self::Failed(failure)
    }
}

/// Forecasts the run of a deck.
///
/// # Errors
/// See [`ForecastError`].
pub fn forecast(setup: Setup, options: &ForecastOptions) -> Result<Forecast, ForecastError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.unwrap_or(0))
        .build()
        .map_err(|e| ForecastError::Threads(e.to_string()))?;
    let (kind, engine) = (options.engine.as_ref(), options.engine.name());
    kind.supports(&setup.model).map_err(|unsupported| ForecastError::Unsupported { engine, unsupported })?;
    pool.install(|| look_ahead(setup, kind, options.seconds))
}

fn look_ahead(setup: Setup, kind: &dyn EngineKind, seconds: f64) -> Result<Forecast, ForecastError> {
    let model = setup.model.clone();
    let bodies = bodies(&model, &setup.masses);
    let frame_bytes = uncompressed_bytes(setup.particles.len(), &model.output.fields);

    let mut simulation = Simulation::start(kind, setup.model, setup.particles)
        .map_err(|failure| ForecastError::Start { engine: kind.name(), failure: Box::new(failure) })?;
    let (first_step, first_reason) = simulation.next_step_estimate()?;
    // The first step touches memory for the first time: it is taken, not timed.
    Repeater::new(&simulation).step(&mut simulation)?;
    // What a run would repeat is repeated.
    let mut repeater = Repeater::new(&simulation);
    let (mut steps, start, start_time, start_steps) = (0_u64, Instant::now(), simulation.time(), simulation.steps());
    let is_over = |simulation: &Simulation| {
        simulation.time() >= model.time.end || model.time.max_steps.is_some_and(|most| simulation.steps() >= most)
    };
    while steps == 0 || start.elapsed().as_secs_f64() < seconds && !is_over(&simulation) {
        repeater.step(&mut simulation)?;
        steps += 1;
    }
    let seconds_per_step = start.elapsed().as_secs_f64() / steps as f64;
    let mean_step = (simulation.time() - start_time) / (simulation.steps() - start_steps) as f64;
    let by_time = (model.time.end / mean_step).ceil();
    let expected_steps = by_time.min(model.time.max_steps.map_or(f64::INFINITY, |most| most as f64));

    let share = (expected_steps / by_time.max(1.0)).min(1.0);
    // An interval that divides the run is not one more by rounding.
    let frames = 1 + (share * model.time.end / model.output.frame_interval * (1.0 - 1e-9)).ceil() as u64;
    let rows = 1.0 + share * model.time.end / model.output.history_interval;
    Ok(Forecast {
        title: model.title.clone(),
        dimensions: model.dimensions,
        bodies,
        end: model.time.end,
        first_step,
        first_reason,
        expected_steps,
        most_steps: model.time.max_steps,
        mean_neighbors: simulation.mean_neighbors(),
        threads: rayon::current_num_threads(),
        device: simulation.device(),
        seconds_per_step,
        run_seconds: seconds_per_step * expected_steps,
        memory_bytes: simulation.memory_bytes() + kept_bytes(&mut simulation),
        frames,
        output_bytes: frames * frame_bytes + (rows * history_row_bytes(&model)) as u64,
    })
}

/// Bytes of the state that step control keeps.
fn kept_bytes(simulation: &mut Simulation) -> u64 {
    let mut count = ByteCount::default();
    let is_kept = simulation.model().time.step_control.is_some() && simulation.persist(&mut count).is_ok();
    if is_kept { count.0 } else { 0 }
}

fn bodies(model: &Model, masses: &[FilledMass]) -> Vec<BodyForecast> {
    let body = |(body, &filled): (&Body, &FilledMass)| BodyForecast {
        name: body.name.clone(),
        material: model.materials[body.material].name.clone(),
        spacing: body.spacing,
        filled,
    };
    model.bodies.iter().zip(masses).map(body).collect()
}

/// About the size of a row of the history.
fn history_row_bytes(model: &Model) -> f64 {
    const BYTES_PER_CELL: f64 = 18.0;
    let observed = Observed::new(model).columns().len();
    let parts = 16 * model.bodies.len() + 3 * (model.walls.len() + model.motions.len());
    let cells = 24 + parts + model.measures.len() + observed;
    BYTES_PER_CELL * cells as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{deck::load_text, engine::Cpu};

    const DECK: &str = r#"
        dimensions = "3d"
        method = "updated-lagrangian"
        [particles]
        spacing = "1 mm"
        [time]
        end = "10 us"
        max-steps = 20
        [output]
        frames = 4
        [[body]]
        name = "left"
        material = "armco-iron"
        shape = { box = { min = ["0 mm", "0 mm", "0 mm"], max = ["4 mm", "5 mm", "6 mm"] } }
        [[body]]
        name = "right"
        material = "armco-iron"
        shape = { sphere = { centre = ["20 mm", "0 mm", "0 mm"], radius = "4 mm" } }
        spacing = "0.8 mm"
    "#;

    fn options(seconds: f64) -> ForecastOptions {
        ForecastOptions { engine: Arc::new(Cpu), threads: Some(1), seconds }
    }

    #[test]
    fn bodies_steps_and_output_are_those_of_a_run() {
        let setup = load_text("test", DECK, &[]).unwrap();
        let particles = setup.particles.clone();
        let model = setup.model.clone();
        let forecast = forecast(setup, &options(0.0)).unwrap();
        let [left, right] = &forecast.bodies[..] else { panic!("{:?}", forecast.bodies) };
        assert_eq!((left.filled.particles, right.filled.particles), (120, particles.len() - 120));
        assert!(
            (left.filled.mass - 7890.0 * 120e-9).abs() < 1e-12
                && (left.filled.shape_mass - left.filled.mass).abs() < 1e-12
        );
        assert!((right.filled.shape_mass - 7890.0 * 4.0 / 3.0 * std::f64::consts::PI * 64e-9).abs() < 1e-12);
        assert_eq!((forecast.most_steps, forecast.threads), (Some(20), 1));

        // The courant number over the longitudinal sound speed, on the smaller smoothing length.
        let speed = (3630_f64.powi(2) + 4.0 / 3.0 * 80e9 / 7890.0).sqrt();
        assert!((forecast.first_step - 0.3 * 1.2 * 0.8e-3 / speed).abs() < 1e-3 * forecast.first_step);
        assert_eq!(forecast.first_reason, LimitReason::SoundSpeed);
        assert_eq!(forecast.expected_steps, 20.0);
        // Steps are taken no farther than a run would go, however long they may last.
        let setup = load_text("test", DECK, &[("time.end".into(), "100 ns".into())]).unwrap();
        let started = Instant::now();
        super::forecast(setup, &options(1000.0)).unwrap();
        assert!(started.elapsed().as_secs() < 500);
        // Twenty steps of 48 ns are short of the first frame interval: the initial frame and that of the end.
        assert_eq!(forecast.frames, 2);
        assert!(forecast.output_bytes > 2 * uncompressed_bytes(particles.len(), &model.output.fields));
        assert!(forecast.memory_bytes > particles.len() as u64 * 500);
    }

    /// A disc that strikes so hard that the first step is too long: a run repeats it.
    #[test]
    fn what_a_run_repeats_is_repeated() {
        let text = crate::decks::find("penetration").unwrap().text;
        let setup = || load_text("penetration", text, &[("particles.spacing".into(), "\"0.5 mm\"".into())]).unwrap();
        let Setup { model, particles, .. } = setup();
        let failure = Simulation::new(model, particles).step(None).unwrap_err();
        assert!(failure.step == 1 && failure.step_may_be_smaller, "{failure}");
        let forecast = forecast(setup(), &options(0.0)).unwrap();
        assert!(forecast.expected_steps > 100.0, "{}", forecast.expected_steps);
    }
}
