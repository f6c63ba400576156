//! Laws of the physics crate as functions of an array of numbers, with data that takes every branch of them.

use super::facets;
use crate::record::Recorded;
use sphorge_physics::eos::{BoundedPressure, ColdEnergy, EQUATIONS_OF_STATE, EquationOfState};
use sphorge_physics::flow::{FLOW_LAWS, FlowLaw, FlowState};
use sphorge_physics::hourglass::{Counted, Misfit, Spring, SpringSums, is_fit};
use sphorge_physics::hyperelastic::{composed, neo_hookean_deviator, neo_hookean_energy_of_stress};
use sphorge_physics::kernel::{Kernel, PairScale};
use sphorge_physics::kick::{KickAccount, KickAxis, earlier};
use sphorge_physics::moving_least_squares::Moments;
use sphorge_physics::return_mapping::{ReturnRule, return_mapping_near};
use sphorge_physics::tensor::transpose;
use sphorge_physics::total_lagrangian::MeetingPoint;
use sphorge_physics::viscosity::ViscosityParameters;
use sphorge_physics::wall::{FacePush, FacePushes};
use sphorge_physics::{
    Dimension, Elementary, SymmetricTensor, Tensor, artificial_stress, gradient_correction, heat, stress, time_step,
    total_lagrangian, viscosity, xsph,
};

/// From arguments to results.
type Call<T> = Box<dyn Fn(&[T]) -> Vec<T>>;

/// A law as a function of numbers.
pub(super) struct Law {
    pub(super) name: String,
    /// Lowest and highest value of each argument.
    pub(super) ranges: Vec<(f32, f32)>,
    pub(super) direct: Call<f32>,
    pub(super) recorded: Call<Recorded>,
    /// Branches and choices that no sample takes both ways: guards of what a run does not reach, and numbers that are known.
    pub(super) never: usize,
}

/// A law written once, for both numbers.
macro_rules! law {
    ($laws:ident, $name:expr, $ranges:expr, $never:expr, |$x:ident: &[$t:ident]| $body:expr) => {{
        fn of<$t: Elementary>($x: &[$t]) -> Vec<$t> {
            $body
        }
        $laws.push(Law {
            name: $name.to_owned(),
            ranges: $ranges.to_vec(),
            direct: Box::new(|x| of(x)),
            recorded: Box::new(|x| of(x)),
            never: $never,
        });
    }};
}

fn tensor<T: Copy>(x: &[T]) -> Tensor<T> {
    [[x[0], x[1], x[2]], [x[3], x[4], x[5]], [x[6], x[7], x[8]]]
}

fn symmetric<T: Copy>(x: &[T]) -> SymmetricTensor<T> {
    SymmetricTensor { xx: x[0], yy: x[1], zz: x[2], xy: x[3], yz: x[4], xz: x[5] }
}

fn flat<T: Copy>(t: &Tensor<T>) -> Vec<T> {
    t.as_flattened().to_vec()
}

/// Names and constants of one law of each kind, in SI units.
const FLOW: &[(&str, &[f64])] = &[
    ("none", &[]),
    ("elastic", &[]),
    ("perfectly-plastic", &[300e6]),
    ("bilinear", &[300e6, 200e9, 1e9]),
    ("johnson-cook", &[90e6, 292e6, 0.31, 0.025, 1.09, 1.0, 293.15, 1356.0]),
    ("modified-johnson-cook", &[490e6, 383e6, 0.45, 0.0114, 0.94, 5e-4, 293.0, 1800.0]),
    ("zerilli-armstrong-bcc", &[65e6, 1033e6, 0.00698, 0.000415, 266e6, 0.289, 1e-3]),
    ("zerilli-armstrong-fcc", &[65e6, 890e6, 0.0028, 0.000115, 1e-3]),
    ("steinberg-guinan", &[120e6, 640e6, 36.0, 0.45, 2.83e-11, 3.77e-4, 300.0, 1790.0, 2.02, 1.5, 0.0]),
];

const PRESSURE: &[(&str, &[f64])] = &[
    ("linear", &[8930.0, 3940.0]),
    ("mie-gruneisen", &[8930.0, 3940.0, 1.489, 2.02]),
    ("mie-gruneisen-polynomial", &[7850.0, 3630.0, 1.8, 1.5]),
];

