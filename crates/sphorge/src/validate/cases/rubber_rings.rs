//! Colliding rubber rings: Gray, Monaghan & Swift (2001).

use super::super::{
    Bounds, Case, Effort, Finding, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::Runs,
    variant::refinements,
};

const SPACING: &str = "spacing";
const CHOICES: &str = "choices";

/// Speed of each ring before the collision, m/s.
const SPEED: f64 = 237.9;

pub(super) const CASE: Case = Case {
    name: "rubber-rings",
    title: "Colliding rubber rings",
    about: "Gray, Monaghan & Swift (2001), with the constants of PySPH's example: two elastic rings collide, flatten, and must part \
            without a torn particle. The fewest neighbours any particle ever had tell a tear; the edges of the rings, that they \
            parted. Part of the energy stays in vibrations of the rings.",
    deck: "rubber-rings",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture {
            series: SPACING,
            subject: Subject::BeforeAfter("von_mises_stress"),
            caption: "Before the collision and at 0.4 ms",
        },
        Picture {
            series: SPACING,
            subject: Subject::History(&["rebound_speed"]),
            caption: "Mean velocity of the right ring",
        },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["1.6667 mm"],
        Effort::Full => &["1 mm", "0.5 mm"],
    };
    let mut variants = refinements(SPACING, "", spacings);
    if effort == Effort::Full {
        let cubic = Variant::of_series("1 mm, cubic spline over 1.2 spacings", CHOICES).spacing("1 mm");
        variants.push(cubic.set("numerics.kernel", "cubic-spline").set("particles.smoothing", "1.2"));
    }
    variants
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(SPACING) {
        let finding = |name: &str, unit, value| Finding::new(name, unit, run.label(), value);
        let gap = run.measure("left_edge").zip(run.measure("right_edge")).map(|(left, right)| right - left);
        findings.add(
            finding("gap between the rings at 0.4 ms", Unit::MILLIMETRE, gap)
                .must(Bounds::AtLeast(3.0 * run.spacing), "they part: three spacings, beyond the reach of the contact"),
        );
        findings.add(finding("fewest neighbours of any particle", Unit::NONE, run.measure("fewest_neighbors")).must(
            Bounds::AtLeast(9.0),
            "no torn particle: those at the edges have 13 and more, a lone pair of rows 6",
        ));
        let share = run.measure("rebound_speed").map(|v| v / SPEED);
        findings.add(finding("speed after over speed before", Unit::NONE, share));
        let drift = run.summary().map(|s| s.largest_momentum_drift);
        findings.add(
            finding("drift of linear momentum", Unit::NONE, drift)
                .must(Bounds::AtMost(1e-6), "pair sums in single precision leave their rounding"),
        );
    }
    for run in runs.series(CHOICES) {
        let fewest = run.measure("fewest_neighbors");
        findings.add(Finding::new("fewest neighbours of any particle (it tears)", Unit::NONE, run.label(), fewest));
    }
}
