//! Renewal of the reference configuration of bodies that separate, as in the CPU engine.
//!
//! Each step marks particles that are deformed too far; a flag comes back with the limits of the step. The rest is
//! rare: the bodies of the marked particles are read back, the energy held by their self-contact is released on the
//! processor, and the configuration and its lists are rebuilt on the GPU. Until the first renewal the kernels use only
//! the initial configuration.

use super::columns::{Compensated, Group, Handles, Layout, Member, Number, groups};
use super::initial_columns::{initial_numbers, part};
use super::kernels::limits;
use super::kernels::reference::References;
use super::read_back::read;
use super::stages::Stage;
use super::{GpuEngine, failure};
use sphorge_engine::persist::{Archive, ArchiveError, Persist};
use sphorge_engine::{RunFailure, heat_of_released};
use sphorge_physics::contact::share_of_released;

impl GpuEngine {
    /// Whether any body has a reference configuration other than the initial one.
    pub(super) fn is_renewed(&self) -> bool {
        self.has_separated.contains(&true)
    }

    /// Makes the current configuration of bodies that are deformed too far their reference. Returns whether there was
    /// such a body.
    pub(super) fn renew_references(&mut self) -> Result<bool, RunFailure> {
        if self.extremes[limits::STRETCHED] <= 0.0 {
            return Ok(false);
        }
        let marks = read(&self.card, &self.columns, Group::Stretch)?;
        let mut is_due = vec![false; self.has_separated.len()];
        for (body, mark) in
            self.initial.body.iter().zip(&marks[groups::Stretch::layout().is_beyond.column() * self.stride..])
        {
            is_due[*body as usize] |= *mark > 0.0;
        }
        let is_due = self.on_any_rank(&is_due)?;
        let was_renewed = self.is_renewed();
        if self.model.has_facets() && self.model.bodies.len() > 1 {
            return Err(failure(
                "a body that meets others at facets has come apart, from when on it meets them by overlap, which cards do not do in one \
                 run: run it with `--engine cpu`, or let bodies meet by overlap from the start: \
                 `contact = { penalty = { surfaces = \"overlap\" } }`",
            ));
        }
        for body in 0..is_due.len() {
            if is_due[body] && !self.has_separated[body] {
                self.release(body)?;
                self.has_separated[body] = true;
            }
        }
        if !was_renewed {
            self.take_references(References::Renewed)?;
        }
        self.write_flags(&is_due)?;
        self.launch(Stage::Renew)?;
        self.choose_ghosts()?;
        self.make_lists_anew()?;
        self.lists.last_searched = self.steps;
        Ok(true)
    }

    /// The columns of a group as they are at the start.
    fn at_start<H: Handles<()>>(&self) -> Vec<f32> {
        initial_numbers((H::GROUP, H::LENGTH), (&self.model, &self.initial), self.stride)
    }

    /// Selects the kernels for renewed references, or those without.
    fn take_references(&mut self, references: References) -> Result<(), RunFailure> {
        if references == References::Renewed {
            let bodies = self.has_separated.len();
            let earlier = self.at_start::<groups::Earlier<()>>();
            self.columns.insert(Group::Earlier, self.card.numbers(&earlier).map_err(failure)?);
            self.columns.insert(Group::Apart, self.card.zeros(2 * bodies).map_err(failure)?);
        } else {
            self.columns.remove(Group::Earlier);
            self.columns.remove(Group::Apart);
        }
        self.plan = self.plan_of(references)?;
        self.rebind()
    }

    /// Copies to the GPU which bodies have separated and which are to be renewed.
    fn write_flags(&self, is_due: &[bool]) -> Result<(), RunFailure> {
        let flags: Vec<f32> =
            self.has_separated.iter().chain(is_due).map(|flag| if *flag { 1.0 } else { 0.0 }).collect();
        let array = self.columns.array(Group::Apart).ok_or_else(|| failure("no flags of bodies"))?;
        self.card.write(array, &flags);
        Ok(())
    }

