//! How stiff the contacts of a particle are, and the step that takes.

use super::{ContactLaw, Overlap, PairKernels, pair_pressures, pair_weight};
use crate::face::{FaceLoad, FaceMetric, PressedFace};
use crate::tensor::dot;
use crate::time_step::oscillator_limit;
use crate::{Scalar, Vector};

/// Overlap short of none from which on the stiffness counts: a step that is taken apart may end in contact.
const NEAR: f64 = 0.1;

/// `phi''` of an overlap, that of first touch where it is near; zero where it is far.
#[inline(always)]
fn overlap_stiffness<T: Scalar>(overlap: T) -> T {
    let s = overlap.max(T::zero());
    if overlap > -T::of(NEAR) { T::one() + s * s } else { T::zero() }
}

/// Stiffness and damping of the contacts of a particle: its row of the second derivative of the energy by places and by the shape of faces, as if
/// all that press it and all that press those moved at their worst, by what its face moves ([`PressedFace::compliance`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactStiffness<'a, T> {
    face: Option<&'a PressedFace<T>>,
    /// Compliance along the normal.
    along: T,
    /// Of the overlaps its neighbours see, N/m.
    stiffness: T,
    /// Largest `K/S_ab` among its contacts, Pa.
    modulus: T,
    /// N s/m.
    damping: T,
}

impl<'a, T: Scalar> ContactStiffness<'a, T> {
    /// Before the first neighbour, of a particle near this face, if any.
    pub fn new(face: Option<&'a PressedFace<T>>) -> Self {
        let along = face.map_or(T::one(), |face| face.compliance_along_normal());
        Self { face, along, stiffness: T::zero(), modulus: T::zero(), damping: T::zero() }
    }

    fn compliance(&self, load: &FaceLoad<T>) -> T {
        self.face.map_or_else(|| dot(load.force, load.force), |face| face.compliance(load))
    }

    /// Adds a neighbour in another body with its overlap at `x_ij` (m); volumes at rest, m^d.
    #[inline(always)]
    pub fn add(
        &mut self,
        law: &ContactLaw<T>,
        kernels: &PairKernels<T>,
        (metric, x_ij): (&FaceMetric<T>, Vector<T>),
        (own, other): (&Overlap<T>, &Overlap<T>),
        volume_i: T,
        volume_j: T,
    ) {
        let overlaps = (own.overlap, other.overlap);
        if overlaps.0.max(overlaps.1) <= -T::of(NEAR) {
            return;
        }
        let (of_own, of_other) = pair_pressures(law, overlaps);
        let weight = pair_weight(kernels, volume_i, volume_j);
        self.stiffness += T::of(2.0) * law.modulus * weight * (of_own + of_other) / kernels.0.h * self.along;
        self.damping += law.damping * weight * self.along;
        self.modulus = self.modulus.max(law.modulus * law.inverse_sums.0);
        let others = overlap_stiffness(overlaps.1);
        if others > T::zero() {
            // Derivative of s_j by the place of i and by its face.
            let seen = volume_i * law.inverse_sums.1;
            let (by_widening, by_normal) = metric.turn(x_ij);
            let slope = -seen * kernels.1.slope;
            let through = FaceLoad {
                force: kernels.1.away.map(|c| seen * c),
                by_widening: slope * by_widening,
                by_normal: by_normal.map(|c| slope * c),
            };
            let moved = (self.compliance(&through) * self.along).sqrt();
            self.stiffness += T::of(2.0) * law.modulus * others * moved * other.weight * law.inverse_sums.1;
        }
    }

    /// Largest stable step, s, of a particle of that mass (kg).
    pub fn limit(&self, own: &Overlap<T>, mass: T) -> T {
        let seen = FaceLoad { force: own.away, ..FaceLoad::default() };
        let two = T::of(2.0);
        // As far as all that is seen moves against the particle.
        let moved = (self.compliance(&seen) * self.along).sqrt();
        let stiffness = self.stiffness + two * self.modulus * overlap_stiffness(own.overlap) * moved * own.weight;
        oscillator_limit(stiffness / mass, two * self.damping / mass)
    }
}

/// Share of the largest stable step of a contact that is taken at a Courant number: twice that number, no more than nine tenths. The limit is that of
/// the springs as they are, where that by the speed of sound leaves room for what the sums do not say.
pub fn contact_share(courant: f64) -> f64 {
    (2.0 * courant).min(0.9)
}

#[cfg(test)]
mod tests {
    use super::super::ContactKernel;
    use super::*;
    use crate::Dimension;
    use crate::face::{Face, Leverage};

    const LAW: ContactLaw<f64> = ContactLaw { inverse_sums: (1.25, 2.0), modulus: 10.0, damping: 4.0, friction: 0.5 };

    #[test]
    fn the_stable_step_of_a_contact_by_hand() {
        let kernel = ContactKernel { w: 1.0, slope: 0.5, away: [0.0, 1.0, 0.0], h: 4.0 };
        let (kernels, x) = ((kernel, kernel), [0.0, 2.0, 0.0]);
        let of = |overlap: f64, weight: f64| Overlap { overlap, away: [0.0, 3.0, 4.0], weight };
        let limit = |overlaps: (f64, f64)| {
            let mut contact = ContactStiffness::new(None);
            let (own, other) = (of(overlaps.0, 7.0), of(overlaps.1, 9.0));
            contact.add(&LAW, &kernels, (&FaceMetric::round(), x), (&own, &other), 2.0, 3.0);
            contact.limit(&own, 520.0)
        };
        let want =
            |stiffness: f64, damping: f64| oscillator_limit(2.0 * 10.0 * stiffness / 520.0, 2.0 * damping / 520.0);
        // weight 2 3 1 = 6; phi'(1) 1.25 = 5/3, phi'(-1) = 0, so 6 (5/3)/4 = 2.5; nothing of the neighbour's. Own: phi''(1) 5 7 1.25 = 87.5. Damping 4 6.
        assert!((limit((1.0, -1.0)) - want(2.5 + 87.5, 24.0)).abs() < 1e-14);
        // The neighbour's overlap: phi''(1) (2 1 2) 9 2 = 144 and 6 (5/3 + 8/3)/4 = 6.5.
        assert!((limit((1.0, 1.0)) - want(144.0 + 6.5 + 87.5, 24.0)).abs() < 1e-14);
        // Far apart, there is neither; near, that of first touch.
        assert!((limit((-0.05, -1.0)) - want(87.5 / 2.0, 24.0)).abs() < 1e-14);
        assert!(limit((-0.1, -1.0)).is_infinite());
        // On a face half a metre below which there is a neighbour of the same mass, g = -2: a force along y moves it by 1 + 0.5 2 = 2, and the
        // neighbour by -1: compliance 5. Of the own (0, 3, 4) the last does not: 9 5 + 16.
        let f = crate::tensor::identity();
        let face = Face::new(Dimension::Three, &f, [0.0, 0.5, 0.0]).unwrap();
        let leverage = Leverage::new(&f, [([0.0, -2.0, 0.0], 1.0)].into_iter());
        let pressed = PressedFace::new(face, &f, leverage);
        let (own, other) = (of(1.0, 7.0), of(1.0, 9.0));
        let mut contact = ContactStiffness::new(Some(&pressed));
        contact.add(&LAW, &kernels, (&face.metric(), x), (&own, &other), 2.0, 3.0);
        let seen = 2.0 * 7.0 * 1.25 * (61.0f64 * 5.0).sqrt();
        assert!((contact.limit(&own, 520.0) - want(144.0 * 5.0 + 6.5 * 5.0 + seen, 120.0)).abs() < 1e-14);
    }
}
