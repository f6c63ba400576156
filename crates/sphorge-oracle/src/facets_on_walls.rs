//! Walls that push the facets of particles: every facet with every wall.

use super::Oracle;
use super::pairs::plus;
use super::surroundings::{AtFace, integral};
use sphorge_engine::Particles;
use sphorge_engine::geometry::{ReferenceFacets, facet_thickness};
use sphorge_engine::model::{Model, Wall, WallContact, WallSurface};
use sphorge_physics::facet::{
    Facet, FacetMaterial, FacetPairLaw, FacetPress, FacetSlip, FacetStrength, FrictionShare, Partner, RigidSegment,
    SlipDrive, damp_sliding, friction_force, moment_of_torn, press, slip_after, stress_of_moment,
};
use sphorge_physics::tensor::{dot, multiply};
use sphorge_physics::time_step::oscillator_limit;
use sphorge_physics::{Tensor, Vector};

/// Width of the ends of segments, in spacings.
const WIDTH: f64 = 1.0;
/// Half of the limit of stability at a Courant number of 0.3, and the mobility of faces.
const MARGIN: f64 = 1.5;
const MOBILITY: f64 = 2.5;

/// Facets against walls, and their springs of friction.
pub(crate) struct WallFacets {
    pub(crate) all: ReferenceFacets,
    thickness: f64,
    /// Faces of the cell of each particle that were inside its body.
    /// Velocity gradients at the velocities at which forces are evaluated, 1/s.
    pub(crate) gradient: Vec<Tensor<f64>>,
    /// By particle and face of its cell: the spring, and its power of friction over its stiffness, m^2/s; the power itself, W, if it has let go.
    springs: Vec<[(FacetSlip<f64>, f64); 6]>,
}

/// A facet that a wall presses.
struct Met {
    face: usize,
    facet: Facet<f64>,
    stretch: f64,
    /// The first part of the same face.
    lead: Facet<f64>,
    press: FacetPress<f64>,
    /// Relative to the wall at the centre of pressure, m/s.
    velocity: Vector<f64>,
}

impl WallFacets {
    /// `None` where walls push particles.
    pub(crate) fn new(model: &Model, p: &Particles) -> Option<Self> {
        model.meets_walls_at_facets().then(|| Self {
            all: ReferenceFacets::new(model),
            thickness: facet_thickness(model),
            gradient: vec![[[0.0; 3]; 3]; p.len()],
            springs: vec![[(FacetSlip::none(), 0.0); 6]; p.len()],
        })
    }
}

/// Largest stable step over the margin of a particle of that mass (kg) for the sums of its facets on all walls, s.
pub(crate) fn limit_on_walls([stiffness, damping]: [f64; 2], mass: f64) -> f64 {
    MARGIN * oscillator_limit(MOBILITY * stiffness / mass, MOBILITY * damping / mass)
}

impl Oracle {
    /// Whether a wall pushes a particle at facets.
    pub(crate) fn is_pushed_at_facets(&self, wall: &Wall, i: usize) -> bool {
        let has_facets = |facets: &WallFacets| !facets.all.of(self.p.id[i]).is_empty();
        wall.is_at_facets() && self.wall_facets.as_ref().is_some_and(has_facets)
    }

    /// The law of a wall for a particle, and the damping of its tangential springs, Pa s/m.
    fn law_of_wall(&self, wall: &Wall, i: usize) -> (FacetPairLaw<f64>, f64) {
        let WallContact::Penalty { stiffness, damping, friction, .. } = wall.contact else {
            return (FacetPairLaw::default(), 0.0);
        };
        let material = self.material(i);
        let c = material.equation_of_state.reference_sound_speed();
        let (half_depth, density) = (0.5 * self.model.bodies[self.p.body[i] as usize].spacing, material.density);
        let of = FacetMaterial { half_depth, density, bulk_modulus: density * c * c };
        let strength = FacetStrength { stiffness: 0.5 * stiffness, damping, friction };
        let law = FacetPairLaw::against_rigid(&of, strength);
        let missing = facet_thickness(&self.model).powi(3 - self.model.dimensions.count() as i32);
        let law_there = FacetPairLaw {
            stiffness: law.stiffness / missing,
            damping: law.damping / missing,
            friction,
            tangential_stiffness: law.tangential_stiffness / missing,
            gives_way: 0.0,
            coincidence: sphorge_engine::COINCIDENCE,
        };
        (law_there, law.sliding_damping(&of) / missing)
    }

    /// All facets of a particle that a wall presses where it stands at a time, s.
    fn pressed_by_wall(&self, wall: &Wall, time: f64, i: usize) -> Vec<Met> {
        let Some(facets) = &self.wall_facets else { return Vec::new() };
        let (id, body) = (self.p.id[i], self.p.body[i] as usize);
        let cells = facets.all.of(id);
        let whole = multiply(&self.deformation[i], &self.earlier_deformation[i]);
        let here = |k: usize| {
            let facet = cells[k].facet;
            Facet::now(self.p.position[i], &whole, &facet).held(facet.depth)
        };
        let shift = [0, 1, 2].map(|a| integral(&wall.velocity[a], time));
        let wall_velocity = [0, 1, 2].map(|a| wall.velocity[a].at(time));
        let law = self.law_of_wall(wall, i).0;
        let mut met = Vec::new();
        for k in 0..cells.len() {
            let (facet, stretch) = here(k);
            let first = (0..cells.len()).find(|&other| cells[other].side == cells[k].side).unwrap_or(k);
            let presses = match wall.surface {
                WallSurface::Plane { point, normal } => {
                    let foot = facet.foot_on_plane(plus(point, 1.0, shift), normal);
                    vec![press(&facet, &foot, Partner::Plane, &law)]
                }
                WallSurface::Segment { from, to } => {
                    let ends = [from, to].map(|end| plus(end, 1.0, shift));
                    let segment = RigidSegment { ends, thickness: facets.thickness };
                    let width = WIDTH * self.model.bodies[body].spacing;
                    let of_end = |end| segment.press_end(&facet, end, width, &law);
                    vec![segment.press_side(&facet, &law), of_end(0), of_end(1)]
                }
            };
            for press in presses.into_iter().filter(|press| press.energy > 0.0) {
                let press = press.within(self.dimension);
                let (v, l) = (self.evaluated[i], &facets.gradient[i]);
                let velocity = press.velocity(v, l, wall_velocity, &[[0.0; 3]; 3]);
                let face = usize::from(cells[k].side);
                met.push(Met { face, facet, stretch, lead: here(first).0, press, velocity });
            }
        }
        met
    }

