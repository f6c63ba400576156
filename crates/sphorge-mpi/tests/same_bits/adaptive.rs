//! Searches of some particles, whose neighbours other ranks may have.

use super::symmetry::{CELL, CORNER};
use super::{Files, column, compare};

/// Searches particles that flow a little or strain a little.
pub(super) const GUARDED: (&str, &str) =
    ("search", "{ adaptive = { plastic-strain-threshold = 1e-5, strain-bound = 5e-4 } }");

/// Fraser's rule, with kept distances.
pub(super) const PUBLISHED: (&str, &str) =
    ("search", "{ adaptive = { plastic-strain-threshold = 1e-5, guard = \"none\" } }");

/// The bullet and its plate, coarse.
pub(super) const COARSE: [(&str, &str); 2] = [("particles.spacing", "\"24 mm\""), ("body.1.spacing", "\"12 mm\"")];

/// Rows of the history in which some particles were searched, and not all.
fn partial_searches(files: &Files) -> usize {
    // The first row, before any step, has none.
    column(files, "searched_fraction")[1..].iter().filter(|fraction| (1e-9..0.999).contains(*fraction)).count()
}

/// Compares runs of a deck of which some steps search some particles.
fn compare_partial(deck: &str, changes: &[(&str, &str)], ranks: &[usize]) {
    let partial = partial_searches(&compare(deck, changes, ranks));
    assert!(partial > 3, "{partial} partial searches of `{deck:.60}` {changes:?}");
}

#[test]
fn a_bullet_in_a_plate() {
    let short = [("time.end", "\"250 us\""), ("output.frames", "2"), ("output.history-interval", "\"5 us\""), GUARDED];
    compare_partial("bullet", &[&COARSE[..], &short].concat(), &[1, 2, 3, 4, 7]);
}

/// Three pieces of one elastic body, each of which several ranks have: the first is whole, spins and has a slot, the others meet.
const PIECES: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
search = { adaptive = { plastic-strain-threshold = 1e-5 } }
particles = { spacing = "0.5 mm" }
numerics = { precision = "double", gradient-correction = "linear" }

[time]
end = "30 us"

[output]
frames = 4
history-interval = "0.3 us"

[material.tough]
base = "armco-iron"
strength = "elastic"

[[body]]
name = "pieces"
material = "tough"
shape.union = [
    { difference = [
        { box = { min = ["0 mm", "0 mm"], max = ["30 mm", "6 mm"] } },
        { box = { min = ["20 mm", "2.5 mm"], max = ["31 mm", "3.5 mm"] } },
    ] },
    { box = { min = ["0 mm", "10 mm"], max = ["30 mm", "14 mm"] } },
    { box = { min = ["0 mm", "16.5 mm"], max = ["30 mm", "20 mm"] } },
]
velocity-profile = { along = "y", amplitude = ["0 m/s", "60 m/s"], rows = [["0 mm", 0], ["15 mm", 0], ["16 mm", -1], ["20 mm", -1]] }

[[measure]]
name = "height"
extent = { body = "pieces", axis = "y" }
"#;

#[test]
fn pieces_of_a_body_that_span_ranks() {
    compare_partial(PIECES, &[], &[2, 3, 4, 7]);
    let soft = PIECES.replace("armco-iron", "ofhc-copper").replace("strength = \"elastic\"", "");
    let accumulating = [("search", "{ adaptive = { plastic-strain-threshold = 1e-3, accumulate = true } }")];
    compare_partial(&soft, &accumulating, &[3]);
}

#[test]
fn the_rule_as_published_with_images_of_images() {
    compare_partial(CORNER, &[PUBLISHED], &[1, 2, 4]);
}

#[test]
fn images_and_a_contact_between_bodies() {
    // So long a corner that its end does not feel the blow.
    let long = [
        ("body.0.shape.box.max", "[\"40 mm\", \"4 mm\"]"),
        ("body.1.shape.box.min", "[\"0 mm\", \"4.4 mm\"]"),
        ("body.0.velocity", "[\"0 m/s\", \"0 m/s\"]"),
        ("time.end", "\"8 us\""),
        ("output.history-interval", "\"0.2 us\""),
        ("contact", "\"penalty\""),
    ];
    compare_partial(CORNER, &[&long[..], &[GUARDED]].concat(), &[2, 3, 4]);
    let calm =
        [("body.0.velocity-profile.amplitude", "[\"100 m/s\", \"0 m/s\"]"), ("output.history-interval", "\"0.2 us\"")];
    compare_partial(CELL, &[&calm[..], &[("search", "\"adaptive\"")]].concat(), &[2, 4]);
}

