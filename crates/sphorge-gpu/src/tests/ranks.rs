//! Several GPUs that share the particles of a run: to the bit what one GPU computes. Ranks are threads here.

use super::card::gpu;
use super::contact::{CONDUCT, PRESENT, RUBS, in_space, slabs, striking};
use super::engine::{IRON, components, start_text};
use super::facet_contact;
use super::periodic::{ACROSS, JOINED, LEAVES};
use super::renewal::PULLED;
use super::self_contact::{BLOCKS, closing};
use super::verlet_lists::BULLET;
use sphorge_deck::{Setup, decks, load_text};
use sphorge_engine::model::{Extremum, ParticleSelection};
use sphorge_engine::particles::FIELDS;
use sphorge_engine::persist::{Archive, ArchiveError, MemoryArchive};
use sphorge_engine::ranks::{Loaded, RankFiles};
use sphorge_engine::reduction::{Quantity, Suspicion};
use sphorge_engine::{Audit, EngineKind, FieldSource, Model, PartKind, ParticleSource, Reduction, Simulation};
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

    fn setup(&self) -> Option<Setup> {
        let overrides: Vec<_> =
            self.overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        load_text(self.name, self.text, &overrides).ok()
    }

    fn start(&self, kind: &dyn EngineKind) -> Simulation {
        start_text(kind, self.name, self.text, self.overrides)
    }
}

