//! Hourglass control of the total Lagrangian form: springs against motion that the deformation gradient does not see.
//!
//! A deformation gradient sees only the linear part of the motion around a particle; the rest costs no energy and can
//! grow without bound. Springs resist it. How far the linear motion of `i` misses the place of neighbour `j` is
//!
//! `z_i(j) = F_i X_ij - x_ij`,
//!
//! with `x_ij = x_i - x_j`, and the energy of the springs weights it as the gradient sum does, `grad_0 W_ij = -w_ij X_ij`:
//!
//! `E_hg = sum_i (k_i/4) V_i sum_j V_j w_ij |z_i(j)|^2`,  `w_ij = -(1/r) dW/dr` at `X_ij`.
//!
//! `F_i` is the least-squares fit to the places of the neighbours with these weights. The normal equations of the fit,
//! `sum_j V_j w_ij z_i(j) X_ij^T = 0`, say that the energy does not change with `F_i`, although `F_i` depends on all
//! neighbours. The pair force
//!
//! `f_ij = V_i V_j w_ij (k_i z_i(j) + k_j z_j)/2`,  `z_j = F_j X_ij - x_ij`,
//!
//! is therefore the exact gradient of the energy: the stiffness is symmetric, no mode grows, and what the springs take
//! from the motion comes back. A weight other than that of the gradient, a force along the pair only, or a stiffness
//! that depends on the pair leaves a moment without counterpart, and elastic bodies flutter. The springs see curvature,
//! with a stiffness that falls with the square of the number of layers, as does what the particle sums lack in bending:
//! one strength, 1.25, is right for all thicknesses from three layers on.
//!
//! Springs as stiff as the metal at rest would resist plastic flow, whose motion is never linear. They therefore have
//! a secant modulus of a metal with the plastic strain `eps_p`, to which the misfit itself counts as strain:
//!
//! `k_i = alpha lambda^(1/2) E_s`,  `E_s = Y/((a eps_p + Y/E)^2 + (c eps_z)^2)^(1/2)`,  `eps_z^2 = (1/d) sum_j V_j w_ij |z_i(j)|^2`.
//!
//! That is Young's modulus until the metal yields or the misfit approaches the elastic strain. As `k_i` depends on
//! `eps_z` of its own particle only, there still is an energy, per volume
//!
//! `(d/2) k_0 eps_z^2/(1 + (1 + b^2 eps_z^2)^(1/2))`,
//!
//! with `k_0`, the stiffness without misfit, and `b = c/(a eps_p + Y/E)`. It is given back except for what is lost when
//! `eps_p` grows, which is heat.
//!
//! A particle pressed flat to `lambda` of its height is wider by `lambda^-1/2`: the strain of a spring in its plane,
//! relative to the length at rest, is too large by this factor. Without `lambda^1/2` springs resist the flow of the foot
//! of a bar at high speed. It is of the least stretch at which the particle has yielded so far, so that no spring
//! stiffens while it is strained.

use crate::{Dimension, Elementary, Real, Tensor, Vector};

/// Flow stress at least, for metal without strength such as a melt, as a share of Young's modulus.
const LEAST: f64 = 2e-4;

/// How much of the plastic strain and of the misfit counts as strain of the springs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted {
    /// Of the plastic strain, `a`: it decides where the strain is large and the misfit small, as in a neck.
    pub strain: f64,
    /// Of the misfit, `c`: it decides where the misfit is large, as in hinges, which lock without, and in feet.
    pub misfit: f64,
}

impl Counted {
    /// Where gradients are exact for linear fields. With all of the plastic strain the neck of a rod of copper, pulled by 40 %, is too sharp:
    /// the strain in its middle is 12 % above that of finite elements, with 0.7 by 2 %, with 0.6 by 0.2 %, with less below it; feet do
    /// not change. The foot of a plate of iron with 12 particles across is 1.3 and 0.9 % too narrow with a `c` of 17 and 20, that of a
    /// copper bar on a wall that lets it go 3.0 % with 17 and 2.2 % with 32; but with 32 a bar at 300 m/s has one that is 2.6 % too wide.
    pub const LINEAR: Self = Self { strain: 0.7, misfit: 16.0 };

