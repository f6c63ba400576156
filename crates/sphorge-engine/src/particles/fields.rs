//! The fields a user can name: stored columns, histories of material laws, and quantities derived from columns.

use super::history::{all_declared, declared, kept_by};
use super::table::{Access, COLUMNS};
use super::{Column, ColumnKind, Particles};
use crate::model::{Formulation, Material};
use sphorge_physics::damage::lode_angle;
use sphorge_physics::{Real, SymmetricTensor, Tensor, tensor};
use std::borrow::Cow;
use std::sync::LazyLock;

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

/// Derived fields, each with the stored one it stands behind in lists.
const DERIVED: [(&str, FieldInfo); 8] = [
    (
        "position",
        FieldInfo {
            name: "displacement",
            unit: "m",
            kind: ColumnKind::Vector,
            default_output: false,
            meaning: "way from the position at the start",
        },
    ),
    (
        "velocity",
        FieldInfo {
            name: "speed",
            unit: "m/s",
            kind: ColumnKind::Scalar,
            default_output: false,
            meaning: "magnitude of the velocity",
        },
    ),
    (
        "deviator",
        FieldInfo {
            name: "stress",
            unit: "Pa",
            kind: ColumnKind::Symmetric,
            default_output: true,
            meaning: "Cauchy stress, positive in tension",
        },
    ),
    (
        "deviator",
        FieldInfo {
            name: "von_mises_stress",
            unit: "Pa",
            kind: ColumnKind::Scalar,
            default_output: true,
            meaning: "von Mises equivalent stress",
        },
    ),
    (
        "deviator",
        FieldInfo {
            name: "triaxiality",
            unit: "",
            kind: ColumnKind::Scalar,
            default_output: false,
            meaning: "mean stress over von Mises stress, positive in tension; zero without von Mises stress",
        },
    ),
    (
        "deviator",
        FieldInfo {
            name: "lode_angle",
            unit: "",
            kind: ColumnKind::Scalar,
            default_output: false,
            meaning: "normalised Lode angle: 1 in tension along one axis, 0 in shear, -1 in compression along one axis; zero without von Mises stress",
        },
    ),
    (
        "velocity_gradient",
        FieldInfo {
            name: DEFORMATION_GRADIENT,
            unit: "",
            kind: ColumnKind::Tensor,
            default_output: true,
            meaning: "deformation gradient F from the start; total Lagrangian form only",
        },
    ),
    (
        "velocity_gradient",
        FieldInfo {
            name: "equivalent_strain_rate",
            unit: "1/s",
            kind: ColumnKind::Scalar,
            default_output: false,
            meaning: "equivalent strain rate sqrt(2/3 D' : D'), D' the deviator of the rate of deformation",
        },
    ),
];

/// Field of the deformation gradient, which the total Lagrangian form alone knows.
pub const DEFORMATION_GRADIENT: &str = "deformation_gradient";

/// All fields a user can name.
pub static FIELDS: LazyLock<Vec<FieldInfo>> = LazyLock::new(|| {
    let mut fields = Vec::new();
    for column in COLUMNS.iter().filter(|column| column.access != Access::Internal) {
        fields.push(FieldInfo {
            name: column.name,
            unit: column.unit,
            kind: column.kind,
            default_output: column.access == Access::Written,
            meaning: column.meaning,
        });
        fields.extend(DERIVED.iter().filter(|(behind, _)| *behind == column.name).map(|(_, field)| *field));
    }
    for variable in all_declared() {
        if fields.iter().all(|field| field.name != variable.name) {
            fields.push(FieldInfo {
                name: variable.name,
                unit: variable.unit,
                kind: ColumnKind::Scalar,
                default_output: true,
                meaning: variable.meaning,
            });
        }
    }
    fields
});

