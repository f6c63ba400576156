//! The one table of fields: what every column of the particles is called, holds, belongs to and is for.
//!
//! Storage, reordering, lookup by name, ghosts, saved state and the guard follow from a row. Histories of material laws are rows that
//! the laws themselves declare ([`sphorge_physics::history::HistoryVariable`]).

use super::value::Value;
use super::{Column, ColumnVisitor, History, Permutation};
use crate::halo::{Columns, FieldSet, Mirror};
use crate::persist::{Archive, ArchiveError, Fixed, Persist, persist_pieces};
use sphorge_physics::{SymmetricTensor, Tensor, Vector};

/// What a column is kept for; columns of parts that a run does not use take no memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// The state of the material, always there.
    State,
    /// The step of any engine.
    Step,
    /// Gradient correction.
    Correction,
    /// Adaptive search.
    AdaptiveSearch,
    /// The predictor–corrector.
    PredictorCorrector,
    /// Conduction of heat.
    Heat,
    /// Contact between bodies.
    Contact,
    /// Faces of bodies of the total Lagrangian form, at which they meet.
    Faces,
    /// Cells of particles with facets.
    Cells,
    /// Facets of bodies that meet bodies.
    SharedEdges,
    /// Facets of bodies that break and meet themselves.
    BrokenFacets,
    /// Friction between bodies or at walls.
    Friction,
    /// Friction between bodies that meet at facets.
    FacetFriction,
    /// Friction of facets on walls.
    WallFriction,
    /// Artificial stress where temperature is that of the energy.
    ArtificialEnergy,
    /// The reference configuration of the total Lagrangian form.
    Reference,
    /// Its renewal; there from the first on.
    Renewal,
    /// Gradients that are exact for quadratic fields at faces.
    FaceGradients,
    /// Where particles started.
    Start,
}

/// Who may name a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Written to frames unless the deck says otherwise.
    Written,
    /// Written when a deck asks for it.
    OnRequest,
    /// Known to engines alone.
    Internal,
}

/// What the guard asks of a value after every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Nothing.
    None,
    /// Every component is finite.
    Finite,
    /// Finite and above zero.
    Positive,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct ColumnInfo {
    /// Name of the column and of the field.
    pub name: &'static str,
    /// Unit in SI, empty for pure numbers.
    pub unit: &'static str,
    /// One line for people.
    pub meaning: &'static str,
    /// Value type.
    pub kind: super::ColumnKind,
    /// What it is kept for.
    pub owner: Owner,
    /// Who may name it.
    pub access: Access,
    /// How a ghost's value follows from that of the particle it stands for.
    pub mirror: Mirror,
    /// Points of the step at which ghosts take it over.
    pub exchanged: &'static [FieldSet],
    /// What the guard asks.
    pub check: Check,
}

/// Does all of this, in any order and on all threads; nothing is allocated for it.
fn all_at_once(jobs: &mut [&mut (dyn FnMut() + Send)]) {
    match jobs {
        [] => {}
        [job] => job(),
        _ => {
            let (some, others) = jobs.split_at_mut(jobs.len() / 2);
            rayon::join(|| all_at_once(some), || all_at_once(others));
        }
    }
}

