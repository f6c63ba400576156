//! Penalty contact between bodies, which push each other and never pull.
//!
//! Particles of different bodies share no kernel sum of stress. They see each other through the *overlap*
//!
//! `s_i = sum_j V_j W_ij / S_ab - 1`,
//!
//! a sum over the neighbours in other bodies with the volumes `V` they have at rest. `S_ab` is the value of the sum for
//! a particle of body `a` one mean spacing from the outermost layer of a flat body `b`, so bodies that just touch have
//! no overlap: contact begins where one lattice would continue the other. A positive overlap stores the energy
//!
//! `U = sum_i V_i K phi(s_i)`,  `phi' = s (1 + s^2/3)`,
//!
//! a contact potential in the sense of Campbell, Vignjevic & Libersky (2000) and Vignjevic, De Vuyst & Campbell (2006),
//! here of the kernel-weighted overlap rather than of single distances. Consequences:
//! - The force is `-grad U`, so stored energy is returned. It is along `x_ij`, equal and opposite, and never attracts,
//!   since `phi' >= 0` and kernels decrease: linear and angular momentum are conserved, pair by pair.
//! - The kernel sum makes a lattice smooth for another one: its rows are not obstacles to sliding, as they would be
//!   with a contact of single pairs.
//! - Stiffness grows with the overlap: bodies that have met at several km/s do not pass through each other.
//!
//! Self-contact of a body works in the same way where different sides of its surface meet ([`crate::surface`]).
//!
//! Damping and friction act along and across the direction `n_ij` of the difference of both overlap gradients, which
//! points from one body to the other and changes its sign with the pair.

use crate::kernel::Kernel;
use crate::tensor::dot;
use crate::time_step::oscillator_limit;
use crate::{Dimension, Elementary, Numbers, Real, Vector};

/// Overlap over which damping sets in, so that it does not jump at first contact.
const ONSET: f64 = 0.2;

/// A flat body seen from outside: kernel sums over its lattice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlatBody {
    /// `sum_j V_j W_j`, a pure number.
    pub sum: f64,
    /// `sum_j V_j |dW_j/dy|` along the normal, 1/m.
    pub slope: f64,
}

/// Kernel sums at a distance `gap` (m) from the outermost layer of a flat body with this spacing and smoothing length, averaged
/// over the position along the surface.
pub fn flat_body(kernel: Kernel, dimension: Dimension, spacing: f64, h: f64, gap: f64) -> FlatBody {
    flat_layers(kernel, dimension, spacing, h, gap, i32::MAX)
}

/// The same for only the outermost `layers` of a flat body.
fn flat_layers(kernel: Kernel, dimension: Dimension, spacing: f64, h: f64, gap: f64, layers: i32) -> FlatBody {
    // Rows within the support, and positions between two rows.
    let rows = (kernel.support() * h / spacing) as i32 + 1;
    const SHIFTS: i32 = 8;
    let d = dimension.count() as i32;
    let scale = kernel.normalisation(dimension) * Real::powu(spacing / h, d as u32);
    let mut flat = FlatBody::default();
    let across = |used: bool| if used { (SHIFTS, rows) } else { (1, 0) };
    let ((shifts_x, rows_x), (shifts_z, rows_z)) = (across(d >= 2), across(d >= 3));
    for (shift_x, shift_z) in (0..shifts_x).flat_map(|a| (0..shifts_z).map(move |b| (a, b))) {
        for layer in 0..(rows + 1).min(layers) {
            let y = gap + f64::from(layer) * spacing;
            for (row_x, row_z) in (-rows_x..=rows_x).flat_map(|a| (-rows_z..=rows_z).map(move |b| (a, b))) {
                let x = spacing * (f64::from(row_x) + f64::from(shift_x) / f64::from(shifts_x));
                let z = spacing * (f64::from(row_z) + f64::from(shift_z) / f64::from(shifts_z));
                let q = Real::sqrt(x * x + y * y + z * z) / h;
                flat.sum += scale * kernel.w(q);
                flat.slope -= scale * kernel.dw_over_q(q) * y / (h * h);
            }
        }
    }
    let shifts = f64::from(shifts_x * shifts_z);
    FlatBody { sum: flat.sum / shifts, slope: flat.slope / shifts }
}

