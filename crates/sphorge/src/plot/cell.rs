//! The deformed cell of a particle in a plane, on the page.

use crate::cells::face_corners;

/// Corners of a cell: bit `k` of a corner's number is its side along axis `k` of the cell.
pub(super) type Corners<T> = [[T; 3]; 8];

/// Faces of a cell.
const FACES: usize = 6;
/// Faces smaller than this share of the square of the cell's size have no direction: those of a wedge at its edge.
const LEAST_FACE: f64 = 1e-9;

/// A half space `n x <= d`, `n` of length one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HalfSpace {
    pub(super) normal: [f64; 3],
    pub(super) offset: f64,
}

impl HalfSpace {
    /// How far inside a point is; negative outside.
    pub(super) fn depth(&self, p: [f64; 3]) -> f64 {
        self.offset - dot(self.normal, p)
    }
}

/// A convex body with plane faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Hull {
    faces: [Option<HalfSpace>; FACES],
    /// Smallest and largest coordinates.
    pub(super) bounds: [(f64, f64); 2],
    /// How far its middle is inside the faces that are seen from their edge, or all of them.
    pub(super) half_width: f64,
}

impl Hull {
    /// Of a cell with these corners; nothing where they are not finite or in one plane.
    pub(super) fn new(corners: &Corners<f64>) -> Option<Self> {
        if !corners.as_flattened().iter().all(|x| x.is_finite()) {
            return None;
        }
        let middle: [f64; 3] = std::array::from_fn(|a| corners.iter().map(|corner| corner[a]).sum::<f64>() / 8.0);
        let side = |a: usize| {
            let of = corners.iter().map(|corner| corner[a]);
            of.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let size = [side(0), side(1), side(2)].map(|(low, high)| high - low).into_iter().fold(0.0, f64::max);
        let face = |number: usize| {
            let [p, q, r, s] = face_corners(number).map(|k| corners[k]);
            let (first, second) = (minus(r, p), minus(s, q));
            let normal = cross(first, second);
            let length = dot(normal, normal).sqrt();
            if length <= LEAST_FACE * size * size {
                return None;
            }
            let normal = normal.map(|x| x / length);
            let point: [f64; 3] = std::array::from_fn(|a| 0.25 * (p[a] + q[a] + r[a] + s[a]));
            let plane = HalfSpace { normal, offset: dot(normal, point) };
            let turned = HalfSpace { normal: normal.map(|x| -x), offset: -plane.offset };
            Some(if plane.depth(middle) < 0.0 { turned } else { plane })
        };
        let faces: [Option<HalfSpace>; FACES] = std::array::from_fn(face);
        let half_width = faces.iter().flatten().map(|face| face.depth(middle)).fold(f64::INFINITY, f64::min);
        (half_width > 0.0 && half_width.is_finite()).then_some(Self { faces, bounds: [side(0), side(1)], half_width })
    }

    /// How far inside all faces a point of the page is, of a hull whose other faces are parallel to the page; negative outside.
    pub(super) fn inside(&self, x: f64, y: f64) -> f64 {
        let edgewise = self.faces.iter().flatten().filter(|face| face.normal[2].abs() < 0.5);
        edgewise.map(|face| face.depth([x, y, 0.0])).fold(f64::INFINITY, f64::min)
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Edges along u, v and w about the point (10, 20, 30).
    fn corners([u, v, w]: [[f64; 3]; 3]) -> Corners<f64> {
        std::array::from_fn(|k| {
            let side = |axis: usize| (k >> axis & 1) as f64 - 0.5;
            std::array::from_fn(|a| [10.0, 20.0, 30.0][a] + side(0) * u[a] + side(1) * v[a] + side(2) * w[a])
        })
    }

    #[test]
    fn a_sheared_cell_is_where_it_is_and_not_where_a_ball_would_be() {
        // Stretched to 8 along x, sheared by 2 along y.
        let hull = Hull::new(&corners([[8.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]])).unwrap();
        assert_eq!(hull.bounds, [(5.0, 15.0), (19.5, 20.5)]);
        assert!((hull.inside(10.0, 20.25) - 0.25).abs() < 1e-12 && hull.inside(13.5, 20.0) > 0.0);
        assert!(hull.inside(10.0, 21.0) < 0.0 && hull.inside(14.5, 19.6) < 0.0);
    }

    #[test]
    fn what_encloses_nothing_has_no_hull() {
        assert_eq!(Hull::new(&corners([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])), None);
        assert_eq!(Hull::new(&corners([[1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0], [0.0, 0.0, 1.0]])), None);
        // A wedge has one face less.
        let mut wedge = corners([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        for k in [0, 2] {
            (wedge[k][1], wedge[k + 4][1]) = (20.0, 20.0);
        }
        let hull = Hull::new(&wedge).unwrap();
        assert_eq!(hull.faces.iter().flatten().count(), 5);
        assert!(hull.inside(10.4, 20.0) > 0.0 && hull.inside(9.6, 20.4) < 0.0);
    }
}
