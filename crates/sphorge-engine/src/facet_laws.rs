//! The laws of the contact of bodies at their facets. Bodies are of few kinds, and a law belongs to two kinds.

use crate::approach::fastest;
use crate::geometry::facet_thickness;
use crate::model::{Body, Model, MotionAxis, TimeTable};
use sphorge_physics::contact::ContactStrength;
use sphorge_physics::facet::{FacetImpact, FacetMaterial, FacetPairLaw, FacetStrength};

/// The laws of the pairs of bodies, by kinds of bodies.
#[derive(Clone, Debug)]
pub struct FacetLaws {
    kinds: Vec<usize>,
    count: usize,
    laws: Vec<FacetPairLaw<f64>>,
    /// Whether bodies rub each other.
    pub has_friction: bool,
}

impl FacetLaws {
    /// Of the bodies of a model.
    pub fn new(model: &Model, strength: ContactStrength) -> Self {
        let ContactStrength { stiffness, damping, friction } = strength;
        let strength = FacetStrength { stiffness, damping, friction };
        let mut examples: Vec<(FacetMaterial, bool)> = Vec::new();
        let impact = impact(model);
        let holds_at_rest = stiffness >= FIRM && !is_squeezed(model);
        let kind = |body: &Body| {
            let material = &model.materials[body.material];
            let speed = material.equation_of_state.reference_sound_speed();
            let of = FacetMaterial {
                half_depth: 0.5 * body.spacing,
                density: material.density,
                bulk_modulus: material.density * speed * speed,
            };
            let of = (of, material.breaks());
            examples.iter().position(|known| *known == of).unwrap_or_else(|| {
                examples.push(of);
                examples.len() - 1
            })
        };
        let kinds: Vec<usize> = model.bodies.iter().map(kind).collect();
        // Facets are as thick along axes that are not there; forces are per unit of thickness.
        let thickness = facet_thickness(model).powi(3 - model.dimensions.count() as i32);
        let law = |(a, a_breaks): &(FacetMaterial, bool), (b, b_breaks): &(FacetMaterial, bool)| {
            let law = FacetPairLaw::new(a, b, strength);
            let closed = law.stiffness * (a.half_depth + b.half_depth);
            let may_give_way = holds_at_rest || *a_breaks || *b_breaks;
            let law = if may_give_way { law.giving_way(impact, closed) } else { law };
            FacetPairLaw {
                stiffness: law.stiffness / thickness,
                damping: law.damping / thickness,
                tangential_stiffness: law.tangential_stiffness / thickness,
                coincidence: COINCIDENCE,
                ..law
            }
        };
        let count = examples.len();
        let laws = (0..count * count).map(|k| law(&examples[k / count], &examples[k % count])).collect();
        Self { kinds, count, laws, has_friction: friction > 0.0 }
    }

    /// Whether there are pairs that give way where their owners come to lie beside each other.
    pub fn some_give_way(&self) -> bool {
        self.laws.iter().any(|law| law.gives_way > 0.0)
    }

    /// Of the facets of two bodies, in either order.
    pub fn of(&self, a: usize, b: usize) -> &FacetPairLaw<f64> {
        &self.laws[self.kinds[a] * self.count + self.kinds[b]]
    }
}

/// Distance over the size of a facet within which edges coincide ([`FacetPairLaw::coincidence`]): 64 roundings of single precision, in which forces are summed by
/// default. Where cells are in line, chance would decide whose edges pull, with all of the energy along them: plates at 3 km/s were torn at their contact. In
/// double precision it is as much, or a shift by 1e-12 m would change the feet of two blocks by 0.8 %.
pub const COINCIDENCE: f64 = 64.0 * f32::EPSILON as f64;

/// Stiffness from which on pairs give way: at half of their depth they then press with 1.5 bulk moduli, which an impact that slow does not. Softer faces may be
/// pressed as much at any speed, and would pass into each other.
const FIRM: f64 = 1.0;

/// Travel of walls and of what is held in motion over the thickness of the thinnest body from which on bodies may be squeezed to such pressures, however slowly.
const SQUEEZED: f64 = 0.2;

/// Whether bodies may be squeezed between things that are driven.
fn is_squeezed(model: &Model) -> bool {
    let held = model.motions.iter().flat_map(|motion| motion.axes.iter().enumerate());
    let held = held.filter_map(|(axis, way)| match way {
        MotionAxis::Free => None,
        MotionAxis::Velocity(table) => Some((axis, table)),
    });
    let walls = model.walls.iter().flat_map(|wall| wall.velocity.iter().enumerate());
    // Ways against each other add up, and so do ways there and back.
    let mut travel = [0.0; 3];
    for (axis, table) in held.chain(walls) {
        let size = TimeTable { points: table.points.iter().map(|(time, v)| (*time, v.abs())).collect() };
        travel[axis] += size.integral(0.0, model.time.end);
    }
    let thickness = |body: &Body| {
        let (low, high) = body.shape.bounds(model.dimensions);
        (0..model.dimensions.count()).map(|a| high[a] - low[a]).fold(f64::INFINITY, f64::min)
    };
    let thinnest = model.bodies.iter().map(thickness).fold(f64::INFINITY, f64::min);
    travel.iter().any(|travel| *travel > SQUEEZED * thinnest)
}

/// What faces bear before they give way, over the pressure behind the shocks of an impact: the first swing, and what two shocks make where they meet.
const BORNE: f64 = 3.0;

/// The energy that they stop before they give way, over that with which the impact meets them. Plates of copper with spacings of 1 : 1.4 passed through each other from
/// 6 to 9 km/s with 1.5.
const STOPPED: f64 = 2.5;

/// What flat faces have to bear in a model if each material meets the like as fast as anything does: behind both shocks `rho v/2 (c + S v/2)` with `S = 1.5`,
/// as metals have it, and `rho v^2/4` of the two cells that meet. What is driven meets them with all of its speed, as if the other half were as fast.
fn impact(model: &Model) -> FacetImpact {
    let is_driven = !model.motions.is_empty() || !model.walls.is_empty();
    let half = if is_driven { 1.0 } else { 0.5 } * fastest(model);
    let of = |body: &Body| {
        let material = &model.materials[body.material];
        let sound = material.equation_of_state.reference_sound_speed();
        [material.density * half * (sound + 1.5 * half), material.density * half * half]
    };
    let most = |which: usize| model.bodies.iter().map(|body| of(body)[which]).fold(0.0, f64::max);
    FacetImpact { pressure: BORNE * most(0), energy: STOPPED * most(1) }
}
