//! Runs of a sweep, as processes.

use super::{Planned, Sweep, SweepError, SweepRow, SweepRun, SweepTable, plan::planned, table::Numbers};
use crate::output::{Claim, Durability, Folder, OutputError, write_file};
use std::{
    ffi::OsString,
    fs,
    io::Read,
    process::{Child, Command, Stdio},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::Duration,
};

/// How often a process is asked whether it has ended.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// Longest text that is kept of what a process tells, bytes.
const LONGEST_TOLD: u64 = 64 << 10;

/// How the runs of a sweep are made.
#[derive(Clone, Debug)]
pub struct Process {
    /// The command that is the program `sphorge`; arguments of its `run` and `resume` follow.
    pub program: Vec<OsString>,
    /// Runs at once.
    pub at_once: usize,
    /// Threads of each.
    pub threads: usize,
    /// Engine, where it is not the default one.
    pub engine: Option<String>,
    /// Words of the name of the card.
    pub device: Option<String>,
}

/// What happens to the runs.
#[derive(Clone, Copy, Debug)]
pub enum SweepEvent<'a> {
    /// A run of this number begins or goes on.
    Begins(usize),
    /// It has ended, or been stopped; what can be said of it.
    Ended(usize, &'a SweepRow),
}

/// Makes the runs that are not there yet, and returns the table of all, which is also in `sweep.csv` at any time. Where `stop` becomes true, the runs
/// under way save their states, and no more are begun.
///
/// # Errors
/// The folder cannot be written. A run that fails is a row of the table.
pub fn execute(
    sweep: &Sweep,
    process: &Process,
    stop: &AtomicBool,
    tell: &(dyn Fn(SweepEvent<'_>) + Sync),
) -> Result<SweepTable, SweepError> {
    let unwritable = |source| OutputError::Unwritable { path: sweep.folder.clone(), source };
    fs::create_dir_all(&sweep.folder).map_err(unwritable)?;
    let _claim = claim(sweep)?;
    // Another study may have made some of them since they were planned.
    let now = |run: &SweepRun| match run.planned {
        Planned::Again if sweep.again => Ok(Planned::Again),
        _ => planned(&sweep.directory(run), &run.deck_text, false),
    };
    let plan = sweep.runs.iter().map(now).collect::<Result<Vec<_>, _>>()?;
    let due: Vec<usize> = (0..sweep.runs.len()).filter(|&k| plan[k] != Planned::Nothing).collect();
    for &k in &due {
        let text = &sweep.runs[k].deck_text;
        write_file(&sweep.deck(&sweep.runs[k]), Durability::Process, |out| out.write_all(text.as_bytes()))?;
    }
    let numbers = Numbers::of(sweep);
    let table = Mutex::new(SweepTable::read(sweep));
    let failed = Mutex::new(None);
    let write = |table: &SweepTable| {
        if let Err(error) = table.write(&sweep.folder) {
            lock(&failed).get_or_insert(error);
        }
    };
    write(&lock(&table));
    let next = AtomicUsize::new(0);
    let work = || {
        while !stop.load(Ordering::Relaxed) {
            let Some(&k) = due.get(next.fetch_add(1, Ordering::Relaxed)) else { return };
            tell(SweepEvent::Begins(k));
            let told = run(sweep, k, plan[k], process, stop);
            let mut table = lock(&table);
            let row = SweepRow { told, ..SweepRow::read(sweep, k, &numbers) };
            tell(SweepEvent::Ended(k, &row));
            table.rows[k] = row;
            table.find_measures();
            write(&table);
        }
    };
    thread::scope(|scope| {
        for _ in 0..process.at_once.clamp(1, due.len().max(1)) {
            scope.spawn(work);
        }
    });
    match lock(&failed).take() {
        Some(error) => Err(error.into()),
        None => Ok(table.into_inner().unwrap_or_else(PoisonError::into_inner)),
    }
}

/// What a mutex guards; a thread that panicked has left nothing half done in it.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes the folder of a sweep, which no other one may write to meanwhile: both would make the same runs.
fn claim(sweep: &Sweep) -> Result<Claim, SweepError> {
    let unwritable = |source| OutputError::Unwritable { path: sweep.folder.clone(), source };
    let folder = Folder::open(&sweep.folder).map_err(unwritable)?;
    Claim::take(folder, false).map_err(|error| match error {
        OutputError::Locked { path, owner } => SweepError::Locked { path, owner },
        other => other.into(),
    })
}

/// Makes a run, and returns what its process told where it did not end well.
fn run(sweep: &Sweep, k: usize, planned: Planned, process: &Process, stop: &AtomicBool) -> Option<String> {
    let run = &sweep.runs[k];
    let directory = sweep.directory(run);
    let (program, own) = process.program.split_first()?;
    let mut command = Command::new(program);
    command.args(own);
    match planned {
        Planned::Resume => command.arg("resume").arg(&directory),
        Planned::New | Planned::Again | Planned::Nothing => {
            command.arg("run").arg(sweep.deck(run)).arg("-o").arg(&directory)
        }
    };
    if planned == Planned::Again {
        command.arg("--overwrite");
    }
    if let Some(engine) = process.engine.as_ref().filter(|_| planned != Planned::Resume) {
        command.args(["--engine", engine]);
    }
    if let Some(device) = &process.device {
        command.args(["--device", device]);
    }
    command.args(["--quiet", "--threads"]).arg(process.threads.to_string());
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    // Ctrl-C would end all runs at once: this process asks them to stop.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return Some(format!("cannot start `{}`: {error}", program.display())),
    };
    let told = child.stderr.take().map(|mut pipe| {
        thread::spawn(move || {
            let mut told = Vec::new();
            let _ = pipe.by_ref().take(LONGEST_TOLD).read_to_end(&mut told);
            // A process that finds its pipe closed would end.
            let _ = std::io::copy(&mut pipe, &mut std::io::sink());
            String::from_utf8_lossy(&told).into_owned()
        })
    });
    let status = wait(&mut child, stop);
    let told = told.and_then(|told| told.join().ok()).unwrap_or_default();
    match status {
        Ok(status) if matches!(status.code(), Some(0 | 130)) => None,
        Ok(status) if status.code().is_some() => Some(told),
        Ok(status) => Some(format!("{told}\nits process ended by {status}").trim().to_owned()),
        Err(error) => Some(error.to_string()),
    }
}

/// Waits for a process, which is asked to stop once `stop` is true.
fn wait(child: &mut Child, stop: &AtomicBool) -> std::io::Result<std::process::ExitStatus> {
    let mut is_asked = false;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status);
        }
        if stop.load(Ordering::Relaxed) && !is_asked {
            is_asked = true;
            ask_to_stop(child)?;
        }
        thread::sleep(POLL_INTERVAL);
    }
}

/// Asks a run to save its state and end.
#[cfg(unix)]
fn ask_to_stop(child: &mut Child) -> std::io::Result<()> {
    Command::new("kill").args(["-TERM", &child.id().to_string()]).status().map(drop)
}

/// Ends a run; what it has written is complete.
#[cfg(not(unix))]
fn ask_to_stop(child: &mut Child) -> std::io::Result<()> {
    child.kill()
}
