//! The columns of the particles on a card, and kernels that name the columns they touch.

use crate::device::{Array, Card, CardFault, Launch};
use crate::record::{
    Counters, Double, Element, Index, IndexOutput, Indices, Input, Kernel, KernelFault, Output, Recorded, Scope,
};
use sphorge_physics::{Elementary, Real, SymmetricTensor, Tensor, Vector};

/// A group of one or more contiguous columns. Numbers that a step adds to have the remainder of their rounding in a
/// column of its own, called the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Group {
    /// Position, m, and its rest.
    Place,
    /// The same at the start of the step.
    BasePlace,
    /// Velocity, m/s, and its rest.
    Velocity,
    /// The same at the start of the step, and the acceleration it was predicted with, m/s².
    BaseVelocity,
    /// Velocity that forces are evaluated with, m/s.
    Evaluated,
    /// Velocity minus that, m/s.
    Ahead,
    /// Density, kg/m³, and its rest.
    Density,
    /// The same at the start of the step.
    BaseDensity,
    /// Density by moving least squares, kg/m³.
    Restored,
    /// Velocity gradient, 1/s.
    Gradient,
    /// Weight of the particle in the sums of its neighbours, and their number.
    Weight,
    /// Specific internal energy, J/kg, its rest, its rate, W/kg, and the parts of the rate due to pair viscosity,
    /// artificial stress and hourglass springs.
    Energy,
    /// Acceleration, m/s², XSPH velocity, m/s, and the largest `|mu|`, m/s.
    Rates,
    /// Acceleration by walls and gravity, m/s², power of walls beyond that of their force on the centre, W/kg, and heat
    /// of their friction, W/kg.
    External,
    /// Deviator of the stress, Pa.
    Deviator,
    /// Pressure, Pa, sound speed, m/s, and shear modulus, Pa.
    Pressure,
    /// Plastic strain and its rest, its last increment, yield stress, Pa, plastic work, J/kg, and its rest.
    Plastic,
    /// History variables of flow laws, each with its rest.
    History,
    /// Temperature, K, and its rest.
    Temperature,
    /// Data of a neighbour that forces read: scaled stress, scaled artificial stress, Pa, Balsara's switch, sound
    /// speed, m/s; in the total Lagrangian form the tensor whose sum is the force, and the stiffness of the hourglass
    /// springs, Pa.
    Packed,
    /// Mass, kg, smoothing length, m, coefficient of the artificial stress, spacing, m, sound speed at rest, m/s, Young's modulus, Pa, and
    /// volume of the mass at rest, m^d, and smoothing length of the start, m.
    Constants,
    /// Body of a particle.
    Body,
    /// Work of forces other than pair forces, J, their impulse, N s, correction of the energy by the integrator, J,
    /// heat by viscosity, J, work against the artificial stress and against the hourglass springs, J, and energy that
    /// moving least squares add to the pressure field, J, each with its rest.
    Accounts,
    /// Work of each wall, J, its rest, and the power of the last forces, W.
    Walls,
    /// Sums of an audit over the list of a particle and over all its neighbours: see [`super::kernels::audit`].
    Audit,
    /// For each particle the time step limits by sound and by acceleration, s, four changes of the step, whether a
    /// value is not a number, and whether the particle is stretched beyond the bound of the reference configuration.
    Limits,
    /// The same for parts of the particles, and the results of the reduction passes.
    Extremes,
    ExtremesLeft(usize),
    /// Position in the reference configuration, m, its rest, and volume in it, m^d, with its rest.
    Reference,
    /// Deformation gradient of the reference configuration, and its rest, once it is not the initial one; by body,
    /// whether it has come apart, and whether its configuration is to be renewed.
    Earlier,
    Apart,
    /// Gradient correction in the reference or in the current configuration.
    Correction,
    /// Scaled stress times the gradient correction, Pa.
    CorrectedStress,
    /// Deformation gradient, and its rest.
    Deformation,
    /// Smallest principal stretch, bulk viscosity of the last stress, Pa, and whether a stretch is beyond a bound.
    Stretch,
    /// Hourglass springs: the least stretch at which the particle has yielded, zero where there are no springs, and of the
    /// last force sum the mean square of their misfit, and the stress of their moment, Pa.
    Springs,
    /// First Piola-Kirchhoff stress of the forces of walls and of the contact, which act on faces, Pa.
    FaceStress,
    /// Particles that may be in contact: those of the surface if there is only self-contact of one body, all if there
    /// are several bodies.
    Surface,
    /// For these, in the total Lagrangian form: outward normal in the reference configuration, 1/m, zero inside, and
    /// depth below the face times its unit normal, m, zero far inside.
    Outward,
    /// Their contact position, m, its rest, its velocity relative to the particle, m/s, and the outward unit normal.
    Standing,
    /// Overlap, its negative gradient, 1/m, and weight, m^(d-1).
    Overlap,
    /// Contact force, N, its power that becomes heat of the particle, W, speed of approach, m/s, limit of the step, s.
    Contact,
    /// For the contact with each body: force, N, powers stored, of friction and of damping, W, these works so far, J,
    /// each with its rest, and the energy that facets hold, J.
    Meetings,
    /// Facets of the initial configuration, of each particle the first, the one behind its last and its `id`, and for
    /// particles velocity gradient, 1/s, and reach of facets, m: see [`super::kernels::facets`].
    FacetTable,
    Facets,
    FacetMotion,
    /// With friction, of each face of a cell the tangential spring, and sums over its pairs.
    Slips,
    Drives,
    /// Contact laws for all pairs of bodies.
    ContactLaws,
    /// Heat conduction: see [`super::kernels::conduction`]. For particles, for each boundary, the body that a particle
    /// touches, laws of each body, for parts of the particles, and the results of the reduction passes.
    Heat,
    Boundaries,
    Touched,
    HeatLaws,
    HeatExtremes,
    HeatExtremesLeft(usize),
    /// Start of the list of each particle, and the neighbours.
    ListStarts,
    List,
    /// Stored lists, the first neighbour of every particle before the second of any, and their lengths: see
    /// [`super::kernels::kept`].
    Kept,
    Rows,
    /// Distances of their pairs at the last search, m, three for each, if sums use them.
    Stored,
    /// Position at the last full search, m, its rest, and the smoothing length used in the search, m.
    SearchedAt,
    /// The same when contact candidates were determined, and one for each of them.
    FoundAt,
    /// The same when ghosts were chosen.
    GhostsAt,
    Candidates,
    /// Marks of rows whose neighbours were searched, and of rows that have gained or lost one.
    Patched,
    /// Gradient correction of the strain that the guard of adaptive search counts, and that of the last step.
    StrainCorrection,
    /// For parts of the particles the displacements since then, and the numbers of searched particles: see
    /// [`super::kernels::kept`].
    Ways,
    /// The results of the reduction passes.
    WaysLeft(usize),
    /// Prescribed motion of a particle: its index plus one; zero for none.
    Motion,
    /// Numbers of the step: see [`super::step_numbers`].
    Step,
    /// Force of a particle through a section, from its pairs across the plane, N.
    Section(usize),
    /// Particles of a material.
    Members(usize),
    /// Sums over particles: see [`super::kernels::sums`]. Chunk and body of each segment, the segment of each particle,
    /// parameters of a sum, and sums of lanes and of segments.
    Segments,
    SegmentOf,
    SumNumbers,
    LaneSums,
    Sums,
    /// Data by which reductions select particles: the number of particles with a smaller `id`, and the bits of their
    /// regions.
    PlacesById,
    Regions,
    /// Cells: their number of particles, the index of each particle, where each cell starts, sums and starts of chunks
    /// of cells and of chunks of chunks.
    CellCounts,
    Slots,
    CellStarts,
    ChunkStarts,
    /// Particles cell by cell, in order of insertion and in order of their indices.
    Unsorted,
    Sorted,
    /// Cells around a cell, three steps each.
    Around,
    /// For particles shared with other cards: the particles that others read, in the order of the cards; their values
    /// to be sent, and the received values for the ghosts here, particle by particle.
    Sends,
    Sent,
    Received,
}

