//! The step of a block of particles from the velocity gradient to the stress: elastic trial, integrity, and on SIMD vectors the flow law of
//! the particles that may yield.

use super::stress_columns::{ElasticInputs, StressColumns};
use crate::lanes::{Instructions, Job, Lanes, run};
use crate::model::{Material, TemperatureSource};
use crate::neighbors::{BLOCK, PAD};
use sphorge_physics::damage::{Before, KEPT};
use sphorge_physics::eos::ColdEnergy;
use sphorge_physics::flow::{FlowLaw, FlowState, FlowStep};
use sphorge_physics::integrity::{share_while_opening, smeared_width};
use sphorge_physics::return_mapping::{Returned, return_mapping_near};
use sphorge_physics::{SymmetricTensor, heat};

/// Data that a plastic step of a block of particles reads and writes.
pub(super) struct FlowColumns<'a> {
    plastic_strain: &'a mut [f64],
    plastic_strain_increment: &'a mut [f64],
    yield_stress: &'a mut [f64],
    plastic_work: &'a mut [f64],
    temperature: &'a mut [f64],
    /// History variables, particle by particle.
    history: &'a mut [f64],
}

/// Chunks of the columns of a [`FlowColumns`], in its order.
pub(super) type FlowChunks<'a> =
    (&'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut Vec<f64>);

/// Largest number of history variables of a law.
const MOST_HISTORY: usize = 16;

/// Parameters of a stress update that are the same for all particles.
#[derive(Clone, Copy)]
pub(super) struct StressStep<'a> {
    pub(super) materials: &'a [Material],
    pub(super) temperature: TemperatureSource,
    /// Whether the temperature of a particle that stays elastic does not change.
    pub(super) only_flow_heats: bool,
    pub(super) instructions: Instructions,
    /// Whether plastic strain and heat are updated to the end of the step; otherwise only the stress is.
    pub(super) commit: bool,
    /// For each material the indices of what it keeps among the history variables of a particle.
    pub(super) slots: &'a [Vec<usize>],
    /// History variables of a particle.
    pub(super) history_width: usize,
    /// By material.
    pub(super) cold_energies: &'a [ColdEnergy<f64>],
    /// Whether some material loses its integrity.
    pub(super) breaks: bool,
    /// Support of the kernel over the smoothing length.
    pub(super) support: f64,
    /// End of the step, s.
    pub(super) end: f64,
}

impl<'a> FlowColumns<'a> {
    pub(super) fn new(chunks: FlowChunks<'a>) -> Self {
        let (plastic_strain, plastic_strain_increment, yield_stress, plastic_work, temperature, history) = chunks;
        Self { plastic_strain, plastic_strain_increment, yield_stress, plastic_work, temperature, history }
    }

    /// Advances the stress by a step; `columns` have density and energy after it.
    #[inline(always)]
    pub(super) fn take_step(
        &mut self,
        step: &StressStep<'_>,
        columns: &mut StressColumns,
        particles: &ElasticInputs<'_>,
    ) {
        self.know_yield_stresses(step, columns, particles.material);
        self.set_shear_moduli(step.materials, columns, particles.material);
        if step.breaks {
            self.weaken(step, columns, particles.material);
        }
        let elastic = columns.take_elastic_step(step.instructions, step.materials, particles);
        particles.set_hyperelastic(step.materials, columns);
        if step.breaks {
            self.open(step, columns, particles);
        }
        // An elastic step changes nothing here, and adding zeros would read and write as much memory again.
        let mut left = !elastic & (u128::MAX >> (BLOCK - particles.material.len()));
        if step.breaks {
            for k in 0..particles.material.len() {
                if left >> k & 1 == 1 && columns.integrity_before[k] == 0.0 {
                    left &= !(1 << k);
                    self.heat_severed(k, step, columns, particles.material[k] as usize);
                }
            }
        }
        if left != 0 {
            run(step.instructions, ReturnToYield { flow: self, step, columns, particles, left });
        }
        if step.breaks {
            self.sever(step, columns, particles);
        }
    }

