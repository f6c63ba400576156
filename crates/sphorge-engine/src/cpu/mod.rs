//! The engine for processors.

mod conduction;
mod constitutive;
mod contact;
mod external;
mod forces;
mod guard;
mod halo;
mod hourglass;
mod integrate;
mod kinematics;
mod ledger;
mod moving_least_squares;
mod prefetch;
mod records;
mod reference_conduction;
mod search;
mod smoothing;
mod stress_columns;
mod sweeps;
mod total_lagrangian;
mod votes;
mod walls;

use crate::engine::{Engine, SearchReport, Vote};
use crate::lanes::{Instructions, PairScalar};
use crate::model::{Integrator, Model, Search, TemperatureSource};
use crate::neighbors::range_of;
use crate::particles::{Particles, Permutation};
use crate::{Audit, Ledger, RunFailure};
use conduction::HeatFlow;
use contact::BodyContacts;
use halo::Halo;
use integrate::{Base, ExternalSums, Motions};
use kinematics::PairConstants;
use records::Records;
use search::Lists;
use sphorge_physics::{Tensor, Vector};
use std::sync::Arc;
use total_lagrangian::Reference;
use walls::Walls;

/// Searches between two sortings of the particles into cell order.
const SEARCHES_PER_SORTING: u64 = 64;

/// Engine for processors; `T` is the precision of pair sums, everything accumulated is double.
pub(super) struct CpuEngine<T> {
    model: Arc<Model>,
    particles: Particles,
    work: Work,
    records: Records<T>,
    halo: Halo,
    walls: Walls,
    motions: Motions,
    /// Prescribed velocities at the end of the step, while those of its middle are in use.
    motions_at_end: Motions,
    external: ExternalSums,
    contacts: Option<BodyContacts>,
    heat: Option<HeatFlow>,
    constants: PairConstants<T>,
    instructions: Instructions,
    lists: Lists<T>,
    step: StepState,
    base: Base,
    /// Initial configuration; only with the total Lagrangian form.
    reference: Option<Reference>,
}

/// Columns the engine keeps for itself, in the order of the particles.
#[derive(Clone, Debug, Default)]
struct Work {
    /// XSPH velocity of the last force sum, already times its strength, m/s.
    xsph: Vec<Vector<f64>>,
    /// Acceleration by walls and gravity, part of the total, m/s².
    external_acceleration: Vec<Vector<f64>>,
    /// Velocity the last force sum was evaluated with, m/s.
    evaluated_velocity: Vec<Vector<f64>>,
    /// Largest |mu| of the last force sum, m/s.
    mu: Vec<f64>,
    /// Gradient correction B; empty unless asked for.
    correction: Vec<Tensor<f64>>,
    /// Index of the prescribed motion plus one, zero for none.
    motion: Vec<u32>,
    /// Strain accumulated since the last search, the integral of |D|; empty unless the search is adaptive.
    strain_since_search: Vec<f64>,
    /// Plastic strain since the last search; empty unless the search is adaptive.
    plastic_since_search: Vec<f64>,
    /// Positions at the start, m; empty unless the search is adaptive.
    origin: Vec<Vector<f64>>,
    /// Scratch of the density re-initialisation.
    restored_density: Vec<f64>,
}

/// The step being taken.
#[derive(Clone, Copy, Debug, Default)]
struct StepState {
    /// Time at its start, s.
    time: f64,
    dt: f64,
    /// Steps begun, the evaluation of initial rates not counted.
    count: u64,
    /// Energy added by density re-initialisation, J.
    mls_energy: f64,
    /// Ordered pairs at the last kinematics stage.
    pairs: u64,
    /// Some particle is marked as searched.
    adapted_someone: bool,
}

impl StepState {
    /// Time from the start of the step to where sums are evaluated: its end for leapfrog, its middle for the other.
    fn dt_to_evaluation(&self, integrator: Integrator) -> f64 {
        match integrator {
            Integrator::Leapfrog => self.dt,
            Integrator::PredictorCorrector => 0.5 * self.dt,
        }
    }
}

