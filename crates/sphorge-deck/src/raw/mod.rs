//! The deck as written. Each key is declared once, here: its type gives the unit, its comment the meaning, and the
//! schema, the reference page, the check for unknown keys and `--set` follow from the declaration.

mod body;
mod boundary;
mod contact;
mod material;
mod measure;
mod numerics;
mod observed;
mod shape;
mod thermal;

pub(crate) use body::*;
pub(crate) use boundary::*;
pub(crate) use contact::*;
pub(crate) use material::*;
pub(crate) use measure::*;
pub(crate) use numerics::*;
pub(crate) use observed::*;
pub(crate) use shape::*;
pub(crate) use thermal::*;

use super::choice::*;
use super::value::*;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// A Sphorge deck.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "Sphorge deck")]
pub(crate) struct RawDeck {
    /// One line for people.
    #[schemars(extend("examples" = ["Taylor impact of an Armco iron plate"], "default" = ""))]
    pub(crate) title: Option<Word>,
    /// Space dimensions; they set the number of components of every vector in the deck.
    #[schemars(extend("examples" = ["plane-strain"]))]
    pub(crate) dimensions: Choice<DimensionsWord>,
    /// Neighbour search strategy.
    #[schemars(extend("examples" = ["every-step"], "default" = "skin"))]
    pub(crate) search: Option<ScalarOr<Choice<SearchWord>, RawSearch>>,
    /// How bodies meet.
    #[schemars(extend("examples" = [{ "penalty": { "friction": 0.1 } }], "default" = "kernel-sum"))]
    pub(crate) contact: Option<RawContactChoice>,
    /// Compare the neighbour lists with an exact search every so many steps; what they miss goes into `history.csv` and
    /// `summary.json`.
    #[schemars(extend("examples" = [100], "x-default" = "never"))]
    pub(crate) audit: Option<Count>,
    /// Acceleration of every particle.
    #[schemars(extend("examples" = [["0 m/s^2", "-9.81 m/s^2"]], "x-default" = "none"))]
    pub(crate) gravity: Option<VectorOf<Acceleration>>,
    /// Particles: resolution and smoothing.
    pub(crate) particles: RawParticles,
    /// Choices of the discretisation.
    #[serde(default)]
    pub(crate) numerics: RawNumerics,
    /// End of the run and time step.
    pub(crate) time: RawTime,
    /// Bodies of particles; at least one.
    #[serde(default)]
    pub(crate) body: Vec<RawBody>,
    /// Named sets of particles, chosen in the initial configuration; at most 32.
    #[serde(default)]
    pub(crate) region: Vec<RawRegion>,
    /// Rigid walls.
    #[serde(default)]
    pub(crate) wall: Vec<RawWall>,
    /// Planes of symmetry.
    #[serde(default)]
    pub(crate) symmetry: Vec<RawSymmetry>,
    /// Periodic axes.
    #[serde(default)]
    pub(crate) periodic: RawPeriodic,
    /// Held or driven particles.
    #[serde(default)]
    pub(crate) motion: Vec<RawMotion>,
    /// Heat that flows; no heat flows without this table.
    pub(crate) thermal: Option<RawThermal>,
    /// What to write and when.
    #[serde(default)]
    pub(crate) output: RawOutput,
    /// Numbers to report: columns of `history.csv`, entries of `summary.json`.
    #[serde(default)]
    pub(crate) measure: Vec<RawMeasure>,
    /// Particles to follow and points to watch: columns of `history.csv`.
    #[serde(default)]
    pub(crate) tracer: Vec<RawTracer>,
    /// Planes the force through which is written: columns of `history.csv`.
    #[serde(default)]
    pub(crate) section: Vec<RawSection>,
    /// Own materials, or changes to those of the catalogue, by name.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, RawMaterial>")]
    pub(crate) material: BTreeMap<Spanned<String>, RawMaterial>,
}

/// Particles: resolution and smoothing.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawParticles {
    /// Distance of neighbouring lattice particles; the key for resolution.
    #[schemars(extend("examples" = ["0.3 mm"]))]
    pub(crate) spacing: Given<Length>,
    /// Smoothing length over spacing, h / spacing.
    #[schemars(extend("examples" = [1.2], "default" = 1.2))]
    pub(crate) smoothing: Option<Given<Number>>,
    /// How particles are arranged.
    #[schemars(extend("examples" = ["hexagonal"], "default" = "square"))]
    pub(crate) lattice: Option<Choice<ArrangementWord>>,
    /// Where a square or cubic lattice sits in a shape.
    #[schemars(extend("examples" = ["on-faces"], "default" = "cell-centres"))]
    pub(crate) placement: Option<Choice<PlacementWord>>,
}

/// End of the run and time step.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawTime {
    /// Time at which the run ends.
    #[schemars(extend("examples" = ["60 us"]))]
    pub(crate) end: Given<Time>,
    /// Courant number, on the longitudinal sound speed plus |mu|; above 0, at most 1.
    #[schemars(extend("examples" = [0.3], "default" = 0.3))]
    pub(crate) courant: Option<Given<Number>>,
    /// Upper bound of the time step.
    #[schemars(extend("examples" = ["10 ns"], "x-default" = "none"))]
    pub(crate) max_step: Option<Given<Time>>,
    /// Time step to use instead of the stable one; larger than the stable one stops the run.
    #[schemars(extend("examples" = ["5 ns"], "x-default" = "none"))]
    pub(crate) fixed_step: Option<Given<Time>>,
    /// Stop when the kinetic energy has fallen below this share of its initial value.
    #[schemars(extend("examples" = [0.01], "x-default" = "none"))]
    pub(crate) stop_kinetic_fraction: Option<Given<Number>>,
    /// Stop after this many steps.
    #[schemars(extend("examples" = [1000], "x-default" = "none"))]
    pub(crate) max_steps: Option<Count>,
}

/// What to write and when.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawOutput {
    /// Number of frames over the run, beside the initial one.
    #[schemars(extend("examples" = [50], "default" = 50))]
    pub(crate) frames: Option<Count>,
    /// Time between frames, instead of `frames`.
    #[schemars(extend("examples" = ["1 us"], "x-default" = "end / frames"))]
    pub(crate) frame_interval: Option<Given<Time>>,
    /// Time between rows of `history.csv`. A row is that of the first step past its time: steps are not cut for it.
    #[schemars(extend("examples" = ["0.1 us"], "x-default" = "end / 500"))]
    pub(crate) history_interval: Option<Given<Time>>,
    /// Fields to write to frames. An adaptive search adds `adapted` to the usual ones: who was searched in the last step.
    #[schemars(extend("examples" = [["velocity", "plastic_strain"]], "x-default" = "the usual ones"))]
    pub(crate) fields: Option<Vec<Choice<FieldWord>>>,
}
