//! Measures the speed of the program on this machine.
//!
//! Each case is stepped until it is warm, then for a given wall-clock time; nothing is written meanwhile. Rates are per core:
//! per thread in use, so leave hyper-threads out with the number of threads when comparing machines. Pairs are ordered
//! pairs `i != j` inside the kernel support, counted once a step whatever the number of sweeps over them.

mod bare;
mod error;
mod measure;
mod row;
mod stage_shares;

pub use crate::machine::Machine;
pub use bare::BareLoop;
pub use error::BenchError;
pub use row::BenchRow;
pub use stage_shares::StageShares;

use crate::{deck, decks};
use measure::measure;
use serde::Serialize;

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
        meaning: "a lattice block at rest: pair sums and search at full cost, nothing yields, a skin is never used up",
    },
    BenchCase { deck: "taylor-bar", meaning: "a round bar on a rigid wall: shock, plastic flow, heat" },
    BenchCase {
        deck: "penetration",
        meaning: "a disc through a plate in plane strain: the flow is everywhere, few neighbours",
    },
    BenchCase { deck: "bullet", meaning: "a bullet through a large plate: two smoothing lengths, the flow is local" },
];
/// Values of `numerics.precision` that are measured.
const PRECISIONS: &[&str] = &["mixed", "double"];

/// How to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchOptions {
    /// Names of the cases to measure; all if empty.
    pub cases: Vec<String>,
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
}

/// Measures every case with every precision and strategy. `observe` is called before each measurement with what it is.
///
/// # Errors
/// The threads cannot be started, or a shipped deck does not run.
pub fn bench(options: &BenchOptions, observe: &mut (dyn FnMut(&str) + Send)) -> Result<BenchReport, BenchError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.unwrap_or(0))
        .build()
        .map_err(|e| BenchError::Threads(e.to_string()))?;
    observe("the bare loop");
    let bare_loop = BareLoop::measure();
    pool.install(|| {
        let mut rows = Vec::new();
        let asked = |case: &&BenchCase| options.cases.is_empty() || options.cases.iter().any(|name| name == case.deck);
        for case in CASES.iter().filter(asked) {
            for &precision in PRECISIONS {
                for search in deck::search_words() {
                    observe(&format!("{}, {precision}, {search}", case.deck));
                    let overrides = [("numerics.precision", precision), ("search", search)]
                        .map(|(key, value)| (key.to_owned(), format!("\"{value}\"")));
                    let text = decks::find(case.deck).map_or("", |deck| deck.text);
                    let setup = deck::load_text(case.deck, text, &overrides).map_err(BenchError::Deck)?;
                    let dimensions = setup.model.dimensions;
                    let mut row = measure(setup, precision, search, options.seconds)?;
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
        })
    })
}
