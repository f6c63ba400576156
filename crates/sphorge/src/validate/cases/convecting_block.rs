//! A block that cools by convection.

use super::super::{
    Bounds, Case, Effort, Finding, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
    variant::refinements,
};
use super::heat_solutions::cooling_plate;

const BLOCK: &str = "block";
const PLATE: &str = "plate";

pub(super) const CASE: Case = Case {
    name: "convecting-block",
    title: "Block that cools by convection",
    about: "Newton's law of cooling on free surfaces, which are detected from the particles: a square block, and the \
            plate that it becomes with a periodic y axis. Particles at an edge of the block have the area of two \
            faces. Temperature rises over the air after 80 s, at a Biot number of 1 and a Fourier number of 0.5, are \
            compared with the series solution of the plate and with the product of two of them.",
    deck: "convecting-block",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture { series: BLOCK, subject: Subject::Last("temperature"), caption: "Temperature at the end" },
        Picture {
            series: BLOCK,
            subject: Subject::History(&["centre", "mean_temperature"]),
            caption: "Temperature in the centre and on average",
        },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["10 mm", "5 mm", "2.5 mm"],
        Effort::Full => &["10 mm", "5 mm", "2.5 mm", "1.25 mm"],
    };
    let mut variants = refinements(BLOCK, "", spacings);
    for variant in refinements(PLATE, "plate, ", spacings) {
        variants.push(variant.set("periodic.y", "[\"0 mm\", \"80 mm\"]"));
    }
    variants
}

fn rise(run: &Run, measure: &str) -> Option<f64> {
    Some(run.measure(measure)? - 273.15)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    let (middle, mean) = cooling_plate(1.0, 0.5);
    for (series, what, power) in [(PLATE, "plate", 1), (BLOCK, "block", 2)] {
        let quantities = [
            ("centre", format!("{what}: rise in the centre"), 100.0 * middle.powi(power)),
            ("mean_temperature", format!("{what}: mean rise"), 100.0 * mean.powi(power)),
        ];
        for (measure, name, exact) in quantities {
            if let Some(run) = runs.finest(series) {
                let finding = Finding::new(&name, Unit::KELVIN, run.label(), rise(run, measure));
                let finding = finding.exact("series", exact);
                findings.add(finding.must(Bounds::Relative(2e-3), "second order, at the quick spacing"));
            }
            let study = Study::exact(name, Unit::KELVIN, exact);
            let study = runs.series(series).fold(study, |s, run| s.point(run.label(), run.spacing, rise(run, measure)));
            findings.study(study.must_converge(1e-5, "second order: edges have the area of their faces"));
        }
        if let Some(run) = runs.finest(series) {
            let drift = run.summary().map(|s| s.energy.largest_relative_drift);
            let finding = Finding::new(format!("{what}: drift of the heat balance"), Unit::NONE, run.label(), drift);
            findings
                .add(finding.must(Bounds::AtMost(1e-11), "the heat that leaves is included; only rounding remains"));
        }
    }
}
