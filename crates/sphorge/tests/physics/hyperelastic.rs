//! Neo-Hookean bodies: stress from the whole deformation, and columns that twist and bend without losing energy.

use super::setup::simulation;
use sphorge::engine::{FieldSource, Simulation};
use sphorge_physics::SymmetricTensor;
use sphorge_physics::hyperelastic::{minus_identity, neo_hookean_deviator};
use sphorge_physics::tensor::multiply;
use std::f64::consts::PI;

/// The rubber column of Bonet, Gil, Lee, Aguirre & Ortigosa (2015), 1 x 1 x 6 m, which stands on the ground. It starts
/// without velocity.
const COLUMN: &str = r#"
dimensions = "3d"
particles = { spacing = "0.25 m" }
numerics = { precision = "double", viscosity = false }
time = { end = "1 s" }

[material.rubber]
density = "1100 kg/m^3"
young-modulus = "17 MPa"
poisson-ratio = 0.3
strength = "neo-hookean"

[[body]]
name = "column"
material = "rubber"
shape = { box = { min = ["-0.5 m", "-0.5 m", "0 m"], max = ["0.5 m", "0.5 m", "6 m"] } }

[[region]]
name = "base"
shape = { box = { min = ["-0.5 m", "-0.5 m", "0 m"], max = ["0.5 m", "0.5 m", "0.25 m"] } }

[[motion]]
region = "base"
velocity = ["0 m/s", "0 m/s", "0 m/s"]
"#;

/// A column with the velocity (m/s) of each place (m).
fn column(ratio: &str, velocity: impl Fn([f64; 3]) -> [f64; 3]) -> Simulation {
    let overrides = [("material.rubber.poisson-ratio".to_owned(), ratio.to_owned())];
    let mut setup =
        sphorge::deck::load_text("column", COLUMN, &overrides).unwrap_or_else(|report| panic!("{report:?}"));
    for i in 0..setup.particles.len() {
        setup.particles.velocity[i] = velocity(setup.particles.position[i]);
    }
    Simulation::new(setup.model, setup.particles)
}

/// Kinetic, elastic and spring energy, J.
fn energy(simulation: &Simulation) -> f64 {
    let ledger = simulation.ledger().unwrap();
    ledger.total.energies.kinetic + ledger.total.energies.elastic + ledger.hourglass_stored_energy
}

/// Goes on to an end, s; the least and the most of the energy on the way over the first.
fn follow(simulation: &mut Simulation, end: f64, mut see: impl FnMut(&Simulation)) -> (f64, f64) {
    let first = energy(simulation);
    let (mut least, mut most) = (1.0f64, 1.0f64);
    while simulation.time() < end {
        simulation.step(Some(end)).unwrap_or_else(|failure| panic!("{failure}"));
        let now = energy(simulation) / first;
        (least, most) = (least.min(now), most.max(now));
        see(simulation);
    }
    (least, most)
}

/// Angle by which the topmost layer has turned about z, rad.
fn twist(simulation: &Simulation, start: &[[f64; 3]]) -> f64 {
    let p = simulation.particles().unwrap();
    let (mut across, mut along) = (0.0, 0.0);
    for i in 0..p.len() {
        let (then, now) = (start[p.id[i] as usize], p.position[i]);
        if then[2] > 5.75 {
            across += then[0] * now[1] - then[1] * now[0];
            along += then[0] * now[0] + then[1] * now[1];
        }
    }
    across.atan2(along)
}

fn starts(simulation: &Simulation) -> Vec<[f64; 3]> {
    let p = simulation.particles().unwrap();
    let mut start = vec![[0.0; 3]; p.len()];
    (0..p.len()).for_each(|i| start[p.id[i] as usize] = p.position[i]);
    start
}

