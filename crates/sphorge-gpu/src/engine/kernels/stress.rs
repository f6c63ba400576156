//! The stress of the particles of a material: equation of state, trial stress, return mapping, heat.

use crate::engine::columns::{Fields, Group, Recording, recording};
use crate::engine::step_numbers::{DT, HALF};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::{Model, Wall};
use sphorge_physics::artificial_stress::artificial_stress;
use sphorge_physics::flow::FlowState;
use sphorge_physics::heat::temperature_rise_from_plastic_work;
use sphorge_physics::pair::stress_scale;
use sphorge_physics::return_mapping::return_mapping_near;
use sphorge_physics::stress::{density_after, trial_deviator};
use sphorge_physics::viscosity::balsara;
use sphorge_physics::{Real, SymmetricTensor};

/// A kernel over the particles of material `k`: where forces are evaluated, which commits nothing, or at the end of the step.
pub(in crate::engine) fn stress(model: &Model, k: usize, count: usize, at_end: bool) -> Result<Recording, KernelFault> {
    let material = &model.materials[k];
    let numerics = &model.numerics;
    let name = if at_end { format!("commit_stress_{k}") } else { format!("stress_{k}") };
    recording(&name, count, |bind, thread| {
        let members = bind.indices(Group::Members(k));
        let i = members.at(thread);
        let step = bind.read(Group::Step);
        let (density, base_density) = (bind.write(Group::Density), bind.read(Group::BaseDensity));
        let (gradient, energy) = (bind.read(Group::Gradient), bind.read(Group::Energy));
        let (deviator, plastic) = (bind.write(Group::Deviator), bind.write(Group::Plastic));
        let (temperature, pressures) = (bind.write(Group::Temperature), bind.write(Group::Pressure));
        let half = step.get(0, Index::of(HALF));
        let dt = if at_end { step.get(0, Index::of(DT)) } else { half };
        let l = gradient.tensor(0, i);
        let (rho, e) = if at_end {
            let change = density_after(Recorded::one(), &l, dt) - Recorded::one();
            let after = crate::engine::columns::added(base_density.double(0, 1, i), base_density.get(0, i) * change);
            density.set_all(0, i, &after);
            (after[0], energy.get(0, i))
        } else {
            (density.get(0, i), energy.get(0, i) + half * energy.get(2, i))
        };
        let state = material.bounded_pressure::<Recorded>().at(rho, e);
        let flow = FlowState {
            plastic_strain: plastic.get(0, i),
            plastic_strain_rate: Recorded::zero(),
            temperature: temperature.get(0, i),
            pressure: state.pressure,
            compression: rho / Recorded::of(material.density),
        };
        let law = material.flow_law.cast::<Recorded>();
        let shear_modulus = law.shear_modulus(Recorded::of(material.shear_modulus), flow);
        let trial = trial_deviator(deviator.symmetric(0, i), &l, shear_modulus, dt);
        let guess = plastic.get(2, i);
        let returned = return_mapping_near(material.return_rule, &law, shear_modulus, trial, flow, &[], dt, guess);
        pressures.set_all(0, i, &[state.pressure, state.sound_speed, shear_modulus]);
        if at_end {
            deviator.set_all(0, i, &returned.deviator.to_array());
            plastic.add(0, 1, i, returned.plastic_strain_increment);
            plastic.set(2, i, returned.plastic_strain_increment);
            plastic.set(3, i, returned.yield_stress);
            plastic.add(4, 5, i, returned.plastic_work / rho);
            if material.heats() {
                let (beta, specific_heat) =
                    (Recorded::of(material.taylor_quinney), Recorded::of(material.specific_heat));
                temperature.add(
                    0,
                    1,
                    i,
                    temperature_rise_from_plastic_work(beta, returned.plastic_work, rho, specific_heat),
                );
                if model.walls.iter().any(Wall::rubs) {
                    let rubbed = bind.read(Group::External).get(4, i);
                    temperature.add(0, 1, i, rubbed * dt / specific_heat);
                }
            }
            return;
        }
        let (packed, constants) = (bind.write(Group::Packed), bind.read(Group::Constants));
        let sigma =
            (returned.deviator - SymmetricTensor::isotropic(state.pressure)) * stress_scale(numerics.pair_form, rho);
        packed.set_all(0, i, &sigma.to_array());
        if numerics.artificial_stress.is_some() {
            let repulsion = artificial_stress(sigma, constants.get(2, i), model.dimensions.into());
            packed.set_all(6, i, &repulsion.to_array());
        }
        if numerics.balsara {
            packed.set(12, i, balsara(&l, state.sound_speed, constants.get(1, i)));
        }
        packed.set(13, i, state.sound_speed);
    })
}
