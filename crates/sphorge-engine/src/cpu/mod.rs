//! The CPU engine.

mod balance;
mod common_points;
mod conduction;
mod conduction_table;
mod constitutive;
mod contact;
mod contact_search;
mod domain;
mod evaluated;
mod exchange;
mod external;
mod face_sums;
mod faces;
mod facet_bounds;
mod facet_source;
mod facets;
mod facets_on_walls;
mod facing;
mod flow;
mod forces;
mod formulation;
mod ghosts;
mod guard;
mod hourglass;
mod initial;
mod inner;
mod integrate;
mod kinematics;
mod ledger;
mod moving_least_squares;
mod numerical_work;
mod persist;
mod prefetch;
mod read;
mod records;
mod reference_conduction;
mod relocation;
mod renewal;
mod search;
mod section;
mod self_contact;
mod shared_edges;
mod shocks;
mod smoothing;
mod stored;
mod stress_columns;
mod sweeps;
mod time_step;
mod walls;

pub use conduction_table::ConductionTable;
pub use contact::heat_of_released;
pub use face_sums::{FaceConfiguration, FaceNeighbor, FaceTerm, FaceTerms, face_terms};
pub use guard::{check as check_values, largest_change};
pub use initial::complete_initial_state;
pub use search::{AuditedRow, ContactCandidates, SearchedMaterial, audit_of};

use crate::drive::{Drive, Driven};
use crate::engine::{Engine, EngineKind, Part, PartKind, SearchReport, TimeStepLimit, Unsupported};
use crate::halo::{Arrival, FieldSet, Halo, Images};
use crate::lanes::{Instructions, PairScalar};
use crate::model::{Integrator, Material, Model, Precision};
use crate::neighbors::range_of;
use crate::particles::{Column, Particles};
use crate::persist::{Archive, ArchiveError, Persist, persist_count};
use crate::ranks::{Communicator, StepFault};
use crate::reduction::{self, Reduction};
use crate::{Audit, Ledger, RunFailure};
use conduction::HeatFlow;
use contact::BodyContacts;
use domain::Domain;
use face_sums::FaceSums;
use formulation::Formulation;
use ghosts::Ghosts;

use facets_on_walls::FacetsOnWalls;
use inner::{InnerBlocks, Rows};
use integrate::{ExternalSums, Motions};
use kinematics::PairConstants;
use numerical_work::NumericalWork;
use records::Records;
use search::Lists;
use sphorge_physics::eos::ColdEnergy;
use std::sync::Arc;
use walls::Walls;

/// Number of searches between two sortings of the particles into cell order.
const SEARCHES_PER_SORTING: u64 = 64;

/// The CPU engine: all threads of the rayon pool it is started in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu;

impl EngineKind for Cpu {
    fn name(&self) -> &'static str {
        "cpu"
    }

    fn supports(&self, _: &Model) -> Result<(), Unsupported> {
        Ok(())
    }

    fn completes_particles(&self) -> bool {
        true
    }

    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        // Tests in this crate test parts. Tests that run are in the library that uses it: compiling both precisions of
        // the whole engine a second time for them would take a minute of every `cargo test`.
        if cfg!(test) {
            return Err(RunFailure::of_engine("tests of the engine's parts start none".to_owned()));
        }
        let halo = Box::new(Images::new(&model));
        let smoothing_lengths = range_of(&particles.smoothing_length);
        Ok(match model.numerics.precision {
            Precision::Mixed => Box::new(CpuEngine::<f32>::new(model, particles, halo, None, smoothing_lengths)?),
            Precision::Double => Box::new(CpuEngine::<f64>::new(model, particles, halo, None, smoothing_lengths)?),
        })
    }
}

impl PartKind for Cpu {
    fn shared_name(&self) -> &'static str {
        "cpu-ranks"
    }

    fn start_part(
        &self,
        model: Arc<Model>,
        particles: Particles,
        communicator: Arc<dyn Communicator>,
    ) -> Result<Box<dyn Part>, RunFailure> {
        domain::start_part(model, particles, communicator)
    }
}