/// Other ranks load the deck as the first one does, and write nothing.
impl RankFiles for Deck<'_> {
    fn load(&self, _: &str, _: &str) -> Option<Loaded> {
        let setup = self.setup()?;
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

/// What the first of some GPUs makes of them.
fn led<T>(deck: Deck<'_>, ranks: usize, lead: impl FnOnce(&Leader) -> T) -> T {
    let kind: Arc<dyn PartKind> = Arc::new(gpu());
    let mut communicators = threads(ranks);
    thread::scope(|scope| {
        for communicator in communicators.split_off(1) {
            let kinds = [kind.clone()];
            scope.spawn(move || follow_with(communicator, Some(1), &kinds, &deck).unwrap());
        }
        lead(&Leader::of(kind, communicators.remove(0)))
    })
}

/// All fields of a run, by their names.
fn fields(simulation: &Simulation) -> Vec<(&'static str, Vec<f64>)> {
    FIELDS.iter().map(|field| (field.name, components(&simulation.read(field.name).unwrap()))).collect()
}

/// Runs to a step; what was searched of each step, how many pairs were summed, and what audits have found.
fn run(simulation: &mut Simulation, steps: u64) -> Vec<(f64, u64, Option<Audit>)> {
    let mut told = Vec::new();
    while simulation.steps() < steps {
        let report = simulation.step(None).unwrap();
        told.push((report.searched_fraction, report.pairs, report.audit));
    }
    told
}

/// What must be the same on any number of GPUs.
fn assert_same(found: &Simulation, expected: &Simulation, what: &str) {
    assert_eq!(found.time(), expected.time(), "{what}");
    for ((name, found), (_, expected)) in fields(found).iter().zip(&fields(expected)) {
        assert!(found == expected, "`{name}` differs: {what}");
    }
    let forces = |simulation: &Simulation| -> Vec<Vec<f64>> {
        let sections = &simulation.model().sections;
        sections.iter().map(|section| simulation.reduce(&Reduction::SectionForce(section)).unwrap()).collect()
    };
    assert_eq!(forces(found), forces(expected), "{what}");
    assert_eq!(found.ledger().unwrap(), expected.ledger().unwrap(), "{what}");
    let (of, last) = (&ParticleSelection::default(), expected.count() as u32 - 1);
    let quantity = |field| Quantity { field, component: None };
    let point = expected.particles().unwrap().position[last as usize / 2];
    let reductions = [
        Reduction::Extent { of, axis: 0 },
        Reduction::Diameter { of, axis: 1 },
        Reduction::Mean { of, quantity: quantity("speed") },
        Reduction::Extremum { of, quantity: quantity("pressure"), extremum: Extremum::Minimum },
        Reduction::Interpolation { of, quantity: quantity("density"), point },
        Reduction::OfParticle { id: last, quantity: quantity("velocity") },
        Reduction::Slabs { of, quantity: quantity("pressure"), axis: 0, direction: 1.0 },
        Reduction::Nearest { point, body: None },
        // All are cold, and many as cold as each other.
        Reduction::Suspects(Suspicion::Cold(1e5)),
        Reduction::Suspects(Suspicion::Lonely),
    ];
    for reduction in reductions {
        assert_eq!(found.reduce(&reduction).unwrap(), expected.reduce(&reduction).unwrap(), "{what}: {reduction:?}");
    }
}

/// Compares so many steps on each number of ranks with one GPU.
fn compare(deck: Deck<'_>, steps: u64, ranks: &[usize]) {
    let mut alone = deck.start(&gpu());
    let told = run(&mut alone, steps);
    for ranks in ranks {
        led(deck, *ranks, |root| {
            let mut simulation = deck.start(root);
            assert_eq!(run(&mut simulation, steps), told, "{ranks} ranks, {}", deck.name);
            assert_same(&simulation, &alone, &format!("{ranks} ranks, {}", deck.name));
        });
    }
}

const PLATE: (&str, &str) = ("particles.spacing", "\"0.6 mm\"");

#[test]
fn a_search_every_step() {
    compare(Deck::shipped("taylor-plate", &[PLATE]), 60, &[3]);
    let more = [PLATE, ("numerics.gradient-correction", "\"linear\""), ("numerics.mls-interval", "4")];
    let follows = [("numerics.smoothing-length", "\"follow-density\""), ("numerics.integrator", "\"leapfrog\"")];
    compare(Deck::shipped("taylor-plate", &[&more[..], &follows].concat()), 20, &[2]);
}

#[test]
fn verlet_lists_on_ranks() {
    // The bullet meets the plate; particles of both are with both ranks.
    let far = [("body.bullet.velocity", "[\"0 m/s\", \"0 m/s\", \"-2000 m/s\"]"), ("search", "\"skin\"")];
    compare(Deck::shipped("bullet", &[&BULLET[..], &far].concat()), 40, &[2]);
}

#[test]
fn a_periodic_axis() {
    let periodic = [
        PLATE,
        ("periodic", "{ x = [\"-3.8 mm\", \"3.8 mm\"] }"),
        ("numerics.artificial-stress", "false"),
        ("body.plate.velocity", "[\"900 m/s\", \"-200 m/s\"]"),
    ];
    compare(Deck::shipped("taylor-plate", &periodic), 60, &[3]);
}

#[test]
fn a_periodic_axis_by_the_default_method_and_with_contact() {
    compare(Deck::shipped(IRON.0, &[&JOINED[..], &[("audit", "20")]].concat()), 80, &[3]);
    let text = striking(&format!("{PRESENT}\n{RUBS}"));
    compare(Deck { name: "striking", text: &text, overrides: &ACROSS }, 60, &[2]);
    let skin = [("search", "\"skin\""), ("numerics.integrator", "\"leapfrog\"")];
    compare(Deck { name: "striking", text: &text, overrides: &[&ACROSS[..], &skin].concat() }, 60, &[3]);
    let adaptive = [&LEAVES[..], &[("search", "\"adaptive\""), skin[1]]].concat();
    compare(Deck::shipped("taylor-plate", &adaptive), 80, &[2]);
}

#[test]
fn variable_smoothing_lengths_in_verlet_lists() {
    let skin = [("search", "\"skin\""), ("numerics.smoothing-length", "\"follow-density\"")];
    let disc = [("particles.spacing", "\"0.8 mm\""), ("time.courant", "0.1"), skin[0], skin[1]];
    compare(Deck::shipped("penetration", &disc), 60, &[2]);
    let text = striking(&format!("{PRESENT}\n{RUBS}"));
    compare(Deck { name: "striking", text: &text, overrides: &skin }, 100, &[3]);
}

#[test]
fn bodies_in_contact_at_facets() {
    let text = striking(facet_contact::RUBS);
    compare(Deck { name: "striking", text: &text, overrides: &CONDUCT }, 120, &[3]);
    let text = in_space(facet_contact::RUBS);
    compare(Deck { name: "striking", text: &text, overrides: &[] }, 60, &[2]);
}

#[test]
fn nine_bodies_in_contact() {
    let text = slabs(RUBS);
    compare(Deck { name: "slabs", text: &text, overrides: &[] }, 60, &[3]);
}

#[test]
fn the_default_method() {
    compare(Deck::shipped("iron-plate", &[("particles.spacing", "\"0.64 mm\"")]), 60, &[2]);
    let sections = "[{ name = \"foot\", point = [\"0 mm\", \"0 mm\", \"2 mm\"], normal = [0, 0, 1] }]";
    compare(Deck::shipped("copper-bar", &[("particles.spacing", "\"0.95 mm\""), ("section", sections)]), 40, &[3]);
}

#[test]
fn bodies_in_contact() {
    let text = striking(RUBS);
    compare(Deck { name: "striking", text: &text, overrides: &CONDUCT }, 250, &[3]);
    let text = in_space(&format!("{PRESENT}\n{RUBS}"));
    compare(Deck { name: "in space", text: &text, overrides: &[("search", "\"skin\"")] }, 40, &[2]);
}

#[test]
fn approaching_bodies_need_capacity_for_more_ghosts() {
    let plate = |name: &str, y: [f64; 2], velocity: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nmaterial = \"ofhc-copper\"\nvelocity = [\"0 m/s\", \"{velocity} m/s\"]\n\
             shape = {{ box = {{ min = [\"0 mm\", \"{} mm\"], max = [\"64 mm\", \"{} mm\"] }} }}\n",
            y[0], y[1]
        )
    };
    let (lower, upper) = (plate("lower", [-8.0, 0.0], 600.0), plate("upper", [2.0, 10.0], -600.0));
    let head = "dimensions = \"plane-strain\"\nparticles = { spacing = \"0.5 mm\" }\ntime = { end = \"60 us\" }\n";
    for method in [format!("{RUBS}\n"), format!("{PRESENT}\n{RUBS}\n")] {
        let text = format!("{head}{method}{lower}{upper}");
        let deck = Deck { name: "plates", text: &text, overrides: &[] };
        let mut alone = deck.start(&gpu());
        run(&mut alone, 70);
        led(deck, 2, |root| {
            let mut simulation = deck.start(root);
            let before = simulation.memory_bytes();
            run(&mut simulation, 70);
            assert!(simulation.memory_bytes() > before, "there is room for all ghosts from the start");
            assert_same(&simulation, &alone, "plates");
        });
    }
}

