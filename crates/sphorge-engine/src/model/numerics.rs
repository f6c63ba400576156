//! Choices of the discretisation, of time and of output.

use sphorge_physics::hourglass::Counted;
use sphorge_physics::kernel::Kernel;
use sphorge_physics::pair::{EnergySplit, PairForm};
use sphorge_physics::step_control::StepChange;

/// Arithmetic of the pair sums; state is always accumulated in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Pair sums in single precision on positions relative to a near origin.
    #[default]
    Mixed,
    /// Everything in double precision.
    Double,
}

/// Time integration scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Kick-drift-kick leapfrog.
    #[default]
    Leapfrog,
    /// Monaghan's (1989) predictor–corrector.
    PredictorCorrector,
}

/// Correction of the kernel gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GradientCorrection {
    /// Plain kernel gradient.
    #[default]
    None,
    /// Linear-exact gradient in the velocity gradient and, adjoint, in the force.
    Linear,
}

/// Source of the temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TemperatureSource {
    /// Heat of plastic work.
    #[default]
    PlasticWork,
    /// Internal energy less cold, elastic and stored plastic energy (shock heating).
    Energy,
}

/// Course of the smoothing length over time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SmoothingLength {
    /// As at the start.
    #[default]
    Constant,
    /// `dh/dt = (h/d) div v`, which with the continuity equation is `h = h_0 (rho_0/rho)^(1/d)`: as many neighbours in expanded as in
    /// compressed material.
    FollowDensity {
        /// Largest ratio to the initial smoothing length, and one over the smallest.
        factor: f64,
    },
}

/// Artificial stress (Gray, Monaghan & Swift 2001).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArtificialStress {
    /// Strength `eps`.
    pub epsilon: f64,
    /// Exponent `n`.
    pub exponent: u32,
}

/// Numerical options.
#[derive(Clone, Debug, PartialEq)]
pub struct Numerics {
    /// Smoothing kernel.
    pub kernel: Kernel,
    /// Time integrator.
    pub integrator: Integrator,
    /// Precision of pair sums.
    pub precision: Precision,
    /// Which pair of adjoint sums.
    pub pair_form: PairForm,
    /// Kernel gradient correction.
    pub gradient_correction: GradientCorrection,
    /// Linear artificial viscosity `alpha`.
    pub viscosity_alpha: f64,
    /// Quadratic artificial viscosity `beta`.
    pub viscosity_beta: f64,
    /// Linear viscosity of shocks along the pairs of the total Lagrangian form, `alpha_s`, beside the bulk viscosity;
    /// zero for none.
    pub viscosity_of_shocks: f64,
    /// Whether the linear viscosity of the total Lagrangian form acts on all waves, not on those of few particles alone.
    pub viscosity_of_all_waves: bool,
    /// Balsara's switch on the viscosity.
    pub balsara: bool,
    /// Artificial stress, if any.
    pub artificial_stress: Option<ArtificialStress>,
    /// XSPH strength `eps`, zero for none.
    pub xsph: f64,
    /// Restore the density by moving least squares every so many steps.
    pub mls_interval: Option<u64>,
    /// Sharing of pair work.
    pub energy_split: EnergySplit,
    /// Source of temperature.
    pub temperature: TemperatureSource,
    /// Rule for the smoothing length.
    pub smoothing_length: SmoothingLength,
}

/// Neighbour search strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// All particles, every step.
    EveryStep,
    /// Verlet lists with a skin, all rebuilt when two particles may have closed in by the skin.
    Skin {
        /// Skin as a share of the kernel radius.
        fraction: f64,
    },
    /// Particles whose plastic strain grows (Fraser).
    Adaptive(AdaptiveSearch),
    /// No one after the start: the sums of the total Lagrangian form, or in the updated Lagrangian one those of a list and kernel values
    /// that are kept as they were, as in the published table.
    Initial,
}

/// Fields for which the gradients of the total Lagrangian form are exact at the faces of bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceGradients {
    /// Linear ones.
    #[default]
    Linear,
    /// Quadratic ones, as inside bodies.
    Quadratic,
}

impl FaceGradients {
    /// How much of what counts as strain of hourglass springs.
    pub fn counted(self) -> Counted {
        match self {
            Self::Linear => Counted::LINEAR,
            Self::Quadratic => Counted::QUADRATIC,
        }
    }
}

