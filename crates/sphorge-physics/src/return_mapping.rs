//! Return of a trial stress to the yield surface: the one return mapping of all flow laws.
//!
//! With the trial deviator `S_trial` and its von Mises equivalent `sigma_trial = sqrt(3/2 S:S)` (Fraser Eq 11; Patiño et
//! al. Eq 29), the plastic strain increment `d` of a step `dt` solves
//!
//! `sigma_trial - 3 G d - sigma(Y) = 0`,   `Y = Y(eps_p + d, d/dt, T, p, rho/rho_0)`,
//!
//! implicit in both the hardening and the rate, and `S = (sigma/sigma_trial) S_trial`. Radial return (Wilkins 1964; Simo
//! & Hughes, *Computational Inelasticity*, chapter 3) has `sigma = Y`. Fraser Eq 12 is its solution for linear hardening;
//! Fraser Eq 14 prints `S^n` on the right where the trial deviator belongs. Patiño et al. Eq 28 (after Benz & Asphaug
//! 1995) scales by `f = Y^2/sigma_trial^2` instead, so `sigma = Y^2/sigma_trial`: stress falls below the yield surface,
//! the more so the larger the step. It stays an option, solved by the same equation.
//!
//! Units: stress Pa, time s, temperature K, work J/m^3.

use crate::flow::{FlowLaw, FlowState, FlowStep, YieldStress};
use crate::real::{branch, iterate};
use crate::{Elementary, Numbers, Real, SymmetricTensor};

/// How a stress beyond yield is brought back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ReturnRule {
    /// To the yield surface, `S = (Y/sigma_trial) S_trial`.
    #[default]
    RadialReturn,
    /// By the printed factor of Patiño et al. Eq 28, `S = (Y/sigma_trial)^2 S_trial`.
    BenzAsphaug,
}

impl ReturnRule {
    /// Every rule.
    pub const ALL: &'static [Self] = &[Self::RadialReturn, Self::BenzAsphaug];

    /// Name in a deck.
    pub const fn key(self) -> &'static str {
        match self {
            Self::RadialReturn => "radial-return",
            Self::BenzAsphaug => "benz-asphaug",
        }
    }

    /// The rule of that name in a deck.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|rule| rule.key() == key)
    }
}

/// Stress and plastic strain after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Returned<T> {
    /// Deviatoric stress, Pa.
    pub deviator: SymmetricTensor<T>,
    /// Increment of the equivalent plastic strain, never negative.
    pub plastic_strain_increment: T,
    /// Yield stress at the end of the step, Pa; infinite for a law that never yields.
    pub yield_stress: T,
    /// Plastic work per volume, J/m^3: equivalent stress at the end times the increment.
    pub plastic_work: T,
    /// Iterations spent; zero in an elastic step.
    pub iterations: T,
}

impl<T: Real> Numbers<T> for Returned<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        let Self { deviator, plastic_strain_increment, yield_stress, plastic_work, iterations } = self;
        deviator.each(visit);
        [plastic_strain_increment, yield_stress, plastic_work, iterations].into_iter().for_each(visit);
    }
    #[inline(always)]
    fn choose_lt(a: T, b: T, then: Self, otherwise: Self) -> Self {
        Self {
            deviator: Numbers::choose_lt(a, b, then.deviator, otherwise.deviator),
            plastic_strain_increment: T::select_lt(
                a,
                b,
                then.plastic_strain_increment,
                otherwise.plastic_strain_increment,
            ),
            yield_stress: T::select_lt(a, b, then.yield_stress, otherwise.yield_stress),
            plastic_work: T::select_lt(a, b, then.plastic_work, otherwise.plastic_work),
            iterations: T::select_lt(a, b, then.iterations, otherwise.iterations),
        }
    }
}

impl<T: Elementary> Returned<T> {
    /// The step a flow law takes its history through: `start` is the state the return began from, `dt` its length (s; at zero
    /// the rate counts as zero).
    #[inline(always)]
    pub fn step(&self, start: FlowState<T>, dt: T) -> FlowStep<T> {
        let increment = self.plastic_strain_increment;
        let rate = T::select_lt(T::zero(), dt, increment / dt, T::zero());
        FlowStep {
            state: FlowState { plastic_strain: start.plastic_strain + increment, plastic_strain_rate: rate, ..start },
            deviator: self.deviator,
            plastic_strain_increment: increment,
            dt,
        }
    }
}

/// Iterations after which the bracket is accepted as it is; bisection alone would need about as many.
const MAXIMUM_ITERATIONS: f64 = 60.0;

/// Residual, relative to the trial stress, that counts as none; in single precision a few units of round-off.
const RESIDUAL: f64 = 1e-12;

