//! Axial vibration of an elastic bar.

use super::super::{
    Bounds, Case, Effort, Finding, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
    variant::refinements,
};

const SPACING: &str = "spacing";
const PLAIN: &str = "plain sums";

/// Length of the bar, m.
const LENGTH: f64 = 0.0324;
/// `sqrt(E/rho)`, m/s.
const BAR_SPEED: f64 = 3619.7;

pub(super) const CASE: Case = Case {
    name: "elastic-bar",
    title: "Axial vibration of a slender elastic bar",
    about: "The bar is fixed at one end by a symmetry plane and starts with a uniform velocity. Its mean velocity is \
            a triangle wave with the period of two round trips, `4 L/c`, from which `c` is computed. A quarter of \
            the section is modelled, between symmetry planes.",
    deck: "elastic-bar",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture {
            series: SPACING,
            subject: Subject::History(&["mean_velocity"]),
            caption: "Mean axial velocity: a triangle wave in theory",
        },
        Picture { series: SPACING, subject: Subject::Last("velocity"), caption: "Velocity at the end" },
        Picture {
            series: PLAIN,
            subject: Subject::History(&["mean_velocity"]),
            caption: "Mean axial velocity with plain sums",
        },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["0.81 mm", "0.54 mm"],
        Effort::Full => &["0.81 mm", "0.54 mm", "0.405 mm", "0.27 mm"],
    };
    let mut variants = refinements(SPACING, "", spacings);
    for variant in refinements(PLAIN, "plain sums, ", spacings) {
        variants.push(variant.set("numerics.gradient-correction", "none"));
    }
    variants
}

fn wave_speed(run: &Run) -> Option<f64> {
    run.measure("period").map(|period| 4.0 * LENGTH / period)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for series in [SPACING, PLAIN] {
        let Some(run) = runs.finest(series) else { continue };
        let speed = Finding::new("wave speed", Unit::METRE_PER_SECOND, run.label(), wave_speed(run));
        let speed = speed.exact("sqrt(E/rho)", BAR_SPEED);
        let period = Finding::new("period", Unit::MICROSECOND, run.label(), run.measure("period"));
        let period = period.exact("4 L/c", 4.0 * LENGTH / BAR_SPEED);
        let drift = run.largest_drift(&["kinetic_energy", "elastic_energy"], "kinetic_energy");
        let energy = Finding::new("largest drift of kinetic plus elastic energy", Unit::PERCENT, run.label(), drift);
        if series == SPACING {
            findings.add(
                speed.must(Bounds::Relative(0.01), "half a spacing at the free end is 0.4 % to 1.3 % of the length"),
            );
            findings.add(period);
            findings.add(energy.must(
                Bounds::AtMost(1e-2),
                "these settings conserve energy; the step is of second \
                                                            order",
            ));
            let booked = run.summary().map(|s| s.energy.integration.abs());
            let first = run.column("kinetic_energy").and_then(|column| column.first().copied());
            let booked = booked.zip(first).map(|(booked, first)| booked / first);
            let quantity = "energy booked by the integrator over the kinetic energy at the start";
            findings.add(Finding::new(quantity, Unit::PERCENT, run.label(), booked).must(
                Bounds::AtMost(0.1),
                "an undamped wave with a sharp front; third order in the step (`tests/physics/conservation.rs`)",
            ));
        } else {
            findings.add(speed);
            findings.add(period);
            findings.add(energy);
        }
    }
    for (series, name) in [(SPACING, "wave speed"), (PLAIN, "wave speed, plain sums")] {
        let study = Study::exact(name, Unit::METRE_PER_SECOND, BAR_SPEED);
        findings.study(
            runs.series(series).fold(study, |study, run| study.point(run.label(), run.spacing, wave_speed(run))),
        );
    }
    findings.note(
        "Plain sums underestimate the strain at free faces, so a slender bar, which consists mostly of faces, is too \
         soft. The same bar with more particles across converges to the theory.",
    );
    findings.note(
        "Without viscosity nothing damps the shortest waves of the lattice: over many periods they absorb the energy \
         of the long wave, sooner at finer spacings. The period is that of the first two oscillations.",
    );
}
