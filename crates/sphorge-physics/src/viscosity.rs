//! Artificial viscosity of pairs (Monaghan & Gingold), with Balsara's switch, and of single particles (von Neumann & Richtmyer).
//!
//! `Pi_ij = (-alpha c mu + beta mu^2)/rho` where particles approach, `v_ij . x_ij < 0`, else zero, with
//! `mu = h v_ij . x_ij / (r^2 + 0.01 h^2)` and pair means of `c`, `rho`, `h` (Monaghan & Gingold 1983; Monaghan 1992).
//! It enters the pair stress as `- Pi_ij I`, a pressure over density squared.
//!
//! Patiño et al. Eq 13 prints `mu^2` in the linear term; Fraser Eq 6 and 15 print `+ Pi_ij`.
//!
//! In shocks the particles of the total Lagrangian form are damped along pairs besides. Behind the front of a strong shock they stand in pairs,
//! distances 0.1 and one spacing in turn, which a velocity gradient does not see, so that no pressure of the particle resists it. The share of
//! this viscosity that acts, `chi`, is a function of the velocity gradient alone: zero in waves and plastic flow, one in shocks. With `z = chi c rho_0`
//! the force on `i` by `j` is
//!
//! `V_i V_j w_ij alpha_s max(z_i, z_j) h_ij max(0, -v_ij . x_ij)/|x_ij|^2 x_ij`,  `w_ij = -(1/r) dW/dr` at `X_ij`,
//!
//! along the pair, so that it has no moment, and never takes work from what is inside.

use crate::tensor::dot;
use crate::{Real, Tensor, Vector};

/// Strength of the artificial viscosity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViscosityParameters<T> {
    /// Linear (bulk and shear) part.
    pub alpha: T,
    /// Quadratic (von Neumann–Richtmyer) part.
    pub beta: T,
}

/// `mu_ij`, m/s: never positive, zero where particles part. `v_dot_x = v_ij . x_ij` (m^2/s), `r2 = r^2` (m^2), pair mean of `h` (m).
#[inline(always)]
pub fn viscosity_mu<T: Real>(v_dot_x: T, r2: T, h: T) -> T {
    h * v_dot_x.min(T::zero()) / (T::of(0.01) * h).mul_add(h, r2)
}

/// `Pi_ij`, Pa m^6/kg^2 (m^5/(kg s^2)), never negative, from `mu_ij` and the pair means of sound speed (m/s) and of density, the
/// inverse of which (m^3/kg) is given.
#[inline(always)]
pub fn viscous_pressure<T: Real>(p: ViscosityParameters<T>, mu: T, sound_speed_mean: T, inverse_density_mean: T) -> T {
    mu * (p.beta * mu - p.alpha * sound_speed_mean) * inverse_density_mean
}

/// Balsara's switch, between 0 and 1: `|div v| / (|div v| + |curl v| + 1e-4 c/h)` (Balsara 1995) with the velocity gradient `l`
/// (1/s), sound speed (m/s) and smoothing length (m).
#[inline(always)]
pub fn balsara<T: Real>(l: &Tensor<T>, sound_speed: T, h: T) -> T {
    let compression = (l[0][0] + l[1][1] + l[2][2]).abs();
    let curl = [l[2][1] - l[1][2], l[0][2] - l[2][0], l[1][0] - l[0][1]];
    compression / (compression + dot(curl, curl).sqrt() + T::of(1e-4) * sound_speed / h)
}

/// `Pi_ij` times the mean of the two particles' switches ([`balsara`]), so that shear flow is not damped.
#[inline(always)]
pub fn switched<T: Real>(pi: T, switch_i: T, switch_j: T) -> T {
    pi * (switch_i + switch_j) * T::of(0.5)
}

/// Bulk viscosity, a pressure of the particle, Pa: `q = rho (alpha c h |tr L| + beta (h tr L)^2) / 2` in compression, zero in
/// expansion (von Neumann & Richtmyer 1950). `divergence = tr L` (1/s), density (kg/m^3), sound speed (m/s), `h` (m).
#[inline(always)]
pub fn bulk_viscosity<T: Real>(p: ViscosityParameters<T>, divergence: T, density: T, sound_speed: T, h: T) -> T {
    let rate = h * (-divergence).max(T::zero());
    T::of(0.5) * density * (p.alpha * sound_speed * rate + p.beta * rate * rate)
}

