//! Materials.

use sphorge_physics::conduction::effusivity;
use sphorge_physics::damage::{AfterFailure, Damage, Moduli};
use sphorge_physics::eos::{BoundedPressure, ColdEnergy, EquationOfState, PressureState};
use sphorge_physics::flow::{FlowLaw, FlowState};
use sphorge_physics::heat::{self, melted, temperature_from_energy};
use sphorge_physics::hyperelastic::neo_hookean_energy_of_stress;
use sphorge_physics::integrity::{Borne, Spall};
use sphorge_physics::total_lagrangian::young_modulus;
use sphorge_physics::{Elementary, Real, SymmetricTensor, return_mapping::ReturnRule};

/// A material, all constants in SI.
#[derive(Clone, Debug)]
pub struct Material {
    /// Name in the catalogue or the deck.
    pub name: String,
    /// Source of the constants.
    pub reference: String,
    /// Density at rest, kg/m³.
    pub density: f64,
    /// Shear modulus G at rest, Pa (0 for a fluid).
    pub shear_modulus: f64,
    /// Pressure law.
    pub equation_of_state: EquationOfState<f64>,
    /// Flow law.
    pub flow_law: FlowLaw<f64>,
    /// Return of the trial stress to the yield surface.
    pub return_rule: ReturnRule,
    /// Specific heat Cp, J/(kg K); [`NO_HEATING`] where the deck gives none: work does not change the temperature.
    pub specific_heat: f64,
    /// Thermal conductivity k, W/(m K).
    pub conductivity: f64,
    /// Share of plastic work that heats (Taylor–Quinney).
    pub taylor_quinney: f64,
    /// Tension the material bears before it spalls, Pa, positive. Infinite where the deck gives none.
    pub spall_pressure: f64,
    /// Opening of a crack at which it bears no tension any more, m.
    pub spall_opening: f64,
    /// How it breaks by damage, if it does.
    pub damage: Option<Damage<f64>>,
    /// Temperature at which the internal energy is zero, and at which bodies start unless they say otherwise, K.
    pub reference_temperature: f64,
    /// Mass over that of what it stands for: constants are of scaled mass. One unless the deck says otherwise.
    pub mass_scaling: f64,
}

/// What the temperature of an internal energy depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyState {
    /// Specific internal energy without the work of forces that are no stress of the material, J/kg.
    pub energy: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Deviatoric stress, Pa.
    pub deviator: SymmetricTensor<f64>,
    /// Plastic work so far, J/kg.
    pub plastic_work: f64,
    /// Share of tension and shear it still bears.
    pub integrity: f64,
}

/// Specific heat of a material that gives none: plastic work and energy do not change its temperature.
pub const NO_HEATING: f64 = f64::INFINITY;

impl Material {
    /// Whether the material has a specific heat, so that work changes its temperature.
    pub fn heats(&self) -> bool {
        self.specific_heat < NO_HEATING
    }

    /// What the flow law may depend on, at a temperature (K), density (kg/m³) and pressure (Pa); the rate of plastic strain is not
    /// known, and zero.
    #[inline(always)]
    pub fn flow_state(&self, plastic_strain: f64, temperature: f64, density: f64, pressure: f64) -> FlowState<f64> {
        let compression = density / self.density;
        FlowState { plastic_strain, pressure, compression, ..FlowState::at_rest(temperature) }
    }

    /// Pressure (Pa) and sound speed of whole material at a density (kg/m³) and a specific internal energy (J/kg). Energies below that of
    /// absolute zero count as that.
    #[inline(always)]
    pub fn pressure(&self, density: f64, energy: f64) -> PressureState<f64> {
        self.bounded_pressure().at(density, energy)
    }

    /// The same, to be computed one by one or on SIMD lanes.
    #[inline(always)]
    pub fn bounded_pressure<T: Real>(&self) -> BoundedPressure<T> {
        BoundedPressure::new(&self.equation_of_state, self.specific_heat, self.reference_temperature)
    }

