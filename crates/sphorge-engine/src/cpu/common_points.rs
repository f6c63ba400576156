//! The points that all ranks search: the particles of all ranks in their common order, and behind them all images of them.
//!
//! Every rank makes the same ones. Those that its rows name become its ghosts.

use super::domain::Share;
use crate::RunFailure;
use crate::halo::{Halo, Image, Images, Remote};
use crate::persist::{Archive, ArchiveError};
use sphorge_physics::Vector;
use std::ops::Range;

/// A point that no row of this rank names.
const UNREAD: u32 = u32::MAX;

/// The images of the particles of all ranks, and who of all points is a ghost of this rank.
#[derive(Clone, Debug, Default)]
pub(super) struct CommonPoints {
    images: Images,
    /// Numbers of the points on this rank, particles first, then ghosts.
    numbers: Vec<u32>,
    /// The ghosts among all points, in their order on this rank.
    ghosts: Vec<u32>,
}

impl CommonPoints {
    /// No rank names any of the points yet; images are these, or come of these planes and periodic axes.
    pub(super) fn new(images: Images) -> Self {
        Self { images, ..Self::default() }
    }

    /// The same points, and behind them the images within `reach` (m) of particles of all ranks at these positions that are not among them. No rank names
    /// any yet.
    pub(super) fn supplemented(&self, positions: &[Vector<f64>], reach: f64) -> Self {
        let mut images = self.images.clone();
        images.supplement(positions, reach);
        Self::new(images)
    }

    /// Makes the images of the particles of all ranks within `reach` (m) of where they are needed. Says whether they are others than before.
    pub(super) fn reflect(&mut self, positions: &[Vector<f64>], reach: f64) -> bool {
        self.images.rebuild(positions, reach)
    }

    /// Puts values of the images behind those of all particles.
    pub(super) fn extend<V: Copy>(&self, values: &mut Vec<V>, of: impl Fn(&Image, V) -> V) {
        values.reserve(self.images.count());
        for image in self.images.images() {
            values.push(of(image, values[image.source as usize]));
        }
    }

    /// Makes ghosts of the points that rows of this rank name.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn adopt(&mut self, share: &Share, named: impl Iterator<Item = u32>) -> Result<Remote, RunFailure> {
        let (own, count) = (share.own(), share.count());
        let numbers = &mut self.numbers;
        numbers.clear();
        numbers.resize(count + self.images.count(), UNREAD);
        for place in own.clone() {
            numbers[place] = (place - own.start) as u32;
        }
        let (mut places, mut images) = (Vec::new(), Vec::new());
        let mut read = |point: u32, points: &mut Vec<u32>| {
            if numbers[point as usize] == UNREAD {
                // Its number follows once all are known.
                numbers[point as usize] = 0;
                points.push(point);
            }
        };
        for point in named {
            read(point, if (point as usize) < count { &mut places } else { &mut images });
        }
        for &image in &images {
            read(self.images.images()[image as usize - count].source, &mut places);
        }
        places.sort_unstable();
        images.sort_unstable();
        self.ghosts.clear();
        self.ghosts.extend(places.iter().chain(&images));
        for (k, &point) in self.ghosts.iter().enumerate() {
            numbers[point as usize] = (own.len() + k) as u32;
        }
        let of_this_rank = |&image: &u32| {
            let mut image = self.images.images()[image as usize - count];
            image.source = numbers[image.source as usize];
            image
        };
        let images = images.iter().map(of_this_rank).collect();
        Remote::new(share.ranks.clone(), share.starts.clone(), self.images.planes()).with(places, images)
    }

    /// Number on this rank of a point that rows name.
    pub(super) fn number(&self, point: u32) -> u32 {
        self.numbers[point as usize]
    }

    /// Whether a point is one of this rank, its own or a ghost.
    pub(super) fn is_here(&self, point: u32) -> bool {
        self.numbers[point as usize] != UNREAD
    }

    /// The points that points of this rank, its own and its ghosts, are, by their numbers on it.
    pub(super) fn point(&self, own: Range<usize>, number: u32) -> u32 {
        match (number as usize).checked_sub(own.len()) {
            None => own.start as u32 + number,
            Some(ghost) => self.ghosts[ghost],
        }
    }

    pub(super) fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.images.persist(name, archive)
    }

    /// The particles, by their places in the common order, that images are of.
    pub(super) fn sources(&self) -> &[u32] {
        self.images.sources()
    }

    /// Number of images of the particles of all ranks.
    pub(super) fn images(&self) -> usize {
        self.images.count()
    }

    /// Images of the particles of all ranks.
    pub(super) fn all_images(&self) -> &Images {
        &self.images
    }

    pub(super) fn bytes(&self) -> usize {
        self.images.bytes() + 4 * (self.numbers.capacity() + self.ghosts.capacity())
    }
}
