//! What viscosity, artificial stress and hourglass springs turn into internal energy: pair by pair by hand, and the sum of all energies.

use super::setup::{run_steps, run_to, simulation};
use sphorge::{
    deck,
    engine::{Simulation, WallLedger},
};

/// A particle that moves along x, at half a spacing from the plane `x = 0`.
const PARTICLE: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm", smoothing = 1.2 }
time = { end = "1 ms", fixed-step = "1 ns" }

[numerics]
precision = "double"
kernel = "cubic-spline"
gradient-correction = "none"
viscosity = { alpha = 0.5, beta = 3.0 }
artificial-stress = { epsilon = 0.3, exponent = 4 }
xsph = 0

[material.metal]
density = "7890 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "right"
material = "metal"
shape = { box = { min = ["0 mm", "0 mm"], max = ["1 mm", "1 mm"] } }
velocity = ["SPEED", "0 m/s"]
"#;

/// Its like on the other side of the plane, and the plane itself in its place.
const LIKE: &str = r#"
[[body]]
name = "left"
material = "metal"
shape = { box = { min = ["-1 mm", "0 mm"], max = ["0 mm", "1 mm"] } }
"#;
const PLANE: &str = "symmetry = [{ axis = \"x\" }]\n";

/// Powers of viscosity and of artificial stress on the two particles, W/m, as the first is now: `m^2 W' v` times viscosity and twice the
/// repulsion over the square of the density, with the slope `W'` of the cubic spline and the speed `v` at which they part.
fn powers_of_pair(simulation: &Simulation) -> [f64; 2] {
    let p = simulation.particles().unwrap();
    let (r, parting, h, m) = (2.0 * p.position[0][0], 2.0 * p.velocity[0][0], 1.2e-3_f64, 7890.0 * 1e-6);
    let (rho, c) = (p.density[0], p.sound_speed[0]);
    let shape = |q: f64| 2.0 / 3.0 - q * q + 0.5 * q.powi(3);
    let slope = 15.0 / (7.0 * std::f64::consts::PI * h.powi(3)) * (1.5 * (r / h).powi(2) - 2.0 * r / h);
    let mu = (h * parting * r / (r * r + 0.01 * h * h)).min(0.0);
    let viscosity = (3.0 * mu * mu - 0.5 * c * mu) / rho;
    let tension = (p.deviator[0].xx - p.pressure[0]).max(0.0);
    let repulsion = 0.3 * tension * (shape(r / h) / shape(1e-3 / h)).powi(4);
    [m * m * viscosity * slope * parting, m * m * 2.0 * repulsion / (rho * rho) * slope * parting]
}

/// Both together in a step over what [`powers_of_pair`] says before and after it.
fn step_over_hand(simulation: &mut Simulation) -> [f64; 2] {
    let taken = |simulation: &Simulation| {
        let ledger = simulation.ledger().unwrap();
        [ledger.viscous_energy, ledger.artificial_stress_energy]
    };
    let (before, first) = (taken(simulation), powers_of_pair(simulation));
    let dt = simulation.step(None).unwrap().dt;
    let (after, last) = (taken(simulation), powers_of_pair(simulation));
    [0, 1].map(|k| {
        let by_hand = 0.5 * (first[k] + last[k]) * dt;
        if by_hand == 0.0 { after[k] - before[k] } else { (after[k] - before[k]) / by_hand }
    })
}

/// A pressure of particles that close turns work into heat; a repulsion of particles that part takes it from the internal energy.
#[test]
fn a_pair_turns_into_internal_energy_what_its_powers_by_hand_say() {
    for integrator in ["leapfrog", "predictor-corrector"] {
        for (form, split) in
            [("volume-weighted", "own-stress"), ("density-weighted", "symmetric"), ("mixed", "own-stress")]
        {
            for (speed, expected) in [(-10, [1.0, 0.0]), (10, [0.0, 1.0])] {
                let velocity = |speed| format!("[\"{speed} m/s\", \"0 m/s\"]");
                let like = format!("{PARTICLE}{LIKE}velocity = {}\n", velocity(-speed));
                for (deck, share) in [(like, 1.0), (format!("{PLANE}{PARTICLE}"), 0.5)] {
                    let overrides = [
                        ("body.right.velocity", &*velocity(speed)),
                        ("numerics.integrator", integrator),
                        ("numerics.pair-form", form),
                        ("numerics.energy-split", split),
                    ];
                    let mut simulation = simulation(&deck, &overrides);
                    run_steps(&mut simulation, 200);
                    let shares = step_over_hand(&mut simulation);
                    for (k, (is, expected)) in shares.iter().zip(expected).enumerate() {
                        assert!((is - share * expected).abs() < 1e-4 * share, "{overrides:?}, {share}, {k}: {is}");
                    }
                }
            }
        }
    }
}

