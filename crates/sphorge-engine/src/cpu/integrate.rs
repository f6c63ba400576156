//! Kick-drift-kick leapfrog and Monaghan's predictor–corrector.
//!
//! The energy correction of a kick, which closes the balance for any sequence of steps, is in
//! [`sphorge_physics::kick`].

use super::CpuEngine;
use super::domain::Domain;
use crate::RunFailure;
use crate::drive::Driven;
use crate::lanes::PairScalar;
use crate::model::Model;
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use crate::persist::Fixed;
use rayon::prelude::*;
use sphorge_physics::Vector;
use sphorge_physics::kick::{KickAccount, KickAxis};

/// Prescribed velocities at one time, by motion and axis.
#[derive(Clone, Debug, Default)]
pub(super) struct Motions {
    velocity: Vec<[Option<f64>; 3]>,
}

impl Motions {
    pub(super) fn new(model: &Model) -> Self {
        Self { velocity: vec![[None; 3]; model.motions.len()] }
    }

    /// Motion of every particle, by index plus one.
    pub(super) fn assign(model: &Model, particles: &Particles) -> Vec<u32> {
        particles.regions.iter().map(|regions| model.motion_of(*regions).map_or(0, |k| k as u32 + 1)).collect()
    }

    /// Evaluates the time tables, unless a program gives the velocities.
    pub(super) fn set_time(&mut self, model: &Model, driven: Option<&Driven>, time: f64) {
        for (k, (velocity, motion)) in self.velocity.iter_mut().zip(&model.motions).enumerate() {
            if let Some(given) = driven.and_then(|driven| driven.velocities[k]) {
                *velocity = given;
                continue;
            }
            for (value, axis) in velocity.iter_mut().zip(&motion.axes) {
                *value = axis.velocity(time);
            }
        }
    }

    /// Prescribed components for a particle.
    #[inline(always)]
    pub(super) fn of(&self, motion: u32) -> [Option<f64>; 3] {
        if motion == 0 { [None; 3] } else { self.velocity[motion as usize - 1] }
    }

    #[inline(always)]
    fn hold(&self, motion: u32, v: &mut Vector<f64>) {
        if motion != 0 {
            for (v, prescribed) in v.iter_mut().zip(self.of(motion)) {
                *v = prescribed.unwrap_or(*v);
            }
        }
    }
}

/// Effect of a kick and a drift on a block.
#[derive(Clone, Copy, Debug, Default)]
struct Moved {
    /// Work of all forces that are not pair forces, J, and their impulse, N s.
    work: f64,
    impulse: Vector<f64>,
    /// Part of that work by loads of a program, J.
    load_work: f64,
    /// Correction of the internal energy that closes the balance, J.
    booked: f64,
    /// Square of the largest displacement of a particle, m².
    farthest: f64,
}

impl Fixed for Moved {
    const SIZE: usize = <[f64; 7]>::SIZE;
    fn write(&self, out: &mut Vec<u8>) {
        let [x, y, z] = self.impulse;
        [self.work, x, y, z, self.load_work, self.booked, self.farthest].write(out);
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        let [work, x, y, z, load_work, booked, farthest] = Fixed::read(bytes)?;
        Some(Self { work, impulse: [x, y, z], load_work, booked, farthest })
    }
}

/// Work and impulse of all forces that are not pair forces, block by block so that the sum does not depend on threads.
#[derive(Clone, Debug, Default)]
pub(super) struct ExternalSums {
    partial: Vec<Moved>,
    /// Work since the start, J.
    pub(super) work: f64,
    /// Impulse since the start, N s.
    pub(super) impulse: Vector<f64>,
    /// Part of the work by loads of a program since the start, J.
    pub(super) load_work: f64,
    /// Correction of the internal energy since the start, J.
    pub(super) booked: f64,
}

impl ExternalSums {
    pub(super) fn new(count: usize) -> Self {
        Self { partial: vec![Moved::default(); count.div_ceil(BLOCK)], ..Self::default() }
    }

    /// Allocates memory for other particles, before a step has summed anything.
    pub(super) fn resize(&mut self, count: usize) {
        self.partial.resize(count.div_ceil(BLOCK), Moved::default());
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Moved>() * self.partial.capacity()
    }

