//! The face of a deformed body near a particle, at which the body meets others.
//!
//! Contact begins where one lattice would continue the other, half a spacing in front of the outermost particles. Material that is pressed
//! to a part `lambda` of its thickness has its face nearer, at `lambda` times the depth `D` of the particle below it, and its particles farther
//! apart along the face. So that faces meet as they do at rest,
//! - the particle stands for the contact at `z = x + D (c(lambda) - 1) n`: as far below the face as it was at rest. `n` is the present normal and
//!   `1/lambda = |F^-T N|`; `c = lambda` where the material is pressed. Where it is stretched along the normal `c = 2 - 1/lambda`, whose
//!   value and slope are the same at rest, and which keeps the shift of what is torn apart below one depth;
//! - others see it in its lattice at rest: distances along the face are divided by `m` ([`FaceMetric`]), the face being
//!   `a = det F |F^-T N|` times as large as it was (Nanson) and `m = a` in a plane, `sqrt(a)` in space. Beyond [`WIDEST`] it is bounded in the way
//!   of `c`, so that what is torn apart reaches no farther than `2 w` times.
//!
//! A face that is stretched evenly so presses as at rest, and stretching it takes no work of the contact. To count volumes `a` times in
//! a round kernel has the same mean, but where particles are farther apart than the kernel reaches each stands off the one it faces: it presses
//! the sooner the more it is stretched, as if the face had a surface tension of a third of a spacing times the pressure.
//!
//! All of it follows from the deformation, so the energy of the contact depends on that: a force `f` on `z` and derivatives `e` of the energy by
//! `ln m` and `g` by `n` are a force `f` on `x` and the stress `P` of [`PressedFace::stress`], which follows from
//! `V P : dF = e d(ln m) + g . dn - f . (dz - dx)`.

use crate::tensor::{apply, determinant, dot, inverse, multiply, transpose};
use crate::{Dimension, Scalar, Tensor, Vector};

/// Widening of a face up to which it is followed: in a plane that of material pressed to a third of its thickness, in space to a ninth.
const WIDEST: f64 = 3.0;

/// How others see the lattice of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceMetric<T> {
    /// Unit normal; zero where there is no face.
    pub normal: Vector<T>,
    /// `m`.
    pub widening: T,
}

impl<T: Scalar> FaceMetric<T> {
    /// Of a particle near no face: distances are as they are.
    pub fn round() -> Self {
        Self { normal: [T::zero(); 3], widening: T::one() }
    }

    /// Distance in the lattice at rest of what is `x` away (m), m.
    #[inline(always)]
    pub fn distance(&self, x: Vector<T>) -> T {
        let along = dot(self.normal, x);
        let beside = (dot(x, x) - along * along).max(T::zero());
        (along * along + beside / (self.widening * self.widening)).sqrt()
    }

    /// Half the derivative of its square by `x`, m.
    #[inline(always)]
    pub fn pull(&self, x: Vector<T>) -> Vector<T> {
        let share = T::one() / (self.widening * self.widening);
        let along = (T::one() - share) * dot(self.normal, x);
        [0, 1, 2].map(|a| share * x[a] + along * self.normal[a])
    }

    /// Half the derivatives of its square by `ln m`, m^2, and by `n`, of which what is along the face counts, m^2.
    #[inline]
    pub fn turn(&self, x: Vector<T>) -> (T, Vector<T>) {
        let share = T::one() / (self.widening * self.widening);
        let along = dot(self.normal, x);
        let beside = [0, 1, 2].map(|a| x[a] - along * self.normal[a]);
        (-share * dot(beside, beside), beside.map(|b| (T::one() - share) * along * b))
    }
}

/// The face near a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face<T> {
    normal: Vector<T>,
    depth: T,
    /// `lambda`.
    thinning: T,
    /// `c(lambda)` and its derivative.
    c: T,
    slope: T,
    /// `m` and `d(ln m)/d(ln a)`.
    widening: T,
    widens: T,
}

/// Rates of what the contact knows of a face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceRates<T> {
    /// Of `z - x`, m/s.
    pub shift: Vector<T>,
    /// Of `ln m`, 1/s.
    pub widening: T,
    /// Of `n`, 1/s.
    pub normal: Vector<T>,
}

