//! Walls, gravity, and loads from a program.

use super::CpuEngine;
use super::facets_on_walls::{Springs, limit_of_facets};
use super::walls::{AtWall, book, push, stored};
use crate::RunFailure;
use crate::drive::{Drive, Driven, masses_of_bodies};
use crate::lanes::PairScalar;
use crate::neighbors::BLOCK;
use crate::report::WallLedger;
use rayon::prelude::*;
use sphorge_physics::wall::FacePushes;
use sphorge_physics::{Tensor, Vector};

/// For a block of particles: accelerations and powers, powers by wall, power at faces and the step that facets limit.
type Chunks<'a> = ((&'a mut [Vector<f64>], &'a mut [f64]), &'a mut [WallLedger], (&'a mut f64, &'a mut f64));

impl<T: PairScalar> CpuEngine<T> {
    /// Whether only pair forces act on the particles: the columns of external forces are zero from the start.
    fn is_alone(&self) -> bool {
        self.model.walls.is_empty() && self.model.gravity == [0.0; 3] && self.driven.is_none()
    }

    /// Takes loads and velocities for the steps to come. The accelerations of the last forces are those of the next kick: loads act from its beginning.
    pub(super) fn take_drive(&mut self, drive: &Drive) {
        // Summed once: a program gives loads in every step.
        let known = self.driven.as_mut().map(|former| std::mem::take(&mut former.masses));
        let known = known.filter(|masses| !masses.is_empty());
        let masses = known.unwrap_or_else(|| masses_of_bodies(&self.model, &self.particles));
        // Of a state that was loaded they are not known yet.
        self.motions.set_time(&self.model, self.driven.as_ref(), self.step.time);
        let before = (0..self.model.motions.len()).map(|k| self.motions.of(k as u32 + 1)).collect();
        let driven = Driven::new(drive, masses, before);
        let former = |body| self.driven.as_ref().map_or([0.0; 3], |former| former.of_body(body));
        let change = |body| {
            let (now, former) = (driven.of_body(body), former(body));
            [0, 1, 2].map(|a| now[a] - former[a])
        };
        let changes: Vec<_> = (0..self.model.bodies.len()).map(change).collect();
        let p = &mut self.particles;
        for i in 0..p.len() {
            let change = changes[p.body[i] as usize];
            for a in 0..3 {
                p.acceleration[i][a] += change[a];
                p.external_acceleration[i][a] += change[a];
            }
        }
        self.driven = Some(driven);
    }

