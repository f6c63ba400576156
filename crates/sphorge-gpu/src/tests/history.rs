//! A flow law with a history of its own, and integrity, on a GPU, beside the processor's engine.

use super::card::gpu;
use super::engine::{IRON, components, drifts, start_text};
use sphorge_deck::{decks, load_text};
use sphorge_engine::persist::MemoryArchive;
use sphorge_engine::{Cpu, EngineKind, FieldSource, Simulation};
use sphorge_physics::flow::{FlowLaw, PressureAndDamage, YieldLaw};

/// The bar of iron of a law that softens with its damage: yield stress 300 MPa, hardening 500 MPa, friction 0.05, stiffening 2e-11/Pa, and the work
/// to failure per volume, J/m³.
fn start(kind: &dyn EngineKind, overrides: &[(&str, &str)], work: f64) -> Simulation {
    let deck = decks::find(IRON.0).unwrap();
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let mut setup = load_text(deck.name, deck.text, &overrides).unwrap();
    let law = PressureAndDamage::new(&[3e8, 5e8, 0.05, 2e-11, work]);
    setup.model.materials.iter_mut().for_each(|material| material.flow_law = FlowLaw::PressureAndDamage(law));
    kind.supports(&setup.model).unwrap();
    Simulation::start(kind, setup.model, setup.particles).unwrap()
}

fn run(simulation: &mut Simulation, end: f64) {
    while simulation.time() < end {
        simulation.step(Some(end)).unwrap();
    }
}

fn compare(overrides: &[(&str, &str)], end: f64, work: f64) {
    let [theirs, ours] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
        let mut simulation = start(kind, overrides, work);
        run(&mut simulation, end);
        simulation
    });
    for field in ["damage", "plastic_strain", "yield_stress", "position", "energy", "pressure"] {
        let [theirs, ours] = [&theirs, &ours].map(|simulation| components(&simulation.read(field).unwrap()));
        let largest = theirs.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let off = theirs.iter().zip(&ours).fold(0.0f64, |a, (b, c)| a.max((b - c).abs())) / largest;
        assert!(off < 1e-4, "{field}: {off:e} of {largest}");
        if field == "damage" {
            assert!(largest > 0.05, "nothing is damaged: {largest}");
        }
    }
}

#[test]
fn damage_grows_as_on_the_cpu() {
    compare(&IRON.1[..2], 5e-6, 1e9);
    let patino = [IRON.1[0], IRON.1[1], ("method", "\"patino\""), ("search", "\"every-step\"")];
    compare(&patino, 3e-6, 1e9);
    // Whole at the end of what it takes.
    compare(&IRON.1[..2], 3e-6, 2e7);
}

#[test]
fn damage_is_saved_and_guarded() {
    let new = || start(&gpu(), &IRON.1[..2], 1e9);
    let mut first = new();
    let start_of = first.ledger().unwrap();
    run(&mut first, 2e-6);
    let mut archive = MemoryArchive::new();
    first.persist(&mut archive).unwrap();
    let mut second = new();
    second.persist(&mut archive.to_load()).unwrap();
    for simulation in [&mut first, &mut second] {
        run(simulation, 4e-6);
    }
    let [first_damage, second_damage] = [&first, &second].map(|of| components(&of.read("damage").unwrap()));
    assert!(first_damage == second_damage && first_damage.iter().any(|damage| *damage > 0.01));
    assert!(drifts(&first, &start_of).0.abs() < 2e-8);
    // A negative work to failure would mend what is broken: below zero the law does not allow it.
    let mut mended = start(&gpu(), &IRON.1[..2], -1e9);
    let failure = (0..2000).find_map(|_| mended.step(None).err()).expect("damage below zero");
    assert_eq!((failure.field, failure.particle.is_some()), ("damage", true), "{failure}");
}

/// A block of iron that is pulled apart and sheared until it spalls.
const TORN: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
time = { end = "20 us" }

[material.iron]
base = "armco-iron"
spall-pressure = "0.4 GPa"

[[body]]
name = "block"
material = "iron"
shape = { box = { min = ["-6 mm", "-3 mm"], max = ["6 mm", "3 mm"] } }
velocity-profile = { along = "x", amplitude = ["100 m/s", "20 m/s"], rows = [["-6 mm", -1.0], ["-1 mm", -0.7], ["2 mm", 0.8], ["6 mm", 1.0]] }
"#;

