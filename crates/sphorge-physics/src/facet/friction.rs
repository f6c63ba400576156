//! Friction of facets: a tangential spring per facet that slips.
//!
//! Each facet carries a slip vector `xi` in its plane. Its rate is the mean of the sliding velocities against its partners, weighted with
//! `S = T k_t` (area times tangential stiffness, N/m). A pair of facets pulls with `q = S (xi_a - xi_b)/2`, `xi_b` as seen from `b`; so all pairs of a facet
//! together do the work that its spring, `E = S |xi|^2/4` with the sum `S`, takes up. The force of the spring is limited to half of `mu` times the normal force of its
//! pairs (the other half is that of the partners' springs; all of it against something that has none): what is beyond is slip, whose work is heat.

use super::{Facet, FacetPairLaw, FacetPress, cross};
use crate::tensor::dot;
use crate::{Elementary, Numbers, Real, Vector};

/// The spring of a facet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacetSlip<T> {
    /// `xi` along the first edge of the facet and square to it, m: it turns with the material.
    pub slip: [T; 2],
    /// `S`, N/m, at which the slip was stored.
    pub stiffness: T,
}

impl<T: Real> Numbers<T> for FacetSlip<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        self.slip.each(visit);
        visit(&mut self.stiffness);
    }
}

impl<T: Real> FacetSlip<T> {
    /// Untouched.
    pub fn none() -> Self {
        Self { slip: [T::zero(); 2], stiffness: T::zero() }
    }

    /// `xi` in space, m.
    #[inline]
    pub fn vector(&self, facet: &Facet<T>) -> Vector<T> {
        let [first, second] = axes(facet);
        [0, 1, 2].map(|i: usize| self.slip[0] * first[i] + self.slip[1] * second[i])
    }

    /// What the spring stores, J.
    #[inline]
    pub fn energy(&self) -> T {
        let [x, y] = self.slip;
        T::of(0.25) * self.stiffness * (x * x + y * y)
    }
}

/// Unit vectors in the plane of a facet, along its first edge and square to it.
#[inline(always)]
fn axes<T: Real>(facet: &Facet<T>) -> [Vector<T>; 2] {
    let edge = [0, 1, 2].map(|i: usize| facet.corners[1][i] - facet.corners[0][i]);
    let length = dot(edge, edge).sqrt();
    let first = edge.map(|c| c / length);
    [first, cross(facet.normal, first)]
}

/// What one pair adds to the spring of one of its facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionShare<T> {
    /// `S` of the pair, N/m.
    pub stiffness: T,
    /// Largest force of the spring in this pair, N.
    pub limit: T,
    /// Sliding velocity of the own side against the other, m/s.
    pub velocity: Vector<T>,
}

impl<T: Real> FrictionShare<T> {
    /// What `press` adds to the spring of its facet `a`, and with the velocity the other way round to that of `b`; `velocity` is
    /// [`FacetPress::velocity`]. A partner without a spring (a plane, or what is rigid) leaves all of the force to this one: `alone`.
    #[inline]
    pub fn of(press: &FacetPress<T>, law: &FacetPairLaw<T>, velocity: Vector<T>, alone: bool) -> Self {
        let share = if alone { T::one() } else { T::of(0.5) };
        let along = dot(velocity, press.normal);
        Self {
            stiffness: (share + share) * law.tangential_stiffness * press.area,
            limit: share * law.friction * press.normal_force,
            velocity: [0, 1, 2].map(|i: usize| velocity[i] - along * press.normal[i]),
        }
    }

    /// The share of the other facet.
    #[inline]
    pub fn turned(self) -> Self {
        Self { velocity: self.velocity.map(|c| -c), ..self }
    }
}

/// Sum of the shares of all pairs of a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipDrive<T> {
    stiffness: T,
    limit: T,
    /// `sum S v`, N/s.
    rate: Vector<T>,
}

impl<T: Real> SlipDrive<T> {
    /// Before the first pair.
    pub fn none() -> Self {
        let o = T::zero();
        Self { stiffness: o, limit: o, rate: [o; 3] }
    }

    /// Adds a pair.
    #[inline]
    pub fn add(&mut self, share: &FrictionShare<T>) {
        self.stiffness += share.stiffness;
        self.limit += share.limit;
        (0..3).for_each(|i| self.rate[i] += share.stiffness * share.velocity[i]);
    }
}

