//! Every shipped deck, coarse and for some steps, on ranks and threads.

use super::{setup, tried, try_run, try_run_on_ranks};
use sphorge::engine::Cpu;

/// Decks with what makes them small, and as large as seven ranks need.
const COARSE: [(&str, &[(&str, &str)]); 29] = [
    ("block", &[("particles.spacing", "\"4 mm\"")]),
    ("bullet", &[("particles.spacing", "\"24 mm\""), ("body.1.spacing", "\"12 mm\"")]),
    ("convecting-block", &[]),
    ("copper-bar", &[("particles.spacing", "\"0.635 mm\"")]),
    ("crack-energy", &[]),
    ("disc-on-plate", &[]),
    ("elastic-bar", &[]),
    ("elastic-plastic-piston", &[("particles.spacing", "\"0.04 mm\"")]),
    ("failure-strains", &[("particles.spacing", "\"0.1 mm\""), ("time.fixed-step", "\"1 ns\"")]),
    ("heat-slab", &[("particles.spacing", "\"0.08 mm\"")]),
    ("high-shear", &[]),
    ("homogeneous", &[]),
    ("iron-plate", &[]),
    ("notched-bars", &[]),
    ("oscillating-plate", &[]),
    ("penetration", &[]),
    ("perforation", &[("particles.spacing", "\"3 mm\"")]),
    ("plate-impact", &[("particles.spacing", "\"0.06 mm\"")]),
    ("pulled", &[]),
    ("rotating-rod", &[("particles.spacing", "\"1.25 mm\"")]),
    ("rubber-rings", &[("particles.spacing", "\"1.5 mm\"")]),
    ("spall", &[("particles.spacing", "\"0.005 mm\"")]),
    ("taylor-bar", &[("particles.spacing", "\"1 mm\"")]),
    ("taylor-bar-42crmo4", &[("particles.spacing", "\"0.6 mm\"")]),
    ("taylor-fracture", &[]),
    ("taylor-plate", &[]),
    ("tensile", &[("particles.spacing", "\"12 mm\"")]),
    ("two-materials", &[("particles.spacing", "\"0.15 mm\"")]),
    ("weldox-tension", &[("particles.spacing", "\"0.2 mm\"")]),
];

/// Compares a deck on ranks, two of two threads each and the others of one, with one process; with every number of ranks on both numbers of threads.
fn compare_for_some_steps(deck: &str, changes: &[(&str, &str)]) {
    let changes = [changes, &[("time.max-steps", "12")]].concat();
    let expected = try_run(&Cpu, setup(deck, &changes), 1).unwrap();
    assert!(expected.len() > 2, "{deck}: {:?}", expected.keys());
    let ranks = tried(&[1, 2, 3, 4, 7]);
    let is_all = ranks.len() > 2;
    for ranks in ranks {
        for threads in [1, 2].into_iter().filter(|threads| is_all || (*threads == 2) == (ranks == 2)) {
            let found = try_run_on_ranks(deck, &changes, ranks, threads).unwrap();
            assert!(found == expected, "`{deck}` on {ranks} ranks of {threads} threads differs");
        }
    }
}

#[test]
fn every_shipped_deck_has_the_bits_of_one_process() {
    let mut names: Vec<&str> = sphorge::decks::DECKS.iter().map(|deck| deck.name).collect();
    names.sort_unstable();
    assert!(names.iter().eq(COARSE.iter().map(|(name, _)| name)), "{names:?}");
    COARSE.iter().for_each(|(deck, changes)| compare_for_some_steps(deck, changes));
}
