//! The energy that contacts hold, and how it depends on the shape of faces.

use super::{ContactLaw, PairKernels, overlap_pressure};
use crate::face::FaceMetric;
use crate::{Scalar, Vector};

/// `phi` of an overlap; zero where there is none.
#[inline(always)]
fn overlap_energy<T: Scalar>(overlap: T) -> T {
    let s = overlap.max(T::zero());
    s * s * (T::of(0.5) + s * s / T::of(12.0))
}

/// A neighbour's part in the energy `V_i K phi(s_i)` that particle `i` holds, by what it adds to the sum of the overlap, J; volumes, m^d.
#[inline]
pub fn held_energy<T: Scalar>(
    law: &ContactLaw<T>,
    kernels: &PairKernels<T>,
    overlap: T,
    volume_i: T,
    volume_j: T,
) -> T {
    let s = overlap.max(T::zero());
    law.modulus * volume_i * volume_j * kernels.0.w * law.inverse_sums.0 * overlap_energy(s) / (T::one() + s)
}

/// Derivatives of `V_j K phi(s_j)` by the shape of the face of `i`, as `j` with the overlap `s_j` sees it at `x_ij` (m); volumes, m^d.
#[inline]
pub fn load_of_face<T: Scalar>(
    law: &ContactLaw<T>,
    kernels: &PairKernels<T>,
    (face, x_ij): (&FaceMetric<T>, Vector<T>),
    overlap: T,
    volume_i: T,
    volume_j: T,
) -> (T, Vector<T>) {
    let scale = -law.modulus * volume_i * volume_j * law.inverse_sums.1 * overlap_pressure(overlap) * kernels.1.slope;
    let (by_widening, by_normal) = face.turn(x_ij);
    (scale * by_widening, by_normal.map(|c| scale * c))
}

#[cfg(test)]
mod tests {
    use super::super::{ContactBody, ContactKernel, ContactPair, ContactStrength, Overlap, contact_force, pair_weight};
    use super::*;
    use crate::face::{Face, FaceLoad, Leverage, PressedFace};
    use crate::kernel::Kernel;
    use crate::{Dimension, Tensor};

    #[test]
    fn what_a_pair_holds_by_hand() {
        let law = ContactLaw { inverse_sums: (2.0, 4.0), modulus: 10.0f64, ..ContactLaw::default() };
        let kernel = ContactKernel { w: 0.5, slope: 3.0, away: [0.0; 3], h: 1.0 };
        let kernels = (kernel, ContactKernel { slope: 5.0, ..kernel });
        // 10 0.3 0.2 0.5 2 = 0.6; phi(1) = 7/12, over 2.
        assert!((held_energy(&law, &kernels, 1.0, 0.3, 0.2) - 0.6 * 7.0 / 24.0).abs() < 1e-15);
        assert_eq!(held_energy(&law, &kernels, -0.5, 0.3, 0.2), 0.0);
        // 10 0.3 0.2 4 5 = 12; phi'(2) = 14/3; twice as wide, 3 along the normal and 4 beside: -16/4 and (1 - 1/4) 3 4.
        let face = FaceMetric { normal: [0.0, 1.0, 0.0], widening: 2.0 };
        let (by_widening, by_normal) = load_of_face(&law, &kernels, (&face, [4.0, 3.0, 0.0]), 2.0, 0.3, 0.2);
        assert!((by_widening - 12.0 * 14.0 / 3.0 * 4.0).abs() < 1e-12, "{by_widening}");
        assert!((by_normal[0] + 12.0 * 14.0 / 3.0 * 9.0).abs() < 1e-12 && by_normal[1] == 0.0, "{by_normal:?}");
    }

    /// A particle of one of two bodies.
    #[derive(Clone, Copy)]
    struct Point {
        body: usize,
        x: Vector<f64>,
        f: Tensor<f64>,
        arm: Vector<f64>,
        volume: f64,
    }

    const D: Dimension = Dimension::Three;

    impl Point {
        fn face(&self) -> Face<f64> {
            Face::new(D, &self.f, self.arm).unwrap()
        }

        fn place(&self) -> Vector<f64> {
            let s = self.face().shift();
            [0, 1, 2].map(|a| self.x[a] + s[a])
        }
    }

    /// Two bodies of different spacings on top of each other, deformed unevenly.
    fn cloud() -> Vec<Point> {
        let mut points = Vec::new();
        for (body, spacing, up) in [(0, 1.0, -1.0), (1, 0.8, 1.0)] {
            for k in 0..18 {
                let (column, row, layer) = (k % 3, k / 3 % 3, k / 9);
                let wobble = |n: usize| 0.15 * ((k * 7 + n * 5 + body * 3) as f64).sin();
                let depth = spacing * (0.5 + layer as f64);
                let pressed = [
                    [1.4 + wobble(0), wobble(1), wobble(2)],
                    [wobble(3), 0.6 + wobble(4), wobble(5)],
                    [wobble(6), wobble(7), 1.3 + wobble(8)],
                ];
                points.push(Point {
                    body,
                    x: [
                        spacing * column as f64 + wobble(9),
                        up * (0.55 * depth - 0.05),
                        spacing * row as f64 + wobble(10),
                    ],
                    f: pressed,
                    arm: [0.1 * depth, -up * depth, 0.05 * depth],
                    volume: spacing.powi(3),
                });
            }
        }
        points
    }

