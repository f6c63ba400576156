//! Taylor bars that crack above some speed.

use super::super::{
    Bounds, Case, Effort, Finding, NumberTable, ReferenceKind, Study, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
};

const SPEEDS: &str = "speed";
const SPACING: &str = "spacing";

/// Speed at which bars of this steel were recovered whole, and one at which they crack, m/s.
const WHOLE: u32 = 208;
const BROKEN: u32 = 400;

/// Spacing of 8, 10 and 12 particles across the bar.
const SPACINGS: [(&str, &str); 3] = [("8 across", "0.9525 mm"), ("10 across", "0.762 mm"), ("12 across", "0.635 mm")];

pub(super) const CASE: Case = Case {
    name: "taylor-fracture",
    title: "A bar of 4340 steel that cracks on a wall above some speed",
    about: "Taylor impacts of a bar of 7.62 mm by 25.4 mm, the one that Johnson and Cook measured after 208 m/s, with \
            their law of damage and published constants. At that speed the bar was recovered whole: no particle may \
            reach a damage of one. Faster ones crack, at first around the edge of the foot, which is stretched, and \
            then along shear bands. No measured critical speed of this steel is known to us, so the speed at which \
            damage of one is reached first is shown without a reference, for several spacings.",
    deck: "taylor-fracture",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture { series: SPEEDS, subject: Subject::BeforeAfter("damage"), caption: "Damage at 400 m/s" },
        Picture { series: SPEEDS, subject: Subject::Last("integrity"), caption: "Integrity after 400 m/s" },
    ],
};

fn variant(label: String, series: &'static str, speed: u32) -> Variant {
    Variant::of_series(label, series).set("body.bar.velocity", &format!("[0.0, 0.0, -{speed}.0]"))
}

fn variants(effort: Effort) -> Vec<Variant> {
    let speeds: &[u32] = match effort {
        Effort::Quick => &[WHOLE, BROKEN],
        Effort::Full => &[WHOLE, 240, 270, 300, 350, BROKEN],
    };
    let mut variants: Vec<_> = speeds.iter().map(|&speed| variant(format!("{speed} m/s"), SPEEDS, speed)).collect();
    if effort == Effort::Full {
        for (label, spacing) in &SPACINGS[1..] {
            for speed in [WHOLE, 270, 300] {
                variants.push(variant(format!("{speed} m/s, {label}"), SPACING, speed).spacing(spacing));
            }
        }
    }
    variants
}

/// Share of the mass of the bar that is no part of its largest piece.
fn lost(run: &Run) -> Option<f64> {
    Some(1.0 - run.measure("largest")? / run.column("largest")?.first()?)
}

fn judge(runs: &Runs, findings: &mut Findings) {
    let mut rows = Vec::new();
    for run in runs.series(SPEEDS).chain(runs.series(SPACING)) {
        let damage = run.measure("largest_damage");
        let cell = |value: Option<f64>, size: f64, digits: usize| {
            value.map_or_else(String::new, |value| format!("{:.digits$}", value / size))
        };
        let whole = damage.is_some_and(|damage| damage < 1.0);
        rows.push(vec![
            run.label().to_owned(),
            cell(run.measure("length"), 1e-3, 2),
            cell(run.measure("largest_plastic_strain"), 1.0, 2),
            cell(damage, 1.0, 3),
            cell(lost(run), 1e-2, 2),
            if whole { "whole" } else { "cracked" }.to_owned(),
        ]);
        let finding = |what: &str, unit, value| Finding::new(what, unit, run.label(), value);
        if run.label().starts_with(&format!("{WHOLE} m/s")) {
            let finding = finding("largest damage", Unit::NONE, damage);
            findings.add(finding.must(Bounds::AtMost(0.999), "the measured bar was recovered whole"));
            findings
                .add(finding_of_length(run).must(Bounds::Relative(0.02), "the measured bar; the spacing is coarse"));
        } else if run.label() == format!("{BROKEN} m/s") {
            let of_bar = finding("share of the bar that has broken off", Unit::PERCENT, lost(run));
            findings.add(of_bar.must(Bounds::AtLeast(0.01), "at twice the speed the foot breaks up"));
        } else {
            findings.add(finding("largest damage", Unit::NONE, damage));
        }
        let drift = run.summary().map(|s| s.energy.largest_relative_drift);
        findings.add(
            finding("drift of the energy balance", Unit::NONE, drift)
                .must(Bounds::AtMost(1e-3), "what breaking dissipates is accounted for"),
        );
    }
    let damages = [format!("{WHOLE} m/s"), "270 m/s".to_owned(), "300 m/s".to_owned()];
    for start in &damages {
        let all = runs.series(SPEEDS).filter(|run| run.label() == start);
        let all = all.chain(runs.series(SPACING).filter(|run| run.label().starts_with(start)));
        let study = Study::trend(format!("largest damage at {start}"), Unit::NONE);
        findings.study(all.fold(study, |s, run| s.point(run.label(), run.spacing, run.measure("largest_damage"))));
    }
    findings.table(NumberTable {
        title: "Bars over the speed of the impact; damage ends at one".to_owned(),
        head: vec!["run", "length mm", "largest strain", "largest damage", "broken off %", "the bar is"],
        rows,
    });
    findings.note(NOTE);
}

fn finding_of_length(run: &Run) -> Finding {
    Finding::new("length", Unit::MILLIMETRE, run.label(), run.measure("length")).beside(
        ReferenceKind::Experiment,
        "Johnson & Cook 1983",
        22.48e-3,
    )
}

const NOTE: &str = "Particles larger than the width of a shear band find a higher speed at which it cracks than smaller ones do: compare \
    spacings. Damage of Johnson and Cook ends at one; a bar with one cracked particle is called cracked.";
