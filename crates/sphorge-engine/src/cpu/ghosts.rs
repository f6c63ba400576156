//! The ghost particles of this engine and the columns they own.

use crate::halo::{self, Columns, Exchanged, FieldSet, Halo};
use crate::particles::Particles;
use smallvec::smallvec;

/// A column of particles, followed by that of the ghosts.
#[derive(Clone, Copy)]
pub(crate) struct WithGhosts<'a, V> {
    own: &'a [V],
    ghosts: &'a [V],
}

impl<'a, V: Copy> WithGhosts<'a, V> {
    pub(crate) fn new(own: &'a [V], ghosts: &'a [V]) -> Self {
        Self { own, ghosts }
    }

    /// Value of point `j`: a particle, or a ghost if the index is beyond the particles.
    #[inline(always)]
    pub(crate) fn at(&self, j: usize) -> V {
        match j.checked_sub(self.own.len()) {
            None => self.own[j],
            Some(ghost) => self.ghosts[ghost],
        }
    }
}

/// Ghost particles of a model and their columns.
pub(crate) struct Ghosts {
    pub(crate) halo: Box<dyn Halo>,
    pub(crate) columns: Particles,
}

impl Ghosts {
    pub(crate) fn new(halo: Box<dyn Halo>) -> Self {
        Self { halo, columns: Particles::default() }
    }

    /// The columns of sets that ghosts receive.
    pub(crate) fn exchanged<'a>(&'a mut self, sets: &[FieldSet], particles: &'a Particles) -> Exchanged<'a> {
        let halo = self.halo.as_ref();
        let columns =
            if halo.is_empty() { Columns::new() } else { particles.exchanged(sets, &mut self.columns, halo.count()) };
        Exchanged { halo, columns }
    }

    /// Updates the columns of sets from the particles.
    pub(crate) fn exchange(&mut self, sets: &[FieldSet], particles: &Particles) {
        halo::fill(smallvec![self.exchanged(sets, particles)]);
    }

    pub(crate) fn count(&self) -> usize {
        self.halo.count()
    }
}