    /// The two bodies in contact.
    struct Contact {
        law: ContactLaw<f64>,
        points: Vec<Point>,
    }

    impl Contact {
        fn law(&self, i: usize) -> ContactLaw<f64> {
            if self.points[i].body == 0 { self.law } else { self.law.turned() }
        }

        fn pair(&self, i: usize, j: usize) -> (Vector<f64>, PairKernels<f64>) {
            let (a, b) = (&self.points[i], &self.points[j]);
            let (z, y) = (a.place(), b.place());
            let x = [0, 1, 2].map(|k| z[k] - y[k]);
            let faces = (a.face().metric(), b.face().metric());
            (x, ContactKernel::of_pair(Kernel::WendlandC2, D, x, 1.1, (&faces.0, &faces.1)))
        }

        fn others(&self, i: usize) -> impl Iterator<Item = usize> {
            (0..self.points.len()).filter(move |&j| self.points[j].body != self.points[i].body)
        }

        fn overlaps(&self) -> Vec<f64> {
            let overlap = |i: usize| {
                let mut sum = Overlap::before_the_first();
                for j in self.others(i) {
                    sum.add(&self.law(i), &self.pair(i, j).1, self.points[i].volume, self.points[j].volume);
                }
                sum.overlap
            };
            (0..self.points.len()).map(overlap).collect()
        }

        fn energy(&self) -> f64 {
            let s = self.overlaps();
            let held = |i: usize, j: usize| {
                held_energy(&self.law(i), &self.pair(i, j).1, s[i], self.points[i].volume, self.points[j].volume)
            };
            (0..s.len()).flat_map(|i| self.others(i).map(move |j| (i, j))).map(|(i, j)| held(i, j)).sum()
        }

        /// What it does to the face of a particle.
        fn load(&self, i: usize) -> FaceLoad<f64> {
            let (mut load, s, own) = (FaceLoad::default(), self.overlaps(), &self.points[i]);
            for j in self.others(i) {
                let ((x, kernels), other) = (self.pair(i, j), self.points[j].volume);
                let pair = ContactPair {
                    v: [0.0; 3],
                    volumes: own.volume * other,
                    away: (kernels.0.away, kernels.1.away),
                    weight: pair_weight(&kernels, own.volume, other),
                    overlaps: (s[i], s[j]),
                    direction: x,
                    stopping: 0.0,
                };
                let force = contact_force(&self.law(i), &pair).force;
                let face = own.face().metric();
                let (by_widening, by_normal) =
                    load_of_face(&self.law(i), &kernels, (&face, x), s[j], own.volume, other);
                load.by_widening += by_widening;
                for a in 0..3 {
                    load.force[a] += force[a];
                    load.by_normal[a] += by_normal[a];
                }
            }
            load
        }
    }

    #[test]
    fn forces_and_stresses_of_deformed_faces_are_derivatives_of_one_energy() {
        let body = |spacing: f64| ContactBody { spacing, smoothing_length: 1.1, density: 1.0, bulk_modulus: 7.0 };
        let strength = ContactStrength { stiffness: 1.0, damping: 0.0, friction: 0.0 };
        let law = ContactLaw::new(Kernel::WendlandC2, D, &body(1.0), &body(0.8), strength);
        let contact = Contact { law, points: cloud() };
        assert!(contact.energy() > 0.1, "{}", contact.energy());
        for i in [0, 4, 13, 20, 31] {
            let (load, own) = (contact.load(i), contact.points[i]);
            let leverage = Leverage { sum: [0.0; 3], squares: [[0.0; 3]; 3] };
            let stress = PressedFace::new(own.face(), &own.f, leverage).stress(&load);
            let derivative = |change: &dyn Fn(&mut Point, f64)| {
                let at = |t: f64| {
                    let mut points = contact.points.clone();
                    change(&mut points[i], t);
                    Contact { law, points }.energy()
                };
                (at(1e-5) - at(-1e-5)) / 2e-5
            };
            for a in 0..3 {
                let want = -derivative(&|p, t| p.x[a] += t);
                assert!((load.force[a] - want).abs() < 1e-7, "{i}: {load:?}, {a} {want}");
                for b in 0..3 {
                    let want = derivative(&|p, t| p.f[a][b] += t);
                    assert!((stress[a][b] - want).abs() < 1e-7, "{i}: {stress:?}, {a} {b} {want}");
                }
            }
        }
    }
}