    /// The place of the integrity of particle `k` in the history of the block, if its material breaks.
    #[inline(always)]
    fn place_of_integrity(step: &StressStep<'_>, k: usize, of: &[u32]) -> Option<usize> {
        let material = of[k] as usize;
        let slot = step.materials[material].breaks().then(|| step.slots[material].last()).flatten()?;
        Some(k * step.history_width + slot)
    }

    /// Reads the integrities at the start of the step: a particle has that share of its shear modulus.
    #[inline(always)]
    fn weaken(&self, step: &StressStep<'_>, columns: &mut StressColumns, of: &[u32]) {
        for k in 0..of.len() {
            let before = Self::place_of_integrity(step, k, of).map_or(1.0, |place| self.history[place]);
            columns.integrity_before[k] = before;
            columns.shear_modulus[k] *= before;
        }
    }

    /// Places of the variables of damage of particle `k` in the history of the block, in their order.
    #[inline(always)]
    fn places_of_damage(step: &StressStep<'_>, k: usize, material: usize) -> Option<[usize; KEPT.len()]> {
        let slots = step.slots[material].get(step.materials[material].flow_law.history().len()..)?;
        Some(slots.first_chunk::<{ KEPT.len() }>()?.map(|slot| k * step.history_width + slot))
    }

    /// Takes from the pressures what particles do not bear for their spall pressure, and finds the integrities that this leaves. What damage takes
    /// comes at the end of the step ([`Self::sever`]): until then such material is whole.
    #[inline(always)]
    fn open(&self, step: &StressStep<'_>, columns: &mut StressColumns, particles: &ElasticInputs<'_>) {
        for (k, material) in particles.material.iter().enumerate() {
            let (before, pressure) = (columns.integrity_before[k], columns.pressure[k]);
            let material = &step.materials[*material as usize];
            (columns.integrity[k], columns.share[k]) = (before, 1.0);
            let is_damaged = material.damage.is_some();
            if pressure < -if is_damaged { 1.0 } else { before } * material.spall_pressure {
                let size = smeared_width(step.support, particles.smoothing_length[k]);
                let borne = material.borne(columns.density[k], pressure, before, size);
                (columns.pressure[k], columns.integrity[k]) = (borne.pressure, borne.integrity);
                columns.share[k] = borne.share;
                if is_damaged {
                    columns.pressure[k] = -material.spall_pressure;
                }
            }
        }
    }

    /// Takes from the deviators what has been lost of the integrity in the step, and from the pressures what damaged material does not bear.
    #[inline(always)]
    fn sever(&mut self, step: &StressStep<'_>, columns: &mut StressColumns, particles: &ElasticInputs<'_>) {
        let of = particles.material;
        for k in 0..of.len() {
            let (before, after) = (columns.integrity_before[k], columns.integrity[k]);
            let material = of[k] as usize;
            let damage = step.materials[material].damage.as_ref();
            if let (true, true, Some([_, failed_at, energy])) =
                (after < before, step.commit && damage.is_some(), Self::places_of_damage(step, k, material))
            {
                let state = (columns.deviator_of(k), columns.shear_modulus[k], columns.density[k], columns.pressure[k]);
                let (whole, sound_speed) = (1.0 / before, columns.sound_speed[k]);
                let elastic = step.materials[material].elastic_energy_of_breaking(
                    state.0 * whole,
                    state.1 * whole,
                    state.2,
                    state.3,
                    sound_speed,
                );
                self.history[energy] += (before - after) * elastic;
                if after == 0.0 {
                    self.history[failed_at] = step.end;
                }
            }
            if after < before {
                let deviator = columns.deviator_of(k);
                let opened = if step.materials[material].opens_without_shear() {
                    share_while_opening((particles.deviator[k], before), (deviator, after))
                } else {
                    1.0
                };
                columns.set_deviator(k, deviator * (opened * (after / before)));
                if let (true, Some(place)) = (step.commit, Self::place_of_integrity(step, k, of)) {
                    self.history[place] = after;
                    // That of an elastic law is infinite.
                    self.yield_stress[k] = if after > 0.0 { self.yield_stress[k] * (after / before) } else { 0.0 };
                }
            }
            if let Some(damage) = damage {
                [columns.pressure[k], columns.share[k]] = damage.after.bears(columns.pressure[k], after);
            }
        }
    }