    /// Where they are exact for quadratic fields at faces.
    pub const QUADRATIC: Self = Self { strain: 0.7, misfit: 4.0 };
}

/// Largest deviation of `M B M` from `M`, relative to `M`, that is rounding.
const INEXACT: f64 = 1e-3;

/// Springs of a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring<T> {
    /// Stiffness without misfit, `k_0`, Pa.
    pub stiffness: T,
    /// `b^2`, by which the misfit softens them.
    pub softening: T,
}

impl<T: Real> Spring<T> {
    /// Springs of strength `alpha` in a material of that Young's modulus, flow stress (Pa) and plastic strain, with the
    /// least principal stretch at which it has yielded.
    #[inline(always)]
    pub fn new(counted: Counted, strength: T, young: T, yield_stress: T, plastic_strain: T, least_stretch: T) -> Self {
        // A fluid has no springs, but its flow stress must not be zero.
        let flow = yield_stress.max(T::of(LEAST) * young).max(T::one());
        let inverse_strain = young / flow;
        let share = T::one() / (T::one() + T::of(counted.strain) * inverse_strain * plastic_strain);
        let softening = T::of(counted.misfit) * inverse_strain * share;
        let stiffness = strength * young * share * least_stretch.min(T::one()).sqrt();
        Self { stiffness, softening: softening * softening }
    }

    /// Stiffness, Pa, at the mean square `eps_z^2` of the misfit.
    #[inline(always)]
    pub fn at(self, misfit2: T) -> T {
        self.stiffness / (T::one() + self.softening * misfit2).sqrt()
    }

    /// Energy that the springs hold at the mean square `eps_z^2` of the misfit, per initial volume, J/m^d.
    #[inline(always)]
    pub fn energy(self, misfit2: T, dimension: Dimension) -> T {
        let root = (T::one() + self.softening * misfit2).sqrt();
        T::of(0.5 * dimension.count() as f64) * self.stiffness * misfit2 / (T::one() + root)
    }
}

/// Deviation of a pair from the linear motion of each of its particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit<T> {
    /// `X_ij`, m.
    pub initial: Vector<T>,
    /// `|X_ij|^2`, m^2.
    pub initial2: T,
    /// `F_i X_ij - x_ij`, m.
    pub own: Vector<T>,
    /// `F_j X_ij - x_ij`, m.
    pub other: Vector<T>,
}

impl<T: Real> Misfit<T> {
    /// None.
    #[inline(always)]
    pub fn zero() -> Self {
        let o = T::zero();
        Self { initial: [o; 3], initial2: o, own: [o; 3], other: [o; 3] }
    }

    /// For a pair that was at `X_ij` (`initial`, m) and is at `x_ij` (m), along the `D` axes computed in. With
    /// displacement gradients `F - 1` in place of `F`, and `u_ij = x_ij - X_ij` in place of `x_ij`, it is the same to more
    /// digits.
    #[inline(always)]
    pub fn of<const D: usize>(initial: &Vector<T>, x: &Vector<T>, f_i: &Tensor<T>, f_j: &Tensor<T>) -> Self {
        let mut misfit = Self { initial: *initial, ..Self::zero() };
        for a in 0..D {
            misfit.initial2 = initial[a].mul_add(initial[a], misfit.initial2);
            let (mut own, mut other) = (-x[a], -x[a]);
            for b in 0..D {
                own = f_i[a][b].mul_add(initial[b], own);
                other = f_j[a][b].mul_add(initial[b], other);
            }
            (misfit.own[a], misfit.other[a]) = (own, other);
        }
        misfit
    }

    /// `(k_i z_i(j) + k_j z_j)/2`, Pa m: the force on `i` is `V_i V_j w_ij` times this. `own` and `other` are `k_i` and
    /// `k_j`, Pa.
    #[inline(always)]
    pub fn push<const D: usize>(&self, own: T, other: T) -> Vector<T> {
        let mut push = [T::zero(); 3];
        for a in 0..D {
            push[a] = T::of(0.5) * own.mul_add(self.own[a], other * self.other[a]);
        }
        push
    }
}

