//! Fields of particles for reductions, in pairs of numbers.

use crate::engine::columns::{Binder, Fields, Group, Reading};
use crate::record::{Double, Index};
use sphorge_engine::model::Model;
use sphorge_engine::particles::{HistoryVariables, equivalent_strain_rate};
use sphorge_engine::reduction::Quantity;
use sphorge_physics::{Real, SymmetricTensor};

/// A field that is available on a card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Field {
    /// This number of columns from this one on.
    Plain(Group, usize, usize),
    /// The same with their rests, which start at this offset.
    Carried(Group, usize, usize, usize),
    /// Symmetric tensor.
    Deviator,
    Stress,
    Speed,
    VonMises,
    StrainRate,
}

impl Field {
    fn named(name: &str, model: &Model) -> Option<Self> {
        Some(match name {
            "mass" => Self::Plain(Group::Constants, 0, 1),
            "position" => Self::Carried(Group::Place, 0, 3, 3),
            "velocity" => Self::Carried(Group::Velocity, 0, 3, 3),
            "acceleration" => Self::Plain(Group::Rates, 0, 3),
            "density" => Self::Carried(Group::Density, 0, 1, 1),
            "energy" => Self::Carried(Group::Energy, 0, 1, 1),
            "temperature" => Self::Carried(Group::Temperature, 0, 1, 1),
            "pressure" => Self::Plain(Group::Pressure, 0, 1),
            "sound_speed" => Self::Plain(Group::Pressure, 1, 1),
            "velocity_gradient" => Self::Plain(Group::Gradient, 0, 9),
            "plastic_strain" => Self::Carried(Group::Plastic, 0, 1, 1),
            "plastic_strain_increment" => Self::Plain(Group::Plastic, 2, 1),
            "plastic_work" => Self::Carried(Group::Plastic, 4, 1, 1),
            "neighbors" => Self::Plain(Group::Weight, 1, 1),
            "deviator" => Self::Deviator,
            "stress" => Self::Stress,
            "speed" => Self::Speed,
            "von_mises_stress" => Self::VonMises,
            "equivalent_strain_rate" => Self::StrainRate,
            _ => {
                let k = HistoryVariables::of(model).variables.iter().position(|of| of.name == name)?;
                Self::Carried(Group::History, 2 * k, 1, 1)
            }
        })
    }

    /// Number of components.
    fn width(self) -> usize {
        match self {
            Self::Plain(_, _, width) | Self::Carried(_, _, width, _) => width,
            Self::Deviator | Self::Stress => 6,
            Self::Speed | Self::VonMises | Self::StrainRate => 1,
        }
    }
}

/// A number of every particle.
#[derive(Clone, Copy)]
pub(super) struct Number {
    field: Field,
    component: Option<usize>,
    columns: Reading,
    pressure: Option<Reading>,
}

/// Whether a quantity is available on a card; some are not, such as a yield stress that may be infinite.
pub(in crate::engine) fn is_known(quantity: Quantity<'_>, model: &Model) -> bool {
    let field = Field::named(quantity.field, model);
    // The state is one number or three.
    field.is_some_and(|field| quantity.component.is_none_or(|k| k < field.width()))
}

impl Number {
    /// Nothing for quantities that are not available.
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, quantity: Quantity<'_>) -> Option<Self> {
        let field = Field::named(quantity.field, model)?;
        let columns = match field {
            Field::Plain(group, ..) | Field::Carried(group, ..) => bind.read(group),
            Field::Deviator | Field::Stress | Field::VonMises => bind.read(Group::Deviator),
            Field::Speed => bind.read(Group::Velocity),
            Field::StrainRate => bind.read(Group::Gradient),
        };
        let pressure = (field == Field::Stress).then(|| bind.read(Group::Pressure));
        Some(Self { field, component: quantity.component, columns, pressure })
    }

    fn component(self, k: usize, i: Index) -> Double {
        match self.field {
            Field::Plain(_, first, _) => Double::from(self.columns.get(first + k, i)),
            Field::Carried(_, first, _, rests) => Double::new(self.columns.double(first + k, first + rests + k, i)),
            Field::Deviator | Field::Stress => self.tensor(i).to_array()[k],
            Field::Speed => norm(&self.columns.doubles(0, i)),
            Field::VonMises => self.tensor(i).von_mises(),
            Field::StrainRate => equivalent_strain_rate(&self.columns.tensor(0, i).map(|row| row.map(Double::from))),
        }
    }

    fn tensor(self, i: Index) -> SymmetricTensor<Double> {
        let deviator = SymmetricTensor::from_array(self.columns.symmetric(0, i).to_array().map(Double::from));
        let pressure = self.pressure.map(|pressure| SymmetricTensor::isotropic(pressure.get(0, i).into()));
        pressure.map_or(deviator, |pressure| deviator - pressure)
    }

    /// The requested component, or the value, or the norm of a vector or tensor.
    pub(super) fn at(self, i: Index) -> Double {
        match (self.component, self.field) {
            (Some(k), _) => self.component(k, i),
            (None, Field::Deviator | Field::Stress) => {
                let tensor = self.tensor(i);
                tensor.double_dot(tensor).sqrt()
            }
            (None, field) if field.width() == 1 => self.component(0, i),
            (None, field) => norm(&(0..field.width()).map(|k| self.component(k, i)).collect::<Vec<_>>()),
        }
    }
}

fn norm(components: &[Double]) -> Double {
    let squares = components.iter().map(|c| *c * *c);
    squares.reduce(|a, b| a + b).map_or_else(Double::zero, Double::sqrt)
}
