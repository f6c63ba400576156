//! What has broken off in a run: printed, as JSON and as CSV.

mod common;

use common::Place;
use std::fs;

/// A strip whose ends are drawn apart, of a metal that breaks at a small strain.
const TORN: &str = r#"
title = "Strip that is torn"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
time = { end = "40 us" }
output = { frames = 4 }

[material.weak]
base = "armco-iron"
damage = { failure-strain = { strain = 0.05 } }

[[body]]
name = "strip"
material = "weak"
shape = { box = { min = ["-12 mm", 0], max = ["12 mm", "6 mm"] } }

[[region]]
name = "right"
shape = { box = { min = ["6 mm", "-1 mm"], max = ["13 mm", "7 mm"] } }
body = "strip"

[[region]]
name = "left"
shape = { box = { min = ["-13 mm", "-1 mm"], max = ["-6 mm", "7 mm"] } }
body = "strip"

[[motion]]
region = "right"
velocity = ["60 m/s", 0]

[[motion]]
region = "left"
velocity = ["-60 m/s", 0]
"#;

#[test]
fn pieces_of_a_torn_strip_are_listed() {
    let place = Place::new();
    fs::write(place.path("torn.toml"), TORN).unwrap();
    place.run(&["run", "torn.toml", "-o", "torn"]).expect_code(0);
    let first = place.run(&["fragments", "torn", "--frame", "first", "--json"]).expect_code(0);
    let first: serde_json::Value = serde_json::from_str(&first.out).unwrap();
    assert_eq!((first[0]["fragments"].as_array().unwrap().len(), &first[0]["frame"]), (1, &0.into()));
    let whole = first[0]["fragments"][0]["mass"].as_f64().unwrap();
    let last = place.run(&["fragments", "torn", "--json", "--body", "strip"]).expect_code(0);
    let last: serde_json::Value = serde_json::from_str(&last.out).unwrap();
    let of = |name: &str| -> Vec<f64> {
        let all = last[0]["fragments"].as_array().unwrap().iter();
        all.map(|of| if name == "mass" { of[name].as_f64().unwrap() } else { of[name][0].as_f64().unwrap() }).collect()
    };
    let (mass, velocity, position) = (of("mass"), of("velocity"), of("position"));
    // It breaks beside both grips: two ends that are alike fly with them, and the middle stays.
    assert_eq!(mass.len(), 3, "{last}");
    assert!((mass[0] / mass[1] - 1.0).abs() < 1e-9 && mass[0] > 0.2 * whole, "{last}");
    let loose = last[0]["loose"][0]["mass"].as_f64().unwrap();
    assert!(loose > 0.0 && (mass.iter().sum::<f64>() + loose - whole).abs() < 1e-9 * whole, "{last}");
    assert!([0, 1].iter().all(|&k| (velocity[k] / (60.0 * position[k].signum()) - 1.0).abs() < 0.01), "{last}");
    assert!(velocity[2].abs() < 1e-3 && velocity[0] * velocity[1] < 0.0, "{last}");
    let printed = place.run(&["fragments", "torn", "--most", "1", "--frame", "all", "--csv", "f.csv"]).expect_code(0);
    assert!(
        printed.out.contains("2 lighter fragments, ") && printed.out.contains("are part of no fragment"),
        "{}",
        printed.out
    );
    let table = fs::read_to_string(place.path("f.csv")).unwrap();
    let frames = fs::read_dir(place.path("torn/fields")).unwrap().count();
    let named = |frame: usize| table.lines().filter(|line| line.starts_with(&format!("{frame},"))).count();
    assert_eq!((named(0), named(frames - 1), named(frames)), (1, 4, 0), "{table}");
    assert!(table.starts_with("frame,time (s),fragment,body,particles,mass (kg/m),"), "{table}");
    // The last line is what is part of none.
    let named = table.lines().last().unwrap().split(',').nth(2);
    assert_eq!(named, Some(""), "{table}");
    place
        .run(&["fragments", "torn", "--body", "srtip"])
        .expect_code(2)
        .expect_told(&["no body `srtip`", "did you mean `strip`?"]);
    place.run(&["fragments", "torn", "--frame", "99"]).expect_code(2).expect_told(&["99"]);
    place.run(&["fragments", "torn", "--frame=-1"]).expect_code(2).expect_told(&["count from zero"]);
    place.run(&["fragments", "torn", "--csv", "torn"]).expect_code(2).expect_told(&["name a file in it"]);
    // Frames without the deformation, and without the body, which is the only one.
    let run = ["run", "torn.toml", "-o", "lean", "--set", "output.fields=[\"velocity\",\"integrity\"]"];
    place.run(&run).expect_code(0);
    let lean = place.run(&["fragments", "lean", "--json"]).expect_code(0);
    lean.expect_told(&["no field `deformation_gradient`"]);
    let lean: serde_json::Value = serde_json::from_str(&lean.out).unwrap();
    assert!(lean[0]["notes"].as_array().unwrap().len() == 1 && lean[0]["mass_unit"] == "kg/m", "{lean}");
    // Frames without what is needed say what to do.
    for (fields, missing) in [("body\",\"integrity", "velocity"), ("body\",\"velocity", "integrity")] {
        let fields = format!("output.fields=[\"{fields}\"]");
        let run = ["run", "torn.toml", "-o", missing, "--set", &fields, "--set", "time.max-steps=2"];
        place.run(&run).expect_code(0);
        let named = format!("no field `{missing}`");
        place.run(&["fragments", missing]).expect_code(2).expect_told(&[&named, "output.fields"]);
    }
}
