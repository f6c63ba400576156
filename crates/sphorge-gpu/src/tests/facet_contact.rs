//! Bodies that meet at their facets on a card, beside the processor's engine.

use super::contact::{CONDUCT, compare, in_space, slabs, striking};
use super::engine::conserves_and_repeats_text;
use super::self_contact::{self, BLOCKS, HAIRPIN, PLANE, UPPER, closing};

pub(crate) const SMOOTH: &str = "contact = { penalty = { surfaces = \"facets\" } }";
pub(crate) const RUBS: &str = "contact = { penalty = { surfaces = \"facets\", friction = 0.3 } }";
/// So stiff that the contact limits the step.
const STIFF: &str = "contact = { penalty = { surfaces = \"facets\", friction = 0.3, stiffness = 3.0 } }";

#[test]
fn bodies_that_meet_at_facets_are_those_of_the_processor() {
    compare(&striking(SMOOTH), &[], 10e-6, 2e-4);
}

#[test]
fn bodies_that_rub_at_facets_are_those_of_the_processor() {
    compare(&striking(RUBS), &CONDUCT, 10e-6, 2e-4);
    compare(&striking(STIFF), &[], 6e-6, 2e-4);
}

#[test]
fn bodies_that_meet_at_facets_in_space_are_those_of_the_processor() {
    compare(&in_space(RUBS), &[], 10e-6, 2e-4);
}

#[test]
fn nine_bodies_that_meet_at_facets_are_those_of_the_processor() {
    compare(&slabs(RUBS), &[], 8e-6, 2e-4);
}

#[test]
fn the_same_bits_come_again_where_facets_are_pressed() {
    conserves_and_repeats_text("striking", &striking(RUBS), &[], 4e-6);
}

#[test]
fn a_body_that_strikes_its_image_at_facets_is_that_of_the_processor() {
    self_contact::compare(&closing(UPPER, &format!("{STIFF}\n{PLANE}")), 15e-6, 2e-4);
}

#[test]
fn arms_of_a_hairpin_meet_at_facets_as_on_the_processor() {
    self_contact::compare(&closing(HAIRPIN, SMOOTH), 40e-6, 1e-3);
}

/// In the plane the processor's own runs in mixed and double precision are 2e-4 of the energy apart.
#[test]
fn parts_of_a_body_that_meet_at_facets_in_space_are_those_of_the_processor() {
    self_contact::compare(&self_contact::in_space(&closing(BLOCKS, RUBS)), 13e-6, 5e-4);
}
