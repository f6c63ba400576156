//! The table of fields a user can name: stored columns and quantities derived from them.

use super::{Column, ColumnKind, Particles};
use sphorge_physics::SymmetricTensor;
use std::borrow::Cow;

/// What is known of a field.
#[derive(Clone, Copy, Debug)]
pub struct FieldInfo {
    /// Name in decks, in `.vtp` files and in pictures.
    pub name: &'static str,
    /// Unit in SI, empty for pure numbers.
    pub unit: &'static str,
    /// Value type.
    pub kind: ColumnKind,
    /// Written to frames unless the deck says otherwise.
    pub default_output: bool,
    /// One line for people.
    pub meaning: &'static str,
}

macro_rules! table {
    ($( $name:literal, $unit:literal, $kind:ident, $output:literal, $meaning:literal; )+) => {
        /// All fields.
        pub const FIELDS: &[FieldInfo] = &[ $( FieldInfo { name: $name, unit: $unit, kind: ColumnKind::$kind, default_output: $output, meaning: $meaning }, )+ ];
    };
}

table! {
    "id", "", Integer, true, "number given at creation";
    "body", "", Integer, true, "index of the body";
    "material", "", Integer, false, "index of the material";
    "mass", "kg", Scalar, false, "mass";
    "smoothing_length", "m", Scalar, false, "smoothing length";
    "position", "m", Vector, false, "position (always written as the points of a frame)";
    "velocity", "m/s", Vector, true, "velocity";
    "speed", "m/s", Scalar, false, "magnitude of the velocity";
    "acceleration", "m/s^2", Vector, false, "acceleration of the last force sum";
    "density", "kg/m^3", Scalar, true, "density";
    "energy", "J/kg", Scalar, true, "specific internal energy";
    "temperature", "K", Scalar, true, "temperature";
    "pressure", "Pa", Scalar, true, "pressure, positive in compression";
    "sound_speed", "m/s", Scalar, false, "bulk sound speed";
    "deviator", "Pa", Symmetric, false, "stress deviator";
    "stress", "Pa", Symmetric, true, "Cauchy stress, positive in tension";
    "von_mises_stress", "Pa", Scalar, true, "von Mises equivalent stress";
    "velocity_gradient", "1/s", Tensor, false, "velocity gradient";
    "plastic_strain", "", Scalar, true, "accumulated equivalent plastic strain";
    "plastic_strain_increment", "", Scalar, false, "plastic strain added in the last step";
    "yield_stress", "Pa", Scalar, false, "yield stress at the end of the last step";
    "plastic_work", "J/kg", Scalar, false, "plastic work per mass";
    "neighbors", "", Integer, false, "neighbours inside the kernel support";
    "adapted", "", Integer, false, "one where neighbours were searched in the last step, else zero";
    "last_searched", "", Integer, false, "number of the step of the last search";
}

/// The field of this name.
pub fn find_field(name: &str) -> Option<&'static FieldInfo> {
    FIELDS.iter().find(|f| f.name == name)
}

impl Particles {
    /// The values of a field of [`FIELDS`], borrowed when stored, computed when derived; `None` for an unknown name.
    pub fn column(&self, name: &str) -> Option<Column<'_>> {
        let scalar = |f: &dyn Fn(usize) -> f64| Some(Column::Scalar(Cow::Owned((0..self.len()).map(f).collect())));
        match name {
            "speed" => scalar(&|i| self.velocity[i].iter().map(|v| v * v).sum::<f64>().sqrt()),
            "von_mises_stress" => scalar(&|i| self.deviator[i].von_mises()),
            "stress" => Some(Column::Symmetric(Cow::Owned(
                (0..self.len()).map(|i| self.deviator[i] - SymmetricTensor::isotropic(self.pressure[i])).collect(),
            ))),
            _ => self.stored(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_of_the_table_is_there_with_its_kind() {
        let particles = Particles::new(2);
        for field in FIELDS {
            let column = particles.column(field.name).expect(field.name);
            assert_eq!(column.kind(), field.kind, "{}", field.name);
            assert_eq!(column.len(), 2);
        }
        assert!(particles.column("no-such-field").is_none());
    }

    #[test]
    fn reordering_moves_every_column() {
        let mut particles = Particles::new(3);
        for i in 0..3 {
            particles.id[i] = i as u32;
            particles.velocity[i] = [i as f64, 0.0, 0.0];
        }
        let mut permutation = crate::particles::Permutation::default();
        permutation.set(&[2, 0, 1]);
        particles.reorder(&permutation);
        assert_eq!(particles.id, [2, 0, 1]);
        assert_eq!(particles.velocity[0][0], 2.0);
    }

    #[test]
    fn cauchy_stress_is_deviator_less_pressure() {
        let mut particles = Particles::new(1);
        particles.pressure[0] = 5.0;
        particles.deviator[0].xy = 3.0;
        let stress = particles.column("stress").unwrap();
        assert_eq!((0..6).map(|k| stress.component(0, k)).collect::<Vec<_>>(), [-5.0, -5.0, -5.0, 3.0, 0.0, 0.0]);
    }
}
