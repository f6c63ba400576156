//! Numbers of the particles of a frame, as the page gets them.

use crate::plot::ranges;

/// Numbers before the values: what an array is without looking at all of it.
pub(super) const HEAD: usize = 8;

/// Numbers of all particles of a frame, by `id`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Array {
    /// Of a field: smallest and largest value, the same without the outermost half percent on each side as pictures have it, mean, number of finite
    /// values. Of positions: smallest and largest coordinate of each axis.
    pub(super) head: [f64; HEAD],
    /// Numbers of a particle.
    pub(super) width: usize,
    /// Particle by particle.
    pub(super) values: Vec<f32>,
}

impl Array {
    /// Values of a field.
    pub(super) fn of_field(values: &[f64]) -> Self {
        let mut finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let count = finite.len() as f64;
        let mean = finite.iter().sum::<f64>() / count.max(1.0);
        let ((low, high), (bulk_low, bulk_high)) =
            ranges(&mut finite).unwrap_or(((f64::NAN, f64::NAN), (f64::NAN, f64::NAN)));
        let head = [low, high, bulk_low, bulk_high, mean, count, 0.0, 0.0];
        Self { head, width: 1, values: values.iter().map(|value| *value as f32).collect() }
    }

    /// Positions from an origin, m.
    pub(super) fn of_positions(positions: &[[f64; 3]], origin: [f64; 3]) -> Self {
        let mut head = [0.0; HEAD];
        for axis in 0..3 {
            let along = positions.iter().map(|p| p[axis] - origin[axis]).filter(|x| x.is_finite());
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            (head[2 * axis], head[2 * axis + 1]) = if low <= high { (low, high) } else { (0.0, 0.0) };
        }
        let values = positions.iter().flat_map(|p| [0, 1, 2].map(|axis| (p[axis] - origin[axis]) as f32)).collect();
        Self { head, width: 3, values }
    }

    /// As they are.
    #[cfg(test)]
    pub(super) fn plain(width: usize, values: Vec<f32>) -> Self {
        Self { head: [0.0; HEAD], width, values }
    }

    /// The head, little-endian.
    pub(super) fn head_bytes(&self) -> Vec<u8> {
        self.head.iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    /// Head and values, little-endian.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.head_bytes();
        bytes.reserve(4 * self.values.len());
        bytes.extend(self.values.iter().flat_map(|value| value.to_le_bytes()));
        bytes
    }
}
