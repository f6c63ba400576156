//! Data of a neighbour that a pair sum reads, one record per particle, so that a neighbour costs one or two cache
//! lines.

use crate::halo::{Columns, GhostColumn, Packed};
use crate::lanes::PairScalar;
use crate::neighbors::Frame;
use bytemuck::{cast_slice, cast_slice_mut};
use smallvec::smallvec;
use sphorge_physics::Vector;

/// Axes along which a mirror image changes the sign of an entry; two equal axes mean no change.
type Axes = (u8, u8);
const SAME: Axes = (0, 0);
const ALONG: [Axes; 3] = [(1, 0), (2, 0), (4, 0)];
/// xx, yy, zz, xy, yz, xz.
const SYMMETRIC: [Axes; 6] = [(1, 1), (2, 2), (4, 4), (1, 2), (2, 4), (1, 4)];

/// Entries of a kinematic record.
pub(super) mod kinematic {
    use super::{ALONG, Axes, SAME};

    pub(crate) const X: usize = 0;
    /// Weight of the neighbour in a gradient sum.
    pub(crate) const WEIGHT: usize = 3;
    pub(crate) const V: usize = 4;
    /// Smoothing length.
    pub(crate) const H: usize = 7;
    pub(crate) const LEN: usize = 8;
    /// Coordinates are encoded and filled apart.
    pub(super) const AXES: [Axes; LEN] = [SAME, SAME, SAME, SAME, ALONG[0], ALONG[1], ALONG[2], SAME];
}

/// Entries of a force record.
pub(super) mod force {
    use super::{ALONG, Axes, SAME, SYMMETRIC};

    pub(crate) const X: usize = 0;
    /// Weight of the neighbour in the momentum sum.
    pub(crate) const WEIGHT: usize = 3;
    pub(crate) const V: usize = 4;
    /// Smoothing length.
    pub(crate) const H: usize = 7;
    /// Scaled stress xx, yy, zz, xy, yz, xz.
    pub(crate) const S: usize = 8;
    /// Density.
    pub(crate) const RHO: usize = 14;
    /// Sound speed.
    pub(crate) const C: usize = 15;
    pub(crate) const LEN: usize = 16;
    /// Coordinates are encoded and filled apart.
    pub(super) const AXES: [Axes; LEN] = {
        let [xx, yy, zz, xy, yz, xz] = SYMMETRIC;
        let [x, y, z] = ALONG;
        [SAME, SAME, SAME, SAME, x, y, z, SAME, xx, yy, zz, xy, yz, xz, SAME, SAME]
    };
}

/// Entries of an extra record, read only when artificial stress, the Balsara switch or XSPH is on.
pub(super) mod extra {
    use super::{Axes, SAME, SYMMETRIC};

    /// Scaled artificial stress xx, yy, zz, xy, yz, xz.
    pub(crate) const R: usize = 0;
    /// Balsara factor.
    pub(crate) const BALSARA: usize = 6;
    /// Mass over the weight of the force record, that is the density of its volume.
    pub(crate) const MASS_PER_WEIGHT: usize = 7;
    pub(crate) const LEN: usize = 8;
    pub(super) const AXES: [Axes; LEN] = {
        let [xx, yy, zz, xy, yz, xz] = SYMMETRIC;
        [xx, yy, zz, xy, yz, xz, SAME, SAME]
    };
}

/// Entries of a corrected record: the scaled stress times the gradient correction, row by row; not symmetric.
pub(super) const CORRECTED_LEN: usize = 9;
const CORRECTED_AXES: [Axes; CORRECTED_LEN] = [(1, 1), (1, 2), (1, 4), (2, 1), (2, 2), (2, 4), (4, 1), (4, 2), (4, 4)];

/// Entries of an hourglass record: displacement `u = x - X`, displacement gradient `H = F - 1`, stiffness.
///
/// Springs see `F_i X_ij - x_ij = H_i X_ij - u_ij`. What a body under its weight does to either side is a billionth of
/// a spacing or less, of which positions and deformation gradients in single precision have nothing left, wherever
/// their origin is. Displacements in two parts do, and depend neither on the size of the model nor on how far the body
/// has moved.
pub(super) mod hourglass {
    pub(crate) const U: usize = 0;
    /// What single precision rounds off the displacement.
    pub(crate) const U_REST: usize = 3;
    pub(crate) const H: usize = 6;
    pub(crate) const STIFFNESS: usize = 15;
    pub(crate) const LEN: usize = 16;
}

