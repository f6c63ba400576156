//! Equations of state: pressure from density and specific internal energy.
//!
//! A law gives pressure, sound speed and Grüneisen parameter ([`PressureLaw`]); the energy of the isotherm follows. One of the
//! form `p(rho, e) = f(rho) + Gamma rho e` gives only `f`, its slope and `Gamma` ([`GruneisenForm`]). A further law is one file
//! and one line of the table at the end.
//!
//! Units: `rho` kg/m^3, `e` J/kg with `e = 0` in the reference state, `p` Pa, positive in compression, `c` m/s.

mod bounded;
mod gruneisen_form;
mod isotherm;
mod linear;
mod mie_gruneisen_hugoniot;
mod mie_gruneisen_polynomial;

pub use bounded::{BoundedPressure, ColdEnergy};
pub use gruneisen_form::{GruneisenForm, ReferenceCurve};
pub use linear::Linear;
pub use mie_gruneisen_hugoniot::MieGruneisenHugoniot;
pub use mie_gruneisen_polynomial::MieGruneisenPolynomial;

use crate::parameter::{Bound, LawEntry, Parameter, PhysicalQuantity};
use crate::{Elementary, Real, Scalar};

/// Pressure and what the time step and the viscosity need beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PressureState<T> {
    /// Pressure, Pa, positive in compression.
    pub pressure: T,
    /// Bulk sound speed at constant entropy, m/s: `c^2 = dp/drho|_e + (p/rho^2) dp/de|_rho`, never below a tenth of the
    /// reference sound speed (far in expansion the formula turns imaginary).
    pub sound_speed: T,
}

impl<T: Real> PressureState<T> {
    /// Of a pressure and the square of the sound speed by its formula, m^2/s^2; `reference_sound_speed` gives the floor.
    #[inline(always)]
    pub fn new(pressure: T, sound_speed_squared: T, reference_sound_speed: T) -> Self {
        let c0 = reference_sound_speed;
        let sound_speed = sound_speed_squared.max(T::of(SOUND_SPEED_SQUARED_FLOOR) * c0 * c0).sqrt();
        Self { pressure, sound_speed }
    }

    /// Of a law that needs more than the arithmetic of lanes, such as a table or an exponential: `state` is asked for one density
    /// and energy after the other. It must bear any: lanes without a particle hold what they happen to, NaN among it.
    #[inline(always)]
    pub fn lane_by_lane(density: T, energy: T, state: impl Fn(f64, f64) -> PressureState<f64>) -> Self {
        let [pressure, sound_speed] = T::lane_by_lane(density, energy, |density, energy| {
            let state = state(density, energy);
            [state.pressure, state.sound_speed]
        });
        Self { pressure, sound_speed }
    }
}

/// Name, constants and reference state of an equation of state.
pub trait EquationConstants: Copy {
    /// What the constants are held in.
    type Number: Real;

    /// Name in a deck.
    const KEY: &'static str;
    /// Name in a text.
    const NAME: &'static str;
    /// Where it is published.
    const REFERENCE: &'static str;
    /// The constants, in the order of `new`; the first is the reference density.
    const PARAMETERS: &'static [Parameter];

    /// What is wrong with constants that do not fit together, or `None`.
    fn check(values: &[f64]) -> Option<&'static str> {
        let _ = values;
        None
    }
    /// From one value per parameter, SI units.
    fn new(values: &[f64]) -> Self;
    /// `rho_0`, kg/m^3: the density of zero pressure at zero energy.
    fn reference_density(&self) -> Self::Number;
    /// Bulk sound speed in the reference state, m/s; the bulk modulus there is `rho_0 c_0^2`.
    fn reference_sound_speed(&self) -> Self::Number;

    /// Slope `S` of `Us = c_0 + S Up`, where the law is made of one: no shock reaches a compression `1 - rho_0/rho` of `1/S`.
    fn shock_slope(&self) -> Option<Self::Number> {
        None
    }
}

