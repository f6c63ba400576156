//! The laws of the contact between bodies. Bodies are of few kinds: a law is sums over layers of particles, worked out once for two kinds
//! rather than for each pair of hundreds of bodies.

use sphorge_physics::contact::{ContactBody, ContactLaw};

/// The law of every ordered pair of bodies.
#[derive(Clone, Debug)]
pub(super) struct PairLaws {
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
    pub(super) fn new(
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
    pub(super) fn of(&self, a: usize, b: usize) -> &ContactLaw<f64> {
        let kind = self.kinds[a];
        if a == b { &self.own[kind] } else { &self.pairs[kind * self.count + self.kinds[b]] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphorge_physics::Dimension;
    use sphorge_physics::contact::ContactStrength;
    use sphorge_physics::kernel::Kernel;
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
