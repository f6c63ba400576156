//! Audits of lists whose particles ranks share.

use super::adaptive::{COARSE, GUARDED, PUBLISHED};
use super::symmetry::CORNER;
use super::{column, compare};

/// Compares audited runs; the largest value of a column of the history.
fn worst(deck: &str, changes: &[(&str, &str)], ranks: &[usize], name: &str) -> f64 {
    let files = compare(deck, changes, ranks);
    column(&files, name).into_iter().fold(0.0, f64::max)
}

#[test]
fn lists_that_miss_pairs_with_every_pair_tested_and_by_cells() {
    let audited = |search| [search, ("audit", "7"), ("output.history-interval", "\"0.5 us\"")];
    let seldom = ("search", "{ adaptive = { plastic-strain-threshold = 0.01, guard = \"none\" } }");
    for (spacing, ranks) in [("\"0.4 mm\"", &[1, 2, 3, 4, 7][..]), ("\"0.2 mm\"", &[3])] {
        let size = [("particles.spacing", spacing), ("time.end", "\"5 us\""), ("output.frames", "2")];
        let missed = worst("taylor-plate", &[&size[..], &audited(seldom)].concat(), ranks, "audit_missed_pairs");
        assert!(missed > 10.0, "{missed}");
    }
    // Images of images, which have kept distances too.
    let error = worst(CORNER, &audited(PUBLISHED), &[2, 3], "audit_force_error");
    assert!(error > 1e-4, "{error}");
}

#[test]
fn lists_of_bodies_in_contact() {
    let audited = [GUARDED, ("audit", "5"), ("contact", "\"penalty\"")];
    let residual = worst(CORNER, &audited, &[2, 3], "audit_momentum_residual");
    assert!(residual > 0.0, "{residual}");
    let short = [("time.end", "\"120 us\""), ("output.frames", "2")];
    worst("bullet", &[&COARSE[..], &audited[..2], &short].concat(), &[2, 5], "audit_missed_pairs");
}

#[test]
fn lists_of_the_initial_configuration() {
    let short = [("time.end", "\"8 us\""), ("output.history-interval", "\"1 us\""), ("audit", "9")];
    let stale = worst(super::contact::CLAMP, &short, &[2, 5], "audit_stale_pairs");
    assert!(stale > 0.0, "{stale}");
    // Images of present positions, some of which came near after the start, in the contact and beside it.
    let bar = [("particles.spacing", "\"0.95 mm\""), ("audit", "20"), ("output.frames", "2")];
    let short = [("time.end", "\"8 us\""), ("output.history-interval", "\"1 us\"")];
    let missed = worst("copper-bar", &[&bar[..], &short].concat(), &[2, 3], "audit_missed_pairs");
    assert!(missed > 100.0, "{missed}");
}