/// What an equation of state has to give.
pub trait PressureLaw: EquationConstants {
    /// Pressure and sound speed at a density (kg/m^3) and specific internal energy (J/kg), on lanes: branches are taken by
    /// [`Real::select_lt`], or the law is asked by [`PressureState::lane_by_lane`].
    fn pressure(&self, density: Self::Number, energy: Self::Number) -> PressureState<Self::Number>;

    /// Grüneisen parameter `Gamma = (1/rho) dp/de|_rho` in a state, zero where pressure does not depend on energy.
    fn gruneisen(&self, density: Self::Number, energy: Self::Number) -> Self::Number;

    /// Specific energy on the isentrope through the reference state, J/kg: `de/drho = p(rho, e)/rho^2`, `e(rho_0) = 0`.
    #[inline(always)]
    fn isentropic_energy(&self, density: Self::Number) -> Self::Number
    where
        Self::Number: Elementary,
    {
        isotherm::energy(self, density, Self::Number::zero())
    }

    /// Specific energy on the isotherm of the reference temperature (K), J/kg, zero at `rho_0`, so that
    /// `T = T_0 + (e - e_cold) / c_p`: `de/drho = p(rho, e)/rho^2 - T_0 Gamma c_p/rho`.
    #[inline(always)]
    fn cold_energy(
        &self,
        density: Self::Number,
        reference_temperature: Self::Number,
        specific_heat: Self::Number,
    ) -> Self::Number
    where
        Self::Number: Elementary,
    {
        isotherm::energy(self, density, specific_heat * reference_temperature)
    }
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
                key: <$law<f64> as EquationConstants>::KEY,
                name: <$law<f64> as EquationConstants>::NAME,
                reference: <$law<f64> as EquationConstants>::REFERENCE,
                parameters: <$law<f64> as EquationConstants>::PARAMETERS,
                history: &[],
                check: <$law<f64> as EquationConstants>::check,
                build: |values| EquationOfState::$law(<$law<f64> as EquationConstants>::new(values)),
            },)*
        ];

        impl<T: Real> EquationOfState<T> {
            /// Pressure and sound speed at a density (kg/m^3) and specific internal energy (J/kg).
            #[inline(always)]
            pub fn pressure(&self, density: T, energy: T) -> PressureState<T> {
                match self { $(Self::$law(law) => law.pressure(density, energy),)* }
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

            /// Slope `S` of `Us = c_0 + S Up`, where the law is made of one: no shock reaches a compression `1 - rho_0/rho` of `1/S`.
            pub fn shock_slope(&self) -> Option<T> {
                match self { $(Self::$law(law) => law.shock_slope(),)* }
            }

            /// Grüneisen parameter `Gamma = (1/rho) dp/de|_rho` in a state, zero where pressure does not depend on energy.
            #[inline(always)]
            pub fn gruneisen(&self, density: T, energy: T) -> T {
                match self { $(Self::$law(law) => law.gruneisen(density, energy),)* }
            }

            /// Name in a deck.
            pub fn key(&self) -> &'static str {
                match self { $(Self::$law(_) => <$law<T> as EquationConstants>::KEY,)* }
            }

            /// The constants of this law.
            pub fn parameters(&self) -> &'static [Parameter] {
                match self { $(Self::$law(_) => <$law<T> as EquationConstants>::PARAMETERS,)* }
            }
        }

        impl<T: Elementary> EquationOfState<T> {
            /// Specific energy on the isentrope through the reference state, J/kg: `de/drho = p(rho, e)/rho^2`, `e(rho_0) = 0`.
            #[inline(always)]
            pub fn isentropic_energy(&self, density: T) -> T {
                match self { $(Self::$law(law) => law.isentropic_energy(density),)* }
            }

            /// Specific energy on the isotherm of the reference temperature (K), J/kg, zero at `rho_0`, so that
            /// `T = T_0 + (e - e_cold) / c_p`.
            #[inline(always)]
            pub fn cold_energy(&self, density: T, reference_temperature: T, specific_heat: T) -> T {
                match self { $(Self::$law(law) => law.cold_energy(density, reference_temperature, specific_heat),)* }
            }
        }

        impl<T: Scalar> EquationOfState<T> {
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

#[cfg(test)]
mod tests;
