//! How bodies meet.

use sphorge_physics::contact::ContactStrength;

/// What particles of different bodies are to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BodyContact {
    /// Neighbours like those of their own body: bodies that meet stick where they are pulled apart.
    #[default]
    Sph,
    /// Sides of a contact that pushes and never pulls; they take no part in each other's kernel sums.
    Penalty(ContactStrength),
}

impl BodyContact {
    /// Whether bodies rub each other.
    pub fn has_friction(&self) -> bool {
        matches!(self, Self::Penalty(strength) if strength.friction > 0.0)
    }
}