/// Two that are closer than their lattice has them and part are driven apart by their own tension: at 0.3 spacings the repulsion is eighteen times as large. It takes no more than what
/// they hold above absolute zero. Without an end to it a pair that parts expands, pulls harder and is driven harder, and steps become as short as
/// one likes.
#[test]
fn a_pair_takes_no_more_than_its_energy_from_the_artificial_stress() {
    let like = format!("{PARTICLE}{LIKE}velocity = [\"-50 m/s\", \"0 m/s\"]\n");
    let with = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let overrides = [
        with("body.right.velocity", "[\"50 m/s\", \"0 m/s\"]"),
        with("numerics.artificial-stress", "{ epsilon = 0.6, exponent = 4 }"),
    ];
    let setup = deck::load_text("pair", &like, &overrides).unwrap();
    let (mut particles, material) = (setup.particles, setup.model.materials[0].clone());
    for x in &mut particles.position {
        x[0] *= 0.3;
    }
    let mut simulation = Simulation::new(setup.model, particles);
    let c = material.equation_of_state.reference_sound_speed();
    let held = 0.01 * c * c;
    let mut least = 0.0_f64;
    for _ in 0..1000 {
        simulation.step(None).unwrap();
        let p = simulation.particles().unwrap();
        least = p.energy.iter().copied().fold(least, f64::min);
    }
    assert!(least < -0.1 * held && least > -1.1 * held, "{}", least / held);
}

/// A bar that strikes a wall without friction and yields: five per cent of its energy goes to viscosity and springs.
const YIELDING_BAR: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
numerics = { precision = "double", artificial-stress = false, xsph = 0 }
time = { end = "1 ms" }

[material.metal]
density = "7890 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = { bilinear = { yield-stress = "300 MPa", tangent-modulus = "2 GPa" } }

[[body]]
name = "bar"
material = "metal"
shape = { box = { min = ["0 mm", "-3 mm"], max = ["20 mm", "3 mm"] } }
velocity = ["-40 m/s", "0 m/s"]

[[symmetry]]
axis = "x"
"#;

/// In place of its velocity: its end is driven against the wall.
const DRIVEN: &str = r#"
[[region]]
name = "end"
shape = { box = { min = ["18 mm", "-3 mm"], max = ["20 mm", "3 mm"] } }

[[motion]]
region = "end"
velocity = ["-30 m/s", "free"]
"#;

/// In place of the wall: a block at rest, over which it slips.
const BLOCK: &str = r#"
[[body]]
name = "block"
material = "metal"
shape = { box = { min = ["-8 mm", "-6 mm"], max = ["0 mm", "6 mm"] } }
"#;

/// In place of the plane of symmetry: a wall, on which it slides.
const WALL: &str = r#"
[[wall]]
name = "wall"
plane = { point = [0, 0], normal = [1, 0] }
contact = { penalty = { friction = 0.3, damping = 0.2 } }
"#;

/// What [`YIELDING_BAR`] has at the end, as shares of the energy it was given: kinetic energy at the start and external work.
struct Named {
    viscous: f64,
    hourglass: f64,
    artificial_stress: f64,
    /// What contacts hold, and turned into heat.
    contacts: f64,
    /// Heat of friction and damping at walls.
    walls: [f64; 2],
    /// Kinetic and elastic energy, plastic work, and these four, less what was given.
    excess: f64,
}

impl Named {
    fn after(deck: &str, overrides: &[(&str, &str)], step: &str) -> Self {
        let mut simulation = simulation(deck, &[overrides, &[("time.fixed-step", step)]].concat());
        let start = simulation.ledger().unwrap().total.energies.kinetic;
        run_to(&mut simulation, 20e-6);
        let ledger = simulation.ledger().unwrap();
        let (energies, given) = (ledger.total.energies, start + ledger.external_work);
        // The heat of walls is external work; what they hold comes back.
        let of_walls = |of: fn(&WallLedger) -> f64| ledger.walls.iter().map(of).sum::<f64>() / given;
        let walls = [of_walls(|wall| wall.friction_work), of_walls(|wall| wall.damping_work)];
        // What slides or is struck keeps some of its motion.
        let keeps = !(ledger.contacts.is_empty() && ledger.walls.is_empty());
        let spent = if keeps { given - energies.kinetic } else { given };
        assert!(energies.plastic_work > 0.7 * spent, "nothing happened: {overrides:?}");
        let (viscous, hourglass) = (ledger.viscous_energy / given, ledger.hourglass_energy / given);
        let artificial_stress = ledger.artificial_stress_energy / given;
        let of_contacts =
            ledger.contacts.iter().map(|c| c.stored_energy + c.friction_work + c.damping_work + c.integration_energy);
        let contacts = of_contacts.sum::<f64>() / given;
        let of_stress = (energies.elastic + energies.plastic_work) / given;
        let numerical = viscous + hourglass + artificial_stress;
        let heat: f64 = walls.iter().sum();
        let excess = energies.kinetic / given + of_stress + numerical + contacts + heat - 1.0;
        Self { viscous, hourglass, artificial_stress, contacts, walls, excess }
    }
}

