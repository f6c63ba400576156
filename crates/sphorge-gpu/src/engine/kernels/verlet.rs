//! Stored lists, which are used from one search to the next.

use super::grid::Grid;
use super::images::Planes;
use super::neighbors::{Pair, over_own_body, searched};
use super::reduce::{over_particles, rows};
use crate::engine::columns::{
    Binder, Group, NOTHING, Read, ReadColumns, ReadShared, Recording, Shared, Write, WriteColumns, Writing, groups,
    recording,
};
use crate::record::{Index, IndexOutput, KernelFault, Recorded};
use sphorge_engine::model::{AdaptiveSearch, Model};
use sphorge_physics::tensor::dot;
use sphorge_physics::{Elementary, Real, Vector};

/// Numbers of a row of [`Group::Ways`]: square of the largest displacement, m², the bounding box of all
/// displacements, m, the longest list, the number of searched particles, and the thinnest skin, as a length to be
/// multiplied by the support, m.
pub(in crate::engine) const LONGEST: usize = 0;
pub(in crate::engine) const LOW: usize = 1;
pub(in crate::engine) const HIGH: usize = 4;
pub(in crate::engine) const LONGEST_ROW: usize = 7;
pub(in crate::engine) const MARKED_ROWS: usize = 8;
pub(in crate::engine) const THINNEST_SKIN: usize = 9;
pub(in crate::engine) const WAYS: usize = 10;

/// Farther than anything moves, m.
const BEYOND: f64 = 1e30;

/// Lists that are written.
#[derive(Clone, Copy)]
struct Rows {
    rows: groups::Rows<Write>,
    kept: IndexOutput,
    stored: Option<Writing>,
    stride: Index,
    capacity: Recorded,
    step: groups::Step<Shared>,
}

impl Rows {
    fn of(bind: &mut Binder<'_>, model: &Model) -> Self {
        let step = groups::Step::shared(bind);
        Self {
            rows: groups::Rows::write(bind),
            kept: bind.index_output(Group::Kept),
            stored: model.keeps_distances().then(|| bind.write(Group::Stored)),
            stride: bind.stride(),
            capacity: step.capacity.value(),
            step,
        }
    }

    /// Index of neighbour `k` of a particle.
    fn place(self, k: Index, i: Index) -> Index {
        k * self.stride + i
    }

    /// Stores a pair as neighbour `k` of a particle, if there is room; returns the next `k`.
    fn keep(self, i: Index, k: Recorded, pair: &Pair, j: Index) -> Recorded {
        let keep = || {
            let at = Index::floor(k);
            self.kept.set(self.place(at, i), Planes::entry_of(pair.bits, j));
            if let Some(stored) = self.stored {
                for (a, x) in pair.x.into_iter().enumerate() {
                    stored.set_at(stored_place(at, a, self.stride, i), x);
                }
            }
            NOTHING
        };
        Recorded::if_lt(k, self.capacity, keep, || NOTHING);
        k + Recorded::one()
    }

    fn is_marked(self, i: Index) -> Recorded {
        self.rows.is_marked.get(i)
    }

    fn set_length(self, i: Index, length: Recorded) {
        self.rows.length.set(i, length);
    }
}

/// Whether a particle is searched, and strain, plastic strain and step since its last search.
fn set_searched(rows: groups::Rows<Write>, i: Index, is_marked: Recorded, since: Vector<Recorded>) {
    let [strain, plastic_strain, last_searched] = since;
    rows.is_marked.set(i, is_marked);
    rows.strain.set(i, strain);
    rows.plastic_strain.set(i, plastic_strain);
    rows.last_searched.set(i, last_searched);
}

/// Index of the distance of neighbour `k` along an axis in [`Group::Stored`].
pub(super) fn stored_place(k: Index, axis: usize, stride: Index, i: Index) -> Index {
    (k * Index::of(3) + Index::of(axis as u32)) * stride + i
}

