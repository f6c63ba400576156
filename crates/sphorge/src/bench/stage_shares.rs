//! Share of the measured time by stage.

use crate::engine::StageSeconds;
use serde::Serialize;

/// Share of the measured time by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageShares {
    /// Neighbour search.
    pub search: f64,
    /// Velocity gradient and density rate.
    pub kinematics: f64,
    /// Constitutive update.
    pub stress: f64,
    /// Forces.
    pub forces: f64,
    /// Integration, guard, time step.
    pub integrate: f64,
}

impl StageShares {
    /// Shares of the time that passed between two readings of the stage clock.
    pub(super) fn between(before: StageSeconds, after: StageSeconds) -> Self {
        let search = after.search - before.search;
        let kinematics = after.kinematics - before.kinematics;
        let stress = after.stress - before.stress;
        let forces = after.forces - before.forces;
        let integrate = after.integrate - before.integrate;
        let all = search + kinematics + stress + forces + integrate;
        let share = |seconds: f64| if all > 0.0 { seconds / all } else { 0.0 };
        Self {
            search: share(search),
            kinematics: share(kinematics),
            stress: share(stress),
            forces: share(forces),
            integrate: share(integrate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_the_time_between_the_readings() {
        let before =
            StageSeconds { search: 1.0, kinematics: 1.0, stress: 1.0, forces: 1.0, integrate: 1.0, output: 9.0 };
        let after =
            StageSeconds { search: 3.0, kinematics: 2.0, stress: 1.5, forces: 5.0, integrate: 1.5, output: 99.0 };
        let shares = StageShares::between(before, after);
        let expected = StageShares { search: 0.25, kinematics: 0.125, stress: 0.0625, forces: 0.5, integrate: 0.0625 };
        assert_eq!(shares, expected);
        assert_eq!(StageShares::between(after, after), StageShares::default());
    }
}
