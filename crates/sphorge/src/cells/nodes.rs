//! Where the corners of joined cells are in a frame.

use super::{Deformation, JoinedCells, Member, length, minus, plus};
use rayon::prelude::*;
use std::collections::HashSet;

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
    /// Numbers of the fillers that have come apart.
    pub(crate) torn: Vec<u32>,
}

/// What the members of a node say.
enum Found {
    One([f64; 3]),
    /// One or several places of cells that have a corner there, each with the members that have it.
    Parted(Vec<([f64; 3], Vec<usize>)>),
}

impl JoinedCells {
    /// Where the nodes are when particles are at places, m, and deformed. Nothing where these are not of all cells.
    pub(crate) fn at(&self, now: &[[f64; 3]], deformation: &Deformation) -> Nodes {
        if self.count == 0 || now.len() != self.count || deformation.gradient.len() != 9 * self.count {
            return Nodes::default();
        }
        let drawn = self.supported(now, deformation);
        let found: Vec<Found> = (0..self.nodes()).into_par_iter().map(|node| self.find(node, now, &drawn)).collect();
        let mut nodes = Nodes { places: Vec::with_capacity(found.len()), ..Nodes::default() };
        let mut others = Vec::new();
        // Nodes that are no longer those of some cells there, with these cells.
        let mut strangers = HashSet::new();
        for (node, found) in found.into_iter().enumerate() {
            let parts = match found {
                Found::One(place) => {
                    nodes.places.push(place);
                    continue;
                }
                Found::Parted(parts) => parts,
            };
            let members = self.members(node);
            let stays = |cell: u32| parts[0].1.iter().any(|m| members[*m].cell == cell);
            strangers.extend(members.iter().filter(|m| !stays(m.cell)).map(|m| (node as u32, m.cell)));
            if let [(place, _)] = parts[..] {
                nodes.places.push(place);
                continue;
            }
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
        let is_torn = |[face, of @ ..]: &[u32; 4]| {
            let cell = face / 6;
            let mut strange = of.iter().filter(|node| strangers.contains(&(**node, cell))).peekable();
            strange.peek().is_some()
                && (strange.any(|node| self.is_of_debris(*node, &drawn))
                    || self.is_beyond(cell, of.map(|node| nodes.places[node as usize]), &drawn))
        };
        nodes.torn = (0u32..).zip(&self.fillers).filter(|(_, filler)| is_torn(filler)).map(|(k, _)| k).collect();
        nodes
    }

    /// Whether a severed cell tells where a node is.
    fn is_of_debris(&self, node: u32, deformation: &Deformation) -> bool {
        self.members(node as usize).iter().any(|member| deformation.is_severed(member.cell))
    }

    /// Whether places are farther apart than corners of a cell are.
    fn is_beyond(&self, cell: u32, places: [[f64; 3]; 3], deformation: &Deformation) -> bool {
        let own = &self.of[self.corners * cell as usize..][..self.corners];
        let members = own.iter().flat_map(|node| self.members(*node as usize)).filter(|member| member.cell == cell);
        let longest = members.map(|member| length(deformed(member, deformation))).fold(0.0, f64::max);
        [0, 1, 2].iter().any(|k| length(minus(places[(k + 1) % 3], places[*k])) > 2.0 * longest)
    }

    fn find(&self, node: usize, now: &[[f64; 3]], deformation: &Deformation) -> Found {
        let members = self.members(node);
        let arms: Vec<[f64; 3]> = members.iter().map(|member| deformed(member, deformation)).collect();
        let places: Vec<[f64; 3]> =
            members.iter().zip(&arms).map(|(member, arm)| plus(now[member.cell as usize], *arm)).collect();
        let is_severed = |k: usize| deformation.is_severed(members[k].cell);
        // What is not finite holds to nothing.
        let hold = |a: usize, b: usize| {
            length(minus(places[a], places[b])) <= 0.5 * HOLDS * (length(arms[a]) + length(arms[b]))
                && !is_severed(a)
                && !is_severed(b)
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
            if of.iter().any(|k| is_severed(*k)) {
                return mean;
            }
            // In a plane of symmetry cells hold to their images, as far as these are as near as others would have to be.
            let longest = of.iter().map(|k| length(arms[*k])).fold(0.0, f64::max);
            for (k, (axis, place)) in self.planes.iter().enumerate() {
                if self.held[node] >> k & 1 == 1 && (mean[*axis] - place).abs() <= HOLDS * longest {
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
            [whole] if whole.len() == members.len() => Found::One(mean(whole)),
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
fn deformed(member: &Member, deformation: &Deformation) -> [f64; 3] {
    deformation.of(member.cell).map(|row| (0..3).map(|b| row[b] * f64::from(member.arm[b])).sum())
}
