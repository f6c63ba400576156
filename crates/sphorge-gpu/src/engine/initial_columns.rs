//! The columns of particles as they are at the start, in the memory of a GPU.

use super::columns::groups::{self, made_with_particles};
use super::columns::{
    Columns, Compensated, CompensatedTensor, CompensatedVector, Group, Handles, Layout, Number, VectorColumns,
};
use super::kernels::grid::{self, Grid};
use super::kernels::{conduction, contact, limits, reduce, verlet};
use super::plan::members;
use super::ranks::lifetime::SharedModel;
use super::step_numbers;
use crate::device::{Array, Card, CardFault};
use rayon::prelude::*;
use sphorge_engine::particles::HistoryVariables;
use sphorge_engine::{Model, Particles};
use sphorge_physics::artificial_stress::coefficient;
use std::iter;

/// Numbers of a group, field by field, of columns of whole chunks.
fn fill(stride: usize, fields: usize, count: usize, number: impl Fn(usize, usize) -> f64 + Sync) -> Vec<f32> {
    let mut numbers = vec![0.0; stride * fields];
    numbers.par_chunks_mut(limits::CHUNK).with_min_len(16).enumerate().for_each(|(chunk, numbers)| {
        let (field, first) = (chunk * limits::CHUNK / stride, chunk * limits::CHUNK % stride);
        for (i, to) in (first..count).zip(numbers) {
            *to = number(field, i) as f32;
        }
    });
    numbers
}

/// Numbers on the GPU; if all are zero, none are copied there.
fn brought(card: &Card, numbers: &[f32]) -> Result<Array, CardFault> {
    let is_zero = |numbers: &[f32]| numbers.iter().all(|number| number.to_bits() == 0);
    if numbers.par_chunks(1 << 16).all(is_zero) { card.zeros(numbers.len()) } else { card.numbers(numbers) }
}

/// A number, or its low part in single precision.
pub(super) fn part(number: f64, rest: bool) -> f64 {
    let high = f64::from(number as f32);
    if rest { number - high } else { high }
}

/// Prescribed motion of every particle: its index plus one; zero for none.
pub(super) fn motions(model: &Model, p: &Particles) -> Vec<u32> {
    p.regions
        .par_iter()
        .with_min_len(1 << 12)
        .map(|regions| model.motion_of(*regions).map_or(0, |k| k as u32 + 1))
        .collect()
}

/// What a column is at the start, by particle.
type OfParticle<'a> = Box<dyn Fn(usize) -> f64 + Sync + 'a>;

/// What the columns of a group are at the start; zero where nothing is said.
struct InitialNumbers<'a> {
    columns: Vec<Option<OfParticle<'a>>>,
}

impl<'a> InitialNumbers<'a> {
    fn column(&mut self, column: usize, number: impl Fn(usize) -> f64 + Sync + 'a) {
        self.columns[column] = Some(Box::new(number));
    }

    fn number(&mut self, of: Number<()>, number: impl Fn(usize) -> f64 + Sync + 'a) {
        self.column(of.column(), number);
    }

    fn vector(&mut self, of: VectorColumns<()>, vector: impl Fn(usize) -> [f64; 3] + Copy + Sync + 'a) {
        for a in 0..3 {
            self.number(of.axis(a), move |i| vector(i)[a]);
        }
    }

    fn compensated(&mut self, of: Compensated<()>, number: impl Fn(usize) -> f64 + Copy + Sync + 'a) {
        let [high, low] = of.columns();
        self.column(high, move |i| part(number(i), false));
        self.column(low, move |i| part(number(i), true));
    }

    fn compensated_vector(&mut self, of: CompensatedVector<()>, vector: impl Fn(usize) -> [f64; 3] + Copy + Sync + 'a) {
        for a in 0..3 {
            self.compensated(of.axis(a), move |i| vector(i)[a]);
        }
    }

