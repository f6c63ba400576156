//! A uniform grid of cells and the points sorted into it.

use super::hilbert::HilbertCurve;
use rayon::prelude::*;
use sphorge_physics::Vector;

/// Points one thread takes at a time.
pub(super) const CHUNK: usize = 1024;

/// Cells along the edges of a tile, as a power of two; along the axis that runs fastest there are twice as many. Smaller tiles cost time: runs of
/// neighbours end where a tile does.
const TILE_BITS: u32 = 3;

/// Spacings of the particles along the edge of a cell of most searches.
const SPACINGS_IN_CELL: f64 = 2.6;

/// Tiles below one node of the curve's tree are joined if they have no more points together than this share of a full tile: those of thin bodies are then
/// about as large as those of others. With 0.9, tiles of a bar are joined to lumps that are cut into long strips.
const JOINED_SHARE: f64 = 2.0 / 3.0;

/// Coordinates of points that are sorted into cells are smaller than this, m: their differences and the cubes of these must be numbers.
const FARTHEST: f64 = 1e100;

/// Whether points may have this coordinate, m.
pub(crate) fn is_place(x: f64) -> bool {
    x.abs() < FARTHEST
}

/// Whether points may be at all these places, m.
pub(crate) fn are_places(points: &[Vector<f64>]) -> bool {
    points.as_flattened().iter().all(|&x| is_place(x))
}

/// Points in cell order. Cells are numbered with the last used axis running fastest, so that three neighbouring cells
/// along it are one contiguous run of points.
#[derive(Clone, Debug, Default)]
pub struct CellGrid {
    origin: Vector<f64>,
    inverse_size: f64,
    /// Cells along each axis, the empty rim of one cell on every side included.
    extent: [usize; 3],
    /// First place of each cell in `order`, one more entry than cells.
    starts: Vec<u32>,
    /// Point indices in cell order.
    order: Vec<u32>,
    cell_of: Vec<u32>,
    /// Occupied cells by their tile's place on the curve, and point indices in that order, once they were asked for.
    by_tile: Vec<(u64, usize)>,
    tiled: Vec<u32>,
}

impl CellGrid {
    /// Sorts `points` into cells of at least `size`, m. Along each axis the grid covers the points; should that take many
    /// more cells than there are points (a few fragments far out), the grid is drawn in towards the bulk and outer points
    /// fall into the rim cells: neighbours stay in the same or in adjacent cells, so nothing is ever missed.
    pub fn sort(&mut self, points: &[Vector<f64>], size: f64) {
        let (mut low, mut high) = bounds(points);
        let limit = (8 * points.len()).max(1 << 15);
        let cells = |low: &Vector<f64>, high: &Vector<f64>, size: f64| -> f64 {
            (0..3).map(|a| ((high[a] - low[a]) / size).floor() + 4.0).product()
        };
        let mut size = size;
        if cells(&low, &high, size) > limit as f64 {
            (low, high) = bulk(points, low, high);
            while cells(&low, &high, size) > limit as f64 {
                size *= 1.25;
            }
        }
        // Cells keep their places in space while points move, so that the order of particles, made once in a while, stays that
        // of the cells.
        low = low.map(|x| (x / size).floor() * size);
        self.origin = low;
        self.inverse_size = 1.0 / size;
        // One rim cell on each side.
        self.extent = [0, 1, 2].map(|a| ((high[a] - low[a]) / size).floor() as usize + 3);

        let count = self.extent.iter().product::<usize>();
        self.starts.clear();
        self.starts.resize(count + 1, 0);
        let mut cell_of = std::mem::take(&mut self.cell_of);
        cell_of.resize(points.len(), 0);
        let this = &*self;
        cell_of.par_chunks_mut(CHUNK).zip(points.par_chunks(CHUNK)).for_each(|(cells, points)| {
            for (cell, point) in cells.iter_mut().zip(points) {
                *cell = this.cell(point) as u32;
            }
        });
        for &c in &cell_of {
            self.starts[c as usize + 1] += 1;
        }
        self.cell_of = cell_of;
        for c in 0..count {
            self.starts[c + 1] += self.starts[c];
        }
        self.order.clear();
        self.order.resize(points.len(), 0);
        // Counting sort from the back keeps points of one cell in index order and leaves `starts` at the cell ends; shift.
        for i in (0..points.len()).rev() {
            let c = self.cell_of[i] as usize + 1;
            self.starts[c] -= 1;
            self.order[self.starts[c] as usize] = i as u32;
        }
        for c in 0..count {
            self.starts[c] = self.starts[c + 1];
        }
        self.starts[count] = points.len() as u32;
    }