/// What the length of a group follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Extent {
    /// Each of its columns has one value of this kind for every particle, ghosts included.
    Particles(Element),
    /// Its rows are not particles, and it is made again when the columns are extended.
    Columns,
    /// It does not depend on the length of the columns, and is kept when they are extended.
    Own,
}

impl Group {
    fn extent(self) -> Extent {
        match self {
            Self::Place
            | Self::BasePlace
            | Self::Velocity
            | Self::BaseVelocity
            | Self::Evaluated
            | Self::Ahead
            | Self::Density
            | Self::BaseDensity
            | Self::Restored
            | Self::Gradient
            | Self::Weight
            | Self::Energy
            | Self::Rates
            | Self::External
            | Self::Deviator
            | Self::Pressure
            | Self::Plastic
            | Self::History
            | Self::Temperature
            | Self::Packed
            | Self::Constants
            | Self::Accounts
            | Self::Walls
            | Self::Audit
            | Self::Limits
            | Self::Reference
            | Self::Earlier
            | Self::Correction
            | Self::CorrectedStress
            | Self::Deformation
            | Self::Stretch
            | Self::Springs
            | Self::FaceStress
            | Self::Outward
            | Self::Standing
            | Self::Overlap
            | Self::Contact
            | Self::Meetings
            | Self::FacetMotion
            | Self::Slips
            | Self::Drives
            | Self::Heat
            | Self::Boundaries
            | Self::Rows
            | Self::SearchedAt
            | Self::FoundAt
            | Self::GhostsAt
            | Self::Candidates
            | Self::StrainCorrection
            | Self::Section(_) => Extent::Particles(Element::Number),
            Self::Body | Self::Motion | Self::Touched | Self::Patched => Extent::Particles(Element::Whole),
            Self::ContactLaws
            | Self::HeatLaws
            | Self::HeatExtremes
            | Self::HeatExtremesLeft(_)
            | Self::Extremes
            | Self::ExtremesLeft(_)
            | Self::Kept
            | Self::Stored
            | Self::Ways
            | Self::WaysLeft(_)
            | Self::CellCounts
            | Self::Slots
            | Self::CellStarts
            | Self::ChunkStarts
            | Self::Unsorted
            | Self::Sorted
            | Self::Around
            | Self::Sent
            | Self::Received => Extent::Columns,
            Self::Surface
            | Self::FacetTable
            | Self::Facets
            | Self::Members(_)
            | Self::ListStarts
            | Self::List
            | Self::Apart
            | Self::Step
            | Self::Sends
            | Self::Segments
            | Self::SegmentOf
            | Self::SumNumbers
            | Self::LaneSums
            | Self::Sums
            | Self::PlacesById
            | Self::Regions => Extent::Own,
        }
    }

