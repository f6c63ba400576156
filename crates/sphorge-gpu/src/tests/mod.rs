//! One text of each law: what is recorded does what the law does.

#[cfg(feature = "device")]
mod audit;
#[cfg(feature = "device")]
pub(crate) mod card;
#[cfg(feature = "device")]
mod conduction;
#[cfg(feature = "device")]
pub(crate) mod contact;
#[cfg(feature = "device")]
mod detached;
#[cfg(feature = "device")]
pub(crate) mod engine;
#[cfg(feature = "device")]
mod faces;
#[cfg(feature = "device")]
pub(crate) mod facet_contact;
mod facets;
#[cfg(feature = "device")]
mod history;
mod laws;
#[cfg(feature = "device")]
mod measured;
#[cfg(feature = "device")]
pub(crate) mod motion;
mod pairs;
#[cfg(feature = "device")]
mod periodic;
#[cfg(feature = "device")]
mod ranks;
#[cfg(feature = "device")]
mod renewal;
mod rounded;
#[cfg(feature = "device")]
mod sections;
#[cfg(feature = "device")]
mod self_contact;
#[cfg(feature = "device")]
mod smoothing;
#[cfg(feature = "device")]
mod verlet_lists;

use crate::evaluate::Evaluation;
use crate::record::Kernel;
use laws::{Law, laws, samples};

/// Samples of every law.
const SAMPLES: usize = 4000;

/// A kernel that takes every sample through a law: argument `k` of sample `i` is at `k SAMPLES + i`.
fn kernel_of(law: &Law) -> Kernel {
    let recorded = Kernel::record("law", |scope| {
        let (arguments, results) = (scope.input("arguments"), scope.output("results"));
        let i = scope.thread();
        let place = |k: usize| crate::record::Index::of((k * SAMPLES) as u32) + i;
        let x: Vec<_> = (0..law.ranges.len()).map(|k| arguments.at(place(k))).collect();
        for (k, result) in (law.recorded)(&x).into_iter().enumerate() {
            results.set(place(k), result);
        }
    });
    recorded.unwrap_or_else(|fault| panic!("{}: {fault}", law.name))
}

/// The samples of a law, and what it makes of them on this processor, argument by argument.
fn expected(law: &Law) -> (Vec<f32>, Vec<f32>) {
    let samples = samples(&law.ranges, SAMPLES);
    let transposed = |rows: &[Vec<f32>]| -> Vec<f32> {
        (0..rows[0].len()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
    };
    let results: Vec<_> = samples.iter().map(|x| (law.direct)(x)).collect();
    (transposed(&samples), transposed(&results))
}

/// Whether two numbers are the same to the bit, or both none.
fn same(a: f32, b: f32) -> bool {
    // Infinity is the largest number on a GPU.
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan() || a == b || a.is_infinite() && b.abs() == f32::MAX
}

#[test]
fn recorded_laws_match_the_laws_to_the_bit_in_every_branch() {
    for law in laws() {
        let kernel = kernel_of(&law);
        let (arguments, results) = expected(&law);
        let mut buffers = [arguments, vec![0.0; results.len()]];
        let mut evaluation = Evaluation::default();
        evaluation.run(&kernel, &mut buffers, SAMPLES as u32);
        for (k, (ours, theirs)) in buffers[1].iter().zip(&results).enumerate() {
            let sample: Vec<_> = (0..law.ranges.len()).map(|a| buffers[0][a * SAMPLES + k % SAMPLES]).collect();
            assert!(same(*theirs, *ours), "{}: result {} of {sample:?}: {ours}, {theirs}", law.name, k / SAMPLES);
        }
        let never = evaluation.one_way(&kernel);
        assert_eq!(never.len(), law.never, "{}: choices that fall one way only: {never:?}", law.name);
    }
}

#[test]
fn operations_without_a_store_are_left_out() {
    let whole = Kernel::record("whole", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let i = scope.thread();
        let unused = x.at(i) / x.at(i + i);
        // Both branches of it are unused, too.
        let _ = sphorge_physics::Elementary::if_lt(unused, x.at(i), || unused + unused, || unused * unused);
        y.set(i, x.at(i) + x.at(i));
    })
    .unwrap();
    let text = crate::source::wgsl(&whole);
    assert!(!text.contains('/') || !text.split("fn whole").nth(1).unwrap().contains('/'), "{text}");
    assert!(!text.contains("else"), "{text}");
    // Equal operations are one.
    assert_eq!(text.matches("buffer_0[thread]").count(), 1, "{text}");
}

#[test]
fn a_law_evaluated_lane_by_lane_is_refused_by_name() {
    let refused = Kernel::record("table", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let i = scope.thread();
        let [a, _] = sphorge_physics::Real::lane_by_lane(x.at(i), x.at(i), |a, b| [a, b]);
        y.set(i, a);
    });
    let fault = refused.unwrap_err();
    assert!(fault.to_string().contains("`table`") && fault.to_string().contains("lane by lane"), "{fault}");
}

#[test]
fn an_array_that_a_kernel_writes_is_bound_once() {
    let copy = |read: &str, written: &str| {
        Kernel::record("copy", |scope| {
            let thread = scope.thread();
            let (from, to) = (scope.input(read), scope.output(written));
            to.set(thread, from.at(thread));
        })
    };
    copy("Force", "Velocity").unwrap();
    let fault = copy("Force", "Force").unwrap_err();
    assert!(fault.to_string().contains("written under two names"), "{fault}");
}
