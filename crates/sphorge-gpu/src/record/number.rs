//! A number that remembers how it came about.

use super::operation::{Binary, Operation, Statement, Unary, Value};
use super::recorder::{begin, end, with};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use sphorge_physics::real::{Branch, Iteration};
use sphorge_physics::{Elementary, Numbers, Real};

/// A number in single precision of a kernel that is being recorded.
#[derive(Clone, Copy, Debug)]
pub struct Recorded(pub(super) Value);

fn record(operation: Operation) -> Recorded {
    Recorded(with(|recorder| recorder.value(operation)))
}

fn unary(operation: Unary, a: Recorded) -> Recorded {
    record(Operation::Unary(operation, a.0))
}

fn binary(operation: Binary, a: Recorded, b: Recorded) -> Recorded {
    record(Operation::Binary(operation, a.0, b.0))
}

/// The two numbers, if both are known while recording.
fn constants(a: Recorded, b: Recorded) -> Option<(f32, f32)> {
    with(|recorder| recorder.constant(a.0).zip(recorder.constant(b.0)))
}

impl Add for Recorded {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        binary(Binary::Add, self, other)
    }
}

impl Sub for Recorded {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        binary(Binary::Subtract, self, other)
    }
}

impl Mul for Recorded {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        // Laws start powers and scales from one.
        match with(|recorder| (recorder.constant(self.0), recorder.constant(other.0))) {
            (Some(1.0), _) => other,
            (_, Some(1.0)) => self,
            _ => binary(Binary::Multiply, self, other),
        }
    }
}

impl Div for Recorded {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        binary(Binary::Divide, self, other)
    }
}

impl Neg for Recorded {
    type Output = Self;
    fn neg(self) -> Self {
        // No language of GPUs has `--`.
        match with(|recorder| recorder.constant(self.0)) {
            Some(constant) => Self::of(f64::from(-constant)),
            None => unary(Unary::Negate, self),
        }
    }
}

impl AddAssign for Recorded {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Recorded {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Recorded {
    /// The number as it was rounded. Compilers of GPUs take numbers for real ones and find `(a + b) - a` to be `b`; where the difference is what
    /// is asked for, they must not see where a sum comes from.
    #[must_use]
    pub fn rounded(self) -> Self {
        unary(Unary::Rounded, self)
    }
}

impl Real for Recorded {
    fn of(value: f64) -> Self {
        // GPUs need not know infinity: the largest number is as far from every other.
        let value = (value as f32).clamp(-f32::MAX, f32::MAX);
        record(Operation::Constant(value.to_bits()))
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        record(Operation::MultiplyAdd(self.0, a.0, b.0))
    }
    fn sqrt(self) -> Self {
        unary(Unary::SquareRoot, self)
    }
    fn inverse_sqrt(self) -> Self {
        unary(Unary::InverseSquareRoot, self)
    }
    fn min(self, other: Self) -> Self {
        binary(Binary::Minimum, self, other)
    }
    fn max(self, other: Self) -> Self {
        binary(Binary::Maximum, self, other)
    }
    fn abs(self) -> Self {
        unary(Unary::Absolute, self)
    }
    fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        match constants(a, b) {
            Some((a, b)) if a < b => then,
            Some(_) => otherwise,
            None => record(Operation::SelectLess(a.0, b.0, then.0, otherwise.0)),
        }
    }
    fn lane_by_lane(a: Self, b: Self, _f: impl Fn(f64, f64) -> [f64; 2]) -> [Self; 2] {
        with(|recorder| recorder.fault = recorder.fault.or(Some("a law that is asked lane by lane")));
        [a, b]
    }
}

impl Elementary for Recorded {
    type Branch = RecordedBranch;
    type Iteration<S: Numbers<Self>> = RecordedIteration<S>;

