//! What a card holds, read back in double precision.

use super::columns::{Columns, Group};
use super::kernels::{audit, conduction, contact, kept, limits, pairs, walls};
use super::start::motions;
use super::{GpuEngine, failure};
use crate::device::Pending;
use sphorge_engine::model::{Integrator, Model, Search, SmoothingLength};
use sphorge_engine::particles::HistoryVariables;
use sphorge_engine::{Column, ContactLedger, FieldSource, HeatLedger, Particles, RunFailure, WallLedger};
use sphorge_physics::SymmetricTensor;
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

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
    Group::Constants,
];

/// Groups that fields of particles are read of; a model may not have all.
const GROUPS_OF_PARTICLES: &[Group] = &[
    Group::Place,
    Group::Velocity,
    Group::Density,
    Group::Energy,
    Group::Temperature,
    Group::Plastic,
    Group::History,
    Group::Rates,
    Group::Deviator,
    Group::Pressure,
    Group::Gradient,
    Group::Weight,
    Group::Rows,
    Group::Constants,
    Group::Deformation,
    Group::Earlier,
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

/// What makes particles of groups that are read back, and what it knows beside them.
struct ColumnReader {
    model: Arc<Model>,
    /// The particles as they came.
    initial: Particles,
    stride: usize,
    /// Steps begun, and the one of the last full search.
    steps: u32,
    last_searched: u32,
    is_renewed: bool,
}

impl ColumnReader {
    /// The particles, whose groups `read` gives.
    fn particles(self, read: &mut dyn FnMut(Group) -> Result<Vec<f32>, RunFailure>) -> Result<Particles, RunFailure> {
        let mut group = |of: Group| read(of).map(|numbers| Group64 { numbers, stride: self.stride });
        let mut p = self.initial;
        let count = p.len();
        let (place, velocity) = (group(Group::Place)?, group(Group::Velocity)?);
        let (density, energy) = (group(Group::Density)?, group(Group::Energy)?);
        let (temperature, plastic) = (group(Group::Temperature)?, group(Group::Plastic)?);
        let (rates, deviator) = (group(Group::Rates)?, group(Group::Deviator)?);
        let (pressure, gradient) = (group(Group::Pressure)?, group(Group::Gradient)?);
        let weight = group(Group::Weight)?;
        let is_initial = walls::is_total_lagrangian(&self.model);
        let rows = kept::adaptive(&self.model).map(|_| group(Group::Rows)).transpose()?;
        let follows = self.model.numerics.smoothing_length != SmoothingLength::Constant;
        let constants = follows.then(|| group(Group::Constants)).transpose()?;
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
                None => (u32::from(self.steps == self.last_searched), self.last_searched),
                Some(rows) => (rows.at(kept::MARKED, i) as u32, rows.at(kept::LAST, i) as u32),
            };
        }
        let variables = HistoryVariables::of(&self.model).variables;
        let history = (!variables.is_empty()).then(|| group(Group::History)).transpose()?;
        for (k, variable) in variables.into_iter().enumerate() {
            let Some(history) = &history else { continue };
            let values: Vec<f64> = (0..count).map(|i| history.double(2 * k, 2 * k + 1, i)).collect();
            p.set_column(variable.name, &Column::Scalar(values.into()));
        }
        if is_initial {
            let tensors = |of: Group64| {
                let at = |i: usize| [0, 1, 2].map(|a| [0, 1, 2].map(|b| of.double(3 * a + b, 9 + 3 * a + b, i)));
                (0..count).map(at).collect()
            };
            p.deformation = tensors(group(Group::Deformation)?);
            if self.is_renewed {
                p.earlier_deformation = tensors(group(Group::Earlier)?);
            }
        }
        Ok(p)
    }
}

