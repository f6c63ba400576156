//! Colliding rubber rings: Gray, Monaghan & Swift (2001).

use super::super::{
    Bounds, Case, Effort, Finding, ReferenceKind, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::Runs,
    variant::refinements,
};

const SPACING: &str = "spacing";
const CHOICES: &str = "choices";

/// Speed of each ring before the collision, m/s.
const SPEED: f64 = 237.9;

/// Speed after over speed before by finite elements, 16 across and 192 around half a ring (`reference/finite-elements/rubber_rings.py`); with 10 x 120
/// elements it is 0.798.
const ELEMENTS: f64 = 0.8;

pub(super) const CASE: Case = Case {
    name: "rubber-rings",
    title: "Colliding rubber rings",
    about: "Gray, Monaghan & Swift (2001), with the constants of PySPH's example: two elastic rings collide, \
            flatten, and must separate without tearing. The gap between the edges of the rings shows that they \
            separate, and finite elements of the same rings how fast. Part of the energy remains in vibrations of \
            the rings. Sums over current neighbours need a wider kernel; the smallest number of neighbours that any \
            particle ever had reveals a tear.",
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
        let current = |label: &str| {
            Variant::of_series(label, CHOICES)
                .spacing("1 mm")
                .set("method", "updated-lagrangian")
                .set("contact", "penalty")
                .set("numerics.artificial-stress", "{ epsilon = 0.3, exponent = 4 }")
                .set("numerics.xsph", "0.5")
        };
        let wide = current("current neighbours, Wendland C2 over 1.6 spacings").set("numerics.kernel", "wendland-c2");
        variants.push(wide.set("particles.smoothing", "1.6"));
        // Torn rings are what it shows.
        variants.push(current("current neighbours, cubic spline over 1.2 spacings").may_fail());
    }
    variants
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(SPACING) {
        let finding = |name: &str, unit, value| Finding::new(name, unit, run.label(), value);
        let gap = run.measure("left_edge").zip(run.measure("right_edge")).map(|(left, right)| right - left);
        findings.add(finding("gap between the rings at 0.4 ms", Unit::MILLIMETRE, gap).must(
            Bounds::AtLeast(3.0 * run.spacing),
            "they separate: three spacings, beyond the reach of the \
                                                           contact",
        ));
        let share = run.measure("rebound_speed").map(|v| v / SPEED);
        findings.add(
            finding("speed after the collision over speed before", Unit::NONE, share)
                .beside(ReferenceKind::FiniteElements, "finite elements, 16 x 192", ELEMENTS)
                .must(
                    Bounds::Relative(if run.spacing > 1.2e-3 { 0.02 } else { 0.01 }),
                    "ten rows of particles across; the error of six rows, at low resolution, is that of six \
                     elements, 1.1 %",
                )
                // On a hard contact coarse rings bend too little: six rows part with 0.828 of the speed from a rigid wall four times as stiff as usual, with
                // 0.806 from the usual one, which is soft. Known, and told.
                .missed_within((run.spacing > 0.6e-3).then_some(Bounds::Relative(0.045))),
        );
        let drift = run.summary().map(|s| s.largest_momentum_drift);
        findings.add(
            finding("drift of linear momentum", Unit::NONE, drift)
                .must(Bounds::AtMost(1e-6), "rounding of the pair sums in single precision"),
        );
    }
    for run in runs.series(CHOICES) {
        let fewest = run.measure("fewest_neighbors");
        findings.add(Finding::new(
            "fewest neighbours of any particle (few mean a tear)",
            Unit::NONE,
            run.label(),
            fewest,
        ));
    }
}
