//! Gradients that are exact for quadratic fields at faces, in the reference configuration of the total Lagrangian form.
//!
//! The corrected sum `G_i[f] = sum_j V_j (f_j - f_i) ⊗ B_i grad_0 W_ij` is exact for linear fields. Of a field with the second
//! gradient `H`, with `X = X_j - X_i` and the slopes `s_ij = V_j B_i grad_0 W_ij`, it is too large by
//!
//! `E_i = (1/2) H : T_i`,  `T_i = sum_j X ⊗ X ⊗ s_ij`.
//!
//! `T` is zero where neighbours are on all sides, and some `h` at a face. There `H` is estimated from how the sums themselves change
//! from neighbour to neighbour, by a linear fit with the weights `w_j = q^4 (k - q)`, `q = |X|/h`, `k` the support over `h`:
//!
//! `Q_i = sum_j (G_j - G_i) ⊗ q_ij`,  `q_ij = w_j M^-1 X`,  `M = sum_j w_j X ⊗ X`.
//!
//! As the `G_j` miss something, too, `Q` is not `H` but a linear function of it, `Q = A_i H`, and so is what is to be subtracted,
//!
//! `E_i = K_i : Q_i`,  `K_i = (1/2) T_i A_i^+`.
//!
//! `K_i` and `q_ij` depend on the reference configuration alone. The pseudo-inverse `A^+` leaves out what the neighbours do not tell,
//! such as the curvature across a body of two layers, which has no more than one difference there.
//!
//! The sums are linear in the field, and the force is the transpose of them all: with the stress `P_i` that works on the exact gradient
//! `F_i = G_i - E_i`, the stress that works on `G_i` is
//!
//! `P'_i = P_i + R_i . sum_j q_ij - sum_j (V_j/V_i) R_j . q_ji`,  `R_i = P_i : K_i`,
//!
//! so that momentum, angular momentum and energy are conserved as with the plain sums. Distant neighbours count in the fit because what
//! is then taken from near ones is less: the fastest vibration of a free face is 1.3 times that of plain sums instead of 1.6 times with the
//! weights of the kernel gradient.

use crate::tensor::inverse;
use crate::{Dimension, Real, Tensor, Vector};

/// A tensor of third order; the last index is that of the slope or of the fit.
pub type ThirdOrder<T = f64> = [[[T; 3]; 3]; 3];

/// Largest component of `T` over the smoothing length that is none of a face. In a lattice with smoothing 1.1 it is 0.87 in the
/// outermost layer, 0.032 in the one below and 0 further inside.
pub const LEAST_MOMENT: f64 = 0.05;

/// Singular values of `A` below which the neighbours do not tell a component of the second gradient: they are at least 0.37 in bodies of
/// three layers, 0.6 in others, and 0 in one of two.
const LEAST_SINGULAR_VALUE: f64 = 0.25;

/// Largest component of `M^-1` over the inverse of its mean principal value.
const LARGEST_INVERSE: f64 = 30.0;

/// `T_i` of the neighbours with these distances `X_j - X_i` (m) and slopes (1/m), m.
pub fn second_moment(neighbors: impl Iterator<Item = (Vector<f64>, Vector<f64>)>) -> ThirdOrder {
    let mut moment = [[[0.0; 3]; 3]; 3];
    for (x, slope) in neighbors {
        for a in 0..3 {
            for b in 0..3 {
                for c in 0..3 {
                    moment[a][b][c] += x[a] * x[b] * slope[c];
                }
            }
        }
    }
    moment
}

/// Whether a particle of this second moment (m) and smoothing length (m) is at a face.
pub fn is_at_face(moment: &ThirdOrder, smoothing_length: f64) -> bool {
    let largest = moment.as_flattened().as_flattened().iter().fold(0.0, |most: f64, t| most.max(t.abs()));
    largest > LEAST_MOMENT * smoothing_length
}

/// Weight in the fit of a neighbour at the distance `q` in smoothing lengths, with the support `support` of the kernel.
pub fn weight_in_fit(q: f64, support: f64) -> f64 {
    q * q * q * q * (support - q).max(0.0)
}

