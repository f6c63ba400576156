//! The ghosts of this engine: who they are, and the columns they own.

use crate::halo::{FieldSet, Halo};
use crate::particles::Particles;

/// A column of particles with that of the ghosts behind it.
#[derive(Clone, Copy)]
pub(crate) struct WithGhosts<'a, V> {
    own: &'a [V],
    ghosts: &'a [V],
}

impl<'a, V: Copy> WithGhosts<'a, V> {
    pub(crate) fn new(own: &'a [V], ghosts: &'a [V]) -> Self {
        Self { own, ghosts }
    }

    /// Value of point `j`: a particle, or from their number on a ghost.
    #[inline(always)]
    pub(crate) fn at(&self, j: usize) -> V {
        match j.checked_sub(self.own.len()) {
            None => self.own[j],
            Some(ghost) => self.ghosts[ghost],
        }
    }
}

/// Ghosts of a model: who they are, and their columns.
pub(crate) struct Ghosts {
    pub(crate) halo: Box<dyn Halo>,
    pub(crate) columns: Particles,
}

impl Ghosts {
    pub(crate) fn new(halo: Box<dyn Halo>) -> Self {
        Self { halo, columns: Particles::default() }
    }

    /// Brings the columns of a set to those of the particles.
    pub(crate) fn exchange(&mut self, fields: FieldSet, particles: &Particles) {
        if !self.halo.is_empty() {
            particles.exchange(fields, &mut self.columns, self.halo.as_ref());
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.halo.count()
    }
}
