//! Data of particles that the search for contact candidates reads: those of all ranks in the common order, if there are
//! several, and behind them those of their images.

use super::super::domain::Domain;
use super::contact_candidates::SearchedMaterial;
use crate::RunFailure;
use crate::halo::{Halo, Image, Images};
use crate::particles::Particles;
use crate::persist::Fixed;
use sphorge_physics::Vector;
use std::borrow::Cow;
use std::ops::Range;

/// Columns of the particles of all ranks, and of the images behind them.
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
    images: Images,
}

impl<'a> Surroundings<'a> {
    /// Of images the planes and periodic cells count.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn new(
        images: Images,
        particles: &'a Particles,
        domain: Option<&'a Domain>,
    ) -> Result<Self, RunFailure> {
        Ok(Self {
            position: of_all(&particles.position, domain)?,
            searched_at: of_all(&particles.searched_at, domain)?,
            origin: of_all(&particles.origin, domain)?,
            smoothing_length: of_all(&particles.smoothing_length, domain)?,
            body: of_all(&particles.body, domain)?,
            domain,
            images,
        })
    }

    /// For a process without ranks.
    pub(super) fn of_one(images: Images, material: &SearchedMaterial<'a>) -> Self {
        Self {
            position: Cow::Borrowed(material.position),
            searched_at: Cow::Borrowed(material.searched_at),
            origin: Cow::Borrowed(material.origin),
            smoothing_length: Cow::Borrowed(material.smoothing_length),
            body: Cow::Borrowed(material.body),
            domain: None,
            images,
        }
    }

    /// Adds the images in symmetry planes and beyond periodic ends that are needed to see everything within `reach` (m) of a particle.
    pub(super) fn reflect(mut self, reach: f64) -> Self {
        if self.images.is_empty() {
            return self;
        }
        self.images = self.images.planes();
        self.images.supplement(&self.position, reach);
        let images = self.images.images();
        let place = |image: &Image, x: Vector<f64>| image.position(&x);
        extend(&mut self.position, images, place);
        extend(&mut self.searched_at, images, place);
        extend(&mut self.origin, images, place);
        extend(&mut self.smoothing_length, images, |_, h| h);
        extend(&mut self.body, images, |_, body| body);
        self
    }

    /// Number of particles of all ranks.
    pub(super) fn count(&self) -> usize {
        self.position.len() - self.images.count()
    }

    /// Images of particles of all ranks; their columns are behind those of the particles.
    pub(super) fn images(&self) -> &[Image] {
        self.images.images()
    }

    /// From one point to another at the start, m; along a periodic axis the shortest way.
    pub(super) fn at_start(&self, i: usize, j: usize) -> Vector<f64> {
        self.images.shortest([0, 1, 2].map(|a| self.origin[i][a] - self.origin[j][a]))
    }

    /// Particles of this rank: their rows are here.
    pub(super) fn own(&self) -> Range<usize> {
        self.domain.map_or(0..self.count(), |domain| domain.own())
    }

    /// The particle, of any rank, that has this index in rows of this rank, or an image, which come after all
    /// particles. Images in rows are numbered otherwise than [`Self::images`].
    pub(super) fn point(&self, number: u32) -> usize {
        self.domain.map_or(number, |domain| domain.point(number)) as usize
    }
}

fn of_all<'a, V: Fixed + Copy>(own: &'a [V], domain: Option<&Domain>) -> Result<Cow<'a, [V]>, RunFailure> {
    domain.map_or(Ok(Cow::Borrowed(own)), |domain| domain.gather(own).map(Cow::Owned))
}

/// Puts values of images behind those of the particles.
fn extend<V: Copy>(values: &mut Cow<'_, [V]>, images: &[Image], of: impl Fn(&Image, V) -> V) {
    let values = values.to_mut();
    values.reserve_exact(images.len());
    for image in images {
        values.push(of(image, values[image.source as usize]));
    }
}
