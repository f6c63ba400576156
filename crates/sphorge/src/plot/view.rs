//! The direction of view of a picture.

use super::cell::cross;

/// Direction of view. The first axis of a plane points right, the second up.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum View {
    /// x to the right, y up, seen from +z.
    #[default]
    Xy,
    /// x to the right, z up, seen from -y.
    Xz,
    /// y to the right, z up, seen from +x.
    Yz,
    /// From a corner, parallel, y up.
    Corner,
    /// Parallel, from any direction.
    From {
        /// From the particles to the eye, of any length above zero.
        direction: [f64; 3],
        /// Axis that points up: 0, 1 or 2, not along the direction.
        up: usize,
    },
}

impl std::str::FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "xy" => Ok(Self::Xy),
            "xz" => Ok(Self::Xz),
            "yz" => Ok(Self::Yz),
            "corner" => Ok(Self::Corner),
            _ => from(text),
        }
    }
}

/// A direction, and behind `up` the axis that points up.
fn from(text: &str) -> Result<View, String> {
    let unknown = || {
        format!(
            "there is no view `{text}`; choose xy, xz, yz, corner, or a direction such as `1,0.5,2` or `1,-2,1 up z`"
        )
    };
    let (numbers, axis) = text.split_once(" up ").map_or((text, None), |(numbers, axis)| (numbers, Some(axis.trim())));
    let direction: Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse()).collect();
    let direction = direction.ok().and_then(|numbers| <[f64; 3]>::try_from(numbers).ok()).ok_or_else(unknown)?;
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Err(format!("`{text}` is no direction"));
    }
    let is_along = |axis: usize| direction[axis].abs() > 0.9999 * length;
    let up = match axis {
        Some(word) => ["x", "y", "z"].iter().position(|name| *name == word).ok_or_else(unknown)?,
        None if is_along(1) => 2,
        None => 1,
    };
    if is_along(up) {
        return Err(format!("`{text}` looks along the axis that points up"));
    }
    Ok(View::From { direction, up })
}

/// A right-handed frame: right and up on the page, towards the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Projection {
    pub(super) right: [f64; 3],
    pub(super) up: [f64; 3],
    pub(super) towards: [f64; 3],
}

impl View {
    pub(super) fn projection(self) -> Projection {
        match self {
            Self::Xy => Projection { right: [1.0, 0.0, 0.0], up: [0.0, 1.0, 0.0], towards: [0.0, 0.0, 1.0] },
            Self::Xz => Projection { right: [1.0, 0.0, 0.0], up: [0.0, 0.0, 1.0], towards: [0.0, -1.0, 0.0] },
            Self::Yz => Projection { right: [0.0, 1.0, 0.0], up: [0.0, 0.0, 1.0], towards: [1.0, 0.0, 0.0] },
            Self::Corner => {
                let (turn, lift) = (32f64.to_radians(), 24f64.to_radians());
                let (s, c) = turn.sin_cos();
                let (sl, cl) = lift.sin_cos();
                Projection { right: [c, 0.0, -s], up: [-sl * s, cl, -sl * c], towards: [cl * s, sl, cl * c] }
            }
            Self::From { direction, up } => {
                let unit = |v: [f64; 3]| {
                    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
                    v.map(|x| x / length)
                };
                let towards = unit(direction);
                let axis: [f64; 3] = std::array::from_fn(|k| f64::from(u8::from(k == up)));
                let right = unit(cross(axis, towards));
                Projection { right, up: cross(towards, right), towards }
            }
        }
    }

    /// Names of the axes of the page; none for a view along no axis.
    pub(super) fn axes(self) -> Option<[&'static str; 2]> {
        match self {
            Self::Xy => Some(["x", "y"]),
            Self::Xz => Some(["x", "z"]),
            Self::Yz => Some(["y", "z"]),
            Self::Corner | Self::From { .. } => None,
        }
    }
}

impl Projection {
    /// Right, up, towards the eye, m.
    pub(super) fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        [self.right, self.up, self.towards].map(|axis| (0..3).map(|k| axis[k] * p[k]).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_is_a_right_handed_orthonormal_frame() {
        let from = ["1,0.5,2", "0,1,0", "1,-2,1 up z", "-3,0,0 up z"].map(|text| text.parse().unwrap());
        for view in [View::Xy, View::Xz, View::Yz, View::Corner].into_iter().chain(from) {
            let Projection { right, up, towards } = view.projection();
            let cross: [f64; 3] =
                std::array::from_fn(|k| right[(k + 1) % 3] * up[(k + 2) % 3] - right[(k + 2) % 3] * up[(k + 1) % 3]);
            for k in 0..3 {
                assert!((cross[k] - towards[k]).abs() < 1e-12, "{view:?}");
            }
            let norm: f64 = up.iter().map(|x| x * x).sum();
            assert!((norm - 1.0).abs() < 1e-12, "{view:?}");
        }
    }
    #[test]
    fn a_direction_is_where_the_eye_is_and_what_points_up_is_upright() {
        let view: View = "0,-5,0 up z".parse().unwrap();
        assert_eq!(view.projection(), View::Xz.projection());
        let [right, up, _] = "1,-2,1 up z".parse::<View>().unwrap().projection().apply([0.0, 0.0, 1.0]);
        assert!(right.abs() < 1e-12 && up > 0.5, "{right} {up}");
        for bad in ["1,2", "0,0,0", "x,y,z", "1,1,1 up w", "0,0,2 up z", "nan,1,1", "side"] {
            assert!(bad.parse::<View>().is_err(), "{bad}");
        }
    }
}
