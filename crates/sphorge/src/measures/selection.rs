//! Particles of a selection, and one number for each.

use crate::{
    model::{Model, ParticleSelection},
    particles::{Column, Particles},
};

/// Particles of a selection at one time.
pub(crate) struct SelectedParticles<'a> {
    pub(super) model: &'a Model,
    pub(super) particles: &'a Particles,
    selection: &'a ParticleSelection,
}

impl<'a> SelectedParticles<'a> {
    pub(crate) fn new(model: &'a Model, particles: &'a Particles, selection: &'a ParticleSelection) -> Self {
        Self { model, particles, selection }
    }

    /// Places of the particles in the columns, ascending.
    pub(crate) fn indices(&self) -> impl Iterator<Item = usize> {
        (0..self.particles.len()).filter(|&i| self.holds(i))
    }

    fn holds(&self, i: usize) -> bool {
        let ParticleSelection { body, region, window } = self.selection;
        let p = self.particles;
        body.is_none_or(|body| p.body[i] as usize == body)
            && region.is_none_or(|region| p.regions[i] >> region & 1 == 1)
            && window.is_none_or(|(min, max)| (0..3).all(|a| (min[a]..=max[a]).contains(&p.position[i][a])))
    }

    /// Spacing of the particle's body, m.
    pub(crate) fn spacing(&self, i: usize) -> f64 {
        self.model.bodies.get(self.particles.body[i] as usize).map_or(self.model.spacing, |body| body.spacing)
    }

    /// Mass-weighted mean.
    pub(crate) fn mean(&self, quantity: &Quantity) -> Option<f64> {
        let (sum, mass) = self.indices().fold((0.0, 0.0), |(sum, mass), i| {
            let m = self.particles.mass[i];
            (sum + m * quantity.of(i), mass + m)
        });
        (mass > 0.0).then(|| sum / mass)
    }
}

/// A field reduced to one number a particle.
pub(crate) struct Quantity<'a> {
    column: Column<'a>,
    component: Option<usize>,
}

impl<'a> Quantity<'a> {
    /// `None` for an unknown field or component.
    pub(crate) fn new(particles: &'a Particles, field: &str, component: Option<usize>) -> Option<Self> {
        let column = particles.column(field)?;
        component.is_none_or(|k| k < column.kind().width()).then_some(Self { column, component })
    }

    /// The component, or without one the value or norm.
    pub(crate) fn of(&self, i: usize) -> f64 {
        match self.component {
            Some(k) => self.column.component(i, k),
            None => self.column.magnitude(i),
        }
    }
}
