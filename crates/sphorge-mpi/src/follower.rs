//! Every rank but the first: does what the first one tells.

use crate::protocol::Command;
use sphorge_engine::ranks::{Communicator, Ranks, SharedArchive};
use sphorge_engine::{Engine, Model, Part, Particles, RunFailure, StageSeconds, advance, start_part};
use std::sync::Arc;

/// A model and its particles as every rank has them at the start.
pub type Loaded = (Arc<Model>, Particles);

/// Follows the first rank until it ends, on as many threads, all of the machine if none are given. `load` makes a model and its particles of a
/// deck, given with its name, that the first rank has found in order.
///
/// # Errors
/// The first rank is lost, or there are no threads.
pub fn follow(
    communicator: Arc<dyn Communicator>,
    threads: Option<usize>,
    load: impl Fn(&str, &str) -> Option<Loaded> + Sync,
) -> Result<(), RunFailure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    let pool = pool.map_err(|error| RunFailure::of_engine(format!("there are no threads: {error}")))?;
    pool.install(|| receive_commands(&communicator, &load))
}

fn receive_commands(
    communicator: &Arc<dyn Communicator>,
    load: &dyn Fn(&str, &str) -> Option<Loaded>,
) -> Result<(), RunFailure> {
    let ranks = Ranks::new(communicator.clone());
    let mut part = None;
    loop {
        match Command::receive(&ranks)? {
            Command::Start { name, deck } => {
                // A former part goes before there is another one.
                drop(part.take());
                part = start(&ranks, communicator, load(&name, &deck))?;
            }
            Command::End => return Ok(()),
            command => {
                let Some(part) = part.as_deref_mut() else { continue };
                execute(&command, part, &ranks)?;
            }
        }
    }
}

/// A part of a run, if every rank could load it; its first rank tells of a failure.
fn start(
    ranks: &Ranks,
    communicator: &Arc<dyn Communicator>,
    loaded: Option<Loaded>,
) -> Result<Option<Box<dyn Part>>, RunFailure> {
    let everyone = !ranks.gather_one(loaded.is_some())?.contains(&false);
    Ok(loaded
        .filter(|_| everyone)
        .and_then(|(model, particles)| start_part(model, particles, communicator.clone()).ok()))
}

/// Does what all ranks do. What goes wrong with a step goes wrong on all of them, and the first one tells of it.
fn execute(command: &Command, part: &mut dyn Part, ranks: &Ranks) -> Result<(), RunFailure> {
    match command {
        Command::Start { .. } | Command::End => {}
        Command::Step(dt) => {
            let _ = advance(part as &mut dyn Engine, *dt, &mut StageSeconds::default());
        }
        Command::Ledger => {
            part.ledger()?;
        }
        Command::Collect(field) => {
            let _ = part.collect(field);
        }
        Command::Section(section) => {
            part.section_force(*section)?;
        }
        Command::Save => {
            save(part, ranks)?;
        }
        Command::Load => {
            load(part, ranks)?;
        }
    }
    Ok(())
}

/// Saves what this rank has of the state.
fn save(part: &mut dyn Part, ranks: &Ranks) -> Result<(), RunFailure> {
    let mut archive = SharedArchive::to_save(ranks, None);
    // The first rank says what it cannot save.
    let _ = part.persist(&mut archive);
    archive.end()
}

/// Loads its share of the state.
fn load(part: &mut dyn Part, ranks: &Ranks) -> Result<(), RunFailure> {
    let mut archive = SharedArchive::to_load(ranks, None);
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
