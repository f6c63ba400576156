//! Walls that push bodies at the facets of their particles: ends of segments, round surfaces, friction.

use super::setup::{run_to, simulation};
use sphorge::engine::Simulation;

/// An elastic block of steel, ten spacings wide, above the end of a rigid segment; the springs against hourglass modes are not what
/// is tested.
const BLADE: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
search = { total-lagrangian = { hourglass = 0 } }
numerics = { precision = "double", viscosity = false }
time = { end = "1 ms" }

[material.steel]
density = "7850 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "block"
material = "steel"
shape = { box = { min = ["-5 mm", "0.1 mm"], max = ["5 mm", "10.1 mm"] } }
velocity = ["0 m/s", "-5 m/s"]
"#;

/// Walls of no friction and no damping along these segments, mm, which move up at 1 m/s.
fn walls(segments: &[[[f64; 2]; 2]]) -> String {
    let wall = |(k, [from, to]): (usize, &[[f64; 2]; 2])| {
        let end = |[x, y]: [f64; 2]| format!("[\"{x} mm\", \"{y} mm\"]");
        let (from, to) = (end(*from), end(*to));
        format!(
            "[[wall]]\nname = \"wall-{k}\"\nsegment = {{ from = {from}, to = {to} }}\nvelocity = [\"0 m/s\", \"1 m/s\"]\n\
             contact = {{ penalty = {{ damping = 0.0 }} }}\n"
        )
    };
    segments.iter().enumerate().map(wall).collect()
}

/// What became of a block that struck segments: the largest force of all, N/m, its velocity upwards, m/s, and the sum of energies and of
/// the work that it did on them over the initial energy.
fn struck(segments: &[[[f64; 2]; 2]]) -> (f64, f64, f64) {
    // Small steps: the energy of so short a push is kept by the square of them.
    let mut simulation = simulation(&format!("{BLADE}{}", walls(segments)), &[("time.courant", "0.1")]);
    simulation.next_step_estimate().unwrap();
    let start = simulation.ledger().unwrap();
    let mut most = 0.0f64;
    while simulation.time() < 250e-6 {
        // Sums over all particles take as long as a step.
        for _ in 0..4 {
            simulation.step(Some(250e-6)).unwrap();
        }
        let forces = simulation.ledger().unwrap().wall_forces;
        most = most.max(forces.iter().map(|force| force[1]).sum());
    }
    let now = simulation.ledger().unwrap();
    assert!(now.wall_forces.iter().all(|force| *force == [0.0; 3]), "it has not left: {:?}", now.wall_forces);
    // The impulse of the walls is the change of momentum.
    let impulse = now.total.momentum[1] - start.total.momentum[1];
    assert!((now.external_impulse[1] / impulse - 1.0).abs() < 1e-9);
    let work: f64 = now.walls.iter().map(|wall| wall.work).sum();
    let energies = now.total.energies;
    let kept = (energies.kinetic + energies.elastic - work) / start.total.energies.kinetic;
    (most, now.total.momentum[1] / now.total.mass, kept)
}

#[test]
fn ends_edges_and_wedges_push_between_particles() {
    let up = |x: f64| [[x, -30.0], [x, 0.0]];
    // End on, below particles and between them: it cannot matter.
    let reference = struck(&[up(0.5)]);
    for x in [0.0, 0.25, 0.8] {
        let (most, velocity, kept) = struck(&[up(x)]);
        assert!((most / reference.0 - 1.0).abs() < 0.25, "{x}: {most} N/m, {reference:?}");
        // At first it comes with 6 m/s, seen from the blade: most of it goes on as motion.
        assert!(velocity > 4.0 && (kept - 1.0).abs() < 5e-3, "{x}: {velocity} {kept}");
    }
    // A narrow punch, the edge of a wedge and the corner of a box.
    for segments in [
        vec![[[-0.2, 0.0], [0.2, 0.0]]],
        vec![[[-3.0, -8.0], [0.0, 0.0]], [[0.0, 0.0], [3.0, -8.0]]],
        vec![[[-6.0, -6.0], [0.0, 0.0]], [[0.0, 0.0], [6.0, -6.0]]],
    ] {
        let (most, velocity, kept) = struck(&segments);
        assert!(
            most > 0.3 * reference.0 && velocity > 4.0 && (kept - 1.0).abs() < 5e-3,
            "{segments:?}: {most} {velocity} {kept}"
        );
    }
}

