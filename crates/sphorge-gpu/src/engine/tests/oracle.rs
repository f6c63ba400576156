//! The ledger of columns read back, in double precision: what that of the GPU is held against.

use crate::engine::GpuEngine;
use crate::engine::columns::{Compensated, Group, Layout, Member, groups};
use crate::engine::kernels::ledger::accounts;
use crate::engine::kernels::walls::{AtWall, Deformed, of_wall};
use crate::engine::read_back::Group64;
use sphorge_engine::model::{Formulation, Wall};
use sphorge_engine::{BodyLedger, ContactLedger, Energies, HeatLedger, Ledger, Particles, RunFailure, WallLedger};
use sphorge_physics::hourglass::Spring;
use sphorge_physics::tensor::multiply;

impl GpuEngine {
    pub(super) fn ledger_read(&self) -> Result<Ledger, RunFailure> {
        let particles = self.snapshot()?;
        let p = &particles;
        let (pressure, of_accounts, of_walls) =
            (self.group(Group::Pressure)?, self.group(Group::Accounts)?, self.group(Group::Walls)?);
        let count = p.len();
        let sum = |of: &Group64, number: Compensated<()>| -> f64 { (0..count).map(|i| of.double(number, i)).sum() };
        let of_wall = |wall: usize| {
            let works = groups::Walls::layout().of(wall).works;
            let [work, friction_work, damping_work] = [0, 1, 2].map(|k| sum(&of_walls, works.number(k)));
            WallLedger { work, friction_work, damping_work }
        };
        let mut heat = HeatLedger::default();
        if self.model.thermal.conduction {
            heat.exchanged = sum(&self.group(Group::Heat)?, groups::Heat::layout().exchanged);
            let boundaries = self.group(Group::Boundaries)?;
            let supplied = |k: usize| sum(&boundaries, groups::Boundaries::layout().of(k).supplied);
            heat.supplied = (0..self.model.thermal.boundaries.len()).map(supplied).collect();
        }
        let evaluated = self.group(Group::Evaluated)?;
        let meetings = self.model.has_contact().then(|| self.group(Group::Meetings)).transpose()?;
        let contact_of = |of: &Group64, (a, b): (usize, usize)| {
            // Of a pair of particles each has a half of the works.
            let halves = |one: usize, other: usize, k: usize| -> f64 {
                let work = groups::Meetings::layout().of(other).works.number(k);
                let own = (0..count).filter(|i| p.body[*i] as usize == one);
                own.map(|i| of.double(work, i)).sum()
            };
            let work = |k| halves(a, b, k) + if a == b { 0.0 } else { halves(b, a, k) };
            let force = |axis: usize| -> f64 {
                let own = (0..count).filter(|i| a != b && p.body[*i] as usize == a);
                own.map(|i| of.number(groups::Meetings::layout().of(b).force.axis(axis), i)).sum()
            };
            let [taken_up, friction_work, damping_work] = [0, 1, 2].map(work);
            let held = |one: usize, other: usize| -> f64 {
                let own = (0..count).filter(|i| p.body[*i] as usize == one);
                own.map(|i| of.number(groups::Meetings::layout().of(other).energy, i)).sum()
            };
            let held = held(a, b) + if a == b { 0.0 } else { held(b, a) };
            let (stored_energy, integration_energy) =
                if self.model.has_facets() { (held, taken_up - held) } else { (taken_up, 0.0) };
            // On the second.
            ContactLedger {
                force: [0, 1, 2].map(|axis| 0.0 - force(axis)),
                stored_energy,
                friction_work,
                damping_work,
                integration_energy,
            }
        };
        let contacts =
            meetings.iter().flat_map(|of| self.model.contact_pairs().into_iter().map(move |pair| (of, pair)));
        let contacts = contacts.map(|(of, pair)| contact_of(of, pair)).collect();
        let mut bodies = vec![BodyLedger::default(); self.model.bodies.len()];
        for i in 0..p.len() {
            let bulk = p.pressure[i] / (p.density[i] * p.sound_speed[i]);
            let material = &self.model.materials[p.material[i] as usize];
            let shear = material.elastic_energy(
                p.deviator[i],
                pressure.number(groups::Pressure::layout().shear_modulus, i),
                p.density[i],
            );
            let elastic = shear + 0.5 * bulk * bulk;
            let driven = self.prescribed_acceleration(p.motion[i]);
            let acceleration = [0, 1, 2].map(|a| driven[a].unwrap_or(p.acceleration[i][a]));
            let specific = Energies { kinetic: 0.0, internal: p.energy[i], elastic, plastic_work: p.plastic_work[i] };
            bodies[p.body[i] as usize].add(p.mass[i], p.position[i], p.velocity[i], acceleration, specific);
        }
        let mut total = BodyLedger::total(&bodies);
        bodies.iter_mut().chain([&mut total]).for_each(BodyLedger::close);
        let [work, x, y, z, integration_energy, viscous_energy, artificial_stress_energy, hourglass_energy, mls_energy] =
            accounts().map(|account| sum(&of_accounts, account));
        Ok(Ledger {
            bodies,
            total,
            external_work: work,
            external_impulse: [x, y, z],
            load_work: 0.0,
            walls: (0..self.model.walls.len()).map(of_wall).collect(),
            wall_forces: self.model.walls.iter().map(|wall| self.wall_force_read((p, &evaluated), wall)).collect(),
            wall_stored_energies: Vec::new(),
            integration_energy,
            viscous_energy,
            artificial_stress_energy,
            hourglass_energy,
            hourglass_stored_energy: self.energy_of_springs_read(p)?,
            mls_energy,
            fracture_energy: 0.0,
            contacts,
            motion_forces: self.motion_forces_read(p),
            heat,
        })
    }

