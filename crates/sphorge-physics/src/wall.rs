//! Rigid walls: how far a particle is from them, and forces that push and never pull.

use crate::tensor::dot;
use crate::{Real, Scalar, Tensor, Vector};

/// Smallest relative distance the repulsion is evaluated at: it is finite for particles on or behind the wall.
const CLOSEST: f64 = 0.01;

/// Way from a wall to a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<T> {
    /// Distance of the particle's centre, m; negative behind a plane.
    pub distance: T,
    /// Unit normal of the wall there, towards the particle, or to the side of a plane where material is.
    pub normal: Vector<T>,
}

impl<T: Real> Gap<T> {
    /// To a plane through a point (m) with a unit normal.
    #[inline]
    pub fn to_plane(x: Vector<T>, point: Vector<T>, normal: Vector<T>) -> Self {
        Self { distance: dot(difference(x, point), normal), normal }
    }
}

/// As far as nothing that a wall pushes is, m.
const FAR: f64 = 1e30;

impl<T: Real> Gap<T> {
    /// To a straight segment between two ends (m), which act like points; on the line itself, where no direction is away from it, as far as
    /// nothing is.
    #[inline]
    pub fn beside_segment(x: Vector<T>, from: Vector<T>, to: Vector<T>) -> Self {
        let along = difference(to, from);
        let offset = difference(x, from);
        let s = (dot(offset, along) / dot(along, along)).max(T::zero()).min(T::one());
        let away = difference(offset, along.map(|c| s * c));
        let distance = dot(away, away).sqrt();
        let beside = |is: T, not: T| T::select_lt(T::zero(), distance, is, not);
        Self { distance: beside(distance, T::of(FAR)), normal: away.map(|c| beside(c / distance, T::zero())) }
    }
}

impl<T: Scalar> Gap<T> {
    /// The same; `None` on the line itself.
    #[inline]
    pub fn to_segment(x: Vector<T>, from: Vector<T>, to: Vector<T>) -> Option<Self> {
        let gap = Self::beside_segment(x, from, to);
        (gap.distance < T::of(FAR)).then_some(gap)
    }
}

/// `a - b`.
#[inline(always)]
fn difference<T: Real>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Repulsion of a wall (Monaghan & Kos 1999): acceleration, m/s^2, along the wall's normal and never towards the wall.
///
/// `R(q) = A (1 - q)/sqrt(q)`, `q = distance/range`, zero from `q = 1` on, `A = (0.01 c^2 + c max(u, 0))/h`, where `u` is the
/// speed of approach, of the `velocity` (m/s) relative to the wall. `range` and `h` in m, sound speed in m/s; below a hundredth of
/// the range, and behind the wall, the value at a hundredth is kept.
#[inline]
pub fn monaghan_kos<T: Real>(gap: &Gap<T>, velocity: Vector<T>, range: T, sound_speed: T, h: T) -> Vector<T> {
    let approach_speed = -dot(velocity, gap.normal);
    let q = (gap.distance / range).max(T::of(CLOSEST)).min(T::one());
    let strength = (T::of(0.01) * sound_speed + approach_speed.max(T::zero())) * sound_speed / h;
    let acceleration = strength * (T::one() - q) / q.sqrt();
    gap.normal.map(|n| acceleration * n)
}

/// Stiffness, damping and friction of a penalty contact, per mass of the particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PenaltyParameters<T> {
    /// Acceleration per depth of penetration, 1/s^2: the square of the frequency of a particle on the wall.
    pub stiffness: T,
    /// Acceleration per speed of approach, 1/s.
    pub damping: T,
    /// Coulomb's coefficient.
    pub friction: T,
}

impl<T: Real> PenaltyParameters<T> {
    /// Stiffness `scale (c/l)^2` with the frequency `c/l` of sound (m/s) across a length (m), such as the spacing, and damping as a
    /// fraction of the critical, `2 ratio sqrt(stiffness)`.
    #[inline]
    pub fn from_sound_speed(sound_speed: T, length: T, scale: T, damping_ratio: T, friction: T) -> Self {
        let frequency = scale.sqrt() * sound_speed / length;
        Self { stiffness: frequency * frequency, damping: T::of(2.0) * damping_ratio * frequency, friction }
    }
}

/// What a penalty contact does to a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallPush<T> {
    /// Acceleration, m/s^2.
    pub acceleration: Vector<T>,
    /// Power damping and friction turn to heat, W/kg; never negative.
    pub heat: T,
    /// Friction's part of it, W/kg.
    pub rubbed: T,
}

