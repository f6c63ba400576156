//! Energy, force and moments of a pair of facets.

use super::clip::{Line, Place, Vertex, along, clip, difference, polygon, turn};
use super::edges::EdgeForces;
use super::lap::{Lap, Lapped};
use super::spread::{NODES, Spread};
use super::{Facet, MOBILITY, cross};
use crate::tensor::{apply, dot};
use crate::time_step::oscillator_limit;
use crate::{Dimension, Elementary, Numbers, Real, SymmetricTensor, Tensor, Vector};

/// What the contact needs of a body; a rigid one has the half depth zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetMaterial {
    /// Half of the spacing at rest, m.
    pub half_depth: f64,
    /// Density at rest, kg/m^3.
    pub density: f64,
    /// Bulk modulus at rest, Pa.
    pub bulk_modulus: f64,
}

/// Strength of the contact of facets, as in a deck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetStrength {
    /// `f`: pressure over that of the same closure of the half cells on both sides, by their bulk moduli.
    pub stiffness: f64,
    /// Share of the critical damping of the half cells.
    pub damping: f64,
    /// Coulomb's coefficient.
    pub friction: f64,
}

/// What the flat faces of bodies have to withstand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacetImpact {
    /// Pressure that they bear, Pa.
    pub pressure: f64,
    /// Energy that the cells on both sides bring, over the area and `D`, J/m^3.
    pub energy: f64,
}

/// The contact of facets of two bodies; the same for both orders.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacetPairLaw<T> {
    /// `k`, pressure per closure, Pa/m.
    pub stiffness: T,
    /// `zeta sqrt(2) Z`, pressure per speed of approach, Pa s/m.
    pub damping: T,
    /// Coulomb's coefficient.
    pub friction: T,
    /// `k_t`, Pa/m.
    pub tangential_stiffness: T,
    /// Closure over `D` from which on it falls again, so that nothing is left where owners pass each other; zero where it never does, as at rigid planes
    /// ([`Self::giving_way`]).
    pub gives_way: T,
    /// Distance over the size of a facet within which edges coincide, where places are rounded more than by the numbers that the law is computed in; never less
    /// than `2^-26` and 64 roundings of these numbers.
    pub coincidence: T,
}

/// `k_t` over `k`.
const TANGENTIAL: f64 = 0.5;

/// Closure over `D` from which on a pair is closed less again, at least. Its pressure there is 1.5 `k D`, some hundred GPa for metals.
const GIVES_WAY: f64 = 0.5;

/// Distance of owners along `m` over `D` above which a pair that gives way presses with all of its closure, and none of it where they pass each other, over what
/// is left between them where it begins to give way.
const IN_ORDER: f64 = 0.6;

impl FacetPairLaw<f64> {
    /// `k = f / (D_a/K_a + D_b/K_b)`; damping `zeta sqrt(2) Z` with the harmonic mean `Z` of `sqrt(rho K)`. Bit-identical in both orders.
    pub fn new(a: &FacetMaterial, b: &FacetMaterial, strength: FacetStrength) -> Self {
        let impedance = |c: &FacetMaterial| Real::sqrt(c.density * c.bulk_modulus);
        let (z_a, z_b) = (impedance(a), impedance(b));
        let yielding = a.half_depth / a.bulk_modulus + b.half_depth / b.bulk_modulus;
        Self::of(yielding, 2.0 * z_a * z_b / (z_a + z_b), strength)
    }

    /// Against something rigid: twice as stiff and damped by twice the body's own impedance, as the limit of a rigid second body.
    pub fn against_rigid(a: &FacetMaterial, strength: FacetStrength) -> Self {
        let impedance = Real::sqrt(a.density * a.bulk_modulus);
        Self::of(a.half_depth / a.bulk_modulus, 2.0 * impedance, strength)
    }

    /// Damping of the tangential spring of a cell of a body, half of what is critical for the [mobility](MOBILITY) of its face, Pa s/m:
    /// `sqrt(k_t rho 2 D/beta)`. The force lags by a step: all of it swings from step to step, without end.
    pub fn sliding_damping(&self, a: &FacetMaterial) -> f64 {
        Real::sqrt(self.tangential_stiffness * a.density * 2.0 * a.half_depth / MOBILITY)
    }

    fn of(yielding: f64, impedance: f64, strength: FacetStrength) -> Self {
        let stiffness = strength.stiffness / yielding;
        Self {
            stiffness,
            damping: strength.damping * core::f64::consts::SQRT_2 * impedance,
            friction: strength.friction,
            tangential_stiffness: if strength.friction > 0.0 { TANGENTIAL * stiffness } else { 0.0 },
            gives_way: 0.0,
            coincidence: 0.0,
        }
    }

    /// Of cells that may come to lie beside and behind each other, as where bodies break or dig in with a corner: a pair would begin to press with all of `D`
    /// closed as soon as its owners are in order. Between that and half of `D` pairs give way instead, from nothing on; or between that and more of `D`, where an
    /// impact asks for it, and not at all where that would be more than 0.8 `D`. `closed` is `k D` of the bodies at rest, Pa.
    ///
    /// Of `phi = x^2/(2 u)` and `phi' = (1 - u^2)/(2 u^2)` with `u = 1 - x` (33b).
    pub fn giving_way(self, impact: FacetImpact, closed: f64) -> Self {
        let for_pressure = 1.0 / Real::sqrt(1.0 + 2.0 * impact.pressure / closed);
        let ratio = 1.0 + impact.energy / closed;
        let for_energy = 1.0 / (ratio + Real::sqrt(ratio * ratio - 1.0));
        let way = GIVES_WAY.max(1.0 - for_pressure.min(for_energy));
        Self { gives_way: if way > STIFFEST { 0.0 } else { way }, ..self }
    }

