//! What a pair sum reads of a neighbour, one record per particle, so that a neighbour costs one or two cache lines.

use crate::lanes::PairScalar;
use crate::neighbors::Frame;

/// Entries of a kinematic record.
pub(super) mod kinematic {
    pub(crate) const X: usize = 0;
    /// Weight of the neighbour in a gradient sum.
    pub(crate) const WEIGHT: usize = 3;
    pub(crate) const V: usize = 4;
    /// Smoothing length.
    pub(crate) const H: usize = 7;
    pub(crate) const LEN: usize = 8;
}

/// Entries of a force record.
pub(super) mod force {
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
}

/// Entries of an extra record, read only when artificial stress or the Balsara switch is on.
pub(super) mod extra {
    /// Scaled artificial stress xx, yy, zz, xy, yz, xz.
    pub(crate) const R: usize = 0;
    /// Balsara factor.
    pub(crate) const BALSARA: usize = 6;
    pub(crate) const LEN: usize = 8;
}

/// Entries of a corrected record: the scaled stress times the gradient correction, row by row; not symmetric.
pub(super) const CORRECTED_LEN: usize = 9;

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
    pub(super) hourglass: Vec<super::hourglass::HourglassRecord<T>>,
    pub(super) frame: Frame,
}

impl<T: PairScalar> Records<T> {
    /// Makes room for `count` particles and ghosts.
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

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let per = |capacity: usize, length: usize| capacity * length * size_of::<T>();
        per(self.kinematic.capacity(), kinematic::LEN)
            + per(self.force.capacity(), force::LEN)
            + per(self.extra.capacity(), extra::LEN)
            + per(self.corrected.capacity(), CORRECTED_LEN)
            + per(self.hourglass.capacity(), 16)
    }
}
