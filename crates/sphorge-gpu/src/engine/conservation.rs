//! Conservation sums, taken when asked for.

use super::GpuEngine;
use super::kernels::walls::of_wall;
use super::snapshot::Snapshot;
use sphorge_engine::model::Wall;
use sphorge_engine::{BodyLedger, Energies, Ledger, RunFailure};
use sphorge_physics::heat::elastic_energy;

impl GpuEngine {
    pub(super) fn conservation(&self) -> Result<Ledger, RunFailure> {
        let snapshot = self.snapshot()?;
        let p = &snapshot.particles;
        let mut bodies = vec![BodyLedger::default(); self.model.bodies.len()];
        for i in 0..p.len() {
            let bulk = p.pressure[i] / (p.density[i] * p.sound_speed[i]);
            let elastic = elastic_energy(p.deviator[i], snapshot.shear_modulus[i], p.density[i]) + 0.5 * bulk * bulk;
            let specific = Energies { kinetic: 0.0, internal: p.energy[i], elastic, plastic_work: p.plastic_work[i] };
            bodies[p.body[i] as usize].add(p.mass[i], p.position[i], p.velocity[i], p.acceleration[i], specific);
        }
        let mut total = BodyLedger::total(&bodies);
        bodies.iter_mut().chain([&mut total]).for_each(BodyLedger::close);
        let [external_work, x, y, z, integration_energy] = snapshot.accounts;
        Ok(Ledger {
            bodies,
            total,
            external_work,
            external_impulse: [x, y, z],
            wall_work: snapshot.wall_work.clone(),
            wall_forces: self.model.walls.iter().map(|wall| self.wall_force(snapshot, wall)).collect(),
            integration_energy,
            ..Ledger::default()
        })
    }

    /// Force of a wall on the particles as they are now, N; the wall stands where forces were evaluated, half a step ago.
    fn wall_force(&self, snapshot: &Snapshot, wall: &Wall) -> [f64; 3] {
        let p = &snapshot.particles;
        let then = self.time - 0.5 * self.dt;
        let shift = [0, 1, 2].map(|a| wall.velocity[a].integral(0.0, then));
        let moving = [0, 1, 2].map(|a| wall.velocity[a].at(then));
        let mut force = [0.0; 3];
        for i in 0..p.len() {
            let body = &self.model.bodies[p.body[i] as usize];
            let sound_speed = self.model.materials[body.material].equation_of_state.reference_sound_speed();
            let x = [0, 1, 2].map(|a| p.position[i][a] - shift[a]);
            let v = [0, 1, 2].map(|a| snapshot.evaluated[i][a] - moving[a]);
            let push = of_wall(wall, x, v, (body.smoothing_length, body.spacing, sound_speed), self.dt);
            for a in 0..3 {
                force[a] += p.mass[i] * push.acceleration[a];
            }
        }
        force
    }
}
