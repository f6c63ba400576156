//! State of the card, read back in double precision.

use super::columns::{Columns, Group};
use super::kernels::{audit, conduction, contact, facets, kept, limits};
use super::start::motions;
use super::{GpuEngine, failure};
use crate::device::Pending;
use sphorge_engine::model::{Integrator, Model, Search};
use sphorge_engine::particles::{HistoryVariables, stored_behind};
use sphorge_engine::{Column, FieldSource, Particles, RunFailure};
use sphorge_physics::SymmetricTensor;
use std::borrow::Cow;
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

/// Groups of columns of particles, with their number of columns, that a model needs.
pub(super) fn fields(model: &Model) -> impl Iterator<Item = (Group, usize)> {
    let (integrator, is_initial) = (model.numerics.integrator, model.is_total_lagrangian());
    let is_corrected = model.corrects_current_gradients();
    let (meets, conducts, audits) = (model.has_contact(), model.thermal.conduction, model.audit.is_some());
    let (has_facets, rubs) = (model.has_facets(), model.contact.has_friction());
    let stands = model.sorts_by_contact_positions();
    let is_needed = move |group: &Group| match group {
        Group::BasePlace | Group::BaseVelocity | Group::BaseDensity => integrator == Integrator::PredictorCorrector,
        Group::Ahead => integrator == Integrator::Leapfrog,
        Group::Correction => is_initial || is_corrected,
        Group::CorrectedStress => is_corrected,
        Group::Reference | Group::Deformation | Group::Stretch | Group::Springs | Group::FaceStress => is_initial,
        Group::Standing => meets && is_initial && stands,
        Group::Overlap => meets && !has_facets,
        Group::FacetMotion => has_facets,
        Group::Slips | Group::Drives => has_facets && rubs,
        Group::Contact => meets,
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
    (Group::Springs, 11),
    (Group::FaceStress, 9),
    (Group::Standing, 12),
    (Group::Overlap, 5),
    (Group::Contact, 6),
    (Group::FacetMotion, facets::MOTION),
    (Group::Slips, facets::SLIPS),
    (Group::Drives, facets::DRIVES),
    (Group::Heat, conduction::HEAT),
    (Group::Audit, audit::AUDIT),
];

/// Groups on which the following steps depend.
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
    Group::Springs,
    Group::Contact,
    Group::Meetings,
    Group::FacetMotion,
    Group::Slips,
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

/// Groups from which fields of particles are read; a model may not have all.
pub(super) const GROUPS_OF_PARTICLES: &[Group] = &[
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

/// Those among them that are lists, and the positions at which they were built.
pub(super) const LISTS: &[Group] = &[Group::Kept, Group::Rows, Group::SearchedAt];

/// Stored fields that steps change.
const CHANGING: [&str; 21] = [
    "smoothing_length",
    "position",
    "velocity",
    "acceleration",
    "density",
    "energy",
    "energy_rate",
    "temperature",
    "pressure",
    "sound_speed",
    "deviator",
    "velocity_gradient",
    "plastic_strain",
    "plastic_strain_increment",
    "plastic_strain_rate",
    "yield_stress",
    "plastic_work",
    "neighbors",
    "adapted",
    "last_searched",
    "motion",
];

/// A group that has been read back; copies share it.
#[derive(Clone)]
pub(super) struct Group64 {
    numbers: Arc<Vec<f32>>,
    stride: usize,
}

impl Group64 {
    pub(super) fn at(&self, field: usize, i: usize) -> f64 {
        f64::from(self.numbers[field * self.stride + i])
    }

    pub(super) fn double(&self, field: usize, rest: usize, i: usize) -> f64 {
        self.at(field, i) + self.at(rest, i)
    }
}

/// Converts groups that are read back to particles, with the additional data for this.
struct ColumnReader<'a> {
    model: Arc<Model>,
    /// The initial particles.
    initial: Cow<'a, Particles>,
    stride: usize,
    /// Number of steps begun, and the step of the last full search.
    steps: u32,
    last_searched: u32,
    /// Duration of the last step, s.
    dt: f64,
    is_renewed: bool,
}

impl ColumnReader<'_> {
    /// A stored field from groups that `read` returns; none if a model does not have it.
    fn column(
        &self,
        field: &str,
        read: &mut dyn FnMut(Group) -> Result<Arc<Vec<f32>>, RunFailure>,
    ) -> Result<Option<Column<'static>>, RunFailure> {
        let mut group = |of: Group| read(of).map(|numbers| Group64 { numbers, stride: self.stride });
        let rows = 0..self.initial.len();
        let scalars = |of: &dyn Fn(usize) -> f64| Column::Scalar(rows.clone().map(of).collect());
        let whole = |of: &dyn Fn(usize) -> u32| Column::Integer(rows.clone().map(of).collect());
        let vectors = |of: &dyn Fn(usize, usize) -> f64| {
            Column::Vector(rows.clone().map(|i| [0, 1, 2].map(|a| of(a, i))).collect())
        };
        let tensors = |of: &dyn Fn(usize, usize) -> f64| {
            let tensor = |i: usize| [0, 1, 2].map(|a| [0, 1, 2].map(|b| of(3 * a + b, i)));
            Column::Tensor(rows.clone().map(tensor).collect())
        };
        let is_initial = self.model.is_total_lagrangian();
        let follows = self.model.smoothing_follows_density();
        let is_adaptive = self.model.adaptive_search().is_some();
        let column = match field {
            "position" | "velocity" => {
                let of = group(if field == "position" { Group::Place } else { Group::Velocity })?;
                vectors(&|a, i| of.double(a, 3 + a, i))
            }
            "acceleration" => {
                let of = group(Group::Rates)?;
                vectors(&|a, i| of.at(a, i))
            }
            "smoothing_length" if follows => {
                let of = group(Group::Constants)?;
                scalars(&|i| of.at(1, i))
            }
            "density" | "energy" | "temperature" | "plastic_strain" => {
                let of = group(match field {
                    "density" => Group::Density,
                    "energy" => Group::Energy,
                    "temperature" => Group::Temperature,
                    _ => Group::Plastic,
                })?;
                scalars(&|i| of.double(0, 1, i))
            }
            "energy_rate" => {
                let of = group(Group::Energy)?;
                scalars(&|i| of.at(2, i))
            }
            "pressure" | "sound_speed" => {
                let (of, place) = (group(Group::Pressure)?, usize::from(field == "sound_speed"));
                scalars(&|i| of.at(place, i))
            }
            "deviator" => {
                let of = group(Group::Deviator)?;
                let tensor = |i: usize| SymmetricTensor::from_array([0, 1, 2, 3, 4, 5].map(|k| of.at(k, i)));
                Column::Symmetric(rows.map(tensor).collect())
            }
            "velocity_gradient" => {
                let of = group(Group::Gradient)?;
                tensors(&|k, i| of.at(k, i))
            }
            "plastic_strain_increment" => {
                let of = group(Group::Plastic)?;
                scalars(&|i| of.at(2, i))
            }
            "plastic_strain_rate" => {
                let of = group(Group::Plastic)?;
                scalars(&|i| if self.dt > 0.0 { of.at(2, i) / self.dt } else { 0.0 })
            }
            "initial_position" => {
                // Positions stay in their periodic cells: a particle takes the short way.
                let of = group(Group::Place)?;
                vectors(&|a, i| {
                    let start = self.initial.position[i][a];
                    let period = self.model.periodic.get(a).copied().flatten().map(|(low, high)| high - low);
                    period.map_or(start, |l| start + l * ((of.double(a, 3 + a, i) - start) / l).round())
                })
            }
            "yield_stress" => {
                let of = group(Group::Plastic)?;
                // A law that never yields has the largest number.
                scalars(&|i| if of.at(3, i) >= f64::from(f32::MAX) { f64::INFINITY } else { of.at(3, i) })
            }
            "plastic_work" => {
                let of = group(Group::Plastic)?;
                scalars(&|i| of.double(4, 5, i))
            }
            "neighbors" => {
                let of = group(Group::Weight)?;
                whole(&|i| of.at(1, i) as u32)
            }
            "adapted" if is_adaptive => {
                let of = group(Group::Rows)?;
                whole(&|i| of.at(kept::MARKED, i) as u32)
            }
            "last_searched" if is_adaptive => {
                let of = group(Group::Rows)?;
                whole(&|i| of.at(kept::LAST, i) as u32)
            }
            "adapted" => whole(&|_| u32::from(self.steps == self.last_searched)),
            "last_searched" => whole(&|_| self.last_searched),
            "motion" => Column::Integer(motions(&self.model, &self.initial).into()),
            "deformation" if is_initial => {
                let of = group(Group::Deformation)?;
                tensors(&|k, i| of.double(k, 9 + k, i))
            }
            "earlier_deformation" if is_initial && self.is_renewed => {
                let of = group(Group::Earlier)?;
                tensors(&|k, i| of.double(k, 9 + k, i))
            }
            _ => match HistoryVariables::of(&self.model).variables.iter().position(|of| of.name == field) {
                Some(k) => {
                    let of = group(Group::History)?;
                    scalars(&|i| of.double(2 * k, 2 * k + 1, i))
                }
                None => return Ok(self.initial.column(field).map(Column::into_owned)),
            },
        };
        Ok(Some(column))
    }

    /// All of the particles.
    fn particles(
        &self,
        read: &mut dyn FnMut(Group) -> Result<Arc<Vec<f32>>, RunFailure>,
    ) -> Result<Particles, RunFailure> {
        let mut p = Particles::clone(&self.initial);
        let variables = HistoryVariables::of(&self.model).variables.into_iter().map(|variable| variable.name);
        let deformed = ["deformation", "earlier_deformation", "initial_position"].into_iter();
        for field in CHANGING.into_iter().chain(variables).chain(deformed) {
            if let Some(column) = self.column(field, read)? {
                p.set_column(field, &column);
            }
        }
        Ok(p)
    }
}

