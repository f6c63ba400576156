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
const FREE: &str = "free ends";
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
/// Free length of the plate, m.
const LENGTH: f64 = 0.2;
/// Period of the first mode of the plate with both ends free, s: eigenvalue of nine-node elements, 40 along and 4 across
/// (`reference/finite-elements/plate_modes.py`).
const FREE_PERIOD: f64 = 0.041_447;

/// A period of finite elements for the clamp that particles make: it holds their centres, so that it begins half a spacing behind the face. The
/// period goes with the square of the length (`plate_modes.py`: within 0.02 %).
fn clamped(period: f64, spacing: f64) -> f64 {
    period * (1.0 + 0.5 * spacing / LENGTH).powi(2)
}

pub(super) const CASE: Case = Case {
    name: "oscillating-plate",
    title: "Oscillating plate of rubber",
    about: "Gray, Monaghan & Swift (2001), four amplitudes. The reference is a finite-element run of the same plate \
            with the same clamp and the same initial velocity (CalculiX, 20-node bricks, large displacements); \
            thin-plate theory gives 0.254 s. Particles are held at their centres. The plate that they clamp is \
            therefore half a spacing longer, and so is that of the reference. A plate with two free ends has no \
            clamp and tests the bending alone. The period is the time at which the deflection of the free end is \
            zero and rising again (CalculiX: the mean of two).",
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
    for variant in refinements(FREE, "free ends, ", &spacings[..spacings.len().min(2)]) {
        let variant = variant
            .set("body.plate.shape.box.min.0", "\"0 mm\"")
            .set("motion", "[]")
            .set("region.clamp.shape.box.max.0", "\"10 mm\"")
            .set("time.end", "\"60 ms\"");
        let variant = variant.set("output.history-interval", "\"0.2 ms\"");
        variants.push(
            variant
                .set("body.plate.velocity-profile.rows", &free_mode())
                .set("body.plate.velocity-profile.amplitude.1", "\"0.2 m/s\""),
        );
    }
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

/// Rows of the velocity profile of the first mode of a free thin plate, one at its ends.
fn free_mode() -> String {
    let beta = 4.730_040_745_f64;
    let share = (beta.cosh() - beta.cos()) / (beta.sinh() - beta.sin());
    let row = |k: u32| {
        let x = beta * f64::from(k) / 50.0;
        let shape = 0.5 * (x.cosh() + x.cos() - share * (x.sinh() + x.sin()));
        format!("[{}, {shape:.6}]", LENGTH * f64::from(k) / 50.0)
    };
    format!("[{}]", (0..=50).map(row).collect::<Vec<_>>().join(", "))
}

/// Time at which the deflection of the free end is zero and rising again, s.
fn period(run: &Run) -> Option<f64> {
    let (time, deflection) = (run.column("time")?, run.column("end_deflection")?);
    let rises = |k: &usize| deflection[*k] < 0.0 && deflection[k + 1] >= 0.0;
    // The rounding of the first row is no crossing.
    let k = (1..deflection.len().checked_sub(1)?).find(rises)?;
    Some(time[k] - deflection[k] * (time[k + 1] - time[k]) / (deflection[k + 1] - deflection[k]))
}

/// Adds the period of the elements for the clamp of the particles, then that for a clamp at the face.
fn beside_elements(finding: Finding, period: f64, spacing: f64) -> Finding {
    let finding =
        finding.beside(ReferenceKind::Published, "CalculiX, clamped half a spacing behind", clamped(period, spacing));
    finding.beside(ReferenceKind::Published, "CalculiX", period)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(AMPLITUDES) {
        let row = AMPLITUDE.iter().find(|row| row.0 == run.label());
        let finding = Finding::new("period", Unit::MILLISECOND, run.label(), period(run));
        findings.add(match row {
            Some(row) => beside_elements(finding, row.2, run.spacing).must(
                Bounds::Relative(0.01),
                "ten particles across: bending is too soft by twice 0.4 %, an error of the faces of first order",
            ),
            None => finding,
        });
    }
    for run in runs.series(FREE) {
        let finding = Finding::new("period with free ends", Unit::MILLISECOND, run.label(), period(run));
        let finding = finding.beside(ReferenceKind::FiniteElements, "finite elements", FREE_PERIOD);
        findings.add(finding.must(Bounds::Relative(0.01), "five or more particles across, without a clamp"));
    }
    let finding = |run: &Run| {
        let finding = Finding::new("period", Unit::MILLISECOND, run.label(), period(run));
        beside_elements(finding, REFERENCE, run.spacing)
    };
    for run in runs.series(CHOICES) {
        findings.add(finding(run));
    }
    if runs.series(SPACING).count() == 1
        && let Some(run) = runs.finest(SPACING)
    {
        findings
            .add(finding(run).must(Bounds::Relative(0.015), "five particles across; see the study at full resolution"));
    }
    let study = Study::exact("period at 0.01 c0, error against CalculiX", Unit::MILLISECOND, REFERENCE);
    findings.study(
        runs.series(SPACING)
            .fold(study, |study, run| study.point(run.label(), run.spacing, period(run)))
            .must_converge(0.0, "errors of clamp and faces, of first order in the spacing"),
    );
    findings.note(
        "Most of the error of the clamped plate, which oscillates too slowly, is due to the position of the clamp: \
         one row of held particles more or less changes the period by 4.0 % at 4 mm, twice the spacing over the \
         length. The plate with free ends is within 0.4 % at 4 mm and 0.1 % at 2 mm. Hourglass springs carry a part \
         of the bending: with smoothing lengths of 1.2 spacings and no springs the period of the clamped plate is \
         0.301 s at 4 mm, with a strength of 1 and 3 it is 0.295 s and 0.285 s.",
    );
    findings.note(
        "Sums over current neighbours make the plate too soft for two reasons. The gradient at a face is that of \
         half a spacing inside: in the linear eigenvalue problem of the corrected sums, ten particles across give \
         0.2686 s (plain sums 0.2899 s), 32 give 0.2576 s. The artificial stress removes a part of every tension; \
         without it, particles clump already at strains of 1 %.",
    );
}
