//! Sums, means, extrema and checks that a deck or a run asks for: on the GPU where they are sums or extremes of single particles. What looks at particles
//! beside each other, and slabs, are evaluated by the processor, of the groups of columns that they need.

use super::columns::Recording;
use super::kernels::quantities;
use super::kernels::reductions::{self, Reduced};
use super::kernels::sums::of_lanes;
use super::made::Made;
use super::{GpuEngine, failure};
use crate::device::Launch;
use crate::record::KernelFault;
use sphorge_engine::model::ParticleSelection;
use sphorge_engine::reduction::{
    AGAINST, Quantity, Reduction, Standard, Suspicion, evaluate, evaluate_in_turn, line_of_diameter,
};
use sphorge_engine::{Model, Particles, RunFailure};
use sphorge_physics::Vector;
use std::sync::Arc;

/// Launches of reductions that were asked for before.
pub(super) type Known = Vec<(String, Arc<Vec<Launch>>)>;

/// A reduction that was launched: how many numbers it leaves, and what is made of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Launched {
    pub(super) count: usize,
    pub(super) made: Made,
}

impl GpuEngine {
    pub(super) fn reduction(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        let Some(Launched { count, made }) = self.launch_sum(reduction)? else { return self.evaluated(reduction) };
        let numbers = self.first_sums(count)?;
        made.of(self.of_segments(&numbers), self.order())
    }

    /// Launches the sums of a reduction, if the GPU takes them.
    pub(super) fn launch_sum(&self, reduction: &Reduction<'_>) -> Result<Option<Launched>, RunFailure> {
        let nowhere = [0.0; 3];
        match *reduction {
            Reduction::SectionForce(section) => self.launch_section(section).map(Some),
            Reduction::Mean { of, quantity } => self.launch_reduced(of, &Reduced::Mean(quantity), nowhere, Made::Ratio),
            Reduction::Interpolation { of, quantity, point } => {
                self.launch_reduced(of, &Reduced::Interpolation(quantity), point, Made::Ratio)
            }
            Reduction::Extremum { of, quantity, extremum } => {
                self.launch_reduced(of, &Reduced::Range(quantity), nowhere, Made::Extremum(extremum))
            }
            Reduction::Extent { of, axis } => {
                self.launch_reduced(of, &Reduced::Ends(axis), nowhere, Made::Extent(axis))
            }
            Reduction::Diameter { of, axis } => {
                let centre = match known_line_of_diameter(&self.model, axis) {
                    Some(centre) => centre,
                    None => self.line_of_diameter(of, axis)?,
                };
                self.launch_reduced(of, &Reduced::Radius(axis), centre, Made::Diameter)
            }
            Reduction::OfParticle { id, quantity } => self.launch_value(id, quantity),
            Reduction::Suspects(suspicion) if suspicion.is_of_single_particles() => {
                self.launch_suspects(suspicion).map(Some)
            }
            Reduction::Slabs { .. } | Reduction::Nearest { .. } | Reduction::Suspects(_) => Ok(None),
        }
    }

    /// A reduction that the processor evaluates.
    pub(super) fn evaluated(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
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

    /// Launches what a reduction makes of each segment of the selected particles, where the GPU knows the quantity.
    fn launch_reduced(
        &self,
        of: &ParticleSelection,
        reduced: &Reduced<'_>,
        point: Vector<f64>,
        made: Made,
    ) -> Result<Option<Launched>, RunFailure> {
        if !reduced.quantity().is_none_or(|quantity| quantities::is_known(quantity, &self.model)) {
            return Ok(None);
        }
        self.give_numbers(&reductions::numbers(&self.model, point, 0, |_| None))?;
        let (partition, count) = (self.segments.partition(), reduced.count());
        let references = self.references();
        self.launch_reduction(format!("{reduced:?} {of:?}"), || {
            let lanes = reductions::of_particles(&self.model, reduced, of, references, (partition, self.stride))?;
            let together = if reduced.is_sum() {
                of_lanes(partition.lanes(), self.stride)
            } else {
                reductions::largest_of_lanes(partition.lanes(), self.stride)
            };
            Ok(vec![(lanes, partition.segments * partition.lanes()), (together?, partition.segments * count)])
        })?;
        Ok(Some(Launched { count: self.segments.numbers_of(count), made }))
    }

    /// A point of the line that a diameter is taken about, through the mean position of the particles, which is waited for.
    fn line_of_diameter(&self, of: &ParticleSelection, axis: usize) -> Result<Vector<f64>, RunFailure> {
        let mut sums = [0.0; 4];
        if let Some(Launched { count, .. }) = self.launch_reduced(of, &Reduced::Centre, [0.0; 3], Made::Ratio)? {
            let numbers = self.first_sums(count)?;
            self.reduce_in_order(&mut sums, |sums| self.of_segments(&numbers).add(sums))?;
        }
        Ok(line_of_diameter(&self.model, axis, sums))
    }

    /// Launches the value of a particle that the GPU knows; nothing of one that another process has.
    fn launch_value(&self, id: u32, quantity: Quantity<'_>) -> Result<Option<Launched>, RunFailure> {
        if !quantities::is_known(quantity, &self.model) {
            return Ok(None);
        }
        let made = Made::OfParticle;
        let Some(row) = self.segments.row_of(id) else { return Ok(Some(Launched { count: 0, made })) };
        self.give_numbers(&reductions::numbers(&self.model, [0.0; 3], row, |_| None))?;
        self.launch_reduction(format!("{quantity:?}"), || {
            Ok(vec![(reductions::of_particle(&self.model, quantity, self.stride)?, 1)])
        })?;
        Ok(Some(Launched { count: 2, made }))
    }

    /// Launches the look for particles that are not as they should be.
    fn launch_suspects(&self, suspicion: Suspicion) -> Result<Launched, RunFailure> {
        let against = |body: usize| -> Option<[f64; AGAINST]> {
            match suspicion.standard(&self.model, self.model.bodies[body].material) {
                Standard::Against(numbers) => Some(numbers),
                Standard::Unseen | Standard::Blameless => None,
            }
        };
        self.give_numbers(&reductions::numbers(&self.model, [0.0; 3], 0, against))?;
        let (partition, bodies) = (self.segments.partition(), self.model.bodies.len());
        self.launch_reduction(format!("{:?}", std::mem::discriminant(&suspicion)), || {
            let kernels = reductions::suspects(&self.model, suspicion, (partition, self.stride))?;
            let threads = [partition.segments * partition.lanes(), partition.segments, bodies];
            Ok(kernels.into_iter().zip(threads).collect())
        })?;
        let [_, count] = reductions::numbers_of_suspects(partition.segments, bodies);
        Ok(Launched { count, made: Made::Suspects(suspicion) })
    }
}

/// A point of the line that a diameter is taken about, where it does not depend on the particles: between planes of symmetry, or where there is one
/// direction across the axis alone, in which all particles are at zero.
fn known_line_of_diameter(model: &Model, axis: usize) -> Option<Vector<f64>> {
    let between_planes = line_of_diameter(model, axis, [f64::NAN, f64::NAN, f64::NAN, 1.0]);
    let known = |a: usize| match between_planes[a] {
        _ if a == axis || a >= model.dimensions.count() => Some(0.0),
        x if x.is_nan() => None,
        x => Some(x),
    };
    let [x, y, z] = [0, 1, 2].map(known);
    Some([x?, y?, z?])
}
