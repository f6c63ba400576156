//! The one table of what kernels bind: every group of columns, when a model has it, and its columns by name.
//!
//! A row makes a variant of [`Group`] and, where it declares columns, a structure of [handles](super::handles) of the
//! same name. A new column is a line here, and nothing else has to know how many there are.

use super::handles::{
    Compensated, CompensatedNumbers, CompensatedTensor, CompensatedVector, Handles, Number, Numbers, SymmetricColumns,
    TensorColumns, VectorColumns, Vectors,
};
use crate::record::Element;
use sphorge_engine::model::{Integrator, Model};
use sphorge_engine::particles::HistoryVariables;

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

/// `particles`: columns that are made with those of all particles. `feature`: the same, made where a feature needs
/// them. `whole`: whole numbers of particles. `columns`, `own`: rows that are not particles.
macro_rules! extent {
    (particles) => {
        Extent::Particles(Element::Number)
    };
    (feature) => {
        Extent::Particles(Element::Number)
    };
    (whole) => {
        Extent::Particles(Element::Whole)
    };
    (columns) => {
        Extent::Columns
    };
    (own) => {
        Extent::Own
    };
}

macro_rules! is_made_with_particles {
    (particles) => {
        true
    };
    ($other:ident) => {
        false
    };
}

/// A structure of handles.
macro_rules! handles {
    ($(#[$doc:meta])* $name:ident, $group:expr, $($field:ident: $kind:ident $([$n:literal])?),*) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub(in crate::engine) struct $name<S> {
            source: S,
            first: usize,
            $(pub(in crate::engine) $field: $kind<S $(, $n)?>,)*
        }

        impl<S: Copy> Handles<S> for $name<S> {
            type From<T: Copy> = $name<T>;

            const LENGTH: usize = 0 $(+ <$kind::<S $(, $n)?>>::WIDTH)*;

            const GROUP: Group = $group;

            fn at(source: S, first: usize) -> Self {
                let mut next = first;
                $(
                    let $field = <$kind::<S $(, $n)?>>::at(source, next);
                    next += <$kind::<S $(, $n)?>>::WIDTH;
                )*
                debug_assert_eq!(next, first + Self::LENGTH);
                Self { source, first, $($field),* }
            }

            fn source(self) -> S {
                self.source
            }

            fn first(self) -> usize {
                self.first
            }
        }
    };
}

/// A group of columns of particles that are made with those of all others.
struct Row {
    group: Group,
    is_made_with_particles: bool,
    /// Number of its columns, for each member if there are several.
    columns: usize,
    needed: &'static [fn(&Model) -> bool],
    members: &'static [fn(&Model) -> usize],
}

