//! Images of particles in the planes of symmetry of a deck.

use super::cell::Corners;
use crate::model::SymmetryPlane;

/// A particle of a frame, m, with the value it is coloured by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) position: [f64; 3],
    pub(super) value: f64,
    pub(super) spacing: f64,
    pub(super) body: u16,
    /// Corners of the deformed cell from the particle, m.
    pub(super) cell: Option<Corners<f32>>,
}

/// Adds the images of all particles in a plane. `component` names the axes of the component that is shown, as in `xy`: a
/// component changes its sign with every one that is normal to the plane.
pub(super) fn mirror(samples: &mut Vec<Sample>, plane: &SymmetryPlane, component: &str) {
    let axis = ['x', 'y', 'z'].get(plane.axis).copied().unwrap_or('x');
    let turned = component.to_lowercase().matches(axis).count() % 2 == 1;
    let images: Vec<_> = samples
        .iter()
        .map(|sample| {
            let mut image = *sample;
            image.position[plane.axis] = 2.0 * plane.position - sample.position[plane.axis];
            for corner in image.cell.iter_mut().flatten() {
                corner[plane.axis] = -corner[plane.axis];
            }
            image.value = if turned { -sample.value } else { sample.value };
            image
        })
        .collect();
    samples.extend(images);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_stand_behind_the_plane_with_the_sign_of_their_component() {
        let plane = SymmetryPlane { axis: 1, position: 2.0, side: 1.0 };
        for (component, sign) in [("", 1.0), ("x", 1.0), ("y", -1.0), ("XY", -1.0), ("yy", 1.0), ("xz", 1.0)] {
            let sample = |y: f64, value: f64, corner: f32| Sample {
                position: [5.0, y, 7.0],
                value,
                spacing: 1.0,
                body: 2,
                cell: Some([[0.5, corner, 0.25]; 8]),
            };
            let mut samples = vec![sample(3.0, 4.0, 0.75)];
            mirror(&mut samples, &plane, component);
            assert_eq!(samples[1], sample(1.0, 4.0 * sign, -0.75));
        }
    }
}
