//! The one table of stored fields: the group each is read from, and how.

use super::columns::{
    Compensated, CompensatedTensor, CompensatedVector, Group, Layout, Member, Number, TensorColumns, VectorColumns,
    groups,
};
use super::read_back::Group64;
use super::snapshot::ColumnReader;
use sphorge_engine::Column;
use sphorge_physics::SymmetricTensor;

/// A stored field that steps change.
pub(super) struct StoredField {
    name: &'static str,
    pub(super) group: Group,
    /// Whether it is read from the GPU; otherwise it is that of the start.
    pub(super) is_stored: fn(&ColumnReader<'_>) -> bool,
    pub(super) read: fn(&FieldReader<'_>) -> Column<'static>,
}

const fn row(name: &'static str, group: Group, read: fn(&FieldReader<'_>) -> Column<'static>) -> StoredField {
    StoredField { name, group, is_stored: |_| true, read }
}

const FIELDS: &[StoredField] = &[
    row("position", Group::Place, |of| of.compensated_vector(groups::Place::layout().position)),
    row("velocity", Group::Velocity, |of| of.compensated_vector(groups::Velocity::layout().velocity)),
    row("density", Group::Density, |of| of.compensated(groups::Density::layout().density)),
    row("energy", Group::Energy, |of| of.compensated(groups::Energy::layout().energy)),
    row("energy_rate", Group::Energy, |of| of.number(groups::Energy::layout().rate)),
    row("temperature", Group::Temperature, |of| of.compensated(groups::Temperature::layout().temperature)),
    row("plastic_strain", Group::Plastic, |of| of.compensated(groups::Plastic::layout().strain)),
    row("plastic_strain_increment", Group::Plastic, |of| of.number(groups::Plastic::layout().increment)),
    row("plastic_strain_rate", Group::Plastic, |of| of.plastic_strain_rate()),
    row("yield_stress", Group::Plastic, |of| of.yield_stress()),
    row("plastic_work", Group::Plastic, |of| of.compensated(groups::Plastic::layout().work)),
    row("acceleration", Group::Rates, |of| of.vector(groups::Rates::layout().acceleration)),
    row("deviator", Group::Deviator, |of| of.deviator()),
    row("pressure", Group::Pressure, |of| of.number(groups::Pressure::layout().pressure)),
    row("sound_speed", Group::Pressure, |of| of.number(groups::Pressure::layout().sound_speed)),
    row("velocity_gradient", Group::Gradient, |of| of.tensor(groups::Gradient::layout().velocity_gradient)),
    row("neighbors", Group::Weight, |of| of.whole(groups::Weight::layout().neighbors)),
    row("initial_position", Group::Place, |of| of.initial_position()),
    StoredField {
        is_stored: |reader| reader.model.adaptive_search().is_some(),
        ..row("adapted", Group::Rows, |of| of.whole(groups::Rows::layout().is_marked))
    },
    StoredField {
        is_stored: |reader| reader.model.adaptive_search().is_some(),
        ..row("last_searched", Group::Rows, |of| of.whole(groups::Rows::layout().last_searched))
    },
    StoredField {
        is_stored: |reader| reader.model.smoothing_follows_density(),
        ..row("smoothing_length", Group::Constants, |of| of.number(groups::Constants::layout().smoothing_length))
    },
    StoredField {
        is_stored: |reader| reader.model.is_total_lagrangian(),
        ..row("deformation", Group::Deformation, |of| of.compensated_tensor(groups::Deformation::layout().deformation))
    },
    StoredField {
        is_stored: |reader| reader.model.is_total_lagrangian() && reader.is_renewed,
        ..row("earlier_deformation", Group::Earlier, |of| of.compensated_tensor(groups::Earlier::layout().deformation))
    },
];

pub(super) fn stored_field(name: &str) -> Option<&'static StoredField> {
    FIELDS.iter().find(|field| field.name == name)
}

/// Names of stored fields that steps change, without those of history variables.
pub(super) fn changing_fields() -> impl Iterator<Item = &'static str> {
    FIELDS.iter().map(|field| field.name).chain(["motion"])
}

