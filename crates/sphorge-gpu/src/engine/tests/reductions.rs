//! Reductions on the GPU beside those of columns read back.

use super::{Deck, changed_engine, engine, shipped, steps};
use crate::Gpu;
use crate::device::Profile;
use crate::engine::GpuEngine;
use crate::tests::card::gpu;
use crate::tests::contact::{OVERLAP, striking};
use crate::tests::engine::IRON;
use crate::tests::motion::driven;
use sphorge_engine::model::{Extremum, ParticleSelection};
use sphorge_engine::particles::FIELDS;
use sphorge_engine::reduction::{Quantity, Reduction, Suspects, Suspicion, evaluate};
use sphorge_physics::flow::{FlowLaw, PressureAndDamage, YieldLaw};

/// How near sums and extremes of pairs of numbers are to those of double precision, over the largest value that the field has.
const NEAR: f64 = 1e-12;

/// Holds what the GPU finds against what comes of columns.
fn compare(engine: &GpuEngine, reduction: &Reduction<'_>, scale: f64) {
    let found = engine.reduction(reduction).unwrap();
    let expected = evaluate(reduction, &engine.model, &engine.snapshot().unwrap());
    assert_eq!(found.len(), expected.len(), "{reduction:?}: {found:?} on the card, {expected:?}");
    for (ours, theirs) in found.iter().zip(&expected) {
        let off = (ours - theirs).abs();
        assert!(
            off <= NEAR * scale || ours == theirs,
            "{reduction:?}: {found:?} on the card, {expected:?}; {off:e} of {scale:e}"
        );
    }
}

/// Every field of these: the whole of it and its last component.
fn compare_fields(engine: &GpuEngine, names: &[&str], selections: &[ParticleSelection]) {
    let p = engine.snapshot().unwrap();
    let (point, id) = (p.position[p.len() / 3].map(|x| x + 1e-5), p.id[p.len() / 2]);
    for field in FIELDS.iter().filter(|field| names.is_empty() || names.contains(&field.name)) {
        let column = p.column(field.name).unwrap();
        let largest = |i: usize| (0..field.kind.width()).map(|k| column.component(i, k).abs()).fold(0.0, f64::max);
        let scale = (0..p.len()).map(largest).filter(|x| x.is_finite()).fold(0.0, f64::max);
        let of_field = |component| Quantity { field: field.name, component };
        for quantity in [of_field(None), of_field(Some(field.kind.width() - 1))] {
            compare(engine, &Reduction::OfParticle { id, quantity }, scale);
            for of in selections {
                compare(engine, &Reduction::Mean { of, quantity }, scale);
                if quantity.component.is_none() {
                    compare(engine, &Reduction::Interpolation { of, quantity, point }, scale);
                }
                for extremum in [Extremum::Minimum, Extremum::Maximum] {
                    compare(engine, &Reduction::Extremum { of, quantity, extremum }, scale);
                }
            }
        }
    }
}

fn compare_sizes(engine: &GpuEngine, selections: &[ParticleSelection]) {
    for of in selections {
        for axis in 0..3 {
            compare(engine, &Reduction::Extent { of, axis }, 1e-2);
            compare(engine, &Reduction::Diameter { of, axis }, 1e-2);
        }
    }
}

fn started(deck: Deck<'_>, count: usize) -> GpuEngine {
    let mut engine = engine(&gpu(), deck);
    steps(&mut engine, &vec![1.0; count]);
    engine
}

/// Some of the particles: in a box in which there are some, and in one where there are none.
fn windows() -> [ParticleSelection; 3] {
    let window = |min, max| ParticleSelection { window: Some((min, max)), ..ParticleSelection::default() };
    let all = f64::INFINITY;
    [
        ParticleSelection::default(),
        window([-1e-3, 1e-3, -all], [2e-3, 4.3e-3, all]),
        window([1.0, 1.0, -all], [2.0, 2.0, all]),
    ]
}

#[test]
fn reductions_of_every_field_match_columns_read_back() {
    let fine = ("particles.spacing", "\"0.3 mm\"");
    let engine = started((shipped("taylor-plate"), &[fine]), 15);
    compare_fields(&engine, &[], &windows()[..1]);
    compare_fields(&engine, &["speed", "stress", "temperature", "neighbors", "yield_stress"], &windows());
}

