//! How well the particles of a body fill its shape, and which spacings would fill it better.
//!
//! A particle of a lattice has the mass of its cell, `rho_0 s^d`. Masses are not scaled to what the shape weighs: with `m = c rho_0
//! s^d` either the density of the start is not the reference density, or every sum over `m/rho` is wrong by `c` inside the
//! body. So what a lattice does not fit is missing or too much, and is told.

use super::{
    fill::pattern,
    lattice::hexagonal_pitch,
    pattern::{Pattern, owner},
    volume::Volume,
};
use crate::model::{Arrangement, Body, Dimensions, LatticePlacement, Model, Solid, WallSurface};
use crate::particles::Particles;

/// Difference of the masses of particles and shape, over that of the shape, that needs no word.
pub const MASS_TOLERANCE: f64 = 0.01;
/// How far a first layer may be from half a spacing off a plane without a word, over the spacing.
pub const LAYER_TOLERANCE: f64 = 0.05;

/// Spacings that are sought lie within this share of the given one.
const SOUGHT_WITHIN: f64 = 0.25;
/// Digits of a spacing that is found: what a user would write.
const DIGITS: i32 = 5;
/// Particles that are set in search of spacings, at most.
const MOST_TRIED: f64 = 2e7;

/// What the particles of a body weigh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilledMass {
    /// Number of particles.
    pub particles: usize,
    /// Mass of the particles, kg (per metre of thickness in plane strain, per square metre in one dimension).
    pub mass: f64,
    /// Reference density times the volume of the shape, in the same unit.
    pub shape_mass: f64,
    /// Whether that volume is counted on a grid, to about a thousandth, rather than exact.
    pub is_estimate: bool,
}

impl FilledMass {
    /// Mass of the particles over that of the shape, less one; round-off is none.
    pub fn excess(&self) -> f64 {
        let share = self.mass / self.shape_mass - 1.0;
        if share.abs() < 1e-9 { 0.0 } else { share }
    }
}

/// What the particles of each body weigh, in the order of the deck; particles from a file are their own shape.
pub fn filled_masses(model: &Model, particles: &Particles) -> Vec<FilledMass> {
    let mut sums = vec![(0, 0.0); model.bodies.len()];
    for (&body, mass) in particles.body.iter().zip(&particles.mass) {
        let sum = &mut sums[body as usize];
        *sum = (sum.0 + 1, sum.1 + mass);
    }
    let rows = model.bodies.iter().zip(sums);
    rows.map(|(body, (particles, mass))| {
        let density = model.density_at_start(body);
        let volume = match &body.shape.solid {
            Solid::Cloud { .. } => Volume { size: mass / density, is_exact: true },
            _ => body.shape.volume(model.dimensions),
        };
        FilledMass { particles, mass, shape_mass: density * volume.size, is_estimate: !volume.is_exact }
    })
    .collect()
}

/// A plane that bounds a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundingPlane {
    /// Index into [`Model::symmetry`].
    Symmetry(usize),
    /// Index into [`Model::walls`].
    Wall(usize),
}

/// A body that ends in a plane, with a first layer that does not stand half a spacing from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MisplacedLayer {
    /// Index of the body.
    pub body: usize,
    /// The plane.
    pub plane: BoundingPlane,
    /// Distance of the layer from the plane, m.
    pub gap: f64,
}

/// A plane by a point and the unit normal towards the material.
struct Place {
    plane: BoundingPlane,
    point: [f64; 3],
    normal: [f64; 3],
}

impl Place {
    fn distance(&self, x: [f64; 3]) -> f64 {
        (0..3).map(|k| (x[k] - self.point[k]) * self.normal[k]).sum()
    }
}

fn planes(model: &Model) -> Vec<Place> {
    let symmetry = model.symmetry.iter().enumerate().map(|(index, plane)| {
        let along = |value: f64| std::array::from_fn(|k| if k == plane.axis { value } else { 0.0 });
        let (point, normal) = (along(plane.position), along(plane.side));
        Place { plane: BoundingPlane::Symmetry(index), point, normal }
    });
    let walls = model.walls.iter().enumerate().filter_map(|(index, wall)| match wall.surface {
        WallSurface::Plane { point, normal } => Some(Place { plane: BoundingPlane::Wall(index), point, normal }),
        WallSurface::Segment { .. } => None,
    });
    symmetry.chain(walls).collect()
}

/// Distance from each plane of the layer next to it, where the body has a face in the plane.
struct Layers<'a> {
    body: &'a Body,
    dimensions: Dimensions,
    spacing: f64,
    planes: &'a [Place],
    gaps: Vec<Option<f64>>,
}

impl<'a> Layers<'a> {
    fn new(body: &'a Body, dimensions: Dimensions, spacing: f64, planes: &'a [Place]) -> Self {
        // Other arrangements have no layers that are as far apart in every direction.
        let planes = if body.lattice.arrangement == Arrangement::Square { planes } else { &[] };
        Self { body, dimensions, spacing, planes, gaps: vec![None; planes.len()] }
    }

    /// Takes a particle into account: the layer is the nearest particle that the shape reaches the plane below.
    fn add(&mut self, x: [f64; 3]) {
        for (place, gap) in self.planes.iter().zip(&mut self.gaps) {
            let distance = place.distance(x);
            let is_nearer = distance < gap.unwrap_or(self.spacing * (1.0 - 1e-6));
            let foot: [f64; 3] = std::array::from_fn(|k| x[k] - distance * place.normal[k]);
            if is_nearer && self.body.shape.contains(foot, self.dimensions, 1e-6 * self.spacing) {
                *gap = Some(distance);
            }
        }
    }

