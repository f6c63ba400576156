//! The commands beside `run`, and the program as a whole.

mod common;

use common::Place;
use std::{fs, process::Stdio};

#[test]
fn check_says_what_a_deck_would_do_and_writes_nothing() {
    let place = Place::new();
    let ended = place.run(&["check", "plate.toml"]).expect_code(0);
    for text in ["plate", "armco-iron", "192", "1.5149 kg/m", "first time step", "sound-speed", "memory", "run time"] {
        assert!(ended.out.contains(text), "`{text}` is not in:\n{}", ended.out);
    }
    assert!(!place.path("out").exists());
}

#[test]
fn many_faults_and_long_words_are_told_in_short() {
    let place = Place::new();
    let keys: String = (0..2000).map(|k| format!("wrong-{k} = 1\n")).collect();
    fs::write(place.path("many.toml"), keys).unwrap();
    let ended = place.run(&["check", "many.toml"]).expect_code(2);
    ended.expect_told(&["2003 faults in many.toml, the first 20 are", "many.toml:10:1"]);
    assert!(!ended.err.contains("many.toml:21:1") && ended.err.len() < 20_000, "{}", ended.err.len());

    fs::write(place.path("long.toml"), format!("a = 1\n{} = 1\n", "b".repeat(1_000_000))).unwrap();
    let ended = place.run(&["check", "long.toml"]).expect_code(2);
    ended.expect_told(&["line 2: "]);
    assert!(ended.err.len() < 10_000, "{}", ended.err.len());
}

#[cfg(unix)]
#[test]
fn what_never_ends_is_not_read() {
    let place = Place::new();
    place.run(&["check", "/dev/zero"]).expect_code(2).expect_told(&["cannot read `/dev/zero`", "longer than 8 MB"]);
    let cloud = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"1 us\" }\n\
                 [[body]]\nname = \"a\"\nmaterial = \"ofhc-copper\"\nshape = { table = { file = \"/dev/zero\", length-unit = \"mm\" } }\n";
    fs::write(place.path("cloud.toml"), cloud).unwrap();
    place.run(&["check", "cloud.toml"]).expect_code(2).expect_told(&["is not a regular file"]);
}

#[test]
fn a_run_that_nobody_waits_for_is_told_in_numbers_that_hold() {
    let place = Place::new();
    let line = |ended: &common::Ended, what: &str| {
        ended.out.lines().find(|line| line.starts_with(what)).unwrap_or_else(|| panic!("{}", ended.out)).to_owned()
    };
    let ended = place.run(&["check", "plate.toml", "--set", "time.courant=1e-290"]).expect_code(0);
    ended.expect_told(&["the run would take more than a year"]);
    let (steps, time) = (line(&ended, "expected steps"), line(&ended, "run time"));
    assert!(steps.contains("e29") && time.contains("e28") && time.contains("days"), "{steps}\n{time}");
    let endless = ["--set", "time.courant=1e-307", "--set", "time.end=\"1 s\""];
    let ended = place.run(&[["check", "plate.toml"].as_slice(), &endless].concat()).expect_code(0);
    ended.expect_told(&["the run would take more than a year"]);
    let (steps, time) = (line(&ended, "expected steps"), line(&ended, "run time"));
    assert!(steps.contains("  more than 1e308") && time.contains("  endless"), "{steps}\n{time}");
}

#[test]
fn a_deck_that_cannot_take_a_step_fails_the_check() {
    let place = Place::new();
    let ended = place.run(&["check", "plate.toml", "--set", "time.fixed-step=\"1 us\""]).expect_code(2);
    ended.expect_told(&["fixed-step"]);
}

