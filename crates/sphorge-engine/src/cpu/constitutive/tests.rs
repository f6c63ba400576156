use super::*;
use crate::cpu::flow::Places;
use crate::lanes::Instructions;
use sphorge_physics::artificial_stress::artificial_stress;
use sphorge_physics::damage::{AfterFailure, DAMAGE_LAWS, Damage, Softening};
use sphorge_physics::eos::{EQUATIONS_OF_STATE, PressureState};
use sphorge_physics::flow::{FLOW_LAWS, FlowLaw};
use sphorge_physics::integrity::{Borne, smeared_width};
use sphorge_physics::parameter::LawEntry;
use sphorge_physics::return_mapping::{ReturnRule, return_mapping_near};
use sphorge_physics::viscosity::{ViscosityParameters, bulk_viscosity};
use sphorge_physics::{Dimension, Tensor, tensor};

/// Not a multiple of the width of any SIMD vector.
const COUNT: usize = 107;
const DT: f64 = 2e-8;
const COPPER: [f64; 4] = [8930.0, 3940.0, 1.49, 2.0];
const STEINBERG_GUINAN: [f64; 11] = [120.0e6, 640.0e6, 36.0, 0.45, 2.83e-11, 3.77e-4, 300.0, 1790.0, 2.02, 1.5, 0.0];
const JOHNSON_COOK: [f64; 8] = [90.0e6, 292.0e6, 0.31, 0.025, 1.09, 1.0, 298.0, 1356.0];

fn material(equation: (&str, &[f64]), flow: (&str, &[f64]), shear_modulus: f64, spall_pressure: f64) -> Material {
    let equation_of_state = EQUATIONS_OF_STATE.iter().find(|e| e.key == equation.0).unwrap();
    let flow_law = FLOW_LAWS.iter().find(|e| e.key == flow.0).unwrap();
    Material {
        name: String::new(),
        reference: String::new(),
        density: equation.1[0],
        shear_modulus,
        equation_of_state: (equation_of_state.build)(equation.1),
        flow_law: (flow_law.build)(flow.1),
        return_rule: ReturnRule::RadialReturn,
        specific_heat: 385.0,
        conductivity: 0.0,
        taylor_quinney: 0.9,
        spall_pressure,
        spall_opening: 5e-5,
        damage: None,
        reference_temperature: 298.0,
        mass_scaling: 1.0,
    }
}

fn materials() -> [Material; 6] {
    [
        material(("mie-gruneisen", &COPPER), ("johnson-cook", &JOHNSON_COOK), 46.0e9, 1.5e9),
        material(("mie-gruneisen-polynomial", &[2710.0, 5300.0, 1.5, 1.7]), ("elastic", &[]), 27.0e9, f64::INFINITY),
        material(("linear", &[7850.0, 4600.0]), ("perfectly-plastic", &[350.0e6]), 80.0e9, f64::INFINITY),
        material(("linear", &[1000.0, 1500.0]), ("none", &[]), 0.0, 0.0),
        material(("mie-gruneisen", &COPPER), ("bilinear", &[350.0e6, 120.0e9, 2.0e9]), 46.0e9, f64::INFINITY),
        material(("mie-gruneisen", &COPPER), ("steinberg-guinan", &STEINBERG_GUINAN), 47.7e9, f64::INFINITY),
    ]
}

/// Numbers between -1 and 1 without repetition.
fn number(k: usize, what: usize) -> f64 {
    let x = ((7919 * k + 104_729 * what + 13) as f64 * 0.618_033_988_749_895).fract();
    2.0 * x - 1.0
}

/// Particles in all states, and the columns from which the stress is computed.
struct Particle {
    material: u32,
    deviator: SymmetricTensor<f64>,
    l: Tensor<f64>,
    density: f64,
    energy: f64,
    /// Plastic strain, its increment, yield stress, plastic work, temperature.
    flow: [f64; 5],
}

