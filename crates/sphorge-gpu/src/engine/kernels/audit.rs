//! Audit of stored lists or of those of the reference configuration: their sums compared with those over an exact
//! search.

use super::contact::SelfContact;
use super::grid::Grid;
use super::images::Planes;
use super::neighbors::{Pair, different, now, over_cells};
use super::reference::References;
use super::verlet::stored_place;
use crate::engine::columns::{
    Binder, Compensated, CompensatedVector, Group, Number, Read, ReadColumns, Recording, SymmetricColumns,
    WriteColumns, groups, recording,
};
use crate::record::{Index, Indices, KernelFault, Recorded};
use sphorge_engine::AuditedRow;
use sphorge_engine::model::Model;
use sphorge_physics::audit::{AuditPair, AuditSums};
use sphorge_physics::surface::soon_different_sides;
use sphorge_physics::{Elementary, Real, SymmetricTensor};

/// Sums of a row: rate of the density, 1/s, acceleration, and that by particles, not images, m/s².
const SUMS: usize = 7;
/// Numbers of a row of the list: its sums, and pairs beyond the kernel support.
const OF_LIST: usize = SUMS + 1;
/// For an exact one: its sums, pairs, those missing from the list, and those of them with another body.
const OF_EXACT: usize = SUMS + 3;
/// Numbers of a particle in [`Group::Audit`].
pub(in crate::engine) const AUDIT: usize = OF_LIST + OF_EXACT;

/// Particle data that the sums read.
#[derive(Clone, Copy)]
struct Points {
    place: CompensatedVector<Read>,
    constants: groups::Constants<Read>,
    velocity: CompensatedVector<Read>,
    density: Compensated<Read>,
    deviator: SymmetricColumns<Read>,
    pressure: groups::Pressure<Read>,
}

impl Points {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            place: groups::Place::read(bind).position,
            constants: groups::Constants::read(bind),
            velocity: groups::Velocity::read(bind).velocity,
            density: groups::Density::read(bind).density,
            deviator: groups::Deviator::read(bind).deviator,
            pressure: groups::Pressure::read(bind),
        }
    }

    fn stress(self, i: Index) -> SymmetricTensor<Recorded> {
        self.deviator.get(i) - SymmetricTensor::isotropic(self.pressure.pressure.get(i))
    }

    /// Adds a pair to the first numbers of a row; `is_particle` is one if the neighbour is not an image, else zero.
    fn add(self, model: &Model, row: &mut [Recorded], (i, j): (Index, Index), pair: &Pair, is_particle: Recorded) {
        let image = &pair.image;
        let (v_i, v_j) = (self.velocity.high().get(i), image.vector(self.velocity.high().get(j)));
        let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
        let mut sums = AuditSums { divergence: row[0], acceleration: [row[1], row[2], row[3]] };
        let acceleration = sums.add(&AuditPair {
            x: pair.x,
            v: [0, 1, 2].map(|a| v_j[a] - v_i[a]),
            f: pair.scale.f(model.numerics.kernel.dw_over_q_by(q, inverse_q)),
            volume: self.constants.mass.get(j) / self.density.high().get(j),
            density: self.density.high().get(i),
            stress: self.stress(i) + image.symmetric(self.stress(j)),
        });
        row[0] = sums.divergence;
        row[1..4].copy_from_slice(&sums.acceleration);
        for (sum, part) in row[4..].iter_mut().zip(acceleration) {
            *sum += is_particle * part;
        }
    }
}

/// One if a pair is within the kernel support, else zero.
fn is_inside(model: &Model, pair: &Pair) -> Recorded {
    let reach = Recorded::of(model.numerics.kernel.support()) * pair.scale.h;
    Recorded::select_lt(pair.r2, reach * reach, Recorded::one(), Recorded::zero())
}

/// Lists that are read.
#[derive(Clone, Copy)]
struct Lists {
    /// Their lengths.
    lengths: Number<Read>,
    entries: Indices,
    /// Their starts, in the reference configuration; stored lists have the first neighbours of all particles before the
    /// second ones.
    starts: Option<Indices>,
    stride: Index,
    planes: Planes,
}

impl Lists {
    fn of(bind: &mut Binder<'_>, model: &Model) -> Self {
        let (stride, planes) = (bind.stride(), Planes::of(model));
        let (lengths, entries, starts) = if model.is_total_lagrangian() {
            (groups::Weight::read(bind).neighbors, bind.indices(Group::List), Some(bind.indices(Group::ListStarts)))
        } else {
            (groups::Rows::read(bind).length, bind.indices(Group::Kept), None)
        };
        Self { lengths, entries, starts, stride, planes }
    }

    fn length(self, i: Index) -> Recorded {
        self.lengths.get(i)
    }

    fn entry(self, k: Index, i: Index) -> Index {
        self.entries.at(self.starts.map_or_else(|| k * self.stride + i, |starts| starts.at(i) + k))
    }
}

