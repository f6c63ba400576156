//! The curve of Recht and Ipson through residual velocities.
//!
//! `v_r = a (v_i^p - v_bl^p)^(1/p)` above the ballistic limit `v_bl`, none below (R. F. Recht, T. W. Ipson, Journal of Applied Mechanics 30 (1963)
//! 384, with `p = 2`; with any `p`: J. Lambert, G. Jonas, Ballistic Research Laboratories R-1852 (1976)). `a` enters linearly and follows from the
//! other two, so that the least squares are looked for in the plane of `p` and `v_bl` alone, on grids that close in on the best of their points.

/// Exponents that are looked for.
const EXPONENTS: (f64, f64) = (1.0, 10.0);
/// Intervals of a grid along each of its axes.
const INTERVALS: usize = 40;
/// How often a grid closes in, each time to a quarter of its width: constants depend on each other, and the best point of a coarse grid is beside a valley.
const ROUNDS: usize = 24;

/// A curve of Recht and Ipson.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RechtIpson {
    /// Residual over impact velocity far above the limit.
    pub a: f64,
    /// Exponent.
    pub p: f64,
    /// Ballistic limit of the curve, m/s.
    pub limit: f64,
    /// Root of the mean square of what the residual velocities are off the curve, m/s.
    pub off_by: f64,
    /// Runs that it is fitted to.
    pub runs: usize,
    /// Constants that were fitted.
    pub constants: usize,
}

impl RechtIpson {
    /// Residual velocity at an impact velocity, m/s.
    pub fn residual(&self, speed: f64) -> f64 {
        self.a * share(speed, self.p, self.limit)
    }

    /// The curve of least squares through `points`, impact and residual velocity of what got through, whose limit is within `bounds`: from the
    /// fastest that was stopped to the slowest that got through. A given exponent is held.
    ///
    /// # Errors
    /// Why there is none.
    pub fn fit(points: &[(f64, f64)], bounds: (f64, f64), exponent: Option<f64>) -> Result<Self, String> {
        let constants = if exponent.is_some() { 2 } else { 3 };
        if points.len() < constants {
            let found = match points.len() {
                0 => "no run has".to_owned(),
                1 => "one run has".to_owned(),
                count => format!("only {count} runs have"),
            };
            let held = if exponent.is_none() && points.len() == 2 { ", or hold p" } else { "" };
            return Err(format!(
                "{found} got through, and a curve with {constants} free constants needs {constants}{held}"
            ));
        }
        // Sums, and so the last bits, do not depend on the order in which runs were made.
        let mut points = points.to_vec();
        points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let (low, high) = bounds;
        if !(low >= 0.0 && low < high && high.is_finite()) {
            return Err("nothing tells where the limit of the curve is".to_owned());
        }
        let of = |p: f64, limit: f64| {
            let shares = points.iter().map(|(speed, _)| share(*speed, p, limit));
            let (product, square) = points
                .iter()
                .zip(shares)
                .fold((0.0, 0.0), |(product, square), ((_, residual), f)| (product + residual * f, square + f * f));
            let a = if square > 0.0 { product / square } else { 0.0 };
            let curve = Self { a, p, limit, off_by: 0.0, runs: points.len(), constants };
            let off = points.iter().map(|(speed, residual)| (residual - curve.residual(*speed)).powi(2)).sum::<f64>();
            (off, curve)
        };
        let range = exponent.map_or(EXPONENTS, |p| (p, p));
        let (mut across, mut up) = (range, bounds);
        let mut best = of(range.0, low);
        for _ in 0..ROUNDS {
            for p in grid(across) {
                for limit in grid(up) {
                    let found = of(p, limit);
                    if found.0 < best.0 {
                        best = found;
                    }
                }
            }
            across = closer(across, best.1.p, range);
            up = closer(up, best.1.limit, bounds);
        }
        let (off, curve) = best;
        let curve = Self { off_by: (off / points.len() as f64).sqrt(), ..curve };
        if curve.a > 0.0 && curve.a.is_finite() {
            Ok(curve)
        } else {
            Err("no curve goes up through the runs".to_owned())
        }
    }
}

/// `(v^p - v_bl^p)^(1/p)`, none below the limit.
fn share(speed: f64, p: f64, limit: f64) -> f64 {
    // Of a ratio: powers of speeds may not be numbers any more.
    if speed > limit { speed * (1.0 - (limit / speed).powf(p)).powf(1.0 / p) } else { 0.0 }
}

