//! Cases that fail.

use super::*;

fn options(cases: &[&str], overrides: &[(&str, &str)]) -> BenchOptions {
    BenchOptions {
        engine: Arc::new(Cpu),
        kernels: None,
        cases: cases.iter().map(|case| (*case).to_owned()).collect(),
        strategies: vec!["skin".to_owned()],
        overrides: overrides.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect(),
        threads: Some(1),
        seconds: 0.0,
    }
}

/// Energies that may not change: those of a block at rest do not.
#[test]
fn a_case_that_fails_is_said_and_the_others_are_measured() {
    let overrides = [("particles.spacing", "\"4 mm\""), ("time.step-control", "{ energy = 1e-9, repeats = 1 }")];
    let report = measure_cases(&options(&["block", "penetration"], &overrides), None, &mut |_| {}).unwrap();
    let measured: Vec<_> = report.rows.iter().map(|row| (&*row.case, &*row.precision)).collect();
    assert_eq!(measured, [("block", "mixed"), ("block", "double")]);
    let failed: Vec<_> = report.skipped.iter().map(|row| (&*row.case, &*row.precision)).collect();
    assert_eq!(failed, [("penetration", "mixed"), ("penetration", "double")]);
    assert!(report.skipped.iter().all(|row| row.why.contains("`time.step-control`")), "{:?}", report.skipped);
}

/// What a run repeats is repeated: the disc strikes so hard that the first step is too long.
#[test]
fn steps_that_a_run_repeats_are_repeated() {
    let overrides = [("particles.spacing", "\"0.5 mm\"")];
    let report = measure_cases(&options(&["penetration"], &overrides), None, &mut |_| {}).unwrap();
    assert_eq!((report.rows.len(), report.skipped.len()), (2, 0), "{:?}", report.skipped);
}
