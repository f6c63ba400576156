//! Data of particles that the search for contact candidates reads: those of all ranks in the common order, if there are
//! several.

use super::super::domain::Domain;
use super::contact_candidates::SearchedMaterial;
use crate::RunFailure;
use crate::particles::Particles;
use crate::persist::Fixed;
use sphorge_physics::Vector;
use std::borrow::Cow;
use std::ops::Range;

/// Columns of the particles of all ranks.
pub(super) struct Surroundings<'a> {
    /// m
    pub(super) position: Cow<'a, [Vector<f64>]>,
    /// Positions at the last full search, m.
    pub(super) searched_at: Cow<'a, [Vector<f64>]>,
    /// Positions at the start, m.
    pub(super) origin: Cow<'a, [Vector<f64>]>,
    /// m
    pub(super) smoothing_length: Cow<'a, [f64]>,
    pub(super) body: Cow<'a, [u32]>,
    /// The share of this rank, if there are several.
    pub(super) domain: Option<&'a Domain>,
}

impl<'a> Surroundings<'a> {
    /// # Errors
    /// A rank is lost.
    pub(super) fn new(particles: &'a Particles, domain: Option<&'a Domain>) -> Result<Self, RunFailure> {
        Ok(Self {
            position: of_all(&particles.position, domain)?,
            searched_at: of_all(&particles.searched_at, domain)?,
            origin: of_all(&particles.origin, domain)?,
            smoothing_length: of_all(&particles.smoothing_length, domain)?,
            body: of_all(&particles.body, domain)?,
            domain,
        })
    }

    /// For a process without ranks.
    pub(super) fn of_one(material: &SearchedMaterial<'a>) -> Self {
        Self {
            position: Cow::Borrowed(material.position),
            searched_at: Cow::Borrowed(material.searched_at),
            origin: Cow::Borrowed(material.origin),
            smoothing_length: Cow::Borrowed(material.smoothing_length),
            body: Cow::Borrowed(material.body),
            domain: None,
        }
    }

    /// Particles of this rank: their rows are here.
    pub(super) fn own(&self) -> Range<usize> {
        self.domain.map_or(0..self.position.len(), |domain| domain.own())
    }

    /// The particle, of any rank, that has this index in rows of this rank, or an image, which come after all
    /// particles.
    pub(super) fn point(&self, number: u32) -> usize {
        self.domain.map_or(number, |domain| domain.point(number)) as usize
    }
}

fn of_all<'a, V: Fixed + Copy>(own: &'a [V], domain: Option<&Domain>) -> Result<Cow<'a, [V]>, RunFailure> {
    domain.map_or(Ok(Cow::Borrowed(own)), |domain| domain.gather(own).map(Cow::Owned))
}
