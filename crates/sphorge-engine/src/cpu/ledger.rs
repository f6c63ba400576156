//! Conservation sums, taken when asked for.

use super::{CpuEngine, constitutive::shear_modulus_of};
use crate::lanes::PairScalar;
use crate::{BodyLedger, Ledger};
use sphorge_physics::heat;

impl<T: PairScalar> CpuEngine<T> {
    /// Sums over bodies in particle order: independent of threads.
    pub(super) fn conservation_ledger(&self) -> Ledger {
        let model = &*self.model;
        let p = &self.particles;
        let mut bodies = vec![BodyLedger::default(); model.bodies.len()];
        let driven: Vec<_> = (0..model.motions.len()).map(|k| self.prescribed_acceleration(k)).collect();
        for i in 0..p.len() {
            let motion = (p.motion[i] as usize).checked_sub(1).map_or([None; 3], |k| driven[k]);
            let body = &mut bodies[p.body[i] as usize];
            let material = &model.materials[p.material[i] as usize];
            let (m, x, v) = (p.mass[i], p.position[i], p.velocity[i]);
            let speed2 = v.iter().map(|c| c * c).sum::<f64>();
            body.mass += m;
            body.energies.kinetic += 0.5 * m * speed2;
            body.energies.internal += m * p.energy[i];
            body.energies.elastic += m * elastic_energy(material, p, i);
            body.energies.plastic_work += m * p.plastic_work[i];
            body.momentum_scale += m * speed2.sqrt();
            for a in 0..3 {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                body.momentum[a] += m * v[a];
                body.angular_momentum[a] += m * (x[b] * v[c] - x[c] * v[b]);
                body.centre[a] += m * x[a];
                body.force[a] += m * motion[a].unwrap_or(p.acceleration[i][a]);
            }
        }
        let mut total = BodyLedger::default();
        for body in &mut bodies {
            total.mass += body.mass;
            total.energies.kinetic += body.energies.kinetic;
            total.energies.internal += body.energies.internal;
            total.energies.elastic += body.energies.elastic;
            total.energies.plastic_work += body.energies.plastic_work;
            total.momentum_scale += body.momentum_scale;
            for a in 0..3 {
                total.momentum[a] += body.momentum[a];
                total.angular_momentum[a] += body.angular_momentum[a];
                total.centre[a] += body.centre[a];
                total.force[a] += body.force[a];
                body.centre[a] /= body.mass;
            }
        }
        for a in 0..3 {
            total.centre[a] /= total.mass;
        }
        Ledger {
            bodies,
            total,
            external_work: self.external.work,
            external_impulse: self.external.impulse,
            wall_work: self.walls.work.clone(),
            integration_energy: self.external.booked,
            mls_energy: self.step.mls_energy,
            heat: self.heat.as_ref().map(|h| h.ledger()).unwrap_or_default(),
            contacts: self.contacts.as_ref().map(|c| c.ledger()).unwrap_or_default(),
            wall_forces: self.wall_forces(),
            motion_forces: self.motion_forces(),
        }
    }

    /// Reaction of every prescribed motion on its particles, N: what the last step's accelerations lack.
    fn motion_forces(&self) -> Vec<[f64; 3]> {
        let p = &self.particles;
        let mut forces = vec![[0.0; 3]; self.model.motions.len()];
        for i in 0..p.len() {
            let Some(k) = (p.motion[i] as usize).checked_sub(1) else { continue };
            let driven = self.prescribed_acceleration(k);
            for a in 0..3 {
                if let Some(driven) = driven[a] {
                    forces[k][a] += p.mass[i] * (driven - p.acceleration[i][a]);
                }
            }
        }
        forces
    }

    /// Acceleration a prescribed motion imposes now, m/s².
    fn prescribed_acceleration(&self, motion: usize) -> [Option<f64>; 3] {
        use crate::model::MotionAxis;
        let (t, dt) = (self.step.time, self.step.dt);
        [0, 1, 2].map(|a| match &self.model.motions[motion].axes[a] {
            MotionAxis::Free => None,
            MotionAxis::Velocity(_) if dt == 0.0 => Some(0.0),
            MotionAxis::Velocity(table) => Some((table.at(t) - table.at(t - dt)) / dt),
        })
    }
}

/// Elastic energy per mass: shear, and volume by `p^2 / (2 rho c^2)` (exact for a linear pressure law).
fn elastic_energy(material: &crate::model::Material, p: &crate::particles::Particles, i: usize) -> f64 {
    let shear = heat::elastic_energy(p.deviator[i], shear_modulus_of(material, p, i), p.density[i]);
    let bulk = p.density[i] * p.sound_speed[i] * p.sound_speed[i];
    shear + 0.5 * p.pressure[i] * p.pressure[i] / (bulk * p.density[i])
}
