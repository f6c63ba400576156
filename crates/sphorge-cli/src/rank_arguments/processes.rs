//! This process among the ranks of a run.

use super::{RankArguments, started};
use crate::{
    engine_arguments::part_kinds,
    failure::{Ending, Failure, Outcome},
    memory,
    progress::ProgressDisplay,
    signals,
    signals::StopFlag,
    terminal,
};
use miette::{IntoDiagnostic, WrapErr, miette};
use sphorge::{
    engine::{EngineKind, PartKind, ranks::Communicator},
    output::RunDirectory,
    run::FilesOfRank,
};
use sphorge_mpi::{Leader, Processes, follow_with};
use std::{
    env,
    path::Path,
    process::{Command, ExitStatus},
    sync::{Arc, atomic::Ordering},
    thread,
    time::Duration,
};

/// How often the launcher asks whether the ranks have ended.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// What this process is among the ranks of a run.
pub(crate) enum Role {
    /// There are no others.
    Alone,
    /// The one that starts so many ranks and waits for them.
    Launcher(usize),
    /// The first rank, which drives the run.
    First(First),
}

/// The first rank.
pub(crate) struct First {
    leader: Leader,
    /// What all ranks can have for engines.
    kinds: Vec<Arc<dyn PartKind>>,
    /// Threads unless told otherwise.
    own_threads: usize,
}

impl First {
    /// What all ranks together are, where each has the engine of a name.
    fn led(&self, name: &str) -> Option<Arc<dyn EngineKind>> {
        let kind = self.kinds.iter().find(|kind| kind.name() == name)?;
        Some(Arc::new(self.leader.with(kind.clone())))
    }
}

impl RankArguments {
    /// Joins the ranks, of which each has so many threads, and a card that is called so where cards compute. On all but the first it returns when the run is over, with nothing left to do.
    ///
    /// # Errors
    /// There is no MPI, or a number of ranks that is not that of the processes.
    pub(crate) fn join(self, threads: Option<usize>, device: Option<&str>) -> Result<Option<Role>, Failure> {
        if !started::by_mpi() {
            let Some(ranks) = self.ranks else { return Ok(Some(Role::Alone)) };
            memory::note_ranks(ranks, ranks);
            return Ok(Some(Role::Launcher(ranks)));
        }
        if !started::is_known_to_mpi() {
            // MPI would end each of them with words of its own.
            return Err(if started::is_first() { unknown_to_mpi(started::count()) } else { Failure::Told });
        }
        let processes = Processes::join().map_err(|message| Failure::Failed(miette!("{message}")))?;
        let own_threads = threads_of_a_rank(processes.on_these_processors());
        let on_this_machine = processes.on_this_machine();
        let kinds = part_kinds(device, processes.place_on_this_machine());
        let communicator: Arc<dyn Communicator> = processes;
        let (rank, size) = (communicator.rank(), communicator.size());
        if size == 1 && started::count() > 1 {
            return Err(if started::is_first() { alone_among(started::count()) } else { Failure::Told });
        }
        if let Some(asked) = self.ranks.filter(|ranks| *ranks != size) {
            // All of them find it, and the first one says so.
            return if rank > 0 { Ok(None) } else { Err(other_number(asked, size)) };
        }
        memory::note_rank(rank);
        memory::note_ranks(size, on_this_machine);
        if rank == 0 {
            let leader = Leader::new(communicator);
            return Ok(Some(Role::First(First { leader, kinds, own_threads })));
        }
        signals::leave_to_the_first_rank().into_diagnostic().map_err(Failure::Failed)?;
        let files = FilesOfRank::new(memory::particle_limit());
        let followed = follow_with(communicator, threads.or(Some(own_threads)), &kinds, &files);
        followed.map(|()| None).map_err(|failure| Failure::Failed(miette!("{failure}")))
    }
}

/// What is wrong where Slurm has started processes and does not tell MPI of them.
fn unknown_to_mpi(count: usize) -> Failure {
    Failure::bad_input(
        format!("`srun` has started {count} processes without an interface through which MPI can connect them"),
        format!(
            "`srun --mpi=pmix`, or another interface supported by {}, to which this program is linked: `srun --mpi=list` shows those available",
            Processes::library()
        ),
    )
}

/// What is wrong where each of some processes sees itself alone.
fn alone_among(count: usize) -> Failure {
    Failure::bad_input(
        format!(
            "{count} processes were started together, but MPI does not connect them: {}, to which this program is linked, does not recognise what started them",
            Processes::library()
        ),
        "start it by the `mpirun` of that MPI, or by an `srun --mpi=KIND` that it knows (`srun --mpi=list` names the kinds); or build the program with the MPI \
         whose `mpirun` it is: `cargo clean -p mpi-sys`, then with its `mpicc` first in PATH",
    )
}

