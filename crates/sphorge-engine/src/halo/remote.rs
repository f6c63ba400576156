//! Particles of other ranks that rows of this one read.

use super::{GhostColumn, Halo, Packed};
use crate::RunFailure;
use crate::persist::{Archive, ArchiveError, Fixed, Persist, persist_each, require};
use crate::ranks::{Ranks, decoded, encoded};
use sphorge_physics::Vector;

/// Ghosts in the common order of the particles, so that those of one rank are one run.
#[derive(Clone, Debug)]
pub(crate) struct Remote {
    ranks: Ranks,
    /// Places in the common order at which the particles of each rank begin, and their number.
    starts: Vec<usize>,
    /// Whom the ghosts stand for: places in the common order, ascending.
    sources: Vec<u32>,
    /// Particles of this rank that each other one reads.
    read_by: Vec<Vec<u32>>,
    /// Ghosts that each other rank fills.
    filled_by: Vec<usize>,
}

impl Remote {
    /// No ghosts yet.
    pub(crate) fn new(ranks: Ranks, starts: Vec<usize>) -> Self {
        let size = ranks.size();
        Self { ranks, starts, sources: Vec::new(), read_by: vec![Vec::new(); size], filled_by: vec![0; size] }
    }

    /// Ghosts of these particles of other ranks, by their places in the common order, ascending.
    ///
    /// # Errors
    /// A rank is lost.
    pub(crate) fn of(&self, sources: Vec<u32>) -> Result<Self, RunFailure> {
        let (rank, size) = (self.ranks.rank(), self.ranks.size());
        let wanted: Vec<Vec<u8>> = (0..size).map(|r| encoded(&sources[self.of_rank(&sources, r)])).collect();
        let filled_by: Vec<usize> = (0..size).map(|r| self.of_rank(&sources, r).len()).collect();
        // Of every rank, how many it wants of each.
        let table = self.ranks.gather(&filled_by, &vec![size; size])?;
        let lengths: Vec<usize> = (0..size).map(|r| table[r * size + rank] * u32::SIZE).collect();
        let asked = self.ranks.exchange(&wanted, &lengths)?;
        let own = self.starts[rank];
        let mut read_by = Vec::with_capacity(size);
        for bytes in asked {
            read_by.push(decoded::<u32>(&bytes)?.into_iter().map(|place| place - own as u32).collect());
        }
        Ok(Self { ranks: self.ranks.clone(), starts: self.starts.clone(), sources, read_by, filled_by })
    }

    /// The ghosts that rank `r` fills.
    fn of_rank(&self, sources: &[u32], r: usize) -> std::ops::Range<usize> {
        let place = |start: usize| sources.partition_point(|&source| (source as usize) < start);
        place(self.starts[r])..place(self.starts[r + 1])
    }

    /// Fills values of the ghosts, `width` to each, from those that `write` writes of particles.
    fn carry<V: Fixed>(&self, width: usize, write: impl Fn(usize, &mut Vec<u8>), ghosts: &mut [V]) {
        let bytes = |particles: &Vec<u32>| {
            let mut bytes = Vec::with_capacity(particles.len() * width * V::SIZE);
            particles.iter().for_each(|&i| write(i as usize, &mut bytes));
            bytes
        };
        let to: Vec<Vec<u8>> = self.read_by.iter().map(bytes).collect();
        let lengths: Vec<usize> = self.filled_by.iter().map(|count| count * width * V::SIZE).collect();
        let result = self.ranks.exchange(&to, &lengths).and_then(|from| {
            let mut ghosts = &mut ghosts[..];
            for bytes in &from {
                let values = decoded::<V>(bytes)?;
                let (filled, rest) = std::mem::take(&mut ghosts).split_at_mut(values.len());
                filled.iter_mut().zip(values).for_each(|(ghost, value)| *ghost = value);
                ghosts = rest;
            }
            Ok(())
        });
        // The engine tells of it at the end of the stage; until then ghosts are as they were.
        result.unwrap_or_else(|failure| self.ranks.note_loss(failure));
    }

    fn values<V: Fixed>(&self, own: &[V], ghosts: &mut [V]) {
        self.carry(1, |i, bytes| own[i].write(bytes), ghosts);
    }

    fn records<V: Fixed>(&self, records: Packed<'_, V>) {
        let Packed { own, ghosts, axes } = records;
        let width = axes.len();
        self.carry(width, |i, bytes| own[i * width..][..width].iter().for_each(|v| v.write(bytes)), ghosts);
    }
}

impl Halo for Remote {
    fn another(&self) -> Box<dyn Halo> {
        Box::new(Self::new(self.ranks.clone(), self.starts.clone()))
    }

    fn is_empty(&self) -> bool {
        self.ranks.size() == 1
    }

    fn count(&self) -> usize {
        self.sources.len()
    }

    fn longest_shift(&self) -> f64 {
        0.0
    }

    fn wrap(&self, _: &mut [Vector<f64>]) -> bool {
        false
    }

    /// Who the ghosts are follows from the rows, which are searched among the particles of all ranks.
    fn rebuild(&mut self, _: &[Vector<f64>], _: f64) -> bool {
        false
    }

    fn fill(&self, column: GhostColumn<'_>) {
        match column {
            GhostColumn::Scalar(own, ghosts) => self.values(own, ghosts),
            GhostColumn::Integer(own, ghosts) => self.values(own, ghosts),
            GhostColumn::Point(own, ghosts) | GhostColumn::Vector(own, ghosts) => self.values(own, ghosts),
            GhostColumn::PointOf(place, ghosts) => self.carry(1, |i, bytes| place(i).write(bytes), ghosts),
            GhostColumn::Symmetric(own, ghosts) => self.values(own, ghosts),
            GhostColumn::Tensor(own, ghosts) => self.values(own, ghosts),
            GhostColumn::Single(records) => self.records(records),
            GhostColumn::Double(records) => self.records(records),
        }
    }

    /// Ghosts have no rows here.
    fn rows(&self) -> &[u32] {
        &[]
    }

    fn bytes(&self) -> usize {
        4 * (self.sources.capacity() + self.read_by.iter().map(Vec::capacity).sum::<usize>())
    }

    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let sources = format!("{name}.sources");
        self.sources.persist(&sources, archive)?;
        if !archive.is_saving() {
            let is_ascending = self.sources.is_sorted_by(|a, b| a < b);
            let last = self.sources.last().map_or(0, |&source| source as usize + 1);
            require(is_ascending && last <= self.starts[self.ranks.size()], &sources)?;
            self.filled_by = (0..self.ranks.size()).map(|r| self.of_rank(&self.sources, r).len()).collect();
        }
        persist_each(&mut self.read_by, &format!("{name}.read_by"), archive)?;
        let count = self.starts[self.ranks.rank() + 1] - self.starts[self.ranks.rank()];
        let is_there = self.read_by.iter().flatten().all(|&i| (i as usize) < count);
        require(is_there, &format!("{name}.read_by"))
    }
}
