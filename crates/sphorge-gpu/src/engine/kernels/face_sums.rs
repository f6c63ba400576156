//! Gradients that are exact for quadratic fields at faces: what is taken from the sums of particles at faces, and the transpose of it, which
//! is added to their stresses, as in the engine for processors ([`sphorge_physics::face_gradient`]).
//!
//! The terms are found on the processor in the reference configuration ([`crate::engine::face_terms`]). Faces are rows of tables, from one on:
//! row zero is that of all particles that are at none, and has no terms and no contraction.

use super::images::Planes;
use super::neighbors::over_list;
use super::reference::is_deleted;
use crate::engine::columns::{
    Binder, Group, Read, ReadColumns, ReadRecords, ReadShared, Reading, Recording, Records, TensorColumns,
    WriteColumns, groups, recording,
};
use crate::record::{Index, Indices, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::face_gradient::{ThirdOrder, add_difference, along, excess, power, spread};
use sphorge_physics::gradient_correction::corrected;
use sphorge_physics::pair::GradientSums;
use sphorge_physics::total_lagrangian::total_first_piola;
use sphorge_physics::{Real, Tensor, Vector};

/// Numbers of a row of [`Group::FaceSpread`]: `R_i`, Pa m, and the power of what is taken, Pa/s.
pub(in crate::engine) const SPREAD: usize = 28;

/// A tensor of third order from numbers that follow each other.
fn third_order(number: impl Fn(usize) -> Recorded) -> ThirdOrder<Recorded> {
    [0, 1, 2].map(|a| [0, 1, 2].map(|b| [0, 1, 2].map(|c| number(9 * a + 3 * b + c))))
}

/// Neighbours of faces, or faces of their neighbours.
#[derive(Clone, Copy)]
struct Terms {
    starts: Indices,
    entries: Indices,
    q: groups::FaceTerms<Records>,
    planes: Planes,
}

impl Terms {
    fn of_faces(bind: &mut Binder<'_>, model: &Model) -> Self {
        Self {
            starts: bind.indices(Group::FaceStarts),
            entries: bind.indices(Group::FaceEntries),
            q: groups::FaceTerms::records(bind),
            planes: Planes::of(model),
        }
    }

    /// Rows of these are particles near faces, from zero on.
    fn of_near(bind: &mut Binder<'_>, model: &Model) -> Self {
        Self {
            starts: bind.indices(Group::NearStarts),
            entries: bind.indices(Group::NearEntries),
            q: groups::FaceTerms::records_of(bind, Group::NearTerms),
            planes: Planes::of(model),
        }
    }

    fn end(self, row: Index) -> Index {
        self.starts.at(row + Index::of(1))
    }
}

/// What is taken from sums of faces.
#[derive(Clone, Copy)]
pub(super) struct Taking {
    terms: Terms,
    table: groups::FaceTable<Records>,
    linear: TensorColumns<Read>,
}

impl Taking {
    /// Of the sums in this group.
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, sums: Group) -> Self {
        let linear = groups::FaceLinear::read_of(bind, sums).gradient;
        Self { terms: Terms::of_faces(bind, model), table: groups::FaceTable::records(bind), linear }
    }

    /// `E_i` of a row whose particle has the sum `own`.
    pub(super) fn taken<const D: usize>(
        self,
        bind: &mut Binder<'_>,
        row: Index,
        own: &Tensor<Recorded>,
    ) -> Tensor<Recorded> {
        let Self { terms, table, linear } = self;
        let zero = [[[Recorded::zero(); 3]; 3]; 3];
        let sum =
            bind.scope.fold(terms.starts.at(row), terms.end(row), zero, |_, mut sum: ThirdOrder<Recorded>, term| {
                let (j, image) = terms.planes.entry(terms.entries.at(term));
                let other = image.tensor(&linear.get(j));
                add_difference::<_, D>(&mut sum, own, &other, &terms.q.q.get(term));
                sum
            });
        excess::<_, D>(&third_order(|k| table.contraction.number(k).get(row)), &sum)
    }
}

/// The row of a thread, one for each face.
fn row_of(thread: Index) -> Index {
    thread + Index::of(1)
}

/// `G_i` of all particles, at the velocities of the middle of the step.
pub(in crate::engine) fn sum<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("sum_linear", count, |bind, i| {
        let near = Near::of(bind);
        let velocity = groups::Velocity::read(bind).velocity.high();
        let sum = linear::<D>(bind, model, i, near, |j| velocity.get(j));
        groups::FaceLinear::write(bind).gradient.set(i, &sum);
    })
}

/// `G_i` of particles near faces, at the velocities at which forces are evaluated.
pub(in crate::engine) fn sum_evaluated<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("sum_evaluated", count, |bind, thread| {
        let i = bind.indices(Group::NearParticles).at(thread);
        let near = Near::of(bind);
        let velocity = groups::Evaluated::read(bind).velocity;
        let sum = linear::<D>(bind, model, i, near, |j| velocity.get(j));
        groups::FaceLinear::write_of(bind, Group::FaceEvaluated).gradient.set(i, &sum);
    })
}

/// What sums in the reference configuration read.
#[derive(Clone, Copy)]
pub(super) struct Near {
    pub(super) reference: groups::Reference<Read>,
    pub(super) constants: groups::Constants<Read>,
    pub(super) correction: TensorColumns<Read>,
}

