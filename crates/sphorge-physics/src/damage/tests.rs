use super::*;
use crate::SymmetricTensor;
use crate::flow::{FlowState, FlowStep};

fn law(key: &str, values: &[f64]) -> DamageLaw<f64> {
    let entry = DAMAGE_LAWS.iter().find(|entry| entry.key == key).unwrap();
    assert_eq!((entry.check)(values), None, "{key}");
    (entry.build)(values)
}

/// Integrity goes over a tenth of the failure strain.
fn damage(law: DamageLaw<f64>) -> Damage<f64> {
    Damage { law, smallest_strain: 1e-3, softening: Softening::Share(0.1), after: AfterFailure::NoTension }
}

const STEEL: Moduli<f64> = Moduli { young: 208e9, shear: 80e9 };
const SIZE: f64 = 2e-3;

/// A step under principal stresses (Pa), turned away from the axes, with an increment of plastic strain at a rate (1/s) and a temperature (K).
fn step(stress: [f64; 3], increment: f64, rate: f64, temperature: f64) -> FlowStep<f64> {
    let sigma = SymmetricTensor::diagonal(stress[0], stress[1], stress[2]).congruence(&[
        [0.6, -0.8, 0.0],
        [0.8, 0.6, 0.0],
        [0.0, 0.0, 1.0],
    ]);
    let pressure = -(stress[0] + stress[1] + stress[2]) / 3.0;
    let state = FlowState { pressure, plastic_strain_rate: rate, ..FlowState::at_rest(temperature) };
    FlowStep { state, deviator: sigma.deviator(), plastic_strain_increment: increment, dt: increment / rate }
}

/// Plastic strain at which the damage is one, and at which the integrity is gone, in steps of 1e-5 of a state of stress.
fn strains(of: &Damage<f64>, stress: [f64; 3], rate: f64, temperature: f64) -> [f64; 2] {
    let increment = 1e-5;
    let (mut before, mut broken) = (Before { damage: 0.0, integrity: 1.0 }, None);
    for k in 1..5_000_000 {
        let after = of.after_step(&step(stress, increment, rate, temperature), STEEL, SIZE, before);
        let strain = f64::from(k) * increment;
        if after.damage >= 1.0 {
            // The part of the step before.
            broken = broken.or(Some(strain - after.share * increment));
        }
        before = Before { damage: after.damage, integrity: after.integrity };
        if before.integrity == 0.0 {
            return [broken.unwrap(), strain];
        }
    }
    [f64::INFINITY; 2]
}

/// Principal stresses of a von Mises stress of 400 MPa: along one axis, equal along two, shear, plane strain, compression, and the first with a
/// mean stress as in a notch. Their triaxialities are 1/3, 2/3, 0, 0.577350, -1/3 and 1, their Lode angles 1, -1, 0, 0, -1 and 1.
const STATES: [[f64; 3]; 6] = [
    [4e8, 0.0, 0.0],
    [4e8, 4e8, 0.0],
    [4e8 / 1.732_050_807_568_877_2, 0.0, -4e8 / 1.732_050_807_568_877_2],
    [8e8 / 1.732_050_807_568_877_2, 4e8 / 1.732_050_807_568_877_2, 0.0],
    [0.0, 0.0, -4e8],
    [4e8 * 5.0 / 3.0, 4e8 * 2.0 / 3.0, 4e8 * 2.0 / 3.0],
];

/// Every state against failure strains by hand, within a tenth of a percent.
fn assert_strains(key: &str, values: &[f64], (rate, temperature): (f64, f64), expected: [f64; 6]) {
    let damage = damage(law(key, values));
    for (stress, expected) in STATES.into_iter().zip(expected) {
        let [found, _] = strains(&damage, stress, rate, temperature);
        let near = found == expected || (found / expected - 1.0).abs() < 1e-3;
        assert!(near, "{key} at {rate}/s, {temperature} K, {stress:?}: {found}, by hand {expected}");
    }
}

const NEVER: f64 = f64::INFINITY;