    /// In the numbers of another precision.
    pub fn cast<T: Real>(self) -> FacetPairLaw<T> {
        FacetPairLaw {
            gives_way: T::of(self.gives_way),
            coincidence: T::of(self.coincidence),
            stiffness: T::of(self.stiffness),
            damping: T::of(self.damping),
            friction: T::of(self.friction),
            tangential_stiffness: T::of(self.tangential_stiffness),
        }
    }
}

/// What the second facet of a pair is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Partner {
    /// A facet with edges: of a body, or rigid.
    Facet,
    /// A plane without end, [`Facet::foot_on_plane`] of the first facet.
    Plane,
}

/// What the elastic part of the contact of a pair of facets is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacetPress<T> {
    /// `U`, J (J/m in the plane); zero where the pair does not press.
    pub energy: T,
    /// Force on the owner of `a`, N (N/m); that on the owner of `b` is exactly the opposite.
    pub force: Vector<T>,
    /// Moment on the owner of `a`, N m (N): power `M:L` beyond `f.v`. Of edges as if they were where the owner carries them ([`EdgeForces::on_cell`]).
    pub moment_a: Tensor<T>,
    /// Moment on the owner of `b`.
    pub moment_b: Tensor<T>,
    /// What of force and moment is on the edges of `a`.
    pub edges_a: EdgeForces<T>,
    /// The same of `b`.
    pub edges_b: EdgeForces<T>,
    /// Integral of the pressure over the common polygon, N (N/m), never negative: the normal force that friction is limited by.
    pub normal_force: T,
    /// Area over which the pair presses, m^2 (m), zero where it does not; it grows over a ten-millionth of the distance of the owners at touch.
    pub area: T,
    /// The same with less weight where the closure is less than a thousandth of the distance of the owners at touch: the area of
    /// damping, which so does not jump at touch.
    pub damped_area: T,
    /// `m`: unit vector from `b` to `a`.
    pub normal: Vector<T>,
    /// From the owner of `a` to the centre of pressure, m. It is half-way between both surfaces.
    pub centre_a: Vector<T>,
    /// From the owner of `b` to the same point, m.
    pub centre_b: Vector<T>,
    /// Largest derivative of the pressure by the closure, Pa/m, for the time step.
    pub stiffness: T,
}

impl<T: Real> FacetPress<T> {
    /// No contact.
    #[inline(always)]
    pub fn none() -> Self {
        let o = T::zero();
        Self {
            energy: o,
            force: [o; 3],
            moment_a: [[o; 3]; 3],
            moment_b: [[o; 3]; 3],
            edges_a: EdgeForces::none(),
            edges_b: EdgeForces::none(),
            normal_force: o,
            area: o,
            damped_area: o,
            normal: [o; 3],
            centre_a: [o; 3],
            centre_b: [o; 3],
            stiffness: o,
        }
    }

    /// So many times the same, zero to one.
    #[inline(always)]
    pub(super) fn times(&self, share: T) -> Self {
        let vector = |v: Vector<T>| v.map(|c| share * c);
        Self {
            energy: share * self.energy,
            force: vector(self.force),
            moment_a: self.moment_a.map(vector),
            moment_b: self.moment_b.map(vector),
            edges_a: self.edges_a.times(share),
            edges_b: self.edges_b.times(share),
            normal_force: share * self.normal_force,
            area: share * self.area,
            damped_area: share * self.damped_area,
            ..*self
        }
    }

    /// The same in a space of so many dimensions: along the others forces of strips are zero but for rounding, and nothing moves.
    #[inline]
    pub fn within(self, dimension: Dimension) -> Self {
        let zero = T::zero();
        let vector = |v: Vector<T>| [0, 1, 2].map(|i: usize| if i < dimension.count() { v[i] } else { zero });
        let tensor =
            |t: Tensor<T>| [0, 1, 2].map(|i: usize| if i < dimension.count() { vector(t[i]) } else { [zero; 3] });
        let edges = |of: EdgeForces<T>| EdgeForces { force: vector(of.force), moment: tensor(of.moment), ..of };
        Self {
            force: vector(self.force),
            moment_a: tensor(self.moment_a),
            moment_b: tensor(self.moment_b),
            edges_a: edges(self.edges_a),
            edges_b: edges(self.edges_b),
            normal: vector(self.normal),
            centre_a: vector(self.centre_a),
            centre_b: vector(self.centre_b),
            ..self
        }
    }

    /// Velocity of the material of `a` at the centre of pressure relative to that of `b`, m/s, from the velocities (m/s) and velocity gradients
    /// (1/s) of the owners.
    #[inline]
    pub fn velocity(&self, v_a: Vector<T>, l_a: &Tensor<T>, v_b: Vector<T>, l_b: &Tensor<T>) -> Vector<T> {
        let (turn_a, turn_b) = (apply(l_a, self.centre_a), apply(l_b, self.centre_b));
        [0, 1, 2].map(|i| (v_a[i] + turn_a[i]) - (v_b[i] + turn_b[i]))
    }

