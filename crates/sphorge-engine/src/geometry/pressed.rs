//! Bodies that press each other before anything moves: what the contact of their facets holds at the start.

use super::facets::ReferenceFacets;
use super::shape::dot;
use crate::facet_laws::FacetLaws;
use crate::model::{BodyContact, Model};
use crate::particles::Particles;
use sphorge_physics::Vector;
use sphorge_physics::facet::{Facet, FacetPress, Partner, press};
use sphorge_physics::tensor::identity;
use std::collections::{BTreeMap, HashMap};

/// Share of the finer spacing by which bodies that are meant to touch may overlap at the start.
pub const LARGEST_CLOSURE: f64 = 0.1;

/// Share of the finer spacing that is rounding.
const ROUNDING: f64 = 1e-5;

/// Share of the normal forces that is left as force below which bodies are not on one side of each other.
const ONE_SIDED: f64 = 0.5;

/// Two bodies that press each other at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressedBodies {
    /// Index of the first.
    pub first: usize,
    /// Index of the second.
    pub second: usize,
    /// Where they are deepest in each other, m.
    pub place: Vector<f64>,
    /// How deep, m.
    pub depth: f64,
    /// Unit vector along which the first parts from the second there.
    pub normal: Vector<f64>,
    /// What the contact holds, J (per metre of thickness in plane strain).
    pub energy: f64,
    /// Force on the first, N (per metre of thickness in plane strain).
    pub force: Vector<f64>,
    /// Sum of the magnitudes of the normal forces, in the same units: far more than the force where they press each other from all sides.
    pub normal_force: f64,
    /// The finer of the spacings, m.
    pub spacing: f64,
}

impl PressedBodies {
    /// Whether they press each other from opposite sides, as a shaft and the hub that it is pressed into.
    pub fn is_all_around(&self) -> bool {
        dot(self.force, self.force).sqrt() < ONE_SIDED * self.normal_force
    }

    /// Depth over the finer spacing.
    pub fn share(&self) -> f64 {
        self.depth / self.spacing
    }
}

/// A facet at the start, with its body.
struct Placed {
    facet: Facet<f64>,
    middle: Vector<f64>,
    body: usize,
}

/// Bodies that overlap at their facets at the start, beyond rounding; none where they do not meet at facets.
pub fn pressed_at_start(model: &Model, particles: &Particles) -> Vec<PressedBodies> {
    let BodyContact::Facets { whole: strength, .. } = model.contact else { return Vec::new() };
    if !model.has_facets() || model.bodies.len() < 2 {
        return Vec::new();
    }
    let (reference, laws) = (ReferenceFacets::new(model), FacetLaws::new(model, strength));
    let placed: Vec<Placed> = (0..particles.len())
        .flat_map(|i| reference.of(particles.id[i]).iter().map(move |facet| (i, facet)))
        .map(|(i, of_cell)| {
            let facet = Facet::now(particles.position[i], &identity(), &of_cell.facet);
            let middle = std::array::from_fn(|k| facet.owner[k] + facet.middle[k]);
            Placed { facet, middle, body: particles.body[i] as usize }
        })
        .collect();
    let edge = 1.5 * model.bodies.iter().map(|body| body.spacing).fold(0.0, f64::max);
    let cell = |p: Vector<f64>| p.map(|c| (c / edge).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (k, of) in placed.iter().enumerate() {
        cells.entry(cell(of.middle)).or_default().push(k);
    }
    let mut pressed: BTreeMap<(usize, usize), PressedBodies> = BTreeMap::new();
    for a in &placed {
        let [x, y, z] = cell(a.middle);
        let around = (-1..=1).flat_map(|i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [x + i, y + j, z + k])));
        for b in around.filter_map(|at| cells.get(&at)).flatten().map(|&k| &placed[k]) {
            if a.body < b.body && dot(a.facet.normal, b.facet.normal) < 0.0 {
                let met = press(&a.facet, &b.facet, Partner::Facet, laws.of(a.body, b.body));
                if met.energy > 0.0 {
                    let of_bodies = pressed.entry((a.body, b.body)).or_insert_with(|| none(model, a.body, b.body));
                    add(of_bodies, &met, &a.facet, &b.facet);
                }
            }
        }
    }
    pressed.into_values().filter(|of| of.share() > ROUNDING).collect()
}

fn none(model: &Model, first: usize, second: usize) -> PressedBodies {
    let spacing = model.bodies[first].spacing.min(model.bodies[second].spacing);
    let [place, normal, force] = [[0.0; 3]; 3];
    PressedBodies { first, second, place, depth: 0.0, normal, energy: 0.0, force, normal_force: 0.0, spacing }
}

fn add(of: &mut PressedBodies, met: &FacetPress<f64>, a: &Facet<f64>, b: &Facet<f64>) {
    of.energy += met.energy;
    of.normal_force += met.normal_force;
    (0..3).for_each(|k| of.force[k] += met.force[k]);
    let depth = mean_closure(met.energy / met.normal_force, a.depth + b.depth);
    if depth > of.depth {
        let place = std::array::from_fn(|k| a.owner[k] + met.centre_a[k]);
        (of.depth, of.place, of.normal) = (depth, place, met.normal);
    }
}

/// Closure, m, of a uniform pressure that holds this energy per force, m, where the owners are `depth` (m) apart at touch: the
/// solution of `U/F = d (1 - d/D)/(2 - d/D)`, the energy of a closure over its pressure; the largest one has where there is none.
fn mean_closure(energy_over_force: f64, depth: f64) -> f64 {
    let ratio = energy_over_force / depth;
    let half = 0.5 * (1.0 + ratio);
    depth * (half - (half * half - 2.0 * ratio).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closure_follows_from_energy_and_force() {
        // psi = k d^2/(2 (1 - d/D)), its slope k d (1 - d/(2 D))/(1 - d/D)^2.
        for share in [1e-6, 0.05, 0.2, 0.5] {
            let (d, k) = (share * 2e-3, 3e13);
            let energy = 0.5 * k * d * d / (1.0 - share);
            let force = k * d * (1.0 - 0.5 * share) / (1.0 - share) / (1.0 - share);
            let found = mean_closure(energy / force, 2e-3);
            assert!((found / d - 1.0).abs() < 1e-9, "{share}: {found}");
        }
    }
}
