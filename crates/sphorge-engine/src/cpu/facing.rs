//! Which particles of one body may come to meet each other at their facets before the next search for contact: on flat surfaces all are near each other, and none meet.

use super::faces::WholeDeformation;
use super::facets::FacetContacts;
use super::ghosts::{Ghosts, WithGhosts};
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use smallvec::SmallVec;
use sphorge_physics::Vector;
use sphorge_physics::surface::{soon_different_sides, surface_normal};

/// Unit normals of the facets of a particle.
type Normals = SmallVec<[Vector<f64>; 1]>;

/// Where facets look now.
pub(super) struct Facing {
    /// Of particles and ghosts but images, which look elsewhere than what they are images of.
    normals: Vec<Normals>,
}

impl Facing {
    pub(super) fn new(facets: &FacetContacts, particles: &Particles, ghosts: &Ghosts) -> Self {
        let columns = &ghosts.columns;
        let id = WithGhosts::new(&particles.id, &columns.id);
        let since = WithGhosts::new(&particles.deformation, &columns.deformation);
        let earlier = (!particles.earlier_deformation.is_empty())
            .then(|| WithGhosts::new(&particles.earlier_deformation, &columns.earlier_deformation));
        let of_point = |point: usize| -> Normals {
            let facets = facets.reference.of(id.at(point));
            if facets.is_empty() {
                return Normals::new();
            }
            let f = since.at(point);
            let f = earlier.map_or(f, |earlier| WholeDeformation::product(&f, &earlier.at(point)));
            facets.iter().map(|of| surface_normal(&f, of.facet.normal)).collect()
        };
        let count = particles.len() + ghosts.count() - ghosts.halo.images().len();
        Self { normals: (0..count).into_par_iter().with_min_len(BLOCK).map(of_point).collect() }
    }

    /// Whether some facets of two particles or ghosts may face each other: true of images. A rotation to that moves neighbours on a surface by more than the skin
    /// of the search.
    pub(super) fn may_meet(&self, i: usize, j: usize) -> bool {
        let (Some(own), Some(others)) = (self.normals.get(i), self.normals.get(j)) else { return true };
        own.iter().any(|own| others.iter().any(|other| soon_different_sides(*own, *other) > 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_surface_meets_nothing_of_its_own_and_sides_of_a_slot_edges_and_images_do() {
        let (up, down, aside): (Vector<f64>, _, _) = ([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]);
        let turned = |degrees: f64| [degrees.to_radians().sin(), degrees.to_radians().cos(), 0.0];
        let of = |normals: &[Vector<f64>]| Normals::from_slice(normals);
        let facing = Facing {
            normals: vec![of(&[up]), of(&[turned(20.0)]), of(&[turned(30.0)]), of(&[down]), of(&[up, aside]), of(&[])],
        };
        let meets = |j: usize| facing.may_meet(0, j);
        assert_eq!([0, 1, 2, 3, 4, 5].map(meets), [false, false, true, true, true, false]);
        assert!(facing.may_meet(0, 6) && facing.may_meet(6, 0));
    }
}
