//! Bundles of neighbours worked on together, from one number to a SIMD register.

use bytemuck::Pod;
use sphorge_physics::{Real, Scalar};

/// Element type of pair arithmetic: `f64`, or `f32` with positions in fixed point.
pub(in crate::solver) trait PairScalar: Scalar + Pod + Lanes<Element = Self> {
    /// Largest magnitude an encoded coordinate may reach, in units.
    const RANGE: f64;

    /// A coordinate, given as a number of units from the origin, in the form records carry it.
    ///
    /// Single precision keeps it as a 32-bit integer (stored as the bits of a float): differences of integers are exact, so
    /// the distance of two close particles does not suffer from their distance to the origin.
    fn encode(units: f64) -> Self;
}

/// A bundle of numbers of one element type.
pub(in crate::solver) trait Lanes: Real {
    /// One lane.
    type Element: PairScalar;
    /// Number of lanes.
    const WIDTH: usize;

    /// The same value in every lane.
    fn splat(value: Self::Element) -> Self;
    /// Takes the records at `WIDTH` indices apart into one bundle per record entry.
    fn load<const F: usize>(records: &[[Self::Element; F]], indices: &[u32]) -> [Self; F];
    /// Difference `a - b` of two encoded coordinates, m; `unit` is the size of a unit, m.
    fn difference(a: Self, b: Self, unit: Self) -> Self;
    /// Sum over the lanes, always in the same order.
    fn sum(self) -> Self::Element;
    /// Largest lane.
    fn largest(self) -> Self::Element;
}

impl PairScalar for f64 {
    const RANGE: f64 = 1.0;

    #[inline(always)]
    fn encode(units: f64) -> Self {
        units
    }
}

impl PairScalar for f32 {
    // Half the range of an `i32`: the difference of two coordinates still fits.
    const RANGE: f64 = (1u32 << 30) as f64;

    #[inline(always)]
    fn encode(units: f64) -> Self {
        f32::from_bits(units.round() as i32 as u32)
    }
}

macro_rules! single_lane {
    ($t:ident, |$a:ident, $b:ident, $unit:ident| $difference:expr) => {
        impl Lanes for $t {
            type Element = Self;
            const WIDTH: usize = 1;

            #[inline(always)]
            fn splat(value: Self) -> Self {
                value
            }
            #[inline(always)]
            fn load<const F: usize>(records: &[[Self; F]], indices: &[u32]) -> [Self; F] {
                records[indices[0] as usize]
            }
            #[inline(always)]
            fn difference($a: Self, $b: Self, $unit: Self) -> Self {
                $difference
            }
            #[inline(always)]
            fn sum(self) -> Self {
                self
            }
            #[inline(always)]
            fn largest(self) -> Self {
                self
            }
        }
    };
}

single_lane!(f64, |a, b, unit| (a - b) * unit);
single_lane!(f32, |a, b, unit| (a.to_bits() as i32).wrapping_sub(b.to_bits() as i32) as f32 * unit);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_point_keeps_the_distance_of_close_particles_far_from_the_origin() {
        // Two particles 1.0003 mm apart, 1.4 m from the origin of a 3 m domain.
        let unit = 1.5 / f32::RANGE;
        let [a, b] = [1.4, 1.4010003].map(|x: f64| f32::encode(x / unit));
        let d = f32::difference(b, a, unit as f32);
        assert!((f64::from(d) - 1.0003e-3).abs() < 2.0 * unit, "{d}");
        // Plain single precision would be off by its spacing at 1.4, a hundred times more.
        assert!((f64::from(1.4010003f32 - 1.4f32) - 1.0003e-3).abs() > 10.0 * unit);
    }
}
