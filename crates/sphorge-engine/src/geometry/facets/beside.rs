//! Which cells lie beside each other at the surface of a body, so that their facets share edges.

use super::{CellFacet, FACES, Space, Vector, dot};
use sphorge_physics::Tensor;
use sphorge_physics::facet::OnSides;
use std::collections::HashMap;

/// Distance from where the next particle is expected within which it is there, in spacings: that of lattices, and along rings, but not from ring to ring.
const EXPECTED: f64 = 0.05;

/// What is beside a cell with facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// Ways to the particles of the cells beside it that have facets, too, m; zero where there is none.
    pub ways: OnSides<f64>,
    /// The sides of these cells that look back, as `2 axis + side`.
    pub facing: [u8; FACES],
}

impl Beside {
    /// Distance of a particle at the start from where one is beside a cell, over the way there, within which it is that one.
    pub const THERE: f64 = 0.1;

    /// The way across a side, m, if there is a cell with facets.
    pub fn way(&self, side: usize) -> Option<Vector<f64>> {
        let way = *self.ways.on(side);
        (way != [0.0; 3]).then_some(way)
    }
}

/// A particle with facets, and the ways to where the next particles of its body are expected, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Owner {
    pub(super) site: Vector<f64>,
    pub(super) ways: [Option<Vector<f64>>; FACES],
}

/// Finds what is beside each of the particles of a body that have facets.
pub(super) fn find(owners: &[Owner], space: &Space<'_>, spacing: f64) -> Vec<Beside> {
    let within = EXPECTED * spacing;
    let cell = |place: Vector<f64>| place.map(|c| (c / spacing).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (k, owner) in owners.iter().enumerate() {
        cells.entry(cell(owner.site)).or_default().push(k);
    }
    let is_at = |place: Vector<f64>, k: usize| {
        let apart: Vector<f64> = std::array::from_fn(|a| owners[k].site[a] - place[a]);
        dot(apart, apart) < within * within
    };
    let at = |place: Vector<f64>| {
        let sides = [-within, within];
        let near = (0..8).map(|corner| cell(std::array::from_fn(|a| place[a] + sides[corner >> a & 1])));
        near.filter_map(|cell| cells.get(&cell)).flatten().copied().find(|&k| is_at(place, k))
    };
    let looks_back = |k: usize, way: Vector<f64>| {
        (0..FACES).find(|&side| {
            owners[k].ways[side].is_some_and(|back| {
                let sum: Vector<f64> = std::array::from_fn(|a| way[a] + back[a]);
                dot(sum, sum) < within * within
            })
        })
    };
    // The particle beyond a side, and the side of its cell that looks back.
    let beyond = |owner: &Owner, side: usize| {
        let way = owner.ways[side]?;
        let there = std::array::from_fn(|a| owner.site[a] + way[a]);
        // Itself, or the particle that it is an image of, from which the way is mirrored.
        let seen = [(there, [1.0; 3]), space.folded_with_signs(there)];
        seen.into_iter().find_map(|(place, sign)| {
            let k = at(place)?;
            Some((k, looks_back(k, std::array::from_fn(|a| sign[a] * way[a]))?))
        })
    };
    let found: Vec<[Option<(usize, usize)>; FACES]> =
        owners.iter().map(|owner| std::array::from_fn(|side| beyond(owner, side))).collect();
    let beside = |(i, owner): (usize, &Owner)| {
        let mut beside = Beside { ways: OnSides::zero(), facing: [0; FACES] };
        for side in 0..FACES {
            let (Some(way), Some((k, facing))) = (owner.ways[side], found[i][side]) else { continue };
            // Where cells of two rings meet by chance, one may expect the other a little farther off: what acts on one acts on both, or on none.
            if found[k][facing] == Some((i, side)) {
                *beside.ways.on_mut(side) = way;
                beside.facing[side] = facing as u8;
            }
        }
        beside
    };
    owners.iter().enumerate().map(beside).collect()
}

/// Rows of [`ReferenceFacet::across`](sphorge_physics::facet::ReferenceFacet::across) for a facet of a cell.
pub(super) fn across(facet: &CellFacet, beside: &Beside) -> Tensor<f64> {
    let own = usize::from(facet.side) / 2;
    std::array::from_fn(|axis| {
        let (low, high) = (beside.way(2 * axis), beside.way(2 * axis + 1));
        let way: Vector<f64> = match (low, high) {
            _ if axis == own => return [0.0; 3],
            (None, None) => return [0.0; 3],
            (Some(low), Some(high)) => std::array::from_fn(|a| 0.5 * (high[a] - low[a])),
            (None, Some(high)) => high,
            (Some(low), None) => low.map(|c| -c),
        };
        way.map(|c| c / dot(way, way))
    })
}
