//! The same on a card, or on what stands for one: run with `--features device`.

use super::laws::{Law, laws};
use super::pairs::{self, Block};
use super::{SAMPLES, expected, kernel_of};
use crate::device::{Card, CardFault, Interface};
use crate::record::{Index, Kernel};

/// The card the tests run on. Without one they say so and pass, unless `SPHORGE_NEEDS_CARD` says which there has to be, as where all is tested: by
/// `CUDA` or `Vulkan`, or any.
pub(crate) fn card() -> Option<Card> {
    let needed = std::env::var("SPHORGE_NEEDS_CARD").ok();
    match Card::open(None) {
        Ok(card) => {
            let title = card.found().title();
            assert!(needed.is_none_or(|needed| needed == "any" || title.ends_with(&needed)), "{title}");
            Some(card)
        }
        Err(fault) => {
            assert!(needed.is_none(), "{fault}");
            eprintln!("not tested: {fault}");
            None
        }
    }
}

/// What a card may round away of a law, as a share of the larger of a result and [`FLOOR`] times the largest result of its kind: elementary
/// functions of cards are good to some units of round-off, and powers to some more.
const ROUNDING: f32 = 1e-4;
const FLOOR: f32 = 1e-3;

/// The same where facets meet, whose results are sums of terms of either sign over corners and edges: 25 units of round-off of the largest.
const FLOOR_OF_FACETS: f32 = 3e-2;

/// Units of round-off of a spacing by which places may be off, in addition, where facets meet: where edges that are nearly parallel cross, the
/// last bits of their ends decide the result, here as there.
const UNITS_OF_PLACES: f32 = 4.0;

/// How much a result of a law whose arguments are shares of a spacing changes with [`UNITS_OF_PLACES`] of each.
fn spread(law: &Law, sample: &[f32], result: usize) -> f32 {
    let at = |sample: &[f32]| (law.direct)(sample)[result];
    let here = at(sample);
    let of = |argument: usize| {
        let moved = |sign: f32| {
            let mut sample = sample.to_vec();
            sample[argument] += sign * UNITS_OF_PLACES * f32::EPSILON;
            (at(&sample) - here).abs()
        };
        moved(1.0).max(moved(-1.0))
    };
    (0..sample.len()).map(of).sum()
}

/// The same as [`ROUNDING`] of the slope of a power of the strain: at zero it is that of a chord to 1e-12, and of powers of so small numbers software
/// renderers know three digits.
const ROUNDING_OF_SLOPES: f32 = 5e-4;

#[test]
fn laws_on_a_card_are_those_of_the_processor() {
    let Some(card) = card() else { return };
    for law in laws() {
        let program = card.compile(&kernel_of(&law)).unwrap_or_else(|fault| panic!("{}: {fault}", law.name));
        let (arguments, results) = expected(&law);
        let (input, output) = (card.numbers(&arguments).unwrap(), card.zeros(results.len()).unwrap());
        card.launch([&card.bind(&program, &[&input, &output], SAMPLES as u32).unwrap()]);
        let ours = card.read(&output).unwrap();
        for (result, (ours, theirs)) in ours.chunks(SAMPLES).zip(results.chunks(SAMPLES)).enumerate() {
            let finite = || theirs.iter().filter(|number| number.is_finite());
            let largest = finite().fold(0.0f32, |a, b| a.max(b.abs()));
            let is_slope = law.name.starts_with("yield stress") && result == 1;
            let rounding = if is_slope { ROUNDING_OF_SLOPES } else { ROUNDING };
            let meets_facets = law.name.ends_with("of facets");
            let floor = if meets_facets { FLOOR_OF_FACETS } else { FLOOR };
            for (k, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
                let scale = theirs.abs().max(floor * largest).max(f32::MIN_POSITIVE);
                let off = (ours - theirs).abs();
                if super::same(*theirs, *ours) || off < rounding * scale {
                    continue;
                }
                let sample: Vec<_> = (0..law.ranges.len()).map(|a| arguments[a * SAMPLES + k]).collect();
                let crossings = if meets_facets { spread(&law, &sample, result) } else { 0.0 };
                let card = &card.found().name;
                assert!(
                    off < rounding * scale + crossings,
                    "{}: result {result} of {sample:?}: {ours} on {card}, {theirs} here",
                    law.name
                );
            }
        }
    }
}

