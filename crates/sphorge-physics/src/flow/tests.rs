use super::*;
use crate::parameter::Bound;

fn entry(key: &str) -> &'static LawEntry<FlowLaw<f64>> {
    FLOW_LAWS.iter().find(|entry| entry.key == key).unwrap()
}

pub(super) fn state(plastic_strain: f64, plastic_strain_rate: f64, temperature: f64) -> FlowState<f64> {
    FlowState { plastic_strain, plastic_strain_rate, ..FlowState::at_rest(temperature) }
}

pub(super) fn close(got: f64, want: f64, relative: f64) {
    assert!((got - want).abs() <= relative * want.abs(), "got {got}, want {want}");
}

/// Compares the slopes of a law at a strain, rate and temperature with differences.
pub(super) fn assert_slopes(yield_stress: &dyn Fn(FlowState<f64>) -> YieldStress<f64>, at: (f64, f64, f64)) {
    let (e, r, t) = at;
    let y = |e, r| yield_stress(state(e, r, t));
    // Differences round off at a billionth of the stress over the step.
    let (de, dr) = (1e-3 * e.max(1e-6), 1e-3 * r.max(1e-6));
    let by_strain = (y(e + de, r).value - y(e - de, r).value) / (2.0 * de);
    let by_rate = (y(e, r + dr).value - y(e, r - dr).value) / (2.0 * dr);
    let near = |got: f64, want: f64, step: f64| {
        assert!((got - want).abs() <= 1e-4 * want.abs() + 1e-12 * y(e, r).value / step, "{at:?}: {got} {want}");
    };
    if e > 0.0 {
        near(y(e, r).by_strain, by_strain, de);
    }
    near(y(e, r).by_rate, by_rate, dr);
}

/// Armco iron (Patiño et al. Table 2) and an aluminium with every constant different.
const IRON: [f64; 8] = [175.0e6, 380.0e6, 0.32, 0.060, 0.55, 1.0, 293.15, 1811.0];
const ALUMINIUM: [f64; 8] = [300.0e6, 426.0e6, 0.34, 0.015, 1.0, 2.0, 273.15, 775.0];

#[test]
fn johnson_cook_by_hand() {
    // Iron, 0.2, 1e4/s, 600 K: 0.2^0.32 = exp(-0.515020) = 0.597489; 175 + 380 0.597489 = 402.0457 MPa;
    // 1 + 0.06 ln 1e4 = 1.552620; T* = 306.85/1517.85 = 0.202161, T*^0.55 = exp(-0.879280) = 0.415082.
    let iron = (entry("johnson-cook").build)(&IRON);
    close(iron.yield_stress(state(0.2, 1.0e4, 600.0), &[]).value, 402.0457e6 * 1.552_620 * 0.584_918, 1e-5);
    // Aluminium, 0.05, 300/s, 400 K: 0.05^0.34 = exp(-1.018549) = 0.361118; 300 + 426 0.361118 = 453.8363 MPa;
    // 1 + 0.015 ln 150 = 1.075160; T* = 126.85/501.85 = 0.252765.
    let aluminium = (entry("johnson-cook").build)(&ALUMINIUM);
    close(aluminium.yield_stress(state(0.05, 300.0, 400.0), &[]).value, 453.8363e6 * 1.075_160 * 0.747_235, 1e-5);
}

#[test]
fn johnson_cook_limits() {
    let iron = (entry("johnson-cook").build)(&IRON);
    let y = |e, r, t| iron.yield_stress(state(e, r, t), &[]);
    assert_eq!(y(0.0, 0.0, 293.15).value, 175.0e6);
    // A negative strain cannot be; it counts as none.
    assert_eq!(y(-1e-3, 0.0, 293.15).value, 175.0e6);
    // At and below the reference rate, no effect of the rate.
    for rate in [0.0, 1e-6, 0.5, 1.0] {
        assert_eq!(y(0.1, rate, 300.0).value, y(0.1, 1.0, 300.0).value);
        assert_eq!(y(0.1, rate, 300.0).by_rate, 0.0);
    }
    // Colder than the reference temperature, no hardening by cold.
    assert_eq!(y(0.1, 10.0, 100.0).value, y(0.1, 10.0, 293.15).value);
    // No strength at and above melting.
    for temperature in [1811.0, 1811.1, 5000.0, 1e6] {
        let melt = y(0.3, 1e5, temperature);
        assert_eq!((melt.value, melt.by_strain, melt.by_rate), (0.0, 0.0, 0.0));
    }
    assert!(y(0.3, 1e5, 1810.9).value > 0.0);
    assert_eq!(iron.melting_temperature(), Some(1811.0));
}