/// The divergence of the velocity of a particle (1/s), filtered over the time `h/c` once and twice: `tau dD_1/dt = D - D_1`, `tau dD_2/dt = D_1 - D_2`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilteredDivergence<T> {
    /// `D_1`.
    pub once: T,
    /// `D_2`.
    pub twice: T,
}

/// `(omega h/c)^2` of an oscillation at which the linear bulk viscosity begins to act, and at which all of it does: plane waves of 20 particles in elastic
/// metal have 0.18, of 12 particles 0.5, in what has no strength two thirds of that.
const SHORT_FROM: f64 = 0.3;
const SHORT_AT: f64 = 0.6;

impl<T: Real> FilteredDivergence<T> {
    /// After a step (s) with that divergence (1/s), where sound crosses a smoothing length in a time `tau` (s); and the share of the linear bulk viscosity
    /// that acts, between 0 and 1: none on what changes slowly, all on waves of few particles. Of an oscillation `D - 2 D_1 + D_2` is
    /// `-(omega tau)^2 D_2`, with the `D_2` before the step at all times, whatever the step.
    #[inline(always)]
    pub fn after(self, divergence: T, dt: T, tau: T) -> (Self, T) {
        let part = dt / (dt + tau);
        let once = part.mul_add(divergence - self.once, self.once);
        let twice = part.mul_add(once - self.twice, self.twice);
        let change = (divergence - (once + once) + twice).abs();
        let (from, at) = (T::of(SHORT_FROM), T::of(SHORT_AT));
        let size = self.twice.abs();
        let least = T::of(f64::from(f32::MIN_POSITIVE));
        let share = (change - from * size) / ((at - from) * size).max(least);
        (Self { once, twice }, share.max(T::zero()).min(T::one()))
    }
}

/// Power per mass of the bulk viscosity `q` (Pa), W/kg: `-q tr L/rho` with `divergence = tr L` (1/s) and density (kg/m^3), positive in
/// compression. It goes to the internal energy. Over a step it is that of the mean of the pressures before and after it.
#[inline(always)]
pub fn bulk_viscous_power<T: Real>(q: T, divergence: T, density: T) -> T {
    -(q * divergence) / density
}

/// Compression over a smoothing length, over the sound speed, at which viscosity of shocks begins to act, and at which all of it does. The front of a
/// shock has the jump of velocity over some five spacings: at an impact of 100 m/s in metals 0.003, while waves of 5 m/s with 20 particles in their length
/// have 0.0003. With three times as much a front of 100 m/s in plates overshoots by 14 % after 200 spacings, instead of by 5 %.
const SHOCK_FROM: f64 = 4e-4;
const SHOCK_AT: f64 = 1.2e-3;

/// `(tr D)^2/(D : D)` at which viscosity of shocks begins to act, and at which all of it does.
const COMPRESSED_FROM: f64 = 0.5;
const COMPRESSED_AT: f64 = 0.9;

/// Share `chi` of the viscosity of shocks that acts on a particle, between 0 and 1, from the velocity gradient `l` (1/s), sound speed (m/s) and smoothing
/// length as compressed (m). A rate of compression over the length, relative to the sound speed, lets it rise; the share of compression in the rate of strain,
/// `(tr D)^2/(D : D)`, which is one in a front, keeps it from metal that is sheared: a foot that flows does not feel it. Expansion has none.
#[inline(always)]
pub fn shock_share<T: Real>(l: &Tensor<T>, sound_speed: T, h: T) -> T {
    let (from, at) = (T::of(SHOCK_FROM), T::of(SHOCK_AT));
    let closing = (-(l[0][0] + l[1][1] + l[2][2])).max(T::zero());
    let rise = ((h * closing / sound_speed - from) / (at - from)).max(T::zero()).min(T::one());
    let (xy, yz, zx) = (l[0][1] + l[1][0], l[1][2] + l[2][1], l[2][0] + l[0][2]);
    let normal = l[0][0] * l[0][0] + l[1][1] * l[1][1] + l[2][2] * l[2][2];
    let square = normal + T::of(0.5) * (xy * xy + yz * yz + zx * zx);
    // Nothing moves where it is zero, and the rise is none.
    let compressed = closing * closing / square.max(T::of(f64::from(f32::MIN_POSITIVE)));
    let (from, at) = (T::of(COMPRESSED_FROM), T::of(COMPRESSED_AT));
    rise * ((compressed - from) / (at - from)).max(T::zero()).min(T::one())
}

