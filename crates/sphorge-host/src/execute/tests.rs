use crate::{Beyond, Binary, Builder, LANES, Unary, memory};
use std::sync::atomic::{AtomicU32, Ordering};

type OfOne = fn(f32) -> f32;
type OfTwo = fn(f32, f32) -> f32;

fn numbers(memory: &[AtomicU32]) -> Vec<f32> {
    memory.iter().map(|bits| f32::from_bits(bits.load(Ordering::Relaxed))).collect()
}

fn whole(memory: &[AtomicU32]) -> Vec<u32> {
    memory.iter().map(|bits| bits.load(Ordering::Relaxed)).collect()
}

/// More than fit in one group, and not a whole number of groups.
const THREADS: usize = LANES + 3;

#[test]
fn threads_take_their_own_way_through_branches_and_loops() {
    // The sum of all odd numbers below the thread, less those of even ones, and how often a number can be halved.
    let mut b = Builder::new(&["sums", "halvings"]);
    let (zero, one) = (b.constant(0), b.constant(1.0f32.to_bits()));
    let half = b.constant(0.5f32.to_bits());
    let (thread, first) = (b.thread(), b.constant(0));
    let sum = b.declare(zero);
    let counter = b.begin_range(first, thread);
    let (mask, number) = (b.constant(1), b.unary(Unary::Number, counter));
    let is_odd = b.binary(Binary::WholeAnd, counter, mask);
    let is_odd = b.unary(Unary::Number, is_odd);
    let before = b.read(sum);
    b.begin_if(is_odd, half);
    let less = b.binary(Binary::Subtract, before, number);
    b.assign(sum, less);
    b.begin_otherwise();
    let more = b.binary(Binary::Add, before, number);
    b.assign(sum, more);
    b.end_if();
    b.end_range();
    let all = b.read(sum);
    b.store(0, thread, all);
    let number = b.unary(Unary::Number, thread);
    let (left, halvings) = (b.declare(number), b.declare(zero));
    b.begin_loop();
    let (before, count) = (b.read(left), b.read(halvings));
    let after = b.binary(Binary::Multiply, before, half);
    let more = b.binary(Binary::Add, count, one);
    b.assign(left, after);
    b.assign(halvings, more);
    let again = b.binary(Binary::Subtract, after, one);
    b.end_loop(again);
    let all = b.read(halvings);
    b.store(1, thread, all);
    let program = b.finish();
    let (sums, halvings) = (memory(&[f32::NAN; THREADS]), memory(&[f32::NAN; THREADS]));
    program.run(&[&sums, &halvings], THREADS as u32).unwrap();
    for thread in 0..THREADS {
        let sum: i64 = (0..thread as i64).map(|k| if k % 2 == 1 { k } else { -k }).sum();
        assert_eq!(numbers(&sums)[thread], sum as f32, "{thread}");
        let mut left = thread as f32;
        let mut count = 0.0;
        loop {
            left *= 0.5;
            count += 1.0;
            if left <= 1.0 {
                break;
            }
        }
        assert_eq!(numbers(&halvings)[thread], count, "{thread}");
    }
}

#[test]
fn operations_round_as_those_of_a_processor() {
    let samples = [0.0, -0.0, 1.5, -2.25, 3e-39, 1e30, -7.7, f32::INFINITY, f32::NAN, 0.1, 16_777_219.0, 2.5e9];
    let count = samples.len();
    let at = |k: usize| samples[k % count];
    let threads = count * count;
    let unary: [(Unary, OfOne); 8] = [
        (Unary::Negate, |a| -a),
        (Unary::Copy, |a| a),
        (Unary::SquareRoot, f32::sqrt),
        (Unary::InverseSquareRoot, |a| 1.0 / a.sqrt()),
        (Unary::Absolute, f32::abs),
        (Unary::Logarithm, f32::ln),
        (Unary::Exponential, f32::exp),
        (Unary::Cosine, f32::cos),
    ];
    let binary: [(Binary, OfTwo); 5] = [
        (Binary::Add, |a, b| a + b),
        (Binary::Subtract, |a, b| a - b),
        (Binary::Multiply, |a, b| a * b),
        (Binary::Divide, |a, b| a / b),
        (Binary::Power, f32::powf),
    ];
    let mut b = Builder::new(&["a", "b", "results"]);
    let i = b.thread();
    let (x, y) = (b.load(0, i), b.load(1, i));
    let mut results = Vec::new();
    results.extend(unary.map(|(operation, _)| b.unary(operation, x)));
    results.extend(binary.map(|(operation, _)| b.binary(operation, x, y)));
    results.push(b.multiply_add(x, y, x));
    results.push(b.select_less(x, y, x, y));
    for (k, value) in results.iter().enumerate() {
        let start = b.constant((k * threads) as u32);
        let place = b.binary(Binary::WholeAdd, start, i);
        b.store(2, place, *value);
    }
    let first: Vec<f32> = (0..threads).map(|k| at(k / count)).collect();
    let second: Vec<f32> = (0..threads).map(at).collect();
    let out = memory(&vec![0.25; results.len() * threads]);
    b.finish().run(&[&memory(&first), &memory(&second), &out], threads as u32).unwrap();
    let found = numbers(&out);
    for k in 0..threads {
        let (x, y) = (first[k], second[k]);
        let mut expected: Vec<f32> = unary.iter().map(|(_, f)| f(x)).collect();
        expected.extend(binary.iter().map(|(_, f)| f(x, y)));
        expected.push(x.mul_add(y, x));
        expected.push(if x < y { x } else { y });
        for (which, expected) in expected.into_iter().enumerate() {
            let found = found[which * threads + k];
            let is_same = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
            assert!(is_same, "result {which} of {x} and {y}: {found}, {expected}");
        }
    }
}