impl<T: PairScalar> CpuEngine<T> {
    pub(super) fn new(model: Arc<Model>, mut particles: Particles) -> Self {
        let total_lagrangian = matches!(model.search, Search::TotalLagrangian(t) if t.corrected);
        let model = if total_lagrangian { total_lagrangian::without_pair_terms(&model) } else { model };
        let count = particles.len();
        if model.numerics.temperature == TemperatureSource::Energy {
            // Temperature is that of the energy, from the start.
            for i in 0..count {
                let material = &model.materials[particles.material[i] as usize];
                let warmer = particles.temperature[i] - material.reference_temperature;
                particles.energy[i] += material.specific_heat * warmer;
            }
        }
        HeatFlow::hold(&model, &mut particles);
        for i in 0..count {
            let law = &model.materials[particles.material[i] as usize].equation_of_state;
            let state = law.pressure(particles.density[i], particles.energy[i]);
            (particles.pressure[i], particles.sound_speed[i]) = (state.pressure, state.sound_speed);
        }
        let numerics = &model.numerics;
        let constants = PairConstants {
            unit: T::one(),
            kernel: numerics.kernel,
            sigma: T::of(numerics.kernel.normalisation(dimension(&model))),
        };
        let corrected = numerics.gradient_correction != crate::model::GradientCorrection::None || total_lagrangian;
        let adaptive = matches!(model.search, Search::Adaptive(_));
        let work = Work {
            xsph: vec![[0.0; 3]; count],
            external_acceleration: vec![[0.0; 3]; count],
            evaluated_velocity: particles.velocity.clone(),
            mu: vec![0.0; count],
            correction: if corrected { vec![sphorge_physics::tensor::identity(); count] } else { Vec::new() },
            motion: Motions::assign(&model, &particles),
            strain_since_search: vec![0.0; if adaptive { count } else { 0 }],
            plastic_since_search: vec![0.0; if adaptive { count } else { 0 }],
            origin: if adaptive { particles.position.clone() } else { Vec::new() },
            restored_density: Vec::new(),
        };
        let mut engine = Self {
            halo: Halo::new(&model),
            walls: Walls::new(&model),
            motions: Motions::new(&model),
            motions_at_end: Motions::new(&model),
            external: ExternalSums::new(count),
            contacts: BodyContacts::new(&model, count),
            heat: HeatFlow::new(&model, count),
            base: Base::new(numerics.integrator, count),
            records: Records::default(),
            lists: Lists::new(),
            step: StepState::default(),
            constants,
            instructions: Instructions::best(),
            work,
            particles,
            model,
            reference: None,
        };
        engine.lists.smoothing_lengths = range_of(&engine.particles.smoothing_length);
        engine.sort_particles();
        if total_lagrangian {
            engine.reference = Some(Reference::new(&engine.particles, &engine.model));
        }
        engine
    }

    /// Whether the bodies stand still in a step of size `dt`: heat alone flows. The initial rates, a step of size zero, are those of
    /// bodies that could move.
    fn idle(&self, dt: f64) -> bool {
        !self.model.thermal.mechanics && dt > 0.0
    }
}

impl Work {
    fn reorder(&mut self, permutation: &Permutation) {
        permutation.apply(&mut self.xsph);
        permutation.apply(&mut self.external_acceleration);
        permutation.apply(&mut self.evaluated_velocity);
        permutation.apply(&mut self.mu);
        permutation.apply(&mut self.correction);
        permutation.apply(&mut self.motion);
        permutation.apply(&mut self.strain_since_search);
        permutation.apply(&mut self.plastic_since_search);
        permutation.apply(&mut self.origin);
    }
}

