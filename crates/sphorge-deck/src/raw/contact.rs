//! Contact between bodies.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

tables! {
    /// The contact between bodies with its constants.
    RawBodyContact {
        /// Bodies push each other but never pull. In the total Lagrangian form they meet at the facets of their particles, in the updated one the
        /// force follows from the kernel-weighted overlap of their particles.
        penalty: Option<RawBodyPenalty>;
    }

    /// Constants of the penalty contact between bodies.
    #[derive(Default)]
    RawBodyPenalty {
        /// Pressure for a closure of one spacing, over the harmonic mean of the two bulk moduli.
        stiffness: Option<Given<Number>>, example 4.0, otherwise "2.0 in the total Lagrangian form, else 1.0";
        /// Damping as a share of critical, 0 to 1.
        damping: Option<Given<Number>>, example 0.5, otherwise "0.05 in the total Lagrangian form, else 0.3";
        /// Coulomb friction coefficient. The heat of friction is divided in proportion to the effusivities sqrt(k rho c) of the materials,
        /// or equally where a conductivity is not given.
        friction: Option<Given<Number>>, example 0.1, default 0.0;
    }
}

/// The key `contact` of a deck.
pub(crate) type RawContactChoice = ScalarOr<Choice<BodyContactWord>, RawBodyContact>;