#[test]
fn the_pair_loop_on_a_card_is_that_of_the_processor_and_the_same_each_time() {
    let Some(card) = card() else { return };
    let block = Block::new(9);
    let program = card.compile(&pairs::kernel(block.count).unwrap()).unwrap();
    let inputs = [
        card.numbers(&block.fields).unwrap(),
        card.indices(&block.first).unwrap(),
        card.indices(&block.neighbors).unwrap(),
    ];
    let run = || {
        let sums = card.zeros(block.sums.len()).unwrap();
        let arrays = [&inputs[0], &inputs[1], &inputs[2], &sums];
        card.launch([&card.bind(&program, &arrays, block.count as u32).unwrap()]);
        card.read(&sums).unwrap()
    };
    let sums = run();
    for (ours, theirs) in sums.chunks(block.count).zip(block.sums.chunks(block.count)) {
        let largest = theirs.iter().fold(0.0f32, |a, b| a.max(b.abs()));
        let worst = ours.iter().zip(theirs).fold(0.0f32, |worst, (a, b)| worst.max((a - b).abs()));
        assert!(worst < 2e-6 * largest, "{worst} of {largest}");
    }
    let again = run();
    assert!(sums.iter().zip(&again).all(|(a, b)| a.to_bits() == b.to_bits()));
}

#[test]
fn launches_of_many_rows_reach_every_thread_once() {
    let Some(card) = card() else { return };
    // More workgroups than a row has.
    let count = 65_535 * 64 + 12_345;
    let kernel = Kernel::record("count", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let i = scope.thread();
        y.set(i, x.at(Index::of(0)) + x.at(i));
    });
    let program = card.compile(&kernel.unwrap()).unwrap();
    let input = card.numbers(&vec![1.0; count]).unwrap();
    let output = card.zeros(count).unwrap();
    card.launch([&card.bind(&program, &[&input, &output], count as u32).unwrap()]);
    assert!(card.read(&output).unwrap().iter().all(|y| *y == 2.0));
}

#[test]
fn a_card_that_is_not_there_is_named() {
    let fault = Card::open(Some("no such card")).unwrap_err();
    let CardFault::NotFound { what, help } = fault else { panic!("{fault}") };
    assert!(what.contains("no such card") || what.contains("no usable graphics card was found"), "{what}");
    assert!(!help.is_empty());
}

#[test]
fn what_goes_wrong_on_the_card_is_an_error_of_the_next_reading() {
    let Some(card) = card() else { return };
    if card.found().interface == Interface::Cuda {
        // No other test of this process would have a card any more: `.ci/run` loses one under a run of the program.
        return;
    }
    let kernel = Kernel::record("copy", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let i = scope.thread();
        y.set(i, x.at(i));
    });
    let program = card.compile(&kernel.unwrap()).unwrap();
    let (input, output, other) = (card.zeros(8).unwrap(), card.zeros(8).unwrap(), card.zeros(8).unwrap());
    let launch = card.bind(&program, &[&input, &output], 8).unwrap();
    card.launch([&launch]);
    assert_eq!(card.read(&output).unwrap(), [0.0; 8]);
    input.destroy();
    card.launch([&launch]);
    let fault = card.read(&other).unwrap_err();
    assert!(matches!(&fault, CardFault::Lost { .. }) && fault.to_string().contains("was lost"), "{fault}");
}

#[test]
fn a_kernel_is_not_bound_to_too_few_buffers_nor_a_column_larger_than_the_card_takes() {
    let Some(card) = card() else { return };
    let kernel = Kernel::record("two", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let i = scope.thread();
        y.set(i, x.at(i));
    });
    let program = card.compile(&kernel.unwrap()).unwrap();
    let fault = card.bind(&program, &[&card.zeros(4).unwrap()], 4).unwrap_err();
    assert!(fault.to_string().contains("kernel `two`"), "{fault}");
    let too_many = card.found().largest_buffer as usize / 4 + 1;
    let fault = card.zeros(too_many).unwrap_err();
    assert!(matches!(fault, CardFault::Memory { .. }), "{fault}");
}
