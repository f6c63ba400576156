//! Equations of state: pressure from density and specific internal energy.
//!
//! Every law here is of the Mie–Grüneisen form `p(rho, e) = f(rho) + Gamma rho e`: a pressure at zero energy `f`, and a
//! constant Grüneisen parameter `Gamma` (zero for a law without energy). A law gives only `f` and its slope; sound speed
//! and the energy of the isotherm follow. A further law is one file and one line of the table at the end.
//!
//! A constant `Gamma` limits the compression a law can be used at: without heat, pressure stops rising at about 1.7 to 2
//! times the reference density (copper 1.72 at zero energy, 1.86 on its isentrope), and a shock cannot exceed `1 + 2/Gamma`.
//!
//! Units: `rho` kg/m^3, `e` J/kg with `e = 0` in the reference state, `p` Pa, positive in compression, `c` m/s.

mod bounded;
mod linear;
mod mie_gruneisen_hugoniot;
mod mie_gruneisen_polynomial;

pub use bounded::BoundedPressure;
pub use linear::Linear;
pub use mie_gruneisen_hugoniot::MieGruneisenHugoniot;
pub use mie_gruneisen_polynomial::MieGruneisenPolynomial;

use crate::parameter::{Bound, LawEntry, Parameter, PhysicalQuantity};
use crate::{Real, Scalar};

/// Pressure and what the time step and the viscosity need beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PressureState<T> {
    /// Pressure, Pa, positive in compression.
    pub pressure: T,
    /// Bulk sound speed at constant entropy, m/s: `c^2 = dp/drho|_e + (p/rho^2) dp/de|_rho`, never below a tenth of the
    /// reference sound speed (far in expansion the formula turns imaginary).
    pub sound_speed: T,
}

/// Pressure at zero specific energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReferenceCurve<T> {
    /// `f(rho)`, Pa.
    pub pressure: T,
    /// `df/drho`, Pa m^3/kg.
    pub slope: T,
}

/// What a law of the form `p = f(rho) + Gamma rho e` has to give.
pub trait PressureLaw<T: Real>: Copy {
    /// Name in a deck.
    const KEY: &'static str;
    /// Name in a text.
    const NAME: &'static str;
    /// Where it is published.
    const REFERENCE: &'static str;
    /// The constants, in the order of `new`; the first is the reference density.
    const PARAMETERS: &'static [Parameter];

    /// From one value per parameter, SI units.
    fn new(values: &[f64]) -> Self;
    /// Pressure at zero energy and its slope.
    fn reference_curve(&self, density: T) -> ReferenceCurve<T>;
    /// `rho_0`, kg/m^3.
    fn reference_density(&self) -> T;
    /// Bulk sound speed at `rho_0`, m/s.
    fn reference_sound_speed(&self) -> T;
    /// `Gamma`.
    fn gruneisen(&self) -> T;
}

/// The constant `rho_0` that every law starts with; a deck takes it from the material.
pub(crate) const REFERENCE_DENSITY: Parameter =
    Parameter::required("density", "rho_0", PhysicalQuantity::Density, Bound::Positive, "density at zero pressure");
/// The constant `c_0`.
pub(crate) const SOUND_SPEED: Parameter = Parameter::required(
    "sound-speed",
    "c_0",
    PhysicalQuantity::Velocity,
    Bound::Positive,
    "bulk sound speed in the reference state",
);
/// The constant `S`.
pub(crate) const SHOCK_SLOPE: Parameter = Parameter::required(
    "shock-slope",
    "S",
    PhysicalQuantity::Dimensionless,
    Bound::NonNegative,
    "slope of shock velocity against particle velocity, Us = c_0 + S Up",
);
/// The constant `Gamma`.
pub(crate) const GRUNEISEN: Parameter = Parameter::required(
    "gruneisen",
    "Gamma",
    PhysicalQuantity::Dimensionless,
    Bound::NonNegative,
    "Grüneisen parameter",
);

/// Smallest square of the sound speed, as a fraction of the square in the reference state.
const SOUND_SPEED_SQUARED_FLOOR: f64 = 0.01;

#[inline(always)]
fn pressure_state<T: Real, L: PressureLaw<T>>(law: &L, density: T, energy: T) -> PressureState<T> {
    let curve = law.reference_curve(density);
    let gamma = law.gruneisen();
    let pressure = curve.pressure + gamma * density * energy;
    let c0 = law.reference_sound_speed();
    let squared = curve.slope + gamma * (energy + pressure / density);
    let sound_speed = squared.max(T::of(SOUND_SPEED_SQUARED_FLOOR) * c0 * c0).sqrt();
    PressureState { pressure, sound_speed }
}

/// Positive nodes and weights of the six-point Gauss–Legendre rule on [-1, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_4),
];

