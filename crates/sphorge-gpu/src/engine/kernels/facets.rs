//! Contact of bodies of the total Lagrangian form at the facets of the cells of their particles, and of a body with
//! itself, as in the engine for processors.
//!
//! Facets are found on the processor in the initial configuration ([`crate::engine::facets`]). A kernel carries those of
//! a particle and of its neighbours to the present where it needs them: that is short beside the law of a pair. The law
//! is long, so a kernel has its text once, in a loop over facets, neighbours, cells and images.

use super::face_sums::{Near, Taking, linear};
use super::images::Image;
use super::reference::{Deformations, References};
use crate::engine::columns::{
    Binder, Group, ReadColumns, ReadRecords, Recording, Records, WriteColumns, groups, recording,
};
use crate::record::{Index, Indices, KernelFault, Recorded};
use sphorge_engine::FacetLaws;
use sphorge_engine::model::Model;
use sphorge_physics::facet::{Facet, FacetPairLaw, OnSides, ReferenceFacet, edges_reversed};
use sphorge_physics::tensor::{apply, dot, inverse, multiply, plus};
use sphorge_physics::thin::is_thin;
use sphorge_physics::{Elementary, Real, Tensor, Vector};

/// Whole numbers of a particle in [`Group::Facets`]: the first of its facets, the one behind its last, its `id`, and the row of what is beside its cell.
pub(in crate::engine) const FACETS: usize = 4;

/// How much farther than the corners of facets owners are looked for: surfaces are curved.
const FARTHER: f64 = 1.1;

/// Numbers of the law of two bodies.
pub(super) fn law_numbers(laws: &FacetLaws, (a, b): (usize, usize), friction_share: f64) -> [f64; 6] {
    let FacetPairLaw { stiffness, damping, friction, tangential_stiffness, gives_way, .. } = *laws.of(a, b);
    [stiffness, damping, friction, tangential_stiffness, gives_way, friction_share]
}

/// Facets of the initial configuration, and who has them.
#[derive(Clone, Copy)]
pub(super) struct Table {
    pub(super) columns: groups::FacetTable<Records>,
    pub(super) ways: groups::BesideTable<Records>,
    of_particles: Indices,
    stride: Index,
}

impl Table {
    pub(super) fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            columns: groups::FacetTable::records(bind),
            ways: groups::BesideTable::records(bind),
            of_particles: bind.indices(Group::Facets),
            stride: bind.stride(),
        }
    }

    pub(super) fn first(self, i: Index) -> Index {
        self.of_particles.at(i)
    }

    pub(super) fn end(self, i: Index) -> Index {
        self.of_particles.at(self.stride + i)
    }

    /// The number of a particle that no other has, in two parts that single precision represents exactly.
    pub(super) fn id(self, i: Index) -> [Recorded; 2] {
        const LOW: u32 = (1 << 16) - 1;
        let id = self.of_particles.at(Index::of(2) * self.stride + i);
        [id.and(Index::of(!LOW)).number(), id.and(Index::of(LOW)).number()]
    }

    /// The row of what is beside the cell of a particle.
    pub(super) fn beside(self, i: Index) -> Index {
        self.of_particles.at(Index::of(3) * self.stride + i)
    }

    pub(super) fn facet(self, facet: Index) -> ReferenceFacet<Recorded> {
        ReferenceFacet {
            corners: self.columns.corners.get(facet),
            middle: self.columns.middle.get(facet),
            normal: self.columns.normal.get(facet),
            curvature: self.columns.curvature.get(facet),
            depth: self.columns.depth.get(facet),
            free: self.columns.free.get(facet),
            across: self.columns.across.get(facet),
        }
    }

    pub(super) fn face(self, facet: Index) -> Index {
        Index::floor(self.columns.face.get(facet))
    }

    /// The first part of the same face.
    pub(super) fn lead(self, facet: Index) -> Index {
        facet + Index::floor(-self.columns.part.get(facet))
    }
}

/// A facet where it is, about its owner, and the stretch along its normal.
pub(super) fn carried(
    table: Table,
    facet: Index,
    (f, shifts): (&Tensor<Recorded>, &OnSides<Recorded>),
    image: Option<&Image>,
) -> (Facet<Recorded>, Recorded) {
    let reference = table.facet(facet);
    let now = Facet::now([Recorded::zero(); 3], f, &reference).shifted(&reference, f, shifts);
    let (now, stretch) = now.held(reference.depth);
    (image.map_or(now, |image| mirrored(&now, image)), stretch)
}

/// Whether corners of an image follow each other the other way round: `-1` if so, else one.
fn handedness(image: &Image) -> Recorded {
    let [x, y, z] = image.vector([Recorded::one(); 3]);
    x * y * z
}

fn mirrored(facet: &Facet<Recorded>, image: &Image) -> Facet<Recorded> {
    let hand = handedness(image);
    let [a, b, c, d] = facet.corners.map(|corner| image.vector(corner));
    let choose = |reversed: Vector<Recorded>, same: Vector<Recorded>| {
        [0, 1, 2].map(|k| Recorded::select_lt(hand, Recorded::zero(), reversed[k], same[k]))
    };
    Facet {
        corners: [choose(b, a), choose(a, b), choose(d, c), choose(c, d)],
        middle: image.vector(facet.middle),
        normal: image.vector(facet.normal),
        curvature: image.symmetric(facet.curvature),
        shift: image.vector(facet.shift),
        shear: image.tensor(&facet.shear),
        free: {
            let reversed = edges_reversed(facet.free);
            [0, 1, 2, 3].map(|k| Recorded::select_lt(hand, Recorded::zero(), reversed[k], facet.free[k]))
        },
        ..*facet
    }
}

/// Velocity gradients of particles with facets at the velocities at which forces are evaluated, so that the forces work
/// as in the sums; and how far their facets reach.
pub(in crate::engine) fn follow<const D: usize>(
    model: &Model,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("follow_facets", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let near = (groups::Reference::read(bind), groups::Constants::read(bind));
        let (evaluated, correction) =
            (groups::Evaluated::read(bind).velocity, groups::Correction::read(bind).correction);
        let (gradient, deformation) =
            (groups::Gradient::read(bind).velocity_gradient, Deformations::of(bind, references));
        let (table, motion) = (Table::of(bind), groups::FacetMotion::write(bind));
        let of = Near { reference: near.0, constants: near.1, correction };
        let mut rate = linear::<D>(bind, model, i, of, |j| evaluated.get(j));
        if model.formulation.is_quadratic_at_faces() {
            let row = bind.indices(Group::FaceRows).at(i);
            let taken = Taking::of(bind, model, Group::FaceEvaluated).taken::<D>(bind, row, &rate);
            rate = plus(&rate, -Recorded::one(), &taken);
        }
        let (correction, f) = (correction.get(i), deformation.since_reference(i));
        // What the sums of thin parts do not see across them is that of the middle of the step.
        let thin = || gradient.get(i);
        let thick = || multiply(&rate, &inverse(&f));
        let l = Recorded::if_lt(Recorded::zero(), is_thin(&correction), thin, thick);
        motion.velocity_gradient.set(i, &l);
        let sizes = deformation.whole(i).map(|row| row.map(Real::abs));
        let farthest =
            bind.scope.fold(table.first(i), table.end(i), Recorded::zero(), |_, farthest: Recorded, facet| {
                table.facet(facet).corners.into_iter().fold(farthest, |farthest, corner| {
                    let arm = apply(&sizes, corner.map(Real::abs));
                    farthest.max(dot(arm, arm))
                })
            });
        motion.reach.set(i, Recorded::of(FARTHER) * farthest.sqrt());
    })
}