fn flow(key: &str, values: &[f64]) -> FlowLaw<f64> {
    let entry = FLOW_LAWS.iter().find(|entry| entry.key == key).unwrap_or_else(|| panic!("no law `{key}`"));
    (entry.build)(values)
}

fn pressure(key: &str, values: &[f64]) -> EquationOfState<f64> {
    let entry = EQUATIONS_OF_STATE.iter().find(|entry| entry.key == key).unwrap_or_else(|| panic!("no law `{key}`"));
    (entry.build)(values)
}

fn coefficients<T: Elementary>(x: &[T], dimension: Dimension) -> Vec<T> {
    let moments = Moments { zeroth: x[0], first: [x[1], x[2], x[3]], second: symmetric(&x[4..]) };
    moments.coefficients(T::one(), dimension).to_vec()
}

fn yield_stress<T: Elementary>(law: &FlowLaw<f64>, x: &[T]) -> Vec<T> {
    let law = law.cast::<T>();
    let state = FlowState {
        plastic_strain: x[0],
        plastic_strain_rate: x[1],
        temperature: x[2],
        pressure: x[3],
        compression: x[4],
    };
    let y = law.yield_stress(state, &[]);
    vec![y.value, y.by_strain, y.by_rate, law.shear_modulus(T::of(48e9), state)]
}

fn returned<T: Elementary>(law: &FlowLaw<f64>, rule: ReturnRule, x: &[T]) -> Vec<T> {
    let trial = symmetric(x).deviator();
    let state = FlowState {
        plastic_strain: x[6],
        plastic_strain_rate: T::zero(),
        temperature: x[7],
        pressure: x[8],
        compression: T::one(),
    };
    let law = law.cast::<T>();
    let r = return_mapping_near(rule, &law, x[11], trial, state, &[], x[9], x[10]);
    let mut all = r.deviator.to_array().to_vec();
    all.extend([r.plastic_strain_increment, r.yield_stress, r.plastic_work]);
    all
}

fn bounded_pressure<T: Elementary>(law: &EquationOfState<f64>, x: &[T]) -> Vec<T> {
    let state = BoundedPressure::<T>::new(law, 385.0, 300.0).at(x[0], x[1]);
    vec![state.pressure, state.sound_speed]
}

fn shapes<T: Elementary>(kernel: Kernel, x: &[T]) -> Vec<T> {
    let scale = PairScale::new::<3>(T::of(kernel.normalisation(Dimension::Three)), x[1]);
    let (q, inverse_q) = scale.reduced_distance(x[0] * x[0]);
    vec![scale.value(kernel.w(q)), scale.f(kernel.dw_over_q(q)), scale.f(kernel.dw_over_q_by(q, inverse_q))]
}

/// What no return does: overflow the squares of a stress, and use up its iterations; a law that is held is not warmer than itself, and one
/// that does not harden is met by the first guess.
fn never_in_return(key: &str, rule: ReturnRule) -> usize {
    match (key, rule) {
        ("none" | "elastic", _) => 0,
        ("perfectly-plastic", ReturnRule::RadialReturn) => 4,
        ("johnson-cook" | "modified-johnson-cook", _) | ("perfectly-plastic", ReturnRule::BenzAsphaug) => 3,
        _ => 2,
    }
}

