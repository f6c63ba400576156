//! History variables that material laws declare: stored, named, guarded, saved and reordered for them.

use super::Permutation;
use crate::model::Model;
use crate::neighbors::BLOCK;
use crate::persist::{Archive, ArchiveError, Persist, persist_column};
use sphorge_physics::history::HistoryVariable;

/// History variables of all particles. Every particle has all of them, at the initial value where its law has no use for one.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Variables of the laws of a model, each once.
    variables: Vec<&'static HistoryVariable>,
    /// For each material, the variables of its law in the law's order.
    slots: Vec<Vec<usize>>,
    /// Values of a block of particles, particle by particle.
    blocks: Vec<Vec<f64>>,
}

impl History {
    /// The variables of the laws of a model for `count` particles, at their initial values.
    pub(crate) fn new(model: &Model, count: usize) -> Self {
        let mut variables: Vec<&'static HistoryVariable> = Vec::new();
        let mut slots = Vec::new();
        for material in &model.materials {
            let of_law = material.flow_law.history().iter().map(|variable| {
                variables.iter().position(|known| known.name == variable.name).unwrap_or_else(|| {
                    variables.push(variable);
                    variables.len() - 1
                })
            });
            slots.push(of_law.collect());
        }
        let initial: Vec<f64> = variables.iter().map(|variable| variable.initial).collect();
        let block = |b: usize| initial.repeat(BLOCK.min(count - b * BLOCK));
        let blocks = (0..count.div_ceil(BLOCK)).map(block).collect();
        Self { variables, slots, blocks }
    }

    /// Values of every block, and for each material the places of its law's variables among those of a particle.
    pub(crate) fn parts(&mut self) -> (&mut [Vec<f64>], &[Vec<usize>], usize) {
        (&mut self.blocks, &self.slots, self.variables.len())
    }

    /// The variable of that name, of all particles.
    pub(super) fn column(&self, name: &str) -> Option<Vec<f64>> {
        let width = self.variables.len();
        let k = self.variables.iter().position(|variable| variable.name == name)?;
        Some(self.blocks.iter().flat_map(|block| block.iter().skip(k).step_by(width).copied()).collect())
    }

    /// Sets the variable of that name, if there is one.
    pub(super) fn set_column(&mut self, name: &str, values: &[f64]) {
        let width = self.variables.len();
        let Some(k) = self.variables.iter().position(|variable| variable.name == name) else { return };
        let places = self.blocks.iter_mut().flat_map(|block| block.iter_mut().skip(k).step_by(width));
        places.zip(values).for_each(|(place, value)| *place = *value);
    }

    pub(super) fn reorder(&mut self, permutation: &Permutation) {
        for variable in self.variables.clone() {
            let Some(mut values) = self.column(variable.name) else { continue };
            permutation.apply(&mut values);
            self.set_column(variable.name, &values);
        }
    }

    /// The first variable of particle `i` that is out of the range its law gives.
    #[inline(always)]
    pub(super) fn first_fault(&self, i: usize) -> Option<&'static str> {
        let width = self.variables.len();
        if width == 0 {
            return None;
        }
        let values = &self.blocks[i / BLOCK][i % BLOCK * width..][..width];
        let wrong = |(variable, value): &(&&HistoryVariable, &f64)| !variable.bound.allows(**value);
        self.variables.iter().zip(values).find(wrong).map(|(variable, _)| variable.name)
    }

    pub(super) fn bytes(&self) -> usize {
        self.blocks.iter().map(|block| 8 * block.capacity()).sum()
    }
}

impl Persist for History {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        for variable in self.variables.clone() {
            let mut values = self.column(variable.name).unwrap_or_default();
            persist_column(&mut values, &format!("{name}.{}", variable.name), archive)?;
            self.set_column(variable.name, &values);
        }
        Ok(())
    }
}
