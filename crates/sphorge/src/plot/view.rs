//! The direction of view of a picture.

use super::cell::cross;
use crate::model::{Model, WallSurface};

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
    /// From a corner, parallel.
    Corner {
        /// Axis that points up: 0, 1 or 2; that of the model if not given.
        up: Option<usize>,
    },
    /// Parallel, from any direction.
    From {
        /// From the particles to the eye, of any length above zero.
        direction: [f64; 3],
        /// Axis that points up: 0, 1 or 2, not along the direction; that of the model, or another where the eye looks along that, if not given.
        up: Option<usize>,
    },
}

/// The axis that points up in pictures of solids whose model does not say otherwise.
const UPRIGHT: usize = 2;

impl std::str::FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "xy" => Ok(Self::Xy),
            "xz" => Ok(Self::Xz),
            "yz" => Ok(Self::Yz),
            _ => from(text),
        }
    }
}

/// A corner or a direction, and behind `up` the axis that points up.
fn from(text: &str) -> Result<View, String> {
    let unknown = || {
        format!(
            "there is no view `{text}`; choose xy, xz, yz, corner, or a direction such as `1,0.5,2` or `1,-2,1 up z`"
        )
    };
    let (numbers, axis) = text.split_once(" up ").map_or((text, None), |(numbers, axis)| (numbers, Some(axis.trim())));
    let named = |word: &str| ["x", "y", "z"].iter().position(|name| *name == word).ok_or_else(unknown);
    let up = axis.map(named).transpose()?;
    if numbers.trim() == "corner" {
        return Ok(View::Corner { up });
    }
    let direction: Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse()).collect();
    let direction = direction.ok().and_then(|numbers| <[f64; 3]>::try_from(numbers).ok()).ok_or_else(unknown)?;
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Err(format!("`{text}` is no direction"));
    }
    if up.is_some_and(|up| is_along(direction, up)) {
        return Err(format!("`{text}` looks along the axis that points up"));
    }
    Ok(View::From { direction, up })
}

/// Whether a direction is so near to an axis that this cannot point up.
fn is_along(direction: [f64; 3], axis: usize) -> bool {
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    direction[axis].abs() > 0.9999 * length
}

/// The axis that points up where a view does not name one: that against gravity, y where the plane walls stand on y, else z.
pub(crate) fn upright(model: &Model) -> usize {
    let [x, y, z] = model.gravity.map(f64::abs);
    if x + y + z > 0.0 {
        return if x > y && x > z {
            0
        } else if y > z {
            1
        } else {
            2
        };
    }
    let mut planes = model.walls.iter().filter_map(|wall| match wall.surface {
        WallSurface::Plane { normal, .. } => Some(normal),
        WallSurface::Segment { .. } => None,
    });
    let stands_on_y =
        planes.next().is_some_and(|normal| is_along(normal, 1)) && planes.all(|normal| is_along(normal, 1));
    if stands_on_y { 1 } else { UPRIGHT }
}

/// A right-handed frame: right and up on the page, towards the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Projection {
    pub(crate) right: [f64; 3],
    pub(crate) up: [f64; 3],
    pub(crate) towards: [f64; 3],
}

