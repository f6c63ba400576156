//! Surfaces of a body: normals and faces under deformation, and the parts that can be in contact.

use crate::contact::flat_body;
use crate::kernel::Kernel;
use crate::tensor::{apply, dot, inverse, transpose};
use crate::{Dimension, Real, Scalar, Tensor, Vector};

/// Unit normal of a surface whose normal (of any length) in the reference configuration is given: `F^-T N` over its length.
#[inline(always)]
pub fn surface_normal<T: Real>(f: &Tensor<T>, normal: Vector<T>) -> Vector<T> {
    let turned = apply(&transpose(&inverse(f)), normal);
    let length = dot(turned, turned).sqrt();
    turned.map(|c| c / length)
}

/// Cosine of the angle between normals below which they are on different sides: 60 degrees. A corner, whose normal is
/// at 45 degrees, can meet corners and flat surfaces.
const DIFFERENT: f64 = 0.5;

/// Whether points of a surface with these outward unit normals are on different sides of it, like those of a closed
/// fold; [`sides_of_a_sheet`] distinguishes them from the sides of a sheet.
#[inline]
pub fn are_different_sides<T: Scalar>(normal_i: Vector<T>, normal_j: Vector<T>) -> bool {
    different_sides(normal_i, normal_j) > T::zero()
}

/// The same as a number: one or zero.
#[inline(always)]
pub fn different_sides<T: Real>(normal_i: Vector<T>, normal_j: Vector<T>) -> T {
    T::select_lt(dot(normal_i, normal_j), T::of(DIFFERENT), T::one(), T::zero())
}

/// Cosine of the angle between normals, 25 degrees, above which they stay on one side until the next contact search: a
/// rotation to 60 degrees moves neighbours on a surface by more than the skin of that search.
const TURNED_AWAY: f64 = 0.9;

/// One if points of a surface with these outward unit normals may be on different sides of it before the next search,
/// else zero.
#[inline(always)]
pub fn soon_different_sides<T: Real>(normal_i: Vector<T>, normal_j: Vector<T>) -> T {
    T::select_lt(dot(normal_i, normal_j), T::of(TURNED_AWAY), T::one(), T::zero())
}

/// Whether of two points of a surface, `x = x_i - x_j` (m) apart, with these outward normals (of any length), at least
/// one is behind the other by more than a length (m) and neither is in front of the other, as on the two sides of a
/// sheet or of an edge. Evaluated in the reference configuration, so that the result does not change.
#[inline]
pub fn are_back_to_back<T: Scalar>(x: Vector<T>, normal_i: Vector<T>, normal_j: Vector<T>, by: T) -> bool {
    back_to_back(x, normal_i, normal_j, by) > T::zero()
}

#[inline(always)]
fn back_to_back<T: Real>(x: Vector<T>, normal_i: Vector<T>, normal_j: Vector<T>, by: T) -> T {
    let behind = |along: T, normal: Vector<T>| along / dot(normal, normal).sqrt();
    let (j, i) = (behind(dot(x, normal_i), normal_i), behind(-dot(x, normal_j), normal_j));
    let none_in_front = T::select_lt(-by, j.min(i), T::one(), T::zero());
    T::select_lt(by, j.max(i), none_in_front, T::zero())
}

/// Distance by which points that are back to back are behind each other, in spacings.
const BEHIND: f64 = 0.25;

/// For sides of a body that are farther apart at the start than this, in spacings, only the normals decide: before they
/// are pressed into reach of each other through the body it has come apart, but its ends may be bent around to meet.
const THICKEST: f64 = 32.0;

/// One if two points of a surface, `x = x_i - x_j` (m) apart in the reference configuration of a body of that spacing
/// (m), with these outward normals (of any length), are the two sides of a sheet or an edge of it, which are never in
/// contact, else zero.
#[inline(always)]
pub fn sides_of_a_sheet<T: Real>(x: Vector<T>, normal_i: Vector<T>, normal_j: Vector<T>, spacing: T) -> T {
    let thickest = T::of(THICKEST) * spacing;
    let is_one = back_to_back(x, normal_i, normal_j, T::of(BEHIND) * spacing);
    T::select_lt(dot(x, x), thickest * thickest, is_one, T::zero())
}

