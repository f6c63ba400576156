//! A notched strip that is torn apart: what its crack takes, against the stated fracture energy.

use super::super::{
    Bounds, Case, Effort, Finding, NumberTable, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
    variant::refinements,
};

const STATED: &str = "fracture energy";
const SHARE: &str = "share of the failure strain";

/// Fracture energy of the deck, J/m², and half of the ligament, m.
const ENERGY: f64 = 30e3;
const LIGAMENT: f64 = 4e-3;

pub(super) const CASE: Case = Case {
    name: "crack-energy",
    title: "A notched strip torn apart with a stated fracture energy",
    about: "A strip of steel with round notches is pulled apart in plane strain; a quarter of it is modelled. What \
            breaking has dissipated, over the ligament of 4 mm of that quarter, is compared with the fracture energy \
            of the deck, 30 kJ/m^2, for three spacings. It need not be the same: a crack that follows a shear band \
            at 45 degrees is longer than the ligament by the root of two, and takes 42 kJ/m^2 of its area. With \
            integrity that falls over a share of the failure strain there is no such energy, and a crack takes less \
            of every finer lattice.",
    deck: "crack-energy",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture { series: STATED, subject: Subject::Last("integrity"), caption: "Integrity at the end" },
        Picture {
            series: STATED,
            subject: Subject::History(&["motion.end.force_x", "fracture_energy"]),
            caption: "Force of the pulled end, and energy that breaking has dissipated, per depth",
        },
    ],
};

fn variants(effort: Effort) -> Vec<Variant> {
    let spacings: &[&str] = match effort {
        Effort::Quick => &["0.5 mm"],
        Effort::Full => &["0.5 mm", "0.25 mm", "0.125 mm"],
    };
    let mut variants = refinements(STATED, "", spacings);
    if effort == Effort::Full {
        // The fracture energy of the deck cannot be taken away, but a material without one can be chosen.
        let ductile = "{ density = \"7800 kg/m^3\", young-modulus = \"200 GPa\", poisson-ratio = 0.3, strength = { bilinear = \
                       { yield-stress = \"500 MPa\", tangent-modulus = \"1 GPa\" } }, damage = { failure-strain = { \
                       strain = 0.1 } }, softening = 0.1, taylor-quinney = 0.0 }";
        for variant in refinements(SHARE, "share, ", &spacings[..2]) {
            variants.push(variant.set("material.ductile-steel", ductile).set("body.strip.material", "ductile-steel"));
        }
    }
    variants
}

/// What breaking has dissipated over the ligament, J/m².
fn taken(run: &Run) -> Option<f64> {
    Some(run.column("fracture_energy")?.last()? / LIGAMENT)
}

/// Largest force of the pulled end, N/m, and the mean of the last fifth of the run over it.
fn forces(run: &Run) -> Option<[f64; 2]> {
    let force = run.column("motion.end.force_x")?;
    // The strip starts at its speed, and rings once.
    let most = force.iter().skip(force.len() / 8).copied().fold(0.0, f64::max);
    let last = &force[force.len() - force.len() / 5..];
    Some([most, last.iter().sum::<f64>() / last.len() as f64 / most])
}

fn judge(runs: &Runs, findings: &mut Findings) {
    let mut rows = Vec::new();
    for run in runs.series(STATED).chain(runs.series(SHARE)) {
        let (energy, forces) = (taken(run), forces(run));
        let cell = |value: Option<f64>, size: f64, digits: usize| {
            value.map_or_else(String::new, |value| format!("{:.digits$}", value / size))
        };
        rows.push(vec![
            run.label().to_owned(),
            cell(energy, 1e3, 1),
            cell(energy, ENERGY, 2),
            cell(forces.map(|f| f[0]), 1e6, 2),
            cell(run.measure("loose"), 1e-3, 1),
        ]);
        let finding = Finding::new(
            "energy of the crack over its ligament",
            Unit::KILOJOULE_PER_SQUARE_METRE,
            run.label(),
            energy,
        )
        .exact("stated", ENERGY)
        .exact("of a crack at 45 degrees", ENERGY * 2f64.sqrt());
        findings.add(if run.variant.series == Some(STATED) {
            finding
                .must(Bounds::Relative(0.1), "an energy that is stated should be taken")
                .missed_within(Some(Bounds::Relative(0.45)))
        } else {
            finding
        });
        let left = forces.map(|f| f[1]);
        findings.add(
            Finding::new("mean force at the end over the largest", Unit::NONE, run.label(), left)
                .must(Bounds::AtMost(0.05), "it has come apart; what is held rings"),
        );
        let drift = run.summary().map(|s| s.energy.largest_relative_drift);
        findings.add(
            Finding::new("drift of the energy balance", Unit::NONE, run.label(), drift)
                .must(Bounds::AtMost(1e-3), "what breaking dissipates is accounted for"),
        );
    }
    for series in [STATED, SHARE] {
        let study =
            Study::exact(format!("energy over the ligament, {series}"), Unit::KILOJOULE_PER_SQUARE_METRE, ENERGY);
        findings.study(runs.series(series).fold(study, |s, run| s.point(run.label(), run.spacing, taken(run))));
    }
    findings.table(NumberTable {
        title: "What the crack takes".to_owned(),
        head: vec!["run", "kJ/m^2 of ligament", "over the stated", "largest force MN/m", "severed and loose g/m"],
        rows,
    });
    findings.note(NOTE);
}

const NOTE: &str = "Each severed particle takes what is stated for its part of a crack that is smeared over the width of the kernel. On a \
    coarse lattice fewer layers than that lose their integrity in the end, and the crack takes less; on a fine one the \
    crack is rough, and follows shear bands, and takes more of its longer way. This has not converged at the finest \
    spacing: the number is known to be missed, and a stated fracture energy is what a crack takes within a third or so.";
