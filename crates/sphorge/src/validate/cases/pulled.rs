//! A strip and a rod pulled to 1.4 times their length.

use super::super::{
    Bounds, Case, Effort, Finding, NumberTable, ReferenceKind, Unit, Variant,
    findings::Findings,
    picture::{Beside, Picture, Subject},
    runs::{Run, Runs},
};
use serde::Deserialize;
use std::f64::consts::PI;

const STRIP: &str = "strip";
const ROD: &str = "rod";
const EVEN_STRIP: &str = "strip that contracts";
const EVEN_ROD: &str = "rod that contracts";

pub(super) const CASE: Case = Case {
    name: "pulled",
    title: "A strip and a rod pulled to 1.4 times their length",
    about: "A strip of aluminium of 20 mm by 20 mm in plane strain and a rod of copper of 8 mm by 30 mm are pulled \
            at both ends, each end at 10 m/s, far beyond the load at which they neck. With rigid grips, force and \
            strain are compared with finite elements of the same bodies \
            (`reference/finite-elements/tensile_bar.py`). With ends that can contract, the bodies stretch evenly, \
            and the Johnson-Cook law alone determines the load of the middle until it necks: the rate equations of \
            stress, plastic strain and heat, driven by the readings of a 6 mm extensometer in the run, are solved by \
            a Runge-Kutta method written only for this check. That strip is three times as long, because in a square \
            one the introduction of the load affects the middle. A metal without a damage law stays in one piece: no \
            check of a run may report anything.",
    deck: "pulled",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[
        Picture {
            series: STRIP,
            subject: Subject::Last("plastic_strain"),
            caption: "The strip at 1.4 times its length",
        },
        Picture {
            series: STRIP,
            subject: Subject::Overlay { column: "section.middle.normal_force", and: "", beside: strip_elements },
            caption: "Force through the middle of the strip",
        },
        Picture {
            series: ROD,
            subject: Subject::Overlay { column: "section.middle.normal_force", and: "", beside: rod_elements },
            caption: "Force through the middle of the rod",
        },
    ],
};

/// The strip of the deck or the rod, of that spacing in mm; `even`: its ends may contract, and it starts with the velocity of an even stretch.
fn sample(series: &'static str, spacing: f64, even: bool) -> Variant {
    let rod = matches!(series, ROD | EVEN_ROD);
    let variant = Variant::of_series(format!("{series}, {spacing} mm"), series).spacing(&format!("{spacing} mm"));
    // Half the length, mm, and the speed of the ends, m/s: some 1000/s in all strips, 670/s in the rods.
    let (half, speed) = if rod {
        (15.0, 10.0)
    } else if even {
        (30.0, 30.0)
    } else {
        (10.0, 10.0)
    };
    let bands = |from: f64, to: f64| {
        if rod {
            format!(
                "{{ box = {{ min = [\"{from} mm\", \"-5 mm\", \"-5 mm\"], max = [\"{to} mm\", \"5 mm\", \"5 mm\"] }} }}"
            )
        } else {
            format!("{{ box = {{ min = [\"{from} mm\", \"-11 mm\"], max = [\"{to} mm\", \"11 mm\"] }} }}")
        }
    };
    // Ends that contract are driven by their last particles, so that nothing else is kept from stretching.
    let grip = if even { spacing } else { 1.0 };
    let mut variant = variant
        .set("region.back.shape", &bands(-half, grip - half))
        .set("region.front.shape", &bands(half - grip, half));
    let across = match (rod, even) {
        (false, false) => "\"0 m/s\"",
        (false, true) => "\"free\"",
        (true, false) => "\"0 m/s\", \"0 m/s\"",
        (true, true) => "\"free\", \"free\"",
    };
    if rod {
        let cylinder = format!(
            "{{ cylinder = {{ from = [\"-{half} mm\", \"0 mm\", \"0 mm\"], to = [\"{half} mm\", \"0 mm\", \"0 mm\"], radius = \"4 mm\" }} }}"
        );
        let middle = "{ box = { min = [\"-1 mm\", \"-1 mm\", \"-1 mm\"], max = [\"1 mm\", \"1 mm\", \"1 mm\"] } }";
        variant = variant
            .set("dimensions", "3d")
            .set("time.end", "\"0.6 ms\"")
            .set("particles.lattice", "rings")
            .set("body.sample.material", "ofhc-copper")
            .set("body.sample.shape", &cylinder)
            .set("region.middle.shape", middle)
            .set("region.gauge.shape", &bands(-4.0, 4.0))
            .set("region.lower-mark.shape", &bands(-4.0, -2.0))
            .set("region.upper-mark.shape", &bands(2.0, 4.0))
            .set("section.middle.point", "[0, 0, 0]")
            .set("section.middle.normal", "[1, 0, 0]");
    }
    if rod || even {
        for (end, speed) in [("back", -speed), ("front", speed)] {
            variant = variant
                .set(&format!("motion.{}.velocity", u8::from(end == "front")), &format!("[\"{speed} m/s\", {across}]"));
        }
    }
    if even {
        // The speed of the ends at the last particles, half a spacing inside.
        let rate = 1e3 * speed / (half - 0.5 * spacing);
        let rows = if rod {
            format!("[[{rate}, 0, 0], [0, {0}, 0], [0, 0, {0}]]", -0.5 * rate)
        } else {
            format!("[[{rate}, 0], [0, {}]]", -rate)
        };
        variant = variant.set("body.sample.velocity-gradient", &format!("{{ rows = {rows} }}"));
        variant = variant.set("time.end", if rod { "\"0.3 ms\"" } else { "\"0.12 ms\"" });
        if !rod {
            let long = "{ min = [\"-30 mm\", \"-10 mm\"], max = [\"30 mm\", \"10 mm\"] }";
            variant = variant.set("body.sample.shape.box", long);
        }
    }
    variant
}

