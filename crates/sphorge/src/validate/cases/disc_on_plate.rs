//! Steel disc through an aluminium plate at 3.1 km/s: PySPH's deck, corrected.

use super::super::{
    Bounds, Case, Effort, ExpectedWarning, Finding, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::Runs,
    variant::refinements,
};

const SPACING: &str = "spacing";

pub(super) const CASE: Case = Case {
    name: "disc-on-plate",
    title: "Steel disc through an aluminium plate at 3.1 km/s",
    about: "The example of PySPH with corrected units. There are no published results: the numbers are shown with \
            the spacing, and only conservation is checked.",
    deck: "disc-on-plate",
    expected_warnings: &[
        ExpectedWarning::new(
            "pieces",
            "perforation breaks the plate and the projectile without a fracture law: the fragments follow from the \
             numerical sums",
        ),
        ExpectedWarning::new("lost-neighbors", "the debris contains fragments of one or two particles"),
        ExpectedWarning::new("expansion", "the debris is strongly expanded, and the material has no `spall-pressure`"),
    ],
    variants,
    judge,
    pictures: &[
        Picture {
            series: SPACING,
            subject: Subject::BeforeAfter("pressure"),
            caption: "Before the impact and at 8 us",
        },
        Picture { series: SPACING, subject: Subject::Last("plastic_strain"), caption: "Plastic strain at 8 us" },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["0.4 mm"],
        Effort::Full => &["0.4 mm", "0.2 mm", "0.1 mm"],
    };
    refinements(SPACING, "", spacings)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(SPACING) {
        let rounding = "rounding of pair sums in single precision over some thousand steps";
        let energy = run.summary().map(|s| s.energy.largest_relative_drift);
        let energy = Finding::new("drift of the energy balance", Unit::NONE, run.label(), energy);
        findings.add(energy.must(Bounds::AtMost(1e-5), rounding));
        let momentum = run.summary().map(|s| s.largest_momentum_drift);
        let momentum = Finding::new("drift of linear momentum", Unit::NONE, run.label(), momentum);
        findings.add(momentum.must(Bounds::AtMost(1e-6), rounding));
    }
    for (name, unit, measure) in [
        ("crater diameter", Unit::MILLIMETRE, "crater_diameter"),
        ("length of the cloud", Unit::MILLIMETRE, "cloud_length"),
        ("width of the cloud", Unit::MILLIMETRE, "cloud_width"),
        ("velocity of the disc", Unit::METRE_PER_SECOND, "residual_velocity"),
    ] {
        findings.study(
            runs.series(SPACING).fold(Study::trend(name, unit), |study, run| {
                study.point(run.label(), run.spacing, run.measure(measure))
            }),
        );
    }
}
