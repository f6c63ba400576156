//! Checks that say of a run that it is broken, and their limits.

/// A check made while a run goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WarningKind {
    /// More plastic work than energy was supplied.
    PlasticWork,
    /// Internal energy below what heat can have left of it.
    NegativeEnergy,
    /// Work of hourglass springs that they do not hold.
    HourglassWork,
    /// Energy that the integration in time has lost or made.
    Integration,
    /// Energy that contacts of bodies have given without having held it.
    ContactEnergy,
    /// A particle colder than absolute zero.
    Cold,
    /// A particle hotter than its energy allows.
    Hot,
    /// A particle colder than its energy.
    MissingHeat,
    /// Work of walls that do not move.
    WallEnergy,
    /// Energy that came from nowhere or went nowhere.
    EnergyDrift,
    /// The same of linear momentum.
    MomentumDrift,
    /// Particles of one body that have fallen together in pairs.
    Pairing,
    /// A zone of a body that cannot break in which particles have fallen together in pairs in tension.
    Tearing,
    /// A body that cannot break in pieces.
    Pieces,
    /// Particles of a body that cannot break without the neighbours a gradient needs.
    LostNeighbors,
    /// Particles of a body in another body.
    Interpenetration,
    /// A particle behind a symmetry plane.
    BehindSymmetry,
    /// A particle far from where anything can have come.
    FarAway,
    /// A density above those the pressure law is made for.
    Compression,
    /// A density below those the pressure law is made for.
    Expansion,
    /// A time step that has collapsed.
    TimeStep,
    /// More steps to go than anybody waits for.
    StepsLeft,
}

/// What is known of a check.
#[derive(Clone, Copy, Debug)]
pub struct WarningInfo {
    /// Name in decks and in `summary.json`.
    pub name: &'static str,
    /// Unit of the number that is held against the limit, SI, empty for pure numbers.
    pub unit: &'static str,
    /// Limit unless the deck gives another.
    pub limit: f64,
    /// Whether numbers below the limit are the wrong ones; otherwise those above.
    pub is_floor: bool,
    /// What the number is.
    pub meaning: &'static str,
}

const fn above(name: &'static str, limit: f64, meaning: &'static str) -> WarningInfo {
    WarningInfo { name, unit: "", limit, is_floor: false, meaning }
}

const fn below(name: &'static str, limit: f64, meaning: &'static str) -> WarningInfo {
    WarningInfo { name, unit: "", limit, is_floor: true, meaning }
}

impl WarningKind {
    /// Every check.
    pub const ALL: [Self; 22] = [
        Self::PlasticWork,
        Self::NegativeEnergy,
        Self::HourglassWork,
        Self::Integration,
        Self::ContactEnergy,
        Self::Cold,
        Self::Hot,
        Self::MissingHeat,
        Self::WallEnergy,
        Self::EnergyDrift,
        Self::MomentumDrift,
        Self::Pairing,
        Self::Tearing,
        Self::Pieces,
        Self::LostNeighbors,
        Self::Interpenetration,
        Self::BehindSymmetry,
        Self::FarAway,
        Self::Compression,
        Self::Expansion,
        Self::TimeStep,
        Self::StepsLeft,
    ];