/// The `q_ij` (1/m) of the neighbours with these distances (m) and [weights](weight_in_fit), if there is such a fit.
pub fn fit(neighbors: &[(Vector<f64>, f64)], dimension: Dimension) -> Option<Vec<Vector<f64>>> {
    let count = dimension.count();
    let mut m = [[0.0; 3]; 3];
    for (x, weight) in neighbors {
        for a in 0..count {
            for b in 0..count {
                m[a][b] += weight * x[a] * x[b];
            }
        }
    }
    let mean = (0..count).map(|a| m[a][a]).sum::<f64>() / count as f64;
    for (a, row) in m.iter_mut().enumerate().skip(count) {
        row[a] = mean;
    }
    let inverse = inverse(&m);
    let is_bounded = |c: &f64| (c * mean).abs() < LARGEST_INVERSE;
    if !inverse.as_flattened().iter().all(is_bounded) {
        return None;
    }
    let of = |(x, weight): &(Vector<f64>, f64)| {
        [0, 1, 2].map(|a| weight * (inverse[a][0] * x[0] + inverse[a][1] * x[1] + inverse[a][2] * x[2]))
    };
    Some(neighbors.iter().map(of).collect())
}

/// What a neighbour contributes to `A`.
pub struct FitNeighbor<'a> {
    /// `X_j - X_i`, m.
    pub x: Vector<f64>,
    /// `q_ij`, 1/m.
    pub q: Vector<f64>,
    /// `T_j`, m.
    pub moment: &'a ThirdOrder,
}

/// Second gradients are symmetric: their components, along the axes computed in.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (0, 1), (2, 2), (1, 2), (0, 2)];

/// `K_i`, m, `[b][c][d]` of `E_ab = sum_cd K_bcd Q_acd`, of a particle with the second moment `T_i` (m).
pub fn contraction<'a>(
    own: &ThirdOrder,
    neighbors: impl Iterator<Item = FitNeighbor<'a>>,
    dimension: Dimension,
) -> ThirdOrder {
    let d = dimension.count();
    let pairs = &PAIRS[..d * (d + 1) / 2];
    // Half of `H : T` for each component of `H`.
    let excess = |moment: &ThirdOrder, (a, b): (usize, usize)| -> Vector<f64> {
        let twice = if a == b { moment[a][a] } else { [0, 1, 2].map(|c| moment[a][b][c] + moment[b][a][c]) };
        twice.map(|t| 0.5 * t)
    };
    let of_own: Vec<Vector<f64>> = pairs.iter().map(|&pair| excess(own, pair)).collect();
    // Q for each component of H.
    let mut a = [[[0.0; 3]; 3]; 6];
    for neighbor in neighbors {
        for ((q, &(p, r)), own) in a.iter_mut().zip(pairs).zip(&of_own) {
            let mut difference = excess(neighbor.moment, (p, r));
            (0..3).for_each(|c| difference[c] -= own[c]);
            difference[p] += neighbor.x[r];
            if p != r {
                difference[r] += neighbor.x[p];
            }
            for c in 0..d {
                for e in 0..d {
                    q[c][e] += difference[c] * neighbor.q[e];
                }
            }
        }
    }
    let product = |one: &Tensor<f64>, other: &Tensor<f64>| {
        one.as_flattened().iter().zip(other.as_flattened()).map(|(a, b)| a * b).sum::<f64>()
    };
    let n = pairs.len();
    let mut normal = [[0.0; 6]; 6];
    for p in 0..n {
        for q in 0..n {
            normal[p][q] = product(&a[p], &a[q]);
        }
    }
    let (values, vectors) = principal_axes(normal, n);
    let mut k = [[[0.0; 3]; 3]; 3];
    for axis in (0..n).filter(|&axis| values[axis] > LEAST_SINGULAR_VALUE * LEAST_SINGULAR_VALUE) {
        // Of A^+ = sum over axes of v (A v)^T/value.
        let (mut image, mut missed) = ([[0.0; 3]; 3], [0.0; 3]);
        for p in 0..n {
            for c in 0..d {
                missed[c] += vectors[p][axis] * of_own[p][c];
                for e in 0..d {
                    image[c][e] += vectors[p][axis] * a[p][c][e];
                }
            }
        }
        for b in 0..d {
            for c in 0..d {
                for e in 0..d {
                    k[b][c][e] += missed[b] * image[c][e] / values[axis];
                }
            }
        }
    }
    k
}

