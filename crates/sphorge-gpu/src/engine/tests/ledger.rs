//! The ledger of the GPU beside that of columns read back.

use super::{Deck, engine, shipped, steps};
use crate::Gpu;
use crate::device::Profile;
use crate::engine::GpuEngine;
use crate::tests::card::gpu;
use crate::tests::contact::{RUBS, striking};
use crate::tests::engine::IRON;
use crate::tests::facet_contact;
use crate::tests::motion::driven;
use sphorge_engine::{BodyLedger, Ledger};

/// How near sums of pairs of numbers are to those of double precision: 48 bits, and a rounding for each particle of a lane and each lane.
const NEAR: f64 = 1e-13;

/// Numbers with what they are parts of.
fn numbers(engine: &GpuEngine, ledger: &Ledger) -> Vec<(String, f64, f64)> {
    let p = engine.snapshot().unwrap();
    let pushed: f64 = (0..p.len()).map(|i| p.mass[i] * p.acceleration[i].map(f64::abs).iter().sum::<f64>()).sum();
    let driven: f64 = ledger.motion_forces.as_flattened().iter().map(|f| f.abs()).sum();
    let far = p.position.as_flattened().iter().fold(0.0f64, |a, x| a.max(x.abs()));
    let energy = ledger.total.energies.kinetic + ledger.total.energies.internal.abs();
    let moved = ledger.total.momentum_scale;
    let mut numbers = Vec::new();
    let mut add = |what: String, number: f64, scale: f64| numbers.push((what, number, scale));
    for (k, body) in ledger.bodies.iter().chain([&ledger.total]).enumerate() {
        let BodyLedger { mass, energies: e, momentum, angular_momentum, momentum_scale, centre, force } = *body;
        let scalars = [
            ("mass", mass, mass),
            ("kinetic", e.kinetic, e.kinetic),
            ("internal", e.internal, energy),
            ("elastic", e.elastic, e.elastic),
            ("plastic work", e.plastic_work, e.plastic_work),
            ("speed", momentum_scale, momentum_scale),
        ];
        for (what, number, scale) in scalars {
            add(format!("{what} of {k}"), number, scale);
        }
        for a in 0..3 {
            add(format!("momentum {a} of {k}"), momentum[a], moved);
            add(format!("angular momentum {a} of {k}"), angular_momentum[a], far * moved);
            add(format!("centre {a} of {k}"), centre[a], far);
            add(format!("force {a} of {k}"), force[a], pushed + driven);
        }
    }
    let accounts = [
        ledger.external_work,
        ledger.integration_energy,
        ledger.viscous_energy,
        ledger.artificial_stress_energy,
        ledger.hourglass_energy,
        ledger.hourglass_stored_energy,
        ledger.mls_energy,
    ];
    for (k, account) in accounts.into_iter().enumerate() {
        add(format!("account {k}"), account, energy);
    }
    for a in 0..3 {
        add(format!("impulse {a}"), ledger.external_impulse[a], moved);
    }
    for (k, (wall, force)) in ledger.walls.iter().zip(&ledger.wall_forces).enumerate() {
        for (what, work) in [("work", wall.work), ("friction", wall.friction_work), ("damping", wall.damping_work)] {
            add(format!("{what} of wall {k}"), work, energy);
        }
        let size = force.iter().map(|f| f.abs()).sum::<f64>();
        for a in 0..3 {
            add(format!("force {a} of wall {k}"), force[a], size);
        }
    }
    for (k, contact) in ledger.contacts.iter().enumerate() {
        for (what, work) in [
            ("held", contact.stored_energy),
            ("friction", contact.friction_work),
            ("damping", contact.damping_work),
            ("rest", contact.integration_energy),
        ] {
            add(format!("{what} by contact {k}"), work, energy);
        }
        for a in 0..3 {
            add(format!("force {a} of contact {k}"), contact.force[a], pushed);
        }
    }
    for (k, force) in ledger.motion_forces.iter().enumerate() {
        for a in 0..3 {
            add(format!("reaction {a} of motion {k}"), force[a], pushed + driven);
        }
    }
    add("heat exchanged".to_owned(), ledger.heat.exchanged, ledger.heat.exchanged);
    for (k, supplied) in ledger.heat.supplied.iter().enumerate() {
        add(format!("heat of boundary {k}"), *supplied, ledger.heat.exchanged.max(supplied.abs()));
    }
    numbers
}