#[test]
fn johnson_cook_slopes() {
    for constants in [IRON, ALUMINIUM, [90.0e6, 0.0, 0.31, 0.025, 1.09, 1.0, 293.0, 1356.0]] {
        let law = (entry("johnson-cook").build)(&constants);
        for (e, r, t) in [(0.01, 50.0, 310.0), (0.7, 1e5, 700.0), (1e-6, 0.3, 250.0)] {
            let y = |e, r| law.yield_stress(state(e, r, t), &[]);
            let by_strain = (y(e * 1.001, r).value - y(e * 0.999, r).value) / (e * 0.002);
            let by_rate = (y(e, r * 1.001).value - y(e, r * 0.999).value) / (r * 0.002);
            assert!((by_strain - y(e, r).by_strain).abs() <= 1e-5 * by_strain.abs());
            assert!((by_rate - y(e, r).by_rate).abs() <= 1e-5 * by_rate.abs());
        }
        // Finite where the formula is not, and joined without a jump.
        let zero = law.yield_stress(state(0.0, 0.0, 300.0), &[]);
        assert!(zero.by_strain.is_finite() && zero.by_strain >= 0.0);
        let (below, above) =
            (law.yield_stress(state(0.999e-12, 0.0, 300.0), &[]), law.yield_stress(state(1.001e-12, 0.0, 300.0), &[]));
        assert!(above.value >= below.value && above.value - below.value < 1e-5 * above.value);
    }
    let single = (entry("johnson-cook").build)(&IRON).cast::<f32>();
    let zero = single.yield_stress(FlowState::at_rest(300.0), &[]);
    assert!(zero.by_strain.is_finite());
}

#[test]
fn bilinear_and_perfectly_plastic() {
    // H = 210 2/208 = 2.019230769 GPa; Y(0.1) = 350 MPa + 201.9230769 MPa.
    let steel = (entry("bilinear").build)(&[350.0e6, 210.0e9, 2.0e9]);
    let y = steel.yield_stress(state(0.1, 1e6, 2000.0), &[]);
    close(y.value, 551.923_076_923e6, 1e-11);
    close(y.by_strain, 2.019_230_769_23e9, 1e-11);
    // H = 70 7/63 = 7.777... GPa.
    let aluminium = (entry("bilinear").build)(&[220.0e6, 70.0e9, 7.0e9]);
    close(aluminium.yield_stress(state(0.03, 0.0, 0.0), &[]).value, 453.333_333_333e6, 1e-11);
    let perfect = (entry("perfectly-plastic").build)(&[90.0e6]);
    assert_eq!(perfect.yield_stress(state(3.0, 1e6, 900.0), &[]).value, 90.0e6);
}

#[test]
fn what_each_law_can() {
    let built = |key: &str, values: &[f64]| (entry(key).build)(values);
    let (none, elastic) = (built("none", &[]), built("elastic", &[]));
    assert!(!none.has_shear() && !none.yields());
    assert!(elastic.has_shear() && !elastic.yields());
    assert!(elastic.yield_stress(state(0.0, 0.0, 0.0), &[]).value.is_infinite());
    for law in [built("perfectly-plastic", &[1.0]), built("bilinear", &[1.0, 2.0, 1.0]), built("johnson-cook", &IRON)] {
        assert!(law.has_shear() && law.yields());
    }
}

/// A law of every entry of the table, of whatever constants where it has no default.
fn built(entry: &LawEntry<FlowLaw<f64>>) -> FlowLaw<f64> {
    let constants = entry.parameters.iter().zip(IRON.into_iter().cycle());
    let values: Vec<f64> = constants.map(|(parameter, value)| parameter.default.unwrap_or(value)).collect();
    (entry.build)(&values)
}

