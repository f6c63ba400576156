//! The deformed cell of a particle on the page: what the planes of its faces enclose.

/// Corners of a cell: bit `k` of a corner's number is its side along axis `k` of the cell.
pub(super) type Corners<T> = [[T; 3]; 8];

/// Faces of a cell.
const FACES: usize = 6;
/// Faces smaller than this share of the square of the cell's size have no direction: those of a wedge at its edge.
const LEAST_FACE: f64 = 1e-9;

/// What is cut off before a plane, so that a face in it is cut, too: points of the raster.
const ON_CUT: f64 = 1e-3;
/// Cosine between normals from which on a face is that which is hit, or the one opposite, which is no edge of it.
const ONE_FACE: f64 = 0.999;

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
    /// Largest coordinate towards the eye.
    pub(super) top: f64,
    /// How far its middle is inside the faces that are seen from their edge, or all of them.
    pub(super) half_width: f64,
}

/// Where a line towards the eye leaves a hull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// Coordinate towards the eye.
    pub(super) depth: f64,
    /// Of the surface there; none on the plane of a cut.
    pub(super) normal: Option<[f64; 3]>,
    /// Distance to the nearest of the other faces.
    pub(super) from_edge: f64,
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
            let (axis, high) = (number / 2, number % 2);
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let corner = |on_b: usize, on_c: usize| corners[(high << axis) | (on_b << b) | (on_c << c)];
            let [p, q, r, s] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
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
        (half_width > 0.0 && half_width.is_finite()).then_some(Self {
            faces,
            bounds: [side(0), side(1)],
            top: side(2).1,
            half_width,
        })
    }

    /// How far inside all faces a point is, of a hull whose other faces are parallel to the page; negative outside.
    pub(super) fn inside(&self, x: f64, y: f64) -> f64 {
        let edgewise = self.faces.iter().flatten().filter(|face| face.normal[2].abs() < 0.5);
        edgewise.map(|face| face.depth([x, y, 0.0])).fold(f64::INFINITY, f64::min)
    }

    /// Where the line through a point of the page towards the eye leaves the hull, grown by a `margin` on all sides and cut off at a plane.
    pub(super) fn hit(&self, x: f64, y: f64, margin: f64, cut: Option<&HalfSpace>) -> Option<Hit> {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut normal = [0.0; 3];
        // A face in the plane of the cut is cut.
        let cut = cut.into_iter().map(|cut| HalfSpace { offset: cut.offset - ON_CUT, ..*cut });
        let grown = self.faces.iter().flatten().map(|face| HalfSpace { offset: face.offset + margin, ..*face });
        for face in grown.chain(cut.clone()) {
            let room = face.depth([x, y, 0.0]);
            let slope = face.normal[2];
            if slope.abs() < 1e-12 {
                if room < 0.0 {
                    return None;
                }
            } else if slope > 0.0 {
                if room / slope < high {
                    (high, normal) = (room / slope, face.normal);
                }
            } else {
                low = low.max(room / slope);
            }
        }
        if low > high || !high.is_finite() {
            return None;
        }
        let others = self.faces.iter().flatten().filter(|face| dot(face.normal, normal).abs() < ONE_FACE);
        let from_edge = others.map(|face| face.depth([x, y, high])).fold(f64::INFINITY, f64::min);
        let is_cut = cut.into_iter().any(|cut| cut.normal == normal);
        Some(Hit { depth: high, normal: (!is_cut).then_some(normal), from_edge })
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
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
    fn a_sheared_cell_is_hit_where_it_is_and_not_where_a_ball_would_be() {
        // Stretched to 8 along x, sheared by 2 along y.
        let hull = Hull::new(&corners([[8.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]])).unwrap();
        assert_eq!(hull.bounds, [(5.0, 15.0), (19.5, 20.5)]);
        let hit = hull.hit(13.5, 20.0, 0.0, None).unwrap();
        assert_eq!((hit.depth, hit.normal), (30.5, Some([0.0, 0.0, 1.0])));
        assert!(hull.hit(10.0, 21.0, 0.0, None).is_none() && hull.hit(14.5, 19.6, 0.0, None).is_none());
        assert!(hull.hit(10.0, 20.6, 0.2, None).is_some());
        assert!((hull.inside(10.0, 20.25) - 0.25).abs() < 1e-12 && hull.inside(10.0, 21.0) < 0.0);
        // A plane across the view takes the upper half away.
        let cut = HalfSpace { normal: [0.0, 0.0, 1.0], offset: 30.1 };
        let hit = hull.hit(10.0, 20.0, 0.0, Some(&cut)).unwrap();
        assert!(
            (hit.depth - 30.1 + ON_CUT).abs() < 1e-12 && hit.normal.is_none() && (hit.from_edge - 0.5).abs() < 1e-12,
            "{hit:?}"
        );
        // A face in the plane is no edge, nor is one just behind it.
        for offset in [30.5, 29.51] {
            let face = HalfSpace { normal: [0.0, 0.0, 1.0], offset };
            let hit = hull.hit(10.0, 20.0, 0.0, Some(&face)).unwrap();
            assert!(hit.normal.is_none() && (hit.from_edge - 0.5).abs() < 1e-12, "{hit:?}");
        }
        let none = HalfSpace { normal: [0.0, 0.0, 1.0], offset: 29.0 };
        assert_eq!(hull.hit(10.0, 20.0, 0.0, Some(&none)), None);
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
        assert!(hull.hit(10.4, 20.4, 0.0, None).is_some() && hull.hit(9.6, 20.4, 0.0, None).is_none());
    }
}
