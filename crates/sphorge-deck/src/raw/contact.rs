//! Contact between bodies.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

tables! {
    /// A contact between bodies with constants of its own; one of them.
    RawBodyContact {
        /// Bodies push each other and never pull; the force grows from the kernel-weighted overlap of their particles.
        penalty: Option<RawBodyPenalty>;
    }

    /// Constants of the contact that never pulls.
    #[derive(Default)]
    RawBodyPenalty {
        /// Pressure per closure by one spacing, over the harmonic mean of the two bulk moduli.
        stiffness: Option<Given<Number>>, example 2.0, default 1.0;
        /// Damping as a share of critical, 0 to 1.
        damping: Option<Given<Number>>, example 0.5, default 0.3;
        /// Coulomb coefficient. The heat of friction is shared in proportion to the effusivities sqrt(k rho c) of the materials, by halves
        /// where a conductivity is not given.
        friction: Option<Given<Number>>, example 0.1, default 0.0;
    }
}

/// The key `contact` of a deck.
pub(crate) type RawContactChoice = ScalarOr<Choice<BodyContactWord>, RawBodyContact>;
