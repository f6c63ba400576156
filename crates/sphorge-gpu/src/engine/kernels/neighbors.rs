//! Neighbours over which a particle sums: those in the cells around its own, or those of a list.

use super::grid::Grid;
use super::images::{Image, Planes};
use super::verlet::stored_place;
use crate::engine::columns::{Binder, CompensatedVector, Group, Read, ReadColumns, Reading, groups};
use crate::record::{Index, Indices, Recorded};
use sphorge_engine::model::{AdaptiveSearch, Model, Search};
use sphorge_physics::kernel::{PairScale, pair_smoothing_length};
use sphorge_physics::{Elementary, Numbers, Real, Vector};

/// A particle on a symmetry plane is its own image: within this share of the reach it has none.
pub(super) const ON_PLANE: f64 = 1e-9;

/// Positions of pairs, and the reach of their kernel.
pub(super) struct Pair {
    /// `x_i - x_j`, m.
    pub(super) x: Vector<Recorded>,
    pub(super) r2: Recorded,
    pub(super) scale: PairScale<Recorded>,
    /// The image that the neighbour is; the entry of the pair in a list by its bits.
    pub(super) image: Image,
    pub(super) bits: u32,
}

impl Pair {
    /// From positions with their low parts.
    pub(super) fn of<const D: usize>(
        model: &Model,
        (image, bits): (Image, u32),
        own: &Vector<[Recorded; 2]>,
        other: &Vector<[Recorded; 2]>,
        (h_i, h_j): (Recorded, Recorded),
    ) -> Self {
        let sigma = Recorded::of(model.numerics.kernel.normalisation(model.dimensions.into()));
        let x = apart::<D>(&image, own, other);
        let mut r2 = Recorded::zero();
        for c in &x[..D] {
            r2 = c.mul_add(*c, r2);
        }
        Self { x, r2, scale: PairScale::new::<D>(sigma, pair_smoothing_length(h_i, h_j)), image, bits }
    }
}

/// `x_i - x_j` of positions with their low parts, along the `D` axes computed in.
pub(super) fn apart<const D: usize>(
    image: &Image,
    own: &Vector<[Recorded; 2]>,
    other: &Vector<[Recorded; 2]>,
) -> Vector<Recorded> {
    [0, 1, 2].map(|a| if a < D { image.apart(a, own[a], other[a]) } else { Recorded::zero() })
}

/// Current smoothing length of a particle, m.
pub(super) fn now(constants: groups::Constants<Read>) -> impl Fn(Index) -> Recorded + Copy {
    move |i| constants.smoothing_length.get(i)
}

/// Initial smoothing length, m, which the contact uses.
pub(super) fn at_start(constants: groups::Constants<Read>) -> impl Fn(Index) -> Recorded + Copy {
    move |i| constants.initial_smoothing_length.get(i)
}

/// Smoothing length of the search, m: with a contact between bodies, not below the one that the contact uses.
pub(super) fn searched(model: &Model, constants: groups::Constants<Read>) -> impl Fn(Index) -> Recorded + Copy {
    let is_raised = is_raised(model);
    move |i| {
        if is_raised {
            constants.smoothing_length.get(i).max(constants.initial_smoothing_length.get(i))
        } else {
            constants.smoothing_length.get(i)
        }
    }
}

/// Whether lists are searched farther than kernels reach.
fn is_raised(model: &Model) -> bool {
    model.has_contact() && model.smoothing_follows_density()
}

/// Folds a state over every neighbour within the reach of the cells, by smoothing lengths (m), without the particle
/// itself, including images behind symmetry planes and periodic ends.
pub(super) fn over_cells<S: Numbers<Recorded>, const D: usize>(
    bind: &mut Binder<'_>,
    model: &Model,
    grid: &Grid,
    i: Index,
    (place, length): (CompensatedVector<Read>, impl Fn(Index) -> Recorded),
    start: S,
    add: impl Fn(S, &Pair, Index) -> S,
) -> S {
    let (starts, sorted, around) =
        (bind.indices(Group::CellStarts), bind.indices(Group::Sorted), bind.indices(Group::Around));
    let support = Recorded::of(grid.reach);
    let planes = Planes::of(model);
    let own = place.get(i);
    let h = length(i);
    let cells = Index::of((grid.around().len() / 3) as u32);
    let near = Recorded::of(strays(model) * grid.edge);
    let mut state = start;
    for (bits, image) in planes.images() {
        // A particle next to the image of the particle has an image next to the particle itself.
        let steps = grid.steps(&|axis| image.back(axis, own[axis][0]));
        let scope = &mut *bind.scope;
        let before = state;
        let mut sum = || {
            scope.fold(Index::of(0), cells, before, |scope, state, k| {
                let there = k * Index::of(3);
                let cell = grid.cell([0, 1, 2].map(|axis| steps[axis] + around.at(there + Index::of(axis as u32))));
                scope.fold(starts.at(cell), starts.at(cell + Index::of(1)), state, |_, state, place_of| {
                    let j = sorted.at(place_of);
                    let other = place.get(j);
                    let pair = Pair::of::<D>(model, (image, bits), &own, &other, (h, length(j)));
                    let reach = support * pair.scale.h;
                    let mut apart = pair.r2;
                    if bits == 0 {
                        // The particle itself counts as out of reach.
                        let itself = (j.number() - i.number()).abs();
                        apart = Recorded::select_lt(itself, Recorded::of(0.5), reach * reach, apart);
                    }
                    for distance in image.distances::<D>(&other) {
                        let on_plane = Recorded::of(ON_PLANE) * reach;
                        apart = Recorded::select_lt(on_plane, distance, apart, reach * reach);
                        // The neighbour is in the sum of this particle only if it also sums over this one.
                        apart = Recorded::select_lt(distance, near, apart, reach * reach);
                    }
                    Recorded::if_lt(apart, reach * reach, || add(state, &pair, j), || state)
                })
            })
        };
        state = match image.farthest::<D>(&own) {
            None => sum(),
            // Only particles near all planes and ends have neighbours behind them.
            Some(distance) => Recorded::if_lt(distance, near, sum, || before),
        };
    }
    state
}

