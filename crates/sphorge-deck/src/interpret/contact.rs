//! Contact between bodies.

use super::exactly_one;
use crate::defaults;
use crate::fault::{Fault, Problems};
use crate::raw::{RawBodyPenalty, RawContactChoice};
use crate::value::ScalarOr;
use sphorge_engine::model::{BodyContact, Formulation};
use sphorge_physics::contact::ContactStrength;
use sphorge_physics::parameter::Bound;

/// How that many bodies meet; where the deck does not say, in the way of the formulation.
pub(crate) fn contact(
    raw: Option<&RawContactChoice>,
    formulation: Option<Formulation>,
    bodies: usize,
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
    // A body alone meets itself alone, which cards compute by overlap, too.
    let at_facets = match &table.surfaces {
        Some(word) => word.get(problems)?,
        None => has_cells && bodies > 1,
    };
    if let (true, false, Some(word)) = (at_facets, has_cells, &table.surfaces) {
        let message = "facets follow the deformation of cells, which the updated Lagrangian form does not have";
        let fault = Fault::new("not-together", message, word.span(), "not possible");
        problems.push(fault.help("leave `surfaces` out, or use `method = \"total-lagrangian\"`"));
        return None;
    }
    let stiffness = table.stiffness.as_ref().map_or(Some(None), |s| s.positive(problems).map(Some));
    let damping = table.damping.as_ref().map_or(Some(None), |d| d.within(Bound::Between(0.0, 1.0), problems).map(Some));
    let friction = table.friction.as_ref().map_or(Some(None), |f| f.within(Bound::NonNegative, problems).map(Some));
    let (stiffness, damping, friction) = (stiffness?, damping?, friction?);
    let strength = |usual: (f64, f64, f64)| ContactStrength {
        stiffness: stiffness.unwrap_or(usual.0),
        damping: damping.unwrap_or(usual.1),
        friction: friction.unwrap_or(usual.2),
    };
    let by_overlap = strength(defaults::BODY_CONTACT);
    Some(match at_facets {
        true => BodyContact::Facets { whole: strength(defaults::FACET_CONTACT), apart: by_overlap },
        false => BodyContact::Penalty(by_overlap),
    })
}
