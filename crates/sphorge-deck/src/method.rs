//! Methods: consistent sets of choices, one key of a deck. Any other key of the deck takes the place of what the method has for it.

use crate::defaults;
use crate::strategy::Strategy;
use sphorge_engine::model::{Arrangement, ArtificialStress, FaceGradients, Formulation, Integrator, Search};

/// A method by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    TotalLagrangian,
    UpdatedLagrangian,
    Patino,
    Fraser,
}

/// What a method has for the keys a deck leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choices {
    pub(crate) strategy: Strategy,
    pub(crate) integrator: Integrator,
    pub(crate) artificial_stress: Option<ArtificialStress>,
    pub(crate) xsph: f64,
    pub(crate) wall: WallContactKind,
    /// Linear and quadratic constant of the artificial viscosity.
    pub(crate) viscosity: (f64, f64),
    /// That of shocks along pairs where bodies meet fast.
    pub(crate) viscosity_of_shocks: f64,
    /// Arrangement of the particles of bodies that rings can fill.
    pub(crate) round: Arrangement,
    /// Smoothing length over spacing.
    pub(crate) smoothing: f64,
    /// Courant number.
    pub(crate) courant: f64,
}

/// Which contact a wall has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WallContactKind {
    /// Repulsion of Monaghan & Kos.
    MonaghanKos,
    Penalty,
}

/// Plain sums over the neighbours as they are, which the papers' methods add to.
const UPDATED: Choices = Choices {
    strategy: Strategy::updated(defaults::SKIN),
    integrator: Integrator::Leapfrog,
    artificial_stress: None,
    xsph: 0.0,
    wall: WallContactKind::MonaghanKos,
    viscosity: defaults::VISCOSITY,
    viscosity_of_shocks: 0.0,
    round: Arrangement::Square,
    smoothing: defaults::SMOOTHING,
    courant: defaults::COURANT,
};

impl Method {
    /// The method of a deck that names none: that of the strategy it names, or the default.
    pub(crate) fn of(strategy: Option<Strategy>) -> Self {
        match strategy.map(|strategy| strategy.formulation) {
            Some(Formulation::UpdatedLagrangian) => Self::UpdatedLagrangian,
            Some(Formulation::TotalLagrangian { .. }) | None => Self::TotalLagrangian,
        }
    }

    /// What it has for all keys.
    pub(crate) const fn choices(self) -> Choices {
        let (epsilon, exponent) = defaults::ARTIFICIAL_STRESS;
        match self {
            Self::TotalLagrangian => {
                // A square lattice has steps for a round surface, and corners beyond it: a bar of twelve particles across is 4 % too wide.
                Choices {
                    strategy: Strategy::TOTAL,
                    wall: WallContactKind::Penalty,
                    viscosity: defaults::BULK_VISCOSITY,
                    viscosity_of_shocks: defaults::VISCOSITY_OF_SHOCKS,
                    round: Arrangement::Rings,
                    smoothing: defaults::LAGRANGIAN_SMOOTHING,
                    courant: defaults::LAGRANGIAN_COURANT,
                    ..UPDATED
                }
            }
            Self::UpdatedLagrangian => UPDATED,
            Self::Patino => Choices {
                strategy: Strategy::updated(Search::EveryStep),
                integrator: Integrator::PredictorCorrector,
                artificial_stress: Some(ArtificialStress { epsilon, exponent }),
                xsph: defaults::XSPH,
                ..UPDATED
            },
            Self::Fraser => Choices {
                strategy: Strategy::updated(Search::Adaptive(defaults::ADAPTIVE)),
                artificial_stress: Some(ArtificialStress { epsilon, exponent: defaults::FRASER_EXPONENT }),
                xsph: defaults::XSPH,
                ..UPDATED
            },
        }
    }

    /// What it has for the keys beside a strategy that may be another than its own: what belongs to the form goes with the form.
    pub(crate) fn beside(self, strategy: Strategy) -> Choices {
        match (self, strategy.formulation) {
            (_, Formulation::TotalLagrangian { faces: FaceGradients::Quadratic, .. }) => {
                Choices { courant: defaults::COURANT, ..Self::TotalLagrangian.choices() }
            }
            (_, Formulation::TotalLagrangian { .. }) => Self::TotalLagrangian.choices(),
            (Self::TotalLagrangian, Formulation::UpdatedLagrangian) => UPDATED,
            (method, Formulation::UpdatedLagrangian) => method.choices(),
        }
    }
}