/// What a wall does to a particle, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacePush<T> {
    /// Acceleration, m/s^2.
    pub acceleration: Vector<T>,
    /// Heat of damping and friction, all of which stays in the particle, W/kg.
    pub heat: T,
    /// Friction's part of it, W/kg.
    pub rubbed: T,
    /// Where the wall meets the particle, from its centre in the reference configuration with the sign turned, m; zero where it meets the centre.
    pub face: Vector<T>,
    /// Velocity of that point, m/s.
    pub velocity: Vector<T>,
}

/// What gravity and all walls do to a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePushes<T> {
    /// Acceleration, m/s^2.
    pub acceleration: Vector<T>,
    /// Power beyond that of the forces on the centre, W/kg.
    pub beyond: T,
    /// Moment of the forces about the centre per mass, in the reference configuration, m^2/s^2.
    pub moment: Tensor<T>,
}

impl<T: Real> FacePushes<T> {
    /// Gravity alone, m/s^2.
    #[inline(always)]
    pub fn of_gravity(gravity: Vector<T>) -> Self {
        Self { acceleration: gravity, beyond: T::zero(), moment: [[T::zero(); 3]; 3] }
    }

    /// Adds what a wall does to a particle whose centre has a velocity (m/s); its power, W/kg.
    #[inline(always)]
    pub fn add(&mut self, push: &FacePush<T>, velocity: Vector<T>) -> T {
        let force = push.acceleration;
        let at_centre = dot(force, velocity);
        let whole = dot(force, push.velocity) + push.heat;
        self.beyond += whole - at_centre;
        for a in 0..3 {
            self.acceleration[a] += force[a];
            (0..3).for_each(|c| self.moment[a][c] += force[a] * push.face[c]);
        }
        whole
    }

    /// Adds what a wall does to the facets of a particle of a mass (kg): a force (N), its moment as a first Piola-Kirchhoff stress times the
    /// reference volume (N m), both with their power (W), and heat (W). Returns the whole power, W/kg.
    #[inline(always)]
    pub fn add_at_facets(
        &mut self,
        mass: T,
        (force, of_force): (Vector<T>, T),
        (moment, of_moment): (Tensor<T>, T),
        heat: T,
    ) -> T {
        let beyond = (of_moment + heat) / mass;
        self.beyond += beyond;
        for a in 0..3 {
            self.acceleration[a] += force[a] / mass;
            (0..3).for_each(|c| self.moment[a][c] += -moment[a][c] / mass);
        }
        of_force / mass + beyond
    }

    /// The first Piola-Kirchhoff stress that the moment is for a particle of that mass (kg) and volume (m^d) in the reference configuration, Pa.
    #[inline(always)]
    pub fn stress(&self, mass: T, reference_volume: T) -> Tensor<T> {
        self.moment.map(|row| row.map(|c| mass / reference_volume * c))
    }
}

/// What the spring of a [`penalty_contact`] holds, J/kg.
#[inline]
pub fn penalty_energy<T: Real>(p: PenaltyParameters<T>, gap: &Gap<T>, radius: T) -> T {
    let penetration = (radius - gap.distance).max(T::zero());
    T::of(0.5) * p.stiffness * penetration * penetration
}

