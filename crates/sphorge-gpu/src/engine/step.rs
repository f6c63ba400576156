//! The stages of the step.

use super::columns::Group;
use super::kernels::{limits, reduce};
use super::read_back::read;
use super::stages::Stage;
use super::{GpuEngine, failure, step_numbers};
use sphorge_engine::model::{AdaptiveSearch, Integrator, Material, Search, WallContact};
use sphorge_engine::particles::HistoryVariables;
use sphorge_engine::persist::{Archive, ArchiveError};
use sphorge_engine::ranks::StepFault;
use sphorge_engine::reduction::{QueuedSums, Reduction};
use sphorge_engine::{
    Audit, Column, Engine, FieldSource, Ledger, LimitReason, RunFailure, SearchReport, TimeStepLimit, largest_change,
};
use sphorge_physics::step_control::StepChange;
use sphorge_physics::time_step::penalty_limit;

impl GpuEngine {
    /// Time from the start of the step to where forces are evaluated, s.
    pub(super) fn dt_to_evaluation(&self) -> f64 {
        match self.model.numerics.integrator {
            Integrator::Leapfrog => self.dt,
            Integrator::PredictorCorrector => 0.5 * self.dt,
        }
    }

    /// The numbers of a step that goes from `time` on; walls stand where they are when forces are evaluated.
    pub(super) fn set_step(&self) -> Result<(), RunFailure> {
        let then = self.time + self.dt_to_evaluation();
        let mut numbers = vec![self.dt, 0.5 * self.dt];
        numbers.extend(self.model.gravity);
        numbers.extend([self.lists.capacity, self.steps].map(f64::from));
        let ghosts_before = self.domain.as_ref().map_or(0, |domain| self.initial.len() + domain.ghosts_behind());
        numbers.extend([ghosts_before as f64, self.time + self.dt]);
        for wall in &self.model.walls {
            numbers.extend([0, 1, 2].map(|a| wall.velocity[a].integral(0.0, then)));
            numbers.extend([0, 1, 2].map(|a| wall.velocity[a].at(then)));
        }
        numbers.extend([0.0; step_numbers::MOTION_LENGTH]);
        for motion in &self.model.motions {
            let at = |time: f64| motion.axes.iter().map(move |axis| axis.velocity(time).unwrap_or(0.0));
            numbers.extend(motion.axes.iter().map(|axis| f64::from(u8::from(axis.velocity(0.0).is_some()))));
            numbers.extend(at(self.time + 0.5 * self.dt).chain(at(self.time + self.dt)));
        }
        let numbers: Vec<f32> = numbers.into_iter().map(|number| number as f32).collect();
        let array = self.columns.array(Group::Step).ok_or_else(|| failure("no numbers of the step"))?;
        self.card.write(array, &numbers);
        Ok(())
    }

    fn read_extremes(&mut self) -> Result<(), RunFailure> {
        let numbers = read(&self.card, &self.columns, reduce::left(Group::Extremes, reduce::rows(self.stride)))?;
        let rows = numbers.len() / limits::EXTREMES;
        let numbers_of = |k: usize| numbers[k * rows..(k + 1) * rows].iter().map(|number| f64::from(*number));
        for (k, extreme) in self.extremes.iter_mut().enumerate() {
            let of = numbers_of(k);
            *extreme = match k {
                _ if k < limits::LIMITS => of.fold(f64::INFINITY, f64::min),
                limits::NEIGHBORS => of.sum::<f64>() + reduce::UNITS * numbers_of(limits::FIELDS).sum::<f64>(),
                _ => of.fold(0.0, f64::max),
            };
        }
        self.join_extremes()
    }

    /// Makes the extremes those of the particles of all ranks.
    fn join_extremes(&mut self) -> Result<(), RunFailure> {
        let Some(domain) = &self.domain else { return Ok(()) };
        let all = domain.ranks.gather_one(self.extremes)?;
        for (k, extreme) in self.extremes.iter_mut().enumerate() {
            let of = all.iter().map(|extremes| extremes[k]);
            *extreme = match k {
                _ if k < limits::LIMITS => of.fold(f64::INFINITY, f64::min),
                limits::NEIGHBORS => of.sum(),
                _ => of.fold(0.0, f64::max),
            };
        }
        Ok(())
    }

