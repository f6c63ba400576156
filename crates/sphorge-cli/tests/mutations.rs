//! Shipped decks with slips in them: each is checked or refused, nothing panics, and what `check` accepts a run starts and steps.
//!
//! A few cases, the same for every change; other ones each time: `PROPTEST_CASES=5000 cargo test -p sphorge-cli --test mutations` takes minutes.

use proptest::{prelude::*, sample::Index, test_runner::RngSeed};
use sphorge::{
    deck::{Setup, advice, load_model, load_text_within},
    decks::DECKS,
    engine::{Cpu, ENGINES},
    forecast::{ForecastOptions, forecast},
    run::{RunOptions, Silent, execute},
};
use std::{
    fs,
    sync::{Arc, LazyLock, atomic::AtomicBool},
};

/// Particles of which a step takes milliseconds.
const MOST_PARTICLES: f64 = 600.0;
const CASES: u32 = 48;
const SEED: u64 = 44;

/// The shipped decks, as coarse as they can be filled, less those that cannot be as coarse.
static COARSE: LazyLock<Vec<String>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let coarse = |name: &str, text: &str| {
        let path = folder.path().join("deck.toml");
        fs::write(&path, text).expect("a deck");
        let spacing = load_model(&path).expect("a good deck").spacing;
        let factors = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0];
        factors.into_iter().find_map(|factor| {
            let set = [("particles.spacing".to_owned(), format!("{:e}", spacing * factor))];
            load_text_within(name, text, &set, MOST_PARTICLES).ok().map(|setup| setup.deck_text)
        })
    };
    DECKS.iter().filter_map(|deck| coarse(deck.name, deck.text)).collect()
});

/// A slip.
#[derive(Clone, Debug)]
enum Slip {
    /// A number becomes another.
    Number(Index, String),
    /// What stands in quotes becomes what stands in quotes elsewhere.
    Word(Index, Index),
    /// A line is left out.
    Line(Index),
    /// A line stands twice.
    Twice(Index),
    /// Some characters become others.
    Piece(Index, usize, String),
}

fn slips() -> impl Strategy<Value = Slip> {
    let index = any::<Index>;
    let numbers =
        prop::sample::select(vec!["0", "-1", "1e-300", "1e300", "0.5", "7", "inf", "nan", "1e15", "-1e-9", "3"]);
    prop_oneof![
        4 => (index(), numbers).prop_map(|(at, number)| Slip::Number(at, number.to_owned())),
        2 => (index(), any::<f64>()).prop_map(|(at, number)| Slip::Number(at, format!("{number:e}"))),
        2 => (index(), -35.0f64..35.0).prop_map(|(at, power)| Slip::Number(at, format!("{:e}", 10f64.powf(power)))),
        2 => (index(), 0.1f64..10.0).prop_map(|(at, number)| Slip::Number(at, format!("{number}"))),
        4 => (index(), index()).prop_map(|(at, from)| Slip::Word(at, from)),
        2 => index().prop_map(Slip::Line),
        1 => index().prop_map(Slip::Twice),
        1 => (index(), 0usize..5, "[\\[\\]{}=.,\"# a-z0-9é%/-]{0,6}").prop_map(|(at, length, piece)| Slip::Piece(at, length, piece)),
    ]
}

/// Where numbers, or texts in quotes, stand in a deck.
fn places(text: &str, is_number: bool) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    let mut rest = 0;
    while let Some(start) =
        text[rest..].find(|c: char| if is_number { c.is_ascii_digit() } else { c == '"' }).map(|k| rest + k)
    {
        let from = start + usize::from(!is_number);
        let ends = |c: char| if is_number { !c.is_ascii_digit() && c != '.' } else { c == '"' || c == '\n' };
        let end = text[from..].find(ends).map_or(text.len(), |k| from + k);
        found.push(from..end);
        rest = (end + 1).min(text.len());
        if !text.is_char_boundary(rest) {
            rest = end;
        }
    }
    found
}

fn slipped(text: &str, slip: &Slip) -> String {
    let lines: Vec<&str> = text.lines().collect();
    match slip {
        Slip::Number(at, new) => {
            let at = at.get(&places(text, true)).clone();
            format!("{}{new}{}", &text[..at.start], &text[at.end..])
        }
        Slip::Word(at, from) => {
            let places = places(text, false);
            let (at, from) = (at.get(&places).clone(), from.get(&places).clone());
            format!("{}{}{}", &text[..at.start], &text[from], &text[at.end..])
        }
        Slip::Line(at) => {
            let left_out = at.index(lines.len());
            lines.iter().enumerate().filter(|(k, _)| *k != left_out).map(|(_, line)| format!("{line}\n")).collect()
        }
        Slip::Twice(at) => {
            let twice = at.index(lines.len());
            lines.iter().enumerate().map(|(k, line)| format!("{line}\n").repeat(1 + usize::from(k == twice))).collect()
        }
        Slip::Piece(at, length, piece) => {
            let chars: Vec<char> = text.chars().collect();
            let start = at.index(chars.len());
            let end = (start + length).min(chars.len());
            chars[..start].iter().copied().chain(piece.chars()).chain(chars[end..].iter().copied()).collect()
        }
    }
}

/// Checks a deck, and runs a step of it if that is accepted.
fn check_and_run(text: &str) -> Result<(), TestCaseError> {
    let load = || load_text_within("deck", text, &[("time.max-steps".to_owned(), "1".to_owned())], MOST_PARTICLES);
    let Ok(setup) = load() else { return Ok(()) };
    let Setup { model, particles, .. } = &setup;
    let _ = advice(model, particles);
    if forecast(setup, &ForecastOptions { engine: Arc::new(Cpu), threads: Some(1), seconds: 0.0 }).is_err() {
        return Ok(());
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let options = RunOptions { directory: folder.path().join("run"), threads: Some(1), ..RunOptions::default() };
    let Ok(setup) = load() else { return Err(TestCaseError::fail("read once, and not twice")) };
    match execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent) {
        Ok(_) => Ok(()),
        Err(error) => Err(TestCaseError::fail(format!("accepted by `check`: {error}"))),
    }
}

fn config() -> ProptestConfig {
    let usual = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    if std::env::var_os("PROPTEST_CASES").is_some() {
        return usual;
    }
    // The same for the same program: a change is not refused for a slip that it has nothing to do with.
    ProptestConfig { cases: CASES, rng_seed: RngSeed::Fixed(SEED), ..usual }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_deck_with_slips_is_refused_or_runs(deck in any::<Index>(), slips in prop::collection::vec(slips(), 1..3)) {
        let text = slips.iter().fold(deck.get(&COARSE).clone(), |text, slip| slipped(&text, slip));
        check_and_run(&text)?;
    }
}

#[test]
fn most_shipped_decks_have_slips_tried() {
    assert!(COARSE.len() >= 15, "{}", COARSE.len());
}