    /// Sets the known yield stresses: those of a last step without plastic flow, unless heat or the law may have
    /// changed them.
    #[inline(always)]
    fn know_yield_stresses(&self, step: &StressStep<'_>, columns: &mut StressColumns, of: &[u32]) {
        let last = self.plastic_strain_increment.iter().zip(&*self.yield_stress);
        for (known, (increment, yield_stress)) in columns.known_yield_stress.iter_mut().zip(last) {
            *known = if step.only_flow_heats && *increment == 0.0 { *yield_stress } else { 0.0 };
        }
        if step.materials.iter().any(Material::changes_without_flow) {
            for (known, material) in columns.known_yield_stress.iter_mut().zip(of) {
                if step.materials[*material as usize].changes_without_flow() {
                    *known = 0.0;
                }
            }
        }
    }

    /// The shear moduli of a step, from plastic strain and temperature at its start and density and pressure at its
    /// end, as in the return mapping.
    #[inline(always)]
    fn set_shear_moduli(&self, materials: &[Material], columns: &mut StressColumns, of: &[u32]) {
        for (modulus, material) in columns.shear_modulus.iter_mut().zip(of) {
            *modulus = materials[*material as usize].shear_modulus;
        }
        if materials.iter().any(|material| material.flow_law.shear_modulus_varies()) {
            for (k, material) in of.iter().enumerate() {
                let material = &materials[*material as usize];
                let density = columns.density[k];
                let whole = material.pressure(density, columns.energy[k]).pressure;
                // Tension without its cut-off: it changes the modulus little, and integrity is not known yet.
                let pressure = whole.max(-material.spall_pressure);
                let state = material.flow_state(self.plastic_strain[k], self.temperature[k], density, pressure);
                columns.shear_modulus[k] = material.flow_law.shear_modulus(material.shear_modulus, state);
            }
        }
    }

    /// The step of a particle that bears no shear any more.
    #[inline(always)]
    fn heat_severed(&mut self, k: usize, step: &StressStep<'_>, columns: &mut StressColumns, index: usize) {
        let (material, cold) = (&step.materials[index], &step.cold_energies[index]);
        columns.set_deviator(k, SymmetricTensor::zero());
        if !step.commit {
            return;
        }
        (self.plastic_strain_increment[k], self.yield_stress[k]) = (0.0, 0.0);
        if step.temperature == TemperatureSource::Energy {
            let energy = columns.energy[k] - columns.numerical_energy[k];
            let cold = material.cold_energy(cold, columns.density[k], 0.0);
            self.temperature[k] = material.temperature_of_energy(energy, cold, 0.0, self.plastic_work[k]);
        }
    }
}

/// Up to as many particles of a block as a SIMD vector has lanes.
#[derive(Clone, Copy)]
pub(super) struct Places {
    /// Their places; the last is repeated behind them.
    at: [usize; PAD],
    count: usize,
    /// Whether they fill the vector and lie side by side.
    is_run: bool,
}

impl Places {
    /// The first of `places`, as many as a vector has.
    #[inline(always)]
    pub(super) fn of<L: Lanes>(places: &[u8]) -> Self {
        let count = places.len().min(L::WIDTH);
        let mut at = [places[count - 1] as usize; PAD];
        for lane in 0..count {
            at[lane] = places[lane] as usize;
        }
        Self { at, count, is_run: count == L::WIDTH && at[count - 1] - at[0] == count - 1 }
    }

    /// Their numbers in a column whose entry of particle `k` is the one at `stride k + first`.
    #[inline(always)]
    fn load_strided<L: Lanes<Element = f64>>(&self, column: &[f64], stride: usize, first: usize) -> L {
        let mut values = [0.0; PAD];
        for lane in 0..L::WIDTH {
            values[lane] = column[stride * self.at[lane] + first];
        }
        L::load(&values)
    }