fn other_number(asked: usize, started: usize) -> Failure {
    Failure::bad_input(
        format!("`--ranks {asked}` was given and {started} processes were started"),
        "leave out `--ranks`: `mpirun` or `srun` sets the number of processes",
    )
}

/// Threads of a rank unless told otherwise: its share of the processors that it may run on, as so many ranks may.
fn threads_of_a_rank(ranks: usize) -> usize {
    let processors = thread::available_parallelism().map_or(1, |n| n.get());
    (processors / ranks).max(1)
}

impl Role {
    /// Threads of this process.
    pub(crate) fn threads(&self, asked: Option<usize>) -> Option<usize> {
        match self {
            Self::First(first) => asked.or(Some(first.own_threads)),
            Self::Alone | Self::Launcher(_) => asked,
        }
    }

    /// The engine of this process, where `asked` was asked for.
    ///
    /// # Errors
    /// Ranks cannot share what that engine computes.
    pub(crate) fn engine(&self, asked: Arc<dyn EngineKind>) -> Result<Arc<dyn EngineKind>, Failure> {
        match self {
            Self::Alone | Self::Launcher(_) => Ok(asked),
            Self::First(first) => first.led(asked.name()).ok_or_else(|| {
                Failure::bad_input(
                    format!("processes cannot share a run on the engine `{}`", asked.name()),
                    "leave `--engine` out, or run on one process",
                )
            }),
        }
    }

    /// The engines of this process that a run may be resumed on, of those there are for a process alone.
    pub(crate) fn engines(&self, alone: Vec<Arc<dyn EngineKind>>) -> Vec<Arc<dyn EngineKind>> {
        match self {
            Self::First(first) => alone.iter().filter_map(|kind| first.led(kind.name())).collect(),
            Self::Alone | Self::Launcher(_) => alone,
        }
    }

    /// Runs this command line on ranks of this machine where that is what this process is for, and waits for them, without the memory of
    /// `setup`, which is given back to a process that runs itself. `directory` is that of the run.
    pub(crate) fn launch<S>(
        &self,
        setup: S,
        directory: &Path,
        display: &mut ProgressDisplay,
        stop: &StopFlag,
    ) -> Result<S, Ending> {
        let Self::Launcher(ranks) = *self else { return Ok(setup) };
        drop(setup);
        // The ranks write what there is when they are asked to stop.
        sphorge::run::Observer::prepared(display);
        Err(run_on(ranks, directory, stop))
    }
}

/// Starts this command line on so many ranks, and waits for them.
fn run_on(ranks: usize, directory: &Path, stop: &StopFlag) -> Ending {
    let program = env::current_exe().into_diagnostic().map_err(Failure::Failed)?;
    let mut command = Command::new("mpirun");
    command.arg("-n").arg(ranks.to_string()).arg(program).args(env::args_os().skip(1));
    // Open MPI: more ranks than processors, threads of a rank on any of them, and no words of its own where a rank ends with a code.
    command.env("OMPI_MCA_rmaps_base_oversubscribe", "1").env("OMPI_MCA_hwloc_base_binding_policy", "none");
    command.env("OMPI_MCA_orte_execute_quiet", "1");
    // Ctrl-C would end all ranks at once: this process asks them to stop.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut running = command
        .spawn()
        .into_diagnostic()
        .wrap_err("cannot start `mpirun`: it comes with MPI (Debian: apt install openmpi-bin)")
        .map_err(Failure::Failed)?;
    let mut is_asked = false;
    let status = loop {
        if let Some(status) = running.try_wait().into_diagnostic().map_err(Failure::Failed)? {
            break status;
        }
        if stop.flag().load(Ordering::Relaxed) && !is_asked {
            is_asked = true;
            // `mpirun` gives this signal to its ranks.
            let _ = Command::new("sh").args(["-c", &format!("kill -USR2 {}", running.id())]).status();
        }
        thread::sleep(POLL_INTERVAL);
    };
    stop.finish();
    conclude(status, directory)
}

/// How the ranks have ended. The first one tells of all but the death of a rank.
fn conclude(status: ExitStatus, directory: &Path) -> Ending {
    let how = match status.code() {
        Some(0) => return Ok(Outcome::Done),
        Some(130) => return Ok(Outcome::Stopped),
        Some(2) => return Err(Failure::ToldOfBadInput),
        // MPICH joins the bits of the codes of all ranks.
        Some(1 | 3) => return Err(Failure::Told),
        Some(code) => format!("with code {code}"),
        None => "by a signal".to_owned(),
    };
    let kept = match RunDirectory::open(directory) {
        Ok(_) => format!(
            "the results so far are in {}: complete frames, history and checkpoints; `sphorge resume` continues from the last one",
            directory.display()
        ),
        Err(_) => "nothing was computed yet".to_owned(),
    };
    terminal::note(&format!("a rank of the run ended {how}, and the others were ended; {kept}"));
    Err(Failure::Told)
}
