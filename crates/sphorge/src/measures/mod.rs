//! Evaluates the measures a deck declares, row by row of the history.
//!
//! Definitions, for the particles of a selection (body, region of the initial configuration, box around the present
//! position; all conditions hold). A particle reaches half a spacing of its body beyond its centre on every side. A
//! measure has no value while no particle is selected.
//!
//! - extent: `max(x + s/2) - min(x - s/2)` along the axis: the extent of the particles plus one spacing `s`, but
//!   not beyond a plane of symmetry.
//! - diameter: `2 max(r + s/2)` with `r` the distance from a line along the axis. The line runs through the mean position of
//!   the particles; where a symmetry plane contains the axis, it runs in that plane (a quarter model knows its axis).
//! - extreme: largest or smallest value, now or in any row so far; a vector or tensor by its norm unless a component is named.
//! - mean: `sum m f / sum m`.
//! - value: `sum (m/rho) f W / sum (m/rho) W` at a point (Shepard), no value where no kernel reaches.
//! - front speed: the field is averaged in slabs of one spacing across the axis; seen from the end the front runs to, the
//!   front is where the slab means first cross the level, on the straight line between two slabs. The side of the level on
//!   which that end lies in the first sample is the material ahead; once the end itself has crossed, the front has left. The
//!   speed is the slope of the least-squares line through the positions of the samples in the window, positive in the
//!   direction of the front; it needs two.
//! - period: the mean over the particles is a signal in time, its average over all samples the middle. The period is the
//!   time from the first to the last upward crossing of the middle over the number of cycles between. A crossing counts
//!   once the signal has gone from below to above the middle by a fifth of its root-mean-square deviation.
//! - reversal time: when the mean velocity first has the other sign than it first had, on the straight line between the two
//!   samples around it.
//!
//! - crater diameter, cloud length and width: what is left of a plate are its particles in fragments of at least a tenth of its mass
//!   that still stand between its undeformed faces somewhere; particles hang together up to `link` spacings. About the line of flight there are the two sides in the plane, in space
//!   36 sectors. The clear opening is twice the mean over sides of the smallest `r - s/2` of what is left, in space over rays in the middle of
//!   the sectors of how far they get: what is left covers discs of radius `s/sqrt(2)` about its particles, and where they cover the
//!   line of flight there is no hole, which is 0. From lip to lip it is twice the mean of the `r` of the particle that stands furthest out of the undeformed face. The cloud is every other particle of any body behind
//!   the undeformed back face: its length goes from that face to `max(x + s/2)` along the flight, its width is the reach `max(r +
//!   s/2)` of one side plus that of the other, in space twice `max(r + s/2)`; where only one side has particles, the other is taken
//!   to be alike. `leave-out` drops that share of the mass from the outer end before.
//! - fragments: the particles of a body that have some integrity hang together up to `link` spacings, as they would be undeformed where the
//!   deformation gradient is known; what hangs together and has at least `least` particles is a fragment.
//!
//! Fronts, periods, reversals and extremes over time know the rows of the history, nothing between: the history interval
//! of the deck is their resolution.

mod fragments;
mod front;
mod perforation;
mod period;
mod remains;
mod reversal;

use crate::{
    engine::{
        ParticleSource, Quantity, Reduction, RunFailure,
        persist::{Archive, ArchiveError, Persist, persist_column},
    },
    model::{Extremum, MeasureKind, Model, Perforation},
    particles::{Column, DEFORMATION_GRADIENT, Particles, is_kept},
};
use fragments::Fragments;
use front::FrontSpeed;
use perforation::Flight;
pub(crate) use perforation::Span;
use period::Period;
use remains::remains;
use reversal::Reversal;

/// The measures of a run with what they remember of its past.
#[derive(Clone, Debug)]
pub struct Measures {
    evaluators: Vec<Evaluator>,
    values: Vec<Option<f64>>,
}

#[derive(Clone, Debug)]
struct Evaluator {
    kind: MeasureKind,
    memory: Memory,
}

/// What a measure remembers.
#[derive(Clone, Debug)]
enum Memory {
    Nothing,
    Best(Option<f64>),
    Front(FrontSpeed),
    Period(Period),
    Reversal(Reversal),
}