#[test]
fn shipped_decks_run_by_name_from_anywhere() {
    let place = Place::new();
    let listed = place.run(&["decks"]).expect_code(0).out;
    assert!(listed.contains("block"), "{listed}");
    let text = place.run(&["decks", "block"]).expect_code(0).out;
    // The line for editors, then the deck as it is shipped.
    let (first, rest) = text.split_once('\n').unwrap();
    assert_eq!(first, "#:schema deck.schema.json");
    assert_eq!(rest, include_str!("../../../decks/block.toml"));
    fs::write(place.path("own.toml"), &text).unwrap();
    place.run(&["check", "own.toml"]).expect_code(0);
    place.run(&["run", "block", "--set", "particles.spacing=\"10 mm\"", "--set", "time.max-steps=2"]).expect_code(0);
    assert_eq!(place.summary("out/block")["end_reason"], "max-steps");
    place.run(&["decks", "blok"]).expect_code(2).expect_told(&["no shipped deck `blok`"]);
    place.run(&["run", "blok"]).expect_code(2).expect_told(&["there is no deck `blok`", "did you mean", "block"]);
    // A path is a path: the folder matters.
    place.run(&["run", "decks/block.toml"]).expect_code(2).expect_told(&["there is no deck"]);
}

#[test]
fn materials_are_listed_and_shown() {
    let place = Place::new();
    assert!(place.run(&["materials"]).expect_code(0).out.contains("armco-iron"));
    let shown = place.run(&["materials", "armco-iron"]).expect_code(0).out;
    for text in ["80 GPa", "175 MPa", "johnson-cook", "Patiño"] {
        assert!(shown.contains(text), "`{text}` is not in:\n{shown}");
    }
    let acts = "acts where the deck gives the material `damage = \"johnson-cook\"`";
    assert!(place.run(&["materials", "ofhc-copper"]).expect_code(0).out.contains(acts));
    place.run(&["materials", "armco-irn"]).expect_code(2).expect_told(&["did you mean `armco-iron`"]);
}

