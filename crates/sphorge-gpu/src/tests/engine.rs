//! Whole steps on a GPU, beside those of the processor.

use super::card::gpu;
use sphorge_deck::{decks, load_text};
use sphorge_engine::model::{Model, ParticleSelection, Precision};
use sphorge_engine::particles::FIELDS;
use sphorge_engine::persist::MemoryArchive;
use sphorge_engine::{Column, Cpu, EngineKind, FieldSource, Ledger, ParticleSource, Particles, Reduction, Simulation};

/// A shipped deck with overrides, on an engine.
pub(super) fn start(kind: &dyn EngineKind, deck: &str, overrides: &[(&str, &str)]) -> Simulation {
    let deck = decks::find(deck).unwrap();
    start_text(kind, deck.name, deck.text, overrides)
}

/// A deck with overrides, on an engine.
pub(super) fn start_text(kind: &dyn EngineKind, name: &str, text: &str, overrides: &[(&str, &str)]) -> Simulation {
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let setup = load_text(name, text, &overrides).unwrap_or_else(|report| panic!("{report:?}"));
    kind.supports(&setup.model).unwrap();
    Simulation::start(kind, setup.model, setup.particles).unwrap()
}

/// Runs to a time, s.
fn run(simulation: &mut Simulation, end: f64) -> (Particles, Ledger) {
    count_steps(simulation, end);
    (simulation.particles().unwrap(), simulation.ledger().unwrap())
}

/// Runs to a time, s; the number of steps.
pub(super) fn count_steps(simulation: &mut Simulation, end: f64) -> u32 {
    let mut steps = 0;
    while simulation.time() < end {
        simulation.step(Some(end)).unwrap();
        steps += 1;
    }
    steps
}

pub(super) const PLATE: (&str, &[(&str, &str)]) = ("taylor-plate", &[("particles.spacing", "\"0.6 mm\"")]);

/// Extent along an axis, m.
fn extent(p: &Particles, axis: usize) -> f64 {
    let along = || p.position.iter().map(|x| x[axis]);
    along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
}

/// Runs of the two engines, and how near they must be: lengths, energies, strains.
pub(super) fn compare(deck: &str, overrides: &[(&str, &str)], end: f64, near: f64) {
    compare_with_noise(deck, overrides, end, near, true);
}

