//! The text of a deck, with overrides: what stands behind lines that begin with `#set ` is given as `--set`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sphorge::{
    deck::{advice, load_text_within},
    engine::Cpu,
    forecast::{ForecastOptions, forecast},
};
use sphorge_fuzz::{MOST_PARTICLES, show, show_of_deck};
use std::sync::Arc;

/// Particles and bodies of which a step is tried.
const STEPPED: (usize, usize) = (64, 3);

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let set = |line: &str| {
        let (path, value) = line.strip_prefix("#set ")?.split_once('=')?;
        Some((path.trim().to_owned(), value.trim().to_owned()))
    };
    let overrides: Vec<_> = text.lines().filter_map(set).take(4).collect();
    match load_text_within("deck", text, &overrides, MOST_PARTICLES) {
        Err(report) => show_of_deck(report),
        Ok(setup) => {
            let _ = advice(&setup.model, &setup.particles);
            let again = load_text_within("deck", &setup.deck_text, &[], MOST_PARTICLES);
            assert!(again.is_ok(), "the deck as run is refused: {:?}", again.err());
            if setup.particles.len() <= STEPPED.0
                && setup.model.bodies.len() <= STEPPED.1
                && let Err(error) =
                    forecast(setup, &ForecastOptions { engine: Arc::new(Cpu), threads: Some(1), seconds: 0.0 })
            {
                show(error);
            }
        }
    }
});
