//! Cells and their corners, as the page gets them: which corners cells have in common once, where these are for each frame.

use super::array::Array;
use crate::cells::{JoinedCells, Nodes};

/// The corners of cells in a frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FrameNodes {
    /// Places from the origin of the run, m.
    pub(super) places: Array,
    /// Corners at which cells have come apart, and their nodes.
    parted: Vec<[u32; 2]>,
    /// Numbers of the fillers that have come apart.
    torn: Vec<u32>,
}

impl FrameNodes {
    pub(super) fn new(nodes: Nodes, origin: [f64; 3]) -> Self {
        Self { places: Array::of_positions(&nodes.places, origin), parted: nodes.parted, torn: nodes.torn }
    }

    /// Corners and nodes of what has come apart, little-endian.
    pub(super) fn parted_bytes(&self) -> Vec<u8> {
        self.parted.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    /// Fillers that have come apart, little-endian.
    pub(super) fn torn_bytes(&self) -> Vec<u8> {
        self.torn.iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    /// Numbers of places, of corners and of fillers that have come apart, then all three: whole numbers of 32 bits and numbers of single precision,
    /// little-endian.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let places = &self.places.values;
        let mut bytes = Vec::with_capacity(12 + 4 * places.len() + 8 * self.parted.len() + 4 * self.torn.len());
        bytes.extend((places.len() as u32 / 3).to_le_bytes());
        bytes.extend((self.parted.len() as u32).to_le_bytes());
        bytes.extend((self.torn.len() as u32).to_le_bytes());
        bytes.extend(places.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend(self.parted_bytes());
        bytes.extend(self.torn_bytes());
        bytes
    }
}

/// Numbers of cells, corners of each, faces and fillers; then the nodes of the corners, the faces, and the fillers: whole numbers of 32 bits,
/// little-endian.
pub(super) fn cell_bytes(cells: &JoinedCells) -> Vec<u8> {
    let counts = [cells.count, cells.corners, cells.surface.len(), cells.fillers.len()].map(|count| count as u32);
    let numbers = counts.iter().chain(&cells.of).chain(&cells.surface).chain(cells.fillers.as_flattened());
    numbers.flat_map(|number| number.to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_and_cells_are_told_with_their_numbers() {
        let nodes = Nodes { places: vec![[1.0, 2.0, 3.0], [1.5, 2.0, 3.0]], parted: vec![[7, 1]], torn: vec![3] };
        let bytes = FrameNodes::new(nodes, [1.0, 2.0, 2.0]).bytes();
        let whole = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!((bytes.len(), whole(0), whole(4), whole(8)), (48, 2, 1, 1));
        assert_eq!((whole(36), whole(40), whole(44)), (7, 1, 3));
        assert_eq!(bytes[24..28], 0.5f32.to_le_bytes());
        let square = std::array::from_fn(|k: usize| [(k & 1) as f64 - 0.5, (k >> 1 & 1) as f64 - 0.5, 0.0]);
        let mut cells = JoinedCells::new(&[[0.0; 3]], &[square], &[0.0], 2, &[]);
        (cells.surface, cells.fillers) = (vec![5], vec![[0, 1, 2, 3]]);
        let told: Vec<u32> =
            cell_bytes(&cells).chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!(told, [1, 4, 1, 1, 0, 1, 2, 3, 5, 0, 1, 2, 3]);
    }
}