/// The same, of the work of the hourglass springs, the damping of walls and their force too where that is asked for.
fn compare_with_noise(deck: &str, overrides: &[(&str, &str)], end: f64, near: f64, of_noise: bool) {
    // In double precision: nearer to what both approximate.
    let double = [overrides, &[("numerics.precision", "\"double\"")]].concat();
    let theirs = run(&mut start(&Cpu, deck, &double), end);
    let ours = run(&mut start(&gpu(), deck, overrides), end);
    let close = |what: &str, ours: f64, theirs: f64, scale: f64| {
        assert!((ours - theirs).abs() <= near * scale, "{deck}, {what}: {ours} on the card, {theirs}");
    };
    for axis in 0..2 {
        close("extent", extent(&ours.0, axis), extent(&theirs.0, axis), extent(&theirs.0, axis));
    }
    let (a, b) = (&ours.1, &theirs.1);
    let (e, f) = (a.total.energies, b.total.energies);
    let scale = f.kinetic + f.internal;
    for (what, ours, theirs) in [
        ("kinetic", e.kinetic, f.kinetic),
        ("internal", e.internal, f.internal),
        ("elastic", e.elastic, f.elastic),
        ("plastic work", e.plastic_work, f.plastic_work),
        ("external work", a.external_work, b.external_work),
        ("integration", a.integration_energy, b.integration_energy),
        ("moving least squares", a.mls_energy, b.mls_energy),
    ] {
        close(what, ours, theirs, scale);
    }
    // Small parts of the energies, so each beside itself.
    close("viscosity", a.viscous_energy, b.viscous_energy, b.viscous_energy);
    // Springs resist what the noise of pressures drives, too.
    if of_noise {
        close("hourglass springs", a.hourglass_energy, b.hourglass_energy, 10.0 * b.hourglass_energy.abs());
        let held = b.hourglass_stored_energy;
        close("what hourglass springs hold", a.hourglass_stored_energy, held, 10.0 * held);
    }
    assert!(b.viscous_energy > 1e-3 * scale, "nothing is damped");
    close(
        "artificial stress",
        a.artificial_stress_energy,
        b.artificial_stress_energy,
        b.artificial_stress_energy.abs(),
    );
    for (k, (ours, theirs)) in a.walls.iter().zip(&b.walls).enumerate() {
        close(&format!("work of wall {k}"), ours.work, theirs.work, scale);
        // Of the same forces as below, so as near.
        for (heat, ours, theirs) in [
            ("friction", ours.friction_work, theirs.friction_work),
            ("damping", ours.damping_work, theirs.damping_work),
        ]
        .into_iter()
        .filter(|(heat, ..)| of_noise || *heat == "friction")
        {
            close(&format!("{heat} of wall {k}"), ours, theirs, 10.0 * theirs);
        }
        for axis in (0..3).filter(|_| of_noise) {
            let scale = b.wall_forces[k].iter().map(|f| f.abs()).sum::<f64>();
            // Forces of single particles at a wall move in 1 % of their sum.
            close("wall force", a.wall_forces[k][axis], b.wall_forces[k][axis], 10.0 * scale);
        }
    }
    // The particles of the one are those of the other.
    let largest = |p: &Particles| p.plastic_strain.iter().fold(0.0f64, |a, b| a.max(*b));
    close("largest plastic strain", largest(&ours.0), largest(&theirs.0), largest(&theirs.0));
    let hottest = |p: &Particles| p.temperature.iter().fold(0.0f64, |a, b| a.max(*b));
    close("largest temperature", hottest(&ours.0), hottest(&theirs.0), hottest(&theirs.0));
    let neighbors = |p: &Particles| p.neighbors.iter().map(|n| u64::from(*n)).sum::<u64>() as f64;
    close("pairs", neighbors(&ours.0), neighbors(&theirs.0), 10.0 * neighbors(&theirs.0));
    assert!(largest(&theirs.0) > 0.05, "nothing flows");
}

#[test]
fn the_plate_of_the_paper_matches_the_cpu_before_chaos() {
    // From 15 us on, particles of this method fall together in pairs, and the last bit decides which.
    compare(PLATE.0, PLATE.1, 8e-6, 1e-4);
}

#[test]
fn every_field_a_deck_can_name_matches_the_cpu() {
    compare_fields(PLATE.0, PLATE.1, 3e-6);
    compare_fields(IRON.0, IRON.1, 3e-6);
}

pub(super) fn compare_fields(deck: &str, overrides: &[(&str, &str)], end: f64) {
    compare_fields_to(deck, overrides, end, 3e-4);
}

/// Runs of the two engines, and how near every field of every particle must be, over the largest value of it.
fn compare_fields_to(deck: &str, overrides: &[(&str, &str)], end: f64, near: f64) {
    let simulations = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
        let mut simulation = start(kind, deck, overrides);
        run(&mut simulation, end);
        simulation
    });
    for field in FIELDS.iter() {
        let [theirs, ours] = simulations.each_ref().map(|simulation| components(&simulation.read(field.name).unwrap()));
        let most = |numbers: &[f64]| numbers.iter().filter(|c| c.is_finite()).fold(0.0f64, |a, b| a.max(b.abs()));
        let largest = most(&theirs);
        let near_to = match field.name {
            // A ratio is as good as both stresses are.
            "triaxiality" => {
                let [pressure, shear] =
                    ["pressure", "von_mises_stress"].map(|stress| components(&simulations[0].read(stress).unwrap()));
                let (pressures, shears) = (most(&pressure), most(&shear));
                let ratios = theirs.iter().zip(&shear);
                ratios.map(|(ratio, shear)| near * (pressures + ratio.abs() * shears) / shear).collect()
            }
            // So is the angle of principal stresses.
            "lode_angle" => {
                let shear = components(&simulations[0].read("von_mises_stress").unwrap());
                shear.iter().map(|of| 8.0 * near * most(&shear) / of).collect()
            }
            _ => vec![near * largest; theirs.len()],
        };
        let periodic = simulations[0].model().periodic;
        for (k, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            let cell = periodic[k % 3].filter(|_| field.name == "displacement").map(|(low, high)| high - low);
            // A GPU does not count how often a particle has come in again.
            let off = ours - theirs;
            let off = cell.map_or(off, |cell| off - (off / cell).round() * cell);
            let is_near = off.abs() <= near_to[k] || ours == theirs;
            assert!(
                is_near,
                "{deck}, {}, value {k}: {ours} on the card, {theirs}; the largest is {largest}",
                field.name
            );
        }
    }
}