/// The columns and the stages; `T` is the precision of pair sums, everything accumulated is double.
struct CpuEngine<T: PairScalar> {
    model: Arc<Model>,
    formulation: &'static dyn Formulation<T>,
    particles: Particles,
    ghosts: Ghosts,
    /// Halo exchange in flight.
    arrival: Option<Arrival>,
    inner: InnerBlocks,
    /// Inner rows are already summed.
    is_begun: bool,
    /// The share of this rank, if there are several.
    domain: Option<Domain>,
    records: Records<T>,
    walls: Walls,
    /// Where walls push bodies at the facets of their particles.
    facets_on_walls: Option<FacetsOnWalls>,
    motions: Motions,
    /// Prescribed velocities at the end of the step, while those of its middle are in use.
    motions_at_end: Motions,
    /// Loads and velocities that a program has given.
    driven: Option<Driven>,
    external: ExternalSums,
    numerical_work: NumericalWork,
    contacts: Option<BodyContacts>,
    heat: Option<HeatFlow>,
    constants: PairConstants<T>,
    instructions: Instructions,
    /// Coefficient of the artificial stress, by body; nothing without one.
    repulsion: Vec<f64>,
    /// Sound speed at rest, by material, m/s.
    sound_speeds: Vec<f64>,
    /// By material.
    cold_energies: Vec<ColdEnergy<f64>>,
    lists: Lists<T>,
    step: StepState,
    /// Scratch of the density re-initialisation, kg/m³.
    restored_density: Vec<f64>,
    /// Where gradients are exact for quadratic fields at faces.
    face_sums: Option<FaceSums>,
    /// Whether the gradient correction of the reference configuration is known.
    reference_corrected: bool,
    /// Whether the neighbours of some particle lie in a plane or on a line there.
    has_thin_parts: bool,
    /// By body, whether its reference configuration has been renewed.
    has_come_apart: Vec<bool>,
}

/// The step being taken.
#[derive(Clone, Copy, Debug, Default)]
struct StepState {
    /// Time at its start, s.
    time: f64,
    dt: f64,
    /// Number of steps begun, without the evaluation of initial rates.
    count: u64,
    /// Energy added by density re-initialisation, J.
    mls_energy: f64,
    /// Ordered pairs at the last kinematics stage.
    pairs: u64,
    /// Whether any particle is marked as searched.
    any_adapted: bool,
}

impl StepState {
    /// Time from the start of the step to the evaluation of the sums: its end for leapfrog, its middle for the
    /// predictor–corrector.
    fn dt_to_evaluation(&self, integrator: Integrator) -> f64 {
        match integrator {
            Integrator::Leapfrog => self.dt,
            Integrator::PredictorCorrector => 0.5 * self.dt,
        }
    }
}

