//! Several cards that share the particles of a run: to the bit what one card computes. Ranks are threads here.

use super::card::card;
use super::engine::{components, start_text};
use crate::Gpu;
use sphorge_deck::{decks, load_text};
use sphorge_engine::particles::FIELDS;
use sphorge_engine::persist::{Archive, ArchiveError};
use sphorge_engine::ranks::{Loaded, RankFiles};
use sphorge_engine::{EngineKind, FieldSource, Ledger, Model, PartKind, Simulation};
use sphorge_mpi::{Leader, follow_with, threads};
use std::sync::Arc;
use std::thread;

/// A deck with overrides.
#[derive(Clone, Copy)]
struct Deck<'a> {
    name: &'a str,
    text: &'a str,
    overrides: &'a [(&'a str, &'a str)],
}

impl<'a> Deck<'a> {
    fn shipped(name: &'a str, overrides: &'a [(&'a str, &'a str)]) -> Self {
        Self { name, text: decks::find(name).unwrap().text, overrides }
    }

    fn start(&self, kind: &dyn EngineKind) -> Simulation {
        start_text(kind, self.name, self.text, self.overrides)
    }
}

/// Other ranks load the deck as the first one does, and write nothing.
impl RankFiles for Deck<'_> {
    fn load(&self, _: &str, _: &str) -> Option<Loaded> {
        let overrides: Vec<_> =
            self.overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let setup = load_text(self.name, self.text, &overrides).ok()?;
        Some((Arc::new(setup.model), setup.particles))
    }

    fn write(&self, _: &str, _: usize, _: &Model, _: &dyn FieldSource) -> Result<(), String> {
        Ok(())
    }

    fn save(
        &self,
        _: &str,
        _: usize,
        _: &mut dyn FnMut(&mut dyn Archive) -> Result<(), ArchiveError>,
    ) -> Result<(), String> {
        Err("nothing is saved in files".to_owned())
    }

    fn open(&self, _: &str, _: usize, _: usize) -> Result<Box<dyn Archive>, String> {
        Err("nothing is saved in files".to_owned())
    }
}

/// What the first of some cards makes of them.
fn led<T>(deck: Deck<'_>, ranks: usize, lead: impl FnOnce(&Leader) -> T) -> T {
    let kind: Arc<dyn PartKind> = Arc::new(Gpu::default());
    let mut communicators = threads(ranks);
    thread::scope(|scope| {
        for communicator in communicators.split_off(1) {
            let kinds = [kind.clone()];
            scope.spawn(move || follow_with(communicator, Some(1), &kinds, &deck).unwrap());
        }
        lead(&Leader::of(kind, communicators.remove(0)))
    })
}

/// Everything that is known of a run at its end: all fields, and the sums.
fn state(simulation: &Simulation) -> (Vec<(&'static str, Vec<f64>)>, Ledger, u64) {
    let field = |name: &'static str| (name, components(&simulation.read(name).unwrap()));
    (FIELDS.iter().map(|field_info| field(field_info.name)).collect(), simulation.ledger().unwrap(), simulation.steps())
}

fn run(simulation: &mut Simulation, steps: u32) {
    for _ in 0..steps {
        simulation.step(None).unwrap();
    }
}

/// Compares so many steps on each number of ranks with one card.
fn compare(deck: Deck<'_>, steps: u32, ranks: &[usize]) {
    if card().is_none() {
        return;
    }
    let mut alone = deck.start(&Gpu::default());
    run(&mut alone, steps);
    let expected = state(&alone);
    for ranks in ranks {
        let found = led(deck, *ranks, |leader| {
            let mut simulation = deck.start(leader);
            run(&mut simulation, steps);
            state(&simulation)
        });
        for ((name, found), (_, expected)) in found.0.iter().zip(&expected.0) {
            assert!(found == expected, "`{name}` of `{}` on {ranks} ranks differs", deck.name);
        }
        assert_eq!((found.1, found.2), (expected.1.clone(), expected.2), "{ranks} ranks");
    }
}

#[test]
fn a_search_every_step() {
    compare(Deck::shipped("taylor-plate", &[("particles.spacing", "\"0.6 mm\"")]), 60, &[2, 3]);
}

#[test]
fn the_default_method() {
    compare(Deck::shipped("iron-plate", &[("particles.spacing", "\"0.64 mm\"")]), 60, &[2]);
}