/// Adds a neighbour `x = x_i - x_j` (m) away, of that volume (m^d), to the outward normal of a particle, 1/m.
#[inline(always)]
pub fn add_outward(
    outward: &mut Vector<f64>,
    kernel: Kernel,
    dimension: Dimension,
    x: Vector<f64>,
    volume: f64,
    h: f64,
) {
    let weight = volume * kernel.slope(dimension, Real::sqrt(dot(x, x)), h);
    for a in 0..3 {
        outward[a] += weight * x[a];
    }
}

/// Length of an outward normal above which a particle of that spacing and smoothing length (m) is in the outermost
/// layer, 1/m: between the values of the outermost layer of a flat surface and of the one behind it, which are sums
/// over the missing layers. It is less than half-way, because a sheet of two layers has only seven tenths of that if
/// the cubic spline smooths over two spacings.
pub fn exposed(kernel: Kernel, dimension: Dimension, spacing: f64, h: f64) -> f64 {
    let missing = |layer: f64| flat_body(kernel, dimension, spacing, h, layer * spacing);
    0.7 * 0.5 * (missing(1.0).slope + missing(2.0).slope)
}

/// Length of the mean of the unit normals around a particle below which it is not near a single face, as in the middle
/// of a sheet.
const ONE_FACE: f64 = 0.5;

/// The face near a particle behind the outermost layer, from its neighbours in that layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NearFace {
    sum: f64,
    mean: Vector<f64>,
    below: f64,
}

impl NearFace {
    /// Adds a neighbour with this outward normal (of any length), `x = x_j - x_i` (m) away, whose kernel is `weight`, m^-d.
    #[inline(always)]
    pub fn add(&mut self, x: Vector<f64>, outward: Vector<f64>, weight: f64) {
        let per_length = weight / Real::sqrt(dot(outward, outward));
        self.sum += weight;
        self.below += per_length * dot(x, outward);
        (0..3).for_each(|a| self.mean[a] += per_length * outward[a]);
    }

    /// Depth below the face times its outward unit normal, m, with an outermost layer `half` a spacing (m) deep; zero
    /// if no single face is near.
    #[inline(always)]
    pub fn arm(&self, half: f64) -> Vector<f64> {
        let length = Real::sqrt(dot(self.mean, self.mean));
        if self.sum > 0.0 && length > ONE_FACE * self.sum {
            let depth = half + (self.below / self.sum).max(0.0);
            self.mean.map(|n| depth * n / length)
        } else {
            [0.0; 3]
        }
    }
}

/// The same for a particle of the outermost layer with this outward normal, of any length.
#[inline(always)]
pub fn outermost_arm(outward: Vector<f64>, half: f64) -> Vector<f64> {
    outward.map(|n| half * n / Real::sqrt(dot(outward, outward)))
}

/// Contact position of a particle near a surface.
///
/// Contact begins where one lattice would continue the other, half a spacing in front of the outermost particles. In
/// material that is compressed to a fraction `lambda` of its thickness the face is nearer, at `lambda` times the depth
/// `D` of the particle below it. The particle therefore takes part in the contact at `z = x + D (c(lambda) - 1) n`, as
/// far below the face as at rest. `n` is the current normal and `1/lambda = |F^-T N|`; `c = lambda` in compression. In
/// stretch along the normal `c = 2 - 1/lambda`, which has the same value and slope at rest, and keeps the shift of torn
/// material below one depth.
///
/// The contact uses the volumes of neighbours at rest, although compression spreads them: faces of material that is
/// compressed to a half at constant volume overlap by a third of a spacing before they push each other. Without the
/// shift they would be held half a spacing apart.
///
/// A force `f` on `z` is equivalent to one on `x` and the stress `P` of [`Self::stress`], which follows from `f . dz =
/// f . dx - V P : dF`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceShift<T> {
    normal: Vector<T>,
    depth: T,
    /// `lambda`.
    thinning: T,
    /// `c(lambda)` and its derivative.
    c: T,
    slope: T,
}

