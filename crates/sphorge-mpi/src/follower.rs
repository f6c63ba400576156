//! Every rank but the first: does what the first one tells.

use crate::protocol::Command;
use sphorge_engine::persist::{Archive, MemoryArchive, Parts};
use sphorge_engine::ranks::{Communicator, Loaded, RankFiles, Ranks, SharedArchive};
use sphorge_engine::reduction::ReductionMessage;
use sphorge_engine::{Cpu, Engine, Model, Part, PartKind, RunFailure, StageSeconds, advance};
use std::sync::Arc;

/// Follows the first rank until it ends, on as many threads, all of the machine if none are given. `files` reads and writes what this rank has to.
///
/// # Errors
/// The first rank is lost, or there are no threads.
pub fn follow(
    communicator: Arc<dyn Communicator>,
    threads: Option<usize>,
    files: &dyn RankFiles,
) -> Result<(), RunFailure> {
    follow_with(communicator, threads, &[Arc::new(Cpu)], files)
}

/// The same with whichever of some kinds of engines the first rank has, by its name.
///
/// # Errors
/// See [`follow`].
pub fn follow_with(
    communicator: Arc<dyn Communicator>,
    threads: Option<usize>,
    kinds: &[Arc<dyn PartKind>],
    files: &dyn RankFiles,
) -> Result<(), RunFailure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    let pool = pool.map_err(|error| RunFailure::of_engine(format!("cannot start the threads: {error}")))?;
    pool.install(|| receive_commands(&communicator, kinds, files))
}

fn receive_commands(
    communicator: &Arc<dyn Communicator>,
    kinds: &[Arc<dyn PartKind>],
    files: &dyn RankFiles,
) -> Result<(), RunFailure> {
    let ranks = Ranks::new(communicator.clone());
    let mut following = None;
    loop {
        match Command::receive(&ranks)? {
            Command::Start { engine, name, deck } => {
                // A former part goes before there is another one.
                drop(following.take());
                let kind = kinds.iter().find(|kind| kind.name() == engine).cloned();
                let loaded = kind.and_then(|kind| Some((kind, files.load(&name, &deck)?)));
                following = start(&ranks, communicator, loaded)?;
            }
            Command::End => return Ok(()),
            command => {
                let Some(following) = &mut following else { continue };
                following.execute(command, &ranks, files)?;
            }
        }
    }
}

/// A part of a run, if every rank could load it; its first rank tells of a failure.
fn start(
    ranks: &Ranks,
    communicator: &Arc<dyn Communicator>,
    loaded: Option<(Arc<dyn PartKind>, Loaded)>,
) -> Result<Option<Following>, RunFailure> {
    let everyone = !ranks.gather_one(loaded.is_some())?.contains(&false);
    let Some((kind, (model, particles))) = loaded.filter(|_| everyone) else { return Ok(None) };
    let part = kind.start_part(model.clone(), particles, communicator.clone()).ok();
    Ok(part.map(|part| Following { model, part, kept: None }))
}

/// What this rank has of a run.
struct Following {
    model: Arc<Model>,
    part: Box<dyn Part>,
    /// The part of a state that is kept in memory.
    kept: Option<MemoryArchive>,
}

impl Following {
    /// Does what all ranks do. What goes wrong with a step goes wrong on all of them, and the first one tells of it.
    fn execute(&mut self, command: Command, ranks: &Ranks, files: &dyn RankFiles) -> Result<(), RunFailure> {
        let part = self.part.as_mut();
        match command {
            Command::Start { .. } | Command::End => {}
            Command::Step(dt) => {
                let _ =
                    advance(part as &mut dyn Engine, dt, &mut StageSeconds::default(), &mut StageSeconds::default());
            }
            Command::Ledger => {
                part.ledger()?;
            }
            Command::Collect(field) => {
                let _ = part.collect(&field);
            }
            Command::Reduce(message) => {
                let message = ReductionMessage::read(&message);
                let Some(reduction) = message.as_ref().and_then(ReductionMessage::reduction) else {
                    return Err(RunFailure::of_engine("the first rank asks for an unknown sum".to_owned()));
                };
                part.reduce(&reduction)?;
            }
            Command::Section(section) => {
                part.section_force(section)?;
            }
            Command::Write(request) => {
                let written = files.write(&request, ranks.rank(), &self.model, part.own());
                let _ = ranks.first_failure(written)?;
            }
            Command::Save => {
                let mut archive = SharedArchive::to_save(ranks, None);
                // The first rank says what it cannot save.
                let _ = part.persist(&mut archive);
                archive.end()?;
            }
            Command::SaveParts(parts) => {
                let saved = self.save_part(parts, ranks, files);
                let _ = ranks.first_failure(saved)?;
            }
            Command::Load => load(part, ranks, None)?,
            Command::LoadParts(Parts::Memory) => {
                let is_kept = self.kept.as_ref().map(drop).ok_or_else(|| "no state was kept".to_owned());
                if ranks.first_failure(is_kept)?.is_ok() {
                    let mut reader = self.kept.as_ref().map(MemoryArchive::reader);
                    load(part, ranks, reader.as_mut().map(|reader| reader as &mut dyn Archive))?;
                }
            }
            Command::LoadParts(Parts::Files(request)) => {
                let opened = files.open(&request, ranks.rank(), ranks.size());
                let (mut archive, opened) = match opened {
                    Ok(archive) => (Some(archive), Ok(())),
                    Err(why) => (None, Err(why)),
                };
                if ranks.first_failure(opened)?.is_ok() {
                    load(part, ranks, archive.as_mut().map(|archive| archive.as_mut() as &mut dyn Archive))?;
                }
            }
        }
        Ok(())
    }

    /// Saves what this rank has of the state.
    fn save_part(&mut self, parts: Parts, ranks: &Ranks, files: &dyn RankFiles) -> Result<(), String> {
        let part = self.part.as_mut();
        let mut save = |archive: &mut dyn Archive| part.persist(&mut SharedArchive::to_save_part(ranks, archive));
        match parts {
            Parts::Files(request) => files.save(&request, ranks.rank(), &mut save),
            Parts::Memory => {
                // Before there is another one: there may be no room for two.
                self.kept = None;
                let mut kept = MemoryArchive::new();
                save(&mut kept).map_err(|error| error.to_string())?;
                self.kept = Some(kept);
                Ok(())
            }
        }
    }
}

/// Loads its share of the state.
fn load<'a>(part: &mut dyn Part, ranks: &'a Ranks, own: Option<&'a mut dyn Archive>) -> Result<(), RunFailure> {
    let mut archive = SharedArchive::to_load(ranks, own);
    let loaded = part.persist(&mut archive);
    archive.end()?;
    go_on(part, ranks, loaded.is_ok()).map(|_| ())
}

/// Goes on from a state if every rank could load its own; says whether all could.
pub(crate) fn go_on(part: &mut dyn Part, ranks: &Ranks, loaded: bool) -> Result<bool, RunFailure> {
    let all = !ranks.gather_one(loaded)?.contains(&false);
    if all {
        part.complete()?;
    }
    Ok(all)
}
