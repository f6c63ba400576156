//! The points that all ranks search: the particles of all ranks in the common order, followed by all images of them.
//!
//! They are the same on every rank. Those that the rows of a rank contain become its ghost particles.

use super::domain::Share;
use crate::RunFailure;
use crate::halo::{Halo, Image, Images, Remote};
use crate::persist::{Archive, ArchiveError};
use sphorge_physics::Vector;
use std::ops::Range;

/// A point that is in no row of this rank.
const UNREAD: u32 = u32::MAX;

/// The images of the particles of all ranks, and which points are ghost particles of this rank.
#[derive(Clone, Debug, Default)]
pub(super) struct CommonPoints {
    images: Images,
    /// Indices of the points on this rank, particles first, then ghosts.
    numbers: Vec<u32>,
    /// The ghosts among all points, in their order on this rank.
    ghosts: Vec<u32>,
}

impl CommonPoints {
    /// No point is in a row yet. The images are those given, or those that the planes and periodic axes produce.
    pub(super) fn new(images: Images) -> Self {
        Self { images, ..Self::default() }
    }

    /// The same points, followed by the images within `reach` (m) of particles of all ranks at these positions that are
    /// not among them. No point is in a row yet.
    pub(super) fn supplemented(&self, positions: &[Vector<f64>], reach: f64) -> Self {
        let mut images = self.images.clone();
        images.supplement(positions, reach);
        Self::new(images)
    }

    /// Creates the images of the particles of all ranks within `reach` (m) of where they are needed. Returns whether
    /// they differ from the previous ones.
    pub(super) fn reflect(&mut self, positions: &[Vector<f64>], reach: f64) -> bool {
        self.images.rebuild(positions, reach)
    }

    /// Appends values of the images to those of all particles.
    pub(super) fn extend<V: Copy>(&self, values: &mut Vec<V>, of: impl Fn(&Image, V) -> V) {
        values.reserve(self.images.count());
        for image in self.images.images() {
            values.push(of(image, values[image.source as usize]));
        }
    }

    /// Creates ghosts for the points in the rows of this rank.
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
                // Its index is assigned once all are known.
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

    /// Index on this rank of a point that is in a row.
    pub(super) fn number(&self, point: u32) -> u32 {
        self.numbers[point as usize]
    }

    /// Whether a point is a particle or a ghost of this rank.
    pub(super) fn is_here(&self, point: u32) -> bool {
        self.numbers[point as usize] != UNREAD
    }

    /// The common points of the particles and ghosts of this rank, by their index on it.
    pub(super) fn point(&self, own: Range<usize>, number: u32) -> u32 {
        match (number as usize).checked_sub(own.len()) {
            None => own.start as u32 + number,
            Some(ghost) => self.ghosts[ghost],
        }
    }

    pub(super) fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.images.persist(name, archive)
    }

    /// The particles that the images are of, by their index in the common order.
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