    /// Lets the springs of all facets slip on the walls where they stand at a time, s.
    pub(crate) fn slip_on_walls(&mut self, time: f64) {
        if self.wall_facets.is_some() {
            let gradient = self.evaluated_gradients();
            self.wall_facets.iter_mut().for_each(|facets| facets.gradient.clone_from(&gradient));
        }
        if !self.model.rubs_at_facets_of_walls() {
            return;
        }
        let Some(mut springs) = self.wall_facets.as_mut().map(|facets| std::mem::take(&mut facets.springs)) else {
            return;
        };
        for (i, springs) in springs.iter_mut().enumerate() {
            let mut drives = [SlipDrive::none(); 6];
            let mut leads = [None; 6];
            for wall in self.model.walls.iter().filter(|wall| wall.is_at_facets()) {
                let law = self.law_of_wall(wall, i).0;
                for met in self.pressed_by_wall(wall, time, i) {
                    drives[met.face].add(&FrictionShare::of(&met.press, &law, met.velocity, true));
                    leads[met.face] = Some(met.lead);
                }
            }
            for face in 0..6 {
                let before = springs[face].0;
                let (after, heat) = match &leads[face] {
                    Some(lead) => slip_after(&before, lead, &drives[face], self.dt),
                    None => (FacetSlip::none(), before.energy()),
                };
                let power = if self.dt > 0.0 { heat / self.dt } else { 0.0 };
                springs[face] = (after, if after.stiffness > 0.0 { power / after.stiffness } else { power });
            }
        }
        if let Some(facets) = &mut self.wall_facets {
            facets.springs = springs;
        }
    }

    /// What a wall, as it stands at a time (s), does to the facets of a particle, and what it holds, J.
    pub(crate) fn wall_push_at_facets(&self, wall: &Wall, time: f64, i: usize) -> (AtFace, f64) {
        let Some(facets) = &self.wall_facets else { return (AtFace::default(), 0.0) };
        let (law, sliding_damping) = self.law_of_wall(wall, i);
        let (mut force, mut moment) = ([0.0; 3], [[0.0; 3]; 3]);
        let (mut damped, mut rubbed, mut held) = (0.0, 0.0, 0.0);
        let (mut stiffness, mut damping) = (0.0, 0.0);
        for mut met in self.pressed_by_wall(wall, time, i) {
            held += met.press.energy;
            let torn = moment_of_torn(&met.facet, met.stretch, met.press.force);
            let (mut push, heat) = met.press.damping(&law, met.velocity);
            damped += heat;
            if law.friction > 0.0 {
                let (spring, power) = &facets.springs[i][met.face];
                let pull = friction_force(&met.press, &law, spring.vector(&met.lead), [0.0; 3], true);
                let (slowed, heat) = damp_sliding(&met.press, &law, sliding_damping, pull, met.velocity);
                push = plus(plus(push, 1.0, pull), 1.0, slowed);
                damped += heat;
                let share = FrictionShare::of(&met.press, &law, met.velocity, true).stiffness;
                if spring.stiffness > 0.0 {
                    rubbed += share * power;
                    held += share / spring.stiffness * spring.energy();
                }
            }
            met.press.add_at_centre(push);
            force = plus(force, 1.0, met.press.force);
            (0..3).for_each(|k| moment[k] = plus(plus(moment[k], 1.0, torn[k]), 1.0, met.press.moment_a[k]));
            stiffness += met.press.area * met.press.stiffness;
            damping += met.press.area * law.damping;
        }
        let rubs = |wall: &&Wall| wall.is_at_facets() && wall.rubs();
        if self.model.walls.iter().find(rubs).is_some_and(|first| first.name == wall.name) {
            // Of springs that have let go.
            rubbed +=
                facets.springs[i].iter().filter(|(slip, _)| slip.stiffness == 0.0).map(|(_, power)| power).sum::<f64>();
        }
        let mass = self.p.mass[i];
        let of_moment: f64 = (0..3).map(|k| dot(moment[k], facets.gradient[i][k])).sum();
        let power = (dot(force, self.evaluated[i]) + of_moment + damped + rubbed) / mass;
        let stress =
            stress_of_moment(&moment, &self.deformation[i]).map(|row| row.map(|c| -c / self.initial_volume[i]));
        let push = force.map(|f| f / mass);
        (
            AtFace {
                push,
                power,
                rubbed: rubbed / mass,
                damped: damped / mass,
                stress,
                stability: [stiffness, damping],
            },
            held,
        )
    }
}