/// How fast a pair closes, 1/s: `max(0, -v_ij . x_ij)/|x_ij|^2`, of the places now (m). Particles at one place do not close; `h` (m) keeps
/// the number finite.
#[inline(always)]
pub fn closing_rate<T: Real>(v_dot_x: T, x2: T, h: T) -> T {
    (-v_dot_x).max(T::zero()) / (T::of(1e-9) * h).mul_add(h, x2)
}

/// Viscosity of a shock along a pair, Pa: times `V_i V_j w_ij x_ij` it is the force on `i`. `strength = alpha_s`, impedances `chi c rho_0` (Pa s/m), pair mean of `h`
/// (m), [`closing_rate`] (1/s).
#[inline(always)]
pub fn shock_push<T: Real>(strength: T, own: T, other: T, h: T, closing: T) -> T {
    strength * own.max(other) * h * closing
}

/// Sums of one particle over its pairs in shocks, still without the factor `V_i/m_i`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShockSums<T> {
    /// Force per initial volume, N/m^d.
    pub acceleration: Vector<T>,
    /// Heat, half of that of each pair, per initial volume, W/m^d.
    pub power: T,
}

impl<T: Real> ShockSums<T> {
    /// Nothing summed.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { acceleration: [T::zero(); 3], power: T::zero() }
    }

    /// Adds a pair along the `D` axes computed in, at `x_ij` (m), with `v_ij . x_ij` (m^2/s), the [push](shock_push) (Pa) and the weight of the gradient, `V_j w_ij`
    /// (m^-2).
    #[inline(always)]
    pub fn add<const D: usize>(&mut self, x: &Vector<T>, v_dot_x: T, push: T, weight: T) {
        let force = weight * push;
        for a in 0..D {
            self.acceleration[a] = force.mul_add(x[a], self.acceleration[a]);
        }
        self.power = (T::of(-0.5) * force).mul_add(v_dot_x, self.power);
    }
}

/// How fast viscosity damps the motion that particles can have, 1/s: bulk viscosity the one that the velocity gradient sees best, which has the length of
/// four spacings, that of shocks neighbours that swing against each other. A step must be shorter than one over it, because the velocities that forces are
/// evaluated with lag. `mu = h |tr L|` (m/s) and `h` with the length as compressed (m), `initial` the smoothing length at rest (m).
#[inline(always)]
pub fn damping_rate<T: Real>(
    p: ViscosityParameters<T>,
    shocks: T,
    share: T,
    sound_speed: T,
    mu: T,
    h: T,
    initial: T,
) -> T {
    let bulk = T::of(BULK_RATE) * (p.alpha * sound_speed + T::of(2.0) * p.beta * mu) / h;
    bulk + share * T::of(PAIR_RATE) * shocks * sound_speed / initial
}

/// `(h/spacing)^2/2`, as the rate of a diffusion `nu = h (alpha c + 2 beta mu)/2` is `nu/spacing^2`. Edges, whose gradients are one-sided, damp up to four
/// times as fast, for which a Courant number of 0.3 has room: a soft bird that strikes a wall at 116 m/s loses half of its energy to the integration at 0.45.
const BULK_RATE: f64 = 0.6;
/// Twice `2 h^2 sum_j V_j w_ij`, which on a line with `h` 1.1 times the spacing is 2.3: the same motion is borne by the stiffness of the metal.
const PAIR_RATE: f64 = 3.6;

