//! Renewal of the reference configuration of the total Lagrangian form.

use super::external_forces::STRUCK_WALL;
use super::setup::{by_id, run_to, simulation};
use sphorge::engine::{Column, FieldSource, Simulation};
use sphorge_physics::tensor::multiply;

/// A sheet on a wall, so soft and so fast that no force moves it, in a motion that is linear in space: it is flattened and sheared, and what touches the wall stands
/// still. Its reference is renewed at a stretch of 1.2, which it has at 25 ns.
const FLATTENED: &str = r#"
dimensions = "plane-strain"
search = { total-lagrangian = { renewal = 1.2 } }
particles = { spacing = "1 mm" }
numerics = { precision = "double", viscosity = false }
time = { end = "30 ns", fixed-step = "0.1 ns" }

[periodic]
x = ["-10 mm", "10 mm"]

[material.soft]
density = "8000 kg/m^3"
young-modulus = "20 MPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "sheet"
material = "soft"
shape = { box = { min = ["-10 mm", "0 mm"], max = ["10 mm", "8 mm"] } }
velocity-gradient = { rows = [["0 1/s", "20e6 1/s"], ["0 1/s", "-10e6 1/s"]] }

[[wall]]
name = "table"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { surfaces = "particles", stiffness = 1.0, friction = 0.3, damping = 0.02 } }
"#;

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

/// Faces stay on the wall while the sheet is flattened to seven tenths, before and after the renewal: nothing pushes it. Where they are pressed in by a tenth of a spacing
/// they are pushed by that and stand still: nothing is rubbed and nothing damped, though the centres of the particles slide along the wall and approach it.
#[test]
fn a_wall_meets_the_faces_of_what_is_flattened_and_renewed() {
    // Twenty particles at `k = c^2/spacing^2` times a tenth of a millimetre for 30 ns, of which centres half a millimetre above the wall slide at 10 km/s and approach at 5.
    let (mass, k, end) = (20.0 * 8e-3, 20e6 / 1.2 / 8000.0 / 1e-6, 30e-9);
    let impulse = mass * k * 1e-4 * end;
    let rubbed_at_centres = 0.3 * impulse * 10e3;
    let damped_at_centres = mass * 2.0 * 0.02 * f64::sqrt(k) * 5e3 * 5e3 * end;
    for (pressed, expected) in [("0 mm", 0.0), ("0.1 mm", impulse)] {
        let plane = format!("[\"0 mm\", \"{pressed}\"]");
        let mut simulation = simulation(FLATTENED, &[("wall.table.plane.point", &plane)]);
        let mut searches = 0;
        while simulation.time() < end {
            searches += u32::from(simulation.step(Some(end)).unwrap().searched_fraction > 0.0);
        }
        assert_eq!(searches, 1, "renewed");
        let ledger = simulation.ledger().unwrap();
        let (wall, found) = (&ledger.walls[0], ledger.external_impulse[1]);
        assert!((found - expected).abs() < 0.05 * impulse, "{pressed}: {found} by hand {expected}");
        assert!(wall.friction_work < 0.01 * rubbed_at_centres, "{pressed}: {wall:?}, at centres {rubbed_at_centres}");
        assert!(wall.damping_work < 0.01 * damped_at_centres, "{pressed}: {wall:?}, at centres {damped_at_centres}");
    }
}

/// A block without strength worth the name that is turned and flattened: `x = (1 + A t) X`.
const TURNED: &str = r#"
dimensions = "plane-strain"
search = { total-lagrangian = { renewal = 1.2 } }
particles = { spacing = "1 mm" }
numerics = { precision = "double", viscosity = false }
time = { end = "250 ns", fixed-step = "0.5 ns" }

[material.dust]
density = "8000 kg/m^3"
young-modulus = "1 Pa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "block"
material = "dust"
shape = { box = { min = ["-4 mm", "-4 mm"], max = ["4 mm", "4 mm"] } }
velocity-gradient = { rows = [["1.2e6 1/s", "2e6 1/s"], ["-2e6 1/s", "-3.6e6 1/s"]] }
"#;

/// A reference taken at the end of a step would lack its motion: 8e-4 of the deformation with two renewals.
#[test]
fn deformation_since_the_start_is_that_of_the_motion_through_all_renewals() {
    let mut simulation = simulation(TURNED, &[]);
    let start = simulation.particles().unwrap().position.clone();
    // At edges of what has come apart gradients are not corrected.
    let inside: Vec<usize> = by_id(simulation.particles().unwrap())
        .into_iter()
        .enumerate()
        .filter(|(_, i)| start[*i].iter().all(|x| x.abs() < 2e-3))
        .map(|(id, _)| id)
        .collect();
    let mut searches = 0;
    while simulation.time() < 250e-9 {
        searches += u32::from(simulation.step(Some(250e-9)).unwrap().searched_fraction > 0.0);
    }
    let [since, earlier] = ["deformation", "earlier_deformation"].map(|field| match simulation.read(field).unwrap() {
        Column::Tensor(tensors) => tensors.into_owned(),
        other => panic!("{field}: {other:?}"),
    });
    let grown = [[1.3, 0.5, 0.0], [-0.5, 0.1, 0.0], [0.0, 0.0, 1.0]];
    let off = inside.iter().flat_map(|id| {
        let whole = multiply(&since[*id], &earlier[*id]);
        (0..9).map(move |k| (whole[k / 3][k % 3] - grown[k / 3][k % 3]).abs())
    });
    let off = off.fold(0.0, f64::max);
    assert!(searches >= 2 && inside.len() == 16 && off < 1e-10, "{searches} renewals, {off:e}");
    // The misfit of springs is that of rounding.
    let ledger = simulation.ledger().unwrap();
    let size = ledger.total.mass / 8000.0;
    assert!(ledger.hourglass_stored_energy < 1e-20 * size, "{:e}", ledger.hourglass_stored_energy / size);
}
