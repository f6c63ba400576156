//! Numbers of a GPU with what single precision leaves of them: some 48 bits.

use super::Recorded;
use super::number::{RecordedBranch, RecordedIteration};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use sphorge_physics::real::{Branch, Iteration};
use sphorge_physics::{Elementary, Numbers, Real};

/// A number and the rest of it, for laws whose result is small beside what it comes of, such as the pressure of a density: T. J. Dekker, Numerische
/// Mathematik 18 (1971) 224. What compilers of GPUs must not see through is [`Recorded::rounded`].
#[derive(Clone, Copy, Debug)]
pub struct Double {
    /// The number in single precision.
    pub high: Recorded,
    /// What that leaves of it.
    pub low: Recorded,
}

/// Divides the 24 digits of a number in two halves.
const HALVES: f64 = 4097.0;

/// `a + b` and what rounding leaves of it (Knuth's sum of two).
fn sum(a: Recorded, b: Recorded) -> Double {
    let high = (a + b).rounded();
    let back = (high - a).rounded();
    Double { high, low: (a - (high - back).rounded()) + (b - back) }
}

/// The same where the second is smaller.
fn sum_of_unequal(a: Recorded, b: Recorded) -> Double {
    let high = (a + b).rounded();
    Double { high, low: b - (high - a).rounded() }
}

fn halves(a: Recorded) -> [Recorded; 2] {
    let wide = (a * Recorded::of(HALVES)).rounded();
    let high = (wide - (wide - a).rounded()).rounded();
    [high, (a - high).rounded()]
}

/// `a b` and what rounding leaves of it.
fn product(a: Recorded, b: Recorded) -> Double {
    let high = (a * b).rounded();
    let ([a, a_rest], [b, b_rest]) = (halves(a), halves(b));
    let mut low = ((a * b).rounded() - high).rounded();
    for part in [a * b_rest, a_rest * b, a_rest * b_rest] {
        low = (low + part.rounded()).rounded();
    }
    Double { high, low }
}

impl Double {
    /// Of a number and its low part.
    pub fn new([high, low]: [Recorded; 2]) -> Self {
        Self { high, low }
    }

    fn times(self, factor: Recorded) -> Self {
        let first = product(self.high, factor);
        sum_of_unequal(first.high, first.low + self.low * factor)
    }
}

impl From<Recorded> for Double {
    fn from(number: Recorded) -> Self {
        Self { high: number, low: Recorded::zero() }
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let first = sum(self.high, other.high);
        let rests = sum(self.low, other.low);
        let second = sum_of_unequal(first.high, first.low + rests.high);
        sum_of_unequal(second.high, second.low + rests.low)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let first = product(self.high, other.high);
        sum_of_unequal(first.high, first.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // Divisions of GPUs are good to a few units: each share is of what the last has left.
        let first = (self.high / other.high).rounded();
        let left = self - other.times(first);
        let second = (left.high / other.high).rounded();
        let third = (left - other.times(second)).high / other.high;
        let quotient = sum_of_unequal(first, second);
        quotient + Self::from(third)
    }
}

impl AddAssign for Double {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Double {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Real for Double {
    fn of(value: f64) -> Self {
        let high = f64::from(value as f32);
        let low = if high.is_finite() { value - high } else { 0.0 };
        Self { high: Recorded::of(value), low: Recorded::of(low) }
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    fn sqrt(self) -> Self {
        let first = self.high.sqrt().rounded();
        let left = (self - product(first, first)).high;
        // The root of nothing is nothing.
        let rest = left / (Recorded::of(2.0) * first);
        sum_of_unequal(first, Recorded::select_lt(Recorded::zero(), first, rest, Recorded::zero()))
    }
    fn min(self, other: Self) -> Self {
        Self::select_lt(self, other, self, other)
    }
    fn max(self, other: Self) -> Self {
        Self::select_lt(other, self, self, other)
    }
    fn abs(self) -> Self {
        Self::select_lt(self, Self::zero(), -self, self)
    }
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        let (left, zero) = ((a - b).high, Recorded::zero());
        let choose = |then, otherwise| Recorded::select_lt(left, zero, then, otherwise);
        Self { high: choose(then.high, otherwise.high), low: choose(then.low, otherwise.low) }
    }
    fn lane_by_lane(a: Self, b: Self, f: impl Fn(f64, f64) -> [f64; 2]) -> [Self; 2] {
        Recorded::lane_by_lane(a.high, b.high, f).map(Self::from)
    }
}

/// So that loops and branches of a kernel can carry it.
impl Numbers<Recorded> for Double {
    fn each(&mut self, visit: &mut dyn FnMut(&mut Recorded)) {
        visit(&mut self.high);
        visit(&mut self.low);
    }
}

/// What is made of pairs of numbers, as their numbers see it.
#[derive(Clone, Copy)]
struct Parts<N>(N);

impl<N: Numbers<Double>> Numbers<Recorded> for Parts<N> {
    fn each(&mut self, visit: &mut dyn FnMut(&mut Recorded)) {
        self.0.each(&mut |number: &mut Double| {
            visit(&mut number.high);
            visit(&mut number.low);
        });
    }
}

/// Elementary functions are those of the first number, with the slope for what the second adds: good to single precision.
impl Elementary for Double {
    type Branch = DoubleBranch;
    type Iteration<S: Numbers<Self>> = DoubleIteration<S>;