/// Sums of one particle over its springs, still without the factor `V_i / m_i`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringSums<T> {
    /// Force per initial volume, N/m^d.
    pub acceleration: Vector<T>,
    /// `sum_j V_j w_ij z_i(j) . v_ij`, 1/s: minus `d/2` times the rate of `eps_z^2`, as that does not change with `F_i`.
    pub closing: T,
    /// `sum_j V_j w_ij |z_i(j)|^2`, `d` times the mean square of the misfit.
    pub misfit2: T,
    /// `sum_j V_j w_ij z_i(j) X_ij^T`: zero but for what rounding has left between `F_i` and the places of the neighbours.
    pub moment: Tensor<T>,
}

impl<T: Real> SpringSums<T> {
    /// Nothing summed.
    #[inline(always)]
    pub fn zero() -> Self {
        let o = T::zero();
        Self { acceleration: [o; 3], closing: o, misfit2: o, moment: [[o; 3]; 3] }
    }

    /// Adds a spring along the `D` axes computed in: `push` by [`Misfit::push`], `v` the velocity of `i` relative to `j`
    /// (m/s), `weight` that of the gradient, `V_j w_ij` (m^-2).
    #[inline(always)]
    pub fn add<const D: usize>(&mut self, misfit: &Misfit<T>, push: &Vector<T>, v: &Vector<T>, weight: T) {
        let (mut closing, mut square) = (T::zero(), T::zero());
        for a in 0..D {
            self.acceleration[a] = weight.mul_add(push[a], self.acceleration[a]);
            closing = misfit.own[a].mul_add(v[a], closing);
            square = misfit.own[a].mul_add(misfit.own[a], square);
            let own = weight * misfit.own[a];
            for b in 0..D {
                self.moment[a][b] = own.mul_add(misfit.initial[b], self.moment[a][b]);
            }
        }
        self.closing = weight.mul_add(closing, self.closing);
        self.misfit2 = weight.mul_add(square, self.misfit2);
    }

    /// Power that goes to the internal energy, per initial volume, W/m^d: that of the springs of the particle itself, of
    /// this stiffness (Pa). What they hold is then part of its own energy. Of all particles it is the power of the forces.
    #[inline(always)]
    pub fn energy_rate(&self, stiffness: T) -> T {
        T::of(-0.5) * stiffness * self.closing
    }
}