#[test]
fn a_body_that_meets_itself() {
    let text = closing(BLOCKS, RUBS);
    compare(Deck { name: "closing", text: &text, overrides: &[] }, 250, &[3]);
}

#[test]
fn a_body_that_separates() {
    let renewal = [("search.total-lagrangian.renewal", "1.2")];
    compare(Deck { name: "pulled", text: PULLED, overrides: &renewal }, 200, &[2]);
    let text = closing(BLOCKS, &format!("{RUBS}\nsearch = {{ total-lagrangian = {{ renewal = 1.2 }} }}"));
    compare(Deck { name: "closing and apart", text: &text, overrides: &[] }, 300, &[2]);
}

#[test]
fn heat_that_flows() {
    let bar = [("particles.spacing", "\"0.8 mm\""), ("material.42crmo4-steel.conductivity", "\"2e5 W/(m K)\"")];
    compare(Deck::shipped("taylor-bar-42crmo4", &bar), 30, &[2]);
    compare(Deck::shipped("two-materials", &[("particles.spacing", "\"1 mm\"")]), 30, &[2]);
}

#[test]
fn a_state_is_the_same_whoever_has_saved_it() {
    let text = striking(&format!("{PRESENT}\n{RUBS}"));
    let skin = [("search", "\"skin\""), ("numerics.integrator", "\"leapfrog\"")];
    let adaptive = [("search", "\"adaptive\""), skin[1]];
    for deck in [
        Deck::shipped("iron-plate", &[("particles.spacing", "\"0.64 mm\"")]),
        Deck::shipped("taylor-plate", &[PLATE]),
        Deck { name: "striking", text: &text, overrides: &skin },
        Deck { name: "striking", text: &text, overrides: &adaptive },
    ] {
        let mut alone = deck.start(&gpu());
        let (half, end) = (60, 100);
        run(&mut alone, half);
        let mut archive = MemoryArchive::new();
        alone.persist(&mut archive).unwrap();
        run(&mut alone, end);
        // Of one GPU, taken by two ranks, whose state is taken by three, whose is taken by one GPU.
        for ranks in [2, 3] {
            archive = led(deck, ranks, |root| {
                let mut simulation = deck.start(root);
                simulation.persist(&mut archive.to_load()).unwrap();
                assert_eq!(simulation.steps(), half);
                let mut saved = MemoryArchive::new();
                simulation.persist(&mut saved).unwrap();
                run(&mut simulation, end);
                assert_same(&simulation, &alone, &format!("{} on {ranks} ranks from a saved state", deck.name));
                // In parts, each in the memory of its rank, and taken back.
                let mut parts = MemoryArchive::in_parts();
                simulation.persist(&mut parts).unwrap();
                run(&mut simulation, end + 5);
                simulation.persist(&mut parts.to_load()).unwrap();
                assert_same(&simulation, &alone, &format!("{} on {ranks} ranks from parts", deck.name));
                saved
            });
        }
        let mut again = deck.start(&gpu());
        again.persist(&mut archive.to_load()).unwrap();
        run(&mut again, end);
        assert_same(&again, &alone, &format!("{} from the state of three ranks", deck.name));
    }
}