    /// Force of the damping on the owner of `a`, N, at the centre of pressure, and the power it turns to heat, W, never negative. `velocity` is that of
    /// [`Self::velocity`]. Damping acts by `zeta sqrt(2) Z` times the speed of approach over the area, and never pulls by more than the pressure pushes.
    #[inline]
    pub fn damping(&self, law: &FacetPairLaw<T>, velocity: Vector<T>) -> (Vector<T>, T) {
        let approach = -dot(velocity, self.normal);
        let force = (law.damping * self.damped_area * approach).max(-self.normal_force);
        (self.normal.map(|m| force * m), force * approach)
    }

    /// Adds a force (N) on `a`, and the opposite one on `b`, at the centre of pressure.
    #[inline]
    pub fn add_at_centre(&mut self, force: Vector<T>) {
        for i in 0..3 {
            self.force[i] += force[i];
            for j in 0..3 {
                self.moment_a[i][j] += force[i] * self.centre_a[j];
                self.moment_b[i][j] += -force[i] * self.centre_b[j];
            }
        }
    }

    /// Largest stable step, s, of the pair: `2/omega` with `omega^2 = k beta (A_a/m_a + A_b/m_b)` and the damping of the same mode. Areas over
    /// masses of the owners in m^2/kg; zero for what is rigid.
    #[inline]
    pub fn step_limit(&self, law: &FacetPairLaw<T>, area_over_mass_a: T, area_over_mass_b: T) -> T {
        let mobility = T::of(MOBILITY) * (area_over_mass_a + area_over_mass_b);
        oscillator_limit(self.stiffness * mobility, law.damping * mobility)
    }
}

impl<T: Real> Numbers<T> for FacetPress<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        let Self {
            energy,
            force,
            moment_a,
            moment_b,
            edges_a,
            edges_b,
            normal_force,
            area,
            damped_area,
            normal,
            centre_a,
            centre_b,
            stiffness,
        } = self;
        visit(energy);
        force.each(visit);
        moment_a.each(visit);
        moment_b.each(visit);
        edges_a.each(visit);
        edges_b.each(visit);
        visit(normal_force);
        visit(area);
        visit(damped_area);
        normal.each(visit);
        centre_a.each(visit);
        centre_b.each(visit);
        visit(stiffness);
    }
}

/// Cosine between one normal and the opposite of the other up to which facets do not press each other, and the range over which they begin to.
const FACING: (f64, f64) = (0.3, 0.4);

/// `chi` and `chi'`.
#[inline(always)]
pub(super) fn facing<T: Real>(cosine: T) -> (T, T) {
    let (zero, one, range) = (T::zero(), T::one(), T::of(FACING.1));
    let t = ((cosine - T::of(FACING.0)) / range).max(zero).min(one);
    (t * t * (T::of(3.0) - t - t), T::of(6.0) * t * (one - t) / range)
}

/// Closure over `D` up to which the stiffness grows; from there on it stays.
const STIFFEST: f64 = 0.8;

/// `omega`, `omega'` and the largest `omega''` of the distance of owners along `m` over `D`, where pairs give way; one elsewhere.
#[inline(always)]
fn in_order<T: Real>(distance: T, gives_way: T) -> [T; 3] {
    let (zero, one, six) = (T::zero(), T::one(), T::of(6.0));
    let range = T::of(IN_ORDER) * (one - gives_way);
    let t = (distance / range).max(zero).min(one);
    let way = |then: T, otherwise: T| T::select_lt(zero, gives_way, then, otherwise);
    [way(t * t * (T::of(3.0) - t - t), one), way(six * t * (one - t) / range, zero), six / (range * range)]
}

/// `phi`, `phi'` and `phi''` of a closure over `D`: `phi = x^2/(2 (1 - x))`, from [`STIFFEST`] on continued with a constant second derivative.
#[inline(always)]
fn stiffening<T: Real>(x: T) -> [T; 3] {
    let (one, half) = (T::one(), T::of(0.5));
    let (x, beyond) = (x.min(T::of(STIFFEST)), (x - T::of(STIFFEST)).max(T::zero()));
    let left = one / (one - x);
    let [energy, pressure, stiffness] = [half * x * x * left, x * (one - half * x) * left * left, left * left * left];
    [energy + beyond * (pressure + half * beyond * stiffness), pressure + beyond * stiffness, stiffness]
}

/// Closure over `D` over which damping sets in.
const ONSET: f64 = 1e-3;

/// Closure over `D` over which a place comes to be in contact, so that the area does not jump either: so little that friction has its stiffness
/// under small loads (a steel block of 10 mm closes 2e-9 under its own weight, and bounces over as much), and more than what is rounded.
#[inline(always)]
fn touch<T: Elementary>() -> T {
    T::of(1e-7).max(T::of(8.0) * T::epsilon())
}

/// Share of the facet's area below which there is no common polygon.
const NOTHING: f64 = 1e-12;

/// A surface over the plane of projection.
struct Surface<T> {
    /// Place of the middle, and height there.
    middle: Place<T>,
    height: T,
    /// Slope of the plane of the facet.
    slope: Place<T>,
    /// Vectors along the plane of the facet above the two axes of projection.
    axes: [Vector<T>; 2],
    /// Curvature by places.
    curvature: [[T; 2]; 2],
    /// Force per pressure: at the middle, and its gradient by place.
    push: Vector<T>,
    gradient: [Vector<T>; 2],
}

