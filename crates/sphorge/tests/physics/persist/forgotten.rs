//! What is saved is needed: a state of which one value is forgotten goes another way.

use super::super::setup::run_steps;
use super::{FEATURES, Loading, Picture, SEARCHES, start, values_of};
use std::collections::BTreeMap;

#[test]
fn explore() {
    let mut needed: BTreeMap<String, (Vec<String>, Vec<String>)> = BTreeMap::new();
    for search in SEARCHES {
        for integrator in ["leapfrog", "predictor-corrector"] {
            for feature in FEATURES {
                let changes = [&[("numerics.integrator", integrator)], feature.changes].concat();
                if !super::resumed::go_together(search, integrator, feature) {
                    continue;
                }
                let new = || start(&feature.deck(), search, &changes);
                let mut whole = new();
                let fresh = values_of(&mut whole);
                run_steps(&mut whole, 37);
                let values = values_of(&mut whole);
                let then = Picture::of(&mut whole);
                run_steps(&mut whole, 35);
                let last = Picture::of(&mut whole);
                for name in values.keys().filter(|name| !name.starts_with("seconds")) {
                    let entry = needed.entry(name.clone()).or_default();
                    if entry.0.len() >= 2 || values.get(name) == fresh.get(name) {
                        continue;
                    }
                    let what = format!("{search} {integrator} {}", feature.name);
                    let mut resumed = new();
                    let of = |wanted: &str| {
                        if wanted == name { fresh.get(wanted).cloned() } else { values.get(wanted).cloned() }
                    };
                    let loaded = resumed.persist(&mut Loading(of));
                    let early = loaded.is_err() || !then.visible_differences(&Picture::of(&mut resumed)).is_empty();
                    let noticed = loaded.is_err()
                        || (0..35).any(|_| resumed.step(None).is_err())
                        || !last.visible_differences(&Picture::of(&mut resumed)).is_empty();
                    if noticed {
                        entry.0.push(format!("{what} {loaded:?}"))
                    } else {
                        entry.1.push(format!("{what} {early}"))
                    }
                }
            }
        }
    }
    for (name, (noticed, unnoticed)) in needed {
        println!(
            "NEED {name}: {} noticed by {:?}, {} not {:?}",
            noticed.len(),
            noticed.first(),
            unnoticed.len(),
            unnoticed.first()
        );
    }
}
