//! Extent and diameter of a set of particles.

use super::selection::SelectedParticles;

/// `max(x + s/2) - min(x - s/2)`, not beyond planes of symmetry, m.
pub(super) fn extent(selection: &SelectedParticles, axis: usize) -> Option<f64> {
    let ends = |i: usize| {
        let (x, half) = (selection.particles.position[i][axis], 0.5 * selection.spacing(i));
        (x - half, x + half)
    };
    let (mut low, mut high) = selection.indices().map(ends).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    // Particles pressed against the plane are flatter than half a spacing.
    for plane in selection.model.symmetry.iter().filter(|plane| plane.axis == axis) {
        if plane.side > 0.0 {
            low = low.max(plane.position);
        } else {
            high = high.min(plane.position);
        }
    }
    Some(high - low)
}

/// `2 max(r + s/2)`, m, about a line along `axis`.
pub(super) fn diameter(selection: &SelectedParticles, axis: usize) -> Option<f64> {
    let positions = &selection.particles.position;
    let mut centre = [0.0; 3];
    let mut count = 0.0;
    for i in selection.indices() {
        for a in 0..3 {
            centre[a] += positions[i][a];
        }
        count += 1.0;
    }
    centre = centre.map(|sum| sum / count);
    for plane in selection.model.symmetry.iter().filter(|plane| plane.axis != axis) {
        centre[plane.axis] = plane.position;
    }
    let reach = |i: usize| {
        let square: f64 = (0..3).filter(|&a| a != axis).map(|a| (positions[i][a] - centre[a]).powi(2)).sum();
        square.sqrt() + 0.5 * selection.spacing(i)
    };
    selection.indices().map(reach).reduce(f64::max).map(|radius| 2.0 * radius)
}
