//! The laws of the contact between bodies. Bodies are of few kinds: a law is sums over layers of particles, worked out once for two kinds
//! rather than for each pair of hundreds of bodies.

use crate::model::Model;
use sphorge_physics::Dimension;
use sphorge_physics::conduction::friction_share;
use sphorge_physics::contact::{ContactBody, ContactKernel, ContactLaw, ContactStrength};
use sphorge_physics::kernel::{Kernel, pair_smoothing_length};

/// Constants of the contact, by body and by ordered pair of bodies.
#[derive(Clone, Debug)]
pub struct ContactLaws {
    kernel: Kernel,
    dimension: Dimension,
    bodies: usize,
    /// Place among the pairs of bodies that have a contact, of those that have one.
    places: Vec<usize>,
    /// `1/rho` at rest.
    pub(crate) specific_volume: Vec<f64>,
    pub(crate) smoothing_length: Vec<f64>,
    laws: PairLaws,
    /// Share of the heat of friction that the first takes up.
    friction_shares: Vec<f64>,
}

impl ContactLaws {
    /// Of the bodies of a model.
    pub fn new(model: &Model, strength: ContactStrength) -> Self {
        let dimension = model.dimensions.into();
        let kernel = model.numerics.kernel;
        let bodies: Vec<ContactBody> = model
            .bodies
            .iter()
            .map(|body| {
                let material = &model.materials[body.material];
                let speed = material.equation_of_state.reference_sound_speed();
                ContactBody {
                    spacing: body.spacing,
                    smoothing_length: body.smoothing_length,
                    density: material.density,
                    bulk_modulus: material.density * speed * speed,
                }
            })
            .collect();
        let effusivities: Vec<f64> = model.bodies.iter().map(|b| model.materials[b.material].effusivity()).collect();
        let share = |a: usize, b: usize| {
            let share = friction_share(effusivities[a.min(b)], effusivities[a.max(b)]);
            // Both shares are one to the last digit.
            if a <= b { share } else { 1.0 - share }
        };
        let count = bodies.len();
        let mut places = vec![usize::MAX; count * count];
        for (place, (a, b)) in model.contact_pairs().into_iter().enumerate() {
            (places[a * count + b], places[b * count + a]) = (place, place);
        }
        let friction_shares = (0..count * count).map(|k| share(k / count, k % count)).collect();
        Self {
            kernel,
            dimension,
            bodies: count,
            places,
            specific_volume: bodies.iter().map(|b| 1.0 / b.density).collect(),
            smoothing_length: bodies.iter().map(|b| b.smoothing_length).collect(),
            laws: PairLaws::new(
                &bodies,
                |body| ContactLaw::with_itself(kernel, dimension, body, strength),
                |a, b| ContactLaw::new(kernel, dimension, a, b, strength),
            ),
            friction_shares,
        }
    }

    /// Of a particle of the one body with one of the other.
    pub fn law(&self, a: usize, b: usize) -> &ContactLaw<f64> {
        self.laws.of(a, b)
    }

    /// Share of the heat of friction that a particle of the one body takes up beside one of the other.
    pub fn friction_share(&self, a: usize, b: usize) -> f64 {
        self.friction_shares[a * self.bodies + b]
    }

    /// Volume of a mass of a body at rest, m³/kg.
    pub fn specific_volume(&self, a: usize) -> f64 {
        self.specific_volume[a]
    }

    /// Place of a pair of bodies among those that have a contact.
    pub(crate) fn place(&self, a: usize, b: usize) -> usize {
        self.places[a * self.bodies + b]
    }

    /// Kernel of two bodies' particles at a distance, m.
    pub(crate) fn kernel(&self, a: usize, b: usize, r: f64) -> ContactKernel<f64> {
        let h = pair_smoothing_length(self.smoothing_length[a], self.smoothing_length[b]);
        ContactKernel::new(self.kernel, self.dimension, r, h)
    }
}

