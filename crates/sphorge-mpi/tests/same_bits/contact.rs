//! Contact between bodies, and of a body with itself.

use super::compare;

/// A clamp of iron whose slot is pressed shut, struck by a steel pin of a finer lattice that slides along it.
pub(super) const CLAMP: &str = r#"
dimensions = "plane-strain"
search = { total-lagrangian = { renewal = 0 } }
particles = { spacing = "0.5 mm" }
contact = { penalty = { friction = 0.2 } }

[time]
end = "10 us"

[output]
frame-interval = "5 us"
history-interval = "0.5 us"

[[body]]
name = "clamp"
material = "armco-iron"
shape.difference = [
    { box = { min = ["0 mm", "0 mm"], max = ["20 mm", "12 mm"] } },
    { box = { min = ["-1 mm", "5 mm"], max = ["14 mm", "6 mm"] } },
]

[[body]]
name = "pin"
material = "42crmo4-steel"
spacing = "0.4 mm"
shape = { box = { min = ["21 mm", "2 mm"], max = ["25 mm", "10 mm"] } }
velocity = ["-200 m/s", "60 m/s"]

[[region]]
name = "jaw"
body = "clamp"
shape = { box = { min = ["0 mm", "11 mm"], max = ["10 mm", "12 mm"] } }

[[motion]]
region = "jaw"
velocity = ["free", "-250 m/s"]

[[wall]]
name = "table"
plane = { point = ["0 mm", "-0.3 mm"], normal = [0, 1] }

[[measure]]
name = "width"
extent = { body = "clamp", axis = "x" }
"#;

#[test]
fn a_clamp_that_is_pressed_shut_and_struck() {
    compare(CLAMP, &[], &[1, 2, 3, 4, 5, 7]);
}

#[test]
fn one_body_that_meets_itself_and_comes_apart() {
    // The surface alone is searched where there is one body, and what its contact holds turns to heat when it comes apart.
    let changes = [("numerics.precision", "\"double\""), ("search.total-lagrangian.renewal", "1.5")];
    compare(&without_pin(), &changes, &[2, 3, 5]);
}

/// The clamp alone.
fn without_pin() -> String {
    let (before, rest) = CLAMP.split_once("[[body]]\nname = \"pin\"").unwrap();
    let (_, after) = rest.split_once("[[region]]").unwrap();
    format!("{before}[[region]]{after}")
}

#[test]
fn shipped_decks_of_the_default_method() {
    let short = |end| [("time.end", end), ("output.frames", "2"), ("output.history-interval", "\"2 us\"")];
    compare("iron-plate", &short("\"20 us\""), &[2, 5]);
    let coarse =
        [("particles.spacing", "\"0.5 mm\""), ("method", "\"total-lagrangian\""), ("search", "\"total-lagrangian\"")];
    compare("penetration", &[&coarse[..], &short("\"6 us\"")].concat(), &[3]);
}

#[test]
fn bodies_of_the_present_configuration_in_a_contact_of_their_own() {
    // Smoothing lengths follow the density: those of the contact are searched for all the same.
    let changes = [
        ("particles.spacing", "\"24 mm\""),
        ("body.1.spacing", "\"12 mm\""),
        ("contact", "{ penalty = { friction = 0.1 } }"),
        ("numerics.smoothing-length", "\"follow-density\""),
        ("time.end", "\"200 us\""),
        ("output.frames", "2"),
    ];
    compare("bullet", &changes, &[2, 5]);
}
