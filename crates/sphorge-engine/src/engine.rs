//! The contract of an engine: what takes particles through a step, and what can be asked of it.
//!
//! An engine owns the columns of the particles, wherever they are: in memory, on a card, on many ranks. [`crate::Simulation`] calls the
//! stages in the order of the papers; the rest of the program asks for sums ([`Engine::reduce`], [`Engine::ledger`]) and copies
//! of fields ([`Engine::read`]), never for the columns themselves.

use crate::halo::FieldSet;
use crate::persist::{Archive, ArchiveError};
use crate::ranks::Communicator;
use crate::reduction::{FieldSource, QueuedSums, Reduction};
use crate::{Audit, Column, Drive, Ledger, LimitReason, Model, Particles, RunFailure};
use std::sync::Arc;

/// Longest stable next step, and what limits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeStepLimit {
    /// Largest stable step, s.
    pub dt: f64,
    /// The rule that set it.
    pub reason: LimitReason,
}

impl TimeStepLimit {
    /// The smaller of two limits, the first of equals.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        if other.dt < self.dt { other } else { self }
    }
}

/// Share of the work a search did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SearchReport {
    /// Share of the particles searched in this step.
    pub searched_fraction: f64,
}

/// A kind of engine: knows what it can run, and starts it.
pub trait EngineKind: Send + Sync + std::fmt::Debug {
    /// Name on the command line and in the summary, such as `cpu`.
    fn name(&self) -> &'static str;

    /// Name of the engine whose saved states this one saves and loads: its own, unless it computes the same in another way.
    fn saved_as(&self) -> &'static str {
        self.name()
    }

    /// Whether this engine can run a model here and now.
    ///
    /// # Errors
    /// What it cannot do.
    fn supports(&self, model: &Model) -> Result<(), Unsupported>;

    /// Processes that share what is started.
    fn ranks(&self) -> usize {
        1
    }

    /// Takes note of the deck, with its name, that what is started next is of; for engines whose other processes read it themselves.
    fn take_deck(&self, name: &str, deck: &str) {
        let _ = (name, deck);
    }

    /// Whether [`Self::start`] adds the columns of the state that particles do not have yet, once it has put them in order: less is moved then.
    fn completes_particles(&self) -> bool {
        false
    }

    /// Takes over particles in their initial configuration. Threads are those of the rayon pool it is called in.
    ///
    /// # Errors
    /// There is no room, or the device does not answer.
    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure>;
}

/// A kind of engine of which several, each on a rank of its own, can share the particles of a run.
pub trait PartKind: EngineKind {
    /// Name of the engine that all ranks together are, in summaries.
    fn shared_name(&self) -> &'static str;

    /// Whether parts of this engine can run a model that it can run in one process.
    ///
    /// # Errors
    /// What they cannot do.
    fn supports_in_parts(&self, model: &Model) -> Result<(), Unsupported> {
        let _ = model;
        Ok(())
    }

    /// Starts the part of this rank: every rank has the same model and all particles, of which it keeps its share.
    ///
    /// # Errors
    /// There are too few particles for so many ranks, there is no room, or a rank is lost. All ranks fail together.
    fn start_part(
        &self,
        model: Arc<Model>,
        particles: Particles,
        communicator: Arc<dyn Communicator>,
    ) -> Result<Box<dyn Part>, RunFailure>;
}

/// Why an engine cannot run a model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}")]
pub struct Unsupported {
    /// What it cannot do, such as "heat conduction".
    pub what: String,
    /// The way out.
    pub help: String,
}

