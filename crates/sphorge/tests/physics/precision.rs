//! Pair sums in single precision, where what happens is small beside the body, and the body beside the model.

use super::setup::{run_steps, simulation};
use sphorge::engine::Simulation;

/// An elastic block that is left to itself or rests on a slope. Its steps are those of bodies that may meet, alone or not.
const BLOCK: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
time = { end = "8 ms", courant = 0.3 }

[material.steel]
density = "7850 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
strength = "elastic"

[[body]]
name = "block"
material = "steel"
shape = { box = { min = ["0 mm", "0 mm"], max = ["12 mm", "6 mm"] } }
"#;

const SLOPE: &str = r#"
[[wall]]
name = "slope"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { friction = 0.3 } }
"#;

/// Ten metres away.
const OTHER: &str = r#"
[[body]]
name = "other"
material = "steel"
shape = { box = { min = ["10 m", "0 m"], max = ["10.012 m", "0.006 m"] } }
"#;

/// How far velocity and deviator of the first body of two runs are from each other, as root mean squares over those of the
/// second run.
fn apart(ours: &Simulation, theirs: &Simulation) -> [f64; 2] {
    let states = [ours, theirs].map(|simulation| {
        let p = simulation.particles().unwrap();
        let mut states: Vec<_> = (0..p.len())
            .filter(|&i| p.body[i] == 0)
            .map(|i| (p.id[i], p.velocity[i], p.deviator[i].to_array()))
            .collect();
        states.sort_by_key(|state| state.0);
        states
    });
    let [ours, theirs] = states;
    assert_eq!(ours.len(), theirs.len());
    let (mut off, mut scale) = ([0.0; 2], [0.0; 2]);
    for ((_, v, s), (_, w, t)) in ours.iter().zip(&theirs) {
        for (k, (a, b)) in [(&v[..], &w[..]), (&s[..], &t[..])].into_iter().enumerate() {
            off[k] += a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            scale[k] += b.iter().map(|b| b * b).sum::<f64>();
        }
    }
    [0, 1].map(|k| (off[k] / scale[k]).sqrt())
}

fn in_precision(deck: &str, precision: &str, changes: &[(&str, &str)], steps: u64) -> Simulation {
    let mut simulation = simulation(deck, &[changes, &[("numerics.precision", precision)]].concat());
    run_steps(&mut simulation, steps);
    simulation
}

#[test]
fn a_block_on_a_slope_is_that_of_double_precision() {
    // What rounding stirs up are short waves, and where they are the block rings less: with viscosity on all waves both ring alike.
    let damped = [("numerics.viscosity.all-waves", "true")];
    let deck = format!("gravity = [\"4.905 m/s^2\", \"-8.495709 m/s^2\"]\n{BLOCK}{SLOPE}");
    for (changes, steps) in [(&damped[..], 1500), (&[], 300)] {
        let [single, double] = ["mixed", "double"].map(|precision| in_precision(&deck, precision, changes, steps));
        let off = apart(&single, &double);
        println!("{off:?}");
        assert!(off.iter().all(|off| *off < 0.01), "{steps}: {off:?}");
    }
}

#[test]
fn a_block_does_not_know_how_far_away_another_one_is() {
    let shaken = [
        (
            "body.block.velocity-gradient",
            r#"{ rows = [["0.02 /s", "0 /s"], ["0 /s", "0 /s"]], centre = ["6 mm", "3 mm"] }"#,
        ),
        ("numerics.viscosity", "false"),
    ];
    let double = in_precision(BLOCK, "double", &shaken, 400);
    for deck in [BLOCK.to_owned(), format!("{BLOCK}{OTHER}")] {
        let off = apart(&in_precision(&deck, "mixed", &shaken, 400), &double);
        println!("{off:?}");
        assert!(off.iter().all(|off| *off < 0.01), "{off:?}");
    }
}

#[test]
fn what_rests_far_from_the_origin_and_from_everything_stays_at_rest() {
    let there = ("body.block.shape", r#"{ box = { min = ["7 m", "-3 m"], max = ["7.012 m", "-2.994 m"] } }"#);
    let far = in_precision(&format!("{BLOCK}{OTHER}"), "mixed", &[there], 1000);
    let p = far.particles().unwrap();
    let fastest = p.velocity.iter().flatten().fold(0.0f64, |fastest, v| fastest.max(v.abs()));
    let most = p.deviator.iter().fold(0.0f64, |most, s| most.max(s.von_mises()));
    assert_eq!((fastest, most), (0.0, 0.0));
}

#[test]
fn a_block_in_flight_is_stressed_as_one_that_stays() {
    // After a fifth of a millimetre, of which single precision rounds off a third of what the shaking moves neighbours apart.
    let shaken = r#"{ rows = [["0.02 /s", "0 /s"], ["0 /s", "0 /s"]], centre = ["6 mm", "3 mm"] }"#;
    let changes = [
        ("body.block.velocity-gradient", shaken),
        ("body.block.velocity", r#"["10 m/s", "0 m/s"]"#),
        ("numerics.viscosity", "false"),
    ];
    let [single, double] = ["mixed", "double"].map(|precision| in_precision(BLOCK, precision, &changes, 400));
    let [_, stress] = apart(&single, &double);
    println!("{stress}");
    assert!(stress < 0.02, "{stress}");
}