/// How far from a plane or an end there are images, over the edge of a cell. Particles leave a periodic cell before all
/// are wrapped, and a renewed reference configuration is that of before a drift; those that have passed a symmetry plane,
/// by up to the reach of a kernel, see images of what is farther in front of it by the same distance.
pub(super) fn strays(model: &Model) -> f64 {
    let of_ends = match model.periodic.iter().all(Option::is_none) {
        true => 1.0,
        false if model.formulation.renews() => 2.0,
        false => model.adaptive_search().map_or(1.0, |_| 1.0 + AdaptiveSearch::IMAGE_MARGIN),
    };
    if model.symmetry.is_empty() { of_ends } else { f64::max(of_ends, 2.0) }
}

/// Folds a state over the list of a particle, as far as pairs are within the kernel support, at the distances used in
/// sums.
pub(super) fn over_neighbors<S: Numbers<Recorded>, const D: usize>(
    bind: &mut Binder<'_>,
    model: &Model,
    i: Index,
    (place, constants): (CompensatedVector<Read>, groups::Constants<Read>),
    start: S,
    add: impl Fn(S, &Pair, Index) -> S,
) -> S {
    let stored = model.keeps_distances().then(|| bind.read(Group::Stored));
    over_rows::<S, D>(bind, model, i, (place, constants), stored, start, add)
}

/// The same at the current distances, if sums use those of the last search.
pub(super) fn over_present_neighbors<S: Numbers<Recorded>, const D: usize>(
    bind: &mut Binder<'_>,
    model: &Model,
    i: Index,
    near: (CompensatedVector<Read>, groups::Constants<Read>),
    start: S,
    add: impl Fn(S, &Pair, Index) -> S,
) -> S {
    over_rows::<S, D>(bind, model, i, near, None, start, add)
}

fn over_rows<S: Numbers<Recorded>, const D: usize>(
    bind: &mut Binder<'_>,
    model: &Model,
    i: Index,
    (place, constants): (CompensatedVector<Read>, groups::Constants<Read>),
    stored: Option<Reading>,
    start: S,
    add: impl Fn(S, &Pair, Index) -> S,
) -> S {
    let (rows, kept, stride) = (groups::Rows::read(bind), bind.indices(Group::Kept), bind.stride());
    let (planes, support) = (Planes::of(model), Recorded::of(model.numerics.kernel.support()));
    let (own, h) = (place.get(i), constants.smoothing_length.get(i));
    let end = Index::floor(rows.length.get(i));
    bind.scope.fold(Index::of(0), end, start, |_, state, k| {
        let (j, image) = planes.entry(kept.at(k * stride + i));
        let mut pair = Pair::of::<D>(model, (image, 0), &own, &place.get(j), (h, constants.smoothing_length.get(j)));
        if let Some(stored) = stored {
            pair.r2 = Recorded::zero();
            for a in 0..D {
                pair.x[a] = stored.get_at(stored_place(k, a, stride, i));
                pair.r2 = pair.x[a].mul_add(pair.x[a], pair.r2);
            }
        }
        if model.search == Search::EveryStep && !is_raised(model) {
            // All are, because they were found in this step.
            return add(state, &pair, j);
        }
        let reach = support * pair.scale.h;
        Recorded::if_lt(pair.r2, reach * reach, || add(state, &pair, j), || state)
    })
}

/// The same as [`over_cells`], but only for neighbours in the same body if bodies have a contact, whose pairs are not
/// neighbours in the sums.
pub(super) fn over_own_body<S: Numbers<Recorded>, const D: usize>(
    bind: &mut Binder<'_>,
    model: &Model,
    grid: &Grid,
    i: Index,
    near: (CompensatedVector<Read>, impl Fn(Index) -> Recorded),
    start: S,
    add: impl Fn(S, &Pair, Index) -> S,
) -> S {
    let bodies = (model.has_contact() && model.bodies.len() > 1).then(|| bind.indices(Group::Body));
    over_cells::<S, D>(bind, model, grid, i, near, start, |state, pair, j| match bodies {
        None => add(state, pair, j),
        Some(of) => Recorded::if_lt(different(of, i, j), Recorded::of(0.5), || add(state, pair, j), || state),
    })
}

/// Zero if two particles are of one body, one or more if they are of different ones.
pub(super) fn different(bodies: Indices, i: Index, j: Index) -> Recorded {
    (bodies.at(j).number() - bodies.at(i).number()).abs()
}

/// Folds a state over the list of a particle, whose pairs are those of the reference configuration.
pub(super) fn over_list<S: Numbers<Recorded>, const D: usize>(
    bind: &mut Binder<'_>,
    model: &Model,
    i: Index,
    (reference, constants): (groups::Reference<Read>, groups::Constants<Read>),
    start: S,
    add: impl FnOnce(S, &Pair, Index) -> S,
) -> S {
    let (starts, list) = (bind.indices(Group::ListStarts), bind.indices(Group::List));
    let planes = Planes::of(model);
    let (own, h) = (reference.position.get(i), constants.smoothing_length.get(i));
    bind.scope.fold(starts.at(i), starts.at(i + Index::of(1)), start, |_, state, k| {
        let (j, image) = planes.entry(list.at(k));
        let pair =
            Pair::of::<D>(model, (image, 0), &own, &reference.position.get(j), (h, constants.smoothing_length.get(j)));
        add(state, &pair, j)
    })
}