    /// Kind of the values that each of its columns has for every particle and that ghosts receive; nothing if rows are
    /// not particles.
    pub(super) fn of_particles(self) -> Option<Element> {
        match self.extent() {
            Extent::Particles(element) => Some(element),
            Extent::Columns | Extent::Own => None,
        }
    }

    /// Whether its length is independent of that of the columns, so that it does not change when these are extended.
    pub(super) fn outlasts_columns(self) -> bool {
        self.extent() == Extent::Own
    }
}

/// A group that a kernel reads.
#[derive(Clone, Copy)]
pub(super) struct Reading {
    buffer: Input,
    stride: u32,
}

/// A group that a kernel writes, and may read.
#[derive(Clone, Copy)]
pub(super) struct Writing {
    buffer: Output,
    stride: u32,
}

fn place(stride: u32, field: usize, i: Index) -> Index {
    if field == 0 { i } else { Index::of(stride * field as u32) + i }
}

/// Reading several columns at a time.
pub(super) trait Fields: Copy {
    fn get(self, field: usize, i: Index) -> Recorded;

    fn vector(self, field: usize, i: Index) -> Vector<Recorded> {
        [0, 1, 2].map(|a| self.get(field + a, i))
    }

    fn symmetric(self, field: usize, i: Index) -> SymmetricTensor<Recorded> {
        SymmetricTensor::from_array([0, 1, 2, 3, 4, 5].map(|a| self.get(field + a, i)))
    }

    fn tensor(self, field: usize, i: Index) -> Tensor<Recorded> {
        [0, 1, 2].map(|a| self.vector(field + 3 * a, i))
    }

    /// A number with its rest.
    fn double(self, field: usize, rest: usize, i: Index) -> [Recorded; 2] {
        [self.get(field, i), self.get(rest, i)]
    }

    /// Three numbers with their rests, which are the three columns behind them.
    fn doubles(self, field: usize, i: Index) -> Vector<Double> {
        [0, 1, 2].map(|a| Double::new(self.double(field + a, field + 3 + a, i)))
    }

