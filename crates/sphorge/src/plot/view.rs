//! The direction of view of a picture.

/// Direction of view. The first axis of a plane points right, the second up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
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
}

impl std::str::FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "xy" => Ok(Self::Xy),
            "xz" => Ok(Self::Xz),
            "yz" => Ok(Self::Yz),
            "corner" => Ok(Self::Corner),
            _ => Err(format!("there is no view `{text}`; choose xy, xz, yz or corner")),
        }
    }
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
        }
    }

    /// Names of the axes of the page; none for a view along no axis.
    pub(super) fn axes(self) -> Option<[&'static str; 2]> {
        match self {
            Self::Xy => Some(["x", "y"]),
            Self::Xz => Some(["x", "z"]),
            Self::Yz => Some(["y", "z"]),
            Self::Corner => None,
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
        for view in [View::Xy, View::Xz, View::Yz, View::Corner] {
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
}
