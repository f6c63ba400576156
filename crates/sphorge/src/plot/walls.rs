//! Rigid walls of the deck, where they stand at the time of a frame.

use super::{
    clip::{clip_line, clip_polygon},
    color::Rgb,
    page::{Area, Page},
    view::Projection,
};
use crate::model::{Model, Wall, WallSurface};

const EDGE: Rgb = [70, 78, 90];
const FACE: Rgb = [232, 234, 238];
/// Length of hatches, from one to the next.
const HATCH: f64 = 8.0;
/// Part of the normal towards the eye below which a wall is seen from its edge.
const EDGEWISE: f64 = 0.02;
/// How far the drawn part of a wall goes beyond the particles, as a share of their extent.
const BEYOND: f64 = 0.12;

/// A wall in a picture, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PlacedWall {
    /// Seen from its edge: a point, and the direction to the material, right and up.
    Line {
        point: [f64; 2],
        normal: [f64; 2],
    },
    /// Seen from one side; filled if that is where material is, which then is before it.
    Face {
        corners: [[f64; 2]; 4],
        filled: bool,
    },
    Segment {
        from: [f64; 2],
        to: [f64; 2],
    },
}

/// Lowest and highest place of particles, by axis, m.
pub(super) type Bounds = [(f64, f64); 3];

/// The walls of a model at a time (s), as far as they are near the particles.
pub(super) fn walls(model: &Model, time: f64, projection: &Projection, bounds: &Bounds) -> Vec<PlacedWall> {
    model.walls.iter().filter_map(|wall| place(wall, time, projection, bounds)).collect()
}

fn place(wall: &Wall, time: f64, projection: &Projection, bounds: &Bounds) -> Option<PlacedWall> {
    let moved = |point: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|axis| point[axis] + wall.velocity[axis].integral(0.0, time.max(0.0)))
    };
    let flat = |point: [f64; 3]| -> [f64; 2] {
        let [right, up, _] = projection.apply(point);
        [right, up]
    };
    match wall.surface {
        WallSurface::Segment { from, to } => Some(PlacedWall::Segment { from: flat(moved(from)), to: flat(moved(to)) }),
        WallSurface::Plane { point, normal } => {
            let point = moved(point);
            let [right, up, towards] = projection.apply(normal);
            let edgewise = towards.abs() < EDGEWISE;
            let line = PlacedWall::Line { point: flat(point), normal: [right, up] };
            Some(if edgewise { line } else { face(point, normal, projection, bounds, towards > 0.0)? })
        }
    }
}

/// The part of a plane behind or before the particles.
fn face(
    point: [f64; 3],
    normal: [f64; 3],
    projection: &Projection,
    bounds: &Bounds,
    filled: bool,
) -> Option<PlacedWall> {
    let corners: Vec<[f64; 3]> = (0..8)
        .map(|k| std::array::from_fn(|axis| if k >> axis & 1 == 0 { bounds[axis].0 } else { bounds[axis].1 }))
        .collect();
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let largest = bounds.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    // Material that has not reached the wall yet, or has left it for good, is pictured without.
    let nearest = corners.iter().map(|corner| dot(*corner, normal) - dot(point, normal)).fold(f64::INFINITY, f64::min);
    if nearest > largest {
        return None;
    }
    // Along the axes where the wall is across one of them.
    let axis = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    let mut first: [f64; 3] = std::array::from_fn(|k| f64::from(u8::from(k == axis)) - normal[axis] * normal[k]);
    let length = dot(first, first).sqrt();
    first = first.map(|x| x / length);
    let second: [f64; 3] = std::array::from_fn(|k| {
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        normal[a] * first[b] - normal[b] * first[a]
    });
    let span = |direction: [f64; 3]| {
        let along = corners.iter().map(|corner| dot(*corner, direction));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        (low - BEYOND * largest, high + BEYOND * largest)
    };
    let ((a, b), (c, d)) = (span(first), span(second));
    let at = |u: f64, v: f64| {
        let height = dot(point, normal);
        let place: [f64; 3] = std::array::from_fn(|k| u * first[k] + v * second[k] + height * normal[k]);
        let [right, up, _] = projection.apply(place);
        [right, up]
    };
    Some(PlacedWall::Face { corners: [at(a, c), at(b, c), at(b, d), at(a, d)], filled })
}