    fn identity(&mut self, of: CompensatedTensor<()>) {
        for a in 0..3 {
            self.number(of.component(4 * a).high(), |_| 1.0);
        }
    }
}

/// The numbers of the columns of a group at the start.
pub(super) fn initial_numbers(
    (group, columns): (Group, usize),
    (model, p): (&Model, &Particles),
    stride: usize,
) -> Vec<f32> {
    let mut at_start = InitialNumbers { columns: (0..columns).map(|_| None).collect() };
    match group {
        Group::Place => at_start.compensated_vector(groups::Place::layout().position, |i| p.position[i]),
        Group::Velocity => at_start.compensated_vector(groups::Velocity::layout().velocity, |i| p.velocity[i]),
        Group::Evaluated => at_start.vector(groups::Evaluated::layout().velocity, |i| p.velocity[i]),
        Group::Density => at_start.compensated(groups::Density::layout().density, |i| p.density[i]),
        Group::Energy => at_start.compensated(groups::Energy::layout().energy, |i| p.energy[i]),
        Group::Temperature => at_start.compensated(groups::Temperature::layout().temperature, |i| p.temperature[i]),
        Group::Deviator => {
            let first = groups::Deviator::layout().deviator.column();
            (0..6).for_each(|k| at_start.column(first + k, move |i| p.deviator[i].to_array()[k]));
        }
        Group::History => {
            for (k, variable) in HistoryVariables::of(model).variables.into_iter().enumerate() {
                let of = groups::History::at((), k * <groups::History<()> as Handles<()>>::LENGTH).value;
                at_start.compensated(of, move |_| variable.initial);
            }
        }
        Group::Plastic => {
            let of = groups::Plastic::layout();
            at_start.compensated(of.strain, |i| p.plastic_strain[i]);
            at_start.number(of.yield_stress, |i| p.yield_stress[i]);
            at_start.compensated(of.work, |i| p.plastic_work[i]);
        }
        Group::Constants => constants(&mut at_start, model, p),
        Group::Packed => at_start.number(groups::Packed::layout().balsara, |_| 1.0),
        Group::Contact => at_start.number(groups::Contact::layout().limit, |_| f64::from(f32::MAX)),
        Group::Reference => {
            let of = groups::Reference::layout();
            at_start.compensated_vector(of.position, |i| p.position[i]);
            at_start.compensated(of.volume, |i| p.mass[i] / p.density[i]);
        }
        Group::Deformation => at_start.identity(groups::Deformation::layout().deformation),
        Group::Earlier => at_start.identity(groups::Earlier::layout().deformation),
        Group::Stretch => at_start.number(groups::Stretch::layout().smallest, |_| 1.0),
        Group::Springs => at_start.number(groups::Springs::layout().least_stretch, |_| 1.0),
        _ => {}
    }
    let number = |column: usize, i: usize| at_start.columns[column].as_ref().map_or(0.0, |of| of(i));
    let mut numbers = fill(stride, columns, p.len(), number);
    if group == Group::Limits {
        numbers[..limits::LIMITS * stride].fill(f32::MAX);
    }
    numbers
}

fn constants<'a>(at_start: &mut InitialNumbers<'a>, model: &'a Model, p: &'a Particles) {
    let of = groups::Constants::layout();
    let numerics = &model.numerics;
    let of_body = |i: usize| &model.bodies[p.body[i] as usize];
    let of_material = |i: usize| &model.materials[p.material[i] as usize];
    at_start.number(of.mass, |i| p.mass[i]);
    at_start.number(of.smoothing_length, |i| p.smoothing_length[i]);
    at_start.number(of.initial_smoothing_length, |i| p.smoothing_length[i]);
    at_start.number(of.artificial_stress, move |i| {
        numerics.artificial_stress.map_or(0.0, |terms| {
            let at_spacing = numerics.kernel.w(of_body(i).spacing / of_body(i).smoothing_length);
            coefficient(terms.epsilon, at_spacing, terms.exponent)
        })
    });
    at_start.number(of.spacing, move |i| of_body(i).spacing);
    at_start.number(of.volume_at_rest, move |i| p.mass[i] / of_material(i).density);
    at_start.number(of.young_modulus, move |i| of_material(i).young_modulus());
    at_start.number(of.sound_speed, move |i| of_material(i).equation_of_state.reference_sound_speed());
}

