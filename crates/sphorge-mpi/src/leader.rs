//! The first rank: an engine that the rest of the program drives as if it were alone.

use crate::follower::go_on;
use crate::protocol::Command;
use sphorge_engine::halo::FieldSet;
use sphorge_engine::persist::{Archive, ArchiveError, Parts, require};
use sphorge_engine::ranks::{Communicator, Ranks, SharedArchive};
use sphorge_engine::reduction::{self, Reduction, ReductionMessage};
use sphorge_engine::{
    Audit, Column, Cpu, Engine, EngineKind, FieldSource, InPieces, Ledger, Model, Part, PartKind, Particles,
    RunFailure, SearchReport, TimeStepLimit, Unsupported,
};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

/// The kind of engine that the first of several ranks has. Once it and those made of it ([`Leader::with`]) are dropped the others end ([`crate::follow`]).
#[derive(Debug)]
pub struct Leader {
    /// What computes on each rank.
    kind: Arc<dyn PartKind>,
    crew: Arc<Crew>,
    /// Name and text of the deck that is run.
    deck: Mutex<(String, String)>,
}

/// The ranks that follow the first one, until nobody leads them any more.
#[derive(Debug)]
struct Crew {
    communicator: Arc<dyn Communicator>,
    ranks: Ranks,
}

impl Leader {
    /// The first of the ranks that a communicator joins, which compute on processors.
    pub fn new(communicator: Arc<dyn Communicator>) -> Self {
        Self::of(Arc::new(Cpu), communicator)
    }

    /// The same of ranks that compute on what engines of a kind do.
    pub fn of(kind: Arc<dyn PartKind>, communicator: Arc<dyn Communicator>) -> Self {
        let crew = Crew { ranks: Ranks::new(communicator.clone()), communicator };
        Self { kind, crew: Arc::new(crew), deck: Mutex::default() }
    }

    /// The same ranks with another kind of engine.
    #[must_use]
    pub fn with(&self, kind: Arc<dyn PartKind>) -> Self {
        Self { kind, crew: self.crew.clone(), deck: Mutex::default() }
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        // Where this one is lost in the middle of something, others do not wait for a command. One that is lost is not told.
        if !std::thread::panicking() {
            let _ = Command::End.broadcast(&self.ranks);
        }
    }
}

impl EngineKind for Leader {
    fn name(&self) -> &'static str {
        self.kind.shared_name()
    }

    fn saved_as(&self) -> &'static str {
        self.kind.name()
    }

    fn ranks(&self) -> usize {
        self.crew.ranks.size()
    }

    fn supports(&self, model: &Model) -> Result<(), Unsupported> {
        self.kind.supports(model)?;
        self.kind.supports_in_parts(model)
    }

    fn take_deck(&self, name: &str, deck: &str) {
        *self.deck.lock().unwrap_or_else(PoisonError::into_inner) = (name.to_owned(), deck.to_owned());
    }

    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        let (name, deck) = self.deck.lock().unwrap_or_else(PoisonError::into_inner).clone();
        Command::Start { engine: self.kind.name().to_owned(), name, deck }.broadcast(&self.crew.ranks)?;
        if let Some(rank) = self.crew.ranks.gather_one(true)?.iter().position(|loaded| !loaded) {
            return Err(RunFailure::of_engine(format!(
                "rank {rank} cannot load the deck that the first rank has loaded: it has less memory, or another version of the program"
            )));
        }
        let part = self.kind.start_part(model.clone(), particles, self.crew.communicator.clone())?;
        Ok(Box::new(LeadingEngine { model, part, ranks: self.crew.ranks.clone(), collected: RefCell::default() }))
    }
}

/// The engine of the first rank.
struct LeadingEngine {
    model: Arc<Model>,
    part: Box<dyn Part>,
    ranks: Ranks,
    collected: RefCell<Collected>,
}

/// Fields of the particles of all ranks that checks of what lies around particles have asked for since the last step, in the order of sums.
#[derive(Default)]
struct Collected {
    particles: Particles,
    known: BTreeSet<String>,
}

impl LeadingEngine {
    /// A field of the particles of all ranks, in the order they are summed in.
    fn collect(&self, field: &str) -> Result<Column<'static>, RunFailure> {
        Command::Collect(field.to_owned()).broadcast(&self.ranks)?;
        self.part.collect(field)
    }

    /// Keeps stored fields of the particles of all ranks until the next step, no other columns beside them: all of these particles are many.
    fn keep(&self, fields: &[&str]) -> Result<(), RunFailure> {
        for field in fields {
            if !self.collected.borrow().known.contains(*field) {
                let column = self.collect(field)?;
                let Collected { particles, known } = &mut *self.collected.borrow_mut();
                particles.set_column(field, &column);
                known.insert((*field).to_owned());
            }
        }
        Ok(())
    }

    /// Saves the state of all ranks as one process would.
    fn save(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        if let Some(parts) = archive.parts() {
            return self.save_parts(parts, archive);
        }
        Command::Save.broadcast(&self.ranks).map_err(lost)?;
        let mut shared = SharedArchive::to_save(&self.ranks, Some(archive));
        let saved = self.part.persist(&mut shared);
        shared.end().map_err(lost)?;
        saved
    }

    /// The same, each rank its part.
    fn save_parts(&mut self, parts: Parts, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        Command::SaveParts(parts).broadcast(&self.ranks).map_err(lost)?;
        let saved = self.part.persist(&mut SharedArchive::to_save_part(&self.ranks, archive));
        // Others have an error of their own as well, or none.
        let of_others = self.ranks.first_failure(Ok(())).map_err(lost)?;
        saved.and(of_others.map_err(ArchiveError::Part))
    }

    /// Loads a state that any number of ranks, or one process without them, has saved.
    fn load(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        *self.collected.borrow_mut() = Collected::default();
        match archive.parts() {
            None => Command::Load.broadcast(&self.ranks).map_err(lost)?,
            Some(parts) => {
                Command::LoadParts(parts).broadcast(&self.ranks).map_err(lost)?;
                self.ranks.first_failure(Ok(())).map_err(lost)?.map_err(ArchiveError::Part)?;
            }
        }
        let mut shared = SharedArchive::to_load(&self.ranks, Some(archive));
        let loaded = self.part.persist(&mut shared);
        shared.end().map_err(lost)?;
        let all = go_on(self.part.as_mut(), &self.ranks, loaded.is_ok()).map_err(lost)?;
        loaded.and_then(|()| require(all, "ranks"))
    }
}

