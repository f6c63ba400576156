//! How bodies meet.

use sphorge_physics::contact::ContactStrength;

/// What particles of different bodies are to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BodyContact {
    /// Neighbours like those of their own body: bodies that meet stick where they are pulled apart.
    #[default]
    Sph,
    /// Sides of a contact that pushes and never pulls, by the kernel-weighted overlap of their particles; they take no part in each other's kernel
    /// sums.
    Penalty(ContactStrength),
    /// The same by the exposed faces of the cells of their particles, which the total Lagrangian form carries with the deformation. What has come
    /// apart has no cells any more: it meets others by overlap.
    Facets {
        /// Of bodies that are whole.
        whole: ContactStrength,
        /// By overlap, where one of both has come apart.
        apart: ContactStrength,
    },
}

impl BodyContact {
    /// Whether bodies rub each other.
    pub fn has_friction(&self) -> bool {
        self.strength().is_some_and(|strength| strength.friction > 0.0)
    }

    /// Strength of a contact that pushes and never pulls.
    pub fn strength(&self) -> Option<ContactStrength> {
        match *self {
            Self::Sph => None,
            Self::Penalty(strength) | Self::Facets { whole: strength, .. } => Some(strength),
        }
    }

    /// Strength of the contact by overlap.
    pub fn overlap_strength(&self) -> Option<ContactStrength> {
        match *self {
            Self::Facets { apart, .. } => Some(apart),
            _ => self.strength(),
        }
    }
}
