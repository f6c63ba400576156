//! What damage depends on.

use crate::flow::FlowStep;
use crate::tensile_part::{largest_principal_value, smallest_principal_value};
use crate::{Elementary, SymmetricTensor};

/// Stress of whole material after a step, and how fast and how warm it flows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DamageState<T> {
    /// Deviatoric stress, Pa.
    pub deviator: SymmetricTensor<T>,
    /// Pressure, Pa.
    pub pressure: T,
    /// Von Mises stress `q`, Pa.
    pub von_mises: T,
    /// Mean stress over von Mises stress, `eta`, positive in tension.
    pub triaxiality: T,
    /// Rate of the equivalent plastic strain, 1/s.
    pub rate: T,
    /// Temperature, K.
    pub temperature: T,
}

/// Von Mises stress below which there is none, Pa: one over it is still a number in single precision.
const NO_STRESS: f64 = 1e-6;

/// Largest triaxiality that counts: exponentials of it stay numbers.
const LARGEST_TRIAXIALITY: f64 = 20.0;

/// Cosine and sine of `theta_n pi/6`, with the normalised Lode angle `theta_n` of a deviator of this von Mises stress.
///
/// With the principal values `s_1 >= s_2 >= s_3` of the deviator and `theta = pi/6 (1 - theta_n)`, `s_k = 2/3 q cos(theta - 2 pi (k - 1)/3)`. So
/// `s_1 - s_3 = 2/sqrt(3) q cos(theta_n pi/6)` and `s_2 = -2/3 q sin(theta_n pi/6)`.
#[inline(always)]
fn lode<T: Elementary>(largest: T, smallest: T, von_mises: T) -> [T; 2] {
    let inverse = T::one() / von_mises.max(T::of(NO_STRESS));
    let cosine = T::of(0.5 * 1.732_050_807_568_877_2) * (largest - smallest) * inverse;
    // The middle one: their sum is zero.
    let sine = T::of(1.5) * (largest + smallest) * inverse;
    [cosine.min(T::one()), sine.max(-T::one()).min(T::one())]
}

/// Normalised Lode angle of a deviator: 1 in tension along one axis, 0 in shear, -1 in compression along one axis, and 0 without stress.
pub fn lode_angle(deviator: SymmetricTensor<f64>) -> f64 {
    let von_mises = deviator.von_mises();
    if von_mises <= NO_STRESS {
        return 0.0;
    }
    let [_, sine] = lode(largest_principal_value(deviator), smallest_principal_value(deviator), von_mises);
    // The arcsine of what is at most a half by Newton's method, which gains a factor of two in digits at a time: `core` has none.
    let sine = sine.clamp(-0.5, 0.5);
    let mut angle = sine * (1.0 + sine * sine / 6.0);
    for _ in 0..4 {
        let [s, c] = sine_and_cosine(angle);
        angle -= (s - sine) / c;
    }
    angle * 6.0 / core::f64::consts::PI
}

/// Of an angle.
fn sine_and_cosine(angle: f64) -> [f64; 2] {
    let cos = |x: f64| Elementary::cos(x);
    [cos(core::f64::consts::FRAC_PI_2 - angle), cos(angle)]
}

impl<T: Elementary> DamageState<T> {
    /// After a step.
    #[inline(always)]
    pub fn after(step: &FlowStep<T>) -> Self {
        let von_mises = step.deviator.von_mises();
        let most = T::of(LARGEST_TRIAXIALITY);
        let triaxiality = -step.state.pressure / von_mises.max(T::of(NO_STRESS));
        Self {
            deviator: step.deviator,
            pressure: step.state.pressure,
            von_mises,
            triaxiality: triaxiality.max(-most).min(most),
            rate: step.state.plastic_strain_rate,
            temperature: step.state.temperature,
        }
    }

    /// Largest principal stress `s_1`, Pa.
    #[inline(always)]
    pub fn largest_stress(&self) -> T {
        largest_principal_value(self.deviator) - self.pressure
    }

