//! Failure strains of a material point under every law of damage, against their formulas.

use super::super::{
    Bounds, Case, Effort, Finding, NumberTable, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
};

const POINTS: &str = "points";

/// Moduli and yield stress of the deck, Pa.
const SHEAR: f64 = 206.9e9 / 2.6;
const BULK: f64 = 206.9e9 / 1.2;
const YIELD: f64 = 1e9;
/// Edge of the cube that the particle is an eighth of, m.
const SPACING: f64 = 1e-3;
/// Steps of a run, rows of its history.
const STEPS: f64 = 4000.0;
const ROWS: f64 = 400.0;

/// Reference temperature and melting temperature of the law of Johnson and Cook, K.
const ROOM: f64 = 293.15;
const MELTING: f64 = 1793.0;

pub(super) const CASE: Case = Case {
    name: "failure-strains",
    title: "Failure strains of one material point",
    about: "One particle between three planes of symmetry is driven so that its plastic strain grows at a constant \
            rate in a constant state of stress, whose triaxiality is that of a volume it is given while it is \
            elastic. Every law of damage in tension along one and two axes, shear, plane strain, compression and as \
            behind a notch; Johnson-Cook at several rates and temperatures; Cockcroft-Latham with hardening. The \
            failure strain is the plastic strain at a damage of one, and its answer the formula of the law by hand. \
            For the largest principal stress, which needs no plastic flow, it is the strain at that stress.",
    deck: "failure-strains",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[Picture {
        series: POINTS,
        subject: Subject::History(&[
            "tracer.point.plastic_strain",
            "tracer.point.damage",
            "tracer.point.integrity",
            "tracer.point.triaxiality",
        ]),
        caption: "The last of the points",
    }],
};

/// A state of stress.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    name: &'static str,
    /// Principal strain rates over the equivalent one, without change of volume.
    direction: [f64; 3],
    triaxiality: f64,
    /// Normalised Lode angle.
    lode: f64,
}

/// Half of the root of three.
const ROOT: f64 = 0.866_025_403_784_438_6;

const TENSION: State = State { name: "tension", direction: [1.0, -0.5, -0.5], triaxiality: 1.0 / 3.0, lode: 1.0 };
const STATES: [State; 6] = [
    TENSION,
    State { name: "tension along two axes", direction: [0.5, 0.5, -1.0], triaxiality: 2.0 / 3.0, lode: -1.0 },
    State { name: "shear", direction: [ROOT, -ROOT, 0.0], triaxiality: 0.0, lode: 0.0 },
    State { name: "plane strain", direction: [ROOT, -ROOT, 0.0], triaxiality: 0.5 / ROOT, lode: 0.0 },
    State { name: "compression", direction: [-1.0, 0.5, 0.5], triaxiality: -1.0 / 3.0, lode: -1.0 },
    State { name: "notch", direction: [1.0, -0.5, -0.5], triaxiality: 1.2, lode: 1.0 },
];

impl State {
    /// Largest principal stress over the von Mises stress.
    fn largest(&self) -> f64 {
        2.0 / 3.0 * self.direction.into_iter().fold(f64::NEG_INFINITY, f64::max) + self.triaxiality
    }
}

/// A law of damage: its name, the value of `damage` in a deck, and its failure strain by hand.
struct Law {
    name: &'static str,
    damage: &'static str,
    failure_strain: fn(&Point) -> f64,
}