    /// A tensor with what rounding left of it in the nine columns behind.
    fn double_tensor(self, i: Index) -> Tensor<Double> {
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| Double::new(self.double(3 * a + b, 9 + 3 * a + b, i))))
    }
}

impl Fields for Reading {
    fn get(self, field: usize, i: Index) -> Recorded {
        self.buffer.at(place(self.stride, field, i))
    }
}

impl Reading {
    /// A number of one of several groups of `length` columns each.
    pub(super) fn get_in_group(self, (group, length): (Index, usize), field: usize, i: Index) -> Recorded {
        let column = group * Index::of(length as u32) + Index::of(field as u32);
        self.buffer.at(column * Index::of(self.stride) + i)
    }

    /// A number by its index in the whole group.
    pub(super) fn get_at(self, at: Index) -> Recorded {
        self.buffer.at(at)
    }
}

impl Fields for Writing {
    fn get(self, field: usize, i: Index) -> Recorded {
        self.buffer.at(place(self.stride, field, i))
    }
}

impl Writing {
    pub(super) fn set(self, field: usize, i: Index, value: Recorded) {
        self.buffer.set(place(self.stride, field, i), value);
    }

    /// Index of a number of one of several groups of `length` columns each.
    fn at(self, group: Index, length: usize, field: usize, i: Index) -> Index {
        (group * Index::of(length as u32) + Index::of(field as u32)) * Index::of(self.stride) + i
    }

    /// Adds to a number of one of several groups of `length` columns each.
    pub(super) fn add_in_group(self, (group, length): (Index, usize), field: usize, i: Index, value: Recorded) {
        let at = self.at(group, length, field, i);
        self.buffer.set(at, self.buffer.at(at) + value);
    }

    pub(super) fn set_in_group(self, (group, length): (Index, usize), field: usize, i: Index, value: Recorded) {
        self.buffer.set(self.at(group, length, field, i), value);
    }

    /// Adds a power times a time, s, to the work of a group, which is followed by its rest; most groups have none.
    pub(super) fn book_in_group(
        self,
        (group, length): (Index, usize),
        (work, power): (usize, usize),
        i: Index,
        dt: Recorded,
    ) {
        let power = self.buffer.at(self.at(group, length, power, i));
        let book = || {
            let [high, low] = [work, work + 1].map(|field| self.at(group, length, field, i));
            let sum = added([self.buffer.at(high), self.buffer.at(low)], dt * power);
            self.buffer.set(high, sum[0]);
            self.buffer.set(low, sum[1]);
            NOTHING
        };
        Recorded::if_lt(Recorded::zero(), power.abs(), book, || NOTHING);
    }

    /// A number of one of several groups of `length` columns each.
    pub(super) fn get_in_group(self, (group, length): (Index, usize), field: usize, i: Index) -> Recorded {
        self.buffer.at(self.at(group, length, field, i))
    }

    /// A number by its index in the whole group.
    pub(super) fn get_at(self, at: Index) -> Recorded {
        self.buffer.at(at)
    }

    /// Writes a number by its index in the whole group.
    pub(super) fn set_at(self, at: Index, value: Recorded) {
        self.buffer.set(at, value);
    }

    pub(super) fn set_all(self, field: usize, i: Index, values: &[Recorded]) {
        for (k, value) in values.iter().enumerate() {
            self.set(field + k, i, *value);
        }
    }

    /// Adds to a number with its rest.
    pub(super) fn add(self, field: usize, rest: usize, i: Index, value: Recorded) {
        let sum = added(self.double(field, rest, i), value);
        self.set(field, i, sum[0]);
        self.set(rest, i, sum[1]);
    }
}

/// Result of a branch or a loop that only stores.
pub(super) const NOTHING: [Recorded; 0] = [];

/// A number and its rest after an addition, keeping the rounding error (Knuth's two-sum).
pub(super) fn added([high, low]: [Recorded; 2], value: Recorded) -> [Recorded; 2] {
    let value = (value + low).rounded();
    let sum = (high + value).rounded();
    let back = (sum - high).rounded();
    [sum, (high - (sum - back).rounded()) + (value - back)]
}

