//! Dimensions of the problem.

/// Dimensions of the problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimensions {
    /// Uniaxial strain along x: motion along x, the full stress tensor carried.
    One,
    /// Plane strain in x, y: in-plane motion, out-of-plane stress carried.
    PlaneStrain,
    /// Three dimensions.
    Three,
}

impl Dimensions {
    /// Number of space dimensions particles move in.
    pub fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::PlaneStrain => 2,
            Self::Three => 3,
        }
    }
}

/// Dimension of the kernel, and of every law that asks for one.
impl From<Dimensions> for sphorge_physics::Dimension {
    fn from(dimensions: Dimensions) -> Self {
        match dimensions {
            Dimensions::One => Self::One,
            Dimensions::PlaneStrain => Self::Two,
            Dimensions::Three => Self::Three,
        }
    }
}
