//! Points in the order of a Hilbert curve through cells: any piece of the order is compact in space.
//!
//! J. Skilling, Programming the Hilbert curve, AIP Conference Proceedings 707 (2004) 381.

use super::cells::{CHUNK, bounds, is_place};
use rayon::prelude::*;
use sphorge_physics::Vector;

/// Bits of a coordinate at most, so that three coordinates are one word.
const BITS: u32 = 21;

/// Indices of points in the order of a Hilbert curve through cubes of edge `cell`, m, the first of them at the least coordinates; only the first
/// `axes` coordinates count. Points of one cube are in the order of their indices. Cubes are larger where more than 2^21 would be needed in a
/// row. The order depends on the points alone, never on threads. Any numbers are points: an order is found of infinite ones, too, if not a useful one.
pub fn hilbert_order(points: &[Vector<f64>], cell: f64, axes: usize) -> Vec<u32> {
    let place = |x: f64| if is_place(x) { x } else { 0.0 };
    let places: Vec<Vector<f64>> = points
        .par_iter()
        .with_min_len(CHUNK)
        .map(|p| [0, 1, 2].map(|a| if a < axes { place(p[a]) } else { 0.0 }))
        .collect();
    let (low, high) = bounds(&places);
    let longest = (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
    let last = (1_u32 << BITS) - 1;
    let cell = cell.max(longest / f64::from(last));
    // A saturating cast; cubes without size hold everything in the first one.
    let coordinates = |p: &Vector<f64>| [0, 1, 2].map(|a| (((p[a] - low[a]) / cell) as u32).min(last));
    let curve = HilbertCurve::through(coordinates(&high));
    let key = |(i, p): (usize, &Vector<f64>)| (curve.place(coordinates(p)), i as u32);
    let mut keys: Vec<(u64, u32)> = places.par_iter().with_min_len(CHUNK).enumerate().map(key).collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, i)| i).collect()
}

/// A curve through all cells of a box whose sides are powers of two. Where sides are unequal it goes through cubes of the shortest side one after
/// the other, and these lie on a curve of fewer axes. Of a box whose two shorter sides are equal, consecutive cells have a face in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct HilbertCurve {
    /// Axes, that of the longest side first.
    axes: [usize; 3],
    /// Bits of coordinates along these axes.
    bits: [u32; 3],
}

impl HilbertCurve {
    /// The curve through all cells up to this one, whose coordinates have no more than 63 bits together.
    pub(super) fn through(last: [u32; 3]) -> Self {
        let bits = last.map(|x| u32::BITS - x.leading_zeros());
        let mut axes = [0, 1, 2];
        axes.sort_by_key(|&a| std::cmp::Reverse(bits[a]));
        Self { axes, bits: axes.map(|a| bits[a]) }
    }

    /// Cells of the nodes that are passed one after the other, from the largest to single cells, as powers of two: halves, quarters or eighths of the
    /// node before. Places of the cells of one node are a contiguous range that begins at a multiple of its size.
    pub(super) fn nodes(&self) -> impl Iterator<Item = u32> + Clone {
        let [first, second, third] = self.bits;
        let of_one_axis = (0..first - second).rev().map(move |bits| bits + 2 * second + third);
        let of_two = (0..second - third).rev().map(move |bits| 2 * bits + 3 * third);
        of_one_axis.chain(of_two).chain((0..third).rev().map(|bits| 3 * bits))
    }

    /// Place of a cell on the curve.
    pub(super) fn place(&self, cell: [u32; 3]) -> u64 {
        let x = self.axes.map(|a| cell[a]);
        let [first, second, third] = self.bits;
        // From the highest bit downwards one axis has bits, then two, then all three.
        let above = u64::from(x[0] >> second);
        debug_assert!(x[0] >> first == 0);
        let above = above << (2 * (second - third)) | place_of([x[0] >> third, x[1] >> third], second - third);
        above << (3 * third) | place_of(x, third)
    }
}

