//! History variables that material laws declare.

use super::Particles;
use crate::model::Model;
use sphorge_physics::history::HistoryVariable;

/// A history variable of all particles; zero or its initial value where the material's law does not have it.
#[derive(Clone, Debug)]
pub struct HistoryColumn {
    /// What the law declares.
    pub variable: &'static HistoryVariable,
    /// One value per particle.
    pub values: Vec<f64>,
}

impl Particles {
    /// Adds the history variables of the material laws of a model, at their initial values.
    pub(crate) fn add_histories(&mut self, model: &Model) {
        for variable in model.materials.iter().flat_map(|material| material.flow_law.history()) {
            if self.history.iter().all(|column| column.variable.name != variable.name) {
                self.history.push(HistoryColumn::new(variable, self.len()));
            }
        }
    }
}

impl HistoryColumn {
    /// A variable of `count` particles at its initial value.
    fn new(variable: &'static HistoryVariable, count: usize) -> Self {
        Self { variable, values: vec![variable.initial; count] }
    }

    /// Whether the value of particle `i` is in the range the law gives.
    pub(super) fn is_valid(&self, i: usize) -> bool {
        self.variable.bound.allows(self.values[i])
    }
}
