//! Taylor impact of a round bar of the same iron.

use super::super::{
    Bounds, Case, Effort, ExpectedWarning, Finding, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::Runs,
    variant::refinements,
};

const SPACING: &str = "spacing";

pub(super) const CASE: Case = Case {
    name: "taylor-bar",
    title: "Taylor impact of a round bar of Armco iron at 200 m/s",
    about: "A round bar with the dimensions of `taylor-plate`, in three dimensions. There is no published result: \
            the case shows the trend with the spacing and checks conservation.",
    deck: "taylor-bar",
    expected_warnings: &[
        ExpectedWarning::new(
            "plastic-work",
            "with plain updated Lagrangian sums the plastic work in the foot exceeds the energy of the impact; the case compares shapes and shows this",
        ),
        ExpectedWarning::new("hot", "a consequence of the plastic work"),
    ],
    variants,
    judge,
    pictures: &[Picture {
        series: SPACING,
        subject: Subject::BeforeAfter("plastic_strain"),
        caption: "Plastic strain before the impact and at 60 us",
    }],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["1.2 mm"],
        Effort::Full => &["0.8 mm", "0.5 mm", "0.4 mm"],
    };
    refinements(SPACING, "", spacings)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for (name, measure) in [("length", "length"), ("foot diameter", "foot_diameter")] {
        findings.study(runs.series(SPACING).fold(Study::trend(name, Unit::MILLIMETRE), |study, run| {
            study.point(run.label(), run.spacing, run.measure(measure))
        }));
    }
    for run in runs.series(SPACING) {
        let rounding = "rounding of pair sums in single precision over some thousand steps";
        let drift = run.summary().map(|s| s.energy.largest_relative_drift);
        let energy = Finding::new("drift of the energy balance", Unit::NONE, run.label(), drift);
        findings.add(energy.must(Bounds::AtMost(1e-6), rounding));
        let drift = run.summary().map(|s| s.largest_momentum_drift);
        let momentum = Finding::new("drift of linear momentum", Unit::NONE, run.label(), drift);
        findings.add(momentum.must(Bounds::AtMost(1e-6), rounding));
    }
}
