//! Contact between bodies.

use super::super::{choice::*, value::*};
use schemars::JsonSchema;
use serde::Deserialize;

/// A contact between bodies with constants of its own; one of them.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawBodyContact {
    /// Bodies push each other and never pull; the force grows from the kernel-weighted overlap of their particles.
    pub(crate) penalty: Option<RawBodyPenalty>,
}

/// Constants of the contact that never pulls.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawBodyPenalty {
    /// Pressure per closure by one spacing, over the harmonic mean of the two bulk moduli.
    #[schemars(extend("examples" = [2.0], "default" = 1.0))]
    pub(crate) stiffness: Option<Given<Number>>,
    /// Damping as a share of critical, 0 to 1.
    #[schemars(extend("examples" = [0.5], "default" = 0.3))]
    pub(crate) damping: Option<Given<Number>>,
    /// Coulomb coefficient.
    #[schemars(extend("examples" = [0.1], "default" = 0.0))]
    pub(crate) friction: Option<Given<Number>>,
}

/// The key `contact` of a deck.
pub(crate) type RawContactChoice = ScalarOr<Choice<BodyContactWord>, RawBodyContact>;
