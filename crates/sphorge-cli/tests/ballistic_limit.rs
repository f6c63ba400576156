//! `ballistic-limit`: the speed at which a punch gets through a strip.

mod common;

use common::{Ended, Place};
use std::fs;

/// A punch through a strip that breaks early, held at its ends: 228 particles, some 1500 steps.
const STRIP: &str = r#"title = "A punch through a strip"
dimensions = "plane-strain"

[particles]
spacing = "1 mm"

[time]
end = "80 us"

[output]
frames = 1
history-interval = "1 us"

[material.brittle]
base = "weldox-460-e"
damage = { failure-strain = { strain = 0.1 } }

[[body]]
name = "strip"
material = "brittle"
shape = { box = { min = ["-24 mm", "-4 mm"], max = ["24 mm", "0 mm"] } }

[[body]]
name = "punch"
material = "armco-iron"
shape = { box = { min = ["-3 mm", "0 mm"], max = ["3 mm", "6 mm"] } }
velocity = ["0 m/s", "-150 m/s"]

[[region]]
name = "left"
shape = { box = { min = ["-25 mm", "-5 mm"], max = ["-20 mm", "0 mm"] } }

[[region]]
name = "right"
shape = { box = { min = ["20 mm", "-5 mm"], max = ["25 mm", "0 mm"] } }

[[motion]]
region = "left"
velocity = ["0 m/s", "0 m/s"]

[[motion]]
region = "right"
velocity = ["0 m/s", "0 m/s"]

[[measure]]
name = "residual"
mean = { body = "punch", field = "velocity", component = "y" }

[[measure]]
name = "speed"
mean = { body = "punch", field = "speed" }

[[measure]]
name = "aside"
mean = { body = "punch", field = "velocity", component = "x" }

[[measure]]
name = "strip_mass"
fragments = { body = "strip", of = "largest" }
"#;

fn place() -> Place {
    let place = Place::new();
    fs::write(place.path("strip.toml"), STRIP).unwrap();
    place
}

const SEARCH: [&str; 14] = [
    "ballistic-limit",
    "strip.toml",
    "-o",
    "b",
    "--from",
    "100 m/s",
    "--to",
    "400 m/s",
    "--within",
    "100 m/s",
    "--exponent",
    "2",
    "--at",
    "300 m/s,350 m/s",
];

fn json(ended: &Ended) -> serde_json::Value {
    serde_json::from_str(&ended.out).unwrap_or_else(|error| panic!("{error}: {}", ended.out))
}

#[test]
fn a_limit_is_bracketed_and_its_curve_drawn() {
    let place = place();
    let ended = place.run(&[&SEARCH[..], &["--threads", "1", "--format", "svg"]].concat()).expect_code(0);
    for shown in
        ["100 m/s", "400 m/s", "stopped", "through", "limit ", "curve ", "strip_mass", "b: ballistic-limit.csv"]
    {
        assert!(ended.out.contains(shown), "`{shown}` is not in:\n{}", ended.out);
    }
    let picture = fs::read_to_string(place.path("b/plots/ballistic-limit.svg")).unwrap();
    for shown in ["impact velocity", "residual velocity", "limit", "runs"] {
        assert!(picture.contains(shown), "`{shown}` is not in the picture");
    }
    // The same again makes no run, and more speeds only what is missing.
    let again = place.run(&[&SEARCH[..], &["--json"]].concat()).expect_code(0);
    assert!(!again.err.contains("begins"), "{}", again.err);
    let found = json(&again);
    let [stopped, through] = ["stopped", "through"].map(|end| found["bracket"][end].as_f64().unwrap());
    assert!(stopped < through && through - stopped <= 100.0 && found["is_found"] == true, "{found}");
    assert_eq!(found["limit"].as_f64().unwrap(), 0.5 * (stopped + through));
    assert_eq!(found["residual"], "residual");
    let curve = &found["curve"];
    assert!(curve["p"] == 2.0 && curve["is_exponent_held"] == true, "{curve}");
    assert!((stopped..=through).contains(&curve["limit"].as_f64().unwrap()), "{curve}");
    let runs = found["runs"].as_array().unwrap();
    let count = runs.iter().filter(|run| run["outcome"] == "through").count();
    assert!(count > 2 && curve["runs"] == count, "{curve}");
    for run in runs {
        let [speed, residual, target] =
            ["impact_velocity", "residual_velocity", "target_velocity"].map(|of| run[of].as_f64().unwrap());
        // Along the flight, which is downwards; what is through flies ahead of the strip.
        let summary = place.summary(&format!("b/{}", run["run"].as_str().unwrap()));
        assert_eq!(residual, -summary["measures"]["residual"].as_f64().unwrap());
        let outcome = if speed >= through { "through" } else { "stopped" };
        assert_eq!(run["outcome"], outcome, "{run}");
        assert_eq!(residual - target > 0.02 * speed, outcome == "through", "{run}");
    }
    let lines: Vec<String> =
        fs::read_to_string(place.path("b/ballistic-limit.csv")).unwrap().lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), runs.len() + 1);
    assert!(lines[0].starts_with("impact_velocity (m/s),residual_velocity (m/s),outcome,curve (m/s)"), "{}", lines[0]);
    assert!(lines[1].starts_with("100,") && lines[1].contains(",stopped,0,"), "{}", lines[1]);
    assert!(fs::read_to_string(place.path("b/sweep.csv")).unwrap().contains("body.punch.velocity.1 (m/s)"));
    // All that are there count, those that the search chose itself, too.
    let more = place.run(&[&SEARCH[..], &["--at", "220 m/s", "-j", "2", "--json"]].concat()).expect_code(0);
    assert!(more.err.contains(&format!("{} of them are there", runs.len())), "{}", more.err);
    assert!(json(&more)["bracket"]["stopped"].as_f64().unwrap() >= 220.0, "{}", more.out);
    // All again: each run once.
    let anew = place.run(&[&SEARCH[..], &["--overwrite", "--json"]].concat()).expect_code(0);
    assert_eq!(anew.err.matches("begins").count(), runs.len(), "{}", anew.err);
    assert_eq!(json(&anew), found);
}

