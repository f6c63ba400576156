//! Ctrl-C, SIGTERM and the end of a session: the first asks the run to stop and write what it has, the second ends the program at once. While a
//! run is set up, which of many particles takes a while, the first one does.
//! SIGUSR1 asks it to save its state and go on.

use signal_hook::{consts::TERM_SIGNALS, flag, iterator::Signals};
use std::{
    io,
    sync::{
        Arc, Once,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

/// Signals that end a run.
fn ending() -> Vec<i32> {
    let mut signals = TERM_SIGNALS.to_vec();
    // `mpirun` ends its processes on those, and gives this one on.
    #[cfg(all(feature = "mpi", unix))]
    signals.push(signal_hook::consts::SIGUSR2);
    #[cfg(unix)]
    if !is_ignored(signal_hook::consts::SIGHUP) {
        signals.push(signal_hook::consts::SIGHUP);
    }
    signals
}

/// Whether the program was started with a signal ignored, as `nohup` does with that of the end of a session; where the system tells.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

/// Lets a write beyond the file-size limit fail like one to a full disk, instead of ending the program.
pub(crate) fn meet_file_size_limits_as_errors() {
    #[cfg(unix)]
    {
        // A handler that does nothing: the write returns an error. Without it the signal ends the program as before.
        let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
    }
}

/// A flag that SIGUSR1 raises, where there is such a signal.
///
/// # Errors
/// The system refuses the handler.
pub(crate) fn checkpoint_request() -> io::Result<Option<Arc<AtomicBool>>> {
    #[cfg(unix)]
    {
        let request = Arc::new(AtomicBool::new(false));
        flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&request))?;
        Ok(Some(request))
    }
    #[cfg(not(unix))]
    Ok(None)
}

/// Leaves all signals that end a run or save its state to the first of its ranks: the others do what that one does.
///
/// # Errors
/// The system refuses the handlers.
#[cfg(feature = "mpi")]
pub(crate) fn leave_to_the_first_rank() -> io::Result<()> {
    let mut signals = ending();
    #[cfg(unix)]
    signals.push(signal_hook::consts::SIGUSR1);
    signals.into_iter().try_for_each(|signal| flag::register(signal, Arc::default()).map(|_| ()))
}

/// A flag that signals raise, and what is said when the first one has.
pub(crate) struct StopFlag {
    raised: Arc<AtomicBool>,
    said: Arc<Said>,
}

/// Said once, by whoever comes first: the thread that waits for signals, or a run that ended before that thread got its turn.
struct Said {
    once: Once,
    say: Box<dyn Fn() + Send + Sync>,
}

impl Said {
    fn say(&self) {
        self.once.call_once(|| (self.say)());
    }
}

impl StopFlag {
    /// Catches the signals; `on_first` is called once, after the first one. While `sets_up` is true, nothing is on the disk that would have to be
    /// completed, and the first signal ends the program at once.
    ///
    /// # Errors
    /// The system refuses the handlers.
    pub(crate) fn new(sets_up: Arc<AtomicBool>, on_first: impl Fn() + Send + Sync + 'static) -> io::Result<Self> {
        let raised = Arc::new(AtomicBool::new(false));
        for signal in ending() {
            flag::register_conditional_shutdown(signal, 130, Arc::clone(&sets_up))?;
            // In this order: the first signal finds the flag down and raises it, the second finds it up and ends the program.
            // Every file of a run is complete or absent at any moment, so nothing is lost by that but the work since.
            // The end of a session often comes twice, from the shell and from the system, and is never meant to end the program at once.
            if TERM_SIGNALS.contains(&signal) {
                flag::register_conditional_shutdown(signal, 130, Arc::clone(&raised))?;
            }
            flag::register(signal, Arc::clone(&raised))?;
        }
        let said = Arc::new(Said { once: Once::new(), say: Box::new(on_first) });
        let mut signals = Signals::new(ending())?;
        let by_thread = Arc::clone(&said);
        thread::spawn(move || {
            if signals.forever().next().is_some() {
                by_thread.say();
            }
        });
        Ok(Self { raised, said })
    }

    /// The flag a run looks at once a step.
    pub(crate) fn flag(&self) -> &AtomicBool {
        &self.raised
    }

    /// From here on the flag is raised without a word: what it stops says so itself, or nothing.
    pub(crate) fn be_quiet(&self) {
        self.said.once.call_once(|| {});
    }

    /// To be called when the run has ended, so that the message never comes after its report or not at all.
    pub(crate) fn finish(&self) {
        if self.raised.load(Ordering::Relaxed) {
            self.said.say();
        }
    }
}