/// Properties of a body for its contact with another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactBody {
    /// Spacing, m.
    pub spacing: f64,
    /// Smoothing length, m.
    pub smoothing_length: f64,
    /// Density at rest, kg/m^3.
    pub density: f64,
    /// Bulk modulus at rest, Pa.
    pub bulk_modulus: f64,
}

/// Strength of the contact, as in a deck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactStrength {
    /// Pressure per closure by one spacing, over the harmonic mean of the bulk moduli.
    pub stiffness: f64,
    /// Share of the critical damping of the two outermost layers.
    pub damping: f64,
    /// Coulomb's coefficient.
    pub friction: f64,
}

/// Contact of a particle of body `a` with one of body `b`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactLaw<T> {
    /// `1/S_ab` and `1/S_ba`.
    pub inverse_sums: (T, T),
    /// `K`, Pa.
    pub modulus: T,
    /// Force per speed of approach and per `V_i V_j |dW/dr|`, Pa s/m.
    pub damping: T,
    /// Coulomb's coefficient.
    pub friction: T,
}

impl ContactLaw<f64> {
    /// The contact of two bodies, bit-identical to the [`Self::turned`] one of both in the other order. Flat faces that
    /// close by a small share `e` of the mean spacing press with `stiffness K_m e`, `K_m` the harmonic mean of the bulk
    /// moduli; approach at the speed `u` adds `damping sqrt(2) Z u`, `Z` the harmonic mean of `sqrt(rho K)`: half a
    /// layer of each body on that spring is critically damped with `damping = 1`.
    pub fn new(
        kernel: Kernel,
        dimension: Dimension,
        a: &ContactBody,
        b: &ContactBody,
        strength: ContactStrength,
    ) -> Self {
        Self::of_layers(kernel, dimension, a, b, strength, i32::MAX)
    }

    /// The contact of a body with itself, in which only particles of the surface, the outermost layer, take part.
    pub fn with_itself(kernel: Kernel, dimension: Dimension, body: &ContactBody, strength: ContactStrength) -> Self {
        Self::of_layers(kernel, dimension, body, body, strength, 1)
    }

    fn of_layers(
        kernel: Kernel,
        dimension: Dimension,
        a: &ContactBody,
        b: &ContactBody,
        strength: ContactStrength,
        layers: i32,
    ) -> Self {
        let flat = |body: &ContactBody, h: f64, gap: f64| flat_layers(kernel, dimension, body.spacing, h, gap, layers);
        let h = 0.5 * (a.smoothing_length + b.smoothing_length);
        let touching = 0.5 * (a.spacing + b.spacing);
        let (from_a, from_b) = (flat(b, h, touching), flat(a, h, touching));
        let mean = |x: f64, y: f64| 2.0 * x * y / (x + y);
        let modulus = strength.stiffness * mean(a.bulk_modulus, b.bulk_modulus);
        let impedance = |c: &ContactBody| Real::sqrt(c.density * c.bulk_modulus);
        // Only the outermost layer of each body has passed the threshold at first: d/dg of its energy per area.
        let relative = |flat: FlatBody, spacing: f64| spacing * (flat.slope / flat.sum) * (flat.slope / flat.sum);
        let response = relative(from_a, a.spacing) + relative(from_b, b.spacing);
        // All pairs across a face, per area: the sum over the layers of one body of their volume per area times the
        // kernel sum of the other. It is the same from both sides, except for the positions along the surface over
        // which it is averaged.
        let seen_from = |own: f64, other: &ContactBody| -> f64 {
            let own_layers = ((kernel.support() * h / own) as i32 + 2).min(layers);
            let shown = |k: i32| flat(other, h, touching + f64::from(k) * own).slope * own;
            (0..own_layers).map(shown).sum()
        };
        let pairs = 0.5 * (seen_from(a.spacing, b) + seen_from(b.spacing, a));
        Self {
            inverse_sums: (1.0 / from_a.sum, 1.0 / from_b.sum),
            modulus: modulus / (touching * response),
            damping: strength.damping * core::f64::consts::SQRT_2 * mean(impedance(a), impedance(b)) / pairs,
            friction: strength.friction,
        }
    }
}

