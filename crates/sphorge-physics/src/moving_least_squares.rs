//! First-order moving-least-squares density (Dilts 1999; Colagrossi & Landrini 2003).
//!
//! `rho_i = sum_j m_j W^MLS_ij`, `W^MLS_ij = [beta_0 + beta . x_ij] W_ij`, with `A beta = (1, 0, 0, 0)`,
//! `A = sum_j V_j W_ij p p^T`, `p = (1, x_ij)`: the sum reproduces a density that varies linearly in space, up to and at free
//! surfaces. Patiño et al. 3.2 names the method without equations.

use crate::tensor::{determinant, dot, inverse};
use crate::{Dimension, Elementary, Real, Scalar, SymmetricTensor, Vector};

/// The moments `A` of a particle's neighbourhood (itself included), gathered pair by pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments<T> {
    /// `sum V_j W_ij`.
    pub zeroth: T,
    /// `sum V_j W_ij x_ij`, m.
    pub first: Vector<T>,
    /// `sum V_j W_ij x_ij x_ij`, m^2.
    pub second: SymmetricTensor<T>,
}

/// `beta`, the solution for one particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients<T> {
    /// `beta_0`.
    pub constant: T,
    /// `beta_1..3`, 1/m; zero along axes not computed in.
    pub linear: Vector<T>,
}

/// Variance of the neighbours' positions, in `h^2`, below which there is no neighbourhood to speak of.
const SMALLEST_VARIANCE: f64 = 1e-4;
/// Determinant of the scaled covariance below which the neighbours lie on a line or in a plane.
const SMALLEST_DETERMINANT: f64 = 1e-4;

impl<T: Real> Default for Moments<T> {
    fn default() -> Self {
        Self { zeroth: T::zero(), first: [T::zero(); 3], second: SymmetricTensor::zero() }
    }
}

impl<T: Real> Moments<T> {
    /// Adds a neighbour at `x_ij = x_i - x_j` (m) with `weight = V_j W_ij`.
    #[inline(always)]
    pub fn add(&mut self, x_ij: Vector<T>, weight: T) {
        let wx = [weight * x_ij[0], weight * x_ij[1], weight * x_ij[2]];
        self.zeroth += weight;
        self.first = [self.first[0] + wx[0], self.first[1] + wx[1], self.first[2] + wx[2]];
        self.second = SymmetricTensor {
            xx: wx[0].mul_add(x_ij[0], self.second.xx),
            yy: wx[1].mul_add(x_ij[1], self.second.yy),
            zz: wx[2].mul_add(x_ij[2], self.second.zz),
            xy: wx[0].mul_add(x_ij[1], self.second.xy),
            yz: wx[1].mul_add(x_ij[2], self.second.yz),
            xz: wx[0].mul_add(x_ij[2], self.second.xz),
        };
    }
}

impl<T: Scalar> Moments<T> {
    /// [`Self::coefficients`]; `None` where there are none.
    pub fn solve(&self, h: T, dimension: Dimension) -> Option<Coefficients<T>> {
        let [constant, x, y, z, is_one] = self.coefficients(h, dimension);
        (is_one > T::zero()).then_some(Coefficients { constant, linear: [x, y, z] })
    }
}

impl<T: Elementary> Moments<T> {
    /// Solves `A beta = (1, 0, 0, 0)`: `beta` and a one; zeros where the neighbours do not span the space, and the density is to be left
    /// alone. `h` (m) is the scale the spread of neighbours is judged by.
    ///
    /// With the mean `a` and covariance `C` of `x_ij` under the weights: `beta = -C^-1 a / A_0`,
    /// `beta_0 = (1 + a . C^-1 a) / A_0`.
    pub fn coefficients(&self, h: T, dimension: Dimension) -> [T; 5] {
        let none = || [T::zero(); 5];
        T::if_lt(T::zero(), self.zeroth, || self.coefficients_of_some(h, dimension), none)
    }

    fn coefficients_of_some(&self, h: T, dimension: Dimension) -> [T; 5] {
        let count = dimension.count();
        let second = self.second.to_tensor();
        let mut mean = [T::zero(); 3];
        for a in 0..count {
            mean[a] = self.first[a] / self.zeroth;
        }
        let mut trace = T::zero();
        for a in 0..count {
            trace += second[a][a] / self.zeroth - mean[a] * mean[a];
        }
        let variance = trace / T::of(count as f64);
        let spread = || {
            // Scaled to trace `count`, with a unit on the axes not computed in.
            let mut covariance = crate::tensor::identity();
            for a in 0..count {
                for b in 0..count {
                    covariance[a][b] = (second[a][b] / self.zeroth - mean[a] * mean[b]) / variance;
                }
            }
            let solution = || {
                let inverse = inverse(&covariance);
                let mut slope = [T::zero(); 3];
                for a in 0..3 {
                    slope[a] = dot(inverse[a], mean) / variance;
                }
                let [x, y, z] = slope.map(|c| -c / self.zeroth);
                [(T::one() + dot(mean, slope)) / self.zeroth, x, y, z, T::one()]
            };
            T::if_lt(T::of(SMALLEST_DETERMINANT), determinant(&covariance), solution, || [T::zero(); 5])
        };
        T::if_lt(T::of(SMALLEST_VARIANCE) * h * h, variance, spread, || [T::zero(); 5])
    }
}

