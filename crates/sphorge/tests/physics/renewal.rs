//! Renewal of the reference configuration of the total Lagrangian form.

use super::external_forces::STRUCK_WALL;
use super::setup::{by_id, run_to, simulation};
use sphorge::engine::Simulation;

/// A copper strip whose ends are pulled apart at 100 m/s each.
const PULLED: &str = include_str!("pulled_strip.toml");

fn with(deck: &str, renewal: &str) -> Simulation {
    let search = format!("{{ total-lagrangian = {{ renewal = {renewal} }} }}");
    simulation(deck, &[("numerics.precision", "double"), ("search", &search)])
}

/// Height, width of the lowest row, mean plastic strain, force impulse of the wall over the momentum that came in.
fn shape(simulation: &Simulation) -> [f64; 4] {
    let particles = simulation.particles().unwrap();
    let order = by_id(simulation.particles().unwrap());
    let row: Vec<f64> = order[..12].iter().map(|&i| particles.position[i][0]).collect();
    let widest = |sign: f64| row.iter().map(|x| sign * x).fold(f64::NEG_INFINITY, f64::max);
    let height = particles.position.iter().map(|x| x[1]).fold(0.0, f64::max);
    let strain = particles.plastic_strain.iter().sum::<f64>() / particles.len() as f64;
    let ledger = simulation.ledger().unwrap();
    [height, widest(1.0) + widest(-1.0), strain, ledger.external_impulse[1] / (200.0 * ledger.total.mass)]
}

#[test]
fn a_renewed_foot_is_pressed_as_one_that_is_not_and_loses_nothing() {
    let run = |renewal: &str| {
        let mut simulation = with(STRUCK_WALL, renewal);
        let supplied = simulation.ledger().unwrap().total.energies.kinetic;
        run_to(&mut simulation, 16e-6);
        let ledger = simulation.ledger().unwrap();
        let total = ledger.total.energies.kinetic + ledger.total.energies.internal;
        assert!((total - ledger.external_work - supplied).abs() < 1e-9 * supplied, "{renewal}");
        assert!((ledger.walls[0].work / supplied).abs() < 0.01, "{renewal}: {}", ledger.walls[0].work / supplied);
        assert!(ledger.total.momentum[0].abs() < 1e-9 * ledger.total.mass * 200.0, "{renewal}");
        shape(&simulation)
    };
    let (kept, renewed) = (run("0"), run("1.2"));
    println!("{kept:?} {renewed:?}");
    assert_ne!(kept, renewed);
    for (kept, renewed) in kept.iter().zip(renewed) {
        assert!((renewed / kept - 1.0).abs() < 0.03, "{kept} {renewed}");
    }
}

#[test]
fn a_strip_comes_apart_where_its_reference_is_renewed_and_does_not_without() {
    // Mean force on the right end from 60 to 100 us, N/m: pieces that ring pull and push.
    let force = |renewal: &str| {
        let mut simulation = with(PULLED, renewal);
        run_to(&mut simulation, 60e-6);
        let mut impulse = 0.0;
        while simulation.time() < 100e-6 {
            let before = simulation.time();
            simulation.step(Some(100e-6)).unwrap();
            impulse += simulation.ledger().unwrap().motion_forces[1][0] * (simulation.time() - before);
        }
        impulse / 40e-6
    };
    let (kept, renewed) = (force("0"), force("4"));
    println!("kept {kept}, renewed {renewed}");
    assert!(kept > 3e5 && renewed.abs() < 0.1 * kept, "kept {kept}, renewed {renewed}");
}

#[test]
fn a_liquid_comes_apart_at_a_stretch_a_solid_bears() {
    // Sheared too fast for stress to matter: by 4.6 at 11.5 us, a principal stretch of 4.8.
    let is_renewed = |changes: &[(&str, &str)]| {
        let rates = ("body.strip.velocity-gradient.rows", r#"[["0 1/s", "400000 1/s"], ["0 1/s", "0 1/s"]]"#);
        let quiet = [("numerics.precision", "double"), ("numerics.viscosity", "false")];
        let free = [("motion", "[]"), ("region", "[]"), quiet[0], quiet[1], rates];
        let mut simulation = simulation(PULLED, &free.iter().chain(changes).copied().collect::<Vec<_>>());
        // The lists of the start are made anew where the reference is.
        let mut searches = 0;
        while simulation.time() < 11.5e-6 {
            searches += u32::from(simulation.step(Some(11.5e-6)).unwrap().searched_fraction > 0.0);
        }
        searches > 0
    };
    let hot = ("body.strip.temperature", "1400 K");
    let fluid = ("material.ofhc-copper.strength", "none");
    assert!(!is_renewed(&[]), "a solid");
    assert!(is_renewed(&[hot]), "a melt");
    assert!(is_renewed(&[fluid]), "a fluid");
    assert!(!is_renewed(&[hot, ("search", "{ total-lagrangian = { renewal = 0 } }")]), "never");
}

/// Half of a drop that splashes on a wall. It comes apart, and its particles pass the plane.
const SPLASH: &str = include_str!("splash.toml");

#[test]
fn what_comes_apart_beside_a_symmetry_plane_keeps_energy_and_momentum() {
    let mut simulation = simulation(SPLASH, &[]);
    let start = simulation.ledger().unwrap();
    let supplied = start.total.energies.kinetic;
    let (mut deepest, mut searches, mut energy, mut momentum) = (0.0f64, 0, 0.0f64, 0.0f64);
    while simulation.time() < 300e-6 {
        searches += u32::from(simulation.step(Some(300e-6)).unwrap().searched_fraction > 0.0);
        let now = simulation.ledger().unwrap();
        let total = now.total.energies.kinetic + now.total.energies.internal - now.external_work;
        energy = energy.max((total / supplied - 1.0).abs());
        let change = now.total.momentum[1] - start.total.momentum[1] - now.external_impulse[1];
        momentum = momentum.max(change.abs() / start.total.momentum_scale);
        deepest = simulation.particles().unwrap().position.iter().fold(deepest, |deepest, x| deepest.max(-x[0]));
    }
    println!("deepest {deepest:.1e}, {searches} searches, energy {energy:.1e}, momentum {momentum:.1e}");
    assert!(searches > 5 && deepest > 1e-4, "{searches} searches, {deepest:.1e} m behind the plane");
    assert!(energy < 1e-10 && momentum < 1e-12, "energy {energy:.1e}, momentum {momentum:.1e}");
}