    /// Computes the effect of walls and gravity. A wall acts on a particle of the total Lagrangian form at its face or
    /// facets, and the distance from the centre is an arm of the force. Its moment enters as a stress of the particle,
    /// so that the work is done at the face, not at the centre.
    pub(super) fn push_externally(&mut self) {
        self.slip_on_walls();
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
        let mut limits = std::mem::take(&mut self.walls.limits);
        let (model, p, dt) = (&*self.model, &self.particles, self.step.dt);
        let (columns, states) = (AtWall::new(p), &self.walls.states);
        let at_facets = self.facets_on_walls.as_ref();
        let loads = self.driven.as_ref();
        let update = |b: usize, (sums, powers, at_faces): Chunks<'_>, face_stress: &mut [Tensor<f64>]| {
            powers.fill(WallLedger::default());
            *at_faces.0 = 0.0;
            *at_faces.1 = f64::INFINITY;
            let (external, external_power) = sums;
            for k in 0..external.len() {
                let i = b * BLOCK + k;
                let load = loads.map(|loads| loads.of_body(p.body[i] as usize));
                let everywhere = load.map_or(model.gravity, |load| [0, 1, 2].map(|a| model.gravity[a] + load[a]));
                let mut sum = FacePushes::of_gravity(everywhere);
                let mut stability = (0.0, 0.0);
                for (number, ((wall, state), powers)) in model.walls.iter().zip(states).zip(&mut *powers).enumerate() {
                    if let Some(push) = at_facets.and_then(|facets| facets.on(model, states, number, p, i)) {
                        let done = push.add_to(&mut sum, p, i);
                        powers.add(&done, 1.0);
                        stability = (stability.0 + push.stiffness, stability.1 + push.damping);
                        continue;
                    }
                    let push = push(model, wall, state, &columns, i, dt);
                    let power = sum.add(&push, p.evaluated_velocity[i]);
                    powers.add(&WallLedger::powers(&push, power, p.mass[i]), 1.0);
                }
                external[k] = sum.acceleration;
                external_power[k] = sum.beyond;
                *at_faces.0 += p.mass[i] * sum.beyond;
                *at_faces.1 = at_faces.1.min(limit_of_facets(stability, p.mass[i]));
                // The stress due to the moment of the forces at the face, in a form that has one.
                if let Some(face_stress) = face_stress.get_mut(k) {
                    *face_stress = sum.stress(p.mass[i], p.reference_volume[i]);
                }
            }
        };
        let sums = external.par_chunks_mut(BLOCK).zip(external_power.par_chunks_mut(BLOCK));
        let of_blocks = at_faces.par_iter_mut().zip(&mut limits);
        let chunks = (sums, powers.par_chunks_mut(model.walls.len().max(1)), of_blocks);
        let chunks = chunks.into_par_iter().enumerate();
        if face_stress.is_empty() {
            chunks.for_each(|(b, chunks)| update(b, chunks, &mut []));
        } else {
            chunks.zip(face_stress.par_chunks_mut(BLOCK)).for_each(|((b, chunks), faces)| update(b, chunks, faces));
        }
        let p = &mut self.particles;
        (p.external_acceleration, p.external_power) = (external, external_power);
        p.face_stress = face_stress;
        (self.walls.powers, self.walls.at_faces, self.walls.limits) = (powers, at_faces, limits);
    }

    /// Lets the tangential springs of facets on walls slip.
    fn slip_on_walls(&mut self) {
        let Some(facets) = self.facets_on_walls.as_ref().filter(|facets| facets.has_friction()) else { return };
        let (model, dt, states) = (&*self.model, self.step.dt, &self.walls.states);
        let mut slips = [
            std::mem::take(&mut self.particles.wall_slip_of_low_faces),
            std::mem::take(&mut self.particles.wall_slip_of_high_faces),
        ];
        let mut rubbed = [
            std::mem::take(&mut self.particles.rubbed_on_walls_at_low_faces),
            std::mem::take(&mut self.particles.rubbed_on_walls_at_high_faces),
        ];
        let p = &self.particles;
        let [slips_low, slips_high] = &mut slips;
        let [rubbed_low, rubbed_high] = &mut rubbed;
        let columns = ((slips_low, slips_high), (rubbed_low, rubbed_high)).into_par_iter();
        columns.with_min_len(BLOCK).enumerate().for_each(|(i, ((low, high), (rubbed_low, rubbed_high)))| {
            let springs = facets.slip(model, states, p, i, Springs::from_columns(low, high), dt);
            springs.to_columns((low, high), (rubbed_low, rubbed_high));
        });
        let p = &mut self.particles;
        [p.wall_slip_of_low_faces, p.wall_slip_of_high_faces] = slips;
        [p.rubbed_on_walls_at_low_faces, p.rubbed_on_walls_at_high_faces] = rubbed;
    }

    /// The heat of friction at walls, to which that of contacts is added.
    fn rub_at_walls(&mut self) {
        let mut friction_heat = std::mem::take(&mut self.particles.friction_heat);
        let (model, p, dt) = (&*self.model, &self.particles, self.step.dt);
        let (columns, states) = (AtWall::new(p), &self.walls.states);
        let at_facets = self.facets_on_walls.as_ref();
        friction_heat.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, heat)| {
            let rubbing = model.walls.iter().zip(states).enumerate().filter(|(_, (wall, _))| wall.rubs());
            let rubbed = rubbing.map(|(number, (wall, state))| {
                let at_facets = at_facets.and_then(|facets| facets.on(model, states, number, p, i));
                at_facets
                    .map_or_else(|| push(model, wall, state, &columns, i, dt).rubbed, |push| push.rubbed / p.mass[i])
            });
            *heat = rubbed.sum();
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
        let (columns, states) = (AtWall::new(p), &self.walls.states);
        for (number, ((wall, state), sum)) in self.model.walls.iter().zip(states).zip(forces).enumerate() {
            for i in 0..p.len() {
                let at_facets = self.facets_on_walls.as_ref();
                let force = match at_facets.and_then(|facets| facets.on(&self.model, states, number, p, i)) {
                    Some(push) => push.force,
                    None => {
                        let push = push(&self.model, wall, state, &columns, i, self.step.dt);
                        push.acceleration.map(|a| p.mass[i] * a)
                    }
                };
                (0..3).for_each(|axis| sum[axis] += force[axis]);
            }
        }
    }

    /// Adds what the springs of every wall hold, J.
    pub(super) fn add_wall_energies(&self, energies: &mut [f64]) {
        let p = &self.particles;
        let (columns, states) = (AtWall::new(p), &self.walls.states);
        for (number, ((wall, state), sum)) in self.model.walls.iter().zip(states).zip(energies).enumerate() {
            for i in 0..p.len() {
                let at_facets = self.facets_on_walls.as_ref();
                *sum += match at_facets.and_then(|facets| facets.on(&self.model, states, number, p, i)) {
                    Some(push) => push.stored,
                    None => p.mass[i] * stored(&self.model, wall, state, &columns, i),
                };
            }
        }
    }
}
