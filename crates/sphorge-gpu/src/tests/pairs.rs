//! The pair loop of a step: neighbours gathered from lists, and given to the formulas of the physics crate.

use crate::evaluate::{Evaluation, whole};
use crate::record::{Index, Input, Kernel, KernelFault, Recorded};
use sphorge_physics::kernel::{KernelShape, PairScale, WendlandC2, pair_smoothing_length};
use sphorge_physics::pair::{
    EnergySplit, ForceSums, GradientSums, PairForce, PairForm, closing_power, inverse_density_mean, mean,
    scaled_pressure, stress_vector,
};
use sphorge_physics::viscosity::{ViscosityParameters, viscosity_mu, viscous_pressure};
use sphorge_physics::{Dimension, Real, SymmetricTensor, Vector};

/// Numbers of a particle: place 0 to 2, velocity 3 to 5, mass 6, density 7, smoothing length 8, sound speed 9, stress 10 to 15.
const FIELDS: usize = 16;

/// Sums of a particle: velocity gradient 9, acceleration 3, energy rate 1, `mu` 1.
const SUMS: usize = 16;

/// A particle, in numbers of either kind.
struct Particle<T> {
    x: Vector<T>,
    v: Vector<T>,
    mass: T,
    density: T,
    h: T,
    sound_speed: T,
    stress: SymmetricTensor<T>,
}

impl<T: Real> Particle<T> {
    fn of(field: impl Fn(usize) -> T) -> Self {
        Self {
            x: [0, 1, 2].map(&field),
            v: [3, 4, 5].map(&field),
            mass: field(6),
            density: field(7),
            h: field(8),
            sound_speed: field(9),
            stress: SymmetricTensor::from_array([10, 11, 12, 13, 14, 15].map(&field)),
        }
    }
}

/// The sums of one particle and one neighbour more.
fn add<T: Real>(sums: [T; SUMS], i: &Particle<T>, j: &Particle<T>) -> [T; SUMS] {
    let minus = |a: Vector<T>, b: Vector<T>| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let (x, v) = (minus(i.x, j.x), minus(i.v, j.v));
    let dot = |a: Vector<T>, b: Vector<T>| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (r2, v_dot_x) = (dot(x, x), dot(v, x));
    let sigma = T::of(WendlandC2::normalisation(Dimension::Three));
    let scale = PairScale::new::<3>(sigma, pair_smoothing_length(i.h, j.h));
    let (q, inverse_q) = scale.reduced_distance(r2);
    let weighted_f = scale.weighted(j.mass / j.density).f(WendlandC2::dw_over_q_by(q, inverse_q));

    let mut gradients = GradientSums {
        gradient: [[sums[0], sums[1], sums[2]], [sums[3], sums[4], sums[5]], [sums[6], sums[7], sums[8]]],
        ..GradientSums::zero()
    };
    gradients.add::<3, false>(&x, &v.map(|c| -c), weighted_f);
    let mu = viscosity_mu(v_dot_x, r2, scale.h);
    let viscosity = ViscosityParameters { alpha: T::of(1.0), beta: T::of(2.0) };
    let pi =
        viscous_pressure(viscosity, mu, mean(i.sound_speed, j.sound_speed), inverse_density_mean(i.density, j.density));
    let mut forces = ForceSums {
        acceleration: [sums[9], sums[10], sums[11]],
        stress_power: sums[12],
        viscous_power: sums[13],
        repulsive_power: sums[14],
    };
    let pair = PairForce {
        x,
        v,
        own_stress: stress_vector::<T, 3>(&i.stress, &x),
        other_stress: stress_vector::<T, 3>(&j.stress, &x),
        // Any vector will do.
        artificial_stress: stress_vector::<T, 3>(&i.stress, &v),
        pi: scaled_pressure(PairForm::VolumeWeighted, pi, i.density, j.density),
        weighted_f,
        closing_power: closing_power(v_dot_x, weighted_f),
    };
    forces.add::<3>(EnergySplit::OwnStress, &pair);
    let mut all = [T::zero(); SUMS];
    all[..9].copy_from_slice(gradients.gradient.as_flattened());
    all[9..12].copy_from_slice(&forces.acceleration);
    all[12] = forces.stress_power;
    all[13] = forces.viscous_power;
    all[14] = forces.repulsive_power;
    all[15] = sums[15].max(mu.abs());
    all
}

