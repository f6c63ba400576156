//! Principal values and directions of a symmetric tensor.

use crate::tensor::identity;
use crate::{Scalar, SymmetricTensor, Tensor};

/// Principal values and their directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalFrame<T> {
    /// Principal values, in no particular order.
    pub values: [T; 3],
    /// `directions[a][k]` is component `a` of the unit vector that belongs to `values[k]`.
    pub directions: Tensor<T>,
}

/// Sweeps after which the frame is taken as it is; convergence is quadratic, four reach round-off.
const MAXIMUM_SWEEPS: u32 = 8;

/// Principal frame by cyclic Jacobi rotations (Golub & Van Loan, *Matrix Computations*, 8.5). Values are exact to
/// round-off of the largest; directions are orthonormal to round-off even where values coincide.
pub fn principal_frame<T: Scalar>(t: SymmetricTensor<T>) -> PrincipalFrame<T> {
    let mut a = t.to_tensor();
    let mut v = identity();
    let size = a[0][0].abs() + a[1][1].abs() + a[2][2].abs();
    let mut sweep = 0;
    let mut searching = true;
    while searching {
        let off = a[0][1].abs() + a[0][2].abs() + a[1][2].abs();
        searching = off > T::of(0.1) * T::epsilon() * (size + off) && sweep < MAXIMUM_SWEEPS;
        if searching {
            rotate_away(&mut a, &mut v, 0, 1, 2);
            rotate_away(&mut a, &mut v, 0, 2, 1);
            rotate_away(&mut a, &mut v, 1, 2, 0);
            sweep += 1;
        }
    }
    PrincipalFrame { values: [a[0][0], a[1][1], a[2][2]], directions: v }
}

/// Turns the plane of axes `p` and `q` so that `a[p][q]` vanishes; `r` is the third axis.
#[inline(always)]
fn rotate_away<T: Scalar>(a: &mut Tensor<T>, v: &mut Tensor<T>, p: usize, q: usize, r: usize) {
    let shear = a[p][q];
    if shear.abs() > T::zero() {
        let theta = (a[q][q] - a[p][p]) / (shear + shear);
        let mut t = T::one() / (theta.abs() + (theta * theta + T::one()).sqrt());
        if theta < T::zero() {
            t = -t;
        }
        let c = T::one() / (t * t + T::one()).sqrt();
        let s = t * c;
        a[p][p] -= t * shear;
        a[q][q] += t * shear;
        a[p][q] = T::zero();
        a[q][p] = T::zero();
        let (rp, rq) = (a[r][p], a[r][q]);
        a[r][p] = c * rp - s * rq;
        a[r][q] = s * rp + c * rq;
        a[p][r] = a[r][p];
        a[q][r] = a[r][q];
        for k in 0..3 {
            let (kp, kq) = (v[k][p], v[k][q]);
            v[k][p] = c * kp - s * kq;
            v[k][q] = s * kp + c * kq;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::{multiply, transpose};

    #[test]
    fn values_and_directions_rebuild_the_tensor() {
        for t in [
            SymmetricTensor { xx: 1.0e9f64, yy: -2.0e9, zz: 0.5e9, xy: 0.7e9, yz: -1.1e9, xz: 0.3e9 },
            SymmetricTensor { xx: 1.0, yy: 1.0, zz: 1.0, xy: 1e-9, yz: 0.0, xz: 0.0 },
            SymmetricTensor { xx: 0.0, yy: 0.0, zz: 0.0, xy: 1.0, yz: 1.0, xz: 1.0 },
            SymmetricTensor { xx: 1.0e12, yy: 1.0, zz: -1.0e-6, xy: 3.0e5, yz: 2.0, xz: -4.0 },
            SymmetricTensor::zero(),
        ] {
            let frame = principal_frame(t);
            let v = frame.directions;
            let [x, y, z] = frame.values;
            let rebuilt = SymmetricTensor::diagonal(x, y, z).congruence(&v);
            let size = t.double_dot(t).sqrt();
            let difference = rebuilt - t;
            assert!(difference.double_dot(difference).sqrt() <= 2e-15 * size, "{t:?}: {rebuilt:?}");
            let unit = multiply(&transpose(&v), &v);
            for i in 0..3 {
                for j in 0..3 {
                    assert!((unit[i][j] - f64::from(u8::from(i == j))).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn values_by_hand() {
        // [[2, 1], [1, 2]] has 1 and 3; all shears 1 on a zero diagonal has 2, -1, -1.
        let mut values =
            principal_frame(SymmetricTensor { xx: 2.0, yy: 2.0, zz: 7.0, xy: 1.0, yz: 0.0, xz: 0.0f64 }).values;
        values.sort_by(f64::total_cmp);
        for (got, want) in values.iter().zip([1.0, 3.0, 7.0]) {
            assert!((got - want).abs() < 1e-14);
        }
        let shears = SymmetricTensor { xy: 1.0f32, yz: 1.0, xz: 1.0, ..SymmetricTensor::zero() };
        let mut values = principal_frame(shears).values;
        values.sort_by(f32::total_cmp);
        for (got, want) in values.iter().zip([-1.0, -1.0, 2.0]) {
            assert!((got - want).abs() < 1e-6);
        }
    }
}
