//! The cells that particles stand for in pictures, joined where they met at the start.
//!
//! The deformation gradient of a particle is a mean over its surroundings, so that cells which are deformed by their own gradients need not meet: they
//! overlap, or leave gaps. A corner is therefore where the cells that met there at the start put it on average, as long as these predictions are
//! near each other. Where they are not, the material has come apart, and the cells part as well. A particle without integrity holds to nobody, and its cell
//! is drawn undeformed. Still pictures and the viewer draw these cells.

mod across;
mod deformation;
mod fillers;
mod nodes;
mod outside;
mod supported;

pub(crate) use deformation::Deformation;
pub(crate) use nodes::Nodes;
pub(crate) use outside::Outside;

use crate::model::SymmetryPlane;
use across::across;
use std::ops::Range;

/// There is no particle.
pub(crate) const NONE: u32 = u32::MAX;
/// Corners of two cells are one if they are nearer than this share of their distance from the particle.
const SAME: f64 = 0.05;
/// A cell touches a corner of another one that is no farther from its particle than its own corners by this factor.
const TOUCHES: f64 = 1.25;
/// Corners of a face, as numbers of corners in which the bits of both other axes are zero or one: in order around it.
const AROUND: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// A cell that tells where a corner is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Member {
    cell: u32,
    /// Its own corner there; of a cell that only touches the place, [`Self::GUEST`].
    corner: u8,
    /// From the particle to the place at the start, m.
    arm: [f32; 3],
}

impl Member {
    const GUEST: u8 = u8::MAX;
}

/// Cells with corners in common.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct JoinedCells {
    /// Corners of a cell: four in a plane, eight in space.
    pub(crate) corners: usize,
    /// Number of cells.
    pub(crate) count: usize,
    /// The node of each corner of each cell while nothing has come apart.
    pub(crate) of: Vec<u32>,
    /// Faces `6 cell + face` across which nobody is at the start; in a plane none, for there each cell is a face.
    pub(crate) surface: Vec<u32>,
    /// What lies between an edge of a face and the nodes of finer cells along it: the face (or `6 cell` in a plane), and the nodes of a triangle.
    pub(crate) fillers: Vec<[u32; 4]>,
    /// Who is across each face of each cell at the start, or [`NONE`].
    across: Vec<[u32; 6]>,
    members: Vec<Member>,
    /// Where those of each node begin.
    first: Vec<u32>,
    /// Planes of symmetry in which a node is, one bit each.
    held: Vec<u8>,
    planes: Vec<(usize, f64)>,
}

/// Corners of a face of a cell, in order around it.
pub(crate) fn face_corners(face: usize) -> [usize; 4] {
    let (axis, side) = (face / 2, face % 2);
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    AROUND.map(|[on_b, on_c]| side << axis | on_b << b | on_c << c)
}

/// Corners of a face as far as the problem has them: in a plane a face is an edge.
fn corners_of_face(face: usize, corners: usize) -> impl Iterator<Item = usize> {
    face_corners(face).into_iter().filter(move |k| *k < corners)
}

impl JoinedCells {
    /// Of particles at the start, m, with the corners of their cells from there, and the numbers of their bodies. Nothing where these do not fit
    /// together, and on a line.
    pub(crate) fn new(
        start: &[[f64; 3]],
        corners: &[[[f64; 3]; 8]],
        bodies: &[f32],
        dimensions: usize,
        symmetry: &[SymmetryPlane],
    ) -> Self {
        let count = start.len();
        let is_finite = start.iter().flatten().chain(corners.as_flattened().as_flattened()).all(|x| x.is_finite());
        if corners.len() != count || bodies.len() != count || dimensions < 2 || !is_finite || count == 0 {
            return Self::default();
        }
        let each = 1 << dimensions;
        let neighbours = across(start, corners, bodies, dimensions);
        let mut trees: Vec<u32> = (0..(each * count) as u32).collect();
        let place = |i: usize, k: usize| plus(start[i], corners[i][k]);
        for (i, around) in neighbours.iter().enumerate() {
            for (face, &j) in around.iter().enumerate().take(2 * dimensions) {
                // Each pair once, unless the other one has another neighbour there.
                if j == NONE || face % 2 == 0 && neighbours[j as usize].contains(&(i as u32)) {
                    continue;
                }
                for k in corners_of_face(face, each) {
                    let at = place(i, k);
                    let same = SAME * length(corners[i][k]);
                    let other = (0..each).find(|l| length(minus(place(j as usize, *l), at)) < same);
                    if let Some(l) = other {
                        unite(&mut trees, each * i + k, each * j as usize + l);
                    }
                }
            }
        }
        let (of, nodes) = numbered(&mut trees);
        let mut guests = Vec::new();
        let reach = |j: usize| TOUCHES * corners[j][..each].iter().map(|arm| length(*arm)).fold(0.0, f64::max);
        for (i, around) in neighbours.iter().enumerate() {
            for (face, &j) in around.iter().enumerate().take(2 * dimensions) {
                if j == NONE {
                    continue;
                }
                let j = j as usize;
                for k in corners_of_face(face, each) {
                    let node = of[each * i + k];
                    let arm = minus(place(i, k), start[j]);
                    if !of[each * j..each * (j + 1)].contains(&node) && length(arm) < reach(j) {
                        guests.push((node, j as u32, arm.map(|x| x as f32)));
                    }
                }
                // The other way round, too: a cell is across one face of another one, and may be across faces of several.
                for k in 0..each {
                    let node = of[each * j + k];
                    let arm = minus(place(j, k), start[i]);
                    if !of[each * i..each * (i + 1)].contains(&node) && length(arm) < reach(i) {
                        guests.push((node, i as u32, arm.map(|x| x as f32)));
                    }
                }
            }
        }
        guests.sort_unstable_by_key(|(node, cell, _)| (*node, *cell));
        guests.dedup_by_key(|(node, cell, _)| (*node, *cell));
        let mut joined = Self { corners: each, count, of, ..Self::default() };
        joined.join(nodes, corners, &guests);
        joined.planes = symmetry.iter().map(|plane| (plane.axis, plane.position)).take(8).collect();
        joined.hold(start);
        if dimensions == 3 {
            let all = (0..count).flat_map(|cell| (0..6).map(move |face| (cell, face)));
            let open = all.filter(|(cell, face)| neighbours[*cell][*face] == NONE);
            joined.surface = open.map(|(cell, face)| (6 * cell + face) as u32).collect();
        }
        joined.fillers = joined.fillers(start, corners, &guests);
        joined.across = neighbours;
        joined
    }