/// The list of every particle, as far as there is room, and the position of the search.
pub(in crate::engine) fn search<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("search", count, |bind, i| {
        let near = (groups::Place::read(bind).position, searched(model, groups::Constants::read(bind)));
        let (rows, searched_at) = (Rows::of(bind, model), groups::SearchedAt::write(bind));
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let length =
            over_own_body::<_, D>(bind, model, grid, i, near, zero, |k: Recorded, pair, j| rows.keep(i, k, pair, j));
        rows.set_length(i, length);
        for part in [0, 1] {
            for a in 0..3 {
                searched_at.position.axis(a).part(part).set(i, near.0.axis(a).part(part).get(i));
            }
        }
        if model.smoothing_follows_density() {
            searched_at.smoothing_length.set(i, near.1(i));
        }
        if model.adaptive_search().is_some() {
            let now = rows.step.number.value();
            set_searched(rows.rows, i, one, [zero, zero, now]);
        }
    })
}

/// Particles that the rule searches: those that flow, and with the guard those that strain and contact candidates.
pub(in crate::engine) fn mark(rule: AdaptiveSearch, count: usize) -> Result<Recording, KernelFault> {
    recording("mark", count, |bind, i| {
        let (rows, plastic) = (groups::Rows::write(bind), groups::Plastic::read(bind));
        let (step, patched) = (groups::Step::shared(bind), bind.index_output(Group::Patched));
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let increment = plastic.increment.get(i);
        let (mut strain, since) = (rows.strain.get(i), rows.plastic_strain.get(i) + increment);
        let flow = if rule.accumulate { since } else { increment };
        let mut marked = Recorded::select_lt(Recorded::of(rule.plastic_strain_threshold), flow, one, zero);
        if let Some(bound) = rule.guard {
            strain += groups::StrainCorrection::read(bind).strain.get(i);
            let strained = Recorded::select_lt(Recorded::of(bound), strain, one, zero);
            marked = marked.max(strained).max(groups::Candidates::read(bind).is_candidate.get(i));
        }
        let reset = |is: Recorded, not: Recorded| Recorded::select_lt(zero, marked, is, not);
        let last = reset(step.number.value(), rows.last_searched.get(i));
        let since_search = [reset(zero, strain), reset(zero, since), last];
        set_searched(rows, i, marked, since_search);
        patched.set(i, Index::of(0));
    })
}

/// Number of searched particles of each row.
pub(in crate::engine) fn count_marked(particles: usize, count: usize) -> Result<Recording, KernelFault> {
    of_rows("count_marked", count, MARKED_ROWS, |rows, marked, i| {
        // Ghosts are counted on the rank where they are particles.
        let (i_number, end, zero) = (i.number(), Recorded::of(particles as f64), Recorded::zero());
        marked + Recorded::select_lt(i_number, end, rows.is_marked.get(i), zero)
    })
}

/// The lists of the searched particles; with the guard, rows of neighbours they lose and gain are marked to be patched.
pub(in crate::engine) fn search_marked<const D: usize>(
    model: &Model,
    grid: &Grid,
    is_guarded: bool,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("search_marked", count, |bind, i| {
        let near = (groups::Place::read(bind).position, searched(model, groups::Constants::read(bind)));
        let rows = Rows::of(bind, model);
        let patched = is_guarded.then(|| bind.index_output(Group::Patched));
        let patch = |j: Index| {
            if let Some(patched) = patched {
                patched.set(j, Index::of(1));
            }
        };
        let (zero, planes) = (Recorded::zero(), Planes::of(model));
        let is_marked = rows.is_marked(i);
        let again = || {
            if is_guarded {
                let end = Index::floor(rows.rows.length.get(i));
                bind.scope.fold(Index::of(0), end, NOTHING, |_, none, k| {
                    patch(planes.entry(rows.kept.at(rows.place(k, i))).0);
                    none
                });
            }
            let length = over_own_body::<_, D>(bind, model, grid, i, near, zero, |k: Recorded, pair, j| {
                patch(j);
                rows.keep(i, k, pair, j)
            });
            rows.set_length(i, length);
            NOTHING
        };
        Recorded::if_lt(zero, is_marked, again, || NOTHING);
    })
}

