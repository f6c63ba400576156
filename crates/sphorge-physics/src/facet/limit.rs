//! The time step of particles that press at their facets.

use super::{FacetPairLaw, FacetPress, OnCell};
use crate::time_step::oscillator_limit;
use crate::{Numbers, Real};

/// `beta`: largest eigenvalue of the mobility of faces, which are carried by `x + F arm`, times the mass of a particle, in a half space
/// of a cubic lattice.
pub const MOBILITY: f64 = 2.5;

/// Share of the contact's stability limit that counts as that of the step, before Courant's number: half of the limit at
/// the usual number of 0.3, at which impacts keep their energy within half a per cent.
pub const MARGIN: f64 = 1.5;

/// Stiffness and damping over the mass of a particle, in all its pairs of facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetStiffness<T> {
    /// Against motion across facets.
    stiffness: T,
    /// Against motion along them.
    lateral: T,
    damping: T,
}

impl<T: Real> FacetStiffness<T> {
    /// Before the first pair.
    pub fn none() -> Self {
        Self { stiffness: T::zero(), lateral: T::zero(), damping: T::zero() }
    }

    /// Adds a pair of a particle of that mass, kg.
    #[inline]
    pub fn add(&mut self, press: &FacetPress<T>, law: &FacetPairLaw<T>, mass: T) {
        let mobility = T::of(MOBILITY) * press.area / mass;
        self.stiffness += mobility * press.stiffness;
        self.damping += mobility * law.damping;
    }

    /// Adds the edges of a facet of a particle of that mass, kg.
    #[inline]
    pub fn add_edges(&mut self, edges: &OnCell<T>, mass: T) {
        self.lateral += edges.stiffness / mass;
    }

    /// Largest step before Courant's number, s. Twice the sum accounts for neighbours that oscillate against the particle.
    #[inline]
    pub fn limit(&self) -> T {
        let two = T::of(2.0);
        let limit = oscillator_limit(two * self.stiffness.max(self.lateral), two * self.damping);
        // Cards do not have infinity, the limit of what presses nothing.
        T::select_lt(T::zero(), self.stiffness, T::of(MARGIN) * limit, limit)
    }
}

impl<T: Real> Numbers<T> for FacetStiffness<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        visit(&mut self.stiffness);
        visit(&mut self.lateral);
        visit(&mut self.damping);
    }
}
