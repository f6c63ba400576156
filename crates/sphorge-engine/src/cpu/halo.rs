//! Ghost particles: mirror images behind symmetry planes and copies beyond periodic ends.
//!
//! A ghost repeats its source with a sign and a shift per axis. Stages that sum over neighbours see ghosts as particles;
//! `exchange` fills what they read. A domain decomposition fills the same records from other ranks.

use super::records::{Records, extra, force, kinematic};
use crate::lanes::PairScalar;
use crate::model::{Model, SymmetryPlane};
use sphorge_physics::Vector;

/// One ghost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ghost {
    pub(super) source: u32,
    /// +1, or -1 along axes it is mirrored on.
    pub(super) sign: Vector<f64>,
    pub(super) shift: Vector<f64>,
}

impl Ghost {
    /// Position of the ghost when its source is at `p`.
    #[inline(always)]
    pub(super) fn position(&self, p: &Vector<f64>) -> Vector<f64> {
        [0, 1, 2].map(|a| self.sign[a] * p[a] + self.shift[a])
    }
}

/// The planes and periodic axes of a model, and the ghosts they make.
#[derive(Clone, Debug, Default)]
pub(super) struct Halo {
    symmetry: Vec<SymmetryPlane>,
    periodic: [Option<(f64, f64)>; 3],
    pub(super) ghosts: Vec<Ghost>,
    /// Ghosts before the last rebuilding.
    former: Vec<Ghost>,
}

impl Halo {
    pub(super) fn new(model: &Model) -> Self {
        Self { symmetry: model.symmetry.clone(), periodic: model.periodic, ..Self::default() }
    }

    /// No planes and no periodic axes.
    pub(super) fn is_empty(&self) -> bool {
        self.symmetry.is_empty() && self.periodic.iter().all(Option::is_none)
    }

    /// How far outside the particles a ghost may stand beyond the reach it was made for, m.
    pub(super) fn longest_shift(&self) -> f64 {
        self.periodic.iter().flatten().fold(0.0, |longest: f64, (low, high)| longest.max(high - low))
    }

    /// Brings particles that left a periodic cell back in; says whether there were any.
    pub(super) fn wrap(&self, positions: &mut [Vector<f64>]) -> bool {
        let mut left = false;
        for (axis, cell) in self.periodic.iter().enumerate() {
            let Some((low, high)) = *cell else { continue };
            for p in positions.iter_mut() {
                if p[axis] < low || p[axis] >= high {
                    p[axis] = low + (p[axis] - low).rem_euclid(high - low);
                    left = true;
                }
            }
        }
        left
    }

    /// Makes the ghosts of all particles within `reach` of a plane or an end; later axes also repeat earlier ghosts, which
    /// fills edges and corners. Says whether they are others than before: then their numbers mean other points.
    pub(super) fn rebuild(&mut self, positions: &[Vector<f64>], reach: f64) -> bool {
        std::mem::swap(&mut self.ghosts, &mut self.former);
        self.ghosts.clear();
        for axis in 0..3 {
            let before = self.ghosts.len();
            let mut images: [Option<(f64, f64, f64, f64)>; 2] = [None; 2];
            // Each image: sign, shift, and the interval of source coordinates that need it.
            if let Some((low, high)) = self.periodic[axis] {
                let length = high - low;
                images = [
                    Some((1.0, length, f64::NEG_INFINITY, low + reach)),
                    Some((1.0, -length, high - reach, f64::INFINITY)),
                ];
            }
            let planes = self.symmetry.iter().filter(|s| s.axis == axis);
            for (image, plane) in images.iter_mut().filter(|i| i.is_none()).zip(planes) {
                let p = plane.position;
                // A particle on the plane is its own image.
                let skip = 1e-9 * reach;
                *image = Some(if plane.side > 0.0 {
                    (-1.0, 2.0 * p, p + skip, p + reach)
                } else {
                    (-1.0, 2.0 * p, p - reach, p - skip)
                });
            }
            for (sign, shift, first, last) in images.into_iter().flatten() {
                for (i, p) in positions.iter().enumerate() {
                    if p[axis] >= first && p[axis] <= last {
                        let mut ghost = Ghost { source: i as u32, sign: [1.0; 3], shift: [0.0; 3] };
                        ghost.sign[axis] = sign;
                        ghost.shift[axis] = shift;
                        self.ghosts.push(ghost);
                    }
                }
                for k in 0..before {
                    let mut ghost = self.ghosts[k];
                    let x = ghost.position(&positions[ghost.source as usize])[axis];
                    if x >= first && x <= last {
                        ghost.sign[axis] *= sign;
                        ghost.shift[axis] = sign * ghost.shift[axis] + shift;
                        self.ghosts.push(ghost);
                    }
                }
            }
        }
        self.ghosts != self.former
    }

