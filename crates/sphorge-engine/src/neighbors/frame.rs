//! Origin and unit of encoded coordinates.

use crate::lanes::PairScalar;
use sphorge_physics::Vector;

/// Origin and unit of encoded coordinates; see [`PairScalar::encode`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    origin: Vector<f64>,
    /// Size of a unit, m.
    pub(crate) unit: f64,
    inverse_unit: f64,
}

impl Default for Frame {
    fn default() -> Self {
        Self { origin: [0.0; 3], unit: 1.0, inverse_unit: 1.0 }
    }
}

impl Frame {
    /// A frame that contains the box between `low` and `high` with `margin` on every side, m.
    pub(crate) fn around<T: PairScalar>(low: Vector<f64>, high: Vector<f64>, margin: f64) -> Self {
        let origin = [0, 1, 2].map(|a| 0.5 * (low[a] + high[a]));
        let half = (0..3).map(|a| 0.5 * (high[a] - low[a])).fold(0.0, f64::max) + margin;
        // Double precision keeps metres: `RANGE` is one, and a unit of the box size would only add a rounding.
        let unit = if T::RANGE > 1.0 { half / T::RANGE } else { 1.0 };
        Self { origin, unit, inverse_unit: 1.0 / unit }
    }

    /// A position in the encoding of the records.
    #[inline(always)]
    pub(crate) fn encode<T: PairScalar>(&self, p: &Vector<f64>) -> [T; 3] {
        [0, 1, 2].map(|a| T::encode((p[a] - self.origin[a]) * self.inverse_unit))
    }

    /// The position represented in the records, m.
    pub(crate) fn decode<T: PairScalar>(&self, p: &[T; 3]) -> Vector<f64> {
        let zero = T::encode(0.0);
        [0, 1, 2].map(|a| self.origin[a] + T::coordinate_difference(p[a], zero).to_f64() * self.unit)
    }
}

crate::persist_fields!(Frame { origin, unit, inverse_unit });