impl<T: Real> Surface<T> {
    /// Of a facet whose middle is at `middle` (m from the origin of projection); `side` is 1 for the facet that `m` points to, else -1.
    #[inline(always)]
    fn new(facet: &Facet<T>, middle: Vector<T>, m: Vector<T>, t: &[Vector<T>; 2], side: T) -> Self {
        let steep = T::one() / dot(facet.normal, m);
        let slope = [0, 1].map(|i: usize| -dot(facet.normal, t[i]) * steep);
        let axes = [0, 1].map(|i: usize| [0, 1, 2].map(|a: usize| t[i][a] + slope[i] * m[a]));
        let bent = axes.map(|axis| facet.curvature.dot(axis));
        let push = facet.normal.map(|n| side * steep * n);
        // -dU = p (n/(n.m) (side + m.K r) - K r).u dA, with r above the place.
        let gradient = [0, 1].map(|i: usize| {
            let rise = side * dot(m, bent[i]);
            [0, 1, 2].map(|a: usize| rise * push[a] - bent[i][a])
        });
        Self {
            middle: [dot(middle, t[0]), dot(middle, t[1])],
            height: dot(middle, m),
            slope,
            axes,
            curvature: [0, 1].map(|i: usize| [0, 1].map(|j: usize| dot(axes[i], bent[j]))),
            push,
            gradient,
        }
    }

    /// Height of the plane at a place.
    #[inline(always)]
    fn plane(&self, place: Place<T>) -> T {
        self.height + along(self.slope, difference(place, self.middle))
    }

    /// The most by which the surface is before the plane over an outline.
    #[inline(always)]
    fn bulge(&self, outline: &[Place<T>; 4]) -> T {
        let far = outline.map(|place| extent(difference(place, self.middle)));
        let farthest = far[0].max(far[1]).max(far[2].max(far[3]));
        let [[xx, xy], [yx, yy]] = self.curvature.map(|row| row.map(T::abs));
        T::of(0.5) * (xx + xy + (yx + yy)) * farthest * farthest
    }

    /// By how much the surface is behind the plane at a place, and the gradient of that.
    #[inline(always)]
    fn behind(&self, place: Place<T>) -> (T, Place<T>) {
        let r = difference(place, self.middle);
        let gradient = [along(self.curvature[0], r), along(self.curvature[1], r)];
        (T::of(0.5) * along(gradient, r), gradient)
    }

    /// Force and moment about the owner of a pressure with these moments and of the edges; `arm` from the owner to the middle.
    #[inline(always)]
    fn act(&self, pressure: &Moments<T>, edges: &EdgeForces<T>, arm: Vector<T>) -> (Vector<T>, Tensor<T>) {
        let about = pressure.about(self.middle);
        let mut force = edges.force;
        let mut moment = edges.moment;
        let pushes = |weight: T, first: Place<T>| {
            [0, 1, 2]
                .map(|a: usize| self.push[a] * weight + self.gradient[0][a] * first[0] + self.gradient[1][a] * first[1])
        };
        let body = pushes(about.sum, about.first);
        let [xx, xy, yy] = about.second;
        let firsts = [pushes(about.first[0], [xx, xy]), pushes(about.first[1], [xy, yy])];
        for a in 0..3 {
            force[a] += body[a];
            for (first, axis) in firsts.iter().zip(&self.axes) {
                (0..3).for_each(|b| moment[a][b] += first[a] * axis[b]);
            }
            for b in 0..3 {
                moment[a][b] += force[a] * arm[b];
            }
        }
        (force, moment)
    }

    /// Force of the edges, and its moment about the middle.
    #[inline(always)]
    fn of_edges(&self, edges: &EdgeMoments<T>, t: &[Vector<T>; 2]) -> EdgeForces<T> {
        let in_space = |[x, y]: Place<T>| [0, 1, 2].map(|a: usize| x * t[0][a] + y * t[1][a]);
        let mut moment = [[T::zero(); 3]; 3];
        for (c, axis) in self.axes.iter().enumerate() {
            let first = in_space([0, 1].map(|i: usize| edges.moment[i][c] - edges.force[i] * self.middle[c]));
            for a in 0..3 {
                (0..3).for_each(|b| moment[a][b] += first[a] * axis[b]);
            }
        }
        EdgeForces { force: in_space(edges.force), moment, by_misfit: T::zero() }
    }
}

/// Integrals of a pressure over places.
#[derive(Clone, Copy)]
struct Moments<T> {
    sum: T,
    first: Place<T>,
    /// xx, xy, yy.
    second: [T; 3],
}

impl<T: Real> Moments<T> {
    fn none() -> Self {
        let o = T::zero();
        Self { sum: o, first: [o; 2], second: [o; 3] }
    }

    #[inline(always)]
    fn add(&mut self, weight: T, place: Place<T>) {
        let at = [weight * place[0], weight * place[1]];
        self.sum += weight;
        self.first[0] += at[0];
        self.first[1] += at[1];
        self.second[0] += at[0] * place[0];
        self.second[1] += at[0] * place[1];
        self.second[2] += at[1] * place[1];
    }

    /// The same with places from a point.
    #[inline(always)]
    fn about(&self, point: Place<T>) -> Self {
        let first = [self.first[0] - self.sum * point[0], self.first[1] - self.sum * point[1]];
        let second = [
            self.second[0] - point[0] * (self.first[0] + first[0]),
            self.second[1] - point[0] * self.first[1] - point[1] * first[0],
            self.second[2] - point[1] * (self.first[1] + first[1]),
        ];
        Self { sum: self.sum, first, second }
    }
}

/// Sum of forces in the plane of projection, and of their dyads with their places.
#[derive(Clone, Copy)]
struct EdgeMoments<T> {
    force: Place<T>,
    moment: [Place<T>; 2],
}

