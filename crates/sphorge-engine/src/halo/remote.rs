//! Ghost particles on ranks: particles of other ranks that rows of this one read, and images of them and of its own.

use super::images::reflect;
use super::{GhostColumn, Halo, Image, Images, Incoming, Outgoing, bytes};
use crate::RunFailure;
use crate::persist::{Archive, ArchiveError, Fixed};
use crate::ranks::Ranks;
use sphorge_physics::Vector;

/// Ghosts: particles of other ranks in the common order, so that those of one rank are contiguous, followed by images.
/// A particle is sent once, whether itself or images of it are read; the rank that reads an image creates it.
#[derive(Clone, Debug)]
pub(crate) struct Remote {
    ranks: Ranks,
    /// Indices in the common order of the first particle of each rank, and the number of particles.
    starts: Vec<usize>,
    /// The particles of the ghosts that are not images: indices in the common order, ascending.
    places: Vec<u32>,
    /// Particles of this rank that each other one reads.
    read_by: Vec<Vec<u32>>,
    /// Ghosts that each other rank fills.
    filled_by: Vec<usize>,
    /// Images of particles of this rank and of the preceding ghosts.
    images: Vec<Image>,
    sources: Vec<u32>,
    /// The source of the images.
    planes: Images,
}

impl Remote {
    /// No ghosts yet, with images in these planes and periodic axes.
    pub(crate) fn new(ranks: Ranks, starts: Vec<usize>, planes: Images) -> Self {
        let size = ranks.size();
        Self {
            ranks,
            starts,
            places: Vec::new(),
            read_by: vec![Vec::new(); size],
            filled_by: vec![0; size],
            images: Vec::new(),
            sources: Vec::new(),
            planes,
        }
    }

    /// Ghosts of these particles of other ranks, by their index in the common order, ascending, and these images, whose
    /// sources are indices of particles of this rank followed by ghosts.
    ///
    /// # Errors
    /// A rank is lost.
    pub(crate) fn with(mut self, places: Vec<u32>, images: Vec<Image>) -> Result<Self, RunFailure> {
        let (rank, size) = (self.ranks.rank(), self.ranks.size());
        let wanted: Vec<Vec<u32>> = (0..size).map(|r| places[self.of_rank(&places, r)].to_vec()).collect();
        self.filled_by = wanted.iter().map(Vec::len).collect();
        let asked = self.ranks.exchange_values(&wanted)?;
        let own = self.starts[rank];
        self.read_by.clear();
        for places in asked {
            self.read_by.push(places.into_iter().map(|place| place - own as u32).collect());
        }
        (self.places, self.images) = (places, images);
        let first = self.own_count() as u32;
        self.sources = (first..first + self.places.len() as u32).collect();
        self.sources.extend(self.images.iter().map(|image| image.source));
        Ok(self)
    }

    /// Particles of this rank that others read, each as often as there are such ranks.
    pub(crate) fn read(&self) -> impl Iterator<Item = u32> {
        self.read_by.iter().flatten().copied()
    }

    /// Values of the ghosts that are not images, from what `of` is of the particles of their ranks.
    ///
    /// # Errors
    /// A rank is lost.
    pub(crate) fn values<V: Fixed>(&self, of: impl Fn(u32) -> V) -> Result<Vec<V>, RunFailure> {
        let to: Vec<Vec<V>> = self.read_by.iter().map(|read| read.iter().map(|&i| of(i)).collect()).collect();
        Ok(self.ranks.exchange_values(&to)?.into_iter().flatten().collect())
    }

    /// Particles of this rank.
    fn own_count(&self) -> usize {
        let rank = self.ranks.rank();
        self.starts[rank + 1] - self.starts[rank]
    }

    /// The ghosts that rank `r` fills.
    fn of_rank(&self, places: &[u32], r: usize) -> std::ops::Range<usize> {
        let place = |start: usize| places.partition_point(|&source| (source as usize) < start);
        place(self.starts[r])..place(self.starts[r + 1])
    }
}

impl Halo for Remote {
    fn another(&self) -> Box<dyn Halo> {
        Box::new(Self::new(self.ranks.clone(), self.starts.clone(), self.planes.planes()))
    }

    fn is_empty(&self) -> bool {
        self.ranks.size() == 1 && self.planes.is_empty()
    }

    fn has_images(&self) -> bool {
        self.planes.has_images()
    }

    fn count(&self) -> usize {
        self.sources.len()
    }

    fn longest_shift(&self) -> f64 {
        self.planes.longest_shift()
    }

    fn wrap(&self, positions: &mut [Vector<f64>], started: &mut [Vector<f64>]) -> bool {
        self.planes.wrap(positions, started)
    }

    /// The ghosts follow from the rows, which are searched among the particles of all ranks.
    fn rebuild(&mut self, _: &[Vector<f64>], _: f64) -> bool {
        false
    }

    fn pack(&self, columns: &[GhostColumn<'_>], outgoing: &mut Outgoing) {
        let width: usize = columns.iter().map(bytes::width).sum();
        let (to, lengths) = outgoing.among(&self.ranks);
        for (message, particles) in to.iter_mut().zip(&self.read_by) {
            message.reserve(particles.len() * width);
            columns.iter().for_each(|column| bytes::write(column, particles, message));
        }
        lengths.iter_mut().zip(&self.filled_by).for_each(|(length, ghosts)| *length += ghosts * width);
    }

    fn unpack(&self, mut column: GhostColumn<'_>, incoming: &mut Incoming) {
        let (width, mut first) = (bytes::width(&column), 0);
        for (rank, &ghosts) in self.filled_by.iter().enumerate() {
            if let Some(come) = incoming.take(rank, ghosts * width) {
                bytes::read(&mut column, first, come).unwrap_or_else(|failure| self.ranks.note_loss(failure));
            }
            first += ghosts;
        }
        reflect(&self.images, self.places.len(), column);
    }

    fn sources(&self) -> &[u32] {
        &self.sources
    }

    fn images(&self) -> &[Image] {
        &self.images
    }

    fn bytes(&self) -> usize {
        size_of::<Image>() * self.images.capacity()
            + 4 * (self.places.capacity() + self.sources.capacity())
            + 4 * self.read_by.iter().map(Vec::capacity).sum::<usize>()
    }

    /// The ghosts follow from the rows, which are built again from the loaded state.
    fn persist(&mut self, _: &str, _: &mut dyn Archive) -> Result<(), ArchiveError> {
        Ok(())
    }
}
