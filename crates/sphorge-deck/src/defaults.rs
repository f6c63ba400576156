//! What a deck gets where it says nothing; the reference page states the same values, and a test compares them.

use sphorge_engine::model::{AdaptiveSearch, FaceGradients, Search};

/// Smoothing length over spacing.
pub(crate) const SMOOTHING: f64 = 1.2;
/// That of the total Lagrangian form, whose corrected sums need fewer neighbours and smear a foot less: the largest strain of a copper bar at
/// 250 m/s, 12 particles across, is 10.0 % below that of finite elements with 1.2, 8.6 % with 1.1.
pub(crate) const LAGRANGIAN_SMOOTHING: f64 = 1.1;
/// Courant number.
pub(crate) const COURANT: f64 = 0.3;
/// That of the total Lagrangian form, whose neighbours stay: a body alone is stable beyond one. Copper at 190 m/s has its foot at 14.609, 14.614 and 14.629 mm
/// with 0.3, 0.6 and 1. Where bodies meet the engine steps no farther than at 0.3. Fluids, which
/// bear the same motions by viscosity alone, have [`COURANT`].
pub(crate) const LAGRANGIAN_COURANT: f64 = 0.45;
/// Linear and quadratic artificial viscosity.
pub(crate) const VISCOSITY: (f64, f64) = (1.0, 1.0);
/// That of the total Lagrangian form. Viscosity is dissipation there, nothing else, and the linear part acts on waves of few particles alone: if it acted on all
/// motion, a standing wave of 20 particles would lose 65 % of its amplitude in 50 periods, not 4 %.
/// The quadratic part is next to nothing in waves and flow: from 1 to 8 feet of bars become 0.1 % narrower. Behind the shock of plates of copper that meet at
/// 20 km/s pressures are up to 12.0, 10.8, 9.8 % too high with 6, 8, 10.
pub(crate) const BULK_VISCOSITY: (f64, f64) = (0.1, 10.0);
/// Linear viscosity of shocks along pairs where bodies meet fast. With it plates of copper that meet at 0.5 to 10 km/s have pressures that are up to 7 % too
/// high behind the fronts, with half of it 9 %, without it 35 % and more. Impacts on walls also heat their first layers: the foot of a bar of copper at 190 m/s with 12
/// particles across would be 0.8 % narrower.
pub(crate) const VISCOSITY_OF_SHOCKS: f64 = 1.0;
/// How often a step that changes too much is repeated.
pub(crate) const REPEATS: u32 = 10;
/// Strength of XSPH in the papers' methods.
pub(crate) const XSPH: f64 = 0.5;
/// Exponent of the artificial stress in the method of Fraser et al.
pub(crate) const FRASER_EXPONENT: u32 = 6;
/// Strength and exponent of the artificial stress, where it is asked for (Gray, Monaghan & Swift 2001).
pub(crate) const ARTIFICIAL_STRESS: (f64, u32) = (0.3, 4);
/// Thickness of the neighbour skin over the kernel radius.
pub(crate) const SKIN_FRACTION: f64 = 0.1;
/// Lists with a skin.
pub(crate) const SKIN: Search = Search::Skin { fraction: SKIN_FRACTION };
/// Strain since its last search at which the guard of the adaptive search searches a particle.
pub(crate) const GUARD_STRAIN: f64 = 0.005;
/// Adaptive search: the middle threshold of Fraser's Table 1, guarded.
pub(crate) const ADAPTIVE: AdaptiveSearch =
    AdaptiveSearch { plastic_strain_threshold: 1e-5, accumulate: false, guard: Some(GUARD_STRAIN) };
/// Strength of the hourglass springs of the total Lagrangian form. Free strips of 2, 3 and 5 layers bend with 1.089, 0.989 and 0.991 of the frequency of
/// a Timoshenko beam, with a strength of 1 with 1.031, 0.945 and 0.973.
pub(crate) const HOURGLASS: f64 = 1.25;
/// The same where gradients are exact for quadratic fields at faces, so that sums lack less in bending: strips of 3, 4 and 6 layers bend with 1.006,
/// 1.006 and 1.004 of the frequency of a beam.
pub(crate) const QUADRATIC_HOURGLASS: f64 = 0.4;

/// Strength of the hourglass springs with these gradients.
pub(crate) const fn hourglass(faces: FaceGradients) -> f64 {
    match faces {
        FaceGradients::Linear => HOURGLASS,
        FaceGradients::Quadratic => QUADRATIC_HOURGLASS,
    }
}

/// Principal stretch at which the total Lagrangian form renews its reference configuration. The foot of a copper bar of 24 particles across that is
/// pressed flat at 300 m/s is stretched by 11.5 at its axis and must not come apart; at 8 it does, and folds through its image. The crater of
/// `penetration` at 0.4 mm is 30.0 mm wide with 8 and 31.9 with 16.
pub(crate) const RENEWAL: Option<f64> = Some(16.0);
/// Stiffness, damping and friction of the penalty contact.
pub(crate) const PENALTY: (f64, f64, f64) = (1.0, 0.1, 0.0);
/// The same at facets: as stiff as the half cell.
pub(crate) const FACET_PENALTY: (f64, f64, f64) = (2.0, 0.05, 0.0);
/// Stiffness, damping and friction of the contact between bodies.
pub(crate) const BODY_CONTACT: (f64, f64, f64) = (1.0, 0.3, 0.0);
/// The same between bodies that meet at facets: that of the half cells on both sides would have the stiffness one. With more damping plates of
/// ten layers that meet lose more than a per cent of their energy.
pub(crate) const FACET_CONTACT: (f64, f64, f64) = (2.0, 0.05, 0.0);
/// Largest ratio of a smoothing length that follows the density to the initial one.
pub(crate) const SMOOTHING_FACTOR: f64 = 2.0;
/// Frames over a run.
pub(crate) const FRAMES: u64 = 50;
/// Rows of the history over a run.
pub(crate) const HISTORY_ROWS: u64 = 500;
/// Share of plastic work that heats.
pub(crate) const TAYLOR_QUINNEY: f64 = 0.9;
/// Temperature of a material that names none, K.
pub(crate) const REFERENCE_TEMPERATURE: f64 = 293.15;
/// Distance up to which particles of a plate hang together, in spacings.
pub(crate) const LINK: f64 = 1.5;

/// Particles of a fragment at least.
pub(crate) const LEAST_FRAGMENT: u64 = 10;
/// Fields of a tracer; one fixed in space has no use for the first.
pub(crate) const TRACER_FIELDS: [&str; 6] =
    ["position", "velocity", "pressure", "von_mises_stress", "plastic_strain", "temperature"];
