//! Every warning has a deck that raises it, and what it recommends cures that deck; slips in a deck are told. The tables of `docs/warnings.md`.

use sphorge::{
    deck::load_text,
    engine::ENGINES,
    model::WarningKind,
    output::WarningRecord,
    run::{RunError, RunOptions, Silent, execute},
};
use std::{fs, path::Path, sync::atomic::AtomicBool};

/// A deck of `docs/warnings` and what a warning on it recommends.
struct Case {
    deck: &'static str,
    /// Part of the message.
    says: &'static str,
    /// A key and its value that do so.
    remedy: (&'static str, &'static str),
}

const TOTAL_LAGRANGIAN: (&str, &str) = ("search", "total-lagrangian");
const SPALLS: (&str, &str) = ("material.ofhc-copper.spall-pressure", "1 GPa");

/// The deck of a warning; none where no deck raises it.
fn case(kind: WarningKind) -> Option<Case> {
    let of = |deck, says, remedy| Some(Case { deck, says, remedy });
    match kind {
        WarningKind::PlasticWork => of("plastic-work", "use `search = \"total-lagrangian\"`", TOTAL_LAGRANGIAN),
        WarningKind::NegativeEnergy => of("negative-energy", "lower `time.courant`", ("time.courant", "0.1")),
        WarningKind::HourglassWork => {
            let key = "search.total-lagrangian.hourglass";
            of("hourglass-work", "lower `search.total-lagrangian.hourglass`", (key, "0.5"))
        }
        WarningKind::Integration => of("integration", "lower `time.courant`", ("time.courant", "0.3")),
        WarningKind::ContactEnergy => of("contact-energy", "use `search = \"total-lagrangian\"`", TOTAL_LAGRANGIAN),
        WarningKind::Cold => of("time-step", "lower `time.courant`", ("time.courant", "0.3")),
        WarningKind::Hot => of("integration", "lower `time.courant`", ("time.courant", "0.3")),
        WarningKind::MissingHeat => {
            let key = "numerics.temperature";
            of("missing-heat", "set `numerics.temperature = \"energy\"`", (key, "energy"))
        }
        WarningKind::WallEnergy => {
            let key = "wall.anvil.contact";
            of("wall-energy", "use `contact = \"penalty\"` at the wall", (key, "penalty"))
        }
        // The sums conserve both, whatever the stress and the motion: more would be a fault of the program.
        WarningKind::EnergyDrift | WarningKind::MomentumDrift => None,
        WarningKind::Pairing | WarningKind::Tearing => {
            of("pairing", "use `search = \"total-lagrangian\"`", TOTAL_LAGRANGIAN)
        }
        WarningKind::Pieces => of("pieces", "use `search = \"total-lagrangian\"`", TOTAL_LAGRANGIAN),
        WarningKind::LostNeighbors => of("lost-neighbors", "give the material a `spall-pressure`", SPALLS),
        WarningKind::Interpenetration => {
            let key = "method";
            of("interpenetration", "use `method = \"updated-lagrangian\"`", (key, "updated-lagrangian"))
        }
        WarningKind::BehindSymmetry => {
            of("behind-symmetry", "`sphorge check` suggests", ("particles.spacing", "0.635 mm"))
        }
        WarningKind::FarAway => {
            let shift = ("body.b.shape.shift", "[\"0.08 mm\", 0]");
            of("far-away", "look at the start for bodies or particles that press on each other", shift)
        }
        WarningKind::Compression => of("time-step", "lower `time.courant`", ("time.courant", "0.3")),
        WarningKind::Expansion => of("expansion", "give the material a `spall-pressure`", SPALLS),
        WarningKind::TimeStep => of("time-step", "lower `time.courant`", ("time.courant", "0.3")),
        WarningKind::StepsLeft => of("steps-left", "raise `time.fixed-step`", ("time.fixed-step", "5 ns")),
    }
}

fn page() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/warnings.md")
}

/// What a run of a deck with a change warns of.
fn warnings(deck: &str, changes: &[(&str, &str)]) -> Vec<WarningRecord> {
    let text = fs::read_to_string(page().with_file_name("warnings").join(format!("{deck}.toml"))).unwrap();
    let changes: Vec<_> = changes.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect();
    let setup = load_text(deck, &text, &changes).unwrap_or_else(|report| panic!("{deck}: {report:?}"));
    let folder = tempfile::tempdir().unwrap();
    let options = RunOptions { directory: folder.path().join("run"), threads: Some(1), ..RunOptions::default() };
    match execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent) {
        Ok(summary) => summary.warnings,
        Err(RunError::Failed { summary, .. }) if changes.is_empty() => summary.warnings,
        Err(error) => panic!("{deck}: {error}"),
    }
}

/// The row of a warning in the table.
fn row(kind: WarningKind) -> String {
    let name = kind.name();
    let Some(Case { deck, says, remedy }) = case(kind) else {
        let limit = kind.info().limit;
        return format!("| `{name}` | none: [by construction](#energy-drift-momentum-drift) | | {limit} | |\n");
    };
    let found = warnings(deck, &[]);
    let raised = found.iter().find(|warning| warning.name == name);
    let raised = raised.unwrap_or_else(|| panic!("`{deck}` does not raise `{name}`: {found:?}"));
    assert!(raised.cure.contains(says), "`{name}` does not say `{says}`: {}", raised.cure);
    let left: Vec<String> = warnings(deck, &[remedy]).into_iter().map(|warning| warning.name).collect();
    assert_eq!(left, [""; 0], "`{name}` with its remedy");
    let (key, value) = remedy;
    format!(
        "| `{name}` | [`{deck}.toml`](warnings/{deck}.toml) | {} | {} | `{key} = {}` |\n",
        two_digits(raised.value),
        raised.limit,
        written(value)
    )
}

