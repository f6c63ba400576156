//! The numbers a law is written in.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// [`Elementary::if_lt`] without closures: `branch!(T, a, b, then, otherwise)` is `then` where `a < b`, else `otherwise`.
macro_rules! branch {
    ($number:ty, $a:expr, $b:expr, $then:expr, $otherwise:expr) => {{
        let mut branch = <$number as $crate::real::Elementary>::branch($a, $b);
        let taken = if $crate::real::Branch::takes(&mut branch) { Some($then) } else { None };
        let passed = if $crate::real::Branch::passes(&mut branch) { Some($otherwise) } else { None };
        $crate::real::Branch::join(branch, taken, passed)
    }};
}
pub(crate) use branch;

/// [`Elementary::iterate`] without closures: `iterate!(T, start, |state| (next, again))`.
macro_rules! iterate {
    ($number:ty, $start:expr, |$state:ident| $step:expr) => {{
        let mut iteration = <$number as $crate::real::Elementary>::iteration($start);
        loop {
            let $state = $crate::real::Iteration::state(&mut iteration);
            let (next, again) = $step;
            if !$crate::real::Iteration::goes_on(&mut iteration, next, again) {
                break $crate::real::Iteration::end(iteration);
            }
        }
    }};
}
pub(crate) use iterate;

/// Arithmetic shared by one number and by a SIMD vector: no comparison, choices are made by [`Real::select_lt`].
pub trait Real:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// A constant, rounded to this precision.
    fn of(value: f64) -> Self;
    /// `self * a + b`, fused where the instruction set has it.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Inverse of the square root, to a few units of round-off, for normal positive numbers; at zero a SIMD vector may give
    /// anything.
    #[inline(always)]
    fn inverse_sqrt(self) -> Self {
        Self::one() / self.sqrt()
    }
    /// The smaller of two.
    fn min(self, other: Self) -> Self;
    /// The larger of two.
    fn max(self, other: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// `then` where `a < b`, else `otherwise`, lane by lane; both are evaluated, so the unused one may be non-finite.
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
    /// Two numbers `f` makes of two others, one lane after the other and in double precision: for what lanes have no instructions
    /// for, such as tables, logarithms, branches that differ from lane to lane.
    fn lane_by_lane(a: Self, b: Self, f: impl Fn(f64, f64) -> [f64; 2]) -> [Self; 2];

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::of(0.0)
    }
    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::of(1.0)
    }
    /// Non-negative integer power by repeated multiplication.
    #[inline(always)]
    fn powu(self, exponent: u32) -> Self {
        let mut result = Self::one();
        let mut base = self;
        let mut left = exponent;
        loop {
            if left & 1 == 1 {
                result = result * base;
            }
            left >>= 1;
            if left == 0 {
                return result;
            }
            // No further than needed: small numbers become subnormal, with which some processors compute slowly.
            base = base * base;
        }
    }
}

/// One number of a particle, in memory or on a graphics card, or a SIMD vector of them: elementary functions, and branches and iterations
/// that are operations as well, so that a law is written down for a card by running it once on numbers that record what is done with
/// them, and so that the lanes of a vector can branch apart.
pub trait Elementary: Real {
    /// A branch under way.
    type Branch: Branch<Self>;
    /// An iteration under way.
    type Iteration<S: Numbers<Self>>: Iteration<Self, S>;

    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Real power.
    fn powf(self, exponent: Self) -> Self;
    /// Cosine.
    fn cos(self) -> Self;
    /// The gap between one and the next larger number.
    fn epsilon() -> Self;
    /// The largest finite number.
    fn largest() -> Self;
    /// A branch that is taken where `a < b`; see `branch!`.
    fn branch(a: Self, b: Self) -> Self::Branch;
    /// An iteration from a state on; see `iterate!`.
    fn iteration<S: Numbers<Self>>(start: S) -> Self::Iteration<S>;
    /// What `then` makes where `a < b`, what `otherwise` makes elsewhere. Of one number only one of them is evaluated; of a SIMD vector
    /// both are where its lanes differ. What laws do on SIMD vectors is written with `branch!` instead: closures are not compiled for the
    /// instructions in use.
    #[inline(always)]
    fn if_lt<R: Numbers<Self>>(a: Self, b: Self, then: impl FnOnce() -> R, otherwise: impl FnOnce() -> R) -> R {
        branch!(Self, a, b, then(), otherwise())
    }
    /// Takes a state through `step` until it returns a second number that is not positive, once at least. Lanes of a SIMD vector that have
    /// come to their end keep their state while others go on. On SIMD vectors `iterate!` is used, as for branches.
    #[inline(always)]
    fn iterate<S: Numbers<Self>>(start: S, step: impl Fn(S) -> (S, Self)) -> S {
        iterate!(Self, start, |state| step(state))
    }
}