impl Near {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            reference: groups::Reference::read(bind),
            constants: groups::Constants::read(bind),
            correction: groups::Correction::read(bind).correction,
        }
    }
}

/// `G_i` of a velocity.
pub(super) fn linear<const D: usize>(
    bind: &mut Binder<'_>,
    model: &Model,
    i: Index,
    Near { reference, constants, correction }: Near,
    velocity: impl Fn(Index) -> Vector<Recorded>,
) -> Tensor<Recorded> {
    let kernel = model.numerics.kernel;
    let near = (reference, constants);
    let own = velocity(i);
    let zero = [[Recorded::zero(); 3]; 3];
    let sum = over_list::<_, D>(bind, model, i, near, zero, |gradient: [[Recorded; 3]; 3], pair, j| {
        let other = pair.image.vector(velocity(j));
        let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
        let f = pair.scale.weighted(near.0.volume.high().get(j)).f(kernel.dw_over_q_by(q, inverse_q));
        let mut sums = GradientSums { gradient, ..GradientSums::zero() };
        sums.add::<D, false>(&pair.x, &[0, 1, 2].map(|a| other[a] - own[a]), f);
        sums.gradient
    });
    corrected(&sum, &correction.get(i))
}

/// Takes what the sums of faces have too much, and adds it up for the springs, which see the motion that the sums do not.
pub(in crate::engine) fn take<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("take_at_faces", count, |bind, thread| {
        let i = bind.indices(Group::FaceParticles).at(thread);
        let taking = Taking::of(bind, model, Group::FaceLinear);
        let (to, sum) = (groups::FaceTaken::write(bind).rate, groups::FaceExcess::write(bind).excess);
        let dt = groups::Step::shared(bind).dt.value();
        let taken = taking.taken::<D>(bind, row_of(thread), &taking.linear.get(i));
        // What is deleted keeps its deformation.
        let left = Recorded::one() - is_deleted(bind, model, i);
        let taken = taken.map(|row| row.map(|c| left * c));
        to.set(i, &taken);
        for (k, rate) in taken.into_iter().flatten().enumerate() {
            sum.component(k).add(i, dt * rate);
        }
    })
}

/// `R_i` of faces, and the power of their stress at what is taken.
pub(in crate::engine) fn spread_stress<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("spread_stress", count, |bind, thread| {
        let i = bind.indices(Group::FaceParticles).at(thread);
        let (packed, table) = (groups::Packed::read(bind), groups::FaceTable::records(bind));
        let deformation = groups::Deformation::read(bind).deformation.high();
        let face_stress = match model.walls.is_empty() && !model.has_contact() {
            true => [[Recorded::zero(); 3]; 3],
            false => groups::FaceStress::read(bind).stress.get(i),
        };
        let taken = groups::FaceTaken::read(bind).rate.get(i);
        let to = bind.write(Group::FaceSpread);
        let stress = total_first_piola(packed.stress.get(i), &deformation.get(i), &face_stress);
        let row = row_of(thread);
        let spread = spread::<_, D>(&stress, &third_order(|k| table.contraction.number(k).get(row)));
        let first = row * Index::of(SPREAD as u32);
        let at_face = power::<_, D>(&stress, &taken);
        for (k, number) in spread.as_flattened().as_flattened().iter().copied().chain([at_face]).enumerate() {
            to.set_at(first + Index::of(k as u32), number);
        }
    })
}

/// `R` of a row.
fn spread_of(spread: Reading, row: Index) -> ThirdOrder<Recorded> {
    let first = row * Index::of(SPREAD as u32);
    third_order(|k| spread.get_at(first + Index::of(k as u32)))
}

/// What is added to the stresses of particles near faces, and the power that they have of others.
pub(in crate::engine) fn share<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("share_stress", count, |bind, n| {
        let i = bind.indices(Group::NearParticles).at(n);
        let row = bind.indices(Group::NearFaces).at(n);
        let (terms, table) = (Terms::of_near(bind, model), groups::FaceTable::records(bind));
        let (spread, linear) = (bind.read(Group::FaceSpread), groups::FaceLinear::read(bind).gradient);
        let (reference, constants) = (groups::Reference::read(bind), groups::Constants::read(bind));
        let to = groups::FaceShare::write(bind);
        let own = along::<_, D>(&spread_of(spread, row), &table.whole.get(row));
        let more = bind.scope.fold(terms.starts.at(n), terms.end(n), own, |_, mut more: [[Recorded; 3]; 3], term| {
            let (row, image) = terms.planes.entry(terms.entries.at(term));
            let stress = image.tensor(&along::<_, D>(&spread_of(spread, row), &terms.q.q.get(term)));
            for a in 0..D {
                for b in 0..D {
                    more[a][b] -= stress[a][b];
                }
            }
            more
        });
        to.stress.set(i, &more);
        let at_face = spread.get_at(row * Index::of(SPREAD as u32) + Index::of(SPREAD as u32 - 1));
        let of_all = -at_face - power::<_, D>(&more, &linear.get(i));
        to.power.set(i, of_all * reference.volume.high().get(i) / constants.mass.get(i));
    })
}
