//! Conservation sums, computed on request.

use super::{CpuEngine, constitutive::shear_modulus_of};
use crate::lanes::PairScalar;
use crate::{BodyLedger, Energies, Ledger, RunFailure};

impl<T: PairScalar> CpuEngine<T> {
    /// Sums over bodies in particle order: independent of threads and ranks.
    pub(super) fn conservation_ledger(&self) -> Result<Ledger, RunFailure> {
        let model = &*self.model;
        let mut bodies = vec![BodyLedger::default(); model.bodies.len()];
        let mut wall_forces = vec![[0.0; 3]; model.walls.len()];
        let mut wall_energies = vec![0.0; model.walls.len()];
        let mut motion_forces = vec![[0.0; 3]; model.motions.len()];
        match &self.domain {
            None => {
                self.add_bodies(&mut bodies);
                self.add_wall_forces(&mut wall_forces);
                self.add_wall_energies(&mut wall_energies);
                self.add_motion_forces(&mut motion_forces);
            }
            Some(domain) => {
                domain.ranks.sum_in_turn(&mut bodies, |bodies| self.add_bodies(bodies))?;
                domain.ranks.sum_in_turn(&mut wall_forces, |forces| self.add_wall_forces(forces))?;
                domain.ranks.sum_in_turn(&mut wall_energies, |energies| self.add_wall_energies(energies))?;
                domain.ranks.sum_in_turn(&mut motion_forces, |forces| self.add_motion_forces(forces))?;
            }
        }
        let mut total = BodyLedger::total(&bodies);
        bodies.iter_mut().chain([&mut total]).for_each(BodyLedger::close);
        Ok(Ledger {
            bodies,
            total,
            external_work: self.external.work,
            external_impulse: self.external.impulse,
            load_work: self.external.load_work,
            walls: self.walls.done.clone(),
            integration_energy: self.external.booked,
            mls_energy: self.step.mls_energy,
            hourglass_energy: self.numerical_work.hourglass.total(self.domain.as_ref())?,
            hourglass_stored_energy: self.energy_of_springs()?,
            viscous_energy: self.numerical_work.viscous.total(self.domain.as_ref())?,
            artificial_stress_energy: self.numerical_work.artificial_stress.total(self.domain.as_ref())?,
            fracture_energy: self.fracture_energy()?,
            heat: self.heat.as_ref().map(|h| h.ledger()).unwrap_or_default(),
            contacts: self.contacts.as_ref().map(|c| c.ledger()).unwrap_or_default(),
            wall_forces,
            wall_stored_energies: wall_energies,
            motion_forces,
        })
    }

    fn add_bodies(&self, bodies: &mut [BodyLedger]) {
        let model = &*self.model;
        let p = &self.particles;
        let driven: Vec<_> = (0..model.motions.len()).map(|k| self.prescribed_acceleration(k)).collect();
        for i in 0..p.len() {
            let motion = (p.motion[i] as usize).checked_sub(1).map_or([None; 3], |k| driven[k]);
            let material = &model.materials[p.material[i] as usize];
            let specific = Energies {
                kinetic: 0.0,
                internal: p.energy[i],
                elastic: elastic_energy(material, p, i),
                plastic_work: p.plastic_work[i],
            };
            let acceleration = [0, 1, 2].map(|a| motion[a].unwrap_or(p.acceleration[i][a]));
            bodies[p.body[i] as usize].add(p.mass[i], p.position[i], p.velocity[i], acceleration, specific);
        }
    }

    /// What breaking has dissipated, J.
    fn fracture_energy(&self) -> Result<f64, RunFailure> {
        let p = &self.particles;
        let add = |sum: &mut [f64]| p.history.add_fracture_energy(&p.mass, sum);
        let mut sum = [0.0];
        match &self.domain {
            _ if !p.history.keeps_fracture_energy() => {}
            None => add(&mut sum),
            Some(domain) => domain.ranks.sum_in_turn(&mut sum, add)?,
        }
        Ok(sum[0])
    }

    /// Adds the reaction of every prescribed motion on its particles, N: the force that is missing from the
    /// accelerations of the last step.
    fn add_motion_forces(&self, forces: &mut [[f64; 3]]) {
        let p = &self.particles;
        for i in 0..p.len() {
            let Some(k) = (p.motion[i] as usize).checked_sub(1) else { continue };
            let driven = self.prescribed_acceleration(k);
            for a in 0..3 {
                if let Some(driven) = driven[a] {
                    forces[k][a] += p.mass[i] * (driven - p.acceleration[i][a]);
                }
            }
        }
    }

    /// Acceleration a prescribed motion imposes now, m/s².
    fn prescribed_acceleration(&self, motion: usize) -> [Option<f64>; 3] {
        let of_a_program = self.driven.as_ref().and_then(|driven| driven.acceleration(motion, self.step.dt));
        let of_the_deck =
            || [0, 1, 2].map(|a| self.model.motions[motion].axes[a].acceleration(self.step.time, self.step.dt));
        of_a_program.unwrap_or_else(of_the_deck)
    }
}

/// Elastic energy per mass: shear, and volume by `p^2 / (2 rho c^2)` (exact for a linear pressure law).
fn elastic_energy(material: &crate::model::Material, p: &crate::particles::Particles, i: usize) -> f64 {
    let shear = material.elastic_energy(p.deviator[i], shear_modulus_of(material, p, i), p.density[i]);
    let bulk = p.density[i] * p.sound_speed[i] * p.sound_speed[i];
    shear + 0.5 * p.pressure[i] * p.pressure[i] / (bulk * p.density[i])
}