impl<T: Real> EdgeMoments<T> {
    fn none() -> Self {
        let o = T::zero();
        Self { force: [o; 2], moment: [[o; 2]; 2] }
    }

    #[inline(always)]
    fn add(&mut self, force: Place<T>, place: Place<T>) {
        for i in 0..2 {
            self.force[i] += force[i];
            (0..2).for_each(|j| self.moment[i][j] += force[i] * place[j]);
        }
    }
}

/// Slots of the common polygon: four corners, one more for each edge of the other facet, one for the line where both planes meet.
const SLOTS: usize = 9;

/// What a pair of facets stores, and the exact derivative of it. For a given pair of owners always call it in the same order: in the other one
/// the result differs in the last bits, and coincident edges belong to `a`.
#[inline]
pub fn press<T: Elementary>(a: &Facet<T>, b: &Facet<T>, partner: Partner, law: &FacetPairLaw<T>) -> FacetPress<T> {
    let zero = T::zero();
    let cosine = -dot(a.normal, b.normal);
    let apart = [0, 1, 2].map(|i: usize| b.normal[i] - a.normal[i]);
    let between = [0, 1, 2].map(|i: usize| b.owner[i] - a.owner[i]);
    // Facets that face each other, owners in order.
    T::if_lt(
        T::of(FACING.0),
        cosine,
        || T::if_lt(zero, -dot(between, apart), || press_facing(a, b, partner, law, between, cosine), FacetPress::none),
        FacetPress::none,
    )
}

#[inline(always)]
fn press_facing<T: Elementary>(
    a: &Facet<T>,
    b: &Facet<T>,
    partner: Partner,
    law: &FacetPairLaw<T>,
    between: Vector<T>,
    cosine: T,
) -> FacetPress<T> {
    let apart = [0, 1, 2].map(|i: usize| b.normal[i] - a.normal[i]);
    let opening = dot(apart, apart).sqrt();
    let m = apart.map(|c| c / opening);
    // The first axis is along the first edge of a: in the plane of a plane problem.
    let edge = [0, 1, 2].map(|i: usize| a.corners[1][i] - a.corners[0][i]);
    let rise = dot(edge, m);
    let level = [0, 1, 2].map(|i: usize| edge[i] - rise * m[i]);
    let length = dot(level, level).sqrt();
    let first = level.map(|c| c / length);
    let t = [first, cross(m, first)];
    // Places from the middle of a.
    let to_b = [0, 1, 2].map(|i: usize| between[i] - a.middle[i]);
    let from_a = |arm: Vector<T>| [0, 1, 2].map(|i: usize| arm[i] - a.middle[i]);
    let from_b = |arm: Vector<T>| [0, 1, 2].map(|i: usize| arm[i] + to_b[i]);
    let project = |p: Vector<T>| [dot(p, t[0]), dot(p, t[1])];
    let surface_a = Surface::new(a, [T::zero(); 3], m, &t, T::one());
    let surface_b = Surface::new(b, from_b(b.middle), m, &t, -T::one());
    // Seen along m the corners of a run clockwise.
    let outline_a = [3, 2, 1, 0].map(|k: usize| project(from_a(a.corners[k])));
    let outline_b = b.corners.map(|arm| project(from_b(arm)));
    let surfaces = Surfaces { a: surface_a, b: surface_b, partner };
    let frame = Frame { m, opening, t, edge, length };
    let press = || surfaces.clip_and_press(outline_a, outline_b, (a, b), between, law, &frame, cosine);
    T::if_lt(surfaces.clearance(&outline_a, &outline_b), T::zero(), press, FacetPress::none)
}

/// Cut by the edge of the other facet that starts at a vertex. Coincident edges are those of the polygon, and of a polygon on the other side of one nothing is
/// left: the edges of a sliver as wide as rounding, which has no energy, would pull with all of that beside it.
#[inline(always)]
fn clipped<T: Elementary, const N: usize, const M: usize>(
    polygon: [Vertex<T>; N],
    cutter: &Vertex<T>,
    coincidence: T,
) -> [Vertex<T>; M] {
    let outside = core::array::from_fn(|k| turn(difference(polygon[k].place, cutter.place), cutter.edge.tangent));
    let size = (0..N).fold(T::zero(), |most, k| most.max(extent(polygon[k].place)));
    let tolerance = coincidence.max(T::of(COINCIDENT).max(T::of(ROUNDING) * T::epsilon())) * size;
    let deepest = outside.iter().fold(T::largest(), |least, s| least.min(*s));
    let farthest = outside.iter().fold(-T::largest(), |most, s| most.max(*s));
    // An edge without length has all on it, and cuts nothing.
    let reaches = T::select_lt(tolerance, farthest, tolerance + tolerance, T::zero());
    let beside = T::select_lt(-tolerance, deepest, reaches, T::zero());
    clip(polygon, outside.map(|s| s + beside), tolerance, cutter.edge)
}

/// Distance over the size of a facet within which edges coincide.
const COINCIDENT: f64 = 1.0 / 67_108_864.0;
/// The same in roundings, where numbers have few digits.
const ROUNDING: f64 = 64.0;

#[inline(always)]
fn extent<T: Real>(place: Place<T>) -> T {
    place[0].abs().max(place[1].abs())
}

/// Sum of the absolute components.
#[inline(always)]
fn bent<T: Real>(curvature: &SymmetricTensor<T>) -> T {
    curvature.to_array().iter().fold(T::zero(), |sum, c| sum + c.abs())
}