impl<T: Real> Coefficients<T> {
    /// `W^MLS_ij / W_ij`.
    #[inline(always)]
    pub fn factor(&self, x_ij: Vector<T>) -> T {
        self.constant + dot(self.linear, x_ij)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cloud::{Cloud, DIMENSIONS};

    /// MLS density of particle `i` where the neighbours' densities are given by `rho` and their volumes are the cloud's.
    fn density(cloud: &Cloud, i: usize, rho: impl Fn(Vector<f64>) -> f64) -> Option<f64> {
        let mut moments = Moments::default();
        for j in 0..cloud.count() {
            moments.add(cloud.x_ij(i, j), cloud.volume[j] * cloud.w(i, j));
        }
        let beta = moments.solve(cloud.h, cloud.dimension)?;
        let mass = |j: usize| rho(cloud.x[j]) * cloud.volume[j];
        Some((0..cloud.count()).map(|j| mass(j) * beta.factor(cloud.x_ij(i, j)) * cloud.w(i, j)).sum())
    }

    #[test]
    fn linear_and_constant_density_are_reproduced_to_the_surface() {
        for dimension in DIMENSIONS {
            let cloud = Cloud::block(dimension);
            for i in 0..cloud.count() {
                let linear = |x: Vector<f64>| 8000.0 + 500.0 * x[0] - 300.0 * x[1] + 200.0 * x[2];
                let want = linear(cloud.x[i]);
                assert!((density(&cloud, i, linear).unwrap() - want).abs() < 1e-9 * want);
                assert!((density(&cloud, i, |_| 2710.0).unwrap() - 2710.0).abs() < 1e-9 * 2710.0);
            }
        }
    }

    #[test]
    fn a_neighbourhood_that_does_not_span_the_space_is_left_alone() {
        assert_eq!(Moments::<f64>::default().solve(1.0, Dimension::One), None);
        let mut alone = Moments::<f64>::default();
        alone.add([0.0; 3], 0.4);
        let mut line = alone;
        for k in 1..4 {
            line.add([0.3 * f64::from(k), 0.6 * f64::from(k), 0.0], 0.2);
        }
        for dimension in DIMENSIONS {
            assert_eq!(alone.solve(1.0, dimension), None);
        }
        assert_eq!(line.solve(1.0, Dimension::Two), None);
        assert_eq!(line.solve(1.0, Dimension::Three), None);
        assert!(line.solve(1.0, Dimension::One).is_some());
        // A hair beside the line does not make a plane.
        line.add([0.3, 0.6 + 1e-3, 0.0], 0.2);
        assert_eq!(line.solve(1.0, Dimension::Two), None);
    }

    #[test]
    fn a_neighbourhood_is_one_from_a_hundredth_of_the_smoothing_length_on() {
        // Two places at a distance d on a line: variance d^2/4. Four on a cross in a plane, d from its middle: d^2/2 along each axis.
        for h in [1.0, 10.0] {
            for (share, spans) in [(0.99, false), (1.01, true)] {
                let d = 0.02 * h * share;
                let mut line = Moments::<f64>::default();
                for x in [0.0, d] {
                    line.add([x, 0.0, 0.0], 0.25);
                }
                assert_eq!(line.solve(h, Dimension::One).is_some(), spans);
                let d = 0.01 * h * share * f64::sqrt(2.0);
                let mut cross = Moments::<f64>::default();
                for [x, y] in [[d, 0.0], [-d, 0.0], [0.0, d], [0.0, -d]] {
                    cross.add([x, y, 0.0], 0.25);
                }
                assert_eq!(cross.solve(h, Dimension::Two).is_some(), spans);
            }
        }
    }

    #[test]
    fn two_neighbours_on_a_line_by_hand() {
        // x_ij = 0 with weight 0.5, x_ij = -1 with weight 0.25: A = [[0.75, -0.25], [-0.25, 0.25]],
        // determinant 0.125, beta = (0.25, 0.25)/0.125 = (2, 2).
        let mut moments = Moments::<f64>::default();
        moments.add([0.0; 3], 0.5);
        moments.add([-1.0, 0.0, 0.0], 0.25);
        let beta = moments.solve(1.0, Dimension::One).unwrap();
        assert!((beta.constant - 2.0).abs() < 1e-14 && (beta.linear[0] - 2.0).abs() < 1e-14);
        assert_eq!(beta.linear[1], 0.0);
    }
}