/// Penalty contact with Coulomb friction.
///
/// Surfaces touch when the particle, a ball of that `radius` (m), does. Along the normal: `a_n = max(k d + b u, 0)` at a penetration
/// `d = radius - distance > 0` with speed of approach `u`, else zero: damping alone never pulls. Friction:
/// `min(mu a_n, |v_t|/dt)` against the sliding velocity `v_t`: within the step `dt` (s) it can stop the sliding but not turn it
/// round. `velocity` (m/s) is relative to the wall. What is neither stored in the spring nor given back by it is heat:
/// `(a_n - k d) u + friction |v_t|`.
#[inline]
pub fn penalty_contact<T: Real>(
    p: PenaltyParameters<T>,
    gap: &Gap<T>,
    radius: T,
    velocity: Vector<T>,
    dt: T,
) -> WallPush<T> {
    let zero = T::zero();
    let n = gap.normal;
    let approach_speed = -dot(velocity, n);
    let sliding = [0, 1, 2].map(|a| velocity[a] + approach_speed * n[a]);
    let penetration = radius - gap.distance;
    let touching = |value: T| T::select_lt(zero, penetration, value, zero);
    let elastic = touching(p.stiffness * penetration);
    let normal = touching((elastic + p.damping * approach_speed).max(zero));
    let speed = dot(sliding, sliding).sqrt();
    let drag = (p.friction * normal / speed).min(T::one() / dt);
    let drag = touching(T::select_lt(zero, speed, T::select_lt(zero, dt, drag, zero), zero));
    let rubbed = drag * speed * speed;
    let heat = (normal - elastic) * approach_speed + rubbed;
    WallPush { acceleration: [0, 1, 2].map(|a| normal * n[a] + -drag * sliding[a]), heat, rubbed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_walls_do_at_faces_by_hand() {
        let mut pushes = FacePushes::of_gravity([0.0, -10.0, 0.0f64]);
        // 4 (3 - 1) + 2 beyond the centre, 4 3 + 2 in all.
        let push = FacePush {
            acceleration: [0.0, 4.0, 0.0],
            heat: 2.0,
            rubbed: 1.0,
            face: [0.5, 2.0, 0.0],
            velocity: [9.0, 3.0, 0.0],
        };
        assert_eq!(pushes.add(&push, [9.0, 1.0, 0.0]), 14.0);
        assert_eq!((pushes.acceleration, pushes.beyond), ([0.0, -6.0, 0.0], 10.0));
        assert_eq!(pushes.moment, [[0.0; 3], [2.0, 8.0, 0.0], [0.0; 3]]);
        // One that pushes the centre along x: no moment, no power beyond.
        let push = FacePush { acceleration: [3.0, 0.0, 0.0], velocity: [-2.0, 0.0, 0.0], ..FacePush::default() };
        assert_eq!(pushes.add(&push, [-2.0, 0.0, 0.0]), -6.0);
        assert_eq!((pushes.acceleration, pushes.beyond), ([3.0, -6.0, 0.0], 10.0));
        assert_eq!(pushes.stress(6.0, 2.0), [[0.0; 3], [6.0, 24.0, 0.0], [0.0; 3]]);
        // At facets of a particle of 2 kg: 8 N, of 4 W, and the opposite of the moment above, of -6 W, and heat of 2 W.
        let moment = [[0.0; 3], [4.0, 16.0, 0.0], [0.0; 3]];
        assert_eq!(pushes.add_at_facets(2.0, ([8.0, 0.0, 0.0], 4.0), (moment, -6.0), 2.0), 0.0);
        assert_eq!((pushes.acceleration, pushes.beyond, pushes.moment), ([7.0, -6.0, 0.0], 8.0, [[0.0; 3]; 3]));
    }

    const UP: Vector<f64> = [0.0, 1.0, 0.0];

    fn at(distance: f64) -> Gap<f64> {
        Gap { distance, normal: UP }
    }

    #[test]
    fn gap_of_a_plane_and_of_a_segment_and_its_ends() {
        assert_eq!(Gap::to_plane([7.0, 2.5, 0.0], [9.0, -1.0, 5.0], UP), at(3.5));
        let gap = Gap::to_plane([3.0f64, 1.0, 2.0], [1.0, 1.0, 1.0], [0.6, 0.0, -0.8]);
        assert!((gap.distance - 0.4).abs() < 1e-15);
        let gap = |x| Gap::to_segment(x, [0.0; 3], [2.0, 0.0, 0.0]);
        assert_eq!(gap([1.0, -3.0, 0.0]), Some(Gap { distance: 3.0, normal: [0.0, -1.0, 0.0] }));
        assert_eq!(gap([5.0, 4.0, 0.0]), Some(Gap { distance: 5.0, normal: [0.6, 0.8, 0.0] }));
        assert_eq!(gap([-0.6, 0.8, 0.0]), Some(Gap { distance: 1.0, normal: [-0.6, 0.8, 0.0] }));
        assert_eq!(gap([1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn repulsion_by_hand() {
        // A = (0.01 3630^2 + 3630 200)/3.6e-4 = 857769/3.6e-4; q = 0.25: 0.75/0.5.
        let a = 857_769.0 / 3.6e-4;
        let got = monaghan_kos(&at(1.5e-4), [70.0, -200.0, 0.0], 6.0e-4, 3630.0, 3.6e-4);
        assert!((got[1] - 1.5 * a).abs() < 1e-9 * a && got[0] == 0.0);
        // Leaving at 50 m/s: only 0.01 c^2/h = 0.01 1e6/0.5; q = 0.64: 0.36/0.8.
        let gap = Gap { distance: 0.32, normal: [0.6, 0.0, -0.8f64] };
        let got = monaghan_kos(&gap, [30.0, 0.0, -40.0], 0.5, 1000.0, 0.5);
        assert!((got[0] - 5400.0).abs() < 1e-9 && (got[2] + 7200.0).abs() < 1e-9);
    }

    #[test]
    fn repulsion_ends_at_its_range_and_stays_finite_behind_the_wall() {
        assert_eq!(monaghan_kos(&at(1.0), [0.0, -100.0, 0.0], 1.0, 1000.0, 1.0)[1], 0.0);
        assert_eq!(monaghan_kos(&at(7.0), [0.0, -100.0, 0.0], 1.0, 1000.0, 1.0)[1], 0.0);
        // A = 1e4; (1 - 0.01)/0.1.
        for distance in [0.01, 1e-9, 0.0, -3.0] {
            assert!((monaghan_kos(&at(distance), [0.0; 3], 1.0, 1000.0, 1.0)[1] - 9.9e4).abs() < 1e-8);
        }
    }

    fn assert_near(got: Vector<f64>, want: Vector<f64>) {
        assert!((0..3).all(|a| (got[a] - want[a]).abs() < 1e-9), "{got:?} {want:?}");
    }

    #[test]
    fn penalty_by_hand() {
        // d = 0.005 - 0.003: k d + b u = 1e6 0.002 + 100 3 = 2300; mu 0.2: 460 along -(3, 0, 4)/5.
        let p = PenaltyParameters { stiffness: 1.0e6, damping: 100.0, friction: 0.2 };
        let push = penalty_contact(p, &at(0.003), 0.005, [3.0, -3.0, 4.0], 1e-5);
        assert_near(push.acceleration, [-276.0, 2300.0, -368.0]);
        // Damping 300 at 3 m/s, friction 460 at 5 m/s.
        assert!((push.heat - 3200.0).abs() < 1e-9 && (push.rubbed - 2300.0).abs() < 1e-9);
        // On a slope, behind the plane, no sliding: 1e6 0.006 - 100 10 = 5000 along the normal.
        let gap = Gap { distance: -0.001, normal: [0.6, 0.0, -0.8] };
        let push = penalty_contact(p, &gap, 0.005, [6.0, 0.0, -8.0], 1e-5);
        assert_near(push.acceleration, [3000.0, 0.0, -4000.0]);
        assert!((push.heat - 1e4).abs() < 1e-9 && push.rubbed == 0.0);
        // A spring of 1e6 pressed by 0.006, and one not touched.
        assert_eq!((penalty_energy(p, &gap, 0.005), penalty_energy(p, &at(0.006), 0.005)), (18.0, 0.0));
        // From c/l: (0.5 (1000/0.1)^2, 2 0.25 sqrt(that)).
        let p = PenaltyParameters::from_sound_speed(1000.0f64, 0.1, 0.5, 0.25, 0.1);
        assert!((p.stiffness - 5.0e7).abs() < 1e-6 && (p.damping - 3_535.533_905_932_738).abs() < 1e-9);
        // 4 (5000/0.002)^2, 2 0.1 2 2.5e6.
        let p = PenaltyParameters::from_sound_speed(5000.0f64, 0.002, 4.0, 0.1, 0.3);
        assert_eq!(p, PenaltyParameters { stiffness: 2.5e13, damping: 1.0e6, friction: 0.3 });
    }

    #[test]
    fn contact_never_pulls_and_friction_at_most_stops() {
        let p = PenaltyParameters { stiffness: 1.0e6, damping: 1.0e4, friction: 0.5 };
        let touching = at(0.003);
        // Leaving fast: damping would pull.
        let push = penalty_contact(p, &touching, 0.005, [1.0, 10.0, 0.0], 1e-5);
        assert_near(push.acceleration, [0.0; 3]);
        // The spring lets go of 2000 at 10 m/s.
        assert!((push.heat - 2e4).abs() < 1e-9);
        // Not touching.
        assert_eq!(penalty_contact(p, &at(0.007), 0.005, [1.0, -50.0, 0.0], 1e-5), WallPush::default());
        // Slow sliding: just stopped within the step.
        let slow = penalty_contact(p, &touching, 0.005, [0.0, 0.0, -1e-4], 1e-5);
        assert!((slow.acceleration[2] * 1e-5 - 1e-4).abs() < 1e-18);
        // No sliding, no friction, nothing undefined.
        assert_near(penalty_contact(p, &touching, 0.005, [0.0; 3], 0.0).acceleration, [0.0, 2000.0, 0.0]);
        // In a step of no length friction has nothing to stop.
        assert_near(penalty_contact(p, &touching, 0.005, [1.0, 0.0, 0.0], 0.0).acceleration, [0.0, 2000.0, 0.0]);
    }
}
