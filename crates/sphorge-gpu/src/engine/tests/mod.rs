//! What the GPU sums, beside what the processor makes of columns read back.

mod ledger;
mod oracle;
mod reductions;
mod rows;

use super::{Gpu, GpuEngine};
use sphorge_deck::{decks, load_text};
use sphorge_engine::{Engine, Model, StageSeconds, advance};
use std::sync::Arc;

/// A deck: text, and what is changed in it.
type Deck<'a> = (&'a str, &'a [(&'a str, &'a str)]);

fn shipped(name: &str) -> &'static str {
    decks::find(name).unwrap_or_else(|| panic!("{name}")).text
}

/// An engine on a deck, before its first step.
fn engine(kind: &Gpu, deck: Deck<'_>) -> GpuEngine {
    changed_engine(kind, deck, |_| {})
}

/// The same of a model that no deck can ask for.
fn changed_engine(kind: &Gpu, (text, overrides): Deck<'_>, change: impl FnOnce(&mut Model)) -> GpuEngine {
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let setup = load_text("deck", text, &overrides).unwrap_or_else(|report| panic!("{report:?}"));
    let (mut model, particles) = (setup.model, setup.particles);
    change(&mut model);
    let mut engine = GpuEngine::new(Arc::new(model), particles, kind, None).unwrap();
    steps(&mut engine, &[0.0]);
    engine
}

/// Takes steps of these shares of the stable one.
fn steps(engine: &mut GpuEngine, shares: &[f64]) {
    for share in shares {
        let longest = if *share > 0.0 { engine.time_step_limit().unwrap().dt } else { 0.0 };
        let longest = engine.model.time.max_step.map_or(longest, |most| longest.min(most));
        let [mut seconds, mut waiting] = [StageSeconds::default(); 2];
        advance(engine, share * longest, &mut seconds, &mut waiting).unwrap();
    }
}