/// Holds the ledger of the GPU against that of columns at the start, after some steps, and after a shorter one; everything that is named must be there.
fn compare(deck: Deck<'_>, count: usize, named: &[&str]) -> GpuEngine {
    let profile = Profile::default();
    let mut engine = engine(&Gpu { profile: Some(profile.clone()), ..gpu() }, deck);
    for shares in [&[][..], &vec![1.0; count], &[0.3]] {
        steps(&mut engine, shares);
        let before = profile.bytes_read();
        let found = engine.conservation().unwrap();
        let bytes = profile.bytes_read() - before;
        assert_eq!(engine.conservation().unwrap(), found);
        let expected = engine.ledger_read().unwrap();
        assert!(bytes < (profile.bytes_read() - before) / 20, "{bytes} bytes are read back");
        let (ours, theirs) = (numbers(&engine, &found), numbers(&engine, &expected));
        assert_eq!(ours.len(), theirs.len());
        for ((what, ours, scale), (_, theirs, _)) in ours.iter().zip(&theirs) {
            let off = (ours - theirs).abs();
            assert!(off <= NEAR * scale, "{what}: {ours} on the card, {theirs}; {off:e} of {scale}");
        }
        if count > 0 && shares.len() == 1 {
            for name in named {
                let is_there = |of: &(String, f64, f64)| of.0.starts_with(name) && of.1 != 0.0;
                assert!(theirs.iter().any(is_there), "there is no `{name}`");
            }
        }
    }
    engine
}

#[test]
fn ledger_with_walls_matches_columns_read_back() {
    let fine = ("particles.spacing", "\"0.2 mm\"");
    let rubs = ("wall.0.contact", "{ penalty = { friction = 0.2, damping = 0.3 } }");
    let moves = ("wall.0.velocity", "[\"0 m/s\", [[\"0 us\", \"0 m/s\"], [\"4 us\", \"60 m/s\"]]]");
    let named = ["force 1 of wall", "friction of wall", "damping of wall", "work of wall", "plastic", "elastic"];
    compare((shipped("taylor-plate"), &[fine, rubs, moves]), 20, &named);
    let leapfrog = ("numerics.integrator", "\"leapfrog\"");
    let monaghan = ("wall.0.contact", "\"monaghan-kos\"");
    compare((shipped("taylor-plate"), &[fine, leapfrog, monaghan]), 20, &["force 1 of wall", "impulse 1"]);
}

#[test]
fn ledger_in_the_reference_configuration_matches_columns_read_back() {
    let rubs = ("wall.0.contact", "{ penalty = { friction = 0.2, surfaces = \"particles\" } }");
    let renews = ("search.total-lagrangian.renewal", "1.1");
    let (fine, falls) = (("particles.spacing", "\"0.3 mm\""), ("gravity", "[\"2e6 m/s^2\", \"0 m/s^2\"]"));
    compare((shipped("iron-plate"), &[fine, rubs]), 25, &["force 0 of wall", "account 4", "account 2"]);
    let short = ("time.courant", "0.3");
    let renewed = compare(
        (shipped("iron-plate"), &[IRON.1[0], rubs, renews, falls, short]),
        40,
        &["force 1 of wall", "impulse 0"],
    );
    assert!(renewed.is_renewed());
    compare((shipped("copper-bar"), &[("particles.spacing", "\"0.95 mm\"")]), 10, &["centre 2"]);
}

#[test]
fn ledger_of_bodies_in_contact_matches_columns_read_back() {
    let held = ["held by contact", "friction by contact", "damping by contact", "force 1 of contact"];
    // A twentieth of a millimetre apart.
    let near = ("body.upper.shape", "{ box = { min = [\"-3 mm\", \"0.65 mm\"], max = [\"5 mm\", \"5 mm\"] } }");
    compare((&striking(RUBS), &[near]), 30, &held);
    let with_rest = [&held[..], &["rest by contact"]].concat();
    compare((&striking(facet_contact::RUBS), &[near]), 30, &with_rest);
    let present = format!("method = \"patino\"\nsearch = \"every-step\"\n{RUBS}");
    compare((&striking(&present), &[near]), 30, &held);
    compare(
        (shipped("penetration"), &[("particles.spacing", "\"0.8 mm\""), ("time.courant", "0.1")]),
        20,
        &["plastic work of 1"],
    );
}

#[test]
fn ledger_of_prescribed_motion_matches_columns_read_back() {
    let named = ["reaction 1 of motion 0", "reaction 1 of motion 1", "reaction 0 of motion 2", "force 1 of 0"];
    compare((&driven(""), &[("particles.spacing", "\"0.25 mm\"")]), 20, &named);
}

#[test]
fn ledger_of_heat_conduction_matches_columns_read_back() {
    let heat = ["heat exchanged", "heat of boundary 0"];
    compare((shipped("convecting-block"), &[("particles.spacing", "\"2 mm\"")]), 10, &heat);
}
