//! Bodies that meet at their facets on a GPU, beside the processor's engine.

use super::contact::{CONDUCT, compare, in_space, slabs, striking};
use super::engine::conserves_and_repeats_text;
use super::self_contact::{self, BLOCKS, HAIRPIN, PLANE, UPPER, closing};

pub(crate) const SMOOTH: &str = "contact = { penalty = { surfaces = \"facets\" } }";
pub(crate) const RUBS: &str = "contact = { penalty = { surfaces = \"facets\", friction = 0.3 } }";
/// So stiff that the contact limits the step.
const STIFF: &str = "contact = { penalty = { surfaces = \"facets\", friction = 0.3, stiffness = 3.0 } }";

#[test]
fn bodies_in_contact_at_facets_match_the_cpu() {
    compare(&striking(SMOOTH), &[], 10e-6, 2e-4);
}

#[test]
fn friction_at_facets_matches_the_cpu() {
    compare(&striking(RUBS), &CONDUCT, 10e-6, 2e-4);
    compare(&striking(STIFF), &[], 6e-6, 2e-4);
}

#[test]
fn bodies_in_contact_at_facets_in_space_match_the_cpu() {
    compare(&in_space(RUBS), &[], 10e-6, 2e-4);
}

#[test]
fn nine_bodies_in_contact_at_facets_match_the_cpu() {
    compare(&slabs(RUBS), &[], 8e-6, 2e-4);
}

#[test]
fn contact_at_facets_is_reproducible_to_the_bit() {
    conserves_and_repeats_text("striking", &striking(RUBS), &[], 4e-6);
}

#[test]
fn a_body_that_strikes_its_image_at_facets_matches_the_cpu() {
    self_contact::compare(&closing(UPPER, &format!("{STIFF}\n{PLANE}")), 15e-6, 2e-4);
}

#[test]
fn arms_of_a_hairpin_meet_at_facets_as_on_the_cpu() {
    self_contact::compare(&closing(HAIRPIN, SMOOTH), 40e-6, 1e-3);
}

/// In the plane the processor's own runs in mixed and double precision are 2e-4 of the energy apart.
#[test]
fn parts_of_a_body_in_contact_at_facets_in_space_match_the_cpu() {
    self_contact::compare(&self_contact::in_space(&closing(BLOCKS, RUBS)), 13e-6, 5e-4);
}
