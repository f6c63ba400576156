//! Constants of conduction by body.

use crate::model::{Body, Model};
use sphorge_physics::conduction::{HeatPair, lattice, pair_conductivity};
use sphorge_physics::pair::mean;
use sphorge_physics::{Dimension, kernel::Kernel};

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
            flat: lattices.map(|(_, l)| l.surface_moment / l.moment).collect(),
        }
    }

    /// For a body: conductivity, W/(m K), specific heat, J/(kg K), one over the moment of its lattice, and the moment
    /// of the outermost layer over that of the full lattice.
    pub fn of_body(&self, body: usize) -> [f64; 4] {
        [self.conductivity[body], self.specific_heat[body], self.correction[body], self.flat[body]]
    }

    /// A pair of particles of these bodies, with the square of their distance, m^2, that conducts with this share of its conductivity.
    pub(super) fn pair(
        &self,
        bodies: (u32, u32),
        volumes: (f64, f64),
        r2: f64,
        h: f64,
        difference: f64,
        share: f64,
    ) -> HeatPair<f64> {
        let (a, b) = (bodies.0 as usize, bodies.1 as usize);
        HeatPair {
            volumes,
            conductivity: share * pair_conductivity(self.conductivity[a], self.conductivity[b]),
            correction: mean(self.correction[a], self.correction[b]),
            slope: self.kernel.slope(self.dimension, r2.sqrt(), h),
            r2,
            difference,
        }
    }
}