#[test]
fn failure_strains_of_johnson_cook_by_hand() {
    // OFHC copper: (0.54 + 4.89 exp(-3.03 eta)) (1 + 0.014 ln rate) (1 + 1.12 T*). At eta = 1/3 exp(-1.01) = 0.364219: 2.321031; at 1e4/s
    // 1 + 0.014 9.210340 = 1.128945; at 600 K T* = 306/1062 = 0.288136: 1.322712.
    let copper = [0.54, 4.89, -3.03, 0.014, 1.12, 1.0, 294.0, 1356.0];
    let slow = [2.321_031, 1.188_685, 5.43, 1.390_289, 13.965_989, 0.776_263];
    assert_strains("johnson-cook", &copper, (0.5, 250.0), slow);
    assert_strains("johnson-cook", &copper, (1e4, 294.0), slow.map(|strain| strain * 1.128_945));
    assert_strains("johnson-cook", &copper, (1e4, 600.0), slow.map(|strain| strain * 1.128_945 * 1.322_712));
    // Molten, and from another reference rate on: 1 + 0.014 ln 100 = 1.064472.
    assert_strains("johnson-cook", &copper, (0.5, 3000.0), slow.map(|strain| strain * 2.12));
    let other = [0.54, 4.89, -3.03, 0.014, 1.12, 100.0, 294.0, 1356.0];
    assert_strains("johnson-cook", &other, (1e4, 294.0), slow.map(|strain| strain * 1.064_472));
}

#[test]
fn failure_strains_of_the_other_laws_by_hand() {
    let at = (10.0, 400.0);
    assert_strains("failure-strain", &[0.37], at, [0.37; 6]);
    // 1.65 exp(-1.5 eta).
    let hancock = [1.000_776, 0.607_001, 1.65, 0.694_023, 2.720_390, 0.368_165];
    assert_strains("hancock-mackenzie", &[1.65, 1.5], at, hancock);
    // 500 MPa over the largest principal stress: 400, 400, 230.940, 461.880, none, 666.667 MPa.
    let cockcroft = [1.25, 1.25, 2.165_064, 1.082_532, NEVER, 0.75];
    assert_strains("cockcroft-latham", &[500e6], at, cockcroft);
    // 0.6 times 400 MPa over it.
    let normalised = [0.6, 0.6, 1.039_230, 0.519_615, NEVER, 0.36];
    assert_strains("normalised-cockcroft-latham", &[0.6], at, normalised);
    // A/c2 = 740/345, c3 = 0.9. With Lode angle 0: 0.9 (sqrt(1.01/3) + 0.1 eta); with one, +-1: 1 (sqrt(1.01/3) sqrt(3)/2 + 0.1 (eta +- 1/6));
    // to the power -1/0.15. In shear 2.144928 0.9 0.580230 = 1.120094, ln = 0.113412, /0.15 = 0.756083, exp(-..) = 0.469502.
    let mohr = [0.322_404, 0.322_404, 0.469_496, 0.249_452, 1.220_389, 0.150_855];
    assert_strains("modified-mohr-coulomb", &[740e6, 0.15, 0.1, 345e6, 0.9], at, mohr);
}

#[test]
fn mohr_and_coulomb_look_at_the_worst_plane() {
    // With n = 1 and c3 = 1 the damage per strain is A/c2 times the largest of tau + c1 sigma_n over all planes, over q.
    let law = law("modified-mohr-coulomb", &[3e8, 1.0, 0.4, 2e8, 1.0]);
    for stress in [[5e8, 1e8, -2e8], [-1e8, -3e8, -3.5e8], [7e8, 6e8, 2e8]] {
        let state = DamageState::after(&step(stress, 0.0, 1.0, 300.0));
        let (middle, radius) = (0.5 * (stress[0] + stress[2]), 0.5 * (stress[0] - stress[2]));
        let plane = |angle: f64| radius * angle.sin() + 0.4 * (middle + radius * angle.cos());
        let worst = (0..10_000).map(|k| plane(f64::from(k) * 3.141_592_653_6e-4)).fold(f64::MIN, f64::max);
        let expected = 1.5 * worst / state.von_mises;
        assert!((law.growth(&state) - expected.max(0.0)).abs() < 1e-6 * expected.abs(), "{stress:?}: {expected}");
    }
}

#[test]
fn a_principal_stress_breaks_without_flow() {
    let brittle = damage(law("principal-stress", &[500e6]));
    let after = |stress: [f64; 3], before| brittle.after_step(&step(stress, 0.0, 1.0, 300.0), STEEL, SIZE, before);
    let start = Before { damage: 0.0, integrity: 1.0 };
    for (stress, damage) in [([4e8, 4e8, 3e8], 0.8), ([-9e8, -8e8, -7e8], 0.0), ([5e8, 0.0, -9e8], 1.0)] {
        let found = after(stress, start);
        assert!((found.damage - damage).abs() < 1e-6 && found.integrity == 1.0, "{stress:?}: {found:?}");
    }
    // What it has borne counts, not what it bears.
    let less = after([1e8, 0.0, 0.0], Before { damage: 0.7, integrity: 1.0 });
    assert_eq!((less.damage, less.integrity), (0.7, 1.0));
    // The stress that is borne falls from s_f to nothing over as much strain again: w D = 2 - D.
    let half = after([7.5e8, 0.0, 0.0], start);
    assert!((half.integrity * 1.5 - 0.5).abs() < 1e-6, "{half:?}");
    assert_eq!(after([1e9, 0.0, 0.0], start).integrity, 0.0);
}