/// Records of particles and ghosts in their precision.
fn packed<'a, T: PairScalar>(own: &'a [T], ghosts: &'a mut [T], axes: &'a [Axes]) -> GhostColumn<'a> {
    if size_of::<T>() == size_of::<f32>() {
        GhostColumn::Single(Packed { own: cast_slice(own), ghosts: cast_slice_mut(ghosts), axes })
    } else {
        GhostColumn::Double(Packed { own: cast_slice(own), ghosts: cast_slice_mut(ghosts), axes })
    }
}

/// Records of all particles and ghosts.
#[derive(Clone, Debug, Default)]
pub(super) struct Records<T> {
    pub(super) kinematic: Vec<[T; kinematic::LEN]>,
    pub(super) force: Vec<[T; force::LEN]>,
    /// Empty unless needed.
    pub(super) extra: Vec<[T; extra::LEN]>,
    /// Empty unless needed.
    pub(super) corrected: Vec<[T; CORRECTED_LEN]>,
    /// Empty unless needed.
    pub(super) hourglass: Vec<[T; hourglass::LEN]>,
    pub(super) frame: Frame,
    /// Positions of ghosts for the velocity gradient, m.
    ghost_places: Vec<Vector<f64>>,
    /// Positions of particles for it, m, if there are ghosts.
    places: Vec<Vector<f64>>,
}

impl<T: PairScalar> Records<T> {
    /// Allocates memory for `count` particles and ghosts.
    pub(super) fn resize(&mut self, count: usize, extra: bool, corrected: bool) {
        self.kinematic.resize(count, [T::zero(); kinematic::LEN]);
        self.force.resize(count, [T::zero(); force::LEN]);
        if extra {
            self.extra.resize(count, [T::zero(); extra::LEN]);
        }
        if corrected {
            self.corrected.resize(count, [T::zero(); CORRECTED_LEN]);
        }
    }

    /// Positions of the `count` particles for the velocity gradient, m, to be filled if there are ghosts.
    pub(super) fn places(&mut self, count: usize) -> &mut [Vector<f64>] {
        self.places.resize(count, [0.0; 3]);
        &mut self.places
    }

    /// The kinematic records of the ghosts, which follow those of the `count` particles. Coordinates are written by
    /// [`Self::place_kinematic_ghosts`].
    pub(super) fn kinematic_of_ghosts(&mut self, count: usize, ghosts: usize) -> [GhostColumn<'_>; 2] {
        self.ghost_places.resize(ghosts, [0.0; 3]);
        let (own, ghosts) = self.kinematic.split_at_mut(count);
        let records = packed(own.as_flattened(), ghosts.as_flattened_mut(), &kinematic::AXES);
        [GhostColumn::Point(&self.places, &mut self.ghost_places), records]
    }

    /// Writes the coordinates of ghosts for the velocity gradient.
    pub(super) fn place_kinematic_ghosts(&mut self, count: usize) {
        for (record, place) in self.kinematic[count..].iter_mut().zip(&self.ghost_places) {
            record[kinematic::X..kinematic::X + 3].copy_from_slice(&self.frame.encode::<T>(place));
        }
    }

    /// The force records of ghosts, and the other records packed for the forces.
    pub(super) fn forces_of_ghosts(&mut self, count: usize) -> Columns<'_> {
        let (own, ghosts) = self.force.split_at_mut(count);
        let mut columns: Columns<'_> = smallvec![packed(own.as_flattened(), ghosts.as_flattened_mut(), &force::AXES)];
        if !self.extra.is_empty() {
            let (own, ghosts) = self.extra.split_at_mut(count);
            columns.push(packed(own.as_flattened(), ghosts.as_flattened_mut(), &extra::AXES));
        }
        if !self.corrected.is_empty() {
            let (own, ghosts) = self.corrected.split_at_mut(count);
            columns.push(packed(own.as_flattened(), ghosts.as_flattened_mut(), &CORRECTED_AXES));
        }
        columns
    }

    /// Writes the coordinates of ghosts at `places` (m) for the forces.
    pub(super) fn place_force_ghosts(&mut self, count: usize, places: &[Vector<f64>]) {
        for (record, place) in self.force[count..].iter_mut().zip(places) {
            record[force::X..force::X + 3].copy_from_slice(&self.frame.encode::<T>(place));
        }
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let per = |capacity: usize, length: usize| capacity * length * size_of::<T>();
        per(self.kinematic.capacity(), kinematic::LEN)
            + per(self.force.capacity(), force::LEN)
            + per(self.extra.capacity(), extra::LEN)
            + per(self.corrected.capacity(), CORRECTED_LEN)
            + per(self.hourglass.capacity(), hourglass::LEN)
            + size_of::<Vector<f64>>() * (self.ghost_places.capacity() + self.places.capacity())
    }
}