/// All numbers of a field.
pub(super) fn components(column: &Column<'_>) -> Vec<f64> {
    match column {
        Column::Scalar(values) => values.to_vec(),
        Column::Integer(values) => values.iter().map(|value| f64::from(*value)).collect(),
        Column::Vector(values) => values.as_flattened().to_vec(),
        Column::Symmetric(values) => values.iter().flat_map(|value| value.to_array()).collect(),
        Column::Tensor(values) => values.as_flattened().as_flattened().to_vec(),
    }
}

#[test]
fn numbers_are_as_good_as_those_of_the_processor() {
    // Waves so weak that pressures of densities of single precision, some 10 kPa off, would be a thousandth of them.
    let piston = [("numerics.precision", "\"mixed\""), ("particles.spacing", "\"0.1 mm\"")];
    compare_fields_to("elastic-plastic-piston", &piston, 2e-6, 2e-5);
    compare_fields_to(PLATE.0, PLATE.1, 2e-6, 2e-5);
}

#[test]
fn densities_by_moving_least_squares_match_the_cpu() {
    // Two bodies in kernel sums whose densities know nothing of each other; the leapfrog, in space.
    let shear = [("particles.spacing", "\"1.5 mm\""), ("numerics.mls-interval", "5")];
    compare("high-shear", &shear, 6e-6, 1e-4);
    let bar = [("method", "\"patino\""), ("particles.spacing", "\"1.2 mm\""), ("numerics.mls-interval", "4")];
    let leapfrog = ("numerics.integrator", "\"leapfrog\"");
    compare("taylor-bar", &[&bar[..], &[leapfrog]].concat(), 4e-6, 1e-4);
    // At the distances of now where sums are taken with older ones.
    for search in ["{ adaptive = { guard = \"none\" } }", "{ total-lagrangian = { form = \"frozen\" } }"] {
        compare("taylor-bar", &[&bar[..], &[leapfrog, ("search", search)]].concat(), 4e-6, 1e-4);
    }
}

#[test]
fn a_bar_in_space_matches_the_cpu() {
    compare("taylor-bar", &[("method", "\"patino\""), ("particles.spacing", "\"1.2 mm\"")], 4e-6, 1e-4);
}

#[test]
fn a_wall_with_friction_matches_the_cpu() {
    let wall = ("wall.0.contact", "{ penalty = { friction = 0.2 } }");
    compare(PLATE.0, &[PLATE.1[0], wall, ("numerics.viscosity.balsara", "true")], 5e-6, 1e-4);
}

#[test]
fn segments_as_walls_match_the_cpu() {
    // Slanted below, with an end that the plate strikes.
    let walls = "[{ name = \"wedge\", segment = { from = [\"-9 mm\", \"-2.4 mm\"], to = [\"1 mm\", \"-0.3 mm\"] } }, \
                  { name = \"edge\", segment = { from = [\"2 mm\", \"-0.4 mm\"], to = [\"9 mm\", \"-6 mm\"] }, \
                    contact = { penalty = { friction = 0.2 } }, velocity = [\"0 m/s\", \"30 m/s\"] }]";
    compare(PLATE.0, &[PLATE.1[0], ("wall", walls)], 6e-6, 1e-4);
    // In the default method GPUs refuse those that push facets.
    let at_particles = walls.replace("friction = 0.2", "surfaces = \"particles\", friction = 0.2").replace(
        "[\"1 mm\", \"-0.3 mm\"] }",
        "[\"1 mm\", \"-0.3 mm\"] }, contact = { penalty = { surfaces = \"particles\" } }",
    );
    let overrides = [IRON.1[0], ("wall", walls)].map(|(path, value)| (path.to_owned(), value.to_owned()));
    let model = load_text(IRON.0, decks::find(IRON.0).unwrap().text, &overrides).unwrap().model;
    assert!(gpu().supports(&model).is_err_and(|refusal| refusal.help.contains("particles")));
    compare(IRON.0, &[IRON.1[0], ("wall", &at_particles)], 6e-6, 1e-4);
}

