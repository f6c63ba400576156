//! The deck as written. Each key is declared once, here: its type gives the unit, its comment the meaning, and the
//! schema, the reference page, the check for unknown keys and `--set` follow from the declaration.

mod body;
mod boundary;
mod contact;
mod law;
mod material;
mod measure;
mod numerics;
mod observed;
mod shape;
mod thermal;
mod warnings;

pub(crate) use body::*;
pub(crate) use boundary::*;
pub(crate) use contact::*;
pub(crate) use law::*;
pub(crate) use material::*;
pub(crate) use measure::*;
pub(crate) use numerics::*;
pub(crate) use observed::*;
pub(crate) use shape::*;
pub(crate) use thermal::*;
pub(crate) use warnings::*;

use super::choice::*;
use super::declare::{Named, tables};
use super::value::*;

tables! {
    /// A Sphorge deck.
    RawDeck {
        /// One-line title.
        title: Option<Word>, example "Taylor impact of an Armco iron plate", default "";
        /// Space dimensions; they define the number of components of every vector in the deck.
        dimensions: Option<Choice<DimensionsWord>>, or fault, example "plane-strain";
        /// Method: a consistent set of the choices below, each of which the deck can override. A deck without a method whose `search` finds
        /// the current neighbours uses `updated-lagrangian`.
        method: Option<Choice<MethodWord>>, example "updated-lagrangian", default "total-lagrangian";
        /// Neighbour search strategy.
        search: Option<ScalarOr<Choice<SearchWord>, RawSearch>>, example "every-step", otherwise "that of the method";
        /// Contact between bodies.
        contact: Option<RawContactChoice>, example { "penalty": { "friction": 0.1 } }, otherwise "`penalty` in the total Lagrangian form, else `kernel-sum`";
        /// Compare the neighbour lists with an exact search every so many steps; missed pairs are reported in `history.csv` and
        /// `summary.json`.
        audit: Option<Count>, example 100, otherwise "never";
        /// Acceleration of every particle.
        gravity: Option<VectorOf<Acceleration>>, example ["0 m/s^2", "-9.81 m/s^2"], otherwise "none";
        /// Particles: resolution and smoothing.
        particles: Option<RawParticles>, or fault;
        /// Numerical options.
        numerics: RawNumerics, or empty;
        /// End of the run and time step.
        time: Option<RawTime>, or fault;
        /// Bodies of particles; at least one, at most 1000.
        body: Vec<RawBody>, or empty;
        /// Named sets of particles, selected in the initial configuration; at most 32.
        region: Vec<RawRegion>, or empty;
        /// Rigid walls; at most 1000.
        wall: Vec<RawWall>, or empty;
        /// Planes of symmetry.
        symmetry: Vec<RawSymmetry>, or empty;
        /// Periodic axes.
        periodic: RawPeriodic, or empty;
        /// Fixed or driven particles; at most 96.
        motion: Vec<RawMotion>, or empty;
        /// Heat conduction; there is none without this table.
        thermal: Option<RawThermal>;
        /// What to write and when.
        output: RawOutput, or empty;
        /// Numbers to report: columns of `history.csv`, entries of `summary.json`; at most 1000.
        measure: Vec<RawMeasure>, or empty;
        /// Particles to follow and fixed points to observe: columns of `history.csv`; at most 1000.
        tracer: Vec<RawTracer>, or empty;
        /// Planes through which the force is reported: columns of `history.csv`; at most 1000.
        section: Vec<RawSection>, or empty;
        /// Limits of the checks for numerical failure during the run.
        warnings: RawWarnings, or empty;
        /// New materials, or changes to those of the catalogue, by name; at most 10000.
        material: Named<RawMaterial>, or empty;
    }

    /// Particles: resolution and smoothing.
    RawParticles {
        /// Distance between neighbouring lattice particles; it sets the resolution.
        spacing: Option<Given<Length>>, or fault, example "0.3 mm";
        /// Smoothing length over spacing, h / spacing.
        smoothing: Option<Given<Number>>, example 1.2, otherwise "1.1 in the total Lagrangian form, else 1.2";
        /// Arrangement of the particles.
        lattice: Option<Choice<ArrangementWord>>, example "hexagonal",
            otherwise "`rings` in the total Lagrangian form for bodies they fill, else `square`";
        /// Placement of a square or cubic lattice in a shape.
        placement: Option<Choice<PlacementWord>>, example "on-faces", default "cell-centres";
    }

    /// End of the run and time step.
    RawTime {
        /// Time at which the run ends.
        end: Option<Given<Time>>, or fault, example "60 us";
        /// Courant number, on the longitudinal sound speed plus |mu|; above 0, at most 1.
        courant: Option<Given<Number>>, example 0.3, otherwise "0.45 in the total Lagrangian form where all bodies have strength and `faces` are linear, else 0.3";
        /// Upper bound of the time step.
        max_step: Option<Given<Time>>, example "10 ns", otherwise "none";
        /// Time step to use instead of the stable one. The stable one is `courant` of the limit; a fixed step may use up this margin, where accuracy and in the end stability are lost without a word, and beyond the limit itself the run stops: compare with half the step. Steps are shortened to end at frames and at the end of the run, not for rows of the history; `max-step` bounds a fixed step, too.
        fixed_step: Option<Given<Time>>, example "5 ns", otherwise "none";
        /// When a step is rejected and repeated at half its size. A fixed step is never rejected.
        step_control: RawStepControl, or empty;
        /// Stop when the kinetic energy has fallen below this share of its initial value.
        stop_kinetic_fraction: Option<Given<Number>>, example 0.01, otherwise "none";
        /// Stop after this many steps.
        max_steps: Option<Count>, example 1000, otherwise "none";
    }

    /// Largest changes of a particle in a step; a step beyond them is rejected and repeated at half its size.
    #[derive(Default)]
    RawStepControl {
        /// Change of the density, over the density.
        density: Option<Given<Number>>, example 0.1, default 0.2;
        /// Strain of the material.
        stretch: Option<Given<Number>>, example 0.1, default 0.25;
        /// Change of the specific internal energy, over its value plus the square of the sound speed at rest.
        energy: Option<Given<Number>>, example 0.05, default 0.1;
        /// Distance that the acceleration of the step moves the particle, over the smoothing length.
        jump: Option<Given<Number>>, example 0.05, default 0.1;
        /// How often a step is repeated before the run is stopped, at most 100; 0 for no step control, which saves the memory of a second state.
        repeats: Option<Count>, example 5, default 10;
    }

    /// What to write and when.
    #[derive(Default)]
    RawOutput {
        /// Number of frames over the run, besides the initial one.
        frames: Option<Count>, example 50, default 50;
        /// Time between frames, instead of `frames`.
        frame_interval: Option<Given<Time>>, example "1 us", otherwise "end / frames";
        /// Time between rows of `history.csv`. A row is written at the first step past its time: steps are not shortened for it.
        history_interval: Option<Given<Time>>, example "0.1 us", otherwise "end / 500";
        /// Fields to write to frames. An adaptive search adds `adapted` to the default ones: particles that were searched in the last step.
        fields: Option<Vec<Choice<FieldWord>>>, example ["velocity", "plastic_strain"], otherwise "the default fields";
        /// Compression of the values in frames.
        compression: Option<Choice<CompressionWord>>, example "none", default "zlib";
        /// Files per frame of a run on MPI ranks; a single process writes one.
        pieces: Option<Choice<PiecesWord>>, example "one", default "each-rank";
    }
}
