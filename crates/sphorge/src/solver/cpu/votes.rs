//! How large the next step may be.

use crate::model::{Model, WallContact};
use crate::particles::Particles;
use crate::solver::{Vote, VoteReason};
use rayon::prelude::*;
use sphorge_physics::time_step::{acceleration_vote, longitudinal_speed, sound_vote};

/// The smallest vote of all particles, walls and contacts; `contact` is the limit of the contact between bodies, s.
pub(super) fn vote(model: &Model, p: &Particles, mu: &[f64], contact: Option<f64>) -> Vote {
    let courant = model.time.courant;
    let of_particle = |i: usize| {
        let h = p.smoothing_length[i];
        let g = model.materials[p.material[i] as usize].shear_modulus;
        let speed = longitudinal_speed(p.sound_speed[i], g, p.density[i]);
        let a = p.acceleration[i].iter().map(|v| v * v).sum::<f64>().sqrt();
        let sound = sound_vote(h, speed, mu[i], courant);
        let acceleration = acceleration_vote(h, a, courant);
        if acceleration < sound {
            Vote { dt: acceleration, reason: VoteReason::Acceleration }
        } else {
            Vote { dt: sound, reason: VoteReason::SoundSpeed }
        }
    };
    let none = Vote { dt: f64::INFINITY, reason: VoteReason::SoundSpeed };
    // A minimum does not depend on the order it is taken in.
    let particles = (0..p.len()).into_par_iter().with_min_len(1024).map(of_particle).reduce(|| none, smaller);
    let contact = contact.map(|limit| Vote { dt: courant * limit, reason: VoteReason::Contact });
    model.walls.iter().filter_map(|w| contact_vote(model, &w.contact)).chain(contact).fold(particles, smaller)
}

/// The vote of conduction, whose limit is given, s.
pub(super) fn conduction_vote(model: &Model, limit: Option<f64>) -> Vote {
    Vote { dt: model.time.courant * limit.unwrap_or(f64::INFINITY), reason: VoteReason::Conduction }
}

/// The smaller of two votes, the first of equals.
pub(super) fn smaller(a: Vote, b: Vote) -> Vote {
    if b.dt < a.dt { b } else { a }
}

/// Step that resolves the contact spring of a penalty wall: the Courant share of `2 / omega`.
fn contact_vote(model: &Model, contact: &WallContact) -> Option<Vote> {
    let WallContact::Penalty { stiffness, .. } = *contact else { return None };
    let fastest = model
        .bodies
        .iter()
        .map(|b| model.materials[b.material].equation_of_state.reference_sound_speed() / b.spacing)
        .fold(0.0, f64::max);
    Some(Vote { dt: model.time.courant * 2.0 / (stiffness.sqrt() * fastest), reason: VoteReason::Contact })
}