#[test]
fn the_leapfrog_matches_the_cpu() {
    let leapfrog = ("numerics.integrator", "\"leapfrog\"");
    compare(PLATE.0, &[PLATE.1[0], leapfrog], 8e-6, 1e-4);
    let rubs = ("wall.0.contact", "{ penalty = { friction = 0.2 } }");
    let moves = ("wall.0.velocity", "[\"0 m/s\", [[\"0 us\", \"0 m/s\"], [\"4 us\", \"60 m/s\"]]]");
    let form = ("numerics.pair-form", "\"density-weighted\"");
    let balsara = ("numerics.viscosity.balsara", "true");
    compare(PLATE.0, &[PLATE.1[0], leapfrog, rubs, moves, form, balsara], 5e-6, 1e-4);
    compare("taylor-bar", &[("method", "\"patino\""), leapfrog, ("particles.spacing", "\"1.2 mm\"")], 4e-6, 1e-4);
}

/// The default method. The wall stands 10 nm higher: where it touches at the start, rounding decides which step is
/// the first that it damps.
pub(crate) const IRON: (&str, &[(&str, &str)]) = (
    "iron-plate",
    &[("particles.spacing", "\"0.6365 mm\""), ("wall.0.plane", "{ point = [\"0 mm\", \"1e-5 mm\"], normal = [0, 1] }")],
);

#[test]
fn the_default_method_matches_the_cpu() {
    compare(IRON.0, IRON.1, 20e-6, 1e-4);
    let [spacing, wall] = [IRON.1[0], IRON.1[1]];
    let rubs = ("wall.0.contact", "{ penalty = { friction = 0.2 } }");
    let moves = ("wall.0.velocity", "[\"0 m/s\", [[\"0 us\", \"0 m/s\"], [\"4 us\", \"60 m/s\"]]]");
    let falls = ("gravity", "[\"2e6 m/s^2\", \"-3e6 m/s^2\"]");
    // At 5 us what sticks and what slips is for rounding to say: the springs' work of the processor itself is 111.9 to 112.2 J/m there, by its
    // precision and by where output cuts its steps, the damping of the wall 243.6 to 246.0 J/m, its force 7.016 to 7.067 MN/m. All else is compared
    // there as well.
    let pressed = [spacing, wall, rubs, moves, falls];
    compare(IRON.0, &pressed, 3e-6, 1e-4);
    compare_with_noise(IRON.0, &pressed, 5e-6, 1e-4, false);
    compare("taylor-bar", &[("method", "\"total-lagrangian\""), ("particles.spacing", "\"1.2 mm\"")], 8e-6, 1e-4);
}

#[test]
fn viscosity_of_shocks_matches_the_cpu() {
    let shocks = ("numerics.viscosity.shocks", "1.0");
    compare(IRON.0, &[IRON.1[0], IRON.1[1], shocks], 5e-6, 1e-4);
    compare("taylor-bar", &[("particles.spacing", "\"1.2 mm\""), shocks], 4e-6, 1e-4);
}

#[test]
fn measures_are_taken_at_deformed_faces() {
    let [theirs, ours] = [&Cpu as &dyn EngineKind, &gpu()].map(|kind| {
        let mut simulation = start(kind, IRON.0, IRON.1);
        run(&mut simulation, 10e-6);
        let of = ParticleSelection::default();
        let extents = [0, 1].map(|axis| Reduction::Extent { of: &of, axis });
        let measure = |reduction: &Reduction<'_>| simulation.reduce(reduction).unwrap()[0];
        let [diameter, undeformed] =
            [measure(&Reduction::Diameter { of: &of, axis: 1 }), extent(&simulation.particles().unwrap(), 1)];
        ([measure(&extents[0]), measure(&extents[1]), diameter], undeformed)
    });
    let spacing = 0.6365e-3;
    assert!((theirs.0[1] - theirs.1 - spacing).abs() > 0.02 * spacing, "{theirs:?}");
    for (ours, theirs) in ours.0.into_iter().zip(theirs.0) {
        assert!((ours - theirs).abs() < 1e-3 * spacing, "{ours} on the card, {theirs}");
    }
}

