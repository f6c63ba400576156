//! Particles in the partition that sums are taken of.

use super::columns::{Columns, Group};
use super::initial_columns::motions;
use super::kernels::ledger::{self, LedgerSums};
use super::kernels::reductions;
use super::kernels::sums::{MOST_SUMS, Partition, chunk_of};
use crate::device::{Card, CardFault};
use rayon::prelude::*;
use sphorge_engine::{Model, Particles};

/// Particles of one chunk, body and prescribed motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    /// Number of the chunk.
    pub(super) chunk: u32,
    pub(super) body: u32,
    /// Number of the motion and one, zero for none.
    pub(super) motion: u32,
    pub(super) particles: u32,
    /// kg.
    pub(super) mass: f64,
}

/// The segments of all particles.
///
/// A sum depends on the particles of its segment alone, and segments are added in order: sums stay the same to the bit when particles are shared out in
/// whole chunks.
#[derive(Clone, Debug)]
pub(super) struct Segments {
    /// By chunk, then body, then motion.
    pub(super) list: Vec<Segment>,
    /// Number of the segment of each particle; behind the last particle, up to a whole chunk, the number of segments, which is that of none.
    pub(super) of_particles: Vec<u32>,
    /// Rows of the particles by their `id`, and these, ascending.
    by_id: Vec<u32>,
    ids: Vec<u32>,
    /// Particles of a chunk.
    chunk: usize,
}

impl Segments {
    /// Of the particles of a process, where there are so many in all.
    pub(super) fn of(model: &Model, p: &Particles, total: usize) -> Self {
        let chunk_length = chunk_of(total);
        let motions = motions(model, p);
        let of_chunk = |chunk: usize| {
            let rows = chunk * chunk_length..((chunk + 1) * chunk_length).min(p.len());
            let mut kinds: Vec<(u32, u32)> = Vec::new();
            let mut last = None;
            for i in rows.clone() {
                let kind = (p.body[i], motions[i]);
                // Those beside each other mostly are of one kind.
                if last != Some(kind) && !kinds.contains(&kind) {
                    kinds.push(kind);
                }
                last = Some(kind);
            }
            kinds.sort_unstable();
            let segment = |(body, motion): &(u32, u32)| Segment {
                chunk: chunk as u32,
                body: *body,
                motion: *motion,
                particles: 0,
                mass: 0.0,
            };
            let mut list: Vec<Segment> = kinds.iter().map(segment).collect();
            let number = |i: usize| {
                let number = kinds.partition_point(|kind| *kind < (p.body[i], motions[i]));
                list[number].particles += 1;
                list[number].mass += p.mass[i];
                number as u32
            };
            let numbers: Vec<u32> = rows.map(number).collect();
            (list, numbers)
        };
        let of_chunks: Vec<_> = (0..p.len().div_ceil(chunk_length)).into_par_iter().map(of_chunk).collect();
        let (mut list, mut of_particles) = (Vec::new(), Vec::with_capacity(p.len().next_multiple_of(chunk_length)));
        for (segments, numbers) in of_chunks {
            let first = list.len() as u32;
            of_particles.extend(numbers.into_iter().map(|number| first + number));
            list.extend(segments);
        }
        of_particles.resize(of_particles.len().next_multiple_of(chunk_length), list.len() as u32);
        let mut by_id: Vec<u32> = (0..p.len() as u32).collect();
        by_id.par_sort_unstable_by_key(|row| p.id[*row as usize]);
        let ids = by_id.par_iter().with_min_len(1 << 12).map(|row| p.id[*row as usize]).collect();
        Self { list, of_particles, by_id, ids, chunk: chunk_length }
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Numbers that so many sums leave: of each segment one and its low part.
    pub(super) fn numbers_of(&self, sums: usize) -> usize {
        2 * sums * self.len()
    }

    pub(super) fn partition(&self) -> Partition {
        Partition { segments: self.list.len(), chunk: self.chunk }
    }

    /// The row of a particle, if it is here.
    pub(super) fn row_of(&self, id: u32) -> Option<usize> {
        self.ids.binary_search(&id).ok().map(|place| self.by_id[place] as usize)
    }

    /// The `id` of the particle that has so many before it by their `id`.
    pub(super) fn id_at(&self, place: f64) -> u32 {
        self.ids.get(place as usize).copied().unwrap_or_default()
    }

    /// How many particles each has before it by their `id`: numbers that GPUs hold exactly.
    fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.by_id.len()];
        for (place, row) in (0..).zip(&self.by_id) {
            places[*row as usize] = place;
        }
        places
    }

    /// What kernels know of each: chunk and body.
    pub(super) fn for_kernels(&self) -> Vec<u32> {
        self.list.iter().flat_map(|segment| [segment.chunk, segment.body]).collect()
    }
}

/// Numbers of the sums of so many particles of a few bodies, each once and once for each lane, with low parts.
pub(super) fn numbers(model: &Model, particles: usize) -> usize {
    let chunk = chunk_of(particles);
    let partition = Partition { segments: particles.div_ceil(chunk) + model.bodies.len(), chunk };
    2 * (partition.lanes() + 1) * partition.segments * most_sums(model)
}

/// Most sums that are taken at once.
fn most_sums(model: &Model) -> usize {
    LedgerSums::of(model).count.max(MOST_SUMS)
}

/// Brings to the GPU what sums are taken by.
pub(super) fn insert(
    card: &Card,
    columns: &mut Columns,
    model: &Model,
    (p, segments): (&Particles, &Segments),
) -> Result<(), CardFault> {
    let given = ledger::numbers_given(model).max(reductions::numbers_given(model.bodies.len()));
    let sums = 2 * segments.len() * most_sums(model);
    columns.insert(Group::Segments, card.indices(&segments.for_kernels())?);
    columns.insert(Group::SegmentOf, card.indices(&segments.of_particles)?);
    columns.insert(Group::SumNumbers, card.zeros(given)?);
    columns.insert(Group::PlacesById, card.indices(&segments.places())?);
    columns.insert(Group::Regions, card.indices(&p.regions)?);
    columns.insert(Group::LaneSums, card.zeros(segments.partition().lanes() * sums)?);
    let [of_suspects, _] = reductions::numbers_of_suspects(segments.len(), model.bodies.len());
    columns.insert(Group::Sums, card.zeros(sums.max(of_suspects))?);
    Ok(())
}