#[test]
fn a_run_is_drawn_and_compared() {
    let place = Place::new();
    place.run(&["run", "plate.toml", "-o", "a"]).expect_code(0);
    place.run(&["run", "plate.toml", "-o", "b", "--set", "search=skin"]).expect_code(0);

    let drawn = place.run(&["plot", "a", "--dpi", "50"]).expect_code(0).out;
    assert!(drawn.contains("before-after"), "{drawn}");
    for file in drawn.lines() {
        assert!(fs::read(place.path(file)).unwrap().starts_with(b"\x89PNG"), "{file}");
    }
    let one = ["plot", "a", "--field", "stress.xy", "--frames", "first,2,1e-6", "--range", "-1e9,1e9", "--dpi", "50"];
    assert_eq!(place.run(&one).expect_code(0).out, "a/plots/stress.xy-first-2-1us.png\n");
    let curve = place.run(&["plot", "a", "--column", "height"]).expect_code(0).out;
    assert_eq!(curve, "a/plots/history-height.png\n");
    let over =
        ["plot", "a", "--column", "kinetic_energy", "--x", "height", "--scale", "height=-1", "--from-start", "height"];
    let drawn = place.run(&over).expect_code(0).out;
    assert_eq!(drawn, "a/plots/history-kinetic_energy-over-height.png\n");
    let table = [&over[..], &["-o", "numbers.csv"]].concat();
    assert_eq!(place.run(&table).expect_code(0).out, "numbers.csv\n");
    let numbers = fs::read_to_string(place.path("numbers.csv")).unwrap();
    assert!(numbers.starts_with("-1 * change of height (m),kinetic_energy (J/m)\n0e0,"), "{numbers}");
    // What is computed for pictures needs no run that writes it; the file says from which side it was drawn.
    let from = ["plot", "a", "--field", "displacement", "--view", "1,0.5,2", "--section=x at 1 mm", "--dpi", "50"];
    let name = "a/plots/displacement-last-from-1_0.5_2-section-x-at-1mm.png";
    assert_eq!(place.run(&from).expect_code(0).out, format!("{name}\n"));
    // The plane of the problem has nothing before and behind it.
    let flat = ["plot", "a", "--field", "body", "--section"];
    place.run(&flat).expect_code(2).expect_told(&["cuts nothing", "plane of the problem"]);
    place
        .run(&["plot", "a", "--field", "body", "--section=x at 1 m"])
        .expect_code(2)
        .expect_told(&["cuts nothing", "bodies are between"]);
    let chosen = ["plot", "a", "--field", "speed", "--body", "plate", "--where", "velocity.y < 1 km/s", "--dpi", "50"];
    assert_eq!(place.run(&chosen).expect_code(0).out, "a/plots/speed-last.png\n");
    let slip = ["plot", "a", "--field", "speed", "--body", "plat"];
    place.run(&slip).expect_code(2).expect_told(&["no body `plat`", "did you mean `plate`"]);
    place.run(&["plot", "a", "--field", "body", "--section=x at 1 s"]).expect_code(2).expect_told(&["a length"]);
    place.run(&["plot", "a", "--field", "body", "-o", "b.csv"]).expect_code(2).expect_told(&["not written as numbers"]);
    place.run(&["plot", "a", "--field", "stres"]).expect_code(2).expect_told(&["no field `stres`", "von_mises_stress"]);
    place.run(&["plot", "nowhere"]).expect_code(2).expect_told(&["nowhere is not the folder of a run"]);
    place.run(&["plot", "a", "--section"]).expect_code(2);
    let timed =
        ["plot", "a", "--field", "pressure", "--time", "1 us", "--range=-1,1GPa", "--format", "svg", "--dpi", "50"];
    assert_eq!(place.run(&timed).expect_code(0).out, "a/plots/pressure-1us.svg\n");
    // The name tells the time of the frame that is drawn, and a note where that is not what was asked for.
    let late = place.run(&["plot", "a", "--field", "pressure", "--time", "1 ms", "--dpi", "50"]).expect_code(0);
    assert_eq!(late.out, "a/plots/pressure-2us.png\n");
    late.expect_told(&["note: the last frame of `a` is at 2 us: it is drawn instead of 1 ms"]);
    let apart = place
        .run(&["plot", "a", "--field", "pressure", "--frames", "all", "--dpi", "50", "-o", "all"])
        .expect_code(0)
        .out;
    assert!(
        apart.lines().count() > 2 && apart.starts_with("all/pressure-000000.png\nall/pressure-000001.png\n"),
        "{apart}"
    );
    let both =
        place.run(&["plot", "a", "b", "--column", "height", "--width", "85 mm", "--dpi", "300"]).expect_code(0).out;
    assert_eq!(both, "a/plots/history-height-vs-b.png\n");
    let png = fs::read(place.path(both.trim())).unwrap();
    assert_eq!(png[16..20], 1004u32.to_be_bytes(), "pixels of 85 mm at 300 to the inch");
    let moving = place
        .run(&["plot", "a", "--field", "pressure", "--animate", "--frames", "0,1,last", "--dpi", "50", "-o", "m.png"])
        .expect_code(0)
        .out;
    assert!(moving == "m.png\n" && fs::read(place.path("m.png")).unwrap().windows(4).any(|word| word == b"acTL"));
    for (arguments, told) in [
        (vec!["--field", "pressure", "--range", "1,0 GPa"], "the smaller first"),
        (vec!["--field", "pressure", "--range", "0,1 mm"], "a length"),
        (vec!["--field", "pressure", "--time", "soon"], "60 us"),
        (vec!["--field", "pressure", "-o", "p.pdf"], ".png or .svg"),
        (vec!["--field", "pressure", "--frames", "all,2"], "--frames all"),
        (vec!["--field", "pressure", "--field", "velocity", "-o", "p.svg"], "several pictures"),
        (vec!["--field", "pressure", "--mirror"], "no plane of symmetry"),
        (vec!["--field", "pressure", "--mirror=w"], "`x,y`"),
        (vec!["--field", "pressure", "--frames", "99"], "there is no frame 99: the run has frames 0 to"),
        (vec!["--field", "pressure", "--animate", "-o", "a.mp4"], "`ffmpeg -i name.png name.mp4`"),
        (vec!["--field", "pressure", "--animate", "-o", "a.svg"], "an animation is an animated PNG file"),
        (vec!["--column", "height", "--width", "1 um"], "40 mm"),
        (vec!["--column", "height", "--dpi", "5000"], "1200"),
        (vec!["b", "--field", "pressure", "--animate"], "one run"),
    ] {
        let arguments: Vec<&str> = ["plot", "a"].into_iter().chain(arguments).collect();
        place.run(&arguments).expect_code(2).expect_told(&[told]);
    }

    let table = place.run(&["compare", "a", "b"]).expect_code(0).out;
    assert!(table.contains("height") && table.contains("searched fraction"), "{table}");
    let json = place.run(&["compare", "a", "b", "--json"]).expect_code(0).out;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["runs"], serde_json::json!(["a", "b"]));
    place.run(&["compare", "a", "nowhere"]).expect_code(2).expect_told(&["nowhere is not the folder of a run"]);
}