impl ContactLaw<f64> {
    /// In the numbers of another precision.
    pub fn cast<T: Real>(self) -> ContactLaw<T> {
        ContactLaw {
            inverse_sums: (T::of(self.inverse_sums.0), T::of(self.inverse_sums.1)),
            modulus: T::of(self.modulus),
            damping: T::of(self.damping),
            friction: T::of(self.friction),
        }
    }
}

impl<T: Real> ContactLaw<T> {
    /// The same contact seen from body `b`.
    pub fn turned(self) -> Self {
        Self { inverse_sums: (self.inverse_sums.1, self.inverse_sums.0), ..self }
    }
}

/// `phi'` of an overlap; zero where there is none.
#[inline(always)]
fn overlap_pressure<T: Real>(overlap: T) -> T {
    let s = overlap.max(T::zero());
    s * (T::one() + s * s / T::of(3.0))
}

/// `phi''` of an overlap; zero where there is none.
#[inline(always)]
fn overlap_stiffness<T: Real>(overlap: T) -> T {
    T::select_lt(T::zero(), overlap, T::one() + overlap * overlap, T::zero())
}

/// Overlap of a particle with other bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overlap<T> {
    /// `s_i = sum_j V_j W_ij / S_ab - 1`.
    pub overlap: T,
    /// `- grad_i s_i`, 1/m: points away from the other bodies.
    pub away: Vector<T>,
    /// `sum_j V_i V_j |dW/dr|`, m^(d-1).
    pub weight: T,
}

/// Kernel of a pair of particles of different bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactKernel<T> {
    /// `W_ij`, m^-d.
    pub w: T,
    /// `-(1/r) dW/dr`, m^-(d+2).
    pub slope: T,
    /// Distance, m.
    pub r: T,
    /// Smoothing length of the pair, m.
    pub h: T,
}

impl<T: Real> ContactKernel<T> {
    /// At a distance, m, with the smoothing length of the pair, m.
    #[inline]
    pub fn new(kernel: Kernel, dimension: Dimension, r: T, h: T) -> Self {
        let scale = T::of(kernel.normalisation(dimension)) / h.powu(dimension.count() as u32);
        let q = r / h;
        Self { w: scale * kernel.w(q), slope: -scale * kernel.dw_over_q(q) / (h * h), r, h }
    }

    /// `V_i V_j |dW/dr|`, m^(d-1), with the volumes at rest, m^d.
    #[inline(always)]
    pub fn weight(&self, volume_i: T, volume_j: T) -> T {
        volume_i * volume_j * self.slope * self.r
    }
}

impl<T: Real> Overlap<T> {
    /// For a particle with neighbours in other bodies, before the first of them is added.
    pub fn before_the_first() -> Self {
        Self { overlap: -T::one(), away: [T::zero(); 3], weight: T::zero() }
    }

    /// Adds a neighbour in another body at `x_ij` (m); volumes at rest, m^d.
    #[inline(always)]
    pub fn add(&mut self, law: &ContactLaw<T>, kernel: &ContactKernel<T>, x_ij: Vector<T>, volume_i: T, volume_j: T) {
        let share = volume_j * law.inverse_sums.0;
        self.overlap += share * kernel.w;
        self.weight += kernel.weight(volume_i, volume_j);
        for a in 0..3 {
            self.away[a] += share * kernel.slope * x_ij[a];
        }
    }
}

