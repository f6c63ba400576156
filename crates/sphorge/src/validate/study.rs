//! A quantity against the particle spacing.

use super::finding::{Unit, Verdict};
use serde::Serialize;

/// One run of a study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyPoint {
    /// Label of the run.
    pub run: String,
    /// Particle spacing, m.
    pub spacing: f64,
    /// Our number, SI; none if the run did not yield it.
    pub value: Option<f64>,
    /// Relative error against the exact value, or the size itself if that is zero; signed.
    pub error: Option<f64>,
}

/// That errors shrink with the spacing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Demand {
    /// Errors smaller than this need not shrink further.
    pub floor: f64,
    /// Why.
    pub reason: String,
}

/// A quantity over a series of refinements, coarse to fine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Study {
    /// What it is.
    pub quantity: String,
    /// Unit it is shown in.
    pub unit: Unit,
    /// Exact value, SI, where there is one.
    pub exact: Option<f64>,
    /// The runs.
    pub points: Vec<StudyPoint>,
    /// Order of convergence: slope of log error against log spacing, least squares.
    pub order: Option<f64>,
    /// What is asked; none if it is only shown.
    pub demand: Option<Demand>,
    /// Outcome, set when the case is judged.
    pub verdict: Verdict,
}

impl Study {
    /// A study against an exact value, SI. If that is zero, values are errors themselves.
    pub fn exact(quantity: impl Into<String>, unit: Unit, exact: f64) -> Self {
        Self { exact: Some(exact), ..Self::trend(quantity, unit) }
    }

    /// A study without an exact value: the numbers alone.
    pub fn trend(quantity: impl Into<String>, unit: Unit) -> Self {
        Self {
            quantity: quantity.into(),
            unit,
            exact: None,
            points: Vec::new(),
            order: None,
            demand: None,
            verdict: Verdict::Shown,
        }
    }

    /// Adds a run; SI.
    pub fn point(mut self, run: &str, spacing: f64, value: Option<f64>) -> Self {
        let value = value.filter(|v| v.is_finite());
        let error = value.zip(self.exact).map(|(v, x)| if x == 0.0 { v } else { (v - x) / x.abs() });
        self.points.push(StudyPoint { run: run.to_owned(), spacing, value, error });
        self
    }

    /// Asks that errors shrink from run to run, as long as they are above `floor`.
    pub fn must_converge(mut self, floor: f64, reason: &str) -> Self {
        self.demand = Some(Demand { floor, reason: reason.to_owned() });
        self
    }

    /// Computes the order and holds the errors against what is asked.
    pub(super) fn judge(&mut self) {
        let errors: Vec<Option<f64>> = self.points.iter().map(|p| p.error.map(f64::abs)).collect();
        self.order = order(self.points.iter().zip(&errors).filter_map(|(p, e)| Some((p.spacing, (*e)?))));
        let Some(demand) = &self.demand else { return };
        let shrinks = |pair: &[Option<f64>]| match *pair {
            [Some(coarse), Some(fine)] => fine <= coarse.max(demand.floor),
            _ => false,
        };
        // One run alone can miss its value, not converge.
        let all_there = errors.iter().all(Option::is_some) && !errors.is_empty();
        let converges = all_there && errors.windows(2).all(shrinks);
        self.verdict = if converges { Verdict::Passed } else { Verdict::Failed };
    }
}

/// Slope of log error against log spacing; needs two points with an error.
fn order(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.filter(|(s, e)| *s > 0.0 && *e > 0.0).map(|(s, e)| (s.ln(), e.ln())).collect();
    let n = logs.len() as f64;
    let mean = |pick: fn(&(f64, f64)) -> f64| logs.iter().map(pick).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let xx: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    let xy: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (xx > 0.0).then(|| xy / xx)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(mut study: Study) -> Study {
        study.judge();
        study
    }

    #[test]
    fn errors_of_second_order_have_order_two_and_converge() {
        let study = Study::exact("speed", Unit::NONE, 100.0)
            .point("a", 0.4, Some(100.0 + 16.0))
            .point("b", 0.2, Some(100.0 - 4.0))
            .point("c", 0.1, Some(101.0))
            .must_converge(0.0, "");
        let study = judged(study);
        assert!((study.order.unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(study.verdict, Verdict::Passed);
        assert_eq!(study.points[1].error, Some(-0.04));
    }

    #[test]
    fn an_error_that_grows_fails_unless_below_the_floor() {
        let study = |floor| {
            let study = Study::exact("speed", Unit::NONE, 100.0).point("a", 0.2, Some(100.01));
            judged(study.point("b", 0.1, Some(99.98)).must_converge(floor, "")).verdict
        };
        assert_eq!(study(0.0), Verdict::Failed);
        assert_eq!(study(1e-3), Verdict::Passed);
    }

    #[test]
    fn a_missing_value_fails_and_a_trend_is_shown() {
        let missing = Study::exact("speed", Unit::NONE, 1.0).point("a", 0.2, Some(1.0)).point("b", 0.1, None);
        assert_eq!(judged(missing.must_converge(1.0, "")).verdict, Verdict::Failed);
        assert_eq!(judged(Study::exact("speed", Unit::NONE, 1.0).must_converge(1.0, "")).verdict, Verdict::Failed);
        let trend = judged(Study::trend("height", Unit::NONE).point("a", 0.2, Some(1.0)).point("b", 0.1, Some(2.0)));
        assert_eq!((trend.verdict, trend.order, trend.points[0].error), (Verdict::Shown, None, None));
    }
}
