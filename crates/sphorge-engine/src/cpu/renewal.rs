//! Renewal of the reference configuration of bodies in the total Lagrangian form that come apart.
//!
//! Sums over the initial neighbours keep material together, which is right even for a foot that is pressed flat. A body
//! that is stretched beyond a bound, a smaller one where it is liquid, has come apart. From then on its current
//! configuration repeatedly becomes its reference configuration: positions, volumes and neighbours are the current
//! ones, and deformation gradients start at one. The state does not change: stress, density, energy and plastic strain
//! belong to the particle, and forces stay pairwise. Parts without common neighbours are then separate pieces.
//!
//! Particles have then drifted to the end of the step, but deformation gradients are those of its start. The reference
//! is therefore where particles were at the start: the step deforms it as it moves them. With the places of the end the
//! motion of this step would count as a misfit of springs for good.

use super::CpuEngine;
use super::face_sums::FaceSums;
use crate::RunFailure;
use crate::lanes::PairScalar;
use crate::model::{EnergyState, Formulation, Material};
use crate::neighbors::BLOCK;
use crate::particles::Owner;
use rayon::prelude::*;
use sphorge_physics::tensor::{identity, multiply};
use sphorge_physics::total_lagrangian::{LARGEST_STRETCH_OF_A_LIQUID, is_deformed_again, is_stretched};
use std::sync::atomic::{AtomicBool, Ordering};

impl<T: PairScalar> CpuEngine<T> {
    /// Makes the current configuration of bodies that are deformed too far their reference. The lists are then out of
    /// date. Returns whether there was such a body.
    pub(super) fn renew_references(&mut self) -> Result<bool, RunFailure> {
        let Formulation::TotalLagrangian { renewal: Some(bound), .. } = self.model.formulation else {
            return Ok(false);
        };
        let dt = self.step.dt;
        let p = &mut self.particles;
        let has_come_apart = &mut self.has_come_apart;
        let is_due: Vec<AtomicBool> = has_come_apart.iter().map(|_| AtomicBool::new(false)).collect();
        let materials: Vec<&Material> = self.model.bodies.iter().map(|b| &self.model.materials[b.material]).collect();
        let solid = (&p.deformation, &p.smallest_stretch, &p.body);
        let liquid = (&p.temperature, &p.energy, &p.density, &p.deviator, &p.plastic_work);
        let columns = (solid.into_par_iter(), liquid.into_par_iter()).into_par_iter();
        let history = &p.history;
        columns.with_min_len(BLOCK).enumerate().for_each(|(i, ((f, smallest, &body), liquid))| {
            let is_liquid = || {
                let (&temperature, &energy, &density, &deviator, &plastic_work) = liquid;
                let integrity = history.integrity_of(i);
                let state = EnergyState { energy, density, deviator, plastic_work, integrity };
                materials[body as usize].is_liquid(temperature, &state)
            };
            let too_far = match has_come_apart[body as usize] {
                true => is_deformed_again(f, *smallest),
                false => {
                    is_stretched(f, bound)
                        || bound > LARGEST_STRETCH_OF_A_LIQUID
                            && is_stretched(f, LARGEST_STRETCH_OF_A_LIQUID)
                            && is_liquid()
                }
            };
            if too_far {
                is_due[body as usize].store(true, Ordering::Relaxed);
            }
        });
        let mut is_due: Vec<bool> = is_due.into_iter().map(AtomicBool::into_inner).collect();
        if let Some(domain) = &self.domain {
            let of_all = domain.ranks.gather(&is_due, &vec![is_due.len(); domain.ranks.size()])?;
            is_due =
                (0..is_due.len()).map(|body| of_all[body..].iter().step_by(is_due.len()).any(|&due| due)).collect();
        }
        if !is_due.contains(&true) {
            return Ok(false);
        }
        for (body, (apart, due)) in has_come_apart.iter_mut().zip(&is_due).enumerate() {
            if let (Some(contacts), false, true) = (&mut self.contacts, *apart, due) {
                contacts.release(body, p, self.domain.as_deref())?;
            }
            *apart |= due;
        }
        p.allocate(Owner::Renewal);
        self.ghosts.halo.wrap(&mut p.position, &mut p.initial_position);
        let of_now = (&p.body, (&p.position, &p.velocity), &p.mass, &p.density);
        let reference = (&mut p.reference_position, &mut p.reference_volume, &mut p.earlier_deformation);
        let springs = (&mut p.yielded_stretch, &mut p.spring_misfit, &mut p.spring_moment);
        let since = (&mut p.deformation, &mut p.smallest_stretch, springs);
        let particles = (of_now.into_par_iter(), reference.into_par_iter(), since.into_par_iter()).into_par_iter();
        particles.with_min_len(BLOCK).for_each(
            |((&body, (position, velocity), mass, density), (reference, volume, earlier), (f, stretch, springs))| {
                if is_due[body as usize] {
                    *reference = [0, 1, 2].map(|a| position[a] - dt * velocity[a]);
                    *volume = mass / density;
                    *earlier = multiply(f, earlier);
                    *f = identity();
                    *stretch = 1.0;
                    // Energy that the springs held is heat from now on.
                    (*springs.0, *springs.1, *springs.2) = (1.0, 0.0, [[0.0; 3]; 3]);
                }
            },
        );
        for (excess, &body) in p.face_excess.iter_mut().zip(&p.body) {
            if is_due[body as usize] {
                *excess = [[0.0; 3]; 3];
            }
        }
        self.reference_corrected = false;
        self.face_sums.iter_mut().for_each(FaceSums::forget);
        self.lists.stale = true;
        Ok(true)
    }
}