/// A pair of particles of different bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPair<T> {
    /// `x_ij`, m.
    pub x: Vector<T>,
    /// `v_ij`, m/s.
    pub v: Vector<T>,
    /// `V_i V_j |dW/dr|`, m^(d-1).
    pub weight: T,
    /// `s_i`, `s_j`.
    pub overlaps: (T, T),
    /// Difference of the overlap gradients of `i` and `j`, each pointing out of the other body; any length.
    pub direction: Vector<T>,
    /// Largest momentum per speed and time step that friction may transfer, kg/s: the share of this pair in stopping
    /// the sliding of its lighter side.
    pub stopping: T,
}

/// Largest momentum per speed and time step (kg/s) that friction may transfer in a step `dt` (s) through a pair: its
/// share, `weight` over the larger sum of weights of the two particles, in stopping the reduced mass. Masses in kg;
/// zero in a step of zero length.
#[inline(always)]
pub fn stopping<T: Real>(m_i: T, m_j: T, weight: T, weights: (T, T), dt: T) -> T {
    let (zero, reduced) = (T::zero(), m_i * m_j / (m_i + m_j));
    let share = weight / weights.0.max(weights.1);
    T::select_lt(zero, dt, T::select_lt(zero, weight, reduced * share / dt, zero), zero)
}

/// Weight with which a particle with this overlap receives heat from the energy that a contact held and releases.
pub fn share_of_released(overlap: f64) -> f64 {
    overlap.max(0.0).powi(2)
}

/// Stiffness and damping of the contacts of a particle: the diagonal of the second derivative of the energy by its
/// position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactStiffness<T> {
    /// Of the overlaps its neighbours see, N/m.
    stiffness: T,
    /// Largest `K` among its contacts, Pa.
    modulus: T,
    /// N s/m.
    damping: T,
}

impl<T: Real> Numbers<T> for ContactStiffness<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        [&mut self.stiffness, &mut self.modulus, &mut self.damping].into_iter().for_each(visit);
    }
}

impl<T: Real> ContactStiffness<T> {
    /// Before the first neighbour.
    #[inline(always)]
    pub fn none() -> Self {
        Self { stiffness: T::zero(), modulus: T::zero(), damping: T::zero() }
    }

    /// Adds a neighbour in another body with the overlap `s_j`; volumes at rest, m^d.
    #[inline(always)]
    pub fn add(&mut self, law: &ContactLaw<T>, kernel: &ContactKernel<T>, overlaps: (T, T), volume_i: T, volume_j: T) {
        let weight = kernel.weight(volume_i, volume_j);
        let pressed = pair_pressure(law, overlaps);
        let through = volume_i * kernel.slope * kernel.r * law.inverse_sums.1;
        self.stiffness +=
            law.modulus * (volume_j * overlap_stiffness(overlaps.1) * through * through + weight * pressed / kernel.h);
        self.damping += T::select_lt(T::zero(), pressed, law.damping * weight, T::zero());
        self.modulus = self.modulus.max(law.modulus);
    }

    /// Largest stable step, s, of a particle of that volume at rest (m^d) and mass (kg). Twice the diagonal accounts
    /// for neighbours that oscillate against the particle.
    pub fn limit(&self, own: &Overlap<T>, volume: T, mass: T) -> T {
        let stiffness =
            self.stiffness + self.modulus * volume * overlap_stiffness(own.overlap) * dot(own.away, own.away);
        let two = T::of(2.0);
        oscillator_limit(two * stiffness / mass, two * self.damping / mass)
    }
}

/// `phi'(s_i)/S_ab + phi'(s_j)/S_ba`.
#[inline(always)]
fn pair_pressure<T: Real>(law: &ContactLaw<T>, overlaps: (T, T)) -> T {
    overlap_pressure(overlaps.0) * law.inverse_sums.0 + overlap_pressure(overlaps.1) * law.inverse_sums.1
}