/// Points from one end to the other; one where both are the same.
fn grid((low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    let count = if high > low { INTERVALS } else { 0 };
    (0..=count).map(move |k| if count == 0 { low } else { low + (high - low) * k as f64 / count as f64 })
}

/// A range of a quarter of the width around a point, not beyond the whole.
fn closer((low, high): (f64, f64), at: f64, whole: (f64, f64)) -> (f64, f64) {
    let half = 0.125 * (high - low);
    ((at - half).max(whole.0), (at + half).min(whole.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(a: f64, p: f64, limit: f64, speeds: &[f64]) -> Vec<(f64, f64)> {
        speeds.iter().map(|v| (*v, a * (v.powf(p) - limit.powf(p)).powf(1.0 / p))).collect()
    }

    #[test]
    fn constants_of_a_curve_are_found_from_points_on_it() {
        for (a, p, limit) in [(0.79, 2.36, 184.5), (0.95, 2.52, 290.6), (1.0, 2.0, 400.0), (0.6, 1.3, 150.0)] {
            let through = points(a, p, limit, &[1.01, 1.03, 1.1, 1.3, 1.6, 2.2].map(|x| x * limit));
            let curve = RechtIpson::fit(&through, (0.95 * limit, 1.01 * limit), None).unwrap();
            assert!((curve.a / a - 1.0).abs() < 1e-5, "{curve:?}");
            assert!((curve.p / p - 1.0).abs() < 1e-4, "{curve:?}");
            assert!((curve.limit / limit - 1.0).abs() < 1e-6, "{curve:?}");
            assert!(curve.off_by < 1e-5 && (curve.runs, curve.constants) == (6, 3), "{curve:?}");
            for (speed, residual) in &through {
                assert!((curve.residual(*speed) - residual).abs() < 1e-4);
            }
            assert_eq!(curve.residual(limit * 0.99), 0.0);
        }
        // By hand: 100 sqrt(2^2 - 1) = 173.2.
        let two = RechtIpson { a: 1.0, p: 2.0, limit: 100.0, off_by: 0.0, runs: 0, constants: 2 };
        assert!((two.residual(200.0) - 173.205_080_756_887_7).abs() < 1e-9);
    }

    #[test]
    fn a_curve_does_not_depend_on_the_order_of_its_points() {
        let speeds = [205.0, 220.0, 250.0, 300.0, 350.0, 400.0];
        let through: Vec<_> =
            speeds.iter().enumerate().map(|(k, v)| (*v, 0.37 * (v - 190.0) + (k * k) as f64 / 3.0)).collect();
        let fit = |points: &[(f64, f64)]| RechtIpson::fit(points, (150.0, 205.0), Some(2.0)).unwrap();
        for first in 0..through.len() {
            let mut others = through.clone();
            others.swap(0, first);
            others.reverse();
            assert_eq!(fit(&others), fit(&through));
        }
    }

    #[test]
    fn an_exponent_can_be_held_and_needs_a_point_less() {
        let through = points(0.8, 2.0, 200.0, &[220.0, 300.0]);
        let curve = RechtIpson::fit(&through, (150.0, 220.0), Some(2.0)).unwrap();
        assert!((curve.a - 0.8).abs() < 1e-6 && (curve.limit - 200.0).abs() < 1e-4 && curve.p == 2.0, "{curve:?}");
        let two = RechtIpson::fit(&through, (150.0, 220.0), None).unwrap_err();
        assert!(two.contains("3 free constants") && two.contains("hold p"), "{two}");
        let one = RechtIpson::fit(&through[..1], (150.0, 220.0), Some(2.0)).unwrap_err();
        assert!(one.contains("one run has"), "{one}");
        let none = RechtIpson::fit(&[], (150.0, 220.0), None).unwrap_err();
        assert!(none.starts_with("no run has got through"), "{none}");
        // What is off a curve is told: here one metre per second, up and down.
        let off = through.iter().flat_map(|(speed, residual)| [(*speed, residual + 1.0), (*speed, residual - 1.0)]);
        let curve = RechtIpson::fit(&off.collect::<Vec<_>>(), (150.0, 220.0), Some(2.0)).unwrap();
        assert!((curve.off_by - 1.0).abs() < 1e-6 && curve.runs == 4, "{curve:?}");
    }

    #[test]
    fn the_limit_of_a_curve_stays_between_what_was_stopped_and_what_was_not() {
        let through = points(0.8, 2.0, 200.0, &[230.0, 260.0, 300.0, 350.0]);
        let curve = RechtIpson::fit(&through, (215.0, 230.0), Some(2.0)).unwrap();
        assert!(curve.limit >= 215.0 && curve.limit <= 230.0 && curve.off_by > 0.1, "{curve:?}");
    }

    #[test]
    fn speeds_of_any_size_do_no_harm() {
        for speeds in [[1e-3, 2e-3, 3e-3], [1e150, 2e150, 3e150], [1e-150, 2e-150, 3e-150]] {
            let through: Vec<_> = speeds.iter().map(|v| (*v, 0.5 * v)).collect();
            let curve = RechtIpson::fit(&through, (0.0, speeds[0]), None).unwrap();
            assert!(curve.a.is_finite() && curve.off_by.is_finite(), "{curve:?}");
        }
    }
}
