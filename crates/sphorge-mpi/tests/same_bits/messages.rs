//! How many messages ranks send, and how long they are.

use super::setup;
use sphorge::engine::ranks::{Communicator, Messages};
use sphorge::engine::reduction::Suspicion;
use sphorge::engine::{EngineKind, FieldSource, ParticleSource, Quantity, Reduction, Simulation};
use sphorge::model::{Extremum, ParticleSelection};
use sphorge::run::FilesOfRank;
use sphorge_mpi::{Leader, follow, threads};
use std::sync::{Arc, Mutex};
use std::thread;

/// Two plates, of each of which two ranks have a half; the upper one moves on, so that particles of it get to the other rank.
const LAYERS: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
search = "every-step"
particles = { spacing = "0.5 mm" }

[time]
end = "20 us"

[output]
frame-interval = "10 us"
history-interval = "1 us"

[[body]]
name = "lower"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["40 mm", "7 mm"] } }

[[body]]
name = "upper"
material = "armco-iron"
shape = { box = { min = ["0 mm", "10 mm"], max = ["40 mm", "17 mm"] } }
velocity = ["1000 m/s", "0 m/s"]
"#;

/// A communicator that notes the lengths of messages that its rank sends.
#[derive(Debug)]
struct Noting {
    inner: Arc<dyn Communicator>,
    lengths: Arc<Mutex<Vec<usize>>>,
}

impl Communicator for Noting {
    fn rank(&self) -> usize {
        self.inner.rank()
    }
    fn size(&self) -> usize {
        self.inner.size()
    }
    fn begin(&self, to: Vec<Vec<u8>>, lengths: &[usize]) -> Result<Box<dyn Messages>, String> {
        self.lengths.lock().unwrap().extend(to.iter().map(Vec::len).filter(|length| *length > 0));
        self.inner.begin(to, lengths)
    }
}

/// Lengths of the messages that the second of two ranks sends while something is done with a deck after some steps.
fn sent(deck: &str, changes: &[(&str, &str)], steps: u64, act: impl FnOnce(&mut Simulation)) -> Vec<usize> {
    let lengths = Arc::<Mutex<Vec<usize>>>::default();
    let [first, second]: [Arc<dyn Communicator>; 2] = threads(2).try_into().unwrap();
    thread::scope(|scope| {
        let second = Noting { inner: second, lengths: lengths.clone() };
        scope.spawn(move || follow(Arc::new(second), Some(1), &FilesOfRank::new(1e9)));
        let leader = Leader::new(first);
        let setup = setup(deck, changes);
        leader.take_deck("a-deck", &setup.deck_text);
        let mut simulation = Simulation::start(&leader, setup.model, setup.particles).unwrap();
        for _ in 0..steps {
            simulation.step(None).unwrap();
        }
        // A rank tells the first one of itself when all of that is done.
        simulation.ledger().unwrap();
        lengths.lock().unwrap().clear();
        act(&mut simulation);
    });
    lengths.lock().unwrap().clone()
}

fn one_step(simulation: &mut Simulation) {
    simulation.step(None).unwrap();
}

#[test]
fn ghosts_take_over_a_set_of_fields_in_one_message() {
    let long = |sent: &[usize]| sent.iter().filter(|length| **length > 2000).count();
    // Motion and stress.
    let initial = sent("copper-bar", &[("particles.spacing", "\"0.8 mm\"")], 5, one_step);
    let present = [("particles.spacing", "\"0.2 mm\""), ("search", "\"skin\""), ("method", "\"updated-lagrangian\"")];
    let present = sent("taylor-plate", &present, 5, one_step);
    assert_eq!((long(&initial), long(&present)), (2, 2), "{initial:?} {present:?}");
}

#[test]
fn particles_that_are_sorted_anew_go_to_another_rank_in_one_message() {
    let [plain, sorted] = [62, 63].map(|steps| sent(LAYERS, &[], steps, one_step));
    // Positions, by which they are sorted, pairs, by which shares are chosen, and the columns of those that go.
    assert_eq!(sorted.len(), plain.len() + 3, "{plain:?} {sorted:?}");
    assert!(sorted[0] == 6 * sorted[1] && (2000..sorted[0]).contains(&sorted[2]), "{sorted:?}");
}

