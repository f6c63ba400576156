//! Every strategy with every feature, saved here and there and gone on with on other threads.

use super::super::setup::run_steps;
use super::{
    Changes, EVERY_STEP, FEATURES, FROZEN, Feature, GRAVITY, GUARDED, HEAT, LAGRANGIAN, PERIODIC, PUBLISHED, Picture,
    SEARCHES, SKIN, STRIKE, SYMMETRY, WALLS, start,
};
use sphorge::{
    deck,
    engine::{Simulation, persist::MemoryArchive},
};

fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

fn saved(simulation: &mut Simulation) -> MemoryArchive {
    let mut archive = MemoryArchive::new();
    simulation.persist(&mut archive).unwrap();
    archive.to_load()
}

/// Runs to the end, saving on the way; then from each of the saved states to the end, on other threads. What is loaded must be what
/// was saved, and every run must come to the same end. Returns whether a step searched some particles and kept others.
fn resumes(what: &str, new: impl Fn() -> Simulation + Sync, stops: &[u64], end: u64) -> bool {
    let (saved, last, partial) = on_threads(1, || {
        let mut simulation = new();
        let (mut archives, mut partial) = (Vec::new(), false);
        loop {
            if stops.contains(&simulation.steps()) {
                archives.push((simulation.steps(), saved(&mut simulation), Picture::of(&mut simulation)));
            }
            if simulation.steps() == end {
                return (archives, Picture::of(&mut simulation), partial);
            }
            let report = simulation.step(None).unwrap_or_else(|failure| panic!("{what}: {failure}"));
            partial |= (f64::EPSILON..1.0).contains(&report.searched_fraction);
        }
    });
    assert_eq!(saved.len(), stops.len());
    for (stop, mut archive, expected) in saved {
        on_threads(2, || {
            let mut simulation = new();
            simulation.persist(&mut archive).unwrap_or_else(|error| panic!("{what}: {error}"));
            let differing = expected.differences(&Picture::of(&mut simulation));
            assert!(differing.is_empty(), "{what}, loaded at step {stop}: {differing:?}");
            run_steps(&mut simulation, end - stop);
            let differing = last.differences(&Picture::of(&mut simulation));
            assert!(differing.is_empty(), "{what}, resumed at step {stop}: {differing:?}");
        });
    }
    partial
}

/// Whether a deck may have all of these.
fn go_together(search: &str, integrator: &str, feature: &Feature) -> bool {
    let initial = [LAGRANGIAN, FROZEN].contains(&search);
    let refused = initial && integrator == "predictor-corrector"
        || (search == FROZEN || search == PUBLISHED) && feature.name.contains("penalty")
        // Bodies in total Lagrangian form do not meet across periodic ends.
        || search == LAGRANGIAN && feature.before == PERIODIC
        || ![EVERY_STEP, SKIN].contains(&search) && feature.name == "follow-density";
    !refused
}

fn is_refused(deck: &str, search: &str, changes: Changes<'_>) -> bool {
    let changes = [&[("search", search)], changes].concat();
    let changes: Vec<_> = changes.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
    deck::load_text("test", deck, &changes).is_err()
}

/// Every strategy with every feature and both integrators, a half in each precision, so that each of them is seen with each of the others.
fn every_search_resumes(precision: &str) {
    for (a, search) in SEARCHES.into_iter().enumerate() {
        for (b, integrator) in ["leapfrog", "predictor-corrector"].into_iter().enumerate() {
            for (c, feature) in FEATURES.iter().enumerate() {
                let half = if (a + b + c) % 2 == 0 { "mixed" } else { "double" };
                if precision != half {
                    continue;
                }
                let own = [("numerics.precision", precision), ("numerics.integrator", integrator)];
                let changes = [&own, feature.changes].concat();
                let (deck, what) = (feature.deck(), format!("{search}, {integrator}, {}", feature.name));
                let together = go_together(search, integrator, feature);
                assert_eq!(is_refused(&deck, search, &changes), !together, "{what}");
                if together {
                    // Particles are sorted after 64 searches.
                    let partial = resumes(&what, || start(&deck, search, &changes), &[37], 72);
                    assert!(partial || search != GUARDED, "{what}: no step searched some particles only");
                }
            }
        }
    }
}

#[test]
fn every_search_resumes_in_mixed_precision() {
    every_search_resumes("mixed");
}

#[test]
fn every_search_resumes_in_double_precision() {
    every_search_resumes("double");
}

#[test]
fn a_state_from_before_the_first_steps_resumes() {
    let deck = format!("{GRAVITY}\n{STRIKE}{WALLS}");
    for search in SEARCHES {
        resumes(search, || start(&deck, search, &[]), &[0, 1, 2], 9);
    }
}

#[test]
fn bodies_that_stand_still_and_conduct_resume() {
    let deck = format!("{SYMMETRY}\n{STRIKE}{HEAT}");
    for search in [SKIN, LAGRANGIAN] {
        resumes(search, || start(&deck, search, &[("thermal.mechanics", "false")]), &[0, 1, 11], 20);
    }
}

/// A block strikes the end of a bar in space, half of which is behind a plane of symmetry.
const IN_SPACE: &str = r#"
dimensions = "3d"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
time = { end = "4 us" }
symmetry = [{ axis = "z" }]

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm", "0 mm"], max = ["9 mm", "4 mm", "4 mm"] } }

[[body]]
name = "striker"
material = "armco-iron"
shape = { box = { min = ["-4 mm", "0 mm", "0 mm"], max = ["0 mm", "4 mm", "4 mm"] } }
velocity = ["300 m/s", "0 m/s", "0 m/s"]
"#;

#[test]
fn a_strike_in_space_resumes() {
    for search in [SKIN, GUARDED, PUBLISHED] {
        resumes(search, || start(IN_SPACE, search, &[]), &[14], 30);
    }
}

#[test]
fn gradients_at_faces_resume() {
    let of = |deck: &'static str, faces: &str, renewal: f64| {
        let search = format!("{{ total-lagrangian = {{ faces = \"{faces}\", renewal = {renewal} }} }}");
        move || start(deck, &search, &[])
    };
    resumes("faces", of(STRIKE, "quadratic", 0.0), &[3, 40], 80);
    resumes("faces, renewed", of(STRIKE, "quadratic", 1.1), &[40, 110], 150);
    resumes("faces in space", of(IN_SPACE, "quadratic", 0.0), &[14], 30);
    let end = |faces: &str| {
        let mut simulation = of(STRIKE, faces, 0.0)();
        run_steps(&mut simulation, 80);
        simulation.particles().unwrap().position.clone()
    };
    assert_ne!(end("quadratic"), end("linear"), "there were no faces");
}

#[test]
fn a_body_whose_reference_is_renewed_resumes() {
    let end = |renewal: &str| {
        let search = format!("{{ total-lagrangian = {{ renewal = {renewal} }} }}");
        let new = || start(STRIKE, &search, &[]);
        resumes(&format!("renewal {renewal}"), new, &[40, 110], 150);
        let mut simulation = new();
        run_steps(&mut simulation, 150);
        simulation.particles().unwrap().position.clone()
    };
    assert_ne!(end("1.1"), end("0"), "nothing was renewed");
}