/// Whether a field is more than its initial value in this formulation for bodies of these materials: all are but the deformation
/// gradient of the updated Lagrangian form and histories that none of their laws keeps.
pub fn is_kept(field: &str, formulation: Formulation, materials: &[Material]) -> bool {
    if field == DEFORMATION_GRADIENT && !matches!(formulation, Formulation::TotalLagrangian { .. }) {
        return false;
    }
    let keeps = |material: &Material| kept_by(material).any(|variable| variable.name == field);
    declared(field).is_none() || materials.iter().any(keeps)
}

/// The field of this name.
pub fn find_field(name: &str) -> Option<&'static FieldInfo> {
    FIELDS.iter().find(|f| f.name == name)
}

/// The stored fields that a field is computed of: itself, unless it is derived.
pub fn stored_behind(field: &str) -> Vec<&str> {
    match field {
        "speed" => vec!["velocity"],
        "von_mises_stress" | "lode_angle" => vec!["deviator"],
        "equivalent_strain_rate" => vec!["velocity_gradient"],
        "stress" | "triaxiality" => vec!["deviator", "pressure"],
        "displacement" => vec!["position", "initial_position"],
        DEFORMATION_GRADIENT => vec!["deformation", "earlier_deformation"],
        _ => vec![field],
    }
}

impl Particles {
    /// The values of a field of [`FIELDS`], borrowed when stored, computed when derived; `None` for an unknown name.
    pub fn column(&self, name: &str) -> Option<Column<'_>> {
        let scalar = |f: &dyn Fn(usize) -> f64| Some(Column::Scalar(Cow::Owned((0..self.len()).map(f).collect())));
        match name {
            "speed" => scalar(&|i| self.velocity[i].iter().map(|v| v * v).sum::<f64>().sqrt()),
            "von_mises_stress" => scalar(&|i| self.deviator[i].von_mises()),
            "equivalent_strain_rate" => scalar(&|i| equivalent_strain_rate(&self.velocity_gradient[i])),
            "stress" => Some(Column::Symmetric(Cow::Owned(
                (0..self.len()).map(|i| self.deviator[i] - SymmetricTensor::isotropic(self.pressure[i])).collect(),
            ))),
            "triaxiality" => scalar(&|i| triaxiality(self.pressure[i], self.deviator[i].von_mises())),
            "lode_angle" => scalar(&|i| lode_angle(self.deviator[i])),
            "displacement" => {
                // Nothing has moved before there is an engine.
                let from = |i: usize| self.initial_position.get(i).unwrap_or(&self.position[i]);
                let way = |i: usize| std::array::from_fn(|k| self.position[i][k] - from(i)[k]);
                Some(Column::Vector(Cow::Owned((0..self.len()).map(way).collect())))
            }
            DEFORMATION_GRADIENT => {
                let part = |of: &[Tensor<f64>], i: usize| of.get(i).copied().unwrap_or(tensor::identity());
                let whole = |i| tensor::multiply(&part(&self.deformation, i), &part(&self.earlier_deformation, i));
                Some(Column::Tensor(Cow::Owned((0..self.len()).map(whole).collect())))
            }
            // What no law of the model keeps stays as it would start.
            _ => self.stored(name).or_else(|| declared(name).and_then(|variable| scalar(&|_| variable.initial))),
        }
    }
}

/// Mean stress over von Mises stress; zero without the latter.
fn triaxiality(pressure: f64, von_mises: f64) -> f64 {
    if von_mises > 0.0 { -pressure / von_mises } else { 0.0 }
}