const LAWS: [Law; 7] = [
    Law { name: "failure strain", damage: "{ failure-strain = { strain = 0.2 } }", failure_strain: |_| 0.2 },
    Law {
        name: "Johnson-Cook",
        damage: "{ johnson-cook = { D1 = 0.05, D2 = 0.15, D3 = -2.12, D4 = 0.02, D5 = 0.61, \
                 reference-strain-rate = \"1 /s\", melting-temperature = \"1793 K\" } }",
        failure_strain: |point| {
            let hot = (point.temperature - ROOM) / (MELTING - ROOM);
            (0.05 + 0.15 * (-2.12 * point.state.triaxiality).exp())
                * (1.0 + 0.02 * point.rate.max(1.0).ln())
                * (1.0 + 0.61 * hot)
        },
    },
    Law {
        name: "Hancock-Mackenzie",
        damage: "{ hancock-mackenzie = { factor = 0.25, exponent = 1.5 } }",
        failure_strain: |point| 0.25 * (-1.5 * point.state.triaxiality).exp(),
    },
    Law {
        name: "Cockcroft-Latham",
        damage: "{ cockcroft-latham = { work = \"0.2 GPa\" } }",
        failure_strain: |point| {
            let work = 0.2e9 / point.state.largest();
            // Yield stress Y + H eps: the integral is quadratic in the strain.
            let slope = point.hardening;
            if slope == 0.0 { work / YIELD } else { ((YIELD * YIELD + 2.0 * slope * work).sqrt() - YIELD) / slope }
        },
    },
    Law {
        name: "Cockcroft-Latham, normalised",
        damage: "{ normalised-cockcroft-latham = { strain = 0.2 } }",
        failure_strain: |point| 0.2 / point.state.largest(),
    },
    Law {
        name: "modified Mohr-Coulomb",
        damage: "{ modified-mohr-coulomb = { A = \"740 MPa\", n = 0.15, c1 = 0.0345, c2 = \"338 MPa\", c3 = 0.95 } }",
        failure_strain: |point| {
            let (sine, cosine) = (point.state.lode * std::f64::consts::PI / 6.0).sin_cos();
            let shear = 3f64.sqrt() / (2.0 - 3f64.sqrt());
            let of_lode = 0.95 + shear * (1.0 - 0.95) * (1.0 / cosine - 1.0);
            let of_planes =
                ((1.0 + 0.0345f64.powi(2)) / 3.0).sqrt() * cosine + 0.0345 * (point.state.triaxiality + sine / 3.0);
            (740.0 / 338.0 * of_lode * of_planes).powf(-1.0 / 0.15)
        },
    },
    Law {
        name: "principal stress",
        damage: "{ principal-stress = { strength = \"0.7 GPa\" } }",
        // The volume is there from half of the elastic part on.
        failure_strain: |point| {
            let of_shear = point.state.largest() - point.state.triaxiality;
            (0.7e9 - point.state.triaxiality * YIELD) / (3.0 * SHEAR * of_shear)
        },
    },
];

const FLOW: usize = 1;
const WORK: usize = 3;
const STRESS: usize = 6;

/// A run.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Index of the law.
    law: usize,
    state: State,
    /// Rate of the equivalent strain, 1/s.
    rate: f64,
    /// K
    temperature: f64,
    /// Slope of the yield stress over the plastic strain, Pa.
    hardening: f64,
}

impl Point {
    fn new(law: usize, state: State) -> Self {
        Self { law, state, rate: 1e4, temperature: ROOM, hardening: 0.0 }
    }

    fn label(&self) -> String {
        let mut label = format!("{}, {}", LAWS[self.law].name, self.state.name);
        if self.law == FLOW {
            label += &format!(", {:.0} /s, {:.0} K", self.rate, self.temperature);
        }
        if self.hardening > 0.0 {
            label += ", hardening";
        }
        label
    }

    fn by_hand(&self) -> f64 {
        (LAWS[self.law].failure_strain)(self)
    }

    /// Equivalent strain at which it yields.
    fn yields(&self) -> f64 {
        YIELD / (3.0 * SHEAR)
    }

    /// Equivalent strain at the end: a tenth beyond the failure strain.
    fn last(&self) -> f64 {
        if self.law == STRESS {
            self.yields()
        } else {
            1.1 * (self.by_hand() * (1.0 + self.hardening / SHEAR / 3.0) + self.yields())
        }
    }