#[test]
fn a_failure_is_that_of_the_rank_that_has_the_particle() {
    let deck = Deck::shipped(
        "taylor-plate",
        &[PLATE, ("time.step-control.stretch", "0.001"), ("body.plate.velocity", "[\"0 m/s\", \"-900 m/s\"]")],
    );
    let fails = |kind: &dyn EngineKind| {
        let mut simulation = deck.start(kind);
        (0..200).find_map(|_| simulation.step(None).err()).expect("changes of a thousandth are too large")
    };
    let alone = fails(&gpu());
    assert!(alone.particle.is_some(), "{alone}");
    for ranks in [2, 3] {
        assert_eq!(led(deck, ranks, |root| fails(root)), alone);
    }
}

#[test]
fn an_adaptive_search() {
    // The bullet flies on while rows of the plate are searched and patched.
    let fast = ("body.bullet.velocity", "[\"0 m/s\", \"0 m/s\", \"-2000 m/s\"]");
    let guarded = [("search", "\"adaptive\""), ("audit", "20"), fast];
    compare(Deck::shipped("bullet", &[&BULLET[..], &guarded].concat()), 60, &[3]);
    let published = [("search", "{ adaptive = { guard = \"none\" } }"), ("audit", "20"), fast];
    compare(Deck::shipped("bullet", &[&BULLET[..], &published].concat()), 40, &[2]);
}

#[test]
fn kernel_values_of_the_start() {
    let frozen = ("search", "{ total-lagrangian = { form = \"frozen\" } }");
    compare(Deck::shipped("taylor-plate", &[PLATE, frozen]), 40, &[2]);
    compare(Deck::shipped("taylor-plate", &[PLATE, frozen, ("audit", "5")]), 40, &[2]);
}
