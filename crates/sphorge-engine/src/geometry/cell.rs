//! The cell of a particle: the part of its body that it stands for, a brick of a lattice or a sector of a ring.

use crate::model::{Dimensions, Transform};
use smallvec::SmallVec;

/// Faces of a cell, at most.
pub(super) const FACES: usize = 6;

/// Widest part of the face of a sector, rad.
const WIDEST: f64 = 0.21;

/// One face of a cell, or a part of it, number `2 axis + side` with the low side first.
#[derive(Clone, Debug)]
pub(super) struct CellFace {
    pub(super) number: u8,
    /// In order around it: four in space, two in the plane, none on a line.
    pub(super) corners: SmallVec<[[f64; 3]; 4]>,
    pub(super) middle: [f64; 3],
    /// Unit vector from the middle of the cell to that of the face.
    pub(super) outward: [f64; 3],
}

/// Cell of a particle, in space.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Cell {
    /// Of a lattice.
    Brick {
        /// Axes of the lattice.
        frame: [[f64; 3]; 3],
        /// Distances of neighbours along them, m.
        pitch: [f64; 3],
        /// Distances from the particle to where the body ends below and above along an axis, m, for the particles next to its ends.
        ends: [[Option<f64>; 2]; 3],
    },
    /// Of a ring.
    Sector {
        /// Point of the axis of the ring.
        centre: [f64; 3],
        /// Towards the particle, along the ring, and along the axis.
        frame: [[f64; 3]; 3],
        /// Distance of the particle from the axis, m.
        radius: f64,
        /// Inner and outer radius of the ring, m.
        radii: [f64; 2],
        /// Half the angle of the sector.
        half_angle: f64,
        /// Half the thickness of the slice, m.
        half_thickness: f64,
    },
}

fn combine(origin: [f64; 3], frame: &[[f64; 3]; 3], by: [f64; 3]) -> [f64; 3] {
    let [u, v, w] = frame;
    std::array::from_fn(|k| origin[k] + by[0] * u[k] + by[1] * v[k] + by[2] * w[k])
}

/// Offsets along the two other axes around a face, as indices of low and high.
fn around(axis: usize, dimensions: Dimensions) -> SmallVec<[[usize; 3]; 4]> {
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |on_b: usize, on_c: usize| {
        let mut at = [0; 3];
        (at[b], at[c]) = (on_b, on_c);
        at
    };
    match dimensions.count() {
        3 => [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)].into_iter().collect(),
        // The axis that is not there has one place.
        2 if b == 2 => [corner(0, 0), corner(0, 1)].into_iter().collect(),
        2 => [corner(0, 0), corner(1, 0)].into_iter().collect(),
        _ => SmallVec::new(),
    }
}

impl Cell {
    /// A cube of that edge (m) along these axes.
    pub(crate) fn cube(frame: [[f64; 3]; 3], edge: f64) -> Self {
        Self::Brick { frame, pitch: [edge; 3], ends: [[None; 2]; 3] }
    }

    /// The same in the space that a solid is placed in.
    pub(super) fn placed(self, by: &Transform) -> Self {
        match self {
            Self::Brick { frame, pitch, ends } => Self::Brick { frame: frame.map(|axis| by.turn(axis)), pitch, ends },
            Self::Sector { centre, frame, radius, radii, half_angle, half_thickness } => Self::Sector {
                centre: by.apply(centre),
                frame: frame.map(|axis| by.turn(axis)),
                radius,
                radii,
                half_angle,
                half_thickness,
            },
        }
    }

    /// Corners of the cell of the particle at `site`, m, from there: bit `k` of a corner's number is its side along axis `k`. Sides of
    /// sectors have straight edges; there is no width along axes that the deck does not have.
    pub(super) fn corners(&self, site: [f64; 3], dimensions: Dimensions) -> [[f64; 3]; 8] {
        let count = dimensions.count();
        std::array::from_fn(|corner| {
            let side = |a: usize| if a >= count { 0.0 } else { f64::from(corner as u32 >> a & 1) - 0.5 };
            match self {
                Self::Brick { frame, pitch, .. } => {
                    combine([0.0; 3], frame, std::array::from_fn(|a| side(a) * pitch[a]))
                }
                Self::Sector { centre, frame, radii, half_angle, half_thickness, .. } => {
                    let radius = radii[usize::from(side(0) > 0.0)];
                    let (sin, cos) = (2.0 * side(1) * half_angle).sin_cos();
                    let place = combine(*centre, frame, [radius * cos, radius * sin, 2.0 * side(2) * half_thickness]);
                    std::array::from_fn(|k| place[k] - site[k])
                }
            }
        })
    }

