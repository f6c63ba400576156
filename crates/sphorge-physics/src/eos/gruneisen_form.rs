//! The Mie–Grüneisen form with a constant Grüneisen parameter.

use super::{EquationConstants, PressureLaw, PressureState};
use crate::{Elementary, Real};

/// Pressure at zero specific energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReferenceCurve<T> {
    /// `f(rho)`, Pa.
    pub pressure: T,
    /// `df/drho`, Pa m^3/kg.
    pub slope: T,
}

/// What a law of the form `p(rho, e) = f(rho) + Gamma rho e` has to give to be a [`PressureLaw`]: sound speed and the energies of
/// isentrope and isotherm follow.
///
/// A constant `Gamma` limits the compression a law can be used at: without heat, pressure stops rising at about 1.7 to 2
/// times the reference density (copper 1.72 at zero energy, 1.86 on its isentrope), and a shock cannot exceed `1 + 2/Gamma`.
pub trait GruneisenForm: EquationConstants {
    /// Pressure at zero energy and its slope.
    fn reference_curve(&self, density: Self::Number) -> ReferenceCurve<Self::Number>;
    /// `Gamma`, zero for a law without energy.
    fn gamma(&self) -> Self::Number;
}

impl<T: Real, L: GruneisenForm<Number = T>> PressureLaw for L {
    #[inline(always)]
    fn pressure(&self, density: T, energy: T) -> PressureState<T> {
        let curve = self.reference_curve(density);
        let gamma = self.gamma();
        let pressure = curve.pressure + gamma * density * energy;
        let squared = curve.slope + gamma * (energy + pressure / density);
        PressureState::new(pressure, squared, self.reference_sound_speed())
    }

    #[inline(always)]
    fn gruneisen(&self, _density: T, _energy: T) -> T {
        self.gamma()
    }

    /// `de/drho = p/rho^2 = f/rho^2 + Gamma e/rho` is linear in `e`; with `x = rho/rho_0`, `u = ln x`,
    /// `e_s = x^Gamma / rho_0 int_0^ln(x) f(rho_0 exp u) exp(-(Gamma + 1) u) du`, done with six Gauss points.
    #[inline(always)]
    fn isentropic_energy(&self, density: T) -> T
    where
        T: Elementary,
    {
        let rho_0 = self.reference_density();
        let exponent = self.gamma() + T::one();
        let half = T::of(0.5) * (density / rho_0).ln();
        let mut sum = T::zero();
        for k in 0..GAUSS.len() {
            let offset = half * T::of(GAUSS[k].0);
            let (near, far) = (half - offset, half + offset);
            let f_near = self.reference_curve(rho_0 * near.exp()).pressure * (-(exponent * near)).exp();
            let f_far = self.reference_curve(rho_0 * far.exp()).pressure * (-(exponent * far)).exp();
            sum += T::of(GAUSS[k].1) * (f_near + f_far);
        }
        half * sum / rho_0 * (self.gamma() * (half + half)).exp()
    }

    /// `e_cold = e_s(rho) - c_p T_0 [(rho/rho_0)^Gamma - 1]` with the isentrope `e_s`: compression at constant entropy heats to
    /// `T = T_0 (rho/rho_0)^Gamma`, as a constant Grüneisen parameter demands.
    #[inline(always)]
    fn cold_energy(&self, density: T, reference_temperature: T, specific_heat: T) -> T
    where
        T: Elementary,
    {
        let ratio = density / self.reference_density();
        let heating = ratio.powf(self.gamma()) - T::one();
        self.isentropic_energy(density) - specific_heat * reference_temperature * heating
    }
}

/// Positive nodes and weights of the six-point Gauss–Legendre rule on [-1, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_4),
];