    fn ln(self) -> Self {
        sum(self.high.ln(), self.low / self.high)
    }
    fn exp(self) -> Self {
        let first = self.high.exp();
        sum(first, first * self.low)
    }
    fn powf(self, exponent: Self) -> Self {
        let first = self.high.powf(exponent.high);
        let by_base = exponent.high * self.low / self.high;
        let by_exponent =
            Recorded::select_lt(Recorded::zero(), self.high, exponent.low * self.high.ln(), Recorded::zero());
        let rest = Recorded::select_lt(Recorded::zero(), self.high, first * (by_base + by_exponent), Recorded::zero());
        sum(first, rest)
    }
    fn cos(self) -> Self {
        sum(self.high.cos(), (self.high + Recorded::of(core::f64::consts::FRAC_PI_2)).cos() * self.low)
    }
    fn epsilon() -> Self {
        Self::of(f64::from(f32::EPSILON) * f64::from(f32::EPSILON))
    }
    fn largest() -> Self {
        Recorded::largest().into()
    }
    fn branch(a: Self, b: Self) -> DoubleBranch {
        DoubleBranch(Recorded::branch((a - b).high, Recorded::zero()))
    }
    fn iteration<S: Numbers<Self>>(start: S) -> DoubleIteration<S> {
        DoubleIteration(Recorded::iteration(Parts(start)))
    }
}

/// A branch on pairs of numbers that is being recorded.
pub struct DoubleBranch(RecordedBranch);

impl Branch<Double> for DoubleBranch {
    fn takes(&mut self) -> bool {
        self.0.takes()
    }
    fn passes(&mut self) -> bool {
        self.0.passes()
    }
    fn join<R: Numbers<Double>>(self, taken: Option<R>, passed: Option<R>) -> R {
        self.0.join(taken.map(Parts), passed.map(Parts)).0
    }
}

/// An iteration on pairs of numbers that is being recorded.
pub struct DoubleIteration<S>(RecordedIteration<Parts<S>>);

impl<S: Numbers<Double>> Iteration<Double, S> for DoubleIteration<S> {
    fn state(&mut self) -> S {
        self.0.state().0
    }
    fn goes_on(&mut self, next: S, again: Double) -> bool {
        self.0.goes_on(Parts(next), again.high)
    }
    fn end(self) -> S {
        self.0.end().0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::Evaluation;
    use crate::record::{Index, Kernel};
    use sphorge_physics::SymmetricTensor;
    use sphorge_physics::eos::{BoundedPressure, EquationConstants, EquationOfState, MieGruneisenHugoniot};
    use sphorge_physics::flow::{FlowLaw, FlowState, FlowStep, PressureAndDamage, YieldLaw};

    /// What a kernel makes of numbers that single precision does not hold.
    fn evaluated(arguments: &[f64], law: impl Fn(&[Double]) -> Vec<Double>) -> Vec<f64> {
        let mut count = 0;
        let kernel = Kernel::record("double", |scope| {
            let (x, y) = (scope.input("x"), scope.output("y"));
            let at = |k: usize| x.at(Index::of(k as u32));
            let numbers: Vec<_> = (0..arguments.len()).map(|k| Double::new([at(2 * k), at(2 * k + 1)])).collect();
            let results = law(&numbers);
            count = results.len();
            for (k, result) in results.into_iter().enumerate() {
                y.set(Index::of(2 * k as u32), result.high);
                y.set(Index::of(2 * k as u32 + 1), result.low);
            }
        });
        let parts = arguments.iter().flat_map(|x| [*x as f32, (x - f64::from(*x as f32)) as f32]).collect();
        let mut buffers = [parts, vec![0.0; 2 * count]];
        Evaluation::default().run(&kernel.unwrap(), &mut buffers, 1);
        buffers[1].chunks(2).map(|parts| f64::from(parts[0]) + f64::from(parts[1])).collect()
    }

    #[test]
    fn arithmetic_has_fourteen_digits() {
        let of = |[a, b]: [f64; 2]| {
            vec![a + b, a - b, a * b, a / b, b.sqrt(), a.min(b), a.max(b), a.abs(), a.mul_add(b, a), a * 0.3 + 1e-9]
        };
        for [a, b] in
            [[1.0 / 3.0, 8_930.123_456_789], [-7.77e5, 0.1], [8_930.0, 8_929.999_7], [2.0 / 7.0, 2.0 / 7.0 + 1e-9]]
        {
            let found = evaluated(&[a, b], |x| {
                let (a, b) = (x[0], x[1]);
                let constant = a * Double::of(0.3) + Double::of(1e-9);
                vec![a + b, a - b, a * b, a / b, b.sqrt(), a.min(b), a.max(b), a.abs(), a.mul_add(b, a), constant]
            });
            for (k, (found, expected)) in found.into_iter().zip(of([a, b])).enumerate() {
                // What two that are near each other leave is good to what they are.
                let scale = if k < 2 { a.abs() + b.abs() } else { expected.abs() };
                assert!((found - expected).abs() < 2e-14 * scale, "{k} of {a} and {b}: {found} {expected}");
            }
        }
        assert_eq!(evaluated(&[0.0], |x| vec![x[0].sqrt()]), [0.0]);
    }

    #[test]
    fn elementary_functions_and_branches_use_the_low_part() {
        let (x, y) = (1.75 + 3e-9, 2.5 - 7e-9);
        let found = evaluated(&[x, y], |numbers| {
            let (x, y) = (numbers[0], numbers[1]);
            let less = |a, b| Double::if_lt(a, b, || [a, b], || [b, a]);
            let [least, most] = less(y, x);
            // Halved until it is below one.
            let halved = Double::iterate(y, |a| {
                let half = a * Double::of(0.5);
                (half, half - Double::one())
            });
            vec![x.ln(), x.exp(), x.powf(y), x.cos(), least, most, halved, Double::of(0.0).powf(y)]
        });
        let expected = [x.ln(), x.exp(), x.powf(y), x.cos(), x, y, y / 4.0, 0.0];
        for (k, (found, expected)) in found.into_iter().zip(expected).enumerate() {
            let near = if k < 4 { 2e-7 } else { 2e-14 };
            assert!((found - expected).abs() <= near * expected.abs(), "{k}: {found} {expected}");
        }
    }

    #[test]
    fn history_variables_accumulate_increments_below_single_precision() {
        let law = FlowLaw::PressureAndDamage(PressureAndDamage::<f64>::new(&[1e8, 0.0, 0.0, 0.0, 1e9]));
        // A stress of 100 MPa over 1e-8 of strain adds 1e-9 to a damage of a third.
        let stress = SymmetricTensor { xx: 2.0 / 3.0, yy: -1.0 / 3.0, zz: -1.0 / 3.0, ..SymmetricTensor::zero() };
        let (mut damage, mut expected) = (1.0 / 3.0, [1.0 / 3.0]);
        for _ in 0..50 {
            damage = evaluated(&[damage], |x| {
                let step = FlowStep {
                    state: FlowState::at_rest(Double::of(300.0)),
                    deviator: SymmetricTensor::from_array(stress.to_array().map(|s| Double::of(1e8 * s))),
                    plastic_strain_increment: Double::of(1e-8),
                    dt: Double::of(1e-9),
                };
                let mut history = [x[0]];
                law.cast().evolve(&step, &mut history);
                history.to_vec()
            })[0];
            let step = FlowStep {
                state: FlowState::at_rest(300.0),
                deviator: stress * 1e8,
                plastic_strain_increment: 1e-8,
                dt: 1e-9,
            };
            law.evolve(&step, &mut expected);
        }
        assert!(expected[0] - 1.0 / 3.0 > 4e-8 && (damage - expected[0]).abs() < 1e-13, "{damage} {expected:?}");
    }

    #[test]
    fn pressure_matches_double_precision() {
        let law = EquationOfState::MieGruneisenHugoniot(MieGruneisenHugoniot::new(&[8930.0, 3940.0, 1.489, 2.02]));
        for (density, energy) in [(8_930.000_2, 0.0), (8_930.000_31, 12.0), (8929.9, -3.0), (12_500.3, 1.3e6)] {
            let found = evaluated(&[density, energy], |x| {
                let state = BoundedPressure::<Double>::new(&law, 385.0, 300.0).at(x[0], x[1]);
                vec![state.pressure, state.sound_speed]
            });
            let expected = BoundedPressure::<f64>::new(&law, 385.0, 300.0).at(density, energy);
            // A pascal where single precision has ten thousand.
            assert!((found[0] - expected.pressure).abs() < 1.0 + 1e-12 * expected.pressure, "{found:?} {expected:?}");
            assert!((found[1] / expected.sound_speed - 1.0).abs() < 1e-12, "{found:?} {expected:?}");
        }
    }
}
