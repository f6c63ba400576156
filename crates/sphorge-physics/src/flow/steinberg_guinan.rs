//! Steinberg–Guinan.

use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `Y = min(Y_0 [1 + beta (eps_p + eps_i)]^n, Y_max) G/G_0` with the shear modulus of pressure `p`, compression
/// `x = rho/rho_0` and temperature, `G = G_0 [1 + A p/x^(1/3) - B (T - T_0)]`
/// (Steinberg, Cochran & Guinan 1980; `A` and `B` are their `G'_p/G_0` and `-G'_T/G_0`, `T_0` is 300 K).
///
/// At and above the melting temperature of the modified Lindemann law of the same paper,
/// `T_m = T_m0 exp[2 a (1 - 1/x)] x^(2 (gamma_0 - a - 1/3))`, both are zero. So they are where tension or heat would turn the bracket
/// negative. The rate has no effect: the law is meant for 1e5 1/s and more, where it saturates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteinbergGuinan<T> {
    /// `Y_0`, Pa.
    pub yield_stress: T,
    /// `Y_max`, Pa.
    pub largest_yield_stress: T,
    /// `beta`.
    pub hardening: T,
    /// `n`.
    pub exponent: T,
    /// `A`, 1/Pa.
    pub by_pressure: T,
    /// `B`, 1/K.
    pub by_temperature: T,
    /// `T_0`, K.
    pub reference_temperature: T,
    /// `T_m0`, K.
    pub melting_temperature: T,
    /// `gamma_0`.
    pub gruneisen: T,
    /// `a`.
    pub gruneisen_correction: T,
    /// `eps_i`.
    pub initial_strain: T,
}

/// Smallest compression the formulas see: far below any a metal is found at.
const LEAST_COMPRESSION: f64 = 1e-3;

impl<T: Elementary> SteinbergGuinan<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> SteinbergGuinan<U>
    where
        T: Scalar,
    {
        SteinbergGuinan {
            yield_stress: U::of(self.yield_stress.to_f64()),
            largest_yield_stress: U::of(self.largest_yield_stress.to_f64()),
            hardening: U::of(self.hardening.to_f64()),
            exponent: U::of(self.exponent.to_f64()),
            by_pressure: U::of(self.by_pressure.to_f64()),
            by_temperature: U::of(self.by_temperature.to_f64()),
            reference_temperature: U::of(self.reference_temperature.to_f64()),
            melting_temperature: U::of(self.melting_temperature.to_f64()),
            gruneisen: U::of(self.gruneisen.to_f64()),
            gruneisen_correction: U::of(self.gruneisen_correction.to_f64()),
            initial_strain: U::of(self.initial_strain.to_f64()),
        }
    }

    /// `G/G_0`, zero in a melt.
    #[inline(always)]
    fn relative_shear_modulus(&self, state: FlowState<T>) -> T {
        let compression = state.compression.max(T::of(LEAST_COMPRESSION));
        let logarithm = compression.ln();
        let third = T::of(1.0 / 3.0);
        let cubic_root = (third * logarithm).exp();
        let heat = self.by_temperature * (state.temperature - self.reference_temperature);
        let relative = T::one() + self.by_pressure * state.pressure / cubic_root - heat;
        let (two, a) = (T::of(2.0), self.gruneisen_correction);
        let exponent = two * a * (T::one() - T::one() / compression) + two * (self.gruneisen - a - third) * logarithm;
        let melting_temperature = self.melting_temperature * exponent.exp();
        T::select_lt(state.temperature, melting_temperature, relative.max(T::zero()), T::zero())
    }
}

