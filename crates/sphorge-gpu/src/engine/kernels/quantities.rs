//! Fields of particles for reductions, in pairs of numbers.

use crate::engine::columns::{
    Binder, Compensated, CompensatedVector, Group, Layout, Member, Number as Column, Read, ReadColumns, Reading,
    SymmetricColumns, TensorColumns, groups,
};
use crate::record::{Double, Index};
use sphorge_engine::model::Model;
use sphorge_engine::particles::{HistoryVariables, equivalent_strain_rate};
use sphorge_engine::reduction::Quantity;
use sphorge_physics::{Real, SymmetricTensor};

/// A field that is available on a GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Field {
    /// This number of columns from this one on.
    Plain(Group, usize, usize),
    /// The same with their low parts, which start at this offset.
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
        use groups::{
            Constants, Density, Energy, Gradient, Place, Plastic, Pressure, Rates, Temperature, Velocity, Weight,
        };
        let number = |group: Group, of: Column<()>| Self::Plain(group, of.column(), 1);
        let carried = |group: Group, of: Compensated<()>| {
            let [first, rest] = of.columns();
            Self::Carried(group, first, 1, rest - first)
        };
        let vector = |group: Group, of: CompensatedVector<()>| Self::Carried(group, of.column(), 3, 3);
        Some(match name {
            "mass" => number(Group::Constants, Constants::layout().mass),
            "position" => vector(Group::Place, Place::layout().position),
            "velocity" => vector(Group::Velocity, Velocity::layout().velocity),
            "acceleration" => Self::Plain(Group::Rates, Rates::layout().acceleration.column(), 3),
            "density" => carried(Group::Density, Density::layout().density),
            "energy" => carried(Group::Energy, Energy::layout().energy),
            "temperature" => carried(Group::Temperature, Temperature::layout().temperature),
            "pressure" => number(Group::Pressure, Pressure::layout().pressure),
            "sound_speed" => number(Group::Pressure, Pressure::layout().sound_speed),
            "velocity_gradient" => Self::Plain(Group::Gradient, Gradient::layout().velocity_gradient.column(), 9),
            "plastic_strain" => carried(Group::Plastic, Plastic::layout().strain),
            "plastic_strain_increment" => number(Group::Plastic, Plastic::layout().increment),
            "plastic_work" => carried(Group::Plastic, Plastic::layout().work),
            "neighbors" => number(Group::Weight, Weight::layout().neighbors),
            "deviator" => Self::Deviator,
            "stress" => Self::Stress,
            "speed" => Self::Speed,
            "von_mises_stress" => Self::VonMises,
            "equivalent_strain_rate" => Self::StrainRate,
            _ => {
                let k = HistoryVariables::of(model).variables.iter().position(|of| of.name == name)?;
                carried(Group::History, groups::History::layout().of(k).value)
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

/// What a field is made of in a kernel.
#[derive(Clone, Copy)]
enum Bound {
    /// Columns from this one on.
    Plain(Reading, usize),
    /// The same with their low parts, which start at this offset.
    Carried(Reading, usize, usize),
    Deviator(SymmetricColumns<Read>),
    Stress(SymmetricColumns<Read>, groups::Pressure<Read>),
    Speed(CompensatedVector<Read>),
    VonMises(SymmetricColumns<Read>),
    StrainRate(TensorColumns<Read>),
}

/// A number of every particle.
#[derive(Clone, Copy)]
pub(super) struct Number {
    bound: Bound,
    width: usize,
    component: Option<usize>,
}

/// Whether a quantity is available on a GPU; some are not, such as a yield stress that may be infinite.
pub(in crate::engine) fn is_known(quantity: Quantity<'_>, model: &Model) -> bool {
    let field = Field::named(quantity.field, model);
    // The state is one number or three.
    field.is_some_and(|field| quantity.component.is_none_or(|k| k < field.width()))
}

impl Number {
    /// Nothing for quantities that are not available.
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, quantity: Quantity<'_>) -> Option<Self> {
        let field = Field::named(quantity.field, model)?;
        let bound = match field {
            Field::Plain(group, first, _) => Bound::Plain(bind.read(group), first),
            Field::Carried(group, first, _, rests) => Bound::Carried(bind.read(group), first, rests),
            Field::Deviator => Bound::Deviator(groups::Deviator::read(bind).deviator),
            Field::Stress => Bound::Stress(groups::Deviator::read(bind).deviator, groups::Pressure::read(bind)),
            Field::Speed => Bound::Speed(groups::Velocity::read(bind).velocity),
            Field::VonMises => Bound::VonMises(groups::Deviator::read(bind).deviator),
            Field::StrainRate => Bound::StrainRate(groups::Gradient::read(bind).velocity_gradient),
        };
        Some(Self { bound, width: field.width(), component: quantity.component })
    }

    fn component(self, k: usize, i: Index) -> Double {
        match self.bound {
            Bound::Plain(columns, first) => Double::from(columns.get(first + k, i)),
            Bound::Carried(columns, first, rests) => {
                Double::new([first + k, first + rests + k].map(|column| columns.get(column, i)))
            }
            Bound::Deviator(deviator) => in_pairs(deviator, i).to_array()[k],
            Bound::Stress(deviator, pressure) => stress(deviator, pressure, i).to_array()[k],
            Bound::Speed(velocity) => norm(&velocity.doubles(i)),
            Bound::VonMises(deviator) => in_pairs(deviator, i).von_mises(),
            Bound::StrainRate(gradient) => equivalent_strain_rate(&gradient.get(i).map(|row| row.map(Double::from))),
        }
    }

    /// The requested component, or the value, or the norm of a vector or tensor.
    pub(super) fn at(self, i: Index) -> Double {
        let of_tensor = |tensor: SymmetricTensor<Double>| tensor.double_dot(tensor).sqrt();
        match (self.component, self.bound) {
            (Some(k), _) => self.component(k, i),
            (None, Bound::Deviator(deviator)) => of_tensor(in_pairs(deviator, i)),
            (None, Bound::Stress(deviator, pressure)) => of_tensor(stress(deviator, pressure, i)),
            (None, _) if self.width == 1 => self.component(0, i),
            (None, _) => norm(&(0..self.width).map(|k| self.component(k, i)).collect::<Vec<_>>()),
        }
    }
}

fn in_pairs(deviator: SymmetricColumns<Read>, i: Index) -> SymmetricTensor<Double> {
    SymmetricTensor::from_array(deviator.get(i).to_array().map(Double::from))
}

fn stress(deviator: SymmetricColumns<Read>, pressure: groups::Pressure<Read>, i: Index) -> SymmetricTensor<Double> {
    in_pairs(deviator, i) - SymmetricTensor::isotropic(pressure.pressure.get(i).into())
}

fn norm(components: &[Double]) -> Double {
    let squares = components.iter().map(|c| *c * *c);
    squares.reduce(|a, b| a + b).map_or_else(Double::zero, Double::sqrt)
}
