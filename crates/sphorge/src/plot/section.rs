//! The plane a section is cut along.

use super::view::{View, sides};

/// Where a section cuts bodies; what is on the side of the eye is left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Section {
    /// Through the middle, across the view: the plane of symmetry there where the deck has one.
    #[default]
    Middle,
    /// Along a plane across this direction.
    Across {
        /// Normal of the plane, of any length.
        normal: [f64; 3],
        /// A point of the plane, m; the middle of the particles if not given.
        point: Option<[f64; 3]>,
    },
}

impl Section {
    /// Normal of the plane, of length one and towards the eye, and the axis it is along, if any; `size` is that of the bodies along the axes.
    pub(crate) fn normal(self, view: View, size: [f64; 3]) -> [f64; 3] {
        let axis = |axis: usize| std::array::from_fn(|k| f64::from(u8::from(k == axis)));
        let normal = match self {
            Self::Across { normal, .. } => {
                let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
                normal.map(|x| x / length)
            }
            Self::Middle => match view {
                View::Xy => axis(2),
                View::Xz => axis(1),
                View::Yz => axis(0),
                // Along the body where that is long.
                View::Corner { up } => {
                    let [right, front] = sides(up.unwrap_or(2));
                    let along = |v: [f64; 3]| (0..3).map(|k| v[k].abs() * size[k]).sum::<f64>();
                    let other = (0..3).filter(|&k| front[k] == 0.0).map(|k| size[k]).fold(0.0, f64::max);
                    if along(front) > 1.5 * other { right } else { front }
                }
                View::From { direction, .. } => {
                    // Along the body here too: across the axis that is nearest to the view but for a long one.
                    let long = (0..3).find(|&k| size[k] > 1.5 * size[(k + 1) % 3].max(size[(k + 2) % 3]));
                    let others = (0..3).filter(|&k| Some(k) != long);
                    axis(others.max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs())).unwrap_or(2))
                }
            },
        };
        let towards = view.projection().towards;
        let faces: f64 = (0..3).map(|k| normal[k] * towards[k]).sum();
        if faces < -1e-9 { normal.map(|x| -x) } else { normal }
    }
}

/// The axis that a direction is along.
pub(super) fn axis_of(normal: [f64; 3]) -> Option<usize> {
    (0..3).find(|&k| normal[k].abs() > 1.0 - 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_half_towards_the_eye_goes_whatever_the_sign_of_the_normal() {
        let section = |z: f64| Section::Across { normal: [0.0, 0.0, z], point: None };
        for z in [-2.0, 3.0] {
            assert_eq!(section(z).normal(View::Corner { up: None }, [1.0; 3]), [0.0, 0.0, 1.0]);
            let below = View::From { direction: [0.0, 1.0, -1.0], up: Some(1) };
            assert_eq!(section(z).normal(below, [1.0; 3]), [0.0, 0.0, -1.0]);
        }
    }

    #[test]
    fn the_middle_of_a_long_body_is_along_it() {
        let corner = |up: usize| View::Corner { up: Some(up) };
        assert_eq!(Section::Middle.normal(corner(1), [1.0, 1.0, 4.0]), [1.0, 0.0, 0.0]);
        assert_eq!(Section::Middle.normal(corner(1), [1.0, 4.0, 1.0]), [0.0, 0.0, 1.0]);
        assert_eq!(Section::Middle.normal(corner(2), [1.0, 1.0, 4.0]), [0.0, -1.0, 0.0]);
        assert_eq!(Section::Middle.normal(corner(2), [1.0, 4.0, 1.0]), [1.0, 0.0, 0.0]);
        let along = View::From { direction: [0.2, 1.0, 0.1], up: Some(2) };
        assert_eq!(axis_of(Section::Middle.normal(along, [1.0, 4.0, 1.0])), Some(0));
        assert_eq!(axis_of(Section::Middle.normal(along, [1.0; 3])), Some(1));
    }
}
