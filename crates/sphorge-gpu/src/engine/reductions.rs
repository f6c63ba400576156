//! Sums, means, extrema and checks that a deck or a run asks for: on the card where they are sums or extremes of single particles. What looks at particles
//! beside each other, and slabs, are evaluated by the processor, of the groups of columns that they need.

use super::columns::Recording;
use super::kernels::quantities;
use super::kernels::reductions::{self, Reduced};
use super::kernels::sums::of_lanes;
use super::ledger::SegmentSums;
use super::{GpuEngine, failure};
use crate::device::Launch;
use crate::record::KernelFault;
use sphorge_engine::model::{Extremum, ParticleSelection};
use sphorge_engine::reduction::{
    AGAINST, Quantity, Reduction, Standard, Suspicion, evaluate, evaluate_in_turn, extent_between_planes,
    line_of_diameter,
};
use sphorge_engine::{Particles, RunFailure};
use sphorge_physics::Vector;
use std::sync::Arc;

/// Launches of reductions that were asked for before.
pub(super) type Known = Vec<(String, Arc<Vec<Launch>>)>;

/// Numbers of the worst particle of a body as processes tell each other: how many are looked at, how many are suspicious, how bad the worst is, its `id`
/// and where it is.
const TALLY: usize = 7;

impl GpuEngine {
    pub(super) fn reduction(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        let on_card = match *reduction {
            Reduction::SectionForce(section) => return self.section_force(section),
            Reduction::Mean { of, quantity } => self.ratio(of, Reduced::Mean(quantity), [0.0; 3])?,
            Reduction::Interpolation { of, quantity, point } => {
                self.ratio(of, Reduced::Interpolation(quantity), point)?
            }
            Reduction::Extremum { of, quantity, extremum } => self.extremum(of, quantity, extremum)?,
            Reduction::Extent { of, axis } => Some(self.extent(of, axis)?),
            Reduction::Diameter { of, axis } => Some(self.diameter(of, axis)?),
            Reduction::OfParticle { id, quantity } => self.of_particle(id, quantity)?,
            Reduction::Suspects(suspicion) if suspicion.is_of_single_particles() => Some(self.suspects(suspicion)?),
            Reduction::Slabs { .. } | Reduction::Nearest { .. } | Reduction::Suspects(_) => None,
        };
        match on_card {
            Some(found) => Ok(found),
            None => self.evaluated(reduction),
        }
    }

    /// A reduction that the processor evaluates.
    fn evaluated(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        let particles = self.with_fields(&reduction.fields())?;
        match &self.domain {
            Some(domain) => evaluate_in_turn(reduction, &self.model, &particles, &domain.ranks),
            None => Ok(evaluate(reduction, &self.model, &particles)),
        }
    }

    /// Particles with the named stored fields, of the groups that these are made of alone.
    fn with_fields(&self, fields: &[&str]) -> Result<Particles, RunFailure> {
        let mut particles = Particles::new(self.initial.len());
        for field in fields {
            particles.set_column(field, &self.field(field)?);
        }
        Ok(particles)
    }

    /// Launches the kernels of a reduction, made when it is first asked for.
    fn launch_reduction(
        &self,
        key: String,
        make: impl FnOnce() -> Result<Vec<(Recording, usize)>, KernelFault>,
    ) -> Result<(), RunFailure> {
        let known = self.reductions.borrow().iter().find(|(of, _)| *of == key).map(|(_, launches)| launches.clone());
        let launches = match known {
            Some(launches) => launches,
            None => {
                let bind = |(kernel, threads): (Recording, usize)| kernel.bind(&self.card, &self.columns, threads);
                let kernels = make().map_err(failure)?;
                let launches: Result<Vec<_>, _> = kernels.into_iter().map(bind).collect();
                let launches = Arc::new(launches.map_err(failure)?);
                self.reductions.borrow_mut().push((key, launches.clone()));
                launches
            }
        };
        self.card.launch(launches.iter());
        Ok(())
    }