    /// Point indices in cell order.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Point indices in the order of tiles of cells along a Hilbert curve, in cell order within a tile: a piece of the order that is not much smaller
    /// than a tile is compact, and a tile is long enough along the axis that runs fastest for neighbours to be in contiguous runs. Tiles with few points,
    /// as in thin bodies, are joined.
    pub fn tiled_order(&mut self) -> &[u32] {
        // The last axis along which there is more than one cell, the rim aside.
        let fastest = (0..3).rev().find(|&a| self.extent[a] > 3);
        let bits = [0, 1, 2].map(|a| TILE_BITS + u32::from(Some(a) == fastest));
        // Tiles keep their places in space, as cells do.
        let first =
            [0, 1, 2].map(|a| (self.origin[a] * self.inverse_size).round().rem_euclid(f64::from(1u32 << bits[a])));
        // Inner cells begin at one.
        let tile = |cell: [usize; 3]| [0, 1, 2].map(|a| (first[a] as u32 + cell[a] as u32 - 1) >> bits[a]);
        let curve = HilbertCurve::through(tile(self.extent.map(|cells| cells - 2)));
        let place = |cell: usize| {
            let row = cell / self.extent[2];
            curve.place(tile([row / self.extent[1], row % self.extent[1], cell % self.extent[2]]))
        };
        // Room of its own, kept from one sorting to the next: no step allocates.
        let (mut by_tile, mut tiled) = (std::mem::take(&mut self.by_tile), std::mem::take(&mut self.tiled));
        let occupied = (0..self.cells()).filter(|&cell| !self.members_run(cell).is_empty());
        by_tile.clear();
        by_tile.extend(occupied.map(|cell| (place(cell), cell)));
        by_tile.par_sort_unstable();
        let axes = self.extent.iter().filter(|&&cells| cells > 3).count();
        let cells = (0..3).filter(|&a| self.extent[a] > 3).map(|a| f64::from(1u32 << bits[a])).product::<f64>();
        let most = JOINED_SHARE * cells * SPACINGS_IN_CELL.powi(axes as i32);
        self.join_tiles(&mut by_tile, curve.nodes(), most as usize);
        tiled.clear();
        by_tile.iter().for_each(|&(_, cell)| tiled.extend_from_slice(self.members(cell)));
        (self.by_tile, self.tiled) = (by_tile, tiled);
        &self.tiled
    }

    /// Puts cells that are sorted by the places of their tiles in cell order wherever the tiles below one node have no more than `most` points. `nodes`
    /// are the sizes of the nodes from here downwards, as powers of two.
    fn join_tiles(&self, by_tile: &mut [(u64, usize)], mut nodes: impl Iterator<Item = u32> + Clone, most: usize) {
        if by_tile.iter().map(|&(_, cell)| self.members_run(cell).len()).sum::<usize>() <= most {
            by_tile.sort_unstable_by_key(|&(_, cell)| cell);
        } else if let Some(size) = nodes.next() {
            for node in by_tile.chunk_by_mut(|(a, _), (b, _)| a >> size == b >> size) {
                self.join_tiles(node, nodes.clone(), most);
            }
        }
    }

