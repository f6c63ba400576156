use super::*;
use crate::{
    engine::{BodyLedger, ContactLedger, Energies, WallLedger, persist::MemoryArchive},
    model::{AdaptiveSearch, TimeTable, Wall, WallContact, WallSurface},
    output::testing,
    particles::Particles,
};

const CLOCK: Clock = Clock { step: 40, time: 0.5 };

/// A run of one body of two particles within a metre that has begun with 100 J of motion.
fn begun(model: &Model) -> Watch {
    let start = Start { kinetic: 100.0, high: [1.0, 0.0, 0.0], speed: 10.0, nothing: 1e-3, ..Start::default() };
    Watch { start: Some(start), ..Watch::new(model) }
}

/// Kinetic and internal energy, plastic work, external work, all J, of one body.
fn ledger(kinetic: f64, internal: f64, plastic_work: f64, external_work: f64) -> Ledger {
    let energies = Energies { kinetic, internal, elastic: 0.0, plastic_work };
    let total = BodyLedger { mass: 1.0, energies, ..BodyLedger::default() };
    Ledger { bodies: vec![total], total, external_work, ..Ledger::default() }
}

/// Names and worst numbers.
fn found(watch: &Watch, model: &Model) -> Vec<(String, f64)> {
    watch.records(model).into_iter().map(|record| (record.name, record.value)).collect()
}

fn one(name: &str, number: f64) -> Vec<(String, f64)> {
    vec![(name.to_owned(), number)]
}