#[test]
fn tables_agree_with_the_laws() {
    for entry in FLOW_LAWS {
        let law = built(entry);
        assert_eq!(law.key(), entry.key);
        assert_eq!(law.parameters(), entry.parameters);
        assert!(
            entry
                .parameters
                .iter()
                .all(|parameter| parameter.default.is_none_or(|value| parameter.bound.allows(value)))
        );
    }
    assert_eq!((entry("bilinear").check)(&[1.0, 2.0, 1.0]), None);
    assert!((entry("bilinear").check)(&[1.0, 2.0, 2.0]).is_some());
    assert_eq!((entry("johnson-cook").check)(&IRON), None);
    let mut cold = IRON;
    cold[7] = 293.15;
    assert!((entry("johnson-cook").check)(&cold).is_some());
    assert!((entry("modified-johnson-cook").check)(&cold).is_some());
    assert_eq!(entry("johnson-cook").parameters[5].default, Some(1.0));
    assert_eq!(entry("johnson-cook").parameters[2].bound, Bound::Positive);
    assert_eq!(entry("pressure-and-damage").parameters[3].quantity.si_unit(), "1/Pa");
}

#[test]
fn every_law_takes_good_constants_keeps_them_in_single_precision_and_knows_where_it_melts() {
    let (good, melts): (&[(&str, &[f64])], _) = (
        &[
            ("none", &[]),
            ("elastic", &[]),
            ("neo-hookean", &[]),
            ("perfectly-plastic", &[90.0e6]),
            ("bilinear", &[350.0e6, 210.0e9, 2.0e9]),
            ("johnson-cook", &IRON),
            ("modified-johnson-cook", &[490.0e6, 383.0e6, 0.45, 0.0114, 0.94, 5e-4, 293.0, 1800.0]),
            ("zerilli-armstrong-bcc", &[65.0e6, 1033.0e6, 6.98e-3, 4.15e-4, 266.0e6, 0.289, 1e-3]),
            ("zerilli-armstrong-fcc", &[65.0e6, 890.0e6, 2.8e-3, 1.15e-4, 1e-3]),
            ("steinberg-guinan", &[120e6, 640e6, 36.0, 0.45, 2.8e-11, 3.8e-4, 300.0, 1790.0, 2.02, 1.5, 0.0]),
            ("pressure-and-damage", &PRESSED),
        ],
        ["johnson-cook", "modified-johnson-cook", "steinberg-guinan"],
    );
    assert_eq!(good.len(), FLOW_LAWS.len());
    let at = FlowState { pressure: 1.0e9, compression: 1.01, ..state(0.1, 1.0e3, 400.0) };
    let single = FlowState {
        pressure: 1.0e9f32,
        compression: 1.01,
        plastic_strain: 0.1,
        plastic_strain_rate: 1.0e3,
        ..FlowState::at_rest(400.0)
    };
    for (key, constants) in good {
        assert_eq!((entry(key).check)(constants), None, "{key}");
        let law = (entry(key).build)(constants);
        assert_eq!(law.melting_temperature().is_some(), melts.contains(key), "{key}");
        let history = vec![0.25; law.history().len()];
        let y = law.yield_stress(at, &history).value;
        let in_single = law.cast::<f32>().yield_stress(single, &vec![0.25; history.len()]).value;
        assert!(y == f64::from(in_single) || (f64::from(in_single) / y - 1.0).abs() < 1e-5, "{key}: {y} {in_single}");
    }
    // A law that cannot harden further is one.
    assert_eq!(
        (entry("steinberg-guinan").check)(&[2e8, 2e8, 36.0, 0.45, 2.8e-11, 3.8e-4, 300.0, 1790.0, 2.02, 1.5, 0.0]),
        None
    );
}

/// `sigma_y`, `H`, `k`, `A`, `W` of the law that uses all there is.
const PRESSED: [f64; 5] = [200.0e6, 1.0e9, 0.1, 2.0e-11, 100.0e6];

/// Strained and compressed by 1.1^3, and stretched to 0.9^3.
fn pressed_states() -> [FlowState<f64>; 2] {
    [
        FlowState { pressure: 5.0e9, compression: 1.331, ..state(0.1, 0.0, 300.0) },
        FlowState { pressure: -1.0e9, compression: 0.729, ..state(0.02, 0.0, 300.0) },
    ]
}

#[test]
fn pressure_and_history_reach_the_yield_stress() {
    let law = (entry("pressure-and-damage").build)(&PRESSED);
    let [pressed, stretched] = pressed_states();
    // (200 + 100 + 500) 0.75 MPa and (200 + 20 - 100) 0.5 MPa; slopes 0.75 and 0.5 GPa.
    for (state, damage, value, slope) in [(pressed, 0.25, 600.0e6, 0.75e9), (stretched, 0.5, 60.0e6, 0.5e9)] {
        let y = law.yield_stress(state, &[damage]);
        close(y.value, value, 1e-15);
        close(y.by_strain, slope, 1e-15);
        // Held at the pressure it is the same.
        close(law.held(state).yield_stress(state, &[damage]).value, value, 1e-15);
    }
    assert!(law.changes_without_flow() && !(entry("johnson-cook").build)(&IRON).changes_without_flow());
}