impl Persist for StepState {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.time.persist(&format!("{name}.time"), archive)?;
        self.dt.persist(&format!("{name}.dt"), archive)?;
        persist_count(&mut self.count, &format!("{name}.count"), archive)?;
        self.mls_energy.persist(&format!("{name}.mls_energy"), archive)?;
        self.pairs.persist(&format!("{name}.pairs"), archive)?;
        self.any_adapted.persist(&format!("{name}.any_adapted"), archive)
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Creates the engine for particles, those of a domain if there is one; `smoothing_lengths` are the smallest and
    /// the largest of all particles, m.
    fn new(
        model: Arc<Model>,
        mut particles: Particles,
        halo: Box<dyn Halo>,
        domain: Option<Domain>,
        smoothing_lengths: (f64, f64),
    ) -> Result<Self, RunFailure> {
        let mut lists = Lists::new(smoothing_lengths);
        if domain.is_none() {
            // Before they have all their columns: less is moved.
            lists.sort(&model, &mut particles);
        }
        particles.complete();
        initial::complete_initial_state(&model, &mut particles);
        let count = particles.len();
        let numerics = &model.numerics;
        let formulation = formulation::of::<T>(&model);
        initial::columns(&model, &mut particles, formulation.is_corrected(&model), formulation.is_initial());
        let constants = PairConstants {
            unit: T::one(),
            kernel: numerics.kernel,
            sigma: T::of(numerics.kernel.normalisation(dimension(&model))),
        };
        let mut engine = Self {
            formulation,
            contacts: BodyContacts::new(&model, count, (!formulation.sees_other_bodies()).then(|| halo.another())),
            ghosts: Ghosts::new(halo),
            arrival: None,
            inner: InnerBlocks::default(),
            is_begun: false,
            domain,
            walls: Walls::new(&model, count),
            facets_on_walls: FacetsOnWalls::new(&model),
            face_sums: FaceSums::of(&model),
            motions: Motions::new(&model),
            motions_at_end: Motions::new(&model),
            driven: None,
            external: ExternalSums::new(count),
            numerical_work: NumericalWork::new(count),
            heat: HeatFlow::new(&model, count),
            records: Records::default(),
            lists,
            step: StepState::default(),
            constants,
            instructions: Instructions::best(),
            repulsion: initial::repulsion(&model),
            sound_speeds: model.materials.iter().map(|m| m.equation_of_state.reference_sound_speed()).collect(),
            cold_energies: model.materials.iter().map(Material::cold_energies).collect(),
            has_come_apart: vec![false; model.bodies.len()],
            particles,
            model,
            restored_density: Vec::new(),
            reference_corrected: false,
            has_thin_parts: false,
        };
        if engine.domain.is_some() {
            engine.sort_particles()?;
        }
        formulation.start(&mut engine);
        Ok(engine)
    }

    /// Whether the bodies are at rest in a step of size `dt`, with heat conduction only. The initial rates, a step of
    /// size zero, are those of bodies that can move.
    fn idle(&self, dt: f64) -> bool {
        !self.model.thermal.mechanics && dt > 0.0
    }

    /// Whether inner rows are summed before ghosts have arrived from other ranks.
    fn begins_inside(&mut self) -> bool {
        let has_others = self.domain.as_ref().is_some_and(|domain| domain.ranks.size() > 1);
        if !has_others || self.idle(self.step.dt) {
            return false;
        }
        self.inner.refresh(&self.lists.list, self.particles.len());
        self.inner.parts() > 0
    }

    /// Sums the inner rows, while messages make progress.
    fn sum_inside(&mut self, sum: impl Fn(&mut Self, Rows)) {
        for part in 0..self.inner.parts() {
            sum(self, Rows::Inner(part));
            self.arrival.iter_mut().for_each(Arrival::advance);
        }
        self.is_begun = true;
    }

    /// The remaining rows of a stage.
    fn rows_left(&mut self) -> Rows {
        if std::mem::take(&mut self.is_begun) { Rows::Rest } else { Rows::All }
    }

    /// Whether an audit is due in this step.
    fn audit_is_due(&self) -> bool {
        self.model.audit.is_some_and(|n| self.step.dt > 0.0 && self.step.count.is_multiple_of(n))
    }
}

impl<T: PairScalar> Engine for CpuEngine<T> {
    fn begin(&mut self, dt: f64) -> Result<(), RunFailure> {
        // A step that failed between the two leaves this.
        self.is_begun = false;
        if self.idle(dt) {
            self.step.dt = dt;
            self.step.count += 1;
            return Ok(());
        }
        if self.lists.searches >= SEARCHES_PER_SORTING && self.may_sort() {
            self.lists.searches = 0;
            self.sort_particles()?;
        }
        self.step.dt = dt;
        if dt > 0.0 {
            self.step.count += 1;
        }
        let integrator = self.model.numerics.integrator;
        self.walls.move_to(self.step.time + self.step.dt_to_evaluation(integrator));
        match integrator {
            Integrator::Leapfrog => self.leapfrog_begin(),
            Integrator::PredictorCorrector => {
                self.predict();
                Ok(())
            }
        }
    }