impl<T: Elementary> YieldLaw<T> for SteinbergGuinan<T> {
    const KEY: &'static str = "steinberg-guinan";
    const NAME: &'static str = "Steinberg–Guinan";
    const REFERENCE: &'static str = "Steinberg, Cochran & Guinan, Journal of Applied Physics 51 (1980) 1498";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "yield-stress",
            "Y_0",
            PhysicalQuantity::Pressure,
            Bound::NonNegative,
            "yield stress at zero plastic strain and pressure and at the reference temperature",
        ),
        Parameter::required(
            "largest-yield-stress",
            "Y_max",
            PhysicalQuantity::Pressure,
            Bound::NonNegative,
            "yield stress at which hardening ends, at zero pressure and at the reference temperature",
        ),
        Parameter::required("beta", "beta", PhysicalQuantity::Dimensionless, Bound::NonNegative, "factor of hardening"),
        Parameter::required("n", "n", PhysicalQuantity::Dimensionless, Bound::Positive, "exponent of hardening"),
        Parameter::required(
            "A",
            "A",
            PhysicalQuantity::Unit("1/Pa"),
            Bound::NonNegative,
            "relative increase of the shear modulus with pressure",
        ),
        Parameter::required(
            "B",
            "B",
            PhysicalQuantity::Unit("1/K"),
            Bound::NonNegative,
            "relative decrease of the shear modulus with temperature",
        ),
        Parameter::required(
            "reference-temperature",
            "T_0",
            PhysicalQuantity::Temperature,
            Bound::NonNegative,
            "temperature at which the shear modulus has the value of the material",
        ),
        Parameter::required(
            "melting-temperature",
            "T_m0",
            PhysicalQuantity::Temperature,
            Bound::Positive,
            "melting temperature at the density at rest",
        ),
        Parameter::required(
            "gruneisen",
            "gamma_0",
            PhysicalQuantity::Dimensionless,
            Bound::NonNegative,
            "Grüneisen parameter at rest, in the melting law",
        ),
        Parameter::required(
            "a",
            "a",
            PhysicalQuantity::Dimensionless,
            Bound::NonNegative,
            "correction of the Grüneisen parameter with volume, in the melting law",
        ),
        Parameter {
            key: "initial-plastic-strain",
            symbol: "eps_i",
            quantity: PhysicalQuantity::Dimensionless,
            bound: Bound::NonNegative,
            default: Some(0.0),
            meaning: "plastic strain of previous hardening",
        },
    ];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = true;
    const SHEAR_MODULUS_VARIES: bool = true;
    const CHANGES_WITHOUT_FLOW: bool = true;
    const DEPENDS_ON_TEMPERATURE: bool = true;

    fn check(values: &[f64]) -> Option<&'static str> {
        if values[1] < values[0] {
            return Some("largest-yield-stress must not be below yield-stress");
        }
        (values[7] <= values[6]).then_some("melting-temperature must be above reference-temperature")
    }

    fn new(values: &[f64]) -> Self {
        Self {
            yield_stress: T::of(values[0]),
            largest_yield_stress: T::of(values[1]),
            hardening: T::of(values[2]),
            exponent: T::of(values[3]),
            by_pressure: T::of(values[4]),
            by_temperature: T::of(values[5]),
            reference_temperature: T::of(values[6]),
            melting_temperature: T::of(values[7]),
            gruneisen: T::of(values[8]),
            gruneisen_correction: T::of(values[9]),
            initial_strain: T::of(values[10]),
        }
    }

    #[inline(always)]
    fn yield_stress(&self, state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        let relative = self.relative_shear_modulus(state);
        let strain = state.plastic_strain.max(T::zero()) + self.initial_strain;
        let base = T::one() + self.hardening * strain;
        let hardened = self.yield_stress * base.powf(self.exponent);
        let slope = hardened * self.exponent * self.hardening / base * relative;
        let largest = self.largest_yield_stress;
        YieldStress {
            value: T::select_lt(hardened, largest, hardened, largest) * relative,
            by_strain: T::select_lt(hardened, largest, slope, T::zero()),
            by_rate: T::zero(),
        }
    }

    #[inline(always)]
    fn shear_modulus(&self, at_rest: T, state: FlowState<T>) -> T {
        at_rest * self.relative_shear_modulus(state)
    }

    fn melting_temperature(&self) -> Option<T> {
        Some(self.melting_temperature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SymmetricTensor;
    use crate::flow::FlowLaw;
    use crate::flow::tests::{assert_slopes, close, state};
    use crate::return_mapping::{ReturnRule, return_mapping};

    /// OFHC copper, half hard (Steinberg 1996), and an aluminium strained before.
    const COPPER: [f64; 11] = [120.0e6, 640.0e6, 36.0, 0.45, 2.83e-11, 3.77e-4, 300.0, 1790.0, 2.02, 1.5, 0.0];
    const ALUMINIUM: [f64; 11] = [40.0e6, 480.0e6, 400.0, 0.27, 6.52e-11, 6.16e-4, 293.0, 1220.0, 1.97, 1.4, 0.001];

    fn law(values: &[f64]) -> SteinbergGuinan<f64> {
        SteinbergGuinan::new(values)
    }

    fn pressed(strain: f64, temperature: f64, pressure: f64, compression: f64) -> FlowState<f64> {
        FlowState { pressure, compression, ..state(strain, 1e6, temperature) }
    }

    #[test]
    fn by_hand() {
        // Copper, 0.1, 500 K, 10 GPa, 1.06: (1 + 3.6)^0.45 = exp(0.686726) = 1.987197, 238.4637 MPa; 1.06^(1/3) = 1.019613;
        // G/G_0 = 1 + 0.283/1.019613 - 0.0754 = 1.202156.
        let copper = law(&COPPER);
        let warm = pressed(0.1, 500.0, 10.0e9, 1.06);
        close(copper.yield_stress(warm, &[]).value, 286.6706e6, 1e-6);
        close(copper.shear_modulus(47.7e9, warm), 47.7e9 * 1.202_156, 1e-6);
        // 2.0, 1500 K, 40 GPa, 1.2: 120 73^0.45 = 827 MPa is beyond 640 MPa; 1.2^(1/3) = 1.062659;
        // 1 + 1.132/1.062659 - 0.4524 = 1.612852.
        let pressed_hard = pressed(2.0, 1500.0, 40.0e9, 1.2);
        close(copper.yield_stress(pressed_hard, &[]).value, 640.0e6 * 1.612_852, 1e-6);
        assert_eq!(copper.yield_stress(pressed_hard, &[]).by_strain, 0.0);
        // Aluminium in tension, 0.01, 350 K, -2 GPa, 0.98: (1 + 400 0.011)^0.27 = exp(0.455327) = 1.576690, 63.06760 MPa;
        // 0.98^(1/3) = 0.993288; 1 - 0.1304/0.993288 - 0.035112 = 0.833607.
        let aluminium = law(&ALUMINIUM);
        let stretched = pressed(0.01, 350.0, -2.0e9, 0.98);
        close(aluminium.yield_stress(stretched, &[]).value, 63.0676e6 * 0.833_607, 1e-6);
        close(aluminium.shear_modulus(27.1e9, stretched), 27.1e9 * 0.833_607, 1e-6);
    }

    #[test]
    fn melting_follows_the_compression() {
        // Copper at 1.06: exp(3 0.0566038) = 1.185074 times 1.06^0.373333 = 1.021992: 1.211144 1790 K = 2167.947 K; aluminium at
        // 0.98: exp(-2.8 0.0204082) = 0.944459 times 0.98^0.473333 = 0.990483: 0.935470 1220 K = 1141.274 K.
        for (constants, compression, melting) in
            [(COPPER, 1.06, 2167.947), (ALUMINIUM, 0.98, 1141.274), (COPPER, 1.0, 1790.0)]
        {
            let law = law(&constants);
            let at = |temperature| pressed(0.1, temperature, 1.0e9, compression);
            assert!(law.yield_stress(at(melting - 0.01), &[]).value > 0.0, "{compression}");
            assert!(law.shear_modulus(1.0e9, at(melting - 0.01)) > 0.0);
            for temperature in [melting + 0.01, 1e4, 1e9] {
                let melt = law.yield_stress(at(temperature), &[]);
                assert_eq!((melt.value, melt.by_strain, melt.by_rate), (0.0, 0.0, 0.0), "{compression}");
                assert_eq!(law.shear_modulus(1.0e9, at(temperature)), 0.0);
            }
        }
        assert_eq!(law(&COPPER).melting_temperature(), Some(1790.0));
    }

    #[test]
    fn no_state_gives_what_is_no_number_or_negative() {
        // Constants as far off as a deck may give them, too.
        let far = [1.0, 1e12, 1e6, 5.0, 1e-6, 1.0, 0.0, 1.0, 0.0, 1e3, 1e3];
        for constants in [COPPER, ALUMINIUM, far] {
            let law = law(&constants);
            for strain in [-0.1, 0.0, 1.0, 100.0] {
                for temperature in [0.0, 300.0, 1789.0, 1e6] {
                    for pressure in [-1e12, -1e9, 0.0, 1e12] {
                        for compression in [-1.0, 0.0, 1e-300, 0.5, 1.0, 3.0, 1e3] {
                            let state = pressed(strain, temperature, pressure, compression);
                            let (y, g) = (law.yield_stress(state, &[]), law.shear_modulus(47.7e9, state));
                            assert!(
                                y.value >= 0.0 && y.value.is_finite() && y.by_strain.is_finite(),
                                "{state:?} {y:?}"
                            );
                            assert!(g >= 0.0 && g.is_finite(), "{state:?} {g}");
                        }
                    }
                }
            }
        }
        // 1 - 2.83e-11 5e10 is negative: tension takes all of the shear modulus.
        assert_eq!(law(&COPPER).shear_modulus(47.7e9, pressed(0.0, 300.0, -5.0e10, 1.0)), 0.0);
    }

    #[test]
    fn a_melt_is_returned_to_nothing() {
        let law = FlowLaw::SteinbergGuinan(law(&COPPER));
        let molten = pressed(0.1, 2000.0, 0.0, 1.0);
        let trial = SymmetricTensor { xy: 1.0e8, ..SymmetricTensor::diagonal(2.0e8, -1.0e8, -1.0e8) };
        let returned =
            return_mapping(ReturnRule::RadialReturn, &law, law.shear_modulus(47.7e9, molten), trial, molten, &[], 1e-8);
        assert_eq!(returned.deviator, SymmetricTensor::zero());
        assert!(returned.plastic_strain_increment.is_finite() && returned.plastic_work == 0.0);
    }

    #[test]
    fn slopes() {
        for constants in [COPPER, ALUMINIUM] {
            for at in [(0.01, 1e5, 310.0), (0.5, 1e6, 700.0), (1e-6, 0.0, 250.0), (0.0, 1e6, 300.0), (20.0, 1e5, 400.0)]
            {
                assert_slopes(
                    &|state| {
                        law(&constants).yield_stress(FlowState { pressure: 5.0e9, compression: 1.03, ..state }, &[])
                    },
                    at,
                );
            }
        }
        let single = law(&COPPER).cast::<f32>();
        let at = FlowState { pressure: 1.0e10f32, compression: 1.06, ..FlowState::at_rest(500.0) };
        assert!((f64::from(single.shear_modulus(47.7e9, at)) / (47.7e9 * 1.202_156) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn constants_that_do_not_fit_are_refused() {
        let check = |k: usize, value| {
            let mut values = COPPER;
            values[k] = value;
            <SteinbergGuinan<f64> as YieldLaw<f64>>::check(&values)
        };
        assert_eq!(check(0, 120.0e6), None);
        assert!(check(1, 119.0e6).is_some_and(|message| message.contains("largest-yield-stress")));
        assert!(check(7, 300.0).is_some_and(|message| message.contains("melting-temperature")));
    }
}
