//! Taylor impact of a 42CrMo4 bar with heat, beside Abaqus and DynELA.

use super::super::{
    Bounds, Case, Effort, Finding, ReferenceKind, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::Runs,
    variant::refinements,
};

const SPACING: &str = "spacing";
const CHOICES: &str = "choices";
const FINEST: &str = "0.267769 mm";
const ZERO_CELSIUS: f64 = 273.15;

/// What is measured: name, measure of the deck, unit, Abaqus Explicit, DynELA (both 3D), what is asked of the finest run.
const ANSWERS: [(&str, &str, Unit, f64, f64, f64); 4] = [
    ("length", "length", Unit::MILLIMETRE, 26.55e-3, 26.52e-3, 0.01),
    ("foot diameter", "foot_diameter", Unit::MILLIMETRE, 11.22e-3, 11.18e-3, 0.03),
    ("largest plastic strain", "max_plastic_strain", Unit::NONE, 1.84, 1.84, 0.1),
    ("largest temperature", "max_temperature", Unit::KELVIN, 597.0 + ZERO_CELSIUS, 597.0 + ZERO_CELSIUS, 0.1),
];

pub(super) const CASE: Case = Case {
    name: "taylor-bar-42crmo4",
    title: "Taylor impact of a 42CrMo4 bar with heat at 287 m/s",
    about: "A round bar of 6.4 x 32.4 mm, Johnson-Cook with the constants of the DynELA benchmark (Pantalé et al.), \
            compared with Abaqus Explicit and DynELA in 3D at 80 us. A quarter of the bar against symmetry planes: \
            the wall is rigid and without friction, as in the reference. Heat is conducted, and diffuses by 0.03 mm \
            in that time. Strain and temperature are largest in the middle of the foot.",
    deck: "taylor-bar-42crmo4",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture {
            series: SPACING,
            subject: Subject::BeforeAfter("plastic_strain"),
            caption: "Plastic strain, before and at 80 us",
        },
        Picture { series: SPACING, subject: Subject::Last("temperature"), caption: "Temperature at 80 us" },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        // 5, 7, 9 and 12 rings.
        Effort::Quick => &["0.635294 mm"],
        Effort::Full => &["0.635294 mm", "0.456338 mm", "0.356044 mm", FINEST],
    };
    let mut variants = refinements(SPACING, "", spacings);
    if effort == Effort::Full {
        let choice = |label: &str, path: &str, value: &str| {
            Variant::of_series(format!("0.456338 mm, {label}"), CHOICES).spacing("0.456338 mm").set(path, value)
        };
        for strength in ["0.3", "3"] {
            let search = format!("{{ total-lagrangian = {{ hourglass = {strength} }} }}");
            variants.push(choice(&format!("hourglass control {strength}"), "search", &search));
        }
        variants.push(choice("current neighbours", "search", "skin"));
    }
    variants
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(SPACING).chain(runs.series(CHOICES)) {
        for (name, measure, unit, abaqus, dynela, share) in ANSWERS {
            let finding = Finding::new(name, unit, run.label(), run.measure(measure))
                .beside(ReferenceKind::Published, "Abaqus Explicit", abaqus)
                .beside(ReferenceKind::Published, "DynELA", dynela);
            findings.add(match run.label() {
                FINEST => finding.must(Bounds::Relative(share), "finite elements of the same model"),
                _ => finding,
            });
        }
    }
    for (name, measure, unit, abaqus, ..) in ANSWERS {
        let study = Study::exact(format!("{name}, error against Abaqus"), unit, abaqus);
        findings.study(
            runs.series(SPACING).fold(study, |study, run| study.point(run.label(), run.spacing, run.measure(measure))),
        );
    }
    let drift = |run: &super::super::runs::Run| run.summary().map(|s| s.energy.largest_relative_drift);
    for run in runs.series(SPACING) {
        findings.add(
            Finding::new("drift of the energy balance", Unit::NONE, run.label(), drift(run))
                .must(Bounds::AtMost(1e-5), "rounding of pair sums in single precision over some thousand steps"),
        );
    }
    findings.note(
        "The hourglass control determines the foot. Its springs soften and yield with the metal; springs that stay \
         elastic resist the flow. Sums over current neighbours give too wide a foot. Our own axisymmetric finite \
         elements (`reference/finite-elements`) give 26.53 mm, 11.23 mm, 1.87 and 879 K.",
    );
}