/// A branch under way: both sides are asked for in turn, and made where they are to be.
pub trait Branch<T: Real> {
    /// Whether to make what holds where the branch is taken.
    fn takes(&mut self) -> bool;
    /// Whether to make what holds elsewhere.
    fn passes(&mut self) -> bool;
    /// What was made of both.
    fn join<R: Numbers<T>>(self, taken: Option<R>, passed: Option<R>) -> R;
}

/// An iteration under way.
pub trait Iteration<T: Real, S: Numbers<T>> {
    /// Before a step.
    fn state(&mut self) -> S;
    /// Whether another step follows the one that led to `next`, with `again` positive where it should.
    fn goes_on(&mut self, next: S, again: T) -> bool;
    /// After the last step.
    fn end(self) -> S;
}

/// Whether a branch on one number in memory is taken.
#[derive(Clone, Copy, Debug)]
pub struct Taken(bool);

impl<T: Scalar> Branch<T> for Taken {
    #[inline(always)]
    fn takes(&mut self) -> bool {
        self.0
    }
    #[inline(always)]
    fn passes(&mut self) -> bool {
        !self.0
    }
    #[inline(always)]
    fn join<R: Numbers<T>>(self, taken: Option<R>, passed: Option<R>) -> R {
        match (taken, passed) {
            (Some(made), _) | (None, Some(made)) => made,
            (None, None) => unreachable!("a branch is taken or passed"),
        }
    }
}

/// The state of an iteration on one number in memory.
#[derive(Clone, Copy, Debug)]
pub struct Stepped<S>(S);

impl<T: Scalar, S: Numbers<T>> Iteration<T, S> for Stepped<S> {
    #[inline(always)]
    fn state(&mut self) -> S {
        self.0
    }
    #[inline(always)]
    fn goes_on(&mut self, next: S, again: T) -> bool {
        self.0 = next;
        again > T::zero()
    }
    #[inline(always)]
    fn end(self) -> S {
        self.0
    }
}

/// One number in memory: it can be compared, and shown.
pub trait Scalar: Elementary + PartialOrd + Default {
    /// Widened to double precision.
    fn to_f64(self) -> f64;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

/// What is made of numbers, so that a branch or an iteration can yield it.
pub trait Numbers<T: Real>: Copy {
    /// Visits every number, always in the same order.
    fn each(&mut self, visit: &mut dyn FnMut(&mut T));
    /// [`Real::select_lt`] of every number. What laws make on SIMD vectors does so without [`Numbers::each`], which is not compiled for
    /// the instructions in use.
    #[inline(always)]
    fn choose_lt(a: T, b: T, then: Self, otherwise: Self) -> Self {
        let mut selected = then;
        let mut place = 0;
        selected.each(&mut |number| {
            let (mut others, mut at) = (otherwise, 0);
            others.each(&mut |other| {
                if at == place {
                    *number = T::select_lt(a, b, *number, *other);
                }
                at += 1;
            });
            place += 1;
        });
        selected
    }
}

impl<T: Real> Numbers<T> for T {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        visit(self);
    }
    #[inline(always)]
    fn choose_lt(a: T, b: T, then: T, otherwise: T) -> T {
        T::select_lt(a, b, then, otherwise)
    }
}

impl<T: Real, N: Numbers<T>, const COUNT: usize> Numbers<T> for [N; COUNT] {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        for part in self {
            part.each(visit);
        }
    }
    #[inline(always)]
    fn choose_lt(a: T, b: T, then: Self, otherwise: Self) -> Self {
        let mut selected = then;
        for k in 0..COUNT {
            selected[k] = N::choose_lt(a, b, then[k], otherwise[k]);
        }
        selected
    }
}

