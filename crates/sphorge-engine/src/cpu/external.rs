//! Walls and gravity.

use super::CpuEngine;
use super::walls::{AtWall, book, push};
use crate::RunFailure;
use crate::lanes::PairScalar;
use crate::neighbors::BLOCK;
use crate::report::WallLedger;
use rayon::prelude::*;
use sphorge_physics::wall::FacePushes;
use sphorge_physics::{Tensor, Vector};

/// For a block of particles: accelerations and powers, powers by wall, power at faces.
type Chunks<'a> = ((&'a mut [Vector<f64>], &'a mut [f64]), &'a mut [WallLedger], &'a mut f64);

impl<T: PairScalar> CpuEngine<T> {
    /// Whether only pair forces act on the particles: the columns of external forces are zero from the start.
    fn is_alone(&self) -> bool {
        self.model.walls.is_empty() && self.model.gravity == [0.0; 3]
    }

    /// Computes the effect of walls and gravity. A wall acts on a particle of the total Lagrangian form at its face,
    /// and the distance from the centre is an arm of the force. Its moment enters as a stress of the particle, so that
    /// the work is done at the face, not at the centre.
    pub(super) fn push_externally(&mut self) {
        self.rub_at_walls();
        if self.is_alone() {
            // Contacts add to it.
            self.particles.face_stress.fill([[0.0; 3]; 3]);
            return;
        }
        let p = &mut self.particles;
        let mut external = std::mem::take(&mut p.external_acceleration);
        let mut external_power = std::mem::take(&mut p.external_power);
        let mut face_stress = std::mem::take(&mut p.face_stress);
        let mut powers = std::mem::take(&mut self.walls.powers);
        let mut at_faces = std::mem::take(&mut self.walls.at_faces);
        let (model, p, dt) = (&*self.model, &self.particles, self.step.dt);
        let (columns, states) = (AtWall::new(p), &self.walls.states);
        let update = |b: usize, (sums, powers, at_faces): Chunks<'_>, face_stress: &mut [Tensor<f64>]| {
            powers.fill(WallLedger::default());
            *at_faces = 0.0;
            let (external, external_power) = sums;
            for k in 0..external.len() {
                let i = b * BLOCK + k;
                let mut sum = FacePushes::of_gravity(model.gravity);
                for ((wall, state), powers) in model.walls.iter().zip(states).zip(&mut *powers) {
                    let push = push(model, wall, state, &columns, i, dt);
                    let power = sum.add(&push, p.evaluated_velocity[i]);
                    powers.add(&WallLedger::powers(&push, power, p.mass[i]), 1.0);
                }
                external[k] = sum.acceleration;
                external_power[k] = sum.beyond;
                *at_faces += p.mass[i] * sum.beyond;
                // The stress due to the moment of the forces at the face, in a form that has one.
                if let Some(face_stress) = face_stress.get_mut(k) {
                    *face_stress = sum.stress(p.mass[i], p.reference_volume[i]);
                }
            }
        };
        let sums = external.par_chunks_mut(BLOCK).zip(external_power.par_chunks_mut(BLOCK));
        let chunks = (sums, powers.par_chunks_mut(model.walls.len().max(1)), at_faces.par_iter_mut());
        let chunks = chunks.into_par_iter().enumerate();
        if face_stress.is_empty() {
            chunks.for_each(|(b, chunks)| update(b, chunks, &mut []));
        } else {
            chunks.zip(face_stress.par_chunks_mut(BLOCK)).for_each(|((b, chunks), faces)| update(b, chunks, faces));
        }
        let p = &mut self.particles;
        (p.external_acceleration, p.external_power) = (external, external_power);
        p.face_stress = face_stress;
        (self.walls.powers, self.walls.at_faces) = (powers, at_faces);
    }

    /// The heat of friction at walls, to which that of contacts is added.
    fn rub_at_walls(&mut self) {
        let mut friction_heat = std::mem::take(&mut self.particles.friction_heat);
        let (model, dt) = (&*self.model, self.step.dt);
        let (columns, states) = (AtWall::new(&self.particles), &self.walls.states);
        friction_heat.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, heat)| {
            let rubbing = model.walls.iter().zip(states).filter(|(wall, _)| wall.rubs());
            *heat = rubbing.map(|(wall, state)| push(model, wall, state, &columns, i, dt).rubbed).sum();
        });
        self.particles.friction_heat = friction_heat;
    }

    /// Adds the effect of walls and gravity to the rates of the pair sums.
    pub(super) fn add_external_forces(&mut self) {
        if self.is_alone() {
            return;
        }
        let p = &mut self.particles;
        let rates = p.acceleration.par_iter_mut().zip(&mut p.energy_rate);
        let external = p.external_acceleration.par_iter().zip(&p.external_power);
        rates.zip(external).with_min_len(BLOCK).for_each(|((a, e), (external, power))| {
            (0..3).for_each(|axis| a[axis] += external[axis]);
            *e += power;
        });
    }

    /// Adds the work of walls over a time, s, to the balance.
    pub(super) fn book_walls(&mut self, dt: f64) -> Result<(), RunFailure> {
        let at_faces = match &self.domain {
            // Without walls all of it is zero.
            Some(domain) if !self.model.walls.is_empty() => {
                let powers = domain.gather_blocks(&self.walls.powers, self.model.walls.len())?;
                let at_faces = domain.gather_blocks(&self.walls.at_faces, 1)?;
                book(&mut self.walls.done, &powers, &at_faces, dt)
            }
            _ => book(&mut self.walls.done, &self.walls.powers, &self.walls.at_faces, dt),
        };
        self.external.work += at_faces;
        Ok(())
    }

    /// Adds the force of every wall on the particles as they are now, N.
    pub(super) fn add_wall_forces(&self, forces: &mut [Vector<f64>]) {
        let p = &self.particles;
        let columns = AtWall::new(p);
        for ((wall, state), sum) in self.model.walls.iter().zip(&self.walls.states).zip(forces) {
            for i in 0..p.len() {
                let push = push(&self.model, wall, state, &columns, i, self.step.dt);
                for axis in 0..3 {
                    sum[axis] += p.mass[i] * push.acceleration[axis];
                }
            }
        }
    }
}