    /// Their numbers in a column.
    #[inline(always)]
    fn load<L: Lanes<Element = f64>>(&self, column: &[f64]) -> L {
        if self.is_run { L::load(&column[self.at[0]..]) } else { self.load_strided(column, 1, 0) }
    }

    #[inline(always)]
    fn store_strided<L: Lanes<Element = f64>>(&self, values: L, column: &mut [f64], stride: usize, first: usize) {
        let mut lanes = [0.0; PAD];
        values.store(&mut lanes);
        for lane in 0..self.count {
            column[stride * self.at[lane] + first] = lanes[lane];
        }
    }

    #[inline(always)]
    fn store<L: Lanes<Element = f64>>(&self, values: L, column: &mut [f64]) {
        if self.is_run {
            values.store(&mut column[self.at[0]..]);
        } else {
            self.store_strided(values, column, 1, 0);
        }
    }

    #[inline(always)]
    fn add<L: Lanes<Element = f64>>(&self, values: L, column: &mut [f64]) {
        self.store(self.load::<L>(column) + values, column);
    }
}

/// A material with its constants in every lane.
struct LaneMaterial<'a, L> {
    material: &'a Material,
    law: FlowLaw<L>,
    cold: ColdEnergy<L>,
    /// Of what the flow law, damage and integrity keep, in the history of a particle.
    slots: &'a [usize],
}

/// The return of particles to their yield surface, and what follows from it.
struct ReturnToYield<'a, 'b> {
    flow: &'a mut FlowColumns<'b>,
    step: &'a StressStep<'a>,
    columns: &'a mut StressColumns,
    particles: &'a ElasticInputs<'a>,
    /// Bits of the particles.
    left: u128,
}

impl Job<f64> for ReturnToYield<'_, '_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        let Self { flow, step, columns, particles, mut left } = self;
        while left != 0 {
            // Those of one material together.
            let index = particles.material[left.trailing_zeros() as usize];
            let (mut places, mut count, mut others) = ([0; BLOCK], 0, 0);
            while left != 0 {
                let k = left.trailing_zeros();
                left &= left - 1;
                if particles.material[k as usize] == index {
                    places[count] = k as u8;
                    count += 1;
                } else {
                    others |= 1 << k;
                }
            }
            left = others;
            let material = &step.materials[index as usize];
            let of = LaneMaterial {
                material,
                law: material.flow_law.cast::<L>(),
                cold: step.cold_energies[index as usize].cast(),
                slots: &step.slots[index as usize],
            };
            for first in (0..count).step_by(L::WIDTH) {
                flow.return_to_yield(&Places::of::<L>(&places[first..count]), step, columns, particles, &of);
            }
        }
    }
}

