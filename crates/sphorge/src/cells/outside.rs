//! The faces of cells in space that are seen from outside in a frame.

use super::{JoinedCells, Nodes, face_corners};

/// A face of a cell, or a triangle that fills a sliver beside one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OutsideFace {
    /// Number of the particle.
    pub(crate) cell: u32,
    /// Nodes of its corners, in order around it; of a filler the last one twice.
    pub(crate) nodes: [u32; 4],
    /// Number of the face of the cell: the one that a filler is beside.
    pub(crate) face: u8,
    pub(crate) is_filler: bool,
    /// Planes of symmetry in which it lies, one bit each.
    pub(crate) held: u8,
}

/// What is outside of the cells that are kept.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outside {
    pub(crate) faces: Vec<OutsideFace>,
    /// Which faces of each cell are outside, one bit each.
    pub(crate) sides: Vec<u8>,
    /// The node of each corner of each cell.
    pub(crate) of: Vec<u32>,
}

impl JoinedCells {
    /// Faces across which nobody that is kept is joined, in the order of cells.
    pub(crate) fn outside(&self, nodes: &Nodes, is_kept: impl Fn(usize) -> bool) -> Outside {
        if self.corners != 8 || nodes.places.is_empty() {
            return Outside::default();
        }
        let mut of = self.of.clone();
        let mut sides = vec![0u8; self.count];
        for face in &self.surface {
            sides[*face as usize / 6] |= 1 << (face % 6);
        }
        for [at, node] in &nodes.parted {
            of[*at as usize] = *node;
            let (cell, corner) = (*at as usize / 8, *at as usize % 8);
            (0..3).for_each(|axis| sides[cell] |= 1 << (2 * axis + (corner >> axis & 1)));
        }
        let kept: Vec<bool> = (0..self.count).map(is_kept).collect();
        if kept.contains(&false) {
            // Who is left out uncovers the faces that have a node of his.
            let is_bare = |node: usize| self.members(node).iter().any(|member| !kept[member.cell as usize]);
            let bare: Vec<bool> = (0..self.nodes()).map(is_bare).collect();
            for (cell, sides) in sides.iter_mut().enumerate() {
                let touches = |k: usize| bare[self.of[8 * cell + k] as usize];
                (0..6).filter(|face| face_corners(*face).into_iter().any(touches)).for_each(|face| *sides |= 1 << face);
                *sides *= u8::from(kept[cell]);
            }
        }
        let at_start = |cell: usize, face: usize| face_corners(face).map(|k| self.of[8 * cell + k] as usize);
        // Planes in which a node is and was at the start: debris leaves them.
        let held = |start: usize, now: u32| {
            let is_there = |(k, (axis, at)): &(usize, &(usize, f64))| {
                self.held[start] >> k & 1 == 1 && nodes.places[now as usize][*axis] == *at
            };
            self.planes.iter().enumerate().filter(is_there).fold(0u8, |bits, (k, _)| bits | 1 << k)
        };
        let mut faces = Vec::new();
        for (cell, sides) in sides.iter().enumerate() {
            for face in (0..6).filter(|face| sides >> face & 1 == 1) {
                let nodes = face_corners(face).map(|k| of[8 * cell + k]);
                let held = at_start(cell, face).into_iter().zip(nodes).fold(u8::MAX, |bits, (a, b)| bits & held(a, b));
                faces.push(OutsideFace { cell: cell as u32, nodes, face: face as u8, is_filler: false, held });
            }
        }
        let mut torn = nodes.torn.iter().copied().peekable();
        for (number, [face, a, b, c]) in (0u32..).zip(&self.fillers) {
            let (cell, face) = ((face / 6) as usize, (face % 6) as usize);
            let is_whole = torn.next_if_eq(&number).is_none();
            if kept[cell] && is_whole {
                let held = [*a, *b, *c].into_iter().fold(u8::MAX, |bits, node| bits & held(node as usize, node));
                faces.push(OutsideFace {
                    cell: cell as u32,
                    nodes: [*a, *b, *c, *c],
                    face: face as u8,
                    is_filler: true,
                    held,
                });
            }
        }
        Outside { faces, sides, of }
    }
}
