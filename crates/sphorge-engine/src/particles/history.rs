//! History variables that material laws declare: stored, named, guarded, saved and reordered for them.

use super::{ColumnVisitor, Permutation};
use crate::model::{Material, Model};
use crate::neighbors::BLOCK;
use crate::persist::{Archive, ArchiveError, Fixed, Persist, persist_pieces};
use sphorge_physics::damage::{FRACTURE_ENERGY, KEPT};
use sphorge_physics::flow::FLOW_LAWS;
use sphorge_physics::history::HistoryVariable;
use sphorge_physics::integrity::INTEGRITY;

/// History variables of all particles. Every particle has all of them, at the initial value where its law has no use for one.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Variables of the laws of a model, each once.
    variables: Vec<&'static HistoryVariable>,
    /// For each material, the variables of its flow law in the law's order, those of damage, then its integrity if it breaks.
    slots: Vec<Vec<usize>>,
    /// Place of the integrity among the variables, if some material breaks.
    integrity: Option<usize>,
    /// Values of a block of particles, particle by particle.
    blocks: Vec<Vec<f64>>,
}

/// All variables that materials may keep.
pub(super) fn all_declared() -> impl Iterator<Item = &'static HistoryVariable> {
    FLOW_LAWS.iter().flat_map(|law| law.history).chain(KEPT).chain([&INTEGRITY])
}

/// The variable of that name, if some law declares one.
pub(super) fn declared(name: &str) -> Option<&'static HistoryVariable> {
    all_declared().find(|variable| variable.name == name)
}

/// The variables that a material keeps: those of its flow law in the law's order, those of damage if it has a law of it, then its integrity if
/// it breaks.
pub(super) fn kept_by(material: &Material) -> impl Iterator<Item = &'static HistoryVariable> {
    let of_damage = material.damage.iter().flat_map(|_| KEPT);
    material.flow_law.history().iter().chain(of_damage).chain(material.breaks().then_some(&INTEGRITY))
}

/// What the laws of a model keep of the past of a particle.
#[derive(Clone, Debug, Default)]
pub struct HistoryVariables {
    /// Variables of all laws, each once.
    pub variables: Vec<&'static HistoryVariable>,
    /// For each material, the places among them of the variables of its flow law, in the law's order, those of damage if it has a law of it, then
    /// that of its integrity if it breaks.
    pub slots: Vec<Vec<usize>>,
}

impl HistoryVariables {
    /// The place of the integrity among them, if some material loses it.
    pub fn integrity(&self) -> Option<usize> {
        place_of_integrity(&self.variables)
    }

    /// Those of the materials of a model.
    pub fn of(model: &Model) -> Self {
        let mut variables: Vec<&'static HistoryVariable> = Vec::new();
        let mut slots = Vec::new();
        for material in &model.materials {
            let of_material = kept_by(material).map(|variable| {
                variables.iter().position(|known| known.name == variable.name).unwrap_or_else(|| {
                    variables.push(variable);
                    variables.len() - 1
                })
            });
            slots.push(of_material.collect());
        }
        Self { variables, slots }
    }
}

impl History {
    /// The variables of the laws of a model for `count` particles, at their initial values.
    pub(crate) fn new(model: &Model, count: usize) -> Self {
        let HistoryVariables { variables, slots } = HistoryVariables::of(model);
        Self::at_start(variables, slots, count)
    }

    fn at_start(variables: Vec<&'static HistoryVariable>, slots: Vec<Vec<usize>>, count: usize) -> Self {
        let initial: Vec<f64> = variables.iter().map(|variable| variable.initial).collect();
        let block = |b: usize| initial.repeat(BLOCK.min(count - b * BLOCK));
        let blocks = (0..count.div_ceil(BLOCK)).map(block).collect();
        let integrity = place_of_integrity(&variables);
        Self { variables, slots, integrity, blocks }
    }

    /// Share of tension and shear that particle `i` still bears.
    pub fn integrity_of(&self, i: usize) -> f64 {
        let width = self.variables.len();
        self.integrity.map_or(INTEGRITY.initial, |k| self.blocks[i / BLOCK][i % BLOCK * width + k])
    }

    /// Whether some material breaks by damage.
    pub(crate) fn keeps_fracture_energy(&self) -> bool {
        self.variables.iter().any(|variable| variable.name == FRACTURE_ENERGY.name)
    }

