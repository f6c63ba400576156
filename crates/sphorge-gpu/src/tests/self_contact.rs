//! A body that meets itself on a GPU, beside the processor's engine.

use super::card::gpu;
use super::engine::{conserves_and_repeats_text, count_steps, drifts, start_text};
use sphorge_engine::{Cpu, EngineKind, Simulation};

/// Copper whose upper half moves down and whose lower half moves up, 100 m/s.
pub(super) fn closing(shape: &str, more: &str) -> String {
    format!(
        "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"0.5 mm\" }}\ntime = {{ end = \"60 us\" }}\n{more}\n\
         [[body]]\nname = \"both\"\nmaterial = \"ofhc-copper\"\nshape = {shape}\n\
         velocity-profile = {{ along = \"y\", amplitude = [\"0 m/s\", \"-100 m/s\"], rows = [[\"-1 mm\", -1.0], [\"1 mm\", 1.0]] }}\n"
    )
}

/// Two blocks as one body, the upper one 1 mm to the right.
pub(super) const BLOCKS: &str = "{ union = [{ box = { min = [\"-3 mm\", \"1 mm\"], max = [\"5 mm\", \"6 mm\"] } }, \
                      { box = { min = [\"-4 mm\", \"-6 mm\"], max = [\"4 mm\", \"-1 mm\"] } }] }";

/// The upper one, above a plane a metre away from the origin.
pub(super) const UPPER: &str = "{ box = { min = [\"-3 mm\", \"1001 mm\"], max = [\"5 mm\", \"1006 mm\"] } }";

pub(super) const RUBS: &str = "contact = { penalty = { friction = 0.3 } }";
/// So stiff that the contact limits the step.
const STIFF: &str = "contact = { penalty = { friction = 0.3, stiffness = 3.0 } }";
pub(super) const PLANE: &str = "symmetry = [{ axis = \"y\", at = \"1000 mm\", side = \"positive\" }]";

/// A hairpin, whose arms close.
pub(super) const HAIRPIN: &str = "{ difference = [{ box = { min = [\"0 mm\", \"-3.5 mm\"], max = [\"10 mm\", \"3.5 mm\"] } }, \
                       { box = { min = [\"5 mm\", \"-1.5 mm\"], max = [\"17 mm\", \"1.5 mm\"] } }] }";

/// What is compared: energies, works of the contact, extents, J and m.
fn numbers(simulation: &Simulation) -> Vec<(&'static str, f64, f64)> {
    let (p, ledger) = (simulation.particles().unwrap(), simulation.ledger().unwrap());
    let (e, contact) = (ledger.total.energies, ledger.contacts[0]);
    let energy = e.kinetic + e.internal;
    let pressed = contact.stored_energy.abs() + contact.damping_work + contact.friction_work;
    let extent = |axis: usize| {
        let along = || p.position.iter().map(|x| x[axis]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let hottest = p.temperature.iter().fold(0.0f64, |a, b| a.max(*b));
    vec![
        ("kinetic", e.kinetic, energy),
        ("internal", e.internal, energy),
        ("plastic work", e.plastic_work, energy),
        ("stored", contact.stored_energy, pressed),
        ("damped", contact.damping_work, pressed),
        ("rubbed", contact.friction_work, pressed),
        ("width", extent(0), extent(0)),
        ("height", extent(1), extent(1)),
        ("hottest", hottest, hottest),
    ]
}

/// Runs of both engines to a time, s, through the middle of it; how near they must be.
pub(super) fn compare(deck: &str, end: f64, near: f64) {
    let [theirs, ours] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
        let mut simulation = start_text(kind, "closing", deck, &[]);
        let first = simulation.ledger().unwrap();
        let states = [0.5 * end, end].map(|end| (count_steps(&mut simulation, end), numbers(&simulation)));
        assert!(drifts(&simulation, &first).0.abs() < 2e-8, "{}: {:?}", kind.name(), drifts(&simulation, &first));
        states
    });
    for ((our_steps, ours), (steps, theirs)) in ours.iter().zip(&theirs) {
        assert!(our_steps.abs_diff(*steps) <= 2, "{our_steps} steps on the card, {steps}");
        for ((what, ours, _), (_, theirs, scale)) in ours.iter().zip(theirs) {
            assert!((ours - theirs).abs() <= near * scale, "{what}: {ours} on the card, {theirs}; of {scale}");
        }
    }
    let pressed = theirs[1].1[3].2;
    assert!(pressed > 1e-3 * theirs[1].1[0].2, "nothing meets: {pressed}");
}

#[test]
fn parts_of_a_body_that_strike_match_the_cpu() {
    compare(&closing(BLOCKS, RUBS), 15e-6, 2e-4);
}

#[test]
fn a_state_under_contact_resumes_to_the_same_bits() {
    conserves_and_repeats_text("closing", &closing(BLOCKS, RUBS), &[], 11e-6);
}

#[test]
fn a_body_that_strikes_its_image_matches_the_cpu() {
    compare(&closing(UPPER, &format!("{STIFF}\n{PLANE}")), 15e-6, 2e-4);
}

#[test]
fn arms_of_a_hairpin_meet_as_on_the_cpu() {
    compare(&closing(HAIRPIN, ""), 40e-6, 1e-3);
}

/// The same in space.
pub(super) fn in_space(text: &str) -> String {
    let space = text.replace("plane-strain", "3d").replace("0.5 mm", "0.8 mm");
    let deep = |from: f64| format!(", \"{from} mm\"]");
    let mut text = String::new();
    for (k, part) in space.split("min = [").enumerate() {
        if k == 0 {
            text += part;
            continue;
        }
        let (low, rest) = part.split_once(']').unwrap();
        let (high, rest) = rest.split_once("max = [").and_then(|(_, rest)| rest.split_once(']')).unwrap();
        text += &format!("min = [{low}{}, max = [{high}{}{rest}", deep(0.0), deep(4.0));
    }
    text.replace("\"0 m/s\", \"-100 m/s\"", "\"0 m/s\", \"-100 m/s\", \"0 m/s\"")
}

#[test]
fn parts_in_space_match_the_cpu() {
    compare(&in_space(&closing(BLOCKS, RUBS)), 13e-6, 5e-4);
}
