//! Every flow law along a known path of deformation, against an ordinary differential equation.

use super::super::{
    Bounds, Case, Effort, Finding, Unit, Variant,
    findings::Findings,
    picture::{Picture, Subject},
    runs::{Run, Runs},
};

const LAWS: &str = "laws";
const STEPS: &str = "steps";

type Matrix = [[f64; 3]; 3];

/// Velocity gradient at the start, 1/s, as in the deck.
const GRADIENT: Matrix = [[200.0, 600.0, 0.0], [0.0, -100.0, 300.0], [100.0, 0.0, -100.0]];
/// End of the run, s.
const END: f64 = 1e-3;
const YOUNG: f64 = 206.9e9;
const POISSON: f64 = 0.3;
/// Density times specific heat at rest, J/(m³ K).
const HEAT: f64 = 7.83e15 * 4.6e-10;
const TAYLOR_QUINNEY: f64 = 0.9;
const ROOM: f64 = 293.15;
const MELTING: f64 = 1540.0 + 273.15;

/// Strength as the differential equation needs it.
#[derive(Clone, Copy, Debug)]
enum Strength {
    Elastic,
    /// Yield stress and its slope against plastic strain, Pa.
    Hardening(f64, f64),
    JohnsonCook,
}

const LAW: [(&str, &str, Strength); 4] = [
    ("elastic", "elastic", Strength::Elastic),
    ("perfectly plastic", "{ perfectly-plastic = { yield-stress = \"800 MPa\" } }", Strength::Hardening(8e8, 0.0)),
    (
        "bilinear",
        "{ bilinear = { yield-stress = \"800 MPa\", tangent-modulus = \"2 GPa\" } }",
        // E Et / (E - Et) (Fraser Eq 12 corrected).
        Strength::Hardening(8e8, YOUNG * 2e9 / (YOUNG - 2e9)),
    ),
    (
        "Johnson-Cook",
        "{ johnson-cook = { A = \"806 MPa\", B = \"614 MPa\", n = 0.168, C = 0.0089, m = 1.1, \
         melting-temperature = \"1540 degC\" } }",
        Strength::JohnsonCook,
    ),
];

pub(super) const CASE: Case = Case {
    name: "homogeneous",
    title: "Homogeneous deformation under every flow law",
    about: "A cube of a thousand particles, so heavy that stress does not accelerate it, deforms along F = 1 + t L0: \
            shear in two planes, stretch and a small change of volume, up to an equivalent strain of 0.4. Stress, \
            plastic strain and temperature are compared with a solution of the rate equations (Jaumann rate, von \
            Mises flow, heat of plastic work) by a Runge-Kutta method with steps of 5 ns, written only for this \
            check. For Johnson-Cook the plastic strain rate is the one at which the law gives the current stress.",
    deck: "homogeneous",
    expected_warnings: &[],
    variants,
    judge,
    pictures: &[Picture {
        series: LAWS,
        subject: Subject::History(&["von_mises_stress", "stress_xy", "stress_yz"]),
        caption: "Stresses over time",
    }],
};

fn variants(_: Effort) -> Vec<Variant> {
    let strength = "material.heavy-steel.strength";
    let mut variants: Vec<_> =
        LAW.iter().map(|(label, law, _)| Variant::of_series(*label, LAWS).set(strength, law)).collect();
    let (label, law, _) = LAW[3];
    let coarse = Variant::of_series(format!("{label}, steps of 4 us"), STEPS);
    variants.push(coarse.set(strength, law).set("time.fixed-step", "\"4 us\""));
    variants
}

/// State of the material.
#[derive(Clone, Copy, Debug)]
struct State {
    deviator: Matrix,
    plastic_strain: f64,
    temperature: f64,
}

fn combine(of: impl Fn(usize, usize) -> f64) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| of(i, j)))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    combine(|i, j| (0..3).map(|k| a[i][k] * b[k][j]).sum())
}

fn contraction(a: &Matrix, b: &Matrix) -> f64 {
    (0..3).map(|i| (0..3).map(|j| a[i][j] * b[i][j]).sum::<f64>()).sum()
}

