//! What the program prints, and how much of it.

mod common;

use common::Place;
use std::{fs, process::Command};

#[test]
fn a_quiet_run_prints_nothing_and_one_with_json_its_summary() {
    let place = Place::new();
    let quiet = place.run(&["run", "plate.toml", "--quiet", "--set", "particles.spacing=\"1.15 mm\""]).expect_code(0);
    assert_eq!((quiet.out.as_str(), quiet.err.as_str()), ("", ""));
    let told = place.run(&["run", "plate.toml", "-q", "--json", "--overwrite"]).expect_code(0);
    let printed: serde_json::Value = serde_json::from_str(&told.out).unwrap();
    assert_eq!((&printed, told.err.as_str()), (&place.summary("out/plate"), ""));
    // Errors are printed, and a failed run has a summary, too.
    place.run(&["run", "plate.toml", "-q"]).expect_code(2).expect_told(&["exists already"]);
    let resumed = place.run(&["run", "plate.toml", "-q", "-o", "long", "--checkpoint-at-end"]).expect_code(0);
    assert_eq!(resumed.err, "");
    let further = place.run(&["resume", "long", "--set", "time.end=\"3 us\"", "--json", "--quiet"]).expect_code(0);
    let printed: serde_json::Value = serde_json::from_str(&further.out).unwrap();
    assert_eq!((&printed, further.err.as_str()), (&place.summary("long"), ""));
}

#[test]
fn commands_that_are_printed_can_be_pasted_into_a_shell() {
    let place = Place::new();
    let steps = ["--set", "time.max-steps=2"];
    let run = |folder| place.run(&[&["run", "plate.toml", "-o", folder][..], &steps].concat()).expect_code(0);
    for (folder, quoted) in
        [("my run & <b> Größe", "'my run & <b> Größe'"), ("it's", "\"it's\""), ("plain/run-1", "plain/run-1")]
    {
        let printed = run(folder).out;
        let files = format!("{folder}: summary.json");
        for text in [files, format!("sphorge plot {quoted}\n")] {
            assert!(printed.contains(&text), "`{text}` is not in:\n{printed}");
        }
        let fields = quoted.trim_end_matches(['\'', '"']).to_owned() + "/fields.pvd";
        assert!(printed.contains(&format!("paraview {fields}")), "{printed}");
    }
    place.run(&["man", "runn"]).expect_code(2).expect_told(&["did you mean `run`?"]);
}

#[test]
#[cfg(unix)]
fn no_text_of_a_user_colours_or_moves_the_cursor() {
    let place = Place::new();
    let name = "a\u{1b}[31mred\u{1b}]0;title\u{7}\u{9b}2J\u{202e}b";
    let harmful = ['\u{1b}', '\u{7}', '\u{9b}', '\u{202e}'];
    let deck = common::DECK.replace("title = \"Small plate on a wall\"\n", "");
    fs::write(place.path(&format!("{name}.toml")), deck).unwrap();
    let file = format!("{name}.toml");
    let all: [(&[&str], i32); 12] = [
        (&["run", "plate.toml", "-o", name], 0),
        (&["run", "plate.toml", "-o", name], 2),
        (&["run", &file, "--json", "-o", "plain"], 0),
        (&["plot", name, "--column", name], 2),
        (&["plot", name, "--field", "pressure"], 0),
        (&["compare", name, "plain"], 0),
        (&["compare", name, "plain", "--json"], 0),
        (&["resume", name], 2),
        (&["check", &file, "--set", name], 2),
        (&["decks", name], 2),
        (&["materials", name], 2),
        (&[name], 2),
    ];
    for (arguments, code) in all {
        for colour in [false, true] {
            let mut command = place.command(arguments);
            if colour {
                command.env_remove("NO_COLOR").env("FORCE_COLOR", "1").env("CLICOLOR_FORCE", "1");
            }
            if code == 0 && arguments[0] == "run" {
                command.arg("--overwrite");
            }
            let ended = common::Ended::from(command.output().unwrap()).expect_code(code);
            assert!(!ended.out.contains(harmful), "{arguments:?}: {:?}", ended.out);
            // Colours of the diagnostic itself are plain numbers between `[` and `m`, and the user's red is none of them.
            let err =
                if colour { ended.err.replace("\u{1b}[31mred", "FOREIGN").replace("\u{1b}[", "") } else { ended.err };
            assert!(!err.contains(harmful) && !err.contains("FOREIGN"), "{arguments:?}: {err:?}");
        }
    }
}

#[test]
#[cfg(unix)]
fn a_name_with_an_end_of_line_makes_no_line_of_its_own() {
    let place = Place::new();
    let name = "a\nwarning: none";
    for command in [
        &["run", "plate.toml", "-o", name, "--checkpoint-at-end"][..],
        &["plot", name, "--column", "height"],
        &["resume", name, "--set", "time.end=\"3 us\""],
        &["resume", name],
    ] {
        let told = place.run(command);
        let lines = told.out.lines().chain(told.err.lines());
        assert!(lines.clone().count() > 0 && !lines.clone().any(|line| line.starts_with("warning: none")), "{told:#?}");
    }
}

#[test]
fn a_slip_in_the_name_of_a_column_is_recognised() {
    let place = Place::new();
    place.run(&["run", "plate.toml", "-q"]).expect_code(0);
    let ended = place.run(&["plot", "out/plate", "--column", "heigth"]).expect_code(2);
    ended.expect_told(&["the history has no column `heigth`", "did you mean `height`?"]);
}

#[test]
fn shells_complete_commands_and_options_and_each_command_has_a_page() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = place.run(&["completions", shell]).expect_code(0).out;
        assert!(["resume", "overwrite", "quiet"].iter().all(|word| text.contains(word)), "{shell}");
    }
    let bash = place.run(&["completions", "bash"]).out;
    fs::write(place.path("complete.bash"), bash).unwrap();
    let script = "source complete.bash; COMP_WORDS=(sphorge run --over); COMP_CWORD=2; _sphorge sphorge --over run; echo ${COMPREPLY[@]}";
    if let Ok(output) = Command::new("bash").args(["-c", script]).current_dir(place.path(".")).output() {
        assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "--overwrite");
    }
    let page = place.run(&["man"]).expect_code(0).out;
    assert!(page.contains(".TH sphorge 1") && page.contains("sphorge\\-resume(1)"), "{page}");
    let page = place.run(&["man", "run"]).expect_code(0).out;
    assert!(page.contains(".TH sphorge-run 1") && page.contains("\\-\\-overwrite"), "{page}");
    place.run(&["man", "rum"]).expect_code(2).expect_told(&["there is no command `rum`"]);
}
