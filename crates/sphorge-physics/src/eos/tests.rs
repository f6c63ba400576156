use super::*;
use core::marker::PhantomData;

const COPPER: [f64; 4] = [8930.0, 3940.0, 1.49, 2.0];

fn close(got: f64, want: f64, relative: f64) {
    assert!((got - want).abs() <= relative * want.abs(), "got {got}, want {want}");
}

fn entry(key: &str) -> &'static LawEntry<EquationOfState<f64>> {
    EQUATIONS_OF_STATE.iter().find(|entry| entry.key == key).unwrap()
}

/// Three of every law, all constants different.
fn laws() -> [EquationOfState<f64>; 6] {
    [
        (entry("linear").build)(&[7850.0, 4600.0]),
        (entry("linear").build)(&[1000.0, 57.03]),
        (entry("mie-gruneisen-polynomial").build)(&COPPER),
        (entry("mie-gruneisen-polynomial").build)(&[2710.0, 5300.0, 1.5, 1.7]),
        (entry("mie-gruneisen").build)(&COPPER),
        (entry("mie-gruneisen").build)(&[7890.0, 3630.0, 1.8, 1.81]),
    ]
}

#[test]
fn laws_made_of_a_straight_line_of_shocks_say_its_slope() {
    assert_eq!(laws().map(|law| law.shock_slope()), [None, None, Some(1.49), Some(1.5), Some(1.49), Some(1.8)]);
}

#[test]
fn linear_by_hand() {
    // K = 7850 4600^2 = 166.106 GPa, 1 % compression.
    let steel = (entry("linear").build)(&[7850.0, 4600.0]);
    close(steel.pressure(7928.5, 1.0e5).pressure, 1.661_06e9, 1e-12);
    close(steel.pressure(7928.5, 1.0e5).sound_speed, 4600.0, 1e-14);
    // 1000 57.03^2 = 3.2524209 MPa, 2 % expansion.
    let rubber = (entry("linear").build)(&[1000.0, 57.03]);
    close(rubber.pressure(980.0, 0.0).pressure, -65_048.418, 1e-12);
}

#[test]
fn polynomial_by_hand() {
    // eta = 0.1, e = 200 kJ/kg: a_0 = 138.625748e9, b_0 = 1.98 a_0, c_0 = 1.7003 a_0,
    // P_H = a_0 (0.1 + 0.0198 + 0.0017003) = 16.84306... GPa, times 0.9, plus 2 9823 2e5.
    let copper = (entry("mie-gruneisen-polynomial").build)(&COPPER);
    let p_h = 138.625_748e9 * 0.121_500_3;
    close(copper.pressure(9823.0, 2.0e5).pressure, 0.9 * p_h + 3.9292e9, 1e-12);
    // eta = -0.05, e = 50 kJ/kg for aluminium: a_0 = 2710 5300^2 = 76.1239 GPa; -0.05 a_0 + 1.7 2574.5 5e4.
    let aluminium = (entry("mie-gruneisen-polynomial").build)(&[2710.0, 5300.0, 1.5, 1.7]);
    close(aluminium.pressure(2574.5, 5.0e4).pressure, -3.806_195e9 + 0.218_832_5e9, 1e-12);
}

#[test]
fn hugoniot_by_hand() {
    // rho = 10 000: chi = 0.107, eta = 0.119820829, S chi = 0.15943; P_H = 138.625748e9 0.107 / 0.84057^2 = 20.993634 GPa.
    let copper = (entry("mie-gruneisen").build)(&COPPER);
    let p_h = 138.625_748e9 * 0.107 / (0.840_57 * 0.840_57);
    close(copper.pressure(1.0e4, 1.5e5).pressure, p_h * (1.0 - 0.119_820_828_667_413_2) + 3.0e9, 1e-12);
    // Expansion: iron, eta = -0.02, e = 30 kJ/kg; a_0 = 7890 3630^2 = 103.965 741 GPa.
    let iron = (entry("mie-gruneisen").build)(&[7890.0, 3630.0, 1.8, 1.81]);
    close(iron.pressure(7732.2, 3.0e4).pressure, -0.02 * 103.965_741e9 + 1.81 * 7732.2 * 3.0e4, 1e-12);
}

