//! Vectors and second-order tensors in three dimensions. Plane strain and one-dimensional cases carry the full tensor.

use crate::{Numbers, Real};
use core::ops::{Add, Mul, Sub};

/// A vector `[x, y, z]`.
pub type Vector<T> = [T; 3];

/// A general second-order tensor, `t[a][b]` row by row.
pub type Tensor<T> = [[T; 3]; 3];

/// A symmetric second-order tensor, components in the order of VTK's symmetric tensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct SymmetricTensor<T> {
    /// Component 11.
    pub xx: T,
    /// Component 22.
    pub yy: T,
    /// Component 33.
    pub zz: T,
    /// Component 12.
    pub xy: T,
    /// Component 23.
    pub yz: T,
    /// Component 13.
    pub xz: T,
}

/// `a . b`.
#[inline(always)]
pub fn dot<T: Real>(a: Vector<T>, b: Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<T: Real> Numbers<T> for SymmetricTensor<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        let Self { xx, yy, zz, xy, yz, xz } = self;
        [xx, yy, zz, xy, yz, xz].into_iter().for_each(visit);
    }
    #[inline(always)]
    fn choose_lt(a: T, b: T, then: Self, otherwise: Self) -> Self {
        Self::from_array(Numbers::choose_lt(a, b, then.to_array(), otherwise.to_array()))
    }
}

impl<T: Real> SymmetricTensor<T> {
    /// All components zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::diagonal(T::zero(), T::zero(), T::zero())
    }

    /// A diagonal tensor.
    #[inline(always)]
    pub fn diagonal(xx: T, yy: T, zz: T) -> Self {
        let o = T::zero();
        Self { xx, yy, zz, xy: o, yz: o, xz: o }
    }

    /// `s I`.
    #[inline(always)]
    pub fn isotropic(s: T) -> Self {
        Self::diagonal(s, s, s)
    }

    /// Components as `[xx, yy, zz, xy, yz, xz]`.
    #[inline(always)]
    pub fn to_array(self) -> [T; 6] {
        [self.xx, self.yy, self.zz, self.xy, self.yz, self.xz]
    }

    /// From `[xx, yy, zz, xy, yz, xz]`.
    #[inline(always)]
    pub fn from_array(c: [T; 6]) -> Self {
        Self { xx: c[0], yy: c[1], zz: c[2], xy: c[3], yz: c[4], xz: c[5] }
    }

    /// As a general tensor.
    #[inline(always)]
    pub fn to_tensor(self) -> Tensor<T> {
        [[self.xx, self.xy, self.xz], [self.xy, self.yy, self.yz], [self.xz, self.yz, self.zz]]
    }

    /// Symmetric part `(t + t^T) / 2` of a general tensor.
    #[inline(always)]
    pub fn symmetric_part(t: &Tensor<T>) -> Self {
        let half = T::of(0.5);
        Self {
            xx: t[0][0],
            yy: t[1][1],
            zz: t[2][2],
            xy: half * (t[0][1] + t[1][0]),
            yz: half * (t[1][2] + t[2][1]),
            xz: half * (t[0][2] + t[2][0]),
        }
    }

    /// Trace.
    #[inline(always)]
    pub fn trace(self) -> T {
        self.xx + self.yy + self.zz
    }

    /// Deviatoric part, `t - tr(t)/3 I`.
    #[inline(always)]
    pub fn deviator(self) -> Self {
        self - Self::isotropic(self.trace() * T::of(1.0 / 3.0))
    }

    /// `a : b`.
    #[inline(always)]
    pub fn double_dot(self, b: Self) -> T {
        let shear = self.xy * b.xy + self.yz * b.yz + self.xz * b.xz;
        self.xx * b.xx + self.yy * b.yy + self.zz * b.zz + shear + shear
    }

    /// `t . v`.
    #[inline(always)]
    pub fn dot(self, v: Vector<T>) -> Vector<T> {
        [
            self.xx * v[0] + self.xy * v[1] + self.xz * v[2],
            self.xy * v[0] + self.yy * v[1] + self.yz * v[2],
            self.xz * v[0] + self.yz * v[1] + self.zz * v[2],
        ]
    }

    /// `q t q^T` for a general `q` (a rotation keeps the invariants).
    #[inline(always)]
    pub fn congruence(self, q: &Tensor<T>) -> Self {
        let t = self.to_tensor();
        let qt = multiply(q, &t);
        let r = |a: usize, b: usize| qt[a][0] * q[b][0] + qt[a][1] * q[b][1] + qt[a][2] * q[b][2];
        Self { xx: r(0, 0), yy: r(1, 1), zz: r(2, 2), xy: r(0, 1), yz: r(1, 2), xz: r(0, 2) }
    }
}

impl<T: Real> SymmetricTensor<T> {
    /// Von Mises equivalent `sqrt(3/2 S:S)` of a deviator.
    #[inline(always)]
    pub fn von_mises(self) -> T {
        (T::of(1.5) * self.double_dot(self)).sqrt()
    }
}

impl<T: Real> Add for SymmetricTensor<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self {
            xx: self.xx + b.xx,
            yy: self.yy + b.yy,
            zz: self.zz + b.zz,
            xy: self.xy + b.xy,
            yz: self.yz + b.yz,
            xz: self.xz + b.xz,
        }
    }
}

impl<T: Real> Sub for SymmetricTensor<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self + b * (-T::one())
    }
}

impl<T: Real> Mul<T> for SymmetricTensor<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: T) -> Self {
        Self { xx: self.xx * s, yy: self.yy * s, zz: self.zz * s, xy: self.xy * s, yz: self.yz * s, xz: self.xz * s }
    }
}