    /// Stress at which the material yields in slow loading without pressure after a plastic strain, at a temperature (K), Pa; infinite where it never does.
    pub fn yield_stress_at_rest(&self, plastic_strain: f64, temperature: f64) -> f64 {
        let history: Vec<f64> = self.flow_law.history().iter().map(|variable| variable.initial).collect();
        let state = FlowState { plastic_strain, ..FlowState::at_rest(temperature) };
        self.flow_law.yield_stress(state, &history).value
    }

    /// Whether the material loses its integrity in tension.
    pub fn spalls(&self) -> bool {
        self.spall_pressure.is_finite()
    }

    /// Whether the material may lose its integrity: it spalls, or breaks by damage.
    pub fn breaks(&self) -> bool {
        self.spalls() || self.damage.is_some()
    }

    /// Whether strain that opens a crack does not shear the solid beside it
    /// ([`share_while_opening`](sphorge_physics::integrity::share_while_opening)): where the material spalls by its pressure alone. Hyperelastic
    /// deviators are those of all of the deformation.
    #[inline(always)]
    pub fn opens_without_shear(&self) -> bool {
        self.spalls() && self.damage.is_none() && !self.flow_law.is_hyperelastic()
    }

    /// Whether yield stress, history or damage can change in a step without plastic flow at a constant temperature.
    #[inline(always)]
    pub fn changes_without_flow(&self) -> bool {
        self.flow_law.changes_without_flow() || self.damage.is_some_and(|damage| damage.law.strength().is_some())
    }

    /// Elastic moduli of whole material with a shear modulus (Pa) of now.
    #[inline(always)]
    pub fn moduli<T: Real>(&self, shear: T) -> Moduli<T> {
        let sound_speed = self.equation_of_state.reference_sound_speed();
        Moduli { young: young_modulus(T::of(self.density * sound_speed * sound_speed), shear), shear }
    }

    /// Specific elastic energy, J/kg, that whole material loses with its integrity where it breaks by damage: that of shape change at a deviatoric
    /// stress and shear modulus (both Pa), and that of tension at a density (kg/m³), pressure (Pa) and sound speed.
    pub fn elastic_energy_of_breaking<T: Real>(
        &self,
        deviator: SymmetricTensor<T>,
        shear_modulus: T,
        density: T,
        pressure: T,
        sound_speed: T,
    ) -> T {
        let shape = self.elastic_energy(deviator, shear_modulus, density);
        let tension = match self.damage.map(|damage| damage.after) {
            Some(AfterFailure::Fluid) => T::zero(),
            _ => pressure.min(T::zero()) / (density * sound_speed),
        };
        shape + T::of(0.5) * tension * tension
    }

    /// Energy of the density on the isotherm ([`Self::cold_energies`]), J/kg, at an integrity: damaged material bears a share of its tension.
    #[inline(always)]
    pub fn cold_energy<T: Elementary>(&self, energies: &ColdEnergy<T>, density: T, integrity: T) -> T {
        let Some(damage) = self.damage else { return energies.at(density, integrity) };
        let whole = energies.at(density, T::one());
        match damage.after {
            AfterFailure::Fluid => whole,
            AfterFailure::NoTension => T::select_lt(density, T::of(self.density), integrity * whole, whole),
            AfterFailure::Delete => {
                let left = T::select_lt(density, T::of(self.density), integrity * whole, whole);
                T::select_lt(T::zero(), integrity, left, T::zero())
            }
        }
    }

    /// Whether a particle that has lost all its integrity bears nothing any more, not even pressure.
    pub fn deletes(&self) -> bool {
        self.damage.is_some_and(|damage| matches!(damage.after, AfterFailure::Delete))
    }