    fn misplaced(&self) -> impl Iterator<Item = (BoundingPlane, f64)> {
        let is_off = |gap: f64| (gap / self.spacing - 0.5).abs() > LAYER_TOLERANCE;
        let gaps = self.planes.iter().zip(&self.gaps);
        gaps.filter_map(move |(place, gap)| gap.filter(|&gap| is_off(gap)).map(|gap| (place.plane, gap)))
    }
}

/// Bodies on a square or cubic lattice that end in a symmetry plane or a plane wall, with a layer next to it that does not stand half a
/// spacing away, within [`LAYER_TOLERANCE`]: images of the layer, or the wall, are not where the lattice goes on.
pub fn misplaced_layers(model: &Model, particles: &Particles) -> Vec<MisplacedLayer> {
    let planes = planes(model);
    let mut layers: Vec<_> =
        model.bodies.iter().map(|body| Layers::new(body, model.dimensions, body.spacing, &planes)).collect();
    for (&x, &body) in particles.position.iter().zip(&particles.body) {
        layers[body as usize].add(x);
    }
    let of_body = |(body, layers): (usize, &Layers<'_>)| {
        layers.misplaced().map(|(plane, gap)| MisplacedLayer { body, plane, gap }).collect::<Vec<_>>()
    };
    layers.iter().enumerate().flat_map(of_body).collect()
}

/// The nearest spacings below and above that of a body, m, rounded as a user would write them, whose lattice weighs what the shape does
/// within [`MASS_TOLERANCE`] and misplaces no layer.
pub fn fitting_spacings(model: &Model, body: usize) -> [Option<f64>; 2] {
    let body = &model.bodies[body];
    let planes = planes(model);
    let volume = match &body.shape.solid {
        Solid::Cloud { .. } => return [None; 2],
        // Particles on faces always weigh more.
        _ if body.lattice.placement == LatticePlacement::OnFaces => return [None; 2],
        _ => body.shape.volume(model.dimensions).size,
    };
    let candidates = candidates(body, model.dimensions);
    let mut left = MOST_TRIED;
    let mut fits = |spacing: f64| {
        let pattern = Pattern { spacing, ..pattern(model, body) };
        left -= pattern.estimate(&body.shape);
        if left < 0.0 {
            return false;
        }
        let (mut filled, mut layers) = (0.0, Layers::new(body, model.dimensions, spacing, &planes));
        pattern.for_each_site(&body.shape, |site, volume| {
            filled += volume;
            layers.add(site);
        });
        (filled / volume - 1.0).abs() <= MASS_TOLERANCE && layers.misplaced().next().is_none()
    };
    let below = candidates.iter().rev().copied().find(|&s| s < body.spacing && fits(s));
    [below, candidates.iter().copied().find(|&s| s > body.spacing && fits(s))]
}

/// Spacings about that of a body that divide one of its lengths, or a diameter in quarters, rising.
fn candidates(body: &Body, dimensions: Dimensions) -> Vec<f64> {
    let pitch = match body.lattice.arrangement {
        Arrangement::Hexagonal => hexagonal_pitch(dimensions, 1.0),
        Arrangement::Square | Arrangement::Rings => [1.0; 3],
    };
    let (solid, _) = owner(&body.shape);
    let (low, high) = solid.bounds(dimensions);
    let between = |from: &[f64; 3], to: &[f64; 3]| (0..3).map(|k| (to[k] - from[k]).powi(2)).sum::<f64>().sqrt();
    let (lengths, diameter) = match solid {
        Solid::Box { .. } | Solid::Polygon { .. } | Solid::Cloud { .. } | Solid::Composed { .. } => {
            ((0..dimensions.count()).map(|k| high[k] - low[k]).collect(), None)
        }
        Solid::Ball { radius, .. } => (Vec::new(), Some(2.0 * radius)),
        Solid::Cylinder { from, to, radius, .. } | Solid::Ogive { from, to, radius, .. } => {
            (vec![between(from, to)], Some(2.0 * radius))
        }
        Solid::Revolution { profile, .. } => {
            let widest = profile.iter().map(|p| p[1]).fold(0.0, f64::max);
            (vec![profile[profile.len() - 1][0] - profile[0][0]], Some(2.0 * widest))
        }
    };
    let mut all = Vec::new();
    for (length, parts) in lengths.into_iter().map(|length| (length, 1.0)).chain(diameter.map(|d| (d, 4.0))) {
        for pitch in &pitch[..dimensions.count()] {
            let whole = length / pitch * parts;
            let (fewest, most) =
                (whole / (body.spacing * (1.0 + SOUGHT_WITHIN)), whole / (body.spacing * (1.0 - SOUGHT_WITHIN)));
            // Of lengths of many spacings the nearest will do.
            let middle = (whole / body.spacing).round();
            let (first, last) = (fewest.ceil().max(middle - 100.0).max(1.0), most.floor().min(middle + 100.0));
            all.extend((first as i64..=last as i64).map(|count| rounded(whole / count as f64)));
        }
    }
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

fn rounded(length: f64) -> f64 {
    let scale = 10f64.powi(DIGITS - 1 - length.log10().floor() as i32);
    (length * scale).round() / scale
}