fn particle(materials: &[Material], mixed: bool, k: usize) -> Particle {
    let m = if mixed { (k / 3) % materials.len() } else { 0 };
    let law = &materials[m].flow_law;
    let plastic_strain = if k.is_multiple_of(2) { 0.0 } else { 0.1 * number(k, 1).abs() };
    let temperature = if k.is_multiple_of(11) { 1400.0 } else { 300.0 + 200.0 * number(k, 2).abs() };
    let state = materials[m].flow_state(plastic_strain, temperature, materials[m].density, 0.0);
    let yield_stress = law.yield_stress(state, &[]).value;
    let increment = if k % 5 == 1 { 1e-5 } else { 0.0 };
    // From far below yield to beyond it.
    let size = 2.0 * number(k, 3).abs() * yield_stress.min(300.0e6);
    let s = [4, 5, 6, 7, 8, 9].map(|c| size * number(k, c));
    let mut deviator = SymmetricTensor::from_array(s).deviator();
    let mut density = materials[m].density * (1.0 + 0.15 * number(k, 10));
    // A value that is not a number stays so.
    if k == 40 {
        deviator.xy = f64::NAN;
    }
    if k == 50 {
        density = f64::NAN;
    }
    Particle {
        material: m as u32,
        deviator,
        l: std::array::from_fn(|a| std::array::from_fn(|b| 3.0e4 * number(k, 11 + 3 * a + b))),
        density,
        energy: 1.0e5 * number(k, 20),
        flow: [plastic_strain, increment, yield_stress, 10.0 * plastic_strain, temperature],
    }
}

/// Equal to a few units of rounding of `size`, or both not numbers.
fn assert_near(got: f64, want: f64, size: f64, what: &dyn std::fmt::Display) {
    let near = (got - want).abs() <= 1e-13 * size || got == want || (got.is_nan() && want.is_nan());
    assert!(near, "{what}: {got:e} {want:e}");
}

