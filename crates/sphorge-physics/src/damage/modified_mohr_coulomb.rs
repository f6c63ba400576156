//! Modified Mohr–Coulomb.

use super::{DamageGrowth, DamageState};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::real::branch;
use crate::{Elementary, Real, Scalar};

/// `dD = deps_p/eps_f` with the failure strain of Bai & Wierzbicki of triaxiality `eta` and normalised Lode angle `theta_n`:
///
/// ```text
/// eps_f = {A/c2 [c3 + sqrt(3)/(2 - sqrt(3)) (1 - c3) (sec(theta_n pi/6) - 1)]
///          [sqrt((1 + c1^2)/3) cos(theta_n pi/6) + c1 (eta + 1/3 sin(theta_n pi/6))]}^(-1/n)
/// ```
///
/// The last bracket times the von Mises stress is the largest of `tau + c1 sigma_n` over all planes, Mohr & Coulomb's, and `c2` is what it reaches
/// at fracture; `A eps_p^n` is the hardening. Where it is not above zero nothing breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModifiedMohrCoulomb<T> {
    /// `A/c2`.
    pub strength: T,
    /// `n`.
    pub exponent: T,
    /// `c1` and `sqrt((1 + c1^2)/3)`.
    pub friction: [T; 2],
    /// `c3`.
    pub shear: T,
}

impl<T: Elementary> ModifiedMohrCoulomb<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> ModifiedMohrCoulomb<U>
    where
        T: Scalar,
    {
        ModifiedMohrCoulomb {
            strength: U::of(self.strength.to_f64()),
            exponent: U::of(self.exponent.to_f64()),
            friction: self.friction.map(|c| U::of(c.to_f64())),
            shear: U::of(self.shear.to_f64()),
        }
    }
}

/// `sqrt(3)/(2 - sqrt(3))`.
const OF_SECANT: f64 = 6.464_101_615_137_754;

impl<T: Elementary> DamageGrowth<T> for ModifiedMohrCoulomb<T> {
    const KEY: &'static str = "modified-mohr-coulomb";
    const NAME: &'static str = "modified Mohr–Coulomb";
    const REFERENCE: &'static str = "Bai & Wierzbicki, Int. J. Fract. 161 (2010) 1";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required("A", "A", PhysicalQuantity::Pressure, Bound::Positive, "strength of hardening, A eps_p^n"),
        Parameter::required("n", "n", PhysicalQuantity::Dimensionless, Bound::Positive, "exponent of hardening"),
        Parameter::required("c1", "c1", PhysicalQuantity::Dimensionless, Bound::NonNegative, "friction"),
        Parameter::required("c2", "c2", PhysicalQuantity::Pressure, Bound::Positive, "shear strength at fracture"),
        Parameter {
            key: "c3",
            symbol: "c3",
            quantity: PhysicalQuantity::Dimensionless,
            bound: Bound::Positive,
            default: Some(1.0),
            meaning: "share of the stress of axial symmetry that is borne in shear",
        },
    ];

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        let [a, n, c1, c2, c3] = [0, 1, 2, 3, 4].map(|k| values[k]);
        Self {
            strength: T::of(a / c2),
            exponent: T::of(n),
            friction: [T::of(c1), T::of(Real::sqrt((1.0 + c1 * c1) / 3.0))],
            shear: T::of(c3),
        }
    }

    #[inline(always)]
    fn growth(&self, state: &DamageState<T>) -> T {
        let ([cosine, sine], [c1, root]) = (state.lode(), self.friction);
        // The cosine is between sqrt(3)/2 and one.
        let secant = T::one() / cosine.max(T::of(0.5));
        let of_lode = self.shear + T::of(OF_SECANT) * (T::one() - self.shear) * (secant - T::one());
        let of_planes = root * cosine + c1 * (state.triaxiality + T::of(1.0 / 3.0) * sine);
        let base = self.strength * of_lode * of_planes;
        branch!(T, T::zero(), base, base.powf(T::one() / self.exponent), T::zero())
    }
}
