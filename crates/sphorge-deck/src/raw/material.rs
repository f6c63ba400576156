//! Materials: the same keys in a deck and in the catalogue.

use super::super::declare::tables;
use super::super::{choice::*, value::*};
use super::{EquationOfStateWord, RawLaw, StrengthWord};

tables! {
    /// A material. Of the elastic constants, two give the others.
    #[derive(Default)]
    RawMaterial {
        /// Material to start from; a material named as one of the catalogue starts from that.
        base: Option<Word>, example "armco-iron", otherwise "the catalogue's material of this name, if any";
        /// What the material is.
        description: Option<Word>, example "4340 steel, Rockwell C 30", default "";
        /// Where the constants come from.
        reference: Option<Word>, example "Johnson & Cook 1983", default "";
        /// What a user has to know, such as constants that are not published.
        note: Option<Word>, example "no equation of state", default "";
        /// Density at rest.
        density: Option<Given<Density>>, example "7890 kg/m^3", otherwise "must be given";
        /// Shear modulus G.
        shear_modulus: Option<Given<Stress>>, example "80 GPa", otherwise "from two of them";
        /// Young's modulus E.
        young_modulus: Option<Given<Stress>>, example "210 GPa", otherwise "from two of them";
        /// Poisson's ratio nu. `check` and `run` tell where the bulk modulus `rho_0 c_0^2` of the pressure law and the shear modulus
        /// give one that differs by more than 0.03, and, where none is stated for a metal, one outside 0.20 to 0.45.
        poisson_ratio: Option<Given<Number>>, example 0.3, otherwise "from two of them";
        /// Bulk modulus K.
        bulk_modulus: Option<Given<Stress>>, example "170 GPa", otherwise "from two of them";
        /// Pressure law.
        equation_of_state: Option<RawLaw<EquationOfStateWord>>, example { "mie-gruneisen": { "sound-speed": "3630 m/s", "shock-slope": 1.8, "gruneisen": 1.81 } }, default "linear";
        /// Flow law.
        strength: Option<RawLaw<StrengthWord>>, example { "perfectly-plastic": { "yield-stress": "350 MPa" } }, otherwise "must be given";
        /// How the trial stress returns to the yield surface.
        return_rule: Option<Choice<ReturnRuleWord>>, example "benz-asphaug", default "radial-return";
        /// Specific heat; without it the temperature stays, and a metal that would soften as plastic work heats it does not, which
        /// `check` and `run` tell unless `taylor-quinney` is 0.
        specific_heat: Option<Given<SpecificHeat>>, example "452 J/(kg K)", otherwise "none: the temperature stays";
        /// Thermal conductivity.
        conductivity: Option<Given<Conductivity>>, example "80.2 W/(m K)", default 0.0;
        /// Share of plastic work that heats (Taylor & Quinney), 0 to 1.
        taylor_quinney: Option<Given<Number>>, example 0.9, default 0.9;
        /// Tension the material bears before it spalls, above zero: the pressure is cut off at its negative, in every pressure law. The
        /// deviator is not touched.
        spall_pressure: Option<Given<Stress>>, example "1.2 GPa", otherwise "none: any tension";
        /// Temperature at which the internal energy is zero and at which bodies start unless they say otherwise.
        reference_temperature: Option<Given<Temperature>>, example "20 degC", default "293.15 K";
    }
}
