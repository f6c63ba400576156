//! Bodies that separate on a GPU, whose reference configuration is renewed, beside the processor's engine.

use super::card::gpu;
use super::engine::{IRON, components, count_steps, drifts, repeats_and_conserves_to, start_text};
use super::facet_contact;
use super::self_contact::{BLOCKS, RUBS, closing};
use sphorge_deck::decks;
use sphorge_engine::persist::MemoryArchive;
use sphorge_engine::{Cpu, EngineKind, FieldSource, Simulation};

/// A copper strip whose ends are pulled apart.
pub(super) const PULLED: &str = include_str!("../../../sphorge/tests/physics/pulled_strip.toml");

pub(super) fn shipped(name: &str) -> &'static str {
    decks::find(name).unwrap().text
}

/// Steps in which references are renewed, up to a time, s.
fn renewals(simulation: &mut Simulation, end: f64) -> Vec<u32> {
    let mut steps = Vec::new();
    let mut step = 0;
    while simulation.time() < end {
        let report = simulation.step(Some(end)).unwrap();
        step += 1;
        if step > 1 && report.searched_fraction > 0.0 {
            steps.push(step);
        }
    }
    steps
}

/// Runs of both engines to a time, s, through so many renewals at least, in the same steps; how near energies and fields must be.
pub(super) fn compare(text: &str, overrides: &[(&str, &str)], end: f64, least: usize, (near, of_fields): (f64, f64)) {
    let [theirs, ours] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
        let mut simulation = start_text(kind, "apart", text, overrides);
        let start = simulation.ledger().unwrap();
        let steps = renewals(&mut simulation, end);
        (simulation, start, steps)
    });
    let ledgers = [&theirs.0, &ours.0].map(|simulation| simulation.ledger().unwrap());
    let [b, a] = &ledgers;
    let scale = b.total.energies.kinetic + b.total.energies.internal;
    let mut wrong = Vec::new();
    for (what, ours, theirs, scale) in [
        ("kinetic", a.total.energies.kinetic, b.total.energies.kinetic, scale),
        ("internal", a.total.energies.internal, b.total.energies.internal, scale),
        ("plastic work", a.total.energies.plastic_work, b.total.energies.plastic_work, scale),
        ("external work", a.external_work, b.external_work, scale),
        ("viscosity", a.viscous_energy, b.viscous_energy, b.viscous_energy.max(1e-2 * scale)),
        ("springs", a.hourglass_energy, b.hourglass_energy, b.hourglass_energy.max(1e-2 * scale)),
    ] {
        if (ours - theirs).abs() > near * scale {
            wrong.push(format!("{what}: {ours} on the card, {theirs}"));
        }
    }
    for field in [
        "position",
        "velocity",
        "density",
        "energy",
        "plastic_strain",
        "deformation",
        "earlier_deformation",
        "neighbors",
    ] {
        let [theirs, ours] = [&theirs.0, &ours.0].map(|simulation| components(&simulation.read(field).unwrap()));
        assert_eq!(theirs.len(), ours.len(), "{field}");
        let largest = theirs.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let off = theirs.iter().zip(&ours).fold(0.0f64, |a, (b, c)| a.max((b - c).abs())) / largest;
        if off > of_fields {
            wrong.push(format!("{field}: {off:e} of the largest"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    assert!(theirs.2.len() >= least, "{:?}", theirs.2);
    assert_eq!(ours.2, theirs.2);
    // Of what came in: the strip starts with little.
    let drift = drifts(&ours.0, &ours.1).0 * ours.1.total_energy() / scale;
    // Rounding of pair sums in single precision: of the strip below the processor loses 2.0e-8 in mixed precision, in which it grows
    // evenly with the steps, and 6e-16 in double.
    assert!(drift.abs() < 5e-8, "{drift:e}");
}

#[test]
fn a_strip_that_is_pulled_apart_matches_the_cpu() {
    let renewal = [("search.total-lagrangian.renewal", "1.3")];
    compare(PULLED, &renewal, 40e-6, 2, (3e-5, 3e-5));
    // A metre from the origin, where single precision alone knows places to 0.06 um.
    let far = PULLED.replace("\"0 mm\"", "\"1000 mm\"").replace("\"3 mm\"", "\"1003 mm\"");
    compare(&far, &renewal, 40e-6, 2, (3e-5, 3e-5));
}

#[test]
fn a_melt_separates_as_on_the_cpu() {
    let melted = [IRON.1[0], IRON.1[1], ("body.bar.temperature", "\"1900 K\"")];
    compare(shipped(IRON.0), &melted, 20e-6, 2, (1e-4, 3e-4));
}

#[test]
fn a_foot_whose_reference_is_renewed_matches_the_cpu() {
    let renewal = ("search.total-lagrangian.renewal", "1.1");
    compare(shipped(IRON.0), &[IRON.1[0], IRON.1[1], renewal], 8e-6, 1, (1e-4, 3e-4));
    let quarter = [("particles.spacing", "\"0.95 mm\""), renewal];
    compare(shipped("copper-bar"), &quarter, 10e-6, 1, (1e-4, 3e-4));
}

#[test]
fn debris_of_an_impact_matches_the_cpu() {
    let disc = [
        ("method", "\"total-lagrangian\""),
        ("search", "\"total-lagrangian\""),
        ("particles.spacing", "\"0.8 mm\""),
        ("contact", "{ penalty = { surfaces = \"overlap\" } }"),
    ];
    compare(shipped("penetration"), &disc, 2e-6, 2, (1e-4, 3e-4));
}

/// Half of a drop that splashes on a wall. It separates, and its particles pass the plane.
const SPLASH: &str = include_str!("../../../sphorge/tests/physics/splash.toml");

#[test]
fn particles_beyond_a_symmetry_plane_match_the_cpu() {
    // GPUs compute pairs in single precision. Later the last bit decides where a drop goes.
    let mixed = [("numerics.precision", "\"mixed\"")];
    compare(SPLASH, &mixed, 200e-6, 4, (1e-3, 1e-2));
}

/// A block of rubber thrown on a wall beside a plane of symmetry.
const RUBBER: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
time = { end = "2 ms" }
symmetry = [{ axis = "x" }]

[material.rubber]
density = "1100 kg/m^3"
young-modulus = "17 MPa"
poisson-ratio = 0.45
strength = "neo-hookean"

[[body]]
name = "block"
material = "rubber"
shape = { box = { min = ["0 mm", "0 mm"], max = ["8 mm", "20 mm"] } }
velocity = ["0 m/s", "-30 m/s"]

[[wall]]
name = "target"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { surfaces = "particles" } }
"#;

#[test]
fn rubber_has_the_stress_and_energy_of_the_processor() {
    compare(RUBBER, &[], 200e-6, 0, (1e-4, 3e-4));
    compare(RUBBER, &[("search.total-lagrangian.renewal", "1.1")], 200e-6, 1, (1e-4, 3e-4));
}

#[test]
fn separated_bodies_keep_the_energy_of_their_contact() {
    come_apart_and_keep(RUBS, 3e-4);
    // What facets held becomes heat of the particles that press, on processors of all that were near: fields differ.
    come_apart_and_keep(facet_contact::RUBS, f64::INFINITY);
}

fn come_apart_and_keep(contact: &str, of_fields: f64) {
    let text = closing(BLOCKS, &format!("{contact}\nsearch = {{ total-lagrangian = {{ renewal = 1.2 }} }}"));
    // A third part strikes when the first two have separated: no contact of the body with itself is left, as it is in the sums from the next renewal on.
    let third = ", { box = { min = [\"-3 mm\", \"-14 mm\"], max = [\"3 mm\", \"-9.2 mm\"] } }] }";
    let faster = "rows = [[\"-8 mm\", -3.0], [\"-7 mm\", -1.0], [\"-1 mm\"";
    let text = text.replace("] } }] }", &format!("] }} }}{third}")).replace("rows = [[\"-1 mm\"", faster);
    compare(&text, &[("time.courant", "0.3")], 20e-6, 1, (2e-4, of_fields));
}

#[test]
fn states_before_and_after_a_renewal_resume_to_the_same_bits() {
    let renewal = [IRON.1[0], IRON.1[1], ("search.total-lagrangian.renewal", "1.1")];
    // That of the processor in single precision is 1e-8 to 2e-8 here.
    repeats_and_conserves_to(5e-8, IRON.0, shipped(IRON.0), &renewal, 8e-6);
    // A state of before the first, as a step that is repeated takes it back.
    let mut simulation = start_text(&gpu(), IRON.0, shipped(IRON.0), &renewal);
    count_steps(&mut simulation, 0.5e-6);
    let mut archive = MemoryArchive::new();
    simulation.persist(&mut archive).unwrap();
    let mut runs = Vec::new();
    for _ in 0..2 {
        let steps = renewals(&mut simulation, 3e-6);
        let p = simulation.particles().unwrap();
        runs.push((steps, p.position, p.energy, p.earlier_deformation));
        simulation.persist(&mut archive.clone().to_load()).unwrap();
    }
    assert!(!runs[0].0.is_empty() && runs[0] == runs[1]);
}