#[test]
fn a_failure_strain_that_is_not_above_its_least_is_that() {
    // 6061-T6: -0.77 + 1.45 exp(-0.47 eta) is -0.1994 at eta = 2, and 0.0024 at 1.34.
    let aluminium = [-0.77, 1.45, -0.47, 0.0, 1.6, 1.0, 293.0, 925.0];
    let damage = Damage { smallest_strain: 0.01, ..damage(law("johnson-cook", &aluminium)) };
    for mean in [1.34, 2.0, 7.0] {
        let [found, _] =
            strains(&damage, [2.0 / 3.0 + mean, mean - 1.0 / 3.0, mean - 1.0 / 3.0].map(|s| s * 3e8), 1.0, 293.0);
        assert!((found / 0.01 - 1.0).abs() < 1e-3, "{mean}: {found}");
    }
    // 0.470 at eta = 1/3.
    let [found, _] = strains(&damage, [3e8, 0.0, 0.0], 1.0, 293.0);
    assert!((found / 0.469_725 - 1.0).abs() < 1e-3, "{found}");
}

#[test]
fn constants_that_turn_a_law_round_are_refused() {
    let entry = DAMAGE_LAWS.iter().find(|entry| entry.key == "johnson-cook").unwrap();
    let told = |values: [f64; 5]| {
        let [d1, d2, d3, d4, d5] = values;
        (entry.check)(&[d1, d2, d3, d4, d5, 1.0, 293.0, 1000.0]).unwrap_or_default()
    };
    assert!(told([0.13, 0.13, 1.5, 0.011, 0.0]).contains("D3 is above zero"));
    assert!(told([-0.1, 0.0, -1.5, 0.0, 0.0]).contains("not above zero for any"));
    assert_eq!(told([0.13, 0.13, -1.5, 0.011, 0.0]), "");
    assert_eq!(told([0.5, 0.0, 0.0, 0.0, 0.0]), "");
    assert!((entry.check)(&[0.5, 0.0, 0.0, 0.0, 0.0, 1.0, 293.0, 293.0]).is_some());
}

/// Plastic work per volume while integrity goes, J/m³, of a stress that hardens on the way, and the strain.
fn softening(softening: Softening<f64>, size: f64) -> [f64; 2] {
    let damage = Damage { softening, ..damage(law("failure-strain", &[0.2])) };
    let (mut before, mut sums, increment) = (Before { damage: 0.0, integrity: 1.0 }, [0.0; 2], 2e-6);
    while before.integrity > 0.0 {
        let stress = 5e8 * (1.0 + 3.0 * sums[1]);
        let after = damage.after_step(&step([stress, 0.0, 0.0], increment, 1.0, 300.0), STEEL, size, before);
        sums[0] += after.share * before.integrity * stress * increment;
        sums[1] += after.share * increment;
        before = Before { damage: after.damage, integrity: after.integrity };
    }
    sums
}

#[test]
fn what_a_crack_takes_is_what_was_stated() {
    for size in [1e-3, 2e-3, 4e-3] {
        let [work, _] = softening(Softening::Energy(60e3), size);
        assert!((work * size / 60e3 - 1.0).abs() < 2e-3, "{size}: {work}");
        let [_, strain] = softening(Softening::Displacement(0.1e-3), size);
        assert!((strain * size / 0.1e-3 - 1.0).abs() < 2e-3, "{size}: {strain}");
    }
    // A tenth of 0.2, whatever the size.
    for size in [1e-3, 4e-3] {
        let [_, strain] = softening(Softening::Share(0.1), size);
        assert!((strain / 0.02 - 1.0).abs() < 2e-3, "{size}: {strain}");
    }
    // Not faster than material unloads: over twice q/(3 G) at least, 500/240e3 = 2.0833e-3.
    for sudden in [Softening::Energy(1.0), Softening::Displacement(1e-9), Softening::Share(1e-6)] {
        let [_, strain] = softening(sudden, 1e-3);
        assert!((strain / 4.1667e-3 - 1.0).abs() < 2e-2, "{strain}");
    }
}

