//! A power of the plastic strain, as many laws harden with.

use crate::Elementary;

/// Plastic strain below which the power is a chord.
const CHORD_BELOW: f64 = 1e-12;

/// `eps_p^n` and its slope. A negative strain counts as none.
///
/// The slope is infinite at zero for `n < 1`. Below a plastic strain of 1e-12 the power is replaced by the chord from the origin,
/// which keeps its zero and makes the slope finite.
#[inline(always)]
pub(super) fn strain_power<T: Elementary>(strain: T, exponent: T) -> (T, T) {
    let at = strain.max(T::of(CHORD_BELOW));
    with_chord(strain, exponent, at, at.powf(exponent))
}

/// The same of `n = 1/2`, as a root. Optimizing compilers make a root of a power that they see to be one, with other last bits than those of the
/// power where they do not see it.
#[inline(always)]
pub(super) fn strain_root<T: Elementary>(strain: T) -> (T, T) {
    let at = strain.max(T::of(CHORD_BELOW));
    with_chord(strain, T::of(0.5), at, at.sqrt())
}

/// From the power of a strain that is at least that of the chord.
#[inline(always)]
fn with_chord<T: Elementary>(strain: T, exponent: T, at: T, power: T) -> (T, T) {
    let chord = T::of(CHORD_BELOW);
    let strain = strain.max(T::zero());
    let slope = T::select_lt(strain, chord, power / chord, exponent * power / at);
    (T::select_lt(strain, chord, slope * strain, power), slope)
}