macro_rules! columns {
    ($( $visibility:vis $name:ident : $type:ty = $initial:expr, $owner:ident, $access:ident($unit:literal, $meaning:literal),
        $mirror:ident[$($set:ident),*], $check:ident; )+) => {
        /// Particles as columns of equal length, in spatial order; `id` is stable. Columns that a run does not use are empty.
        #[derive(Clone, Debug, Default)]
        pub struct Particles {
            $( #[doc = concat!($meaning, "; unit: ", $unit, ".")] $visibility $name: Vec<$type>, )+
            /// History variables of the material laws in use.
            pub(crate) history: History,
        }

        /// The rows of the table, without the histories of laws.
        pub const COLUMNS: &[ColumnInfo] = &[ $( ColumnInfo {
            name: stringify!($name),
            unit: $unit,
            meaning: $meaning,
            kind: <$type as Value>::KIND,
            owner: Owner::$owner,
            access: Access::$access,
            mirror: Mirror::$mirror,
            exchanged: &[$(FieldSet::$set),*],
            check: Check::$check,
        }, )+ ];

        impl Particles {
            /// `count` particles, every column of the state at its initial value.
            pub fn new(count: usize) -> Self {
                let mut particles = Self::default();
                particles.id = vec![0; count];
                particles.position = vec![[0.0; 3]; count];
                particles.allocate(Owner::State);
                particles
            }

            /// Adds the columns of the state that are not there yet, at their initial values.
            pub fn complete(&mut self) {
                self.allocate(Owner::State);
            }

            /// Adds the columns of an owner, at their initial values.
            pub(crate) fn allocate(&mut self, owner: Owner) {
                let count = self.len();
                let Self { history: _, $( $name ),+ } = self;
                all_at_once(&mut [$( &mut || if owner == Owner::$owner { $name.resize(count, $initial) } ),+]);
            }

            /// Takes the columns of an owner away.
            pub(crate) fn release(&mut self, owner: Owner) {
                $( if owner == Owner::$owner { self.$name = Vec::new(); } )+
            }

            /// Number of particles.
            pub fn len(&self) -> usize {
                self.position.len()
            }

            /// No particles at all.
            pub fn is_empty(&self) -> bool {
                self.position.is_empty()
            }

            /// Moves every column the same way, several at once; see [`Permutation`].
            pub fn reorder(&mut self, permutation: &Permutation) {
                let Self { history, $( $name ),+ } = self;
                all_at_once(&mut [$( &mut || permutation.apply($name) ),+, &mut || history.reorder(permutation)]);
            }

            /// Shows every column in turn, those of a run and those it does not use, always in the same order; afterwards all that are used are of
            /// one length again.
            pub(crate) fn visit(&mut self, visitor: &mut impl ColumnVisitor) {
                $( visitor.visit(&mut self.$name); )+
                self.history.visit(visitor, self.len());
            }

            /// Bytes of the values of one particle in all columns of the run.
            pub(crate) fn width(&self) -> usize {
                self.history.width() $( + if self.$name.is_empty() { 0 } else { <$type as Fixed>::SIZE } )+
            }

            /// Keeps some particles, which have no history yet.
            pub fn keep(&mut self, kept: std::ops::Range<usize>) {
                $( if !self.$name.is_empty() { self.$name = self.$name[kept.clone()].to_vec(); } )+
            }

            /// Bytes held.
            pub fn bytes(&self) -> usize {
                self.history.bytes() $( + size_of::<$type>() * self.$name.capacity() )+
            }

            /// A stored column by its name; `None` for an unknown one.
            pub(crate) fn stored(&self, name: &str) -> Option<Column<'_>> {
                match name {
                    $( stringify!($name) => Some(Value::borrowed(self.$name.as_slice())), )+
                    _ => self.history.column(name).map(|values| Column::Scalar(std::borrow::Cow::Owned(values))),
                }
            }

            /// Sets a stored column by its name; derived and unknown fields are left alone.
            pub fn set_column(&mut self, name: &str, values: &Column<'_>) {
                match name {
                    $( stringify!($name) => Value::copy_from(values, &mut self.$name), )+
                    _ => {
                        if let Column::Scalar(values) = values {
                            self.history.set_column(name, values);
                        }
                    }
                }
            }

            /// The columns that belong to sets, with those of so many ghosts that take them over.
            pub(crate) fn exchanged<'a>(&'a self, sets: &[FieldSet], ghosts: &'a mut Self, count: usize) -> Columns<'a> {
                let mut columns = Columns::new();
                $( if [$(FieldSet::$set),*].iter().any(|set| sets.contains(set)) && !self.$name.is_empty() {
                    ghosts.$name.resize(count, $initial);
                    columns.push(Value::ghosts(Mirror::$mirror, &self.$name, &mut ghosts.$name));
                } )+
                columns
            }

            /// The first field of particle `i`, in the order of the table, that is not what the guard asks for; columns that a run does not
            /// use have no values to ask.
            #[inline(always)]
            pub(crate) fn first_fault(&self, i: usize) -> Option<&'static str> {
                $( match Check::$check {
                    Check::None => {}
                    Check::Finite if self.$name.get(i).is_none_or(|value| value.is_finite()) => {}
                    Check::Positive if self.$name.get(i).is_none_or(|value| value.is_above_zero()) => {}
                    Check::Finite | Check::Positive => return Some(stringify!($name)),
                } )+
                self.history.first_fault(i)
            }
        }

        impl Persist for Particles {
            fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
                $( persist_pieces(&mut self.$name, &format!("{name}.{}", stringify!($name)), archive)?; )+
                self.history.persist(&format!("{name}.history"), archive)?;
                Ok(())
            }
        }
    };
}

