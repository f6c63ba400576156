//! Bodies filled with particles, as decks ask for it.

use crate::load_text;
use sphorge_engine::Particles;

fn deck(dimensions: &str, rest: &str) -> Particles {
    let text = format!(
        "dimensions = \"{dimensions}\"\n[particles]\nspacing = 0.5\n[time]\nend = 1\n\
         [material.m]\ndensity = 1000\nyoung-modulus = 1e9\npoisson-ratio = 0.3\nstrength = \"elastic\"\n{rest}"
    );
    match load_text("deck", &text, &[]) {
        Ok(setup) => setup.particles,
        Err(report) => panic!("{:?}", report.problems()),
    }
}

const BOX: &str = "[[body]]\nname = \"b\"\nmaterial = \"m\"\nshape = { box = { min = [0, 0], max = [1, 1] } }\n";

#[test]
fn particles_move_and_turn_as_their_body() {
    let particles = deck("plane-strain", &format!("{BOX}velocity = [3, 0]\nspin = {{ rate = 2, centre = [1, 0] }}\n"));
    assert_eq!(particles.position[1], [0.75, 0.25, 0.0]);
    // v + w x r with w = 2 about z and r = (-0.25, 0.25).
    assert_eq!(particles.velocity[1], [3.0 - 0.5, -0.5, 0.0]);
    assert_eq!((particles.id[3], particles.mass[3], particles.density[3]), (3, 250.0, 1000.0));
    assert_eq!((particles.smoothing_length[0], particles.temperature[0]), (0.6, 293.15));
    // c0 = sqrt(K/rho), K = E/(3 (1 - 2 nu)).
    assert!((particles.sound_speed[0] - (1e9f64 / 1.2 / 1000.0).sqrt()).abs() < 1e-9);
}

#[test]
fn spin_in_space_is_about_its_vector() {
    let body = "[[body]]\nname = \"b\"\nmaterial = \"m\"\nshape = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n";
    let particles = deck("3d", &format!("{body}spin = {{ rate = [0, 4, 0] }}\n"));
    // w = (0, 4, 0), r = (0.25, 0.25, 0.25): w x r = (1, 0, -1).
    assert_eq!(particles.velocity[0], [1.0, 0.0, -1.0]);
    assert_eq!((particles.len(), particles.mass[0]), (8, 125.0));
}

#[test]
fn initial_velocities_vary_in_space_as_asked() {
    let particles = deck(
        "plane-strain",
        &format!(
            "{BOX}velocity = [3, 0]\nvelocity-gradient = {{ rows = [[1, 10], [100, 1000]], centre = [0, 0.75] }}\n\
             velocity-profile = {{ along = \"x\", amplitude = [0, 8], rows = [[0.5, 0], [1, 1]] }}\n"
        ),
    );
    // At (0.75, 0.25), (0.75, -0.5) from the centre, half of the amplitude.
    assert_eq!(particles.position[1], [0.75, 0.25, 0.0]);
    assert_eq!(particles.velocity[1], [3.0 + 0.75 - 5.0, 75.0 - 500.0 + 4.0, 0.0]);
    // At (0.25, 0.25) the profile is what it is at its first row.
    assert_eq!(particles.velocity[0], [3.0 + 0.25 - 5.0, 25.0 - 500.0, 0.0]);
}

#[test]
fn regions_are_bits_of_what_body_and_shape_choose() {
    let regions = "[[region]]\nname = \"left\"\nshape = { box = { min = [0, 0], max = [0.25, 1] } }\n\
                   [[region]]\nname = \"second\"\nbody = \"c\"\n\
                   [[region]]\nname = \"low\"\nbody = \"b\"\nshape = { box = { min = [0, 0], max = [1, 0.5] } }\n";
    let other = BOX.replace("\"b\"", "\"c\"").replace("[0, 0]", "[1, 0]").replace("[1, 1]", "[2, 1]");
    let particles = deck("plane-strain", &format!("{BOX}{other}{regions}"));
    // Particles on the surface of a region belong to it.
    assert_eq!(particles.regions, [0b101, 0b100, 0b001, 0, 0b010, 0b010, 0b010, 0b010]);
    assert_eq!(particles.body, [0, 0, 0, 0, 1, 1, 1, 1]);
}

#[test]
fn a_turned_box_has_a_turned_lattice() {
    let turned =
        BOX.replace("[1, 1] } }", "[1, 1] }, rotate = { angle = \"90 deg\", about = [1, 0] }, shift = [0, 2] }");
    let particles = deck("plane-strain", &turned);
    // (0.25, 0.25) turns about (1, 0) to (0.75, -0.75) and is shifted by 2.
    assert!((particles.position[0][0] - 0.75).abs() < 1e-15 && (particles.position[0][1] - 1.25).abs() < 1e-15);
}

#[test]
fn bodies_of_unlike_spacing_touch_and_overlap() {
    let fine = |min: &str| {
        format!(
            "{BOX}[[body]]\nname = \"fine\"\nmaterial = \"m\"\nspacing = 0.1\n\
             shape = {{ box = {{ min = [{min}, 0], max = [2, 1] }} }}\n"
        )
    };
    assert_eq!(deck("plane-strain", &fine("1")).len(), 4 + 100);
    let text = format!(
        "dimensions = \"plane-strain\"\n[particles]\nspacing = 0.5\n[time]\nend = 1\n\
         [material.m]\nbase = \"armco-iron\"\n{}",
        fine("0.7")
    );
    let Err(report) = load_text("deck", &text, &[]) else { panic!("they overlap") };
    assert_eq!(report.problems()[0].to_string(), "bodies `b` and `fine` overlap");
}
