//! Lines and polygons cut off at the edges of a rectangle.

use super::page::Area;

type Point = (f64, f64);
/// Coordinate across an edge, the side that is inside, and where the edge is.
type Edge = (fn(Point) -> f64, f64, f64);

/// The part of a line inside (Liang and Barsky 1984).
pub(super) fn clip_line([from, to]: [Point; 2], area: Area) -> Option<[Point; 2]> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let edges =
        [(-dx, from.0 - area.x), (dx, area.right() - from.0), (-dy, from.1 - area.y), (dy, area.bottom() - from.1)];
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (slope, room) in edges {
        if slope == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            first = first.max(room / slope);
        } else {
            last = last.min(room / slope);
        }
    }
    let at = |share: f64| (from.0 + share * dx, from.1 + share * dy);
    (first <= last).then(|| [at(first), at(last)])
}

/// The part of a convex polygon inside (Sutherland and Hodgman 1974).
pub(super) fn clip_polygon(points: &[Point], area: Area) -> Vec<Point> {
    let edges: [Edge; 4] = [
        (|p| p.0, 1.0, area.x),
        (|p| p.0, -1.0, -area.right()),
        (|p| p.1, 1.0, area.y),
        (|p| p.1, -1.0, -area.bottom()),
    ];
    edges.into_iter().fold(points.to_vec(), |points, (pick, sign, limit)| {
        let room = |p: Point| sign * pick(p) - limit;
        let mut kept = Vec::with_capacity(points.len() + 1);
        for (k, &to) in points.iter().enumerate() {
            let from = points[(k + points.len() - 1) % points.len()];
            if (room(from) < 0.0) != (room(to) < 0.0) {
                let share = room(from) / (room(from) - room(to));
                kept.push((from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1)));
            }
            if room(to) >= 0.0 {
                kept.push(to);
            }
        }
        kept
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Area = Area { x: 0.0, y: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn what_is_outside_is_cut_off() {
        assert_eq!(clip_line([(-5.0, 5.0), (15.0, 5.0)], AREA), Some([(0.0, 5.0), (10.0, 5.0)]));
        assert_eq!(clip_line([(2.0, 2.0), (3.0, 4.0)], AREA), Some([(2.0, 2.0), (3.0, 4.0)]));
        assert_eq!(clip_line([(-5.0, -1.0), (15.0, -1.0)], AREA), None);
        assert_eq!(clip_line([(-5.0, 8.0), (5.0, 18.0)], AREA), None);
        let triangle = [(5.0, 5.0), (25.0, 5.0), (5.0, 25.0)];
        let kept = clip_polygon(&triangle, AREA);
        assert!(kept.len() == 4 && kept.iter().all(|&p| AREA.contains(p)), "{kept:?}");
        assert!(clip_polygon(&[(20.0, 20.0), (30.0, 20.0), (30.0, 30.0)], AREA).is_empty());
    }
}