/// Advances particles by a step with SIMD and one by one; returns how many stayed elastic.
fn compare(instructions: Instructions, mixed: bool, only_flow_heats: bool, form: StressForm) -> usize {
    let materials = materials();
    // Whole, weakened, severed.
    let integrity: Vec<f64> = (0..COUNT).map(|k| [1.0, 0.6, 0.0][k % 3]).collect();
    let mut particles: Vec<Particle> = (0..COUNT).map(|k| particle(&materials, mixed, k)).collect();
    for (p, integrity) in particles.iter_mut().zip(&integrity) {
        if form.breaks && materials[p.material as usize].breaks() {
            p.flow[2] *= integrity;
        }
    }
    let column = |of: &dyn Fn(&Particle) -> f64| -> Vec<f64> { particles.iter().map(of).collect() };
    let source = if only_flow_heats { TemperatureSource::PlasticWork } else { TemperatureSource::Energy };
    let step = StressStep {
        materials: &materials,
        temperature: source,
        only_flow_heats,
        instructions,
        commit: true,
        slots: &materials.iter().map(|m| if m.breaks() { vec![0] } else { Vec::new() }).collect::<Vec<_>>(),
        history_width: 1,
        cold_energies: &materials.iter().map(Material::cold_energies).collect::<Vec<_>>(),
        breaks: form.breaks,
        support: 2.0,
        end: 1e-6,
    };
    let mut columns = StressColumns::new();
    columns.repulsion = std::array::from_fn(|k| 0.2 + 0.01 * k as f64);
    columns.density[..COUNT].copy_from_slice(&column(&|p| p.density));
    columns.energy[..COUNT].copy_from_slice(&column(&|p| p.energy));
    columns.smoothing_length = [1e-3; BLOCK];
    columns.linear_share = std::array::from_fn(|k| [0.0, 0.4, 1.0][k % 3]);
    let mut flow: [Vec<f64>; 5] = std::array::from_fn(|c| column(&|p| p.flow[c]));
    let [ep, dep, y, wp, t] = &mut flow;
    let inputs = ElasticInputs {
        material: &particles.iter().map(|p| p.material).collect::<Vec<_>>(),
        deviator: &particles.iter().map(|p| p.deviator).collect::<Vec<_>>(),
        velocity_gradient: &particles.iter().map(|p| p.l).collect::<Vec<_>>(),
        deformation: &[],
        earlier_deformation: &[],
        smoothing_length: &[1e-3; COUNT],
        dt: DT,
    };
    let mut history = integrity.clone();
    FlowColumns::new((ep, dep, y, wp, t, &mut history)).take_step(&step, &mut columns, &inputs);
    let mut records = vec![[0.0; force::LEN]; COUNT];
    let mut singles = vec![[0.0f32; force::LEN]; COUNT];
    let mut extras = vec![[0.0; extra::LEN]; COUNT];
    run(
        instructions,
        PackStress { columns: &columns, form, records: &mut singles, extras: &mut vec![[0.0; extra::LEN]; COUNT] },
    );
    run(instructions, PackStress { columns: &columns, form, records: &mut records, extras: &mut extras });

    let mut elastic = 0;
    for (k, p) in particles.iter().enumerate() {
        let m = &materials[p.material as usize];
        let state = m.pressure(p.density, p.energy);
        let before = if form.breaks && m.breaks() { integrity[k] } else { 1.0 };
        let borne = match form.breaks {
            true => m.borne(p.density, state.pressure, before, smeared_width(2.0, 1e-3)),
            false => Borne { pressure: state.pressure, integrity: 1.0, share: 1.0 },
        };
        let state = PressureState { pressure: borne.pressure, ..state };
        let (law, pressure) = (&m.flow_law, state.pressure);
        let begin = m.flow_state(p.flow[0], p.flow[4], p.density, pressure);
        let g = law.shear_modulus(m.shear_modulus, begin);
        let of_whole = if before > 0.0 { p.deviator * (1.0 / before) } else { SymmetricTensor::zero() };
        let trial = stress::trial_deviator(of_whole, &p.l, g, DT);
        let mut update = return_mapping_near(m.return_rule, law, g, trial, begin, &[], DT, p.flow[1]);
        elastic += usize::from(update.plastic_strain_increment == 0.0);
        if form.breaks && m.breaks() && k != 50 {
            assert_near(history[k], borne.integrity, 1.0, &format!("integrity of {k}"));
        }
        if before == 0.0 {
            update.deviator = SymmetricTensor::zero();
        }
        let deviator_after = update.deviator * borne.integrity;
        let (mut want, mut empty): ([Vec<f64>; 5], _) = (p.flow.map(|v| vec![v]), Vec::new());
        let [ep, dep, y, wp, t] = &mut want;
        let cold = m.cold_energies();
        if before == 0.0 {
            (dep[0], y[0]) = (0.0, 0.0);
            if source == TemperatureSource::Energy {
                t[0] = m.temperature_of_energy(p.energy, cold.at(p.density, 0.0), 0.0, wp[0]);
            }
        } else {
            let integrity = (before, borne.integrity);
            let mut flow = FlowColumns::new((ep, dep, y, wp, t, &mut empty));
            let at = Places::of::<f64>(&[0]);
            flow.commit(&at, &update, (m, &cold), g, source, p.density, p.energy, integrity);
            y[0] = if borne.integrity > 0.0 { y[0] * (borne.integrity / before) } else { 0.0 };
        }
        for (c, name) in ["strain", "increment", "yield stress", "work", "temperature"].into_iter().enumerate() {
            // A step known to be elastic leaves the work alone whatever the density.
            if k != 50 {
                assert_near(flow[c][k], want[c][0], 1.0e9, &format!("{name} of {k}"));
                let relative = want[c][0].abs().max(1e-12);
                assert_near(flow[c][k], want[c][0], 1e3 * relative, &format!("{name} of {k}"));
            }
        }
        let deviator = columns.deviator_of(k).to_array();
        for (got, want) in deviator.into_iter().zip(deviator_after.to_array()) {
            assert_near(got, want, 1.0e9, &format!("deviator of {k}"));
        }
        assert_near(columns.pressure[k], state.pressure, 1.0e11, &format!("pressure of {k}"));
        assert_near(columns.sound_speed[k], state.sound_speed, 1.0e4, &format!("sound speed of {k}"));

        let mut pressure = state.pressure;
        if let Some(viscosity) = form.bulk_viscosity {
            let divergence = p.l[0][0] + p.l[1][1] + p.l[2][2];
            let acting = ViscosityParameters { alpha: columns.linear_share[k] * viscosity.alpha, ..viscosity };
            pressure += borne.share * bulk_viscosity(acting, divergence, p.density, state.sound_speed, 1e-3);
        }
        let scale = match form.pair_form {
            PairForm::VolumeWeighted => 1.0,
            PairForm::DensityWeighted | PairForm::Mixed => 1.0 / (p.density * p.density),
        };
        let sigma = (deviator_after - SymmetricTensor::isotropic(pressure)) * scale;
        let tail = [p.density, state.sound_speed];
        for (c, want) in sigma.to_array().into_iter().chain(tail).enumerate() {
            let size = if c < 6 { 1.0e11 * scale.max(1e-12) } else { 1.0e5 };
            assert_near(records[k][force::S + c], want, size, &format!("record of {k}"));
            assert_eq!(singles[k][force::S + c].to_bits(), (records[k][force::S + c] as f32).to_bits());
        }
        if k != 40 && k != 50 {
            let coefficient = if form.artificial_stress { columns.repulsion[k] } else { 0.0 };
            let r = artificial_stress(sigma, coefficient, form.dimension);
            for (c, want) in r.to_array().into_iter().enumerate() {
                assert_near(extras[k][extra::R + c], want, 1.0e11 * scale, &format!("artificial stress of {k}"));
            }
        }
    }
    elastic
}