/// One if a gradient correction inverts its moment matrix, on the axes on which there are neighbours at all; zero where
/// it does not, and a deformation gradient is no fit to the neighbours. Springs would not have an energy there.
pub fn is_fit<T: Elementary>(moment: &Tensor<T>, correction: &Tensor<T>, dimension: Dimension) -> T {
    let d = dimension.count();
    let product = |a: usize, b: usize| {
        let mut sum = T::zero();
        for p in 0..d {
            for q in 0..d {
                sum += moment[a][p] * correction[p][q] * moment[q][b];
            }
        }
        sum
    };
    let (mut size, mut error) = (T::zero(), T::zero());
    for a in 0..d {
        for b in 0..d {
            size = size.max(moment[a][b].abs());
            error = error.max((product(a, b) - moment[a][b]).abs());
        }
    }
    T::select_lt(T::of(INEXACT) * size, error, T::zero(), T::one())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradient_correction::{LARGEST_COMPONENT, gradient_correction};
    use crate::tensor::{determinant, dot, identity, multiply, zero};
    use crate::test_cloud::{Cloud, Noise};

    const PLANE_AND_SPACE: [Dimension; 2] = [Dimension::Two, Dimension::Three];

    /// Springs of an irregular body of a metal that yields at a strain of 0.005.
    struct Sprung {
        cloud: Cloud,
        spring: Vec<Spring<f64>>,
        correction: Vec<Tensor<f64>>,
    }

    impl Sprung {
        fn new(dimension: Dimension) -> Self {
            let cloud = Cloud::block(dimension);
            // Particles that have yielded by different strains.
            let spring = |i: usize| {
                Spring::new(Counted::LINEAR, 1.2, 200.0, 1.0, 0.002 * (i % 5) as f64, 0.7 + 0.1 * (i % 4) as f64)
            };
            let spring = (0..cloud.count()).map(spring).collect();
            let mut sprung = Self { cloud, spring, correction: Vec::new() };
            let places = sprung.cloud.x.clone();
            let invert = |i: usize| gradient_correction(&sprung.moment(i, &places), dimension, LARGEST_COMPONENT);
            sprung.correction = (0..places.len()).map(invert).collect();
            sprung
        }

        fn pairs(&self, i: usize) -> impl Iterator<Item = (usize, Vector<f64>, f64)> {
            (0..self.cloud.count()).filter(move |&j| j != i).map(move |j| {
                let (apart, slope) = (self.cloud.x_ij(i, j), self.cloud.grad_w(i, j));
                (j, apart, -self.cloud.volume[j] * dot(slope, apart) / dot(apart, apart))
            })
        }

        /// `sum_j V_j w_ij x_ij X_ij^T`.
        fn moment(&self, i: usize, x: &[Vector<f64>]) -> Tensor<f64> {
            let mut moment = zero();
            for (j, apart, weight) in self.pairs(i) {
                for a in 0..3 {
                    for b in 0..3 {
                        moment[a][b] += weight * (x[i][a] - x[j][a]) * apart[b];
                    }
                }
            }
            moment
        }

        fn fit(&self, i: usize, x: &[Vector<f64>]) -> Tensor<f64> {
            let mut f = multiply(&self.moment(i, x), &self.correction[i]);
            for a in self.cloud.dimension.count()..3 {
                f[a][a] = 1.0;
            }
            f
        }

        /// Sums of particles at `x` that move with `v`, and the energy.
        fn sums(&self, x: &[Vector<f64>], v: &[Vector<f64>]) -> (Vec<SpringSums<f64>>, f64) {
            match self.cloud.dimension {
                Dimension::Two => self.sums_in::<2>(x, v),
                _ => self.sums_in::<3>(x, v),
            }
        }

        fn sums_in<const D: usize>(&self, x: &[Vector<f64>], v: &[Vector<f64>]) -> (Vec<SpringSums<f64>>, f64) {
            let f: Vec<_> = (0..x.len()).map(|i| self.fit(i, x)).collect();
            let difference = |of: &[Vector<f64>], i: usize, j: usize| [0, 1, 2].map(|a| of[i][a] - of[j][a]);
            let misfit =
                |i: usize, j: usize, apart: &Vector<f64>| Misfit::of::<D>(apart, &difference(x, i, j), &f[i], &f[j]);
            let square = |i: usize| {
                self.pairs(i).fold(0.0, |sum, (j, apart, weight)| {
                    let own = misfit(i, j, &apart).own;
                    sum + weight * dot(own, own)
                }) / D as f64
            };
            let squares: Vec<f64> = (0..x.len()).map(square).collect();
            let stiffness: Vec<f64> = (0..x.len()).map(|i| self.spring[i].at(squares[i])).collect();
            let sums = |i: usize| {
                let mut sums = SpringSums::zero();
                for (j, apart, weight) in self.pairs(i) {
                    let misfit = misfit(i, j, &apart);
                    let push = misfit.push::<D>(stiffness[i], stiffness[j]);
                    sums.add::<D>(&misfit, &push, &difference(v, i, j), weight);
                }
                sums
            };
            let energy = (0..x.len())
                .map(|i| self.cloud.volume[i] * self.spring[i].energy(squares[i], self.cloud.dimension))
                .sum();
            ((0..x.len()).map(sums).collect(), energy)
        }

        fn force(&self, i: usize, sums: &[SpringSums<f64>]) -> Vector<f64> {
            sums[i].acceleration.map(|a| self.cloud.volume[i] * a)
        }

        /// The body, stretched, turned by half a radian and with particles off their places by a share of the spacing.
        fn disturbed(&self, share: f64, seed: u64) -> Vec<Vector<f64>> {
            let (s, c) = 0.5f64.sin_cos();
            let d = self.cloud.dimension.count();
            let mut noise = Noise::new(seed);
            let turned = |x: &Vector<f64>| {
                let (x, y) = (1.1 * x[0], 0.95 * x[1]);
                [c * x - s * y, s * x + c * y]
            };
            self.cloud
                .x
                .iter()
                .map(|place| {
                    let [x, y] = turned(place);
                    let mut place = [x, y, place[2]];
                    place[..d].iter_mut().for_each(|x| *x += share * 0.1 * noise.next());
                    place
                })
                .collect()
        }
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_also_where_springs_soften() {
        for dimension in PLANE_AND_SPACE {
            let sprung = Sprung::new(dimension);
            // Misfits from a tenth of the elastic strain to many times it.
            for share in [0.003, 0.3] {
                let x = sprung.disturbed(share, 11);
                let rest = vec![[0.0; 3]; x.len()];
                let (sums, _) = sprung.sums(&x, &rest);
                let size =
                    (0..x.len()).flat_map(|i| sprung.force(i, &sums)).fold(0.0, |most: f64, f| most.max(f.abs()));
                for i in (0..x.len()).step_by(7) {
                    for a in 0..dimension.count() {
                        let energy = |shift: f64| {
                            let mut x = x.clone();
                            x[i][a] += shift;
                            sprung.sums(&x, &rest).1
                        };
                        let step = 1e-4 * share;
                        let slope = (energy(step) - energy(-step)) / (2.0 * step);
                        let force = sprung.force(i, &sums)[a];
                        assert!((force + slope).abs() < 1e-5 * size, "{dimension:?} {share} {i} {a}: {force} {slope}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_stiffness_is_symmetric_and_never_negative() {
        let sprung = Sprung::new(Dimension::Two);
        let (x, n) = (sprung.cloud.x.clone(), 2 * sprung.cloud.count());
        let rest = vec![[0.0; 3]; x.len()];
        let column = |q: usize| -> Vec<f64> {
            let force = |shift: f64| {
                let mut x = x.clone();
                x[q / 2][q % 2] += shift;
                let (sums, _) = sprung.sums(&x, &rest);
                (0..n).map(|p| sprung.force(p / 2, &sums)[p % 2]).collect::<Vec<_>>()
            };
            let step = 1e-8;
            force(step).iter().zip(force(-step)).map(|(ahead, behind)| (behind - ahead) / (2.0 * step)).collect()
        };
        let columns: Vec<Vec<f64>> = (0..n).map(column).collect();
        let largest = columns.iter().flatten().fold(0.0, |most: f64, k| most.max(k.abs()));
        for p in 0..n {
            for q in 0..p {
                let (one, other) = (columns[p][q], columns[q][p]);
                assert!((one - other).abs() < 1e-6 * largest, "{p} {q}: {one} {other}");
            }
        }
        let mut noise = Noise::new(3);
        for _ in 0..200 {
            let u: Vec<f64> = (0..n).map(|_| noise.next()).collect();
            let along = |k: &Vec<f64>| k.iter().zip(&u).map(|(k, u)| k * u).sum::<f64>();
            let twice: f64 = columns.iter().map(along).zip(&u).map(|(f, u)| f * u).sum();
            assert!(twice > 0.0, "{twice}");
        }
    }

    #[test]
    fn springs_move_and_turn_nothing_and_their_work_is_the_energy() {
        for dimension in PLANE_AND_SPACE {
            let sprung = Sprung::new(dimension);
            let x = sprung.disturbed(0.3, 5);
            let mut noise = Noise::new(9);
            let v: Vec<Vector<f64>> = x.iter().map(|_| [noise.next(), noise.next(), noise.next()]).collect();
            let (sums, _) = sprung.sums(&x, &v);
            let misfits = |x: &[Vector<f64>]| sprung.sums(x, &v).0.into_iter().map(|sums| sums.misfit2);
            let moved = |by: f64| {
                misfits(&(0..x.len()).map(|i| [0, 1, 2].map(|a| x[i][a] + by * v[i][a])).collect::<Vec<_>>())
                    .collect::<Vec<_>>()
            };
            let (after, before) = (moved(1e-4), moved(-1e-4));
            let (mut force, mut torque, mut size, mut heat, mut power) = ([0.0; 3], [0.0; 3], 0.0, 0.0, 0.0);
            for (i, x) in x.iter().enumerate() {
                let f = sprung.force(i, &sums);
                let turning = [x[1] * f[2] - x[2] * f[1], x[2] * f[0] - x[0] * f[2], x[0] * f[1] - x[1] * f[0]];
                (0..3).for_each(|a| force[a] += f[a]);
                (0..3).for_each(|a| torque[a] += turning[a]);
                size += dot(f, f).sqrt();
                power += dot(f, v[i]);
                let stiffness = sprung.spring[i].at(sums[i].misfit2 / dimension.count() as f64);
                heat += sprung.cloud.volume[i] * sums[i].energy_rate(stiffness);
                // Of a particle it is the rate of the energy of its own springs: (k/4) d/dt of the sum of the squares.
                let held = stiffness / 4.0 * (after[i] - before[i]) / 2e-4;
                assert!((sums[i].energy_rate(stiffness) - held).abs() < 1e-6, "{dimension:?} {i}");
                let moment = sums[i].moment.as_flattened().iter().fold(0.0, |most: f64, m| most.max(m.abs()));
                assert!(moment < 1e-12, "{dimension:?}: {moment}");
            }
            assert!(force.iter().all(|f| f.abs() < 1e-12 * size), "{dimension:?}: {force:?} of {size}");
            assert!(torque.iter().all(|t| t.abs() < 1e-12 * size), "{dimension:?}: {torque:?} of {size}");
            assert!((heat + power).abs() < 1e-12 * size, "{dimension:?}: {heat} {power}");
        }
    }

    #[test]
    fn a_closed_path_takes_no_work() {
        let sprung = Sprung::new(Dimension::Two);
        let (one, other) = (sprung.disturbed(0.3, 21), sprung.disturbed(0.3, 22));
        let at = |t: f64| -> [Vec<Vector<f64>>; 2] {
            let (s, c) = t.sin_cos();
            let place =
                |i: usize| [0, 1, 2].map(|a| sprung.cloud.x[i][a] * (2.0 - s - c) + c * one[i][a] + s * other[i][a]);
            let speed = |i: usize| [0, 1, 2].map(|a| sprung.cloud.x[i][a] * (s - c) - s * one[i][a] + c * other[i][a]);
            [(0..one.len()).map(place).collect(), (0..one.len()).map(speed).collect()]
        };
        let (mut work, mut size) = (0.0, 0.0f64);
        let steps = 400;
        for k in 0..steps {
            let [x, v] = at(core::f64::consts::TAU * k as f64 / steps as f64);
            let (sums, _) = sprung.sums(&x, &v);
            let stiffness = |i: usize| sprung.spring[i].at(sums[i].misfit2 / 2.0);
            let power: f64 = (0..x.len()).map(|i| sprung.cloud.volume[i] * sums[i].energy_rate(stiffness(i))).sum();
            work += power;
            size += power.abs();
        }
        assert!(size > 0.0 && work.abs() < 1e-6 * size, "{work} of {size}");
    }

    #[test]
    fn springs_soften_with_plastic_strain_and_misfit() {
        // E 200 GPa, Y 800 MPa at a plastic strain of 0.04: 800 MPa/(0.7 0.04 + 0.004) = 25 GPa, times 1.2.
        let spring = Spring::new(Counted::LINEAR, 1.2, 200e9, 800e6, 0.04f64, 1.0);
        assert!((spring.stiffness / 30e9 - 1.0).abs() < 1e-12);
        // b = 16/0.032: at a misfit of 0.002 sqrt(2) times softer.
        assert!((spring.at((0.002f64).powi(2)) / 30e9 * 2.0f64.sqrt() - 1.0).abs() < 1e-12);
        // Far beyond: Y/(16 eps_z).
        assert!((spring.at(1.0) / (1.2 * 800e6 / 16.0) - 1.0).abs() < 1e-5);
        // Pressed to a quarter of its height, half; wider on all sides, no more.
        let of = |stretch| Spring::new(Counted::LINEAR, 1.2, 200e9, 800e6, 0.04f64, stretch);
        assert_eq!(of(0.25), Spring { stiffness: 0.5 * spring.stiffness, ..spring });
        assert_eq!(of(1.2), spring);
        // A melt has a flow stress of 2e-4 E.
        let melt = Spring::new(Counted::LINEAR, 1.0, 200e9, 0.0f64, 1.0, 1.0);
        assert!((melt.stiffness / (40e6 / (0.7 + 2e-4)) - 1.0).abs() < 1e-12);
        // What never yields does not soften, and a fluid has no springs.
        let rubber = Spring::new(Counted::LINEAR, 1.2, 2e6, f64::INFINITY, 0.0, 1.0);
        assert_eq!((rubber.at(0.0), rubber.at(0.3)), (2.4e6, 2.4e6));
        assert_eq!(Spring::new(Counted::LINEAR, 1.2, 0.0, 0.0f64, 0.0, 1.0).at(0.3), 0.0);
    }

    #[test]
    fn the_energy_by_hand() {
        // Linear: (k/4) d eps_z^2.
        let linear = Spring { stiffness: 100.0, softening: 0.0 };
        assert_eq!(linear.energy(0.04, Dimension::Two), 2.0);
        // b eps_z = sqrt(3), a root of 2: (3/2) 100 0.04/(1 + 2).
        let soft = Spring { stiffness: 100.0f64, softening: 75.0 };
        assert!((soft.energy(0.04, Dimension::Three) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn linear_motion_has_no_misfit_and_what_is_left_over_does() {
        let f = [[1.2, 0.5, 0.0], [0.0, 0.9, -0.3], [0.1, 0.0, 1.0]];
        let initial = [2.0, -1.0, 0.5];
        let x: Vector<f64> = core::array::from_fn(|a| (0..3).map(|b| f[a][b] * initial[b]).sum());
        let none = Misfit::of::<3>(&initial, &x, &f, &f);
        assert!(none.own.iter().chain(&none.other).all(|z| z.abs() < 1e-15));
        // F_i stretches x by 2, F_j by 1; from (1, 1) to (1, 2). What is not computed in does not count.
        let f_i = [[2.0, 0.0, 7.0], [0.0, 1.0, 7.0], [7.0; 3]];
        let apart = Misfit::of::<2>(&[1.0, 1.0, 9.0], &[1.0, 2.0, 9.0], &f_i, &identity());
        assert_eq!((apart.initial2, apart.own, apart.other), (2.0, [1.0, -1.0, 0.0], [0.0, -1.0, 0.0]));
        // (10 (1, -1) + 30 (0, -1))/2.
        assert_eq!(apart.push::<2>(10.0, 30.0), [5.0, -20.0, 0.0]);
        // The weight is 0.5; the particle drifts apart with (2, 1), its own misfit closes by half of 2 - 1; of a stiffness of
        // 10 this takes half of half of 10 from what is held.
        let mut sums = SpringSums::zero();
        sums.add::<2>(&apart, &[5.0, -20.0, 0.0], &[2.0, 1.0, 9.0], 0.5);
        assert_eq!((sums.acceleration, sums.closing, sums.misfit2), ([2.5, -10.0, 0.0], 0.5, 1.0));
        assert_eq!(sums.energy_rate(10.0), -2.5);
        assert_eq!(sums.moment, [[0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.0; 3]]);
    }

    #[test]
    fn a_correction_is_a_fit_where_it_inverts_its_moment() {
        let moment = [[0.5, 0.1, 0.0], [0.1, 0.4, 0.0], [0.0, 0.0, 0.3f64]];
        assert!(determinant(&moment) > 0.0);
        let inverse = gradient_correction(&moment, Dimension::Three, LARGEST_COMPONENT);
        assert_eq!(is_fit(&moment, &inverse, Dimension::Three), 1.0);
        // Left out because a component is too large.
        let none = gradient_correction(&moment, Dimension::Three, 2.0);
        assert_eq!((none, is_fit(&moment, &none, Dimension::Three)), (identity(), 0.0));
        // One layer: inverted in its plane, whatever stands on the axis without neighbours.
        let flat = [[0.5, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0; 3]];
        let in_plane = [[2.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(is_fit(&flat, &in_plane, Dimension::Three), 1.0);
        assert_eq!(is_fit(&flat, &identity(), Dimension::Three), 0.0);
    }
}