fn variants(effort: Effort) -> Vec<Variant> {
    match effort {
        Effort::Quick => vec![
            sample(STRIP, 1.0, false),
            sample(ROD, 1.0, false),
            sample(EVEN_STRIP, 1.0, true),
            sample(EVEN_ROD, 1.0, true),
        ],
        Effort::Full => vec![
            sample(STRIP, 1.0, false),
            sample(STRIP, 0.5, false),
            sample(ROD, 1.0, false),
            sample(EVEN_STRIP, 1.0, true),
            sample(EVEN_STRIP, 0.5, true),
            sample(EVEN_ROD, 1.0, true),
        ],
    }
}

/// What the finite elements say.
#[derive(Deserialize)]
struct Elements {
    cases: Vec<ElementCase>,
}

/// Of a body.
#[derive(Deserialize)]
struct ElementCase {
    body: String,
    /// Coarse to fine.
    meshes: Vec<Mesh>,
}

/// On a mesh.
#[derive(Deserialize)]
struct Mesh {
    /// Across the radius or half the width, and along half the length.
    elements: [u32; 2],
    /// Time, elongation, force, plastic strain of the innermost element, outer edge of the middle, largest strain and temperature.
    history: Vec<[f64; 7]>,
}

impl Mesh {
    fn name(&self) -> String {
        format!("finite elements, {} x {}", self.elements[0], self.elements[1])
    }

    /// Column `k` at a time, s.
    fn at(&self, time: f64, k: usize) -> Option<f64> {
        let rows: Vec<_> = self.history.iter().map(|row| (row[0], row[k])).collect();
        interpolated(&rows, time)
    }
}

/// The runs of `reference/finite-elements/tensile_bar.py`, coarse to fine.
fn elements(body: &str) -> Vec<Mesh> {
    let text = include_str!("../../../reference/finite-elements/tensile_bar.json");
    // A file of ours: a test reads it.
    let elements: Elements = serde_json::from_str(text).unwrap_or(Elements { cases: Vec::new() });
    elements.cases.into_iter().find(|case| case.body == body).map_or(Vec::new(), |case| case.meshes)
}

fn force_over_time(body: &str) -> Beside {
    elements(body).iter().map(|mesh| (mesh.name(), mesh.history.iter().map(|row| (row[0], row[2])).collect())).collect()
}

fn strip_elements() -> Beside {
    force_over_time(STRIP)
}

fn rod_elements() -> Beside {
    force_over_time(ROD)
}

