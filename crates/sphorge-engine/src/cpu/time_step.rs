//! Limits of the next time step.

use super::constitutive::shear_modulus_of;
use crate::lanes::{Instructions, Job, Lanes, run};
use crate::model::{Model, WallContact};
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use crate::{LimitReason, TimeStepLimit};
use rayon::prelude::*;
use sphorge_physics::time_step::{acceleration_limit, longitudinal_speed, penalty_limit, sound_limit};
use sphorge_physics::total_lagrangian::limiting_length;

/// Input of the limits of a block, a column for each quantity; entries without a particle do not limit the step.
struct Columns {
    smoothing_length: [f64; BLOCK],
    sound_speed: [f64; BLOCK],
    density: [f64; BLOCK],
    shear_modulus: [f64; BLOCK],
    mu: [f64; BLOCK],
    /// Square of the acceleration, m²/s⁴.
    acceleration: [f64; BLOCK],
}

/// The smallest limits of a block by sound speed and by acceleration, s.
struct LimitJob<'a> {
    columns: &'a Columns,
    courant: f64,
    limits: &'a mut (f64, f64),
}

impl Job<f64> for LimitJob<'_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        let columns = self.columns;
        let courant = L::splat(self.courant);
        let (mut by_sound, mut by_acceleration) = (L::splat(f64::INFINITY), L::splat(f64::INFINITY));
        for k in (0..BLOCK).step_by(L::WIDTH) {
            let h = L::load(&columns.smoothing_length[k..]);
            let (c, rho) = (L::load(&columns.sound_speed[k..]), L::load(&columns.density[k..]));
            let speed = longitudinal_speed(c, L::load(&columns.shear_modulus[k..]), rho);
            // `min` returns the second if the first is not a number.
            by_sound = sound_limit(h, speed, L::load(&columns.mu[k..]), courant).min(by_sound);
            let acceleration = L::load(&columns.acceleration[k..]).sqrt();
            by_acceleration = acceleration_limit(h, acceleration, courant).min(by_acceleration);
        }
        *self.limits = (-(-by_sound).largest(), -(-by_acceleration).largest());
    }
}

/// The smallest limits of the particles of block `b`, s.
fn limits_of_block(model: &Model, p: &Particles, instructions: Instructions, b: usize) -> (f64, f64) {
    let mut columns = Columns {
        smoothing_length: [f64::INFINITY; BLOCK],
        sound_speed: [1.0; BLOCK],
        density: [1.0; BLOCK],
        shear_modulus: [0.0; BLOCK],
        mu: [0.0; BLOCK],
        acceleration: [1.0; BLOCK],
    };
    let particles = b * BLOCK..((b + 1) * BLOCK).min(p.len());
    let count = particles.len();
    columns.smoothing_length[..count].copy_from_slice(&p.smoothing_length[particles.clone()]);
    for (h, stretch) in
        columns.smoothing_length.iter_mut().zip(p.smallest_stretch.get(particles.clone()).unwrap_or(&[]))
    {
        *h = limiting_length(*h, *stretch);
    }
    columns.sound_speed[..count].copy_from_slice(&p.sound_speed[particles.clone()]);
    columns.density[..count].copy_from_slice(&p.density[particles.clone()]);
    columns.mu[..count].copy_from_slice(&p.mu[particles.clone()]);
    for (k, (material, a)) in p.material[particles.clone()].iter().zip(&p.acceleration[particles]).enumerate() {
        columns.shear_modulus[k] = shear_modulus_of(&model.materials[*material as usize], p, b * BLOCK + k);
        columns.acceleration[k] = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
    }
    let mut limits = (f64::INFINITY, f64::INFINITY);
    run(instructions, LimitJob { columns: &columns, courant: model.time.courant, limits: &mut limits });
    let damped =
        p.damping_rate.get(b * BLOCK..b * BLOCK + count).unwrap_or(&[]).iter().fold(0.0, |a: f64, b| a.max(*b));
    (limits.0.min(model.time.share_of_damping() / damped), limits.1)
}

/// The smallest limit of all particles, walls and contacts; `contact` is the limit of the contact between bodies, s.
pub(super) fn limit(model: &Model, p: &Particles, contact: Option<f64>, instructions: Instructions) -> TimeStepLimit {
    let courant = model.time.courant_of_contacts();
    let of_block = |b| limits_of_block(model, p, instructions, b);
    // A minimum does not depend on the order.
    let (by_sound, by_acceleration) = (0..p.len().div_ceil(BLOCK))
        .into_par_iter()
        .map(of_block)
        .reduce(|| (f64::INFINITY, f64::INFINITY), |a, b| (a.0.min(b.0), a.1.min(b.1)));
    let particles = TimeStepLimit { dt: by_sound, reason: LimitReason::SoundSpeed }
        .min(TimeStepLimit { dt: by_acceleration, reason: LimitReason::Acceleration });
    let contact = contact.map(|limit| TimeStepLimit { dt: courant * limit, reason: LimitReason::Contact });
    model.walls.iter().filter_map(|w| wall_limit(model, &w.contact)).chain(contact).fold(particles, TimeStepLimit::min)
}

/// The limit of heat conduction from its largest stable step, s.
pub(super) fn conduction_limit(model: &Model, limit: Option<f64>) -> TimeStepLimit {
    TimeStepLimit { dt: model.time.courant * limit.unwrap_or(f64::INFINITY), reason: LimitReason::Conduction }
}

/// Step that resolves the contact spring of a penalty wall, for the body with the highest frequency.
fn wall_limit(model: &Model, contact: &WallContact) -> Option<TimeStepLimit> {
    let WallContact::Penalty { stiffness, .. } = *contact else { return None };
    let fastest = model
        .bodies
        .iter()
        .map(|b| model.materials[b.material].equation_of_state.reference_sound_speed() / b.spacing)
        .fold(0.0, f64::max);
    Some(TimeStepLimit {
        dt: penalty_limit(stiffness, fastest, model.time.courant_of_contacts()),
        reason: LimitReason::Contact,
    })
}
