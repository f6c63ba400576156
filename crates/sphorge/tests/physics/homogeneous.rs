//! Bodies that are compressed so fast that no force moves them: the deformation of every particle is known, and with it what it does by hand.

use super::setup::{run_to, simulation};

/// A rod of 80 mm that closes at 20 per microsecond: a wave from its ends passes two particles. At 20 ns it has six tenths of its length.
const CLOSING: &str = r#"
dimensions = "1d"
particles = { spacing = "1 mm" }
numerics = { precision = "double", viscosity = { alpha = 1.0, beta = 0.05 } }
time = { end = "20 ns", fixed-step = "0.1 ns" }

[material.metal]
density = "8000 kg/m^3"
young-modulus = "200 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = { perfectly-plastic = { yield-stress = "1 GPa" } }
specific-heat = "500 J/(kg K)"
taylor-quinney = 0.8
reference-temperature = "300 K"

[[body]]
name = "rod"
material = "metal"
shape = { box = { min = ["-40 mm"], max = ["40 mm"] } }
velocity-gradient = { rows = [["-20e6 1/s"]] }
"#;

/// Rate of the closing at the start, 1/s, and the stretch at the end.
const RATE: f64 = 20e6;
const STRETCH: f64 = 0.6;

/// The length of the viscosity is that of the lattice as it is: `h lambda`, and the rate of closing `a/lambda`, so that both of its terms are the same all the
/// time and the work is `m (alpha c h a + beta (h a)^2)/2 ln(1/lambda)`.
#[test]
fn bulk_viscosity_has_the_length_of_the_compressed_lattice() {
    let mut simulation = simulation(CLOSING, &[]);
    run_to(&mut simulation, 20e-9);
    let (p, ledger) = (simulation.particles().unwrap(), simulation.ledger().unwrap());
    let c = simulation.model().materials[0].equation_of_state.reference_sound_speed();
    let speed = p.smoothing_length[0] * RATE;
    let work = ledger.total.mass * 0.5 * (c * speed + 0.05 * speed * speed) * (1.0 / STRETCH).ln();
    assert!((ledger.viscous_energy / work - 1.0).abs() < 0.02, "{} by hand {work}", ledger.viscous_energy);
}

/// A strain `ln(1/lambda)` along one axis is two thirds of it in shear. It yields from a stress of `2 G` times that on, at a work per volume of the yield stress
/// times the plastic strain; per mass it is over the density as it is, `rho_0/lambda`. All but a fifth of it is heat.
#[test]
fn plastic_work_heats_the_mass_that_is_in_the_compressed_volume() {
    let mut simulation = simulation(CLOSING, &[("numerics.viscosity", "false")]);
    run_to(&mut simulation, 20e-9);
    let p = simulation.particles().unwrap();
    let (yield_stress, rho, shear_modulus) = (1e9, 8000.0, 200e9 / 2.6_f64);
    let begins = (-0.5 * yield_stress / shear_modulus).exp();
    let work = yield_stress / rho * (2.0 / 3.0) * (begins - STRETCH);
    let middle = p.position.iter().enumerate().min_by(|a, b| a.1[0].abs().total_cmp(&b.1[0].abs())).unwrap().0;
    assert!((p.density[middle] / (rho / STRETCH) - 1.0).abs() < 1e-3, "{}", p.density[middle]);
    assert!((p.plastic_work[middle] / work - 1.0).abs() < 5e-3, "{} by hand {work}", p.plastic_work[middle]);
    let rise = p.temperature[middle] - 300.0;
    assert!((rise / (0.8 * work / 500.0) - 1.0).abs() < 5e-3, "{rise} by hand {}", 0.8 * work / 500.0);
}

/// A rod that closes slowly, to two thirds of what it bears cold. Half of it is kept hot, and heat flows from there as fast as the steps bear: the other half has been
/// elastic before it comes.
const HEATED: &str = r#"
dimensions = "1d"
particles = { spacing = "1 mm" }
numerics = { precision = "double", viscosity = false }
time = { end = "130 ns", fixed-step = "1 ns" }

[material.metal]
density = "8000 kg/m^3"
young-modulus = "200 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = { johnson-cook = { A = "300 MPa", B = "0 MPa", n = 1.0, C = 0.0, m = 1.0, melting-temperature = "1300 K" } }
specific-heat = "500 J/(kg K)"
conductivity = "4e8 W/(m K)"
taylor-quinney = 0.0
reference-temperature = "300 K"

[thermal]
boundary = [{ name = "oven", region = "hot", hold = "800 K" }]

[[region]]
name = "hot"
shape = { box = { min = ["-41 mm"], max = ["0 mm"] } }

[[body]]
name = "rod"
material = "metal"
shape = { box = { min = ["-40 mm"], max = ["40 mm"] } }
velocity-gradient = { rows = [["-1e4 1/s"]] }
"#;

/// Both forms: in one of them bodies are ready to rub, and heat by that, too.
#[test]
fn what_heat_alone_softens_yields_at_its_new_stress() {
    for method in ["total-lagrangian", "updated-lagrangian"] {
        let mut simulation = simulation(HEATED, &[("method", method), ("numerics.gradient-correction", "linear")]);
        run_to(&mut simulation, 130e-9);
        let p = simulation.particles().unwrap();
        let (mut softened, mut elastic) = (0, 0);
        // A wave from the ends has passed one particle.
        for i in (0..p.len()).filter(|&i| p.position[i][0].abs() < 37e-3) {
            let bears = 300e6 * (1.0 - (p.temperature[i] - 300.0) / 1000.0);
            // 2 G 0.0013: 200 MPa.
            let expected = f64::min(bears, 200e6);
            let (stress, x) = (p.deviator[i].von_mises(), 1e3 * p.position[i][0]);
            assert!((stress / expected - 1.0).abs() < 0.01, "{method}, {x} mm: {stress} by hand {expected}");
            softened += u32::from(bears < 198e6 && x > 0.0);
            elastic += u32::from(bears > 200e6);
        }
        assert!(softened >= 1 && elastic >= 20, "{method}: {softened} {elastic}");
    }
}