/// Every law.
pub(super) fn laws() -> Vec<Law> {
    let mut laws = Vec::new();
    for kernel in Kernel::ALL.iter().copied() {
        laws.push(Law {
            name: format!("kernel {}", kernel.key()),
            ranges: vec![(0.0, 4e-3), (0.8e-3, 1.2e-3)],
            direct: Box::new(move |x| shapes(kernel, x)),
            recorded: Box::new(move |x| shapes(kernel, x)),
            never: 0,
        });
    }
    for &(key, values) in PRESSURE {
        let law = pressure(key, values);
        laws.push(Law {
            name: format!("pressure {key}"),
            ranges: vec![(4000.0, 30_000.0), (-1e6, 4e6)],
            direct: Box::new(move |x| bounded_pressure(&law, x)),
            recorded: Box::new(move |x| bounded_pressure(&law, x)),
            never: 0,
        });
        laws.push(Law {
            name: format!("cold energy {key}"),
            ranges: vec![(6000.0, 14_000.0), (0.0, 1.0)],
            direct: Box::new(move |x| vec![ColdEnergy::new(&law, 2e9, 300.0, 385.0).at(x[0], x[1])]),
            recorded: Box::new(move |x| vec![ColdEnergy::new(&law, 2e9, 300.0, 385.0).at(x[0], x[1])]),
            never: 0,
        });
    }
    for &(key, values) in FLOW {
        let law = flow(key, values);
        laws.push(Law {
            name: format!("yield stress {key}"),
            ranges: vec![(-0.02, 2.0), (0.0, 1e5), (0.0, 2500.0), (-5e9, 5e10), (0.5, 1.5)],
            direct: Box::new(move |x| yield_stress(&law, x)),
            recorded: Box::new(move |x| yield_stress(&law, x)),
            never: 0,
        });
        for rule in [ReturnRule::RadialReturn, ReturnRule::BenzAsphaug] {
            let s = (-8e8, 8e8);
            laws.push(Law {
                name: format!("return mapping {key}, {}", rule.key()),
                ranges: vec![
                    s,
                    s,
                    s,
                    s,
                    s,
                    s,
                    (0.0, 3.0),
                    (250.0, 2500.0),
                    (-1e9, 1e10),
                    (0.0, 1e-7),
                    (0.0, 0.02),
                    (-1e9, 48e9),
                ],
                direct: Box::new(move |x| returned(&law, rule, x)),
                recorded: Box::new(move |x| returned(&law, rule, x)),
                never: never_in_return(key, rule),
            });
        }
    }
    let l = (-3e5, 3e5);
    let s = (-8e8, 8e8);
    let f = (-0.4, 1.2);
    for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
        let ranges = [&[(-0.1, 1.0)][..], &[(-0.3, 0.3); 3], &[(0.0, 0.4); 3], &[(-0.1, 0.1); 3]].concat();
        let name = format!("moving least squares, {}", dimension.count());
        let direct: Call<f32> = Box::new(move |x| coefficients(x, dimension));
        let recorded: Call<Recorded> = Box::new(move |x| coefficients(x, dimension));
        // On a line there is no determinant to be small.
        let never = usize::from(dimension == Dimension::One);
        laws.push(Law { name, ranges, direct, recorded, never });
    }
    law!(laws, "trial deviator", [s, s, s, s, s, s, l, l, l, l, l, l, l, l, l], 0, |x: &[T]| {
        stress::trial_deviator(symmetric(x), &tensor(&x[6..]), T::of(48e9), T::of(1e-7)).to_array().to_vec()
    });
    law!(laws, "density after a step", [l, l, l, l, l, l, l, l, l], 0, |x: &[T]| {
        let l = tensor(x);
        let dt = T::of(1e-7);
        vec![
            stress::density_after(T::of(8930.0), &l, dt),
            stress::predicted_density(T::of(8930.0), &l, dt * T::of(40.0)),
            stress::relative_density_change(&l, dt),
        ]
    });
    law!(laws, "artificial stress", [s, s, s, s, s, s, (0.1, 0.9)], 1, |x: &[T]| {
        let coefficient = artificial_stress::coefficient(T::of(0.3), x[6], 4);
        let [one, two, three] = [Dimension::One, Dimension::Two, Dimension::Three]
            .map(|dimension| artificial_stress::artificial_stress(symmetric(x), coefficient, dimension).to_array());
        [one, two, three, [artificial_stress::pair_factor(x[6], 4); 6]].concat()
    });
    law!(
        laws,
        "viscosity",
        [(-3.0, 3.0), (1e-7, 1e-5), (1000.0, 6000.0), l, l, l, l, l, l, l, l, l],
        0,
        |x: &[T]| {
            let p = ViscosityParameters { alpha: T::of(1.0), beta: T::of(2.0) };
            let h = T::of(1.2e-3);
            let mu = viscosity::viscosity_mu(x[0], x[1], h);
            let l = tensor(&x[3..]);
            let divergence = l[0][0] + l[1][1] + l[2][2];
            let switch = viscosity::balsara(&l, x[2], h);
            let pi = viscosity::viscous_pressure(p, mu, x[2], T::of(1.0 / 8930.0));
            let bulk = viscosity::bulk_viscosity(p, divergence, T::of(8930.0), x[2], h);
            let last = viscosity::FilteredDivergence { once: x[3], twice: x[4] };
            let (filtered, share) = last.after(divergence, T::of(1e-7), h / x[2]);
            let switched = viscosity::switched(pi, switch, T::of(0.5));
            vec![mu, pi, switch, switched, bulk, viscosity::bulk_mu(&l, h), filtered.once, filtered.twice, share]
        }
    );
    law!(
        laws,
        "total Lagrangian",
        [
            f,
            (-0.3, 0.3),
            (-0.3, 0.3),
            (-0.3, 0.3),
            f,
            (-0.3, 0.3),
            (-0.3, 0.3),
            (-0.3, 0.3),
            f,
            l,
            l,
            l,
            s,
            s,
            s,
            s,
            s,
            s
        ],
        // Deformations of no shear at all, of which the smallest and the largest stretch are asked.
        2,
        |x: &[T]| {
            let mut f = tensor(x);
            for a in 0..3 {
                f[a][a] += T::of(0.8);
            }
            let zero = T::zero();
            let rate = [[x[9], x[10], zero], [zero, x[11], zero], [x[10], zero, x[9]]];
            let l = total_lagrangian::deform(&mut f, &rate, T::of(1e-8));
            let mut all = flat(&l);
            all.extend(flat(&f));
            all.extend(flat(&total_lagrangian::first_piola(symmetric(&x[12..]), &f)));
            all.push(total_lagrangian::stretched(&f, T::of(1.6)));
            let stretch = total_lagrangian::smallest_stretch(&f);
            all.extend([total_lagrangian::density(T::of(1e-6), T::of(1e-10), &f), stretch]);
            all.push(total_lagrangian::limiting_length(T::of(1.2e-3), stretch));
            all
        }
    );
    law!(laws, "gradient correction", [(-0.2, 2.5), f, f, f, (-0.2, 2.5), f, f, f, (-0.2, 2.5)], 5, |x: &[T]| {
        let m = tensor(x);
        let both = [Dimension::Two, Dimension::Three]
            .map(|dimension| gradient_correction::gradient_correction(&m, dimension, T::of(3.0)));
        let fit = [(Dimension::Two, 0), (Dimension::Three, 1)].map(|(dimension, k)| is_fit(&m, &both[k], dimension));
        [flat(&both[0]), flat(&transpose(&both[1])), fit.to_vec()].concat()
    });
    law!(
        laws,
        "hourglass spring",
        [(-2e-3, 2e-3), (-2e-3, 2e-3), (-2e-3, 2e-3), (-1e-3, 1e-3), (-50.0, 50.0), f, f, f, (0.0, 9e8), (0.0, 2.0)],
        0,
        |x: &[T]| {
            let zero = T::zero();
            let f = [[T::one() + x[5], x[6], zero], [x[7], T::one(), zero], [zero, x[5], T::one()]];
            let initial = [x[0], x[1], x[2]];
            let now = [x[0] + x[3], x[1] * T::of(1.2), x[2] - x[3]];
            let misfit = Misfit::of::<3>(&initial, &now, &f, &transpose(&f));
            let spring = Spring::new(Counted::LINEAR, T::of(1.2), T::of(120e9), x[8], x[9], T::of(0.3));
            let stiffness = spring.at(misfit.initial2);
            let mut sums = SpringSums::zero();
            let push = misfit.push::<3>(stiffness, spring.stiffness);
            sums.add::<3>(&misfit, &push, &[x[4], x[4], zero], T::of(2e5));
            let held = spring.energy(sums.misfit2, Dimension::Three);
            [&push[..], &sums.acceleration, &[sums.energy_rate(stiffness), sums.misfit2, held], &flat(&sums.moment)]
                .concat()
        }
    );
    let g = (-0.15, 0.2);
    law!(laws, "neo-Hookean solid", [g, g, g, g, g, g, g, g, g, (1e6, 8e10)], 0, |x: &[T]| {
        let h = tensor(x);
        let s = neo_hookean_deviator(&h, x[9]);
        let twice = neo_hookean_deviator(&composed(&h, &transpose(&h)), x[9]);
        let stored = [neo_hookean_energy_of_stress(s, T::of(1.1), x[9])];
        [&s.to_array()[..], &twice.to_array(), &stored].concat()
    });
    law!(
        laws,
        "walls at faces and kicks",
        [f, f, f, f, f, f, l, l, (-200.0, 200.0), (-200.0, 200.0), (-1e9, 1e9), (0.0, 1e6)],
        0,
        |x: &[T]| {
            let (zero, one) = (T::zero(), T::one());
            let f = [[one + x[0], x[1], zero], [x[2], one, x[3]], [zero, x[4], one + x[5]]];
            let l = [[x[6], zero, x[7]], [zero, x[7], zero], [x[6], zero, zero]];
            let (velocity, normal) = ([x[8], x[9], zero], [T::of(0.6), zero, T::of(0.8)]);
            let at = MeetingPoint::new(T::of(1e-3), &f, &l, velocity, normal);
            let acceleration = normal.map(|n| n * x[10]);
            let push = FacePush { acceleration, heat: x[11], rubbed: zero, face: at.place, velocity: at.velocity };
            let mut pushes = FacePushes::of_gravity([zero, x[11], zero]);
            let power = pushes.add(&push, velocity);
            let stress = pushes.stress(T::of(9e-6), T::of(1e-9));
            let tensor = total_lagrangian::force_tensor(SymmetricTensor::isotropic(x[10]), &f, &stress, &l);
            let mut account = KickAccount::zero();
            for k in 0..3 {
                let axis = KickAxis { pair: x[10], mean: x[8], ahead: x[9], beyond: pushes.acceleration[k] };
                account.add(k, &axis, T::of(9e-6), T::of(1e-8));
            }
            let mut all =
                vec![at.radius, power, pushes.beyond, account.energy, account.work, earlier(x[8], x[9], x[0])];
            all.extend([pushes.acceleration, account.impulse].concat());
            all.extend(flat(&tensor));
            all
        }
    );
    law!(laws, "contact of facets", facets::RANGES, 86, |x: &[T]| facets::pair(x));
    law!(laws, "friction of facets", facets::RANGES, 64, |x: &[T]| facets::slip(x));
    law!(
        laws,
        "heat, XSPH and time step",
        [s, s, s, s, s, s, (-1.0, 1e11), (1e-4, 1e-3), (1.0, 1e9), (0.0, 40.0)],
        0,
        |x: &[T]| {
            let rho = T::of(8930.0);
            let rise = heat::temperature_rise_from_plastic_work(T::of(0.9), x[8], rho, T::of(385.0));
            let elastic = heat::elastic_energy(symmetric(x), x[6], rho);
            let temperature =
                heat::temperature_from_energy(T::of(300.0), x[8], T::of(10.0), T::of(0.0), T::of(0.0), T::of(385.0));
            let speed = time_step::longitudinal_speed(T::of(3940.0), x[6].max(T::zero()), rho);
            let limits = [
                time_step::sound_limit(x[7], speed, x[9], T::of(0.3)),
                time_step::acceleration_limit(x[7], x[8], T::of(0.25)),
            ];
            let mut smoothing = [x[0], x[1], x[2]];
            let weight = xsph::xsph_weight(x[7], T::of(2.0), T::of(1e-4));
            xsph::add_xsph::<T, 3>(&mut smoothing, &[x[3], x[4], x[5]], weight);
            [vec![rise, elastic, temperature, speed], limits.to_vec(), smoothing.to_vec()].concat()
        }
    );
    laws
}

/// Arguments of a law: the corners of its ranges, and values spread over them, zero among them where it is inside.
pub(super) fn samples(ranges: &[(f32, f32)], count: usize) -> Vec<Vec<f32>> {
    // A generator of Lehmer: the samples are the same in every run.
    let mut state = 48_271_u64;
    let mut random = move || {
        state = state * 48_271 % 2_147_483_647;
        state as f32 / 2_147_483_647.0
    };
    let mut sample = |k: usize| -> Vec<f32> {
        let value = |(low, high): &(f32, f32)| {
            let (choice, place) = (random(), random());
            match k % 8 {
                0 if choice < 0.2 => *low,
                0 if choice < 0.4 => *high,
                1 if choice < 0.3 && *low <= 0.0 && *high >= 0.0 => 0.0,
                // Near zero, or near the lower end.
                2 => low.max(0.0) + (high - low.max(0.0)) * place * place * place * place,
                3 => 0.5 * (low + high) + 1e-3 * (high - low) * (place - 0.5),
                _ => low + (high - low) * place,
            }
        };
        ranges.iter().map(value).collect()
    };
    (0..count).map(&mut sample).collect()
}
