//! What a card holds, read back in double precision.

use super::columns::{Columns, Group};
use super::kernels::walls;
use super::{GpuEngine, failure};
use sphorge_engine::{Particles, RunFailure};
use sphorge_physics::SymmetricTensor;

/// Groups of columns of particles, with their number of columns.
pub(super) const FIELDS: &[(Group, usize)] = &[
    (Group::Place, 6),
    (Group::BasePlace, 6),
    (Group::Velocity, 6),
    (Group::BaseVelocity, 9),
    (Group::Evaluated, 3),
    (Group::Density, 2),
    (Group::BaseDensity, 2),
    (Group::Gradient, 9),
    (Group::Weight, 3),
    (Group::Energy, 3),
    (Group::Rates, 7),
    (Group::External, 5),
    (Group::Deviator, 6),
    (Group::Pressure, 3),
    (Group::Plastic, 6),
    (Group::Temperature, 2),
    (Group::Packed, 14),
    (Group::Constants, 5),
    (Group::Accounts, 10),
    (Group::Limits, 7),
];

/// Groups whose numbers the steps to come depend on.
pub(super) const STATE: &[Group] = &[
    Group::Place,
    Group::Velocity,
    Group::Evaluated,
    Group::Density,
    Group::Gradient,
    Group::Weight,
    Group::Energy,
    Group::Rates,
    Group::External,
    Group::Deviator,
    Group::Pressure,
    Group::Plastic,
    Group::Temperature,
    Group::Accounts,
    Group::Walls,
    Group::Limits,
];

/// What a card holds after a step.
pub(super) struct Snapshot {
    pub(super) particles: Particles,
    /// Pa.
    pub(super) shear_modulus: Vec<f64>,
    /// Work of what pairs do not do, J, its impulse, N s, and booked energy, J.
    pub(super) accounts: [f64; 5],
    /// Work of each wall, J.
    pub(super) wall_work: Vec<f64>,
    /// Velocities that forces were evaluated with, m/s.
    pub(super) evaluated: Vec<[f64; 3]>,
}

/// A group read back.
struct Group64 {
    numbers: Vec<f32>,
    stride: usize,
}

impl Group64 {
    fn at(&self, field: usize, i: usize) -> f64 {
        f64::from(self.numbers[field * self.stride + i])
    }

    fn double(&self, field: usize, rest: usize, i: usize) -> f64 {
        self.at(field, i) + self.at(rest, i)
    }
}

impl GpuEngine {
    fn group(&self, group: Group) -> Result<Group64, RunFailure> {
        let numbers = read(&self.card, &self.columns, group)?;
        Ok(Group64 { numbers, stride: self.stride })
    }

    /// What the card holds now.
    pub(super) fn snapshot(&self) -> Result<&Snapshot, RunFailure> {
        if self.snapshot.get().is_none() {
            // Nobody else sets it between.
            let _ = self.snapshot.set(self.read_all()?);
        }
        self.snapshot.get().ok_or_else(|| failure("the card was not read"))
    }

    fn read_all(&self) -> Result<Snapshot, RunFailure> {
        let mut p = self.initial.clone();
        let count = p.len();
        let (place, velocity) = (self.group(Group::Place)?, self.group(Group::Velocity)?);
        let (density, energy) = (self.group(Group::Density)?, self.group(Group::Energy)?);
        let (temperature, plastic) = (self.group(Group::Temperature)?, self.group(Group::Plastic)?);
        let (rates, deviator) = (self.group(Group::Rates)?, self.group(Group::Deviator)?);
        let (pressure, gradient) = (self.group(Group::Pressure)?, self.group(Group::Gradient)?);
        let (weight, accounts, of_walls) =
            (self.group(Group::Weight)?, self.group(Group::Accounts)?, self.group(Group::Walls)?);
        for i in 0..count {
            p.position[i] = [0, 1, 2].map(|a| place.double(a, 3 + a, i));
            p.velocity[i] = [0, 1, 2].map(|a| velocity.double(a, 3 + a, i));
            p.acceleration[i] = [0, 1, 2].map(|a| rates.at(a, i));
            p.density[i] = density.double(0, 1, i);
            p.energy[i] = energy.double(0, 1, i);
            p.energy_rate[i] = energy.at(2, i);
            p.temperature[i] = temperature.double(0, 1, i);
            p.pressure[i] = pressure.at(0, i);
            p.sound_speed[i] = pressure.at(1, i);
            p.deviator[i] = SymmetricTensor::from_array([0, 1, 2, 3, 4, 5].map(|k| deviator.at(k, i)));
            p.velocity_gradient[i] = [0, 1, 2].map(|a| [0, 1, 2].map(|b| gradient.at(3 * a + b, i)));
            p.plastic_strain[i] = plastic.double(0, 1, i);
            p.plastic_strain_increment[i] = plastic.at(2, i);
            // A law that never yields has the largest number there.
            p.yield_stress[i] = if plastic.at(3, i) >= f64::from(f32::MAX) { f64::INFINITY } else { plastic.at(3, i) };
            p.plastic_work[i] = plastic.double(4, 5, i);
            p.neighbors[i] = weight.at(1, i) as u32;
            (p.adapted[i], p.last_searched[i]) = (1, self.steps);
        }
        let sum = |of: &Group64, field: usize| -> f64 { (0..count).map(|i| of.double(field, field + 1, i)).sum() };
        let evaluated = self.group(Group::Evaluated)?;
        Ok(Snapshot {
            shear_modulus: (0..count).map(|i| pressure.at(2, i)).collect(),
            accounts: [0, 2, 4, 6, 8].map(|field| sum(&accounts, field)),
            wall_work: (0..self.model.walls.len()).map(|k| sum(&of_walls, walls::FIELDS * k)).collect(),
            evaluated: (0..count).map(|i| [0, 1, 2].map(|a| evaluated.at(a, i))).collect(),
            particles: p,
        })
    }
}

/// The numbers of a group.
pub(super) fn read(card: &crate::device::Card, columns: &Columns, group: Group) -> Result<Vec<f32>, RunFailure> {
    let array = columns.array(group).ok_or_else(|| failure(format!("no column {group:?}")))?;
    card.read(array).map_err(failure)
}
