//! Sums of one moment that are asked for together and looked at later.

use super::{FieldSource, ParticleSource, Reduction};
use crate::particles::Column;
use crate::{Ledger, RunFailure};

/// Sums that an engine takes while it goes on.
pub trait QueuedSums {
    /// Waits for them.
    ///
    /// # Errors
    /// The engine is lost.
    fn wait(self: Box<Self>) -> Result<Answers, RunFailure>;
}

/// What was asked, without borrowing from the model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question(String);

impl Question {
    /// Two reductions are the same question where all they say is the same, to the last digit.
    pub fn of(reduction: &Reduction<'_>) -> Self {
        Self(format!("{reduction:?}"))
    }
}

/// The answers to what was asked of the particles of one moment. Nothing else can be asked of these particles.
#[derive(Clone, Debug)]
pub struct Answers {
    count: usize,
    ledger: Ledger,
    found: Vec<(Question, Vec<f64>)>,
}

impl Answers {
    /// Of so many particles: their conservation sums, and what each question found.
    pub fn new(count: usize, ledger: Ledger, found: Vec<(Question, Vec<f64>)>) -> Self {
        Self { count, ledger, found }
    }

    /// The conservation sums.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }
}

fn not_asked(what: &str) -> RunFailure {
    RunFailure::of_engine(format!("{what} was not asked for while the particles were there"))
}

impl FieldSource for Answers {
    fn count(&self) -> usize {
        self.count
    }

    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        Err(not_asked(&format!("the field `{field}`")))
    }
}

impl ParticleSource for Answers {
    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        let question = Question::of(reduction);
        let found = self.found.iter().find(|(asked, _)| *asked == question);
        found.map(|(_, found)| found.clone()).ok_or_else(|| not_asked(&question.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::ParticleSelection;

    #[test]
    fn answers_are_to_what_was_asked_and_to_nothing_near_it() {
        let of = ParticleSelection::default();
        let quantity = crate::Quantity { field: "speed", component: None };
        let at = |x: f64| Reduction::Interpolation { of: &of, quantity, point: [x, 0.0, 0.0] };
        let found = vec![
            (Question::of(&at(0.1)), vec![1.0]),
            (Question::of(&Reduction::Extent { of: &of, axis: 0 }), vec![2.0]),
            (Question::of(&Reduction::Extent { of: &of, axis: 1 }), Vec::new()),
        ];
        let answers = Answers::new(7, Ledger::default(), found);
        assert_eq!(answers.count(), 7);
        assert_eq!(answers.reduce(&at(0.1)).unwrap(), [1.0]);
        assert_eq!(answers.reduce(&Reduction::Extent { of: &of, axis: 0 }).unwrap(), [2.0]);
        assert!(answers.reduce(&Reduction::Extent { of: &of, axis: 1 }).unwrap().is_empty());
        let failure = answers.reduce(&at(0.1f64.next_up())).unwrap_err();
        assert!(failure.message.contains("0.10000000000000002"), "{failure}");
        assert!(answers.reduce(&Reduction::Diameter { of: &of, axis: 0 }).is_err());
        assert!(answers.read("speed").unwrap_err().message.contains("`speed`"));
    }
}
