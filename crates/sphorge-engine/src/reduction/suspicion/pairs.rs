//! Particles that have fallen together in pairs, the sign of numerical fracture.

use super::CHUNK;
use crate::model::Model;
use crate::neighbors::CellGrid;
use crate::particles::Particles;
use rayon::prelude::*;

/// Distance of a pair below which it is suspicious, in local spacings.
///
/// Measured with this distance and [`PAIR_GAP`]: of an aluminium strip that is pulled in plane strain and comes apart in paired rows, no
/// particle is in such a pair at 5 % elongation, 25 % are at 6 %, 57 % at 10 %; of a plate that mushrooms on a wall never more than 3 %.
pub const PAIR_DISTANCE: f64 = 0.8;
/// Distance of the next neighbour from which on two particles are a pair, in distances of the pair.
pub const PAIR_GAP: f64 = 1.25;
/// How far around a pair in tension others are looked for, in local spacings: a little more than the usual kernel reaches.
pub const TEARING_RADIUS: f64 = 2.5;
/// Share of pairs in tension around one of them from which on a body tears there.
///
/// Measured with a quarter of an aluminium plate that opens in gaps below a rod of steel (`docs/guide/numerics.md`): 60 to 180 particles are
/// above it from the first gaps to the end, and no more than 4 % of the plate lie in pairs. In the foot of `taylor-bar` at 1.2 mm it is 24 for a
/// while, of 64 that lie in pairs, and in `bullet` and `taylor-plate` none.
pub const TEARING_SHARE: f64 = 0.4;

/// Nobody.
const ALONE: u32 = u32::MAX;

/// Spacing at which the particles of a body would have its present density, `(m/rho)^(1/d)`, m.
fn local_spacings(model: &Model, p: &Particles) -> Vec<f64> {
    let power = 1.0 / model.dimensions.count() as f64;
    let spacing = |i: usize| {
        let local = (p.mass[i] / p.density[i]).powf(power);
        // A particle whose density has all but vanished must not ask for the whole body.
        local.min(2.0 * model.bodies.get(p.body[i] as usize).map_or(model.spacing, |body| body.spacing))
    };
    (0..p.len()).into_par_iter().with_min_len(CHUNK).map(spacing).collect()
}

/// Who lies with whom.
pub(super) struct Pairs {
    /// Place of the partner in the columns, or [`ALONE`].
    partner: Vec<u32>,
    /// Distance from the nearest in local spacings; without a near one infinite.
    distance: Vec<f64>,
}

impl Pairs {
    pub(super) fn find(model: &Model, p: &Particles) -> Self {
        let dimensions = model.dimensions.count();
        let spacings = local_spacings(model, p);
        let reach = PAIR_DISTANCE * PAIR_GAP;
        let largest = reach * spacings.iter().copied().fold(0.0, f64::max);
        let mut pairs = Self { partner: vec![ALONE; p.len()], distance: vec![f64::INFINITY; p.len()] };
        if !(largest > 0.0 && largest.is_finite()) {
            return pairs;
        }
        let mut grid = CellGrid::default();
        grid.sort(&p.position, largest);
        // The nearest of each, if it is near and the next one is not.
        let nearest = |i: usize| {
            let x = p.position[i];
            let (mut first, mut second, mut who) = (f64::INFINITY, f64::INFINITY, ALONE);
            for (begin, end) in grid.runs_around(&x) {
                for &j in &grid.order()[begin..end] {
                    let (k, y) = (j as usize, p.position[j as usize]);
                    if k == i || p.body[k] != p.body[i] {
                        continue;
                    }
                    let squared: f64 = (0..dimensions).map(|a| (x[a] - y[a]).powi(2)).sum();
                    if squared < first {
                        (first, second, who) = (squared, first, j);
                    } else if squared < second {
                        second = squared;
                    }
                }
            }
            let distance = first.sqrt() / spacings[i];
            let is_alone = distance >= PAIR_DISTANCE || second < PAIR_GAP * PAIR_GAP * first;
            if is_alone { (ALONE, distance) } else { (who, distance) }
        };
        let found: Vec<(u32, f64)> = (0..p.len()).into_par_iter().with_min_len(256).map(nearest).collect();
        for (i, &(who, distance)) in found.iter().enumerate() {
            let mutual = who != ALONE && found[who as usize].0 as usize == i;
            pairs.partner[i] = if mutual { who } else { ALONE };
            pairs.distance[i] = distance;
        }
        pairs
    }

    /// Place of the particle that one lies with.
    pub(super) fn partner_of(&self, i: usize) -> Option<usize> {
        Some(self.partner[i]).filter(|&partner| partner != ALONE).map(|partner| partner as usize)
    }

    /// Distance of a particle from its nearest, in local spacings.
    pub(super) fn distance(&self, i: usize) -> f64 {
        self.distance[i]
    }
}

/// Where pairs in tension lie side by side.
pub(super) struct Torn(Vec<f64>);

impl Torn {
    pub(super) fn find(model: &Model, p: &Particles) -> Self {
        let pairs = Pairs::find(model, p);
        let tears = |i: usize| pairs.partner_of(i).is_some_and(|k| p.pressure[i] + p.pressure[k] < 0.0);
        let torn: Vec<bool> = (0..p.len()).into_par_iter().with_min_len(CHUNK).map(tears).collect();
        if !torn.contains(&true) {
            return Self(vec![0.0; p.len()]);
        }
        let spacings = local_spacings(model, p);
        let mut grid = CellGrid::default();
        // Local spacings are above zero and finite where there is a pair.
        grid.sort(&p.position, TEARING_RADIUS * spacings.iter().copied().filter(|s| s.is_finite()).fold(0.0, f64::max));
        let share = |i: usize| {
            if !torn[i] {
                return 0.0;
            }
            let (x, reach) = (p.position[i], TEARING_RADIUS * spacings[i]);
            let (mut all, mut tearing) = (0_u32, 0_u32);
            for (begin, end) in grid.runs_around(&x) {
                for k in grid.order()[begin..end].iter().map(|&k| k as usize).filter(|&k| p.body[k] == p.body[i]) {
                    let squared: f64 = (0..3).map(|a| (x[a] - p.position[k][a]).powi(2)).sum();
                    if squared < reach * reach {
                        all += 1;
                        tearing += u32::from(torn[k]);
                    }
                }
            }
            f64::from(tearing) / f64::from(all.max(1))
        };
        Self((0..p.len()).into_par_iter().with_min_len(256).map(share).collect())
    }

    /// Share of pairs in tension among the particles around one that lies in such a pair; zero for all others.
    pub(super) fn share(&self, i: usize) -> f64 {
        self.0[i]
    }
}
