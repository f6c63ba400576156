//! Where the corners of joined cells are in a frame.

use super::{JoinedCells, Member, length, minus, plus};
use rayon::prelude::*;

/// Predictions of a corner that are no farther from each other than this share of its mean distance from both particles are of one corner. In the foot of
/// a bar with five particles across they differ by 0.9 of a spacing.
const HOLDS: f64 = 1.0;

/// The nodes of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Nodes {
    /// Places, m: those of [`JoinedCells::of`], then those of cells that have come apart from others.
    pub(crate) places: Vec<[f64; 3]>,
    /// Corners (in the order of [`JoinedCells::of`]) at which cells have come apart, and their nodes now.
    pub(crate) parted: Vec<[u32; 2]>,
}

/// What the members of a node say.
enum Found {
    One([f64; 3]),
    /// Several places, each with the members that have it.
    Parted(Vec<([f64; 3], Vec<usize>)>),
}

impl JoinedCells {
    /// Where the nodes are when particles are at places, m, with deformation gradients, nine numbers each. Nothing where these are not of all cells.
    pub(crate) fn at(&self, now: &[[f64; 3]], gradient: &[f32]) -> Nodes {
        if self.count == 0 || now.len() != self.count || gradient.len() != 9 * self.count {
            return Nodes::default();
        }
        let found: Vec<Found> = (0..self.nodes()).into_par_iter().map(|node| self.find(node, now, gradient)).collect();
        let mut nodes = Nodes { places: Vec::with_capacity(found.len()), parted: Vec::new() };
        let mut others = Vec::new();
        for (node, found) in found.into_iter().enumerate() {
            let parts = match found {
                Found::One(place) => {
                    nodes.places.push(place);
                    continue;
                }
                Found::Parted(parts) => parts,
            };
            for (k, (place, members)) in parts.into_iter().enumerate() {
                let number = if k == 0 {
                    nodes.places.push(place);
                    node
                } else {
                    others.push(place);
                    self.nodes() + others.len() - 1
                };
                let corners = members.into_iter().map(|m| self.members(node)[m]);
                let own = corners.filter(|member| member.corner != Member::GUEST);
                nodes.parted.extend(
                    own.map(|member| [member.cell * self.corners as u32 + u32::from(member.corner), number as u32]),
                );
            }
        }
        nodes.places.extend(others);
        nodes
    }

    fn find(&self, node: usize, now: &[[f64; 3]], gradient: &[f32]) -> Found {
        let members = self.members(node);
        let arms: Vec<[f64; 3]> = members.iter().map(|member| deformed(member, gradient)).collect();
        let places: Vec<[f64; 3]> =
            members.iter().zip(&arms).map(|(member, arm)| plus(now[member.cell as usize], *arm)).collect();
        // What is not finite holds to nothing.
        let hold = |a: usize, b: usize| {
            length(minus(places[a], places[b])) <= 0.5 * HOLDS * (length(arms[a]) + length(arms[b]))
        };
        let mut part: Vec<usize> = (0..members.len()).collect();
        for a in 0..members.len() {
            for b in 0..a {
                if part[a] != part[b] && hold(a, b) {
                    let (from, to) = (part[a].max(part[b]), part[a].min(part[b]));
                    part.iter_mut().filter(|part| **part == from).for_each(|part| *part = to);
                }
            }
        }
        let mean = |of: &[usize]| {
            let sum = of.iter().fold([0.0; 3], |sum, k| plus(sum, places[*k]));
            let mut mean = sum.map(|x| x / of.len() as f64);
            for (k, (axis, place)) in self.planes.iter().enumerate() {
                if self.held[node] >> k & 1 == 1 && mean[*axis].is_finite() {
                    mean[*axis] = *place;
                }
            }
            mean
        };
        let is_own = |k: &usize| members[*k].corner != Member::GUEST;
        let parts: Vec<Vec<usize>> = (0..members.len())
            .map(|first| (0..members.len()).filter(|k| part[*k] == first).collect::<Vec<_>>())
            .filter(|of| of.iter().any(is_own))
            .collect();
        match &parts[..] {
            [whole] => Found::One(mean(whole)),
            _ => Found::Parted(parts.into_iter().map(|of| (mean(&of), of)).collect()),
        }
    }

    /// Corners of all cells from their particles, m: in space all eight, in a plane both of an edge where bit 2 tells apart.
    pub(crate) fn corners(&self, now: &[[f64; 3]], nodes: &Nodes) -> Vec<[[f32; 3]; 8]> {
        if nodes.places.is_empty() {
            return Vec::new();
        }
        let mut of = self.of.clone();
        for [corner, node] in &nodes.parted {
            of[*corner as usize] = *node;
        }
        let corner = |cell: usize, k: usize| {
            let place = nodes.places[of[self.corners * cell + k % self.corners] as usize];
            minus(place, now[cell]).map(|x| x as f32)
        };
        (0..self.count).into_par_iter().map(|cell| std::array::from_fn(|k| corner(cell, k))).collect()
    }
}

/// From the particle to the corner now, m.
fn deformed(member: &Member, gradient: &[f32]) -> [f64; 3] {
    let f = &gradient[9 * member.cell as usize..][..9];
    std::array::from_fn(|a| (0..3).map(|b| f64::from(f[3 * a + b]) * f64::from(member.arm[b])).sum())
}
