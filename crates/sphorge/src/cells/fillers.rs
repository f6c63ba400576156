//! Between an edge of a cell and the finer cells along it, as between two rings, there is a sliver: the nodes of the finer ones are not on the edge.

use super::{JoinedCells, face_corners, length, minus, plus};
use std::collections::HashSet;

/// A node belongs to an edge from which it is no farther than this share of its length.
const NEAR: f64 = 0.35;

impl JoinedCells {
    /// Triangles between edges of drawn faces and the nodes that other cells have along them.
    pub(super) fn fillers(
        &self,
        start: &[[f64; 3]],
        corners: &[[[f64; 3]; 8]],
        guests: &[(u32, u32, [f32; 3])],
    ) -> Vec<[u32; 4]> {
        let surface: HashSet<u32> = self.surface.iter().copied().collect();
        // Face, ends of the edge, place along it, node.
        let mut along: Vec<(u32, [u32; 2], f64, u32)> = Vec::new();
        for (node, cell, arm) in guests {
            let (i, at) = (*cell as usize, plus(start[*cell as usize], arm.map(f64::from)));
            let nearest = edges(self.corners).map(|(a, b)| {
                let (from, to) = (plus(start[i], corners[i][a]), plus(start[i], corners[i][b]));
                let (way, off) = (minus(to, from), minus(at, from));
                let share = dot(way, off) / dot(way, way).max(f64::MIN_POSITIVE);
                let foot: [f64; 3] = std::array::from_fn(|k| from[k] + share * way[k]);
                (length(minus(at, foot)) / length(way).max(f64::MIN_POSITIVE), share, a, b)
            });
            let Some((off, share, a, b)) = nearest.min_by(|p, q| p.0.total_cmp(&q.0)) else { continue };
            if off > NEAR || !(0.01..0.99).contains(&share) {
                continue;
            }
            let ends = [a, b].map(|k| self.of[self.corners * i + k]);
            let faces = (0..6).filter(|face| face_corners(*face).contains(&a) && face_corners(*face).contains(&b));
            for face in faces {
                let face = (6 * i + face) as u32;
                if self.corners == 8 && surface.contains(&face) {
                    along.push((face, ends, share, *node));
                }
            }
            if self.corners == 4 {
                along.push(((6 * i) as u32, ends, share, *node));
            }
        }
        along.sort_by(|p, q| (p.0, p.1).cmp(&(q.0, q.1)).then(p.2.total_cmp(&q.2)));
        let mut fillers = Vec::new();
        for edge in along.chunk_by(|p, q| (p.0, p.1) == (q.0, q.1)) {
            let (face, [from, to], ..) = edge[0];
            let nodes: Vec<u32> = edge.iter().map(|(.., node)| *node).chain([to]).collect();
            fillers.extend(nodes.windows(2).map(|pair| [face, from, pair[0], pair[1]]));
        }
        fillers
    }
}

/// Edges of a cell: corners that differ in one bit.
fn edges(corners: usize) -> impl Iterator<Item = (usize, usize)> {
    let axes = corners.ilog2() as usize;
    (0..axes).flat_map(move |axis| (0..corners).filter(move |k| k >> axis & 1 == 0).map(move |k| (k, k | 1 << axis)))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}