impl Measures {
    /// The measures of a model, with no sample yet.
    pub fn new(model: &Model) -> Self {
        let evaluator = |kind: &MeasureKind| Evaluator {
            kind: kind.clone(),
            memory: match kind {
                MeasureKind::Extreme { over_time: true, .. } => Memory::Best(None),
                MeasureKind::FrontSpeed { level, window, .. } => Memory::Front(FrontSpeed::new(*level, *window)),
                MeasureKind::Period { .. } => Memory::Period(Period::default()),
                MeasureKind::ReversalTime { .. } => Memory::Reversal(Reversal::default()),
                MeasureKind::Extreme { over_time: false, .. }
                | MeasureKind::Extent { .. }
                | MeasureKind::Diameter { .. }
                | MeasureKind::Mean { .. }
                | MeasureKind::Value { .. }
                | MeasureKind::CraterDiameter { .. }
                | MeasureKind::Cloud { .. }
                | MeasureKind::Fragments { .. } => Memory::Nothing,
            },
        };
        Self {
            evaluators: model.measures.iter().map(|measure| evaluator(&measure.kind)).collect(),
            values: vec![None; model.measures.len()],
        }
    }

    /// What the next sample will ask, unless it needs all positions.
    pub(crate) fn asks(&self) -> Option<Vec<Reduction<'_>>> {
        self.evaluators.iter().map(Evaluator::reduction).collect()
    }

    /// Takes the state at `time` (s, later than any before) into account.
    ///
    /// # Errors
    /// The engine is lost.
    pub fn sample(&mut self, model: &Model, time: f64, source: &dyn ParticleSource) -> Result<(), RunFailure> {
        let all = self.evaluators.iter().any(|evaluator| evaluator.kind.needs_positions());
        let is_kept = |field: &str| is_kept(field, model.formulation, &model.materials);
        let mut fields = vec!["position", "mass", "body"];
        fields.extend(Some("integrity").filter(|field| is_kept(field)));
        let positions = if all { source.with_fields(&fields)? } else { Particles::default() };
        let of_fragments = self.evaluators.iter().any(|of| matches!(of.kind, MeasureKind::Fragments { .. }));
        let deformation = match of_fragments && is_kept(DEFORMATION_GRADIENT) {
            true => Some(source.read(DEFORMATION_GRADIENT)?),
            false => None,
        };
        let mut shared = Shared { deformation, ..Shared::default() };
        for (evaluator, value) in self.evaluators.iter_mut().zip(&mut self.values) {
            let now = evaluator.sample(model, time, source, &positions, &mut shared)?;
            *value = now.filter(|value| value.is_finite());
        }
        Ok(())
    }

    /// Value of each measure in the order of the deck, SI; `None` for one that has none (yet).
    pub fn values(&self) -> &[Option<f64>] {
        &self.values
    }
}

/// What several measures of one sample share.
#[derive(Debug, Default)]
struct Shared<'a> {
    /// What is left of plates, by plate, axis of the flight and link.
    remains: Vec<((usize, usize, u64), Vec<bool>)>,
    /// Deformation gradients, where some measure needs them and the form knows them.
    deformation: Option<Column<'a>>,
}

impl Shared<'_> {
    fn flight<'a>(
        &'a mut self,
        model: &'a Model,
        particles: &'a Particles,
        perforation: &'a Perforation,
    ) -> Flight<'a> {
        let Perforation { plate, axis, .. } = *perforation;
        let key = (plate, axis, perforation.link.to_bits());
        let place = self.remains.iter().position(|(other, _)| *other == key).unwrap_or_else(|| {
            let link = perforation.link * model.bodies[plate].spacing;
            let (low, high) = model.bodies[plate].shape.bounds(model.dimensions);
            let in_place = |x: &[f64; 3]| (low[axis]..=high[axis]).contains(&x[axis]);
            self.remains.push((key, remains(model, particles, plate, link, in_place)));
            self.remains.len() - 1
        });
        Flight { model, particles, perforation, remains: &self.remains[place].1 }
    }
}

/// Where a measure of a hole or a cloud is taken, for a drawing; none for other measures.
pub(crate) fn span(kind: &MeasureKind, model: &Model, particles: &Particles) -> Option<Span> {
    let mut shared = Shared::default();
    match kind {
        MeasureKind::CraterDiameter { perforation, edge } => shared.flight(model, particles, perforation).crater(*edge),
        MeasureKind::Cloud { perforation, extent, leave_out } => {
            shared.flight(model, particles, perforation).cloud(*extent, *leave_out)
        }
        MeasureKind::Extent { .. }
        | MeasureKind::Diameter { .. }
        | MeasureKind::Extreme { .. }
        | MeasureKind::Mean { .. }
        | MeasureKind::Value { .. }
        | MeasureKind::FrontSpeed { .. }
        | MeasureKind::Period { .. }
        | MeasureKind::ReversalTime { .. }
        | MeasureKind::Fragments { .. } => None,
    }
}