/// Force and powers of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactForce<T> {
    /// Force on `i`, N; that on `j` is opposite.
    pub force: Vector<T>,
    /// Power that the pair stores, W; negative if it is returned.
    pub stored: T,
    /// Power that damping converts to heat, W; not negative except for rounding.
    pub damped: T,
    /// Power that friction converts to heat, W; never negative.
    pub rubbed: T,
    /// Speed of approach, m/s; negative if the pair separates.
    pub approach: T,
}

impl<T: Real> ContactForce<T> {
    /// Nothing.
    #[inline(always)]
    pub fn none() -> Self {
        let o = T::zero();
        Self { force: [o; 3], stored: o, damped: o, rubbed: o, approach: o }
    }
}

impl<T: Real> ContactForce<T> {
    /// Power that becomes heat of the particle, W, and the part due to friction: half of the damping power and a share
    /// of the friction power.
    #[inline(always)]
    pub fn own_heat(&self, friction_share: T) -> (T, T) {
        let friction = friction_share * self.rubbed;
        (T::of(0.5) * self.damped + friction, friction)
    }
}

impl<T: Real> Numbers<T> for ContactForce<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        let Self { force: [x, y, z], stored, damped, rubbed, approach } = self;
        [x, y, z, stored, damped, rubbed, approach].into_iter().for_each(visit);
    }
}

/// Force of a pair.
///
/// Elastic: `V_i V_j |dW/dr| K (phi'(s_i)/S_ab + phi'(s_j)/S_ba)` along `x_ij`. Damping: opposes the speed of approach `u` along
/// `n_ij`, never by more than the elastic force where bodies part. Friction: the lesser of `friction` times the normal force and
/// what stops the sliding within a step, against the sliding velocity.
#[inline]
pub fn contact_force<T: Elementary>(law: &ContactLaw<T>, pair: &ContactPair<T>) -> ContactForce<T> {
    let r2 = dot(pair.x, pair.x);
    let n2 = dot(pair.direction, pair.direction);
    // Beyond the reach of the kernel, in pairs of a skin, there is no contact.
    T::if_lt(T::zero(), r2.min(n2).min(pair.weight), || force_in_reach(law, pair, r2, n2), ContactForce::none)
}

#[inline(always)]
fn force_in_reach<T: Elementary>(law: &ContactLaw<T>, pair: &ContactPair<T>, r2: T, n2: T) -> ContactForce<T> {
    let zero = T::zero();
    let (r, length) = (r2.sqrt(), n2.sqrt());
    let normal = pair.direction.map(|c| c / length);
    let speed_n = dot(pair.v, normal);
    let (s_i, s_j) = pair.overlaps;
    let pressure = pair_pressure(law, pair.overlaps);
    let pressed = || {
        let elastic = pair.weight * law.modulus * pressure;
        let onset = ((s_i.max(zero) + s_j.max(zero)) / T::of(ONSET)).min(T::one());
        let damping = (onset * pair.weight * law.damping * -speed_n).max(-elastic);
        let sliding = [0, 1, 2].map(|a| pair.v[a] - speed_n * normal[a]);
        let slip = dot(sliding, sliding).sqrt();
        let along = elastic * dot(pair.x, normal) / r;
        let pressing = (along + damping).max(zero);
        let drag = T::select_lt(zero, slip, (law.friction * pressing / slip).min(pair.stopping), zero);
        ContactForce {
            force: [0, 1, 2].map(|a| elastic * pair.x[a] / r + damping * normal[a] - drag * sliding[a]),
            stored: -elastic * dot(pair.x, pair.v) / r,
            damped: -damping * speed_n,
            rubbed: drag * slip * slip,
            approach: -speed_n,
        }
    };
    T::if_lt(zero, pressure, pressed, || ContactForce { approach: -speed_n, ..ContactForce::none() })
}

#[cfg(test)]
mod tests;