    /// Logarithm of the volume ratio at an equivalent strain, and its slope. All of it comes in the elastic part, where a strength is looked for in the first
    /// half of that, at a rate that rises and falls as smoothly as a cosine: any other rule of the steps would miss some of it.
    fn volume(&self, strain: f64) -> [f64; 2] {
        let over = if self.law == STRESS { 0.5 } else { 1.0 } * self.yields();
        let pressure = -self.state.triaxiality * YIELD;
        let (all, at) = (-(pressure / BULK).ln_1p(), (strain / over).min(1.0));
        let turn = std::f64::consts::TAU;
        [all * (at - (turn * at).sin() / turn), all / over * (1.0 - (turn * at).cos())]
    }

    /// Rows of time and velocity of the particle along an axis, as a deck has them.
    fn motion(&self, axis: usize) -> String {
        let (elastic, plastic) = (self.yields(), self.last() - self.yields());
        let of_elastic = (0..=64).map(|k| elastic * f64::from(k) / 64.0);
        let of_plastic = (1..=200).filter(|_| plastic > 0.0).map(|k| elastic + plastic * f64::from(k) / 200.0);
        let row = |strain: f64| {
            let [volume, slope] = self.volume(strain);
            let stretch = (self.state.direction[axis] * strain + volume / 3.0).exp();
            let velocity = 0.5 * SPACING * stretch * (self.state.direction[axis] + slope / 3.0) * self.rate;
            format!("[{:e}, {velocity:e}]", strain / self.rate)
        };
        of_elastic.chain(of_plastic).map(row).collect::<Vec<_>>().join(", ")
    }

    fn variant(&self) -> Variant {
        let end = self.last() / self.rate;
        let motion = [0, 1, 2].map(|axis| format!("[{}]", self.motion(axis))).join(", ");
        let start = [0, 1, 2].map(|axis| format!("{:e}", 0.5 * SPACING * self.rate * self.state.direction[axis]));
        let variant = Variant::of_series(self.label(), POINTS)
            .set("material.steel.damage", LAWS[self.law].damage)
            .set("motion.0.velocity", &format!("[{motion}]"))
            .set("body.point.velocity", &format!("[{}]", start.join(", ")))
            .set("body.point.temperature", &format!("{:e}", self.temperature))
            .set("time.end", &format!("{end:e}"))
            .set("time.fixed-step", &format!("{:e}", end / STEPS))
            .set("output.history-interval", &format!("{:e}", end / ROWS));
        if self.hardening == 0.0 {
            return variant;
        }
        let young = 206.9e9;
        let tangent = young * self.hardening / (young + self.hardening);
        let strength = format!("{{ bilinear = {{ yield-stress = {YIELD:e}, tangent-modulus = {tangent:e} }} }}");
        variant.set("material.steel.strength", &strength)
    }

    /// Strain at a damage of one: along a straight line from the last two rows before.
    fn failure_strain(&self, run: &Run) -> Option<f64> {
        let damage = run.column("tracer.point.damage")?;
        let strain: Vec<f64> = match self.law {
            STRESS => run.column("time")?.iter().map(|time| time * self.rate).collect(),
            _ => run.column("tracer.point.plastic_strain")?.to_vec(),
        };
        let last = damage.iter().position(|&d| d >= 1.0)?.checked_sub(1)?;
        let before = last.checked_sub(1)?;
        let slope = (strain[last] - strain[before]) / (damage[last] - damage[before]);
        Some(strain[last] + (1.0 - damage[last]) * slope)
    }
}

/// The runs; a law that never breaks in a state is left out there.
fn points(effort: Effort) -> Vec<Point> {
    let mut points = Vec::new();
    for law in 0..LAWS.len() {
        for (k, state) in STATES.into_iter().enumerate() {
            let point = Point::new(law, state);
            // Cockcroft and Latham never break in compression; a strength is tried where it is reached after the volume and before yield.
            let breaks = match law {
                WORK | 4 => state.largest() > 0.1,
                STRESS => (0.5 * point.yields()..0.9 * point.yields()).contains(&point.by_hand()),
                _ => true,
            };
            // Each law in another state.
            let is_quick = k == law % STATES.len() || state == TENSION;
            if breaks && (effort == Effort::Full || is_quick) {
                points.push(point);
            }
        }
    }
    let of_flow = Point::new(FLOW, TENSION);
    points.extend([1e3, 1e5].map(|rate| Point { rate, ..of_flow }));
    points.extend([600.0, 1200.0].map(|temperature| Point { temperature, ..of_flow }));
    points.push(Point { hardening: 2e9, ..Point::new(WORK, STATES[2]) });
    points
}