/// The sums of a thread's particle over its list.
pub(super) fn kernel(count: usize) -> Result<Kernel, KernelFault> {
    Kernel::record("pairs", |scope| {
        let fields = scope.input("fields");
        let (first, neighbors) = (scope.indices("first"), scope.indices("neighbors"));
        let sums = scope.output("sums");
        let i = scope.thread();
        let particle = |of: Index| Particle::of(|field| at(fields, field, count, of));
        let own = particle(i);
        let zero = [Recorded::zero(); SUMS];
        let total = scope.fold(first.at(i), first.at(i + Index::of(1)), zero, |_, total, k| {
            add(total, &own, &particle(neighbors.at(k)))
        });
        for (k, number) in total.into_iter().enumerate() {
            sums.set(Index::of((k * count) as u32) + i, number);
        }
    })
}

fn at(fields: Input, field: usize, count: usize, i: Index) -> Recorded {
    fields.at(Index::of((field * count) as u32) + i)
}

/// A block of particles off their lattice, their lists, and their sums on this processor.
pub(super) struct Block {
    pub(super) count: usize,
    pub(super) fields: Vec<f32>,
    pub(super) first: Vec<u32>,
    pub(super) neighbors: Vec<u32>,
    pub(super) sums: Vec<f32>,
}

impl Block {
    pub(super) fn new(edge: usize) -> Self {
        let (spacing, count) = (1e-3f32, edge * edge * edge);
        let mut fields = vec![0.0; FIELDS * count];
        for i in 0..count {
            let wave = |k: usize| ((i * (k + 3)) as f32 * 0.7 + k as f32).sin();
            let place = [i % edge, i / edge % edge, i / edge / edge];
            for k in 0..FIELDS {
                fields[k * count + i] = match k {
                    0..3 => spacing * (place[k] as f32 + 0.2 * wave(k)),
                    3..6 => 50.0 * wave(k),
                    6 => 8.9e-6,
                    7 => 8900.0 * (1.0 + 0.05 * wave(k)),
                    8 => 1.2e-3 * (1.0 + 0.05 * wave(k)),
                    9 => 4000.0 + 100.0 * wave(k),
                    _ => 1e9 * wave(k),
                };
            }
        }
        let particle = |i: usize| Particle::of(|field| fields[field * count + i]);
        let reach = 2.0 * 1.3e-3f32;
        let (mut first, mut neighbors) = (vec![0], Vec::new());
        let mut sums = vec![0.0; SUMS * count];
        for i in 0..count {
            let own = particle(i);
            let mut total = [0.0; SUMS];
            for j in (0..count).filter(|j| *j != i) {
                let other = particle(j);
                let r2: f32 = (0..3).map(|a| (own.x[a] - other.x[a]).powi(2)).sum();
                if r2 < reach * reach {
                    neighbors.push(j as u32);
                    total = add(total, &own, &other);
                }
            }
            first.push(neighbors.len() as u32);
            for (k, number) in total.into_iter().enumerate() {
                sums[k * count + i] = number;
            }
        }
        Self { count, fields, first, neighbors, sums }
    }
}

#[test]
fn the_pair_loop_matches_the_cpu_to_the_bit() {
    let block = Block::new(7);
    assert!(block.neighbors.len() > 30 * block.count);
    let kernel = kernel(block.count).unwrap();
    let mut buffers = [block.fields.clone(), whole(&block.first), whole(&block.neighbors), vec![0.0; block.sums.len()]];
    Evaluation::default().run(&kernel, &mut buffers, block.count as u32);
    let differing = buffers[3].iter().zip(&block.sums).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    assert_eq!(differing, 0);
    // Not nothing: the sums are of the size of the forces of a wave.
    assert!(block.sums[9 * block.count..12 * block.count].iter().any(|a| a.abs() > 1e6));
}