/// Value of a line through points at `at`; nothing outside.
fn interpolated(points: &[(f64, f64)], at: f64) -> Option<f64> {
    let k = points.windows(2).position(|pair| pair[0].0 <= at && at <= pair[1].0)?;
    let ((x0, y0), (x1, y1)) = (points[k], points[k + 1]);
    Some(if x1 > x0 { y0 + (y1 - y0) * (at - x0) / (x1 - x0) } else { y0 })
}

/// A metal as the rate equations need it.
#[derive(Clone, Copy, Debug)]
struct Metal {
    /// Pa
    bulk: f64,
    shear: f64,
    /// Johnson-Cook; stresses in Pa, the melting temperature in K.
    a: f64,
    b: f64,
    n: f64,
    c: f64,
    m: f64,
    melting: f64,
    /// Density times specific heat, J/(m³ K).
    heat: f64,
}

/// 2024-T351, as in the catalogue.
const ALUMINIUM: Metal = Metal {
    bulk: 2770.0 * 5328.0 * 5328.0,
    shear: 28.6e9,
    a: 265e6,
    b: 426e6,
    n: 0.34,
    c: 0.015,
    m: 1.0,
    melting: 775.0,
    heat: 2770.0 * 875.0,
};

/// OFHC, as in the catalogue.
const COPPER: Metal = Metal {
    bulk: 8960.0 * 3940.0 * 3940.0,
    shear: 46e9,
    a: 90e6,
    b: 292e6,
    n: 0.31,
    c: 0.025,
    m: 1.09,
    melting: 1356.0,
    heat: 8960.0 * 383.0,
};

const ROOM: f64 = 293.15;
const TAYLOR_QUINNEY: f64 = 0.9;

/// Stress along the pull and across the plane, Pa, plastic strain, temperature in K.
type State = [f64; 4];

impl Metal {
    fn young(&self) -> f64 {
        9.0 * self.bulk * self.shear / (3.0 * self.bulk + self.shear)
    }

    fn poisson(&self) -> f64 {
        (3.0 * self.bulk - 2.0 * self.shear) / (2.0 * (3.0 * self.bulk + self.shear))
    }

    /// Rates of the state where the logarithmic strain along the pull grows at `rate`, 1/s; the sides are free, those of a plate in plane strain
    /// in its plane alone.
    fn rates(&self, plane: bool, rate: f64, [along, across, strain, temperature]: State) -> State {
        let (young, poisson) = (self.young(), self.poisson());
        let stress = (along * along - along * across + across * across).sqrt();
        let softening = 1.0 - ((temperature - ROOM) / (self.melting - ROOM)).max(0.0).powf(self.m);
        let quasistatic = (self.a + self.b * strain.powf(self.n)) * softening;
        // The rate at which the law yields the present stress.
        let flow = if stress > quasistatic { ((stress / quasistatic - 1.0) / self.c).min(40.0).exp() } else { 0.0 };
        let share = if stress > 0.0 { flow / (2.0 * stress) } else { 0.0 };
        let elastic_along = rate - share * (2.0 * along - across);
        let elastic_across = -share * (2.0 * across - along);
        let (along, across) = if plane {
            let modulus = young / (1.0 - poisson * poisson);
            (modulus * (elastic_along + poisson * elastic_across), modulus * (elastic_across + poisson * elastic_along))
        } else {
            (young * elastic_along, 0.0)
        };
        [along, across, flow, TAYLOR_QUINNEY * stress * flow / self.heat]
    }

    /// Force over the first section, Pa, and plastic strain at every row of time (s) and stretch.
    fn pull(&self, plane: bool, rows: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let mut state = [0.0, 0.0, 0.0, ROOM];
        let mut found = vec![(0.0, 0.0); rows.len().min(1)];
        for pair in rows.windows(2) {
            let ((from, before), (to, after)) = (pair[0], pair[1]);
            let steps = ((to - from) / 5e-9).ceil().max(1.0);
            let dt = (to - from) / steps;
            let rate = if to > from { (after / before).ln() / (to - from) } else { 0.0 };
            let ahead = |state: State, by: State, dt: f64| std::array::from_fn(|k| state[k] + dt * by[k]);
            for _ in 0..steps as u64 {
                let k1 = self.rates(plane, rate, state);
                let k2 = self.rates(plane, rate, ahead(state, k1, 0.5 * dt));
                let k3 = self.rates(plane, rate, ahead(state, k2, 0.5 * dt));
                let k4 = self.rates(plane, rate, ahead(state, k3, dt));
                for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
                    state = ahead(state, k, weight * dt / 6.0);
                }
            }
            let swelling = ((1.0 - 2.0 * self.poisson()) * (state[0] + state[1]) / self.young()).exp();
            found.push((state[0] * swelling / after, state[2]));
        }
        found
    }
}