    fn ln(self) -> Self {
        unary(Unary::Logarithm, self)
    }
    fn exp(self) -> Self {
        unary(Unary::Exponential, self)
    }
    fn powf(self, exponent: Self) -> Self {
        binary(Binary::Power, self, exponent)
    }
    fn cos(self) -> Self {
        unary(Unary::Cosine, self)
    }
    fn epsilon() -> Self {
        Self::of(f64::from(f32::EPSILON))
    }
    fn largest() -> Self {
        Self::of(f64::from(f32::MAX))
    }
    fn branch(a: Self, b: Self) -> RecordedBranch {
        let known = constants(a, b).map(|(a, b)| a < b);
        RecordedBranch { a, b, known, taken: Vec::new() }
    }
    fn iteration<S: Numbers<Self>>(start: S) -> RecordedIteration<S> {
        let mut state = start;
        let variables = declare(&mut state);
        begin();
        RecordedIteration { state, variables }
    }
}

/// A branch that is being recorded, or one that is known while recording.
pub struct RecordedBranch {
    a: Recorded,
    b: Recorded,
    /// Whether it is taken.
    known: Option<bool>,
    /// What is done where it is taken.
    taken: Vec<Statement>,
}

impl Branch<Recorded> for RecordedBranch {
    fn takes(&mut self) -> bool {
        if self.known.is_none() {
            begin();
        }
        self.known.unwrap_or(true)
    }
    fn passes(&mut self) -> bool {
        if self.known.is_none() {
            self.taken = end();
            begin();
        }
        !self.known.unwrap_or(false)
    }
    fn join<R: Numbers<Recorded>>(self, taken: Option<R>, passed: Option<R>) -> R {
        let Self { a, b, taken: mut then, .. } = self;
        let (mut result, mut other) = match (taken, passed) {
            (Some(result), Some(other)) => (result, other),
            (Some(known), None) | (None, Some(known)) => return known,
            (None, None) => unreachable!("a branch is taken or passed"),
        };
        let mut otherwise = end();
        let others = numbers(&mut other);
        let mut others = others.into_iter();
        let mut changes = Vec::new();
        result.each(&mut |number| {
            // Of the same type, so there are as many.
            let other = others.next().unwrap_or(number.0);
            if other != number.0 {
                let variable = with(|recorder| {
                    let zero = recorder.value(Operation::Constant(0));
                    recorder.declare(zero)
                });
                then.push(Statement::Assign { variable, value: number.0 });
                otherwise.push(Statement::Assign { variable, value: other });
                changes.push(variable);
            }
        });
        with(|recorder| recorder.push(Statement::If { a: a.0, b: b.0, then, otherwise }));
        let others = numbers(&mut other);
        let (mut others, mut changes) = (others.into_iter(), changes.into_iter());
        result.each(&mut |number| {
            let changed = others.next().is_some_and(|other| other != number.0);
            if let Some(variable) = changed.then(|| changes.next()).flatten() {
                *number = Recorded(with(|recorder| recorder.read(variable)));
            }
        });
        result
    }
}

/// An iteration that is being recorded: its step is, once.
pub struct RecordedIteration<S> {
    state: S,
    variables: Vec<u32>,
}

impl<S: Numbers<Recorded>> Iteration<Recorded, S> for RecordedIteration<S> {
    fn state(&mut self) -> S {
        read(&mut self.state, &self.variables);
        self.state
    }
    fn goes_on(&mut self, mut next: S, again: Recorded) -> bool {
        assign(&mut next, &self.variables);
        let body = end();
        with(|recorder| recorder.push(Statement::Loop { body, again: again.0 }));
        false
    }
    fn end(mut self) -> S {
        read(&mut self.state, &self.variables);
        self.state
    }
}

/// The numbers of a state, in order.
fn numbers<S: Numbers<Recorded>>(state: &mut S) -> Vec<Value> {
    let mut values = Vec::new();
    state.each(&mut |number| values.push(number.0));
    values
}

/// A variable for each number of a state, which starts as it.
pub(super) fn declare<S: Numbers<Recorded>>(state: &mut S) -> Vec<u32> {
    let mut variables = Vec::new();
    state.each(&mut |number| variables.push(with(|recorder| recorder.declare(number.0))));
    variables
}

/// Makes the numbers of a state what the variables are now.
pub(super) fn read<S: Numbers<Recorded>>(state: &mut S, variables: &[u32]) {
    let mut variables = variables.iter();
    state.each(&mut |number| {
        if let Some(variable) = variables.next() {
            *number = Recorded(with(|recorder| recorder.read(*variable)));
        }
    });
}

/// Makes the variables what the numbers of a state are.
pub(super) fn assign<S: Numbers<Recorded>>(state: &mut S, variables: &[u32]) {
    let mut variables = variables.iter();
    state.each(&mut |number| {
        if let Some(&variable) = variables.next() {
            with(|recorder| recorder.push(Statement::Assign { variable, value: number.0 }));
        }
    });
}
