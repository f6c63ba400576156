//! Heat conduction: with mechanics its sums are computed every few steps, without mechanics in every step.

use super::columns::Group;
use super::kernels::conduction::{BEYOND, EXTREMES};
use super::kernels::reduce;
use super::read_back::read;
use super::stages::Stage;
use super::{GpuEngine, failure};
use sphorge_engine::ranks::StepFault;
use sphorge_engine::{LimitReason, RunFailure, TimeStepLimit, check_values};

impl GpuEngine {
    /// Whether bodies are at rest in this step, with heat conduction only; the initial rates are those of bodies that
    /// can move.
    pub(super) fn is_idle(&self) -> bool {
        !self.model.thermal.mechanics && self.dt > 0.0
    }

    /// Sums the heat flow again if it is due.
    pub(super) fn sum_heat(&mut self) -> Result<(), RunFailure> {
        let Some(mut clock) = self.heat.filter(|clock| clock.is_due(&self.model)) else { return Ok(()) };
        if self.model.thermal.mechanics || !self.has_looked_for_heat {
            self.launch(Stage::LookForHeat)?;
            self.has_looked_for_heat = true;
        }
        self.launch(Stage::SumHeat)?;
        clock.start();
        clock.limit = self.read_heat_extremes()?;
        self.heat = Some(clock);
        Ok(())
    }

    /// Applies the heat flow of the step.
    pub(super) fn flow_heat(&mut self) -> Result<(), RunFailure> {
        let Some(clock) = &mut self.heat else { return Ok(()) };
        clock.advance(self.dt);
        self.launch(Stage::FlowHeat)?;
        // With mechanics values are checked together with all others, and only a flux can cool below zero.
        if self.is_idle() || self.model.thermal.is_cooled() {
            self.read_heat_extremes()?;
        }
        Ok(())
    }

    /// The smallest limit, s; stores the lowest temperature.
    fn read_heat_extremes(&mut self) -> Result<f64, RunFailure> {
        self.launch(Stage::HeatExtremes)?;
        let left = reduce::left(Group::HeatExtremes, reduce::rows(self.stride));
        let numbers = read(&self.card, &self.columns, left)?;
        let rows = numbers.len() / EXTREMES;
        let of = |k: usize| numbers[k * rows..(k + 1) * rows].iter().map(|number| f64::from(*number));
        let is_broken = of(2).any(|broken| broken > 0.0);
        let of_rank = [
            f64::from(u8::from(is_broken)),
            -of(1).fold(f64::INFINITY, f64::min),
            -of(0).fold(f64::INFINITY, f64::min),
        ];
        let [broken, coldest, limit] = self.largest_of_ranks(of_rank)?;
        self.coldest = if broken > 0.0 { f64::NAN } else { -coldest };
        let limit = -limit;
        Ok(if limit < BEYOND { limit } else { f64::INFINITY })
    }

    /// Whether temperatures are numbers and, if a flux removes heat, above absolute zero.
    pub(super) fn guard_heat(&self) -> Result<(), RunFailure> {
        let is_cooled = self.model.thermal.is_cooled();
        if self.heat.is_none() || self.coldest >= 0.0 || !self.coldest.is_nan() && !is_cooled {
            return Ok(());
        }
        let wrong = check_values(&self.snapshot()?, is_cooled).map_err(StepFault::wrong).err();
        self.fail_together(wrong)?;
        Err(failure("a temperature is not finite"))
    }

    pub(super) fn conduction_limit(&self) -> TimeStepLimit {
        let limit = self.heat.map_or(f64::INFINITY, |clock| clock.limit);
        TimeStepLimit { dt: self.model.time.courant * limit, reason: LimitReason::Conduction }
    }
}
