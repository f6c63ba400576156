//! What a card holds, read back in double precision.

use super::columns::{Columns, Group};
use super::kernels::{audit, conduction, contact, kept, limits, pairs, walls};
use super::start::motions;
use super::{GpuEngine, failure};
use sphorge_engine::model::{Integrator, Model, Search, SmoothingLength};
use sphorge_engine::particles::HistoryVariables;
use sphorge_engine::{Column, ContactLedger, HeatLedger, Particles, RunFailure, WallLedger};
use sphorge_physics::SymmetricTensor;

/// Groups of columns of particles, with their number of columns, that a model needs.
pub(super) fn fields(model: &Model) -> impl Iterator<Item = (Group, usize)> {
    let (integrator, is_initial) = (model.numerics.integrator, walls::is_total_lagrangian(model));
    let is_corrected = pairs::is_corrected(model);
    let (meets, conducts, audits) = (contact::meets(model), model.thermal.conduction, model.audit.is_some());
    let is_needed = move |group: &Group| match group {
        Group::BasePlace | Group::BaseVelocity | Group::BaseDensity => integrator == Integrator::PredictorCorrector,
        Group::Ahead => integrator == Integrator::Leapfrog,
        Group::Correction => is_initial || is_corrected,
        Group::CorrectedStress => is_corrected,
        Group::Reference | Group::Deformation | Group::Stretch | Group::FaceStress => is_initial,
        Group::Standing => meets && is_initial,
        Group::Overlap | Group::Contact => meets,
        Group::Heat => conducts,
        Group::Audit => audits,
        _ => true,
    };
    let of_bodies = meets.then(|| (Group::Meetings, contact::MEETING * model.bodies.len()));
    let variables = HistoryVariables::of(model).variables.len();
    let of_laws = (variables > 0).then_some((Group::History, 2 * variables));
    FIELDS.iter().copied().filter(move |(group, _)| is_needed(group)).chain(of_bodies).chain(of_laws)
}

/// Columns of [`Group::Weight`]; the second is the number of neighbours.
pub(super) const WEIGHT_FIELDS: usize = 3;

const FIELDS: &[(Group, usize)] = &[
    (Group::Place, 6),
    (Group::BasePlace, 6),
    (Group::Velocity, 6),
    (Group::BaseVelocity, 9),
    (Group::Evaluated, 3),
    (Group::Ahead, 3),
    (Group::Density, 2),
    (Group::BaseDensity, 2),
    (Group::Gradient, 9),
    (Group::Weight, WEIGHT_FIELDS),
    (Group::Energy, 6),
    (Group::Rates, 7),
    (Group::External, 5),
    (Group::Deviator, 6),
    (Group::Pressure, 3),
    (Group::Plastic, 6),
    (Group::Temperature, 2),
    (Group::Packed, 14),
    (Group::Constants, 8),
    (Group::Accounts, 18),
    (Group::Limits, limits::FIELDS),
    (Group::Reference, 8),
    (Group::Correction, 9),
    (Group::CorrectedStress, 9),
    (Group::Deformation, 18),
    (Group::Stretch, 3),
    (Group::FaceStress, 9),
    (Group::Standing, 12),
    (Group::Overlap, 5),
    (Group::Contact, 6),
    (Group::Heat, conduction::HEAT),
    (Group::Audit, audit::AUDIT),
];

/// Groups whose numbers the steps to come depend on.
pub(super) const STATE: &[Group] = &[
    Group::Place,
    Group::Velocity,
    Group::Evaluated,
    Group::Ahead,
    Group::Density,
    Group::Gradient,
    Group::Weight,
    Group::Energy,
    Group::Rates,
    Group::External,
    Group::Deviator,
    Group::Pressure,
    Group::Plastic,
    Group::History,
    Group::Temperature,
    Group::Accounts,
    Group::Walls,
    Group::Limits,
    Group::Reference,
    Group::Deformation,
    Group::Earlier,
    Group::Stretch,
    Group::Contact,
    Group::Meetings,
    Group::Kept,
    Group::Rows,
    Group::SearchedAt,
    Group::Stored,
    Group::FoundAt,
    Group::Candidates,
    Group::StrainCorrection,
    Group::Heat,
    Group::Boundaries,
];

/// Those among them that are lists, and where particles were when they were made.
pub(super) const LISTS: &[Group] = &[Group::Kept, Group::Rows, Group::SearchedAt];

/// What a card holds after a step.
pub(super) struct Snapshot {
    pub(super) particles: Particles,
    /// Pa.
    pub(super) shear_modulus: Vec<f64>,
    /// Work of what pairs do not do, J, its impulse, N s, booked energy, J, and those of viscosity, artificial stress, springs
    /// and moving least squares, J.
    pub(super) accounts: [f64; 9],
    /// What each wall has done.
    pub(super) walls: Vec<WallLedger>,
    /// What the contact of each pair of bodies that have one does and has done.
    pub(super) contacts: Vec<ContactLedger>,
    /// What flowed through boundaries, and was exchanged.
    pub(super) heat: HeatLedger,
    /// Velocities that forces were evaluated with, m/s.
    pub(super) evaluated: Vec<[f64; 3]>,
}

/// A group read back.
pub(super) struct Group64 {
    numbers: Vec<f32>,
    stride: usize,
}

impl Group64 {
    pub(super) fn at(&self, field: usize, i: usize) -> f64 {
        f64::from(self.numbers[field * self.stride + i])
    }

