//! Contact between bodies.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

tables! {
    /// The contact between bodies with its constants.
    RawBodyContact {
        /// Bodies push each other but never pull.
        penalty: Option<RawBodyPenalty>;
    }

    /// Constants of the penalty contact between bodies.
    #[derive(Default)]
    RawBodyPenalty {
        /// Where bodies meet.
        surfaces: Option<Choice<ContactSurfacesWord>>, otherwise "`\"facets\"` between bodies in the total Lagrangian form, `\"overlap\"` of one body with itself and in the updated Lagrangian form";
        /// Pressure for a closure of one spacing, over the harmonic mean of the two bulk moduli.
        stiffness: Option<Given<Number>>, example 4.0, otherwise "2.0 with facets, 1.0 by overlap";
        /// Damping as a share of critical, 0 to 1.
        damping: Option<Given<Number>>, example 0.5, otherwise "0.05 with facets, 0.3 by overlap";
        /// Coulomb friction coefficient. The heat of friction is divided in proportion to the effusivities sqrt(k rho c) of the materials,
        /// or equally where a conductivity is not given.
        friction: Option<Given<Number>>, example 0.1, default 0.0;
    }
}

/// The key `contact` of a deck.
pub(crate) type RawContactChoice = ScalarOr<Choice<BodyContactWord>, RawBodyContact>;