fn variants(effort: Effort) -> Vec<Variant> {
    points(effort).iter().map(Point::variant).collect()
}

fn judge(runs: &Runs, findings: &mut Findings) {
    let mut rows = Vec::new();
    for point in points(Effort::Full) {
        let label = point.label();
        let Some(run) = runs.series(POINTS).find(|run| run.label() == label) else { continue };
        let (ours, answer) = (point.failure_strain(run), point.by_hand());
        let what = if point.law == STRESS { "strain at the strength" } else { "failure strain" };
        findings.add(Finding::new(what, Unit::NONE, &label, ours).exact("by hand", answer).must(
            Bounds::Relative(1e-3),
            "the return mapping is of first order in the step, of which there are four thousand",
        ));
        let cell = |value: f64| format!("{value:.5}");
        rows.push(vec![
            LAWS[point.law].name.to_owned(),
            point.state.name.to_owned(),
            format!("{:.3}", point.state.triaxiality),
            format!("{:.0}", point.rate),
            format!("{:.0}", point.temperature),
            ours.map_or_else(String::new, cell),
            cell(answer),
        ]);
        let drift = run.summary().map(|s| s.energy.largest_relative_drift);
        findings.add(
            Finding::new("drift of the energy balance", Unit::NONE, &label, drift)
                .must(Bounds::AtMost(1e-3), "what is driven takes the work of its forces"),
        );
    }
    findings.table(NumberTable {
        title: "Strain at a damage of one".to_owned(),
        head: vec!["law", "state", "triaxiality", "rate /s", "temperature K", "computed", "by hand"],
        rows,
    });
    findings.note(
        "In compression along one axis the largest principal stress is zero: a law of Cockcroft and Latham does not \
         break there, and is left out.",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_states_are_what_their_numbers_say() {
        for state in STATES {
            let [a, b, c] = state.direction;
            assert!((a + b + c).abs() < 1e-12, "{}", state.name);
            let square = 2.0 / 3.0 * (a * a + b * b + c * c);
            assert!((square - 1.0).abs() < 1e-12, "{}: {square}", state.name);
            // 27/2 J_3/q^3 of the deviator, 2/3 of the direction.
            let cosine: f64 = 13.5 * (8.0 / 27.0) * a * b * c;
            let lode = 1.0 - 2.0 / std::f64::consts::PI * cosine.clamp(-1.0, 1.0).acos();
            assert!((lode - state.lode).abs() < 1e-6, "{}: {lode}", state.name);
        }
    }

    #[test]
    fn the_volume_is_reached_smoothly_in_the_elastic_part() {
        let point = Point::new(0, STATES[5]);
        let (yields, all) = (point.yields(), -(-1.2 * YIELD / BULK).ln_1p());
        let (mut sum, steps) = (0.0, 1000);
        for k in 0..steps {
            let strain = yields * (f64::from(k) + 0.5) / f64::from(steps);
            sum += point.volume(strain)[1] * yields / f64::from(steps);
        }
        assert!((sum / all - 1.0).abs() < 1e-9 && (point.volume(yields)[0] / all - 1.0).abs() < 1e-12, "{sum} {all}");
        assert!((point.volume(2.0 * yields)[0] / all - 1.0).abs() < 1e-12);
        // A strength is looked for after the volume.
        let strength = Point::new(STRESS, TENSION);
        assert!(strength.volume(0.5 * yields)[1].abs() < 1e-9 && strength.by_hand() > 0.5 * yields);
    }
}
