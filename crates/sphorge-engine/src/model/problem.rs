//! A whole problem.

use super::numerics::TemperatureSource;
use super::{
    AdaptiveSearch, Body, BodyContact, Dimensions, Formulation, GradientCorrection, Material, Measure, Numerics,
    OutputControl, PrescribedMotion, Region, Search, Section, SmoothingLength, SymmetryPlane, Thermal, TimeControl,
    Tracer, Wall, WarningLimits,
};

/// A whole problem.
#[derive(Clone, Debug)]
pub struct Model {
    /// One line for people.
    pub title: String,
    /// File stem of the deck; names the output folder.
    pub name: String,
    /// Space dimensions.
    pub dimensions: Dimensions,
    /// Particle spacing, m.
    pub spacing: f64,
    /// Numerical options.
    pub numerics: Numerics,
    /// Which configuration the sums are taken in.
    pub formulation: Formulation,
    /// Neighbour search strategy.
    pub search: Search,
    /// Compare the neighbour lists with an exact search every so many steps.
    pub audit: Option<u64>,
    /// When to start, stop and how to choose steps.
    pub time: TimeControl,
    /// Materials in use; bodies refer to them by index.
    pub materials: Vec<Material>,
    /// Bodies in deck order.
    pub bodies: Vec<Body>,
    /// Contact between bodies.
    pub contact: BodyContact,
    /// Heat that flows.
    pub thermal: Thermal,
    /// Named regions of particles, selected in the initial configuration.
    pub regions: Vec<Region>,
    /// Rigid walls.
    pub walls: Vec<Wall>,
    /// Symmetry planes.
    pub symmetry: Vec<SymmetryPlane>,
    /// Periodic axes: lower and upper end of the cell, m.
    pub periodic: [Option<(f64, f64)>; 3],
    /// Held and prescribed motion.
    pub motions: Vec<PrescribedMotion>,
    /// Body acceleration, m/s².
    pub gravity: [f64; 3],
    /// What to write and when.
    pub output: OutputControl,
    /// Declared measures.
    pub measures: Vec<Measure>,
    /// Followed particles and watched points.
    pub tracers: Vec<Tracer>,
    /// Planes the force through which is written.
    pub sections: Vec<Section>,
    /// Checks that say when the run is broken.
    pub warnings: WarningLimits,
}

impl Model {
    /// Density of the particles of a body at the start, kg/m³: that of zero pressure at its temperature. Where the law has none, as far beyond
    /// boiling, that of the reference state.
    pub fn density_at_start(&self, body: &Body) -> f64 {
        let material = &self.materials[body.material];
        material.density_at_rest(body.temperature).unwrap_or(material.density)
    }

    /// Pairs of bodies that have a contact of their own, the lower index first, in order; a body with itself among them where it has one.
    pub fn contact_pairs(&self) -> Vec<(usize, usize)> {
        let count = match self.contact {
            BodyContact::Sph => 0,
            BodyContact::Penalty(_) | BodyContact::Facets { .. } => self.bodies.len(),
        };
        let first = if self.has_self_contact() { 0 } else { 1 };
        (0..count).flat_map(|a| (a + first..count).map(move |b| (a, b))).collect()
    }

    /// Prescribed motion of a particle of these regions; of two that claim it the later in the deck holds.
    pub fn motion_of(&self, regions: u32) -> Option<usize> {
        self.motions.iter().rposition(|motion| regions >> motion.region & 1 == 1)
    }

    /// Whether bodies meet at faces that follow their deformation: in the total Lagrangian form, where there is something to meet.
    pub fn has_faces(&self) -> bool {
        matches!(self.formulation, Formulation::TotalLagrangian { .. }) && !self.contact_pairs().is_empty()
    }

    /// Whether they meet at the facets of the cells of their particles.
    pub fn has_facets(&self) -> bool {
        self.has_faces() && matches!(self.contact, BodyContact::Facets { .. })
    }

