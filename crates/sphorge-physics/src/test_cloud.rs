//! Small irregular particle clouds for the tests of pair sums.

use crate::kernel::Kernel;
use crate::pair::PairForm;
use crate::tensor::dot;
use crate::{Dimension, Vector};

pub(crate) const FORMS: [PairForm; 3] = [PairForm::VolumeWeighted, PairForm::DensityWeighted, PairForm::Mixed];

pub(crate) const DIMENSIONS: [Dimension; 3] = [Dimension::One, Dimension::Two, Dimension::Three];

/// Particles with volumes.
pub(crate) struct Cloud {
    pub(crate) dimension: Dimension,
    pub(crate) h: f64,
    pub(crate) x: Vec<Vector<f64>>,
    pub(crate) volume: Vec<f64>,
}

/// Numbers between -1 and 1, the same every time.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

impl Cloud {
    /// A disturbed lattice of spacing 0.1, five particles along each axis; its outer layers are free surfaces.
    pub(crate) fn block(dimension: Dimension) -> Self {
        Self::lattice(dimension, [5; 3])
    }

    /// Six particles.
    pub(crate) fn few(dimension: Dimension) -> Self {
        Self::lattice(dimension, [if dimension == Dimension::One { 6 } else { 3 }, 2, 1])
    }

    fn lattice(dimension: Dimension, count: [usize; 3]) -> Self {
        let spacing = 0.1;
        let along = |axis: usize| if axis < dimension.count() { count[axis] } else { 1 };
        let mut noise = Noise::new(7);
        let (mut x, mut volume) = (Vec::new(), Vec::new());
        for k in 0..along(2) {
            for j in 0..along(1) {
                for i in 0..along(0) {
                    let mut point = [i, j, k].map(|n| n as f64 * spacing);
                    for component in point.iter_mut().take(dimension.count()) {
                        *component += 0.2 * spacing * noise.next();
                    }
                    x.push(point);
                    volume.push(spacing.powi(dimension.count() as i32) * (1.0 + 0.3 * noise.next()));
                }
            }
        }
        Self { dimension, h: 1.3 * spacing, x, volume }
    }

    pub(crate) fn count(&self) -> usize {
        self.x.len()
    }

    pub(crate) fn x_ij(&self, i: usize, j: usize) -> Vector<f64> {
        core::array::from_fn(|a| self.x[i][a] - self.x[j][a])
    }

    fn r(&self, i: usize, j: usize) -> f64 {
        let x_ij = self.x_ij(i, j);
        dot(x_ij, x_ij).sqrt()
    }

    pub(crate) fn w(&self, i: usize, j: usize) -> f64 {
        Kernel::CubicSpline.value(self.dimension, self.r(i, j), self.h)
    }

    /// `grad_i W_ij`.
    pub(crate) fn grad_w(&self, i: usize, j: usize) -> Vector<f64> {
        let slope = Kernel::CubicSpline.slope(self.dimension, self.r(i, j), self.h);
        self.x_ij(i, j).map(|x| -slope * x)
    }
}