/// Groups from which fields of particles are read; a model may not have all.
pub(super) fn groups_of_particles() -> Vec<Group> {
    let mut groups: Vec<Group> = FIELDS.iter().map(|field| field.group).chain([Group::History]).collect();
    groups.sort_unstable();
    groups.dedup();
    groups
}

/// Makes a field of a group that was read back.
pub(super) struct FieldReader<'a> {
    pub(super) reader: &'a ColumnReader<'a>,
    pub(super) group: Group64,
}

impl FieldReader<'_> {
    fn scalars(&self, of: impl Fn(usize) -> f64) -> Column<'static> {
        Column::Scalar((0..self.reader.initial.len()).map(of).collect())
    }

    fn vectors(&self, of: impl Fn(usize, usize) -> f64) -> Column<'static> {
        let vector = |i: usize| [0, 1, 2].map(|a| of(a, i));
        Column::Vector((0..self.reader.initial.len()).map(vector).collect())
    }

    fn tensors(&self, of: impl Fn(usize, usize) -> f64) -> Column<'static> {
        let tensor = |i: usize| [0, 1, 2].map(|a| [0, 1, 2].map(|b| of(3 * a + b, i)));
        Column::Tensor((0..self.reader.initial.len()).map(tensor).collect())
    }

    fn number(&self, of: Number<()>) -> Column<'static> {
        self.scalars(|i| self.group.number(of, i))
    }

    fn whole(&self, of: Number<()>) -> Column<'static> {
        let whole = |i: usize| self.group.number(of, i) as u32;
        Column::Integer((0..self.reader.initial.len()).map(whole).collect())
    }

    fn compensated(&self, of: Compensated<()>) -> Column<'static> {
        self.scalars(|i| self.group.double(of, i))
    }

    fn vector(&self, of: VectorColumns<()>) -> Column<'static> {
        self.vectors(|a, i| self.group.number(of.axis(a), i))
    }

    fn compensated_vector(&self, of: CompensatedVector<()>) -> Column<'static> {
        self.vectors(|a, i| self.group.double(of.axis(a), i))
    }

    fn tensor(&self, of: TensorColumns<()>) -> Column<'static> {
        self.tensors(|k, i| self.group.number(of.component(k), i))
    }

    fn compensated_tensor(&self, of: CompensatedTensor<()>) -> Column<'static> {
        self.tensors(|k, i| self.group.double(of.component(k), i))
    }

    fn deviator(&self) -> Column<'static> {
        let first = groups::Deviator::layout().deviator.column();
        let tensor = |i: usize| [0, 1, 2, 3, 4, 5].map(|k| self.group.at(first + k, i));
        Column::Symmetric((0..self.reader.initial.len()).map(tensor).map(SymmetricTensor::from_array).collect())
    }

    fn plastic_strain_rate(&self) -> Column<'static> {
        let (increment, dt) = (groups::Plastic::layout().increment, self.reader.dt);
        self.scalars(|i| if dt > 0.0 { self.group.number(increment, i) / dt } else { 0.0 })
    }

    fn yield_stress(&self) -> Column<'static> {
        let of = groups::Plastic::layout().yield_stress;
        // A law that never yields has the largest number.
        self.scalars(|i| match self.group.number(of, i) {
            largest if largest >= f64::from(f32::MAX) => f64::INFINITY,
            yield_stress => yield_stress,
        })
    }

    /// Positions stay in their periodic cells: a particle takes the short way.
    fn initial_position(&self) -> Column<'static> {
        let (of, reader) = (groups::Place::layout().position, self.reader);
        self.vectors(|a, i| {
            let start = reader.initial.position[i][a];
            let period = reader.model.periodic.get(a).copied().flatten().map(|(low, high)| high - low);
            period.map_or(start, |l| start + l * ((self.group.double(of.axis(a), i) - start) / l).round())
        })
    }

    /// A history variable by its number.
    pub(super) fn history(&self, k: usize) -> Column<'static> {
        self.compensated(groups::History::layout().of(k).value)
    }
}