#[test]
fn tension_without_heat_is_that_of_the_bulk_modulus() {
    // K = 138.625748 GPa and 76.1239 GPa; 10 % and 2 % of expansion; the slope is the sound speed.
    for key in ["mie-gruneisen-polynomial", "mie-gruneisen"] {
        for (constants, modulus) in [(COPPER, 138.625_748e9), ([2710.0, 5300.0, 1.5, 1.7], 76.1239e9)] {
            let law = (entry(key).build)(&constants);
            for eta in [-0.1, -0.02] {
                let rho = constants[0] * (1.0 + eta);
                close(law.pressure(rho, 0.0).pressure, eta * modulus, 1e-12);
                // c^2 = c_0^2 + Gamma p/rho.
                let squared = constants[1] * constants[1] + constants[3] * eta * modulus / rho;
                close(law.pressure(rho, 0.0).sound_speed, squared.sqrt(), 1e-12);
            }
        }
    }
}

#[test]
fn exact_form_gives_the_hugoniot_back() {
    // Cu at up = 250 m/s: Us = 3940 + 1.49 250 = 4312.5, P = 8930 4312.5 250 = 9.62766 GPa, rho = rho_0 Us/(Us - up).
    for (constants, up) in
        [(COPPER, 250.0), ([2710.0, 5300.0, 1.5, 1.7], 3090.0), ([7890.0, 3630.0, 1.8, 1.81], 1000.0)]
    {
        let [rho_0, c_0, s, _] = constants;
        let us = c_0 + s * up;
        let state = (entry("mie-gruneisen").build)(&constants).pressure(rho_0 * us / (us - up), 0.5 * up * up);
        close(state.pressure, rho_0 * us * up, 1e-12);
    }
    let copper = (entry("mie-gruneisen").build)(&COPPER);
    close(copper.pressure(8930.0 * 4312.5 / 4062.5, 31_250.0).pressure, 9.627_656_25e9, 1e-12);
}

#[test]
fn polynomial_and_exact_hugoniot_agree_near_the_reference_density() {
    // The expansion leaves out terms of fourth order in the compression.
    let (polynomial, exact) =
        ((entry("mie-gruneisen-polynomial").build)(&COPPER), (entry("mie-gruneisen").build)(&COPPER));
    let difference = |eta: f64| {
        let rho = 8930.0 * (1.0 + eta);
        (polynomial.pressure(rho, 1.0e4).pressure - exact.pressure(rho, 1.0e4).pressure).abs()
    };
    assert!(difference(0.01) < 1e-6 * 138.6e9);
    let order = (difference(0.02) / difference(0.01)).log2();
    assert!((order - 4.0).abs() < 0.1, "order {order}");
}

#[test]
fn sound_speed_is_the_isentropic_slope() {
    for law in laws() {
        let rho_0 = law.reference_density();
        for ratio in [0.97, 1.0 + 1e-3, 1.05, 1.2] {
            for energy in [0.0, 2.0e4, 3.0e5] {
                let rho = rho_0 * ratio;
                let p = |rho: f64, e: f64| law.pressure(rho, e).pressure;
                let (dr, de) = (rho * 1e-6, 1.0);
                let by_density = (p(rho + dr, energy) - p(rho - dr, energy)) / (2.0 * dr);
                let by_energy = (p(rho, energy + de) - p(rho, energy - de)) / (2.0 * de);
                let squared = by_density + p(rho, energy) / (rho * rho) * by_energy;
                close(law.pressure(rho, energy).sound_speed, squared.sqrt(), 1e-6);
            }
        }
        close(law.pressure(rho_0, 0.0).sound_speed, law.reference_sound_speed(), 1e-12);
        assert_eq!(law.pressure(rho_0, 0.0).pressure, 0.0);
    }
}

#[test]
fn sound_speed_has_a_floor_in_expansion() {
    let copper = (entry("mie-gruneisen-polynomial").build)(&COPPER);
    close(copper.pressure(0.3 * 8930.0, 0.0).sound_speed, 394.0, 1e-12);
}

