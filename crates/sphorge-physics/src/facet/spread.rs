//! How a polygon spreads about its centre, and the quadrature that follows from that.

use super::clip::{Place, along, turn};
use crate::Elementary;

/// Points of Gauss's rule over an interval with a second moment of one about its middle, and their weights.
pub(super) const NODES: [(f64, f64); 3] =
    [(-1.341_640_786_499_874, 5.0 / 18.0), (0.0, 4.0 / 9.0), (1.341_640_786_499_874, 5.0 / 18.0)];

/// Least determinant of the second moments over the product of those along both axes: below it is rounding, in roundings.
const THINNEST: f64 = 16.0;

/// Mean second moments of a polygon about its centre, `Sigma = int r (x) r dA/A`, and their symmetric root `S`, `S S = Sigma`.
pub(super) struct Spread<T> {
    second: [Place<T>; 2],
    /// `S`.
    pub(super) root: [Place<T>; 2],
    /// Trace and determinant of `S`.
    trace: T,
    determinant: T,
}

impl<T: Elementary> Spread<T> {
    /// Of a polygon with these vertices, from its centre, anticlockwise, and that area.
    #[inline(always)]
    pub(super) fn of<const N: usize>(rays: &[Place<T>; N], area: T) -> Self {
        let (mut xx, mut xy, mut yy) = (T::zero(), T::zero(), T::zero());
        for k in 0..N {
            let (p, q) = (rays[k], rays[(k + 1) % N]);
            let twice = turn(p, q);
            xx += twice * (p[0] * p[0] + p[0] * q[0] + q[0] * q[0]);
            yy += twice * (p[1] * p[1] + p[1] * q[1] + q[1] * q[1]);
            xy += twice * ((p[0] * p[1] + q[0] * q[1]) + T::of(0.5) * (p[0] * q[1] + q[0] * p[1]));
        }
        let share = T::one() / (T::of(12.0) * area);
        let (xx, xy, yy) = (share * xx, share * xy, share * yy);
        // The root of the determinant, by ratios, since lengths of micrometres to the fourth power are no numbers of single precision.
        let both = xx.sqrt() * yy.sqrt();
        let cosine = xy / both;
        let determinant = both * (T::one() - cosine * cosine).max(T::of(THINNEST) * T::epsilon()).sqrt();
        let trace = (xx + yy + (determinant + determinant)).sqrt();
        let root = [[(xx + determinant) / trace, xy / trace], [xy / trace, (yy + determinant) / trace]];
        Self { second: [[xx, xy], [xy, yy]], root, trace, determinant }
    }

    /// The symmetric derivative by `Sigma` of what has that derivative, which need not be symmetric, by `S`: `Y` with `S Y + Y S = (G + G^T)/2`.
    #[inline(always)]
    pub(super) fn by_second(&self, by_root: &[Place<T>; 2]) -> [Place<T>; 2] {
        let half = T::of(0.5);
        let across = half * (by_root[0][1] + by_root[1][0]);
        let of = [[by_root[0][0], across], [across, by_root[1][1]]];
        let adjugate = [[self.root[1][1], -self.root[0][1]], [-self.root[1][0], self.root[0][0]]];
        let product = |a: &[Place<T>; 2], b: &[Place<T>; 2]| {
            [0, 1].map(|i: usize| [0, 1].map(|j: usize| along(a[i], [b[0][j], b[1][j]])))
        };
        let turned = product(&product(&adjugate, &of), &adjugate);
        let share = half / self.trace;
        [0, 1].map(|i: usize| [0, 1].map(|j: usize| share * (of[i][j] + turned[i][j] / self.determinant)))
    }

    /// `Y : Sigma`.
    #[inline(always)]
    pub(super) fn contracted(&self, by_second: &[Place<T>; 2]) -> T {
        along(by_second[0], self.second[0]) + along(by_second[1], self.second[1])
    }

    /// The derivative by an anticlockwise turn of the nodes, of what has that derivative by `S`.
    #[inline(always)]
    pub(super) fn by_turn(&self, by_root: &[Place<T>; 2]) -> T {
        (0..2).fold(T::zero(), |sum, i| sum + (self.root[i][1] * by_root[i][0] - self.root[i][0] * by_root[i][1]))
    }
}
