//! Measures the speed of the program on this machine.
//!
//! Each case is stepped until it is warm, then for a given wall-clock time; nothing is written meanwhile. Rates are per core:
//! per thread in use, so leave hyper-threads out with the number of threads when comparing machines. Pairs are ordered
//! pairs `i != j` inside the kernel support, counted once a step whatever the number of sweeps over them. Rates of an engine on a card are
//! those of the card.

mod bare;
mod error;
mod kernels;
mod measure;
mod row;
mod stage_shares;

pub use crate::machine::Machine;
pub use bare::BareLoop;
pub use error::BenchError;
pub use kernels::{KernelClock, KernelRow};
pub use row::BenchRow;
pub use stage_shares::StageShares;

use crate::engine::{Cpu, EngineKind};
use crate::{deck, decks};
use measure::measure;
use serde::Serialize;
use std::sync::Arc;

/// A case of the benchmark: a shipped deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BenchCase {
    /// Name of the deck.
    pub deck: &'static str,
    /// What it stands for.
    pub meaning: &'static str,
}

/// The cases.
pub const CASES: &[BenchCase] = &[
    BenchCase {
        deck: "block",
        meaning: "a lattice block at rest: pair sums and search at full cost, no plastic flow, the skin is never used up",
    },
    BenchCase { deck: "taylor-bar", meaning: "a round bar on a rigid wall: shock, plastic flow, heat" },
    BenchCase {
        deck: "penetration",
        meaning: "a disc through a plate in plane strain: flow everywhere, few neighbours",
    },
    BenchCase { deck: "bullet", meaning: "a bullet through a large plate: two smoothing lengths, local flow" },
];
/// Values of `numerics.precision` that are measured.
const PRECISIONS: &[&str] = &["mixed", "double"];

/// How to measure.
#[derive(Clone, Debug)]
pub struct BenchOptions {
    /// What computes.
    pub engine: Arc<dyn EngineKind>,
    /// What times single kernels, where the engine has such.
    pub kernels: Option<KernelClock>,
    /// Names of the cases to measure; all if empty.
    pub cases: Vec<String>,
    /// Words of the strategies to measure; all if empty.
    pub strategies: Vec<String>,
    /// Keys of the decks and what they are to be.
    pub overrides: Vec<(String, String)>,
    /// Number of threads; all the machine has if not given.
    pub threads: Option<usize>,
    /// Wall-clock seconds of each measurement, after the warm-up.
    pub seconds: f64,
}

/// All measurements of one call.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchReport {
    /// Version of the program.
    pub version: &'static str,
    /// Where it was measured.
    pub machine: Machine,
    /// Threads in use.
    pub threads: usize,
    /// The bare loop on one core, measured first; none where the processor lacks AVX-512.
    pub bare_loop: Option<BareLoop>,
    /// The measurements, in the order they were made.
    pub rows: Vec<BenchRow>,
    /// What the engine does not run, had no room for, or failed in, and why.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<Skipped>,
}

/// A case that was not measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Skipped {
    /// Name of the deck.
    pub case: String,
    /// `mixed` or `double`.
    pub precision: String,
    /// Search strategy.
    pub search: String,
    /// What the engine cannot do, or how it failed.
    pub why: String,
}

/// Measures every case with every precision and strategy. `observe` is called before each measurement with what it is.
///
/// # Errors
/// The threads cannot be started, or a deck cannot be read with these overrides.
pub fn bench(options: &BenchOptions, observe: &mut (dyn FnMut(&str) + Send)) -> Result<BenchReport, BenchError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.unwrap_or(0))
        .build()
        .map_err(|e| BenchError::Threads(e.to_string()))?;
    // It is a yardstick of the processor.
    let is_own = options.engine.name() == Cpu.name();
    if is_own {
        observe("the bare loop");
    }
    let bare_loop = is_own.then(BareLoop::measure).flatten();
    pool.install(|| measure_cases(options, bare_loop, observe))
}

/// Measures the cases beside a bare loop in the present thread pool.
fn measure_cases(
    options: &BenchOptions,
    bare_loop: Option<BareLoop>,
    observe: &mut (dyn FnMut(&str) + Send),
) -> Result<BenchReport, BenchError> {
    let (mut rows, mut skipped) = (Vec::new(), Vec::new());
    let asked = |case: &&BenchCase| options.cases.is_empty() || options.cases.iter().any(|name| name == case.deck);
    for case in CASES.iter().filter(asked) {
        for &precision in PRECISIONS {
            for search in deck::search_words() {
                if !options.strategies.is_empty() && !options.strategies.iter().any(|word| word == search) {
                    continue;
                }
                observe(&format!("{}, {precision}, {search}", case.deck));
                let own = [("numerics.precision", precision), ("search", search)]
                    .map(|(key, value)| (key.to_owned(), format!("\"{value}\"")));
                let overrides: Vec<_> = options.overrides.iter().cloned().chain(own).collect();
                let text = decks::find(case.deck).map_or("", |deck| deck.text);
                // To fill bodies takes long; what is not measured has none.
                let model = deck::load_text_model(case.deck, text, &overrides).map_err(BenchError::Deck)?;
                let dimensions = model.dimensions;
                let mut skip = |why: String| {
                    let [case, precision, search] = [case.deck, precision, search].map(str::to_owned);
                    skipped.push(Skipped { case, precision, search, why });
                };
                if let Err(unsupported) = options.engine.supports(&model) {
                    skip(unsupported.what);
                    continue;
                }
                let setup = deck::load_text(case.deck, text, &overrides).map_err(BenchError::Deck)?;
                let kind = (&*options.engine, options.kernels.as_ref());
                let mut row = match measure(kind, setup, precision, search, options.seconds) {
                    Ok((row, None)) => row,
                    Ok((row, Some(failure))) => {
                        skip(format!("its kernels: {failure}"));
                        row
                    }
                    // The others are measured all the same.
                    Err(failure) => {
                        skip(failure.to_string());
                        continue;
                    }
                };
                let bare = bare_loop.filter(|_| dimensions == crate::model::Dimensions::Three);
                row.share_of_bare_loop = bare.map(|bare| {
                    row.pairs_per_second_per_core / (bare.particle_steps_per_second() * bare.mean_neighbors)
                });
                rows.push(row);
            }
        }
    }
    Ok(BenchReport {
        version: env!("CARGO_PKG_VERSION"),
        machine: Machine::here(),
        threads: rayon::current_num_threads(),
        bare_loop,
        rows,
        skipped,
    })
}

#[cfg(test)]
mod tests;
