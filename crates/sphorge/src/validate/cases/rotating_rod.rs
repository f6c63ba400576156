//! Ten turns of a free elastic rod.

use super::super::{
    Bounds, Case, Effort, ExpectedWarning, Finding, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
    variant::refinements,
};

const SPACING: &str = "spacing";
const DEFAULT: &str = "default numerics";
const PLAIN: &str = "plain sums";
const PLAIN_TEARS: &str = "plain sums give the free faces of a rod that turns a strain, and with particles of 1.25 mm its tension tears the ends \
                           within a tenth of a turn: what the corrected form is for";

pub(super) const CASE: Case = Case {
    name: "rotating-rod",
    title: "Ten turns of a free elastic rod",
    about: "Nothing acts on the rod, so energy, linear and angular momentum are constant. The energy balance \
            (kinetic plus internal energy) is conserved by construction. Kinetic plus elastic energy, computed from \
            the stress, shows whether the stress did the work that the forces did. Largest drifts over ten turns; \
            energy is relative to the initial total, linear momentum to the sum of m |v|.",
    deck: "rotating-rod",
    expected_warnings: &[
        ExpectedWarning { name: "tearing", reason: PLAIN_TEARS, runs: &[PLAIN] },
        ExpectedWarning { name: "pairing", reason: PLAIN_TEARS, runs: &[PLAIN] },
    ],
    variants,
    judge,
    pictures: &[
        Picture {
            series: SPACING,
            subject: Subject::BeforeAfter("von_mises_stress"),
            caption: "Before and after ten turns",
        },
        Picture {
            series: SPACING,
            subject: Subject::History(&["kinetic_energy", "elastic_energy", "angular_momentum_z"]),
            caption: "Energy and angular momentum",
        },
        Picture {
            series: PLAIN,
            subject: Subject::BeforeAfter("von_mises_stress"),
            caption: "Before and after, plain sums",
        },
        Picture {
            series: PLAIN,
            subject: Subject::History(&["kinetic_energy", "elastic_energy", "angular_momentum_z"]),
            caption: "Energy and angular momentum, plain sums",
        },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["5 mm"],
        Effort::Full => &["5 mm", "2.5 mm"],
    };
    let mut variants = refinements(SPACING, "", spacings);
    for variant in refinements(DEFAULT, "default viscosity, ", spacings) {
        variants.push(variant.set("numerics.viscosity", "true"));
    }
    let plain: &[&str] = match effort {
        Effort::Quick => &["5 mm", "2.5 mm"],
        Effort::Full => &["5 mm", "2.5 mm", "1.25 mm"],
    };
    // A tenth of a turn tells the order; after more the plain rod has long stopped turning.
    for variant in refinements(PLAIN, "plain sums, ", plain) {
        let variant = variant.set("method", "updated-lagrangian").set("numerics.gradient-correction", "none");
        variants.push(variant.set("time.end", "10.472 ms"));
    }
    variants
}

/// Largest drift of angular momentum.
fn angular(run: &Run) -> Option<f64> {
    run.largest_drift(&["angular_momentum_z"], "angular_momentum_z")
}

/// Largest drift of kinetic plus elastic energy.
fn energy(run: &Run) -> Option<f64> {
    run.largest_drift(&["kinetic_energy", "elastic_energy"], "kinetic_energy")
}

/// Round-off of some 30 000 steps.
const ROUND_OFF: f64 = 1e-12;

/// What nothing that acts within the rod may change.
fn ledgers(run: &Run, findings: &mut Findings) {
    let finding = |name: &str, value| Finding::new(name, Unit::NONE, run.label(), value);
    let conserved = "conserved exactly with these settings; only rounding remains";
    let ledger = run.summary().map(|s| s.energy.largest_relative_drift);
    findings.add(finding("drift of the energy balance", ledger).must(Bounds::AtMost(ROUND_OFF), conserved));
    let linear = run.summary().map(|s| s.largest_momentum_drift);
    findings.add(finding("drift of linear momentum", linear).must(Bounds::AtMost(ROUND_OFF), conserved));
    findings.add(finding("drift of angular momentum", angular(run)).must(Bounds::AtMost(ROUND_OFF), conserved));
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(SPACING) {
        let finding = |name: &str, value| Finding::new(name, Unit::NONE, run.label(), value);
        findings.add(
            finding("drift of kinetic plus elastic energy", energy(run))
                .must(Bounds::AtMost(1e-3), "0.1 % over ten turns; the step is of second order"),
        );
        ledgers(run, findings);
    }
    for run in runs.series(DEFAULT) {
        let quantity = "drift of kinetic plus elastic energy, due to the viscous damping of the oscillation";
        let drift = Finding::new(quantity, Unit::NONE, run.label(), energy(run));
        findings.add(drift.must(
            Bounds::AtMost(5e-3),
            "less than the energy of the oscillation, a hundredth of the \
                                                       total",
        ));
        ledgers(run, findings);
    }
    for run in runs.series(PLAIN) {
        let finding = |name: &str, value| Finding::new(name, Unit::NONE, run.label(), value);
        let ledger = run.summary().map(|s| s.energy.largest_relative_drift);
        findings.add(finding("drift of the energy balance, a tenth of a turn", ledger));
        let linear = run.summary().map(|s| s.largest_momentum_drift);
        findings.add(finding("drift of linear momentum, a tenth of a turn", linear));
    }
    let drift = |name: &str, of: fn(&Run) -> Option<f64>| {
        runs.series(PLAIN)
            .fold(Study::exact(name, Unit::NONE, 0.0), |study, run| study.point(run.label(), run.spacing, of(run)))
    };
    findings.study(drift("drift of angular momentum, plain sums, a tenth of a turn", angular));
    findings.study(drift("drift of kinetic plus elastic energy, plain sums, a tenth of a turn", energy));
    findings.note(
        "The rod has no viscosity, and over ten turns kinetic plus elastic energy never exceeds that of the start by \
         more than 5e-6: hourglass springs give back what they take.",
    );
    findings.note(
        "Plain sums give a strain at free faces in pure rotation, and their forces exert a torque. Over ten turns \
         they convert most of the rotation to strain, so their drift is measured over a tenth of a turn.",
    );
}
