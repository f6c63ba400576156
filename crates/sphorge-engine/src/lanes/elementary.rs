//! Elementary functions, branches and iterations of SIMD vectors.
//!
//! Exponential, logarithm and power are computed here in double precision, without tables and without branches between lanes: the
//! logarithm as the sum of two numbers, by the series of `2 artanh s`, `s = (m - 1)/(m + 1)`, with the coefficients of FreeBSD's
//! `e_log.c` (Sun Microsystems 1993); the exponential by the polynomial of degree 13 within half of `ln 2`. They need fused
//! multiplication. Every lane has the same digits whatever the others hold. All three are within one unit in the last place of the
//! functions of the standard library, the power of bases that are not negative.

use super::Lanes;
use sphorge_physics::real::{Branch, Iteration};
use sphorge_physics::{Elementary, Numbers, Real};
use std::f64::consts::{LOG2_E, SQRT_2};

/// What elementary functions need to know of the form of numbers.
pub(super) trait Doubles: Elementary {
    /// `m` from 1 to 2 and `e` of positive normal numbers `2^e m`.
    fn mantissa_and_exponent(self) -> [Self; 2];
    /// `2^exponent` times numbers, for whole exponents from -1100 to 1100; rounded once.
    fn times_power_of_two(self, exponent: Self) -> Self;
}

/// `ln 2` as a sum: the first has so few digits that a whole number below 2048 times it is exact.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];

/// Coefficients of `ln(1 + f) = 2 s + s R`, `R = w (a_0 + w (a_1 + ...))`, `w = s^2`.
const OF_LOGARITHM: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

/// Coefficients of `(exp(r) - 1 - r)/r^2`, one over the factorials from that of two on.
const OF_EXPONENTIAL: [f64; 12] = {
    let (mut inverse, mut factorial, mut k) = ([0.0; 12], 1.0, 0);
    while k < inverse.len() {
        factorial *= (k + 2) as f64;
        inverse[k] = 1.0 / factorial;
        k += 1;
    }
    inverse
};

/// Added to a number below 2^51 and taken away again, it leaves the nearest whole number.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// What subnormal numbers are multiplied with to be normal, and its exponent.
const NORMALIZER: (f64, f64) = (18_014_398_509_481_984.0, 54.0);

/// Beyond these exponents the exponential is infinite and zero.
const EXPONENTS: [f64; 2] = [-746.0, 710.0];

/// Constants in every lane; not by `array::map`, whose closure would not be compiled for the instructions in use.
#[inline(always)]
fn splat<V: Real, const COUNT: usize>(constants: [f64; COUNT]) -> [V; COUNT] {
    let mut lanes = [V::zero(); COUNT];
    for k in 0..COUNT {
        lanes[k] = V::of(constants[k]);
    }
    lanes
}

/// Whole numbers nearest to `x`.
#[inline(always)]
fn rounded<V: Real>(x: V) -> V {
    (x + V::of(ROUNDER)) - V::of(ROUNDER)
}

/// Two whole numbers of about half of `exponent`: of the products with the powers of two of both the first is exact.
#[inline(always)]
#[cfg_attr(not(test), allow(dead_code, reason = "not with every processor's instructions"))]
pub(super) fn halves<V: Real>(exponent: V) -> [V; 2] {
    let half = rounded(V::of(0.5) * exponent);
    [half, exponent - half]
}