/// `e_s(rho)`, J/kg: energy on the isentrope through the reference state.
///
/// `de/drho = p/rho^2 = f/rho^2 + Gamma e/rho` is linear in `e`; with `x = rho/rho_0`, `u = ln x`,
/// `e_s = x^Gamma / rho_0 int_0^ln(x) f(rho_0 exp u) exp(-(Gamma + 1) u) du`, done with six Gauss points.
#[inline]
fn isentropic_energy<T: Scalar, L: PressureLaw<T>>(law: &L, density: T) -> T {
    let rho_0 = law.reference_density();
    let exponent = law.gruneisen() + T::one();
    let half = T::of(0.5) * (density / rho_0).ln();
    let mut sum = T::zero();
    for k in 0..GAUSS.len() {
        let offset = half * T::of(GAUSS[k].0);
        let (near, far) = (half - offset, half + offset);
        let f_near = law.reference_curve(rho_0 * near.exp()).pressure * (-(exponent * near)).exp();
        let f_far = law.reference_curve(rho_0 * far.exp()).pressure * (-(exponent * far)).exp();
        sum += T::of(GAUSS[k].1) * (f_near + f_far);
    }
    half * sum / rho_0 * (law.gruneisen() * (half + half)).exp()
}

macro_rules! equations_of_state {
    ($($law:ident,)*) => {
        /// The equations of state a material can have.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum EquationOfState<T> {
            $(
                #[doc = concat!("See [`", stringify!($law), "`](struct@", stringify!($law), ").")]
                $law($law<T>),
            )*
        }

        /// Every equation of state, for the deck reader.
        pub const EQUATIONS_OF_STATE: &[LawEntry<EquationOfState<f64>>] = &[
            $(LawEntry {
                key: <$law<f64> as PressureLaw<f64>>::KEY,
                name: <$law<f64> as PressureLaw<f64>>::NAME,
                reference: <$law<f64> as PressureLaw<f64>>::REFERENCE,
                parameters: <$law<f64> as PressureLaw<f64>>::PARAMETERS,
                check: |_| None,
                build: |values| EquationOfState::$law(<$law<f64> as PressureLaw<f64>>::new(values)),
            },)*
        ];

        impl<T: Real> EquationOfState<T> {
            /// Pressure and sound speed at a density (kg/m^3) and specific internal energy (J/kg).
            #[inline(always)]
            pub fn pressure(&self, density: T, energy: T) -> PressureState<T> {
                match self { $(Self::$law(law) => pressure_state(law, density, energy),)* }
            }

            /// `rho_0`, kg/m^3: the density of zero pressure at zero energy.
            #[inline(always)]
            pub fn reference_density(&self) -> T {
                match self { $(Self::$law(law) => law.reference_density(),)* }
            }

            /// Bulk sound speed in the reference state, m/s; the bulk modulus there is `rho_0 c_0^2`.
            #[inline(always)]
            pub fn reference_sound_speed(&self) -> T {
                match self { $(Self::$law(law) => law.reference_sound_speed(),)* }
            }

            /// Grüneisen parameter `Gamma = (1/rho) dp/de|_rho`, zero where pressure does not depend on energy.
            #[inline(always)]
            pub fn gruneisen(&self) -> T {
                match self { $(Self::$law(law) => law.gruneisen(),)* }
            }

            /// Name in a deck.
            pub fn key(&self) -> &'static str {
                match self { $(Self::$law(_) => <$law<T> as PressureLaw<T>>::KEY,)* }
            }

            /// The constants of this law.
            pub fn parameters(&self) -> &'static [Parameter] {
                match self { $(Self::$law(_) => <$law<T> as PressureLaw<T>>::PARAMETERS,)* }
            }
        }

        impl<T: Scalar> EquationOfState<T> {
            /// Specific energy on the isentrope through the reference state, J/kg: `de/drho = p(rho, e)/rho^2`, `e(rho_0) = 0`.
            #[inline]
            pub fn isentropic_energy(&self, density: T) -> T {
                match self { $(Self::$law(law) => isentropic_energy(law, density),)* }
            }

            /// The same law in another precision, or with every constant in all lanes of a SIMD vector.
            #[inline(always)]
            pub fn cast<U: Real>(&self) -> EquationOfState<U> {
                match self { $(Self::$law(law) => EquationOfState::$law(law.cast()),)* }
            }
        }
    };
}

equations_of_state! {
    Linear,
    MieGruneisenPolynomial,
    MieGruneisenHugoniot,
}

impl<T: Scalar> EquationOfState<T> {
    /// Specific energy on the isotherm of the reference temperature, J/kg, zero at `rho_0`, so that
    /// `T = T_0 + (e - e_cold) / c_p`.
    ///
    /// Along an isotherm `de/drho = p(rho, e)/rho^2 - T_0 Gamma c_p / rho`, whose solution is
    /// `e_cold = e_s(rho) - c_p T_0 [(rho/rho_0)^Gamma - 1]` with the isentrope `e_s`: compression at constant entropy
    /// heats to `T = T_0 (rho/rho_0)^Gamma`, as a constant Grüneisen parameter demands.
    #[inline]
    pub fn cold_energy(&self, density: T, reference_temperature: T, specific_heat: T) -> T {
        let ratio = density / self.reference_density();
        let heating = ratio.powf(self.gruneisen()) - T::one();
        self.isentropic_energy(density) - specific_heat * reference_temperature * heating
    }
}

#[cfg(test)]
mod tests;
