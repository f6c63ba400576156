//! Numbers that keep their rounding error in a second number.

use crate::device::{Card, CardFault};
use crate::record::{Index, Kernel, Recorded};

/// A number and its low part after an addition, keeping the rounding error (Knuth's two-sum).
pub(in crate::engine) fn added([high, low]: [Recorded; 2], value: Recorded) -> [Recorded; 2] {
    let value = (value + low).rounded();
    let sum = (high + value).rounded();
    let back = (sum - high).rounded();
    [sum, (high - (sum - back).rounded()) + (value - back)]
}

/// Whether the compiler of a GPU preserves the rounding error of a sum: one that assumes exact arithmetic optimises it
/// to zero.
pub(in crate::engine) fn keeps_rests(card: &Card) -> Result<bool, CardFault> {
    let kernel = Kernel::record("keeps_rests", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let i = scope.thread();
        let at = |k: u32| i + Index::of(k);
        let sum = added([x.at(at(0)), x.at(at(1))], x.at(at(2)));
        y.set(at(0), sum[0]);
        y.set(at(1), sum[1]);
    });
    let kernel = kernel.map_err(|fault| CardFault::Kernel { kernel: fault.kernel, why: fault.what.to_owned() })?;
    let program = card.compile(&kernel)?;
    let (x, y) = (card.numbers(&[1.0, 0.0, 1e-9])?, card.zeros(2)?);
    card.launch([&card.bind(&program, &[&x, &y], 1)?]);
    Ok(card.read(&y)? == [1.0, 1e-9])
}