/// `sqrt(2/3 D' : D')` of a velocity gradient, 1/s (Patiño et al., Equation 27): that of plastic strain where elastic rates are small.
pub fn equivalent_strain_rate<T: Real>(l: &Tensor<T>) -> T {
    T::of(2.0 / 3.0) * SymmetricTensor::symmetric_part(l).deviator().von_mises()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reduction::FieldSource;

    #[test]
    fn every_field_of_the_table_is_there_with_its_kind() {
        let particles = Particles::new(2);
        for field in FIELDS.iter() {
            let column = particles.column(field.name).expect(field.name);
            assert_eq!(column.kind(), field.kind, "{}", field.name);
            assert_eq!(column.len(), 2);
        }
        assert!(particles.column("no-such-field").is_none());
    }

    #[test]
    fn a_field_can_be_computed_of_what_is_stored_behind_it() {
        let mut particles = Particles::new(1);
        particles.velocity = vec![[3.0, -4.0, 12.0]];
        particles.deviator = vec![SymmetricTensor { xx: 5e6, yy: -3e6, zz: -2e6, xy: 1e6, xz: -4e6, yz: 7e6 }];
        particles.pressure = vec![9e6];
        particles.velocity_gradient = vec![[[1.0, 2.0, 3.0], [4.0, -5.0, 6.0], [7.0, 8.0, -9.0]]];
        particles.position = vec![[1.0, 2.0, 3.0]];
        particles.initial_position = vec![[0.5, 2.5, 1.0]];
        particles.deformation = vec![[[2.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]]];
        particles.earlier_deformation = vec![[[1.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
        for field in FIELDS.iter().map(|field| field.name) {
            let of_all = format!("{:?}", particles.column(field));
            let alone = particles.with_fields(&stored_behind(field)).unwrap();
            assert_eq!(format!("{:?}", alone.column(field)), of_all, "{field}");
        }
        assert_ne!(particles.column("von_mises_stress").unwrap().component(0, 0), 0.0);
    }

    #[test]
    fn displacement_and_deformation_are_from_the_start() {
        let mut particles = Particles::new(1);
        particles.position = vec![[1.0, 2.0, 3.0]];
        let components = |particles: &Particles, field: &str| {
            let column = particles.column(field).unwrap();
            (0..column.kind().width()).map(|k| column.component(0, k)).collect::<Vec<_>>()
        };
        assert_eq!(components(&particles, "displacement"), [0.0; 3]);
        assert_eq!(components(&particles, DEFORMATION_GRADIENT), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        particles.initial_position = vec![[0.5, 2.5, 1.0]];
        assert_eq!(components(&particles, "displacement"), [0.5, -0.5, 2.0]);
        // A shear by 3 along y, then another configuration: stretched by 2 and sheared by 0.5 along x.
        particles.deformation = vec![[[2.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]]];
        particles.earlier_deformation = vec![[[1.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
        assert_eq!(components(&particles, DEFORMATION_GRADIENT), [3.5, 0.5, 0.0, 3.0, 1.0, 0.0, 0.0, 0.0, 0.5]);
    }

    #[test]
    fn triaxiality_is_positive_in_tension_and_nothing_without_stress() {
        let mut particles = Particles::new(2);
        // 3 MPa of tension along x: a third.
        particles.deviator[0] = SymmetricTensor { xx: 2e6, yy: -1e6, zz: -1e6, xy: 0.0, yz: 0.0, xz: 0.0 };
        particles.pressure = vec![-1e6, 5e6];
        let triaxiality = particles.column("triaxiality").unwrap();
        assert!((triaxiality.component(0, 0) - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!(triaxiality.component(1, 0), 0.0);
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
    fn the_equivalent_strain_rate_is_that_of_stretch_and_shear_without_rotation_and_compression() {
        // Uniaxial at constant volume, 10/s; simple shear of 6/s with a rotation of 100/s: 6/sqrt(3); compression alone.
        let stretch = [[10.0, 0.0, 0.0], [0.0, -5.0, 0.0], [0.0, 0.0, -5.0]];
        let shear = [[0.0, 6.0 + 100.0, 0.0], [-100.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
        let compression = [[-7.0, 0.0, 0.0], [0.0, -7.0, 0.0], [0.0, 0.0, -7.0]];
        let mut particles = Particles::new(3);
        particles.velocity_gradient = vec![stretch, shear, compression];
        let rate = particles.column("equivalent_strain_rate").unwrap();
        for (i, expected) in [10.0, 6.0 / 3f64.sqrt(), 0.0].into_iter().enumerate() {
            assert!((rate.component(i, 0) - expected).abs() < 1e-12, "{i}: {}", rate.component(i, 0));
        }
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