    fn double(&self, field: usize, rest: usize, i: usize) -> f64 {
        self.at(field, i) + self.at(rest, i)
    }
}

impl GpuEngine {
    pub(super) fn group(&self, group: Group) -> Result<Group64, RunFailure> {
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
        let is_initial = walls::is_total_lagrangian(&self.model);
        let last_searched = match self.model.search {
            Search::EveryStep => self.steps,
            Search::Skin { .. } | Search::Adaptive(_) | Search::Initial => self.kept.last_searched,
        };
        let rows = kept::adaptive(&self.model).map(|_| self.group(Group::Rows)).transpose()?;
        let follows = self.model.numerics.smoothing_length != SmoothingLength::Constant;
        let constants = follows.then(|| self.group(Group::Constants)).transpose()?;
        p.motion = motions(&self.model, &p);
        for i in 0..count {
            p.position[i] = [0, 1, 2].map(|a| place.double(a, 3 + a, i));
            p.velocity[i] = [0, 1, 2].map(|a| velocity.double(a, 3 + a, i));
            p.acceleration[i] = [0, 1, 2].map(|a| rates.at(a, i));
            p.density[i] = density.double(0, 1, i);
            if let Some(constants) = &constants {
                p.smoothing_length[i] = constants.at(1, i);
            }
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
            (p.adapted[i], p.last_searched[i]) = match &rows {
                None => (u32::from(self.steps == last_searched), last_searched),
                Some(rows) => (rows.at(kept::MARKED, i) as u32, rows.at(kept::LAST, i) as u32),
            };
        }
        let sum = |of: &Group64, field: usize| -> f64 { (0..count).map(|i| of.double(field, field + 1, i)).sum() };
        let of_wall = |at: usize| {
            let [work, friction_work, damping_work] = [0, 2, 4].map(|field| sum(&of_walls, at + field));
            WallLedger { work, friction_work, damping_work }
        };
        let mut heat = HeatLedger::default();
        if self.model.thermal.conduction {
            heat.exchanged = sum(&self.group(Group::Heat)?, conduction::EXCHANGED);
            let boundaries = self.group(Group::Boundaries)?;
            let supplied = |k: usize| sum(&boundaries, conduction::BOUNDARY * k + conduction::SUPPLIED);
            heat.supplied = (0..self.model.thermal.boundaries.len()).map(supplied).collect();
        }
        let evaluated = self.group(Group::Evaluated)?;
        let meetings = contact::meets(&self.model).then(|| self.group(Group::Meetings)).transpose()?;
        let contact_of = |of: &Group64, (a, b): (usize, usize)| {
            // Of a pair of particles each has a half of the works.
            let halves = |one: usize, other: usize, field: usize| -> f64 {
                let first = contact::MEETING * other + field;
                let own = (0..count).filter(|i| p.body[*i] as usize == one);
                own.map(|i| of.double(first, first + 1, i)).sum()
            };
            let work = |field| halves(a, b, field) + if a == b { 0.0 } else { halves(b, a, field) };
            let force = |axis: usize| -> f64 {
                let own = (0..count).filter(|i| a != b && p.body[*i] as usize == a);
                own.map(|i| of.at(contact::MEETING * b + axis, i)).sum()
            };
            let [stored_energy, friction_work, damping_work] = contact::WORKS.map(|(field, _)| work(field));
            // On the second.
            ContactLedger { force: [0, 1, 2].map(|axis| 0.0 - force(axis)), stored_energy, friction_work, damping_work }
        };
        let contacts =
            meetings.iter().flat_map(|of| self.model.contact_pairs().into_iter().map(move |pair| (of, pair)));
        let contacts = contacts.map(|(of, pair)| contact_of(of, pair)).collect();
        for (k, variable) in HistoryVariables::of(&self.model).variables.into_iter().enumerate() {
            let history = self.group(Group::History)?;
            let values: Vec<f64> = (0..count).map(|i| history.double(2 * k, 2 * k + 1, i)).collect();
            p.set_column(variable.name, &Column::Scalar(values.into()));
        }
        if is_initial {
            let tensors = |of: Group64| {
                let at = |i: usize| [0, 1, 2].map(|a| [0, 1, 2].map(|b| of.double(3 * a + b, 9 + 3 * a + b, i)));
                (0..count).map(at).collect()
            };
            p.deformation = tensors(self.group(Group::Deformation)?);
            if self.is_renewed() {
                p.earlier_deformation = tensors(self.group(Group::Earlier)?);
            }
        }
        Ok(Snapshot {
            shear_modulus: (0..count).map(|i| pressure.at(2, i)).collect(),
            accounts: [0, 2, 4, 6, 8, 10, 12, 14, 16].map(|field| sum(&accounts, field)),
            walls: (0..self.model.walls.len()).map(|k| of_wall(walls::FIELDS * k)).collect(),
            evaluated: (0..count).map(|i| [0, 1, 2].map(|a| evaluated.at(a, i))).collect(),
            contacts,
            heat,
            particles: p,
        })
    }
}

/// The numbers of a group.
pub(super) fn read(card: &crate::device::Card, columns: &Columns, group: Group) -> Result<Vec<f32>, RunFailure> {
    let array = columns.array(group).ok_or_else(|| failure(format!("no column {group:?}")))?;
    card.read(array).map_err(failure)
}
