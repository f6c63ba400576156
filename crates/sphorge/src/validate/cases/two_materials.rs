//! Two materials in contact.

use super::super::{
    Bounds, Case, Effort, Finding, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
    variant::refinements,
};
use super::heat_solutions::error_function;

const SPACING: &str = "spacing";
const CONTACT: &str = "contact that never pulls";

pub(super) const CASE: Case = Case {
    name: "two-materials",
    title: "Two materials in contact",
    about: "Cold metal and hot copper, whose conductivity is 20 times larger, touch. Their interface immediately \
            takes one temperature and keeps it; its computed value is the one at which the fluxes from the particles \
            on both sides are equal. Rises over the cold side after 4 s are compared with error functions. Heat is \
            exchanged with kernel-sum contact and with penalty contact.",
    deck: "two-materials",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[Picture {
        series: SPACING,
        subject: Subject::History(&["cold_side", "hot_side", "in_metal", "in_copper"]),
        caption: "Temperature on both sides of the interface and away from it",
    }],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["4 mm", "2 mm", "1 mm"],
        Effort::Full => &["4 mm", "2 mm", "1 mm", "0.5 mm"],
    };
    let mut variants = refinements(SPACING, "", spacings);
    for variant in refinements(CONTACT, "contact that never pulls, ", &["1 mm"]) {
        variants.push(variant.set("contact", "penalty"));
    }
    variants
}

/// Conductivity, W/(m K), and capacity per volume, J/(m³ K).
const METAL: (f64, f64) = (20.0, 4000.0 * 500.0);
const COPPER: (f64, f64) = (400.0, 8930.0 * 385.0);

/// Rise of the seam, K.
fn seam_exact() -> f64 {
    let effusivity = |(k, c): (f64, f64)| (k * c).sqrt();
    100.0 * effusivity(COPPER) / (effusivity(METAL) + effusivity(COPPER))
}

/// Rise at a distance (m) from the seam after 4 s, K.
fn exact((k, c): (f64, f64), start: f64, distance: f64) -> f64 {
    let reach = 2.0 * (k / c * 4.0).sqrt();
    seam_exact() + (start - seam_exact()) * error_function(distance / reach)
}

fn rise(run: &Run, measure: &str) -> Option<f64> {
    Some(run.measure(measure)? - 273.15)
}

/// Temperature between two particles at equal distances that passes the same flux to both.
fn seam(run: &Run) -> Option<f64> {
    Some((METAL.0 * rise(run, "cold_side")? + COPPER.0 * rise(run, "hot_side")?) / (METAL.0 + COPPER.0))
}

type Quantity = (&'static str, fn(&Run) -> Option<f64>, fn() -> f64);

const QUANTITIES: [Quantity; 3] = [
    ("rise of the interface", seam, seam_exact),
    ("rise in the metal, 10 mm from the interface", |run| rise(run, "in_metal"), || exact(METAL, 0.0, 0.01)),
    ("rise in the copper, 20 mm from the interface", |run| rise(run, "in_copper"), || exact(COPPER, 100.0, 0.02)),
];

fn judge(runs: &Runs, findings: &mut Findings) {
    for series in [SPACING, CONTACT] {
        let Some(run) = runs.finest(series) else { continue };
        for (name, value, exact) in QUANTITIES {
            let finding = Finding::new(name, Unit::KELVIN, run.label(), value(run)).exact("error functions", exact());
            findings.add(finding.must(
                Bounds::Relative(5e-3),
                "the interface is two particles wide; at the quick \
                                                               spacing",
            ));
        }
        let drift = run.summary().map(|s| s.energy.largest_relative_drift);
        let finding = Finding::new("drift of the heat balance", Unit::NONE, run.label(), drift);
        findings.add(finding.must(Bounds::AtMost(1e-11), "antisymmetric exchange; only rounding remains"));
    }
    for (name, value, exact) in QUANTITIES {
        let study = Study::exact(name, Unit::KELVIN, exact());
        let study = runs.series(SPACING).fold(study, |s, run| s.point(run.label(), run.spacing, value(run)));
        findings.study(study.must_converge(1e-4, "second order in the spacing"));
    }
}
