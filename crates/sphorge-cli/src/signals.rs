//! Ctrl-C and SIGTERM: the first asks the run to stop and write what it has, the second ends the program at once.

use signal_hook::{consts::TERM_SIGNALS, flag, iterator::Signals};
use std::{
    io,
    sync::{Arc, atomic::AtomicBool},
    thread,
};

/// A flag that signals raise; `on_first` is called when the first one has.
///
/// # Errors
/// The system refuses the handlers.
pub(crate) fn stop_flag(on_first: impl FnOnce() + Send + 'static) -> io::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    for &signal in TERM_SIGNALS {
        // In this order: the first signal finds the flag down and raises it, the second finds it up and ends the program.
        // Every file of a run is complete or absent at any moment, so nothing is lost by that but the work since.
        flag::register_conditional_shutdown(signal, 130, Arc::clone(&stop))?;
        flag::register(signal, Arc::clone(&stop))?;
    }
    let mut signals = Signals::new(TERM_SIGNALS)?;
    thread::spawn(move || {
        if signals.forever().next().is_some() {
            on_first();
        }
    });
    Ok(stop)
}