#[test]
fn every_warning_has_a_deck_that_raises_it_and_a_remedy_that_cures_it() {
    let mut table = "| warning | deck | number | limit | remedy |\n|---|---|---:|---:|---|\n".to_owned();
    let rows: Vec<String> = std::thread::scope(|scope| {
        let rows = WarningKind::ALL.map(|kind| scope.spawn(move || row(kind)));
        rows.into_iter().map(|row| row.join().expect("see above")).collect()
    });
    table.extend(rows);
    // Numbers of runs that break depend on their last digits.
    is_in_the_page(["<!-- decks -->\n", "<!-- /decks -->\n"], &table, Some(2));
}

/// A change of `sound.toml` that no engineer means, and a part of the note on it.
const SLIPS: [(&str, &str, &str); 25] = [
    ("material.steel.density", "7.85e-9", "in SI"),
    ("material.steel.density", "7.85", "7.85 g/cm^3"),
    ("material.steel.young-modulus", "210 MPa", "210 GPa"),
    ("material.steel.strength.perfectly-plastic.yield-stress", "350", "no metal yields"),
    ("material.steel.strength.perfectly-plastic.yield-stress", "350 GPa", "times its shear modulus"),
    ("material.steel.conductivity", "45 kW/(m K)", "no material has such a conductivity"),
    ("material.steel.poisson-ratio", "0.4999", "nearly incompressible"),
    ("material.steel.poisson-ratio", "0.03", "below that of any metal"),
    ("material.steel.spall-pressure", "1.2", "1.2 GPa"),
    ("numerics.viscosity.alpha", "1e9", "values in use are"),
    ("time.end", "20", "the run takes some"),
    ("time.end", "10 us", "meets wall `anvil` after 50 us at the earliest"),
    ("body.bar.velocity", "[0, 0]", "nothing moves"),
    ("body.bar.velocity", "[0, 100]", "flies away from wall `anvil`"),
    ("body.bar.velocity", "[100, 0]", "meets nothing"),
    ("body.bar.velocity", "[0, -1000]", "does not stiffen in shocks"),
    ("body.bar.velocity", "[0, -300000]", "times its speed of sound"),
    ("body.bar.temperature", "20000 K", "far above the boiling point"),
    ("body.bar.temperature", "20", "20 degC"),
    ("body.bar.spacing", "1.5 mm", "mass than its shape"),
    ("wall.anvil.velocity", "[0, -100]", "never meet"),
    ("output.history-interval", "1 ms", "the only rows of the history"),
    ("wall.anvil.contact.penalty.friction", "10", "the friction coefficient of wall `anvil`"),
    ("section.middle.point", "[0, \"50 mm\"]", "cuts no body"),
    ("gravity", "[0, \"9.81 m/s^2\"]", "gravity points away from wall `anvil`"),
];

#[test]
fn a_sound_deck_is_told_nothing_and_each_slip_in_it_is() {
    let text = fs::read_to_string(page().with_file_name("warnings").join("sound.toml")).unwrap();
    let notes = |changes: &[(&str, &str)]| {
        let changes: Vec<_> = changes.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect();
        load_text("sound", &text, &changes).unwrap_or_else(|report| panic!("{report:?}")).all_notes()
    };
    assert_eq!(notes(&[]), [""; 0]);
    let mut table = "| change | note |\n|---|---|\n".to_owned();
    for (key, value, words) in SLIPS {
        // Gravity alone does not turn a bar round that has been thrown.
        let thrown = ("body.bar.velocity", "[0, 0]");
        let found = if key == "gravity" { notes(&[(key, value), thrown]) } else { notes(&[(key, value)]) };
        let note = found.iter().find(|note| note.contains(words));
        let note = note.unwrap_or_else(|| panic!("{key} = {value}: {found:?}"));
        assert_eq!(found.len(), 1, "{key} = {value}: {found:?}");
        table += &format!("| `{key} = {}` | {note} |\n", written(value));
    }
    is_in_the_page(["<!-- notes -->\n", "<!-- /notes -->\n"], &table, None);
}

/// Holds a table against the one of the page between two marks, but for a column, or writes it there.
fn is_in_the_page(marks: [&str; 2], table: &str, but: Option<usize>) {
    let text = fs::read_to_string(page()).unwrap();
    let places = marks.map(|mark| text.find(mark).unwrap_or_else(|| panic!("{mark} is not in docs/warnings.md")));
    let from = places[0] + marks[0].len();
    if std::env::var_os("UPDATE_WARNINGS").is_some() {
        fs::write(page(), format!("{}{table}{}", &text[..from], &text[places[1]..])).unwrap();
        return;
    }
    let cells = |table: &str| -> Vec<Vec<String>> {
        let rows = table.lines().map(|row| row.split(" | ").map(str::to_owned).collect::<Vec<_>>());
        rows.map(|row| row.into_iter().enumerate().filter(|(k, _)| Some(*k) != but).map(|(_, cell)| cell).collect())
            .collect()
    };
    let says = "docs/warnings.md: `UPDATE_WARNINGS=1 cargo test -p sphorge --test warnings -- --test-threads 1` writes its tables anew";
    assert_eq!(cells(&text[from..places[1]]), cells(table), "{says}");
}

/// A value as a deck has it.
fn written(value: &str) -> String {
    let is_plain = value.parse::<f64>().is_ok() || value.starts_with(['[', '{']);
    if is_plain { value.to_owned() } else { format!("\"{value}\"") }
}

fn two_digits(value: f64) -> String {
    let shown: f64 = format!("{value:.1e}").parse().unwrap();
    if (1e-3..1e4).contains(&shown.abs()) || shown == 0.0 { shown.to_string() } else { format!("{shown:e}") }
}
