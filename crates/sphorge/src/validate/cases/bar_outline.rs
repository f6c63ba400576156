//! The side of a round bar of rings of particles, beside that of others.

use super::super::runs::Run;

/// A round bar along `z` that stands on `z = 0`, as it was at the start, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundBar {
    pub(super) length: f64,
    pub(super) radius: f64,
}

/// Heights at which two outlines are compared.
const HEIGHTS: usize = 20;

/// A line of a bar from the wall up, height and radius of its points.
pub(super) type Line = Vec<[f64; 2]>;

/// Where the outermost ring of the bar is at the end, slice by slice, m; none if the frames of the run have no such bar.
///
/// These particles are half a spacing below the side, and so is what they are compared with: the side itself would have to be guessed from
/// rings of which the outermost are stretched the least. Drawn through the last two rings of finite elements and on to the wall through the
/// last two slices, the foot of the 42CrMo4 bar is 2.1 % too wide with 12 particles across and 0.8 % with 24.
pub(super) fn outermost_ring(run: &Run, bar: RoundBar) -> Option<Line> {
    let [first, last] = run.first_and_last_positions()?;
    ring(&first, &last, bar, run.spacing)
}

fn ring(first: &[[f64; 3]], last: &[[f64; 3]], bar: RoundBar, spacing: f64) -> Option<Line> {
    let slices = (bar.length / spacing).round();
    let width = bar.radius / (bar.radius / spacing).round();
    // Of each slice: number of particles, sums of height and radius.
    let mut sums = vec![[0.0; 3]; slices as usize];
    for (a, b) in first.iter().zip(last).filter(|(a, _)| a[0].hypot(a[1]) > bar.radius - width) {
        if let Some(sum) = sums.get_mut((a[2] / bar.length * slices) as usize) {
            for (sum, value) in sum.iter_mut().zip([1.0, b[2], b[0].hypot(b[1])]) {
                *sum += value;
            }
        }
    }
    let ring: Line = sums.iter().map(|[count, height, radius]| [height / count, radius / count]).collect();
    (ring.len() > 1 && ring.iter().flatten().all(|number| number.is_finite())).then_some(ring)
}

/// Deviation of `ours` from `theirs` at the worst of 20 heights between the ends of `ours`, as a share of the radius; heights of `theirs` are
/// stretched by `stretch` first.
pub(super) fn worst_deviation(ours: &[[f64; 2]], theirs: &[[f64; 2]], stretch: f64) -> Option<f64> {
    let (low, high) = (ours.first()?[0], ours.last()?[0]);
    let heights = (0..HEIGHTS).map(|k| low + (high - low) * k as f64 / (HEIGHTS - 1) as f64);
    let deviation = |height: f64| radius_at(ours, height) / radius_at(theirs, height / stretch) - 1.0;
    heights.map(deviation).reduce(|a, b| if b.abs() > a.abs() || b.is_nan() { b } else { a })
}

/// The largest radius at a height, which a fold has several of; beyond the ends of the line that of the end.
fn radius_at(line: &[[f64; 2]], height: f64) -> f64 {
    let height = line.iter().map(|[height, _]| *height).fold(f64::INFINITY, f64::min).max(height);
    let crossing = |pair: &[[f64; 2]]| {
        let [[low, a], [high, b]] = [pair[0], pair[1]];
        let share = (height - low) / (high - low);
        (0.0..=1.0).contains(&share).then_some(a + share * (b - a))
    };
    let top = line.last().map_or(f64::NAN, |[_, radius]| *radius);
    line.windows(2).filter_map(crossing).reduce(f64::max).unwrap_or(top)
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
    fn the_outermost_ring_of_a_cone_is_that_of_the_cone() {
        let first = places();
        // Half as high, wider by half at the wall and by nothing at the top.
        let cone = |p: &[f64; 3]| [p[0] * (1.5 - 0.05 * p[2]), p[1] * (1.5 - 0.05 * p[2]), 0.5 * p[2]];
        let last: Vec<_> = first.iter().map(cone).collect();
        let ours = ring(&first, &last, BAR, 0.82).unwrap();
        assert_eq!(ours.len(), 12);
        let line = |wider: f64| [0.0, 5.0].map(|height| [height, wider * 2.625 * (1.5 - 0.1 * height)]).to_vec();
        assert!(worst_deviation(&ours, &line(1.0), 1.0).unwrap().abs() < 1e-12);
        assert!((worst_deviation(&ours, &line(1.25), 1.0).unwrap() + 0.2).abs() < 1e-12);
        // A bar a tenth shorter with the same radii.
        let shorter: Line = line(1.0).iter().map(|[height, radius]| [0.9 * height, *radius]).collect();
        assert!(worst_deviation(&ours, &shorter, 1.0 / 0.9).unwrap().abs() < 1e-12);
        assert!(worst_deviation(&ours, &shorter, 1.0).unwrap() > 0.03);
    }

    #[test]
    fn the_worst_height_counts_whatever_its_sign() {
        let straight = [[0.0, 1.0], [19.0, 1.0]];
        let uneven = [[0.0, 1.02], [1.0, 1.0], [9.0, 1.0], [10.0, 0.95], [11.0, 1.0], [19.0, 1.0]];
        assert!((worst_deviation(&uneven, &straight, 1.0).unwrap() + 0.05).abs() < 1e-12);
        assert_eq!(worst_deviation(&[], &straight, 1.0), None);
    }

    #[test]
    fn a_fold_has_its_largest_radius_and_lost_particles_no_ring() {
        let fold = [[0.0, 3.0], [2.0, 5.0], [1.0, 4.0], [4.0, 3.5]];
        assert_eq!(radius_at(&fold, 2.0), 5.0);
        assert_eq!(radius_at(&fold, 1.0), 4.0);
        assert_eq!((radius_at(&fold, 4.1), radius_at(&fold, -0.1)), (3.5, 3.0));
        let first = places();
        assert!(ring(&first[..50], &first[..50], BAR, 0.82).is_none());
    }
}
