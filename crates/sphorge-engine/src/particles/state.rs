//! The columns, declared once; storage, reordering and lookup by name follow from the declaration.

use super::{Column, Permutation};
use sphorge_physics::{SymmetricTensor, Tensor, Vector};
use std::borrow::Cow;

/// A value a column can hold.
trait Value: Copy {
    fn borrowed(values: &[Self]) -> Column<'_>;
}
impl Value for f64 {
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Scalar(Cow::Borrowed(values))
    }
}
impl Value for u32 {
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Integer(Cow::Borrowed(values))
    }
}
impl Value for Vector<f64> {
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Vector(Cow::Borrowed(values))
    }
}
impl Value for SymmetricTensor<f64> {
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Symmetric(Cow::Borrowed(values))
    }
}
impl Value for Tensor<f64> {
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Tensor(Cow::Borrowed(values))
    }
}

macro_rules! columns {
    ($( $(#[doc = $doc:literal])+ $name:ident : $type:ty = $initial:expr, )+) => {
        /// Particle state as columns of equal length, in spatial order; `id` is stable.
        #[derive(Clone, Debug, Default)]
        pub struct Particles {
            $( $(#[doc = $doc])+ pub $name: Vec<$type>, )+
        }

        impl Particles {
            /// `count` particles with every column at its initial value.
            pub fn new(count: usize) -> Self {
                Self { $( $name: vec![$initial; count], )+ }
            }

            /// Number of particles.
            pub fn len(&self) -> usize {
                self.position.len()
            }

            /// No particles at all.
            pub fn is_empty(&self) -> bool {
                self.position.is_empty()
            }

            /// Moves every column the same way; see [`Permutation`].
            pub fn reorder(&mut self, permutation: &Permutation) {
                $( permutation.apply(&mut self.$name); )+
            }

            /// Bytes held by the columns of one particle.
            pub const BYTES: usize = 0 $( + std::mem::size_of::<$type>() )+;

            /// A stored column by its name.
            pub(super) fn stored(&self, name: &str) -> Option<Column<'_>> {
                match name {
                    $( stringify!($name) => Some(Value::borrowed(self.$name.as_slice())), )+
                    _ => None,
                }
            }
        }
    };
}

columns! {
    /// Number given at creation, never changed.
    id: u32 = 0,
    /// Index of the body.
    body: u32 = 0,
    /// Index of the material.
    material: u32 = 0,
    /// Bit set of the regions (bit k: region k) the particle belongs to.
    regions: u32 = 0,
    /// Mass, kg (per metre of thickness in plane strain, per square metre in one dimension).
    mass: f64 = 0.0,
    /// Smoothing length h, m.
    smoothing_length: f64 = 0.0,
    /// Position x, m.
    position: Vector<f64> = [0.0; 3],
    /// Velocity v, m/s.
    velocity: Vector<f64> = [0.0; 3],
    /// Acceleration of the last force sum, m/s².
    acceleration: Vector<f64> = [0.0; 3],
    /// Density rho, kg/m³.
    density: f64 = 0.0,
    /// Specific internal energy e, J/kg.
    energy: f64 = 0.0,
    /// Rate of the specific internal energy at the last force sum, W/kg.
    energy_rate: f64 = 0.0,
    /// Temperature T, K.
    temperature: f64 = 0.0,
    /// Pressure p, positive in compression, Pa.
    pressure: f64 = 0.0,
    /// Bulk sound speed, m/s.
    sound_speed: f64 = 0.0,
    /// Stress deviator S, Pa.
    deviator: SymmetricTensor<f64> = SymmetricTensor { xx: 0.0, yy: 0.0, zz: 0.0, xy: 0.0, yz: 0.0, xz: 0.0 },
    /// Velocity gradient L = grad v, `L_ab = dv_a/dx_b`, 1/s.
    velocity_gradient: Tensor<f64> = [[0.0; 3]; 3],
    /// Accumulated equivalent plastic strain.
    plastic_strain: f64 = 0.0,
    /// Plastic strain added in the last step.
    plastic_strain_increment: f64 = 0.0,
    /// Yield stress at the end of the last step, Pa.
    yield_stress: f64 = 0.0,
    /// Plastic work per mass w_p, J/kg.
    plastic_work: f64 = 0.0,
    /// Number of neighbours inside the kernel support.
    neighbors: u32 = 0,
    /// One if the neighbours were searched in the last step (the `AdaptNode` of Fraser), else zero.
    adapted: u32 = 0,
    /// Number of the step of the last search.
    last_searched: u32 = 0,
}

impl Particles {
    /// Index and distance, m, of the particle nearest to a point, of one body if given; of several as near the one with the least id.
    pub fn nearest(&self, point: Vector<f64>, body: Option<usize>) -> Option<(usize, f64)> {
        let squared = |i: usize| (0..3).map(|a| (self.position[i][a] - point[a]).powi(2)).sum::<f64>();
        (0..self.len())
            .filter(|&i| body.is_none_or(|body| self.body[i] as usize == body))
            .map(|i| (i, squared(i)))
            .min_by(|a, b| a.1.total_cmp(&b.1).then(self.id[a.0].cmp(&self.id[b.0])))
            .map(|(i, squared)| (i, squared.sqrt()))
    }
}