/// A slab without ends that strikes a wall at an angle.
fn oblique(friction: f64, along: f64) -> Simulation {
    let text = format!(
        r#"
dimensions = "plane-strain"
particles = {{ spacing = "0.5 mm" }}
numerics = {{ precision = "double" }}
periodic = {{ x = ["0 mm", "4 mm"] }}
time = {{ end = "3 us" }}

[material.aluminium]
density = "2700 kg/m^3"
young-modulus = "70 GPa"
poisson-ratio = 0.33
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "slab"
material = "aluminium"
shape = {{ box = {{ min = ["0 mm", "0 mm"], max = ["4 mm", "24 mm"] }} }}
velocity = ["{along} m/s", "-10 m/s"]

[[wall]]
name = "wall"
plane = {{ point = ["0 mm", "0 mm"], normal = [0, 1] }}
contact = {{ penalty = {{ surfaces = "facets", friction = {friction} }} }}
"#
    );
    simulation(&text, &[])
}

/// Means over a time of the tangential and normal stress on the wall, Pa.
fn stresses(simulation: &mut Simulation, (from, to): (f64, f64)) -> [f64; 2] {
    run_to(simulation, from);
    let mut sums = [0.0; 2];
    while simulation.time() < to {
        let before = simulation.time();
        simulation.step(Some(to)).unwrap();
        let force = simulation.ledger().unwrap().wall_forces[0];
        (0..2).for_each(|k| sums[k] += (simulation.time() - before) * force[k]);
    }
    sums.map(|sum| sum / (to - from) / 4e-3)
}

#[test]
fn what_sticks_on_a_wall_does_not_creep_and_what_slides_obeys_coulomb() {
    let (young, poisson, density) = (70e9, 0.33, 2700.0f64);
    let shear = young / (2.0 * (1.0 + poisson));
    let longitudinal = (young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) / density).sqrt();
    let transverse = (shear / density).sqrt();
    // Waves bring the face to rest: rho c_l v_n and rho c_s v_t.
    let normal = density * longitudinal * 10.0;
    let sheared = density * transverse * 5.0;
    assert!(sheared < 0.3 * normal);
    let mut stuck = oblique(0.3, 5.0);
    // Places of the lowest particles, which are a fraction of a spacing apart from where they were.
    let face = |simulation: &Simulation| {
        let particles = simulation.particles().unwrap();
        let (x, y) = (|i: usize| particles.position[i][0], |i: usize| particles.position[i][1]);
        let lowest = (0..particles.len()).min_by(|&i, &j| (y(i), x(i)).partial_cmp(&(y(j), x(j))).unwrap()).unwrap();
        (x(lowest) - 0.2e-3).rem_euclid(0.5e-3)
    };
    run_to(&mut stuck, 1e-6);
    let before = face(&stuck);
    let [tangential, pressing] = stresses(&mut stuck, (1e-6, 3e-6));
    assert!((pressing / normal - 1.0).abs() < 0.01, "{pressing} of {normal}");
    assert!((tangential / -sheared - 1.0).abs() < 0.01, "{tangential} of {sheared}");
    // And stays so from one step to the next: damping that is more than a step can bear swings without end.
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    while stuck.time() < 3.6e-6 {
        stuck.step(Some(3.6e-6)).unwrap();
        let force = stuck.ledger().unwrap().wall_forces[0][0] / 4e-3;
        (least, most) = (least.min(force), most.max(force));
    }
    assert!(most - least < 0.02 * sheared, "{least} to {most} of {sheared}");
    // The slab goes on by 13 um meanwhile.
    let crept = face(&stuck) - before;
    assert!(crept.abs() < 2e-8, "{crept}");
    // Faster than friction can hold: mu p, all of whose work is heat.
    let mut sliding = oblique(0.3, 20.0);
    let [tangential, pressing] = stresses(&mut sliding, (1e-6, 3e-6));
    assert!((tangential / (-0.3 * pressing) - 1.0).abs() < 0.005, "{tangential} {pressing}");
    let rubbed = sliding.ledger().unwrap().walls[0].friction_work;
    // The face slides at v_t - mu p/(rho c_s).
    let speed = 20.0 - 0.3 * normal / (density * transverse);
    let heat = 0.3 * normal * speed * 3e-6 * 4e-3;
    assert!((rubbed / heat - 1.0).abs() < 0.03, "{rubbed} of {heat}");
}