impl<T: Scalar> FaceShift<T> {
    /// For a particle with this deformation gradient and the `arm`, its depth below the face at rest (m) times the
    /// outward unit normal of the face; `None` if no face is near.
    #[inline]
    pub fn new(f: &Tensor<T>, arm: Vector<T>) -> Option<Self> {
        (dot(arm, arm) > T::zero()).then(|| Self::of(f, arm))
    }
}

impl<T: Real> FaceShift<T> {
    /// The same near a face.
    #[inline(always)]
    pub fn of(f: &Tensor<T>, arm: Vector<T>) -> Self {
        let depth = dot(arm, arm).sqrt();
        let carried = apply(&transpose(&inverse(f)), arm);
        let length = dot(carried, carried).sqrt();
        let thinning = depth / length;
        let one = T::one();
        let c = T::select_lt(thinning, one, thinning, T::of(2.0) - one / thinning);
        let slope = T::select_lt(thinning, one, one, one / (thinning * thinning));
        Self { normal: carried.map(|n| n / length), depth, thinning, c, slope }
    }

    /// `z - x`, m.
    #[inline]
    pub fn shift(&self) -> Vector<T> {
        self.normal.map(|n| self.depth * (self.c - T::one()) * n)
    }

    /// Its rate with a velocity gradient (1/s), m/s.
    #[inline]
    pub fn rate(&self, velocity_gradient: &Tensor<T>) -> Vector<T> {
        // d(F^-T N)/dt = -L^T F^-T N.
        let turned = apply(&transpose(velocity_gradient), self.normal);
        let along = dot(self.normal, turned);
        let thinner = self.depth * self.slope * self.thinning * along;
        let tilt = self.depth * (self.c - T::one());
        [0, 1, 2].map(|a| thinner * self.normal[a] - tilt * (turned[a] - along * self.normal[a]))
    }

