//! States that are saved: by any number of ranks to be loaded by any other, or by one process without ranks.

use super::adaptive::{COARSE, GUARDED, PUBLISHED};
use super::contact::CLAMP;
use super::faces::{APART, QUADRATIC};
use super::symmetry::CORNER;
use super::{IN_THE_INITIAL_CONFIGURATION, led, setup};
use sphorge::engine::persist::{Archive, ArchiveError, ByteCount, MemoryArchive};
use sphorge::engine::{Cpu, Drive, EngineKind, FieldSource, Ledger, Simulation};
use std::collections::BTreeMap;

/// A deck, changes of it, and works of which it has some.
type Worked<'a> = (&'a str, &'a [(&'a str, &'a str)], fn(&Ledger) -> Vec<f64>);

/// Heat flows, and the clamp is pressed shut and struck at once.
const FAST: [(&str, &str); 5] = [
    ("thermal.conduction", "true"),
    // So near that particles of two bodies are neighbours in the reference configuration.
    ("body.1.shape.box.min", "[\"20.2 mm\", \"2 mm\"]"),
    ("body.1.velocity", "[\"-600 m/s\", \"60 m/s\"]"),
    ("motion.0.velocity", "[\"free\", \"-600 m/s\"]"),
    // Steps are taken here one by one, and nobody repeats one that is too long for so hard a blow.
    ("time.step-control.repeats", "0"),
];

const DECKS: [Worked<'static>; 11] = [
    ("taylor-plate", &[("particles.spacing", "\"0.4 mm\"")], |l| vec![l.viscous_energy, l.artificial_stress_energy]),
    (IN_THE_INITIAL_CONFIGURATION, &[("time.step-control.stretch", "0.5")], |l| {
        vec![l.viscous_energy, l.hourglass_energy]
    }),
    (CLAMP, &FAST, |l| vec![l.contacts[0].damping_work, l.contacts[1].friction_work, l.heat.exchanged]),
    (CORNER, &[("contact", "\"penalty\""), ("search", "\"skin\"")], |l| vec![l.contacts[0].damping_work]),
    ("copper-bar", &[("particles.spacing", "\"0.8 mm\"")], |l| vec![l.viscous_energy]),
    (
        "bullet",
        &[
            ("particles.spacing", "\"24 mm\""),
            ("body.1.spacing", "\"12 mm\""),
            ("contact", "{ penalty = { friction = 0.1 } }"),
            ("numerics.smoothing-length", "\"follow-density\""),
        ],
        |l| vec![l.contacts[0].damping_work],
    ),
    (CORNER, &[GUARDED, ("contact", "\"penalty\"")], |l| vec![l.contacts[0].damping_work]),
    ("bullet", &[COARSE[0], COARSE[1], PUBLISHED, ("audit", "11")], |l| vec![l.viscous_energy]),
    (CORNER, &[("search", "{ total-lagrangian = { form = \"frozen\" } }")], |l| vec![l.viscous_energy]),
    (IN_THE_INITIAL_CONFIGURATION, &[("time.step-control.stretch", "0.5"), APART], |l| vec![l.hourglass_energy]),
    (CLAMP, &[QUADRATIC, FAST[1], FAST[2], FAST[3], FAST[4]], |l| {
        vec![l.contacts[0].damping_work, l.contacts[1].friction_work]
    }),
];

/// A state in memory whose values can be seen.
#[derive(Default)]
struct Seen(BTreeMap<String, Vec<u8>>);

impl Archive for Seen {
    fn is_saving(&self) -> bool {
        true
    }
    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        self.0.insert(name.to_owned(), bytes);
    }
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        Err(ArchiveError::Missing(name.to_owned()))
    }
}

impl Seen {
    fn to_load(&self) -> MemoryArchive {
        let mut archive = MemoryArchive::new();
        self.0.iter().for_each(|(name, bytes)| archive.save(name, bytes.clone()));
        archive.to_load()
    }
}

/// Sums and places after some more steps of a deck, from a saved state or from the start, and the state then.
fn after_steps(kind: &dyn EngineKind, of: &Worked<'_>, saved: Option<&Seen>, more: u64) -> (String, Seen) {
    // Steps are not repeated here.
    let setup = setup(of.0, &[&[("time.courant", "0.3")], of.1].concat());
    kind.take_deck("a-deck", &setup.deck_text);
    let mut simulation = Simulation::start(kind, setup.model, setup.particles).unwrap();
    if let Some(saved) = saved {
        simulation.persist(&mut saved.to_load()).unwrap();
    }
    let end = simulation.steps() + more;
    while simulation.steps() < end {
        simulation.step(None).unwrap();
    }
    let ledger = simulation.ledger().unwrap();
    assert!(more < 30 || of.2(&ledger).iter().all(|work| *work != 0.0), "{ledger:?}");
    let told = format!("{ledger:?} {:?}", simulation.read("position").unwrap());
    let mut archive = Seen::default();
    simulation.persist(&mut archive).unwrap();
    (told, archive)
}

