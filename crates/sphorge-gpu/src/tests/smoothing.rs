//! Smoothing lengths that follow the density on a GPU, beside the processor's engine.

use super::card::gpu;
use super::contact::{PRESENT, RUBS, compare as compare_contact, striking};
use super::engine::{
    PLATE, compare, components, conserves_and_repeats, conserves_and_repeats_text, count_steps, start,
};
use super::verlet_lists::compare as compare_searches;
use sphorge_engine::persist::MemoryArchive;
use sphorge_engine::{FieldSource, Simulation};

const FOLLOWS: (&str, &str) = ("numerics.smoothing-length", "\"follow-density\"");
const SKIN: [(&str, &str); 2] = [("search", "\"skin\""), ("numerics.integrator", "\"leapfrog\"")];
/// Compressed by a third, and torn to half of the density.
const DISC: [(&str, &str); 3] = [("particles.spacing", "\"0.8 mm\""), ("time.courant", "0.1"), FOLLOWS];

#[test]
fn with_a_search_every_step_they_match_the_cpu() {
    compare(PLATE.0, &[PLATE.1[0], FOLLOWS, ("wall.0.contact", "\"monaghan-kos\"")], 5e-6, 1e-4);
    compare("penetration", &[&DISC[..], &[("search", "\"every-step\"")]].concat(), 1.5e-6, 1e-4);
    conserves_and_repeats(PLATE.0, &[PLATE.1[0], FOLLOWS], 2e-6);
}

#[test]
fn lists_with_a_skin_are_searched_again_when_they_have_used_it_up() {
    // Material that expands takes of the skin: lists last less long than by the ways of particles alone.
    compare_searches("penetration", &[&DISC[..], &SKIN[..1]].concat(), (100, 1.5e-6), (0, 1, 1e-3));
    let meet = ("contact", "\"penalty\"");
    compare_searches("penetration", &[&DISC[..], &SKIN[..1], &[meet]].concat(), (100, 1.5e-6), (0, 1, 1e-3));
    compare("penetration", &[&DISC[..], &SKIN[..1]].concat(), 1.5e-6, 1e-4);
    compare(PLATE.0, &[PLATE.1[0], FOLLOWS, SKIN[0]], 5e-6, 1e-4);
    conserves_and_repeats("penetration", &[&DISC[..], &SKIN].concat(), 0.5e-6);
}

#[test]
fn a_saved_state_has_them_and_those_of_its_last_search() {
    let disc = [&DISC[..], &SKIN[..1]].concat();
    let [mut simulation, mut other] = [(); 2].map(|()| start(&gpu(), "penetration", &disc));
    count_steps(&mut simulation, 0.6e-6);
    let of = |simulation: &Simulation| components(&simulation.read("smoothing_length").unwrap());
    assert_ne!(of(&simulation), of(&other));
    let mut searches = 0;
    for _ in 0..80 {
        let mut archive = MemoryArchive::new();
        simulation.persist(&mut archive).unwrap();
        other.persist(&mut archive.to_load()).unwrap();
        assert_eq!(of(&simulation), of(&other));
        // What is left of the skin is known from then.
        let [share, again] = [&mut simulation, &mut other].map(|of| of.step(None).unwrap().searched_fraction);
        assert_eq!(share, again);
        searches += u32::from(share == 1.0);
    }
    assert!(searches > 5, "{searches}");
}

#[test]
fn the_contact_keeps_those_of_the_start() {
    let text = striking(&format!("{PRESENT}\n{RUBS}"));
    compare_contact(&text, &[FOLLOWS], 7e-6, 2e-4);
    compare_contact(&text, &[&SKIN[..], &[FOLLOWS]].concat(), 7e-6, 2e-4);
    conserves_and_repeats_text("striking", &text, &[&SKIN[..], &[FOLLOWS]].concat(), 4e-6);
}
