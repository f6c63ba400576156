//! What the key `search` chooses, a neighbour search and a formulation, and what the formulation leaves out of the model.

use crate::defaults;
use sphorge_engine::model::{FaceGradients, Formulation, Numerics, Search};
use sphorge_physics::pair::PairForm;

/// Neighbour search and formulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strategy {
    pub(crate) search: Search,
    pub(crate) formulation: Formulation,
}

impl Strategy {
    /// The updated Lagrangian form with a search.
    pub(crate) const fn updated(search: Search) -> Self {
        Self { search, formulation: Formulation::UpdatedLagrangian }
    }

    /// The total Lagrangian form, whose lists are those of the start, with the default of each of its keys.
    pub(crate) const TOTAL: Self = Self::total(Formulation::TotalLagrangian {
        hourglass: defaults::hourglass(FaceGradients::Linear),
        faces: FaceGradients::Linear,
        renewal: defaults::RENEWAL,
        self_contact: true,
    });

    /// The total Lagrangian form with these constants.
    pub(crate) const fn total(formulation: Formulation) -> Self {
        Self { search: Search::Initial, formulation }
    }

    /// Takes out of the choices what the formulation does without; what to tell the user whose keys had asked for it.
    pub(crate) fn normalise(self, numerics: &mut Numerics) -> Option<String> {
        match self.formulation {
            Formulation::UpdatedLagrangian => {
                let mut asked = Vec::new();
                if std::mem::take(&mut numerics.viscosity_of_shocks) != 0.0 {
                    asked.push("`numerics.viscosity.shocks`");
                }
                if std::mem::take(&mut numerics.viscosity_of_all_waves) {
                    asked.push("`numerics.viscosity.all-waves`");
                }
                let asked = asked.join(", ");
                return (!asked.is_empty()).then(|| format!("only the total Lagrangian form uses {asked}"));
            }
            Formulation::TotalLagrangian { .. } => {}
        }
        let mut dropped = Vec::new();
        if numerics.artificial_stress.take().is_some() {
            dropped.push("artificial-stress");
        }
        if std::mem::take(&mut numerics.xsph) != 0.0 {
            dropped.push("xsph");
        }
        if std::mem::take(&mut numerics.balsara) {
            dropped.push("viscosity.balsara");
        }
        if numerics.mls_interval.take().is_some() {
            dropped.push("mls-interval");
        }
        if std::mem::replace(&mut numerics.pair_form, PairForm::VolumeWeighted) != PairForm::VolumeWeighted {
            dropped.push("pair-form");
        }
        let keys: Vec<String> = dropped.iter().map(|key| format!("`numerics.{key}`")).collect();
        (!keys.is_empty()).then(|| format!("the total Lagrangian form does not use {}", keys.join(", ")))
    }
}