impl<T: Real> Numbers<T> for SlipDrive<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        visit(&mut self.stiffness);
        visit(&mut self.limit);
        self.rate.each(visit);
    }
}

/// The spring of a facet after a step `dt` (s), and the heat of the step, J: the work that the spring takes in the step, by the mean of its forces at both ends, less
/// what it stores more than before. So heat and stored energy together are the work of friction exactly. The heat is not negative unless the limit of the
/// force falls faster than the spring relaxes.
///
/// Where the facet loses area, that area's part of the stored energy becomes heat; area that it gains is not stretched yet, so that the force goes on.
#[inline]
pub fn slip_after<T: Elementary>(
    before: &FacetSlip<T>,
    facet: &Facet<T>,
    drive: &SlipDrive<T>,
    dt: T,
) -> (FacetSlip<T>, T) {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let stiffness = drive.stiffness;
    let touching = || {
        let axes = axes(facet);
        let way = axes.map(|axis| dt * dot(drive.rate, axis) / stiffness);
        let kept = (before.stiffness / stiffness).min(one);
        let trial = [0, 1].map(|i: usize| kept * before.slip[i] + way[i]);
        let size = (trial[0] * trial[0] + trial[1] * trial[1]).sqrt();
        let longest = (drive.limit + drive.limit) / stiffness;
        let share = T::select_lt(longest, size, longest / size, one);
        let slip = trial.map(|c| share * c);
        let after = FacetSlip { slip, stiffness };
        let pull = |state: &FacetSlip<T>, i: usize| half * state.stiffness * state.slip[i];
        let work = half * ((pull(before, 0) + pull(&after, 0)) * way[0] + (pull(before, 1) + pull(&after, 1)) * way[1]);
        [slip[0], slip[1], stiffness, work + (before.energy() - after.energy())]
    };
    let [x, y, stiffness, heat] = T::if_lt(zero, stiffness, touching, || [zero, zero, zero, before.energy()]);
    (FacetSlip { slip: [x, y], stiffness }, heat)
}

/// Friction force on the owner of `a`, N, to be added [at the centre](FacetPress::add_at_centre) of pressure: `-S (xi_a - xi_b)/2` in the plane square to `m`; `-S xi_a/2` against
/// something without a spring, whose `S` is twice `T k_t`. With the springs after the update and the pressures with which they were updated.
#[inline]
pub fn friction_force<T: Real>(
    press: &FacetPress<T>,
    law: &FacetPairLaw<T>,
    slip_a: Vector<T>,
    slip_b: Vector<T>,
    alone: bool,
) -> Vector<T> {
    let share = FrictionShare::of(press, law, slip_a, alone).stiffness;
    let apart = [0, 1, 2].map(|i: usize| slip_a[i] - slip_b[i]);
    let along = dot(apart, press.normal);
    let half = T::of(0.5);
    [0, 1, 2].map(|i: usize| -half * share * (apart[i] - along * press.normal[i]))
}

/// Damping of the spring of `a` against something rigid: the force on its owner, N, to be added at the centre of pressure to that of the spring,
/// and the power that it turns to heat, W. `coefficient` times area and sliding velocity, as far as the force of the spring leaves room below `mu` times
/// the normal force: what sticks comes to rest, what slides is not held by more.
#[inline]
pub fn damp_sliding<T: Elementary>(
    press: &FacetPress<T>,
    law: &FacetPairLaw<T>,
    coefficient: T,
    spring: Vector<T>,
    velocity: Vector<T>,
) -> (Vector<T>, T) {
    let (zero, one) = (T::zero(), T::one());
    let along = dot(velocity, press.normal);
    let sliding = [0, 1, 2].map(|i: usize| velocity[i] - along * press.normal[i]);
    let damping = coefficient * press.damped_area;
    let full = sliding.map(|v| -damping * v);
    // The largest share at which the sum is within the limit: of |q + s d|^2 = limit^2.
    let limit = law.friction * press.normal_force;
    let (square, mixed) = (dot(full, full), dot(spring, full));
    let room = (limit * limit - dot(spring, spring)).max(zero);
    let root = (mixed * mixed + square * room).max(zero).sqrt();
    let share = T::select_lt(zero, square, ((root - mixed) / square).min(one).max(zero), zero);
    let force = full.map(|c| share * c);
    (force, -dot(force, velocity))
}