    /// First Piola-Kirchhoff stress times the reference volume, N m, of a force (N) on `z`, in the reference configuration from which `f` is the
    /// deformation gradient: `P V = D n ⊗ F^-1 [(c - 1) f_t - c' lambda f_n n]`.
    #[inline]
    pub fn stress(&self, f: &Tensor<T>, force: Vector<T>) -> Tensor<T> {
        let along = dot(force, self.normal);
        let (tilt, press) = (self.c - T::one(), self.slope * self.thinning);
        let q = [0, 1, 2].map(|a| {
            let normal = along * self.normal[a];
            self.depth * (tilt * (force[a] - normal) - press * normal)
        });
        let back = apply(&inverse(f), q);
        self.normal.map(|n| back.map(|b| n * b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_of_a_sheet_are_behind_each_other_and_near() {
        let (up, down): (Vector<f64>, Vector<f64>) = ([0.0, 3.0, 0.0], [0.0, -0.5, 0.0]);
        // Two spacings thick: the one above looks up, the one below looks down. A slot is the other way round, a flat side has none behind.
        assert_eq!(sides_of_a_sheet([0.5, 2.0, 0.0], up, down, 1.0), 1.0);
        assert_eq!(sides_of_a_sheet([0.5, -2.0, 0.0], up, down, 1.0), 0.0);
        assert_eq!(sides_of_a_sheet([2.0, 0.0, 0.0], up, up, 1.0), 0.0);
        // A quarter of a spacing behind, and 32 spacings apart, are the bounds.
        assert_eq!([0.24, 0.26].map(|y| sides_of_a_sheet([0.0, y, 0.0], up, down, 1.0)), [0.0, 1.0]);
        assert_eq!([31.0, 33.0].map(|y| sides_of_a_sheet([0.0, 2.0 * y, 0.0], up, down, 2.0)), [1.0, 0.0]);
        assert_eq!([0.49, 0.51].map(|c| different_sides([c, 0.0, 0.0], [1.0, 0.0, 0.0])), [1.0, 0.0]);
        assert_eq!([0.89, 0.91].map(|c| soon_different_sides([0.0, c, 0.0], [0.0, 1.0, 0.0])), [1.0, 0.0]);
    }

    #[test]
    fn faces_are_found_by_the_outermost_layer() {
        // Layers one spacing apart, the outermost seen by its normals: half a spacing deep itself, one and a half what is behind it.
        assert_eq!(outermost_arm([0.0, 4.0, 0.0], 0.5), [0.0, 0.5, 0.0]);
        let mut face = NearFace::default();
        face.add([1.0, 1.0, 0.0], [0.0, 4.0, 0.0], 2.0);
        face.add([-1.0, 1.0, 0.0], [0.0, 9.0, 0.0], 3.0);
        assert_eq!(face.arm(0.5), [0.0, 1.5, 0.0]);
        // Between two faces, and with no neighbour in a face, near none.
        face.add([0.0, -1.0, 0.0], [0.0, -2.0, 0.0], 5.0);
        assert_eq!((face.arm(0.5), NearFace::default().arm(0.5)), ([0.0; 3], [0.0; 3]));
        // A row at the edge of a half plane is of the outermost layer, the next one is not.
        let (kernel, dimension) = (Kernel::CubicSpline, Dimension::Two);
        // Of a row with so many rows above it and below.
        let normal = |above: i32, below: i32, h: f64| {
            let mut outward = [0.0; 3];
            let rows = |x| (-below..=above).map(move |y| (x, y));
            for (x, y) in (-5..=5).flat_map(rows).filter(|place| *place != (0, 0)) {
                add_outward(&mut outward, kernel, dimension, [f64::from(-x), f64::from(-y), 0.0], 1.0, h);
            }
            outward
        };
        let exposed = |h: f64| exposed(kernel, dimension, 1.0, h);
        let [outer, inner] = [normal(0, 5, 1.1), normal(1, 5, 1.1)];
        assert!(
            outer[0].abs() < 1e-15 && outer[1] > 1.2 * exposed(1.1) && inner[1] < 0.8 * exposed(1.1),
            "{outer:?} {inner:?} {}",
            exposed(1.1)
        );
        // Over two spacings a sheet of two layers still has surfaces, and the layer behind that of a thick body still is none.
        let [of_two, inner] = [normal(0, 1, 2.0), normal(1, 5, 2.0)].map(|outward| outward[1] / exposed(2.0));
        assert!((1.0..1.05).contains(&of_two) && (0.9..1.0).contains(&inner), "{of_two} {inner}");
    }

    #[test]
    fn a_normal_stays_square_to_its_surface() {
        // A surface along (1, 0, 0) and (0, 1, 1), sheared, stretched and turned.
        let f = [[1.2, 2.0, 0.3], [-0.4, 0.9, 0.0], [0.1, 0.5, 0.6]];
        let normal = surface_normal(&f, [0.0, -3.0, 3.0]);
        assert!((dot(normal, normal) - 1.0f64).abs() < 1e-14);
        for along in [[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]] {
            assert!(dot(normal, apply(&f, along)).abs() < 1e-14);
        }
        // It points to the same side.
        assert!(dot(normal, apply(&f, [0.0, -1.0, 1.0])) > 0.0);
    }

    /// Double contraction.
    fn contract(a: &Tensor<f64>, b: &Tensor<f64>) -> f64 {
        (0..3).map(|i| dot(a[i], b[i])).sum()
    }

    #[test]
    fn a_particle_stands_as_far_below_its_face_as_at_rest() {
        let stretched = |n: f64| [[1.5, 0.0, 0.0], [0.0, n, 0.0], [0.0, 0.0, 0.8]];
        let shift = |n: f64| FaceShift::new(&stretched(n), [0.0, 0.5, 0.0]).unwrap().shift();
        // Pressed to 0.4, the face is 0.2 above the particle, which stands 0.3 deeper.
        assert!((shift(0.4)[1] + 0.3).abs() < 1e-15 && shift(0.4)[0] == 0.0);
        // Stretched by 4: 0.5 (2 - 1/4 - 1), never more than 0.5.
        assert!((shift(4.0)[1] - 0.375).abs() < 1e-15 && shift(1e9)[1] < 0.5);
        assert_eq!(shift(1.0)[1], 0.0);
        assert_eq!(FaceShift::new(&stretched(0.4), [0.0; 3]), None);
    }

    #[test]
    fn rate_and_stress_of_a_face_are_derivatives_of_its_place() {
        let arm = [0.3, -0.4, 0.2];
        let pressed = [[1.2, 0.5, 0.3], [-0.4, 0.7, 0.1], [0.1, 0.2, 0.6]];
        let pulled = [[1.9, -0.3, 0.2], [0.4, 2.1, 0.1], [-0.2, 0.3, 1.4]];
        let l = [[0.3, -1.0, 0.4], [0.7, 0.2, -0.5], [0.1, 0.9, -0.6]];
        let force = [3.0, -1.0, 2.0];
        for (f, is_pressed) in [(pressed, true), (pulled, false)] {
            let face = FaceShift::new(&f, arm).unwrap();
            assert_eq!(face.thinning < 1.0, is_pressed);
            let rate_of_f = crate::tensor::multiply(&l, &f);
            let at = |t: f64| {
                let moved = [0, 1, 2].map(|i| [0, 1, 2].map(|j| f[i][j] + t * rate_of_f[i][j]));
                FaceShift::new(&moved, arm).unwrap().shift()
            };
            let (ahead, behind) = (at(1e-5), at(-1e-5));
            let rate = face.rate(&l);
            for a in 0..3 {
                let difference = (ahead[a] - behind[a]) / 2e-5;
                assert!((rate[a] - difference).abs() < 1e-8, "{is_pressed}: {rate:?} {a} {difference}");
            }
            // f . dz/dt = -V P : dF/dt, also where the reference configuration has been renewed: dF/dt = L F' there.
            let power = -dot(force, rate);
            assert!((contract(&face.stress(&f, force), &rate_of_f) - power).abs() < 1e-12);
            let renewed = [[0.9, 0.1, 0.0], [0.2, 1.1, -0.1], [0.0, 0.3, 1.2]];
            let rate_of_f = crate::tensor::multiply(&l, &renewed);
            assert!((contract(&face.stress(&renewed, force), &rate_of_f) - power).abs() < 1e-12);
        }
    }

    #[test]
    fn the_sides_of_a_slot_meet_and_those_of_a_sheet_or_an_edge_do_not() {
        let (up, down, aside): ([f64; 3], _, _) = ([0.0, 2.0, 0.0], [0.0, -2.0, 0.0], [2.0, 0.0, 0.0]);
        let halved = |v: [f64; 3]| v.map(|c| 0.5 * c);
        assert!(are_different_sides(halved(up), halved(down)) && are_different_sides(halved(up), halved(aside)));
        assert!(!are_different_sides(halved(up), halved(up)));
        // The first place is above the second, aslant: back to back where it is the upper side of a sheet, not where it is that of a slot,
        // nor on a flat surface that will fold.
        let x = [-0.5, 1.0, 0.0];
        assert!(are_back_to_back(x, up, down, 0.9) && are_back_to_back(x.map(|c| -c), down, up, 0.9));
        assert!(!are_back_to_back(x, up, down, 1.1) && !are_back_to_back(x, down, up, 0.1));
        assert!(!are_back_to_back([1.0, 0.0, 0.0], up, up, 0.1));
        // The two sides of an edge: one looks up and stands aside from it, the other looks aside and is below.
        assert!(are_back_to_back([-1.0, 1.0, 0.0], up, aside, 0.1));
        assert!(!are_back_to_back([1.0, -1.0, 0.0], up, aside, 0.1));
        // The corner itself, and a place below it on one of the sides.
        assert!(are_back_to_back([0.0, 3.0, 0.0], [1.0, 1.0, 0.0], aside, 0.1));
    }
}