    /// Energy that the hourglass springs hold, J.
    fn energy_of_springs_read(&self, p: &Particles) -> Result<f64, RunFailure> {
        let Formulation::TotalLagrangian { hourglass: strength, faces, .. } = self.model.formulation else {
            return Ok(0.0);
        };
        let counted = faces.counted();
        let (springs, reference, constants) =
            (self.group(Group::Springs)?, self.group(Group::Reference)?, self.group(Group::Constants)?);
        let of_springs = groups::Springs::layout();
        let held = |i: usize| {
            let young_modulus = constants.number(groups::Constants::layout().young_modulus, i);
            let least = springs.number(of_springs.least_stretch, i);
            let spring = Spring::new(counted, strength, young_modulus, p.yield_stress[i], p.plastic_strain[i], least);
            let misfit = springs.number(of_springs.misfit, i);
            reference.double(groups::Reference::layout().volume, i)
                * spring.energy(misfit, self.model.dimensions.into())
        };
        Ok((0..p.len()).map(held).sum())
    }

    /// Reaction of every prescribed motion on its particles, N: what the last step's accelerations lack.
    fn motion_forces_read(&self, p: &Particles) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; self.model.motions.len()];
        for i in 0..p.len() {
            let Some(k) = (p.motion[i] as usize).checked_sub(1) else { continue };
            let driven = self.prescribed_acceleration(p.motion[i]);
            for a in 0..3 {
                forces[k][a] += driven[a].map_or(0.0, |driven| p.mass[i] * (driven - p.acceleration[i][a]));
            }
        }
        forces
    }

    /// Acceleration a prescribed motion, by its number and one, imposes now, m/s².
    fn prescribed_acceleration(&self, motion: u32) -> [Option<f64>; 3] {
        let Some(k) = (motion as usize).checked_sub(1) else { return [None; 3] };
        [0, 1, 2].map(|a| self.model.motions[k].axes[a].acceleration(self.time, self.dt))
    }

    /// Force of a wall on the particles as they are now, N; the wall stands where forces were evaluated.
    fn wall_force_read(&self, (particles, evaluated): (&Particles, &Group64), wall: &Wall) -> [f64; 3] {
        let p = particles;
        let then = self.time - (self.dt - self.dt_to_evaluation());
        let shift = [0, 1, 2].map(|a| wall.velocity[a].integral(0.0, then));
        let moving = [0, 1, 2].map(|a| wall.velocity[a].at(then));
        let evaluated_at = groups::Evaluated::layout().velocity;
        let velocity = |i: usize| [0, 1, 2].map(|a| evaluated.number(evaluated_at.axis(a), i));
        let mut force = [0.0; 3];
        for i in 0..p.len() {
            let body = &self.model.bodies[p.body[i] as usize];
            let sound_speed = self.model.materials[body.material].equation_of_state.reference_sound_speed();
            let x = [0, 1, 2].map(|a| p.position[i][a] - shift[a]);
            let deformed = p.deformation.get(i).map(|f| {
                let earlier = p.earlier_deformation.get(i).copied();
                let whole = earlier.map_or(*f, |earlier| multiply(f, &earlier));
                Deformed { whole, earlier, velocity_gradient: p.velocity_gradient[i] }
            });
            let own = AtWall { h: body.smoothing_length, spacing: body.spacing, sound_speed, deformed };
            let push = of_wall(wall, &own, x, velocity(i), moving, self.dt);
            for a in 0..3 {
                force[a] += p.mass[i] * push.acceleration[a];
            }
        }
        force
    }
}