/// Residual, relative to the trial stress, so small that Newton's method converges from either side.
const NEARLY: f64 = 1e-6;

/// Newton step, relative to the increment, whose square is beyond double precision.
const SMALL_STEP: f64 = 1e-7;

/// Equivalent stress that a yield stress asks for, and its derivative with respect to the increment.
#[inline(always)]
fn target<T: Elementary>(rule: ReturnRule, y: YieldStress<T>, inverse_dt: T, sigma_trial: T) -> (T, T) {
    let slope = y.by_strain + y.by_rate * inverse_dt;
    let mut stress = y.value;
    let mut stress_slope = slope;
    if rule == ReturnRule::BenzAsphaug {
        let ratio = y.value / sigma_trial;
        stress = y.value * ratio;
        stress_slope = T::of(2.0) * ratio * slope;
    }
    (stress, stress_slope)
}

/// Brings a trial deviator back to the yield surface of a law.
///
/// `shear_modulus` is `G` (Pa) of the elastic step that gave the trial, `state` has the plastic strain at the start of the step,
/// whatever its rate; temperature, pressure and compression are held over the step, and so is the `history` of the law, one value
/// per variable. `dt` is the length of the step (s; at zero the rate counts as zero). The result depends on nothing else: calling
/// it for a predictor commits nothing. A law without strength gives a zero deviator; zero yield stress (melt) is returned to
/// exactly zero; stress never ends above yield but by round-off; a stress on the yield surface of a law without rate stays where
/// it is.
#[inline(always)]
pub fn return_mapping<T: Elementary>(
    rule: ReturnRule,
    law: &FlowLaw<T>,
    shear_modulus: T,
    trial: SymmetricTensor<T>,
    state: FlowState<T>,
    history: &[T],
    dt: T,
) -> Returned<T> {
    return_mapping_near(rule, law, shear_modulus, trial, state, history, dt, T::zero())
}

/// The same, searched from `guess`, such as the plastic strain increment of the step before: any value gives the same result to
/// round-off, a near one sooner.
#[inline(always)]
pub fn return_mapping_near<T: Elementary>(
    rule: ReturnRule,
    law: &FlowLaw<T>,
    shear_modulus: T,
    trial: SymmetricTensor<T>,
    state: FlowState<T>,
    history: &[T],
    dt: T,
    guess: T,
) -> Returned<T> {
    debug_assert_eq!(history.len(), law.history().len());
    let zero = T::zero();
    let law = &law.held(state);
    let start = law.yield_stress(FlowState { plastic_strain_rate: zero, ..state }, history);
    let mut returned = Returned {
        deviator: trial,
        plastic_strain_increment: zero,
        yield_stress: start.value,
        plastic_work: zero,
        iterations: zero,
    };
    if !law.has_shear() {
        returned.deviator = SymmetricTensor::zero();
    }
    if law.yields() {
        let sigma_trial = equivalent_stress(trial);
        // A few units of round-off, so that a stress just returned counts as elastic.
        let elastic = start.value * (T::one() + T::of(8.0) * T::epsilon());
        returned = branch!(
            T,
            elastic,
            sigma_trial,
            plastic_return(rule, law, shear_modulus, trial, sigma_trial, start, state, history, dt, guess),
            returned
        );
    }
    returned
}

/// How far a trial deviator stays below the `yield_stress` (Pa) that [`return_mapping`] gave in the step before, where that step
/// was elastic, the temperature is the same and the law does not [change without flow](FlowLaw::changes_without_flow):
/// `Y^2 - 3/2 S:S`, Pa^2. Where it is positive, the step is elastic too: the law need not be asked, stress is the trial, yield
/// stress the same, and nothing flows. Never positive where a melt has no strength.
#[inline(always)]
pub fn elastic_margin<T: Real>(trial: SymmetricTensor<T>, yield_stress: T) -> T {
    yield_stress * yield_stress - T::of(1.5) * trial.double_dot(trial)
}

/// Von Mises equivalent of a deviator, without overflow of the squares in single precision.
#[inline(always)]
fn equivalent_stress<T: Elementary>(deviator: SymmetricTensor<T>) -> T {
    let stress = deviator.von_mises();
    branch!(T, stress, T::largest(), stress, {
        let c = deviator.to_array();
        let mut largest = c[0].abs();
        for k in 1..6 {
            largest = largest.max(c[k].abs());
        }
        (deviator * (T::one() / largest)).von_mises() * largest
    })
}

/// Where the increment is known to be, and what was found there.
#[derive(Clone, Copy)]
struct Bracket<T> {
    low: T,
    high: T,
    increment: T,
    y: YieldStress<T>,
    /// Equivalent stress that the yield stress asks for, Pa.
    stress: T,
    iterations: T,
}

