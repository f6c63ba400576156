//! Contact between bodies.

use super::exactly_one;
use crate::defaults;
use crate::fault::{Fault, Problems};
use crate::raw::{RawBodyPenalty, RawContactChoice};
use crate::value::ScalarOr;
use sphorge_engine::model::{BodyContact, Formulation};
use sphorge_physics::contact::ContactStrength;
use sphorge_physics::parameter::Bound;

/// How bodies meet; where the deck does not say, in the way of the formulation.
pub(crate) fn contact(
    raw: Option<&RawContactChoice>,
    formulation: Option<Formulation>,
    problems: &mut Problems,
) -> Option<BodyContact> {
    let usual = RawBodyPenalty::default();
    let table = match raw {
        None => match formulation {
            // Its sums hold no particles of other bodies.
            Some(Formulation::TotalLagrangian { .. }) => &usual,
            Some(Formulation::UpdatedLagrangian) | None => return Some(BodyContact::Sph),
        },
        Some(ScalarOr::Scalar(word)) => match word.get(problems)? {
            false => return Some(BodyContact::Sph),
            true => &usual,
        },
        Some(ScalarOr::Composed(table, at)) => {
            exactly_one(vec![("penalty", table.penalty.as_ref())], "a contact", at.clone(), problems)?
        }
    };
    let has_cells = !matches!(formulation, Some(Formulation::UpdatedLagrangian));
    let at_facets = match &table.surfaces {
        Some(word) => word.get(problems)?,
        None => false,
    };
    if let (true, false, Some(word)) = (at_facets, has_cells, &table.surfaces) {
        let message = "facets follow the deformation of cells, which the updated Lagrangian form does not have";
        let fault = Fault::new("not-together", message, word.span(), "not possible");
        problems.push(fault.help("leave `surfaces` out, or use `method = \"total-lagrangian\"`"));
        return None;
    }
    let (stiffness, damping, friction) = if at_facets { defaults::FACET_CONTACT } else { defaults::BODY_CONTACT };
    let stiffness = table.stiffness.as_ref().map_or(Some(stiffness), |s| s.positive(problems));
    let damping = table.damping.as_ref().map_or(Some(damping), |d| d.within(Bound::Between(0.0, 1.0), problems));
    let friction = table.friction.as_ref().map_or(Some(friction), |f| f.within(Bound::NonNegative, problems));
    let strength = ContactStrength { stiffness: stiffness?, damping: damping?, friction: friction? };
    Some(if at_facets { BodyContact::Facets(strength) } else { BodyContact::Penalty(strength) })
}