#[test]
fn plastic_work_is_held_against_all_that_was_supplied() {
    let model = testing::model(&["bar"]);
    let mut watch = begun(&model);
    watch.look_at_ledger(&model, &ledger(0.0, 100.0, 100.9, 0.0), CLOCK);
    assert_eq!(watch.count(), 0);
    // 50 J of work, 20 J of heat: what a wall takes back later is still spent.
    let mut warm = ledger(0.0, 170.0, 170.0, 50.0);
    warm.heat.supplied = vec![20.0];
    watch.look_at_ledger(&model, &warm, CLOCK);
    watch.look_at_ledger(&model, &ledger(0.0, 150.0, 170.0, -10.0), CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_ledger(&model, &ledger(0.0, 150.0, 340.0, 0.0), CLOCK);
    watch.look_at_ledger(&model, &ledger(0.0, 150.0, 204.0, 0.0), CLOCK);
    assert_eq!(found(&watch, &model), one("plastic-work", 2.0));
}

#[test]
fn heat_that_bodies_give_each_other_is_supplied() {
    // At rest, a body that is 50 K hotter than another: 400 J/(kg K) of each kilogram may expand what is colder.
    let deck = r#"
        dimensions = "1d"
        particles = { spacing = "1 mm" }
        time = { end = "1 us" }
        body = [
            { name = "hot", material = "metal", shape = { box = { min = ["0 m"], max = ["1 m"] } }, temperature = "350 K" },
            { name = "cold", material = "metal", shape = { box = { min = ["1 m"], max = ["2 m"] } }, temperature = "300 K" },
        ]
        thermal = {}
        material.metal = { density = "8000 kg/m^3", specific-heat = "400 J/(kg K)", conductivity = "300 W/(m K)", bulk-modulus = "128 GPa", equation-of-state = "linear", strength = "none" }
    "#;
    let mut model = crate::deck::load_text("metal", deck, &[]).unwrap_or_else(|report| panic!("{report:?}")).model;
    let start = Start { high: [1.0, 0.0, 0.0], nothing: 1e-3, ..Start::default() };
    let internal = [0, 1].map(|body| energy_at_start(&model, body));
    let bodies = internal.map(|internal| BodyLedger {
        mass: 1.0,
        energies: Energies { internal, ..Energies::default() },
        ..BodyLedger::default()
    });
    for (conducts, expected) in [(true, 1.25), (false, LARGEST)] {
        model.thermal.conduction = conducts;
        let mut watch = Watch { start: Some(start.clone()), ..Watch::new(&model) };
        let two = |plastic_work: f64, springs: f64| Ledger {
            bodies: bodies.to_vec(),
            hourglass_energy: springs,
            ..ledger(0.0, internal[0] + internal[1], plastic_work, 0.0)
        };
        watch.look_at_ledger(&model, &two(19_000.0, 1900.0), CLOCK);
        assert_eq!(watch.count() == 0, conducts);
        watch.look_at_ledger(&model, &two(25_000.0, 0.0), CLOCK);
        let plastic = found(&watch, &model).into_iter().find(|(name, _)| name == "plastic-work").unwrap();
        assert_eq!(plastic.1, expected);
    }
}

#[test]
fn springs_may_hold_what_they_like_but_not_keep_it() {
    let model = testing::model(&["bar"]);
    let springs = |work: f64, held: f64| Ledger {
        hourglass_energy: work,
        hourglass_stored_energy: held,
        ..ledger(100.0 - work, work, 0.0, 0.0)
    };
    let mut watch = begun(&model);
    watch.look_at_ledger(&model, &springs(60.0, 50.5), CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_ledger(&model, &springs(60.0, 48.0), CLOCK);
    assert_eq!(found(&watch, &model), one("hourglass-work", 0.12));
    // What the integrator books is the error of a work at predicted velocities.
    let mut watch = begun(&model);
    watch.look_at_ledger(&model, &Ledger { integration_energy: -5.0, ..springs(60.0, 48.0) }, CLOCK);
    assert_eq!(watch.count(), 0);
    // Energy out of nothing: they hold more than they have taken.
    watch.look_at_ledger(&model, &springs(10.0, 30.0), CLOCK);
    assert_eq!(found(&watch, &model), one("hourglass-work", 0.2));
}

#[test]
fn energy_that_the_steps_lose_is_told() {
    let model = testing::model(&["bar"]);
    for sign in [-1.0, 1.0] {
        let with = |lost: f64| Ledger { integration_energy: sign * lost, ..ledger(100.0, 0.0, 0.0, 0.0) };
        let mut watch = begun(&model);
        watch.look_at_ledger(&model, &with(9.0), CLOCK);
        assert_eq!(watch.count(), 0);
        watch.look_at_ledger(&model, &with(13.0), CLOCK);
        assert_eq!(found(&watch, &model), one("integration", 0.13));
        // Heat that leaves has passed, too: a body that cools between planes stores next to nothing.
        let mut cooled = with(13.0);
        cooled.heat.supplied = vec![-500.0];
        let mut watch = begun(&model);
        watch.look_at_ledger(&model, &cooled, CLOCK);
        assert_eq!(watch.count(), 0);
        // What contacts book counts with it, but does not hide it.
        let contact = |lost: f64| ContactLedger { integration_energy: sign * lost, ..ContactLedger::default() };
        let both = |lost: f64, by_contact: f64| Ledger { contacts: vec![contact(by_contact)], ..with(lost) };
        let mut watch = begun(&model);
        watch.look_at_ledger(&model, &both(9.0, -9.0), CLOCK);
        assert_eq!(watch.count(), 0);
        watch.look_at_ledger(&model, &both(11.0, -9.0), CLOCK);
        watch.look_at_ledger(&model, &both(-2.0, 16.0), CLOCK);
        assert_eq!(found(&watch, &model), one("integration", 0.14));
    }
}

#[test]
fn contacts_give_what_they_took_and_no_more() {
    let model = testing::model(&["bar", "plate"]);
    let with = |stored: [f64; 2]| Ledger {
        contacts: stored.map(|stored_energy| ContactLedger { stored_energy, ..ContactLedger::default() }).to_vec(),
        ..ledger(100.0, 0.0, 0.0, 0.0)
    };
    let mut watch = begun(&model);
    watch.look_at_ledger(&model, &with([50.0, -0.9]), CLOCK);
    watch.look_at_ledger(&model, &with([0.0, -0.9]), CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_ledger(&model, &with([-3.0, -9.0]), CLOCK);
    assert_eq!(found(&watch, &model), one("contact-energy", 0.12));
    // Where bodies meet at facets that is a fault of the program, by overlap a matter of where they start.
    let cure_of = |model: &Model| super::cure::cure(WarningKind::ContactEnergy, model, None);
    assert!(cure_of(&model).contains("total-lagrangian"), "{}", cure_of(&model));
    let whole = crate::deck::decks::find("perforation").unwrap();
    let at = |surfaces: &str| {
        let change = ("contact.penalty.surfaces".to_owned(), surfaces.to_owned());
        crate::deck::load_text("disc", whole.text, &[change]).unwrap().model
    };
    assert!(cure_of(&at("facets")).contains("fault of the program"), "{}", cure_of(&at("facets")));
    assert!(cure_of(&at("overlap")).contains("leave `surfaces"), "{}", cure_of(&at("overlap")));
}

#[test]
fn a_vibration_may_lose_a_little_in_each_of_many_periods() {
    let model = testing::model(&["bar"]);
    let at =
        |kinetic: f64, lost: f64| Ledger { integration_energy: lost, ..ledger(kinetic, 100.0 - kinetic, 0.0, 0.0) };
    let mut watch = begun(&model);
    for (period, lost) in (1..=10).map(|period| (period, -3.0 * f64::from(period))) {
        watch.look_at_ledger(&model, &at(0.0, lost), CLOCK);
        watch.look_at_ledger(&model, &at(100.0, lost), CLOCK);
        assert_eq!(watch.count(), 0, "{period}");
    }
    // 220 of the 2000 J that have passed are too much.
    watch.look_at_ledger(&model, &at(100.0, -220.0), CLOCK);
    assert_eq!(found(&watch, &model), one("integration", 0.11));
}

#[test]
fn what_was_driven_from_the_start_supplies_what_it_moves_with() {
    let model = testing::model(&["bar"]);
    let mut watch = begun(&model);
    // 60 J of the 100 J came from a driven region, before the first row.
    watch.start.as_mut().unwrap().external_work = 60.0;
    watch.look_at_ledger(&model, &ledger(0.0, 140.0, 140.0, 100.0), CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_ledger(&model, &ledger(0.0, 140.0, 154.0, 100.0), CLOCK);
    assert!((found(&watch, &model)[0].1 - 1.1).abs() < 1e-12);
}

#[test]
fn work_out_of_nothing_is_a_large_number_and_nothing_is_none() {
    let model = testing::model(&["bar"]);
    let mut watch = begun(&model);
    watch.start.as_mut().unwrap().kinetic = 0.0;
    watch.look_at_ledger(&model, &ledger(0.0, -9e-4, 9e-4, 0.0), CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_ledger(&model, &ledger(0.0, 0.0, 1.0, 0.0), CLOCK);
    assert_eq!(found(&watch, &model), one("plastic-work", LARGEST));
}

#[test]
fn internal_energy_is_missing_in_the_whole_or_in_a_body() {
    let model = testing::model(&["bar", "plate"]);
    let mut watch = begun(&model);
    let of =
        |internal: f64| BodyLedger { energies: Energies { internal, ..Energies::default() }, ..BodyLedger::default() };
    let two = |a: f64, b: f64| Ledger { bodies: vec![of(a), of(b)], total: of(a + b), ..Ledger::default() };
    watch.look_at_ledger(&model, &two(5.0, -0.9), CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_ledger(&model, &two(5.0, -2.0), CLOCK);
    assert_eq!(found(&watch, &model), one("negative-energy", 0.02));
    assert_eq!(watch.records(&model)[0].body.as_deref(), Some("plate"));
    let mut watch = begun(&model);
    watch.look_at_ledger(&model, &two(-0.8, -0.7), CLOCK);
    assert_eq!(found(&watch, &model), one("negative-energy", 0.015));
    assert_eq!(watch.records(&model)[0].body, None);
}

#[test]
fn heat_that_may_be_taken_out_is_not_missing() {
    let deck = r#"
        dimensions = "1d"
        method = "updated-lagrangian"
        particles = { spacing = "1 mm" }
        time = { end = "1 us" }
        body = [{ name = "bar", material = "slab", shape = { box = { min = ["0 m"], max = ["1 m"] } }, temperature = "300 K" }]
        thermal = { boundary = [{ name = "ice", body = "bar", hold = "250 K" }] }
        material.slab = { density = "8000 kg/m^3", specific-heat = "400 J/(kg K)", conductivity = "300 W/(m K)", reference-temperature = "290 K", bulk-modulus = "128 GPa", equation-of-state = "linear", strength = "none" }
    "#;
    let mut model = crate::deck::load_text("slab", deck, &[]).unwrap_or_else(|report| panic!("{report:?}")).model;
    // From the 300 K of the start down to the ice; at the start the bar is 10 K above the zero of the energy.
    assert_eq!((least_energy(&model, 0), energy_at_start(&model, 0)), (-400.0 * 50.0, 400.0 * 10.0));
    // 20.1 kJ are in play: the heat of 50 K, and 100 J of motion.
    let mut watch = begun(&model);
    watch.look_at_ledger(&model, &ledger(0.0, 4e3 - 20e3 - 150.0, 0.0, 0.0), CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_ledger(&model, &ledger(0.0, 4e3 - 20e3 - 402.0, 0.0, 0.0), CLOCK);
    assert_eq!(found(&watch, &model), one("negative-energy", 0.02));
    model.thermal.conduction = false;
    assert_eq!(least_energy(&model, 0), 0.0);
    model.bodies[0].temperature = 280.0;
    assert_eq!((least_energy(&model, 0), energy_at_start(&model, 0)), (0.0, -400.0 * 10.0));
}

#[test]
fn only_walls_at_rest_must_not_work() {
    let mut model = testing::model(&["bar"]);
    let wall = |speed: f64| Wall {
        name: "wall".into(),
        surface: WallSurface::Plane { point: [0.0; 3], normal: [1.0, 0.0, 0.0] },
        velocity: [TimeTable::constant(speed), TimeTable::constant(0.0), TimeTable::constant(0.0)],
        contact: WallContact::MonaghanKos { range: 1.0 },
    };
    model.walls = vec![wall(0.0), wall(1.0)];
    let of_walls = |works: [f64; 2]| Ledger {
        walls: works.map(|work| WallLedger { work, ..WallLedger::default() }).to_vec(),
        ..ledger(0.0, 0.0, 0.0, 0.0)
    };
    let mut watch = begun(&model);
    watch.look_at_ledger(&model, &of_walls([-19.0, 500.0]), CLOCK);
    // What the spring of a wall holds is not lost: of 60 here 45.
    let held = Ledger { wall_stored_energies: vec![45.0, 0.0], ..of_walls([-60.0, 500.0]) };
    watch.look_at_ledger(&model, &held, CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_ledger(&model, &of_walls([-21.0, 500.0]), CLOCK);
    watch.look_at_ledger(&model, &of_walls([22.0, 500.0]), CLOCK);
    assert_eq!(found(&watch, &model), one("wall-energy", 0.22));
}

#[test]
fn particles_are_named_with_their_place() {
    let model = testing::model(&["bar"]);
    let mut particles = Particles::new(2);
    particles.id = vec![7, 3];
    particles.position[1] = [1.5, 0.0, 0.0];
    particles.temperature[1] = -4.0;
    let mut watch = begun(&model);
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(found(&watch, &model), one("cold", -4.0));
    particles.temperature = vec![-9.0, -1.0];
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, Clock { step: 60, time: 0.75 }).unwrap();
    let records = watch.records(&model);
    assert_eq!((records[0].value, records[0].value_time), (-9.0, 0.75));
    // First seen elsewhere and before.
    assert_eq!((records[0].step, records[0].time, records[0].particle), (40, 0.5, Some(3)));
    assert_eq!((records[0].body.as_deref(), records[0].position), (Some("bar"), Some([1.5, 0.0, 0.0])));
    let text = records[0].to_string();
    for part in
        ["cold: temperature is -9 K, limit 0 K", "500 ms (step 40)", "particle 3 of `bar`", "lower `time.courant`"]
    {
        assert!(text.contains(part), "`{part}` is not in: {text}");
    }
}

#[test]
fn who_flies_away_has_gone_farther_than_the_fastest_could() {
    let mut model = testing::model(&["bar"]);
    let mut particles = Particles::new(1);
    // A metre of length, 10 m/s for 0.5 s, 8 m/s^2 for 0.5 s: 7 m, of which three times are beyond doubt.
    model.gravity[1] = -8.0;
    particles.position[0] = [0.0, -20.0, 0.0];
    let mut watch = begun(&model);
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(watch.count(), 0);
    particles.position[0] = [0.0, -28.0, 0.0];
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(found(&watch, &model), one("far-away", 4.0));
    // Round a periodic axis one comes back.
    model.periodic[1] = Some((-1.0, 1.0));
    let mut watch = begun(&model);
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(watch.count(), 0);
}

/// A strip of copper, 10 by 10 particles at rest; the model has the limits the deck gives.
fn strip(warnings: &str) -> (Model, Particles) {
    let deck = format!(
        r#"
        dimensions = "plane-strain"
        method = "updated-lagrangian"
        particles = {{ spacing = "1 mm" }}
        time = {{ end = "1 us" }}
        body = [{{ name = "strip", material = "ofhc-copper", shape = {{ box = {{ min = ["0 mm", "0 mm"], max = ["10 mm", "10 mm"] }} }} }}]
        warnings = {{ {warnings} }}
        "#
    );
    let setup = crate::deck::load_text("strip", &deck, &[]).unwrap_or_else(|report| panic!("{report:?}"));
    let mut particles = setup.particles;
    particles.complete();
    particles.neighbors.fill(8);
    (setup.model, particles)
}

#[test]
fn lost_neighbors_are_those_lost_since_the_start() {
    let (model, mut particles) = strip("");
    let mut watch = begun(&model);
    particles.neighbors[0] = 2;
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(watch.count(), 0);
    particles.neighbors[5] = 0;
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(found(&watch, &model), one("lost-neighbors", 0.01));
    let (model, particles) = strip("lost-neighbors = 0.01");
    let mut watch = begun(&model);
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    let (_, mut particles) = strip("");
    particles.neighbors[5] = 0;
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(watch.count(), 0);
}

#[test]
fn pieces_are_those_that_were_none_at_the_start() {
    let (model, mut particles) = strip("");
    let mut watch = begun(&model);
    let fling = |particles: &mut Particles, i: usize, y: f64| particles.position[i][1] = y;
    fling(&mut particles, 0, 1.0);
    let look = |particles: &Particles, watch: &mut Watch| {
        watch.look_at(Aspect::Pieces, &(&model, particles), &model, CLOCK).unwrap();
    };
    look(&particles, &mut watch);
    fling(&mut particles, 1, 2.0);
    look(&particles, &mut watch);
    assert_eq!(watch.count(), 0);
    fling(&mut particles, 2, 3.0);
    look(&particles, &mut watch);
    let found = found(&watch, &model);
    assert!(found.len() == 1 && found[0].0 == "pieces" && (found[0].1 - 0.02).abs() < 1e-12, "{found:?}");
}

#[test]
fn density_is_held_against_the_pressure_law() {
    let (model, mut particles) = strip("");
    particles.density[3] = 0.4 * 8960.0;
    // ofhc-copper: S = 1.489, so that chi is at most 0.672 and the density 3.05 times that at rest.
    particles.density[4] = 3.2 * 8960.0;
    let mut watch = begun(&model);
    watch.look_at(Aspect::Particles, &(&model, &particles), &model, CLOCK).unwrap();
    let names: Vec<_> = found(&watch, &model).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["compression", "expansion"]);
}

#[test]
fn rows_that_fall_together_are_seen_by_their_share() {
    let (model, mut particles) = strip("pairing = 0.05");
    let pair = |particles: &mut Particles, i: usize, j: usize| {
        particles.position[j] = {
            let x = particles.position[i];
            [x[0], x[1] + 0.4e-3, 0.0]
        }
    };
    // Every other particle of a column goes up to the next: first a pair, then three.
    let at = |x: f64, y: f64, particles: &Particles| particles.nearest([x, y, 0.0], None).unwrap().0;
    let (a, b) = (at(0.5e-3, 0.5e-3, &particles), at(0.5e-3, 1.5e-3, &particles));
    let (c, d) = (at(5.5e-3, 0.5e-3, &particles), at(5.5e-3, 1.5e-3, &particles));
    let (e, f) = (at(9.5e-3, 0.5e-3, &particles), at(9.5e-3, 1.5e-3, &particles));
    pair(&mut particles, a, b);
    pair(&mut particles, c, d);
    let mut watch = begun(&model);
    watch.look_at(Aspect::Pairs, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(watch.count(), 0);
    pair(&mut particles, e, f);
    watch.look_at(Aspect::Pairs, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(found(&watch, &model), one("pairing", 0.06));
    let (model, _) = strip("off = [\"pairing\"]");
    let mut watch = begun(&model);
    watch.look_at(Aspect::Pairs, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(watch.count(), 0);
}

#[test]
fn a_zone_that_tears_is_seen_however_large_the_body() {
    let (model, mut particles) = strip("off = [\"pairing\"]");
    // Columns of the left part fall together by twos, in tension.
    let column = |x: f64| (x / 1e-3).floor() as i64;
    let mut torn = 0;
    for i in 0..particles.len() {
        let k = column(particles.position[i][0]);
        if (0..6).contains(&k) {
            particles.position[i][0] += if k % 2 == 0 { 0.25e-3 } else { -0.25e-3 };
            particles.pressure[i] = -1e6;
            torn += 1;
        }
    }
    let mut watch = begun(&model);
    watch.look_at(Aspect::Pairs, &(&model, &particles), &model, CLOCK).unwrap();
    let seen = found(&watch, &model);
    // Over those in a circle of 2.5 spacings.
    let number = f64::from(torn) / (std::f64::consts::PI * 2.5 * 2.5);
    assert!(seen.len() == 1 && seen[0].0 == "tearing" && (seen[0].1 - number).abs() < 1e-12, "{seen:?} {number}");
    let (model, _) = strip("off = [\"pairing\", \"tearing\"]");
    let mut watch = begun(&model);
    watch.look_at(Aspect::Pairs, &(&model, &particles), &model, CLOCK).unwrap();
    assert_eq!(watch.count(), 0);
}

#[test]
fn a_step_that_collapses_is_told_and_a_run_without_end_is_stopped() {
    let model = testing::model(&["bar"]);
    let mut watch = Watch::new(&model);
    watch.step(&model, 1e-3, 0, 0.0).unwrap();
    watch.step(&model, 1.1e-6, 1, 0.5).unwrap();
    assert_eq!(watch.count(), 0);
    watch.step(&model, 1e-7, 2, 0.5).unwrap();
    let found = found(&watch, &model);
    assert_eq!(found[0].0, "time-step");
    assert!((found[0].1 - 1e-4).abs() < 1e-12 && found.len() == 1);
    // Half a second is left: 5e10 steps, for once.
    for step in 3..102 {
        watch.step(&model, 1e-11, step, 0.5).unwrap();
    }
    let record = &watch.records(&model)[1];
    assert_eq!(record.name, "steps-left");
    assert!(record.cure.contains("has collapsed") && record.cure.contains("lower `time.courant`"), "{record}");
    watch.step(&model, 1e-3, 102, 0.5).unwrap();
    for step in 103..202 {
        watch.step(&model, 1e-11, step, 0.5).unwrap();
    }
    let failure = watch.step(&model, 1e-11, 202, 0.5).unwrap_err();
    assert_eq!((failure.step, failure.time, failure.field), (202, 0.5, "time step"));
    assert!(
        failure.message.contains("5.0e10 steps to the end") && failure.message.contains("stop-at-steps"),
        "{failure}"
    );
    assert!(failure.message.contains("lower `time.courant`") && !failure.message.contains("raise `time.courant`"));
}

#[test]
fn a_deck_that_asks_for_many_small_steps_is_told_to_take_larger_ones() {
    let model = testing::model(&["bar"]);
    let mut watch = Watch::new(&model);
    for step in 0..99 {
        watch.step(&model, 1e-11, step, 0.0).unwrap();
    }
    let record = &watch.records(&model)[0];
    assert!(record.name == "steps-left" && record.cure.contains("raise `time.courant`"), "{record}");
    let failure = watch.step(&model, 1e-11, 99, 0.0).unwrap_err();
    assert!(failure.message.contains("raise `time.courant`") && !failure.message.contains("collapsed"), "{failure}");
}

#[test]
fn a_deck_that_ends_after_some_steps_is_not_stopped() {
    let mut model = testing::model(&["bar"]);
    model.time.max_steps = Some(1000);
    let mut watch = Watch::new(&model);
    for step in 0..999 {
        watch.step(&model, 1e-300, step, 0.0).unwrap();
    }
    assert_eq!(watch.records(&model)[0].name, "steps-left");
    assert!(watch.records(&model)[0].value.is_finite());
}

#[test]
fn what_a_repeated_step_comes_upon_again_is_not_told_again() {
    let model = testing::model(&["bar"]);
    let mut watch = begun(&model);
    let mut before = MemoryArchive::new();
    watch.persist("watch", &mut before).unwrap();
    watch.look_at_ledger(&model, &ledger(0.0, 0.0, 300.0, 0.0), CLOCK);
    assert_eq!(watch.news(&model).len(), 1);
    watch.persist("watch", &mut before.to_load()).unwrap();
    assert_eq!(watch.records(&model), []);
    watch.look_at_ledger(&model, &ledger(0.0, 0.0, 300.0, 0.0), CLOCK);
    assert_eq!((watch.records(&model).len(), watch.news(&model).len()), (1, 0));
}

#[test]
fn news_are_told_once_and_a_saved_watch_goes_on() {
    let model = testing::model(&["bar"]);
    let mut watch = begun(&model);
    watch.look_at_ledger(&model, &ledger(0.0, 0.0, 300.0, 0.0), CLOCK);
    assert_eq!((watch.news(&model).len(), watch.news(&model).len()), (1, 0));
    watch.look_at_ledger(&model, &ledger(0.0, -50.0, 400.0, 0.0), CLOCK);
    let mut archive = MemoryArchive::new();
    watch.persist("watch", &mut archive).unwrap();
    let mut loaded = Watch::new(&model);
    loaded.persist("watch", &mut archive.clone().to_load()).unwrap();
    assert_eq!(loaded.records(&model), watch.records(&model));
    assert_eq!(loaded.news(&model)[0].name, "negative-energy");
    watch.seen[0].kind = 200;
    let mut archive = MemoryArchive::new();
    watch.persist("watch", &mut archive).unwrap();
    assert!(loaded.persist("watch", &mut archive.to_load()).is_err());
}

/// Conservation of a run of 100 J and 10 kg m/s that has lost this much of them.
fn lost(energy: f64, momentum: f64) -> Conservation {
    let mut conservation = Conservation::default();
    let at = |energy: f64, momentum: f64| {
        let mut of = ledger(energy, 0.0, 0.0, 0.0);
        (of.total.momentum, of.total.momentum_scale) = ([momentum, 0.0, 0.0], 10.0);
        of
    };
    conservation.sample(&at(100.0, 10.0));
    conservation.sample(&at(100.0 - energy, 10.0 - momentum));
    conservation
}

#[test]
fn what_is_not_conserved_is_told_unless_it_is_next_to_nothing_or_the_form_does_not_conserve_it() {
    let mut model = testing::model(&["bar"]);
    let mut watch = begun(&model);
    watch.look_at_drift(&model, &lost(9e-3, 9e-4), CLOCK);
    watch.look_at_drift(&model, &lost(-9e-3, -9e-4), CLOCK);
    assert_eq!(watch.count(), 0);
    watch.look_at_drift(&model, &lost(0.5, 0.0), CLOCK);
    assert_eq!(found(&watch, &model), one("energy-drift", 5e-3));
    let mut watch = begun(&model);
    watch.look_at_drift(&model, &lost(0.0, 2.0), CLOCK);
    assert_eq!(found(&watch, &model), one("momentum-drift", 0.2));
    // Half a joule and two units of momentum that are the noise of a body at rest.
    let mut watch = begun(&model);
    let start = watch.start.as_mut().unwrap();
    (start.nothing, start.no_momentum) = (0.6, 2.1);
    watch.look_at_drift(&model, &lost(0.5, 2.0), CLOCK);
    assert_eq!(watch.count(), 0);
    let mut watch = begun(&model);
    let published = AdaptiveSearch { plastic_strain_threshold: 1e-4, accumulate: false, guard: None };
    model.search = Search::Adaptive(published);
    watch.look_at_drift(&model, &lost(0.5, 2.0), CLOCK);
    assert_eq!(watch.count(), 0);
}

#[test]
fn cells_are_looked_at_where_there_are_some() {
    let watch_of = |change: Option<(&str, &str)>| {
        let change: Vec<_> = change.iter().map(|(path, value)| (path.to_string(), value.to_string())).collect();
        let text = crate::deck::decks::find("perforation").unwrap().text;
        let model = crate::deck::load_text("perforation", text, &change).unwrap().model;
        let mut watch = begun(&model);
        let asks = watch.asks(&model, CLOCK).unwrap();
        watch.cells_at = Some(CLOCK.step);
        let again = watch.asks(&model, CLOCK).unwrap();
        let are_cells = |asked: &&Reduction| matches!(asked, Reduction::Suspects(Suspicion::Inside { .. }));
        [asks, again].map(|asks| asks.iter().filter(are_cells).count())
    };
    assert_eq!(watch_of(None), [1, 0]);
    assert_eq!(watch_of(Some(("method", "updated-lagrangian"))), [0, 0]);
    assert_eq!(watch_of(Some(("warnings.off", "[\"interpenetration\"]"))), [0, 0]);
}
