//! Gradients that are exact for quadratic fields at faces, whose neighbours and whose stresses are on other ranks.

use super::contact::CLAMP;
use super::symmetry::{CELL, CORNER, FOLDED};
use super::{IN_THE_INITIAL_CONFIGURATION, compare, setup, try_run};
use sphorge::engine::Cpu;

pub(super) const QUADRATIC: (&str, &str) = ("search", "{ total-lagrangian = { faces = \"quadratic\", renewal = 0 } }");

/// The same of a body that comes apart.
pub(super) const APART: (&str, &str) =
    ("search", "{ total-lagrangian = { faces = \"quadratic\", self-contact = false, renewal = 1.1 } }");

#[test]
fn a_block_with_faces_that_walls_push_and_that_is_renewed() {
    compare(IN_THE_INITIAL_CONFIGURATION, &[APART], &[1, 2, 3, 4]);
}

#[test]
fn faces_between_planes_beyond_periodic_ends_and_at_images_they_meet() {
    let method = ("method", "\"total-lagrangian\"");
    compare(CORNER, &[method, QUADRATIC], &[2, 3, 4]);
    compare(CELL, &[method, QUADRATIC], &[2, 3]);
    let quadratic = compare(FOLDED, &[QUADRATIC], &[2, 4]);
    let linear = try_run(&Cpu, setup(FOLDED, &[(QUADRATIC.0, "{ total-lagrangian = { renewal = 0 } }")]), 1).unwrap();
    assert!(quadratic != linear, "there are no faces");
}

#[test]
fn faces_of_bodies_that_meet_at_facets() {
    compare(CLAMP, &[QUADRATIC], &[2, 3]);
}

#[test]
fn faces_in_space() {
    let quadratic = ("search", "{ total-lagrangian = { faces = \"quadratic\" } }");
    let short = [("particles.spacing", "\"0.8 mm\""), ("time.end", "\"12 us\""), ("output.frames", "2")];
    let rows = ("output.history-interval", "\"1 us\"");
    compare("copper-bar", &[short[0], short[1], short[2], rows, quadratic], &[2, 4]);
}
