//! Materials: the same keys in a deck and in the catalogue.

use super::super::declare::tables;
use super::super::{choice::*, value::*};
use super::{DamageWord, EquationOfStateWord, RawLaw, StrengthWord};

tables! {
    /// A material. Two elastic constants define the others.
    #[derive(Default)]
    RawMaterial {
        /// Material whose constants apply where this one gives none; by default the material of the catalogue with the same name.
        base: Option<Word>, example "armco-iron", otherwise "the catalogue's material of this name, if any";
        /// Description of the material.
        description: Option<Word>, example "4340 steel, Rockwell C 30", default "";
        /// Source of the constants.
        reference: Option<Word>, example "Johnson & Cook 1983", default "";
        /// Notes for users, such as constants that are not published.
        note: Option<Word>, example "no equation of state", default "";
        /// Density at rest at the reference temperature.
        density: Option<Given<Density>>, example "7890 kg/m^3", otherwise "must be given";
        /// Shear modulus G.
        shear_modulus: Option<Given<Stress>>, example "80 GPa", otherwise "from two others";
        /// Young's modulus E.
        young_modulus: Option<Given<Stress>>, example "210 GPa", otherwise "from two others";
        /// Poisson's ratio nu. `check` and `run` print a note if the ratio that follows from the bulk modulus `rho_0 c_0^2` of the pressure law
        /// and the shear modulus differs from it by more than 0.03 (in light, soft matter such as polymers 0.12 upwards) or, where none is given for what is as heavy as a metal, lies outside 0.20 to 0.47, and if it
        /// is above 0.49.
        poisson_ratio: Option<Given<Number>>, example 0.3, otherwise "from two others";
        /// Bulk modulus K.
        bulk_modulus: Option<Given<Stress>>, example "170 GPa", otherwise "from two others";
        /// Pressure law.
        equation_of_state: Option<RawLaw<EquationOfStateWord>>, example { "mie-gruneisen": { "sound-speed": "3630 m/s", "shock-slope": 1.8, "gruneisen": 1.81 } }, default "linear";
        /// Flow law.
        strength: Option<RawLaw<StrengthWord>>, example { "perfectly-plastic": { "yield-stress": "350 MPa" } }, otherwise "must be given";
        /// Return of the trial stress to the yield surface.
        return_rule: Option<Choice<ReturnRuleWord>>, example "benz-asphaug", default "radial-return";
        /// Specific heat. Without it the temperature is constant, and a metal does not soften by the heat of plastic work; `check` and
        /// `run` print a note if the flow law depends on the temperature and `taylor-quinney` is not 0.
        specific_heat: Option<Given<SpecificHeat>>, example "452 J/(kg K)", otherwise "none: the temperature is constant";
        /// Thermal conductivity.
        conductivity: Option<Given<Conductivity>>, example "80.2 W/(m K)", default 0.0;
        /// Share of plastic work that becomes heat (Taylor & Quinney), 0 to 1.
        taylor_quinney: Option<Given<Number>>, example 0.9, default 0.9;
        /// Tension at which the material spalls, above zero. From there on tension and shear fall with the opening of the crack, and a
        /// particle that is severed bears pressure alone: see the field `integrity`.
        spall_pressure: Option<Given<Stress>>, example "1.2 GPa", otherwise "none: unlimited tension";
        /// Opening of a crack at which it bears no tension any more: spalling takes half of it times `spall-pressure` in energy per area.
        /// Where the spacing is too coarse for it, twice the elastic stretch of a particle at `spall-pressure`.
        spall_opening: Option<Given<Length>>, example "20 um", default "0.1 mm";
        /// Law of damage: the material breaks where it reaches one. The name of a law alone takes its constants from the material of the catalogue,
        /// which does not break otherwise.
        damage: Option<RawLaw<DamageWord>>, example { "cockcroft-latham": { "work": "800 MPa" } }, otherwise "none: it does not break";
        /// Failure strain at least, for laws whose failure strain turns negative where the triaxiality is large.
        minimum_failure_strain: Option<Given<Number>>, example 0.01, default 0.001;
        /// Plastic work per area of a crack, from a damage of one until nothing is borne: the integrity falls over the strain that takes
        /// it in a particle of this size. Where that is faster than the material unloads, over twice its elastic strain.
        fracture_energy: Option<Given<FractureEnergy>>, example "50 kJ/m^2", otherwise "see `softening`";
        /// The same by the plastic opening of a crack.
        softening_displacement: Option<Given<Length>>, example "50 um", otherwise "see `softening`";
        /// Share of the failure strain over which the integrity falls. What a crack takes then depends on the spacing: prefer
        /// `fracture-energy` or `softening-displacement`, one of the three.
        softening: Option<Given<Number>>, example 0.2, default 0.1;
        /// What a particle still bears that has lost its integrity.
        after_failure: Option<Choice<AfterFailureWord>>, example "fluid", default "no-tension";
        /// Mass scaling: inertia is so many times that of the material, 1 or more, so that time steps are the square root of it longer. For slow loads, under
        /// which inertia does not matter. Densities of the run are multiplied by it, and the specific heat and the sound speed are adapted, so
        /// that stiffness, strength and temperatures stay as they are; a weight does not. `check` and `run` print a note with the mass that is added.
        mass_scaling: Option<Given<Number>>, example 25, default 1.0;
        /// Temperature at which the internal energy is zero, and the default initial temperature of bodies.
        reference_temperature: Option<Given<Temperature>>, example "20 degC", default "293.15 K";
    }
}
