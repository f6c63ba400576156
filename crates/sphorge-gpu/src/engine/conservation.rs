//! Conservation sums, taken when asked for.

use super::columns::Group;
use super::kernels::walls::{AtWall, Deformed, of_wall};
use super::snapshot::{Snapshot, read};
use super::{GpuEngine, failure};
use sphorge_engine::model::{Integrator, Section, Wall};
use sphorge_engine::{BodyLedger, Energies, Ledger, RunFailure};
use sphorge_physics::heat::elastic_energy;
use sphorge_physics::tensor::multiply;

impl GpuEngine {
    pub(super) fn conservation(&self) -> Result<Ledger, RunFailure> {
        let snapshot = self.snapshot()?;
        let p = &snapshot.particles;
        let mut bodies = vec![BodyLedger::default(); self.model.bodies.len()];
        for i in 0..p.len() {
            let bulk = p.pressure[i] / (p.density[i] * p.sound_speed[i]);
            let elastic = elastic_energy(p.deviator[i], snapshot.shear_modulus[i], p.density[i]) + 0.5 * bulk * bulk;
            let driven = self.prescribed_acceleration(p.motion[i]);
            let acceleration = [0, 1, 2].map(|a| driven[a].unwrap_or(p.acceleration[i][a]));
            let specific = Energies { kinetic: 0.0, internal: p.energy[i], elastic, plastic_work: p.plastic_work[i] };
            bodies[p.body[i] as usize].add(p.mass[i], p.position[i], p.velocity[i], acceleration, specific);
        }
        let mut total = BodyLedger::total(&bodies);
        bodies.iter_mut().chain([&mut total]).for_each(BodyLedger::close);
        let [work, x, y, z, integration_energy, viscous_energy, artificial_stress_energy, hourglass_energy, mls_energy] =
            snapshot.accounts;
        Ok(Ledger {
            bodies,
            total,
            external_work: work,
            external_impulse: [x, y, z],
            walls: snapshot.walls.clone(),
            wall_forces: self.model.walls.iter().map(|wall| self.wall_force(snapshot, wall)).collect(),
            integration_energy,
            viscous_energy,
            artificial_stress_energy,
            hourglass_energy,
            mls_energy,
            contacts: snapshot.contacts.clone(),
            motion_forces: self.motion_forces(snapshot),
            heat: snapshot.heat.clone(),
        })
    }

    /// Reaction of every prescribed motion on its particles, N: what the last step's accelerations lack.
    fn motion_forces(&self, snapshot: &Snapshot) -> Vec<[f64; 3]> {
        let p = &snapshot.particles;
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

    /// Whether forces through sections are summed with those of the step: the predictor-corrector leaves the places that they were evaluated at.
    pub(super) fn sums_sections_with_forces(&self) -> bool {
        self.model.numerics.integrator == Integrator::PredictorCorrector
    }

    /// Force of what is ahead of a section of the model on what is behind it, N.
    pub(super) fn section_force(&self, section: &Section) -> Result<Vec<f64>, RunFailure> {
        let number = self.model.sections.iter().position(|of| of == section);
        let number = number.ok_or_else(|| failure(format!("no section `{}`", section.name)))?;
        if !self.sums_sections_with_forces() {
            self.launch(&self.stages.sections[number])?;
        }
        let numbers = read(&self.card, &self.columns, Group::Section(number))?;
        let sum = |a: usize| numbers[a * self.stride..(a + 1) * self.stride].iter().map(|f| f64::from(*f)).sum();
        Ok((0..3).map(sum).collect())
    }

    /// Force of a wall on the particles as they are now, N; the wall stands where forces were evaluated.
    fn wall_force(&self, snapshot: &Snapshot, wall: &Wall) -> [f64; 3] {
        let p = &snapshot.particles;
        let then = self.time - (self.dt - self.dt_to_evaluation());
        let shift = [0, 1, 2].map(|a| wall.velocity[a].integral(0.0, then));
        let moving = [0, 1, 2].map(|a| wall.velocity[a].at(then));
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
            let push = of_wall(wall, &own, x, snapshot.evaluated[i], moving, self.dt);
            for a in 0..3 {
                force[a] += p.mass[i] * push.acceleration[a];
            }
        }
        force
    }
}
