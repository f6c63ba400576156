//! The sums of a history row, which steps do not wait for: all are launched behind the step, each is copied before the next overwrites it, and
//! what is made of them is made when they are looked at.

use super::kernels::ledger::LedgerSums;
use super::kernels::reductions::OF_WORST;
use super::kernels::sums::MOST_SUMS;
use super::ledger::LaunchedLedger;
use super::made::{Made, SegmentSums};
use super::ranks::agreement::Order;
use super::reductions::Launched;
use super::segments::Segments;
use super::{GpuEngine, failure};
use crate::device::Pending;
use sphorge_engine::reduction::{Answers, Question, QueuedSums, Reduction};
use sphorge_engine::{Model, RunFailure};
use std::sync::Arc;

/// The sums of one moment, on their way.
struct SumsOnTheirWay {
    model: Arc<Model>,
    segments: Arc<Segments>,
    /// Particles.
    count: usize,
    numbers: Pending,
    /// What is made of the numbers, in the order they were queued in.
    ledger: LaunchedLedger,
    asked: Vec<(Question, Answer)>,
}

/// What a question finds.
enum Answer {
    /// The processor has evaluated it.
    Known(Vec<f64>),
    /// So many numbers, of which this is made.
    OfNumbers(usize, Made),
}

impl GpuEngine {
    /// The ledger and reductions as they are now, on their way. None where sums go from rank to rank, which all of them wait for, or where there is no
    /// memory for copies beside the run. What the processor evaluates is waited for now, and so is the line of a diameter that the particles decide.
    pub(super) fn queued_sums(&self, asked: &[Reduction<'_>]) -> Result<Option<Box<dyn QueuedSums>>, RunFailure> {
        if self.domain.is_some() {
            return Ok(None);
        }
        let of_worst = OF_WORST * self.model.bodies.len();
        let of_all = |sums: usize| self.segments.numbers_of(sums);
        let most = of_all(LedgerSums::of(&self.model).count) + asked.len() * (of_all(MOST_SUMS) + of_worst);
        let Some(mut reservation) = self.card.reserve(most).map_err(failure)? else { return Ok(None) };
        let sums = self.sums()?;
        let ledger = self.launch_ledger()?;
        self.card.add(&mut reservation, sums, ledger.count).map_err(failure)?;
        let mut answers = Vec::with_capacity(asked.len());
        for reduction in asked {
            let answer = match self.launch_sum(reduction)? {
                Some(Launched { count, made }) => {
                    self.card.add(&mut reservation, sums, count).map_err(failure)?;
                    Answer::OfNumbers(count, made)
                }
                None => Answer::Known(self.evaluated(reduction)?),
            };
            answers.push((Question::of(reduction), answer));
        }
        Ok(Some(Box::new(SumsOnTheirWay {
            model: self.model.clone(),
            segments: self.segments.clone(),
            count: self.initial.len(),
            numbers: self.card.pending(reservation),
            ledger,
            asked: answers,
        })))
    }
}

impl QueuedSums for SumsOnTheirWay {
    fn wait(self: Box<Self>) -> Result<Answers, RunFailure> {
        let numbers = self.numbers.wait().map_err(failure)?;
        let mut left = &numbers[..];
        let mut next = |count: usize| {
            let (numbers, others) = left.split_at(count);
            left = others;
            SegmentSums { model: &self.model, segments: &self.segments, numbers }
        };
        let ledger = self.ledger.made(next(self.ledger.count), Order::Alone)?;
        let mut found = Vec::with_capacity(self.asked.len());
        for (question, answer) in self.asked {
            let numbers = match answer {
                Answer::Known(found) => found,
                Answer::OfNumbers(count, made) => made.of(next(count), Order::Alone)?,
            };
            found.push((question, numbers));
        }
        Ok(Answers::new(self.count, ledger, found))
    }
}
