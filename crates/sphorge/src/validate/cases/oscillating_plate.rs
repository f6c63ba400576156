//! Oscillating plate of rubber: Gray, Monaghan & Swift (2001).

use super::super::{
    Bounds, Case, Effort, Finding, ReferenceKind, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
    variant::refinements,
};

const SPACING: &str = "spacing";
const AMPLITUDES: &str = "amplitudes";
const CHOICES: &str = "choices";

/// Share of the sound speed of 57.03 m/s, velocity of the free end in m/s, period in s by CalculiX
/// (`reference/calculix/oscillating_plate.json`).
const AMPLITUDE: [(&str, &str, f64); 4] = [
    ("0.001 c0", "0.05703 m/s", 0.254_73),
    ("0.01 c0", "0.5703 m/s", 0.254_72),
    ("0.03 c0", "1.7109 m/s", 0.254_62),
    ("0.05 c0", "2.8515 m/s", 0.254_47),
];
/// That of 0.01 c0, which the deck has.
const REFERENCE: f64 = AMPLITUDE[1].2;

pub(super) const CASE: Case = Case {
    name: "oscillating-plate",
    title: "Oscillating plate of rubber",
    about: "Gray, Monaghan & Swift (2001), four amplitudes. The reference is a finite-element run of the same plate with the same \
            clamp and the same initial velocity (CalculiX, 20-node bricks, large displacements); thin-plate theory gives 0.254 s. \
            The period is the time at which the deflection of the free end is zero and rising again (CalculiX: the mean of two).",
    deck: "oscillating-plate",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture {
            series: SPACING,
            subject: Subject::History(&["end_deflection"]),
            caption: "Deflection of the free end, 0.01 c0",
        },
        Picture { series: AMPLITUDES, subject: Subject::Last("von_mises_stress"), caption: "The plate at 0.05 c0" },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["4 mm"],
        Effort::Full => &["4 mm", "2 mm", "1.3333 mm"],
    };
    let mut variants = refinements(SPACING, "", spacings);
    if effort == Effort::Full {
        for (label, velocity, _) in AMPLITUDE {
            let variant = Variant::of_series(label, AMPLITUDES);
            variants.push(variant.set("body.plate.velocity-profile.amplitude.1", &format!("\"{velocity}\"")));
        }
        // Sums over current neighbours, with what they need.
        let current = |label: &str| {
            Variant::of_series(label, CHOICES)
                .set("search", "skin")
                .set("numerics.gradient-correction", "linear")
                .set("numerics.artificial-stress", "true")
        };
        variants.push(current("current neighbours"));
        variants.push(current("current neighbours, plain gradient").set("numerics.gradient-correction", "none"));
        variants.push(current("current neighbours, no artificial stress").set("numerics.artificial-stress", "false"));
    }
    variants
}

/// Time at which the deflection of the free end is zero and rising again, s.
fn period(run: &Run) -> Option<f64> {
    let (time, deflection) = (run.column("time")?, run.column("end_deflection")?);
    let rises = |k: &usize| deflection[*k] < 0.0 && deflection[k + 1] >= 0.0;
    // The rounding of the first row is no crossing.
    let k = (1..deflection.len().checked_sub(1)?).find(rises)?;
    Some(time[k] - deflection[k] * (time[k + 1] - time[k]) / (deflection[k + 1] - deflection[k]))
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(AMPLITUDES) {
        let row = AMPLITUDE.iter().find(|row| row.0 == run.label());
        let finding = Finding::new("period", Unit::MILLISECOND, run.label(), period(run));
        findings.add(match row {
            Some(row) => finding.beside(ReferenceKind::Published, "CalculiX", row.2).must(
                Bounds::Relative(0.03),
                "ten particles across: the gradient at a face is that of half a spacing inside, an error of first order",
            ),
            None => finding,
        });
    }
    let finding = |run: &Run| {
        let finding = Finding::new("period", Unit::MILLISECOND, run.label(), period(run));
        finding.beside(ReferenceKind::Published, "CalculiX", REFERENCE)
    };
    for run in runs.series(CHOICES) {
        findings.add(finding(run));
    }
    if runs.series(SPACING).count() == 1
        && let Some(run) = runs.finest(SPACING)
    {
        findings
            .add(finding(run).must(Bounds::Relative(0.05), "five particles across; see the study at full resolution"));
    }
    let study = Study::exact("period at 0.01 c0, error against CalculiX", Unit::MILLISECOND, REFERENCE);
    findings.study(
        runs.series(SPACING)
            .fold(study, |study, run| study.point(run.label(), run.spacing, period(run)))
            .must_converge(0.0, "an error of the faces, of first order in the spacing"),
    );
    findings.note(
        "Sums over current neighbours make the plate soft for two reasons. The gradient at a face is that of half a spacing inside: \
         in the linear eigenvalue problem of the corrected sums, ten particles across give 0.2686 s (plain sums 0.2899 s), 32 give \
         0.2576 s. The artificial stress takes away a part of every tension; without it, strains of 1 % already make the particles \
         clump.",
    );
}