    /// The first particle of this GPU with a value that is none, if it has one.
    fn broken(&self) -> Result<Option<StepFault>, RunFailure> {
        let p = self.snapshot()?;
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let variables = HistoryVariables::of(&self.model).variables.into_iter();
        let kept: Vec<_> = variables
            .filter_map(|variable| match p.column(variable.name) {
                Some(Column::Scalar(values)) => Some((variable.name, values, variable.bound)),
                _ => None,
            })
            .collect();
        let fault = |i: usize| {
            let checks: [(&str, bool); 7] = [
                ("position", finite(&p.position[i])),
                ("velocity", finite(&p.velocity[i])),
                ("density", p.density[i].is_finite() && p.density[i] > 0.0),
                ("energy", p.energy[i].is_finite()),
                ("temperature", p.temperature[i].is_finite()),
                ("pressure", p.pressure[i].is_finite()),
                ("deviator", finite(&p.deviator[i].to_array())),
            ];
            let first = checks.into_iter().find(|(_, sound)| !sound).map(|(field, _)| field);
            first
                .or_else(|| kept.iter().find(|(_, values, bound)| !bound.allows(values[i])).map(|of| of.0))
                .map(|field| (i, field))
        };
        let failure = |particle: Option<usize>, field: &'static str| {
            StepFault::wrong(RunFailure {
                field,
                particle: particle.map(|i| p.id[i]),
                body: particle.map(|i| p.body[i]),
                step_may_be_smaller: true,
                ..RunFailure::of_engine(format!(
                    "`{field}` is not finite, or a density not positive; try a smaller time step"
                ))
            })
        };
        let found = (0..p.len()).find_map(fault).map(|(i, field)| failure(Some(i), field));
        // Of all ranks one has the particle; alone it may be an acceleration, which is not read back.
        Ok(found.or_else(|| self.domain.is_none().then(|| failure(None, "acceleration"))))
    }
}

impl Engine for GpuEngine {
    fn begin(&mut self, dt: f64) -> Result<(), RunFailure> {
        self.read_back.take();
        self.dt = dt;
        self.steps += u32::from(dt > 0.0);
        self.set_step()?;
        if self.is_idle() {
            return Ok(());
        }
        self.launch(Stage::Begin)?;
        Ok(())
    }

    fn refresh_neighbors(&mut self) -> Result<SearchReport, RunFailure> {
        if self.is_idle() {
            // The same neighbours would be found.
            let searches = self.model.search == Search::EveryStep;
            return Ok(SearchReport { searched_fraction: f64::from(u8::from(searches)) });
        }
        self.widen_cells_of_facets()?;
        if self.model.formulation.renews() && self.renew_references()? {
            return Ok(SearchReport { searched_fraction: 1.0 });
        }
        self.refresh_ghosts()?;
        if self.model.keeps_lists() {
            return self.refresh_lists();
        }
        self.launch(Stage::Wrap)?;
        self.launch(Stage::Sorting)?;
        let searches = self.steps == 0 || !self.stages.is_empty(Stage::Sorting);
        Ok(SearchReport { searched_fraction: f64::from(u8::from(searches)) })
    }

    fn audit(&mut self) -> Result<Option<Audit>, RunFailure> {
        self.audit_lists()
    }

    fn kinematics(&mut self) -> Result<(), RunFailure> {
        if self.is_idle() {
            return Ok(());
        }
        let corrects = !self.stages.is_empty(Stage::CorrectedGradients)
            && u64::from(self.steps).is_multiple_of(AdaptiveSearch::STRAIN_CORRECTION_STEPS);
        let due = if corrects { Stage::CorrectedGradients } else { Stage::Gradients };
        self.launch(due)?;
        Ok(())
    }

    fn restore_density(&mut self) -> Result<(), RunFailure> {
        let due = |n: u64| self.dt > 0.0 && !self.is_idle() && u64::from(self.steps).is_multiple_of(n);
        if self.model.numerics.mls_interval.is_some_and(due) {
            self.launch(Stage::Restore)?;
        }
        Ok(())
    }

    fn correct_gradients(&mut self) -> Result<(), RunFailure> {
        if self.dt > 0.0 && !self.is_idle() {
            self.launch(Stage::Correct)?;
        }
        Ok(())
    }

