//! The ballistic limit: at which impact velocity a projectile gets through, and how fast it then leaves.
//!
//! A deck is run at several speeds. The fastest that was stopped and the slowest that got through bracket the limit, and further runs between them
//! make the bracket narrower. The curve of Recht and Ipson through what got through tells where to look.
//!
//! A projectile has got through if, at the end of the run, it flies ahead of what it has struck by more than two per cent of its impact velocity,
//! and its velocity has changed by less than a twentieth of that lead over the last tenth of the run. What it has struck has the median velocity of the
//! particles of all other bodies: a plug may be faster than the projectile, and a target that nobody holds is carried along. One that is slower was
//! stopped. Of one that still slows down, has not struck, or whose run has failed or warns of its energy, nothing is known: such runs are listed, and narrow nothing.

mod fit;
mod flight;
mod report;
mod search;

pub use fit::RechtIpson;
pub use flight::{Flight, read_speed};
pub use report::BallisticLimit;
pub use search::{Bracket, End, Next, Outcome, Search, Shot};

use super::{SweepError, SweepTable};

/// Share of the speed of a deck that a bracket is narrowed to where nothing else is asked for.
const WITHIN: f64 = 0.01;

/// Speeds with what became of each, and how the search for their limit ended.
#[derive(Clone, Debug)]
pub struct Searched {
    /// Speeds in the order they were run, m/s.
    pub speeds: Vec<f64>,
    /// The table of the runs in that order.
    pub table: SweepTable,
    /// What became of each.
    pub shots: Vec<Shot>,
    /// How it ended.
    pub end: End,
}

impl Searched {
    /// Numbers of the runs, slow to fast.
    pub fn in_order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.speeds.len()).collect();
        order.sort_by(|a, b| self.speeds[*a].total_cmp(&self.speeds[*b]));
        order
    }
}

/// What was asked for, before it is known what flies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// Lower bound, m/s.
    pub from: Option<f64>,
    /// Upper bound, m/s.
    pub to: Option<f64>,
    /// Further speeds to run, m/s.
    pub at: Vec<f64>,
    /// Width of a bracket that is narrow enough, m/s; a hundredth of the speed of the deck if none.
    pub within: Option<f64>,
    /// Most runs.
    pub runs: usize,
    /// Runs at once.
    pub at_once: usize,
    /// Exponent of the curve, if it is held.
    pub exponent: Option<f64>,
}

impl Asked {
    /// The same, if it makes sense.
    ///
    /// # Errors
    /// What does not.
    pub fn checked(self) -> Result<Self, SweepError> {
        let fault = |what: String, help: &str| Err(SweepError::Varied { what, help: help.to_owned() });
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from >= to
        {
            return fault(format!("the search goes from {from} m/s to {to} m/s"), "give `--from` below `--to`");
        }
        if self.exponent.is_some_and(|p| !(1.0..=10.0).contains(&p)) {
            return fault(
                "the exponent of the curve is not between 1 and 10".to_owned(),
                "two is that of Recht and Ipson",
            );
        }
        let count = self.search_from(1.0).first().len();
        if count > self.runs {
            let what = format!("{count} speeds are asked for, and {} runs allowed", self.runs);
            return fault(what, "allow more by `--runs`");
        }
        Ok(self)
    }

    /// The search for the limit of what flies.
    pub fn search(&self, flight: &Flight) -> Search {
        self.search_from(flight.speed)
    }

    fn search_from(&self, own: f64) -> Search {
        let Self { from, to, ref at, within, runs, at_once, exponent } = *self;
        Search { own, from, to, at: at.clone(), within: within.unwrap_or(WITHIN * own), runs, at_once, exponent }
    }
}

impl Search {
    /// Runs until the search ends. `known` are speeds of which there are runs ([`Flight::known`]), `run` makes the runs at all of these speeds that are
    /// not there yet.
    ///
    /// # Errors
    /// That of `run`.
    pub fn execute<E>(
        &self,
        known: &[f64],
        mut run: impl FnMut(&[f64]) -> Result<(SweepTable, Vec<Shot>), E>,
    ) -> Result<Option<Searched>, E> {
        let mut found: Option<Searched> = None;
        loop {
            match self.next(found.as_ref().map_or(&[], |found| &found.shots)) {
                Next::End(end) => return Ok(found.map(|found| Searched { end, ..found })),
                Next::Run(more) => {
                    let mut speeds = found.map_or_else(|| known.to_vec(), |found| found.speeds);
                    let more: Vec<f64> = more.into_iter().filter(|speed| !speeds.contains(speed)).collect();
                    speeds.extend(more);
                    let (table, shots) = run(&speeds)?;
                    found = Some(Searched { speeds, table, shots, end: End::RunsUsed });
                }
            }
        }
    }
}
