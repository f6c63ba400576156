//! The stress of the particles of a material: equation of state, trial stress, return mapping, heat.

use super::pairs::compressed;
use super::reference::{Deformations, References, Separated};
use crate::engine::columns::{
    Binder, Compensated, Group, Member, Read, ReadColumns, ReadShared, Recording, Shared, SymmetricColumns, Write,
    WriteColumns, added, groups, recording,
};
use crate::record::{Double, Index, KernelFault, Recorded};
use sphorge_engine::model::{Formulation, Material, Model, TemperatureSource};
use sphorge_engine::particles::HistoryVariables;
use sphorge_physics::artificial_stress::artificial_stress;
use sphorge_physics::damage::{Before, Moduli};
use sphorge_physics::eos::PressureState;
use sphorge_physics::flow::{FlowState, FlowStep};
use sphorge_physics::heat::temperature_rise_from_plastic_work;
use sphorge_physics::hourglass::Spring;
use sphorge_physics::hyperelastic::neo_hookean_deviator;
use sphorge_physics::integrity::{Borne, Spall, share_while_opening, smeared_width};
use sphorge_physics::pair::{mean, stress_scale};
use sphorge_physics::return_mapping::{Returned, return_mapping_near};
use sphorge_physics::stress::trial_deviator;
use sphorge_physics::total_lagrangian::{LARGEST_STRETCH_OF_A_LIQUID, stretched};
use sphorge_physics::viscosity::{
    FilteredDivergence, ViscosityParameters, balsara, bulk_viscosity, bulk_viscous_power, damping_rate, shock_share,
};
use sphorge_physics::{Real, SymmetricTensor, Tensor};

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
    let name = match of {
        StressOf::End => format!("commit_stress_{k}"),
        StressOf::Middle | StressOf::Leapfrog => format!("stress_{k}"),
    };
    recording(&name, count, |bind, thread| {
        let i = bind.indices(Group::Members(k)).at(thread);
        let point = Point::of(bind, (model, k), of, i);
        let (rho, e) = point.density_and_energy(bind);
        let material = point.material;
        // A pressure is small compared with the bulk modulus: from densities in single precision it would be accurate
        // only to some 10 kPa.
        let state = material.bounded_pressure::<Double>().at(Double::new(rho), Double::new(e));
        let whole = PressureState { pressure: state.pressure.high, sound_speed: state.sound_speed.high };
        let ([rho, _], [e, _]) = (rho, e);
        let history = OfHistory::of(bind, &point, k);
        let mut borne = point.spalled(&history, rho, whole.pressure);
        let state = PressureState { pressure: borne.pressure, ..whole };
        let flow = FlowState {
            plastic_strain: point.plastic.strain.high().get(i),
            plastic_strain_rate: Recorded::zero(),
            temperature: point.temperature.high().get(i),
            pressure: state.pressure,
            compression: rho / Recorded::of(material.density),
        };
        let law = material.flow_law.cast::<Recorded>();
        let shear_modulus = law.shear_modulus(Recorded::of(material.shear_modulus), flow);
        let trial = point.trial(bind, references, &history, shear_modulus);
        let held_by_springs = point.energy_of_springs(bind);
        let guess = point.plastic.increment.get(i);
        let kept = history.of_flow_law(i);
        let held: Vec<Recorded> = kept.iter().map(|kept| kept[0]).collect();
        let rule = material.return_rule;
        let mut returned = return_mapping_near(rule, &law, shear_modulus, trial, flow, &held, point.dt, guess);
        let evolved = returned.step(flow, point.dt);
        point.grow_damage(&history, &mut borne, &evolved, (&returned, shear_modulus, rho, state));
        let state = match &material.damage {
            Some(damage) => {
                let [pressure, share] = damage.after.bears(state.pressure, borne.integrity);
                borne.share = share;
                PressureState { pressure, ..state }
            }
            None => state,
        };
        let of_whole = material.opens_without_shear().then(|| history.whole(point.deviator.get(i)));
        let elastic_share = history.take_integrity(&mut returned, borne.integrity, of_whole);
        point.pressures.pressure.set(i, state.pressure);
        point.pressures.sound_speed.set(i, state.sound_speed);
        point.pressures.shear_modulus.set(i, shear_modulus);
        if of.commits() {
            point.commit(&history, (&returned, &evolved), kept, (rho, borne.integrity));
            let energies = Energies { e, held_by_springs, elastic_share, shear_modulus };
            point.heat(bind, &energies, &returned, (rho, borne.integrity));
        }
        if of.is_read_by_forces() {
            point.pack(bind, references, &returned, (rho, e), (state, &borne));
        }
    })
}