    fn refresh_neighbors(&mut self) -> Result<SearchReport, RunFailure> {
        self.follow_density()?;
        self.refresh_lists()
    }

    fn audit(&mut self) -> Result<Option<Audit>, RunFailure> {
        let due = self.audit_is_due();
        due.then(|| self.audit_lists()).transpose()
    }

    fn begin_exchange(&mut self, fields: FieldSet) -> Result<(), RunFailure> {
        self.begin_exchange_of(fields);
        Ok(())
    }

    fn finish_exchange(&mut self, fields: FieldSet) -> Result<(), RunFailure> {
        self.finish_exchange_of(fields)
    }

    fn inner_kinematics(&mut self) -> Result<(), RunFailure> {
        // The gradient correction of the reference configuration and the terms of faces read ghosts.
        let is_known = self.reference_corrected && self.face_sums.as_ref().is_none_or(FaceSums::is_known);
        if self.begins_inside() && (is_known || !self.formulation.is_initial()) {
            self.sum_inside(|engine, rows| engine.formulation.kinematics(engine, rows));
        }
        Ok(())
    }

    fn kinematics(&mut self) -> Result<(), RunFailure> {
        if !self.idle(self.step.dt) {
            let rows = self.rows_left();
            self.formulation.kinematics(self, rows);
        }
        Ok(())
    }

    fn restore_density(&mut self) -> Result<(), RunFailure> {
        if !self.idle(self.step.dt) && self.restoration_is_due() {
            self.restore_densities()?;
        }
        Ok(())
    }

    fn correct_gradients(&mut self) -> Result<(), RunFailure> {
        if !self.idle(self.step.dt) {
            self.formulation.correct_gradients(self);
        }
        Ok(())
    }

    fn find_faces(&mut self) -> Result<(), RunFailure> {
        if !self.idle(self.step.dt) {
            self.shift_to_faces();
            self.follow_evaluated();
            self.take_out_severed();
            self.shift_edges();
        }
        Ok(())
    }

    fn find_overlaps(&mut self) -> Result<(), RunFailure> {
        if !self.idle(self.step.dt) {
            self.overlap_bodies();
        }
        Ok(())
    }

    fn push_faces(&mut self) -> Result<(), RunFailure> {
        if !self.idle(self.step.dt) {
            self.push_externally();
            self.push_bodies()?;
        }
        Ok(())
    }

    fn stress(&mut self) -> Result<(), RunFailure> {
        if !self.idle(self.step.dt) {
            self.update_stress();
            self.soften_springs();
        }
        Ok(())
    }

    fn intermediate_sums(&mut self) -> Result<(), RunFailure> {
        self.begin_heat();
        Ok(())
    }

    fn inner_forces(&mut self) -> Result<(), RunFailure> {
        if self.begins_inside() {
            self.sum_inside(|engine, rows| {
                engine.sum_forces(rows);
                engine.formulation.add_forces(engine, rows);
            });
        }
        Ok(())
    }

    fn forces(&mut self) -> Result<(), RunFailure> {
        self.sum_heat()?;
        if self.idle(self.step.dt) {
            return Ok(());
        }
        let rows = self.rows_left();
        self.sum_forces(rows);
        self.formulation.add_forces(self, rows);
        self.add_body_contact();
        self.add_pulls();
        self.add_external_forces();
        Ok(())
    }

    fn finish(&mut self) -> Result<(), RunFailure> {
        if !self.idle(self.step.dt) {
            match self.model.numerics.integrator {
                Integrator::Leapfrog => self.leapfrog_finish()?,
                Integrator::PredictorCorrector => self.correct()?,
            }
            self.warm_by_friction();
            if let Some(domain) = &mut self.domain {
                self.step.pairs = domain.sum_pairs(self.step.pairs, self.inner.rows())?;
            }
        }
        self.accumulate_strain();
        self.know_flow_rates();
        self.flow_heat()?;
        self.step.time += self.step.dt;
        Ok(())
    }

