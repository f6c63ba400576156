//! Checks of single particles, generic over the number, so that a graphics card makes them as the processor does.

use super::{Suspicion, can_break};
use crate::model::{HeatBoundaryKind, Material, Model, SymmetryPlane};
use crate::particles::Particles;
use sphorge_physics::tensor::dot;
use sphorge_physics::{Real, Vector};

/// What checks of single particles look at.
#[derive(Clone, Copy, Debug)]
pub struct Looked<T> {
    /// m.
    pub position: Vector<T>,
    /// kg/m³.
    pub density: T,
    /// K.
    pub temperature: T,
    /// Specific internal energy, J/kg.
    pub energy: T,
    /// Plastic work so far, J/kg.
    pub plastic_work: T,
    /// Number of neighbours.
    pub neighbors: T,
    /// Spacing of its body, m.
    pub spacing: T,
    /// Integrity: one where nothing breaks.
    pub integrity: T,
}

impl Looked<f64> {
    pub(super) fn of(model: &Model, p: &Particles, i: usize) -> Self {
        Self {
            position: p.position[i],
            density: p.density[i],
            temperature: p.temperature[i],
            energy: p.energy[i],
            plastic_work: p.plastic_work[i],
            neighbors: f64::from(p.neighbors[i]),
            spacing: model.bodies.get(p.body[i] as usize).map_or(model.spacing, |body| body.spacing),
            integrity: p.history.integrity_of(i),
        }
    }
}

/// Numbers that a particle is held against: the limit, and those of its material and of the check.
pub const AGAINST: usize = 9;

/// What a check asks of the particles of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standard {
    /// They are not looked at.
    Unseen,
    /// Nothing is wrong with them, whatever they are like.
    Blameless,
    /// They are held against these numbers, of which the first is the limit.
    Against([f64; AGAINST]),
}

impl Suspicion {
    /// Whether it looks at every particle by itself, so that [`Self::standard`] and [`Self::number`] say all of it.
    pub fn is_of_single_particles(self) -> bool {
        !matches!(self, Self::Apart | Self::Paired | Self::Torn | Self::Inside { .. })
    }

    /// One where numbers above the limit are suspicious, the larger the worse; minus one where those below it are.
    pub fn sense(self) -> f64 {
        match self {
            Self::Cold(_) | Self::Expanded(_) | Self::Lonely => -1.0,
            _ => 1.0,
        }
    }

    /// What it asks of particles of a material, by its place in the model.
    pub fn standard(self, model: &Model, material: usize) -> Standard {
        let material = model.materials.get(material);
        let of = |numbers: &[f64]| {
            let mut against = [0.0; AGAINST];
            against[..numbers.len()].copy_from_slice(numbers);
            Standard::Against(against)
        };
        match self {
            Self::Cold(limit) | Self::Behind { limit, .. } => of(&[limit]),
            Self::Hot(limit) => match material.filter(|material| material.heats()) {
                // At least a kelvin: bodies may start at absolute zero.
                Some(material) => {
                    let start = warmest(model).max(material.reference_temperature).max(1.0);
                    of(&[limit, start, material.specific_heat])
                }
                None => Standard::Blameless,
            },
            Self::MissingHeat(limit) => match material.filter(|material| material.heats() && expands(material)) {
                Some(material) => {
                    let cold = cold_kelvins(material);
                    let (t0, cp, kept) =
                        (material.reference_temperature, material.specific_heat, 1.0 - material.taylor_quinney);
                    of(&[limit, t0, cp, kept, material.density, cold[0], cold[1], cold[2], cold[3]])
                }
                None => Standard::Blameless,
            },
            Self::Compressed(limit) => match material.map(|material| material.equation_of_state) {
                Some(law) => of(&[limit, law.reference_density(), law.shock_slope().unwrap_or(1.0)]),
                None => Standard::Blameless,
            },
            // Where a material breaks, the density is that of open cracks.
            Self::Expanded(limit) => match material.filter(|of| !of.breaks()).map(|of| of.equation_of_state) {
                Some(law) => of(&[limit, law.reference_density()]),
                None => Standard::Blameless,
            },
            Self::Away { low, high, limit } => of(&[limit, low[0], low[1], low[2], high[0], high[1], high[2]]),
            Self::Lonely if material.is_some_and(|material| !can_break(material)) => {
                of(&[model.dimensions.count() as f64 + 1.0])
            }
            Self::Lonely | Self::Apart | Self::Paired | Self::Torn | Self::Inside { .. } => Standard::Unseen,
        }
    }

