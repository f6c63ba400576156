//! Choices of the discretisation and of the neighbour search.

use super::super::{choice::*, value::*};
use schemars::JsonSchema;
use serde::Deserialize;

/// Choices of the discretisation.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawNumerics {
    /// Smoothing kernel.
    #[schemars(extend("examples" = ["wendland-c2"], "default" = "cubic-spline"))]
    pub(crate) kernel: Option<Choice<KernelWord>>,
    /// Time integrator.
    #[schemars(extend("examples" = ["predictor-corrector"], "default" = "leapfrog"))]
    pub(crate) integrator: Option<Choice<IntegratorWord>>,
    /// Arithmetic of the pair sums; state is always kept in double precision.
    #[schemars(extend("examples" = ["double"], "default" = "mixed"))]
    pub(crate) precision: Option<Choice<PrecisionWord>>,
    /// Form of the pair sums of velocity gradient and momentum.
    #[schemars(extend("examples" = ["density-weighted"], "default" = "volume-weighted"))]
    pub(crate) pair_form: Option<Choice<PairFormWord>>,
    /// Correction of the kernel gradient.
    #[schemars(extend("examples" = ["linear"], "default" = "none"))]
    pub(crate) gradient_correction: Option<Choice<GradientCorrectionWord>>,
    /// Artificial viscosity (Monaghan & Gingold 1983), or `false` for none.
    #[schemars(extend("default" = true))]
    pub(crate) viscosity: Option<ScalarOr<Flag, RawViscosity>>,
    /// Artificial stress (Gray, Monaghan & Swift 2001); `true` for the constants of that paper.
    #[schemars(extend("default" = false))]
    pub(crate) artificial_stress: Option<ScalarOr<Flag, RawArtificialStress>>,
    /// XSPH strength, 0 to 1: positions move with a velocity averaged over neighbours to this share.
    #[schemars(extend("examples" = [0.5], "default" = 0.0))]
    pub(crate) xsph: Option<Given<Number>>,
    /// Restore the density by moving least squares every so many steps.
    #[schemars(extend("examples" = [20], "x-default" = "never"))]
    pub(crate) mls_interval: Option<Count>,
    /// How pair work is shared between the two particles.
    #[schemars(extend("examples" = ["symmetric"], "default" = "own-stress"))]
    pub(crate) energy_split: Option<Choice<EnergySplitWord>>,
    /// Where the temperature comes from.
    #[schemars(extend("examples" = ["energy"], "default" = "plastic-work"))]
    pub(crate) temperature: Option<Choice<TemperatureWord>>,
    /// Course of the smoothing length.
    #[schemars(extend("examples" = ["follow-density"], "default" = "constant"))]
    pub(crate) smoothing_length: Option<ScalarOr<Choice<SmoothingLengthWord>, RawSmoothingLength>>,
}

/// A course of the smoothing length with constants of its own.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawSmoothingLength {
    /// Follow the density: `dh/dt = (h/d) div v` in `d` dimensions, that is `h = h0 (rho0/rho)^(1/d)`.
    pub(crate) follow_density: Option<RawFollowDensity>,
}

/// Bounds of a smoothing length that follows the density.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawFollowDensity {
    /// Largest ratio to the initial smoothing length, and one over the smallest; above 1, at most 4.
    #[schemars(extend("examples" = [1.5], "default" = 2.0))]
    pub(crate) factor: Option<Given<Number>>,
}

/// Constants of the artificial viscosity.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawViscosity {
    /// Linear coefficient.
    #[schemars(extend("examples" = [0.2], "default" = 1.0))]
    pub(crate) alpha: Option<Given<Number>>,
    /// Quadratic coefficient.
    #[schemars(extend("examples" = [4.0], "default" = 1.0))]
    pub(crate) beta: Option<Given<Number>>,
    /// Balsara's switch: less viscosity in shear.
    #[schemars(extend("examples" = [true], "default" = false))]
    pub(crate) balsara: Option<Flag>,
}

/// Constants of the artificial stress.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawArtificialStress {
    /// Strength.
    #[schemars(extend("examples" = [0.3], "default" = 0.3))]
    pub(crate) epsilon: Option<Given<Number>>,
    /// Exponent of the kernel ratio, 1 to 16.
    #[schemars(extend("examples" = [4], "default" = 4))]
    pub(crate) exponent: Option<Count>,
}

/// A search strategy with constants of its own; one of them.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawSearch {
    /// Neighbour lists with a skin, renewed when two particles may have closed in by it.
    pub(crate) skin: Option<RawSkin>,
    /// Particles whose plastic strain grows are searched again (Fraser), and all a guard finds.
    pub(crate) adaptive: Option<RawAdaptive>,
    /// No search after the start: sums over the initial neighbours.
    pub(crate) total_lagrangian: Option<RawTotalLagrangian>,
}

/// Constants of the adaptive search.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawAdaptive {
    /// Plastic strain increment above which a particle is searched.
    #[schemars(extend("examples" = [1e-5], "default" = 1e-5))]
    pub(crate) plastic_strain_threshold: Option<Given<Number>>,
    /// Compare the increment since the last search of the particle, not that of the last step.
    #[schemars(extend("examples" = [true], "default" = false))]
    pub(crate) accumulate: Option<Flag>,
    /// Guard against what plastic strain does not show: `full`, or `none` for the rule as published.
    #[schemars(extend("examples" = ["none"], "default" = "full"))]
    pub(crate) guard: Option<Choice<GuardWord>>,
    /// Strain since its last search at which the guard searches a particle.
    #[schemars(extend("examples" = [0.005], "default" = 0.005))]
    pub(crate) strain_bound: Option<Given<Number>>,
}

/// Constants of the total Lagrangian form.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawTotalLagrangian {
    /// Form of the sums. The corrected form leaves out artificial stress, XSPH and density restoration, which belong to
    /// sums over current neighbours, and puts a bulk viscosity with the same constants in place of the pair viscosity.
    #[schemars(extend("examples" = ["frozen"], "default" = "corrected"))]
    pub(crate) form: Option<Choice<FormulationWord>>,
    /// Strength of the hourglass control of the corrected form (Ganzenmüller 2015), 0 for none. Its springs yield with the material.
    #[schemars(extend("examples" = [10.0], "default" = 10.0))]
    pub(crate) hourglass: Option<Given<Number>>,
}

/// Constants of the skin.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawSkin {
    /// Thickness of the skin over the kernel radius; above 0, at most 1.
    #[schemars(extend("examples" = [0.1], "default" = 0.1))]
    pub(crate) fraction: Option<Given<Number>>,
}