    /// Adds up the blocks, over all ranks if there are several; returns the largest displacement of any particle, m.
    fn close(&mut self, domain: Option<&Domain>) -> Result<f64, RunFailure> {
        let all = domain.map(|domain| domain.gather_blocks(&self.partial, 1)).transpose()?;
        let mut farthest = 0.0_f64;
        for moved in all.as_ref().unwrap_or(&self.partial) {
            self.work += moved.work;
            self.load_work += moved.load_work;
            self.booked += moved.booked;
            for a in 0..3 {
                self.impulse[a] += moved.impulse[a];
            }
            farthest = farthest.max(moved.farthest);
        }
        Ok(farthest.sqrt())
    }
}

/// One kick of one particle: new velocity, correction of the specific internal energy, and the external share.
struct Kick {
    velocity: Vector<f64>,
    energy: f64,
    work: f64,
    impulse: Vector<f64>,
    /// The correction of the whole particle, J.
    booked: f64,
}

/// Changes `v` by `a dt`, then imposes prescribed components. `external` is the part of `a` that is not due to pair
/// forces.
#[inline(always)]
fn kick(
    v: Vector<f64>,
    a: Vector<f64>,
    external: Vector<f64>,
    evaluated: Vector<f64>,
    mass: f64,
    dt: f64,
    motions: &Motions,
    motion: u32,
) -> Kick {
    let mut after = [0, 1, 2].map(|k| v[k] + dt * a[k]);
    motions.hold(motion, &mut after);
    let mut account = KickAccount::zero();
    for k in 0..3 {
        let pair = a[k] - external[k];
        let mean = 0.5 * (v[k] + after[k]);
        // Change of velocity minus that by pair forces.
        let beyond = after[k] - v[k] - pair * dt;
        account.add(k, &KickAxis { pair, mean, ahead: mean - evaluated[k], beyond }, mass, dt);
    }
    let KickAccount { energy, work, impulse } = account;
    Kick { velocity: after, energy, work, impulse, booked: mass * energy }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Integrates the powers of the last forces over a time `dt`, s, as the kicks do: works of contacts and walls, of
    /// viscosity, artificial stress and hourglass springs.
    fn book_rates(&mut self, dt: f64) -> Result<(), RunFailure> {
        if let Some(contacts) = &mut self.contacts {
            contacts.book(dt);
        }
        self.book_walls(dt)?;
        self.numerical_work.book(dt);
        let Particles { artificial_energy, artificial_power, .. } = &mut self.particles;
        let columns = artificial_energy.par_iter_mut().with_min_len(BLOCK).zip(&*artificial_power);
        columns.for_each(|(energy, power)| *energy += dt * power);
        Ok(())
    }

    /// First half kick, drift, and the velocity at which forces are evaluated: that of the end of the step, predicted
    /// with the last acceleration. All in one pass, because the data do not fit in the caches.
    pub(super) fn leapfrog_begin(&mut self) -> Result<(), RunFailure> {
        let dt = self.step.dt;
        let half = 0.5 * dt;
        self.book_rates(half)?;
        self.motions.set_time(&self.model, self.driven.as_ref(), self.step.time + half);
        self.motions_at_end.set_time(&self.model, self.driven.as_ref(), self.step.time + dt);
        let Particles {
            position,
            velocity,
            energy,
            acceleration,
            energy_rate,
            mass,
            xsph,
            external_acceleration,
            evaluated_velocity,
            motion,
            body,
            ..
        } = &mut self.particles;
        let (acceleration, energy_rate, mass, body) = (&*acceleration, &*energy_rate, &*mass, &*body);
        let (xsph, external_acceleration, motion) = (&*xsph, &*external_acceleration, &*motion);
        let driven = self.driven.as_ref();
        let (motions, at_end) = (&self.motions, &self.motions_at_end);
        (
            position.par_chunks_mut(BLOCK),
            velocity.par_chunks_mut(BLOCK),
            energy.par_chunks_mut(BLOCK),
            evaluated_velocity.par_chunks_mut(BLOCK),
            self.external.partial.par_iter_mut(),
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(b, (x, v, e, evaluated, partial))| {
                *partial = Moved::default();
                for k in 0..x.len() {
                    let i = b * BLOCK + k;
                    let (a, external) = (acceleration[i], external_acceleration[i]);
                    let kicked = kick(v[k], a, external, evaluated[k], mass[i], half, motions, motion[i]);
                    if let Some(driven) = driven {
                        let load = driven.of_body(body[i] as usize);
                        partial.load_work += work_of_load(load, mass[i], v[k], kicked.velocity, half);
                    }
                    v[k] = kicked.velocity;
                    e[k] += half * energy_rate[i] + kicked.energy;
                    add(partial, &kicked);
                    let way = drift(&mut x[k], v[k], xsph[i], motions.of(motion[i]), dt);
                    partial.farthest = partial.farthest.max(way);
                    evaluated[k] = [0, 1, 2].map(|c| v[k][c] + half * a[c]);
                    at_end.hold(motion[i], &mut evaluated[k]);
                }
            });
        self.lists.displacement.advance(self.external.close(self.domain.as_ref())?);
        std::mem::swap(&mut self.motions, &mut self.motions_at_end);
        Ok(())
    }

    /// Second half kick.
    pub(super) fn leapfrog_finish(&mut self) -> Result<(), RunFailure> {
        let half = 0.5 * self.step.dt;
        self.book_rates(half)?;
        self.motions.set_time(&self.model, self.driven.as_ref(), self.step.time + self.step.dt);
        let Particles {
            velocity,
            energy,
            acceleration,
            energy_rate,
            mass,
            external_acceleration,
            evaluated_velocity,
            motion,
            body,
            ..
        } = &mut self.particles;
        let (acceleration, energy_rate, mass, body) = (&*acceleration, &*energy_rate, &*mass, &*body);
        let (external_acceleration, evaluated_velocity, motion) =
            (&*external_acceleration, &*evaluated_velocity, &*motion);
        let (motions, driven) = (&self.motions, self.driven.as_ref());
        (velocity.par_chunks_mut(BLOCK), energy.par_chunks_mut(BLOCK), self.external.partial.par_iter_mut())
            .into_par_iter()
            .enumerate()
            .for_each(|(b, (v, e, partial))| {
                *partial = Moved::default();
                for k in 0..v.len() {
                    let i = b * BLOCK + k;
                    let (a, external, evaluated) = (acceleration[i], external_acceleration[i], evaluated_velocity[i]);
                    let kicked = kick(v[k], a, external, evaluated, mass[i], half, motions, motion[i]);
                    if let Some(driven) = driven {
                        let load = driven.of_body(body[i] as usize);
                        partial.load_work += work_of_load(load, mass[i], v[k], kicked.velocity, half);
                    }
                    v[k] = kicked.velocity;
                    e[k] += half * energy_rate[i] + kicked.energy;
                    add(partial, &kicked);
                }
            });
        self.external.close(self.domain.as_ref())?;
        Ok(())
    }

    /// State at mid-step, predicted with the last rates.
    pub(super) fn predict(&mut self) {
        let half = 0.5 * self.step.dt;
        // This mid-step state is temporary; displacements are checked every time.
        self.lists.displacement.lose_track();
        self.motions.set_time(&self.model, self.driven.as_ref(), self.step.time + half);
        let p = &mut self.particles;
        p.base_position.copy_from_slice(&p.position);
        p.base_velocity.copy_from_slice(&p.velocity);
        p.base_density.copy_from_slice(&p.density);
        let Particles { position, velocity, acceleration, xsph, motion, evaluated_velocity, .. } = p;
        let (acceleration, xsph, motion) = (&*acceleration, &*xsph, &*motion);
        let motions = &self.motions;
        (position.par_chunks_mut(BLOCK), velocity.par_chunks_mut(BLOCK), evaluated_velocity.par_chunks_mut(BLOCK))
            .into_par_iter()
            .enumerate()
            .for_each(|(b, (x, v, evaluated))| {
                for k in 0..x.len() {
                    let i = b * BLOCK + k;
                    drift(&mut x[k], v[k], xsph[i], motions.of(motion[i]), half);
                    for a in 0..3 {
                        v[k][a] += half * acceleration[i][a];
                    }
                    motions.hold(motion[i], &mut v[k]);
                    evaluated[k] = v[k];
                }
            });
    }

    /// The whole step with the rates of mid-step.
    pub(super) fn correct(&mut self) -> Result<(), RunFailure> {
        let dt = self.step.dt;
        self.book_rates(dt)?;
        self.motions.set_time(&self.model, self.driven.as_ref(), self.step.time + dt);
        let Particles {
            position,
            velocity,
            energy,
            acceleration,
            energy_rate,
            mass,
            xsph,
            external_acceleration,
            evaluated_velocity,
            motion,
            base_position,
            base_velocity,
            body,
            ..
        } = &mut self.particles;
        let (acceleration, energy_rate, mass, body) = (&*acceleration, &*energy_rate, &*mass, &*body);
        let driven = self.driven.as_ref();
        let (xsph, external_acceleration, evaluated_velocity, motion) =
            (&*xsph, &*external_acceleration, &*evaluated_velocity, &*motion);
        let (motions, base_position, base_velocity) = (&self.motions, &*base_position, &*base_velocity);
        (
            position.par_chunks_mut(BLOCK),
            velocity.par_chunks_mut(BLOCK),
            energy.par_chunks_mut(BLOCK),
            self.external.partial.par_iter_mut(),
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(b, (x, v, e, partial))| {
                *partial = Moved::default();
                for k in 0..x.len() {
                    let i = b * BLOCK + k;
                    let (a, external, evaluated) = (acceleration[i], external_acceleration[i], evaluated_velocity[i]);
                    let before = base_velocity[i];
                    let kicked = kick(before, a, external, evaluated, mass[i], dt, motions, motion[i]);
                    if let Some(driven) = driven {
                        let load = driven.of_body(body[i] as usize);
                        partial.load_work += work_of_load(load, mass[i], before, kicked.velocity, dt);
                    }
                    v[k] = kicked.velocity;
                    let mean = [0, 1, 2].map(|a| 0.5 * (before[a] + v[k][a]));
                    x[k] = base_position[i];
                    // A prescribed axis moves with the mean of its velocities, without XSPH.
                    let prescribed = motions.of(motion[i]);
                    let held = [0, 1, 2].map(|a| prescribed[a].map(|_| mean[a]));
                    drift(&mut x[k], mean, xsph[i], held, dt);
                    e[k] += dt * energy_rate[i] + kicked.energy;
                    add(partial, &kicked);
                }
            });
        self.external.close(self.domain.as_ref())?;
        self.commit_stress();
        Ok(())
    }
}