/// The state without the times that stages took.
fn values(state: &Seen) -> BTreeMap<&str, &Vec<u8>> {
    let of_state = |name: &&String| !name.contains("seconds");
    state.0.iter().filter(|(name, _)| of_state(name)).map(|(name, bytes)| (name.as_str(), bytes)).collect()
}

#[test]
fn what_some_ranks_have_saved_others_go_on_with_to_the_bits_of_one() {
    for deck in &DECKS {
        let name = &deck.0[..20.min(deck.0.len())];
        let (expected, last) = after_steps(&Cpu, deck, None, 150);
        let (_, by_one) = after_steps(&Cpu, deck, None, 130);
        let (_, by_three) = led(3, 1, |leader| after_steps(leader, deck, None, 130));
        let (one, three) = (values(&by_one), values(&by_three));
        assert!(one.keys().eq(three.keys()), "{name}: {:?} {:?}", one.keys(), three.keys());
        for (value, bytes) in &one {
            assert!(three[value] == *bytes, "`{value}` of {name}");
        }
        for (saved, ranks) in [(&by_three, 2), (&by_one, 4)] {
            let (found, state) = led(ranks, 1, |leader| after_steps(leader, deck, Some(saved), 20));
            assert!(found == expected, "{name} on {ranks} ranks: {found:.2000}\n{expected:.2000}");
            assert!(values(&state) == values(&last), "{name} on {ranks} ranks");
        }
        let (found, _) = after_steps(&Cpu, deck, Some(&by_three), 20);
        assert!(found == expected, "{name} without ranks: {found:.2000}\n{expected:.2000}");
    }
}

#[test]
fn what_cannot_be_loaded_is_refused_by_all_ranks_and_the_next_state_is_loaded() {
    let deck = &DECKS[2];
    let (_, saved) = led(3, 1, |leader| after_steps(leader, deck, None, 10));
    let (expected, _) = after_steps(&Cpu, deck, Some(&saved), 5);
    let damaged = |name: &str, change: &dyn Fn(&mut Vec<u8>)| {
        let mut state = Seen(saved.0.clone());
        change(state.0.get_mut(name).unwrap());
        state
    };
    let last_byte = |bytes: &mut Vec<u8>| *bytes.last_mut().unwrap() = 0xff;
    let faults = [
        ("particles.body", damaged("particles.body", &last_byte)),
        ("particles.position", damaged("particles.position", &|bytes| bytes.truncate(24))),
        ("lists.stale", damaged("lists.stale", &last_byte)),
        ("contacts.search.foreign", damaged("contacts.foreign.lengths", &last_byte)),
    ];
    let found = led(3, 1, |leader| {
        let setup = setup(deck.0, deck.1);
        leader.take_deck("a-deck", &setup.deck_text);
        let mut simulation = Simulation::start(leader, setup.model, setup.particles).unwrap();
        for (name, fault) in &faults {
            assert!(simulation.persist(&mut fault.to_load()).is_err(), "{name}");
        }
        simulation.persist(&mut saved.to_load()).unwrap();
        for _ in 0..5 {
            simulation.step(None).unwrap();
        }
        format!("{:?} {:?}", simulation.ledger().unwrap(), simulation.read("position").unwrap())
    });
    assert!(found == expected);
}

/// Steps of a deck, then a saved state in place of it, and some more steps: sums and places then, and the shares of particles that were searched.
fn from_state(kind: &dyn EngineKind, changes: &[(&str, &str)], before: u64, saved: &Seen) -> (String, Vec<f64>) {
    let setup = setup(CORNER, changes);
    kind.take_deck("a-deck", &setup.deck_text);
    let mut simulation = Simulation::start(kind, setup.model, setup.particles).unwrap();
    let mut searched = Vec::new();
    let mut steps = |simulation: &mut Simulation, count| {
        for _ in 0..count {
            searched.push(simulation.step(None).unwrap().searched_fraction);
        }
    };
    steps(&mut simulation, before);
    simulation.persist(&mut saved.to_load()).unwrap();
    steps(&mut simulation, 15);
    let told = format!("{:?} {:?}", simulation.ledger().unwrap(), simulation.read("position").unwrap());
    (told, searched)
}