fn mask(bits: u32) -> u32 {
    (1 << bits) - 1
}

/// Place on the curve through a cube of 2^`bits` cells a side; higher bits of the coordinates do not count. The curve begins at zero and ends at the far end of the first axis.
fn place_of<const AXES: usize>(mut x: [u32; AXES], bits: u32) -> u64 {
    // Skilling's transform from coordinates to the bits of the place, each coordinate with every `AXES`-th of them.
    for level in (1..bits).rev() {
        let below = mask(level);
        for a in 0..AXES {
            if x[a] >> level & 1 == 1 {
                x[0] ^= below;
            } else {
                let swapped = (x[0] ^ x[a]) & below;
                x[0] ^= swapped;
                x[a] ^= swapped;
            }
        }
    }
    for a in 1..AXES {
        x[a] ^= x[a - 1];
    }
    let flips = (1..bits).filter(|level| x[AXES - 1] >> level & 1 == 1).fold(0, |flips, level| flips ^ mask(level));
    let bit_of = |level: u32, x: u32| u64::from((x ^ flips) >> level & 1);
    (0..bits).rev().fold(0, |place, level| x.iter().fold(place, |place, &x| place << 1 | bit_of(level, x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The cells of a box in the order of the curve; that no two share a place.
    fn cells(sides: [u32; 3]) -> Vec<[u32; 3]> {
        let curve = HilbertCurve::through(sides.map(|side| side - 1));
        let count = sides.iter().product::<u32>();
        let cell = |k: u32| [k % sides[0], k / sides[0] % sides[1], k / sides[0] / sides[1]];
        let mut cells: Vec<_> = (0..count).map(|k| (curve.place(cell(k)), cell(k))).collect();
        cells.sort_unstable();
        let places = cells.iter().map(|&(place, _)| place);
        assert!(places.eq(0..u64::from(count)), "{sides:?}: every place has one cell");
        cells.into_iter().map(|(_, cell)| cell).collect()
    }

    #[test]
    fn the_curve_through_sixteen_squares_is_that_of_hilbert() {
        let squares: Vec<[u32; 2]> = cells([4, 4, 1]).into_iter().map(|[x, y, _]| [x, y]).collect();
        let rows = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 2], [0, 3], [1, 3], [1, 2]];
        // The right half mirrors the left one.
        let mirrored = rows.iter().rev().map(|&[x, y]| [3 - x, y]);
        assert_eq!(squares, rows.into_iter().chain(mirrored).collect::<Vec<_>>());
    }

    #[test]
    fn consecutive_cells_share_a_face() {
        for sides in [[8, 8, 8], [32, 32, 1], [1, 16, 16], [4, 64, 4], [1, 1, 32], [2, 8, 1], [1, 1, 1]] {
            for pair in cells(sides).windows(2) {
                let steps: u32 = (0..3).map(|a| pair[0][a].abs_diff(pair[1][a])).sum();
                assert_eq!(steps, 1, "{sides:?}: {pair:?}");
            }
        }
    }

    #[test]
    fn nodes_halve_the_axes_that_have_cells() {
        let nodes = |sides: [u32; 3]| {
            let curve = HilbertCurve::through(sides.map(|side| side - 1));
            curve.nodes().collect::<Vec<_>>()
        };
        assert_eq!(nodes([4, 4, 4]), [3, 0]);
        assert_eq!(nodes([4, 32, 8]), [9, 8, 6, 3, 0]);
        assert_eq!(nodes([1, 8, 1]), [2, 1, 0]);
        assert_eq!(nodes([1, 1, 1]), []);
    }

    #[test]
    fn flat_boxes_are_cubes_on_a_curve_of_two_axes() {
        let cells = cells([32, 4, 16]);
        let cubes: Vec<[u32; 3]> = cells.chunks(64).map(|cube| cube[0].map(|x| x / 4)).collect();
        for (cube, members) in cubes.iter().zip(cells.chunks(64)) {
            assert!(members.iter().all(|cell| cell.map(|x| x / 4) == *cube));
        }
        assert!(cubes.windows(2).all(|pair| (0..3).map(|a| pair[0][a].abs_diff(pair[1][a])).sum::<u32>() == 1));
    }

    #[test]
    fn the_largest_cube_has_places_for_all_its_cells() {
        let last = (1 << BITS) - 1;
        let curve = HilbertCurve::through([last; 3]);
        assert_eq!(curve.place([0; 3]), 0);
        assert_eq!(curve.place([last, 0, 0]), (1 << (3 * BITS)) - 1);
    }

    #[test]
    fn points_of_one_axis_are_sorted() {
        let points = [0.5, -1.0, 2.0, 0.1, 0.5, -3.0].map(|x| [7.0 * x, -x, f64::NAN]);
        assert_eq!(hilbert_order(&points, 0.5, 1), [5, 1, 3, 0, 4, 2]);
        assert_eq!(hilbert_order(&[], 1.0, 3), []);
        // More cubes than there are places for.
        let points = [7e6, 9e6, 8e6, 0.0].map(|x| [x, 0.0, 0.0]);
        assert_eq!([1, 3].map(|axes| hilbert_order(&points, 1.0, axes)), [[3, 0, 2, 1]; 2]);
    }

    #[test]
    fn points_of_one_cube_keep_their_order() {
        let points: Vec<_> = (0..5000).map(|k| [f64::from(k % 10), f64::from(k * 7 % 20), 0.0]).collect();
        let halves = (0..5000).filter(|k| k * 7 % 20 < 10).chain((0..5000).filter(|k| k * 7 % 20 >= 10));
        assert_eq!(hilbert_order(&points, 10.0, 3), halves.collect::<Vec<_>>());
    }

    #[test]
    fn points_are_in_the_order_of_their_cells() {
        let expected = cells([8, 8, 4]);
        let place = |cell: [u32; 3]| expected.iter().position(|&other| other == cell);
        let cell = |k: u32| [k * 7 % 8, k / 8 % 8, k * 3 / 64 % 4];
        let point = |k: u32| cell(k).map(|x| -5.0 + 0.25 * (f64::from(x) + 0.3 + 0.6 * f64::from(k % 2)));
        // The first point is where cells begin, the last one where they end.
        let points: Vec<_> =
            [[-5.0; 3]].into_iter().chain((0..256).map(point)).chain([[-3.01, -3.01, -4.01]]).collect();
        let mut expected: Vec<u32> = (0..256).collect();
        expected.sort_by_key(|&k| (place(cell(k)), k));
        let order = hilbert_order(&points, 0.25, 3);
        let order: Vec<u32> = order.into_iter().filter(|k| (1..257).contains(k)).map(|k| k - 1).collect();
        assert_eq!(order, expected);
    }

    #[test]
    fn pieces_of_the_order_are_compact() {
        // 4096 points of a lattice in pieces of 64: a cube of four a side each, where that of a lexicographic order is a line.
        let points: Vec<Vector<f64>> = (0..4096).map(|k| [k / 256, k / 16 % 16, k % 16].map(f64::from)).collect();
        let order = hilbert_order(&points, 1.0, 3);
        for piece in order.chunks(64) {
            let (low, high) = bounds(&piece.iter().map(|&i| points[i as usize]).collect::<Vec<_>>());
            assert_eq!([0, 1, 2].map(|a| high[a] - low[a]), [3.0; 3]);
        }
    }

    proptest! {
        #[test]
        fn any_numbers_have_an_order(
            points in prop::collection::vec([any::<f64>(), any::<f64>(), prop::num::f64::ANY], 0..40),
            cell in any::<f64>(),
            axes in 0_usize..5,
        ) {
            let mut order = hilbert_order(&points, cell, axes);
            order.sort_unstable();
            prop_assert!(order.into_iter().eq(0..points.len() as u32));
        }
    }
}
