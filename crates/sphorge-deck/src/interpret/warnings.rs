//! When a run is said to be broken.

use crate::fault::Problems;
use crate::raw::RawWarnings;
use sphorge_engine::model::{STOP_AT_STEPS, WarningKind, WarningLimits};
use sphorge_physics::parameter::Bound;

/// Limits of the checks.
pub(crate) fn limits(raw: &RawWarnings, problems: &mut Problems) -> Option<WarningLimits> {
    let mut limits = WarningLimits::default();
    let numbers = [
        (WarningKind::PlasticWork, &raw.plastic_work),
        (WarningKind::NegativeEnergy, &raw.negative_energy),
        (WarningKind::HourglassWork, &raw.hourglass_work),
        (WarningKind::Integration, &raw.integration),
        (WarningKind::ContactEnergy, &raw.contact_energy),
        (WarningKind::Hot, &raw.hot),
        (WarningKind::MissingHeat, &raw.missing_heat),
        (WarningKind::WallEnergy, &raw.wall_energy),
        (WarningKind::EnergyDrift, &raw.energy_drift),
        (WarningKind::MomentumDrift, &raw.momentum_drift),
        (WarningKind::Pairing, &raw.pairing),
        (WarningKind::Tearing, &raw.tearing),
        (WarningKind::Pieces, &raw.pieces),
        (WarningKind::LostNeighbors, &raw.lost_neighbors),
        (WarningKind::Interpenetration, &raw.interpenetration),
        (WarningKind::BehindSymmetry, &raw.behind_symmetry),
        (WarningKind::FarAway, &raw.far_away),
        (WarningKind::Compression, &raw.compression),
        (WarningKind::Expansion, &raw.expansion),
        (WarningKind::TimeStep, &raw.time_step),
        (WarningKind::StepsLeft, &raw.steps_left),
    ];
    for (kind, given) in numbers {
        if let Some(given) = given {
            limits.set(kind, given.within(Bound::NonNegative, problems));
        }
    }
    if let Some(given) = &raw.cold {
        limits.set(WarningKind::Cold, given.within(Bound::NonNegative, problems));
        // A limit may be as low as one likes.
        problems.drop_doubt(&given.span());
    }
    for word in raw.off.iter().flatten() {
        if let Some(kind) = word.get(problems) {
            limits.set(kind, None);
        }
    }
    limits.stop_at_steps = raw.stop_at_steps.as_ref().map_or(Some(STOP_AT_STEPS), |given| given.positive(problems))?;
    Some(limits)
}
