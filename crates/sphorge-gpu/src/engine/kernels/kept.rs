//! Lists that are kept from one search to the next.

use super::grid::Grid;
use super::images::Mirrors;
use super::limits::CHUNK;
use super::neighbors::over_own_body;
use crate::engine::columns::{Fields, Group, Recording, recording};
use crate::engine::step_numbers::ROOM;
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::tensor::dot;
use sphorge_physics::{Elementary, Real};

/// Place of the length of a list among the numbers of [`Group::Rows`].
pub(in crate::engine) const LENGTH: usize = 0;
/// Numbers of a particle there.
pub(in crate::engine) const ROWS: usize = 1;

/// Numbers of a chunk in [`Group::Ways`]: square of the longest way, m², the box of all ways, m, and the longest list.
pub(in crate::engine) const LONGEST: usize = 0;
pub(in crate::engine) const LOW: usize = 1;
pub(in crate::engine) const HIGH: usize = 4;
pub(in crate::engine) const LONGEST_ROW: usize = 7;
pub(in crate::engine) const WAYS: usize = 8;

/// Farther than anything moves, m.
const BEYOND: f64 = 1e30;

/// The list of every particle, as far as there is room, and where it was searched.
pub(in crate::engine) fn search<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("search", count, |bind, i| {
        let near = (bind.read(Group::Place), bind.read(Group::Constants));
        let (rows, kept, step) = (bind.write(Group::Rows), bind.index_output(Group::Kept), bind.read(Group::Step));
        let searched_at = bind.write(Group::SearchedAt);
        let (stride, room, zero) = (bind.stride(), step.get(0, Index::of(ROOM)), Recorded::zero());
        let length = over_own_body::<_, D>(bind, model, grid, i, near, zero, |before: Recorded, pair, j| {
            let keep = || {
                kept.set(Index::floor(before) * stride + i, Mirrors::entry_of(pair.bits, j));
                [zero; 0]
            };
            Recorded::if_lt(before, room, keep, || [zero; 0]);
            before + Recorded::one()
        });
        rows.set(LENGTH, i, length);
        for k in 0..6 {
            searched_at.set(k, i, near.0.get(k, i));
        }
    })
}

/// The longest list of each chunk of particles.
pub(in crate::engine) fn longest_rows(count: usize) -> Result<Recording, KernelFault> {
    let chunks = count.div_ceil(CHUNK);
    recording("longest_rows", count, |bind, chunk| {
        let (rows, ways) = (bind.read(Group::Rows), bind.write(Group::Ways));
        let first = chunk * Index::of(CHUNK as u32);
        let end = first + Index::of(CHUNK as u32);
        let longest =
            bind.scope.fold(first, end, Recorded::zero(), |_, longest: Recorded, i| longest.max(rows.get(LENGTH, i)));
        ways.set(0, Index::of((LONGEST_ROW * chunks) as u32) + chunk, longest);
    })
}

/// How far the particles of each chunk are from where they were at the last full search; there are `particles` of them.
pub(in crate::engine) fn ways(particles: usize, count: usize) -> Result<Recording, KernelFault> {
    let chunks = count.div_ceil(CHUNK);
    recording("ways", count, |bind, chunk| {
        let (place, searched_at) = (bind.read(Group::Place), bind.read(Group::SearchedAt));
        let ways = bind.write(Group::Ways);
        let first = chunk * Index::of(CHUNK as u32);
        let (zero, far) = (Recorded::zero(), Recorded::of(BEYOND));
        let start = [zero, far, far, far, -far, -far, -far];
        let all = bind.scope.fold(first, first + Index::of(CHUNK as u32), start, |_, mut all, i| {
            let way = [0, 1, 2].map(|a| {
                let (now, then) = (place.double(a, 3 + a, i), searched_at.double(a, 3 + a, i));
                (now[0] - then[0]) + (now[1] - then[1])
            });
            // Columns are padded to whole chunks.
            let there =
                |a: Recorded, b: Recorded| Recorded::select_lt(i.number(), Recorded::of(particles as f64), a, b);
            all[LONGEST] = all[LONGEST].max(there(dot(way, way), zero));
            for a in 0..3 {
                all[LOW + a] = all[LOW + a].min(there(way[a], far));
                all[HIGH + a] = all[HIGH + a].max(there(way[a], -far));
            }
            all
        });
        for (k, number) in all.into_iter().enumerate() {
            ways.set(0, Index::of((k * chunks) as u32) + chunk, number);
        }
    })
}
