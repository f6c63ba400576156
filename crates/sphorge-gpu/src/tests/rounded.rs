//! Whether results of laws differ by more than other rounding can make of them.

use super::laws::{Law, laws};
use super::{SAMPLES, expected, kernel_of, same};
use crate::evaluate::{Evaluation, Loaded, Units};
use crate::record::{Binary, Kernel, Operation, Statement, Value};
use std::collections::{BTreeSet, HashMap};

/// What a GPU may round away of a law, as a share of the larger of a result and [`FLOOR`] times the largest result of its kind: elementary
/// functions of GPUs are good to some units of round-off, and powers to some more.
const ROUNDING: f32 = 1e-4;
const FLOOR: f32 = 1e-3;

/// The same as [`ROUNDING`] of the slope of a power of the strain: at zero it is that of a chord to 1e-12, and of powers of so small numbers software
/// renderers know three digits.
const ROUNDING_OF_SLOPES: f32 = 5e-4;

/// Where a result is farther off than that, the law may be one that magnifies rounding at these arguments: a difference of numbers that are nearly the
/// same, an edge that runs along another. It is evaluated so often, with operations that each round at random as far as those of GPUs may: compilers may
/// fuse sums and products, quotients and roots are good to two units, functions to some. The result may be off by twice as much again as the farthest of
/// these.
const EVALUATIONS: u32 = 32;
const OF_CARDS: Units = Units { of_sums_and_products: 1, of_quotients_and_functions: 4 };
const TIMES: f32 = 2.0;

/// Samples of a law, and what this processor makes of them.
pub(super) struct Expected<'a> {
    law: &'a Law,
    pub(super) arguments: Vec<f32>,
    pub(super) results: Vec<f32>,
}

impl<'a> Expected<'a> {
    pub(super) fn of(law: &'a Law) -> Self {
        let (arguments, results) = expected(law);
        Self { law, arguments, results }
    }

    /// How many of these results differ, and the one that does most; nothing if there are none. No more are looked for than are enough.
    pub(super) fn difference(&self, kernel: &Kernel, ours: &[f32], enough: usize) -> Option<String> {
        let law = self.law;
        let (mut wrong, mut worst) = (0, (0.0, String::new()));
        // What is farther off than laws that magnify nothing: sample, result, how far, and how far it may be.
        let mut far_off = Vec::new();
        for (result, (ours, theirs)) in ours.chunks(SAMPLES).zip(self.results.chunks(SAMPLES)).enumerate() {
            let finite = || theirs.iter().filter(|number| number.is_finite());
            let largest = finite().fold(0.0f32, |a, b| a.max(b.abs()));
            let is_slope = law.name.starts_with("yield stress") && result == 1;
            let rounding = if is_slope { ROUNDING_OF_SLOPES } else { ROUNDING };
            for (k, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
                let scale = theirs.abs().max(FLOOR * largest).max(f32::MIN_POSITIVE);
                let off = (ours - theirs).abs();
                let is_near = same(*theirs, *ours) || off < rounding * scale;
                if !is_near {
                    far_off.push((k, result, off, rounding * scale));
                }
            }
        }
        let samples: BTreeSet<usize> = far_off.iter().map(|(k, ..)| *k).collect();
        let spreads = self.spreads(kernel, &samples.into_iter().collect::<Vec<_>>());
        for (k, result, off, of_rounding) in far_off {
            let spread = spreads[&k][result];
            let bound = of_rounding + TIMES * spread;
            if off < bound {
                continue;
            }
            wrong += 1;
            // What is no number here or there is worse than any that is.
            let share = if off.is_finite() { off / bound } else { f32::INFINITY };
            if share > worst.0 {
                let sample: Vec<_> = (0..law.ranges.len()).map(|a| self.arguments[a * SAMPLES + k]).collect();
                let [ours, theirs] = [ours, &self.results].map(|of| of[result * SAMPLES + k]);
                worst = (
                    share,
                    format!(
                        "result {result} of {sample:?}: {ours} in place of {theirs}, {share:.2} times what may be rounded, of which {spread:e} where operations round at random"
                    ),
                );
            }
            if wrong == enough {
                return Some(format!("{}: {wrong} results and more, the worst so far {}", law.name, worst.1));
            }
        }
        (wrong > 0).then(|| format!("{}: {wrong} results, the worst {}", law.name, worst.1))
    }