/// The plane of projection.
struct Frame<T> {
    /// Unit normal, and how far both unit normals of the facets are from each other.
    m: Vector<T>,
    opening: T,
    /// Axes; the first along the first edge of `a`.
    t: [Vector<T>; 2],
    /// That edge, and its length in the plane.
    edge: Vector<T>,
    length: T,
}

struct Surfaces<T> {
    a: Surface<T>,
    b: Surface<T>,
    partner: Partner,
}

/// The quadrature at a place.
struct At<T> {
    energy: T,
    /// Derivative by how far the surfaces are behind each other; by the closure that this leaves; by the lap.
    pressure: T,
    by_closure: T,
    by_lap: T,
    stiffness: T,
    closed: T,
    /// Share of the damping.
    damped: T,
    /// Gradient of the gap by place.
    gradient: Place<T>,
    /// Derivative of the energy by `D`.
    by_depth: T,
}

impl<T: Elementary> Surfaces<T> {
    #[inline(always)]
    fn at(&self, place: Place<T>, law: &FacetPairLaw<T>, depth: T, least: T, lap: T) -> At<T> {
        let (behind_a, slope_a) = self.a.behind(place);
        let (behind_b, slope_b) = self.b.behind(place);
        let gap = (self.a.plane(place) - self.b.plane(place)) + (behind_a + behind_b);
        let apart = (-gap).max(least);
        // A pair that gives way does so as one does beside which bodies lap by that share of `D`.
        let (zero, way) = (T::zero(), law.gives_way * depth);
        let gives = T::select_lt(zero, law.gives_way, T::select_lt(way, lap, T::one(), zero), zero);
        let lap = T::select_lt(zero, gives, way, lap);
        let lapped = Lapped::of(apart, lap, depth);
        let by_lap = |then: T, otherwise: T| T::select_lt(zero, gives, then, otherwise);
        let closure = lapped.closure;
        let [energy, pressure, stiffness] = stiffening(closure / depth);
        let [energy, pressure] = [law.stiffness * depth * depth * energy, law.stiffness * depth * pressure];
        let gradient = [0, 1].map(|i: usize| (self.a.slope[i] - self.b.slope[i]) + (slope_a[i] + slope_b[i]));
        At {
            energy,
            pressure: pressure * lapped.by_apart,
            by_closure: pressure,
            by_lap: by_lap(zero, pressure * lapped.by_lap),
            stiffness: law.stiffness * stiffness,
            closed: (closure / (touch::<T>() * depth)).max(T::zero()).min(T::one()),
            damped: (closure / (T::of(ONSET) * depth)).max(T::zero()).min(T::one()),
            gradient,
            by_depth: (energy + energy - pressure * closure) / depth
                + pressure * by_lap(lapped.by_depth + law.gives_way * lapped.by_lap, lapped.by_depth),
        }
    }

    /// Not positive if the outlines may have something in common where the surfaces meet, else positive: how far they are beside each other, or how far above `b`
    /// the lowest part of `a` is at least.
    #[inline(always)]
    fn clearance(&self, outline_a: &[Place<T>; 4], outline_b: &[Place<T>; 4]) -> T {
        let gaps = outline_a.map(|place| self.gap(place));
        let lowest = gaps[0].min(gaps[1]).min(gaps[2].min(gaps[3])) - self.a.bulge(outline_a) - self.b.bulge(outline_a);
        match self.partner {
            Partner::Plane => lowest,
            Partner::Facet => (0..2).fold(lowest, |most, i| {
                let ends = |outline: &[Place<T>; 4]| {
                    let [p, q, r, s] = outline.map(|place| place[i]);
                    (p.min(q).min(r.min(s)), p.max(q).max(r.max(s)))
                };
                let ((low_a, high_a), (low_b, high_b)) = (ends(outline_a), ends(outline_b));
                most.max(low_a - high_b).max(low_b - high_a)
            }),
        }
    }