fn determinant(a: &Matrix) -> f64 {
    let minor = |i: usize, j: usize| a[1][i] * a[2][j] - a[1][j] * a[2][i];
    a[0][0] * minor(1, 2) - a[0][1] * minor(0, 2) + a[0][2] * minor(0, 1)
}

fn inverse(a: &Matrix) -> Matrix {
    let d = determinant(a);
    // Cyclic indices carry the signs of the cofactors.
    combine(|i, j| {
        let (r, s, t, u) = ((j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3);
        (a[r][t] * a[s][u] - a[r][u] * a[s][t]) / d
    })
}

/// Deformation gradient and velocity gradient at `t`.
fn motion(gradient: &Matrix, t: f64) -> (Matrix, Matrix) {
    let f = combine(|i, j| f64::from(u8::from(i == j)) + t * gradient[i][j]);
    (f, product(gradient, &inverse(&f)))
}

fn equivalent(deviator: &Matrix) -> f64 {
    (1.5 * contraction(deviator, deviator)).sqrt()
}

/// Rates of the state at `t`.
fn rates(strength: Strength, gradient: &Matrix, t: f64, state: &State) -> State {
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    let (f, l) = motion(gradient, t);
    let trace = (l[0][0] + l[1][1] + l[2][2]) / 3.0;
    let rate = combine(|i, j| 0.5 * (l[i][j] + l[j][i]) - if i == j { trace } else { 0.0 });
    let spin = combine(|i, j| 0.5 * (l[i][j] - l[j][i]));
    let s = &state.deviator;
    let stress = equivalent(s);
    let plastic_rate = match strength {
        Strength::Elastic => 0.0,
        // At yield, consistency: the equivalent stress grows as fast as the yield stress.
        Strength::Hardening(yield_stress, slope) if stress >= yield_stress + slope * state.plastic_strain => {
            (3.0 * shear * contraction(s, &rate) / stress / (3.0 * shear + slope)).max(0.0)
        }
        Strength::Hardening(..) => 0.0,
        Strength::JohnsonCook => {
            let softening = 1.0 - ((state.temperature - ROOM) / (MELTING - ROOM)).max(0.0).powf(1.1);
            let quasistatic = (806e6 + 614e6 * state.plastic_strain.powf(0.168)) * softening;
            if stress > quasistatic { ((stress / quasistatic - 1.0) / 0.0089).min(40.0).exp() } else { 0.0 }
        }
    };
    let (ws, sw) = (product(&spin, s), product(s, &spin));
    let flow = if stress > 0.0 { 1.5 * plastic_rate / stress } else { 0.0 };
    State {
        deviator: combine(|i, j| 2.0 * shear * (rate[i][j] - flow * s[i][j]) + ws[i][j] - sw[i][j]),
        plastic_strain: plastic_rate,
        temperature: TAYLOR_QUINNEY * stress * plastic_rate * determinant(&f) / HEAT,
    }
}

/// The state at `end`, by the classical Runge-Kutta method.
fn solve(strength: Strength, gradient: &Matrix, end: f64, steps: u32) -> State {
    let dt = end / f64::from(steps);
    let mut state = State { deviator: [[0.0; 3]; 3], plastic_strain: 0.0, temperature: ROOM };
    let ahead = |state: &State, rates: &State, dt: f64| State {
        deviator: combine(|i, j| state.deviator[i][j] + dt * rates.deviator[i][j]),
        plastic_strain: state.plastic_strain + dt * rates.plastic_strain,
        temperature: state.temperature + dt * rates.temperature,
    };
    for step in 0..steps {
        let t = f64::from(step) * dt;
        let k1 = rates(strength, gradient, t, &state);
        let k2 = rates(strength, gradient, t + 0.5 * dt, &ahead(&state, &k1, 0.5 * dt));
        let k3 = rates(strength, gradient, t + 0.5 * dt, &ahead(&state, &k2, 0.5 * dt));
        let k4 = rates(strength, gradient, t + dt, &ahead(&state, &k3, dt));
        for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
            state = ahead(&state, &k, weight * dt / 6.0);
        }
    }
    state
}