    /// What a reduction makes of each segment of the selected particles.
    fn reduced(
        &self,
        of: &ParticleSelection,
        reduced: &Reduced<'_>,
        point: Vector<f64>,
    ) -> Result<SegmentSums, RunFailure> {
        self.give_numbers(&reductions::numbers(&self.model, point, 0, |_| None))?;
        let (portions, count) = (self.segments.portions(), reduced.count());
        let references = self.references();
        self.launch_reduction(format!("{reduced:?} {of:?}"), || {
            let lanes = reductions::of_particles(&self.model, reduced, of, references, (portions, self.stride))?;
            let together = if reduced.is_sum() {
                of_lanes(portions.lanes(), self.stride)
            } else {
                reductions::largest_of_lanes(portions.lanes(), self.stride)
            };
            Ok(vec![(lanes, portions.segments * portions.lanes()), (together?, portions.segments * count)])
        })?;
        self.segment_sums(count)
    }

    /// A sum over another, where the card knows the quantity.
    fn ratio(
        &self,
        of: &ParticleSelection,
        reduced: Reduced<'_>,
        point: Vector<f64>,
    ) -> Result<Option<Vec<f64>>, RunFailure> {
        if !self.is_known(reduced.quantity()) {
            return Ok(None);
        }
        let found = self.reduced(of, &reduced, point)?;
        let mut sums = [0.0; 2];
        self.in_turn(&mut sums, |sums| found.add(sums))?;
        let [sum, weight] = sums;
        Ok(Some(if weight > 0.0 { vec![sum / weight] } else { Vec::new() }))
    }

    fn is_known(&self, quantity: Option<Quantity<'_>>) -> bool {
        quantity.is_none_or(|of| quantities::is_known(of, &self.model))
    }

    /// The smallest and the largest; none where there is no particle.
    fn range(
        &self,
        of: &ParticleSelection,
        reduced: &Reduced<'_>,
        point: Vector<f64>,
    ) -> Result<Option<[f64; 2]>, RunFailure> {
        if !self.is_known(reduced.quantity()) {
            return Ok(None);
        }
        let found = self.reduced(of, reduced, point)?;
        let mut range = [0.0, 0.0, 0.0];
        self.in_turn(&mut range, |range| {
            for segment in 0..self.segments.len() {
                let [largest, smallest, is_any] = [0, 1, 2].map(|k| found.at(k, segment));
                if is_any > 0.0 {
                    let is_first = range[2] == 0.0;
                    range[0] = if is_first { -smallest } else { range[0].min(-smallest) };
                    range[1] = if is_first { largest } else { range[1].max(largest) };
                    range[2] = 1.0;
                }
            }
        })?;
        let [low, high, is_any] = range;
        Ok((is_any > 0.0).then_some([low, high]))
    }

    fn extremum(
        &self,
        of: &ParticleSelection,
        quantity: Quantity<'_>,
        extremum: Extremum,
    ) -> Result<Option<Vec<f64>>, RunFailure> {
        if !self.is_known(Some(quantity)) {
            return Ok(None);
        }
        let range = self.range(of, &Reduced::Range(quantity), [0.0; 3])?;
        let of_range = |[low, high]: [f64; 2]| match extremum {
            Extremum::Minimum => low,
            Extremum::Maximum => high,
        };
        Ok(Some(range.map(of_range).into_iter().collect()))
    }

    fn extent(&self, of: &ParticleSelection, axis: usize) -> Result<Vec<f64>, RunFailure> {
        let range = self.range(of, &Reduced::Ends(axis), [0.0; 3])?;
        Ok(range.map(|[low, high]| extent_between_planes(&self.model, axis, low, high)).into_iter().collect())
    }

    fn diameter(&self, of: &ParticleSelection, axis: usize) -> Result<Vec<f64>, RunFailure> {
        let found = self.reduced(of, &Reduced::Centre, [0.0; 3])?;
        let mut sums = [0.0; 4];
        self.in_turn(&mut sums, |sums| found.add(sums))?;
        let centre = line_of_diameter(&self.model, axis, sums);
        let range = self.range(of, &Reduced::Radius(axis), centre)?;
        Ok(range.map(|[_, radius]| 2.0 * radius).into_iter().collect())
    }

