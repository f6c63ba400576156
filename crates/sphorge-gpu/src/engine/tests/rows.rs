//! What a row of the history reads back.

use super::{Deck, engine, shipped};
use crate::Gpu;
use crate::device::Profile;
use crate::engine::GpuEngine;
use crate::engine::columns::Group;
use crate::tests::card::card;
use sphorge_engine::model::MeasureKind;
use sphorge_engine::reduction::{Quantity, Reduction, Suspicion};
use sphorge_engine::{Engine, FieldSource};

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
    let of_particles = crate::engine::snapshot::GROUPS_OF_PARTICLES.iter();
    let beside = [Group::Pressure, Group::Accounts, Group::Walls, Group::Evaluated, Group::Heat, Group::Meetings];
    let all = of_particles.chain(&beside).filter(|group| **group != Group::Constants);
    all.filter_map(|group| engine.columns.array(*group)).map(|array| 4 * array.count() as u64).sum()
}

/// What a row reads without and with checks, and all columns.
fn bytes(deck: Deck<'_>) -> Option<[u64; 3]> {
    card()?;
    let profile = Profile::default();
    let engine = engine(&Gpu { profile: Some(profile.clone()), ..Gpu::default() }, deck);
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
    Some(found)
}

#[test]
fn a_row_reads_a_small_part_of_the_columns() {
    // Of so few particles chunks are small; of many there are a thousand in each.
    for (deck, overrides, share) in [
        ("taylor-plate", &[("particles.spacing", "\"0.2 mm\"")][..], 50),
        ("iron-plate", &[("particles.spacing", "\"0.2 mm\"")], 50),
        ("bullet", &[("particles.spacing", "\"15 mm\"")], 100),
    ] {
        let Some([row, with_checks, columns]) = bytes((shipped(deck), overrides)) else { return };
        assert!(row * share < columns && with_checks < 2 * row, "{deck}: {row}, {with_checks}, {columns}");
    }
    // Craters and clouds are drawn of places, six columns.
    let Some([row, with_checks, columns]) = bytes((shipped("penetration"), &[("particles.spacing", "\"0.6 mm\"")]))
    else {
        return;
    };
    assert!(6 * row < columns && with_checks - row < row / 2, "{row}, {with_checks}, {columns}");
}
