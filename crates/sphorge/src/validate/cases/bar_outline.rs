//! The side of a round bar of rings of particles, beside that of others.

use super::super::runs::Run;

/// A round bar along `z` that stands on `z = 0`, as it was at the start, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundBar {
    pub(super) length: f64,
    pub(super) radius: f64,
}

/// Radii of a bar at `count` heights, evenly from the wall to its present top at `top`, m; none if the frames of the run have no such bar.
pub(super) fn outline(run: &Run, bar: RoundBar, top: f64, count: usize) -> Option<Vec<f64>> {
    let [first, last] = run.first_and_last_positions()?;
    let side = side(&first, &last, bar, run.spacing)?;
    Some((0..count).map(|k| radius_at(&side, top * k as f64 / (count - 1) as f64)).collect())
}

/// Height and radius of the side, from the wall up.
///
/// Slice by slice, half the distance between the two outermost rings beyond the outermost one. Foot and top lie on the line through the two
/// slices next to them.
fn side(first: &[[f64; 3]], last: &[[f64; 3]], bar: RoundBar, spacing: f64) -> Option<Vec<[f64; 2]>> {
    let slices = (bar.length / spacing).round();
    let width = bar.radius / (bar.radius / spacing).round();
    // Of each slice and its outermost ring and the one inside: number of particles, sums of height and radius.
    let mut sums = vec![[[0.0; 3]; 2]; slices as usize];
    for (a, b) in first.iter().zip(last) {
        let inwards = ((bar.radius - a[0].hypot(a[1])) / width) as usize;
        let slice = (a[2] / bar.length * slices) as usize;
        if let Some(sum) = sums.get_mut(slice).and_then(|rings| rings.get_mut(inwards)) {
            for (sum, value) in sum.iter_mut().zip([1.0, b[2], b[0].hypot(b[1])]) {
                *sum += value;
            }
        }
    }
    let beyond = |[outer, inner]: [[f64; 3]; 2]| {
        let mean = |k: usize| [outer[k] / outer[0], inner[k] / inner[0]];
        let at = |[outer, inner]: [f64; 2]| outer + 0.5 * (outer - inner);
        [at(mean(1)), at(mean(2))]
    };
    let mut side: Vec<[f64; 2]> = sums.into_iter().map(beyond).collect();
    let [low, next, .., before, high] = side[..] else { return None };
    let line = |a: [f64; 2], b: [f64; 2], height: f64| [height, a[1] + (height - a[0]) / (b[0] - a[0]) * (b[1] - a[1])];
    side.insert(0, line(low, next, 0.0));
    side.push(line(high, before, high[0] + 0.5 * (high[0] - before[0])));
    side.iter().flatten().all(|number| number.is_finite()).then_some(side)
}

/// The largest radius at a height; that of the top above it.
fn radius_at(side: &[[f64; 2]], height: f64) -> f64 {
    let crossing = |pair: &[[f64; 2]]| {
        let [[low, a], [high, b]] = [pair[0], pair[1]];
        let share = (height - low) / (high - low);
        (0.0..=1.0).contains(&share).then_some(a + share * (b - a))
    };
    let top = side.last().map_or(f64::NAN, |[_, radius]| *radius);
    side.windows(2).filter_map(crossing).reduce(f64::max).unwrap_or(top)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAR: RoundBar = RoundBar { length: 10.0, radius: 3.0 };

    /// Four rings and twelve slices, as of a spacing of 0.82.
    fn places() -> Vec<[f64; 3]> {
        let mut places = Vec::new();
        for slice in 0..12 {
            for ring in 0..4 {
                let r = 0.75 * (f64::from(ring) + 0.5);
                for angle in [0.3, 0.7, 1.2] {
                    places.push([r * f64::cos(angle), r * f64::sin(angle), 10.0 / 12.0 * (f64::from(slice) + 0.5)]);
                }
            }
        }
        places
    }

    #[test]
    fn a_cone_has_its_sides_from_the_wall_to_the_top() {
        let first = places();
        // Half as high, wider by half at the wall and by nothing at the top.
        let cone = |p: &[f64; 3]| [p[0] * (1.5 - 0.05 * p[2]), p[1] * (1.5 - 0.05 * p[2]), 0.5 * p[2]];
        let last: Vec<_> = first.iter().map(cone).collect();
        let side = side(&first, &last, BAR, 0.82).unwrap();
        assert_eq!(side.len(), 14);
        for height in [0.0, 0.1, 2.0, 3.3, 4.95, 5.0] {
            assert!((radius_at(&side, height) - 3.0 * (1.5 - 0.1 * height)).abs() < 1e-12, "{height}");
        }
        assert!((radius_at(&side, 5.1) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_fold_has_its_largest_radius_and_lost_particles_no_side() {
        let fold = [[0.0, 3.0], [2.0, 5.0], [1.0, 4.0], [4.0, 3.5]];
        assert_eq!(radius_at(&fold, 2.0), 5.0);
        assert_eq!(radius_at(&fold, 1.0), 4.0);
        let first = places();
        assert!(side(&first[..50], &first[..50], BAR, 0.82).is_none());
    }
}