    /// The number of a particle that is held against the limit, where its material is held against `against`.
    pub fn number<T: Real>(self, model: &Model, against: &[T; AGAINST], of: &Looked<T>) -> T {
        let zero = T::zero();
        match self {
            Self::Cold(_) => of.temperature,
            Self::Hot(_) => of.temperature / (against[1] + of.energy.max(zero) / against[2]),
            Self::MissingHeat(_) => {
                let [_, reference, specific_heat, kept, density, a, b, c, d] = *against;
                let eta = (of.density / density - T::one()).max(zero);
                let cold = eta * eta * (a + eta * (b + eta * (c + eta * d)));
                let of_energy = reference + (of.energy - kept * of.plastic_work) / specific_heat - cold;
                // Bodies may start at absolute zero.
                of_energy / of.temperature.max(T::one())
            }
            Self::Compressed(_) => (T::one() - against[1] / of.density) * against[2],
            Self::Expanded(_) => of.density / against[1],
            Self::Away { .. } => {
                let outside =
                    |a: usize| (against[1 + a] - of.position[a]).max(of.position[a] - against[4 + a]).max(zero);
                let outside = [0, 1, 2].map(outside);
                dot(outside, outside).sqrt()
            }
            Self::Behind { .. } => {
                let depth =
                    |plane: &SymmetryPlane| (T::of(plane.position) - of.position[plane.axis]) * T::of(plane.side);
                let deepest = model.symmetry.iter().map(depth).reduce(T::max);
                let depth = deepest.map_or(zero, |deepest| deepest / of.spacing);
                // What is severed changes places with its image as it passes: nothing tells them apart.
                T::select_lt(zero, of.integrity, depth, zero)
            }
            Self::Lonely => of.neighbors,
            Self::Apart | Self::Paired | Self::Torn | Self::Inside { .. } => zero,
        }
    }
}

/// Whether heat moves the pressure of a material.
fn expands(material: &Material) -> bool {
    material.equation_of_state.gruneisen(material.density, 0.0) != 0.0
}

/// Compressions `eta = rho/rho_0 - 1` at which the energy of the isotherm is met, over the largest of them: the smaller of these, to which a constant
/// Grüneisen parameter of two holds, and the compression `chi` at which a shock is near its limit `1/S`.
const MET_AT: [f64; 4] = [1.0 / 9.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];
const LARGEST_COMPRESSION: f64 = 0.9;
const NEAR_LIMIT: f64 = 0.8;

/// Coefficients `a` to `d` of `e_cold/c_p = eta^2 (a + b eta + c eta^2 + d eta^3)`, K, with `eta = rho/rho_0 - 1`: a few products serve all particles, and
/// all laws.
fn cold_kelvins(material: &Material) -> [f64; 4] {
    let cold = material.cold_energies::<f64>();
    let chi = NEAR_LIMIT / material.equation_of_state.shock_slope().unwrap_or(1.0);
    let largest = if chi < 1.0 { LARGEST_COMPRESSION.min(chi / (1.0 - chi)) } else { LARGEST_COMPRESSION };
    let met_at = MET_AT.map(|share| share * largest);
    let of = |eta: f64| cold.at((1.0 + eta) * material.density, 1.0) / (material.specific_heat * eta * eta);
    // Newton's divided differences, then powers of eta.
    let mut table = met_at.map(of);
    for order in 1..4 {
        for k in (order..4).rev() {
            table[k] = (table[k] - table[k - 1]) / (met_at[k] - met_at[k - order]);
        }
    }
    let mut powers = [0.0; 4];
    for k in (0..4).rev() {
        for power in (1..4).rev() {
            powers[power] = powers[power - 1] - met_at[k] * powers[power];
        }
        powers[0] = table[k] - met_at[k] * powers[0];
    }
    powers
}

/// The highest temperature that bodies start with and boundaries have, K.
fn warmest(model: &Model) -> f64 {
    let boundaries = model.thermal.boundaries.iter().filter(|_| model.thermal.conduction);
    let of_boundary = boundaries.map(|boundary| match boundary.kind {
        HeatBoundaryKind::HeldTemperature(t) | HeatBoundaryKind::SurfaceTemperature(t) => t,
        HeatBoundaryKind::Convection { ambient, .. } => ambient,
        HeatBoundaryKind::Flux(_) => 0.0,
    });
    model.bodies.iter().map(|body| body.temperature).chain(of_boundary).fold(0.0, f64::max)
}