/// The longest message that a reduction may take, of what it gave for a deck of one body; none where whole columns are sent.
fn longest(reduction: &Reduction<'_>, found: &[f64]) -> Option<usize> {
    match reduction {
        Reduction::Extent { .. }
        | Reduction::Diameter { .. }
        | Reduction::Extremum { .. }
        | Reduction::Mean { .. }
        | Reduction::Interpolation { .. }
        | Reduction::Nearest { .. }
        | Reduction::OfParticle { .. } => Some(32),
        // Count, place and value of each slab, of which place and value are given.
        Reduction::Slabs { .. } => Some(found.len() / 2 * 24),
        // Nine numbers of a body.
        Reduction::Suspects(
            Suspicion::Cold(_)
            | Suspicion::Hot(_)
            | Suspicion::MissingHeat(_)
            | Suspicion::Compressed(_)
            | Suspicion::Expanded(_)
            | Suspicion::Away { .. }
            | Suspicion::Behind { .. }
            | Suspicion::Lonely,
        ) => Some(72),
        // They look at what lies around particles.
        Reduction::Suspects(Suspicion::Apart | Suspicion::Paired | Suspicion::Torn | Suspicion::Inside { .. }) => None,
        Reduction::SectionForce(_) => panic!("the deck has no section"),
    }
}

#[test]
fn measures_and_checks_send_sums_and_no_columns_but_those_of_what_lies_around_particles() {
    let of = &ParticleSelection { body: Some(0), ..ParticleSelection::default() };
    let quantity = Quantity { field: "von_mises_stress", component: None };
    let mut asked = vec![
        Reduction::Extent { of, axis: 0 },
        Reduction::Diameter { of, axis: 1 },
        Reduction::Extremum { of, quantity, extremum: Extremum::Maximum },
        Reduction::Mean { of, quantity },
        Reduction::Interpolation { of, quantity, point: [1e-3, 5e-3, 0.0] },
        Reduction::Slabs { of, quantity, axis: 1, direction: 1.0 },
        Reduction::Nearest { point: [1e-3, 5e-3, 0.0], body: None },
        Reduction::OfParticle { id: 7, quantity },
    ];
    let suspicions = [
        Suspicion::Cold(1e3),
        Suspicion::Hot(0.5),
        Suspicion::MissingHeat(0.5),
        Suspicion::Compressed(-1.0),
        Suspicion::Expanded(2.0),
        Suspicion::Away { low: [0.0; 3], high: [1e-3; 3], limit: 0.0 },
        Suspicion::Behind { limit: -1e3, breaks: false },
        Suspicion::Lonely,
        Suspicion::Apart,
        Suspicion::Paired,
        Suspicion::Torn,
        Suspicion::Inside { faces: false, breaks: false },
    ];
    asked.extend(suspicions.map(Reduction::Suspects));
    for reduction in &asked {
        let (mut found, mut particles) = (Vec::new(), 0);
        let lengths = sent("copper-bar", &[("particles.spacing", "\"0.8 mm\"")], 3, |simulation| {
            particles = simulation.count();
            found = simulation.reduce(reduction).unwrap();
        });
        assert!(!found.is_empty() && !lengths.is_empty(), "{reduction:?} {found:?} {lengths:?}");
        let most = lengths.into_iter().max().unwrap_or(0);
        match longest(reduction, &found) {
            Some(allowed) => assert!(most <= allowed, "{reduction:?} sends {most} bytes, not {allowed}"),
            // A vector or a number of half of the particles.
            None => assert!(most >= 4 * particles, "{reduction:?} sends {most} bytes of {particles} particles"),
        }
    }
}

#[test]
fn rows_that_read_no_ghost_are_summed_while_these_are_on_their_way() {
    let mut shares = [0.0; 2];
    let bullet = [("particles.spacing", "\"24 mm\""), ("body.1.spacing", "\"12 mm\""), ("search", "\"skin\"")];
    sent("bullet", &bullet, 2, |simulation| shares[0] = simulation.inner_share());
    // The default method: springs against hourglass modes, planes of symmetry. In a coarser bar every block is as long as its tile and reads a ghost.
    let bar = [("particles.spacing", "\"0.35 mm\"")];
    sent("copper-bar", &bar, 2, |simulation| shares[1] = simulation.inner_share());
    assert!(shares[0] > 0.3 && shares[1] > 0.0, "{shares:?}");
}
