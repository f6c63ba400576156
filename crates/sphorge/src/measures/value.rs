//! Kernel interpolation at a point.

use super::selection::{Quantity, SelectedParticles};

/// `sum (m/rho) f W / sum (m/rho) W` (Shepard). The normalisation of the kernel cancels, but for its `1/h^d`.
pub(crate) fn shepard(selection: &SelectedParticles, quantity: &Quantity, point: [f64; 3]) -> Option<f64> {
    let p = selection.particles;
    let kernel = selection.model.numerics.kernel;
    let dimensions = selection.model.dimensions.count();
    let (sum, weight) = selection.indices().fold((0.0, 0.0), |(sum, weight), i| {
        let r = (0..dimensions).map(|a| (p.position[i][a] - point[a]).powi(2)).sum::<f64>().sqrt();
        let h = p.smoothing_length[i];
        let w = p.mass[i] / p.density[i] * kernel.w(r / h) / h.powi(dimensions as i32);
        // The field may be anything where the kernel does not reach.
        if w > 0.0 { (sum + w * quantity.of(i), weight + w) } else { (sum, weight) }
    });
    (weight > 0.0).then(|| sum / weight)
}
