//! Forces through sections.

use super::{compare, contact::CLAMP, symmetry::CORNER};

#[test]
fn a_strip_that_is_pulled() {
    let changes = [
        ("time.end", "\"30 us\""),
        ("output.frames", "2"),
        ("output.history-interval", "\"2 us\""),
        // Its middle, where particles are of several ranks.
        ("section.0.point", "[\"0.1 mm\", \"0 mm\"]"),
        ("section.0.normal", "[0.6, 0.8]"),
    ];
    compare("pulled", &changes, &[1, 2, 3, 4, 5, 7]);
}

#[test]
fn sections_through_contacts_and_along_planes_of_symmetry() {
    let through = r#"
[[section]]
name = "through"
point = ["20.4 mm", "6 mm"]
normal = [1, 0.1]

[[section]]
name = "slot"
point = ["0 mm", "5.6 mm"]
normal = [0, 1]
body = "clamp"
"#;
    compare(&format!("{CLAMP}{through}"), &[], &[2, 3, 5]);
    // The middle of a step is where forces are; images across the plane count otherwise than those along it.
    let along = r#"
[[section]]
name = "face"
point = ["0.2 mm", "0 mm"]
normal = [1, 0]

[[section]]
name = "slanting"
point = ["3 mm", "5 mm"]
normal = [0.3, 1]
"#;
    compare(&format!("{CORNER}{along}"), &[], &[3, 4]);
    compare(&format!("{CORNER}{along}"), &[("contact", "\"penalty\"")], &[2]);
}