/// Work of the load of a program on a particle in a kick over a time, s, J: that of its share of the force alone, at the mean velocity. The work
/// of all forces, which closes the balance, is not made of it.
#[inline(always)]
fn work_of_load(load: Vector<f64>, mass: f64, before: Vector<f64>, after: Vector<f64>, dt: f64) -> f64 {
    mass * dt * (0..3).map(|k| load[k] * (0.5 * (before[k] + after[k]))).sum::<f64>()
}

#[inline(always)]
fn add(partial: &mut Moved, kicked: &Kick) {
    partial.work += kicked.work;
    partial.booked += kicked.booked;
    for a in 0..3 {
        partial.impulse[a] += kicked.impulse[a];
    }
}

/// Moves a particle with its velocity and XSPH correction; along a prescribed axis only with the prescribed velocity.
/// Returns the square of its displacement, m².
#[inline(always)]
fn drift(x: &mut Vector<f64>, v: Vector<f64>, xsph: Vector<f64>, prescribed: [Option<f64>; 3], dt: f64) -> f64 {
    let mut way = 0.0;
    for a in 0..3 {
        let step = dt * prescribed[a].unwrap_or(v[a] + xsph[a]);
        x[a] += step;
        way += step * step;
    }
    way
}

crate::persist_fields!(ExternalSums { work, impulse, booked });