#[test]
fn the_schema_knows_every_key_of_a_deck() {
    let schema = Place::new().run(&["schema"]).expect_code(0).out;
    let schema: serde_json::Value = serde_json::from_str(&schema).unwrap();
    for key in ["title", "particles", "time", "output", "body", "wall", "measure"] {
        assert!(schema["properties"][key].is_object(), "{key} is missing");
    }
}

#[test]
fn a_case_that_is_not_there_is_bad_input() {
    let place = Place::new();
    place.run(&["validate", "taylor-plat"]).expect_code(2).expect_told(&["taylor-plat"]);
    assert!(!place.path("out").exists());
}

#[test]
fn wrong_usage_exits_with_2_and_help_with_0() {
    let place = Place::new();
    for arguments in [
        ["run"].as_slice(),
        &["fly"],
        &["run", "plate.toml", "--set", "time.end"],
        &["run", "plate.toml", "--threads", "0"],
        &["run", "plate.toml", "--precision", "quadruple"],
        &["bench", "--seconds", "-1"],
    ] {
        place.run(arguments).expect_code(2);
    }
    assert!(place.run(&["--help"]).expect_code(0).out.contains("Exit codes"));
    assert!(place.run(&["run", "--help"]).expect_code(0).out.contains("Examples:"));
    assert!(place.run(&["--version"]).expect_code(0).out.starts_with("sphorge "));
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let place = Place::new();
    let mut child = place.command(&["run", "plate.toml"]).spawn().unwrap();
    drop((child.stdout.take(), child.stderr.take()));
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(place.summary("out/plate")["status"], "completed");
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_does_not_fit_is_a_failure() {
    let place = Place::new();
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = place.command(&["materials"]).stdout(Stdio::from(full)).output().unwrap();
    common::Ended::from(output).expect_code(1).expect_told(&["cannot write to standard output"]);
}

#[test]
fn a_program_without_mpi_is_not_one_of_many_processes() {
    if common::has_mpi() {
        return;
    }
    let place = Place::new();
    let one_of = |names: [&str; 2], number: &str| {
        let mut command = place.command(&["run", "plate.toml", "-o", "run"]);
        common::Ended::from(command.env(names[0], "4").env(names[1], number).output().unwrap())
    };
    for names in [
        ["OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"],
        ["PMI_SIZE", "PMI_RANK"],
        ["SLURM_STEP_NUM_TASKS", "SLURM_PROCID"],
    ] {
        one_of(names, "0").expect_code(2).expect_told(&["4 processes were started together", "--features mpi"]);
        // The first one has said so.
        assert_eq!(one_of(names, "3").expect_code(1).err, "");
    }
    assert!(!place.path("run").exists());
    let mut alone = place.command(&["run", "plate.toml", "-o", "run"]);
    common::Ended::from(alone.env("PMI_SIZE", "1").env("PMI_RANK", "0").output().unwrap()).expect_code(0);
}