impl<T: PairScalar> Engine for CpuEngine<T> {
    fn begin(&mut self, dt: f64) {
        if self.idle(dt) {
            self.step.dt = dt;
            self.step.count += 1;
            return;
        }
        if self.lists.searches >= SEARCHES_PER_SORTING && self.may_sort() {
            self.lists.searches = 0;
            self.sort_particles();
        }
        self.step.dt = dt;
        if dt > 0.0 {
            self.step.count += 1;
        }
        let integrator = self.model.numerics.integrator;
        self.walls.move_to(self.step.time + self.step.dt_to_evaluation(integrator));
        match integrator {
            Integrator::Leapfrog => self.leapfrog_begin(),
            Integrator::PredictorCorrector => self.predict(),
        }
    }

    fn refresh_neighbors(&mut self) -> SearchReport {
        self.follow_density();
        self.renew_lists()
    }

    fn audit(&mut self) -> Option<Audit> {
        let due = self.model.audit.is_some_and(|n| self.step.dt > 0.0 && self.step.count.is_multiple_of(n));
        due.then(|| self.audit_lists())
    }

    fn kinematics(&mut self) {
        if self.idle(self.step.dt) {
            return;
        }
        self.sum_gradients();
        self.restore_density();
        self.correct_forces();
    }

    fn stress(&mut self) {
        if self.idle(self.step.dt) {
            return;
        }
        self.update_stress();
        let positions = self.reference.as_ref().map_or(&self.particles.position, |r| &r.position);
        self.halo.exchange_stress(positions, &mut self.records);
    }

    fn forces(&mut self) {
        self.sum_heat();
        if self.idle(self.step.dt) {
            return;
        }
        self.sum_forces();
        self.resist_hourglass();
        self.add_body_contact();
        self.add_external_forces();
    }

    fn finish(&mut self) {
        if !self.idle(self.step.dt) {
            match self.model.numerics.integrator {
                Integrator::Leapfrog => self.leapfrog_finish(),
                Integrator::PredictorCorrector => self.correct(),
            }
            self.warm_by_friction();
        }
        self.accumulate_strain();
        self.flow_heat();
        self.step.time += self.step.dt;
    }

    fn guard(&self) -> Result<(), RunFailure> {
        guard::check(&self.particles, guard::is_cooled(&self.model))
    }

    fn vote(&self) -> Vote {
        let conduction = votes::conduction_vote(&self.model, self.heat.as_ref().map(HeatFlow::limit));
        if !self.model.thermal.mechanics {
            return conduction;
        }
        let contact = self.contacts.as_ref().map(BodyContacts::limit);
        votes::smaller(votes::vote(&self.model, &self.particles, &self.work.mu, contact, self.instructions), conduction)
    }

    fn pairs(&self) -> u64 {
        self.step.pairs
    }

    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn ledger(&self) -> Ledger {
        self.conservation_ledger()
    }

    fn memory_bytes(&self) -> u64 {
        let count = self.particles.len();
        let columns = count * (Particles::BYTES + Work::BYTES + self.base.bytes_per_particle());
        let accumulated = (8 + 8 + 24) * self.work.strain_since_search.capacity();
        let reference = self.reference.as_ref().map_or(0, Reference::bytes);
        let contacts = self.contacts.as_ref().map_or(0, BodyContacts::bytes);
        let heat = self.heat.as_ref().map_or(0, HeatFlow::bytes);
        (columns + accumulated + reference + contacts + heat + self.lists.bytes() + self.records.bytes()) as u64
    }
}

impl Work {
    /// Bytes per particle without the gradient correction.
    const BYTES: usize = 3 * size_of::<Vector<f64>>() + size_of::<f64>() + size_of::<u32>();
}

/// Dimension of the kernel.
fn dimension(model: &Model) -> sphorge_physics::Dimension {
    use crate::model::Dimensions;
    use sphorge_physics::Dimension;
    match model.dimensions {
        Dimensions::One => Dimension::One,
        Dimensions::PlaneStrain => Dimension::Two,
        Dimensions::Three => Dimension::Three,
    }
}