#[test]
fn a_block_sticks_on_a_slope_that_is_not_steep_enough() {
    // 30 degrees, with a thousand times the weight. The load comes at once: damping ends the bounce.
    let slope = |friction: f64| {
        let text = format!(
            "{BLADE}gravity = [\"4905 m/s^2\", \"-8495.709 m/s^2\"]\n[[wall]]\nname = \"slope\"\n\
             plane = {{ point = [\"0 mm\", \"0.1 mm\"], normal = [0, 1] }}\n\
             contact = {{ penalty = {{ surfaces = \"facets\", friction = {friction}, damping = 1.0 }} }}\n"
        );
        // Keys of the deck itself come before its tables.
        let (gravity, rest) = (text.lines().find(|line| line.starts_with("gravity")).unwrap(), text.clone());
        let text = format!("{gravity}\n{}", rest.replacen(gravity, "", 1));
        simulation(&text, &[("body.block.velocity", "[0, 0]"), ("numerics.viscosity", "true")])
    };
    let speed = |simulation: &Simulation| {
        let total = simulation.ledger().unwrap().total;
        total.momentum[0] / total.mass
    };
    let mut held = slope(0.7);
    run_to(&mut held, 400e-6);
    let before = held.ledger().unwrap().total.centre[0];
    run_to(&mut held, 600e-6);
    // Free it would reach nearly 3 m/s.
    let crept = held.ledger().unwrap().total.centre[0] - before;
    assert!(crept.abs() < 1e-3 * 200e-6 && speed(&held).abs() < 5e-3, "{crept} {}", speed(&held));
    let mut sliding = slope(0.3);
    run_to(&mut sliding, 400e-6);
    let expected = (4905.0 - 0.3 * 8495.709) * 400e-6;
    assert!((speed(&sliding) / expected - 1.0).abs() < 0.02, "{} of {expected}", speed(&sliding));
}

#[test]
fn a_ball_rebounds_by_the_law_of_hertz() {
    // A quarter of an elastic ball of steel at 20 m/s, 20 spacings across.
    let text = r#"
dimensions = "3d"
particles = { spacing = "1 mm" }
time = { end = "40 us" }
symmetry = [{ axis = "x" }, { axis = "y" }]

[material.steel]
density = "7850 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "ball"
material = "steel"
velocity = ["0 m/s", "0 m/s", "-20 m/s"]
shape = { intersection = [
    { sphere = { centre = ["0 mm", "0 mm", "10 mm"], radius = "10 mm" } },
    { box = { min = ["0 mm", "0 mm", "0 mm"], max = ["10 mm", "10 mm", "20 mm"] } },
] }

[[wall]]
name = "anvil"
plane = { point = ["0 mm", "0 mm", "0 mm"], normal = [0, 0, 1] }
"#;
    let (radius, speed) = (10e-3f64, 20.0f64);
    let modulus = 210e9 / (1.0 - 0.09);
    let mass = 7850.0 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    let depth = (15.0 * mass * speed * speed / (16.0 * radius.sqrt() * modulus)).powf(0.4);
    let (peak, duration) = (modulus * radius.sqrt() * depth.powf(1.5) / 3.0, 2.943 * depth / speed);
    let mut simulation = simulation(text, &[]);
    let (mut most, mut times) = (0.0f64, Vec::new());
    while simulation.time() < 40e-6 {
        simulation.step(Some(40e-6)).unwrap();
        let force = simulation.ledger().unwrap().wall_forces[0][2];
        most = most.max(force);
        if force > 3e-3 * peak {
            times.push(simulation.time());
        }
    }
    let lasted = times[times.len() - 1] - times[0];
    assert!(
        (most / peak - 1.0).abs() < 0.1 && (lasted / duration - 1.0).abs() < 0.1,
        "{most} of {peak}, {lasted} of {duration}"
    );
    let ledger = simulation.ledger().unwrap();
    let rebound = ledger.total.momentum[2] / ledger.total.mass;
    assert!(rebound > 0.97 * speed && ledger.walls[0].work.abs() < 0.01 * ledger.total.energies.kinetic, "{rebound}");
}