/// What stands for `|mu|` in the time-step limit where viscosity is that of single particles, m/s: `h |tr L|`.
#[inline(always)]
pub fn bulk_mu<T: Real>(l: &Tensor<T>, h: T) -> T {
    h * (l[0][0] + l[1][1] + l[2][2]).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `Pi_ij` and `mu_ij` of a pair.
    fn pair(p: ViscosityParameters<f64>, v_dot_x: f64, r2: f64, h: f64, c: f64, inverse_density: f64) -> (f64, f64) {
        let mu = viscosity_mu(v_dot_x, r2, h);
        (viscous_pressure(p, mu, c, inverse_density), mu)
    }

    #[test]
    fn approaching_pairs_by_hand() {
        // v.x = -0.12, r^2 = 1e-6, h = 1.2e-3: mu = -1.44e-4/1.0144e-6 = -141.9558;
        // (1 5000 141.9558 + 2 141.9558^2)/8000.
        let p = ViscosityParameters { alpha: 1.0, beta: 2.0 };
        let (pi, mu) = pair(p, -0.12, 1.0e-6, 1.2e-3, 5000.0, 1.0 / 8000.0);
        assert!((mu + 141.955_835_962_145).abs() < 1e-9);
        assert!((pi - 93.760_262_317_268_56).abs() < 1e-9, "{pi}");
        // alpha 0.2, beta 4, v.x = -0.003, r^2 = 4e-8, h = 3.6e-4, c = 3630, rho = 7890.
        let p = ViscosityParameters { alpha: 0.2, beta: 4.0 };
        let (pi, mu) = pair(p, -0.003, 4.0e-8, 3.6e-4, 3630.0, 1.0 / 7890.0);
        let size = 1.08e-6 / 4.1296e-8;
        assert!((mu + size).abs() < 1e-11);
        assert!((pi - (726.0 * size + 4.0 * size * size) / 7890.0).abs() < 1e-12);
    }

    #[test]
    fn parting_and_coincident_particles_have_none() {
        let p = ViscosityParameters { alpha: 1.0, beta: 2.0 };
        for (v_dot_x, r2) in [(0.3f64, 1e-6), (0.0, 1e-6), (0.0, 0.0)] {
            assert_eq!(pair(p, v_dot_x, r2, 1e-3, 5000.0, 1.0 / 8000.0), (0.0, 0.0));
        }
    }

    #[test]
    fn balsara_lets_compression_through_and_holds_shear_back() {
        // |tr L| = 3, curl (2, 0, -sqrt(12)) of length 4: 3/(3 + 4 + 1e-4 5000/0.5).
        let l = [[-4.0, 1.0 + 12.0f64.sqrt(), 1.0], [1.0, 1.5, 5.0], [1.0, 7.0, -0.5]];
        assert!((balsara(&l, 5000.0, 0.5) - 0.375).abs() < 1e-15);
        let shear = [[1.0, 9.0, 0.0], [0.0, -1.0, 0.0], [0.0; 3]];
        assert_eq!(balsara(&shear, 5000.0f64, 0.5), 0.0);
        assert_eq!(balsara(&[[9.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], 5000.0f64, 0.5), 0.9);
        // 8 times the mean of 0.5 and 0.75; 3 times that of 1 and 0.
        assert_eq!((switched(8.0, 0.5, 0.75), switched(3.0, 1.0, 0.0)), (5.0, 1.5));
    }

    #[test]
    fn a_shock_is_told_from_waves_shear_and_expansion() {
        let of = |x: f64, y: f64, z: f64, shear: f64| {
            let l = [[x, 2.0 * shear, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
            shock_share(&l, 4000.0, 1e-3)
        };
        // h |tr L|/c of 0.0003, 0.0004, 0.0008, 0.0012 and 0.01 along one axis.
        for (rate, share) in [(1.2e3, 0.0), (1.6e3, 0.0), (3.2e3, 0.5), (4.8e3, 1.0), (40e3, 1.0)] {
            assert!((of(-rate, 0.0, 0.0, 0.0) - share).abs() < 1e-12, "{rate}");
            assert_eq!(of(rate, 0.0, 0.0, 0.0), 0.0);
        }
        // As much along all axes: (tr D)^2 is three times D : D. A foot that keeps its volume has none; half of all
        // where 0.7 of the rate is compression.
        assert_eq!((of(-4e4, -4e4, -4e4, 0.0), of(-4e4, 2e4, 2e4, 0.0), of(0.0, 0.0, 0.0, 0.0)), (1.0, 0.0, 0.0));
        assert!((of(-4e4, 0.0, 0.0, 4e4 * (0.15f64 / 0.7).sqrt()) - 0.5).abs() < 1e-12);
    }

    /// Shares of the linear viscosity over an oscillation of `frequency` times `tau` after it has gone on for long, with steps of `tau/3` and less.
    fn shares(frequency: f64) -> (f64, f64) {
        let (mut last, mut range) = (FilteredDivergence::default(), (1.0_f64, 0.0_f64));
        let (tau, mut time) = (2e-7, 0.0);
        for k in 0..4000 {
            let dt = tau / 3.0 * (1.0 + 0.001 * f64::from(k % 7));
            time += dt;
            let (next, share) = last.after(40.0 * (frequency * time / tau).sin(), dt, tau);
            // Not where the divergence passes through zero, and with it what is compared.
            if k > 1000 && last.twice.abs() > 4.0 {
                range = (range.0.min(share), range.1.max(share));
            }
            last = next;
        }
        range
    }

    #[test]
    fn linear_viscosity_acts_on_short_waves_alone() {
        // Squares of 0.18 and 0.25, less by the finite step; 0.45 is half way; 0.7 and 3.
        for (square, share, within) in
            [(0.18, 0.0, 1e-12), (0.25, 0.0, 1e-12), (0.45, 0.5, 0.1), (0.7, 1.0, 1e-12), (3.0, 1.0, 1e-12)]
        {
            let (least, most) = shares(f64::sqrt(square));
            assert!((least - share).abs() <= within && (most - share).abs() <= within, "{square}: {least} {most}");
        }
    }

    #[test]
    fn a_front_is_short_and_what_goes_on_alike_is_not() {
        let rest = FilteredDivergence::default();
        assert_eq!(rest.after(0.0, 1e-8, 1e-7), (rest, 0.0));
        // By hand: a part of 1/4 of 8 and again of 2; 8 - 4 + 0.5 against nothing.
        let (after, share) = rest.after(8.0, 1.0, 3.0f64);
        assert_eq!((after, share), (FilteredDivergence { once: 2.0, twice: 0.5 }, 1.0));
        // 1/4 of the way from 2 to 8 and from 0.5 to 3.5: 8 - 7 + 1.25 against 0.5.
        assert_eq!(after.after(8.0, 1.0, 3.0), (FilteredDivergence { once: 3.5, twice: 1.25 }, 1.0));
        let mut last = after;
        for _ in 0..100 {
            last = last.after(8.0, 1.0, 3.0).0;
        }
        assert_eq!(last.after(8.0, 1.0, 3.0).1, 0.0);
    }

    #[test]
    fn pairs_in_a_shock_are_pushed_apart_by_hand() {
        // v.x = -6 over |x|^2 = 4: 1.5/s; 0.5 max(20, 30) 0.1 1.5.
        assert!((closing_rate(-6.0, 4.0, 1e-2) - 1.5f64).abs() < 1e-12);
        assert_eq!((closing_rate(6.0, 4.0, 1.0), closing_rate(0.0, 0.0, 1.0)), (0.0, 0.0f64));
        let push = shock_push(0.5, 20.0, 30.0f64, 0.1, 1.5);
        assert!((push - 2.25).abs() < 1e-12 && push == shock_push(0.5, 30.0, 20.0, 0.1, 1.5));
        let mut sums = ShockSums::zero();
        sums.add::<2>(&[2.0, -1.0, 7.0], -6.0, 2.0, 0.25);
        sums.add::<2>(&[0.0, 4.0, 7.0], -1.0, 1.0, 0.5);
        assert_eq!(sums, ShockSums { acceleration: [1.0, 1.5, 0.0], power: 1.75 });
    }

    #[test]
    fn viscosity_limits_the_step_by_hand() {
        // 0.6 (0.1 4000 + 2 8 100)/0.5e-3 + 0.5 3.6 2 4000/1e-3.
        let p = ViscosityParameters { alpha: 0.1, beta: 8.0 };
        let rate = damping_rate(p, 2.0, 0.5, 4000.0f64, 100.0, 0.5e-3, 1e-3);
        assert!((rate - (2.4e6 + 0.5 * 28.8e6)).abs() < 1e-6, "{rate}");
    }

    #[test]
    fn bulk_viscosity_by_hand_and_none_in_expansion() {
        let p = ViscosityParameters { alpha: 0.5, beta: 2.0 };
        // 0.5 8000 (0.5 4000 0.01 100 + 2 (0.01 100)^2) = 4000 (2000 + 2).
        assert!((bulk_viscosity(p, -100.0, 8000.0f64, 4000.0, 0.01) - 8.008e6).abs() < 1e-6);
        assert_eq!(bulk_viscosity(p, 100.0f64, 8000.0, 4000.0, 0.01), 0.0);
        // 0.5 2000 (0.3 1000 2 0.5 + (2 0.5)^2).
        let p = ViscosityParameters { alpha: 0.3, beta: 1.0 };
        assert_eq!(bulk_viscosity(p, -0.5f64, 2000.0, 1000.0, 2.0), 301e3);
        // 8.008 MPa of 8000 kg/m^3 that close at 100/s; what expands has no pressure to work against.
        assert!((bulk_viscous_power(8.008e6, -100.0f64, 8000.0) - 1.001e5).abs() < 1e-9);
        assert_eq!(bulk_viscous_power(301e3, -0.5f64, 2000.0), 75.25);
        assert_eq!(bulk_viscous_power(0.0f64, 100.0, 8000.0), 0.0);
        assert_eq!(bulk_mu(&[[-4.0, 9.0, 9.0], [9.0, 1.0, 9.0], [9.0, 9.0, 1.0f64]], 3.0), 6.0);
    }
}