#[test]
fn integrity_is_lost_as_on_the_cpu() {
    for overrides in [
        &[("method", "total-lagrangian"), ("numerics.temperature", "energy")][..],
        &[("method", "updated-lagrangian")],
        &[("method", "updated-lagrangian"), ("numerics.integrator", "predictor-corrector")],
    ] {
        let [theirs, ours] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
            let mut simulation = start_text(kind, "torn", TORN, overrides);
            run(&mut simulation, 3e-6);
            simulation
        });
        for field in
            ["integrity", "position", "velocity", "energy", "pressure", "deviator", "temperature", "yield_stress"]
        {
            let [theirs, ours] = [&theirs, &ours].map(|simulation| components(&simulation.read(field).unwrap()));
            let largest = theirs.iter().fold(0.0f64, |a, b| a.max(b.abs()));
            let off = theirs.iter().zip(&ours).fold(0.0f64, |a, (b, c)| a.max((b - c).abs())) / largest;
            assert!(off < 1e-3, "{overrides:?}: {field}: {off:e} of {largest}");
            if field == "integrity" {
                let least = theirs.iter().fold(1.0f64, |a, b| a.min(*b));
                assert!(least < 0.1 && largest == 1.0, "{least} to {largest}");
            }
        }
    }
}

/// The laws of damage, with what follows failure.
const BREAKS: [(&str, &[(&str, &str)]); 5] = [
    (
        "{ johnson-cook = { D1 = 0.01, D2 = 0.02, D3 = -1.5, D4 = 0.01, D5 = 0.6 } }",
        &[
            ("method", "total-lagrangian"),
            ("thermal.conduction", "true"),
            ("material.iron.conductivity", "0.1 MW/(m K)"),
        ],
    ),
    (
        "{ principal-stress = { strength = \"500 MPa\" } }",
        &[
            ("method", "total-lagrangian"),
            ("material.iron.strength", "elastic"),
            ("material.iron.softening-displacement", "30 um"),
        ],
    ),
    (
        "{ cockcroft-latham = { work = \"8 MPa\" } }",
        &[
            ("method", "total-lagrangian"),
            ("numerics.temperature", "energy"),
            ("material.iron.fracture-energy", "8 kJ/m^2"),
            ("material.iron.after-failure", "delete"),
        ],
    ),
    (
        "{ modified-mohr-coulomb = { A = \"8 GPa\", n = 0.4, c1 = 0.2, c2 = \"1 GPa\", c3 = 0.9 } }",
        &[("method", "updated-lagrangian"), ("material.iron.after-failure", "fluid")],
    ),
    (
        "{ principal-stress = { strength = \"400 MPa\" } }",
        &[
            ("method", "updated-lagrangian"),
            ("numerics.integrator", "predictor-corrector"),
            ("material.iron.softening-displacement", "30 um"),
            ("thermal.conduction", "true"),
            ("material.iron.conductivity", "0.1 MW/(m K)"),
        ],
    ),
];

#[test]
fn damage_grows_and_metal_breaks_as_on_the_cpu() {
    for (law, more) in BREAKS {
        let overrides = [&[("material.iron.damage", law), ("material.iron.spall-pressure", "50 GPa")], more].concat();
        let [theirs, ours] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
            let mut simulation = start_text(kind, "torn", TORN, &overrides);
            run(&mut simulation, 4e-6);
            simulation
        });
        let [all, of_card] = [&theirs, &ours].map(|simulation| simulation.ledger().unwrap().fracture_energy);
        assert!(all > 0.0 && (of_card / all - 1.0).abs() < 2e-3, "{law}: {of_card:e} {all:e}");
        for field in [
            "damage",
            "integrity",
            "fracture_energy",
            "failed_at",
            "position",
            "velocity",
            "pressure",
            "deviator",
            "temperature",
        ] {
            let [theirs, ours] = [&theirs, &ours].map(|simulation| components(&simulation.read(field).unwrap()));
            let largest = theirs.iter().fold(0.0f64, |a, b| a.max(b.abs()));
            let off = theirs.iter().zip(&ours).fold(0.0f64, |a, (b, c)| a.max((b - c).abs())) / largest;
            println!("{law}: {field} {off:e} of {largest}");
            assert!(off < 2e-3, "{law}: {field}: {off:e} of {largest}");
            if field == "integrity" {
                let some = |of: &dyn Fn(f64) -> bool| theirs.iter().any(|w| of(*w));
                assert!(some(&|w| w == 0.0) && some(&|w| w > 0.0 && w < 1.0), "{law}: {theirs:?}");
            }
        }
    }
}
