//! What a row of the history reads back.

use super::{Deck, engine, shipped, steps};
use crate::Gpu;
use crate::device::Profile;
use crate::engine::GpuEngine;
use crate::engine::columns::Group;
use crate::engine::stored_fields::groups_of_particles;
use crate::tests::card::gpu;
use crate::tests::contact::{OVERLAP, striking};
use crate::tests::engine::IRON;
use sphorge_engine::model::{Extremum, MeasureKind, ParticleSelection};
use sphorge_engine::reduction::{Quantity, Reduction, Suspicion};
use sphorge_engine::{Engine, FieldSource, ParticleSource};

/// Asks what a run asks in a row: the ledger, and what measures are made of; and in one row of twenty the checks of single particles.
fn ask_for_a_row(engine: &GpuEngine, with_checks: bool) {
    engine.ledger().unwrap();
    let ask = |reduction: Reduction<'_>| drop(engine.reduce(&reduction).unwrap());
    for measure in &engine.model.measures {
        match &measure.kind {
            MeasureKind::Extent { selection, axis } => ask(Reduction::Extent { of: selection, axis: *axis }),
            MeasureKind::Diameter { selection, axis } => ask(Reduction::Diameter { of: selection, axis: *axis }),
            MeasureKind::Extreme { selection, field, component, extremum, .. } => {
                let quantity = Quantity { field, component: *component };
                ask(Reduction::Extremum { of: selection, quantity, extremum: *extremum });
            }
            MeasureKind::Mean { selection, field, component } => {
                ask(Reduction::Mean { of: selection, quantity: Quantity { field, component: *component } });
            }
            // Craters and clouds are drawn from where particles are.
            MeasureKind::CraterDiameter { .. } | MeasureKind::Cloud { .. } => {
                engine.with_fields(&["position", "mass", "body"]).unwrap();
            }
            other => panic!("{other:?}"),
        }
    }
    if with_checks {
        let (low, high) = ([-1e3; 3], [1e3; 3]);
        let checks = [
            Suspicion::Cold(0.0),
            Suspicion::Hot(1e3),
            Suspicion::Compressed(1.0),
            Suspicion::Expanded(0.1),
            Suspicion::Away { low, high, limit: 1.0 },
            Suspicion::Lonely,
        ];
        checks.into_iter().for_each(|check| ask(Reduction::Suspects(check)));
    }
}

/// Bytes of all columns that rows were made of when they were evaluated by the processor.
fn bytes_of_columns(engine: &GpuEngine) -> u64 {
    let of_particles = groups_of_particles();
    let beside = [Group::Pressure, Group::Accounts, Group::Walls, Group::Evaluated, Group::Heat, Group::Meetings];
    let all = of_particles.iter().chain(&beside).filter(|group| **group != Group::Constants);
    all.filter_map(|group| engine.columns.array(*group)).map(|array| 4 * array.count() as u64).sum()
}

/// What a row reads without and with checks, and all columns.
fn bytes(deck: Deck<'_>) -> [u64; 3] {
    let profile = Profile::default();
    let engine = engine(&Gpu { profile: Some(profile.clone()), ..gpu() }, deck);
    let read = |with_checks: bool| {
        engine.read_back.take();
        let before = profile.bytes_read();
        ask_for_a_row(&engine, with_checks);
        profile.bytes_read() - before
    };
    let found = [read(false), read(true), bytes_of_columns(&engine)];
    println!(
        "{} particles: {} bytes of a row, {} with checks, {} of all columns",
        engine.initial.len(),
        found[0],
        found[1],
        found[2]
    );
    found
}

#[test]
fn a_row_reads_a_small_part_of_the_columns() {
    // Of so few particles chunks are small; of many there are a thousand in each.
    for (deck, overrides, share) in [
        ("taylor-plate", &[("particles.spacing", "\"0.2 mm\"")][..], 50),
        ("iron-plate", &[("particles.spacing", "\"0.2 mm\"")], 50),
        ("bullet", &[("particles.spacing", "\"15 mm\"")], 100),
    ] {
        let [row, with_checks, columns] = bytes((shipped(deck), overrides));
        assert!(row * share < columns && with_checks < 2 * row, "{deck}: {row}, {with_checks}, {columns}");
    }
    // Craters and clouds are drawn of places, six columns.
    let [row, with_checks, columns] = bytes((shipped("penetration"), &[("particles.spacing", "\"0.6 mm\"")]));
    assert!(6 * row < columns && with_checks - row < row / 2, "{row}, {with_checks}, {columns}");
}