/// Whether the compiler of a card preserves the rounding error of a sum: one that assumes exact arithmetic optimises it
/// to zero.
pub(super) fn keeps_rests(card: &Card) -> Result<bool, CardFault> {
    let kernel = Kernel::record("keeps_rests", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let i = scope.thread();
        let at = |k: u32| i + Index::of(k);
        let sum = added([x.at(at(0)), x.at(at(1))], x.at(at(2)));
        y.set(at(0), sum[0]);
        y.set(at(1), sum[1]);
    });
    let kernel = kernel.map_err(|fault| CardFault::Kernel { kernel: fault.kernel, why: fault.what.to_owned() })?;
    let program = card.compile(&kernel)?;
    let (x, y) = (card.numbers(&[1.0, 0.0, 1e-9])?, card.zeros(2)?);
    card.launch([&card.bind(&program, &[&x, &y], 1)?]);
    Ok(card.read(&y)? == [1.0, 1e-9])
}

/// A kernel that is being recorded, with the groups it has requested so far.
pub(super) struct Binder<'a> {
    pub(super) scope: &'a mut Scope,
    groups: Vec<Group>,
    /// Number of particles.
    stride: u32,
}

impl Binder<'_> {
    pub(super) fn read(&mut self, group: Group) -> Reading {
        self.groups.push(group);
        Reading { buffer: self.scope.input(&format!("{group:?}")), stride: self.stride }
    }

    pub(super) fn write(&mut self, group: Group) -> Writing {
        self.groups.push(group);
        Writing { buffer: self.scope.output(&format!("{group:?}")), stride: self.stride }
    }

    /// Length of the columns.
    pub(super) fn stride(&self) -> Index {
        Index::of(self.stride)
    }

    pub(super) fn indices(&mut self, group: Group) -> Indices {
        self.groups.push(group);
        self.scope.indices(&format!("{group:?}"))
    }

    pub(super) fn index_output(&mut self, group: Group) -> IndexOutput {
        self.groups.push(group);
        self.scope.index_output(&format!("{group:?}"))
    }

    pub(super) fn counters(&mut self, group: Group) -> Counters {
        self.groups.push(group);
        self.scope.counters(&format!("{group:?}"))
    }
}

/// A kernel with the groups of its buffers.
pub(super) struct Recording {
    pub(super) kernel: Kernel,
    pub(super) groups: Vec<Group>,
}

/// Records a kernel of `count` particles.
pub(super) fn recording(
    name: &str,
    count: usize,
    body: impl FnOnce(&mut Binder<'_>, Index),
) -> Result<Recording, KernelFault> {
    let mut groups = Vec::new();
    let kernel = Kernel::record(name, |scope| {
        let thread = scope.thread();
        let mut binder = Binder { scope, groups: Vec::new(), stride: count as u32 };
        body(&mut binder, thread);
        groups = binder.groups;
    })?;
    Ok(Recording { kernel, groups })
}

impl Recording {
    /// The kernel compiled for a card and bound to the columns of an engine.
    pub(super) fn bind(&self, card: &Card, columns: &Columns, threads: usize) -> Result<Launch, CardFault> {
        let program = card.compile(&self.kernel)?;
        let arrays: Vec<&Array> = self.groups.iter().filter_map(|group| columns.array(*group)).collect();
        card.bind(&program, &arrays, threads as u32)
    }
}

/// The groups of an engine, in the memory of its card.
#[derive(Default)]
pub(super) struct Columns {
    arrays: Vec<(Group, Array)>,
}

impl Columns {
    /// Adds a group, or replaces its array.
    pub(super) fn insert(&mut self, group: Group, array: Array) {
        match self.arrays.iter_mut().find(|(of, _)| *of == group) {
            Some((_, known)) => *known = array,
            None => self.arrays.push((group, array)),
        }
    }

    pub(super) fn remove(&mut self, group: Group) {
        self.arrays.retain(|(of, _)| *of != group);
    }

    pub(super) fn into_all(self) -> impl Iterator<Item = (Group, Array)> {
        self.arrays.into_iter()
    }

    pub(super) fn array(&self, group: Group) -> Option<&Array> {
        self.arrays.iter().find(|(of, _)| *of == group).map(|(_, array)| array)
    }

    pub(super) fn all(&self) -> impl Iterator<Item = &(Group, Array)> {
        self.arrays.iter()
    }
}