    fn push_faces(&mut self) -> Result<(), RunFailure> {
        if !self.is_idle() {
            self.launch(Stage::Push)?;
        }
        Ok(())
    }

    fn stress(&mut self) -> Result<(), RunFailure> {
        if !self.is_idle() {
            self.launch(Stage::Stress)?;
        }
        Ok(())
    }

    fn forces(&mut self) -> Result<(), RunFailure> {
        self.sum_heat()?;
        if !self.is_idle() {
            self.launch(Stage::Forces)?;
            if self.sums_sections_with_forces() {
                for number in 0..self.model.sections.len() {
                    self.launch(Stage::Section(number))?;
                }
            }
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), RunFailure> {
        if self.is_idle() {
            self.flow_heat()?;
        } else {
            self.launch(Stage::Finish)?;
            self.flow_heat()?;
            self.read_extremes()?;
        }
        self.time += self.dt;
        Ok(())
    }

    fn guard(&self) -> Result<(), RunFailure> {
        self.guard_heat()?;
        let [_, _, _, density, stretch, energy, jump, broken, ..] = self.extremes;
        if broken > 0.0 {
            self.fail_together(self.broken()?)?;
            return Err(failure("an acceleration is not finite; try a smaller time step"));
        }
        let change = StepChange { density, stretch, energy, jump };
        match &self.model.time.step_control {
            // Which particle that was is found in what the GPU holds.
            Some(control) if !self.is_idle() && change.is_beyond(&control.largest) => {
                let speed = |material: &Material| material.equation_of_state.reference_sound_speed();
                let speeds: Vec<f64> = self.model.materials.iter().map(speed).collect();
                let fault = largest_change(&control.largest, &self.snapshot()?, &speeds, self.dt);
                self.fail_together(fault)
            }
            _ => Ok(()),
        }
    }

    fn time_step_limit(&self) -> Result<TimeStepLimit, RunFailure> {
        let conduction = self.conduction_limit();
        if !self.model.thermal.mechanics {
            return Ok(conduction);
        }
        let [by_sound, by_acceleration, by_contact, ..] = self.extremes;
        let limit = |dt, reason| TimeStepLimit { dt, reason };
        let mut least = limit(by_sound, LimitReason::SoundSpeed).min(limit(by_acceleration, LimitReason::Acceleration));
        least = least.min(conduction);
        let courant = self.model.time.courant_of_contacts();
        if self.model.has_contact() {
            least = least.min(limit(courant * by_contact, LimitReason::Contact));
        }
        let rate = |b: &sphorge_engine::model::Body| {
            self.model.materials[b.material].equation_of_state.reference_sound_speed() / b.spacing
        };
        let fastest = self.model.bodies.iter().map(rate).fold(0.0, f64::max);
        for wall in &self.model.walls {
            if let WallContact::Penalty { stiffness, .. } = wall.contact {
                let of_wall = penalty_limit(stiffness, fastest, courant);
                least = least.min(limit(of_wall, LimitReason::Contact));
            }
        }
        Ok(least)
    }

    fn count(&self) -> usize {
        self.initial.len()
    }

    fn pairs(&self) -> u64 {
        self.extremes[limits::NEIGHBORS] as u64
    }

    fn ledger(&self) -> Result<Ledger, RunFailure> {
        self.conservation()
    }

    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        self.reduction(reduction)
    }

    fn queue_sums(&self, asked: &[Reduction<'_>]) -> Result<Option<Box<dyn QueuedSums>>, RunFailure> {
        self.queued_sums(asked)
    }

    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        Ok(self.own_column(field)?.by_id(&self.initial.id))
    }

    fn ranks(&self) -> usize {
        self.domain.as_ref().map_or(1, |domain| domain.ranks.size())
    }

    fn waited(&self) -> f64 {
        self.domain.as_ref().map_or(0.0, |domain| domain.ranks.waited())
    }

    fn detach(&self) -> Result<Option<Box<dyn FieldSource + Send>>, RunFailure> {
        Ok(self.detached()?.map(|columns| Box::new(columns) as Box<dyn FieldSource + Send>))
    }

    fn persist(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.persist_state(archive)
    }

    fn memory_bytes(&self) -> u64 {
        self.columns.all().map(|(_, array)| 4 * array.count() as u64).sum()
    }

    fn device(&self) -> Option<String> {
        Some(self.card.found().title())
    }
}