impl PlacedWall {
    /// Places a picture of the `window` of particles has to show too, right and up, m: the wall as far as it is near.
    pub(super) fn reach(&self, window: [(f64, f64); 2]) -> Vec<[f64; 2]> {
        let size = window.map(|(low, high)| high - low);
        let largest = size[0].max(size[1]);
        let near = |by: f64, point: &[f64; 2]| -> [f64; 2] {
            std::array::from_fn(|k| point[k].clamp(window[k].0 - by * largest, window[k].1 + by * largest))
        };
        match self {
            Self::Face { corners, .. } => corners.iter().map(|point| near(1.0, point)).collect(),
            Self::Segment { from, to } => vec![near(0.5, from), near(0.5, to)],
            Self::Line { point, normal } => {
                let middle = [0, 1].map(|k| 0.5 * (window[k].0 + window[k].1));
                let distance: f64 = (0..2).map(|k| (point[k] - middle[k]) * normal[k]).sum();
                let foot = [0, 1].map(|k| middle[k] + distance * normal[k]);
                let reached = (0..2).all(|k| (foot[k] - middle[k]).abs() < 0.5 * size[k] + 0.25 * largest);
                if reached { vec![foot] } else { Vec::new() }
            }
        }
    }

    /// Where it crosses the axis to the right, if it is across it, m.
    pub(super) fn across(&self) -> Option<f64> {
        match *self {
            Self::Line { point: [x, _], normal: [_, up] } if up.abs() < EDGEWISE => Some(x),
            Self::Line { .. } | Self::Face { .. } | Self::Segment { .. } => None,
        }
    }

    /// Whether it is drawn before the particles.
    pub(super) fn is_behind(&self) -> bool {
        matches!(self, Self::Face { filled: true, .. })
    }