fn lost(failure: RunFailure) -> ArchiveError {
    ArchiveError::Unsupported(failure.message)
}

impl InPieces for LeadingEngine {
    fn pieces(&self) -> usize {
        self.ranks.size()
    }
    fn write(
        &self,
        request: &str,
        write: &mut dyn FnMut(&dyn FieldSource) -> Result<(), String>,
    ) -> Result<Result<(), String>, RunFailure> {
        Command::Write(request.to_owned()).broadcast(&self.ranks)?;
        self.ranks.first_failure(write(self.part.own()))
    }
}

impl Engine for LeadingEngine {
    fn begin(&mut self, dt: f64) -> Result<(), RunFailure> {
        *self.collected.borrow_mut() = Collected::default();
        Command::Step(dt).broadcast(&self.ranks)?;
        self.part.begin(dt)
    }
    fn refresh_neighbors(&mut self) -> Result<SearchReport, RunFailure> {
        self.part.refresh_neighbors()
    }
    fn audit(&mut self) -> Result<Option<Audit>, RunFailure> {
        self.part.audit()
    }
    fn begin_exchange(&mut self, fields: FieldSet) -> Result<(), RunFailure> {
        self.part.begin_exchange(fields)
    }
    fn finish_exchange(&mut self, fields: FieldSet) -> Result<(), RunFailure> {
        self.part.finish_exchange(fields)
    }
    fn inner_kinematics(&mut self) -> Result<(), RunFailure> {
        self.part.inner_kinematics()
    }
    fn kinematics(&mut self) -> Result<(), RunFailure> {
        self.part.kinematics()
    }
    fn restore_density(&mut self) -> Result<(), RunFailure> {
        self.part.restore_density()
    }
    fn correct_gradients(&mut self) -> Result<(), RunFailure> {
        self.part.correct_gradients()
    }
    fn find_faces(&mut self) -> Result<(), RunFailure> {
        self.part.find_faces()
    }
    fn find_overlaps(&mut self) -> Result<(), RunFailure> {
        self.part.find_overlaps()
    }
    fn push_faces(&mut self) -> Result<(), RunFailure> {
        self.part.push_faces()
    }
    fn stress(&mut self) -> Result<(), RunFailure> {
        self.part.stress()
    }
    fn intermediate_sums(&mut self) -> Result<(), RunFailure> {
        self.part.intermediate_sums()
    }
    fn inner_forces(&mut self) -> Result<(), RunFailure> {
        self.part.inner_forces()
    }
    fn forces(&mut self) -> Result<(), RunFailure> {
        self.part.forces()
    }
    fn finish(&mut self) -> Result<(), RunFailure> {
        self.part.finish()
    }
    fn guard(&self) -> Result<(), RunFailure> {
        self.part.guard()
    }
    fn time_step_limit(&self) -> Result<TimeStepLimit, RunFailure> {
        self.part.time_step_limit()
    }
    fn ranks(&self) -> usize {
        self.ranks.size()
    }
    fn imbalance(&self) -> f64 {
        self.part.imbalance()
    }
    fn count(&self) -> usize {
        self.part.total()
    }
    fn inner_share(&self) -> f64 {
        self.part.inner_share()
    }
    fn waited(&self) -> f64 {
        self.part.waited()
    }
    fn pairs(&self) -> u64 {
        self.part.pairs()
    }
    fn ledger(&self) -> Result<Ledger, RunFailure> {
        Command::Ledger.broadcast(&self.ranks)?;
        self.part.ledger()
    }
    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        if let Reduction::SectionForce(section) = reduction {
            let Some(number) = self.model.sections.iter().position(|known| known == *section) else {
                return Ok(Vec::new());
            };
            Command::Section(number).broadcast(&self.ranks)?;
            return self.part.section_force(number);
        }
        if let Some(message) = ReductionMessage::of(reduction) {
            Command::Reduce(message.to_bytes()).broadcast(&self.ranks)?;
            return self.part.reduce(reduction);
        }
        // What looks at particles around others.
        self.keep(&reduction.fields())?;
        Ok(reduction::evaluate(reduction, &self.model, &self.collected.borrow().particles))
    }
    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        let column = self.collect(field)?;
        Ok(match self.collect("id")? {
            Column::Integer(id) => column.by_id(&id),
            _ => column,
        })
    }
    fn persist(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        if archive.is_saving() { self.save(archive) } else { self.load(archive) }
    }
    fn in_pieces(&self) -> Option<&dyn InPieces> {
        (self.ranks.size() > 1).then_some(self)
    }
    /// Of this rank.
    fn memory_bytes(&self) -> u64 {
        self.part.memory_bytes()
    }
}