    /// Converts the energy held by the contact of a body with itself to heat of the particles it presses. From now on
    /// its surfaces meet in the sums of the body.
    fn release(&self, body: usize) -> Result<(), RunFailure> {
        if !self.model.has_self_contact() {
            return Ok(());
        }
        let array = |group: Group| self.columns.array(group).ok_or_else(|| failure(format!("no column {group:?}")));
        let column = |group| read(&self.card, &self.columns, group);
        let (mut meetings, mut energy) = (column(Group::Meetings)?, column(Group::Energy)?);
        let (has_facets, stride) = (self.model.has_facets(), self.stride);
        let of_overlap = |group| if has_facets { Ok(Vec::new()) } else { column(group) };
        let (overlap, outward) = (of_overlap(Group::Overlap)?, of_overlap(Group::Outward)?);
        let number = |of: &[f32], column: Number<()>, i: usize| f64::from(of[column.column() * stride + i]);
        let of_body = groups::Meetings::layout().of(body);
        let held = |of: &[f32], i: usize| number(of, of_body.energy, i);
        let is_holding: Vec<bool> = (0..self.initial.len()).map(|i| held(&meetings, i) > 0.0).collect();
        let double = |of: &[f32], columns: Compensated<()>, i: usize| {
            let [high, low] = columns.columns();
            f64::from(of[high * stride + i]) + f64::from(of[low * stride + i])
        };
        let set = |of: &mut [f32], columns: Compensated<()>, i: usize, number: f64| {
            for (column, rest) in columns.columns().into_iter().zip([false, true]) {
                of[column * stride + i] = part(number, rest) as f32;
            }
        };
        let own: Vec<usize> = (0..self.initial.len()).filter(|i| self.initial.body[*i] as usize == body).collect();
        let [stored, _, damped] = [0, 1, 2].map(|k| of_body.works.number(k));
        let mut stored_by = Vec::new();
        for &i in &own {
            // Each particle of a pair has half.
            let taken_up = double(&meetings, stored, i);
            // What facets hold is known.
            let here = if has_facets { held(&meetings, i) } else { taken_up };
            stored_by.push(here);
            let sum = double(&meetings, damped, i) + here;
            set(&mut meetings, damped, i, sum);
            set(&mut meetings, stored, i, taken_up - here);
        }
        let normal = groups::Outward::layout().normal;
        let pressed = |i: usize| {
            if has_facets {
                return f64::from(u8::from(is_holding[i]));
            }
            let is_exposed = (0..3).any(|a| number(&outward, normal.axis(a), i) != 0.0);
            if is_exposed { share_of_released(number(&overlap, groups::Overlap::layout().overlap, i)) } else { 0.0 }
        };
        let sum = |part: &dyn Fn(usize) -> f64| self.sum_in_order(own.iter().map(|i| self.initial.mass[*i] * part(*i)));
        let released = self.sum_in_order(stored_by.into_iter())?;
        let heat = heat_of_released(released, &pressed, sum)?;
        let internal = groups::Energy::layout().energy;
        for &i in &own {
            let after = double(&energy, internal, i) + heat(i);
            set(&mut energy, internal, i, after);
        }
        self.card.write(array(Group::Meetings)?, &meetings);
        self.card.write(array(Group::Energy)?, &energy);
        self.wrote(Group::Energy);
        Ok(())
    }

    /// Saves or loads which bodies have separated; loading selects the kernels for them. Columns follow, and then
    /// [`Self::make_lists_anew`].
    pub(super) fn persist_references(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let was_renewed = self.is_renewed();
        self.has_separated.persist("has_come_apart", archive)?;
        if self.has_separated.len() != self.model.bodies.len() {
            return Err(ArchiveError::Mismatch("has_come_apart".to_owned()));
        }
        if archive.is_saving() || !(was_renewed || self.is_renewed()) {
            return Ok(());
        }
        self.load_references(was_renewed).map_err(|fault| ArchiveError::Unsupported(fault.to_string()))
    }

    fn load_references(&mut self, was_renewed: bool) -> Result<(), RunFailure> {
        let is_renewed = self.is_renewed();
        self.lists.had_other_references = true;
        if is_renewed != was_renewed {
            self.take_references(if is_renewed { References::Renewed } else { References::Initial })?;
        }
        if is_renewed {
            return self.write_flags(&vec![false; self.has_separated.len()]);
        }
        let numbers = self.at_start::<groups::Reference<()>>();
        let array = self.columns.array(Group::Reference).ok_or_else(|| failure("no reference configuration"))?;
        self.card.write(array, &numbers);
        self.wrote(Group::Reference);
        Ok(())
    }

    /// The reference configurations that kernels support.
    pub(super) fn references(&self) -> References {
        if self.is_renewed() { References::Renewed } else { References::Initial }
    }
}