/// The columns of a particle whose stress is computed.
struct Point<'a> {
    model: &'a Model,
    material: &'a Material,
    of: StressOf,
    i: Index,
    step: groups::Step<Shared>,
    density: Compensated<Write>,
    energy: groups::Energy<Read>,
    deviator: SymmetricColumns<Write>,
    plastic: groups::Plastic<Write>,
    temperature: Compensated<Write>,
    pressures: groups::Pressure<Write>,
    half: Recorded,
    dt: Recorded,
    /// Velocity gradient, 1/s.
    l: Tensor<Recorded>,
}

/// The history of a particle, if its material has any.
struct OfHistory {
    history: Option<groups::History<Write>>,
    /// Numbers of the variables of the material: those of the flow law, of damage, and integrity.
    slots: Vec<usize>,
    /// Number of those of the flow law.
    laws: usize,
    /// Integrity, if the material breaks.
    breaking: Option<(usize, groups::History<Write>)>,
    /// Width over which what breaks is smeared, m, and integrity before the step.
    size: Recorded,
    before: Recorded,
}

impl OfHistory {
    fn of(bind: &mut Binder<'_>, point: &Point<'_>, k: usize) -> Self {
        let (model, i) = (point.model, point.i);
        let slots = HistoryVariables::of(model).slots[k].clone();
        let history = (!slots.is_empty()).then(|| groups::History::write(bind));
        // Integrity is kept behind the variables of the flow law and of damage.
        let laws = point.material.flow_law.history().len();
        let breaking = slots.last().copied().filter(|_| point.material.breaks()).zip(history);
        let one = Recorded::one();
        let size = breaking.map_or(one, |_| {
            smeared_width(model.numerics.kernel.support(), groups::Constants::read(bind).smoothing_length.get(i))
        });
        let before = breaking.map_or(one, |(slot, of)| of.of(slot).value.high().get(i));
        Self { history, slots, laws, breaking, size, before }
    }

    /// History variables of the flow law.
    fn of_flow_law(&self, i: Index) -> Vec<[Recorded; 2]> {
        let values = |of: &groups::History<Write>| {
            let of = *of;
            self.slots[..self.laws].iter().map(move |slot| of.of(*slot).value.get(i))
        };
        self.history.iter().flat_map(values).collect()
    }

    /// A stored deviator as whole material would have it: a particle bears that times its integrity, and without any none.
    fn whole(&self, stored: SymmetricTensor<Recorded>) -> SymmetricTensor<Recorded> {
        let (before, zero) = (self.before, Recorded::zero());
        match self.breaking {
            Some(_) => stored * Recorded::select_lt(zero, before, Recorded::one() / before, zero),
            None => stored,
        }
    }

    /// Takes from what a return mapping found what the particle does not bear; returns by what the deviator is to be
    /// multiplied in the energy of whole material. `of_whole` is that of whole material before the step, if it does not grow while the particle opens.
    fn take_integrity(
        &self,
        returned: &mut Returned<Recorded>,
        integrity: Recorded,
        of_whole: Option<SymmetricTensor<Recorded>>,
    ) -> Recorded {
        if self.breaking.is_none() {
            return Recorded::one();
        }
        let opened = of_whole
            .map_or(Recorded::one(), |was| share_while_opening((was, self.before), (returned.deviator, integrity)));
        let (before, zero) = (self.before, Recorded::zero());
        let is_severed =
            |severed: Recorded, bears: Recorded| Recorded::select_lt(Recorded::zero(), before, bears, severed);
        returned.deviator = returned.deviator * is_severed(zero, integrity * opened);
        returned.plastic_work = returned.plastic_work * before;
        returned.plastic_strain_increment = is_severed(zero, returned.plastic_strain_increment);
        // That of an elastic law is infinite.
        let left = Recorded::select_lt(zero, integrity, returned.yield_stress * integrity, zero);
        returned.yield_stress = is_severed(zero, left);
        let borne = integrity * opened;
        Recorded::select_lt(zero, borne, Recorded::one() / borne, zero)
    }
}

/// What temperature follows from.
struct Energies {
    /// Internal energy, J/kg, and what hourglass springs hold of it.
    e: Recorded,
    held_by_springs: Option<Recorded>,
    /// By what the deviator is multiplied in the energy of whole material.
    elastic_share: Recorded,
    shear_modulus: Recorded,
}