#[test]
fn planes_of_symmetry_match_the_cpu() {
    compare("copper-bar", &[("particles.spacing", "\"0.95 mm\"")], 10e-6, 1e-4);
    // A plane at a place that single precision does not know, with a table of as many cells as columns are long; and a corner of two.
    let half = [
        PLATE.1[0],
        ("symmetry", "[{ axis = \"x\", at = \"0.1 mm\" }]"),
        ("body.plate.shape", "{ box = { min = [\"0.1 mm\", \"0 mm\"], max = [\"3.7 mm\", \"12 mm\"] } }"),
    ];
    compare(PLATE.0, &half, 4e-6, 1e-4);
    let corner = [
        ("wall", "[]"),
        ("symmetry", "[{ axis = \"x\", at = \"0.1 mm\" }, { axis = \"y\", at = \"0.3 mm\" }]"),
        ("body.plate.shape", "{ box = { min = [\"0.1 mm\", \"0.3 mm\"], max = [\"3.7 mm\", \"12.3 mm\"] } }"),
        ("numerics.integrator", "\"leapfrog\""),
    ];
    compare(PLATE.0, &[&half[..1], &corner].concat(), 4e-6, 1e-4);
}

#[test]
fn flattened_particles_take_the_steps_of_the_cpu() {
    let fast = [IRON.1[0], IRON.1[1], ("body.bar.velocity", "[\"0 m/s\", \"-400 m/s\"]")];
    let [theirs, ours] =
        [&Cpu as &dyn EngineKind, &gpu()].map(|kind| count_steps(&mut start(kind, IRON.0, &fast), 20e-6));
    assert!(ours.abs_diff(theirs) <= 2, "{ours} steps on the card, {theirs}");
}

#[test]
fn a_body_between_two_symmetry_planes_matches_the_cpu() {
    let between = |x: f64| {
        format!("[{{ axis = \"x\", at = \"-{x} mm\" }}, {{ axis = \"x\", at = \"{x} mm\", side = \"negative\" }}]")
    };
    let [near, far] = [3.8, 3.9].map(between);
    // Nothing is pulled.
    let plate = [PLATE.1[0], ("symmetry", &near), ("numerics.artificial-stress", "false")];
    compare(PLATE.0, &plate, 4e-6, 1e-4);
    compare(PLATE.0, &[&plate[..], &[("search", "\"skin\"")]].concat(), 4e-6, 1e-4);
    // Here it spreads until it meets its images.
    compare(IRON.0, &[IRON.1[0], IRON.1[1], ("symmetry", &far)], 8e-6, 1e-4);
    conserves_and_repeats(IRON.0, &[IRON.1[0], IRON.1[1], ("symmetry", &far)], 3e-6);
}

#[test]
fn corrected_gradients_match_the_cpu() {
    let correction = ("numerics.gradient-correction", "\"linear\"");
    compare(PLATE.0, &[PLATE.1[0], correction], 4e-6, 1e-4);
    let bar = [("method", "\"patino\""), ("particles.spacing", "\"1.2 mm\""), correction];
    let leapfrog = ("numerics.integrator", "\"leapfrog\"");
    let form = ("numerics.pair-form", "\"density-weighted\"");
    compare("taylor-bar", &[&bar[..], &[leapfrog, form]].concat(), 3e-6, 1e-4);
    let mixed = ("numerics.precision", "\"mixed\"");
    compare_fields("elastic-plastic-piston", &[mixed, ("particles.spacing", "\"0.1 mm\"")], 2e-6);
    compare_fields("elastic-bar", &[mixed, ("particles.spacing", "\"0.81 mm\"")], 5e-6);
    compare_fields("homogeneous", &[mixed, ("particles.spacing", "\"0.2 m\"")], 1e-4);
    conserves_and_repeats(PLATE.0, &[PLATE.1[0], correction, leapfrog], 2e-6);
}

