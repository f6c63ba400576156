//! The stress of the particles of a material: equation of state, trial stress, return mapping, heat.

use super::pairs::compressed;
use super::reference::{Deformations, References};
use crate::engine::columns::{
    Group, Member, ReadColumns, ReadShared, Recording, WriteColumns, added, groups, recording,
};
use crate::record::{Double, KernelFault, Recorded};
use sphorge_engine::model::{Formulation, Model, TemperatureSource};
use sphorge_engine::particles::HistoryVariables;
use sphorge_physics::artificial_stress::artificial_stress;
use sphorge_physics::damage::{Before, Moduli};
use sphorge_physics::eos::PressureState;
use sphorge_physics::flow::{FlowState, FlowStep};
use sphorge_physics::heat::temperature_rise_from_plastic_work;
use sphorge_physics::hourglass::Spring;
use sphorge_physics::hyperelastic::neo_hookean_deviator;
use sphorge_physics::integrity::{Borne, smeared_width};
use sphorge_physics::pair::{mean, stress_scale};
use sphorge_physics::return_mapping::return_mapping_near;
use sphorge_physics::stress::trial_deviator;
use sphorge_physics::total_lagrangian::{LARGEST_STRETCH_OF_A_LIQUID, stretched};
use sphorge_physics::viscosity::{ViscosityParameters, balsara, bulk_viscosity, bulk_viscous_power};
use sphorge_physics::{Real, SymmetricTensor};

/// The stress of a step that is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum StressOf {
    /// At mid-step, for the predictor: nothing is committed; forces read it.
    Middle,
    /// At the end of the step of the predictor–corrector, committed, from the density before it.
    End,
    /// At the end of the step of leapfrog, committed; forces read it.
    Leapfrog,
}

impl StressOf {
    fn commits(self) -> bool {
        match self {
            Self::Middle => false,
            Self::End | Self::Leapfrog => true,
        }
    }

    fn is_read_by_forces(self) -> bool {
        match self {
            Self::End => false,
            Self::Middle | Self::Leapfrog => true,
        }
    }
}

