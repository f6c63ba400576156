//! Hole in a plate and debris behind it; the definitions are in [`super`].

use crate::{
    model::{CloudExtent, CraterEdge, Dimensions, Model, Perforation},
    particles::Particles,
};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Sectors about the line of flight in space; in the plane there are the two sides.
const SECTORS: usize = 36;

/// A length between two points of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    /// m.
    pub(crate) length: f64,
    /// Where it is measured from and to, for a drawing.
    pub(crate) ends: [[f64; 3]; 2],
}

/// Particles about a line of flight.
pub(super) struct Flight<'a> {
    pub(super) model: &'a Model,
    pub(super) particles: &'a Particles,
    pub(super) perforation: &'a Perforation,
    /// For every particle, whether it is left of the plate.
    pub(super) remains: &'a [bool],
}

impl Flight<'_> {
    fn half_spacing(&self, i: usize) -> f64 {
        0.5 * self.model.bodies[self.particles.body[i] as usize].spacing
    }

    /// Place along the flight.
    fn along(&self, i: usize) -> f64 {
        self.perforation.direction * self.particles.position[i][self.perforation.axis]
    }

    /// The axes across the flight.
    fn across(&self) -> impl Iterator<Item = usize> {
        let axis = self.perforation.axis;
        (0..self.model.dimensions.count()).filter(move |&a| a != axis)
    }

    /// Distances from the line of flight along the axes across it.
    fn offset(&self, i: usize) -> [f64; 2] {
        let mut offset = [0.0; 2];
        for (place, axis) in offset.iter_mut().zip(self.across()) {
            *place = self.particles.position[i][axis] - self.perforation.point[axis];
        }
        offset
    }

    /// Faces of the undeformed plate along the flight: entry, exit.
    fn faces(&self) -> (f64, f64) {
        let Perforation { plate, axis, direction, .. } = *self.perforation;
        let (low, high) = self.model.bodies[plate].shape.bounds(self.model.dimensions);
        let (a, b) = (direction * low[axis], direction * high[axis]);
        (a.min(b), a.max(b))
    }

    /// Sector about the line of flight, and how many there are.
    fn sector(&self, [a, b]: [f64; 2]) -> usize {
        match self.model.dimensions {
            Dimensions::Three => ((b.atan2(a) / TAU).rem_euclid(1.0) * SECTORS as f64) as usize % SECTORS,
            _ => usize::from(a < 0.0),
        }
    }

    fn sectors(&self) -> usize {
        if self.model.dimensions == Dimensions::Three { SECTORS } else { 2 }
    }

    /// The point at this place along the flight and this far to the side.
    fn point(&self, along: f64, aside: f64) -> [f64; 3] {
        let mut point = self.perforation.point;
        point[self.perforation.axis] = self.perforation.direction * along;
        if let Some(axis) = self.across().next() {
            point[axis] += aside;
        }
        point
    }

    /// Diameter of the hole.
    pub(super) fn crater(&self, edge: CraterEdge) -> Option<Span> {
        match (edge, self.model.dimensions) {
            (CraterEdge::Clear, Dimensions::Three) => self.clear_opening(),
            _ => self.innermost(edge),
        }
    }

    /// Seen along the flight a particle covers a disc about its cell, so that a plate without a hole is covered whole; the opening is
    /// how far rays from the line of flight get.
    fn clear_opening(&self) -> Option<Span> {
        let step = TAU / SECTORS as f64;
        let mut free = [f64::INFINITY; SECTORS];
        for i in (0..self.particles.len()).filter(|&i| self.remains[i]) {
            let [a, b] = self.offset(i);
            let (r, angle) = (a.hypot(b), b.atan2(a));
            // Corners of the cells of an undeformed lattice touch.
            let cover = 2.0 * FRAC_1_SQRT_2 * self.half_spacing(i) * (1.0 + 1e-6);
            if r <= cover {
                return Some(self.opening(0.0, 0.0, 0.0));
            }
            // Ray k leaves in the middle of its sector.
            let half = (cover / r).asin();
            let ray = |angle: f64| angle / step - 0.5;
            for k in ray(angle - half).ceil() as i64..=ray(angle + half).floor() as i64 {
                let away = (k as f64 + 0.5) * step - angle;
                let reach = r * away.cos() - (cover * cover - (r * away.sin()).powi(2)).max(0.0).sqrt();
                let free = &mut free[k.rem_euclid(SECTORS as i64) as usize];
                *free = free.min(reach);
            }
        }
        let found = || free.iter().filter(|reach| reach.is_finite());
        let count = found().count();
        let mean = found().sum::<f64>() / count as f64;
        (count > 0).then(|| self.opening(2.0 * mean, mean, mean))
    }

    /// A clear opening, drawn in the middle of the undeformed plate from one side to the other.
    fn opening(&self, length: f64, left: f64, right: f64) -> Span {
        let (entry, exit) = self.faces();
        let level = 0.5 * (entry + exit);
        Span { length, ends: [self.point(level, -left), self.point(level, right)] }
    }

    /// From the particle next to the line of flight, or the one furthest out of a face, on one side to that on the other.
    fn innermost(&self, edge: CraterEdge) -> Option<Span> {
        let (entry, exit) = self.faces();
        // Of every sector: how good the particle found is, and its distance from the line of flight.
        let mut best: Vec<Option<(f64, f64)>> = vec![None; self.sectors()];
        let mut height = 0.0f64;
        for i in (0..self.particles.len()).filter(|&i| self.remains[i]) {
            let offset = self.offset(i);
            let r = offset[0].hypot(offset[1]);
            let (merit, radius) = match edge {
                CraterEdge::Clear => (-r, r - self.half_spacing(i)),
                CraterEdge::EntryLips => (entry - self.along(i), r),
                CraterEdge::ExitLips => (self.along(i) - exit, r),
            };
            // A lip stands out of the face.
            if edge != CraterEdge::Clear && merit <= 0.0 {
                continue;
            }
            height = height.max(merit);
            let sector = &mut best[self.sector(offset)];
            if sector.is_none_or(|(other, _)| merit > other) {
                *sector = Some((merit, radius));
            }
        }
        let found: Vec<f64> = best.iter().flatten().map(|b| b.1).collect();
        if found.is_empty() {
            return None;
        }
        // A side that overlaps the line of flight takes from the other.
        let mean = (found.iter().sum::<f64>() / found.len() as f64).max(0.0);
        let level = match edge {
            CraterEdge::Clear => 0.5 * (entry + exit),
            CraterEdge::EntryLips => entry - height,
            CraterEdge::ExitLips => exit + height,
        };
        // In the plane the two sides are where they are.
        let (right, left) = match (self.model.dimensions, best[0], best.get(1).copied().flatten()) {
            (Dimensions::PlaneStrain, Some(right), Some(left)) => (right.1, left.1),
            _ => (mean, mean),
        };
        Some(Span { length: 2.0 * mean, ends: [self.point(level, -left), self.point(level, right)] })
    }

    /// Extent of the debris behind the plate.
    pub(super) fn cloud(&self, extent: CloudExtent, leave_out: f64) -> Option<Span> {
        let (_, exit) = self.faces();
        let cloud = || (0..self.particles.len()).filter(|&i| !self.remains[i] && self.along(i) > exit);
        let outermost = |place: &dyn Fn(usize) -> Option<f64>| {
            let reaches: Vec<(f64, f64)> =
                cloud().filter_map(|i| Some((place(i)? + self.half_spacing(i), self.particles.mass[i]))).collect();
            reach(reaches, leave_out)
        };
        match extent {
            CloudExtent::Length => {
                let tip = outermost(&|i| Some(self.along(i)))?;
                Some(Span { length: tip - exit, ends: [self.point(exit, 0.0), self.point(tip, 0.0)] })
            }
            CloudExtent::Width => {
                let middle = cloud().map(|i| self.particles.mass[i] * self.along(i)).sum::<f64>()
                    / cloud().map(|i| self.particles.mass[i]).sum::<f64>();
                let (right, left) = if self.model.dimensions == Dimensions::Three {
                    let radius = outermost(&|i| Some(self.offset(i)[0].hypot(self.offset(i)[1])))?;
                    (radius, radius)
                } else {
                    let side = |sign: f64| outermost(&|i| Some(sign * self.offset(i)[0]).filter(|x| *x >= 0.0));
                    // Half a model knows the other half.
                    match (side(1.0), side(-1.0)) {
                        (Some(right), Some(left)) => (right, left),
                        (Some(only), None) | (None, Some(only)) => (only, only),
                        (None, None) => return None,
                    }
                };
                Some(Span { length: right + left, ends: [self.point(middle, -left), self.point(middle, right)] })
            }
        }
    }
}

/// The largest place, or the one beyond which `leave_out` of the mass lies.
fn reach(mut places: Vec<(f64, f64)>, leave_out: f64) -> Option<f64> {
    places.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let limit = leave_out * places.iter().map(|p| p.1).sum::<f64>();
    let mut beyond = 0.0;
    places.into_iter().find_map(|(place, mass)| {
        beyond += mass;
        (beyond > limit).then_some(place)
    })
}