    /// Whether the material loses its integrity without ever yielding. Hourglass springs soften with the yield stress, which damage lowers; those
    /// of brittle material have none, and would pull across a crack until its particles are severed, so they soften with its integrity.
    pub fn is_brittle(&self) -> bool {
        self.breaks() && matches!(self.flow_law, FlowLaw::Elastic(_) | FlowLaw::NeoHookean(_))
    }

    /// How the material spalls, if it does.
    pub fn spall(&self) -> Option<Spall<f64>> {
        self.spalls().then(|| Spall {
            pressure: self.spall_pressure,
            opening: self.spall_opening,
            density: self.density,
            sound_speed: self.equation_of_state.reference_sound_speed(),
        })
    }

    /// What a particle bears of the `pressure` (Pa) of whole material at a density (kg/m³), with its integrity before and its size (m;
    /// [`smeared_width`](sphorge_physics::integrity::smeared_width)).
    #[inline(always)]
    pub fn borne(&self, density: f64, pressure: f64, before: f64, size: f64) -> Borne<f64> {
        match self.spall() {
            None => Borne { pressure, integrity: 1.0, share: 1.0 },
            Some(spall) => spall.borne(density, pressure, before, size),
        }
    }

    /// Effusivity at rest, W s^(1/2)/(m² K); zero or infinite where conductivity or specific heat is not given.
    pub fn effusivity(&self) -> f64 {
        effusivity(self.conductivity, self.density, self.specific_heat)
    }

    /// Specific energies of densities on the isotherm of the reference temperature.
    pub fn cold_energies<T: Real>(&self) -> ColdEnergy<T> {
        ColdEnergy::new(&self.equation_of_state, self.spall_pressure, self.reference_temperature, self.specific_heat)
    }

    /// Density of zero pressure at a temperature (K), kg/m³; `None` where the pressure law has none.
    pub fn density_at_rest(&self, temperature: f64) -> Option<f64> {
        if self.heats() { self.cold_energies().density_at_rest(temperature) } else { Some(self.density) }
    }

    /// Temperature of an internal energy, K, from it and what of it is no heat: the energy of the density on the isotherm
    /// ([`Self::cold_energies`]), that of shape change, and a share of the plastic work; all J/kg.
    #[inline(always)]
    pub fn temperature_of_energy<T: Real>(&self, energy: T, cold_energy: T, elastic_energy: T, plastic_work: T) -> T {
        temperature_from_energy(
            T::of(self.reference_temperature),
            energy,
            cold_energy,
            elastic_energy,
            T::of(1.0 - self.taylor_quinney) * plastic_work,
            T::of(self.specific_heat),
        )
    }

    /// One where a particle bears no shear, else zero: its material never does, or has melted at the temperature (K) it has or at that of its
    /// energy, which is asked for where energy heats.
    #[inline(always)]
    pub fn liquid<T: Real>(&self, temperature: T, of_energy: impl FnOnce() -> T) -> T {
        match self.flow_law.melting_temperature() {
            Some(melting) => melted(temperature, if self.heats() { of_energy() } else { temperature }, T::of(melting)),
            None if self.flow_law.has_shear() => T::zero(),
            None => T::one(),
        }
    }

    /// Whether a particle of a temperature (K) and a state is liquid: see [`Self::liquid`].
    pub fn is_liquid(&self, temperature: f64, state: &EnergyState) -> bool {
        let EnergyState { energy, density, deviator, plastic_work, integrity } = *state;
        let elastic = || self.elastic_energy(deviator, self.shear_modulus, density);
        let cold = || self.cold_energy(&self.cold_energies(), density, integrity);
        let of_energy = || self.temperature_of_energy(energy, cold(), elastic(), plastic_work);
        self.liquid(temperature, of_energy) > 0.0
    }