/// A kernel over the particles of material `k`.
pub(in crate::engine) fn stress(
    model: &Model,
    (k, references): (usize, References),
    count: usize,
    of: StressOf,
) -> Result<Recording, KernelFault> {
    let material = &model.materials[k];
    let numerics = &model.numerics;
    let name = match of {
        StressOf::End => format!("commit_stress_{k}"),
        StressOf::Middle | StressOf::Leapfrog => format!("stress_{k}"),
    };
    recording(&name, count, |bind, thread| {
        let members = bind.indices(Group::Members(k));
        let i = members.at(thread);
        let step = groups::Step::shared(bind);
        let density = groups::Density::write(bind).density;
        let (gradient, energy) = (groups::Gradient::read(bind).velocity_gradient, groups::Energy::read(bind));
        let (deviator, plastic) = (groups::Deviator::write(bind).deviator, groups::Plastic::write(bind));
        let (temperature, pressures) = (groups::Temperature::write(bind).temperature, groups::Pressure::write(bind));
        let half = step.half.value();
        let dt = if of.commits() { step.dt.value() } else { half };
        let l = gradient.get(i);
        let (rho, e) = match of {
            StressOf::End => {
                let after = compressed(groups::BaseDensity::read(bind).density.get(i), &l, dt);
                density.set(i, after);
                (after, energy.energy.get(i))
            }
            StressOf::Middle | StressOf::Leapfrog => {
                (density.get(i), added(energy.energy.get(i), half * energy.rate.get(i)))
            }
        };
        // A pressure is small compared with the bulk modulus: from densities in single precision it would be accurate
        // only to some 10 kPa.
        let state = material.bounded_pressure::<Double>().at(Double::new(rho), Double::new(e));
        let whole = PressureState { pressure: state.pressure.high, sound_speed: state.sound_speed.high };
        let ([rho, _], [e, _]) = (rho, e);
        let slots = &HistoryVariables::of(model).slots[k];
        let history = (!slots.is_empty()).then(|| groups::History::write(bind));
        // Integrity is kept behind the variables of the flow law and of damage.
        let laws = material.flow_law.history().len();
        let breaking = slots.last().filter(|_| material.breaks()).zip(history);
        let one = Recorded::one();
        let size = breaking.map_or(one, |_| {
            smeared_width(numerics.kernel.support(), groups::Constants::read(bind).smoothing_length.get(i))
        });
        let before = breaking.map_or(one, |(slot, of)| of.of(*slot).value.high().get(i));
        let spalled = material.spall().map(|spall| spall.cast::<Recorded>().borne(rho, whole.pressure, before, size));
        let mut borne = match (spalled, material.damage) {
            (Some(spalled), None) => spalled,
            // What damage takes comes at the end of the step.
            (Some(spalled), Some(_)) => {
                let most = Recorded::of(-material.spall_pressure);
                let integrity = Recorded::select_lt(whole.pressure, most, spalled.integrity, before);
                Borne { pressure: whole.pressure.max(most), integrity, share: one }
            }
            (None, _) => Borne { pressure: whole.pressure, integrity: before, share: one },
        };
        let state = PressureState { pressure: borne.pressure, ..whole };
        let flow = FlowState {
            plastic_strain: plastic.strain.high().get(i),
            plastic_strain_rate: Recorded::zero(),
            temperature: temperature.high().get(i),
            pressure: state.pressure,
            compression: rho / Recorded::of(material.density),
        };
        let law = material.flow_law.cast::<Recorded>();
        let shear_modulus = law.shear_modulus(Recorded::of(material.shear_modulus), flow);
        let stored = deviator.get(i);
        // A particle of that integrity bears the stress of whole material times it, and one without any none.
        let of_whole = match breaking {
            Some(_) => {
                let inverse = Recorded::select_lt(Recorded::zero(), before, one / before, Recorded::zero());
                stored * inverse
            }
            None => stored,
        };
        let trial = if material.flow_law.is_hyperelastic() {
            neo_hookean_deviator(&Deformations::of(bind, references).displacement_gradient(i), shear_modulus)
        } else {
            trial_deviator(of_whole, &l, shear_modulus, dt)
        };
        // What springs hold is neither strain of the metal nor heat.
        let held_by_springs = match model.formulation {
            Formulation::TotalLagrangian { hourglass, .. }
                if hourglass != 0.0 && of.commits() && numerics.temperature == TemperatureSource::Energy =>
            {
                let (springs, constants) = (groups::Springs::read(bind), groups::Constants::read(bind));
                let (strength, young, least) =
                    (Recorded::of(hourglass), constants.young_modulus.get(i), springs.least_stretch.get(i));
                let spring =
                    Spring::new(strength, young, plastic.yield_stress.get(i), plastic.strain.high().get(i), least);
                let volume_by_mass = groups::Reference::read(bind).volume.high().get(i) / constants.mass.get(i);
                Some(volume_by_mass * spring.energy(springs.misfit.get(i), model.dimensions.into()))
            }
            _ => None,
        };
        let guess = plastic.increment.get(i);
        let kept: Vec<[Recorded; 2]> =
            history.iter().flat_map(|of| slots[..laws].iter().map(|slot| of.of(*slot).value.get(i))).collect();
        let held: Vec<Recorded> = kept.iter().map(|kept| kept[0]).collect();
        let mut returned =
            return_mapping_near(material.return_rule, &law, shear_modulus, trial, flow, &held, dt, guess);
        let evolved = returned.step(flow, dt);
        if let (Some(damage), Some((_, history)), true) = (&material.damage, breaking, of.commits()) {
            let [damaged, failed_at, energy] = [0, 1, 2].map(|k| history.of(slots[laws + k]).value);
            // An increment may be smaller than the resolution of a number in single precision.
            let moduli = material.moduli(shear_modulus);
            let kept = Before { damage: damaged.double(i), integrity: before.into() };
            let moduli = Moduli { young: moduli.young.into(), shear: moduli.shear.into() };
            let broken = damage.cast::<Double>().after_step(&in_pairs(&evolved), moduli, size.into(), kept);
            let severed = Recorded::select_lt(Recorded::zero(), before, broken.integrity.high, Recorded::zero());
            borne.integrity = borne.integrity.min(severed);
            let grown = Double::select_lt(Double::zero(), kept.integrity, broken.damage, kept.damage);
            damaged.set(i, [grown.high, grown.low]);
            let elastic = material.elastic_energy_of_breaking(
                returned.deviator,
                shear_modulus,
                rho,
                state.pressure,
                state.sound_speed,
            );
            let softened = broken.share.high * before * returned.plastic_work / rho;
            energy.add(i, softened + (before - borne.integrity) * elastic);
            let now = Recorded::select_lt(borne.integrity, before, step.end.value(), failed_at.high().get(i));
            let at = Recorded::select_lt(Recorded::zero(), borne.integrity, Recorded::zero(), now);
            failed_at.set(i, [at, Recorded::zero()]);
        }
        let state = match &material.damage {
            Some(damage) => {
                let [pressure, share] = damage.after.bears(state.pressure, borne.integrity);
                borne.share = share;
                PressureState { pressure, ..state }
            }
            None => state,
        };
        let mut elastic_share = one;
        if breaking.is_some() {
            let is_severed =
                |severed: Recorded, bears: Recorded| Recorded::select_lt(Recorded::zero(), before, bears, severed);
            let zero = Recorded::zero();
            returned.deviator = returned.deviator * is_severed(zero, borne.integrity);
            returned.plastic_work = returned.plastic_work * before;
            returned.plastic_strain_increment = is_severed(zero, returned.plastic_strain_increment);
            // That of an elastic law is infinite.
            let left = Recorded::select_lt(zero, borne.integrity, returned.yield_stress * borne.integrity, zero);
            returned.yield_stress = is_severed(zero, left);
            // Of the deviator, which integrity has been taken from already, in the energy of whole material.
            elastic_share = Recorded::select_lt(zero, borne.integrity, one / borne.integrity, zero);
        }
        pressures.pressure.set(i, state.pressure);
        pressures.sound_speed.set(i, state.sound_speed);
        pressures.shear_modulus.set(i, shear_modulus);
        if of.commits() {
            deviator.set(i, returned.deviator);
            plastic.strain.add(i, returned.plastic_strain_increment);
            plastic.increment.set(i, returned.plastic_strain_increment);
            plastic.yield_stress.set(i, returned.yield_stress);
            plastic.work.add(i, returned.plastic_work / rho);
            if let Some((slot, history)) = breaking {
                history.of(*slot).value.set(i, [borne.integrity, Recorded::zero()]);
            }
            if let Some(history) = history.filter(|_| laws > 0) {
                // The increment of a step may be smaller than the resolution of the sum in single precision.
                let mut values: Vec<Double> = kept.into_iter().map(Double::new).collect();
                material.flow_law.cast().evolve(&in_pairs(&evolved), &mut values);
                for (slot, value) in slots[..laws].iter().zip(values) {
                    history.of(*slot).value.set(i, [value.high, value.low]);
                }
            }
            match numerics.temperature {
                TemperatureSource::PlasticWork if material.heats() => {
                    let (beta, specific_heat) =
                        (Recorded::of(material.taylor_quinney), Recorded::of(material.specific_heat));
                    let rise = temperature_rise_from_plastic_work(beta, returned.plastic_work, rho, specific_heat);
                    temperature.add(i, rise);
                }
                TemperatureSource::PlasticWork => {}
                TemperatureSource::Energy => {
                    let mut heat = held_by_springs.map_or(e, |held| e - held);
                    if model.books_artificial_energy() {
                        let (accounts, constants) = (groups::Accounts::read(bind), groups::Constants::read(bind));
                        heat -= accounts.artificial_stress.high().get(i) / constants.mass.get(i);
                        if of == StressOf::Leapfrog {
                            heat -= half * energy.artificial_stress_rate.get(i);
                        }
                    }
                    let whole = returned.deviator * elastic_share;
                    let elastic = borne.integrity * material.elastic_energy(whole, shear_modulus, rho);
                    let cold = material.cold_energy(&material.cold_energies::<Recorded>(), rho, borne.integrity);
                    let warm = material.temperature_of_energy(heat, cold, elastic, plastic.work.high().get(i));
                    temperature.set(i, [warm, Recorded::zero()]);
                }
            }
        }
        if !of.is_read_by_forces() {
            return;
        }
        let (packed, constants) = (groups::Packed::write(bind), groups::Constants::read(bind));
        let mut pressure = state.pressure;
        if model.is_total_lagrangian() {
            let (stretch, accounts) = (groups::Stretch::write(bind), groups::Accounts::write(bind));
            let parameters = ViscosityParameters {
                alpha: Recorded::of(numerics.viscosity_alpha),
                beta: Recorded::of(numerics.viscosity_beta),
            };
            let (divergence, shortest) =
                (l[0][0] + l[1][1] + l[2][2], constants.smoothing_length.get(i) * stretch.smallest.get(i));
            let q = borne.share * bulk_viscosity(parameters, divergence, rho, state.sound_speed, shortest);
            let power = bulk_viscous_power(mean(stretch.bulk_viscosity.get(i), q), divergence, rho);
            accounts.viscous.add(i, constants.mass.get(i) * dt * power);
            stretch.bulk_viscosity.set(i, q);
            pressure += q;
            if let Formulation::TotalLagrangian { renewal: Some(bound), .. } = model.formulation
                && bound > LARGEST_STRETCH_OF_A_LIQUID
            {
                let is_liquid = material.liquid(temperature.high().get(i), || {
                    let elastic = material.elastic_energy(returned.deviator, Recorded::of(material.shear_modulus), rho);
                    let cold = material.cold_energy(&material.cold_energies::<Recorded>(), rho, borne.integrity);
                    material.temperature_of_energy(e, cold, elastic, plastic.work.high().get(i))
                });
                let f = groups::Deformation::read(bind).deformation.high().get(i);
                let flows = is_liquid * stretched(&f, Recorded::of(LARGEST_STRETCH_OF_A_LIQUID));
                stretch.is_beyond.set(i, stretch.is_beyond.get(i).max(flows));
            }
        }
        let sigma = (returned.deviator - SymmetricTensor::isotropic(pressure)) * stress_scale(numerics.pair_form, rho);
        packed.stress.set(i, sigma);
        if numerics.artificial_stress.is_some() {
            let left = material.bounded_pressure::<Recorded>().energy_left(e);
            let repulsion =
                artificial_stress(sigma, constants.artificial_stress.get(i) * left, model.dimensions.into());
            packed.artificial_stress.set(i, repulsion);
        }
        if numerics.balsara {
            packed.balsara.set(i, balsara(&l, state.sound_speed, constants.smoothing_length.get(i)));
        }
        packed.sound_speed.set(i, state.sound_speed);
    })
}