/// Everything that the GPU sums for a row.
fn all_sums<'a>(of: &'a ParticleSelection, engine: &'a GpuEngine) -> Vec<Reduction<'a>> {
    let speed = Quantity { field: "speed", component: None };
    let place = Quantity { field: "position", component: Some(1) };
    let point = engine.initial.position[engine.initial.len() / 3];
    let mut sums = vec![
        Reduction::Mean { of, quantity: speed },
        Reduction::Interpolation { of, quantity: speed, point },
        Reduction::Extremum { of, quantity: place, extremum: Extremum::Minimum },
        Reduction::Extremum { of, quantity: place, extremum: Extremum::Maximum },
        Reduction::Extent { of, axis: 0 },
        Reduction::OfParticle { id: 7, quantity: place },
        Reduction::OfParticle { id: u32::MAX, quantity: place },
        // Each with some that are suspicious.
        Reduction::Suspects(Suspicion::Cold(1e4)),
        Reduction::Suspects(Suspicion::Hot(0.1)),
        Reduction::Suspects(Suspicion::MissingHeat(0.1)),
        Reduction::Suspects(Suspicion::Away { low: [-1e-4; 3], high: [1e-4; 3], limit: 1e-3 }),
        Reduction::Suspects(Suspicion::Compressed(0.9)),
    ];
    sums.extend(engine.model.sections.iter().map(Reduction::SectionForce));
    sums
}

/// Waits that something makes.
fn waits<T>(profile: &Profile, make: impl FnOnce() -> T) -> (u64, T) {
    let before = profile.waits();
    let made = make();
    (profile.waits() - before, made)
}

/// Sums that are looked at after the next steps are those of when they were asked for, and wait for nothing.
fn compare_queued(deck: Deck<'_>, first: usize) {
    let profile = Profile::default();
    let mut engine = engine(&Gpu { profile: Some(profile.clone()), ..gpu() }, deck);
    steps(&mut engine, &vec![1.0; first]);
    let of = ParticleSelection::default();
    for _ in 0..2 {
        let (of_step, ()) = waits(&profile, || steps(&mut engine, &[1.0]));
        assert!(of_step > 0, "the limits of a step are waited for");
        let asked = all_sums(&of, &engine);
        let ledger = engine.ledger().unwrap();
        let found: Vec<_> = asked.iter().map(|of| engine.reduce(of).unwrap()).collect();
        assert!(found.iter().filter(|found| found.iter().any(|number| *number != 0.0)).count() >= asked.len() - 2);
        let (of_asking, queued) = waits(&profile, || engine.queue_sums(&asked).unwrap().expect("a card"));
        let questions: Vec<_> = asked.iter().map(|of| format!("{of:?}")).collect();
        let (of_more, ()) = waits(&profile, || steps(&mut engine, &[1.0]));
        let (of_looking, answers) = waits(&profile, || queued.wait().unwrap());
        assert_eq!((of_asking, of_more, of_looking), (0, of_step, 0), "waits for asking, a step and looking");
        assert_eq!(answers.ledger(), &ledger);
        for ((asked, found), question) in all_sums(&of, &engine).iter().zip(&found).zip(&questions) {
            assert_eq!(&answers.reduce(asked).unwrap(), found, "{question}");
        }
        // The state has changed meanwhile.
        assert_ne!(engine.ledger().unwrap(), ledger);
    }
    // Without a step between there is one wait for all of them.
    let asked = all_sums(&of, &engine);
    let (at_once, _) = waits(&profile, || engine.queue_sums(&asked).unwrap().unwrap().wait().unwrap());
    assert_eq!(at_once, 1);
}

#[test]
fn steps_do_not_wait_for_the_sums_of_a_row() {
    let section = ("section", "[{ name = \"s\", point = [\"0 mm\", \"4 mm\"], normal = [0, 1] }]");
    compare_queued((shipped("taylor-plate"), &[("particles.spacing", "\"0.6 mm\""), section]), 5);
    compare_queued((shipped(IRON.0), &[IRON.1[0], IRON.1[1], section]), 5);
    compare_queued((&striking(OVERLAP), &[]), 5);
}

#[test]
fn a_diameter_waits_where_its_line_depends_on_the_particles() {
    let profile = Profile::default();
    let kind = Gpu { profile: Some(profile.clone()), ..gpu() };
    let of = ParticleSelection::default();
    // Across the axis of the quarter there are planes of symmetry, and across the width of the plate there is none.
    for (deck, axis, expected) in [("copper-bar", 2, 0), ("copper-bar", 0, 0), ("taylor-plate", 1, 1)] {
        let mut engine = engine(&kind, (shipped(deck), &[("particles.spacing", "\"0.95 mm\"")]));
        steps(&mut engine, &[1.0]);
        let asked = [Reduction::Diameter { of: &of, axis }];
        let (made, queued) = waits(&profile, || engine.queue_sums(&asked).unwrap().unwrap());
        assert_eq!(made, expected, "{deck}");
        let found = engine.reduce(&asked[0]).unwrap();
        assert_eq!(queued.wait().unwrap().reduce(&asked[0]).unwrap(), found);
    }
}
