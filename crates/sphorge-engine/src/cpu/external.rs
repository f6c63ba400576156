//! Walls and gravity.

use super::CpuEngine;
use super::walls::wall_acceleration;
use crate::lanes::PairScalar;
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::Vector;

impl<T: PairScalar> CpuEngine<T> {
    /// Adds wall and gravity accelerations to those of the pair sum.
    pub(super) fn add_external_forces(&mut self) {
        let model = &*self.model;
        if model.walls.is_empty() && model.gravity == [0.0; 3] {
            // The external acceleration is zero from the start.
            return;
        }
        let dt = self.step.dt;
        let mut power = std::mem::take(&mut self.walls.power);
        let walls = &self.walls;
        let Particles { acceleration, position, body, mass, external_acceleration, evaluated_velocity, .. } =
            &mut self.particles;
        let (position, body, mass, velocity) = (&*position, &*body, &*mass, &*evaluated_velocity);
        (
            acceleration.par_chunks_mut(BLOCK),
            external_acceleration.par_chunks_mut(BLOCK),
            power.par_chunks_mut(model.walls.len().max(1)),
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(b, (a, external, power))| {
                power.fill(0.0);
                for k in 0..a.len() {
                    let i = b * BLOCK + k;
                    let mut sum = model.gravity;
                    for ((wall, state), power) in model.walls.iter().zip(&walls.states).zip(&mut *power) {
                        let push = wall_acceleration(model, wall, state, body[i], position[i], velocity[i], dt);
                        for axis in 0..3 {
                            sum[axis] += push[axis];
                            *power += mass[i] * push[axis] * velocity[i][axis];
                        }
                    }
                    external[k] = sum;
                    for axis in 0..3 {
                        a[k][axis] += sum[axis];
                    }
                }
            });
        self.walls.power = power;
        self.walls.book(dt);
    }

    /// Force of every wall on the particles as they are now, N.
    pub(super) fn wall_forces(&self) -> Vec<Vector<f64>> {
        let p = &self.particles;
        let force = |(wall, state)| {
            let mut sum = [0.0; 3];
            for i in 0..p.len() {
                let v = p.evaluated_velocity[i];
                let push = wall_acceleration(&self.model, wall, state, p.body[i], p.position[i], v, self.step.dt);
                for axis in 0..3 {
                    sum[axis] += p.mass[i] * push[axis];
                }
            }
            sum
        };
        self.model.walls.iter().zip(&self.walls.states).map(force).collect()
    }
}
