//! Ranks that are processes of MPI.

use crate::in_flight::InFlight;
use mpi::Threading;
use mpi::collective::CommunicatorCollectives as _;
use mpi::environment::{Universe, initialize_with_threading};
use mpi::topology::Communicator as _;
use sphorge_engine::ranks::{Communicator, Messages};
use std::fs;
use std::sync::Arc;

/// All processes that were started together.
pub struct Processes {
    universe: Universe,
    rank: usize,
    size: usize,
    on_this_machine: usize,
    place_on_this_machine: usize,
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
            return Err("MPI was already initialised".to_owned());
        };
        if provided < Threading::Serialized {
            return Err("this MPI library supports only one thread per process".to_owned());
        }
        let world = universe.world();
        let (rank, size) = (world.rank() as usize, world.size() as usize);
        let machine = world.split_shared(world.rank());
        let (on_this_machine, place_on_this_machine) = (machine.size() as usize, machine.rank() as usize);
        let (own, mut all) = (processors(), vec![0u64; PROCESSORS * on_this_machine]);
        machine.all_gather_into(&own[..], &mut all[..]);
        let on_these_processors = sharing(&own, &all);
        Ok(Arc::new(Self { universe, rank, size, on_this_machine, place_on_this_machine, on_these_processors }))
    }

    /// Processes that share the memory of this machine, this one among them.
    pub fn on_this_machine(&self) -> usize {
        self.on_this_machine
    }

    /// Number of this one among them, from zero on.
    pub fn place_on_this_machine(&self) -> usize {
        self.place_on_this_machine
    }

    /// Those of them that may run on some processor that this one may run on.
    pub fn on_these_processors(&self) -> usize {
        self.on_these_processors
    }
}

/// Name and version in what an MPI says of itself.
fn name_of(told: &str) -> String {
    let first = told.split(&[',', '\n', '\0'][..]).next().unwrap_or_default();
    first.split_whitespace().filter(|word| *word != "Version:").collect::<Vec<_>>().join(" ")
}

/// Words of a set of processors, a bit each: 4096 of them. Where there are more, each process counts as sharing with all.
const PROCESSORS: usize = 64;

/// The processors that this process may run on, as Linux writes them; elsewhere all.
fn processors() -> [u64; PROCESSORS] {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let list = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"));
    list.and_then(set_of).unwrap_or([u64::MAX; PROCESSORS])
}

/// The set of a list such as `0-3,7`; nothing where it is none or goes beyond.
fn set_of(list: &str) -> Option<[u64; PROCESSORS]> {
    let mut set = [0; PROCESSORS];
    for part in list.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last): (usize, usize) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
        for processor in first..=last.min(64 * PROCESSORS) {
            *set.get_mut(processor / 64)? |= 1 << (processor % 64);
        }
    }
    Some(set)
}

/// How many of the sets `all`, one behind the other, have a processor of `own`.
fn sharing(own: &[u64; PROCESSORS], all: &[u64]) -> usize {
    let (sets, _) = all.as_chunks::<PROCESSORS>();
    sets.iter().filter(|set| set.iter().zip(own).any(|(a, b)| a & b != 0)).count()
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
    use super::*;

    #[test]
    fn processes_share_where_sets_of_processors_overlap() {
        let [low, whole, high, far] = ["0-3", "0-7", "4-5,7", "130"].map(|list| set_of(list).unwrap());
        assert_eq!((high[0], far[2]), (0b1011_0000, 0b100));
        let all = [low, whole, high, far].concat();
        assert_eq!([low, whole, high, far].map(|own| sharing(&own, &all)), [2, 3, 2, 1]);
        assert_eq!(["", "a", "0-x", "0-9999"].map(set_of), [None; 4]);
    }

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