/// What the contact does to a face: minus the derivative of its energy by the place, N, and its derivatives by `ln m` and by `n`, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceLoad<T> {
    /// `f`.
    pub force: Vector<T>,
    /// `e`.
    pub by_widening: T,
    /// `g`.
    pub by_normal: Vector<T>,
}

impl<T: Scalar> FaceLoad<T> {
    /// Power by which the face changes, W: what the stress of the load takes, and what the energy of the contact gains beyond that of places.
    #[inline]
    pub fn power_of_shape(&self, rates: &FaceRates<T>) -> T {
        self.by_widening * rates.widening + dot(self.by_normal, rates.normal)
    }
}

impl<T: Scalar> Face<T> {
    /// Of a particle with this deformation gradient, whose depth below the face at rest (m) times the outward unit normal of the face there is
    /// the `arm`; `None` where there is no face near.
    #[inline]
    pub fn new(dimension: Dimension, f: &Tensor<T>, arm: Vector<T>) -> Option<Self> {
        let depth = dot(arm, arm).sqrt();
        if depth == T::zero() {
            return None;
        }
        let one = T::one();
        let carried = apply(&transpose(&inverse(f)), arm);
        let length = dot(carried, carried).sqrt();
        let thinning = depth / length;
        let (c, slope) = bounded(thinning, one);
        let area = determinant(f) / thinning;
        let (widening, widens) = match dimension {
            Dimension::One => (one, T::zero()),
            Dimension::Two => bounded(area, T::of(WIDEST)),
            Dimension::Three => bounded(area.sqrt(), T::of(WIDEST)),
        };
        let power = match dimension {
            Dimension::Three => area.sqrt() / T::of(2.0),
            _ => area,
        };
        let widens = widens * power / widening;
        Some(Self { normal: carried.map(|n| n / length), depth, thinning, c, slope, widening, widens })
    }

    /// `z - x`, m.
    #[inline]
    pub fn shift(&self) -> Vector<T> {
        self.normal.map(|n| self.depth * (self.c - T::one()) * n)
    }

    /// How others see it.
    #[inline]
    pub fn metric(&self) -> FaceMetric<T> {
        FaceMetric { normal: self.normal, widening: self.widening }
    }

    /// Rates with a velocity gradient, 1/s.
    #[inline]
    pub fn rates(&self, velocity_gradient: &Tensor<T>) -> FaceRates<T> {
        let l = velocity_gradient;
        // d(F^-T N)/dt = -L^T F^-T N and d(ln a)/dt = tr L - n . L n.
        let turned = apply(&transpose(l), self.normal);
        let along = dot(self.normal, turned);
        let normal = [0, 1, 2].map(|a| along * self.normal[a] - turned[a]);
        let thinner = self.depth * self.slope * self.thinning * along;
        let tilt = self.depth * (self.c - T::one());
        FaceRates {
            shift: [0, 1, 2].map(|a| thinner * self.normal[a] + tilt * normal[a]),
            widening: self.widens * (l[0][0] + l[1][1] + l[2][2] - along),
            normal,
        }
    }
}

/// A number up to a bound `w`, beyond it `2 w - w^2/x`, with the derivative.
#[inline(always)]
fn bounded<T: Scalar>(x: T, bound: T) -> (T, T) {
    if x < bound {
        return (x, T::one());
    }
    let share = bound / x;
    (bound * (T::of(2.0) - share), share * share)
}

/// How displacements in the neighbourhood deform a particle: `dF_i = sum_j (dx_j - dx_i) ⊗ g_j`, `g_j = V_j B_i grad_i W_ij`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leverage<T> {
    /// `sum_j g_j`, 1/m.
    pub sum: Vector<T>,
    /// `sum_j (m_i/m_j) g_j ⊗ g_j`, 1/m^2.
    pub squares: Tensor<T>,
}

impl<T: Scalar> Leverage<T> {
    /// Of a particle, over its neighbours: `V_j grad_i W_ij` (1/m) and `m_i/m_j` of each.
    pub fn new(correction: &Tensor<T>, neighbours: impl Iterator<Item = (Vector<T>, T)>) -> Self {
        let (mut sum, mut squares) = ([T::zero(); 3], [[T::zero(); 3]; 3]);
        for (gradient, ratio) in neighbours {
            for a in 0..3 {
                sum[a] += gradient[a];
                (0..3).for_each(|b| squares[a][b] += ratio * gradient[a] * gradient[b]);
            }
        }
        let squares = multiply(&multiply(correction, &squares), &transpose(correction));
        Self { sum: apply(correction, sum), squares }
    }
}