macro_rules! scalar {
    ($t:ident, $sqrt:ident, $ln:ident, $exp:ident, $pow:ident, $cos:ident) => {
        impl Real for $t {
            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $t
            }
            // Not `mul_add` of the standard library: without a hardware instruction that is a slow call.
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                self * a + b
            }
            #[cfg(feature = "std")]
            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }
            #[cfg(not(feature = "std"))]
            #[inline(always)]
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn abs(self) -> Self {
                if self < 0.0 { -self } else { self }
            }
            #[inline(always)]
            fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
                if a < b { then } else { otherwise }
            }
            #[inline(always)]
            fn lane_by_lane(a: Self, b: Self, f: impl Fn(f64, f64) -> [f64; 2]) -> [Self; 2] {
                let [c, d] = f(a.to_f64(), b.to_f64());
                [Self::of(c), Self::of(d)]
            }
        }
        impl Elementary for $t {
            type Branch = Taken;
            type Iteration<S: Numbers<Self>> = Stepped<S>;

            #[cfg(feature = "std")]
            #[inline(always)]
            fn ln(self) -> Self {
                $t::ln(self)
            }
            #[cfg(not(feature = "std"))]
            #[inline(always)]
            fn ln(self) -> Self {
                libm::$ln(self)
            }
            #[cfg(feature = "std")]
            #[inline(always)]
            fn exp(self) -> Self {
                $t::exp(self)
            }
            #[cfg(not(feature = "std"))]
            #[inline(always)]
            fn exp(self) -> Self {
                libm::$exp(self)
            }
            #[cfg(feature = "std")]
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                $t::powf(self, exponent)
            }
            #[cfg(not(feature = "std"))]
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                libm::$pow(self, exponent)
            }
            #[cfg(feature = "std")]
            #[inline(always)]
            fn cos(self) -> Self {
                $t::cos(self)
            }
            #[cfg(not(feature = "std"))]
            #[inline(always)]
            fn cos(self) -> Self {
                libm::$cos(self)
            }
            #[inline(always)]
            fn epsilon() -> Self {
                $t::EPSILON
            }
            #[inline(always)]
            fn largest() -> Self {
                $t::MAX
            }
            #[inline(always)]
            fn branch(a: Self, b: Self) -> Taken {
                Taken(a < b)
            }
            #[inline(always)]
            fn iteration<S: Numbers<Self>>(start: S) -> Stepped<S> {
                Stepped(start)
            }
        }
        impl Scalar for $t {
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $t::is_finite(self)
            }
        }
    };
}

scalar!(f64, sqrt, log, exp, pow, cos);
scalar!(f32, sqrtf, logf, expf, powf, cosf);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integer_power_is_repeated_multiplication() {
        assert_eq!(1.5f64.powu(0), 1.0);
        assert_eq!(1.5f64.powu(4), 5.0625);
        assert_eq!(Real::powu(2.0f32, 6), 64.0);
    }

    #[test]
    fn branches_and_iterations_are_those_of_the_language() {
        let branch = |a: f64| f64::if_lt(a, 2.0, || [a, 1.0], || [0.0, a]);
        assert_eq!((branch(1.0), branch(2.0)), ([1.0, 1.0], [0.0, 2.0]));
        assert!(branch(f64::NAN)[1].is_nan());
        // 1, 2, 4 ... until it is above 50; at least one step.
        let doubled = |start: f64| f64::iterate(start, |x| (2.0 * x, 50.0 - 2.0 * x));
        assert_eq!((doubled(1.0), doubled(100.0)), (64.0, 200.0));
    }

    #[test]
    fn numbers_are_their_only_lane() {
        assert_eq!(f64::lane_by_lane(2.0, 0.5, |a, b| [a - b, a / b]), [1.5, 4.0]);
        assert_eq!(f32::lane_by_lane(-1.0, 0.25, |a, b| [a * b, b]), [-0.25, 0.25]);
    }

    #[test]
    fn selection_discards_the_other_value_even_if_it_is_not_finite() {
        assert_eq!(f64::select_lt(1.0, 2.0, 7.0, f64::NAN), 7.0);
        assert_eq!(f64::select_lt(2.0, 2.0, f64::NAN, 7.0), 7.0);
    }
}
