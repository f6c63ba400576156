//! Number of space dimensions a case is computed in.

/// Space dimensions: one (uniaxial strain), two (plane strain) or three.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// Motion along `x`; strain in `y` and `z` is zero.
    One,
    /// Motion in the `x`-`y` plane; plane strain, so out-of-plane stress is carried.
    Two,
    /// Motion in space.
    Three,
}

impl Dimension {
    /// 1, 2 or 3.
    #[inline(always)]
    pub const fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Three => 3,
        }
    }
}
