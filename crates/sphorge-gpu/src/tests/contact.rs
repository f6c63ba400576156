//! Bodies that meet in the contact on a GPU, beside the processor's engine.

use super::card::gpu;
use super::engine::{conserves_and_repeats_text, count_steps, drifts, start_text};
use sphorge_engine::{Cpu, EngineKind, Simulation};

/// Blocks of copper, of iron and of copper again, of other spacings: the upper strikes the middle, 1 mm to the right, which strikes the lower.
pub(crate) fn striking(more: &str) -> String {
    let block = |name: &str, material: &str, spacing: &str, low: &str, high: &str, velocity: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmaterial = \"{material}\"\nspacing = \"{spacing} mm\"\n\
             shape = {{ box = {{ min = {low}, max = {high} }} }}\nvelocity = {velocity}\n"
        )
    };
    format!(
        "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"0.5 mm\" }}\ntime = {{ end = \"60 us\" }}\n{more}\n{}{}{}",
        block(
            "upper",
            "ofhc-copper",
            "0.5",
            "[\"-3 mm\", \"1 mm\"]",
            "[\"5 mm\", \"5 mm\"]",
            "[\"30 m/s\", \"-120 m/s\"]"
        ),
        block(
            "middle",
            "armco-iron",
            "0.4",
            "[\"-4 mm\", \"-3 mm\"]",
            "[\"4 mm\", \"0.6 mm\"]",
            "[\"0 m/s\", \"0 m/s\"]"
        ),
        block(
            "lower",
            "ofhc-copper",
            "0.5",
            "[\"-2 mm\", \"-7 mm\"]",
            "[\"4 mm\", \"-3.4 mm\"]",
            "[\"0 m/s\", \"60 m/s\"]"
        ),
    )
}

/// So that friction warms one more than the other.
pub(super) const CONDUCT: [(&str, &str); 2] =
    [("material.ofhc-copper.conductivity", "\"400 W/(m K)\""), ("material.armco-iron.conductivity", "\"20 W/(m K)\"")];
/// By overlap; at facets: [`super::facet_contact`].
pub(crate) const OVERLAP: &str = "contact = { penalty = { surfaces = \"overlap\" } }";
pub(crate) const RUBS: &str = "contact = { penalty = { surfaces = \"overlap\", friction = 0.3 } }";
/// So stiff that the contact limits the step.
const STIFF: &str = "contact = { penalty = { surfaces = \"overlap\", friction = 0.3, stiffness = 3.0 } }";
/// K.
const AT_START: f64 = 293.15;
pub(super) const PRESENT: &str = "method = \"patino\"\nsearch = \"every-step\"";

/// What is compared: energies and momenta of bodies, works and forces of contacts, extents, each with what it is a part of.
fn numbers(simulation: &Simulation) -> Vec<(String, f64, f64)> {
    let (p, ledger) = (simulation.particles().unwrap(), simulation.ledger().unwrap());
    let energy = ledger.total_energy();
    let mut numbers = Vec::new();
    let mut note = |what: String, number: f64, scale: f64| numbers.push((what, number, scale));
    for (k, body) in ledger.bodies.iter().enumerate() {
        note(format!("kinetic energy of {k}"), body.energies.kinetic, energy);
        note(format!("internal energy of {k}"), body.energies.internal, energy);
        note(format!("plastic work of {k}"), body.energies.plastic_work, energy);
        for axis in 0..2 {
            note(format!("momentum of {k}"), body.momentum[axis], ledger.total.momentum_scale);
        }
    }
    for (k, contact) in ledger.contacts.iter().enumerate() {
        let pressed = contact.stored_energy.abs() + contact.damping_work + contact.friction_work;
        note(format!("stored in {k}"), contact.stored_energy, pressed);
        note(format!("damped in {k}"), contact.damping_work, pressed);
        note(format!("rubbed in {k}"), contact.friction_work, pressed);
        for axis in 0..2 {
            note(
                format!("force of {k}"),
                contact.force[axis],
                5.0 * contact.force.iter().map(|c| c.abs()).sum::<f64>(),
            );
        }
    }
    for axis in 0..2 {
        let along = || p.position.iter().map(|x| x[axis]);
        let extent = along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min);
        note("extent".to_owned(), extent, extent);
    }
    // Friction warms the bodies by their effusivities.
    let warmer = p.temperature.iter().map(|t| t - AT_START).sum::<f64>();
    for k in 0..ledger.bodies.len() {
        let of = (0..p.len()).filter(|i| p.body[*i] as usize == k);
        let rise = of.map(|i| p.temperature[i] - AT_START).sum::<f64>();
        note(format!("heat of {k}"), rise, rise + 0.01 * warmer + 1.0);
    }
    let hottest = p.temperature.iter().fold(0.0f64, |a, b| a.max(*b));
    note("hottest".to_owned(), hottest, hottest);
    numbers
}

