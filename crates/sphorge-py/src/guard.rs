//! Nothing that goes wrong in Rust leaves it but as an exception.

use crate::errors;
use pyo3::prelude::*;
use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    thread,
    time::Duration,
};

/// How often signals are looked for.
pub(crate) const POLL: Duration = Duration::from_millis(50);

/// What a panic says.
pub(crate) fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic without words".to_owned())
}

/// Computes without the lock of the interpreter.
pub(crate) fn detached<T: Send>(py: Python<'_>, compute: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(compute))).map_err(|panic| errors::internal(py, &message(&*panic)))
}

/// The same on threads that end with it: those that would stay are lost in a process that forks.
pub(crate) fn in_pool<T: Send>(py: Python<'_>, compute: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = rayon::ThreadPoolBuilder::new().build().map_err(|error| errors::internal(py, &error.to_string()))?;
    detached(py, || pool.install(compute))
}

/// Computes on a thread of its own. Ctrl-C raises `stop`, and is passed on when the thread has ended; a second one is at once.
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    stop: &Arc<AtomicBool>,
    compute: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    let work = move || {
        // Nobody waits any more after a second Ctrl-C.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(compute)));
    };
    let thread = thread::Builder::new().name("sphorge".to_owned()).spawn(work);
    thread.map_err(|error| errors::internal(py, &error.to_string()))?;
    let mut interrupt = None;
    loop {
        let waiting = &mut receiver;
        let news = py.detach(move || {
            let waiting = waiting;
            waiting.recv_timeout(POLL)
        });
        match news {
            Ok(done) => {
                let done = done.map_err(|panic| errors::internal(py, &message(&*panic)));
                return interrupt.map_or(done, Err);
            }
            Err(RecvTimeoutError::Disconnected) => return Err(errors::internal(py, "a thread is gone")),
            Err(RecvTimeoutError::Timeout) => {
                let Err(signal) = py.check_signals() else { continue };
                if interrupt.is_some() {
                    return Err(signal);
                }
                stop.store(true, Ordering::Relaxed);
                interrupt = Some(signal);
            }
        }
    }
}

/// The same on threads that end with it.
pub(crate) fn interruptible_in_pool<T: Send + 'static>(
    py: Python<'_>,
    stop: &Arc<AtomicBool>,
    compute: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let pool = rayon::ThreadPoolBuilder::new().build().map_err(|error| errors::internal(py, &error.to_string()))?;
    interruptible(py, stop, move || pool.install(compute))
}

/// Panics, on a thread of a pool or here, for the tests that nothing of it crosses.
#[pyfunction]
pub(crate) fn panic_for_tests(py: Python<'_>, on_a_pool: bool) -> PyResult<()> {
    let fail = || panic!("a panic for tests");
    if on_a_pool { in_pool(py, fail) } else { detached(py, fail) }
}