#[test]
fn a_state_whose_particles_come_in_another_order_is_searched_with_its_own_smoothing_lengths() {
    // Two spacings, so that smoothing lengths differ from particle to particle.
    let two = [("body.1.spacing", "\"0.3 mm\""), ("body.1.shape.box.min", "[\"0 mm\", \"8.4 mm\"]")];
    let search = |bound: &'static str| ("search", bound);
    let often = search("{ adaptive = { plastic-strain-threshold = 1e-9, strain-bound = 1e-9 } }");
    let seldom = search("{ adaptive = { plastic-strain-threshold = 1e-2, strain-bound = 0.05 } }");
    let [often, seldom] = [often, seldom].map(|search| [&two[..], &[search]].concat());
    // All particles are searched in each step, so that they have been sorted anew when the state is saved.
    let deck: Worked<'_> = (CORNER, &often, |ledger| vec![ledger.viscous_energy]);
    let (_, saved) = after_steps(&Cpu, &deck, None, 100);
    let (expected, _) = from_state(&Cpu, &seldom, 0, &saved);
    let (found, searched) = led(2, 1, |leader| from_state(leader, &seldom, 10, &saved));
    // Before and after, some are searched, and never all of them.
    let some = |shares: &[f64]| shares.iter().any(|share| (1e-9..0.99).contains(share));
    assert!(some(&searched[..10]) && some(&searched[10..]) && searched[10..].iter().all(|s| *s < 0.99), "{searched:?}");
    assert!(found == expected);
}

#[test]
fn a_state_that_each_rank_has_kept_is_gone_back_to_when_particles_have_moved_on_to_other_ranks() {
    let deck = &DECKS[0];
    let (expected, _) = after_steps(&Cpu, deck, None, 60);
    let found = led(3, 1, |leader| {
        let setup = setup(deck.0, deck.1);
        leader.take_deck("a-deck", &setup.deck_text);
        let mut simulation = Simulation::start(leader, setup.model, setup.particles).unwrap();
        let steps = |simulation: &mut Simulation, count| {
            for _ in 0..count {
                simulation.step(None).unwrap();
            }
        };
        steps(&mut simulation, 40);
        let mut kept = MemoryArchive::in_parts();
        simulation.persist(&mut kept).unwrap();
        // The first rank has no more than its own.
        let mut whole = ByteCount::default();
        simulation.persist(&mut whole).unwrap();
        let share = kept.bytes() as f64 / whole.0 as f64;
        assert!((0.25..0.45).contains(&share), "{share}");
        // Sorted and shared anew in between.
        steps(&mut simulation, 100);
        for _ in 0..2 {
            simulation.persist(&mut kept.reader()).unwrap();
            steps(&mut simulation, 20);
        }
        format!("{:?} {:?}", simulation.ledger().unwrap(), simulation.read("position").unwrap())
    });
    assert!(found == expected);
}

#[test]
fn a_state_that_a_program_drives_is_refused_by_all_ranks() {
    let deck = &DECKS[0];
    let driven = {
        let setup = setup(deck.0, deck.1);
        let mut simulation = Simulation::start(&Cpu, setup.model, setup.particles).unwrap();
        let forces = vec![Some([1e3, 0.0, 0.0]); simulation.model().bodies.len()];
        let drive = Drive { forces, ..Drive::none(simulation.model()) };
        simulation.drive(&drive).unwrap();
        simulation.step(None).unwrap();
        let mut state = Seen::default();
        simulation.persist(&mut state).unwrap();
        state
    };
    let (expected, plain) = after_steps(&Cpu, deck, None, 1);
    led(2, 1, |leader| {
        let setup = setup(deck.0, deck.1);
        leader.take_deck("a-deck", &setup.deck_text);
        let mut simulation = Simulation::start(leader, setup.model, setup.particles).unwrap();
        assert!(!simulation.can_be_driven());
        let refused = simulation.persist(&mut driven.to_load()).unwrap_err();
        assert!(refused.to_string().contains("a program gave loads"), "{refused}");
        // The next one is loaded all the same.
        simulation.persist(&mut plain.to_load()).unwrap();
        let told = format!("{:?} {:?}", simulation.ledger().unwrap(), simulation.read("position").unwrap());
        assert!(told == expected);
    });
}
