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

#[test]
fn scaled_mass_leaves_stiffness_strength_and_heat_per_volume_as_they_are() {
    let of = |material: &str, factor: &str| {
        let deck = format!(
            "dimensions = \"1d\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\n[material.m]\nbase = \"{material}\"\n\
             mass-scaling = {factor}\n[[body]]\nname = \"bar\"\nmaterial = \"m\"\nshape = {{ box = {{ min = [0], max = [\"40 mm\"] }} }}\n\
             velocity = [\"1 m/s\"]\n"
        );
        load_text("deck", &deck, &[]).unwrap_or_else(|report| panic!("{report}"))
    };
    // The sound speed is given, or follows from moduli.
    for material in ["ofhc-copper", "armco-iron", "4340-steel"] {
        let [one, nine] = ["1", "9"].map(|factor| of(material, factor));
        let [(before, notes), (after, told)] =
            [one, nine].map(|setup| (setup.model.materials[0].clone(), setup.all_notes()));
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert_eq!((before.mass_scaling, after.mass_scaling), (1.0, 9.0));
        assert!(near(after.density, 9.0 * before.density) && near(9.0 * after.specific_heat, before.specific_heat));
        assert!(near(after.shear_modulus, before.shear_modulus) && near(after.young_modulus(), before.young_modulus()));
        // The same pressure at the same compression and energy per volume.
        let pressure = |of: &sphorge_engine::model::Material| {
            of.equation_of_state.pressure(1.1 * of.density, 1e9 / of.density).pressure
        };
        assert!(near(pressure(&after), pressure(&before)), "{material}");
        let added = told.iter().filter(|note| !notes.contains(note)).collect::<Vec<_>>();
        assert!(
            added.len() == 1 && added[0].contains("adds 800 % to its mass") && added[0].contains("3.000 times as long"),
            "{told:?}"
        );
    }
    assert_eq!(of("ofhc-copper", "1.04").all_notes(), of("ofhc-copper", "1").all_notes());
}
