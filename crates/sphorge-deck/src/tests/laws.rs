//! Laws of a deck's material, as far as the engine.

use super::*;
use sphorge_engine::Simulation;

/// A bar of copper in one dimension: K = 140 GPa, linear pressure, G = 47.7 GPa at 300 K.
const COPPER: &str = r#"
dimensions = "1d"
search = "every-step"
numerics = { gradient-correction = "linear" }
particles = { spacing = "1 mm" }
time = { end = "1 us" }

[material.copper]
base = "copper-steinberg"
bulk-modulus = "140 GPa"
equation-of-state = "linear"

[[body]]
name = "bar"
material = "copper"
shape = { box = { min = ["0 mm"], max = ["40 mm"] } }
temperature = "300 K"
"#;

fn simulation(deck: &str) -> Simulation {
    let setup = load_text("deck", deck, &[]).unwrap_or_else(|report| panic!("{report}"));
    Simulation::new(setup.model, setup.particles)
}

/// The deck at another temperature.
fn at(temperature: &str) -> String {
    COPPER.replace("\"300 K\"\n", &format!("\"{temperature}\"\n"))
}

#[test]
fn the_time_step_follows_the_shear_modulus_of_the_state() {
    let step = |deck: &str| simulation(deck).next_step_estimate().unwrap().0;
    // c_l^2 = (140 + 4/3 47.7) GPa/8930 = 22.79955e6; at 1500 K G is 1 - 3.77e-4 1200 = 0.5476 of it: 19.57753e6.
    let ratio = step(&at("1500 K")) / step(COPPER);
    assert!((ratio / 1.079_156 - 1.0).abs() < 1e-5, "{ratio}");
    // Molten at 1790 K: 15.67749e6.
    let ratio = step(&at("1800 K")) / step(COPPER);
    assert!((ratio / 1.205_938 - 1.0).abs() < 1e-5, "{ratio}");
}

#[test]
fn stress_follows_the_shear_modulus_of_the_state() {
    // Stretched by 1e3/s for 1 ns: S_xx = 4/3 G 1e-6, far below yield; the pressure of 0.14 MPa changes G by 4e-6.
    let stress = |temperature: &str| {
        let deck = at(temperature) + "velocity-gradient = { rows = [[1000]] }\n";
        let mut simulation = simulation(&deck);
        simulation.step(Some(1e-9)).unwrap();
        assert_eq!(simulation.time(), 1e-9);
        let particles = simulation.particles().unwrap();
        particles.deviator[20].xx
    };
    let cold = stress("300 K");
    assert!((cold / (4.0 / 3.0 * 47.7e9 * 1e-6) - 1.0).abs() < 1e-4, "{cold}");
    let ratio = stress("1500 K") / cold;
    assert!((ratio / 0.5476 - 1.0).abs() < 1e-4, "{ratio}");
    assert_eq!(stress("1800 K"), 0.0);
}

#[test]
fn constants_of_the_new_laws_are_read_with_their_units_and_checked() {
    let law = |strength: &str| {
        let deck = COPPER.replace("[[body]]", &format!("[material.copper.strength]\n{strength}\n[[body]]"));
        load_text("deck", &deck, &[]).map(|setup| setup.model.materials[0].clone())
    };
    let copper =
        law("zerilli-armstrong-fcc = { C0 = \"65 MPa\", C2 = \"890 MPa\", C3 = \"2.8e-3 /K\", C4 = 1.15e-4 }").unwrap();
    let y = copper.flow_law.yield_stress(copper.flow_state(0.25, 300.0, copper.density, 0.0), &[]).value;
    // No rate counts as 1e-3/s: -0.0028 300 - 0.000115 300 6.907755 = -1.078318, exp = 0.340167; 65 + 890 0.5 0.340167.
    assert!((y / 216.3745e6 - 1.0).abs() < 1e-5, "{y}");
    let told = law("zerilli-armstrong-bcc = { C0 = 1, C1 = 1, C3 = 0, C4 = 0, C5 = 0 }").unwrap_err().to_string();
    assert!(told.contains("has no `n`, which `zerilli-armstrong-bcc` needs"), "{told}");
    let told = law("steinberg-guinan = { largest-yield-stress = \"0.1 GPa\" }").unwrap_err().to_string();
    assert!(told.contains("largest-yield-stress must not be below yield-stress"), "{told}");
    let told = law("steinberg-guinan = { A = \"2.83 Mbar\" }").unwrap_err().to_string();
    assert!(told.contains("expected a quantity (1/Pa)"), "{told}");
}