#[test]
fn a_limit_beyond_a_bound_is_told_with_the_bound_to_move() {
    let place = place();
    let search = |from: &str, to: &str, out: &str| {
        place
            .run(&[
                "ballistic-limit",
                "strip.toml",
                "-q",
                "-o",
                out,
                "--from",
                from,
                "--to",
                to,
                "--set",
                "time.end=60 us",
            ])
            .expect_code(1)
    };
    let slow = search("20 m/s", "40 m/s", "slow");
    assert!(slow.out.contains("the limit is above 40 m/s; give a larger `--to`"), "{}", slow.out);
    assert!(slow.out.contains("not bracketed") && slow.out.contains("curve   none"), "{}", slow.out);
    let fast = search("400 m/s", "500 m/s", "fast");
    assert!(fast.out.contains("the limit is below 400 m/s; give a smaller `--from`"), "{}", fast.out);
}

#[test]
fn runs_that_do_not_tell_are_listed_and_not_used() {
    let place = place();
    let search = |set: &str, out: &str| {
        let search =
            ["ballistic-limit", "strip.toml", "-q", "-o", out, "--at", "300 m/s,350 m/s", "--set", set, "--json"];
        json(&place.run(&search).expect_code(1))
    };
    // It still slows down; it has not struck; its step is beyond the stable one.
    for (set, out, outcome, why) in [
        ("time.end=\"2 us\"", "short", "open", "lengthen `time.end`"),
        (
            "body.punch.shape={ box = { min = [\"-3 mm\", \"200 mm\"], max = [\"3 mm\", \"206 mm\"] } }",
            "far",
            "open",
            "has lost nothing of its speed",
        ),
        ("time.fixed-step=\"1 us\"", "failed", "failed", "is failed"),
    ] {
        let found = search(set, out);
        let runs = found["runs"].as_array().unwrap();
        assert!(runs.len() == 2 && runs.iter().all(|run| run["outcome"] == outcome), "{found}");
        assert!(found["bracket"].is_null() && found["is_found"] == false && found["curve"].is_null());
        let notes: Vec<&str> = found["notes"].as_array().unwrap().iter().map(|note| note.as_str().unwrap()).collect();
        assert!(notes.iter().any(|note| note.starts_with("300 m/s: ") && note.contains(why)), "{notes:?}");
        assert!(notes.contains(&"no run tells whether it got through"), "{notes:?}");
    }
}

#[test]
fn runs_are_listed_and_what_is_wrong_is_told_before_the_first_one() {
    let place = place();
    let listed = place.run(&[&SEARCH[..], &["--dry-run", "--json"]].concat()).expect_code(0);
    assert_eq!(json(&listed)["runs"][0]["planned"], "run");
    let listed = place.run(&[&SEARCH[..], &["--dry-run"]].concat()).expect_code(0).out;
    assert_eq!(listed.lines().next(), Some("run        b/body.punch.velocity.1=-100m_s"));
    assert_eq!(listed.lines().count(), 4);
    let search = |arguments: &[&str]| {
        place.run(&[&["ballistic-limit", "strip.toml", "-o", "b"], arguments].concat()).expect_code(2)
    };
    search(&["--body", "strip"]).expect_told(&["the body `strip` has no velocity", "what moves is `punch`"]);
    search(&["--body", "punsh"]).expect_told(&["no body `punsh`", "did you mean `punch`?"]);
    search(&["--residual", "residaul"]).expect_told(&["no measure `residaul`", "did you mean `residual`?"]);
    search(&["--residual", "speed"]).expect_told(&["`speed` is no velocity along y", "choose `residual`"]);
    search(&["--residual", "aside"]).expect_told(&["`aside` is the velocity along x", "choose `residual`"]);
    search(&["--set", "measure.aside.mean.component=y"])
        .expect_told(&["several measures of the velocity", "`residual`, `aside`"]);
    search(&["--set", "measure.residual.mean.component=x"])
        .expect_told(&["no measure of the velocity along y", "component = \"y\""]);
    search(&["--set", "body.punch.velocity.0=10"]).expect_told(&["`punch` does not fly along an axis"]);
    search(&["--set", "body.strip.velocity=[0, 5]"])
        .expect_told(&["`strip` and `punch` do not have the same velocity", "`--body`"]);
    search(&["--set", "body.punch.velocity=[0, 0]"]).expect_told(&["no body of the deck has a velocity"]);
    search(&["--from", "-3 m/s"]).expect_told(&["`--from -3 m/s`: it is not above zero"]);
    search(&["--from", "300 m/s", "--to", "0.2 km/s"])
        .expect_told(&["from 300 m/s to 200 m/s", "`--from` below `--to`"]);
    search(&["--exponent", "0.5"]).expect_told(&["the exponent of the curve is not between 1 and 10"]);
    search(&["--at", "1,2,3", "--runs", "2"]).expect_told(&["3 speeds are asked for, and 2 runs allowed", "`--runs`"]);
    search(&["--set", "body.punch.velocity.1=-100", "--body", "punch"]).expect_told(&["is set and varied"]);
    assert!(!place.path("b").exists());
}