impl View {
    pub(crate) fn projection(self) -> Projection {
        match self {
            Self::Xy => Projection { right: [1.0, 0.0, 0.0], up: [0.0, 1.0, 0.0], towards: [0.0, 0.0, 1.0] },
            Self::Xz => Projection { right: [1.0, 0.0, 0.0], up: [0.0, 0.0, 1.0], towards: [0.0, -1.0, 0.0] },
            Self::Yz => Projection { right: [0.0, 1.0, 0.0], up: [0.0, 0.0, 1.0], towards: [1.0, 0.0, 0.0] },
            Self::Corner { up } => {
                let up = up.unwrap_or(UPRIGHT);
                let [right, front] = sides(up);
                let (turn, lift) = (32f64.to_radians(), 24f64.to_radians());
                let (s, c) = turn.sin_cos();
                let (sl, cl) = lift.sin_cos();
                let of = |on_right: f64, on_up: f64, on_front: f64| {
                    std::array::from_fn(|k| {
                        let upright = if k == up { on_up } else { 0.0 };
                        upright + on_right * right[k] + on_front * front[k]
                    })
                };
                Projection { right: of(c, 0.0, -s), up: of(-sl * s, cl, -sl * c), towards: of(cl * s, sl, cl * c) }
            }
            Self::From { direction, up } => {
                let up = up.unwrap_or_else(|| turned(direction, UPRIGHT));
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

    /// This view with an axis that points up where it names none.
    pub(crate) fn with_up(self, axis: usize) -> Self {
        match self {
            Self::Corner { up: None } => Self::Corner { up: Some(axis) },
            Self::From { direction, up: None } => Self::From { direction, up: Some(turned(direction, axis)) },
            given => given,
        }
    }

    /// Names of the axes of the page; none for a view along no axis.
    pub(super) fn axes(self) -> Option<[&'static str; 2]> {
        match self {
            Self::Xy => Some(["x", "y"]),
            Self::Xz => Some(["x", "z"]),
            Self::Yz => Some(["y", "z"]),
            Self::Corner { .. } | Self::From { .. } => None,
        }
    }
}

/// The axis, or where the eye looks along it, the next one.
fn turned(direction: [f64; 3], axis: usize) -> usize {
    if is_along(direction, axis) { [1, 2, 1][axis] } else { axis }
}

/// The directions to the right and towards the eye that a corner is seen from, with an axis that points up.
pub(super) fn sides(up: usize) -> [[f64; 3]; 2] {
    match up {
        0 => [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
        1 => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        _ => [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
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
        let from =
            ["corner", "corner up x", "corner up y", "corner up z", "1,0.5,2", "0,0,1", "1,-2,1 up y", "-3,0,0 up z"];
        let from = from.map(|text| text.parse().unwrap());
        for view in [View::Xy, View::Xz, View::Yz].into_iter().chain(from) {
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
        for bad in [
            "corner up w",
            "corner up",
            "xy up z",
            "1,2",
            "0,0,0",
            "x,y,z",
            "1,1,1 up w",
            "0,0,2 up z",
            "nan,1,1",
            "side",
        ] {
            assert!(bad.parse::<View>().is_err(), "{bad}");
        }
    }

    #[test]
    fn z_points_up_unless_gravity_or_a_floor_says_otherwise() {
        let up = |view: View, axis: usize| view.projection().up[axis];
        let corner: View = "corner".parse().unwrap();
        assert!(up(corner, 2) > 0.9 && up(corner.with_up(1), 1) > 0.9 && up(corner.with_up(0), 0) > 0.9);
        let (above, front): (View, View) = ("0,0,1".parse().unwrap(), "1,-2,1".parse().unwrap());
        assert_eq!((up(above, 1), up(above.with_up(1), 1)), (1.0, 1.0));
        assert!(up(front, 2) > 0.9 && up(front.with_up(1), 1) > 0.4);
        // One that is named stays.
        assert_eq!("corner up x".parse::<View>().unwrap().with_up(1), View::Corner { up: Some(0) });
        let of = |more: &str| {
            let deck = format!(
                "dimensions = \"3d\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\n{more}\n[[body]]\nname = \"b\"\n\
                 material = \"armco-iron\"\nshape = {{ box = {{ min = [0, 0, 0], max = [\"2 mm\", \"2 mm\", \"2 mm\"] }} }}\nvelocity = [0, -1, 0]\n"
            );
            upright(&crate::deck::load_text("up", &deck, &[]).unwrap().model)
        };
        let wall = |name: &str, normal: &str| {
            format!("[[wall]]\nname = \"{name}\"\nplane = {{ point = [0, 0, 0], normal = {normal} }}\n")
        };
        assert_eq!(of(""), 2);
        assert_eq!(of("gravity = [0, \"-9.81 m/s^2\", 0]"), 1);
        assert_eq!(of(&format!("gravity = [\"-9.81 m/s^2\", 0, 0]\n{}", wall("a", "[0, 1, 0]"))), 0);
        assert_eq!(of(&wall("a", "[0, 1, 0]")), 1);
        assert_eq!(of(&format!("{}{}", wall("a", "[0, 1, 0]"), wall("b", "[1, 0, 0]"))), 2);
    }
}