    /// Number of nodes while nothing has come apart.
    pub(crate) fn nodes(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    fn members(&self, node: usize) -> &[Member] {
        &self.members[self.range(node)]
    }

    fn range(&self, node: usize) -> Range<usize> {
        self.first[node] as usize..self.first[node + 1] as usize
    }

    /// Lists the members of each node.
    fn join(&mut self, nodes: usize, corners: &[[[f64; 3]; 8]], guests: &[(u32, u32, [f32; 3])]) {
        let mut first = vec![0u32; nodes + 1];
        for node in self.of.iter().chain(guests.iter().map(|(node, ..)| node)) {
            first[*node as usize + 1] += 1;
        }
        for node in 0..nodes {
            first[node + 1] += first[node];
        }
        let mut next = first.clone();
        let nobody = Member { cell: NONE, corner: Member::GUEST, arm: [0.0; 3] };
        let mut members = vec![nobody; self.of.len() + guests.len()];
        let mut add = |node: u32, member: Member| {
            members[next[node as usize] as usize] = member;
            next[node as usize] += 1;
        };
        for (at, node) in self.of.iter().enumerate() {
            let (cell, corner) = (at / self.corners, at % self.corners);
            let arm = corners[cell][corner].map(|x| x as f32);
            add(*node, Member { cell: cell as u32, corner: corner as u8, arm });
        }
        for (node, cell, arm) in guests {
            add(*node, Member { cell: *cell, corner: Member::GUEST, arm: *arm });
        }
        (self.first, self.members) = (first, members);
    }

    /// Finds the nodes in planes of symmetry, which stay there.
    fn hold(&mut self, start: &[[f64; 3]]) {
        let held = |node: usize| {
            let Some(member) = self.members(node).first() else { return 0 };
            let arm = member.arm.map(f64::from);
            let (at, same) = (plus(start[member.cell as usize], arm), SAME * length(arm));
            let planes = self.planes.iter().enumerate();
            planes.filter(|(_, (axis, place))| (at[*axis] - place).abs() < same).fold(0, |bits, (k, _)| bits | 1 << k)
        };
        self.held = (0..self.nodes()).map(held).collect();
    }
}

/// The root of a tree, which becomes shorter on the way.
fn root(trees: &mut [u32], mut at: usize) -> usize {
    while trees[at] as usize != at {
        trees[at] = trees[trees[at] as usize];
        at = trees[at] as usize;
    }
    at
}

/// Makes two trees one; the lower number is its root.
fn unite(trees: &mut [u32], a: usize, b: usize) {
    let (a, b) = (root(trees, a), root(trees, b));
    trees[a.max(b)] = a.min(b) as u32;
}

/// Numbers trees in the order of their roots: the number of each member's tree, and how many there are.
fn numbered(trees: &mut [u32]) -> (Vec<u32>, usize) {
    let (mut numbers, mut count) = (vec![0u32; trees.len()], 0);
    for at in 0..trees.len() {
        let root = root(trees, at);
        // A root comes before its members.
        numbers[at] = if root == at {
            count += 1;
            count - 1
        } else {
            numbers[root]
        };
    }
    (numbers, count as usize)
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
pub(crate) mod tests;