/// No stress.
const UNSTRESSED: SymmetricTensor<f64> = SymmetricTensor { xx: 0.0, yy: 0.0, zz: 0.0, xy: 0.0, yz: 0.0, xz: 0.0 };
/// No deformation.
const UNDEFORMED: Tensor<f64> = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

columns! {
    // name: type = initial value, owner, access(unit, meaning), mirror[sets], check
    pub id: u32 = 0, State, Written("", "number given at creation"), Same[Search], None;
    pub body: u32 = 0, State, Written("", "index of the body"), Same[Search], None;
    pub material: u32 = 0, State, OnRequest("", "index of the material"), Same[Search], None;
    // Bit k: region k.
    pub regions: u32 = 0, State, Internal("", "bit set of the regions the particle belongs to"), Unmirrored[], None;
    // Per metre of thickness in plane strain, per square metre in one dimension.
    pub mass: f64 = 0.0, State, OnRequest("kg", "mass"), Same[Search], None;
    pub smoothing_length: f64 = 0.0, State, OnRequest("m", "smoothing length"), Same[Search, Audit, Motion], None;
    pub position: Vector<f64> = [0.0; 3], State, OnRequest("m", "position (always written as the points of a frame)"),
        Point[Search, Audit, Motion], Finite;
    pub velocity: Vector<f64> = [0.0; 3], State, Written("m/s", "velocity"), Vector[Audit], Finite;
    pub acceleration: Vector<f64> = [0.0; 3], State, OnRequest("m/s^2", "acceleration of the last force sum"),
        Unmirrored[], Finite;
    pub density: f64 = 0.0, State, Written("kg/m^3", "density"), Same[Audit, Density, Stress], Positive;
    pub energy: f64 = 0.0, State, Written("J/kg", "specific internal energy"), Unmirrored[], Finite;
    pub energy_rate: f64 = 0.0, State, Internal("W/kg", "rate of the specific internal energy at the last force sum"),
        Unmirrored[], None;
    pub temperature: f64 = 0.0, State, Written("K", "temperature"), Same[Stress], Finite;
    pub pressure: f64 = 0.0, State, Written("Pa", "pressure, positive in compression"), Same[Audit], Finite;
    pub sound_speed: f64 = 0.0, State, OnRequest("m/s", "bulk sound speed"), Unmirrored[], None;
    pub deviator: SymmetricTensor<f64> = UNSTRESSED, State, OnRequest("Pa", "stress deviator"), Symmetric[Audit], Finite;
    // L_ab = dv_a/dx_b.
    pub velocity_gradient: Tensor<f64> = [[0.0; 3]; 3], State, OnRequest("1/s", "velocity gradient"), Tensor[Contact], None;
    pub plastic_strain: f64 = 0.0, State, Written("", "accumulated equivalent plastic strain"), Same[Stress], None;
    pub plastic_strain_increment: f64 = 0.0, State, OnRequest("", "plastic strain added in the last step"),
        Unmirrored[], None;
    pub plastic_strain_rate: f64 = 0.0, State, OnRequest("1/s", "plastic strain added in the last step over its duration"),
        Unmirrored[], None;
    pub yield_stress: f64 = 0.0, State, OnRequest("Pa", "yield stress at the end of the last step"), Same[Stress], None;
    pub plastic_work: f64 = 0.0, State, OnRequest("J/kg", "plastic work per mass"), Unmirrored[], None;
    pub neighbors: u32 = 0, State, OnRequest("", "neighbours inside the kernel support"), Unmirrored[], None;
    // The `AdaptNode` of Fraser.
    pub adapted: u32 = 0, State, OnRequest("", "1 if the neighbours were searched in the last step, otherwise 0"),
        Unmirrored[], None;
    pub last_searched: u32 = 0, State, OnRequest("", "number of the step of the last search"), Unmirrored[], None;

    pub(crate) xsph: Vector<f64> = [0.0; 3], Step, Internal("m/s", "XSPH velocity of the last force sum, times its strength"),
        Unmirrored[], Finite;
    pub(crate) external_acceleration: Vector<f64> = [0.0; 3], Step,
        Internal("m/s^2", "acceleration by walls and gravity, part of the total"), Unmirrored[], None;
    pub(crate) external_power: f64 = 0.0, Step,
        Internal("W/kg", "power of walls beyond that of their force on the centre: heat, and the difference in velocity of the face"), Unmirrored[], None;
    pub(crate) evaluated_velocity: Vector<f64> = [0.0; 3], Step,
        Internal("m/s", "velocity the last force sum was evaluated with"), Vector[Motion, Contact, Stress], None;
    pub(crate) mu: f64 = 0.0, Step, Internal("m/s", "largest |mu| of the last force sum"), Unmirrored[], None;
    // Zero for none.
    pub motion: u32 = 0, Step, Internal("", "index of the prescribed motion plus one"), Unmirrored[], None;

    pub(crate) correction: Tensor<f64> = UNDEFORMED, Correction, Internal("", "gradient correction B"), Unmirrored[], None;

    pub(crate) strain_since_search: f64 = 0.0, AdaptiveSearch,
        Internal("", "integral of |D| since the last search of the particle"), Unmirrored[], None;
    pub(crate) strain_correction: Tensor<f64> = UNDEFORMED, AdaptiveSearch,
        Internal("", "gradient correction B of the strain that the guard counts, some steps old"), Unmirrored[], None;
    pub(crate) plastic_since_search: f64 = 0.0, AdaptiveSearch,
        Internal("", "plastic strain since the last search of the particle"), Unmirrored[], None;
    pub(crate) origin: Vector<f64> = [0.0; 3], AdaptiveSearch, Internal("m", "position at the start"), Unmirrored[], None;
    pub(crate) searched_at: Vector<f64> = [0.0; 3], AdaptiveSearch,
        Internal("m", "position at the last full search"), Unmirrored[], None;

    pub(crate) base_position: Vector<f64> = [0.0; 3], PredictorCorrector,
        Internal("m", "position at the start of the step"), Unmirrored[], None;
    pub(crate) base_velocity: Vector<f64> = [0.0; 3], PredictorCorrector,
        Internal("m/s", "velocity at the start of the step"), Unmirrored[], None;
    pub(crate) base_density: f64 = 0.0, PredictorCorrector,
        Internal("kg/m^3", "density at the start of the step"), Unmirrored[], None;

    pub(crate) heat_rate: f64 = 0.0, Heat, Internal("W/kg", "heat that flows in"), Unmirrored[], None;
    // Only with the total Lagrangian form.
    pub(crate) heat_flow: Vector<f64> = [0.0; 3], Reference,
        Internal("W/m^2", "heat flow q B that deformation adds, in the initial configuration"),
        Vector[IntermediateSums], None;

    pub(crate) contact_overlap: f64 = 0.0, Contact, Internal("", "sum_j V_j W_ij / S_ab - 1 over other bodies"),
        Same[Overlaps], None;
    pub(crate) contact_direction: Vector<f64> = [0.0; 3], Contact,
        Internal("1/m", "- gradient of the contact overlap, away from other bodies"), Vector[Overlaps], None;
    pub(crate) contact_weight: f64 = 0.0, Contact, Internal("m^2", "sum_j V_i V_j |dW/dr| over other bodies"),
        Same[Overlaps], None;
    pub(crate) friction_heat: f64 = 0.0, Friction, Internal("W/kg", "heat of friction at the last force sum"), Unmirrored[], None;

    pub(crate) artificial_energy: f64 = 0.0, ArtificialEnergy,
        Internal("J/kg", "work of the artificial stress in the internal energy"), Unmirrored[], None;
    pub(crate) artificial_power: f64 = 0.0, ArtificialEnergy,
        Internal("W/kg", "power of the artificial stress at the last force sum"), Unmirrored[], None;

    pub(crate) reference_position: Vector<f64> = [0.0; 3], Reference, Internal("m", "initial position X"), Point[Search], None;
    // m² in plane strain, m in one dimension.
    pub(crate) reference_volume: f64 = 0.0, Reference, Internal("m^3", "initial volume"), Same[Search], None;
    pub deformation: Tensor<f64> = UNDEFORMED, Reference, Internal("", "deformation gradient from the reference configuration"), Tensor[Contact, Stress], None;
    pub(crate) face_stress: Tensor<f64> = [[0.0; 3]; 3], Reference,
        Internal("Pa", "first Piola-Kirchhoff stress of the forces of walls and contacts, which act on faces"), Unmirrored[], None;
    pub(crate) smallest_stretch: f64 = 1.0, Reference,
        Internal("", "smallest principal stretch from the reference configuration"), Unmirrored[], None;
    // Zero where the gradient correction was left out: there are no springs then.
    pub(crate) yielded_stretch: f64 = 1.0, Reference,
        Internal("", "the smallest at which the particle has yielded since the reference configuration"), Unmirrored[], None;
    pub(crate) spring_stiffness: f64 = 0.0, Reference, Internal("Pa", "stiffness of the hourglass springs"), Same[Stress], None;
    pub(crate) spring_misfit: f64 = 0.0, Reference,
        Internal("", "mean square of the strain that the hourglass springs resist, at the last force sum"), Unmirrored[], None;
    pub(crate) spring_moment: Tensor<f64> = [[0.0; 3]; 3], Reference,
        Internal("Pa", "first Piola-Kirchhoff stress of the moment of the hourglass springs, at the last force sum"), Unmirrored[], None;
    pub(crate) viscous_pressure: f64 = 0.0, Reference, Internal("Pa", "bulk viscosity of the last stress"), Unmirrored[], None;
    pub(crate) divergence_once: f64 = 0.0, Reference,
        Internal("1/s", "divergence of the velocity, filtered over the time that sound takes over a smoothing length"), Unmirrored[], None;
    pub(crate) divergence_twice: f64 = 0.0, Reference, Internal("1/s", "the same, filtered again"), Unmirrored[], None;
    pub(crate) damping_rate: f64 = 0.0, Reference, Internal("1/s", "how fast viscosity damps neighbours that swing against each other"), Unmirrored[], None;
    pub(crate) reference_normal: Vector<f64> = [0.0; 3], Faces,
        Internal("1/m", "outward normal of the surface in the reference configuration, zero inside"), Vector[Search], None;
    pub(crate) face_arm: Vector<f64> = [0.0; 3], Faces,
        Internal("m", "depth below the nearest face, times its outward unit normal, in the initial configuration; zero far inside"),
        Unmirrored[], None;
    pub(crate) contact_shift: Vector<f64> = [0.0; 3], Faces,
        Internal("m", "from the position to the point at which the contact places the particle"), Vector[Contact], None;
    pub(crate) contact_shift_rate: Vector<f64> = [0.0; 3], Faces, Internal("m/s", "its rate"), Vector[Contact], None;
    // Springs see the deformation gradient of the sums, which is this more.
    pub(crate) face_excess: Tensor<f64> = [[0.0; 3]; 3], FaceGradients,
        Internal("", "what has been taken from the deformation gradient of the sums"), Tensor[Stress], None;
    pub earlier_deformation: Tensor<f64> = UNDEFORMED, Renewal,
        Internal("", "deformation gradient of the reference configuration"), Tensor[Contact], None;
    pub(crate) kept_overlap: f64 = 0.0, Renewal,
        Internal("", "overlap that a body had where it came apart, from which on it presses; it falls with the overlap"), Unmirrored[], None;
    // Wrapped with the position: behind a periodic end it is a period farther.
    pub initial_position: Vector<f64> = [0.0; 3], Start, Internal("m", "position at the start"), Unmirrored[], None;

    pub(crate) evaluated_gradient: Tensor<f64> = [[0.0; 3]; 3], Cells,
        Internal("1/s", "velocity gradient at which the facets of the last force sum moved"), Tensor[Contact], None;
    // A row for each axis of the cell.
    pub(crate) shifts_of_low_edges: Tensor<f64> = [[0.0; 3]; 3], SharedEdges,
        Internal("m", "how far the edges of facets on the low sides of the cell are from where it carries them"), Tensor[Contact], None;
    pub(crate) shifts_of_high_edges: Tensor<f64> = [[0.0; 3]; 3], SharedEdges,
        Internal("m", "the same for the high sides"), Tensor[Contact], None;
    pub(crate) pulls_of_low_edges: Tensor<f64> = [[0.0; 3]; 3], SharedEdges,
        Internal("N", "forces on the distances of these edges on the low sides of the cell"), Tensor[Stress], None;
    pub(crate) pulls_of_high_edges: Tensor<f64> = [[0.0; 3]; 3], SharedEdges,
        Internal("N", "the same for the high sides"), Tensor[Stress], None;
    pub(crate) facet_integrity: f64 = 1.0, BrokenFacets,
        Internal("", "integrity at which the body of the particle meets itself at its facets"), Same[Contact], None;
    // A row for each axis of the cell: along the first edge of the facet and square to it, m, and the stiffness, N/m.
    pub(crate) slip_of_low_faces: Tensor<f64> = [[0.0; 3]; 3], FacetFriction,
        Internal("m", "tangential springs of the facets on the low sides of the cell"), Tensor[Overlaps], None;
    pub(crate) slip_of_high_faces: Tensor<f64> = [[0.0; 3]; 3], FacetFriction,
        Internal("m", "tangential springs of the facets on the high sides of the cell"), Tensor[Overlaps], None;
    pub(crate) rubbed_at_low_faces: Vector<f64> = [0.0; 3], FacetFriction,
        Internal("m^2/s", "power of friction over the stiffness of these springs, by axis of the cell"), Vector[Overlaps], None;
    pub(crate) rubbed_at_high_faces: Vector<f64> = [0.0; 3], FacetFriction,
        Internal("m^2/s", "the same for the high sides"), Vector[Overlaps], None;
    pub(crate) wall_slip_of_low_faces: Tensor<f64> = [[0.0; 3]; 3], WallFriction,
        Internal("m", "tangential springs against walls of the facets on the low sides of the cell"), Unmirrored[], None;
    pub(crate) wall_slip_of_high_faces: Tensor<f64> = [[0.0; 3]; 3], WallFriction,
        Internal("m", "the same for the high sides"), Unmirrored[], None;
    pub(crate) rubbed_on_walls_at_low_faces: Vector<f64> = [0.0; 3], WallFriction,
        Internal("m^2/s", "power of friction on walls over the stiffness of these springs, by axis of the cell"), Unmirrored[], None;
    pub(crate) rubbed_on_walls_at_high_faces: Vector<f64> = [0.0; 3], WallFriction,
        Internal("m^2/s", "the same for the high sides"), Unmirrored[], None;
}

impl Particles {
    /// Index and distance, m, of the particle nearest to a point, of one body if given; of several as near the one with the least id.
    pub fn nearest(&self, point: Vector<f64>, body: Option<usize>) -> Option<(usize, f64)> {
        self.nearest_squared(point, body).map(|(i, squared)| (i, squared.sqrt()))
    }

    /// The same with the distance squared, m².
    pub(crate) fn nearest_squared(&self, point: Vector<f64>, body: Option<usize>) -> Option<(usize, f64)> {
        let squared = |i: usize| (0..3).map(|a| (self.position[i][a] - point[a]).powi(2)).sum::<f64>();
        (0..self.len())
            .filter(|&i| body.is_none_or(|body| self.body[i] as usize == body))
            .map(|i| (i, squared(i)))
            .min_by(|a, b| a.1.total_cmp(&b.1).then(self.id[a.0].cmp(&self.id[b.0])))
    }
}