    /// What is known of it.
    pub fn info(self) -> WarningInfo {
        match self {
            Self::PlasticWork => above("plastic-work", 1.01, "plastic work over the energy supplied"),
            Self::NegativeEnergy => above(
                "negative-energy",
                0.01,
                "deficit of internal energy below the floor that heat can explain, over the energy supplied",
            ),
            Self::HourglassWork => above(
                "hourglass-work",
                0.1,
                "work of the hourglass springs that they do not hold, of either sign, beyond what the integrator booked, over the energy supplied",
            ),
            Self::Integration => above(
                "integration",
                0.1,
                "energy that the integration in time has lost or made, over the energy that has passed between motion and matter",
            ),
            Self::ContactEnergy => above(
                "contact-energy",
                0.01,
                "energy that contacts between bodies have given beyond what they took and held at the start, over the energy supplied",
            ),
            Self::Cold => WarningInfo { unit: "K", ..below("cold", 0.0, "temperature") },
            Self::Hot => above("hot", 2.0, "temperature over the highest that the particle's energy allows"),
            Self::MissingHeat => above("missing-heat", 1.5, "temperature of the energy over that of plastic work"),
            Self::WallEnergy => above("wall-energy", 0.2, "work of walls at rest over the initial kinetic energy"),
            Self::EnergyDrift => above(
                "energy-drift",
                1e-4,
                "change of the total energy that neither work nor heat explains, over the energy in play",
            ),
            Self::MomentumDrift => above(
                "momentum-drift",
                1e-4,
                "change of the linear momentum that no external impulse explains, over the sum of all m |v|",
            ),
            Self::Pairing => above("pairing", 0.1, "share of the particles of a body that have clumped in pairs"),
            Self::Tearing => above(
                "tearing",
                1.0,
                "number of particles of a body that cannot break in zones where more than 40 % have clumped in pairs in tension, over the number within one kernel",
            ),
            Self::Pieces => above(
                "pieces",
                0.01,
                "share of the particles of a body that cannot break that have separated from its largest piece",
            ),
            Self::LostNeighbors => above(
                "lost-neighbors",
                0.001,
                "share of the particles of a body that cannot break that have too few neighbours for a gradient",
            ),
            Self::Interpenetration => {
                above("interpenetration", 0.03, "share of the particles of a body that lie in cells of another body")
            }
            Self::BehindSymmetry => {
                above("behind-symmetry", 0.5, "depth of a particle behind a symmetry plane over the spacing")
            }
            Self::FarAway => {
                above("far-away", 3.0, "distance from the initial bodies over the largest possible travel")
            }
            Self::Compression => {
                above("compression", 1.0, "compression chi = 1 - rho_0/rho over the largest that a shock reaches, 1/S")
            }
            Self::Expansion => below("expansion", 0.5, "density over the reference density"),
            Self::TimeStep => below("time-step", 1e-3, "time step over the first time step"),
            Self::StepsLeft => above("steps-left", 1e8, "steps to the end of the run at the present time step"),
        }
    }

    /// Name in decks and in `summary.json`.
    pub fn name(self) -> &'static str {
        self.info().name
    }
}

/// Which checks are made, and their limits.
#[derive(Clone, Debug, PartialEq)]
pub struct WarningLimits {
    /// By the place in [`WarningKind::ALL`]; none for a check that is not made.
    limits: [Option<f64>; WarningKind::ALL.len()],
    /// A run that has more steps than this to go is stopped.
    pub stop_at_steps: f64,
}

/// Steps to go at which a run is stopped unless the deck says otherwise: more than a day of the smallest model.
pub const STOP_AT_STEPS: f64 = 1e10;

impl Default for WarningLimits {
    fn default() -> Self {
        Self { limits: WarningKind::ALL.map(|kind| Some(kind.info().limit)), stop_at_steps: STOP_AT_STEPS }
    }
}

impl WarningLimits {
    /// The limit of a check; none if it is not made.
    pub fn of(&self, kind: WarningKind) -> Option<f64> {
        self.limits[kind as usize]
    }

    /// Sets the limit of a check, or turns it off.
    pub fn set(&mut self, kind: WarningKind, limit: Option<f64>) {
        self.limits[kind as usize] = limit;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_check_stands_at_its_own_place_under_its_own_name() {
        for (k, kind) in WarningKind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, k);
            assert!(WarningKind::ALL[..k].iter().all(|other| other.name() != kind.name()), "{}", kind.name());
        }
    }

    #[test]
    fn a_limit_that_is_set_is_that_of_its_check_alone() {
        let mut limits = WarningLimits::default();
        limits.set(WarningKind::Hot, Some(5.0));
        limits.set(WarningKind::Pairing, None);
        assert_eq!((limits.of(WarningKind::Hot), limits.of(WarningKind::Pairing)), (Some(5.0), None));
        assert_eq!(limits.of(WarningKind::Cold), Some(0.0));
    }
}
