//! Numbers in a single page: rounded to 16 bits, and compressed.
//!
//! An array is split by component. The numbers of a component become whole ones between the smallest and the largest; of each the difference from the
//! one before is kept, which is small where neighbours in the order of `id` are neighbours in space, first all low bytes, then all high bytes. What
//! comes out is compressed by zlib.

use super::array::Array;
use flate2::{Compression, write::ZlibEncoder};
use std::io::Write;

/// The largest number; the next one stands for a value that is not finite.
const LARGEST: u16 = u16::MAX - 1;

/// An array packed.
pub(super) struct Packed {
    /// Smallest and largest number of each component.
    pub(super) ranges: Vec<(f64, f64)>,
    pub(super) bytes: Vec<u8>,
}

/// Packs an array. Whole numbers up to 65534 come back as they were if `exact`.
pub(super) fn packed(array: &Array, exact: bool) -> Packed {
    let mut ranges = Vec::new();
    let mut planes = Vec::with_capacity(2 * array.values.len());
    for component in 0..array.width {
        let values = || array.values.iter().skip(component).step_by(array.width).copied();
        let finite = values().filter(|value| value.is_finite()).map(f64::from);
        let (low, high) = match exact {
            true => (0.0, f64::from(LARGEST)),
            false => finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x))),
        };
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let step = if high > low { f64::from(LARGEST) / (high - low) } else { 0.0 };
        let whole = |value: f32| match value.is_finite() {
            true => ((f64::from(value) - low) * step).round() as u16,
            false => u16::MAX,
        };
        let mut before = 0u16;
        let differences: Vec<u16> = values()
            .map(|value| {
                let now = whole(value);
                let difference = now.wrapping_sub(before);
                before = now;
                difference
            })
            .collect();
        planes.extend(differences.iter().map(|difference| *difference as u8));
        planes.extend(differences.iter().map(|difference| (difference >> 8) as u8));
        ranges.push((low, high));
    }
    Packed { ranges, bytes: compressed(&planes) }
}

/// Compresses bytes.
pub(super) fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    // Memory does not refuse to be written to.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    /// As the page does.
    fn unpacked(packed: &Packed, count: usize) -> Vec<f64> {
        let mut planes = Vec::new();
        ZlibDecoder::new(packed.bytes.as_slice()).read_to_end(&mut planes).unwrap();
        let width = packed.ranges.len();
        let mut values = vec![0.0; count * width];
        for (component, (low, high)) in packed.ranges.iter().enumerate() {
            let at = 2 * component * count;
            let mut now = 0u16;
            for k in 0..count {
                now = now.wrapping_add(u16::from(planes[at + k]) | u16::from(planes[at + count + k]) << 8);
                values[k * width + component] =
                    if now == u16::MAX { f64::NAN } else { low + (high - low) * f64::from(now) / f64::from(LARGEST) };
            }
        }
        values
    }

    #[test]
    fn numbers_come_back_to_a_part_in_sixty_five_thousand_of_their_range() {
        let values: Vec<f32> =
            (0..3000).map(|k| (k as f32 * 0.37).sin() * if k % 3 == 1 { 1e9 } else { 1e-3 }).collect();
        let array = Array::plain(3, values.clone());
        let packed = packed(&array, false);
        for (k, (back, value)) in unpacked(&packed, 1000).iter().zip(&values).enumerate() {
            let (low, high) = packed.ranges[k % 3];
            assert!(
                (back - f64::from(*value)).abs() <= 0.51 * (high - low) / f64::from(LARGEST),
                "{k}: {back} {value}"
            );
        }
    }

    #[test]
    fn whole_numbers_and_what_is_not_finite_come_back_as_they_were() {
        let whole = Array::plain(1, vec![0.0, 7.0, 65534.0, 3.0]);
        assert_eq!(unpacked(&packed(&whole, true), 4), [0.0, 7.0, 65534.0, 3.0]);
        let gaps = Array::plain(1, vec![f32::NAN, 2.0, f32::INFINITY, 4.0]);
        let back = unpacked(&packed(&gaps, false), 4);
        assert!(back[0].is_nan() && back[2].is_nan() && (back[1], back[3]) == (2.0, 4.0), "{back:?}");
        let equal = Array::plain(1, vec![5.0; 9]);
        assert_eq!(unpacked(&packed(&equal, false), 9), [5.0; 9]);
    }
}
