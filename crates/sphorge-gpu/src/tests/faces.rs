//! Gradients that are exact for quadratic fields at faces on a GPU, beside the processor's engine.

use super::card::gpu;
use super::contact::{self, striking};
use super::engine::{IRON, compare, compare_fields, conserves_and_repeats, repeats_and_conserves_to};
use super::facet_contact::{RUBS, SMOOTH};
use super::periodic::{JOINED, ON_A_FOOT};
use super::renewal;
use super::self_contact::{self, HAIRPIN, closing};
use sphorge_deck::{decks, load_text};
use sphorge_engine::{EngineKind, PartKind};

const QUADRATIC: (&str, &str) = ("search.total-lagrangian.faces", "\"quadratic\"");
const RENEWED: (&str, &str) = ("search.total-lagrangian.renewal", "1.1");

#[test]
fn quadratic_gradients_at_faces_match_the_cpu() {
    let changes = [IRON.1[0], IRON.1[1], QUADRATIC];
    compare_fields(IRON.0, &changes, 3e-6);
    compare(IRON.0, &changes, 12e-6, 1e-4);
}

#[test]
fn faces_in_space_between_planes_of_symmetry_match_the_cpu() {
    let changes = [("particles.spacing", "\"0.95 mm\""), QUADRATIC];
    compare_fields("copper-bar", &changes, 4e-6);
}

#[test]
fn energy_and_momentum_are_conserved_with_faces_and_a_saved_state_resumes_to_the_same_bits() {
    conserves_and_repeats(IRON.0, &[IRON.1[0], IRON.1[1], QUADRATIC], 4e-6);
    conserves_and_repeats("copper-bar", &[("particles.spacing", "\"1.27 mm\""), QUADRATIC], 3e-6);
}

#[test]
fn faces_of_a_foot_whose_reference_is_renewed_match_the_cpu() {
    let changes = [IRON.1[0], IRON.1[1], QUADRATIC, RENEWED];
    renewal::compare(renewal::shipped(IRON.0), &changes, 8e-6, 1, (1e-4, 3e-4));
    repeats_and_conserves_to(5e-8, IRON.0, renewal::shipped(IRON.0), &changes, 6e-6);
}

#[test]
fn faces_beyond_periodic_ends_match_the_cpu() {
    compare_fields(IRON.0, &[&ON_A_FOOT[..], &[QUADRATIC]].concat(), 3e-6);
    renewal::compare(renewal::shipped(IRON.0), &[&JOINED[..], &[QUADRATIC]].concat(), 10e-6, 1, (1e-4, 3e-4));
}

#[test]
fn faces_of_bodies_that_meet_at_facets_match_the_cpu() {
    contact::compare(&striking(RUBS), &[QUADRATIC], 10e-6, 2e-4);
    let faces = "search = { total-lagrangian = { faces = \"quadratic\" } }";
    self_contact::compare(&closing(HAIRPIN, &format!("{SMOOTH}\n{faces}")), 30e-6, 1e-3);
}

#[test]
fn faces_on_several_cards_are_refused() {
    let deck = decks::find(IRON.0).unwrap();
    let model = |changes: &[(String, String)]| load_text(deck.name, deck.text, changes).unwrap().model;
    let of_faces = model(&[(QUADRATIC.0.to_owned(), QUADRATIC.1.to_owned())]);
    let refusal = gpu().supports_in_parts(&of_faces).unwrap_err();
    assert!(refusal.what.contains("quadratic") && refusal.help.contains("--engine cpu"), "{refusal:?}");
    assert!(gpu().supports(&of_faces).is_ok() && gpu().supports_in_parts(&model(&[])).is_ok());
}
