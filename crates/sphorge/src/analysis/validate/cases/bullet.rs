//! A bullet through a plate with every search strategy: Fraser et al., Table 1.

use super::super::{
    Bounds, Case, Effort, Finding, ReferenceKind, Unit, Variant,
    pictures::{Picture, Subject},
    report::Findings,
    runs::{Run, Runs},
};

const STRATEGIES: &str = "strategies";
const CONTACT: &str = "contact";

/// Strategy, value of `search`, and of the paper: seconds, residual velocity in m/s.
const TABLE: [(&str, &str, Option<f64>, Option<f64>); 7] = [
    ("every step", "every-step", Some(372.0), Some(141.0)),
    ("skin", "skin", None, None),
    ("adaptive 1e-4", "{ adaptive = { plastic-strain-threshold = 1e-4 } }", Some(195.0), Some(123.7)),
    ("adaptive 1e-5", "{ adaptive = { plastic-strain-threshold = 1e-5 } }", Some(221.0), Some(141.0)),
    ("adaptive 1e-6", "{ adaptive = { plastic-strain-threshold = 1e-6 } }", Some(274.0), Some(141.0)),
    ("total Lagrangian, frozen", "{ total-lagrangian = { form = \"frozen\" } }", Some(175.0), None),
    (
        "adaptive 1e-5, as published",
        "{ adaptive = { plastic-strain-threshold = 1e-5, guard = \"none\" } }",
        Some(221.0),
        Some(141.0),
    ),
];

/// Steps between audits of the neighbour lists.
const AUDIT: &str = "200";

pub(super) const CASE: Case = Case {
    name: "bullet",
    title: "Steel bullet through an aluminium plate: search strategies",
    about: "Fraser et al., Table 1: the same impact with five neighbour-search strategies, and two more. Times are those of the steps without \
            output and audits, on the threads given; the paper's are of another machine and another model of the lost drawings, \
            so speed-ups compare better than seconds. The residual velocity owes much to the kernel sums in which the bodies \
            meet: the run with a contact that cannot pull shows how much.",
    deck: "bullet",
    variants,
    judge,
    pictures: &[
        Picture {
            series: STRATEGIES,
            subject: Subject::Last("von_mises_stress"),
            caption: "Von Mises stress at the end (the paper's Figure 13)",
        },
        Picture {
            series: STRATEGIES,
            subject: Subject::History(&["residual_velocity"]),
            caption: "Velocity of the bullet (the paper's Figure 11)",
        },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let sized = |variant: Variant| match effort {
        // A tenth of the particles.
        Effort::Quick => variant.spacing("15 mm").set("body.bullet.spacing", "\"12 mm\""),
        Effort::Full => variant,
    };
    let count = if effort == Effort::Quick { 5 } else { TABLE.len() };
    let mut variants: Vec<Variant> = TABLE
        .iter()
        .take(count)
        .map(|(label, search, ..)| Variant::of_series(*label, STRATEGIES).set("search", search).set("audit", AUDIT))
        .map(sized)
        .collect();
    if effort == Effort::Full {
        let contact = Variant::of_series("every step, contact that cannot pull", CONTACT);
        variants.push(contact.set("search", "every-step").set("contact", "penalty"));
    }
    variants
}

/// Seconds of the steps.
fn seconds(run: &Run) -> Option<f64> {
    let s = &run.summary()?.stage_seconds;
    Some(s.search + s.kinematics + s.stress + s.forces + s.integrate)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    let all = || runs.series(STRATEGIES);
    let Some(reference) = all().next() else { return };
    let whole = runs.series(CONTACT).next().is_some();
    let of_table = |run: &Run| TABLE.iter().find(|row| row.0 == run.label());
    for run in all().chain(runs.series(CONTACT)) {
        let value = run.measure("residual_velocity");
        let mut residual = Finding::new("residual velocity", Unit::METRE_PER_SECOND, run.label(), value);
        if let Some(of_every_step) = reference.measure("residual_velocity") {
            residual = residual.beside(ReferenceKind::OtherRun, "every step", of_every_step);
        }
        if let Some(of_paper) = of_table(run).and_then(|row| row.3).filter(|_| whole) {
            residual = residual.beside(ReferenceKind::Published, "Fraser et al.", of_paper);
        }
        let small = run.label().starts_with("adaptive 1e-5") || run.label() == "adaptive 1e-6";
        let guarded = run.label().starts_with("adaptive") && !run.label().ends_with("as published");
        findings.add(if small && guarded {
            residual.must(Bounds::Relative(0.01), "a guarded search must not change the answer")
        } else {
            residual
        });
        let audit = run.summary().and_then(|s| s.audit);
        let number = |name: &str, value| Finding::new(name, Unit::NONE, run.label(), value);
        let missed = number("missed pairs of different bodies", audit.map(|a| a.missed_foreign_pairs as f64));
        let momentum = number("residual of momentum", audit.map(|a| a.momentum_residual));
        if guarded {
            findings.add(missed.must(Bounds::AtMost(0.0), "every stranger is searched for in every step"));
            findings.add(momentum.must(Bounds::AtMost(1e-13), "both rows of a pair or none: rounding"));
        } else if audit.is_some() {
            findings.add(missed);
            findings.add(momentum);
        }
        if audit.is_some() {
            findings.add(Finding::new("missed pairs", Unit::PERCENT, run.label(), audit.map(|a| a.missed_share)));
        }
    }
    for run in all() {
        let row = of_table(run);
        let time = Finding::new("time", Unit::SECOND, run.label(), seconds(run));
        let ratio = seconds(reference).zip(seconds(run)).map(|(reference, run)| reference / run);
        let ratio = Finding::new("speed-up", Unit::NONE, run.label(), ratio);
        let searched = run.summary().map(|s| s.searched_fraction);
        let paper = row.and_then(|row| row.2).filter(|_| whole);
        findings.add(paper.map_or(time.clone(), |t| time.beside(ReferenceKind::Published, "Fraser et al.", t)));
        findings
            .add(paper.map_or(ratio.clone(), |t| ratio.beside(ReferenceKind::Published, "Fraser et al.", 372.0 / t)));
        findings.add(Finding::new("particles searched", Unit::PERCENT, run.label(), searched));
    }
    findings.note(
        "A search of everyone takes a quarter of a step here, not half as in the paper: no strategy can gain more than that quarter, \
         and skins already gain most of it.",
    );
}