#[test]
fn bodies_of_two_metals_that_strike_match_the_cpu() {
    let overrides = [
        ("search", "\"every-step\""),
        ("particles.spacing", "\"0.8 mm\""),
        ("body.0.material", "\"ofhc-copper\""),
        ("numerics.temperature", "\"plastic-work\""),
        ("time.courant", "0.1"),
    ];
    compare("penetration", &overrides, 1e-6, 1e-4);
}

#[test]
fn temperatures_of_the_energy_match_the_cpu() {
    // Shocks of 100 GPa; with artificial stress, whose work is no heat.
    let disc = [("particles.spacing", "\"0.8 mm\""), ("time.courant", "0.1")];
    compare("penetration", &[&disc[..], &[("body.1.temperature", "\"500 K\"")]].concat(), 1.2e-6, 1e-4);
    compare_fields("penetration", &disc, 1.2e-6);
    let leapfrog = ("numerics.integrator", "\"leapfrog\"");
    compare_fields(
        "penetration",
        &[disc[0], disc[1], leapfrog, ("numerics.artificial-stress", "{ epsilon = 3.0 }")],
        1.2e-6,
    );
}

#[test]
fn one_dimension_matches_the_cpu() {
    let overrides = [
        ("method", "\"patino\""),
        ("body.0.velocity", "[\"900 m/s\"]"),
        ("body.0.material", "\"ofhc-copper\""),
        ("body.1.material", "\"ofhc-copper\""),
        ("numerics.precision", "\"mixed\""),
        ("numerics.gradient-correction", "\"none\""),
        ("particles.spacing", "\"0.4 mm\""),
    ];
    compare("plate-impact", &overrides, 5e-7, 1e-4);
}

#[test]
fn other_kernels_forms_moving_walls_and_gravity_match_the_cpu() {
    let overrides = [
        PLATE.1[0],
        ("numerics.kernel", "\"quintic-spline\""),
        ("numerics.pair-form", "\"density-weighted\""),
        ("numerics.energy-split", "\"symmetric\""),
        ("gravity", "[\"2e6 m/s^2\", \"-3e6 m/s^2\"]"),
        ("wall.0.velocity", "[\"0 m/s\", [[\"0 us\", \"0 m/s\"], [\"4 us\", \"60 m/s\"]]]"),
        ("material.armco-iron.strength", "{ perfectly-plastic = { yield-stress = \"300 MPa\" } }"),
    ];
    compare(PLATE.0, &overrides, 5e-6, 1e-4);
}

#[test]
fn energy_is_conserved_and_a_saved_state_resumes_to_the_same_bits() {
    conserves_and_repeats(PLATE.0, PLATE.1, 2e-6);
    conserves_and_repeats(PLATE.0, &[PLATE.1[0], ("numerics.integrator", "\"leapfrog\"")], 2e-6);
    conserves_and_repeats(IRON.0, IRON.1, 4e-6);
    conserves_and_repeats("copper-bar", &[("particles.spacing", "\"1.27 mm\"")], 4e-6);
}

pub(super) fn conserves_and_repeats(deck: &str, overrides: &[(&str, &str)], half: f64) {
    let deck = decks::find(deck).unwrap();
    conserves_and_repeats_text(deck.name, deck.text, overrides, half);
}

pub(super) fn conserves_and_repeats_text(name: &str, text: &str, overrides: &[(&str, &str)], half: f64) {
    repeats_and_conserves_to(2e-8, name, text, overrides, half);
}

