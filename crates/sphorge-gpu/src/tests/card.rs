//! The same on a GPU, or on the processor in place of one: run with `--features device`.

use super::engine::{IRON, PLATE, components, start};
use super::laws::{Law, laws};
use super::pairs::{self, Block};
use super::rounded::Expected;
use super::{SAMPLES, kernel_of};
use crate::Gpu;
use crate::device::{Card, CardFault, Interface};
use crate::record::{Index, Kernel};
use sphorge_engine::FieldSource;
use sphorge_engine::particles::FIELDS;

/// The device the tests run on: the processor, unless `SPHORGE_NEEDS_CARD` says which there has to be, as where all is tested: that of `CUDA` or
/// `Vulkan`, or the first of any.
fn device() -> Option<String> {
    match std::env::var("SPHORGE_NEEDS_CARD") {
        Ok(words) => (words != "any").then_some(words),
        Err(_) => Some("host".to_owned()),
    }
}

/// The same, opened.
pub(crate) fn card() -> Card {
    Card::open(device().as_deref()).unwrap()
}

/// The engine on this device.
pub(crate) fn gpu() -> Gpu {
    Gpu { device: device(), ..Gpu::default() }
}

#[test]
fn laws_on_a_device_match_the_cpu() {
    let card = card();
    // All laws are looked at before the test fails: time on a GPU is short.
    let differs = |law: &Law| {
        let kernel = kernel_of(law);
        let program = card.compile(&kernel).unwrap_or_else(|fault| panic!("{}: {fault}", law.name));
        let expected = Expected::of(law);
        let (input, output) = (card.numbers(&expected.arguments).unwrap(), card.zeros(expected.results.len()).unwrap());
        card.launch([&card.bind(&program, &[&input, &output], SAMPLES as u32).unwrap()]);
        // After so many wrong results a law is wrong.
        expected.difference(&kernel, &card.read(&output).unwrap(), 1000)
    };
    let faults: Vec<_> = laws().iter().filter_map(differs).collect();
    assert!(faults.is_empty(), "{} laws differ on {}:\n{}", faults.len(), card.found().name, faults.join("\n"));
}

#[test]
fn the_pair_loop_on_a_device_matches_the_cpu_and_is_reproducible() {
    let card = card();
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
    let card = card();
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
fn a_missing_device_is_named() {
    let fault = Card::open(Some("no such card")).unwrap_err();
    let CardFault::NotFound { what, help } = fault else { panic!("{fault}") };
    assert!(what.contains("no such card") || what.contains("no usable graphics card was found"), "{what}");
    assert!(!help.is_empty());
}

#[test]
fn errors_on_the_device_are_reported_by_the_next_read() {
    let card = card();
    if card.found().interface == Interface::Cuda {
        // No other test of this process would have a GPU any more: `.ci/run` loses one under a run of the program.
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
fn too_few_buffers_and_too_large_columns_are_refused() {
    let card = card();
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

#[test]
fn an_access_beyond_a_column_is_named_by_the_processor() {
    let host = Card::open(Some(" Host ")).unwrap();
    assert_eq!(host.found().title(), "host processor by interpreter");
    let kernel = Kernel::record("shift", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let i = scope.thread();
        y.set(i, x.at(i + Index::of(1)));
    });
    let program = host.compile(&kernel.unwrap()).unwrap();
    let (input, output) = (host.numbers(&[1.0, 2.0, 3.0]).unwrap(), host.zeros(3).unwrap());
    host.launch([&host.bind(&program, &[&input, &output], 2).unwrap()]);
    assert_eq!(host.read(&output).unwrap(), [2.0, 3.0, 0.0]);
    host.launch([&host.bind(&program, &[&input, &output], 3).unwrap()]);
    let fault = host.read(&output).unwrap_err().to_string();
    assert!(fault.contains("kernel `shift`: thread 2 asks for element 3 of `x`, which has 3"), "{fault}");
}

#[test]
fn a_run_by_the_stand_in_for_cuda_has_the_bits_of_the_host_device() {
    // Functions of a GPU round otherwise.
    if !card().found().name.contains("stand-in") {
        return;
    }
    let host = Gpu { device: Some("host".to_owned()), ..Gpu::default() };
    for (deck, overrides) in [PLATE, IRON] {
        let [ours, theirs] = [gpu(), host.clone()].map(|kind| {
            let mut simulation = start(&kind, deck, overrides);
            for _ in 0..30 {
                simulation.step(None).unwrap();
            }
            let fields = FIELDS.iter().map(|field| components(&simulation.read(field.name).unwrap()));
            (simulation.time(), fields.collect::<Vec<_>>(), simulation.ledger().unwrap())
        });
        assert_eq!(ours.0, theirs.0, "{deck}");
        for (field, (ours, theirs)) in FIELDS.iter().zip(ours.1.iter().zip(&theirs.1)) {
            assert!(
                ours.iter().map(|number| number.to_bits()).eq(theirs.iter().map(|number| number.to_bits())),
                "{deck}: `{}`",
                field.name
            );
        }
        assert_eq!(ours.2, theirs.2, "{deck}");
    }
}