#[test]
fn sizes_of_deformed_and_renewed_bodies_match_columns_read_back() {
    let renews = ("search.total-lagrangian.renewal", "1.1");
    for (overrides, count) in [(vec![IRON.1[0], IRON.1[1]], 30), (vec![IRON.1[0], IRON.1[1], renews], 40)] {
        let engine = started((shipped(IRON.0), &overrides), count);
        assert_eq!(engine.is_renewed(), overrides.len() > 2);
        compare_sizes(&engine, &windows());
    }
    let engine = started((shipped("copper-bar"), &[("particles.spacing", "\"0.95 mm\"")]), 20);
    compare_sizes(&engine, &windows()[..1]);
}

#[test]
fn selections_and_variable_smoothing_lengths_match_columns_read_back() {
    let of_body = |body| ParticleSelection { body: Some(body), ..ParticleSelection::default() };
    let engine = started((&striking(OVERLAP), &[]), 5);
    compare_fields(&engine, &["velocity", "density"], &[of_body(0), of_body(1), of_body(2)]);
    compare_sizes(&engine, &[of_body(1), of_body(2)]);
    let engine = started((&driven(""), &[("particles.spacing", "\"0.25 mm\"")]), 10);
    let of_region = |region| ParticleSelection { region: Some(region), ..ParticleSelection::default() };
    compare_fields(&engine, &["velocity", "von_mises_stress"], &[of_region(0), of_region(1), of_region(2)]);
    let follows = [("particles.spacing", "\"0.6 mm\""), ("numerics.smoothing-length", "\"follow-density\"")];
    let engine = started((shipped("taylor-plate"), &follows), 30);
    compare_fields(&engine, &["smoothing_length", "pressure"], &windows()[..1]);
}

#[test]
fn reductions_of_history_variables_match_columns_read_back() {
    let law = PressureAndDamage::new(&[3e8, 5e8, 0.05, 2e-11, 1e9]);
    let mut engine = changed_engine(&gpu(), (shipped(IRON.0), &IRON.1[..2]), |model| {
        model.materials.iter_mut().for_each(|material| material.flow_law = FlowLaw::PressureAndDamage(law));
    });
    steps(&mut engine, &[1.0; 30]);
    compare_fields(&engine, &["damage", "plastic_strain"], &windows()[..1]);
    let (of, quantity) = (ParticleSelection::default(), Quantity { field: "damage", component: None });
    let largest = Reduction::Extremum { of: &of, quantity, extremum: Extremum::Maximum };
    assert!(engine.reduction(&largest).unwrap()[0] > 1e-3);
}

/// Holds a check against that of columns; the particles of each body that are suspicious.
fn compare_suspects(engine: &GpuEngine, suspicion: Suspicion) -> Vec<u64> {
    let reduction = Reduction::Suspects(suspicion);
    let [found, expected] =
        [engine.reduction(&reduction).unwrap(), evaluate(&reduction, &engine.model, &engine.snapshot().unwrap())]
            .map(|numbers| Suspects::of(&numbers));
    assert_eq!(found.len(), expected.len());
    for (ours, theirs) in found.iter().zip(&expected) {
        let counts = |of: &Suspects| (of.particles, of.suspects, of.worst.is_some());
        assert_eq!(counts(ours), counts(theirs), "{suspicion:?}: {ours:?} on the card, {theirs:?}");
        if let Some((ours, theirs)) = ours.worst.zip(theirs.worst) {
            assert!((ours.0 - theirs.0).abs() <= NEAR * theirs.0.abs(), "{suspicion:?}: {ours:?}, {theirs:?}");
            // Of numbers that rounding alone tells apart either may be the worst.
            if ours.0 == theirs.0 || ours.1 == theirs.1 {
                assert_eq!((ours.1, ours.2), (theirs.1, theirs.2), "{suspicion:?}");
            }
        }
    }
    found.iter().map(|of| of.suspects).collect()
}