#[test]
fn lanes_of_every_instruction_set_give_what_one_particle_at_a_time_does() {
    let plain = StressForm {
        pair_form: PairForm::VolumeWeighted,
        bulk_viscosity: None,
        shocks: None,
        artificial_stress: true,
        breaks: false,
        dimension: Dimension::Three,
    };
    let scaled = StressForm { pair_form: PairForm::DensityWeighted, dimension: Dimension::Two, ..plain };
    let viscous = StressForm {
        bulk_viscosity: Some(ViscosityParameters { alpha: 0.5, beta: 2.0 }),
        shocks: None,
        artificial_stress: false,
        ..plain
    };
    for instructions in Instructions::available() {
        for form in
            [plain, scaled, viscous, StressForm { breaks: true, ..plain }, StressForm { breaks: true, ..viscous }]
        {
            for mixed in [false, true] {
                for only_flow_heats in [false, true] {
                    let elastic = compare(instructions, mixed, only_flow_heats, form);
                    assert!(elastic > COUNT / 5 && elastic < 4 * COUNT / 5, "{elastic} of {COUNT} are elastic");
                }
            }
        }
    }
}

#[test]
fn a_body_that_spins_turns_its_stress_and_an_empty_block_is_none() {
    let materials = materials();
    let step = StressStep {
        materials: &materials,
        temperature: TemperatureSource::PlasticWork,
        only_flow_heats: true,
        instructions: Instructions::best(),
        commit: true,
        slots: &vec![Vec::new(); materials.len()],
        history_width: 0,
        cold_energies: &materials.iter().map(Material::cold_energies).collect::<Vec<_>>(),
        breaks: false,
        support: 2.0,
        end: 1e-6,
    };
    let mut columns = StressColumns::new();
    columns.density = [2710.0; BLOCK];
    // A quarter turn about z: tan(45 degrees) = dt/2 w.
    let inputs = ElasticInputs {
        material: &[1],
        deviator: &[SymmetricTensor::diagonal(2.0e6, -3.0e6, 1.0e6)],
        velocity_gradient: &[[[0.0, -2.0 / DT, 0.0], [2.0 / DT, 0.0, 0.0], [0.0; 3]]],
        deformation: &[],
        earlier_deformation: &[],
        smoothing_length: &[1e-3],
        dt: DT,
    };
    let mut flow = [[0.0], [0.0], [f64::INFINITY], [0.0], [300.0]];
    let [ep, dep, y, wp, t] = &mut flow;
    FlowColumns::new((ep, dep, y, wp, t, &mut Vec::new())).take_step(&step, &mut columns, &inputs);
    let turned = columns.deviator_of(0);
    let want = SymmetricTensor::<f64>::diagonal(-3.0e6, 2.0e6, 1.0e6);
    for (got, want) in turned.to_array().into_iter().zip(want.to_array()) {
        assert_near(got, want, 1.0e7, &"turned");
    }
    assert_eq!(flow, [[0.0], [0.0], [f64::INFINITY], [0.0], [300.0]]);
    assert!((tensor::determinant(&turned.to_tensor()) / -6.0e18 - 1.0).abs() < 1e-9);

    let nothing = ElasticInputs {
        material: &[],
        deviator: &[],
        velocity_gradient: &[],
        deformation: &[],
        earlier_deformation: &[],
        smoothing_length: &[],
        dt: DT,
    };
    assert_eq!(columns.take_elastic_step(step.instructions, &materials, &nothing), 0);
}

