//! Drift of what ought to be conserved, from ledger to ledger.

use crate::engine::{
    Ledger,
    persist::{Archive, ArchiveError, Persist, persist_option},
    persist_fields,
};
use std::array;

/// Drift at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Drift {
    /// Relative drift of the total energy, signed.
    pub(super) energy: f64,
    /// Relative drift of the linear momentum, never negative.
    pub(super) momentum: f64,
}

/// Follows a run from its first ledger on. The definitions are in the documentation of [`crate::run`].
#[derive(Clone, Debug, Default)]
pub(super) struct Conservation {
    /// Axes across which a plane of symmetry stands: it takes momentum and keeps no balance of it.
    mirrored: [bool; 3],
    start: Option<Start>,
    energy_scale: f64,
    momentum_scale: f64,
    /// At the last ledger.
    pub(super) last: Drift,
    /// Largest sizes so far.
    pub(super) largest: Drift,
}

/// The first ledger, less the work and impulse it already holds.
#[derive(Clone, Copy, Debug, Default)]
struct Start {
    energy: f64,
    momentum: [f64; 3],
}

impl Conservation {
    pub(super) fn new(mirrored: [bool; 3]) -> Self {
        Self { mirrored, ..Self::default() }
    }

    pub(super) fn sample(&mut self, ledger: &Ledger) -> Drift {
        let total = &ledger.total;
        let energy = ledger.total_energy();
        let supplied = ledger.external_work + ledger.boundary_heat();
        // Regions that are driven from the start have been given their velocity before the first ledger.
        let start = *self.start.get_or_insert(Start {
            energy: energy - supplied,
            momentum: array::from_fn(|a| total.momentum[a] - ledger.external_impulse[a]),
        });
        self.energy_scale = [start.energy, total.energies.kinetic, ledger.external_work, ledger.heat.exchanged]
            .into_iter()
            .map(f64::abs)
            .fold(self.energy_scale, f64::max);
        self.momentum_scale = self.momentum_scale.max(total.momentum_scale);

        let momentum_change = (0..3)
            .filter(|&a| !self.mirrored[a])
            .map(|a| (total.momentum[a] - start.momentum[a] - ledger.external_impulse[a]).powi(2))
            .sum::<f64>()
            .sqrt();
        self.last = Drift {
            energy: relative(energy - start.energy - supplied, self.energy_scale),
            momentum: relative(momentum_change, self.momentum_scale),
        };
        self.largest.energy = self.largest.energy.max(self.last.energy.abs());
        self.largest.momentum = self.largest.momentum.max(self.last.momentum);
        self.last
    }

    /// Measures drifts against no less than these amounts (J, kg m/s): those of rounding are not the drift of a body at
    /// rest.
    pub(super) fn set_floor(&mut self, energy: f64, momentum: f64) {
        self.energy_scale = self.energy_scale.max(energy);
        self.momentum_scale = self.momentum_scale.max(momentum);
    }

    /// The last drift, of amounts (J, kg m/s) larger than what counts as nothing.
    pub(super) fn drift_beyond(&self, energy: f64, momentum: f64) -> Drift {
        let beyond =
            |drift: f64, scale: f64, nothing: f64| if drift.abs() * scale > nothing { drift.abs() } else { 0.0 };
        Drift {
            energy: beyond(self.last.energy, self.energy_scale, energy),
            momentum: beyond(self.last.momentum, self.momentum_scale, momentum),
        }
    }
}

persist_fields!(Drift { energy, momentum });
persist_fields!(Start { energy, momentum });

impl Persist for Conservation {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        persist_option(&mut self.start, &format!("{name}.start"), archive)?;
        self.energy_scale.persist(&format!("{name}.energy_scale"), archive)?;
        self.momentum_scale.persist(&format!("{name}.momentum_scale"), archive)?;
        self.last.persist(&format!("{name}.last"), archive)?;
        self.largest.persist(&format!("{name}.largest"), archive)
    }
}