/// Angular velocity of what slides on a corner, clockwise (rad/s), and its velocity (m/s) after a time: a rigid block of `n` point masses a millimetre apart,
/// under gravity (m/s²) and friction.
fn tipping(n: [f64; 2], speed: f64, gravity: f64, friction: f64, end: f64) -> [f64; 2] {
    let [half_width, half_height] = n.map(|n| 0.5e-3 * n);
    let inertia: f64 = n.iter().map(|n| (n * n - 1.0) * 1e-6 / 12.0).sum();
    let rates = |[angle, turning, _]: [f64; 3]| {
        // From the corner to the centre.
        let across = half_height * angle.sin() - half_width * angle.cos();
        let up = half_height * angle.cos() + half_width * angle.sin();
        let lever = across + friction * up;
        let turns = lever * (gravity - up * turning * turning) / (inertia + lever * across);
        let pressed = gravity - across * turns - up * turning * turning;
        [turning, turns, -friction * pressed]
    };
    let dt = end / 1000.0;
    let mut state = [0.0, 0.0, speed];
    for _ in 0..1000 {
        let moved = |by: [f64; 3], dt: f64| std::array::from_fn(|k| state[k] + dt * by[k]);
        let middle = rates(moved(rates(state), 0.5 * dt));
        state = moved(middle, dt);
    }
    [state[1], state[2]]
}

#[test]
fn what_slides_slowly_on_a_wall_tips_over_its_edge() {
    // By default: walls that push particles would hold it half a spacing inside its edge, and it would tip 17 % too fast.
    let text = r#"
dimensions = "plane-strain"
gravity = ["0 m/s^2", "-1000 m/s^2"]
particles = { spacing = "1 mm" }
numerics = { viscosity = { alpha = 1.0, all-waves = true } }
time = { end = "0.8 ms" }

[material.steel]
density = "8000 kg/m^3"
young-modulus = "200 GPa"
poisson-ratio = 0.3
strength = "elastic"

[[body]]
name = "block"
material = "steel"
shape = { box = { min = ["0 mm", "0 mm"], max = ["5 mm", "20 mm"] } }
velocity = ["4 m/s", "0 m/s"]

[[wall]]
name = "floor"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { friction = 0.5 } }
"#;
    let mut block = simulation(text, &[]);
    run_to(&mut block, 0.8e-3);
    let total = block.ledger().unwrap().total;
    let particles = block.particles().unwrap();
    let (mut angular, mut inertia) = (0.0, 0.0);
    for i in 0..particles.len() {
        let [x, y] = [0, 1].map(|k| particles.position[i][k] - total.centre[k]);
        let [u, v] = [0, 1].map(|k| particles.velocity[i][k] - total.momentum[k] / total.mass);
        angular += x * v - y * u;
        inertia += x * x + y * y;
    }
    let [turning, speed] = tipping([5.0, 20.0], 4.0, 1000.0, 0.5, 0.8e-3);
    let (found, left) = (-angular / inertia, total.momentum[0] / total.mass);
    assert!((found / turning - 1.0).abs() < 0.03, "{found} rad/s of {turning}");
    assert!((left / speed - 1.0).abs() < 0.005, "{left} m/s of {speed}");
}