/// A block that flies at its image in a plane and, out of the periodic cell, at another: contact candidates are found among images of particles of all
/// ranks.
const AT_IMAGES: &str = r#"
dimensions = "plane-strain"
method = "fraser"
particles = { spacing = "0.5 mm" }
time = { end = "16 us" }
output = { history-interval = "1 us" }
periodic = { x = ["0 mm", "24 mm"] }

[[body]]
name = "block"
material = "armco-iron"
shape = { box = { min = ["1 mm", "1.5 mm"], max = ["11 mm", "9.5 mm"] } }
velocity = ["-100 m/s", "-100 m/s"]

[[body]]
name = "target"
material = "armco-iron"
shape = { box = { min = ["13 mm", "1.5 mm"], max = ["23 mm", "9.5 mm"] } }

[[symmetry]]
axis = "y"
at = "0 mm"
side = "positive"
"#;

#[test]
fn contact_candidates_among_images() {
    compare_partial(AT_IMAGES, &[("search", "\"adaptive\"")], &[2, 3, 4]);
}

#[test]
fn neighbours_that_are_not_searched_themselves() {
    // Each particle is searched when it has strained by a few hundredths, its neighbours at other times: their rows, of other ranks and of images, are patched.
    let at_times = ("search", "{ adaptive = { plastic-strain-threshold = 1.0, strain-bound = 0.05 } }");
    let often = ("output.history-interval", "\"0.1 us\"");
    compare_partial(CELL, &[at_times, often], &[2, 3, 5]);
    let heavy = [
        ("body.0.velocity", "[\"0 m/s\", \"0 m/s\"]"),
        ("body.1.material", "\"ofhc-copper\""),
        ("numerics.mls-interval", "5"),
        ("output.frame-interval", "\"1 us\""),
    ];
    compare_partial(CORNER, &[&heavy[..], &[at_times, often]].concat(), &[2, 3]);
}

/// A block whose upper half slides along the lower one, past the borders of ranks, and is never searched whole.
fn sliding() -> (String, [(&'static str, &'static str); 4]) {
    let open = CELL.replace("periodic = { x = [\"0 mm\", \"16 mm\"], y = [\"0 mm\", \"10 mm\"] }", "");
    let sliding = [
        ("body.0.velocity-profile.amplitude", "[\"400 m/s\", \"0 m/s\"]"),
        ("body.0.velocity-profile.rows", "[[\"0 mm\", 0.0], [\"4.2 mm\", 0.0], [\"5.8 mm\", 1.0], [\"10 mm\", 1.0]]"),
        ("search", "{ adaptive = { plastic-strain-threshold = 1.0, strain-bound = 0.02 } }"),
        ("output.history-interval", "\"0.1 us\""),
    ];
    (open, sliding)
}

#[test]
fn neighbours_that_were_no_ghosts() {
    let (open, sliding) = sliding();
    compare_partial(&open, &sliding, &[2, 3, 5]);
}

#[test]
fn ghosts_that_are_chosen_anew_among_others_of_another_mass() {
    // A lid out of reach above the block comes behind it in the order of the cells: its ghosts get other numbers when the block has new ones.
    let (open, sliding) = sliding();
    let lid = "[[body]]\nname = \"lid\"\nmaterial = \"tungsten-alloy-steinberg\"\n\
               shape = { box = { min = [\"0 mm\", \"13 mm\"], max = [\"24 mm\", \"16 mm\"] } }\n\n[[measure]]";
    let restored = [("numerics.mls-interval", "2"), ("numerics.precision", "\"double\"")];
    compare_partial(&open.replacen("[[measure]]", lid, 1), &[&sliding[..], &restored].concat(), &[2, 3, 5]);
}