    /// Draws the wall inside an area of the page; `place` puts a point on it.
    pub(super) fn draw(&self, page: &mut Page, area: Area, place: impl Fn([f64; 2]) -> (f64, f64)) {
        match *self {
            Self::Face { corners, filled } => {
                let corners = corners.map(&place);
                if filled {
                    let face = clip_polygon(&corners, area);
                    if face.len() > 2 {
                        page.polygon(face, FACE);
                    }
                }
                for k in 0..4 {
                    if let Some([from, to]) = clip_line([corners[k], corners[(k + 1) % 4]], area) {
                        page.line(from, to, 1.2, EDGE);
                    }
                }
            }
            Self::Segment { from, to } => {
                if let Some([from, to]) = clip_line([place(from), place(to)], area) {
                    page.line(from, to, 3.0, EDGE);
                }
            }
            Self::Line { point, normal } => {
                let (x, y) = place(point);
                let along = (normal[1], normal[0]);
                // Long enough from any point of the wall across the whole page.
                let reach = 2.0 * (page.width + page.height) + (x - area.x).abs() + (y - area.y).abs();
                let ends = [-reach, reach].map(|t| (x + t * along.0, y + t * along.1));
                let Some([from, to]) = clip_line(ends, area) else { return };
                page.line(from, to, 2.5, EDGE);
                let length = (to.0 - from.0).hypot(to.1 - from.1);
                // Hatches lean back from the material.
                let back = (-normal[0] + 0.8 * along.0, normal[1] + 0.8 * along.1);
                for k in 0..(length / HATCH) as usize {
                    let share = (k as f64 + 0.5) * HATCH / length;
                    let foot = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
                    let head = (foot.0 + HATCH * back.0, foot.1 + HATCH * back.1);
                    if let Some([from, to]) = clip_line([foot, head], area) {
                        page.line(from, to, 1.0, EDGE);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::{TimeTable, WallContact},
        plot::{View, page::Item, paper::Paper},
    };

    fn wall(surface: WallSurface, velocity: f64) -> Wall {
        Wall {
            name: "w".into(),
            surface,
            velocity: [0.0, velocity, 0.0].map(TimeTable::constant),
            contact: WallContact::MonaghanKos { range: 1.0 },
        }
    }

    const BOUNDS: Bounds = [(0.0, 4.0), (1.0, 3.0), (0.0, 2.0)];

    #[test]
    fn walls_stand_where_they_are_at_the_time_of_the_frame() {
        let projection = View::Xy.projection();
        let plane = |normal| WallSurface::Plane { point: [7.0, 0.0, 0.0], normal };
        let placed = place(&wall(plane([0.0, 1.0, 0.0]), -3.0), 2.0, &projection, &BOUNDS).unwrap();
        assert_eq!(placed, PlacedWall::Line { point: [7.0, -6.0], normal: [0.0, 1.0] });
        let segment = WallSurface::Segment { from: [0.0, 0.0, 0.0], to: [1.0, 0.0, 0.0] };
        let placed = place(&wall(segment, 2.0), 0.5, &projection, &BOUNDS).unwrap();
        assert_eq!(placed, PlacedWall::Segment { from: [0.0, 1.0], to: [1.0, 1.0] });
        // From the front, the wall behind the particles goes 12 % of their largest extent beyond them.
        let placed = place(&wall(plane([0.0, 0.0, 1.0]), 0.0), 0.0, &projection, &BOUNDS).unwrap();
        let PlacedWall::Face { corners, filled: true } = placed else { panic!("{placed:?}") };
        let along = |k: usize| {
            corners.map(|corner| corner[k]).into_iter().fold((9.0f64, -9.0f64), |(l, h), x| (l.min(x), h.max(x)))
        };
        assert!((along(0).0 + 0.48).abs() < 1e-12 && (along(0).1 - 4.48).abs() < 1e-12);
        assert!((along(1).0 - 0.52).abs() < 1e-12 && (along(1).1 - 3.48).abs() < 1e-12);
        let behind = place(&wall(plane([0.0, 0.0, -1.0]), 0.0), 0.0, &projection, &BOUNDS).unwrap();
        assert!(!behind.is_behind() && placed.is_behind());
    }

    #[test]
    fn a_picture_shows_walls_that_are_near_and_draws_nothing_outside_of_its_area() {
        let window = [(0.0, 4.0), (1.0, 3.0)];
        let line = |y: f64| PlacedWall::Line { point: [100.0, y], normal: [0.0, 1.0] };
        assert_eq!(line(0.5).reach(window), [[2.0, 0.5]]);
        assert!(line(-5.0).reach(window).is_empty());
        let far = PlacedWall::Segment { from: [2.0, 2.0], to: [50.0, 2.0] };
        assert_eq!(far.reach(window), [[2.0, 2.0], [6.0, 2.0]]);
        let area = Area { x: 10.0, y: 10.0, width: 40.0, height: 20.0 };
        for wall in [line(1.2), far] {
            let mut page = Page::new(100.0, 100.0, Paper::default()).unwrap();
            wall.draw(&mut page, area, |[x, y]| (10.0 + 10.0 * x, 40.0 - 10.0 * y));
            assert!(!page.items.is_empty());
            for item in &page.items {
                let Item::Line { points, .. } = item else { panic!("{item:?}") };
                assert!(points.iter().all(|&point| area.contains(point)), "{points:?}");
            }
        }
        // Hatches are on the side without material: below.
        let mut page = Page::new(100.0, 100.0, Paper::default()).unwrap();
        line(1.5).draw(&mut page, area, |[x, y]| (10.0 + 10.0 * x, 40.0 - 10.0 * y));
        let lowest = page.items.iter().flat_map(|item| match item {
            Item::Line { points, .. } => points.clone(),
            _ => Vec::new(),
        });
        assert!(lowest.clone().all(|(_, y)| y >= 25.0) && lowest.clone().any(|(_, y)| y > 28.0));
    }
}