    /// Whether a wall pushes bodies at the facets of the cells of their particles: in the total Lagrangian form.
    pub fn meets_walls_at_facets(&self) -> bool {
        matches!(self.formulation, Formulation::TotalLagrangian { .. }) && self.walls.iter().any(Wall::is_at_facets)
    }

    /// Whether one of them rubs there.
    pub fn rubs_at_facets_of_walls(&self) -> bool {
        self.meets_walls_at_facets() && self.walls.iter().any(|wall| wall.is_at_facets() && wall.rubs())
    }

    /// Whether bodies meet themselves in the contact: in the total Lagrangian form, where no end of the space is joined to another.
    pub fn has_self_contact(&self) -> bool {
        matches!(self.formulation, Formulation::TotalLagrangian { self_contact: true, .. })
            && self.contact != BodyContact::Sph
            && self.dimensions != Dimensions::One
            && self.periodic.iter().all(Option::is_none)
    }

    /// Whether sums are those of the reference configuration.
    pub fn is_total_lagrangian(&self) -> bool {
        matches!(self.formulation, Formulation::TotalLagrangian { .. })
    }

    /// Whether a contact acts between bodies, or of a body with itself.
    pub fn has_contact(&self) -> bool {
        !self.contact_pairs().is_empty()
    }

    /// Whether there are images, which move differently from their particles.
    pub fn has_images(&self) -> bool {
        !self.symmetry.is_empty() || self.periodic.iter().any(Option::is_some)
    }

    /// Whether sums use lists of the current configuration, which are kept from one search to the next.
    pub fn keeps_lists(&self) -> bool {
        self.formulation == Formulation::UpdatedLagrangian
    }

    /// The rule of adaptive search, if the model has one.
    pub fn adaptive_search(&self) -> Option<AdaptiveSearch> {
        match self.search {
            Search::Adaptive(rule) => Some(rule),
            Search::EveryStep | Search::Skin { .. } | Search::Initial => None,
        }
    }

    /// Skin of lists of the current configuration, as a share of the support of the kernel.
    pub fn skin_fraction(&self) -> f64 {
        match self.search {
            Search::Skin { fraction } if !self.is_total_lagrangian() => fraction,
            Search::Skin { .. } | Search::EveryStep | Search::Adaptive(_) | Search::Initial => 0.0,
        }
    }

    /// Whether sums over the current configuration use the distances of the last search.
    pub fn keeps_distances(&self) -> bool {
        let is_kept = match self.search {
            Search::EveryStep | Search::Skin { .. } => false,
            Search::Adaptive(rule) => rule.guard.is_none(),
            Search::Initial => true,
        };
        is_kept && !self.is_total_lagrangian()
    }

    /// Whether smoothing lengths follow the density.
    pub fn smoothing_follows_density(&self) -> bool {
        self.numerics.smoothing_length != SmoothingLength::Constant
    }

    /// Whether gradients are corrected in the current configuration.
    pub fn corrects_current_gradients(&self) -> bool {
        !self.is_total_lagrangian() && self.numerics.gradient_correction != GradientCorrection::None
    }

    /// Whether heat may be conducted between bodies: where their faces touch.
    pub fn conducts_between_bodies(&self) -> bool {
        self.bodies.len() > 1
    }

    /// Whether heat is conducted to particles of other bodies that are not among the neighbours of the sums.
    pub fn conducts_across_contact(&self) -> bool {
        self.conducts_between_bodies() && self.has_contact()
    }

    /// Whether particles in a contact are sorted by their contact positions: for the overlap, or to find those that heat
    /// flows to.
    pub fn sorts_by_contact_positions(&self) -> bool {
        !self.has_facets() || self.conducts_across_contact()
    }

    /// Whether the work of the artificial stress is booked apart: where temperature is that of the energy, of which it is no heat.
    pub fn books_artificial_energy(&self) -> bool {
        self.numerics.temperature == TemperatureSource::Energy && self.numerics.artificial_stress.is_some()
    }
}