/// Natural logarithm of positive finite numbers as a sum whose first part is the rounded one; to some 2^-59 of itself.
#[inline(always)]
fn logarithm<V: Doubles>(x: V) -> [V; 2] {
    let (one, normal) = (V::one(), V::of(f64::MIN_POSITIVE));
    let [m, e] = V::select_lt(x, normal, x * V::of(NORMALIZER.0), x).mantissa_and_exponent();
    let e = e - V::select_lt(x, normal, V::of(NORMALIZER.1), V::zero());
    // From the root of one half to that of two.
    let root = V::of(SQRT_2);
    let (e, m) = (V::select_lt(root, m, e + one, e), V::select_lt(root, m, V::of(0.5) * m, m));

    // s = f/d with what is left of the division; d and what was rounded off it are m + 1.
    let d = m + one;
    let d_low = m - (d - one);
    let inverse = one / d;
    let s = (m - one) * inverse;
    let left = s.mul_add(d, one - m) + s * d_low;
    let (w, a): (V, [V; 7]) = (s * s, splat(OF_LOGARITHM));
    let w2 = w * w;
    let even = a[5].mul_add(w2, a[3]).mul_add(w2, a[1]) * w2;
    let odd = a[6].mul_add(w2, a[4]).mul_add(w2, a[2]).mul_add(w2, a[0]) * w;
    let two_s_low = V::of(-2.0) * left * inverse * (one + w);

    let (whole, two_s) = (e * V::of(LN_2[0]), s + s);
    let sum = whole + two_s;
    let rest = (two_s - (sum - whole)) + e.mul_add(V::of(LN_2[1]), s.mul_add(even + odd, two_s_low));
    let high = sum + rest;
    [high, rest - (high - sum)]
}

/// Exponential of a sum whose second part is far smaller; the first may have any size but not be NaN.
#[inline(always)]
fn exponential<V: Doubles>(x: V, low: V) -> V {
    let one = V::one();
    let x = x.max(V::of(EXPONENTS[0])).min(V::of(EXPONENTS[1]));
    let n = rounded(x * V::of(LOG2_E));
    let (reduced, n_low) = (n.mul_add(V::of(-LN_2[0]), x), n * V::of(LN_2[1]));
    let r = reduced - n_low;
    let low = ((reduced - r) - n_low) + low;

    // (exp(r) - 1 - r)/r^2 by its series, in pairs.
    let (r2, c): (V, [V; 12]) = (r * r, splat(OF_EXPONENTIAL));
    let r4 = r2 * r2;
    let first = c[3].mul_add(r, c[2]).mul_add(r2, c[1].mul_add(r, c[0]));
    let second = c[7].mul_add(r, c[6]).mul_add(r2, c[5].mul_add(r, c[4]));
    let third = c[11].mul_add(r, c[10]).mul_add(r2, c[9].mul_add(r, c[8]));
    let series = r2 * third.mul_add(r4, second).mul_add(r4, first);

    let sum = one + r;
    let rest = (r - (sum - one)) + low.mul_add(sum + series, series);
    (sum + rest).times_power_of_two(n)
}

/// Natural logarithm.
#[inline(always)]
pub(super) fn ln<V: Doubles>(x: V) -> V {
    let (zero, infinity) = (V::zero(), V::of(f64::INFINITY));
    let [high, _] = logarithm(x);
    // Infinity and NaN are their own logarithms.
    let finite = V::select_lt(x, infinity, high, x);
    V::select_lt(zero, x, finite, V::select_lt(x, zero, V::of(f64::NAN), x - infinity))
}

/// Exponential.
#[inline(always)]
pub(super) fn exp<V: Doubles>(x: V) -> V {
    V::select_lt(x, V::of(f64::INFINITY), exponential(x, V::zero()), x)
}

/// Power of bases that are not negative; that of a negative base is NaN.
#[inline(always)]
pub(super) fn pow<V: Doubles>(x: V, y: V) -> V {
    let (zero, one, infinity) = (V::zero(), V::one(), V::of(f64::INFINITY));
    let [high, low] = logarithm(x);
    let product = y * high;
    let rest = y.mul_add(high, -product) + y * low;
    // Where the power is zero or infinite, what is left of a product may be NaN.
    let rest = V::select_lt(product.abs(), V::of(-EXPONENTS[0]), rest, zero);
    let power = exponential(product, rest);

    let ordinary = V::select_lt(zero, x, V::select_lt(x, infinity, one, zero), zero);
    let mut special = V::branch(ordinary, one);
    let taken = if special.takes() {
        let of_zero = V::select_lt(zero, y, x, V::select_lt(y, zero, infinity, one));
        let of_infinity = V::select_lt(zero, y, x, V::select_lt(y, zero, one / x, one));
        let limit = V::select_lt(x, one, of_zero, of_infinity);
        Some(V::select_lt(x, zero, V::of(f64::NAN), limit))
    } else {
        None
    };
    special.join(taken, Some(power))
}