#[test]
fn a_twisted_column_turns_back_and_keeps_its_energy() {
    // The volume part of the elastic energy is `p^2/(2 K)`, which is exact for small changes of volume only.
    for (ratio, inexact) in [("0.3", 0.005), ("0.495", 0.001)] {
        let mut column = column(ratio, |x| {
            let rate = 105.0 * (PI * x[2] / 12.0).sin();
            [-rate * x[1], rate * x[0], 0.0]
        });
        let start = starts(&column);
        let (mut last, mut turns, mut farthest) = (0.0f64, 0.0f64, 0.0f64);
        let (least, most) = follow(&mut column, 0.25, |column| {
            // Angles beyond half a turn.
            let now = twist(column, &start);
            turns += (now - last + PI).rem_euclid(2.0 * PI) - PI;
            last = now;
            farthest = farthest.max(turns);
        });
        println!("{ratio}: farthest {farthest}, end {turns}, energy {least} to {most}");
        assert!(farthest > 1.5 * PI, "{ratio}: {farthest}");
        assert!(turns < 0.5 * farthest, "{ratio}: {turns} after {farthest}");
        assert!(least > 1.0 - inexact && most < 1.0 + inexact, "{ratio}: {least} to {most}");
    }
}

#[test]
fn a_bending_column_swings_back_and_keeps_its_energy() {
    let mut column = column("0.3", |x| [10.0 * x[2] / 6.0, 0.0, 0.0]);
    let start = starts(&column);
    let tip = |column: &Simulation| {
        let p = column.particles().unwrap();
        let top: Vec<usize> = (0..p.len()).filter(|&i| start[p.id[i] as usize][2] > 5.75).collect();
        [0, 2].map(|a| top.iter().map(|&i| p.position[i][a]).sum::<f64>() / top.len() as f64)
    };
    let (mut farthest, mut lowest) = (0.0f64, 6.0f64);
    let (least, most) = follow(&mut column, 1.5, |column| {
        let [x, z] = tip(column);
        (farthest, lowest) = (farthest.max(x), lowest.min(z));
    });
    println!("farthest {farthest}, lowest {lowest}, end {:?}, energy {least} to {most}", tip(&column));
    assert!(farthest > 2.0 && lowest < 5.0, "{farthest} {lowest}");
    assert!(least > 0.999 && most < 1.001, "{least} to {most}");
}

#[test]
fn the_stress_is_that_of_the_whole_deformation_through_a_renewal() {
    let renewed = [("search", "{ total-lagrangian = { renewal = 1.1 } }")];
    let rubber = COLUMN.replace("[[region]]", "[[unused]]");
    let deck = rubber[..rubber.find("[[unused]]").unwrap()].replace(
        "[[body]]",
        "[[body]]\nvelocity-gradient = { rows = [[\"150 1/s\", \"200 1/s\", \"0 1/s\"], [\"0 1/s\", \"-60 1/s\", \"0 1/s\"], \
         [\"0 1/s\", \"0 1/s\", \"-40 1/s\"]] }",
    );
    let mut simulation = simulation(&deck, &renewed);
    let mut searches = 0;
    while simulation.time() < 0.02 {
        searches += u32::from(simulation.step(Some(0.02)).unwrap().searched_fraction > 0.0);
    }
    let tensor = |field: &str, i: usize| {
        let column = simulation.read(field).unwrap();
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| column.component(i, 3 * a + b)))
    };
    let modulus = 17e6 / 2.6;
    let mut largest = 0.0f64;
    for i in 0..simulation.particles().unwrap().len() {
        let f = multiply(&tensor("deformation", i), &tensor("earlier_deformation", i));
        let expected = neo_hookean_deviator(&minus_identity(&f), modulus);
        let deviator = simulation.read("deviator").unwrap();
        let found = SymmetricTensor::from_array([0, 1, 2, 3, 4, 5].map(|k| deviator.component(i, k)));
        let off = found - expected;
        largest = largest.max(expected.double_dot(expected).sqrt());
        assert!(off.double_dot(off).sqrt() < 1e-9 * modulus, "{found:?} {expected:?}");
    }
    assert!(searches > 1 && largest > 0.3 * modulus, "{searches} searches, {largest:e}");
}