impl FlowColumns<'_> {
    /// Returns the trial stress of particles of a material to the yield surface.
    #[inline(always)]
    fn return_to_yield<L: Lanes<Element = f64>>(
        &mut self,
        at: &Places,
        step: &StressStep<'_>,
        columns: &mut StressColumns,
        particles: &ElasticInputs<'_>,
        of: &LaneMaterial<'_, L>,
    ) {
        let (zero, one) = (L::zero(), L::one());
        let material = of.material;
        let density = at.load::<L>(&columns.density);
        // The law is that of the whole material, with the share of the stress that this would have.
        let (integrity, whole) = if step.breaks {
            let integrity = at.load::<L>(&columns.integrity_before);
            (integrity, one / integrity)
        } else {
            (one, one)
        };
        let mut shear_modulus = at.load::<L>(&columns.shear_modulus);
        if step.breaks {
            shear_modulus = shear_modulus / integrity;
        }
        let mut trial = [zero; 6];
        for c in 0..6 {
            trial[c] = at.load::<L>(&columns.deviator[c]) * whole;
        }
        let state = FlowState {
            plastic_strain: at.load(self.plastic_strain),
            plastic_strain_rate: zero,
            temperature: at.load(self.temperature),
            pressure: at.load(&columns.pressure),
            compression: density / L::of(material.density),
        };
        let of_law = material.flow_law.history().len();
        let mut history = [zero; MOST_HISTORY];
        for k in 0..of_law {
            history[k] = at.load_strided(self.history, step.history_width, of.slots[k]);
        }
        let (dt, guess) = (L::of(particles.dt), at.load(self.plastic_strain_increment));
        let update = return_mapping_near(
            material.return_rule,
            &of.law,
            shear_modulus,
            SymmetricTensor::from_array(trial),
            state,
            &history[..of_law],
            dt,
            guess,
        );
        let deviator = (update.deviator * integrity).to_array();
        for c in 0..6 {
            at.store(deviator[c], &mut columns.deviator[c]);
        }
        if step.commit {
            let evolved = update.step(state, dt);
            of.law.evolve(&evolved, &mut history[..of_law]);
            for k in 0..of_law {
                at.store_strided(history[k], self.history, step.history_width, of.slots[k]);
            }
            self.damage(at, step, columns, particles, of, (&evolved, shear_modulus, update.plastic_work));
            let after = if step.breaks { at.load(&columns.integrity) } else { one };
            let energy = at.load::<L>(&columns.energy) - at.load::<L>(&columns.numerical_energy);
            self.commit(
                at,
                &update,
                (material, &of.cold),
                shear_modulus,
                step.temperature,
                density,
                energy,
                (integrity, after),
            );
        }
    }

    /// Lets the damage of particles grow in a step of whole material, with its shear modulus (Pa) and plastic work per volume (J/m³), and takes
    /// from their integrity.
    #[inline(always)]
    fn damage<L: Lanes<Element = f64>>(
        &mut self,
        at: &Places,
        step: &StressStep<'_>,
        columns: &mut StressColumns,
        particles: &ElasticInputs<'_>,
        of: &LaneMaterial<'_, L>,
        (evolved, shear_modulus, plastic_work): (&FlowStep<L>, L, L),
    ) {
        let material = of.material;
        let Some(damage) = &material.damage else { return };
        let kept = of.slots.get(material.flow_law.history().len()..);
        let Some([place, _, energy]) = kept.and_then(|kept| kept.first_chunk::<{ KEPT.len() }>()) else { return };
        let (place, energy) = (*place, *energy);
        let width = step.history_width;
        let before = Before {
            damage: at.load_strided(self.history, width, place),
            integrity: at.load::<L>(&columns.integrity_before),
        };
        let size = smeared_width(step.support, at.load::<L>(particles.smoothing_length));
        let after = damage.cast::<L>().after_step(evolved, material.moduli(shear_modulus), size, before);
        at.store_strided(after.damage, self.history, width, place);
        let lost = after.share * before.integrity * plastic_work / at.load::<L>(&columns.density);
        let so_far = at.load_strided::<L>(self.history, width, energy);
        at.store_strided(so_far + lost, self.history, width, energy);
        at.store(at.load::<L>(&columns.integrity).min(after.integrity), &mut columns.integrity);
    }

    /// Applies the result of a return mapping to particles of an integrity before and after the step: plastic strain, heat.
    #[inline(always)]
    pub(super) fn commit<L: Lanes<Element = f64>>(
        &mut self,
        at: &Places,
        update: &Returned<L>,
        (material, cold): (&Material, &ColdEnergy<L>),
        shear_modulus: L,
        source: TemperatureSource,
        density: L,
        energy: L,
        (before, after): (L, L),
    ) {
        let plastic_work = before * update.plastic_work;
        at.add(update.plastic_strain_increment, self.plastic_strain);
        at.store(update.plastic_strain_increment, self.plastic_strain_increment);
        at.store(before * update.yield_stress, self.yield_stress);
        at.add(plastic_work / density, self.plastic_work);
        match source {
            TemperatureSource::PlasticWork => {
                let (beta, cp) = (L::of(material.taylor_quinney), L::of(material.specific_heat));
                at.add(heat::temperature_rise_from_plastic_work(beta, plastic_work, density, cp), self.temperature);
            }
            TemperatureSource::Energy => {
                let elastic = after * material.elastic_energy(update.deviator, shear_modulus, density);
                let cold = material.cold_energy(cold, density, after);
                let plastic = at.load(self.plastic_work);
                at.store(material.temperature_of_energy(energy, cold, elastic, plastic), self.temperature);
            }
        }
    }
}
