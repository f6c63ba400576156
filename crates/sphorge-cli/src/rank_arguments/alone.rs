//! A program without MPI: there is one process.

use super::{RankArguments, started};
use crate::{
    failure::{Ending, Failure},
    progress::ProgressDisplay,
    signals::StopFlag,
};
use sphorge::engine::EngineKind;
use std::{path::Path, sync::Arc};

/// What this process is among the ranks of a run: the only one.
pub(crate) struct Role;

impl RankArguments {
    /// Refuses ranks, which this program was built without, and to be one of many processes that would all do the same.
    pub(crate) fn join(self, _threads: Option<usize>, _device: Option<&str>) -> Result<Option<Role>, Failure> {
        let count = started::count();
        match self.ranks {
            _ if count > 1 && !started::is_first() => Err(Failure::Told),
            _ if count > 1 => Err(Failure::bad_input(
                format!(
                    "{count} processes were started together, but this program was built without MPI: each would repeat the same run"
                ),
                "build it with `cargo build --release --features mpi`, or start one process: `--threads` can use all processors of one machine",
            )),
            None => Ok(Some(Role)),
            Some(_) => Err(Failure::bad_input(
                "this program was built without MPI, which `--ranks` needs",
                "build it with `cargo build --release --features mpi`; without MPI, `--threads` can use all processors of one machine",
            )),
        }
    }
}

impl Role {
    pub(crate) fn threads(&self, asked: Option<usize>) -> Option<usize> {
        asked
    }

    pub(crate) fn engine(&self, asked: Arc<dyn EngineKind>) -> Result<Arc<dyn EngineKind>, Failure> {
        Ok(asked)
    }

    pub(crate) fn engines(&self, alone: Vec<Arc<dyn EngineKind>>) -> Vec<Arc<dyn EngineKind>> {
        alone
    }

    pub(crate) fn launch<S>(&self, setup: S, _: &Path, _: &mut ProgressDisplay, _: &StopFlag) -> Result<S, Ending> {
        Ok(setup)
    }
}
