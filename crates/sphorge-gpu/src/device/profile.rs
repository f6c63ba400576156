//! Times of kernels.

use std::sync::{Arc, Mutex, PoisonError};

/// Times of kernels, each waited for by itself; copies share them.
#[derive(Clone, Debug, Default)]
pub struct Profile(Arc<Mutex<Vec<KernelTime>>>);

/// What the launches of a kernel took.
#[derive(Clone, Debug, PartialEq)]
pub struct KernelTime {
    /// Name of the kernel.
    pub kernel: String,
    /// How often it was launched.
    pub launches: u64,
    /// Seconds of all launches.
    pub seconds: f64,
}

impl Profile {
    /// Forgets what was timed so far.
    pub fn clear(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Every kernel that was launched, the longest first.
    pub fn times(&self) -> Vec<KernelTime> {
        let mut times = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        times.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        times
    }

    pub(super) fn add(&self, kernel: &str, seconds: f64) {
        let mut times = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match times.iter_mut().find(|of| of.kernel == kernel) {
            Some(of) => {
                of.launches += 1;
                of.seconds += seconds;
            }
            None => times.push(KernelTime { kernel: kernel.to_owned(), launches: 1, seconds }),
        }
    }
}