/// Which configuration the sums are taken in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Formulation {
    /// The present one: Cauchy stress over current neighbours.
    #[default]
    UpdatedLagrangian,
    /// The initial one, or the one at its last renewal: deformation gradient and first Piola–Kirchhoff stress with corrected gradients over
    /// the neighbours there.
    TotalLagrangian {
        /// Strength of the hourglass control, zero for none.
        hourglass: f64,
        /// What gradients are exact for at faces.
        faces: FaceGradients,
        /// Principal stretch at which a body has come apart, and its present configuration becomes the one the sums are taken in;
        /// `None`: the initial one for good.
        renewal: Option<f64>,
        /// Whether a body meets itself where it folds, as [`super::Model::has_self_contact`] has it.
        self_contact: bool,
    },
}

impl Formulation {
    /// Whether reference configurations are renewed where bodies come apart.
    pub fn renews(&self) -> bool {
        matches!(self, Self::TotalLagrangian { renewal: Some(_), .. })
    }

    /// Whether gradients are exact for quadratic fields at the faces of bodies.
    pub fn is_quadratic_at_faces(&self) -> bool {
        matches!(self, Self::TotalLagrangian { faces: FaceGradients::Quadratic, .. })
    }
}

/// Which rows of the neighbour lists are rebuilt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveSearch {
    /// Plastic strain increment above which the row of a particle is rebuilt.
    pub plastic_strain_threshold: f64,
    /// The increment since the last search of the particle, not that of the last step.
    pub accumulate: bool,
    /// Whose rows are rebuilt too so that no pair is missed: particles whose accumulated strain since their last search exceeds
    /// this bound, and contact candidates. `None`: the paper's rule alone, with the kernel values of the last search.
    pub guard: Option<f64>,
}

impl AdaptiveSearch {
    /// Share of the particles above which, with the guard, all are searched: that costs less than a search of some and their neighbours.
    pub const ALL_ABOVE: f64 = 0.5;

    /// Images in planes of symmetry and periodic ends are made for particles this much farther away than the kernel reaches, as a share of the reach,
    /// and made again with a full search when a particle has moved as far.
    pub const IMAGE_MARGIN: f64 = 0.5;

    /// Steps from one sum of the moments to the next where the guard of adaptive search alone needs them. Waves go five smoothing lengths in them,
    /// and a neighbourhood that strains by the guard's bound changes its moments by as much, half a per cent.
    pub const STRAIN_CORRECTION_STEPS: u64 = 16;
}

/// Largest Courant number of contacts and penalty walls, beyond which theirs does not grow with that of the waves. Bodies
/// that meet at facets then step at no more than half of the stability limit of their springs (`facet::MARGIN`), which
/// leaves room for the stiffness and the viscosity of the material behind them: of the energy of plates that met at 100 m/s
/// the integration in time lost nearly all at a Courant number of 0.6.
const MOST_OF_CONTACTS: f64 = 1.0 / 3.0;

/// Time control.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeControl {
    /// End time, s.
    pub end: f64,
    /// Courant number on the longitudinal sound speed plus |mu|.
    pub courant: f64,
    /// Upper bound of the step, s.
    pub max_step: Option<f64>,
    /// Fixed step, s (the limit is still reported; a fixed step above it is an error at run time).
    pub fixed_step: Option<f64>,
    /// Steps that change too much are taken back; never with a fixed step.
    pub step_control: Option<StepControl>,
    /// Stop when kinetic energy has fallen below this share of its initial value.
    pub stop_kinetic_fraction: Option<f64>,
    /// Stop after this many steps.
    pub max_steps: Option<u64>,
}

impl TimeControl {
    /// Courant number of contacts between bodies and of penalty walls. A fixed step is held against limits of one number.
    pub fn courant_of_contacts(&self) -> f64 {
        if self.fixed_step.is_some() { self.courant } else { self.courant.min(MOST_OF_CONTACTS) }
    }

    /// Share of the limit of viscosity that a step may take. A fixed step is held against limits of one number.
    pub fn share_of_damping(&self) -> f64 {
        if self.fixed_step.is_some() { self.courant } else { 1.0 }
    }
}

/// When a step is taken back and repeated smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl {
    /// What a step may change of a particle at most.
    pub largest: StepChange,
    /// How often a step is repeated, each time at half its size, before the run is stopped; above 0.
    pub repeats: u32,
}

/// What to write and when.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputControl {
    /// Time between frames, s.
    pub frame_interval: f64,
    /// Time between rows of the history, s; a row is that of the first step past its time.
    pub history_interval: f64,
    /// Names of the fields to write; see [`crate::particles::FIELDS`].
    pub fields: Vec<String>,
    /// Whether values of frames are compressed.
    pub is_compressed: bool,
    /// Whether each of the processes that share a run writes its own piece of a frame.
    pub in_pieces: bool,
}
