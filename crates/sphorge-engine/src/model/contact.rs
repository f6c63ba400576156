//! How bodies meet.

use sphorge_physics::contact::ContactStrength;

/// What particles of different bodies are to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BodyContact {
    /// Neighbours like those of their own body: bodies that meet stick where they are pulled apart.
    #[default]
    KernelSum,
    /// Sides of a contact that pushes and never pulls; they take no part in each other's kernel sums.
    Penalty(ContactStrength),
}

impl super::Model {
    /// Pairs of bodies that have a contact of their own, the lower index first, in order.
    pub fn contact_pairs(&self) -> Vec<(usize, usize)> {
        let count = match self.contact {
            BodyContact::KernelSum => 0,
            BodyContact::Penalty(_) => self.bodies.len(),
        };
        (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).collect()
    }
}