/// Runs to twice a time (s), from half of it again from a saved state, and from the start after going back to it; and the
/// drift that rounding may leave.
pub(super) fn repeats_and_conserves_to(rounding: f64, name: &str, text: &str, overrides: &[(&str, &str)], half: f64) {
    let kind = gpu();
    let end = 2.0 * half;
    let [mut first, mut second] = [(); 2].map(|()| start_text(&kind, name, text, overrides));
    let start_of = first.ledger().unwrap();
    let mut before = MemoryArchive::new();
    second.persist(&mut before).unwrap();
    let (between, _) = run(&mut first, half);
    run(&mut second, half);
    let mut archive = MemoryArchive::new();
    second.persist(&mut archive).unwrap();
    let mut third = start_text(&kind, name, text, overrides);
    third.persist(&mut archive.to_load()).unwrap();
    let (whole, ledger) = run(&mut first, end);
    for other in [&mut second, &mut third] {
        let (again, sums) = run(other, end);
        assert_eq!(sums, ledger);
        assert_eq!((&again.position, &again.energy), (&whole.position, &whole.energy));
        assert_eq!((&again.plastic_strain, &again.deviator), (&whole.plastic_strain, &whole.deviator));
    }
    assert_ne!(between.position, whole.position);
    third.persist(&mut before.to_load()).unwrap();
    let (repeated, _) = run(&mut third, half);
    assert_eq!((&repeated.position, &repeated.energy), (&between.position, &between.energy));
    let (drift, momentum) = drifts(&first, &start_of);
    assert!(drift.abs() < rounding, "{drift:e}");
    assert!(momentum < rounding, "{momentum:e}");
}

/// Total energy and momentum less what was there at first and came from outside, over these then or now, of which one may be at rest.
pub(super) fn drifts(simulation: &Simulation, first: &Ledger) -> (f64, f64) {
    let ledger = simulation.ledger().unwrap();
    let change = ledger.total_energy() - first.total_energy() - ledger.external_work;
    let drift = change / if first.total_energy() > 0.0 { first.total_energy() } else { ledger.total_energy() };
    // Planes of symmetry take momentum up.
    let planes = &simulation.model().symmetry;
    let momentum: f64 = (0..3)
        .filter(|axis| planes.iter().all(|plane| plane.axis != *axis))
        .map(|a| ledger.total.momentum[a] - first.total.momentum[a] - ledger.external_impulse[a])
        .map(f64::abs)
        .sum();
    let scales = [first.total.momentum_scale, ledger.total.momentum_scale];
    (drift, momentum / if scales[0] > 0.0 { scales[0] } else { scales[1] })
}

#[test]
fn every_shipped_deck_is_supported_except_in_double_precision() {
    for deck in decks::DECKS {
        let load = |overrides: &[(String, String)]| load_text(deck.name, deck.text, overrides).unwrap().model;
        let refused = |model: &Model| gpu().supports(model).err().map(|refusal| refusal.what);
        let model = load(&[]);
        let is_double = model.numerics.precision == Precision::Double;
        let what = refused(&model);
        assert_eq!(what.is_some(), is_double, "{}: {what:?}", deck.name);
        assert!(!is_double || what.is_some_and(|what| what.contains("double precision")), "{}", deck.name);
        let mixed = ("numerics.precision".to_owned(), "\"mixed\"".to_owned());
        assert_eq!(refused(&load(&[mixed])), None, "{}", deck.name);
    }
}

#[test]
fn double_precision_is_refused_with_the_reason() {
    let deck = decks::find("elastic-bar").unwrap();
    let setup = load_text(deck.name, deck.text, &[]).unwrap();
    let refusal = gpu().supports(&setup.model).unwrap_err();
    assert!(refusal.what.contains("cards compute pairs in single precision"), "{refusal:?}");
    assert!(refusal.help.contains("numerics.precision") && refusal.help.contains("--engine cpu"), "{refusal:?}");
}

#[test]
fn a_step_that_is_too_long_is_named_and_can_be_shorter() {
    let long = [PLATE.1[0], ("time.courant", "1.0"), ("time.step-control.jump", "0.001")];
    let mut simulation = start(&gpu(), PLATE.0, &long);
    let failure = (0..60).find_map(|_| simulation.step(None).err()).expect("a step that is too long");
    assert!(failure.step_may_be_smaller && failure.particle.is_some(), "{failure}");
    assert!(failure.message.contains("smoothing lengths in one step, more than the 0.001 of"), "{failure}");
}