    /// Place at which the particle beyond a face is expected; none beyond a face that the cell does not have.
    pub(super) fn across(&self, site: [f64; 3], face: usize, dimensions: Dimensions) -> Option<[f64; 3]> {
        let (axis, side) = (face / 2, face % 2);
        if axis >= dimensions.count() {
            return None;
        }
        let sign = if side == 0 { -1.0 } else { 1.0 };
        match self {
            Self::Brick { frame, pitch, .. } => {
                Some(std::array::from_fn(|k| site[k] + sign * pitch[axis] * frame[axis][k]))
            }
            Self::Sector { centre, frame, radius, radii, half_angle, half_thickness } => match axis {
                0 if side == 0 && radii[0] == 0.0 => None,
                0 => {
                    let r = 0.5 * (radii[0] + radii[1]) + sign * (radii[1] - radii[0]);
                    Some(combine(*centre, frame, [r, 0.0, 0.0]))
                }
                1 => {
                    let (sin, cos) = (2.0 * sign * half_angle).sin_cos();
                    Some(combine(*centre, frame, [radius * cos, radius * sin, 0.0]))
                }
                _ => Some(combine(site, frame, [0.0, 0.0, 2.0 * sign * half_thickness])),
            },
        }
    }

    /// Number of parts of a face, which are nearly plane with straight edges: those of an arc are [`WIDEST`] at most.
    pub(super) fn parts(&self, face: usize) -> usize {
        match self {
            Self::Sector { half_angle, .. } if face / 2 != 1 => (2.0 * half_angle / WIDEST).ceil().max(1.0) as usize,
            Self::Brick { .. } | Self::Sector { .. } => 1,
        }
    }

    /// A part of a face of the cell of the particle at `site`; the cell reaches to the ends of the body on its
    /// `exposed` sides.
    pub(super) fn face(
        &self,
        site: [f64; 3],
        (face, part): (usize, usize),
        exposed: [bool; FACES],
        dimensions: Dimensions,
    ) -> CellFace {
        let (axis, side) = (face / 2, face % 2);
        let sign = if side == 0 { -1.0 } else { 1.0 };
        match self {
            Self::Brick { frame, pitch, ends } => {
                let reach = |a: usize, side: usize| {
                    let to_end = ends[a][side].filter(|_| exposed[2 * a + side]);
                    (if side == 0 { -1.0 } else { 1.0 }) * to_end.unwrap_or(0.5 * pitch[a])
                };
                let count = dimensions.count();
                let place = |at: [Option<usize>; 3]| {
                    let by = std::array::from_fn(|a| match at[a] {
                        _ if a >= count => 0.0,
                        Some(side) => reach(a, side),
                        None => 0.5 * (reach(a, 0) + reach(a, 1)),
                    });
                    combine(site, frame, by)
                };
                let corner =
                    |at: [usize; 3]| place(std::array::from_fn(|a| Some(if a == axis { side } else { at[a] })));
                let corners = around(axis, dimensions).into_iter().map(corner).collect();
                let middle = place(std::array::from_fn(|a| (a == axis).then_some(side)));
                CellFace { number: face as u8, corners, middle, outward: frame[axis].map(|c| sign * c) }
            }
            Self::Sector { centre, frame, radii, half_angle, half_thickness, .. } => {
                let count = dimensions.count();
                let width = 2.0 * half_angle / self.parts(face) as f64;
                let start = width * part as f64 - half_angle;
                // Straight edges are as far from the axis as makes a part of a slice as large as it is.
                let farther = if axis == 2 { (width / width.sin()).sqrt() } else { 1.0 };
                let place = |r: f64, angle: f64, z: f64| {
                    let (sin, cos) = angle.sin_cos();
                    combine(*centre, frame, [r * cos, r * sin, if count == 3 { z } else { 0.0 }])
                };
                let (angles, heights) = ([start, start + width], [-half_thickness, *half_thickness]);
                let corner = |at: [usize; 3]| {
                    let of = |a: usize| if a == axis { side } else { at[a] };
                    place(farther * radii[of(0)], angles[of(1)], heights[of(2)])
                };
                let corners = around(axis, dimensions).into_iter().map(corner).collect();
                let middle_radius = 0.5 * (radii[0] + radii[1]);
                let angle = start + 0.5 * width;
                let (middle, outward) = match axis {
                    0 => {
                        let (sin, cos) = angle.sin_cos();
                        let outward = combine([0.0; 3], frame, [sign * cos, sign * sin, 0.0]);
                        (place(radii[side], angle, 0.0), outward)
                    }
                    1 => {
                        let (sin, cos) = angles[side].sin_cos();
                        let outward = combine([0.0; 3], frame, [-sign * sin, sign * cos, 0.0]);
                        (place(middle_radius, angles[side], 0.0), outward)
                    }
                    _ => (place(middle_radius, angle, heights[side]), frame[2].map(|c| sign * c)),
                };
                CellFace { number: face as u8, corners, middle, outward }
            }
        }
    }
}