/// Every flow law that yields, and Johnson & Cook's with every law of damage.
fn laws_on_lanes() -> Vec<Material> {
    const STRENGTHS: [(&str, &[f64]); 7] = [
        ("perfectly-plastic", &[350.0e6]),
        ("bilinear", &[350.0e6, 120.0e9, 2.0e9]),
        ("johnson-cook", &JOHNSON_COOK),
        ("modified-johnson-cook", &JOHNSON_COOK),
        ("zerilli-armstrong-bcc", &[65.0e6, 1033.0e6, 0.00698, 0.000415, 266.0e6, 0.289, 1e-3]),
        ("zerilli-armstrong-fcc", &[65.0e6, 890.0e6, 0.0028, 0.000115, 1e-3]),
        ("steinberg-guinan", &STEINBERG_GUINAN),
    ];
    const DAMAGES: [(&str, &[f64]); 7] = [
        ("failure-strain", &[0.2]),
        ("johnson-cook", &[0.05, 0.2, -1.5, 0.014, 1.12, 1.0, 298.0, 1356.0]),
        ("hancock-mackenzie", &[0.5, 1.5]),
        ("cockcroft-latham", &[60.0e6]),
        ("normalised-cockcroft-latham", &[0.2]),
        ("modified-mohr-coulomb", &[500.0e6, 0.2, 0.05, 290.0e6, 0.9]),
        ("principal-stress", &[300.0e6]),
    ];
    let yields = |entry: &&LawEntry<FlowLaw<f64>>| !["none", "elastic", "neo-hookean"].contains(&entry.key);
    assert_eq!(FLOW_LAWS.iter().filter(yields).map(|e| e.key).collect::<Vec<_>>(), STRENGTHS.map(|(key, _)| key));
    assert_eq!(DAMAGE_LAWS.iter().map(|e| e.key).collect::<Vec<_>>(), DAMAGES.map(|(key, _)| key));
    let mut materials: Vec<_> =
        STRENGTHS.iter().map(|law| material(("mie-gruneisen", &COPPER), *law, 46.0e9, f64::INFINITY)).collect();
    for (key, constants) in DAMAGES {
        let entry = DAMAGE_LAWS.iter().find(|entry| entry.key == key).unwrap();
        let damage = Damage {
            law: (entry.build)(constants),
            smallest_strain: 1e-3,
            softening: Softening::Share(0.1),
            after: AfterFailure::NoTension,
        };
        let whole = material(("mie-gruneisen", &COPPER), STRENGTHS[2], 46.0e9, f64::INFINITY);
        materials.push(Material { damage: Some(damage), ..whole });
    }
    let other_rule = materials[2].clone();
    materials.push(Material { return_rule: ReturnRule::BenzAsphaug, ..other_rule });
    materials
}

/// Integrity and history variables of a particle that has them all: damage, time of failure, energy, integrity.
const KEPT_BEFORE: [[f64; 4]; 4] =
    [[0.0, 0.0, 0.0, 1.0], [0.995, 0.0, 3.0, 1.0], [1.0, 0.0, 40.0, 0.6], [1.0, 2e-7, 90.0, 0.0]];

