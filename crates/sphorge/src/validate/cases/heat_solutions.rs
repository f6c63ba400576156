//! Exact temperatures of the heat cases, as rise over the cold side; s, m, m²/s.

use std::f64::consts::PI;

/// Terms of a series; the last is far below rounding at the times in use.
const TERMS: u32 = 60;

/// A slab of this thickness from 0, one face at `x = 0` brought to `rise`, the other kept at 0.
pub(super) fn slab(rise: f64, x: f64, thickness: f64, diffusivity: f64, time: f64) -> f64 {
    let mode = |n: u32| {
        let k = f64::from(n) * PI / thickness;
        (k * x).sin() / f64::from(n) * (-diffusivity * k * k * time).exp()
    };
    rise * (1.0 - x / thickness - 2.0 / PI * (1..=TERMS).map(mode).sum::<f64>())
}

/// A plate from 1 in surroundings at 0: temperature in its middle and on average, for a Biot number on half its thickness and a
/// Fourier number `a t/L²`.
pub(super) fn cooling_plate(biot: f64, fourier: f64) -> (f64, f64) {
    (0..TERMS).fold((0.0, 0.0), |(middle, mean), n| {
        let z = root(biot, n);
        let share = 4.0 * z.sin() / (2.0 * z + (2.0 * z).sin()) * (-z * z * fourier).exp();
        (middle + share, mean + share * z.sin() / z)
    })
}

/// Root number `n` of `z tan z = biot`, by bisection.
fn root(biot: f64, n: u32) -> f64 {
    let (mut low, mut high) = (f64::from(n) * PI, (f64::from(n) + 0.5) * PI);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if middle * middle.tan() < biot { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Error function by its power series, for arguments up to 3.
pub(super) fn error_function(x: f64) -> f64 {
    let mut term = x;
    let mut sum = x;
    for n in 1..80 {
        let n = f64::from(n);
        term *= -x * x / n;
        sum += term / (2.0 * n + 1.0);
    }
    2.0 / PI.sqrt() * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_values() {
        // Abramowitz & Stegun, table 7.1 and table 4.20.
        for (x, value) in [(0.0, 0.0), (0.5, 0.520_499_877_8), (1.0, 0.842_700_792_9), (2.0, 0.995_322_265_0)] {
            assert!((error_function(x) - value).abs() < 1e-9, "{x}");
        }
        assert!((root(1.0, 0) - 0.860_33).abs() < 1e-5 && (root(1.0, 1) - 3.425_62).abs() < 1e-5);
        // In time a slab's profile is straight; a plate starts at one everywhere.
        assert!((slab(100.0, 0.02, 0.08, 1e-5, 1e5) - 75.0).abs() < 1e-9);
        let (middle, mean) = cooling_plate(1.0, 0.002);
        assert!((middle - 1.0).abs() < 1e-9 && mean < 1.0 && mean > 0.99, "{middle} {mean}");
    }
}