impl<T: Real> Numbers<T> for Bracket<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        let Self { low, high, increment, y, stress, iterations } = self;
        y.each(visit);
        [low, high, increment, stress, iterations].into_iter().for_each(visit);
    }
    #[inline(always)]
    fn choose_lt(a: T, b: T, then: Self, otherwise: Self) -> Self {
        Self {
            low: T::select_lt(a, b, then.low, otherwise.low),
            high: T::select_lt(a, b, then.high, otherwise.high),
            increment: T::select_lt(a, b, then.increment, otherwise.increment),
            y: Numbers::choose_lt(a, b, then.y, otherwise.y),
            stress: T::select_lt(a, b, then.stress, otherwise.stress),
            iterations: T::select_lt(a, b, then.iterations, otherwise.iterations),
        }
    }
}

#[inline(always)]
fn plastic_return<T: Elementary>(
    rule: ReturnRule,
    law: &FlowLaw<T>,
    shear_modulus: T,
    trial: SymmetricTensor<T>,
    sigma_trial: T,
    start: YieldStress<T>,
    state: FlowState<T>,
    history: &[T],
    dt: T,
    guess: T,
) -> Returned<T> {
    let (zero, one) = (T::zero(), T::one());
    let three_g = (T::of(3.0) * shear_modulus).max(zero);
    let inverse_dt = T::select_lt(zero, dt, one / dt, zero);
    let tolerance = T::of(RESIDUAL).max(T::of(4.0) * T::epsilon()) * sigma_trial;

    // The residual falls with the increment: positive at zero, negative where all of the trial stress has relaxed.
    let high = T::select_lt(zero, three_g, sigma_trial / three_g, zero);
    // Without hardening this is the answer; with it, the answer is smaller, and Newton's method comes from above,
    // where slopes are finite even if they are not at zero strain.
    let perfect = (sigma_trial - target(rule, start, zero, sigma_trial).0) / three_g;
    let guess = T::select_lt(guess, perfect, guess, perfect);
    let guess = T::select_lt(zero, guess, guess, perfect);
    let increment = T::select_lt(zero, three_g, guess, zero);

    let first = Bracket { low: zero, high, increment, y: start, stress: start.value, iterations: zero };
    let Bracket { increment, y, stress, iterations, .. } = iterate!(T, first, |bracket| {
        let Bracket { low, high, increment, .. } = bracket;
        let iterations = bracket.iterations + one;
        let there = FlowState {
            plastic_strain: state.plastic_strain + increment,
            plastic_strain_rate: increment * inverse_dt,
            ..state
        };
        let y = law.yield_stress(there, history);
        let (wanted, slope) = target(rule, y, inverse_dt, sigma_trial);
        let residual = sigma_trial - three_g * increment - wanted;
        let (low, high) = (T::select_lt(zero, residual, increment, low), T::select_lt(zero, residual, high, increment));
        // The residual falls, and a logarithm of the rate makes it convex: from the left Newton's method does not overshoot. On the
        // right the increment that the yield stress just found would leave is a bound from the left, for yield stress grows with
        // the increment; where that is none, the increment is far smaller.
        let newton = increment + residual / (three_g + slope);
        let left = (sigma_trial - wanted) / three_g;
        let left = T::select_lt(low, left, left, T::of(0.1) * increment);
        let next = T::select_lt(residual, -(T::of(NEARLY) * sigma_trial), left, newton);
        let middle = T::of(0.5) * (low + high);
        let next = T::select_lt(low, next, T::select_lt(next, high, next, middle), middle);

        let step = next - increment;
        let moved = T::select_lt(zero, step.abs(), one, zero);
        let more = T::select_lt(tolerance, residual.abs(), moved, zero);
        let more = T::select_lt(iterations, T::of(MAXIMUM_ITERATIONS), more, zero);
        // Newton's method squares the error: after a step this small another evaluation would change the last digit.
        let small = T::of(SMALL_STEP) * next;
        let again = T::select_lt(small, step.abs(), more, zero);
        // The last step is taken along the slopes.
        let last = (more - again) * step;
        let y = YieldStress { value: y.value + (y.by_strain + y.by_rate * inverse_dt) * last, ..y };
        let increment = T::select_lt(zero, more, next, increment);
        (Bracket { low, high, increment, y, stress: wanted + slope * last, iterations }, again)
    });

    let scale = (stress / sigma_trial).min(T::one());
    Returned {
        deviator: trial * scale,
        plastic_strain_increment: increment,
        yield_stress: y.value,
        plastic_work: sigma_trial * scale * increment,
        iterations,
    }
}

#[cfg(test)]
mod tests;