/// What columns are made for.
struct Maker<'a> {
    card: &'a Card,
    model: &'a Model,
    p: &'a Particles,
    stride: usize,
    columns: Columns,
}

/// Columns of a given length for particles, with their initial values; those of shared particles are followed by
/// ghosts.
pub(super) fn make_columns(
    card: &Card,
    (model, p): (&Model, &Particles),
    stride: usize,
    grid: &Grid,
    is_shared: bool,
) -> Result<Columns, CardFault> {
    let mut maker = Maker { card, model, p, stride, columns: Columns::default() };
    for (group, columns) in made_with_particles(model) {
        let numbers = initial_numbers((group, columns), (model, p), stride);
        maker.columns.insert(group, brought(card, &numbers)?);
    }
    maker.step_and_walls()?;
    maker.contact()?;
    maker.heat()?;
    maker.cells(grid)?;
    maker.lists()?;
    if is_shared {
        maker.columns.insert(Group::Sends, card.zeros(0)?);
    }
    if is_shared && model.ghosts_expire() {
        maker.zeros::<groups::GhostsAt<()>>()?;
    }
    if model.keeps_lists() || is_shared {
        maker.reduced(Group::Ways, verlet::WAYS)?;
    }
    Ok(maker.columns)
}

impl Maker<'_> {
    /// Columns of a group that are zero at the start.
    fn zeros<H: Handles<()>>(&mut self) -> Result<(), CardFault> {
        self.columns.insert(H::GROUP, self.card.zeros(H::LENGTH * self.stride)?);
        Ok(())
    }

    /// Numbers of parts of the particles, and of the passes that reduce them.
    fn reduced(&mut self, group: Group, numbers: usize) -> Result<(), CardFault> {
        let rows = reduce::rows(self.stride);
        for (group, rows) in iter::once((group, rows)).chain(reduce::groups(group, rows)) {
            self.columns.insert(group, self.card.zeros(numbers * rows)?);
        }
        Ok(())
    }

    fn whole(&self, mut numbers: Vec<u32>) -> Result<Array, CardFault> {
        numbers.resize(self.stride, 0);
        self.card.indices(&numbers)
    }

    fn step_and_walls(&mut self) -> Result<(), CardFault> {
        let Self { card, model, p, stride, .. } = *self;
        let of_walls = (<groups::Walls<()> as Handles<()>>::LENGTH * model.walls.len()).max(1);
        self.columns.insert(Group::Walls, card.zeros(of_walls * stride)?);
        self.reduced(Group::Extremes, limits::EXTREMES)?;
        self.columns.insert(Group::Step, card.zeros(step_numbers::count(model))?);
        self.columns.insert(Group::Motion, self.whole(motions(model, p))?);
        self.columns.insert(Group::Body, self.whole(p.body.clone())?);
        for section in 0..model.sections.len() {
            let columns = <groups::Section<()> as Handles<()>>::LENGTH;
            self.columns.insert(Group::Section(section), card.zeros(columns * stride)?);
        }
        for k in 0..model.materials.len() {
            self.columns.insert(Group::Members(k), card.indices(&members(p, k))?);
        }
        Ok(())
    }

    fn contact(&mut self) -> Result<(), CardFault> {
        let Self { card, model, p, stride, .. } = *self;
        if let Some(laws) = contact::laws(model) {
            self.columns.insert(Group::ContactLaws, card.numbers(&laws)?);
            if !model.has_faces() {
                let all: Vec<u32> = (0..p.len() as u32).collect();
                self.columns.insert(Group::Surface, card.indices(&all)?);
            }
        }
        if model.has_faces() {
            self.columns.insert(Group::Surface, card.zeros(0)?);
            if model.sorts_by_contact_positions() {
                self.zeros::<groups::Outward<()>>()?;
            }
        }
        if model.has_facets() {
            self.columns.insert(Group::FacetTable, card.zeros(0)?);
            self.columns.insert(Group::BesideTable, card.zeros(0)?);
            self.columns.insert(Group::Facets, card.zeros(super::kernels::facets::FACETS * stride)?);
        }
        Ok(())
    }

    fn heat(&mut self) -> Result<(), CardFault> {
        let Self { card, model, p, stride, .. } = *self;
        if !model.thermal.conduction {
            return Ok(());
        }
        self.columns.insert(Group::HeatLaws, card.numbers(&conduction::laws(model))?);
        self.columns.insert(Group::Boundaries, card.numbers(&conduction::claims(model, p, stride))?);
        self.reduced(Group::HeatExtremes, conduction::EXTREMES)?;
        if model.conducts_between_bodies() {
            self.columns.insert(Group::Touched, card.zeros(stride)?);
        }
        Ok(())
    }

    fn cells(&mut self, grid: &Grid) -> Result<(), CardFault> {
        let Self { card, stride, .. } = *self;
        let cells = grid.chunks() * grid::CHUNK;
        self.columns.insert(Group::CellCounts, card.zeros(cells)?);
        self.columns.insert(Group::CellStarts, card.zeros(cells + 1)?);
        self.columns.insert(Group::ChunkStarts, card.zeros(grid.sums())?);
        for group in [Group::Slots, Group::Unsorted, Group::Sorted] {
            self.columns.insert(group, card.zeros(stride)?);
        }
        self.columns.insert(Group::Around, card.indices(&grid.around())?);
        Ok(())
    }

    /// Terms of faces, whose memory is allocated when they are found.
    fn faces(&mut self) -> Result<(), CardFault> {
        let Self { card, model, stride, .. } = *self;
        for group in [
            Group::FaceParticles,
            Group::FaceStarts,
            Group::FaceEntries,
            Group::FaceTerms,
            Group::FaceTable,
            Group::FaceSpread,
            Group::NearParticles,
            Group::NearStarts,
            Group::NearEntries,
            Group::NearTerms,
            Group::NearFaces,
        ] {
            self.columns.insert(group, card.zeros(0)?);
        }
        if model.has_facets() {
            self.columns.insert(Group::FaceRows, card.zeros(stride)?);
            self.columns
                .insert(Group::FaceEvaluated, card.zeros(<groups::FaceLinear<()> as Handles<()>>::LENGTH * stride)?);
        }
        Ok(())
    }

    /// Lists, whose memory is allocated when it is known how much they need.
    fn lists(&mut self) -> Result<(), CardFault> {
        let Self { card, model, p, stride, .. } = *self;
        if model.is_total_lagrangian() {
            self.columns.insert(Group::ListStarts, card.zeros(p.len() + 1)?);
            self.columns.insert(Group::List, card.zeros(0)?);
        }
        if model.formulation.is_quadratic_at_faces() {
            self.faces()?;
        }
        if model.numerics.mls_interval.is_some() {
            self.zeros::<groups::Restored<()>>()?;
        }
        if !model.keeps_lists() {
            return Ok(());
        }
        self.columns.insert(Group::Kept, card.zeros(0)?);
        self.zeros::<groups::Rows<()>>()?;
        self.zeros::<groups::SearchedAt<()>>()?;
        if model.keeps_distances() {
            self.columns.insert(Group::Stored, card.zeros(0)?);
        }
        if model.adaptive_search().is_some() {
            self.columns.insert(Group::Patched, card.zeros(stride)?);
            self.zeros::<groups::FoundAt<()>>()?;
            self.zeros::<groups::Candidates<()>>()?;
            self.zeros::<groups::StrainCorrection<()>>()?;
        }
        Ok(())
    }
}
