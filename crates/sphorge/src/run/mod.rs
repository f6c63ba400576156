//! Runs a model from start to end and writes what happens.
//!
//! Frames are written at exact multiples of their interval, for which steps are cut; a row of the history is that of the first step past a
//! multiple of its interval, so that more rows change nothing. Both are written at the start and at the end. The initial values of energy and
//! momentum are those of the first row. Definitions of what is in history and summary:
//!
//! - **Energy drift**: `(E - E0 - W) / scale`, with `E` kinetic plus internal energy and what contacts hold, `E0` its initial value, `W` the
//!   external work and the heat through boundaries since then. `scale` is the largest so far of `|E0|`, the kinetic energy, the external
//!   work and the heat exchanged: the initial total wherever there is one, and for a body at rest the work done on it; and no less than
//!   `m (1e-12 c)^2` with the sound speed `c`, which is rounding.
//! - **Momentum drift**: `|P - P0 - J| / scale`, with `P` the linear momentum, `J` the external impulse since the first row and `scale`
//!   the largest sum of `m |v|` so far, no less than `1e-12 m c`. Axes across which a plane of symmetry stands are left out: the plane takes momentum.
//! - **Kinetic stop**: `stop-kinetic-fraction` is tested in every row of the history, against the first row.
//! - **Searched fraction**: mean over the steps.
//! - **Warnings**: what the checks of `docs/warnings.md` found; a run that reaches its end with one is `completed with warnings`.

mod checkpoint;
mod conservation;
mod drive;
mod driven;
mod error;
mod frame;
mod listed;
mod progress;
mod rank_files;
mod record;
pub(crate) mod repeat;
mod resume;
mod schedule;
mod state;
mod watch;

pub use checkpoint::CheckpointPlan;
pub use drive::{RunOptions, execute};
pub use error::RunError;
pub use progress::{Observer, Progress, RunStart, Silent};
pub use rank_files::FilesOfRank;
pub use resume::{CHANGEABLE, ResumeError, ResumeOptions, resume};

#[cfg(test)]
mod tests;