impl Evaluator {
    /// The sum that it is made of; none where it is made of all positions.
    fn reduction(&self) -> Option<Reduction<'_>> {
        Some(match &self.kind {
            MeasureKind::Extent { selection, axis } => Reduction::Extent { of: selection, axis: *axis },
            MeasureKind::Diameter { selection, axis } => Reduction::Diameter { of: selection, axis: *axis },
            MeasureKind::Extreme { selection, field, component, extremum, .. } => Reduction::Extremum {
                of: selection,
                quantity: Quantity { field, component: *component },
                extremum: *extremum,
            },
            MeasureKind::Mean { selection, field, component } | MeasureKind::Period { selection, field, component } => {
                Reduction::Mean { of: selection, quantity: Quantity { field, component: *component } }
            }
            MeasureKind::Value { selection, field, component, point } => Reduction::Interpolation {
                of: selection,
                quantity: Quantity { field, component: *component },
                point: *point,
            },
            MeasureKind::FrontSpeed { selection, field, component, axis, direction, .. } => Reduction::Slabs {
                of: selection,
                quantity: Quantity { field, component: *component },
                axis: *axis,
                direction: direction.signum(),
            },
            MeasureKind::ReversalTime { selection, axis } => {
                Reduction::Mean { of: selection, quantity: Quantity { field: "velocity", component: Some(*axis) } }
            }
            MeasureKind::CraterDiameter { .. } | MeasureKind::Cloud { .. } | MeasureKind::Fragments { .. } => {
                return None;
            }
        })
    }

    fn sample(
        &mut self,
        model: &Model,
        time: f64,
        source: &dyn ParticleSource,
        positions: &Particles,
        shared: &mut Shared<'_>,
    ) -> Result<Option<f64>, RunFailure> {
        let found = self.reduction().map(|asked| source.reduce(&asked)).transpose()?.unwrap_or_default();
        let now = found.first().copied();
        Ok(match (&self.kind, &mut self.memory) {
            (MeasureKind::Extreme { extremum, .. }, Memory::Best(best)) => {
                let better = match extremum {
                    Extremum::Maximum => f64::max,
                    Extremum::Minimum => f64::min,
                };
                *best = now.into_iter().chain(*best).reduce(better);
                *best
            }
            (_, Memory::Front(front)) => {
                front.sample(time, &found);
                front.speed()
            }
            (_, Memory::Period(period)) => {
                now.into_iter().for_each(|mean| period.sample(time, mean));
                period.period()
            }
            (_, Memory::Reversal(reversal)) => {
                now.into_iter().for_each(|mean| reversal.sample(time, mean));
                reversal.time()
            }
            (MeasureKind::CraterDiameter { perforation, edge }, _) => {
                shared.flight(model, positions, perforation).crater(*edge).map(|span| span.length)
            }
            (MeasureKind::Cloud { perforation, extent, leave_out }, _) => {
                shared.flight(model, positions, perforation).cloud(*extent, *leave_out).map(|span| span.length)
            }
            (MeasureKind::Fragments { body, quantity, link, least }, _) => {
                let deformation = match &shared.deformation {
                    Some(Column::Tensor(values)) => Some(&**values),
                    _ => None,
                };
                Some(Fragments::of(model, positions, deformation, *body, *link, *least).quantity(*quantity))
            }
            _ => now,
        })
    }
}

impl Persist for Measures {
    /// What every measure remembers, by its place in the deck, and the values of the last sample.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        persist_column(&mut self.values, &format!("{name}.values"), archive)?;
        for (k, evaluator) in self.evaluators.iter_mut().enumerate() {
            evaluator.memory.persist(&format!("{name}.{k}"), archive)?;
        }
        Ok(())
    }
}

impl Persist for Memory {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        match self {
            Self::Nothing => Ok(()),
            Self::Best(best) => best.persist(&format!("{name}.best"), archive),
            Self::Front(front) => front.persist(&format!("{name}.front"), archive),
            Self::Period(period) => period.persist(&format!("{name}.period"), archive),
            Self::Reversal(reversal) => reversal.persist(&format!("{name}.reversal"), archive),
        }
    }
}

#[cfg(test)]
mod tests;