/// The law of every ordered pair of bodies.
#[derive(Clone, Debug)]
struct PairLaws {
    /// What kind each body is of.
    kinds: Vec<usize>,
    count: usize,
    /// Of a body with itself, by its kind.
    own: Vec<ContactLaw<f64>>,
    /// Of two bodies, by the kind of the one and that of the other.
    pairs: Vec<ContactLaw<f64>>,
}

impl PairLaws {
    /// `with_itself` is the law of a body of this kind with itself, `between` that of two bodies.
    fn new(
        bodies: &[ContactBody],
        with_itself: impl Fn(&ContactBody) -> ContactLaw<f64>,
        between: impl Fn(&ContactBody, &ContactBody) -> ContactLaw<f64>,
    ) -> Self {
        let mut examples: Vec<&ContactBody> = Vec::new();
        let mut kind = |body| {
            examples.iter().position(|known| *known == body).unwrap_or_else(|| {
                examples.push(body);
                examples.len() - 1
            })
        };
        let kinds: Vec<usize> = bodies.iter().map(&mut kind).collect();
        let count = examples.len();
        let mut pairs = vec![ContactLaw::default(); count * count];
        for (a, b) in (0..count).flat_map(|a| (a..count).map(move |b| (a, b))) {
            // One law for both orders of a pair, so that forces are opposite to the last digit.
            let law = between(examples[a], examples[b]);
            (pairs[b * count + a], pairs[a * count + b]) = (law.turned(), law);
        }
        Self { kinds, count, own: examples.into_iter().map(with_itself).collect(), pairs }
    }

    /// Of a particle of the one with one of the other.
    fn of(&self, a: usize, b: usize) -> &ContactLaw<f64> {
        let kind = self.kinds[a];
        if a == b { &self.own[kind] } else { &self.pairs[kind * self.count + self.kinds[b]] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    const STRENGTH: ContactStrength = ContactStrength { stiffness: 0.1, damping: 0.2, friction: 0.3 };

    fn body(spacing: f64, smoothing_length: f64, density: f64, bulk_modulus: f64) -> ContactBody {
        ContactBody { spacing, smoothing_length, density, bulk_modulus }
    }

    fn law(a: &ContactBody, b: &ContactBody) -> ContactLaw<f64> {
        ContactLaw::new(Kernel::default(), Dimension::Two, a, b, STRENGTH)
    }

    fn own(a: &ContactBody) -> ContactLaw<f64> {
        ContactLaw::with_itself(Kernel::default(), Dimension::Two, a, STRENGTH)
    }

    #[test]
    fn every_pair_has_the_law_of_its_two_bodies_to_the_bit() {
        // Kinds that differ in one constant each, in an order that sets kinds against places.
        let (steel, copper) = (body(1e-3, 1.3e-3, 7850.0, 1.6e11), body(1e-3, 1.3e-3, 8960.0, 1.4e11));
        let (fine, smooth) = (body(4e-4, 1.3e-3, 7850.0, 1.6e11), body(1e-3, 1.7e-3, 7850.0, 1.6e11));
        let bodies = [copper, steel, smooth, copper, steel, fine, copper];
        let laws = PairLaws::new(&bodies, own, law);
        for (a, b) in (0..bodies.len()).flat_map(|a| (0..bodies.len()).map(move |b| (a, b))) {
            let expected = if a == b { own(&bodies[a]) } else { law(&bodies[a], &bodies[b]) };
            assert_eq!(laws.of(a, b), &expected, "{a} {b}");
        }
    }

    #[test]
    fn laws_are_worked_out_by_kinds_and_not_by_pairs() {
        let bodies: Vec<_> = (0..300).map(|k| body(1e-3, 1.3e-3, 7850.0 + f64::from(k % 3), 1.6e11)).collect();
        let count = Cell::new(0);
        let counted = |a: &ContactBody, b: &ContactBody| {
            count.set(count.get() + 1);
            law(a, b)
        };
        PairLaws::new(&bodies, own, counted);
        assert_eq!(count.get(), 6);
    }
}