    /// Specific elastic energy of shape change, J/kg, at a deviatoric stress, shear modulus (both Pa) and density
    /// (kg/m³); zero without shear modulus.
    #[inline(always)]
    pub fn elastic_energy<T: Real>(&self, deviator: SymmetricTensor<T>, shear_modulus: T, density: T) -> T {
        if self.flow_law.is_hyperelastic() {
            let at_rest = T::of(self.density);
            neo_hookean_energy_of_stress(deviator, at_rest / density, shear_modulus) / at_rest
        } else {
            heat::elastic_energy(deviator, shear_modulus, density)
        }
    }

    /// Young's modulus at rest, Pa.
    pub fn young_modulus(&self) -> f64 {
        let c = self.equation_of_state.pressure(self.density, 0.0).sound_speed;
        young_modulus(self.density * c * c, self.shear_modulus)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphorge_physics::{eos::EQUATIONS_OF_STATE, flow::FLOW_LAWS};

    fn material(flow_law: &str, constants: &[f64], specific_heat: f64) -> Material {
        let law = FLOW_LAWS.iter().find(|entry| entry.key == flow_law).unwrap();
        Material {
            name: String::new(),
            reference: String::new(),
            density: 8000.0,
            shear_modulus: 80e9,
            equation_of_state: (EQUATIONS_OF_STATE[0].build)(&[8000.0, 4000.0]),
            flow_law: (law.build)(constants),
            return_rule: ReturnRule::RadialReturn,
            specific_heat,
            conductivity: 0.0,
            taylor_quinney: 0.9,
            spall_pressure: f64::INFINITY,
            spall_opening: 0.0,
            damage: None,
            reference_temperature: 293.15,
            mass_scaling: 1.0,
        }
    }

    #[test]
    fn a_metal_is_liquid_at_its_melting_temperature_or_with_the_energy_of_it() {
        // Melts at 1000 K; 400 J/(kg K). Constants in the order of the law: A, B, n, C, m, reference rate, T_0, T_m.
        let metal = material("johnson-cook", &[3e8, 4e8, 0.3, 0.01, 1.0, 1.0, 293.15, 1000.0], 400.0);
        let shear = |tau: f64| SymmetricTensor { xy: tau, ..SymmetricTensor::zero() };
        let state = |energy: f64| EnergyState {
            energy,
            density: 8000.0,
            deviator: shear(4e8),
            plastic_work: 50e3,
            integrity: 1.0,
        };
        assert!(!metal.is_liquid(999.9, &state(0.0)) && metal.is_liquid(1000.0, &state(0.0)));
        // 400 (1000 - 293.15) + 0.1 50e3 + 4e8^2/(2 80e9 8000) = 282 740 + 5000 + 125 J/kg.
        assert!((metal.temperature_of_energy(287_865.0f64, 0.0, 125.0, 50e3) - 1000.0).abs() < 1e-9);
        assert!(!metal.is_liquid(300.0, &state(287_864.0)) && metal.is_liquid(300.0, &state(287_866.0)));
        // Without a specific heat energy says nothing of temperature.
        let cold = Material { specific_heat: NO_HEATING, ..metal };
        assert!(!cold.is_liquid(300.0, &state(1e9)) && cold.is_liquid(1000.0, &state(0.0)));
        // What never melts is liquid if it bears no shear.
        assert!(!material("elastic", &[], 400.0).is_liquid(1e4, &state(1e9)));
        assert!(material("none", &[], 400.0).is_liquid(300.0, &state(0.0)));
    }

    #[test]
    fn the_flow_law_sees_compression_against_the_density_at_rest() {
        let material = material("elastic", &[], NO_HEATING);
        for (strain, temperature, density, pressure, compression) in
            [(0.2, 400.0, 8800.0, 1.28e10, 1.1), (0.0, 300.0, 7200.0, -1.28e10, 0.9)]
        {
            let state = material.flow_state(strain, temperature, density, pressure);
            assert_eq!((state.plastic_strain, state.plastic_strain_rate), (strain, 0.0));
            assert_eq!((state.temperature, state.pressure, state.compression), (temperature, pressure, compression));
        }
    }
}