impl<'a> Point<'a> {
    fn of(bind: &mut Binder<'_>, (model, k): (&'a Model, usize), of: StressOf, i: Index) -> Self {
        let step = groups::Step::shared(bind);
        let density = groups::Density::write(bind).density;
        let (gradient, energy) = (groups::Gradient::read(bind).velocity_gradient, groups::Energy::read(bind));
        let (deviator, plastic) = (groups::Deviator::write(bind).deviator, groups::Plastic::write(bind));
        let (temperature, pressures) = (groups::Temperature::write(bind).temperature, groups::Pressure::write(bind));
        let half = step.half.value();
        let dt = if of.commits() { step.dt.value() } else { half };
        let l = gradient.get(i);
        let material = &model.materials[k];
        Self { model, material, of, i, step, density, energy, deviator, plastic, temperature, pressures, half, dt, l }
    }

    /// Density and internal energy with their low parts, at the time of the stress.
    fn density_and_energy(&self, bind: &mut Binder<'_>) -> ([Recorded; 2], [Recorded; 2]) {
        let (i, energy) = (self.i, self.energy);
        match self.of {
            StressOf::End => {
                let after = compressed(groups::BaseDensity::read(bind).density.get(i), &self.l, self.dt);
                self.density.set(i, after);
                (after, energy.energy.get(i))
            }
            StressOf::Middle | StressOf::Leapfrog => {
                (self.density.get(i), added(energy.energy.get(i), self.half * energy.rate.get(i)))
            }
        }
    }

    /// What the particle bears of its pressure, and what is left of its integrity.
    fn spalled(&self, history: &OfHistory, rho: Recorded, pressure: Recorded) -> Borne<Recorded> {
        let (before, one) = (history.before, Recorded::one());
        let borne = |spall: Spall<Recorded>| spall.borne(rho, pressure, before, history.size);
        match (self.material.spall().map(|spall| borne(spall.cast())), self.material.damage) {
            (Some(spalled), None) => spalled,
            // What damage takes comes at the end of the step.
            (Some(spalled), Some(_)) => {
                let most = Recorded::of(-self.material.spall_pressure);
                let integrity = Recorded::select_lt(pressure, most, spalled.integrity, before);
                Borne { pressure: pressure.max(most), integrity, share: one }
            }
            (None, _) => Borne { pressure, integrity: before, share: one },
        }
    }

    /// Elastic trial deviator of whole material, Pa.
    fn trial(
        &self,
        bind: &mut Binder<'_>,
        references: References,
        history: &OfHistory,
        shear_modulus: Recorded,
    ) -> SymmetricTensor<Recorded> {
        let stored = self.deviator.get(self.i);
        let of_whole = history.whole(stored);
        if self.material.flow_law.is_hyperelastic() {
            neo_hookean_deviator(&Deformations::of(bind, references).displacement_gradient(self.i), shear_modulus)
        } else {
            trial_deviator(of_whole, &self.l, shear_modulus, self.dt)
        }
    }

    /// What springs hold, J/kg, which is neither strain of the metal nor heat.
    fn energy_of_springs(&self, bind: &mut Binder<'_>) -> Option<Recorded> {
        let (model, plastic, i) = (self.model, self.plastic, self.i);
        match model.formulation {
            Formulation::TotalLagrangian { hourglass, faces, .. }
                if hourglass != 0.0 && self.of.commits() && model.numerics.temperature == TemperatureSource::Energy =>
            {
                let (springs, constants) = (groups::Springs::read(bind), groups::Constants::read(bind));
                let (strength, young, least) =
                    (Recorded::of(hourglass), constants.young_modulus.get(i), springs.least_stretch.get(i));
                let (yield_stress, strain) = (plastic.yield_stress.get(i), plastic.strain.high().get(i));
                let spring = Spring::new(faces.counted(), strength, young, yield_stress, strain, least);
                let volume_by_mass = groups::Reference::read(bind).volume.high().get(i) / constants.mass.get(i);
                Some(volume_by_mass * spring.energy(springs.misfit.get(i), model.dimensions.into()))
            }
            _ => None,
        }
    }

    /// Damage of the step, and the energy that it dissipates.
    fn grow_damage(
        &self,
        history: &OfHistory,
        borne: &mut Borne<Recorded>,
        evolved: &FlowStep<Recorded>,
        (returned, shear_modulus, rho, state): (&Returned<Recorded>, Recorded, Recorded, PressureState<Recorded>),
    ) {
        let (material, i, before) = (self.material, self.i, history.before);
        let (Some(damage), Some((_, of)), true) = (&material.damage, history.breaking, self.of.commits()) else {
            return;
        };
        let [damaged, failed_at, energy] = [0, 1, 2].map(|k| of.of(history.slots[history.laws + k]).value);
        // An increment may be smaller than the resolution of a number in single precision.
        let moduli = material.moduli(shear_modulus);
        let kept = Before { damage: damaged.double(i), integrity: before.into() };
        let moduli = Moduli { young: moduli.young.into(), shear: moduli.shear.into() };
        let broken = damage.cast::<Double>().after_step(&in_pairs(evolved), moduli, history.size.into(), kept);
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
        let now = Recorded::select_lt(borne.integrity, before, self.step.end.value(), failed_at.high().get(i));
        let at = Recorded::select_lt(Recorded::zero(), borne.integrity, Recorded::zero(), now);
        failed_at.set(i, [at, Recorded::zero()]);
    }

    /// Stores what the following steps start from.
    fn commit(
        &self,
        history: &OfHistory,
        (returned, evolved): (&Returned<Recorded>, &FlowStep<Recorded>),
        kept: Vec<[Recorded; 2]>,
        (rho, integrity): (Recorded, Recorded),
    ) {
        let (i, plastic) = (self.i, self.plastic);
        self.deviator.set(i, returned.deviator);
        plastic.strain.add(i, returned.plastic_strain_increment);
        plastic.increment.set(i, returned.plastic_strain_increment);
        plastic.yield_stress.set(i, returned.yield_stress);
        plastic.work.add(i, returned.plastic_work / rho);
        if let Some((slot, of)) = history.breaking {
            of.of(slot).value.set(i, [integrity, Recorded::zero()]);
        }
        if let Some(of) = history.history.filter(|_| history.laws > 0) {
            // The increment of a step may be smaller than the resolution of the sum in single precision.
            let mut values: Vec<Double> = kept.into_iter().map(Double::new).collect();
            self.material.flow_law.cast().evolve(&in_pairs(evolved), &mut values);
            for (slot, value) in history.slots[..history.laws].iter().zip(values) {
                of.of(*slot).value.set(i, [value.high, value.low]);
            }
        }
    }

    /// Temperature at the end of the step.
    fn heat(
        &self,
        bind: &mut Binder<'_>,
        energies: &Energies,
        returned: &Returned<Recorded>,
        (rho, integrity): (Recorded, Recorded),
    ) {
        let (material, i) = (self.material, self.i);
        match self.model.numerics.temperature {
            TemperatureSource::PlasticWork if material.heats() => {
                let (beta, specific_heat) =
                    (Recorded::of(material.taylor_quinney), Recorded::of(material.specific_heat));
                let rise = temperature_rise_from_plastic_work(beta, returned.plastic_work, rho, specific_heat);
                self.temperature.add(i, rise);
            }
            TemperatureSource::PlasticWork => {}
            TemperatureSource::Energy => {
                let mut heat = energies.held_by_springs.map_or(energies.e, |held| energies.e - held);
                if self.model.books_artificial_energy() {
                    let (accounts, constants) = (groups::Accounts::read(bind), groups::Constants::read(bind));
                    heat -= accounts.artificial_stress.high().get(i) / constants.mass.get(i);
                    if self.of == StressOf::Leapfrog {
                        heat -= self.half * self.energy.artificial_stress_rate.get(i);
                    }
                }
                let whole = returned.deviator * energies.elastic_share;
                let elastic = integrity * material.elastic_energy(whole, energies.shear_modulus, rho);
                let cold = material.cold_energy(&material.cold_energies::<Recorded>(), rho, integrity);
                let warm = material.temperature_of_energy(heat, cold, elastic, self.plastic.work.high().get(i));
                self.temperature.set(i, [warm, Recorded::zero()]);
            }
        }
    }

    /// Data of a neighbour that forces read.
    fn pack(
        &self,
        bind: &mut Binder<'_>,
        references: References,
        returned: &Returned<Recorded>,
        (rho, e): (Recorded, Recorded),
        (state, borne): (PressureState<Recorded>, &Borne<Recorded>),
    ) {
        let (model, i) = (self.model, self.i);
        let numerics = &model.numerics;
        let (packed, constants) = (groups::Packed::write(bind), groups::Constants::read(bind));
        let mut pressure = state.pressure;
        if model.is_total_lagrangian() {
            let stretch = groups::Stretch::write(bind);
            pressure +=
                self.bulk_viscosity(bind, references, (stretch, constants), (rho, state.sound_speed, borne.share));
            self.mark_liquid(bind, stretch, returned, (rho, e, borne.integrity));
        }
        let sigma = (returned.deviator - SymmetricTensor::isotropic(pressure)) * stress_scale(numerics.pair_form, rho);
        packed.stress.set(i, sigma);
        if numerics.artificial_stress.is_some() {
            let left = self.material.bounded_pressure::<Recorded>().energy_left(e);
            let repulsion =
                artificial_stress(sigma, constants.artificial_stress.get(i) * left, model.dimensions.into());
            packed.artificial_stress.set(i, repulsion);
        }
        if numerics.balsara {
            packed.balsara.set(i, balsara(&self.l, state.sound_speed, constants.smoothing_length.get(i)));
        }
        packed.sound_speed.set(i, state.sound_speed);
    }

    /// Bulk viscosity of the total Lagrangian form, Pa, of which a particle bears a share; its heat is booked.
    fn bulk_viscosity(
        &self,
        bind: &mut Binder<'_>,
        references: References,
        (stretch, constants): (groups::Stretch<Write>, groups::Constants<Read>),
        (rho, sound_speed, share): (Recorded, Recorded, Recorded),
    ) -> Recorded {
        let (numerics, l, i) = (&self.model.numerics, &self.l, self.i);
        let accounts = groups::Accounts::write(bind);
        let parameters = ViscosityParameters {
            alpha: Recorded::of(numerics.viscosity_alpha),
            beta: Recorded::of(numerics.viscosity_beta),
        };
        let (divergence, shortest) =
            (l[0][0] + l[1][1] + l[2][2], constants.smoothing_length.get(i) * stretch.smallest.get(i));
        let initial = constants.smoothing_length.get(i);
        let shocks = Recorded::of(numerics.viscosity_of_shocks);
        let in_shocks = match numerics.viscosity_of_shocks > 0.0 {
            true => shock_share(l, sound_speed, shortest),
            false => Recorded::one(),
        };
        let mu = shortest * (-divergence).max(Recorded::zero());
        let rate = damping_rate(parameters, shocks, in_shocks, sound_speed, mu, shortest, initial);
        stretch.damping_rate.set(i, rate);
        if numerics.viscosity_of_shocks > 0.0 {
            let at_rest = constants.mass.get(i) / groups::Reference::read(bind).volume.high().get(i);
            stretch.impedance.set(i, share * in_shocks * sound_speed * at_rest);
        }
        let last = FilteredDivergence { once: stretch.divergence_once.get(i), twice: stretch.divergence_twice.get(i) };
        let (filtered, on_short_waves) = last.after(divergence, self.dt, shortest / sound_speed);
        stretch.divergence_once.set(i, filtered.once);
        stretch.divergence_twice.set(i, filtered.twice);
        // What cracks, or has come apart, lets go at once: all waves are damped.
        let acts_on_all = numerics.viscosity_of_all_waves || self.material.breaks();
        let on_short_waves = match (Separated::of(bind, self.model, references), acts_on_all) {
            (_, true) => Recorded::one(),
            (None, false) => on_short_waves,
            (Some(apart), false) => on_short_waves.max(apart.has_separated(i)),
        };
        let acting = ViscosityParameters { alpha: on_short_waves * parameters.alpha, beta: parameters.beta };
        let q = share * bulk_viscosity(acting, divergence, rho, sound_speed, shortest);
        let power = bulk_viscous_power(mean(stretch.bulk_viscosity.get(i), q), divergence, rho);
        accounts.viscous.add(i, constants.mass.get(i) * self.dt * power);
        stretch.bulk_viscosity.set(i, q);
        q
    }

    /// Marks a particle that has molten and is deformed farther than a liquid may be, where solids may be deformed
    /// farther.
    fn mark_liquid(
        &self,
        bind: &mut Binder<'_>,
        stretch: groups::Stretch<Write>,
        returned: &Returned<Recorded>,
        (rho, e, integrity): (Recorded, Recorded, Recorded),
    ) {
        let (material, i) = (self.material, self.i);
        let Formulation::TotalLagrangian { renewal: Some(bound), .. } = self.model.formulation else { return };
        if bound <= LARGEST_STRETCH_OF_A_LIQUID {
            return;
        }
        let is_liquid = material.liquid(self.temperature.high().get(i), || {
            let elastic = material.elastic_energy(returned.deviator, Recorded::of(material.shear_modulus), rho);
            let cold = material.cold_energy(&material.cold_energies::<Recorded>(), rho, integrity);
            material.temperature_of_energy(e, cold, elastic, self.plastic.work.high().get(i))
        });
        let f = groups::Deformation::read(bind).deformation.high().get(i);
        let flows = is_liquid * stretched(&f, Recorded::of(LARGEST_STRETCH_OF_A_LIQUID));
        stretch.is_beyond.set(i, stretch.is_beyond.get(i).max(flows));
    }
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