#[test]
fn a_law_may_vary_the_shear_modulus() {
    let law = (entry("pressure-and-damage").build)(&PRESSED);
    let [pressed, stretched] = pressed_states();
    // 80 (1 + 0.1/1.1) GPa and 45 (1 - 0.02/0.9) GPa.
    close(law.shear_modulus(80.0e9, pressed), 87.272_727_272_727_3e9, 1e-14);
    close(law.shear_modulus(45.0e9, stretched), 44.0e9, 1e-14);
    close(law.shear_modulus(80.0e9, FlowState::at_rest(300.0)), 80.0e9, 1e-15);
    assert!(law.shear_modulus_varies());
    let iron = (entry("johnson-cook").build)(&IRON);
    assert_eq!(iron.shear_modulus(80.0e9, pressed), 80.0e9);
    assert!(!iron.shear_modulus_varies());
}

#[test]
fn a_law_takes_its_history_through_a_step() {
    let law = (entry("pressure-and-damage").build)(&PRESSED);
    assert_eq!(law.history()[0].name, "damage");
    assert!((entry("johnson-cook").build)(&IRON).history().is_empty());
    // A shear of tau has the equivalent stress sqrt(3) tau: 400 MPa 0.01/100 MPa = 0.04, and 50 MPa 0.02/100 MPa = 0.01.
    let mut damage = [0.25];
    for (equivalent, increment, after) in [(400.0e6, 0.01, 0.29), (50.0e6, 0.02, 0.30), (1.0e9, 50.0, 1.0)] {
        let deviator = SymmetricTensor { xy: equivalent / 3.0f64.sqrt(), ..SymmetricTensor::zero() };
        let step = FlowStep { state: pressed_states()[0], deviator, plastic_strain_increment: increment, dt: 1e-8 };
        law.evolve(&step, &mut damage);
        close(damage[0], after, 1e-14);
    }
}

#[test]
fn laws_depend_on_what_they_say() {
    let rest = state(0.1, 0.0, 400.0);
    let pressed = FlowState { pressure: 7.0e9, compression: 1.2, ..rest };
    for entry in FLOW_LAWS {
        let law = built(entry);
        let initial: Vec<f64> = law.history().iter().map(|variable| variable.initial).collect();
        let y = |state| law.yield_stress(state, &initial);
        assert!(law.changes_without_flow() || y(rest) == y(pressed), "{}", entry.key);
        let g = |state| law.shear_modulus(80.0e9, state);
        assert!(law.shear_modulus_varies() || (g(rest) == 80.0e9 && g(pressed) == 80.0e9), "{}", entry.key);
        // Whatever the constants are, one of the two heats is between cold and molten.
        let heats = [(0.5, 2.0), (400.0, 700.0)].map(|(cold, hot)| (state(0.1, 0.0, cold), state(0.1, 0.0, hot)));
        let feels = heats.iter().any(|&(cold, hot)| y(cold) != y(hot) || g(cold) != g(hot));
        assert_eq!(law.depends_on_temperature(), feels, "{}", entry.key);
        let mut after = initial.clone();
        let deviator = SymmetricTensor { xy: 1.0e8, ..SymmetricTensor::zero() };
        law.evolve(&FlowStep { state: pressed, deviator, plastic_strain_increment: 0.0, dt: 1.0 }, &mut after);
        assert!(law.changes_without_flow() || after == initial, "{}", entry.key);
    }
}

#[test]
fn history_variables_are_fields_with_a_value_to_start_from() {
    for entry in FLOW_LAWS {
        assert_eq!(entry.history, built(entry).history());
        for (k, variable) in entry.history.iter().enumerate() {
            assert!(variable.bound.allows(variable.initial), "{}", variable.name);
            assert!(variable.name.bytes().all(|b| b.is_ascii_lowercase() || b == b'_'), "{}", variable.name);
            assert!(entry.history[..k].iter().all(|other| other.name != variable.name), "{}", variable.name);
        }
    }
}