#[test]
fn hugoniot_stays_finite_and_rises_through_its_singularity() {
    // chi = 1/S at rho = rho_0 S/(S-1); Gamma = 0 leaves P_H alone.
    let copper = (entry("mie-gruneisen").build)(&[8930.0, 3940.0, 1.49, 0.0]);
    let mut last = 0.0;
    let mut ratio = 1.0;
    while ratio < 20.0 {
        ratio += 0.001;
        let p = copper.pressure(8930.0 * ratio, 0.0).pressure;
        assert!(p.is_finite() && p > last, "at {ratio}");
        // No jump where the tangent begins.
        assert!(p - last < 0.03 * 138.6e9 * 100.0);
        last = p;
    }
    // On the tangent by hand: rho_0/rho = 0.35, chi = 0.65, chi_g = 0.9/1.49; value 100 chi_g, slope 1.9/0.1^3.
    let chi_g = 0.9 / 1.49;
    close(
        copper.pressure(8930.0 / 0.35, 0.0).pressure,
        138.625_748e9 * (100.0 * chi_g + 1900.0 * (0.65 - chi_g)),
        1e-12,
    );
    // S = 0 has no singularity: P_H = rho_0 c_0^2 chi.
    let flat = (entry("mie-gruneisen").build)(&[8930.0, 3940.0, 0.0, 0.0]);
    close(flat.pressure(17_860.0, 0.0).pressure, 0.5 * 138.625_748e9, 1e-12);
}

#[test]
fn cold_energy_follows_the_isotherm() {
    // Fourth-order Runge–Kutta on de/drho = p/rho^2 - T_0 Gamma c_p/rho.
    let (t_0, c_p) = (293.15, 385.0);
    for law in laws() {
        for ratio in [0.8, 1.1, 1.5] {
            let rho_0 = law.reference_density();
            let steps = 4000;
            let dr = rho_0 * (ratio - 1.0) / f64::from(steps);
            let slope = |rho: f64, e: f64| {
                law.pressure(rho, e).pressure / (rho * rho) - t_0 * law.gruneisen(rho, e) * c_p / rho
            };
            let (mut rho, mut e) = (rho_0, 0.0);
            for _ in 0..steps {
                let k1 = slope(rho, e);
                let k2 = slope(rho + 0.5 * dr, e + 0.5 * dr * k1);
                let k3 = slope(rho + 0.5 * dr, e + 0.5 * dr * k2);
                let k4 = slope(rho + dr, e + dr * k3);
                e += dr / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
                rho += dr;
            }
            close(law.cold_energy(rho_0 * ratio, t_0, c_p), e, 1e-8);
        }
        assert_eq!(law.cold_energy(law.reference_density(), t_0, c_p), 0.0);
    }
}

#[test]
fn isentropic_compression_heats_by_the_power_of_the_density() {
    let (t_0, c_p) = (300.0, 385.0);
    let copper = (entry("mie-gruneisen").build)(&COPPER);
    let rho = 8930.0 * 1.2;
    let temperature = t_0 + (copper.isentropic_energy(rho) - copper.cold_energy(rho, t_0, c_p)) / c_p;
    close(temperature, 300.0 * 1.44, 1e-12);
}

#[test]
fn single_precision_and_tables() {
    for law in laws() {
        let rho = law.reference_density() * 1.07;
        let (double, single) = (law.pressure(rho, 4.0e4), law.cast::<f32>().pressure(rho as f32, 4.0e4));
        close(f64::from(single.pressure), double.pressure, 1e-5);
        close(f64::from(single.sound_speed), double.sound_speed, 1e-5);
        close(
            f64::from(law.cast::<f32>().cold_energy(rho as f32, 300.0, 400.0)),
            law.cold_energy(rho, 300.0, 400.0),
            1e-4,
        );
        let entry = entry(law.key());
        assert_eq!(entry.parameters, law.parameters());
        assert_eq!(entry.parameters[0].key, "density");
    }
}

/// `p = K (1 - rho_0/rho) + Gamma_0 rho_0 e`: a law that is not of the form with a constant Grüneisen parameter, asked lane by
/// lane.
#[derive(Clone, Copy, Debug)]
struct ConstantGammaRho<T> {
    /// `rho_0`, kg/m^3, `c_0`, m/s, `Gamma_0`.
    constants: [f64; 3],
    number: PhantomData<T>,
}

impl<T: Real> EquationConstants for ConstantGammaRho<T> {
    type Number = T;

    const KEY: &'static str = "constant-gamma-rho";
    const NAME: &'static str = "constant Gamma rho";
    const REFERENCE: &'static str = "none";
    const PARAMETERS: &'static [Parameter] = &[REFERENCE_DENSITY, SOUND_SPEED, GRUNEISEN];