/// What is known of particles after a step, one row of numbers for each.
fn advanced(
    instructions: Instructions,
    materials: &[Material],
    source: TemperatureSource,
    particles: &[(usize, Particle)],
) -> Vec<Vec<f64>> {
    let column = |of: &dyn Fn(&Particle) -> f64| -> Vec<f64> { particles.iter().map(|(_, p)| of(p)).collect() };
    let step = StressStep {
        materials,
        temperature: source,
        only_flow_heats: source == TemperatureSource::PlasticWork,
        instructions,
        commit: true,
        slots: &materials.iter().map(|m| if m.breaks() { vec![0, 1, 2, 3] } else { Vec::new() }).collect::<Vec<_>>(),
        history_width: 4,
        cold_energies: &materials.iter().map(Material::cold_energies).collect::<Vec<_>>(),
        breaks: materials.iter().any(Material::breaks),
        support: 2.0,
        end: 1e-6,
    };
    let mut columns = StressColumns::new();
    columns.density[..particles.len()].copy_from_slice(&column(&|p| p.density));
    columns.energy[..particles.len()].copy_from_slice(&column(&|p| p.energy));
    let mut flow: [Vec<f64>; 5] = std::array::from_fn(|c| column(&|p| p.flow[c]));
    let [ep, dep, y, wp, t] = &mut flow;
    let mut history: Vec<f64> = particles.iter().flat_map(|(k, _)| KEPT_BEFORE[k % 4]).collect();
    let inputs = ElasticInputs {
        material: &particles.iter().map(|(_, p)| p.material).collect::<Vec<_>>(),
        deviator: &particles.iter().map(|(_, p)| p.deviator).collect::<Vec<_>>(),
        velocity_gradient: &particles.iter().map(|(_, p)| p.l).collect::<Vec<_>>(),
        deformation: &[],
        earlier_deformation: &[],
        smoothing_length: &vec![1e-3; particles.len()],
        dt: DT,
    };
    FlowColumns::new((ep, dep, y, wp, t, &mut history)).take_step(&step, &mut columns, &inputs);
    let row = |k: usize| {
        let stress = columns.deviator_of(k).to_array().into_iter().chain([columns.pressure[k]]);
        stress.chain(flow.iter().map(|column| column[k])).chain(history[4 * k..][..4].iter().copied()).collect()
    };
    (0..particles.len()).map(row).collect()
}

#[test]
fn lanes_follow_every_law_as_single_numbers_do_whatever_their_company() {
    let all = laws_on_lanes();
    for source in [TemperatureSource::PlasticWork, TemperatureSource::Energy] {
        // One law at a time, and all of them side by side.
        for chosen in (0..=all.len()).map(|m| all.get(m..m + 1).unwrap_or(&all)) {
            let block = |kept: &dyn Fn(usize) -> bool| -> Vec<(usize, Particle)> {
                let particles = (0..COUNT).filter(|k| kept(*k)).map(|k| (k, particle(chosen, chosen.len() > 1, k)));
                particles.filter(|(k, _)| *k != 40 && *k != 50).collect()
            };
            let particles = block(&|_| true);
            let one_by_one = advanced(Instructions::Scalar, chosen, source, &particles);
            let yielded = particles.iter().zip(&one_by_one).filter(|((_, p), after)| after[7] > p.flow[0]).count();
            assert!(yielded > COUNT / 4, "{yielded} of {COUNT} yield");
            for instructions in Instructions::available() {
                let together = advanced(instructions, chosen, source, &particles);
                for ((k, p), (got, want)) in particles.iter().zip(together.iter().zip(&one_by_one)) {
                    for (c, (got, want)) in got.iter().zip(want).enumerate() {
                        let size = if c < 7 { 1e9 } else { want.abs().max(1e-6) };
                        let law = chosen[p.material as usize].flow_law.key();
                        let near = (got - want).abs() <= 1e-11 * size || got == want;
                        assert!(near, "{instructions:?}, {law}, number {c} of {k}: {got:e} {want:e}");
                    }
                }
                // The same digits beside other particles, or alone.
                for kept in [&|k: usize| k % 3 == 1, &|k: usize| k == 16] as [&dyn Fn(usize) -> bool; 2] {
                    let fewer = block(kept);
                    for ((k, _), apart) in fewer.iter().zip(advanced(instructions, chosen, source, &fewer)) {
                        let place = particles.iter().position(|(other, _)| other == k).unwrap();
                        let bits = |row: &[f64]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                        assert_eq!(bits(&apart), bits(&together[place]), "{instructions:?}, {k}: {apart:?}");
                    }
                }
            }
        }
    }
}
