//! The two forms of the sums, which differ in the configuration of positions, gradients and stresses.
//!
//! What both have in common, the pair loops, the laws and the integrators, is in the files next to this folder.

mod total_lagrangian;
mod updated_lagrangian;

use super::CpuEngine;
use super::inner::Rows;
use crate::lanes::PairScalar;
use crate::model::{self, Model};
use crate::particles::Particles;
use sphorge_physics::viscosity::ViscosityParameters;
use sphorge_physics::{SymmetricTensor, Tensor};
use total_lagrangian::TotalLagrangian;
use updated_lagrangian::UpdatedLagrangian;

/// Operations that differ between the two forms. They have no state: that is in the columns of the engine.
pub(super) trait Formulation<T: PairScalar>: Sync {
    /// Whether sums use corrected gradients.
    fn is_corrected(&self, model: &Model) -> bool;
    /// Completes the columns of particles in their initial order.
    fn start(&self, engine: &mut CpuEngine<T>);
    /// Whether sums are taken over the initial configuration: its neighbours, positions and volumes.
    fn is_initial(&self) -> bool;
    /// Whether material of other bodies contributes to the sums.
    fn sees_other_bodies(&self) -> bool;
    /// Viscosity between pairs; none if it is a pressure of the particle.
    fn pair_viscosity(&self, model: &Model) -> Option<ViscosityParameters<f64>>;
    /// Viscosity as a pressure of the particle.
    fn bulk_viscosity(&self, model: &Model) -> Option<ViscosityParameters<f64>>;
    /// Strength of the viscosity of shocks along pairs, if there is one.
    fn viscosity_of_shocks(&self, model: &Model) -> Option<f64>;

    /// Packs the data of particles that the velocity gradient reads.
    fn pack_motion(&self, engine: &mut CpuEngine<T>);
    /// Velocity gradient and density.
    fn kinematics(&self, engine: &mut CpuEngine<T>, rows: Rows);
    /// Whether forces have a gradient correction other than that of the velocity gradient.
    fn corrects_forces(&self, engine: &CpuEngine<T>) -> bool;
    /// Packs the data of particles that it reads.
    fn pack_volumes(&self, engine: &mut CpuEngine<T>);
    /// That gradient correction, if there is one.
    fn correct_gradients(&self, engine: &mut CpuEngine<T>);
    /// The tensor whose sum is the force on particle `i`, from its scaled stress and its gradient correction.
    fn force_tensor(
        &self,
        particles: &Particles,
        i: usize,
        stress: SymmetricTensor<f64>,
        correction: &Tensor<f64>,
    ) -> Tensor<f64>;
    /// Forces besides those of the stress.
    fn add_forces(&self, engine: &mut CpuEngine<T>, rows: Rows);
}

/// The form that a model selects.
pub(super) fn of<T: PairScalar>(model: &Model) -> &'static dyn Formulation<T> {
    match model.formulation {
        model::Formulation::UpdatedLagrangian => &UpdatedLagrangian,
        model::Formulation::TotalLagrangian { .. } => &TotalLagrangian,
    }
}