/// Elongation of the extensometer from which on forces are compared.
const QUIET: f64 = 0.1;

/// Period of the stress wave that the start leaves in the strip, s, between its zeros. Nothing but the flow of the metal damps it: it is 1.7 % of the
/// force at an elongation of 10 %, which the law knows nothing of.
const ROUND_TRIP: f64 = 6.7e-6;

/// How far force and plastic strain of the middle are from what the law says of the stretch of the extensometer: the largest deviation of the
/// force, its mean over a [`ROUND_TRIP`], from [`QUIET`] on, and that of the strain at the end.
fn beside_the_law(run: &Run, metal: &Metal, plane: bool, section: f64) -> Option<(f64, f64)> {
    let (time, force) = (run.column("time")?, run.column("section.middle.normal_force")?);
    let (lower, upper) = (run.column("lower_mark")?, run.column("upper_mark")?);
    let first = upper.first()? - lower.first()?;
    let rows: Vec<_> = (0..time.len()).map(|k| (time[k], (upper[k] - lower[k]) / first)).collect();
    let law = metal.pull(plane, &rows);
    let off: Vec<f64> = law.iter().zip(force).map(|(law, force)| force / (law.0 * section) - 1.0).collect();
    let (half, end) = (0.5 * ROUND_TRIP, *time.last()?);
    let mean = |at: f64| {
        let near: Vec<f64> =
            off.iter().zip(time).filter(|(_, t)| (*t - at).abs() <= half).map(|(off, _)| *off).collect();
        near.iter().sum::<f64>() / near.len() as f64
    };
    let whole = (0..rows.len()).filter(|&k| rows[k].1 > 1.0 + QUIET && time[k] + half <= end);
    let force = whole.map(|k| mean(time[k]).abs()).fold(0.0, f64::max);
    let strain = run.column("plastic_strain")?.last()? / law.last()?.1 - 1.0;
    Some((force, strain.abs()))
}

