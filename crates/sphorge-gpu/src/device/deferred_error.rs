//! What went wrong on a GPU, reported by the next wait.

use std::sync::{Arc, Mutex, PoisonError};

/// What went wrong first with a launch, a copy or the GPU itself, if anything did.
#[derive(Clone, Debug, Default)]
pub(super) struct DeferredError(Arc<Mutex<Option<String>>>);

impl DeferredError {
    pub(super) fn keep(&self, why: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
    }

    pub(super) fn first(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