/// The energy that was given is kinetic energy, what stress stores and dissipates, what springs and artificial stress take, what contacts
/// hold, and what these and viscosity turn into heat.
/// What is left over is the error of the stress, of first order in the step.
#[test]
fn every_joule_has_a_name() {
    let total = [("method", "total-lagrangian")];
    let updated = [("method", "updated-lagrangian"), ("numerics.gradient-correction", "linear")];
    let and = |further: &[(&'static str, &'static str)]| [&updated, further].concat();
    let repelling = ("numerics.artificial-stress", "{ epsilon = 0.3, exponent = 4 }");
    // XSPH moves particles without force: it takes nothing.
    let moving = ("numerics.xsph", "0.5");
    let [front, _] = YIELDING_BAR.split("[[symmetry]]").collect::<Vec<_>>()[..] else { panic!("a plane") };
    let striking = format!("contact = {{ penalty = {{ friction = 0.2, damping = 0.2 }} }}\n{front}{BLOCK}");
    let sliding = format!("{front}{WALL}");
    let slanting = ("body.bar.velocity", "[\"-60 m/s\", \"20 m/s\"]");
    let driven = YIELDING_BAR.replace("velocity = [\"-40 m/s\", \"0 m/s\"]", "") + DRIVEN;
    let cases = [
        (YIELDING_BAR, total.to_vec()),
        (YIELDING_BAR, [total[0], ("search", "{ total-lagrangian = { hourglass = 4 } }")].to_vec()),
        (YIELDING_BAR, updated.to_vec()),
        (YIELDING_BAR, and(&[("numerics.pair-form", "density-weighted"), ("numerics.viscosity.balsara", "true")])),
        (YIELDING_BAR, and(&[("numerics.pair-form", "mixed"), ("numerics.energy-split", "symmetric")])),
        (YIELDING_BAR, and(&[("numerics.integrator", "predictor-corrector")])),
        (YIELDING_BAR, and(&[repelling])),
        (YIELDING_BAR, and(&[repelling, ("numerics.integrator", "predictor-corrector")])),
        (YIELDING_BAR, and(&[repelling, moving])),
        (YIELDING_BAR, and(&[repelling, moving, ("numerics.integrator", "predictor-corrector")])),
        (&striking, vec![total[0], slanting]),
        (&sliding, vec![total[0], slanting]),
        (&sliding, vec![updated[0], updated[1], slanting]),
        (&sliding, vec![updated[0], updated[1], slanting, ("numerics.integrator", "predictor-corrector")]),
        (&driven, total.to_vec()),
        (&driven, updated.to_vec()),
    ];
    for (deck, case) in cases {
        // What slides on a wall has twice the error at the same step, in the total Lagrangian form, where its faces slide, a little more.
        let steps = match (deck == sliding, case[0] == total[0]) {
            (true, true) => ["\"4 ns\"", "\"1 ns\""],
            (true, false) => ["\"8 ns\"", "\"2 ns\""],
            (false, _) => ["\"16 ns\"", "\"4 ns\""],
        };
        let [coarse, fine] = steps.map(|step| Named::after(deck, &case, step));
        let (left, coarser) = (fine.excess.abs(), coarse.excess.abs());
        assert!(left < 1.5e-4 && coarser < 6e-4, "{case:?}: {coarser:.1e}, {left:.1e}");
        // A quarter of the step, a quarter of the error; the error of the predictor-corrector has two parts that all but cancel at 16 ns.
        let falls = if case.iter().any(|(_, value)| *value == "predictor-corrector") { 1.5 } else { 3.5 };
        assert!(coarser > falls * left, "{case:?}: {coarser:.1e}, {left:.1e}");
        // None is lost in what is left over.
        assert!(fine.viscous > 10.0 * left, "{case:?}: {:.1e} of viscosity", fine.viscous);
        for (of, share, there) in [
            ("springs", fine.hourglass, case[0] == total[0]),
            ("artificial stress", -fine.artificial_stress, case.contains(&repelling)),
            ("contacts", fine.contacts, deck == striking),
            ("friction at the wall", fine.walls[0], deck == sliding),
            ("damping at the wall", fine.walls[1], deck == sliding),
        ] {
            assert!(if there { share > 10.0 * left } else { share == 0.0 }, "{case:?}: {share:.1e} of {of}");
        }
    }
}
