//! Conduction through a slab.

use super::super::{
    Bounds, Case, Effort, Finding, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
    variant::refinements,
};
use super::heat_solutions::slab;

const SPACING: &str = "spacing";
const WIDE: &str = "h = 1.2 spacings";

pub(super) const CASE: Case = Case {
    name: "heat-slab",
    title: "Conduction through a slab",
    about: "One face of a cold slab is set to 100 degC and kept there, the other one is kept cold; both are \
            particles with a prescribed temperature. Temperatures at three depths after 60 s, as rises over the cold \
            side, are compared with the series solution. The bodies do not move.",
    deck: "heat-slab",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[Picture {
        series: SPACING,
        subject: Subject::History(&["quarter", "middle", "three_quarters"]),
        caption: "Temperature at three depths",
    }],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["10 mm", "5 mm", "2.5 mm"],
        Effort::Full => &["10 mm", "5 mm", "2.5 mm", "1.25 mm"],
    };
    let mut variants = refinements(SPACING, "", spacings);
    for variant in refinements(WIDE, "h = 1.2 spacings, ", spacings) {
        variants.push(variant.set("particles.smoothing", "1.2"));
    }
    variants
}

/// Name, what it is, depth in m.
const DEPTHS: [(&str, &str, f64); 3] = [
    ("quarter", "rise at a quarter of the thickness", 0.02),
    ("middle", "rise in the middle", 0.04),
    ("three_quarters", "rise at three quarters", 0.06),
];

fn exact(x: f64) -> f64 {
    slab(100.0, x, 0.08, 1e-5, 60.0)
}

/// Rise over 0 degC.
fn rise(run: &Run, measure: &str) -> Option<f64> {
    Some(run.measure(measure)? - 273.15)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for (series, asked) in [(SPACING, true), (WIDE, false)] {
        let Some(run) = runs.finest(series) else { continue };
        for (measure, name, x) in DEPTHS {
            let finding = Finding::new(name, Unit::KELVIN, run.label(), rise(run, measure)).exact("series", exact(x));
            findings.add(match asked {
                true => finding.must(Bounds::Relative(5e-3), "second order: 0.3 % at the quick spacing"),
                false => finding,
            });
        }
        let drift = run.summary().map(|s| s.energy.largest_relative_drift);
        let finding = Finding::new("drift of the heat balance", Unit::NONE, run.label(), drift);
        findings.add(finding.must(Bounds::AtMost(1e-11), "antisymmetric exchange; only rounding remains"));
    }
    for (series, prefix) in [(SPACING, ""), (WIDE, "h = 1.2 spacings: ")] {
        for (measure, name, x) in DEPTHS {
            let study = Study::exact(format!("{prefix}{name}"), Unit::KELVIN, exact(x));
            let study = runs.series(series).fold(study, |s, run| s.point(run.label(), run.spacing, rise(run, measure)));
            findings.study(match series {
                SPACING => study.must_converge(
                    1e-5,
                    "second order in the spacing; the time step is proportional to \
                                                      its square",
                ),
                _ => study,
            });
        }
    }
}