/// Change over scale; a change of nothing is all drift.
fn relative(change: f64, scale: f64) -> f64 {
    if change == 0.0 {
        0.0
    } else if scale > 0.0 {
        change / scale
    } else {
        change.signum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{BodyLedger, Energies};

    fn ledger(kinetic: f64, internal: f64, work: f64, momentum: f64, impulse: f64, scale: f64) -> Ledger {
        Ledger {
            total: BodyLedger {
                energies: Energies { kinetic, internal, ..Energies::default() },
                momentum: [0.0, momentum, 0.0],
                momentum_scale: scale,
                ..BodyLedger::default()
            },
            external_work: work,
            external_impulse: [0.0, impulse, 0.0],
            ..Ledger::default()
        }
    }

    #[test]
    fn drift_is_what_work_and_impulse_do_not_explain() {
        let mut conservation = Conservation::default();
        assert_eq!(conservation.sample(&ledger(100.0, 20.0, 0.0, -50.0, 0.0, 60.0)), Drift::default());
        // 100 + 20 + 6 of work should be 126, it is 120; -50 + 30 should be -20, it is -14.
        let drift = conservation.sample(&ledger(40.0, 80.0, 6.0, -14.0, 30.0, 10.0));
        assert_eq!(drift, Drift { energy: -6.0 / 120.0, momentum: 6.0 / 60.0 });
        let drift = conservation.sample(&ledger(40.0, 80.0, 0.0, -50.0, 0.0, 10.0));
        assert_eq!((drift, conservation.largest), (Drift::default(), Drift { energy: 0.05, momentum: 0.1 }));
    }

    #[test]
    fn a_body_pulled_from_rest_is_measured_against_the_work_done() {
        let mut conservation = Conservation::default();
        assert_eq!(conservation.sample(&ledger(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)), Drift::default());
        assert_eq!(conservation.sample(&ledger(1.0, 10.0, 10.0, 0.0, 0.0, 0.0)).energy, 0.1);
        // The scale is the largest so far: unloading does not make the drift explode.
        assert_eq!(conservation.sample(&ledger(0.0, 1.0, 0.0, 0.0, 0.0, 0.0)).energy, 0.1);
    }

    #[test]
    fn what_is_driven_from_the_start_has_no_drift() {
        let mut conservation = Conservation::default();
        assert_eq!(conservation.sample(&ledger(50.0, 0.0, 50.0, 5.0, 5.0, 5.0)), Drift::default());
        // 20 more of work and 2 of impulse; 1 and 0.5 of them are missing.
        let drift = conservation.sample(&ledger(60.0, 9.0, 70.0, 6.5, 7.0, 10.0));
        assert_eq!(drift, Drift { energy: -1.0 / 70.0, momentum: 0.5 / 10.0 });
    }

    #[test]
    fn momentum_across_a_plane_of_symmetry_is_not_counted() {
        let mut conservation = Conservation::new([false, true, false]);
        conservation.sample(&ledger(50.0, 0.0, 0.0, 5.0, 0.0, 5.0));
        assert_eq!(conservation.sample(&ledger(50.0, 0.0, 0.0, -5.0, 0.0, 5.0)).momentum, 0.0);
    }

    #[test]
    fn rounding_of_a_body_at_rest_is_no_drift() {
        let mut conservation = Conservation::default();
        conservation.sample(&ledger(0.0, 0.0, 0.0, 0.0, 0.0, 0.0));
        conservation.set_floor(1e-18, 1e-12);
        let drift = conservation.sample(&ledger(2e-24, 1e-24, 0.0, 1e-20, 0.0, 3e-20));
        assert_eq!(drift, Drift { energy: (2e-24 + 1e-24) / 1e-18, momentum: 1e-20 / 1e-12 });
        // Motion is measured against itself.
        let drift = conservation.sample(&ledger(1.0, 0.0, 0.5, 2.0, 1.0, 4.0));
        assert_eq!(drift, Drift { energy: 0.5, momentum: 0.25 });
    }

    #[test]
    fn energy_out_of_nothing_is_all_drift() {
        let mut conservation = Conservation::default();
        conservation.sample(&ledger(0.0, 0.0, 0.0, 0.0, 0.0, 0.0));
        assert_eq!(conservation.sample(&ledger(0.0, 3.0, 0.0, 0.0, 0.0, 0.0)).energy, 1.0);
    }
}