/// A branch on a SIMD vector: both sides are made where its lanes differ.
pub(crate) struct LaneBranch<L> {
    a: L,
    b: L,
    /// Bits of the lanes in which it is taken.
    taken: u32,
}

impl<L: Lanes> LaneBranch<L> {
    #[inline(always)]
    pub(super) fn new(a: L, b: L) -> Self {
        Self { a, b, taken: L::less(a, b) }
    }
}

impl<L: Lanes> Branch<L> for LaneBranch<L> {
    #[inline(always)]
    fn takes(&mut self) -> bool {
        self.taken != 0
    }
    #[inline(always)]
    fn passes(&mut self) -> bool {
        self.taken != ((1u64 << L::WIDTH) - 1) as u32
    }
    #[inline(always)]
    fn join<R: Numbers<L>>(self, taken: Option<R>, passed: Option<R>) -> R {
        match (taken, passed) {
            (Some(taken), Some(passed)) => R::choose_lt(self.a, self.b, taken, passed),
            (Some(made), None) | (None, Some(made)) => made,
            (None, None) => unreachable!("a branch is taken or passed"),
        }
    }
}

/// An iteration on a SIMD vector, positive lanes of which go on while others keep their state.
pub(crate) struct LaneIteration<L, S> {
    state: S,
    going: L,
}

impl<L: Lanes, S: Numbers<L>> LaneIteration<L, S> {
    #[inline(always)]
    pub(super) fn new(start: S) -> Self {
        Self { state: start, going: L::one() }
    }
}

impl<L: Lanes, S: Numbers<L>> Iteration<L, S> for LaneIteration<L, S> {
    #[inline(always)]
    fn state(&mut self) -> S {
        self.state
    }
    #[inline(always)]
    fn goes_on(&mut self, next: S, again: L) -> bool {
        self.state = S::choose_lt(L::zero(), self.going, next, self.state);
        self.going = L::select_lt(L::zero(), again, self.going, L::zero());
        L::less(L::zero(), self.going) != 0
    }
    #[inline(always)]
    fn end(self) -> S {
        self.state
    }
}

/// Implements [`Elementary`] for a SIMD vector of doubles.
macro_rules! elementary_of_doubles {
    ($vector:ident) => {
        impl sphorge_physics::Elementary for $vector {
            #[inline(always)]
            fn ln(self) -> Self {
                super::elementary::ln(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                super::elementary::exp(self)
            }
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                super::elementary::pow(self, exponent)
            }
            super::elementary::common!(f64::EPSILON, f64::MAX);
        }
    };
}

/// Implements [`Elementary`] for a SIMD vector of singles, whose functions no stage asks for in its inner loop: one by one.
macro_rules! elementary_of_singles {
    ($vector:ident) => {
        impl sphorge_physics::Elementary for $vector {
            #[inline(always)]
            fn ln(self) -> Self {
                Self::lane_by_lane(self, self, |x, _| [x.ln(), 0.0])[0]
            }
            #[inline(always)]
            fn exp(self) -> Self {
                Self::lane_by_lane(self, self, |x, _| [x.exp(), 0.0])[0]
            }
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                Self::lane_by_lane(self, exponent, |x, y| [x.powf(y), 0.0])[0]
            }
            super::elementary::common!(f64::from(f32::EPSILON), f64::from(f32::MAX));
        }
    };
}

/// What both kinds of vectors have in common.
macro_rules! common {
    ($epsilon:expr, $largest:expr) => {
        type Branch = super::elementary::LaneBranch<Self>;
        type Iteration<S: sphorge_physics::Numbers<Self>> = super::elementary::LaneIteration<Self, S>;

        #[inline(always)]
        fn cos(self) -> Self {
            Self::lane_by_lane(self, self, |x, _| [x.cos(), 0.0])[0]
        }
        #[inline(always)]
        fn epsilon() -> Self {
            Self::of($epsilon)
        }
        #[inline(always)]
        fn largest() -> Self {
            Self::of($largest)
        }
        #[inline(always)]
        fn branch(a: Self, b: Self) -> Self::Branch {
            super::elementary::LaneBranch::new(a, b)
        }
        #[inline(always)]
        fn iteration<S: sphorge_physics::Numbers<Self>>(start: S) -> Self::Iteration<S> {
            super::elementary::LaneIteration::new(start)
        }
    };
}