    /// `cos(theta_n pi/6)` and `sin(theta_n pi/6)` of the normalised Lode angle `theta_n`: 1 in tension along one axis, 0 in shear, -1 in
    /// compression along one axis.
    #[inline(always)]
    pub fn lode(&self) -> [T; 2] {
        let (largest, smallest) = (largest_principal_value(self.deviator), smallest_principal_value(self.deviator));
        lode(largest, smallest, self.von_mises)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::FlowState;

    fn state(sigma: SymmetricTensor<f64>) -> DamageState<f64> {
        let pressure = -sigma.trace() / 3.0;
        let flow = FlowState { pressure, plastic_strain_rate: 30.0, ..FlowState::at_rest(400.0) };
        DamageState::after(&FlowStep {
            state: flow,
            deviator: sigma.deviator(),
            plastic_strain_increment: 0.0,
            dt: 1.0,
        })
    }

    /// Of 400 MPa along x, and of other principal stresses.
    const AXES: [([f64; 3], f64, f64); 6] = [
        ([4e8, 0.0, 0.0], 1.0 / 3.0, 1.0),
        ([-4e8, 0.0, 0.0], -1.0 / 3.0, -1.0),
        // Equal in two directions: q is that stress, the mean two thirds of it.
        ([4e8, 4e8, 0.0], 2.0 / 3.0, -1.0),
        ([4e8, 0.0, -4e8], 0.0, 0.0),
        // Plane strain, s_2 the mean of the others: q = sqrt(3)/2 (s_1 - s_3), eta = 1/sqrt(3).
        ([4e8, 2e8, 0.0], 0.577_350_269_189_625_8, 0.0),
        // A middle one of a quarter: s = (7, -2, -5)/12, q^2 = 3/2 78/144 = 13/16; sine = -3/2 (-2/12)/q = 0.277350; asin = 0.281035.
        ([4e8, 1e8, 0.0], 0.462_250_163_520_849_5, 0.536_737_7),
    ];

    #[test]
    fn triaxiality_and_lode_angle_of_simple_states() {
        let (s, c) = (0.6, 0.8);
        for (principal, triaxiality, lode) in AXES {
            let axes = SymmetricTensor::diagonal(principal[0], principal[1], principal[2]);
            let turned = axes.congruence(&[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]);
            let again = turned.congruence(&[[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]);
            for sigma in [axes, turned, again] {
                let found = state(sigma);
                assert!((found.triaxiality - triaxiality).abs() < 1e-12, "{principal:?}: {found:?}");
                let [cosine, sine] = found.lode();
                assert!((sine - (lode * core::f64::consts::FRAC_PI_6).sin()).abs() < 1e-6, "{principal:?}: {found:?}");
                assert!((cosine * cosine + sine * sine - 1.0).abs() < 1e-9, "{principal:?}: {found:?}");
                assert!((lode_angle(sigma.deviator()) - lode).abs() < 1e-6, "{principal:?}: {}", lode_angle(sigma));
                let largest = principal.iter().copied().fold(f64::MIN, f64::max);
                assert!((found.largest_stress() - largest).abs() < 1.0, "{principal:?}: {found:?}");
            }
        }
        assert_eq!((state(AXES[0].0.into_iter().fold(SymmetricTensor::zero(), |s, _| s)).rate, 400.0), (30.0, 400.0));
    }

    #[test]
    fn without_shear_stress_all_is_finite() {
        let pulled = state(SymmetricTensor::isotropic(1e9));
        assert_eq!((pulled.triaxiality, pulled.temperature), (20.0, 400.0));
        assert!(pulled.lode().iter().all(|c| c.is_finite()) && lode_angle(SymmetricTensor::zero()) == 0.0);
        assert_eq!(state(SymmetricTensor::isotropic(-1e9)).triaxiality, -20.0);
    }
}
