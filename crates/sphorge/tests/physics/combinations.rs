//! Every search strategy together with the other choices of a deck: the answer of a search every step, or a refusal that says why.

use super::setup::{by_id, norm, simulation};
use sphorge::{deck, engine::Simulation};

/// A block strikes the end of a bar so long that its other end stays alone.
const STRIKE: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
time = { end = "4 us" }

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["50 mm", "6 mm"] } }

[[body]]
name = "striker"
material = "armco-iron"
shape = { box = { min = ["-8 mm", "0 mm"], max = ["-1 mm", "6 mm"] } }
velocity = ["300 m/s", "0 m/s"]
"#;

/// The same in space, thinner.
const STRIKE_IN_SPACE: &str = r#"
dimensions = "3d"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
time = { end = "4 us" }

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm", "0 mm"], max = ["40 mm", "4 mm", "4 mm"] } }

[[body]]
name = "striker"
material = "armco-iron"
shape = { box = { min = ["-6 mm", "0 mm", "0 mm"], max = ["-1 mm", "4 mm", "4 mm"] } }
velocity = ["300 m/s", "0 m/s", "0 m/s"]
"#;

/// A bar that is pressed together beyond yield.
const SQUEEZE: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
time = { end = "4 us" }

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["40 mm", "8 mm"] } }
velocity-profile = { along = "x", amplitude = ["60 m/s", "0 m/s"], rows = [["0 mm", 1.0], ["40 mm", -1.0]] }
"#;

const PLAIN: &[(&str, &str)] = &[];
const PENALTY: &[(&str, &str)] = &[("contact", "penalty")];
const PREDICTOR: &[(&str, &str)] = &[("numerics.integrator", "predictor-corrector")];
const CORRECTED: &[(&str, &str)] = &[("numerics.gradient-correction", "linear")];
const MIRRORED: &[(&str, &str)] = &[("symmetry", "[{ axis = \"y\" }]")];
const PERIODIC: &[(&str, &str)] = &[("periodic", "{ y = [\"0 mm\", \"6 mm\"] }")];

/// A run to the end of the deck, and whether a step searched some particles and kept others.
fn run(deck: &str, search: &str, choices: &[(&str, &str)]) -> (Simulation, bool) {
    let overrides: Vec<_> = [("search", search)].into_iter().chain(choices.iter().copied()).collect();
    let mut simulation = simulation(deck, &overrides);
    let end = simulation.model().time.end;
    let mut partial = false;
    while simulation.time() < end {
        simulation.step(Some(end)).unwrap_or_else(|failure| panic!("{search} {choices:?}: {failure}"));
        let adapted = &simulation.particles().unwrap().adapted;
        partial |= adapted.contains(&0) && adapted.contains(&1);
    }
    (simulation, partial)
}

/// Largest distance of particles of the same id over the longest way of any.
fn apart(a: &Simulation, b: &Simulation, start: &Simulation) -> f64 {
    let (order_a, order_b, order_start) =
        (by_id(a.particles().unwrap()), by_id(b.particles().unwrap()), by_id(start.particles().unwrap()));
    let between = |p: &Simulation, i: usize, q: &Simulation, j: usize| {
        let (x, y) = (p.particles().unwrap().position[i], q.particles().unwrap().position[j]);
        norm([0, 1, 2].map(|k| x[k] - y[k]))
    };
    let ids = || 0..order_a.len();
    let difference = ids().map(|id| between(a, order_a[id], b, order_b[id])).fold(0.0, f64::max);
    let way = ids().map(|id| between(a, order_a[id], start, order_start[id])).fold(0.0, f64::max);
    difference / way
}

#[test]
fn skins_and_adaptive_search_give_the_answer_of_every_step_with_every_other_choice() {
    for (deck, choices) in [
        (STRIKE, PLAIN),
        (STRIKE, PENALTY),
        (STRIKE, PREDICTOR),
        (STRIKE, CORRECTED),
        (STRIKE, MIRRORED),
        (STRIKE, PERIODIC),
        (STRIKE_IN_SPACE, PLAIN),
        (STRIKE_IN_SPACE, PENALTY),
        (STRIKE_IN_SPACE, PREDICTOR),
        (STRIKE_IN_SPACE, MIRRORED),
    ] {
        let (reference, _) = run(deck, "every-step", choices);
        let start = simulation(deck, choices);
        let strained = reference.particles().unwrap().plastic_strain.iter().fold(0.0, |m: f64, &e| m.max(e));
        assert!(strained > 0.01, "{choices:?}: {strained}");
        for search in ["skin", "adaptive"] {
            let (other, partial) = run(deck, search, choices);
            assert!(partial == (search == "adaptive"), "{search} {choices:?}");
            // Pairs at the edge of the support, where the kernel gradient all but vanishes.
            let apart = apart(&reference, &other, &start);
            assert!(apart < 1e-6, "{search} {choices:?}: {apart:.1e}");
        }
    }
}

#[test]
fn the_total_lagrangian_form_gives_about_the_answer_of_every_step_with_every_choice_it_takes() {
    for choices in [PLAIN, CORRECTED, MIRRORED, &[("periodic", "{ y = [\"0 mm\", \"8 mm\"] }")]] {
        let (reference, _) = run(SQUEEZE, "every-step", choices);
        let start = simulation(SQUEEZE, choices);
        let (lagrangian, _) = run(SQUEEZE, "total-lagrangian", choices);
        // Other sums: they differ by what sums over neighbours of either kind miss at free faces.
        let apart = apart(&reference, &lagrangian, &start);
        assert!(apart < 0.1, "{choices:?}: {apart:.1e}");
    }
}

#[test]
fn what_a_search_cannot_serve_is_refused_with_the_reason() {
    for (search, choices, reason) in [
        ("total-lagrangian", &[("contact", "kernel-sum")][..], "over the particles of one body"),
        ("total-lagrangian", PERIODIC, "across the ends of a periodic cell"),
        ("{ total-lagrangian = { form = \"frozen\" } }", PENALTY, "do not include approaching bodies"),
        ("{ adaptive = { guard = \"none\" } }", PENALTY, "without its guard"),
        ("total-lagrangian", PREDICTOR, "integrated by leapfrog"),
    ] {
        let overrides = [("search", search)].into_iter().chain(choices.iter().copied());
        let overrides: Vec<_> = overrides.map(|(path, value)| (path.to_owned(), value.to_owned())).collect();
        let report = deck::load_text("deck", STRIKE, &overrides).err().map(|report| report.to_string());
        assert!(report.as_ref().is_some_and(|report| report.contains(reason)), "{search}: {report:?}");
    }
}

#[test]
fn an_audit_does_not_change_a_bit_of_the_run() {
    for search in ["every-step", "skin", "adaptive", "total-lagrangian"] {
        let (audited, _) = run(SQUEEZE, search, &[("audit", "1")]);
        let (alone, _) = run(SQUEEZE, search, PLAIN);
        let [audited, alone] =
            [&audited, &alone].map(|s| (s.particles().unwrap().id.clone(), s.particles().unwrap().position.clone()));
        assert!(audited == alone, "{search}");
    }
}