#[test]
fn the_smaller_and_the_larger_are_numbers_where_one_is() {
    let mut b = Builder::new(&["a", "b", "least", "most"]);
    let i = b.thread();
    let (x, y) = (b.load(0, i), b.load(1, i));
    let (least, most) = (b.binary(Binary::Minimum, x, y), b.binary(Binary::Maximum, x, y));
    b.store(2, i, least);
    b.store(3, i, most);
    let (x, y) = (memory(&[1.0, 3.0, f32::NAN, 4.0]), memory(&[2.0, -3.0, 5.0, f32::NAN]));
    let (least, most) = (memory(&[0.0; 4]), memory(&[0.0; 4]));
    b.finish().run(&[&x, &y, &least, &most], 4).unwrap();
    assert_eq!((numbers(&least), numbers(&most)), (vec![1.0, -3.0, 5.0, 4.0], vec![2.0, 3.0, 5.0, 4.0]));
}

#[test]
fn threads_count_in_ascending_order() {
    let mut b = Builder::new(&["counters", "before"]);
    let (i, one) = (b.thread(), b.constant(1));
    let counter = b.binary(Binary::WholeAnd, i, one);
    let before = b.count(0, counter);
    b.store(1, i, before);
    let (counters, before) = (memory(&[0.0; 2]), memory(&[0.0; THREADS]));
    b.finish().run(&[&counters, &before], THREADS as u32).unwrap();
    assert_eq!(whole(&counters), [THREADS.div_ceil(2) as u32, THREADS as u32 / 2]);
    assert_eq!(whole(&before), (0..THREADS as u32).map(|k| k / 2).collect::<Vec<_>>());
}

#[test]
fn an_access_beyond_the_end_is_named_unless_the_thread_does_not_take_part() {
    let beyond = |index: u32, threads: u32| Beyond { buffer: "x".to_owned(), length: 3, index, thread: threads };
    let guarded = |is_guarded: bool, access: fn(&mut Builder, crate::Value)| {
        let mut b = Builder::new(&["x"]);
        let i = b.thread();
        let (number, most) = (b.unary(Unary::Number, i), b.constant(3.0f32.to_bits()));
        if is_guarded {
            b.begin_if(number, most);
        }
        access(&mut b, i);
        if is_guarded {
            b.begin_otherwise();
            b.end_if();
        }
        b.finish()
    };
    let accesses: [fn(&mut Builder, crate::Value); 3] = [
        |b, i| {
            b.load(0, i);
        },
        |b, i| b.store(0, i, i),
        |b, i| {
            b.count(0, i);
        },
    ];
    for access in accesses {
        let x = memory(&[0.0; 3]);
        assert_eq!(guarded(false, access).run(&[&x], THREADS as u32), Err(beyond(3, 3)));
        assert_eq!(guarded(true, access).run(&[&x], THREADS as u32), Ok(()));
        assert_eq!(guarded(false, access).run(&[&x], 3), Ok(()));
    }
    assert!(beyond(7, 9).to_string().contains("thread 9 asks for element 7 of `x`, which has 3"));
}

#[test]
fn registers_are_given_to_other_values_but_not_across_a_loop_that_needs_them() {
    // A chain of a hundred sums needs a few registers.
    let mut b = Builder::new(&["y"]);
    let (i, one) = (b.thread(), b.constant(1.0f32.to_bits()));
    let mut sum = b.unary(Unary::Number, i);
    for _ in 0..100 {
        sum = b.binary(Binary::Add, sum, one);
    }
    // Made before two loops, needed in the inner one alone, and each time.
    let step = b.binary(Binary::Add, one, one);
    let all = b.declare(sum);
    let (first, end) = (b.constant(0), b.constant(3));
    b.begin_range(first, end);
    b.begin_range(first, end);
    let before = b.read(all);
    let after = b.binary(Binary::Add, before, step);
    b.assign(all, after);
    b.end_range();
    // What would take the register of `step`, were it free.
    let other = b.binary(Binary::Add, one, one);
    let other = b.binary(Binary::Multiply, other, other);
    b.store(0, i, other);
    b.end_range();
    let result = b.read(all);
    b.store(0, i, result);
    let program = b.finish();
    assert!(program.registers < 14, "{}", program.registers);
    let y = memory(&[0.0; THREADS]);
    program.run(&[&y], THREADS as u32).unwrap();
    let expected: Vec<f32> = (0..THREADS).map(|k| k as f32 + 100.0 + 18.0).collect();
    assert_eq!(numbers(&y), expected);
}