impl GpuEngine {
    fn column_reader(&self) -> ColumnReader<'_> {
        let last_searched = match self.model.search {
            Search::EveryStep => self.steps,
            Search::Skin { .. } | Search::Adaptive(_) | Search::Initial => self.kept.last_searched,
        };
        ColumnReader {
            model: self.model.clone(),
            initial: Cow::Borrowed(&self.initial),
            stride: self.stride,
            steps: self.steps,
            last_searched,
            dt: self.dt,
            is_renewed: self.is_renewed(),
        }
    }

    /// Contents of a group after a step: copied back once, and kept until the next one.
    fn read_once(&self, group: Group) -> Result<Arc<Vec<f32>>, RunFailure> {
        let known = self.read_back.borrow().iter().find(|(of, _)| *of == group).map(|(_, numbers)| numbers.clone());
        if let Some(numbers) = known {
            return Ok(numbers);
        }
        let numbers = Arc::new(read(&self.card, &self.columns, group)?);
        self.read_back.borrow_mut().push((group, numbers.clone()));
        Ok(numbers)
    }

    /// A field, read only from the groups it consists of.
    pub(super) fn field(&self, field: &str) -> Result<Column<'static>, RunFailure> {
        let (reader, mut read) = (self.column_reader(), |group| self.read_once(group));
        let missing = || failure(format!("no field `{field}`"));
        let stored = stored_behind(field);
        if stored == [field] {
            return reader.column(field, &mut read)?.ok_or_else(missing);
        }
        let mut particles = Particles::new(self.initial.len());
        for stored in stored {
            particles.set_column(stored, &reader.column(stored, &mut read)?.ok_or_else(missing)?);
        }
        particles.column(field).map(Column::into_owned).ok_or_else(missing)
    }

    /// All particle data on the card.
    pub(super) fn snapshot(&self) -> Result<Particles, RunFailure> {
        self.column_reader().particles(&mut |group| self.read_once(group))
    }

    /// A copy of the current particles in flight; none if there is no memory for copies during the run.
    pub(super) fn detached(&self) -> Result<Option<DetachedColumns>, RunFailure> {
        let reader = self.column_reader();
        let reader = ColumnReader { initial: Cow::Owned(self.initial.clone()), ..reader };
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

/// Fields of all particles in flight from a card that continues meanwhile.
pub(super) struct DetachedColumns {
    count: usize,
    /// The groups, until particles are made from them.
    pending: RefCell<Option<OnTheirWay>>,
    particles: OnceCell<Particles>,
}

/// Groups that are copied, and their conversion to particles.
struct OnTheirWay {
    reader: ColumnReader<'static>,
    groups: Vec<(Group, Pending)>,
}

impl DetachedColumns {
    fn particles(&self) -> Result<&Particles, RunFailure> {
        if let Some(OnTheirWay { reader, groups }) = self.pending.take() {
            let mut arrived = Vec::new();
            for (group, pending) in groups {
                arrived.push((group, Arc::new(pending.wait().map_err(failure)?)));
            }
            let mut find = |wanted: Group| {
                let found = arrived.iter().find(|(group, _)| *group == wanted).map(|(_, numbers)| numbers.clone());
                found.ok_or_else(|| failure(format!("no column {wanted:?}")))
            };
            // Nothing else sets it, because its source exists only once.
            let _ = self.particles.set(reader.particles(&mut find)?);
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
        let numbers = Arc::new(read(&self.card, &self.columns, group)?);
        Ok(Group64 { numbers, stride: self.stride })
    }
}

/// The numbers of a group.
pub(super) fn read(card: &crate::device::Card, columns: &Columns, group: Group) -> Result<Vec<f32>, RunFailure> {
    let array = columns.array(group).ok_or_else(|| failure(format!("no column {group:?}")))?;
    card.read(array).map_err(failure)
}
