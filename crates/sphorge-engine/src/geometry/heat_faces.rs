//! Faces of bodies at the start, of which heat boundaries name some by their normals.

use super::{CellFacet, ReferenceFacets, facets::facet_thickness, shape::dot};
use crate::model::{HeatBoundary, HeatBoundaryKind, Model};
use crate::particles::Particles;
use sphorge_physics::Vector;
use sphorge_physics::conduction::face_at_unit_density;

/// Least cosine between the normal of a boundary and that of a face it names: 45 degrees, of which a box has one face.
const LEAST_COSINE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Area of the faces that the particles of a boundary have at the start, m^(d-1), by the direction of an axis that they look to most: down and up
/// along x, y and z.
pub fn faces_by_direction(
    model: &Model,
    particles: &Particles,
    facets: &ReferenceFacets,
    of: &HeatBoundary,
) -> [f64; 6] {
    let thickness = facet_thickness(model).powi(3 - model.dimensions.count() as i32);
    let mut areas = [0.0; 6];
    for i in (0..particles.len()).filter(|i| of.claims(particles.body[*i], particles.regions[*i])) {
        for face in facets.of(particles.id[i]) {
            let normal = face.facet.normal;
            let axis = (1..3).fold(0, |most, k| if normal[k].abs() > normal[most].abs() + 1e-9 { k } else { most });
            areas[2 * axis + usize::from(normal[axis] > 0.0)] += face.facet.area() / thickness;
        }
    }
    areas
}

/// The faces through which boundaries pass heat: exposed faces of cells at the start, on the surface of the shape.
#[derive(Clone, Debug, Default)]
pub struct HeatFaces {
    /// Of each boundary, by the number of the particle; nothing for one without a normal.
    at_unit_density: Vec<Option<Vec<f64>>>,
    /// All faces, by the number of the particle, if some boundary is on surfaces that it does not name.
    outline: Vec<f64>,
}

impl HeatFaces {
    /// Those of the boundaries of a model, of all its particles.
    pub fn new(model: &Model) -> Self {
        let boundaries = &model.thermal.boundaries;
        let is_held = |boundary: &HeatBoundary| matches!(boundary.kind, HeatBoundaryKind::HeldTemperature(_));
        if !model.thermal.conduction || boundaries.iter().all(is_held) {
            return Self { at_unit_density: vec![None; boundaries.len()], outline: Vec::new() };
        }
        let facets = ReferenceFacets::new(model);
        let densities: Vec<f64> = model.bodies.iter().map(|body| model.density_at_start(body)).collect();
        let missing = 3 - model.dimensions.count();
        let thickness = facet_thickness(model).powi(missing as i32);
        let named = |normal: Option<Vector<f64>>| {
            let is_named = |of: &&CellFacet| normal.is_none_or(|n| dot(of.facet.normal, n) > LEAST_COSINE - 1e-9);
            let of_particle = |id: u32| {
                let area = facets.of(id).iter().filter(is_named).map(|of| of.facet.area()).sum::<f64>() / thickness;
                face_at_unit_density(model.dimensions.into(), area, densities[facets.body_of(id)])
            };
            (0..facets.particles()).map(of_particle).collect()
        };
        let finds_surfaces = boundaries.iter().any(|boundary| boundary.normal.is_none() && !is_held(boundary));
        Self {
            at_unit_density: boundaries.iter().map(|boundary| boundary.normal.map(|n| named(Some(n)))).collect(),
            outline: if finds_surfaces { named(None) } else { Vec::new() },
        }
    }

    /// Of all faces of the particle with this number, zero for none: their area at unit density.
    #[inline]
    pub fn outline(&self, id: u32) -> f64 {
        self.outline.get(id as usize).copied().unwrap_or(0.0)
    }

    /// Of a boundary that names faces, that of the particle with this number, zero for none: its area at unit density
    /// ([`face_area`](sphorge_physics::conduction::face_area)).
    #[inline]
    pub fn at_unit_density(&self, boundary: usize, id: u32) -> Option<f64> {
        let of_boundary = self.at_unit_density.get(boundary)?.as_ref()?;
        Some(of_boundary.get(id as usize).copied().unwrap_or(0.0))
    }

    /// Boundaries that name faces that none of their particles has.
    pub fn nameless(&self, model: &Model, particles: &Particles) -> Vec<usize> {
        let has = |k: usize, boundary: &HeatBoundary| {
            (0..particles.len()).any(|i| {
                boundary.claims(particles.body[i], particles.regions[i])
                    && self.at_unit_density(k, particles.id[i]).is_some_and(|face| face > 0.0)
            })
        };
        let boundaries = model.thermal.boundaries.iter().enumerate();
        boundaries
            .filter(|(k, boundary)| self.at_unit_density.get(*k).is_some_and(Option::is_some) && !has(*k, boundary))
            .map(|(k, _)| k)
            .collect()
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        8 * (self.at_unit_density.iter().flatten().map(Vec::capacity).sum::<usize>() + self.outline.capacity())
    }
}