fn judge(runs: &Runs, findings: &mut Findings) {
    findings.note(
        "The finite elements of the strip agree until its neck heats up: within 0.4 % at 24 % elongation, 4 % at 32 \
         %, 9 % at 40 %, where the force decreases with finer elements.",
    );
    for (series, end) in [(STRIP, 0.4e-3), (ROD, 0.6e-3)] {
        let meshes = elements(series);
        let Some(finest) = meshes.last() else { continue };
        let shares = [0.2, 0.4, 0.6, 0.8, 1.0];
        let row = |name: String, of: &dyn Fn(f64) -> Option<f64>| {
            let number = |share: f64| of(share * end).map_or_else(String::new, |force| format!("{force:.4e}"));
            std::iter::once(name).chain(shares.map(number)).collect::<Vec<_>>()
        };
        let of_runs = runs.series(series).map(|run| row(run.label().to_owned(), &|time| force(run, time)));
        let of_elements = meshes.iter().map(|mesh| row(mesh.name(), &|time| mesh.at(time, 2)));
        findings.table(NumberTable {
            title: format!("Force through the middle of the {series}, N (strip: N/m)"),
            head: vec!["run", "8 %", "16 %", "24 %", "32 %", "40 %"],
            rows: of_runs.chain(of_elements).collect(),
        });
        for run in runs.series(series) {
            for (share, percent) in [(0.4, "16 %"), (0.6, "24 %"), (1.0, "40 %")] {
                let quantity = format!("force at an elongation of {percent}");
                let finding = Finding::new(quantity, Unit::NONE, run.label(), force(run, share * end));
                let finding = meshes.iter().rev().fold(finding, |finding, mesh| match mesh.at(share * end, 2) {
                    Some(force) => finding.beside(ReferenceKind::FiniteElements, &mesh.name(), force),
                    None => finding,
                });
                findings.add(match (series, run.spacing < 0.6e-3) {
                    (ROD, _) => finding.must(Bounds::Relative(0.01), "elements agree within 0.3 %"),
                    // Heat softens the aluminium so fast that the bands of its neck are as wide as the elements.
                    _ if share > 0.9 => finding,
                    (_, true) => finding.must(Bounds::Relative(0.02), GRIPPED),
                    (_, false) => finding.must(Bounds::Relative(0.04), GRIPPED),
                });
            }
            let strain = Finding::new(
                "plastic strain in the middle at the end",
                Unit::NONE,
                run.label(),
                run.measure("plastic_strain"),
            );
            let reference = finest.at(end, 3).unwrap_or(f64::NAN);
            let strain = strain.beside(ReferenceKind::FiniteElements, &finest.name(), reference);
            findings.add(if series == ROD {
                strain.must(
                    Bounds::Relative(0.08),
                    "two fifths of it develop over the last 8 % of elongation; finer elements strain by 2 % more",
                )
            } else {
                strain
            });
        }
    }
    // First sections: 20 mm times a metre, a circle of 8 mm.
    for (series, metal, plane, section) in [(EVEN_STRIP, ALUMINIUM, true, 0.02), (EVEN_ROD, COPPER, false, PI * 16e-6)]
    {
        for run in runs.series(series) {
            let off = beside_the_law(run, &metal, plane, section);
            let finding = |quantity: &str, value| Finding::new(quantity, Unit::PERCENT, run.label(), value);
            findings.add(
                finding("largest deviation of the force from the law", off.map(|off| off.0))
                    .must(Bounds::AtMost(0.01), "its mean over a round trip of the wave from the start, which stays"),
            );
            findings.add(
                finding("deviation of the plastic strain at the end", off.map(|off| off.1))
                    .must(Bounds::AtMost(0.01), "of the middle, where a neck begins to affect the extensometer"),
            );
            let uneven =
                run.measure("most_in_gauge").zip(run.measure("least_in_gauge")).map(|(most, least)| most / least - 1.0);
            findings.add(finding("unevenness of the plastic strain between the marks", uneven).must(
                Bounds::AtMost(0.04),
                "the beginning of a neck; pairs of particles or hourglass modes would strain differently from their \
                 neighbours",
            ));
        }
    }
}

/// Why the force of the strip differs.
const GRIPPED: &str = "grips hold the centres of particles and prevent the middle from contracting; the error decreases with the \
     spacing";

/// Force through the middle at a time, s.
fn force(run: &Run, time: f64) -> Option<f64> {
    let rows: Vec<_> =
        run.column("time")?.iter().copied().zip(run.column("section.middle.normal_force")?.iter().copied()).collect();
    interpolated(&rows, time.min(rows.last()?.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finite_elements_are_read() {
        for (body, end) in [(STRIP, 0.4e-3), (ROD, 0.6e-3)] {
            let meshes = elements(body);
            assert_eq!(meshes.len(), 2);
            assert!(
                meshes.iter().all(|mesh| mesh.at(end, 1).is_some_and(|elongation| (elongation - 0.4).abs() < 1e-6))
            );
        }
    }

    /// A metal that does not harden, at 1000/s: `sigma = A (1 + C ln 1000)` along a rod, `2/sqrt(3)` of it in a plate that is held across.
    #[test]
    fn the_equation_knows_a_metal_that_does_not_harden() {
        let metal = Metal { b: 0.0, heat: 1e30, ..COPPER };
        let rows: Vec<_> = (0..=40).map(|k| (f64::from(k) * 1e-6, (f64::from(k) * 1e-3).exp())).collect();
        let stress = 90e6 * (1.0 + 0.025 * 1000f64.ln());
        for (plane, factor) in [(false, 1.0), (true, 2.0 / 3f64.sqrt())] {
            let (force, strain) = *metal.pull(plane, &rows).last().unwrap();
            // In the plate the rate is 2/sqrt(3) times as high: 0.3 % more stress.
            assert!((force * 0.04f64.exp() / (factor * stress) - 1.0).abs() < 5e-3, "{force:e}");
            assert!((strain / (factor * 0.04) - 1.0).abs() < 0.03, "{strain}");
        }
    }
}