/// Rows of particles that are not searched but whose neighbours are: entries of searched neighbours are replaced by
/// those that are near, the others are kept.
pub(in crate::engine) fn patch<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("patch_rows", count, |bind, i| {
        let near = (groups::Place::read(bind).position, searched(model, groups::Constants::read(bind)));
        let (rows, patched) = (Rows::of(bind, model), bind.indices(Group::Patched));
        let (zero, one, planes) = (Recorded::zero(), Recorded::one(), Planes::of(model));
        let is_due = patched.at(i).number() - rows.is_marked(i);
        let again = || {
            let end = Index::floor(rows.rows.length.get(i));
            let staying = bind.scope.fold(Index::of(0), end, zero, |_, k: Recorded, old| {
                let entry = rows.kept.at(rows.place(old, i));
                let stays = || {
                    rows.kept.set(rows.place(Index::floor(k), i), entry);
                    k + one
                };
                Recorded::if_lt(zero, rows.is_marked(planes.entry(entry).0), || k, stays)
            });
            let length = over_own_body::<_, D>(bind, model, grid, i, near, staying, |k: Recorded, pair, j| {
                Recorded::if_lt(zero, rows.is_marked(j), || rows.keep(i, k, pair, j), || k)
            });
            rows.set_length(i, length);
            NOTHING
        };
        Recorded::if_lt(zero, is_due, again, || NOTHING);
    })
}

/// The longest list of each row of particles.
pub(in crate::engine) fn longest_rows(count: usize) -> Result<Recording, KernelFault> {
    of_rows("longest_rows", count, LONGEST_ROW, |rows, longest, i| longest.max(rows.length.get(i)))
}

/// Folds over the lists of the particles of each row, starting with zero, to a number of [`Group::Ways`].
fn of_rows(
    name: &str,
    count: usize,
    to: usize,
    add: impl Fn(groups::Rows<Read>, Recorded, Index) -> Recorded,
) -> Result<Recording, KernelFault> {
    recording(name, count, |bind, row| {
        let (lists, ways) = (groups::Rows::read(bind), bind.write(Group::Ways));
        let all = over_particles(bind, (count, row), Recorded::zero(), |all, i| add(lists, all, i));
        ways.set_at(Index::of((to * rows(count)) as u32) + row, all);
    })
}

/// Displacements of the particles of each row since the last full search, or since contact candidates were
/// determined, and the skin that smoothing lengths that follow the density have left; there are `particles` of them.
pub(in crate::engine) fn displacements(
    model: &Model,
    since: Group,
    particles: usize,
    count: usize,
) -> Result<Recording, KernelFault> {
    let name = if since == Group::FoundAt { "ways_of_candidates" } else { "ways" };
    recording(name, count, |bind, row| {
        let place = groups::Place::read(bind).position;
        let (position, then_searched) = match since {
            Group::SearchedAt => {
                let searched_at = groups::SearchedAt::read(bind);
                (searched_at.position, model.smoothing_follows_density().then_some(searched_at.smoothing_length))
            }
            // They last as long as particles are near; nothing asks for the skin.
            other => (groups::FoundAt::read_of(bind, other).position, None),
        };
        let lengths = then_searched.map(|then| (then, searched(model, groups::Constants::read(bind))));
        let wide = Recorded::of(1.0 + model.skin_fraction());
        let displacements = bind.write(Group::Ways);
        let (zero, far) = (Recorded::zero(), Recorded::of(BEYOND));
        let start = [zero, far, far, far, -far, -far, -far, far];
        let all = over_particles(bind, (count, row), start, |mut all, i| {
            let way = [0, 1, 2].map(|a| {
                let (now, then) = (place.axis(a).get(i), position.axis(a).get(i));
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
            if let Some((then, now)) = &lengths {
                let left = wide * then.get(i) - now(i);
                all[7] = all[7].min(there(left, far));
            }
            all
        });
        for (k, number) in (0..LONGEST_ROW).chain([THINNEST_SKIN]).zip(all) {
            displacements.set_at(Index::of((k * rows(count)) as u32) + row, number);
        }
    })
}