    /// Adds the energy that breaking has dissipated in particles of these masses (kg), J, in their order.
    pub(crate) fn add_fracture_energy(&self, masses: &[f64], sum: &mut [f64]) {
        let Some(k) = self.variables.iter().position(|variable| variable.name == FRACTURE_ENERGY.name) else { return };
        let width = self.variables.len();
        let energies = self.blocks.iter().flat_map(|block| block.iter().skip(k).step_by(width));
        for (energy, mass) in energies.zip(masses) {
            sum[0] += mass * energy;
        }
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

    /// Sets the variable of that name; one that some law declares and that is not kept yet is kept from now on.
    pub(super) fn set_column(&mut self, name: &str, values: &[f64]) {
        let width = self.variables.len();
        let Some(k) = self.variables.iter().position(|variable| variable.name == name) else {
            if let Some(variable) = declared(name) {
                self.add(variable, values);
            }
            return;
        };
        let places = self.blocks.iter_mut().flat_map(|block| block.iter_mut().skip(k).step_by(width));
        places.zip(values).for_each(|(place, value)| *place = *value);
    }

    /// Keeps another variable, with these values.
    pub(crate) fn add(&mut self, variable: &'static HistoryVariable, values: &[f64]) {
        let width = self.variables.len();
        self.variables.push(variable);
        self.integrity = place_of_integrity(&self.variables);
        self.blocks.resize(values.len().div_ceil(BLOCK), Vec::new());
        for (block, values) in self.blocks.iter_mut().zip(values.chunks(BLOCK)) {
            let longer = |(i, value): (usize, &f64)| [&block[i * width..][..width], &[*value]].concat();
            *block = values.iter().enumerate().flat_map(longer).collect();
        }
    }

    pub(super) fn reorder(&mut self, permutation: &Permutation) {
        for variable in self.variables.clone() {
            let Some(mut values) = self.column(variable.name) else { continue };
            permutation.apply(&mut values);
            self.set_column(variable.name, &values);
        }
    }

    /// Shows every variable as a column; there are so many particles afterwards.
    pub(super) fn visit(&mut self, visitor: &mut impl ColumnVisitor, count: usize) {
        let mut visited = Self::at_start(self.variables.clone(), std::mem::take(&mut self.slots), count);
        for variable in &self.variables {
            let mut values = self.column(variable.name).unwrap_or_default();
            visitor.visit(&mut values);
            visited.set_column(variable.name, &values);
        }
        *self = visited;
    }

    /// Bytes of the values of one particle.
    pub(super) fn width(&self) -> usize {
        self.variables.len() * f64::SIZE
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

/// Place of the integrity among variables.
fn place_of_integrity(variables: &[&'static HistoryVariable]) -> Option<usize> {
    variables.iter().position(|variable| variable.name == INTEGRITY.name)
}

impl Persist for History {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        for variable in self.variables.clone() {
            let mut values = self.column(variable.name).unwrap_or_default();
            persist_pieces(&mut values, &format!("{name}.{}", variable.name), archive)?;
            self.set_column(variable.name, &values);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::{Column, Particles};
    use sphorge_physics::parameter::Bound;

    const fn variable(name: &'static str, initial: f64, bound: Bound) -> HistoryVariable {
        HistoryVariable { name, unit: "", initial, bound, meaning: "for a test" }
    }
    static DAMAGE: HistoryVariable = variable("damage", 0.0, Bound::Between(0.0, 1.0));
    static POROSITY: HistoryVariable = variable("porosity", 0.5, Bound::Any);

    /// More particles than a block holds, damage by place.
    fn damaged() -> Particles {
        let count = BLOCK + 3;
        let mut particles = Particles::new(count);
        particles.density.fill(1.0);
        particles.history = History::at_start(vec![&DAMAGE], vec![vec![0]], count);
        let damage: Vec<f64> = (0..count).map(|i| i as f64 / count as f64).collect();
        particles.set_column("damage", &Column::Scalar(damage.into()));
        particles
    }

    #[test]
    fn a_variable_is_a_column_that_moves_with_its_particles() {
        let mut particles = damaged();
        let count = particles.len();
        let mut backwards = Permutation::default();
        backwards.set(&(0..count as u32).rev().collect::<Vec<_>>());
        particles.reorder(&backwards);
        let damage = particles.column("damage").unwrap();
        assert_eq!((damage.component(0, 0), damage.component(count - 1, 0)), ((count - 1) as f64 / count as f64, 0.0));
    }

    /// Keeps every other value.
    struct Halved;

    impl ColumnVisitor for Halved {
        fn visit<V: Fixed + Copy>(&mut self, column: &mut Vec<V>) {
            *column = column.iter().copied().step_by(2).collect();
        }
    }

    #[test]
    fn a_variable_is_shown_with_the_columns() {
        let mut particles = damaged();
        particles.history.add(&POROSITY, &(0..BLOCK + 3).map(|i| i as f64).collect::<Vec<_>>());
        let (width, damage) = (particles.width(), particles.history.column("damage").unwrap());
        particles.visit(&mut Halved);
        let halved: Vec<f64> = damage.into_iter().step_by(2).collect();
        assert_eq!(particles.history.column("damage").unwrap(), halved);
        assert_eq!(particles.history.column("porosity").unwrap()[..3], [0.0, 2.0, 4.0]);
        assert_eq!((particles.len(), particles.history.slots.len()), (halved.len(), 1));
        particles.history = History::default();
        assert_eq!(particles.width(), width - 16);
    }

    #[test]
    fn a_variable_that_comes_later_leaves_the_others_as_they_are() {
        let mut history = damaged().history;
        let (damage, porosity) = (history.column("damage").unwrap(), vec![0.25; BLOCK + 3]);
        history.add(&POROSITY, &porosity);
        assert_eq!((history.column("damage").unwrap(), history.column("porosity").unwrap()), (damage, porosity));
    }

    #[test]
    fn what_its_law_does_not_allow_is_named() {
        let mut particles = damaged();
        assert!((0..particles.len()).all(|i| particles.first_fault(i).is_none()));
        for wrong in [f64::NAN, -0.1, 1.1] {
            let mut damage = vec![0.0; BLOCK + 3];
            damage[BLOCK + 1] = wrong;
            particles.set_column("damage", &Column::Scalar(damage.into()));
            assert_eq!(particles.first_fault(BLOCK + 1), Some("damage"));
            assert_eq!(particles.first_fault(BLOCK), None);
        }
    }
}
