//! Tension of a waisted steel bar: Fraser et al., verification.

use super::super::{
    Bounds, Case, Effort, Finding, ReferenceKind, Unit, Variant,
    pictures::{Picture, Subject},
    report::Findings,
    runs::Runs,
};

const PERFECT: &str = "perfectly plastic";
const HARDENING: &str = "hardening";

/// Element size in mm, plastic strain at the middle of the waist at 10 ms without hardening and with a slope of 2 GPa, by CalculiX
/// (`reference/calculix/tensile.json`).
const ELEMENTS: [(f64, f64, f64); 4] =
    [(10.0, 0.109_10, 0.079_33), (5.0, 0.168_45, 0.109_40), (2.5, 0.225_16, 0.124_59), (1.25, 0.279_85, 0.131_95)];

pub(super) const CASE: Case = Case {
    name: "tensile",
    title: "Tension of a waisted steel bar",
    about: "Fraser et al., verification: a bar is pulled 7.5 mm in 10 ms. Published are the largest plastic strains of a finite-element \
            run (0.281) and of the paper's particles (0.286). Without hardening the neck has no width of its own: finite elements \
            (CalculiX, axisymmetric, the same bar) give more with every refinement, so the published figure is that of one mesh, \
            and particles are set beside elements of their spacing. A quarter of the bar between planes of symmetry. Strategies \
            of the neighbour search are compared at the bar without hardening.",
    deck: "tensile",
    variants,
    judge,
    pictures: &[
        Picture {
            series: PERFECT,
            subject: Subject::Last("plastic_strain"),
            caption: "Plastic strain at 10 ms (the paper's Figure 7)",
        },
        Picture {
            series: PERFECT,
            subject: Subject::Last("von_mises_stress"),
            caption: "Von Mises stress at 10 ms (the paper's Figure 7)",
        },
        Picture {
            series: PERFECT,
            subject: Subject::History(&["waist_plastic_strain"]),
            caption: "Plastic strain at the middle of the waist (the paper's Figure 8)",
        },
    ],
};

const LAGRANGIAN: &str = "total-lagrangian";

/// The bar between planes of symmetry.
const QUARTER: &str = "{ intersection = [ \
    { revolution = { axis = [0, 0, 1], profile = [[0.0, 0.075], [0.2, 0.075], [0.225, 0.05], [0.275, 0.05], [0.3, 0.075], \
    [0.5, 0.075]] } }, { box = { min = [0.0, 0.0, 0.0], max = [0.075, 0.075, 0.5] } } ] }";

fn variants(effort: Effort) -> Vec<Variant> {
    let quarter = |label: &str, series| {
        let symmetry = "[{ axis = \"x\" }, { axis = \"y\" }]";
        Variant::of_series(label, series).set("body.bar.shape", QUARTER).set("symmetry", symmetry)
    };
    match effort {
        Effort::Quick => {
            vec![quarter("total Lagrangian, to 5 ms", PERFECT).set("search", LAGRANGIAN).set("time.end", "\"5 ms\"")]
        }
        Effort::Full => {
            let hard = "{ bilinear = { yield-stress = \"350 MPa\", tangent-modulus = \"1.98113 GPa\" } }";
            let harder = |variant: Variant| variant.set("material.steel-fraser.strength", hard);
            vec![
                quarter("skin", PERFECT),
                quarter("adaptive", PERFECT).set("search", "adaptive"),
                quarter("total Lagrangian", PERFECT).set("search", LAGRANGIAN),
                harder(quarter("skin, hardening", HARDENING)),
                harder(quarter("total Lagrangian, hardening", HARDENING).set("search", LAGRANGIAN)),
            ]
        }
    }
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(PERFECT) {
        let whole = run.summary().is_some_and(|s| s.simulated_time > 0.009);
        let finding = |name: &str, measure: &str| Finding::new(name, Unit::NONE, run.label(), run.measure(measure));
        let most = finding("largest plastic strain", "max_plastic_strain");
        findings.add(if whole {
            most.beside(ReferenceKind::Published, "Fraser, finite elements", 0.281).beside(
                ReferenceKind::Published,
                "Fraser, particles",
                0.286,
            )
        } else {
            most
        });
        let waist = finding("plastic strain at the middle of the waist", "waist_plastic_strain");
        findings.add(if whole {
            ELEMENTS.iter().fold(waist, |finding, (size, perfect, _)| {
                finding.beside(ReferenceKind::Published, &format!("CalculiX, {size} mm"), *perfect)
            })
        } else {
            waist
        });
    }
    for run in runs.series(HARDENING) {
        let value = run.measure("waist_plastic_strain");
        let finding = Finding::new("plastic strain at the middle of the waist", Unit::NONE, run.label(), value);
        findings.add(ELEMENTS.iter().fold(finding, |finding, (size, _, hardening)| {
            finding.beside(ReferenceKind::Published, &format!("CalculiX, {size} mm"), *hardening)
        }));
    }
    for run in runs.series(PERFECT).chain(runs.series(HARDENING)) {
        let drift = run.summary().map(|s| s.energy.relative_drift);
        findings.add(
            Finding::new("drift of the energy ledger at the end", Unit::NONE, run.label(), drift)
                .must(Bounds::AtMost(1e-5), "pair sums in single precision, of a bar that starts at rest"),
        );
    }
}
