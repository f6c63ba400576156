//! Images in planes of symmetry and beyond periodic ends, of particles of one rank that another one reads.

use super::compare;

#[test]
fn a_quarter_of_a_bar_of_the_default_method_on_a_plane_of_symmetry() {
    let changes = [
        ("particles.spacing", "\"0.635 mm\""),
        ("time.end", "\"20 us\""),
        ("output.frames", "2"),
        ("output.history-interval", "\"1 us\""),
    ];
    compare("copper-bar", &changes, &[1, 2, 3, 4, 5, 7]);
}

#[test]
fn a_bar_in_which_viscosity_acts_in_shocks() {
    let changes = [
        ("particles.spacing", "\"0.635 mm\""),
        ("time.end", "\"4 us\""),
        ("output.frames", "2"),
        ("output.history-interval", "\"1 us\""),
        ("numerics.viscosity.shocks", "1.0"),
    ];
    compare("copper-bar", &changes, &[1, 2, 3, 5]);
}

/// A block in a corner between planes, struck along one of them, in the present configuration; the corner has images of images.
pub(super) const CORNER: &str = r#"
dimensions = "plane-strain"
method = "patino"
search = "every-step"
particles = { spacing = "0.4 mm" }

[time]
end = "12 us"

[output]
frame-interval = "4 us"
history-interval = "1 us"

[[body]]
name = "corner"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["8 mm", "8 mm"] } }
velocity = ["-120 m/s", "-200 m/s"]

[[body]]
name = "striker"
material = "42crmo4-steel"
shape = { box = { min = ["0 mm", "8.4 mm"], max = ["5.6 mm", "14 mm"] } }
velocity = ["0 m/s", "-400 m/s"]

[[symmetry]]
axis = "x"

[[symmetry]]
axis = "y"

[[measure]]
name = "height"
extent = { body = "corner", axis = "y" }
"#;

#[test]
fn a_corner_between_planes_in_the_present_configuration() {
    compare(CORNER, &[], &[1, 2, 3, 4]);
    let corrected = [
        ("search", "\"skin\""),
        ("numerics.gradient-correction", "\"linear\""),
        ("numerics.precision", "\"double\""),
        ("contact", "\"penalty\""),
    ];
    compare(CORNER, &corrected, &[3]);
}

/// A bar in the total Lagrangian form whose foot spreads along a plane of symmetry and meets its image again.
pub(super) const FOLDED: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }

[time]
end = "16 us"

[output]
frame-interval = "8 us"
history-interval = "1 us"

[[body]]
name = "arch"
material = "ofhc-copper"
shape.difference = [
    { box = { min = ["0 mm", "0 mm"], max = ["10 mm", "20 mm"] } },
    { box = { min = ["-1 mm", "-1 mm"], max = ["1 mm", "15 mm"] } },
]

[[symmetry]]
axis = "x"

[[region]]
name = "flank"
body = "arch"
shape = { box = { min = ["9 mm", "0 mm"], max = ["10 mm", "8 mm"] } }

[[motion]]
region = "flank"
velocity = ["-250 m/s", "free"]

[[measure]]
name = "width"
extent = { body = "arch", axis = "x" }
"#;

#[test]
fn a_slot_that_closes_on_its_image() {
    compare(FOLDED, &[], &[2, 3, 5]);
}

/// A cell, periodic along both axes, with material of two speeds that goes round.
pub(super) const CELL: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
search = "skin"
particles = { spacing = "0.5 mm" }
periodic = { x = ["0 mm", "16 mm"], y = ["0 mm", "10 mm"] }

[time]
end = "20 us"

[output]
frame-interval = "10 us"
history-interval = "1 us"

[[body]]
name = "metal"
material = "ofhc-copper"
shape = { box = { min = ["0 mm", "0 mm"], max = ["16 mm", "10 mm"] } }
velocity-profile = { along = "y", amplitude = ["400 m/s", "90 m/s"], rows = [["0 mm", 0.5], ["5 mm", 1.0], ["10 mm", 0.5]] }

[[measure]]
name = "strain"
mean = { body = "metal", field = "plastic_strain" }
"#;

#[test]
fn a_periodic_cell_whose_particles_go_round() {
    compare(CELL, &[], &[1, 2, 4]);
}
