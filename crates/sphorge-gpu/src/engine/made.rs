//! What is made of the sums of the segments, once they are there.

use super::kernels::reductions::{OF_WORST, SUSPECTS};
use super::ranks::agreement::Order;
use super::segments::Segments;
use sphorge_engine::model::Extremum;
use sphorge_engine::reduction::{Standard, Suspicion, Turns, extent_between_planes};
use sphorge_engine::{Model, RunFailure};

/// Numbers of the worst particle of a body as processes tell each other: how many are looked at, how many are suspicious, how bad the worst is, its `id`
/// and where it is.
const TALLY: usize = 7;

/// Sums of every segment, as they were read back: of each segment a number and its low part, sum after sum.
#[derive(Clone, Copy)]
pub(super) struct SegmentSums<'a> {
    pub(super) model: &'a Model,
    pub(super) segments: &'a Segments,
    pub(super) numbers: &'a [f32],
}

impl SegmentSums<'_> {
    /// The two numbers that stand for one, or for themselves.
    fn pair(&self, sum: usize, segment: usize) -> [f64; 2] {
        let at = 2 * (sum * self.segments.len() + segment);
        [self.numbers[at], self.numbers[at + 1]].map(f64::from)
    }

    pub(super) fn at(&self, sum: usize, segment: usize) -> f64 {
        let [number, rest] = self.pair(sum, segment);
        number + rest
    }

    /// Adds the first sums of the segments in their order.
    pub(super) fn add(&self, sums: &mut [f64]) {
        for segment in 0..self.segments.len() {
            for (sum, place) in sums.iter_mut().enumerate() {
                *place += self.at(sum, segment);
            }
        }
    }
}

/// What is made of the sums of a reduction.
#[derive(Clone, Copy, Debug)]
pub(super) enum Made {
    /// A sum over another.
    Ratio,
    /// An end of a range.
    Extremum(Extremum),
    /// The length of a range along an axis.
    Extent(usize),
    /// Twice the upper end of a range.
    Diameter,
    /// The value of one particle, which one process has.
    OfParticle,
    Suspects(Suspicion),
    Force,
}

impl Made {
    /// What a reduction of this kind is, where each process adds its segments in turn.
    pub(super) fn of(self, found: SegmentSums<'_>, order: Order<'_>) -> Result<Vec<f64>, RunFailure> {
        Ok(match self {
            Self::Ratio => {
                let mut sums = [0.0; 2];
                order.pass(&mut sums, |sums| found.add(sums))?;
                let [sum, weight] = sums;
                if weight > 0.0 { vec![sum / weight] } else { Vec::new() }
            }
            Self::Extremum(extremum) => {
                let of_range = |[low, high]: [f64; 2]| match extremum {
                    Extremum::Minimum => low,
                    Extremum::Maximum => high,
                };
                range(found, order)?.map(of_range).into_iter().collect()
            }
            Self::Extent(axis) => {
                let of_range = |[low, high]: [f64; 2]| extent_between_planes(found.model, axis, low, high);
                range(found, order)?.map(of_range).into_iter().collect()
            }
            Self::Diameter => range(found, order)?.map(|[_, radius]| 2.0 * radius).into_iter().collect(),
            Self::OfParticle => {
                let mut value = [0.0; 2];
                order.pass(&mut value, |value| {
                    if let [number, rest] = found.numbers {
                        value.copy_from_slice(&[1.0, f64::from(*number) + f64::from(*rest)]);
                    }
                })?;
                let [is_there, value] = value;
                if is_there > 0.0 { vec![value] } else { Vec::new() }
            }
            Self::Suspects(suspicion) => suspects(suspicion, found, order)?,
            Self::Force => {
                let mut force = vec![0.0; 3];
                order.pass(&mut force, |force| found.add(force))?;
                force
            }
        })
    }
}

/// The smallest and the largest; none where there is no particle.
fn range(found: SegmentSums<'_>, order: Order<'_>) -> Result<Option<[f64; 2]>, RunFailure> {
    let mut range = [0.0, 0.0, 0.0];
    order.pass(&mut range, |range| {
        for segment in 0..found.segments.len() {
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

/// Particles that are not as they should be, body by body, as [`sphorge_engine::reduction::Suspects`] reads them.
fn suspects(suspicion: Suspicion, found: SegmentSums<'_>, order: Order<'_>) -> Result<Vec<f64>, RunFailure> {
    let bodies = &found.model.bodies;
    let standard = |body: usize| suspicion.standard(found.model, bodies[body].material);
    let mut own = vec![[0.0; TALLY]; bodies.len()];
    for (k, segment) in found.segments.list.iter().enumerate() {
        let tally = &mut own[segment.body as usize];
        if standard(segment.body as usize) != Standard::Unseen {
            tally[0] += f64::from(segment.particles);
        }
        let [suspects, place] = found.pair(0, k);
        add_suspects(tally, suspects, [found.at(1, k), f64::from(found.segments.id_at(place)), 0.0, 0.0, 0.0]);
    }
    let of_worst = &found.numbers[found.segments.numbers_of(SUSPECTS)..];
    for (tally, [x, x_rest, y, y_rest, z, z_rest]) in own.iter_mut().zip(of_worst.as_chunks::<OF_WORST>().0) {
        let at_worst = [[x, x_rest], [y, y_rest], [z, z_rest]].map(|pair| pair.map(|x| f64::from(*x)).iter().sum());
        tally[4..].copy_from_slice(&at_worst);
    }
    let mut all = vec![[0.0; TALLY]; bodies.len()];
    order.pass(all.as_flattened_mut(), |sums| {
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