#[test]
fn checks_of_single_particles_match_columns_read_back() {
    let engine = started((&striking(OVERLAP), &[]), 0);
    // All are equally cold: the first is the worst.
    let all = compare_suspects(&engine, Suspicion::Cold(1e4));
    let warm = engine.initial.temperature[0];
    assert_eq!(compare_suspects(&engine, Suspicion::Cold(warm - 1.0)), [0, 0, 0]);
    assert!(all.iter().all(|count| *count > 50));
    compare_suspects(&engine, Suspicion::Hot(0.1));
    compare_suspects(&engine, Suspicion::MissingHeat(0.1));
    compare_suspects(&engine, Suspicion::Lonely);
    let edge = [("particles.spacing", "\"0.3 mm\""), ("symmetry", "[{ axis = \"x\", at = \"0 mm\" }]")];
    let half = ("body.plate.shape", "{ box = { min = [\"0 mm\", \"0 mm\"], max = [\"3.8 mm\", \"12 mm\"] } }");
    let engine = started((shipped("taylor-plate"), &[edge[0], edge[1], half]), 20);
    let (low, high) = ([0.5e-3, 1e-3, f64::NEG_INFINITY], [3e-3, 9e-3, f64::INFINITY]);
    let some = [
        Suspicion::Compressed(1e-3),
        Suspicion::Expanded(1.001),
        Suspicion::Hot(1.0 - 1e-3),
        Suspicion::Away { low, high, limit: 1e-3 },
        Suspicion::Behind { limit: -0.6, breaks: false },
    ];
    for suspicion in some {
        let found = compare_suspects(&engine, suspicion);
        assert!(found[0] > 0 && found[0] < engine.initial.len() as u64, "{suspicion:?}: {found:?}");
    }
    // The same kernels with other limits.
    assert_eq!(compare_suspects(&engine, Suspicion::Compressed(0.9)), [0]);
    assert_eq!(compare_suspects(&engine, Suspicion::Away { low, high, limit: 1.0 }), [0]);
    compare_suspects(&engine, Suspicion::Lonely);
}

#[test]
fn particles_in_cells_of_another_body_are_those_of_the_processor() {
    let text = include_str!("../../../../../docs/warnings/interpenetration.toml");
    let engine = started((text, &[]), 400);
    let found = compare_suspects(&engine, Suspicion::Inside { faces: true, breaks: false });
    assert!(found[0] > 3 && found[1] > 3, "{found:?}");
}

#[test]
fn no_reduction_of_single_particles_reads_a_column_back() {
    let profile = Profile::default();
    let kind = Gpu { profile: Some(profile.clone()), ..gpu() };
    let mut engine = engine(&kind, (shipped("taylor-plate"), &[("particles.spacing", "\"0.2 mm\"")]));
    steps(&mut engine, &[1.0]);
    let count = engine.initial.len() as u64;
    let (of, quantity) = (&ParticleSelection::default(), Quantity { field: "speed", component: None });
    let bytes = |reduction: Reduction<'_>| {
        let before = profile.bytes_read();
        engine.reduction(&reduction).unwrap();
        profile.bytes_read() - before
    };
    let segments = engine.segments.len() as u64;
    assert!(segments > 1);
    assert_eq!(bytes(Reduction::Mean { of, quantity }), 2 * 8 * segments);
    assert_eq!(bytes(Reduction::Extremum { of, quantity, extremum: Extremum::Maximum }), 3 * 8 * segments);
    assert_eq!(bytes(Reduction::Extent { of, axis: 0 }), 3 * 8 * segments);
    // Of each body where its worst is.
    assert_eq!(bytes(Reduction::Suspects(Suspicion::Expanded(0.5))), 2 * 8 * segments + 3 * 8);
    assert_eq!(bytes(Reduction::OfParticle { id: 0, quantity }), 8);
    // What is evaluated by the processor reads the groups it needs, once until the next step.
    let slabs = || Reduction::Slabs { of, quantity, axis: 1, direction: 1.0 };
    let columns = |groups: u64| groups * 4 * engine.stride as u64;
    // Places, densities and velocities with their low parts.
    assert_eq!(bytes(slabs()), columns(6 + 2 + 6));
    assert_eq!(bytes(slabs()), 0);
    assert_eq!(bytes(Reduction::Suspects(Suspicion::Torn)), columns(3));
    assert!(count > 1024);
}