/// Runs of both engines to a time, s, through the middle of it; how near they must be.
pub(super) fn compare(deck: &str, overrides: &[(&str, &str)], end: f64, near: f64) {
    let [theirs, ours] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
        let mut simulation = start_text(kind, "striking", deck, overrides);
        let first = simulation.ledger().unwrap();
        let states = [0.5 * end, end].map(|end| (count_steps(&mut simulation, end), numbers(&simulation)));
        let (drift, momentum) = drifts(&simulation, &first);
        assert!(drift.abs() < 2e-8 && momentum < 2e-7, "{}: {drift:e} {momentum:e}", kind.name());
        let contacts = simulation.ledger().unwrap().contacts;
        let meets = |k: &usize| contacts[*k].friction_work + contacts[*k].damping_work > 0.0;
        assert!((0..contacts.len()).filter(meets).count() + 1 >= simulation.model().bodies.len(), "{contacts:?}");
        states
    });
    for ((our_steps, ours), (steps, theirs)) in ours.iter().zip(&theirs) {
        assert!(our_steps.abs_diff(*steps) <= 2, "{our_steps} steps on the card, {steps}");
        for ((what, ours, _), (_, theirs, scale)) in ours.iter().zip(theirs) {
            assert!((ours - theirs).abs() <= near * scale, "{what}: {ours} on the card, {theirs}; of {scale}");
        }
    }
}

#[test]
fn bodies_in_contact_at_faces_match_the_cpu() {
    compare(&striking(RUBS), &CONDUCT, 10e-6, 2e-4);
    compare(&striking(STIFF), &[], 6e-6, 2e-4);
}

#[test]
fn bodies_in_contact_in_the_current_configuration_match_the_cpu() {
    compare(&striking(&format!("{PRESENT}\n{RUBS}")), &[], 7e-6, 2e-4);
    let kept = [("numerics.integrator", "\"leapfrog\""), ("search", "\"skin\"")];
    compare(&striking(&format!("{PRESENT}\n{RUBS}")), &kept[..1], 7e-6, 2e-4);
    compare(&striking(&format!("{PRESENT}\n{RUBS}")), &kept, 7e-6, 2e-4);
}

#[test]
fn bodies_in_contact_under_the_adaptive_search_match_the_cpu() {
    let adaptive = [("numerics.integrator", "\"leapfrog\""), ("search", "\"adaptive\"")];
    compare(&striking(&format!("{PRESENT}\n{RUBS}")), &adaptive, 7e-6, 2e-4);
}

/// Three cubes in space, of two metals and spacings: the upper strikes and rubs the middle, which strikes the lower, beside a plane of symmetry.
pub(super) fn in_space(more: &str) -> String {
    let cube = |name: &str, material: &str, spacing: &str, z: [&str; 2], velocity: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmaterial = \"{material}\"\nspacing = \"{spacing} mm\"\nvelocity = {velocity}\n\
             shape = {{ box = {{ min = [\"0 mm\", \"-2 mm\", \"{} mm\"], max = [\"3 mm\", \"2 mm\", \"{} mm\"] }} }}\n",
            z[0], z[1],
        )
    };
    format!(
        "dimensions = \"3d\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"60 us\" }}\nsymmetry = [{{ axis = \"x\" }}]\n{more}\n{}{}{}",
        cube("upper", "ofhc-copper", "1", ["0.7", "3.7"], "[\"0 m/s\", \"60 m/s\", \"-150 m/s\"]"),
        cube("middle", "armco-iron", "0.8", ["-2.4", "0"], "[\"0 m/s\", \"0 m/s\", \"0 m/s\"]"),
        cube("lower", "ofhc-copper", "1", ["-6.1", "-3.1"], "[\"0 m/s\", \"-20 m/s\", \"80 m/s\"]"),
    )
}

#[test]
fn bodies_in_contact_in_space_match_the_cpu() {
    compare(&in_space(RUBS), &[], 12e-6, 2e-4);
    compare(&in_space(&format!("{PRESENT}\n{RUBS}")), &[("search", "\"skin\"")], 10e-6, 2e-4);
}

#[test]
fn bodies_in_contact_are_reproducible_to_the_bit() {
    conserves_and_repeats_text("striking", &striking(RUBS), &[], 4e-6);
    conserves_and_repeats_text("striking", &striking(&format!("{PRESENT}\n{RUBS}")), &[], 4e-6);
}

/// Nine slabs, each of which falls on the one below.
pub(super) fn slabs(more: &str) -> String {
    let slab = |k: u32| {
        let (low, speed) = (1.6 * f64::from(k), 60 * k);
        format!(
            "[[body]]\nname = \"slab-{k}\"\nmaterial = \"ofhc-copper\"\nvelocity = [\"{} m/s\", \"-{speed} m/s\"]\n\
             shape = {{ box = {{ min = [\"0 mm\", \"{low} mm\"], max = [\"4 mm\", \"{} mm\"] }} }}\n",
            20 * (k % 2),
            low + 1.5,
        )
    };
    let slabs: String = (0..9).map(slab).collect();
    format!(
        "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"0.5 mm\" }}\ntime = {{ end = \"60 us\" }}\n{more}\n{slabs}"
    )
}

#[test]
fn nine_bodies_in_contact_match_the_cpu() {
    compare(&slabs(RUBS), &[], 8e-6, 2e-4);
    compare(&slabs(&format!("{PRESENT}\n{RUBS}")), &[], 8e-6, 2e-4);
    conserves_and_repeats_text("slabs", &slabs(RUBS), &[], 3e-6);
}