/// Sums over the lists, with the distances used in the step.
pub(in crate::engine) fn of_lists<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("audit_lists", count, |bind, i| {
        let (points, lists, audit) = (Points::of(bind), Lists::of(bind, model), groups::Audit::write(bind));
        let stored = model.keeps_distances().then(|| bind.read(Group::Stored));
        let (zero, one, own) = (Recorded::zero(), Recorded::one(), points.place.get(i));
        let row = bind.scope.fold(Index::of(0), Index::floor(lists.length(i)), [zero; OF_LIST], |_, mut row, k| {
            let entry = lists.entry(k, i);
            let (j, image) = lists.planes.entry(entry);
            let lengths = (points.constants.smoothing_length.get(i), points.constants.smoothing_length.get(j));
            let mut pair = Pair::of::<D>(model, (image, 0), &own, &points.place.get(j), lengths);
            row[SUMS] += one - is_inside(model, &pair);
            if let Some(stored) = stored {
                pair.r2 = zero;
                for a in 0..D {
                    pair.x[a] = stored.get_at(stored_place(k, a, lists.stride, i));
                    pair.r2 = pair.x[a].mul_add(pair.x[a], pair.r2);
                }
            }
            let is_particle = Recorded::select_lt(Planes::image_of(entry), Recorded::of(0.5), one, zero);
            points.add(model, &mut row, (i, j), &pair, is_particle);
            row
        });
        audit.of_list.set(i, row);
    })
}

/// Sums over all neighbours within the kernel support, and how many of them the lists lack. Contact pairs are searched
/// in every step; pairs of a body with itself count if they may be in contact soon.
pub(in crate::engine) fn exact<const D: usize>(
    model: &Model,
    grid: &Grid,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("audit_exactly", count, |bind, i| {
        let (points, lists, audit) = (Points::of(bind), Lists::of(bind, model), groups::Audit::write(bind));
        let bodies = bind.indices(Group::Body);
        let (zero, one, half) = (Recorded::zero(), Recorded::one(), Recorded::of(0.5));
        let near = (points.place, now(points.constants));
        let itself = SelfContact::of(bind, model, references, points.constants);
        let row =
            over_cells::<_, D>(bind, model, grid, i, near, [zero; OF_EXACT], |row: [Recorded; OF_EXACT], pair, j| {
                let add = || {
                    let mut row = row;
                    let is_particle = if pair.bits == 0 { one } else { zero };
                    points.add(model, &mut row, (i, j), pair, is_particle);
                    row[SUMS] += one;
                    let is_foreign = Recorded::select_lt(different(bodies, i, j), half, zero, one);
                    let lacks = lists.lack(i, Planes::entry_of(pair.bits, j));
                    let mut missed = if model.has_contact() { lacks * (one - is_foreign) } else { lacks };
                    if let Some(itself) = itself {
                        missed = missed * (one - itself.press::<D>(model, i, pair, j, soon_different_sides));
                    }
                    row[SUMS + 1] += missed;
                    row[SUMS + 2] += missed * is_foreign;
                    row
                };
                Recorded::if_lt(half, is_inside(model, pair), add, || row)
            });
        audit.exact.set(i, row);
    })
}

impl Lists {
    /// One if the list of a particle does not have an entry, else zero.
    fn lack(self, i: Index, entry: Index) -> Recorded {
        let (zero, one, half) = (Recorded::zero(), Recorded::one(), Recorded::of(0.5));
        let (neighbor, image) = (Planes::number_of(entry), Planes::image_of(entry));
        let length = self.length(i);
        let look = || {
            let [_, lacks] = Recorded::iterate([zero, one], |[k, _]| {
                let other = self.entry(Index::floor(k), i);
                let apart = (Planes::number_of(other) - neighbor).abs() + (Planes::image_of(other) - image).abs();
                let (next, lacks) = (k + one, Recorded::select_lt(apart, half, zero, one));
                ([next, lacks], Recorded::select_lt(next, length, lacks, zero))
            });
            lacks
        };
        Recorded::if_lt(zero, length, look, || one)
    }
}

/// Results for particle `i`: from its list and exactly; `number` returns the numbers of [`Group::Audit`].
pub(in crate::engine) fn rows(number: impl Fn(usize) -> f64) -> (AuditedRow, AuditedRow) {
    let vector = |first: usize| [0, 1, 2].map(|a| number(first + a));
    let of = |first: usize| AuditedRow {
        sums: AuditSums { divergence: number(first), acceleration: vector(first + 1) },
        internal: vector(first + 4),
        ..AuditedRow::default()
    };
    let counted = |k: usize| number(OF_LIST + SUMS + k) as u64;
    let exact = AuditedRow { pairs: counted(0), missed: counted(1), missed_foreign: counted(2), ..of(OF_LIST) };
    (AuditedRow { stale: number(SUMS) as u64, ..of(0) }, exact)
}