    fn new(values: &[f64]) -> Self {
        Self { constants: [values[0], values[1], values[2]], number: PhantomData }
    }

    fn reference_density(&self) -> T {
        T::of(self.constants[0])
    }

    fn reference_sound_speed(&self) -> T {
        T::of(self.constants[1])
    }
}

impl<T: Real> PressureLaw for ConstantGammaRho<T> {
    fn pressure(&self, density: T, energy: T) -> PressureState<T> {
        let [rho_0, c_0, gamma_0] = self.constants;
        PressureState::lane_by_lane(density, energy, |rho, e| {
            let modulus = rho_0 * c_0 * c_0;
            let pressure = modulus * (1.0 - rho_0 / rho) + gamma_0 * rho_0 * e;
            PressureState::new(pressure, (modulus + gamma_0 * pressure) * rho_0 / (rho * rho), c_0)
        })
    }

    fn gruneisen(&self, density: T, _energy: T) -> T {
        T::of(self.constants[2]) * self.reference_density() / density
    }
}

#[test]
fn a_law_of_any_form_gives_pressure_and_gruneisen_parameter_of_its_own() {
    let law = ConstantGammaRho::<f64>::new(&[8000.0, 4000.0, 2.0]);
    // K = 128 GPa. 25.6 + 1.6 GPa, c^2 = 1.024e7 + 4.352e6; -32 + 3.2 GPa, c^2 = 2.5e7 - 1.125e7.
    for (rho, e, pressure, squared, gamma) in
        [(1.0e4, 1.0e5, 27.2e9, 1.4592e7, 1.6), (6400.0, 2.0e5, -28.8e9, 1.375e7, 2.5)]
    {
        let state = law.pressure(rho, e);
        close(state.pressure, pressure, 1e-14);
        close(state.sound_speed, f64::sqrt(squared), 1e-14);
        close(law.gruneisen(rho, e), gamma, 1e-14);
    }
    // Far in expansion the formula turns imaginary: a tenth of c_0.
    close(law.pressure(2000.0, 0.0).sound_speed, 400.0, 1e-14);
    assert!(ConstantGammaRho::<f64>::check(&[]).is_none());
    // The laws of the constant form say the same of every state.
    let copper = (entry("mie-gruneisen").build)(&COPPER);
    assert_eq!((copper.gruneisen(9.0e3, 0.0), copper.gruneisen(7.0e3, 1.0e6)), (2.0, 2.0));
    assert_eq!((entry("linear").build)(&[7850.0, 4600.0]).gruneisen(8.0e3, 1.0e5), 0.0);
}

#[test]
fn isentrope_and_isotherm_of_any_form_by_hand() {
    // With x = 1 - rho_0/rho: e_s = K/(rho_0 Gamma_0^2) (exp(Gamma_0 x) - 1 - Gamma_0 x), less T_0 c_p (exp(Gamma_0 x) - 1) on the
    // isotherm. K/(rho_0 Gamma_0^2) = 4 MJ/kg, T_0 c_p = 300 400 = 120 kJ/kg; x = 0.2, exp(0.4) = 1.4918246976, and x = -0.25,
    // exp(-0.5) = 0.6065306597.
    let law = ConstantGammaRho::<f64>::new(&[8000.0, 4000.0, 2.0]);
    for (rho, isentropic, cold) in [(1.0e4, 367_298.790, 308_279.827), (6400.0, 426_122.639, 473_338.960)] {
        close(law.isentropic_energy(rho), isentropic, 1e-6);
        close(law.cold_energy(rho, 300.0, 400.0), cold, 1e-6);
    }
    assert_eq!((law.isentropic_energy(8000.0), law.cold_energy(8000.0, 300.0, 400.0)), (0.0, 0.0));
}

#[test]
fn integration_agrees_with_the_quadrature_of_the_constant_form() {
    for constants in [COPPER, [2710.0, 5300.0, 1.5, 1.7]] {
        let law = MieGruneisenHugoniot::<f64>::new(&constants);
        for ratio in [0.7, 0.95, 1.02, 1.2, 1.5] {
            let rho = ratio * law.density;
            close(isotherm::energy(&law, rho, 0.0), law.isentropic_energy(rho), 1e-6);
            close(isotherm::energy(&law, rho, 300.0 * 385.0), law.cold_energy(rho, 300.0, 385.0), 1e-6);
        }
    }
}
