//! Ranks that are processes of MPI.

use crate::in_flight::InFlight;
use mpi::Threading;
use mpi::environment::{Universe, initialize_with_threading};
use mpi::topology::{Color, Communicator as _};
use sphorge_engine::ranks::{Communicator, Messages};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// All processes that were started together.
pub struct Processes {
    universe: Universe,
    rank: usize,
    size: usize,
    on_this_machine: usize,
    on_these_processors: usize,
}

impl std::fmt::Debug for Processes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Processes").field("rank", &self.rank).field("size", &self.size).finish_non_exhaustive()
    }
}

impl Processes {
    /// Name and version of the MPI that this program is linked to, as it calls itself.
    pub fn library() -> String {
        name_of(&mpi::environment::library_version().unwrap_or_default())
    }

    /// Joins the others; to be called once, on the thread that ends last. Where a process ends without saying so, MPI ends all.
    ///
    /// # Errors
    /// MPI cannot be started, or does not let threads of a rank take turns.
    pub fn join() -> Result<Arc<Self>, String> {
        let Some((universe, provided)) = initialize_with_threading(Threading::Serialized) else {
            return Err("MPI was started before".to_owned());
        };
        if provided < Threading::Serialized {
            return Err("this MPI serves a single thread of a process alone".to_owned());
        }
        let world = universe.world();
        let (rank, size) = (world.rank() as usize, world.size() as usize);
        let machine = world.split_shared(world.rank());
        let together = machine.split_by_color(Color::with_value(color_of(&processors())));
        let (on_this_machine, on_these_processors) =
            (machine.size() as usize, together.map_or(1, |together| together.size() as usize));
        Ok(Arc::new(Self { universe, rank, size, on_this_machine, on_these_processors }))
    }

    /// Processes that share the memory of this machine, this one among them.
    pub fn on_this_machine(&self) -> usize {
        self.on_this_machine
    }

    /// Those of them that may run on the same processors as this one.
    pub fn on_these_processors(&self) -> usize {
        self.on_these_processors
    }
}

/// Name and version in what an MPI says of itself.
fn name_of(told: &str) -> String {
    let first = told.split(&[',', '\n', '\0'][..]).next().unwrap_or_default();
    first.split_whitespace().filter(|word| *word != "Version:").collect::<Vec<_>>().join(" ")
}

/// The processors that this process may run on, as Linux writes them; elsewhere nothing: they are those of all.
fn processors() -> String {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let list = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"));
    list.unwrap_or_default().trim().to_owned()
}

/// A color for MPI: the same for the same text.
fn color_of(text: &str) -> i32 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    (hasher.finish() >> 33) as i32
}

impl Drop for Processes {
    fn drop(&mut self) {
        // Others may wait for this one: they would wait for good.
        if std::thread::panicking() {
            self.universe.world().abort(1);
        }
    }
}

impl Communicator for Processes {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn begin(&self, to: Vec<Vec<u8>>, lengths: &[usize]) -> Result<Box<dyn Messages>, String> {
        Ok(Box::new(InFlight::begin(&self.universe.world(), to, lengths)))
    }
}

#[cfg(test)]
mod tests {
    use super::name_of;

    #[test]
    fn names_of_libraries_are_short() {
        let told = "Open MPI v4.1.4, package: Debian OpenMPI, ident: 4.1.4, repo rev: v4.1.4, May 26, 2022";
        assert_eq!(name_of(told), "Open MPI v4.1.4");
        assert_eq!(
            name_of("MPICH Version:\t4.0.2\nMPICH Release date:\tThu Apr  7 12:34:45 CDT 2022\n"),
            "MPICH 4.0.2"
        );
    }
}
