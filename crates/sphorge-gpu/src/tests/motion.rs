//! Bodies that a deck drives on a GPU, beside the processor's engine.

use super::card::gpu;
use super::engine::{conserves_and_repeats_text, count_steps, drifts, start_text};
use sphorge_engine::{Cpu, EngineKind, Ledger, Particles};

/// Copper whose top is pushed down and to the side, faster and faster; the bottom is held up and free to slide, the foot of a corner of
/// it held on the whole.
pub(crate) fn driven(more: &str) -> String {
    let region = |name: &str, low: &str, high: &str| {
        format!("[[region]]\nname = \"{name}\"\nshape = {{ box = {{ min = {low}, max = {high} }} }}\n")
    };
    format!(
        "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"0.5 mm\" }}\ntime = {{ end = \"60 us\" }}\n{more}\n\
         [[body]]\nname = \"block\"\nmaterial = \"ofhc-copper\"\n\
         shape = {{ box = {{ min = [\"-3 mm\", \"-4 mm\"], max = [\"3 mm\", \"4 mm\"] }} }}\n{}{}{}\
         [[motion]]\nregion = \"top\"\nvelocity = [[[\"0 us\", \"0 m/s\"], [\"4 us\", \"60 m/s\"]], [[\"0 us\", \"0 m/s\"], [\"1 us\", \"-100 m/s\"]]]\n\
         [[motion]]\nregion = \"bottom\"\nvelocity = [\"free\", \"0 m/s\"]\n\
         [[motion]]\nregion = \"corner\"\nvelocity = [\"0 m/s\", \"0 m/s\"]\n",
        region("top", "[\"-3 mm\", \"3 mm\"]", "[\"3 mm\", \"4 mm\"]"),
        region("bottom", "[\"-2 mm\", \"-4 mm\"]", "[\"3 mm\", \"-3 mm\"]"),
        region("corner", "[\"-3 mm\", \"-4 mm\"]", "[\"-2 mm\", \"-3 mm\"]"),
    )
}

/// Sums in the present configuration with what drifts beside the velocity.
const PRESENT: &str = "method = \"patino\"\nsearch = \"every-step\"\nnumerics = { xsph = 0.5 }";
const PRESENT_LEAPFROG: &str =
    "method = \"patino\"\nsearch = \"every-step\"\nnumerics = { xsph = 0.5, integrator = \"leapfrog\" }";

/// Runs of both engines to a time, s: energies and the work and impulse of what drives, places, and the reactions, which are forces of single
/// particles, ten times as far.
fn compare(deck: &str, end: f64, near: f64) {
    let [theirs, ours]: [(Particles, Ledger); 2] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
        let mut simulation = start_text(kind, "driven", deck, &[]);
        let first = simulation.ledger().unwrap();
        count_steps(&mut simulation, end);
        let ledger = simulation.ledger().unwrap();
        let (drift, momentum) = drifts(&simulation, &first);
        assert!(drift.abs() < 2e-8 && momentum < 2e-8, "{}: {drift:e} {momentum:e}", kind.name());
        (simulation.particles().unwrap(), ledger)
    });
    let (ours, theirs, p, q) = (&ours.1, &theirs.1, &ours.0, &theirs.0);
    let close = |what: &str, ours: f64, theirs: f64, scale: f64| {
        assert!((ours - theirs).abs() <= near * scale, "{what}: {ours} on the card, {theirs}; of {scale}");
    };
    let work = theirs.external_work;
    close("work", ours.external_work, work, work);
    close("kinetic", ours.total.energies.kinetic, theirs.total.energies.kinetic, work);
    close("internal", ours.total.energies.internal, theirs.total.energies.internal, work);
    close("integration", ours.integration_energy, theirs.integration_energy, work);
    assert!(theirs.total.energies.plastic_work > 0.2 * work, "nothing flows");
    let impulse = theirs.external_impulse.iter().map(|c| c.abs()).sum::<f64>();
    let reaction = theirs.motion_forces.as_flattened().iter().map(|c| c.abs()).sum::<f64>();
    for axis in 0..2 {
        // Of what is driven with the acceleration that is prescribed, of the rest with that of its forces.
        close("resultant", ours.total.force[axis], theirs.total.force[axis], 10.0 * reaction);
        close("impulse", ours.external_impulse[axis], theirs.external_impulse[axis], impulse);
        for (k, (ours, theirs)) in ours.motion_forces.iter().zip(&theirs.motion_forces).enumerate() {
            close(&format!("reaction {k}"), ours[axis], theirs[axis], 10.0 * reaction);
        }
        for (i, (ours, theirs)) in p.position.iter().zip(&q.position).enumerate() {
            close(&format!("particle {i}"), ours[axis], theirs[axis], 8e-3);
        }
    }
    assert_eq!(theirs.motion_forces[1][0], 0.0);
}

#[test]
fn prescribed_motion_in_the_reference_configuration_matches_the_cpu() {
    compare(&driven(""), 8e-6, 1e-4);
}

#[test]
fn prescribed_motion_in_the_current_configuration_matches_the_cpu() {
    compare(&driven(PRESENT), 5e-6, 1e-4);
    compare(&driven(PRESENT_LEAPFROG), 5e-6, 1e-4);
}

#[test]
fn prescribed_motion_is_reproducible_to_the_bit() {
    conserves_and_repeats_text("driven", &driven(""), &[], 2e-6);
}

#[test]
fn forces_on_driven_particles_do_not_limit_the_step() {
    // All of it is held against a gravity that would move it by a hundredth of a smoothing length and more in a step.
    let deck = "dimensions = \"plane-strain\"\nparticles = { spacing = \"0.5 mm\" }\ngravity = [\"1e12 m/s^2\", \"0 m/s^2\"]\n\
                time = { end = \"60 us\", step-control = { jump = 1e-3 } }\n\
                [[body]]\nname = \"block\"\nmaterial = \"ofhc-copper\"\n\
                shape = { box = { min = [\"-3 mm\", \"-4 mm\"], max = [\"3 mm\", \"4 mm\"] } }\n\
                [[region]]\nname = \"all\"\nbody = \"block\"\n\
                shape = { box = { min = [\"-3 mm\", \"-4 mm\"], max = [\"3 mm\", \"4 mm\"] } }\n";
    let held = "[[motion]]\nregion = \"all\"\nvelocity = [\"0 m/s\", \"0 m/s\"]\n";
    for (deck, fails) in [(deck.to_owned(), true), (format!("{deck}{held}"), false)] {
        let mut simulation = start_text(&gpu(), "held", &deck, &[]);
        let failure = (0..3).find_map(|_| simulation.step(None).err());
        assert_eq!(failure.is_some_and(|failure| failure.step_may_be_smaller), fails);
    }
}