    /// How far results of samples are off where operations round at random, by sample.
    fn spreads(&self, kernel: &Kernel, samples: &[usize]) -> HashMap<usize, Vec<f32>> {
        let loaded = Loaded::new(kernel, &[self.arguments.clone(), self.results.clone()]);
        let threads: Vec<u32> = samples.iter().map(|k| *k as u32).collect();
        let kinds = self.results.len() / SAMPLES;
        let mut farthest: HashMap<_, _> = samples.iter().map(|k| (*k, vec![0.0f32; kinds])).collect();
        for number in 0..EVALUATIONS {
            Evaluation::rounding_at_random(OF_CARDS, number).run_loaded(&loaded, &threads);
            for (k, farthest) in &mut farthest {
                for (result, farthest) in farthest.iter_mut().enumerate() {
                    let at = result * SAMPLES + k;
                    let off = (loaded.number(1, at) - self.results[at]).abs();
                    // What is no number for once bounds nothing.
                    *farthest = farthest.max(if off.is_finite() { off } else { 0.0 });
                }
            }
        }
        farthest
    }
}

/// Wrong signs that are tried in a law, and samples that they are tried with.
const TRIED: usize = 16;
const FOR_SIGNS: u32 = 400;

/// What a kernel makes of the first samples; the others are as they should be.
fn results(mut evaluation: Evaluation, kernel: &Kernel, expected: &Expected<'_>, samples: u32) -> Vec<f32> {
    let mut buffers = [expected.arguments.clone(), expected.results.clone()];
    evaluation.run(kernel, &mut buffers, samples);
    let [_, results] = buffers;
    results
}

/// The values that statements evaluate.
fn evaluated(statements: &[Statement], all: &mut Vec<Value>) {
    for statement in statements {
        match statement {
            Statement::Let(value) => all.push(*value),
            Statement::If { then, otherwise, .. } => [then, otherwise].into_iter().for_each(|of| evaluated(of, all)),
            Statement::Loop { body, .. } | Statement::Range { body, .. } => evaluated(body, all),
            _ => {}
        }
    }
}

#[test]
fn differences_by_rounding_are_accepted_and_a_wrong_sign_is_not() {
    let laws = laws();
    let asked = ["moving least squares, 3", "contact of facets", "friction of facets", "gradient correction"];
    for law in laws.iter().filter(|law| asked.contains(&law.name.as_str())) {
        let (kernel, expected) = (kernel_of(law), Expected::of(law));
        // As with CUDA.
        let units = Units { of_sums_and_products: 0, of_quotients_and_functions: 2 };
        let other = results(Evaluation::rounding_at_random(units, EVALUATIONS), &kernel, &expected, SAMPLES as u32);
        assert_eq!(expected.difference(&kernel, &other, usize::MAX), None);
        let mut all = Vec::new();
        evaluated(&kernel.statements, &mut all);
        let signs = all.into_iter().filter_map(|value| match kernel.operations[value as usize] {
            Operation::Binary(Binary::Add, a, b) => Some((value, Operation::Binary(Binary::Subtract, a, b))),
            Operation::Binary(Binary::Subtract, a, b) => Some((value, Operation::Binary(Binary::Add, a, b))),
            _ => None,
        });
        let signs: Vec<_> = signs.collect();
        let (mut missed, mut changing) = (Vec::new(), 0);
        for (value, other) in signs.iter().step_by(signs.len().div_ceil(TRIED)) {
            let mut wrong = kernel.clone();
            wrong.operations[*value as usize] = *other;
            let ours = results(Evaluation::default(), &wrong, &expected, FOR_SIGNS);
            // The sign of a zero, as of what is not there in a plane, changes nothing.
            if ours.iter().zip(&expected.results).all(|(a, b)| super::same(*a, *b) || (*a == 0.0 && *b == 0.0)) {
                continue;
            }
            changing += 1;
            if expected.difference(&kernel, &ours, 1).is_none() {
                missed.push(*value);
            }
        }
        assert!(changing >= TRIED / 2, "{}: {changing} of {TRIED} change anything", law.name);
        // A few are in front of what is less than rounding in these samples.
        assert!(missed.len() <= changing / 8, "{}: {missed:?} of {}", law.name, signs.len());
    }
}