/// An engine that has some of the particles of a run on many ranks. Every stage, and whatever is asked of it, is called on all ranks in the same
/// order; what comes back is of all particles and, but for what [`Self::collect`] and [`Engine::read`] give, the same on all ranks.
pub trait Part: Engine {
    /// A field of the particles of all ranks, in the order they are summed in, on the first rank; nothing on the others.
    ///
    /// # Errors
    /// There is no such field, or a rank is lost.
    fn collect(&self, field: &str) -> Result<Column<'static>, RunFailure>;
    /// The force through a section, by its number among those of the model, as [`Engine::reduce`] gives it.
    ///
    /// # Errors
    /// A rank is lost.
    fn section_force(&self, section: usize) -> Result<Vec<f64>, RunFailure>;
    /// Completes a state that [`Engine::persist`] has loaded, once all ranks have loaded theirs.
    ///
    /// # Errors
    /// A rank is lost.
    fn complete(&mut self) -> Result<(), RunFailure>;
    /// Particles of all ranks; [`Engine::count`] are those of this one.
    fn total(&self) -> usize;
    /// The particles of this rank, in the order it has them in.
    fn own(&self) -> &dyn FieldSource;
}

/// Processes that write together what they share, each its own particles.
pub trait InPieces {
    /// Number of the processes.
    fn pieces(&self) -> usize;
    /// Has each process write its particles: `request` tells the others what to do, `write` does it for this one, the first. The inner error is
    /// what one of them could not do.
    ///
    /// # Errors
    /// A process is lost.
    fn write(
        &self,
        request: &str,
        write: &mut dyn FnMut(&dyn FieldSource) -> Result<(), String>,
    ) -> Result<Result<(), String>, RunFailure>;
}