/// A face in the reference configuration, and how what presses it reaches the particle and its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressedFace<T> {
    face: Face<T>,
    /// `F^-1`.
    back: Tensor<T>,
    leverage: Leverage<T>,
}

impl<T: Scalar> PressedFace<T> {
    /// In the reference configuration from which `f` is the deformation gradient.
    pub fn new(face: Face<T>, f: &Tensor<T>, leverage: Leverage<T>) -> Self {
        Self { face, back: inverse(f), leverage }
    }

    /// First Piola-Kirchhoff stress times the reference volume, N m, of a load, in the reference configuration:
    /// `P V = n ⊗ F^-1 {D [(c - 1) f_t - c' lambda f_n n] - g_t} + e (d ln m/d ln a) (F^-T - n ⊗ F^-1 n)`.
    #[inline]
    pub fn stress(&self, load: &FaceLoad<T>) -> Tensor<T> {
        let Face { normal, depth, thinning, c, slope, widens, .. } = self.face;
        let (along, turning) = (dot(load.force, normal), dot(load.by_normal, normal));
        let (tilt, press) = (c - T::one(), slope * thinning);
        let sideways = load.by_widening * widens;
        let q = [0, 1, 2].map(|a| {
            let by_force = tilt * (load.force[a] - along * normal[a]) - press * along * normal[a];
            depth * by_force - (load.by_normal[a] - turning * normal[a]) - sideways * normal[a]
        });
        let arm = apply(&self.back, q);
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| normal[a] * arm[b] + sideways * self.back[b][a]))
    }

    /// How easily a load moves what it loads: its product with what it accelerates, times the mass of the particle, in squares of its unit. A
    /// force on a particle near no face has its square.
    pub fn compliance(&self, load: &FaceLoad<T>) -> T {
        let stress = self.stress(load);
        let by_stress = apply(&stress, self.leverage.sum);
        let own = [0, 1, 2].map(|a| load.force[a] + by_stress[a]);
        let others = (0..3).fold(T::zero(), |sum, a| sum + dot(stress[a], apply(&self.leverage.squares, stress[a])));
        dot(own, own) + others
    }

    /// Of a force of one newton along the normal.
    pub fn compliance_along_normal(&self) -> T {
        let (by_widening, by_normal) = (T::zero(), [T::zero(); 3]);
        self.compliance(&FaceLoad { force: self.face.normal, by_widening, by_normal })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::identity;

    const D: Dimension = Dimension::Three;

    /// Double contraction.
    fn contract(a: &Tensor<f64>, b: &Tensor<f64>) -> f64 {
        (0..3).map(|i| dot(a[i], b[i])).sum()
    }

    fn stretched(x: f64, y: f64, z: f64) -> Tensor<f64> {
        [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]
    }

    #[test]
    fn a_particle_stands_as_far_below_its_face_as_at_rest() {
        let shift = |n: f64| Face::new(D, &stretched(1.5, n, 0.8), [0.0, 0.5, 0.0]).unwrap().shift();
        // Pressed to 0.4, the face is 0.2 above the particle, which stands 0.3 deeper.
        assert!((shift(0.4)[1] + 0.3).abs() < 1e-15 && shift(0.4)[0] == 0.0);
        // Stretched by 4: 0.5 (2 - 1/4 - 1), never more than 0.5.
        assert!((shift(4.0)[1] - 0.375).abs() < 1e-15 && shift(1e9)[1] < 0.5);
        assert_eq!(shift(1.0)[1], 0.0);
        assert_eq!(Face::new(D, &stretched(1.5, 0.4, 0.8), [0.0; 3]), None);
    }

    #[test]
    fn a_face_is_as_wide_as_its_area_has_grown() {
        let widening = |dimension, f: &Tensor<f64>| Face::new(dimension, f, [0.0, 0.5, 0.0]).unwrap().metric().widening;
        let (plane, space) = (Dimension::Two, Dimension::Three);
        // What happens along the normal, and turns, do not matter.
        assert!((widening(plane, &stretched(1.5, 0.4, 0.8)) - 1.2).abs() < 1e-15);
        assert!((widening(plane, &stretched(1.5, 7.0, 0.8)) - 1.2).abs() < 1e-14);
        let turn = [[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
        assert!((widening(plane, &multiply(&turn, &stretched(1.5, 3.0, 0.8))) - 1.2).abs() < 1e-14);
        // A face that is sheared in its plane is as large; one that is tilted against what it lies on has grown.
        assert!((widening(plane, &[[1.0, 0.0, 2.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) - 1.0).abs() < 1e-15);
        assert!((widening(plane, &[[1.0, 0.0, 0.0], [0.75, 1.0, 0.0], [0.0, 0.0, 1.0]]) - 1.25).abs() < 1e-15);
        // 3 (2 - 3/6) at 6, and never more than 6; in space of the root, on a line there is no width.
        assert!((widening(plane, &stretched(6.0, 0.1, 1.0)) - 4.5).abs() < 1e-14);
        assert!(widening(plane, &stretched(1e4, 0.1, 1.0)) < 6.0);
        assert!((widening(space, &stretched(2.0, 0.1, 3.125)) - 2.5).abs() < 1e-14);
        assert_eq!(widening(Dimension::One, &stretched(1.0, 0.1, 1.0)), 1.0);
    }

    #[test]
    fn distances_along_a_wide_face_are_those_at_rest() {
        let metric = FaceMetric { normal: [0.0, 0.6, 0.8], widening: 2.0 };
        // (4, 0.8 2, -0.6 2) along it and 3 away: 3^2 + (16 + 4)/4 = 14.
        let x = [4.0, 1.6 + 1.8, -1.2 + 2.4];
        assert!((metric.distance(x) - 14.0f64.sqrt()).abs() < 1e-14);
        assert_eq!(FaceMetric::round().distance([2.0, 3.0, 6.0]), 7.0);
        assert_eq!(FaceMetric::round().pull([2.0, 3.0, 6.0]), [2.0, 3.0, 6.0]);
        // Derivatives of half the square.
        let half = |metric: FaceMetric<f64>, x: Vector<f64>| 0.5 * metric.distance(x).powi(2);
        let (by_widening, by_normal) = metric.turn(x);
        let wider = |t: f64| half(FaceMetric { widening: 2.0 * f64::exp(t), ..metric }, x);
        assert!((by_widening - (wider(1e-5) - wider(-1e-5)) / 2e-5).abs() < 1e-8);
        for (axis, along) in [(0, [1.0, 0.0, 0.0]), (1, [0.0, 0.8, -0.6])] {
            let moved = |t: f64| half(metric, [0, 1, 2].map(|a| x[a] + t * along[a]));
            assert!((dot(metric.pull(x), along) - (moved(1e-5) - moved(-1e-5)) / 2e-5).abs() < 1e-8, "{axis}");
            let turned = |t: f64| {
                let n = [0, 1, 2].map(|a| f64::cos(t) * metric.normal[a] + f64::sin(t) * along[a]);
                half(FaceMetric { normal: n, ..metric }, x)
            };
            assert!((dot(by_normal, along) - (turned(1e-5) - turned(-1e-5)) / 2e-5).abs() < 1e-8, "{axis}");
        }
    }

    #[test]
    fn rates_and_stress_of_a_face_are_derivatives_of_its_place_and_shape() {
        let arm = [0.3, -0.4, 0.2];
        let pressed = [[1.2, 0.5, 0.3], [-0.4, 0.7, 0.1], [0.1, 0.2, 0.6]];
        let pulled = [[1.9, -0.3, 0.2], [0.4, 2.1, 0.1], [-0.2, 0.3, 1.4]];
        let torn = [[3.9, -0.3, 0.2], [0.4, 3.6, 0.1], [-0.2, 0.3, 4.0]];
        let l = [[0.3, -1.0, 0.4], [0.7, 0.2, -0.5], [0.1, 0.9, -0.6]];
        let load = FaceLoad { force: [3.0, -1.0, 2.0], by_widening: 0.7, by_normal: [-0.5, 1.1, 0.4] };
        let leverage = Leverage { sum: [0.0; 3], squares: [[0.0; 3]; 3] };
        for (f, is_pressed, is_torn) in [(pressed, true, false), (pulled, false, false), (torn, false, true)] {
            let face = Face::new(D, &f, arm).unwrap();
            assert_eq!((face.thinning < 1.0, face.widens < 0.5), (is_pressed, is_torn));
            let rate_of_f = multiply(&l, &f);
            let at = |t: f64| {
                let moved = [0, 1, 2].map(|i| [0, 1, 2].map(|j| f[i][j] + t * rate_of_f[i][j]));
                Face::new(D, &moved, arm).unwrap()
            };
            let (ahead, behind) = (at(1e-5), at(-1e-5));
            let rates = face.rates(&l);
            for a in 0..3 {
                let shifted = (ahead.shift()[a] - behind.shift()[a]) / 2e-5;
                assert!((rates.shift[a] - shifted).abs() < 1e-8, "{is_pressed}: {rates:?} {a} {shifted}");
                let turned = (ahead.normal[a] - behind.normal[a]) / 2e-5;
                assert!((rates.normal[a] - turned).abs() < 1e-8, "{is_pressed}: {rates:?} {a} {turned}");
            }
            let widening = (ahead.widening.ln() - behind.widening.ln()) / 2e-5;
            assert!((rates.widening - widening).abs() < 1e-8, "{rates:?} {widening}");
            // V P : dF/dt = e d(ln m)/dt + g . dn/dt - f . d(z - x)/dt, also where the reference configuration has been renewed: dF/dt = L F' there.
            let power = load.power_of_shape(&rates) - dot(load.force, rates.shift);
            let stress = PressedFace::new(face, &f, leverage).stress(&load);
            assert!((contract(&stress, &rate_of_f) - power).abs() < 1e-12);
            let renewed = [[0.9, 0.1, 0.0], [0.2, 1.1, -0.1], [0.0, 0.3, 1.2]];
            let stress = PressedFace::new(face, &renewed, leverage).stress(&load);
            assert!((contract(&stress, &multiply(&l, &renewed)) - power).abs() < 1e-12);
        }
    }

    #[test]
    fn what_a_load_moves_by_hand() {
        // Two neighbours below at 1 and 2 with g = -0.6 and -0.2 (exact for linear fields), all of one mass; 0.5 below the face. The
        // place moves by 1 + 0.5 0.8 with the particle, by -0.5 0.6 and -0.5 0.2 with the others: 1.96 + 0.09 + 0.01.
        let neighbours = [([0.0, -0.6, 0.0], 1.0), ([0.0, -0.2, 0.0], 1.0)];
        let leverage = Leverage::new(&identity(), neighbours.into_iter());
        let pressed = |f: &Tensor<f64>, leverage| {
            let face = Face::new(Dimension::Two, f, [0.0, 0.5, 0.0]).unwrap();
            PressedFace::new(face, f, leverage)
        };
        assert!((pressed(&identity(), leverage).compliance_along_normal() - 2.06).abs() < 1e-12);
        // However far it is pressed: the depth below the face follows.
        assert!((pressed(&stretched(1.0, 0.5, 1.0), leverage).compliance_along_normal() - 2.06).abs() < 1e-12);
        // Neighbours beside it, of half its mass, widen the face: 2 (3 0.5/1.2)^2 each.
        let beside = [([0.5, 0.0, 0.0], 2.0), ([-0.5, 0.0, 0.0], 2.0)];
        let load = FaceLoad { by_widening: 3.0, ..FaceLoad::default() };
        let f = stretched(1.2, 0.5, 1.0);
        let widened = pressed(&f, Leverage::new(&identity(), beside.into_iter())).compliance(&load);
        assert!((widened - 4.0 * 1.25f64.powi(2)).abs() < 1e-12, "{widened}");
        // Twice the correction, four times the squares.
        let twice = stretched(2.0, 2.0, 2.0);
        let widened = pressed(&f, Leverage::new(&twice, beside.into_iter())).compliance(&load);
        assert!((widened - 16.0 * 1.25f64.powi(2)).abs() < 1e-12, "{widened}");
    }
}