/// Principal values of the first `n` rows and columns of a symmetric matrix, and its principal axes as columns, by Jacobi's rotations.
fn principal_axes(mut m: [[f64; 6]; 6], n: usize) -> ([f64; 6], [[f64; 6]; 6]) {
    let mut axes = [[0.0; 6]; 6];
    (0..6).for_each(|a| axes[a][a] = 1.0);
    for _ in 0..30 {
        for p in 0..n {
            for q in 0..p {
                if m[p][q].abs() <= 1e-15 * (m[p][p].abs() + m[q][q].abs()) {
                    continue;
                }
                let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
                let t = theta.signum() / (theta.abs() + (1.0 + theta * theta).sqrt());
                let c = 1.0 / (1.0 + t * t).sqrt();
                let s = t * c;
                for k in 0..n {
                    (m[k][p], m[k][q]) = (c * m[k][p] - s * m[k][q], s * m[k][p] + c * m[k][q]);
                }
                for k in 0..n {
                    (m[p][k], m[q][k]) = (c * m[p][k] - s * m[q][k], s * m[p][k] + c * m[q][k]);
                }
                for row in axes.iter_mut().take(n) {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
            }
        }
    }
    ([0, 1, 2, 3, 4, 5].map(|a| m[a][a]), axes)
}

/// `Q_i`, `[a][c][d]`, a neighbour at a time: `(G_j - G_i) ⊗ q_ij`.
#[inline(always)]
pub fn add_difference<T: Real, const D: usize>(
    sum: &mut ThirdOrder<T>,
    own: &Tensor<T>,
    other: &Tensor<T>,
    q: &Vector<T>,
) {
    for a in 0..D {
        for c in 0..D {
            let difference = other[a][c] - own[a][c];
            for e in 0..D {
                sum[a][c][e] += difference * q[e];
            }
        }
    }
}

/// `E_i = K_i : Q_i`.
#[inline(always)]
pub fn excess<T: Real, const D: usize>(k: &ThirdOrder<T>, sum: &ThirdOrder<T>) -> Tensor<T> {
    let mut excess = [[T::zero(); 3]; 3];
    for a in 0..D {
        for b in 0..D {
            for c in 0..D {
                for e in 0..D {
                    excess[a][b] += k[b][c][e] * sum[a][c][e];
                }
            }
        }
    }
    excess
}

/// `R_i = P_i : K_i`, `[a][c][d]`.
#[inline(always)]
pub fn spread<T: Real, const D: usize>(p: &Tensor<T>, k: &ThirdOrder<T>) -> ThirdOrder<T> {
    let mut spread = [[[T::zero(); 3]; 3]; 3];
    for a in 0..D {
        for b in 0..D {
            for c in 0..D {
                for e in 0..D {
                    spread[a][c][e] += p[a][b] * k[b][c][e];
                }
            }
        }
    }
    spread
}

/// `R . q`.
#[inline(always)]
pub fn along<T: Real, const D: usize>(spread: &ThirdOrder<T>, q: &Vector<T>) -> Tensor<T> {
    let mut stress = [[T::zero(); 3]; 3];
    for a in 0..D {
        for c in 0..D {
            for e in 0..D {
                stress[a][c] += spread[a][c][e] * q[e];
            }
        }
    }
    stress
}

/// `P : E`, Pa/s: the power of a stress, Pa, at a rate of deformation, 1/s.
#[inline(always)]
pub fn power<T: Real, const D: usize>(p: &Tensor<T>, rate: &Tensor<T>) -> T {
    let mut sum = T::zero();
    for k in 0..D {
        for l in 0..D {
            sum += p[k][l] * rate[k][l];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradient_correction::{LARGEST_COMPONENT, gradient_correction};
    use crate::tensor::{dot, plus, zero};
    use crate::test_cloud::{Cloud, Noise};

    const PLANE_AND_SPACE: [Dimension; 2] = [Dimension::Two, Dimension::Three];

    /// A lattice of spacing 0.1.
    fn lattice(dimension: Dimension, count: [usize; 3]) -> Cloud {
        let mut x = Vec::new();
        for i in 0..count[0] {
            for j in 0..count[1] {
                for k in 0..count[2] {
                    x.push([i, j, k].map(|n| 0.1 * n as f64));
                }
            }
        }
        let volume = vec![0.1f64.powi(dimension.count() as i32); x.len()];
        Cloud { dimension, h: 0.11, x, volume }
    }

    /// A body with the terms of its faces.
    struct Body {
        cloud: Cloud,
        slopes: Vec<Vec<(usize, Vector<f64>)>>,
        /// `q_ij` and `K_i`, where a particle is at a face.
        faces: Vec<Option<(Vec<Vector<f64>>, ThirdOrder)>>,
    }

    impl Body {
        fn new(cloud: Cloud) -> Self {
            let h = cloud.h;
            Self::with(cloud, |moment| is_at_face(moment, h))
        }

        fn with(cloud: Cloud, is_at_face: impl Fn(&ThirdOrder) -> bool) -> Self {
            let slopes: Vec<_> = (0..cloud.count()).map(|i| slopes(&cloud, i)).collect();
            let apart = |i: usize, j: usize| [0, 1, 2].map(|a| cloud.x[j][a] - cloud.x[i][a]);
            let moment = |i: usize| second_moment(slopes[i].iter().map(|(j, slope)| (apart(i, *j), *slope)));
            let moments: Vec<ThirdOrder> = (0..cloud.count()).map(moment).collect();
            let face = |i: usize| {
                let weighted = |(j, _): &(usize, Vector<f64>)| {
                    let x = apart(i, *j);
                    (x, weight_in_fit(dot(x, x).sqrt() / cloud.h, 2.0))
                };
                let fitted = fit(&slopes[i].iter().map(weighted).collect::<Vec<_>>(), cloud.dimension).unwrap();
                let neighbors = slopes[i].iter().zip(&fitted);
                let neighbors =
                    neighbors.map(|((j, _), q)| FitNeighbor { x: apart(i, *j), q: *q, moment: &moments[*j] });
                let k = contraction(&moments[i], neighbors, cloud.dimension);
                (fitted, k)
            };
            let at_face = |i: usize| is_at_face(&moments[i]).then(|| face(i));
            let faces = (0..cloud.count()).map(at_face).collect();
            Self { cloud, slopes, faces }
        }

        /// `G_i` of a vector field.
        fn sums(&self, v: &[Vector<f64>]) -> Vec<Tensor<f64>> {
            let sum = |i: usize| {
                let mut g = zero();
                for (j, slope) in &self.slopes[i] {
                    for a in 0..3 {
                        for b in 0..3 {
                            g[a][b] += (v[*j][a] - v[i][a]) * slope[b];
                        }
                    }
                }
                g
            };
            (0..v.len()).map(sum).collect()
        }

        /// `F_i` of the sums.
        fn exact(&self, g: &[Tensor<f64>]) -> Vec<Tensor<f64>> {
            let of = |i: usize| match &self.faces[i] {
                None => g[i],
                Some((q, k)) => {
                    let mut sum = [[[0.0; 3]; 3]; 3];
                    for ((j, _), q) in self.slopes[i].iter().zip(q) {
                        add_difference::<f64, 3>(&mut sum, &g[i], &g[*j], q);
                    }
                    plus(&g[i], -1.0, &excess::<f64, 3>(k, &sum))
                }
            };
            (0..g.len()).map(of).collect()
        }

        /// The stresses that work on the sums, of those that work on `F_i`.
        fn transposed(&self, p: &[Tensor<f64>]) -> Vec<Tensor<f64>> {
            let mut of = p.to_vec();
            for (i, face) in self.faces.iter().enumerate() {
                let Some((q, k)) = face else { continue };
                let r = spread::<f64, 3>(&p[i], k);
                for ((j, _), q) in self.slopes[i].iter().zip(q) {
                    let along = along::<f64, 3>(&r, q);
                    of[i] = plus(&of[i], 1.0, &along);
                    of[*j] = plus(&of[*j], -self.cloud.volume[i] / self.cloud.volume[*j], &along);
                }
            }
            of
        }
    }

    /// `s_ij` of the neighbours of a particle.
    fn slopes(cloud: &Cloud, i: usize) -> Vec<(usize, Vector<f64>)> {
        let near: Vec<usize> = (0..cloud.count()).filter(|&j| j != i && cloud.w(i, j) > 0.0).collect();
        let mut moment = zero();
        for &j in &near {
            let (x, slope) = (cloud.x_ij(i, j), cloud.grad_w(i, j));
            for a in 0..3 {
                for b in 0..3 {
                    moment[a][b] -= cloud.volume[j] * x[a] * slope[b];
                }
            }
        }
        let b = gradient_correction(&moment, cloud.dimension, LARGEST_COMPONENT);
        let slope = |&j: &usize| {
            let g = cloud.grad_w(i, j).map(|g| cloud.volume[j] * g);
            (j, crate::tensor::apply(&b, g))
        };
        near.iter().map(slope).collect()
    }

    /// A quadratic field with different second derivatives everywhere, and its gradient.
    fn field(x: &Vector<f64>, d: usize) -> (Vector<f64>, Tensor<f64>) {
        let (mut v, mut gradient) = ([0.0; 3], zero());
        for a in 0..d {
            for b in 0..d {
                let slope = (3 * a + b) as f64 - 4.0;
                v[a] += slope * x[b];
                gradient[a][b] += slope;
                for c in 0..d {
                    let curvature = (a + 2 * b * b + 3 * c) as f64 - 2.5;
                    v[a] += curvature * x[b] * x[c];
                    gradient[a][b] += curvature * x[c];
                    gradient[a][c] += curvature * x[b];
                }
            }
        }
        (v, gradient)
    }

    /// Largest error of the gradient of that field, with the sums as they are and without what faces take.
    fn errors(body: &Body) -> (f64, f64) {
        let d = body.cloud.dimension.count();
        let of: Vec<_> = body.cloud.x.iter().map(|x| field(x, d)).collect();
        let g = body.sums(&of.iter().map(|(v, _)| *v).collect::<Vec<_>>());
        let largest = |found: &[Tensor<f64>]| {
            let pairs = found.iter().zip(&of).flat_map(|(f, (_, right))| {
                f.as_flattened().iter().zip(right.as_flattened()).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>()
            });
            pairs.fold(0.0, f64::max)
        };
        (largest(&g), largest(&body.exact(&g)))
    }

    #[test]
    fn gradients_of_quadratic_fields_are_exact_at_faces_edges_and_corners() {
        let counts = [(Dimension::Two, [7, 6, 1]), (Dimension::Two, [3, 8, 1]), (Dimension::Three, [6, 5, 5])];
        let lattices = counts.into_iter().chain([(Dimension::Three, [5, 6, 3])]).map(|(d, count)| lattice(d, count));
        for cloud in lattices.chain([Cloud::block(Dimension::Two), Cloud::block(Dimension::Three)]) {
            let name = format!("{:?}, {} particles", cloud.dimension, cloud.count());
            let (plain, exact) = errors(&Body::with(cloud, |_| true));
            assert!(plain > 0.3 && exact < 1e-10, "{name}: {plain} {exact}");
        }
        for (dimension, count) in counts {
            // What is left below the outermost layer, which is not taken for a face.
            let body = Body::new(lattice(dimension, count));
            let (plain, exact) = errors(&body);
            assert!(exact > 0.0 && exact < 0.05 * plain, "{count:?}: {plain} {exact}");
            let outermost =
                |x: &Vector<f64>| (0..dimension.count()).any(|a| x[a] < 0.05 || x[a] > 0.1 * count[a] as f64 - 0.15);
            for (x, face) in body.cloud.x.iter().zip(&body.faces) {
                assert_eq!(face.is_some(), outermost(x), "{x:?}");
            }
        }
    }

    /// Two layers tell no curvature across: that of what is bent along them is exact, and nothing is made of the other.
    #[test]
    fn what_two_layers_do_not_tell_is_left_alone() {
        let body = Body::new(lattice(Dimension::Two, [8, 2, 1]));
        let of = |field: fn(&Vector<f64>) -> Vector<f64>| {
            let g = body.sums(&body.cloud.x.iter().map(field).collect::<Vec<_>>());
            (body.exact(&g), g)
        };
        let (bent, _) = of(|x| [-x[0] * x[1], 0.5 * x[0] * x[0], 0.0]);
        let (across, plain) = of(|x| [0.0, 0.5 * x[1] * x[1], 0.0]);
        for (i, x) in body.cloud.x.iter().enumerate() {
            let right = [[-x[1], -x[0], 0.0], [x[0], 0.0, 0.0], [0.0; 3]];
            for (found, right) in [(&bent[i], &right), (&across[i], &plain[i])] {
                for (a, b) in found.as_flattened().iter().zip(right.as_flattened()) {
                    assert!((a - b).abs() < 1e-12, "{x:?}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn the_stress_that_works_on_the_sums_is_the_transpose() {
        for dimension in PLANE_AND_SPACE {
            let body = Body::new(Cloud::block(dimension));
            let mut noise = Noise::new(3);
            let d = dimension.count();
            let v: Vec<Vector<f64>> =
                (0..body.cloud.count()).map(|_| [0, 1, 2].map(|a| if a < d { noise.next() } else { 0.0 })).collect();
            let p: Vec<Tensor<f64>> =
                v.iter().map(|_| [0, 1, 2].map(|_| [noise.next(), noise.next(), noise.next()])).collect();
            let g = body.sums(&v);
            let power = |p: &[Tensor<f64>], f: &[Tensor<f64>]| -> f64 {
                let of = |i: usize| {
                    let products = p[i].as_flattened().iter().zip(f[i].as_flattened()).map(|(a, b)| a * b);
                    body.cloud.volume[i] * products.sum::<f64>()
                };
                (0..p.len()).map(of).sum()
            };
            let (right, found) = (power(&p, &body.exact(&g)), power(&body.transposed(&p), &g));
            let plain = power(&p, &g);
            assert!((found - right).abs() < 1e-12 * right.abs().max(1.0), "{dimension:?}: {found} {right}");
            assert!((plain - right).abs() > 1e-3 * right.abs(), "{dimension:?}: nothing taken");
        }
    }
}