/// The stages of a step, and what can be asked between steps. Every stage can fail: a card can be lost, a rank can die.
///
/// Stages that serve one feature do nothing unless an engine says what: it leaves them out where [`EngineKind::supports`] refuses the feature, or
/// where its work is done in another stage.
pub trait Engine: Send {
    /// Opens a step of size `dt` (s): boundary motion, kick and drift or prediction. A step of size zero evaluates the initial rates.
    ///
    /// # Errors
    /// Here and below: the engine is lost, or the state has no meaning any more.
    fn begin(&mut self, dt: f64) -> Result<(), RunFailure>;
    /// Makes neighbour lists and ghosts valid for the positions just reached.
    fn refresh_neighbors(&mut self) -> Result<SearchReport, RunFailure>;
    /// Comparison of the lists with an exact search, if one is due.
    fn audit(&mut self) -> Result<Option<Audit>, RunFailure> {
        Ok(None)
    }
    /// Sends what ghosts take over of a set of fields and does not wait for it. Until it is finished, ghosts are not read and particles keep these fields.
    fn begin_exchange(&mut self, fields: FieldSet) -> Result<(), RunFailure> {
        let _ = fields;
        Ok(())
    }
    /// Brings the fields of the set that is on its way, of all ghosts, to those of the particles they stand for.
    fn finish_exchange(&mut self, fields: FieldSet) -> Result<(), RunFailure> {
        let _ = fields;
        Ok(())
    }
    /// Both at once.
    fn exchange(&mut self, fields: FieldSet) -> Result<(), RunFailure> {
        self.begin_exchange(fields)?;
        self.finish_exchange(fields)
    }
    /// Velocity gradient and density of particles that read no ghost, while these are on their way; [`Self::kinematics`] leaves them out then.
    fn inner_kinematics(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    /// Velocity gradient and density.
    fn kinematics(&mut self) -> Result<(), RunFailure>;
    /// Density re-initialisation, if one is due.
    fn restore_density(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    /// Gradient correction where forces are evaluated, if it is not that of the velocity gradient.
    fn correct_gradients(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    /// Where particles stand for the contact, of bodies whose faces follow their deformation.
    fn find_faces(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    /// Contact overlaps.
    fn find_overlaps(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    /// Forces of walls and contacts, and gravity. What acts on faces, not on centres, has moments, which the stress takes up.
    fn push_faces(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    /// Trial stress, equation of state, return mapping, temperature.
    fn stress(&mut self) -> Result<(), RunFailure>;
    /// Sums that the forces read of neighbours: heat flow in the initial configuration.
    fn intermediate_sums(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    /// What pairs do to particles that read no ghost, while these are on their way; [`Self::forces`] leaves it out then.
    fn inner_forces(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    /// Momentum, energy, viscosity, artificial stress, XSPH, heat; contact, walls and gravity as they were worked out.
    fn forces(&mut self) -> Result<(), RunFailure>;
    /// Closes the step: correction or second kick.
    fn finish(&mut self) -> Result<(), RunFailure>;
    /// Every value finite, every density positive, and nothing changed in this step by more than `time.step-control` allows. A failure says
    /// whether a smaller step may go well ([`RunFailure::step_may_be_smaller`]).
    fn guard(&self) -> Result<(), RunFailure>;
    /// Longest stable next step.
    fn time_step_limit(&self) -> Result<TimeStepLimit, RunFailure>;

    /// Processes that share the particles.
    fn ranks(&self) -> usize {
        1
    }
    /// Most work of one of them over the mean of all, counted in pairs, in the last step.
    fn imbalance(&self) -> f64 {
        1.0
    }
    /// Share of the particles whose pairs are summed while ghosts are on their way.
    fn inner_share(&self) -> f64 {
        0.0
    }
    /// Seconds that this process has waited for messages of others or sent its own.
    fn waited(&self) -> f64 {
        0.0
    }
    /// Number of particles.
    fn count(&self) -> usize;
    /// Ordered pairs inside the kernel support at the last kinematics stage.
    fn pairs(&self) -> u64;
    /// Conservation sums.
    fn ledger(&self) -> Result<Ledger, RunFailure>;
    /// A sum, mean or extremum over particles, taken where the columns are; see [`Reduction`] for what comes back.
    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure>;
    /// The ledger and these sums as they are now: they are queued behind what was asked of the engine before, and waited for when it has gone on.
    /// Nothing where summing them now costs no wait, as on a processor.
    ///
    /// # Errors
    /// As above.
    fn queue_sums(&self, asked: &[Reduction<'_>]) -> Result<Option<Box<dyn QueuedSums>>, RunFailure> {
        let _ = asked;
        Ok(None)
    }
    /// A field of [`crate::particles::FIELDS`] of all particles, in the order of their `id`.
    ///
    /// # Errors
    /// As above, or there is no such field.
    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure>;
    /// All fields as they are now, to be read elsewhere while the engine goes on: a copy of them is queued behind what was asked of the engine before.
    /// Nothing where reading them now costs no wait, as on a processor.
    ///
    /// # Errors
    /// As above.
    fn detach(&self) -> Result<Option<Box<dyn FieldSource + Send>>, RunFailure> {
        Ok(None)
    }
    /// The processes that share the particles, where each can write its own.
    fn in_pieces(&self) -> Option<&dyn InPieces> {
        None
    }
    /// Whether a program can give it loads and velocities of bodies between steps.
    fn can_be_driven(&self) -> bool {
        false
    }
    /// If a program has given loads or velocities that act: which bodies have a load, and which motions a velocity of it.
    fn driven(&self) -> Option<(Vec<bool>, Vec<bool>)> {
        None
    }
    /// Loads and velocities from the next step on; their work and impulse are booked like those of gravity and prescribed motions. They are part of the saved state.
    ///
    /// # Errors
    /// It cannot be driven, or the numbers do not fit the model.
    fn drive(&mut self, drive: &Drive) -> Result<(), RunFailure> {
        let _ = drive;
        Err(RunFailure::of_engine("this engine takes no loads from a program".to_owned()))
    }
    /// Saves everything that the steps to come depend on, or loads it into an engine that was started with the same model.
    ///
    /// # Errors
    /// The archive holds something else.
    fn persist(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError>;
    /// Bytes held by columns, lists and scratch.
    fn memory_bytes(&self) -> u64;
    /// Name of the device that computes, where that is not the processor.
    fn device(&self) -> Option<String> {
        None
    }
}
