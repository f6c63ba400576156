//! What a deck says to no effect is told, with its line.

use crate::load_text;

const DECK: &str = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"20 us\" }\n[[body]]\nname = \"bar\"\n\
                    material = \"ofhc-copper\"\nshape = { box = { min = [0, 0], max = [\"6 mm\", \"12 mm\"] } }\n[[region]]\nname = \"top\"\n\
                    shape = { box = { min = [0, \"10 mm\"], max = [\"6 mm\", \"12 mm\"] } }\n";

fn notes(more: &str, changes: &[(&str, &str)]) -> Vec<String> {
    let changes: Vec<_> = changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let setup = load_text("bar", &(DECK.to_owned() + more), &changes);
    setup.unwrap_or_else(|report| panic!("{report:?}")).all_notes()
}

#[track_caller]
fn told(notes: &[String], words: &[&str]) {
    assert!(notes.len() == 1 && words.iter().all(|word| notes[0].contains(word)), "{notes:?}");
}

fn motion(rows: &str) -> String {
    format!("[[motion]]\nregion = \"top\"\nvelocity = [\"free\", {rows}]\n")
}

#[test]
fn tables_whose_times_are_not_those_of_the_run_are_told_with_the_unit_that_is_meant() {
    let of = |rows: &str| notes(&motion(rows), &[]);
    told(
        &of("[[0, 0], [10, 5], [20, 5]]"),
        &[
            "line 13: ",
            "motion of region `top` has hardly begun by the end",
            "after the start is 10 s",
            "ends at 20 us; is \"10 us\" meant?",
        ],
    );
    told(&of("[[5, 0], [\"10 s\", 5]]"), &["has no effect: its first time is 5 s", "is \"5 us\" meant?"]);
    told(&of("[[\"5 ms\", 0], [\"9 ms\", 5]]"), &["is \"5 us\" meant?"]);
    told(&of("[[0, 0], [\"10 ns\", 5]]"), &["is over at 10 ns", "ends at 20 us", "is \"10 us\" meant?"]);
    // A ramp longer than the run, one that is fast, a constant, and a pulse that is over soon.
    for rows in [
        "[[0, 0], [\"1 ms\", 5]]",
        "[[0, 0], [\"0.1 us\", 5]]",
        "[[0, 5], [10, 5]]",
        "[[0, 0], [\"5 us\", 5], [10, 5]]",
    ] {
        assert_eq!(of(rows), [""; 0], "{rows}");
    }
    // Who stops by the kinetic energy may give any end.
    assert_eq!(notes(&motion("[[0, 0], [\"10 ns\", 5]]"), &[("time.stop-kinetic-fraction", "0.1")]), [""; 0]);
    let wall = "[[wall]]\nname = \"ram\"\nplane = { point = [0, \"12 mm\"], normal = [0, -1] }\nvelocity = [0, [[0, 0], [10, -5]]]\n";
    told(&notes(&(motion("0") + wall), &[]), &["line 17: the table of wall `ram` has hardly begun"]);
}

#[test]
fn a_motion_that_is_free_in_all_components_is_told() {
    let free = "[[motion]]\nregion = \"top\"\nvelocity = [\"free\", \"free\"]\n";
    let told = notes(
        &(free.to_owned()
            + "[[wall]]\nname = \"ram\"\nplane = { point = [0, \"12 mm\"], normal = [0, -1] }\nvelocity = [0, -5]\n"),
        &[],
    );
    assert!(
        told.len() == 1 && told[0].starts_with("line 12: all components of the motion of region `top` are free"),
        "{told:?}"
    );
    assert_eq!(notes(&motion("5"), &[]), [""; 0]);
}

#[test]
fn outputs_longer_than_the_run_are_told() {
    let of = |key: &str, value: &str| notes(&format!("{}[output]\n{key} = {value}\n", motion("5")), &[]);
    told(
        &of("history-interval", "0.5"),
        &[
            "line 15: `output.history-interval` is 500 ms, and the run ends at 20 us",
            "rows of the history",
            "is \"500 ns\" meant?",
        ],
    );
    told(
        &of("frame-interval", "\"30 us\""),
        &["`output.frame-interval` is 30 us", "the only frames", "is \"30 ns\" meant?"],
    );
    for (key, value) in [("history-interval", "\"20 us\""), ("frame-interval", "\"20 us\""), ("frames", "1")] {
        assert_eq!(of(key, value), [""; 0], "{key}");
    }
}

#[test]
fn what_would_move_bodies_that_stay_is_told_once() {
    let still = |more: &str, changes: &[(&str, &str)]| {
        let heat = "[thermal]\nmechanics = false\n[[thermal.boundary]]\nname = \"hot\"\nregion = \"top\"\nhold = 400\n[material.ofhc-copper]\nconductivity = 400\n";
        // Long enough for heat to get from one particle to the next.
        notes(&format!("{heat}{more}"), &[changes, &[("time.end", "1")]].concat())
    };
    assert_eq!(still("", &[]), [""; 0]);
    assert_eq!(still(&motion("0"), &[]), [""; 0]);
    told(
        &still("", &[("body.bar.velocity", "[0, -5]")]),
        &["with `thermal.mechanics = false` bodies stay where they are: the velocity of body `bar` has no effect"],
    );
    let wall = "[[wall]]\nname = \"ram\"\nplane = { point = [0, \"12 mm\"], normal = [0, -1] }\nvelocity = [0, -5]\n";
    told(
        &still(&(motion("5") + wall), &[]),
        &["line 12: ", "the motion of region `top` and the velocity of wall `ram` have no effect"],
    );
    told(&still("", &[("gravity", "[0, -9.81]")]), &["`gravity` has no effect"]);
}

#[test]
fn notes_name_the_line_of_what_they_are_about_unless_keys_that_are_set_move_the_lines() {
    let own = "[material.m]\nbase = \"ofhc-copper\"\nspall-pressure = 1.2\nstrength = { johnson-cook = { B = 300 } }\n";
    let of = |changes: &[(&str, &str)]| notes(&(motion("5") + own), changes);
    let told = of(&[("body.bar.material", "m")]);
    assert!(told.len() == 2 && told[0].starts_with("line 17: material `m`: `B`"), "{told:?}");
    assert!(told[1].starts_with("line 16: material `m`: `spall-pressure`"), "{told:?}");
    let moved = of(&[("body.bar.material", "m"), ("title", "a")]);
    assert!(moved.len() == 2 && moved.iter().all(|note| note.starts_with("material `m`")), "{moved:?}");
    let flies = notes("", &[("body.bar.material", "armco-iron")]);
    assert!(
        flies.len() == 2 && flies[1].starts_with("line 9: no motion, measure") && flies[0].starts_with("nothing moves"),
        "{flies:?}"
    );
    let section = motion("5") + "[[section]]\nname = \"cut\"\npoint = [0, \"90 mm\"]\nnormal = [0, 1]\n";
    assert!(notes(&section, &[])[0].starts_with("line 15: section `cut` cuts no body"));
    let thrown = DECK.replace("material = \"ofhc", "velocity = [\"300 km/s\", 0]\nmaterial = \"ofhc");
    let thrown = load_text("bar", &thrown, &[]).unwrap().all_notes();
    assert!(thrown.iter().any(|note| note.starts_with("line 6: body `bar` starts with 3e5 m/s")), "{thrown:?}");
}
