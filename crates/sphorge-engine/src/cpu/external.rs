//! Walls and gravity.

use super::CpuEngine;
use super::walls::{Walls, wall_push};
use crate::lanes::PairScalar;
use crate::model::Wall;
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
                        let push = wall_push(model, wall, state, body[i], position[i], velocity[i], dt);
                        for axis in 0..3 {
                            sum[axis] += push.acceleration[axis];
                            *power += mass[i] * push.acceleration[axis] * velocity[i][axis];
                        }
                    }
                    external[k] = sum;
                    for axis in 0..3 {
                        a[k][axis] += sum[axis];
                    }
                }
            });
        self.walls.power = power;
        if model.walls.iter().any(Wall::rubs) {
            self.rub_at_walls();
        }
        self.walls.book(dt);
    }

    /// Heats particles by the friction of walls, which take up none of it: what they give is the work of where they move.
    fn rub_at_walls(&mut self) {
        let (model, dt, contacts) = (&*self.model, self.step.dt, self.contacts.is_some());
        let Particles { energy_rate, position, body, mass, evaluated_velocity, friction_heat, .. } =
            &mut self.particles;
        let Walls { states, power, rubbed, .. } = &mut self.walls;
        let states = &*states;
        (
            energy_rate.par_chunks_mut(BLOCK),
            friction_heat.par_chunks_mut(BLOCK),
            power.par_chunks_mut(model.walls.len()),
            rubbed.par_iter_mut(),
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(b, (energy_rate, friction_heat, power, rubbed))| {
                *rubbed = 0.0;
                if !contacts {
                    friction_heat.fill(0.0);
                }
                for k in 0..energy_rate.len() {
                    let i = b * BLOCK + k;
                    for ((wall, state), power) in model.walls.iter().zip(states).zip(&mut *power) {
                        let (x, v) = (position[i], evaluated_velocity[i]);
                        let heat = wall_push(model, wall, state, body[i], x, v, dt).rubbed;
                        friction_heat[k] += heat;
                        energy_rate[k] += heat;
                        *rubbed += mass[i] * heat;
                        *power += mass[i] * heat;
                    }
                }
            });
    }

    /// Force of every wall on the particles as they are now, N.
    pub(super) fn wall_forces(&self) -> Vec<Vector<f64>> {
        let p = &self.particles;
        let force = |(wall, state)| {
            let mut sum = [0.0; 3];
            for i in 0..p.len() {
                let v = p.evaluated_velocity[i];
                let push = wall_push(&self.model, wall, state, p.body[i], p.position[i], v, self.step.dt);
                for axis in 0..3 {
                    sum[axis] += p.mass[i] * push.acceleration[axis];
                }
            }
            sum
        };
        self.model.walls.iter().zip(&self.walls.states).map(force).collect()
    }
}