impl GpuEngine {
    fn column_reader(&self) -> ColumnReader {
        let last_searched = match self.model.search {
            Search::EveryStep => self.steps,
            Search::Skin { .. } | Search::Adaptive(_) | Search::Initial => self.kept.last_searched,
        };
        ColumnReader {
            model: self.model.clone(),
            initial: self.initial.clone(),
            stride: self.stride,
            steps: self.steps,
            last_searched,
            is_renewed: self.is_renewed(),
        }
    }

    /// What particles are now: as it was read already, or on its way; none where there is no memory for copies beside the run.
    pub(super) fn detached(&self) -> Result<Option<DetachedColumns>, RunFailure> {
        if let Some(snapshot) = self.snapshot.get() {
            let particles = OnceCell::from(snapshot.particles.clone());
            return Ok(Some(DetachedColumns { count: self.initial.len(), pending: RefCell::default(), particles }));
        }
        let reader = self.column_reader();
        let queued = GROUPS_OF_PARTICLES.iter().filter_map(|group| Some((*group, self.columns.array(*group)?)));
        let pending =
            queued.map(|(group, array)| Ok(self.card.queue_read(array).map_err(failure)?.map(|copy| (group, copy))));
        let Some(groups) = pending.collect::<Result<Option<Vec<_>>, RunFailure>>()? else { return Ok(None) };
        Ok(Some(DetachedColumns {
            count: self.initial.len(),
            pending: RefCell::new(Some(OnTheirWay { reader, groups })),
            particles: OnceCell::new(),
        }))
    }
}

/// Fields of all particles on their way from a card that goes on meanwhile.
pub(super) struct DetachedColumns {
    count: usize,
    /// What particles are made of, until they are.
    pending: RefCell<Option<OnTheirWay>>,
    particles: OnceCell<Particles>,
}

/// Groups that are copied, and what makes particles of them.
struct OnTheirWay {
    reader: ColumnReader,
    groups: Vec<(Group, Pending)>,
}

impl DetachedColumns {
    fn particles(&self) -> Result<&Particles, RunFailure> {
        if let Some(OnTheirWay { reader, groups }) = self.pending.take() {
            let mut arrived = Vec::new();
            for (group, pending) in groups {
                arrived.push((group, pending.wait().map_err(failure)?));
            }
            let mut take = |wanted: Group| {
                let place = arrived.iter().position(|(group, _)| *group == wanted);
                place.map(|place| arrived.swap_remove(place).1).ok_or_else(|| failure(format!("no column {wanted:?}")))
            };
            // Nobody else sets it: there is one of what it is made of.
            let _ = self.particles.set(reader.particles(&mut take)?);
        }
        self.particles.get().ok_or_else(|| failure("the card was lost while its fields were copied"))
    }
}

impl FieldSource for DetachedColumns {
    fn count(&self) -> usize {
        self.count
    }

    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        let p = self.particles()?;
        Ok(p.column(field).ok_or_else(|| failure(format!("no field `{field}`")))?.by_id(&p.id))
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
        let particles = self.column_reader().particles(&mut |group| read(&self.card, &self.columns, group))?;
        let (pressure, accounts, of_walls) =
            (self.group(Group::Pressure)?, self.group(Group::Accounts)?, self.group(Group::Walls)?);
        let p = &particles;
        let count = p.len();
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
        Ok(Snapshot {
            shear_modulus: (0..count).map(|i| pressure.at(2, i)).collect(),
            accounts: [0, 2, 4, 6, 8, 10, 12, 14, 16].map(|field| sum(&accounts, field)),
            walls: (0..self.model.walls.len()).map(|k| of_wall(walls::FIELDS * k)).collect(),
            evaluated: (0..count).map(|i| [0, 1, 2].map(|a| evaluated.at(a, i))).collect(),
            contacts,
            heat,
            particles,
        })
    }
}

/// The numbers of a group.
pub(super) fn read(card: &crate::device::Card, columns: &Columns, group: Group) -> Result<Vec<f32>, RunFailure> {
    let array = columns.array(group).ok_or_else(|| failure(format!("no column {group:?}")))?;
    card.read(array).map_err(failure)
}