    fn of_particle(&self, id: u32, quantity: Quantity<'_>) -> Result<Option<Vec<f64>>, RunFailure> {
        if !quantities::is_known(quantity, &self.model) {
            return Ok(None);
        }
        let row = self.segments.row_of(&self.initial, id);
        let own = row.map(|row| self.value_of(row, quantity)).transpose()?;
        // One process has it.
        let mut found = [0.0; 2];
        self.in_turn(&mut found, |found| {
            if let Some(own) = own {
                found.copy_from_slice(&[1.0, own]);
            }
        })?;
        let [is_there, value] = found;
        Ok(Some(if is_there > 0.0 { vec![value] } else { Vec::new() }))
    }

    /// A quantity that the card knows of the particle in a row.
    fn value_of(&self, row: usize, quantity: Quantity<'_>) -> Result<f64, RunFailure> {
        self.give_numbers(&reductions::numbers(&self.model, [0.0; 3], row, |_| None))?;
        self.launch_reduction(format!("{quantity:?}"), || {
            Ok(vec![(reductions::of_particle(&self.model, quantity, self.stride)?, 1)])
        })?;
        let array = self.columns.array(super::Group::Sums).ok_or_else(|| failure("no sums"))?;
        let numbers = self.card.read_first(array, 2).map_err(failure)?;
        Ok(numbers.into_iter().map(f64::from).sum())
    }

    /// Particles that are not as they should be, body by body, as [`sphorge_engine::Suspects`] reads them.
    fn suspects(&self, suspicion: Suspicion) -> Result<Vec<f64>, RunFailure> {
        let standards: Vec<_> =
            self.model.bodies.iter().map(|body| suspicion.standard(&self.model, body.material)).collect();
        let against = |body: usize| -> Option<[f64; AGAINST]> {
            match standards[body] {
                Standard::Against(numbers) => Some(numbers),
                Standard::Unseen | Standard::Blameless => None,
            }
        };
        self.give_numbers(&reductions::numbers(&self.model, [0.0; 3], 0, against))?;
        let portions = self.segments.portions();
        self.launch_reduction(format!("{:?}", std::mem::discriminant(&suspicion)), || {
            let [of_lanes, of_segments] = reductions::suspects(&self.model, suspicion, (portions, self.stride))?;
            Ok(vec![(of_lanes, portions.segments * portions.lanes()), (of_segments, portions.segments)])
        })?;
        let found = self.segment_sums(2)?;
        let mut own = vec![[0.0; TALLY]; self.model.bodies.len()];
        for (k, segment) in self.segments.list.iter().enumerate() {
            let tally = &mut own[segment.body as usize];
            if standards[segment.body as usize] != Standard::Unseen {
                tally[0] += f64::from(segment.particles);
            }
            let ([suspects, place], worst) = (found.pair(0, k), found.at(1, k));
            let id = self.initial.id[self.segments.row_at(place)];
            add_suspects(tally, suspects, [worst, f64::from(id), 0.0, 0.0, 0.0]);
        }
        for tally in own.iter_mut().filter(|tally| tally[1] > 0.0) {
            let Some(row) = self.segments.row_of(&self.initial, tally[3] as u32) else { continue };
            for a in 0..3 {
                tally[4 + a] = self.value_of(row, Quantity { field: "position", component: Some(a) })?;
            }
        }
        let mut all = vec![[0.0; TALLY]; own.len()];
        self.in_turn(all.as_flattened_mut(), |sums| {
            for (sums, own) in sums.as_chunks_mut::<TALLY>().0.iter_mut().zip(&own) {
                sums[0] += own[0];
                add_suspects(sums, own[1], [own[2], own[3], own[4], own[5], own[6]]);
            }
        })?;
        for tally in &mut all {
            tally[2] *= suspicion.sense();
        }
        Ok(all.into_flattened())
    }
}

/// Adds suspects to those of a body, of which the worst is that with the largest number, and of those the first.
fn add_suspects(tally: &mut [f64; TALLY], suspects: f64, worst: [f64; 5]) {
    if suspects == 0.0 {
        return;
    }
    let is_worse = worst[0].total_cmp(&tally[2]).then(tally[3].total_cmp(&worst[1])).is_gt();
    if tally[1] == 0.0 || is_worse {
        tally[2..].copy_from_slice(&worst);
    }
    tally[1] += suspects;
}