#[test]
fn a_brittle_crack_takes_what_was_stated() {
    let s = 500e6;
    for size in [1e-4, 5e-4] {
        for (softening, expected) in
            [(Softening::Energy(800.0), 800.0), (Softening::Displacement(4e-6), 0.5 * s * 4e-6)]
        {
            let brittle = Damage { softening, ..damage(law("principal-stress", &[s])) };
            let (mut before, mut work, rise) = (Before { damage: 0.0, integrity: 1.0 }, 0.0, 1e-4 * s);
            let mut stress = 0.0;
            while before.integrity > 0.0 {
                stress += rise;
                let after = brittle.after_step(&step([stress, 0.0, 0.0], 0.0, 1.0, 300.0), STEEL, size, before);
                work += 0.5 * (before.integrity + after.integrity) * stress * rise / STEEL.young;
                before = Before { damage: after.damage, integrity: after.integrity };
            }
            assert!((work * size / expected - 1.0).abs() < 2e-3, "{size} {softening:?}: {}", work * size);
        }
    }
}

#[test]
fn damage_stays_and_what_is_closed_does_not_break_on() {
    let latham = damage(law("cockcroft-latham", &[100e6]));
    let broken = Before { damage: 1.0, integrity: 0.6 };
    let pressed = latham.after_step(&step([0.0, 0.0, -4e8], 0.01, 1.0, 300.0), STEEL, SIZE, broken);
    assert_eq!((pressed.damage, pressed.integrity, pressed.share), (1.0, 0.6, 0.0));
    let idle = latham.after_step(&step([4e8, 0.0, 0.0], 0.0, 1.0, 300.0), STEEL, SIZE, broken);
    assert_eq!((idle.damage, idle.integrity, idle.share), (1.0, 0.6, 0.0));
    // All of a step that comes later counts, and what is lost at 0.25 per 0.025 of strain is all there is.
    let on = latham.after_step(&step([4e8, 0.0, 0.0], 0.01, 1.0, 300.0), STEEL, SIZE, broken);
    assert_eq!((on.damage, on.share), (1.0, 1.0));
    assert!((on.integrity - 0.2).abs() < 1e-9, "{on:?}");
}

#[test]
fn what_is_borne_without_integrity() {
    for (pressure, integrity, [no_tension, fluid, deleted]) in [
        (-100.0, 1.0, [[-100.0, 1.0], [-100.0, 1.0], [-100.0, 1.0]]),
        (-100.0, 0.25, [[-25.0, 0.25], [-100.0, 1.0], [-25.0, 0.25]]),
        (300.0, 0.25, [[300.0, 1.0], [300.0, 1.0], [300.0, 1.0]]),
        (300.0, 0.0, [[300.0, 1.0], [300.0, 1.0], [0.0, 0.0]]),
        (-100.0, 0.0, [[-0.0, 0.0], [-100.0, 1.0], [0.0, 0.0]]),
    ] {
        assert_eq!(AfterFailure::NoTension.bears(pressure, integrity), no_tension);
        assert_eq!(AfterFailure::Fluid.bears(pressure, integrity), fluid);
        assert_eq!(AfterFailure::Delete.bears(pressure, integrity), deleted);
    }
}

#[test]
fn single_precision_gives_the_same() {
    let single = damage(law("johnson-cook", &[0.05, 3.44, -2.12, 0.002, 0.61, 1.0, 293.0, 1793.0])).cast::<f32>();
    let double = damage(law("johnson-cook", &[0.05, 3.44, -2.12, 0.002, 0.61, 1.0, 293.0, 1793.0]));
    let of = step([9e8, 2e8, -1e8], 1e-3, 2e3, 500.0);
    let FlowStep { state, deviator, .. } = of;
    let of_single = FlowStep {
        state: FlowState {
            plastic_strain: state.plastic_strain as f32,
            plastic_strain_rate: state.plastic_strain_rate as f32,
            temperature: state.temperature as f32,
            pressure: state.pressure as f32,
            compression: state.compression as f32,
        },
        deviator: SymmetricTensor::from_array(deviator.to_array().map(|c| c as f32)),
        plastic_strain_increment: 1e-3,
        dt: of.dt as f32,
    };
    let moduli = Moduli { young: 208e9, shear: 80e9 };
    let a = single.after_step(&of_single, moduli, 2e-3, Before { damage: 0.5, integrity: 1.0 });
    let b = double.after_step(&of, STEEL, SIZE, Before { damage: 0.5, integrity: 1.0 });
    assert!((f64::from(a.damage) / b.damage - 1.0).abs() < 1e-6, "{a:?} {b:?}");
}