macro_rules! groups {
    ($(
        $(#[$doc:meta])*
        $name:ident $(($index:ty))?: $extent:ident $(if $needed:ident)? $(per $member:ident)?
            $({ $($field:ident: $kind:ident $([$n:literal])?),* $(,)? })?;
    )*) => {
        /// A group of one or more contiguous columns. Numbers that a step adds to have the remainder of their rounding
        /// in a column of its own, called the low part.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub(in crate::engine) enum Group {
            $($(#[$doc])* $name $(($index))?,)*
        }

        impl Group {
            fn extent(self) -> Extent {
                match self {
                    $(Self::$name { .. } => extent!($extent),)*
                }
            }
        }

        const ROWS: &[Row] = &[
            $(Row {
                group: Group::$name $((<$index>::MIN))?,
                is_made_with_particles: is_made_with_particles!($extent),
                columns: 0 $($(+ <$kind::<() $(, $n)?>>::WIDTH)*)?,
                needed: &[$($needed)?],
                members: &[$($member)?],
            },)*
        ];

        $($(handles! {
            /// Handles of the columns of the group of this name.
            $name, Group::$name, $($field: $kind $([$n])?),*
        })?)*
    };
}

groups! {
    /// Position, m, and its low part.
    Place: particles { position: CompensatedVector };
    /// The same at the start of the step.
    BasePlace: particles if predicts { position: CompensatedVector };
    /// Velocity, m/s, and its low part.
    Velocity: particles { velocity: CompensatedVector };
    /// The same at the start of the step, and the acceleration it was predicted with, m/s².
    BaseVelocity: particles if predicts { velocity: CompensatedVector, acceleration: VectorColumns };
    /// Velocity that forces are evaluated with, m/s.
    Evaluated: particles { velocity: VectorColumns };
    /// Velocity minus that, m/s.
    Ahead: particles if leaps { velocity: VectorColumns };
    /// Density, kg/m³, and its low part.
    Density: particles { density: Compensated };
    /// The same at the start of the step.
    BaseDensity: particles if predicts { density: Compensated };
    /// Density by moving least squares, kg/m³.
    Restored: feature { density: Number };
    /// Velocity gradient, 1/s.
    Gradient: particles { velocity_gradient: TensorColumns };
    /// Weight of the particle in the sums of its neighbours, and their number.
    Weight: particles { weight: Number, neighbors: Number, factor: Number };
    /// Specific internal energy, J/kg, its low part, its rate, W/kg, and the parts of the rate due to pair viscosity,
    /// artificial stress and hourglass springs.
    Energy: particles {
        energy: Compensated,
        rate: Number,
        viscous_rate: Number,
        artificial_stress_rate: Number,
        hourglass_rate: Number,
    };
    /// Acceleration, m/s², XSPH velocity, m/s, and the largest `|mu|`, m/s.
    Rates: particles {
        acceleration: VectorColumns,
        smoothing_velocity: VectorColumns,
        largest_mu: Number,
    };
    /// Acceleration by walls and gravity, m/s², power of walls beyond that of their force on the centre, W/kg, and heat
    /// of their friction, W/kg.
    External: particles { acceleration: VectorColumns, power: Number, friction_heat: Number };
    /// Deviator of the stress, Pa.
    Deviator: particles { deviator: SymmetricColumns };
    /// Pressure, Pa, sound speed, m/s, and shear modulus, Pa.
    Pressure: particles { pressure: Number, sound_speed: Number, shear_modulus: Number };
    /// Plastic strain and its low part, its last increment, yield stress, Pa, plastic work, J/kg, and its low part.
    Plastic: particles {
        strain: Compensated,
        increment: Number,
        yield_stress: Number,
        work: Compensated,
    };
    /// History variables of flow laws, each with its low part.
    History: particles per history_variable { value: Compensated };
    /// Temperature, K, and its low part.
    Temperature: particles { temperature: Compensated };
    /// Data of a neighbour that forces read: scaled stress, scaled artificial stress, Pa, Balsara's switch, sound
    /// speed, m/s; in the total Lagrangian form the tensor whose sum is the force, and the stiffness of the hourglass
    /// springs, Pa.
    Packed: particles {
        stress: SymmetricColumns,
        artificial_stress: SymmetricColumns,
        balsara: Number,
        sound_speed: Number,
    };
    /// Mass, kg, smoothing length, m, coefficient of the artificial stress, spacing, m, sound speed at rest, m/s, Young's modulus, Pa, and
    /// volume of the mass at rest, m^d, and smoothing length of the start, m.
    Constants: particles {
        mass: Number,
        smoothing_length: Number,
        artificial_stress: Number,
        spacing: Number,
        sound_speed: Number,
        young_modulus: Number,
        volume_at_rest: Number,
        initial_smoothing_length: Number,
    };
    /// Body of a particle.
    Body: whole;
    /// Work of forces other than pair forces, J, their impulse, N s, correction of the energy by the integrator, J,
    /// heat by viscosity, J, work against the artificial stress and against the hourglass springs, J, and energy that
    /// moving least squares add to the pressure field, J, each with its low part.
    Accounts: particles {
        external_work: Compensated,
        impulse: CompensatedNumbers[3],
        integration: Compensated,
        viscous: Compensated,
        artificial_stress: Compensated,
        hourglass: Compensated,
        moving_least_squares: Compensated,
    };
    /// Work of each wall, J, its low part, and the power of the last forces, W.
    Walls: feature { works: CompensatedNumbers[3], powers: Numbers[3] };
    /// Sums of an audit over the list of a particle and over all its neighbours: see [`crate::engine::kernels::audit`].
    Audit: particles if audits { of_list: Numbers[8], exact: Numbers[10] };
    /// For each particle the time step limits by sound and by acceleration, s, four changes of the step, whether a
    /// value is not a number, and whether the particle is stretched beyond the bound of the reference configuration.
    Limits: particles {
        by_sound: Number,
        by_acceleration: Number,
        by_contact: Number,
        changes: Numbers[4],
        is_broken: Number,
        is_stretched: Number,
        facet_reach: Number,
        neighbors: Number,
    };
    /// The same for parts of the particles, and the results of the reduction passes.
    Extremes: columns;
    ExtremesLeft(usize): columns;
    /// Position in the reference configuration, m, its low part, and volume in it, m^d, with its low part.
    Reference: particles if is_total_lagrangian { position: CompensatedVector, volume: Compensated };
    /// Deformation gradient of the reference configuration, and its low part, once it is not the initial one; by body,
    /// whether it has separated, and whether its configuration is to be renewed.
    Earlier: feature { deformation: CompensatedTensor };
    Apart: own;
    /// Gradient correction in the reference or in the current configuration.
    Correction: particles if corrects { correction: TensorColumns };
    /// Scaled stress times the gradient correction, Pa.
    CorrectedStress: particles if corrects_current_gradients { stress: TensorColumns };
    /// Deformation gradient, and its low part.
    Deformation: particles if is_total_lagrangian { deformation: CompensatedTensor };
    /// Smallest principal stretch, bulk viscosity of the last stress, Pa, whether a stretch is beyond a bound, and of the viscosity what damps pairs in shocks,
    /// `chi c rho_0`, Pa s/m, and how fast all of it damps, 1/s; the divergence of the velocity filtered once and twice, 1/s.
    Stretch: particles if is_total_lagrangian {
        smallest: Number,
        bulk_viscosity: Number,
        is_beyond: Number,
        impedance: Number,
        damping_rate: Number,
        divergence_once: Number,
        divergence_twice: Number,
    };
    /// Hourglass springs: the least stretch at which the particle has yielded, zero where there are no springs, and of the
    /// last force sum the mean square of their misfit, and the stress of their moment, Pa.
    Springs: particles if is_total_lagrangian { least_stretch: Number, misfit: Number, moment: TensorColumns };
    /// Where gradients are exact for quadratic fields at faces, see [`crate::engine::kernels::face_sums`]: sums that are exact for linear fields,
    /// 1/s, and the same at the velocities at which forces are evaluated; what is taken from those of particles at faces, 1/s, and the sum of that
    /// over time; stress that is added to that of particles near faces, Pa, and their power from others, W/kg.
    FaceLinear: particles if is_quadratic_at_faces { gradient: TensorColumns };
    FaceEvaluated: feature;
    FaceTaken: particles if is_quadratic_at_faces { rate: TensorColumns };
    FaceExcess: particles if is_quadratic_at_faces { excess: CompensatedTensor };
    FaceShare: particles if is_quadratic_at_faces { stress: TensorColumns, power: Number };
    /// Particles at faces, and of each row the start of its terms, neighbours, their `q_ij`, 1/m, `K_i`, m, and `sum_j q_ij`, 1/m. Row zero is
    /// that of particles at none.
    FaceParticles: own;
    FaceStarts: own;
    FaceEntries: own;
    FaceTerms: own { q: VectorColumns };
    FaceTable: own { contraction: Numbers[27], whole: VectorColumns };
    /// Of each row `R_i`, Pa m, and a power.
    FaceSpread: own;
    /// Particles near faces, the start of the terms of each, rows of the faces they are neighbours of, `V_j/V_i q_ji`, 1/m, and its own row.
    NearParticles: own;
    NearStarts: own;
    NearEntries: own;
    NearTerms: own;
    NearFaces: own;
    /// The row of every particle, if particles with facets need it.
    FaceRows: whole;
    /// First Piola-Kirchhoff stress of the forces of walls and of the contact, which act on faces, Pa.
    FaceStress: particles if is_total_lagrangian { stress: TensorColumns };
    /// Particles that may be in contact: those of the surface if there is only self-contact of one body, all if there
    /// are several bodies.
    Surface: own;
    /// For these, in the total Lagrangian form: outward normal in the reference configuration, 1/m, zero inside, and
    /// depth below the face times its unit normal, m, zero far inside.
    Outward: feature { normal: VectorColumns, arm: VectorColumns };
    /// Their contact position, m, its low part, its velocity relative to the particle, m/s, and the outward unit normal.
    Standing: particles if has_contact_positions {
        position: CompensatedVector,
        velocity: VectorColumns,
        normal: VectorColumns,
    };
    /// Overlap, its negative gradient, 1/m, and weight, m^(d-1).
    Overlap: particles if overlaps { overlap: Number, away: VectorColumns, weight: Number };
    /// Contact force, N, its power that becomes heat of the particle, W, speed of approach, m/s, limit of the step, s.
    Contact: particles if has_contact { force: VectorColumns, heat: Number, approach: Number, limit: Number };
    /// For the contact with each body: force, N, powers stored, of friction and of damping, W, these works so far, J,
    /// each with its low part, and the energy that facets hold, J.
    Meetings: particles if has_contact per body {
        force: VectorColumns,
        powers: Numbers[3],
        works: CompensatedNumbers[3],
        energy: Number,
    };
    /// Facets of the initial configuration, of each particle the first, the one behind its last and its `id`, and for
    /// particles velocity gradient, 1/s, and reach of facets, m: see [`crate::engine::kernels::facets`].
    FacetTable: own {
        corners: Vectors[4],
        middle: VectorColumns,
        normal: VectorColumns,
        curvature: SymmetricColumns,
        depth: Number,
        face: Number,
        part: Number,
        free: Numbers[4],
        across: TensorColumns,
    };
    Facets: own;
    /// What is beside the cells of particles with facets, and a row of zeros for the others: ways to the particles there at the start, m, zero where there is none,
    /// and the sides of their cells that look back. Shifts of the edges of these, m, their rates, m/s, and the forces that they pull by, N.
    BesideTable: own { ways: Vectors[6], facing: Numbers[6] };
    SharedEdges: particles if has_facets per face_of_cell { shift: VectorColumns, rate: VectorColumns };
    EdgePulls: particles if has_facets per face_of_cell { pull: VectorColumns };
    FacetMotion: particles if has_facets { velocity_gradient: TensorColumns, reach: Number };
    /// With friction, of each face of a cell the tangential spring, and sums over its pairs.
    Slips: particles if rubs_at_facets per face_of_cell { slip: Numbers[2], stiffness: Number, rubbed: Number };
    Drives: particles if rubs_at_facets per face_of_cell { parts: Numbers[5] };
    /// Contact laws for all pairs of bodies.
    ContactLaws: columns {
        inverse_sums: Numbers[2],
        modulus: Number,
        damping: Number,
        friction: Number,
        friction_share: Number,
    };
    /// Heat conduction: see [`crate::engine::kernels::conduction`]. For particles, what replaces missing pairs of them, for each boundary, the body that a particle
    /// touches, laws of each body, for parts of the particles, and the results of the reduction passes.
    Heat: particles if conducts { rate: Number, limit: Number, exchanged: Compensated, flow: VectorColumns };
    Replacement: particles if conducts { replacement: SymmetricColumns };
    Boundaries: feature { claimed: Number, outline: Number, power: Number, supplied: Compensated };
    Touched: whole;
    HeatLaws: columns {
        conductivity: Number,
        specific_heat: Number,
        correction: Number,
        surface: Number,
        most_replaced: Number,
    };
    HeatExtremes: columns;
    HeatExtremesLeft(usize): columns;
    /// Start of the list of each particle, and the neighbours.
    ListStarts: own;
    List: own;
    /// Stored lists, the first neighbour of every particle before the second of any, and their lengths: see
    /// [`crate::engine::kernels::verlet`].
    Kept: columns;
    Rows: feature {
        length: Number,
        is_marked: Number,
        strain: Number,
        plastic_strain: Number,
        last_searched: Number,
    };
    /// Distances of their pairs at the last search, m, three for each, if sums use them.
    Stored: columns;
    /// Position at the last full search, m, its low part, and the smoothing length used in the search, m.
    SearchedAt: feature { position: CompensatedVector, smoothing_length: Number };
    /// Position when contact candidates were determined, m, its low part, and one for each of them.
    FoundAt: feature { position: CompensatedVector };
    /// The same when ghosts were chosen; kernels read its columns as those of [`FoundAt`].
    GhostsAt: feature { _position: CompensatedVector };
    Candidates: feature { is_candidate: Number };
    /// Marks of rows whose neighbours were searched, and of rows that have gained or lost one.
    Patched: whole;
    /// Gradient correction of the strain that the guard of adaptive search counts, and that of the last step.
    StrainCorrection: feature { correction: TensorColumns, strain: Number };
    /// For parts of the particles the displacements since then, and the numbers of searched particles: see
    /// [`crate::engine::kernels::verlet`].
    Ways: columns;
    /// The results of the reduction passes.
    WaysLeft(usize): columns;
    /// Prescribed motion of a particle: its index plus one; zero for none.
    Motion: whole;
    /// Numbers of the step: see [`crate::engine::step_numbers`].
    Step: own {
        dt: Number,
        half: Number,
        gravity: VectorColumns,
        capacity: Number,
        number: Number,
        ghosts_before: Number,
        end: Number,
    };
    /// Force of a particle through a section, from its pairs across the plane, N.
    Section(usize): feature;
    /// Particles of a material.
    Members(usize): own;
    /// Sums over particles: see [`crate::engine::kernels::sums`]. Chunk and body of each segment, the segment of each particle,
    /// parameters of a sum, and sums of lanes and of segments.
    Segments: own;
    SegmentOf: own;
    SumNumbers: own;
    LaneSums: own;
    Sums: own;
    /// Data by which reductions select particles: the number of particles with a smaller `id`, and the bits of their
    /// regions.
    PlacesById: own;
    Regions: own;
    /// Cells: their number of particles, the index of each particle, where each cell starts, sums and starts of chunks
    /// of cells and of chunks of chunks.
    CellCounts: columns;
    Slots: columns;
    CellStarts: columns;
    ChunkStarts: columns;
    /// Particles cell by cell, in order of insertion and in order of their indices.
    Unsorted: columns;
    Sorted: columns;
    /// Cells around a cell, three steps each.
    Around: columns;
    /// For particles shared with other GPUs: the particles that others read, in the order of the GPUs; their values
    /// to be sent, and the received values for the ghosts here, particle by particle.
    Sends: own;
    Sent: columns;
    Received: columns;
}

handles! {
    /// [`Group::Packed`] in the total Lagrangian form: the tensor whose sum is the force, the stiffness of the
    /// hourglass springs, Pa, and the impedance in shocks, Pa s/m.
    PulledBack, Group::Packed, tensor: TensorColumns, stiffness: Number, impedance: Number
}

handles! {
    /// [`Group::Section`] of one section.
    Section, Group::Section(0), force: VectorColumns
}

handles! {
    /// [`Group::ContactLaws`] of bodies that meet at facets.
    FacetLaws, Group::ContactLaws,
    stiffness: Number, damping: Number, friction: Number, tangential_stiffness: Number, gives_way: Number,
    friction_share: Number
}

handles! {
    /// Displacement, m, and velocity, m/s, of a wall among the numbers of [`Group::Step`].
    WallOfStep, Group::Step, displacement: VectorColumns, velocity: VectorColumns
}

handles! {
    /// A prescribed motion among the numbers of [`Group::Step`]: one along each prescribed axis, velocities at the
    /// middle and at the end of the step, m/s.
    MotionOfStep, Group::Step, is_prescribed: VectorColumns, middle: VectorColumns, end: VectorColumns
}

impl Group {
    /// Kind of the values that each of its columns has for every particle and that ghosts receive; nothing if rows are
    /// not particles.
    pub(in crate::engine) fn of_particles(self) -> Option<Element> {
        match self.extent() {
            Extent::Particles(element) => Some(element),
            Extent::Columns | Extent::Own => None,
        }
    }

    /// Whether its length is independent of that of the columns, so that it does not change when these are extended.
    pub(in crate::engine) fn outlasts_columns(self) -> bool {
        self.extent() == Extent::Own
    }
}

/// Groups that are made with the columns of particles, with their number of columns, that a model needs.
pub(in crate::engine) fn made_with_particles(model: &Model) -> impl Iterator<Item = (Group, usize)> {
    let is_needed = move |row: &&Row| row.is_made_with_particles && row.needed.iter().all(|is_needed| is_needed(model));
    let columns = move |row: &Row| row.columns * row.members.iter().map(|members| members(model)).product::<usize>();
    ROWS.iter().filter(is_needed).map(move |row| (row.group, columns(row))).filter(|(_, columns)| *columns > 0)
}

/// Faces of the cell of a particle.
pub(in crate::engine) const FACES: usize = 6;

fn predicts(model: &Model) -> bool {
    model.numerics.integrator == Integrator::PredictorCorrector
}

fn leaps(model: &Model) -> bool {
    model.numerics.integrator == Integrator::Leapfrog
}

fn is_total_lagrangian(model: &Model) -> bool {
    model.is_total_lagrangian()
}

fn is_quadratic_at_faces(model: &Model) -> bool {
    model.formulation.is_quadratic_at_faces()
}

fn corrects_current_gradients(model: &Model) -> bool {
    model.corrects_current_gradients()
}

fn corrects(model: &Model) -> bool {
    model.is_total_lagrangian() || model.corrects_current_gradients()
}

fn has_contact(model: &Model) -> bool {
    model.has_contact()
}

fn has_facets(model: &Model) -> bool {
    model.has_facets()
}

fn has_contact_positions(model: &Model) -> bool {
    model.has_contact() && model.is_total_lagrangian() && model.sorts_by_contact_positions()
}

fn overlaps(model: &Model) -> bool {
    model.has_contact() && !model.has_facets()
}

fn rubs_at_facets(model: &Model) -> bool {
    model.has_facets() && model.contact.has_friction()
}

fn conducts(model: &Model) -> bool {
    model.thermal.conduction
}

fn audits(model: &Model) -> bool {
    model.audit.is_some()
}

fn body(model: &Model) -> usize {
    model.bodies.len()
}

fn history_variable(model: &Model) -> usize {
    HistoryVariables::of(model).variables.len()
}

fn face_of_cell(_: &Model) -> usize {
    FACES
}
