//! Times of kernels, and what they do in them.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Which launch of a kernel counts what it does instead of being timed: the first steps may be those of a start.
const COUNTED: u64 = 3;

/// Times of kernels, each waited for by itself; copies share them.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    times: Arc<Mutex<Vec<KernelTime>>>,
    read_back: Arc<ReadBack>,
    is_paused: Arc<AtomicBool>,
}

/// What is copied back, but for frames.
#[derive(Debug, Default)]
struct ReadBack {
    bytes: AtomicU64,
    waits: AtomicU64,
    /// Copies that were queued, and those of them that are there for certain.
    queued: AtomicU64,
    there: AtomicU64,
}

/// What the launches of a kernel took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KernelTime {
    /// Name of the kernel.
    pub kernel: String,
    /// How often it was timed.
    pub launches: u64,
    /// Seconds of all these.
    pub seconds: f64,
    /// What one launch did, where it was counted.
    pub work: Option<KernelWork>,
}

/// What one launch of a kernel does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KernelWork {
    /// Bytes that its threads read or write; what a cache has of them need not come from memory.
    pub bytes: f64,
    /// Additions, multiplications, divisions, roots and functions; a product that is added to something is two.
    pub operations: f64,
}

impl Profile {
    /// Times no kernels for a while, so that nothing is waited for; or goes on with it.
    pub fn pause(&self, is_paused: bool) {
        self.is_paused.store(is_paused, Ordering::Relaxed);
    }

    pub(super) fn is_paused(&self) -> bool {
        self.is_paused.load(Ordering::Relaxed)
    }

    /// Bytes that were copied back, not counting frames.
    pub fn bytes_read(&self) -> u64 {
        self.read_back.bytes.load(Ordering::Relaxed)
    }

    /// How often the GPU was waited for to have them. Copies that were queued before another that was waited for are there already.
    pub fn waits(&self) -> u64 {
        self.read_back.waits.load(Ordering::Relaxed)
    }

    pub(super) fn add_read(&self, bytes: u64) {
        self.read_back.bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    /// The place of another copy in the queue.
    pub(super) fn queue_copy(&self) -> u64 {
        1 + self.read_back.queued.fetch_add(1, Ordering::Relaxed)
    }

    /// Counts a wait, unless what is at that place of the queue is there for certain.
    pub(super) fn wait_for(&self, place: u64) {
        if self.read_back.there.fetch_max(place, Ordering::Relaxed) < place {
            self.read_back.waits.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Forgets the times, not the work.
    pub fn clear(&self) {
        for of in self.kernels().iter_mut() {
            (of.launches, of.seconds) = (0, 0.0);
        }
    }

    /// Forgets everything, and gives back what there was of kernels that were timed, the longest first.
    pub fn take(&self) -> Vec<KernelTime> {
        let mut times = std::mem::take(&mut *self.kernels());
        times.retain(|of| of.launches > 0);
        times.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        times
    }

    fn kernels(&self) -> MutexGuard<'_, Vec<KernelTime>> {
        self.times.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, kernel: &str, change: impl FnOnce(&mut KernelTime)) {
        let mut kernels = self.kernels();
        match kernels.iter_mut().find(|of| of.kernel == kernel) {
            Some(of) => change(of),
            None => {
                let mut new = KernelTime { kernel: kernel.to_owned(), ..KernelTime::default() };
                change(&mut new);
                kernels.push(new);
            }
        }
    }

    pub(super) fn add(&self, kernel: &str, seconds: f64) {
        self.change(kernel, |of| {
            of.launches += 1;
            of.seconds += seconds;
        });
    }

    /// Whether the next launch counts what it does.
    pub(super) fn counts_next(&self, kernel: &str) -> bool {
        self.kernels().iter().any(|of| of.kernel == kernel && of.launches == COUNTED && of.work.is_none())
    }

    pub(super) fn count(&self, kernel: &str, numbers: f64, operations: f64) {
        self.change(kernel, |of| of.work = Some(KernelWork { bytes: 4.0 * numbers, operations }));
    }
}
