//! Constants of conduction by body.

use crate::model::{Body, Model};
use sphorge_physics::conduction::{HeatPair, Surroundings, lattice, pair_conductivity};
use sphorge_physics::pair::mean;
use sphorge_physics::{Dimension, Vector, kernel::Kernel};

/// Constants of conduction by body.
#[derive(Clone, Debug)]
pub struct ConductionTable {
    pub(super) kernel: Kernel,
    pub(super) dimension: Dimension,
    pub(super) conductivity: Vec<f64>,
    pub(super) specific_heat: Vec<f64>,
    /// `1 / moment` of the body's lattice.
    correction: Vec<f64>,
    /// Moment of its outermost layer over that of a full lattice.
    pub(super) flat: Vec<f64>,
    /// The most that pairs replace of missing ones.
    pub(super) most_replaced: Vec<f64>,
}

impl ConductionTable {
    /// For the bodies of a model.
    pub fn new(model: &Model) -> Self {
        let dimension = super::dimension(model);
        let kernel = model.numerics.kernel;
        let material = |body: &Body| &model.materials[body.material];
        let lattices = model.bodies.iter().map(|b| (b, lattice(kernel, dimension, b.spacing, b.smoothing_length)));
        Self {
            kernel,
            dimension,
            conductivity: model.bodies.iter().map(|b| material(b).conductivity).collect(),
            specific_heat: model.bodies.iter().map(|b| material(b).specific_heat).collect(),
            correction: lattices.clone().map(|(_, l)| 1.0 / l.moment).collect(),
            flat: lattices.clone().map(|(_, l)| l.surface_moment / l.moment).collect(),
            most_replaced: lattices.map(|(_, l)| l.most_replaced()).collect(),
        }
    }

    /// For a body: conductivity, W/(m K), specific heat, J/(kg K), one over the moment of its lattice, the moment of the outermost
    /// layer over that of the full lattice, and the most that pairs replace of missing ones.
    pub fn of_body(&self, body: usize) -> [f64; 5] {
        let of_lattice = [self.correction[body], self.flat[body], self.most_replaced[body]];
        [self.conductivity[body], self.specific_heat[body], of_lattice[0], of_lattice[1], of_lattice[2]]
    }

    /// Adds a pair of particles of these bodies to what the first sees of its surroundings, in the direction `x`: volume of the other
    /// (m^d), square of the distance (m^2), smoothing length (m).
    pub(super) fn see(
        &self,
        surroundings: &mut Surroundings<f64>,
        bodies: (u32, u32),
        volume: f64,
        (r2, h): (f64, f64),
        x: Vector<f64>,
    ) {
        let correction = mean(self.correction[bodies.0 as usize], self.correction[bodies.1 as usize]);
        surroundings.add(correction * volume * self.kernel.slope(self.dimension, r2.sqrt(), h), r2, x);
    }

    /// A pair of particles of these bodies, with the square of their distance, m^2, and smoothing length, m, that conducts with this
    /// share of its conductivity, and that many times as much for missing pairs, too.
    pub(super) fn pair(
        &self,
        bodies: (u32, u32),
        volumes: (f64, f64),
        (r2, h): (f64, f64),
        difference: f64,
        (share, replaced): (f64, f64),
    ) -> HeatPair<f64> {
        let (a, b) = (bodies.0 as usize, bodies.1 as usize);
        HeatPair {
            volumes,
            conductivity: share * pair_conductivity(self.conductivity[a], self.conductivity[b]),
            correction: mean(self.correction[a], self.correction[b]),
            replaced,
            slope: self.kernel.slope(self.dimension, r2.sqrt(), h),
            r2,
            difference,
        }
    }
}