pub(super) use {common, elementary_of_doubles, elementary_of_singles};

#[cfg(test)]
mod tests {
    use crate::lanes::{Instructions, Job, Lanes, run};
    use sphorge_physics::Numbers;

    /// Applies a function to the pairs `x`, `y` lane by lane.
    struct Apply<'a> {
        function: usize,
        x: &'a [f64],
        y: &'a [f64],
        out: &'a mut Vec<f64>,
    }

    impl Job<f64> for Apply<'_> {
        #[inline(always)]
        fn run<L: Lanes<Element = f64>>(self) {
            let padded = |values: &[f64], k: usize| {
                L::load(&std::array::from_fn::<f64, 16, _>(|lane| values[(k + lane).min(values.len() - 1)]))
            };
            for k in (0..self.x.len()).step_by(L::WIDTH) {
                let (x, y) = (padded(self.x, k), padded(self.y, k));
                let mut made = [0.0; 16];
                [x.ln(), x.exp(), x.powf(y), x.cos()][self.function].store(&mut made);
                self.out.extend(&made[..L::WIDTH]);
            }
            self.out.truncate(self.x.len());
        }
    }

    fn applied(instructions: Instructions, function: usize, x: &[f64], y: &[f64]) -> Vec<f64> {
        let mut out = Vec::new();
        run(instructions, Apply { function, x, y, out: &mut out });
        out
    }

    /// How many numbers there are between two.
    fn units_apart(a: f64, b: f64) -> u64 {
        if a == b || (a.is_nan() && b.is_nan()) { 0 } else { a.to_bits().abs_diff(b.to_bits()) }
    }

    /// Numbers that fill an interval without repetition.
    fn spread(count: usize, [from, to]: [f64; 2], seed: f64) -> Vec<f64> {
        (0..count).map(|k| from + (to - from) * (k as f64 * 0.618_033_988_749_894_9 + seed).fract()).collect()
    }

    #[test]
    fn elementary_functions_are_within_a_unit_of_those_of_the_library() {
        const COUNT: usize = 40_000;
        let of_exponents = |range, seed| spread(COUNT, range, seed).into_iter().map(f64::exp).collect::<Vec<_>>();
        let none = vec![0.0; COUNT];
        // Logarithms of all sizes and near one, exponents of all sizes, powers as of strains, of heat and of rates, powers of all sizes.
        let cases = [
            (0, of_exponents([-744.0, 709.7], 0.1), none.clone()),
            (0, spread(COUNT, [0.6, 1.7], 0.2), none.clone()),
            (1, spread(COUNT, [-745.0, 709.7], 0.3), none.clone()),
            (1, spread(COUNT, [-0.4, 0.4], 0.4), none.clone()),
            (2, of_exponents([-28.0, 2.0], 0.5), spread(COUNT, [0.05, 1.0], 0.05)),
            (2, spread(COUNT, [0.0, 1.0], 0.6), spread(COUNT, [0.3, 3.0], 0.95)),
            (2, of_exponents([0.0, 30.0], 0.7), spread(COUNT, [0.001, 0.1], 0.35)),
            (2, of_exponents([-700.0, 700.0], 0.8), spread(COUNT, [-1.0, 1.0], 0.45)),
        ];
        for instructions in Instructions::available() {
            for (case, (function, x, y)) in cases.iter().enumerate() {
                let found = applied(instructions, *function, x, y);
                for ((x, y), found) in x.iter().zip(y).zip(found) {
                    let want = [x.ln(), x.exp(), x.powf(*y)][*function];
                    assert!(units_apart(found, want) <= 1, "{instructions:?}, {case}: {x:e} {y:e}: {found:e} {want:e}");
                }
            }
        }
    }

    #[test]
    fn limits_of_elementary_functions_are_those_of_the_library() {
        const SPECIAL: [f64; 14] = [
            0.0,
            5e-324,
            1e-310,
            f64::MIN_POSITIVE,
            0.5,
            1.0,
            2.0,
            710.5,
            1e300,
            f64::MAX,
            f64::INFINITY,
            -1.5,
            f64::NAN,
            -750.0,
        ];
        for instructions in Instructions::available() {
            for (x, y) in SPECIAL.iter().flat_map(|x| SPECIAL.map(|y| (*x, y))) {
                let want = [x.ln(), x.exp(), if x < 0.0 { f64::NAN } else { x.powf(y) }, x.cos()];
                for (function, want) in want.into_iter().enumerate() {
                    // Exponents are constants, and whole powers of negative bases are for single numbers.
                    if function == 2
                        && (x.is_nan() || !y.is_finite() || (x < 0.0 && instructions == Instructions::Scalar))
                    {
                        continue;
                    }
                    let found = applied(instructions, function, &[1.25, x, 3.0], &[0.5, y, 0.5]);
                    assert!(
                        units_apart(found[1], want) <= 1,
                        "{instructions:?}, {function}: {x:e} {y:e}: {found:?} {want:e}"
                    );
                    let beside = [1.25f64.ln(), 1.25f64.exp(), 1.25f64.powf(0.5), 1.25f64.cos()][function];
                    assert!(units_apart(found[0], beside) <= 1, "{instructions:?}, {function} beside {x:e} {y:e}");
                }
            }
            assert!(applied(instructions, 2, &[f64::NAN], &[0.3])[0].is_nan());
        }
    }

    /// Branches and iterates in every lane on its own.
    struct BranchApart<'a>(&'a mut Vec<[f64; 3]>);

    impl Job<f64> for BranchApart<'_> {
        #[inline(always)]
        fn run<L: Lanes<Element = f64>>(self) {
            let numbers: [f64; 16] = std::array::from_fn(|k| 1.0 + ((5 * k) % 7) as f64);
            for k in (0..16).step_by(L::WIDTH) {
                let x = L::load(&numbers[k..]);
                let two = L::of(2.0);
                let [low, high] = L::if_lt(x, L::of(4.5), || [x, two], || [two, x * x]);
                // Doubled until it is above fifty.
                let grown = L::iterate([x], |[x]| ([two * x], L::of(50.0) - two * x));
                let mut out = [[0.0; 16]; 3];
                for (values, row) in [low, high, grown[0]].into_iter().zip(&mut out) {
                    values.store(row);
                }
                self.0.extend((0..L::WIDTH).map(|lane| [out[0][lane], out[1][lane], out[2][lane]]));
            }
        }
    }

    #[test]
    fn lanes_branch_and_iterate_apart() {
        for instructions in Instructions::available() {
            let mut found = Vec::new();
            run(instructions, BranchApart(&mut found));
            for (k, found) in found.into_iter().enumerate() {
                let x = 1.0 + ((5 * k) % 7) as f64;
                let [low, high] = if x < 4.5 { [x, 2.0] } else { [2.0, x * x] };
                let mut grown = 2.0 * x;
                while grown < 50.0 {
                    grown *= 2.0;
                }
                assert_eq!(found, [low, high, grown], "{instructions:?}, lane {k}");
            }
        }
    }

    #[test]
    fn what_has_no_choice_of_its_own_chooses_every_number() {
        #[derive(Clone, Copy, Debug, PartialEq)]
        struct Both([f64; 2], f64);
        impl Numbers<f64> for Both {
            fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
                self.0.each(visit);
                visit(&mut self.1);
            }
        }
        let (a, b) = (Both([1.0, 2.0], 3.0), Both([4.0, 5.0], 6.0));
        assert_eq!((Both::choose_lt(0.0, 1.0, a, b), Both::choose_lt(1.0, 0.0, a, b)), (a, b));
    }
}
