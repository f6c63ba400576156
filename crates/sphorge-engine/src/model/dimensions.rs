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