    /// Fills the kinematic records of ghosts, which follow those of the `count` particles; `place` tells where a particle is.
    pub(super) fn exchange_kinematics<T: PairScalar>(
        &self,
        count: usize,
        place: impl Fn(usize) -> Vector<f64>,
        records: &mut Records<T>,
    ) {
        let frame = records.frame;
        let (own, ghosts) = records.kinematic.split_at_mut(count);
        for (ghost, record) in self.ghosts.iter().zip(ghosts) {
            let source = ghost.source as usize;
            *record = own[source];
            let x = frame.encode::<T>(&ghost.position(&place(source)));
            for a in 0..3 {
                record[kinematic::X + a] = x[a];
                record[kinematic::V + a] = record[kinematic::V + a] * T::of(ghost.sign[a]);
            }
        }
    }

    /// Fills the force records of ghosts.
    pub(super) fn exchange_stress<T: PairScalar>(&self, positions: &[Vector<f64>], records: &mut Records<T>) {
        let (count, frame) = (positions.len(), records.frame);
        // Axis pairs of the symmetric components xx, yy, zz, xy, yz, xz.
        const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
        for (k, ghost) in self.ghosts.iter().enumerate() {
            let source = ghost.source as usize;
            let sign = ghost.sign.map(T::of);
            let mut record = records.force[source];
            let x = frame.encode::<T>(&ghost.position(&positions[source]));
            for a in 0..3 {
                record[force::X + a] = x[a];
                record[force::V + a] = record[force::V + a] * sign[a];
            }
            for (c, (a, b)) in PAIRS.into_iter().enumerate() {
                record[force::S + c] = record[force::S + c] * sign[a] * sign[b];
            }
            records.force[count + k] = record;
            if !records.extra.is_empty() {
                let mut record = records.extra[source];
                for (c, (a, b)) in PAIRS.into_iter().enumerate() {
                    record[extra::R + c] = record[extra::R + c] * sign[a] * sign[b];
                }
                records.extra[count + k] = record;
            }
            if !records.corrected.is_empty() {
                let mut record = records.corrected[source];
                for (c, value) in record.iter_mut().enumerate() {
                    *value = *value * sign[c / 3] * sign[c % 3];
                }
                records.corrected[count + k] = record;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_planes_and_a_corner_make_three_images() {
        let plane = |axis| SymmetryPlane { axis, position: 0.0, side: 1.0 };
        let mut halo = Halo { symmetry: vec![plane(0), plane(1)], ..Halo::default() };
        let p = [0.2, 0.3, 5.0];
        assert!(halo.rebuild(&[p], 1.0) && !halo.rebuild(&[p], 1.0));
        let mut images: Vec<_> = halo.ghosts.iter().map(|g| g.position(&p)).collect();
        images.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(images, [[-0.2, -0.3, 5.0], [-0.2, 0.3, 5.0], [0.2, -0.3, 5.0]]);
    }

    #[test]
    fn periodic_copies_and_wrapping() {
        let mut halo = Halo { periodic: [Some((1.0, 3.0)), None, None], ..Halo::default() };
        let mut p = [[3.25, 0.0, 0.0], [0.5, 0.0, 0.0], [2.0, 0.0, 0.0]];
        assert!(halo.wrap(&mut p) && !halo.wrap(&mut p));
        assert_eq!(p, [[1.25, 0.0, 0.0], [2.5, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        assert!(halo.rebuild(&p, 0.6));
        let images: Vec<_> = halo.ghosts.iter().map(|g| (g.source, g.position(&p[g.source as usize])[0])).collect();
        assert_eq!(images, [(0, 3.25), (1, 0.5)]);
        // As many, of others.
        p.swap(1, 2);
        assert!(halo.rebuild(&p, 0.6));
        assert_eq!(halo.ghosts.len(), 2);
    }
}