/// The zero tensor.
#[inline(always)]
pub fn zero<T: Real>() -> Tensor<T> {
    [[T::zero(); 3]; 3]
}

/// The unit tensor.
#[inline(always)]
pub fn identity<T: Real>() -> Tensor<T> {
    let (o, i) = (T::zero(), T::one());
    [[i, o, o], [o, i, o], [o, o, i]]
}

/// `a + s b`.
#[inline(always)]
pub fn plus<T: Real>(a: &Tensor<T>, s: T, b: &Tensor<T>) -> Tensor<T> {
    let mut sum = *a;
    for i in 0..3 {
        for j in 0..3 {
            sum[i][j] += s * b[i][j];
        }
    }
    sum
}

/// `a b`.
#[inline(always)]
pub fn multiply<T: Real>(a: &Tensor<T>, b: &Tensor<T>) -> Tensor<T> {
    let mut c = zero();
    for i in 0..3 {
        for j in 0..3 {
            c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        }
    }
    c
}

/// `a v`.
#[inline(always)]
pub fn apply<T: Real>(a: &Tensor<T>, v: Vector<T>) -> Vector<T> {
    [0, 1, 2].map(|i| a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2])
}

/// `a^T`.
#[inline(always)]
pub fn transpose<T: Real>(a: &Tensor<T>) -> Tensor<T> {
    let mut t = zero();
    for i in 0..3 {
        for j in 0..3 {
            t[i][j] = a[j][i];
        }
    }
    t
}

/// Determinant.
#[inline(always)]
pub fn determinant<T: Real>(a: &Tensor<T>) -> T {
    a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
        + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])
}

/// Inverse by cofactors; components are non-finite when `a` is singular.
#[inline(always)]
pub fn inverse<T: Real>(a: &Tensor<T>) -> Tensor<T> {
    let scale = T::one() / determinant(a);
    let mut inv = zero();
    for i in 0..3 {
        for j in 0..3 {
            let (r, s) = ((j + 1) % 3, (j + 2) % 3);
            let (u, v) = ((i + 1) % 3, (i + 2) % 3);
            inv[i][j] = (a[r][u] * a[s][v] - a[r][v] * a[s][u]) * scale;
        }
    }
    inv
}

/// Principal values of a symmetric tensor, the smallest first, by Jacobi's rotations.
pub fn principal_values(mut m: Tensor<f64>) -> [f64; 3] {
    for _ in 0..20 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q] == 0.0 {
                continue;
            }
            let (s, c) = (0.5 * (2.0 * m[p][q]).atan2(m[q][q] - m[p][p])).sin_cos();
            for row in &mut m {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let [of_p, of_q] = [m[p], m[q]];
            for a in 0..3 {
                (m[p][a], m[q][a]) = (c * of_p[a] - s * of_q[a], s * of_p[a] + c * of_q[a]);
            }
        }
    }
    let mut values = [m[0][0], m[1][1], m[2][2]];
    values.sort_by(f64::total_cmp);
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_tensor_is_identity() {
        let a = [[2.0, 1.0, -1.0], [0.5, 3.0, 2.0], [1.0, -2.0, 4.0f64]];
        let p = multiply(&a, &inverse(&a));
        for i in 0..3 {
            for j in 0..3 {
                assert!((p[i][j] - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn von_mises_of_uniaxial_and_shear_stress() {
        // Uniaxial sigma = 300: deviator (200, -100, -100), equivalent 300. Pure shear tau: sqrt(3) tau.
        let uniaxial = SymmetricTensor::diagonal(300.0, 0.0, 0.0).deviator();
        assert!((uniaxial.von_mises() - 300.0).abs() < 1e-12);
        let shear = SymmetricTensor { xy: 10.0, ..SymmetricTensor::zero() };
        assert!((shear.von_mises() - 300f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_symmetric_tensor_times_a_vector_by_hand() {
        let t = SymmetricTensor { xx: 2.0, yy: 3.0, zz: 5.0, xy: 7.0, yz: 11.0, xz: 13.0f64 };
        // (2 17 + 7 19 + 13 23, 7 17 + 3 19 + 11 23, 13 17 + 11 19 + 5 23).
        assert_eq!(t.dot([17.0, 19.0, 23.0]), [466.0, 429.0, 545.0]);
    }

    #[test]
    fn congruence_with_a_quarter_turn_swaps_axes() {
        // Turning about z by 90 degrees carries the x axis to y.
        let q = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0f64]];
        let t = SymmetricTensor { xx: 1.0, yy: 2.0, zz: 3.0, xy: 4.0, yz: 5.0, xz: 6.0 };
        let r = t.congruence(&q);
        assert_eq!(r, SymmetricTensor { xx: 2.0, yy: 1.0, zz: 3.0, xy: -4.0, yz: 6.0, xz: -5.0 });
    }

    #[test]
    fn principal_values_have_trace_and_determinant_and_are_sorted() {
        // det = 5 (12 - 1) - 2 (6 + 0.3) + 0.3 (-2 - 1.2).
        let turned = principal_values([[5.0, 2.0, 0.3], [2.0, 4.0, -1.0], [0.3, -1.0, 3.0]]);
        let (trace, determinant) = (turned.iter().sum::<f64>(), turned.iter().product::<f64>());
        assert!((trace - 12.0).abs() < 1e-12 && (determinant - 41.44).abs() < 1e-10, "{turned:?}");
        assert!(turned.is_sorted() && turned[0] > 0.0);
        assert_eq!(principal_values([[3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]]), [1.0, 2.0, 3.0]);
    }
}