    fn guard(&self) -> Result<(), RunFailure> {
        let wrong = guard::check(&self.particles, self.model.thermal.is_cooled()).map_err(StepFault::wrong).err();
        let fault = wrong.or_else(|| match &self.model.time.step_control {
            Some(control) if self.step.dt > 0.0 && self.model.thermal.mechanics => {
                guard::largest_change(&control.largest, &self.particles, &self.sound_speeds, self.step.dt)
            }
            _ => None,
        });
        match &self.domain {
            Some(domain) => domain.ranks.fail_together(fault),
            None => fault.map_or(Ok(()), |fault| Err(fault.failure)),
        }
    }

    fn time_step_limit(&self) -> Result<TimeStepLimit, RunFailure> {
        let conduction = time_step::conduction_limit(&self.model, self.heat.as_ref().map(HeatFlow::limit));
        if !self.model.thermal.mechanics {
            return Ok(conduction);
        }
        let at_facets = self.walls.limits.iter().copied().fold(f64::INFINITY, f64::min);
        let contact = self.contacts.as_ref().map(BodyContacts::limit);
        let contact = self.facets_on_walls.as_ref().map(|_| at_facets).into_iter().chain(contact).reduce(f64::min);
        let limit = time_step::limit(&self.model, &self.particles, contact, self.instructions).min(conduction);
        self.agree_on_limit(limit)
    }

    fn count(&self) -> usize {
        self.particles.len()
    }

    fn imbalance(&self) -> f64 {
        self.domain.as_ref().map_or(1.0, |domain| domain.imbalance)
    }

    fn inner_share(&self) -> f64 {
        self.domain.as_ref().map_or(0.0, |domain| domain.inner_share)
    }

    fn waited(&self) -> f64 {
        self.domain.as_ref().map_or(0.0, |domain| domain.ranks.waited())
    }

    fn pairs(&self) -> u64 {
        self.step.pairs
    }

    fn ledger(&self) -> Result<Ledger, RunFailure> {
        self.conservation_ledger()
    }

    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        Ok(match *reduction {
            Reduction::SectionForce(section) => self.section_force(section)?.map_or_else(Vec::new, |f| f.to_vec()),
            _ => match &self.domain {
                Some(domain) => reduction::evaluate_in_turn(reduction, &self.model, &self.particles, &domain.ranks)?,
                None => reduction::evaluate(reduction, &self.model, &self.particles),
            },
        })
    }

    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        self.read_by_id(field)
    }

    fn can_be_driven(&self) -> bool {
        self.domain.is_none() && self.model.thermal.mechanics
    }

    fn driven(&self) -> Option<(Vec<bool>, Vec<bool>)> {
        self.driven.as_ref().map(Driven::parts)
    }

    fn drive(&mut self, drive: &Drive) -> Result<(), RunFailure> {
        if !self.can_be_driven() || !drive.fits(&self.model) {
            let what = "loads or velocities from a program that the model or the engine does not take";
            return Err(RunFailure::of_engine(what.to_owned()));
        }
        self.take_drive(drive);
        Ok(())
    }

    fn persist(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.persist_all(archive)
    }

    fn memory_bytes(&self) -> u64 {
        let contacts = self.contacts.as_ref().map_or(0, BodyContacts::bytes);
        let heat = self.heat.as_ref().map_or(0, HeatFlow::bytes);
        let ghosts = self.ghosts.halo.bytes() + self.ghosts.columns.bytes();
        let domain = self.domain.as_ref().map_or(0, Domain::bytes);
        let ghosts = ghosts + self.inner.bytes() + self.face_sums.as_ref().map_or(0, FaceSums::bytes);
        let contacts = contacts + self.facets_on_walls.as_ref().map_or(0, FacetsOnWalls::bytes);
        let contacts = contacts + self.walls.bytes() + self.external.bytes();
        (self.particles.bytes() + ghosts + contacts + heat + domain + self.lists.bytes() + self.records.bytes()) as u64
    }
}

/// Dimension of the kernel.
fn dimension(model: &Model) -> sphorge_physics::Dimension {
    model.dimensions.into()
}