/// A step for a law whose numbers are pairs.
fn in_pairs(step: &FlowStep<Recorded>) -> FlowStep<Double> {
    let FlowState { plastic_strain, plastic_strain_rate, temperature, pressure, compression } = step.state;
    FlowStep {
        state: FlowState {
            plastic_strain: plastic_strain.into(),
            plastic_strain_rate: plastic_strain_rate.into(),
            temperature: temperature.into(),
            pressure: pressure.into(),
            compression: compression.into(),
        },
        deviator: SymmetricTensor::from_array(step.deviator.to_array().map(Double::from)),
        plastic_strain_increment: step.plastic_strain_increment.into(),
        dt: step.dt.into(),
    }
}

/// Heats the particles of material `k` by the friction of the step.
pub(in crate::engine) fn warm(model: &Model, k: usize, count: usize) -> Result<Recording, KernelFault> {
    let specific_heat = model.materials[k].specific_heat;
    recording(&format!("warm_by_friction_{k}"), count, |bind, thread| {
        let i = bind.indices(Group::Members(k)).at(thread);
        let (external, temperature, step) =
            (groups::External::read(bind), groups::Temperature::write(bind).temperature, groups::Step::shared(bind));
        let dt = step.dt.value();
        temperature.add(i, external.friction_heat.get(i) * dt / Recorded::of(specific_heat));
    })
}