    /// The contiguous runs `(first, last)` of `order` that hold every point within one cell of `p`; some may be empty.
    #[inline(always)]
    pub fn runs_around(&self, p: &Vector<f64>) -> [(usize, usize); 9] {
        self.runs_around_cell(self.cell(p))
    }

    /// The same around a cell that holds a point.
    #[inline(always)]
    pub fn runs_around_cell(&self, cell: usize) -> [(usize, usize); 9] {
        let plane = self.extent[1] * self.extent[2];
        let mut runs = [(0, 0); 9];
        for a in 0..3 {
            for b in 0..3 {
                let c = cell + a * plane + b * self.extent[2] - plane - self.extent[2];
                runs[3 * a + b] = (self.starts[c - 1] as usize, self.starts[c + 2] as usize);
            }
        }
        runs
    }

    /// The cell point `i` was sorted into.
    #[inline(always)]
    pub fn cell_of(&self, i: usize) -> usize {
        self.cell_of[i] as usize
    }

    /// Number of cells, the rim included.
    pub fn cells(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Where the points of a cell lie in the order.
    #[inline(always)]
    pub(crate) fn members_run(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    /// Points of a cell.
    pub fn members(&self, cell: usize) -> &[u32] {
        &self.order[self.members_run(cell)]
    }

    /// A cell that holds a point and the 26 around it.
    pub fn cells_around(&self, cell: usize) -> impl Iterator<Item = usize> {
        let plane = self.extent[1] * self.extent[2];
        let row = self.extent[2];
        (0..27).map(move |k| cell + k / 9 * plane + k / 3 % 3 * row + k % 3 - plane - row - 1)
    }

    /// The cells that have both a cell that holds a point and the one at that place among [`Self::cells_around`] it around them.
    pub fn cells_around_both(&self, cell: usize, place: usize) -> impl Iterator<Item = usize> {
        let is_near = move |k: &usize| [9, 3, 1].iter().all(|axis| (k / axis % 3).abs_diff(place / axis % 3) <= 1);
        self.cells_around(cell).enumerate().filter(move |(k, _)| is_near(k)).map(|(_, cell)| cell)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.starts.capacity() + self.order.capacity() + self.cell_of.capacity() + self.tiled.capacity())
            + size_of::<(u64, usize)>() * self.by_tile.capacity()
    }

    fn coordinates(&self, p: &Vector<f64>) -> [usize; 3] {
        // A saturating cast: points below the grid fall into the first inner cell, points above into the last.
        [0, 1, 2].map(|a| (((p[a] - self.origin[a]) * self.inverse_size) as usize + 1).min(self.extent[a] - 2))
    }

    fn cell(&self, p: &Vector<f64>) -> usize {
        let [x, y, z] = self.coordinates(p);
        (x * self.extent[1] + y) * self.extent[2] + z
    }
}

/// Smallest and largest coordinate of the points along each axis.
pub(crate) fn bounds(points: &[Vector<f64>]) -> (Vector<f64>, Vector<f64>) {
    let nothing = || ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let of_chunk = |points: &[Vector<f64>]| {
        let (mut low, mut high) = nothing();
        for p in points {
            for a in 0..3 {
                low[a] = low[a].min(p[a]);
                high[a] = high[a].max(p[a]);
            }
        }
        (low, high)
    };
    // The least does not depend on the order it is found in.
    let (low, high) = points.par_chunks(CHUNK).map(of_chunk).reduce(nothing, |(a_low, a_high), (b_low, b_high)| {
        ([0, 1, 2].map(|a| a_low[a].min(b_low[a])), [0, 1, 2].map(|a| a_high[a].max(b_high[a])))
    });
    if points.is_empty() { ([0.0; 3], [0.0; 3]) } else { (low, high) }
}

/// Mean plus and minus four standard deviations, inside the given bounds.
fn bulk(points: &[Vector<f64>], low: Vector<f64>, high: Vector<f64>) -> (Vector<f64>, Vector<f64>) {
    let n = points.len() as f64;
    let (mut l, mut h) = (low, high);
    for a in 0..3 {
        let mean = points.iter().map(|p| p[a]).sum::<f64>() / n;
        let deviation = (points.iter().map(|p| (p[a] - mean).powi(2)).sum::<f64>() / n).sqrt();
        l[a] = low[a].max(mean - 4.0 * deviation);
        h[a] = high[a].min(mean + 4.0 * deviation);
    }
    (l, h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bulk_is_four_deviations_about_the_mean() {
        // 99 points at zero and one at (1, -2, 3): mean 0.01, deviation sqrt(99) / 100 of these.
        let mut points = vec![[0.0; 3]; 100];
        points[70] = [1.0, -2.0, 3.0];
        let (low, high) = bounds(&points);
        let (l, h) = bulk(&points, low, high);
        let edge = 0.01 + 4.0 * 99.0_f64.sqrt() / 100.0;
        for (a, (below, above)) in [(0.0, edge), (-2.0 * edge, 0.0), (0.0, 3.0 * edge)].into_iter().enumerate() {
            assert!((l[a] - below).abs() < 1e-12 && (h[a] - above).abs() < 1e-12, "{a}: {} {}", l[a], h[a]);
        }
    }

    #[test]
    fn every_point_is_in_the_order_once_and_runs_reach_all_close_points() {
        let points: Vec<Vector<f64>> =
            (0..60).map(|k| [(k * 7 % 13) as f64 * 0.3, (k * 5 % 11) as f64 * 0.4, (k % 4) as f64 * 0.5]).collect();
        let mut grid = CellGrid::default();
        grid.sort(&points, 1.0);
        let mut seen = grid.order().to_vec();
        seen.sort_unstable();
        assert_eq!(seen, (0..60).collect::<Vec<u32>>());
        for p in &points {
            let mut reached = [false; 60];
            for (first, last) in grid.runs_around(p) {
                for &j in &grid.order()[first..last] {
                    assert!(!reached[j as usize], "visited twice");
                    reached[j as usize] = true;
                }
            }
            for (j, q) in points.iter().enumerate() {
                let d2: f64 = (0..3).map(|a| (p[a] - q[a]).powi(2)).sum();
                assert!(d2 >= 1.0 || reached[j]);
            }
        }
    }

    #[test]
    fn cells_around_two_are_those_around_each_of_them() {
        let points: Vec<Vector<f64>> =
            (0..64).map(|k| [f64::from(k % 4), f64::from(k / 4 % 4), f64::from(k / 16)]).collect();
        let mut grid = CellGrid::default();
        grid.sort(&points, 1.0);
        let (one, around) = (grid.cell_of(21), |cell| grid.cells_around(cell).collect::<Vec<_>>());
        for (place, other) in grid.cells_around(one).enumerate() {
            let both: Vec<_> = grid.cells_around_both(one, place).collect();
            let expected: Vec<_> = around(one).into_iter().filter(|c| around(other).contains(c)).collect();
            assert_eq!(both, expected);
        }
    }

    /// Points of a lattice, `sides` of them along each axis and `spacing` apart, in any order.
    fn lattice(sides: [u32; 3], spacing: f64) -> Vec<Vector<f64>> {
        let count = sides.iter().product::<u32>();
        let point = |k: u32| [k % sides[0], k / sides[0] % sides[1], k / sides[0] / sides[1]];
        // A step that has no factor in common with the count takes every point once.
        (0..count).map(|k| point((k * 7919) % count).map(|x| (f64::from(x) + 0.5) * spacing)).collect()
    }

    fn tiled_order(points: &[Vector<f64>]) -> Vec<u32> {
        let mut grid = CellGrid::default();
        grid.sort(points, 1.0);
        grid.tiled_order().to_vec()
    }

    #[test]
    fn cells_are_together_in_tiles_and_tiles_along_the_curve() {
        // Eight points in each cell; extents in cells, in tiles, and cells of a tile.
        for (sides, tiles, tile) in [
            ([16, 16, 32], [2, 2, 2], [8, 8, 16]),
            ([64, 128, 1], [8, 8, 1], [8, 16, 1]),
            ([1, 1, 64], [1, 1, 4], [1, 1, 16]),
        ] {
            let points = lattice(sides.map(|side: u32| if side == 1 { 1 } else { 2 * side }), 0.5);
            let mut passed: Vec<[u32; 3]> = Vec::new();
            let order = tiled_order(&points);
            let members = order.len() / tiles.iter().product::<u32>() as usize;
            for piece in order.chunks(members) {
                let cells = piece.iter().map(|&i| points[i as usize].map(|x| x as u32));
                let mut sorted: Vec<_> = cells.clone().collect();
                sorted.sort_unstable();
                assert!(cells.eq(sorted.iter().copied()), "{sides:?}: cells are in their own order within a tile");
                let tile_of = |cell: [u32; 3]| [0, 1, 2].map(|a| cell[a] / tile[a]);
                let here = tile_of(sorted[0]);
                assert!(sorted.iter().all(|&cell| tile_of(cell) == here), "{sides:?}: {here:?}");
                let steps = |there: &[u32; 3]| (0..3).map(|a| here[a].abs_diff(there[a])).sum::<u32>();
                assert!(passed.last().is_none_or(|there| steps(there) == 1), "{sides:?}: {here:?} after {passed:?}");
                passed.push(here);
            }
        }
    }

    #[test]
    fn tiles_of_thin_bodies_are_joined() {
        // A plate of two cells of eight points each, in tiles of 8 x 8 x 2: four of them have 4096, sixteen would have more than two thirds of a full tile.
        let points = lattice([128, 64, 4], 0.5);
        let order = tiled_order(&points);
        for piece in order.chunks(4096) {
            let cells: Vec<_> = piece.iter().map(|&i| points[i as usize].map(|x| x as u32)).collect();
            assert!(cells.is_sorted(), "a joined tile is in cell order");
            let (first, last) = (cells[0], cells[4095]);
            assert_eq!([0, 1, 2].map(|a| last[a] - first[a]), [15, 15, 1], "{first:?} to {last:?}");
        }
    }

    #[test]
    fn points_that_move_together_by_whole_tiles_keep_their_order() {
        let points = lattice([40, 35, 70], 0.5);
        let order = tiled_order(&points);
        let moved = |way: Vector<f64>| {
            tiled_order(&points.iter().map(|p| [0, 1, 2].map(|a| p[a] + way[a])).collect::<Vec<_>>())
        };
        assert!(order == moved([8.0, -16.0, 0.0]) && order == moved([-80.0, 0.0, 160.0]));
        // Tiles themselves stay where they are.
        assert_ne!(order, moved([4.0, 0.0, 0.0]));
    }

    #[test]
    fn points_outside_of_the_grid_have_their_places_in_the_order() {
        let mut points = lattice([20, 20, 20], 0.4);
        points.extend([[1e9, -1e9, 1e9], [-1e90, 0.0, 0.0]]);
        let mut order = tiled_order(&points);
        order.sort_unstable();
        assert!(order.into_iter().eq(0..8002));
    }

    #[test]
    fn a_fragment_far_away_does_not_blow_up_the_grid() {
        let mut points: Vec<Vector<f64>> =
            (0..1000).map(|k| [f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)]).collect();
        points.push([1e9, -1e9, 1e9]);
        points.push([1e9 + 0.5, -1e9, 1e9]);
        let mut grid = CellGrid::default();
        grid.sort(&points, 1.0);
        assert!(grid.bytes() < 4_000_000);
        let runs = grid.runs_around(&points[1000]);
        assert!(runs.iter().any(|&(a, b)| grid.order()[a..b].contains(&1001)));
    }
}
