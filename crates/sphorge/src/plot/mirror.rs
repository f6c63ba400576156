//! Images of particles in the planes of symmetry of a deck.

use crate::model::SymmetryPlane;

/// A particle of a frame, m, with the value it is coloured by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) position: [f64; 3],
    pub(super) value: f64,
    pub(super) spacing: f64,
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
            let mut samples = vec![Sample { position: [5.0, 3.0, 7.0], value: 4.0, spacing: 1.0 }];
            mirror(&mut samples, &plane, component);
            assert_eq!(samples[1], Sample { position: [5.0, 1.0, 7.0], value: 4.0 * sign, spacing: 1.0 });
        }
    }
}