/// What the equation says of the measures of the deck: name, unit, value.
fn answers(strength: Strength) -> [(&'static str, Unit, f64); 6] {
    let state = solve(strength, &GRADIENT, END, 200_000);
    let bulk = YOUNG / (3.0 * (1.0 - 2.0 * POISSON));
    let pressure = bulk * (1.0 / determinant(&motion(&GRADIENT, END).0) - 1.0);
    let s = &state.deviator;
    [
        ("von_mises_stress", Unit::MEGAPASCAL, equivalent(s)),
        ("stress_xx", Unit::MEGAPASCAL, s[0][0] - pressure),
        ("stress_xy", Unit::MEGAPASCAL, s[0][1]),
        ("stress_yz", Unit::MEGAPASCAL, s[1][2]),
        ("plastic_strain", Unit::NONE, state.plastic_strain),
        ("temperature", Unit::KELVIN, state.temperature),
    ]
}

fn compare(run: &Run, strength: Strength, findings: &mut Findings, asked: Option<f64>) {
    for (measure, unit, answer) in answers(strength) {
        let ours = run.measure(measure);
        if measure == "plastic_strain" && answer == 0.0 {
            let finding = Finding::new("plastic strain", unit, run.label(), ours);
            findings.add(finding.must(Bounds::AtMost(0.0), "elastic material never yields"));
            continue;
        }
        let finding = Finding::new(measure.replace('_', " "), unit, run.label(), ours).exact("rate equations", answer);
        findings.add(match asked {
            Some(share) => finding.must(
                Bounds::Relative(share),
                "the return mapping is of first order in the step; a thousand steps of a thousandth of the path",
            ),
            None => finding,
        });
    }
}

fn judge(runs: &Runs, findings: &mut Findings) {
    for run in runs.series(LAWS) {
        if let Some((_, _, strength)) = LAW.iter().find(|law| law.0 == run.label()) {
            compare(run, *strength, findings, Some(2e-3));
        }
        let spread = run.measure("most_plastic_strain").zip(run.measure("least_plastic_strain")).map(|(m, l)| m - l);
        findings.add(
            Finding::new("spread of plastic strain over the particles", Unit::NONE, run.label(), spread).must(
                Bounds::AtMost(1e-9),
                "the gradient of a linear velocity is exact at every particle, also at \
                                             faces",
            ),
        );
    }
    for run in runs.series(STEPS) {
        compare(run, Strength::JohnsonCook, findings, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Simple shear of an elastic material under the Jaumann rate: `S_xy = G sin(gamma)`, `S_xx = G (1 - cos(gamma))`.
    #[test]
    fn the_equation_knows_elastic_simple_shear() {
        let shear = YOUNG / 2.6;
        let gradient = [[0.0, 2000.0, 0.0], [0.0; 3], [0.0; 3]];
        let state = solve(Strength::Elastic, &gradient, 1e-3, 1000);
        assert!((state.deviator[0][1] / (shear * 2f64.sin()) - 1.0).abs() < 1e-9);
        assert!((state.deviator[0][0] / (shear * (1.0 - 2f64.cos())) - 1.0).abs() < 1e-9);
    }

    /// Beyond yield in uniaxial stretch of constant volume, `sigma_eq = Y + H ep` and `ep = eps - sigma_eq / 3G`.
    #[test]
    fn the_equation_knows_hardening_in_uniaxial_stretch() {
        let (shear, y, h) = (YOUNG / 2.6, 8e8, 3e9);
        let gradient = [[1.0, 0.0, 0.0], [0.0, -0.5, 0.0], [0.0, 0.0, -0.5]];
        let state = solve(Strength::Hardening(y, h), &gradient, 0.05, 50_000);
        // Along F = 1 + t L0 the equivalent of the logarithmic strain.
        let strain = (1.05f64.ln() - 0.975f64.ln()) * 2.0 / 3.0;
        let expected = (3.0 * shear * strain - y) / (3.0 * shear + h);
        assert!((state.plastic_strain - expected).abs() < 1e-5, "{} {expected}", state.plastic_strain);
        assert!((equivalent(&state.deviator) - (y + h * expected)).abs() < 2e6);
    }

    #[test]
    fn an_inverse_undoes_its_matrix() {
        let (a, one) = (GRADIENT, product(&GRADIENT, &inverse(&GRADIENT)));
        assert!(determinant(&a) != 0.0);
        for i in 0..3 {
            for j in 0..3 {
                assert!((one[i][j] - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }
}