    /// Gap between the planes at a place.
    #[inline(always)]
    fn gap(&self, place: Place<T>) -> T {
        self.a.plane(place) - self.b.plane(place)
    }

    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "what was found out about the pair on the way here")]
    fn clip_and_press(
        &self,
        outline_a: [Place<T>; 4],
        outline_b: [Place<T>; 4],
        (a, b): (&Facet<T>, &Facet<T>),
        between: Vector<T>,
        law: &FacetPairLaw<T>,
        frame: &Frame<T>,
        cosine: T,
    ) -> FacetPress<T> {
        let whole = polygon(outline_a, T::one());
        let common: [Vertex<T>; SLOTS - 1] = match self.partner {
            Partner::Plane => core::array::from_fn(|k| whole[k.min(3)]),
            Partner::Facet => {
                let cutters = polygon(outline_b, -T::one());
                let five: [Vertex<T>; 5] = clipped(whole, &cutters[0], law.coincidence);
                let six: [Vertex<T>; 6] = clipped(five, &cutters[1], law.coincidence);
                let seven: [Vertex<T>; 7] = clipped(six, &cutters[2], law.coincidence);
                clipped(seven, &cutters[3], law.coincidence)
            }
        };
        // Plane facets press where their gap is negative, which is a straight line.
        let fall = difference(self.a.slope, self.b.slope);
        let steepest = along(fall, fall).sqrt();
        let unit = |c: T| T::select_lt(T::zero(), steepest, c / steepest, T::zero());
        let meeting = Line { tangent: [unit(-fall[1]), unit(fall[0])], owner: T::zero() };
        let bent = bent(&a.curvature) + bent(&b.curvature);
        let outside = common.map(|v| T::select_lt(T::zero(), bent, -T::one(), self.gap(v.place)));
        let pressed: [Vertex<T>; SLOTS] = clip(common, outside, T::zero(), meeting);
        // Where the polygon ends at that line, what its quadrature finds beyond is the continuation of a quadratic function.
        let least = T::select_lt(T::zero(), bent, T::zero(), -T::largest());
        let reference = pressed[0].place;
        let (mut area, mut centre) = (T::zero(), [T::zero(); 2]);
        for k in 0..SLOTS {
            let (p, q) = (difference(pressed[k].place, reference), difference(pressed[next(k)].place, reference));
            let twice = turn(p, q);
            area += T::of(0.5) * twice;
            (0..2).for_each(|i| centre[i] += twice * (p[i] + q[i]));
        }
        T::if_lt(
            T::of(NOTHING) * a.area,
            area,
            || {
                let centre = [0, 1].map(|i: usize| reference[i] + centre[i] / (T::of(6.0) * area));
                // In the order of the outlines.
                let free_a = [2, 1, 0, 3].map(|edge: usize| a.free[edge]);
                let lap = Lap::of([(&outline_a, free_a), (&outline_b, b.free)], centre);
                self.press(&pressed, steepest, (area, centre), (a, b), between, law, frame, least, &lap, cosine)
            },
            FacetPress::none,
        )
    }

    /// Energy by a product of Gauss rules with three points over the rectangle that has the polygon's area, centre and second moments, so that it is exact
    /// for quadratic functions, and nothing depends on where the polygon's edges are divided. Its derivative by the edges and by what moves the surfaces.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "what was found out about the pair on the way here")]
    fn press(
        &self,
        polygon: &[Vertex<T>; SLOTS],
        steepest: T,
        (area, centre): (T, Place<T>),
        (a, b): (&Facet<T>, &Facet<T>),
        between: Vector<T>,
        law: &FacetPairLaw<T>,
        frame: &Frame<T>,
        least: T,
        lap: &Lap<T>,
        cosine: T,
    ) -> FacetPress<T> {
        let (zero, half) = (T::zero(), T::of(0.5));
        let Frame { m, opening, t, edge, length } = *frame;
        let depth = a.depth + b.depth;
        // From the centre to the vertices.
        let rays: [Place<T>; SLOTS] = core::array::from_fn(|k| difference(polygon[k].place, centre));
        let spread = Spread::of(&rays, area);
        let (mut pressure, mut whole) = (Moments::none(), Moments::none());
        let (mut energy, mut closed, mut damped) = (zero, zero, zero);
        let (mut by_depth, mut by_lap, mut stiffness) = (zero, zero, zero);
        // Derivatives of the mean energy by the centre and, not symmetric, by the root of the second moments.
        let mut by_centre = [zero; 2];
        let mut by_root = [[zero; 2]; 2];
        for (u, weight_u) in NODES {
            for (v, weight_v) in NODES {
                let (node, weight) = ([T::of(u), T::of(v)], T::of(weight_u * weight_v));
                let place = [0, 1].map(|i: usize| centre[i] + along(spread.root[i], node));
                let at = self.at(place, law, depth, least, lap.distance);
                energy += weight * at.energy;
                closed += weight * at.closed;
                damped += weight * at.damped;
                by_depth += weight * at.by_depth;
                stiffness = stiffness.max(T::select_lt(zero, weight * at.closed, at.stiffness, zero));
                let force = weight * at.pressure;
                pressure.add(area * force, place);
                whole.add(area * weight * at.by_closure, place);
                by_lap += weight * at.by_lap;
                for i in 0..2 {
                    let share = -(force * at.gradient[i]);
                    by_centre[i] += share;
                    (0..2).for_each(|j| by_root[i][j] += share * node[j]);
                }
            }
        }
        let mut edges = [EdgeMoments::none(); 2];
        let by_lap = by_lap * lap.share;
        for side in 0..2 {
            let push = -(area * by_lap);
            edges[side].add(lap.outward[side].map(|c| push * c), lap.feet[side]);
            (0..2).for_each(|i| by_centre[i] -= by_lap * lap.outward[side][i]);
        }
        let by_second = spread.by_second(&by_root);
        // What an edge adds to the energy where it moves outwards.
        let level = energy - spread.contracted(&by_second);
        let density =
            |r: Place<T>| level + along(by_centre, r) + along([along(by_second[0], r), along(by_second[1], r)], r);
        let mut moved = pressure;
        let at_vertices: [T; SLOTS] = core::array::from_fn(|k| density(rays[k]));
        for k in 0..SLOTS {
            let (p, q) = (rays[k], rays[next(k)]);
            let way = difference(q, p);
            let owner = polygon[k].edge.owner;
            let belongs = |side: T| T::select_lt(half, side * owner, T::one(), zero);
            // The line along which the planes meet moves by the rate of the gap over its slope, as if the pressure were larger there.
            let none = T::select_lt(owner.abs(), half, T::one(), zero);
            let far = T::select_lt(zero, none * steepest, along(way, way).sqrt() / steepest, zero);
            let middle = [half * (p[0] + q[0]), half * (p[1] + q[1])];
            // Simpson's rule is exact.
            let sixth = T::of(1.0 / 6.0);
            for (weight, r) in [
                (sixth * at_vertices[k], p),
                (T::of(4.0) * sixth * density(middle), middle),
                (sixth * at_vertices[next(k)], q),
            ] {
                let place = [centre[0] + r[0], centre[1] + r[1]];
                for (facet, side) in [T::one(), -T::one()].into_iter().enumerate() {
                    let share = -belongs(side) * weight;
                    edges[facet].add([share * way[1], -share * way[0]], place);
                }
                moved.add(far * weight, place);
            }
        }
        T::if_lt(
            zero,
            energy,
            || {
                let (chi, by_cosine) = facing(cosine);
                let shares = [a, b].map(|of| (of.rest_depth + of.rest_depth) / (a.rest_depth + b.rest_depth));
                let firmer = T::one() + (shares[0] * a.misfit + shares[1] * b.misfit);
                let (chi, by_cosine) = (firmer * chi, firmer * by_cosine);
                let distance = -dot(between, m);
                let [order, by_order, steepest_order] = in_order(distance / depth, law.gives_way);
                // The derivative by the distance of the owners, which turns `m` as other forces do.
                let parted = by_order * chi * area * energy / depth;
                let (chi, by_cosine) = (chi * order, by_cosine * order);
                let [of_a, of_b] = [self.a.of_edges(&edges[0], &t), self.b.of_edges(&edges[1], &t)];
                let (force, about_a) = self.a.act(&moved, &of_a, a.middle);
                let (_, about_b) = self.b.act(&moved, &of_b, b.middle);
                let gives = |then: T, otherwise: T| T::select_lt(zero, law.gives_way, then, otherwise);
                let force = [0, 1, 2].map(|i: usize| gives(chi * force[i] - parted * m[i], chi * force[i]));
                let by_depth = chi * area * by_depth - parted * distance / depth;
                let of_order = firmer * steepest_order * energy / (depth * depth);
                let stiffness = chi * stiffness + T::select_lt(zero, by_order, of_order, zero);
                let [mut moment_a, mut moment_b] =
                    [about_a, about_b].map(|moment| moment.map(|row| row.map(|c| chi * c)));
                // The rectangle turns with the first edge of a.
                let turn = chi * area * spread.by_turn(&by_root) / length;
                for i in 0..3 {
                    (0..3).for_each(|j| moment_a[i][j] -= turn * t[1][i] * edge[j]);
                }
                // m follows both normals: what is left of the torque of the forces turns it. The force on b is the opposite of that on a.
                let (turns_a, turns_b, of_both) = (torque(&moment_a), torque(&moment_b), cross(between, force));
                let left = [0, 1, 2].map(|i: usize| turns_a[i] + turns_b[i] - of_both[i]);
                let turned = cross(left, m).map(|c| c / opening);
                let facing = by_cosine * area * energy;
                let by_normal_a = [0, 1, 2].map(|i: usize| -turned[i] - facing * b.normal[i]);
                let by_normal_b = [0, 1, 2].map(|i: usize| turned[i] - facing * a.normal[i]);
                let [mut edges_a, mut edges_b] = [of_a.times(chi), of_b.times(chi)];
                let by_misfit = shares.map(|share| share * chi * area * energy / firmer);
                [edges_a.by_misfit, edges_b.by_misfit] = by_misfit;
                for i in 0..3 {
                    (0..3).for_each(|j| edges_a.moment[i][j] -= turn * t[1][i] * edge[j]);
                }
                add_of_normal(&mut moment_a, a.normal, by_normal_a, by_depth * a.depth);
                add_of_normal(&mut moment_b, b.normal, by_normal_b, by_depth * b.depth);
                let place = [0, 1].map(|i: usize| whole.first[i] / whole.sum);
                let high =
                    (self.a.plane(place) + self.a.behind(place).0) + (self.b.plane(place) - self.b.behind(place).0);
                let point = [0, 1, 2].map(|i: usize| half * high * m[i] + (place[0] * t[0][i] + place[1] * t[1][i]));
                let centre_a = [0, 1, 2].map(|i: usize| a.middle[i] + point[i]);
                FacetPress {
                    energy: chi * area * energy,
                    force,
                    moment_a,
                    moment_b,
                    edges_a,
                    edges_b,
                    normal_force: chi * whole.sum,
                    area: chi * area * closed,
                    damped_area: chi * area * damped,
                    normal: m,
                    centre_a,
                    centre_b: [0, 1, 2].map(|i: usize| centre_a[i] - between[i]),
                    stiffness,
                }
            },
            FacetPress::none,
        )
    }
}

/// The next vertex.
#[inline(always)]
fn next(k: usize) -> usize {
    (k + 1) % SLOTS
}

/// Torque of a moment, `sum y x f` of `sum f (x) y`.
#[inline(always)]
fn torque<T: Real>(moment: &Tensor<T>) -> Vector<T> {
    [moment[2][1] - moment[1][2], moment[0][2] - moment[2][0], moment[1][0] - moment[0][1]]
}

/// Adds the moment of a derivative by the unit normal, `dn = -(I - n n) L^T n`, and of one by the logarithm of the depth, `dD = D n.L n`.
#[inline(always)]
pub(super) fn add_of_normal<T: Real>(moment: &mut Tensor<T>, n: Vector<T>, by_normal: Vector<T>, thinner: T) {
    let along = dot(by_normal, n);
    for i in 0..3 {
        for j in 0..3 {
            moment[i][j] += n[i] * ((by_normal[j] - along * n[j]) - thinner * n[j]);
        }
    }
}
