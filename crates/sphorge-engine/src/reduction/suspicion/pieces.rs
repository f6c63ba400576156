//! Bodies that have come apart.

use crate::model::Model;
use crate::neighbors::CellGrid;
use crate::particles::Particles;

/// No particle.
const NONE: u32 = u32::MAX;

/// What hangs together. The particle of a piece with the lowest place stands for it.
pub(super) struct Pieces {
    piece: Vec<u32>,
    /// Particles of a piece, at the place of the one that stands for it.
    sizes: Vec<u32>,
    /// Largest piece of each body.
    largest: Vec<u32>,
}

impl Pieces {
    pub(super) fn find(model: &Model, p: &Particles, is_whole: &impl Fn(usize) -> bool) -> Self {
        let support = model.numerics.kernel.support();
        let reach = support * p.smoothing_length.iter().copied().fold(0.0, f64::max);
        // What hangs together in the configuration the sums are taken in.
        let position = if p.reference_position.is_empty() { &p.position } else { &p.reference_position };
        let mut pieces = Self {
            piece: (0..p.len() as u32).collect(),
            sizes: vec![0; p.len()],
            largest: vec![NONE; model.bodies.len()],
        };
        let any = (0..p.len()).any(is_whole);
        if any && reach > 0.0 && reach.is_finite() {
            let mut grid = CellGrid::default();
            grid.sort(position, reach);
            let within = |i: usize, j: usize| {
                let h = p.smoothing_length[i].max(p.smoothing_length[j]);
                (0..3).map(|a| (position[i][a] - position[j][a]).powi(2)).sum::<f64>() < (support * h).powi(2)
            };
            // The fewest pieces there can be, one of each body that may not come apart: where one neighbour of each row of cells has
            // joined all to as few, none of the others needs to be looked at.
            let whole = || (0..p.len()).filter(|&i| is_whole(i));
            let fewest = (0..model.bodies.len() as u32).filter(|body| whole().any(|i| p.body[i] == *body)).count();
            let mut count = whole().count();
            'search: for only_first in [true, false] {
                for i in whole() {
                    for (begin, end) in grid.runs_around(&position[i]) {
                        // Each pair once.
                        let before = grid.order()[begin..end].iter().map(|&j| j as usize);
                        for j in before.filter(|&j| j < i && p.body[j] == p.body[i]) {
                            let (a, b) = (pieces.root(i), pieces.root(j));
                            // Most are together already.
                            if a != b {
                                if !within(i, j) {
                                    continue;
                                }
                                pieces.piece[a.max(b)] = a.min(b) as u32;
                                count -= 1;
                                if count == fewest {
                                    break 'search;
                                }
                            }
                            if only_first {
                                break;
                            }
                        }
                    }
                }
            }
        }
        for i in 0..p.len() {
            let root = pieces.root(i);
            pieces.piece[i] = root as u32;
            pieces.sizes[root] += 1;
        }
        for root in 0..p.len() {
            let Some(largest) = pieces.largest.get_mut(p.body[root] as usize) else { continue };
            // Of equals the one that holds the particle with the lowest place.
            if *largest == NONE || pieces.sizes[root] > pieces.sizes[*largest as usize] {
                *largest = root as u32;
            }
        }
        pieces
    }

    /// Who stands for the piece of a particle; the way there is halved.
    fn root(&mut self, mut i: usize) -> usize {
        while self.piece[i] as usize != i {
            self.piece[i] = self.piece[self.piece[i] as usize];
            i = self.piece[i] as usize;
        }
        i
    }

    pub(super) fn size_of(&self, i: usize) -> u32 {
        self.sizes[self.piece[i] as usize]
    }

    pub(super) fn is_largest(&self, i: usize, p: &Particles) -> bool {
        self.largest.get(p.body[i] as usize).is_none_or(|&largest| largest == self.piece[i])
    }
}
