//! Walls that push bodies of the total Lagrangian form at the facets of their particles.
//!
//! Facets are those of the initial configuration ([`ReferenceFacets`]), and follow with the whole deformation since the
//! start. A wall is rigid and has no facets to search for: each particle meets all walls by itself. A plane is a facet
//! without end; a segment pushes with both sides and both ends ([`RigidSegment`]). Particles without a facet meet walls
//! as they do where nothing has facets ([`super::walls`]), so that a wall also holds what has come out of a body.

use super::faces::WholeDeformation;
use super::facets::{MARGIN, MOBILITY};
use super::walls::WallState;
use crate::WallLedger;
use crate::facet_laws::COINCIDENCE;
use crate::geometry::{CellFacet, ReferenceFacets, facet_thickness};
use crate::model::{Body, Model, Wall, WallContact, WallSurface};
use crate::particles::Particles;
use sphorge_physics::facet::{
    Facet, FacetMaterial, FacetPairLaw, FacetPress, FacetSlip, FacetStrength, FrictionShare, Partner, RigidSegment,
    SlipDrive, damp_sliding, friction_force, moment_of_torn, press, slip_after, stress_of_moment,
};
use sphorge_physics::tensor::dot;
use sphorge_physics::time_step::oscillator_limit;
use sphorge_physics::wall::FacePushes;
use sphorge_physics::{Dimension, Tensor, Vector};

/// Width of the strip by which the end of a segment pushes, in spacings of the body.
const WIDTH_OF_ENDS: f64 = 1.0;

/// Facets of particles, and their laws against walls.
pub(super) struct FacetsOnWalls {
    dimension: Dimension,
    reference: ReferenceFacets,
    thickness: f64,
    /// By wall and body; nothing for walls that push particles.
    laws: Vec<Vec<FacetPairLaw<f64>>>,
    /// Distance of the farthest corner of a facet from its particle at rest, by body, m.
    farthest: Vec<f64>,
    /// Damping of tangential springs, likewise, Pa s/m.
    sliding_damping: Vec<Vec<f64>>,
    has_friction: bool,
    /// The first wall with friction at facets: nothing says any more which one springs had that have let go.
    rubbing: Option<usize>,
}

/// What a wall does to a particle at its facets.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FacetsPush {
    /// N.
    pub(super) force: Vector<f64>,
    /// Moment about the particle, of the power `M:L`, N m.
    pub(super) moment: Tensor<f64>,
    /// Heat of damping and friction, W.
    pub(super) heat: f64,
    /// Friction's part of it, W.
    pub(super) rubbed: f64,
    /// What the wall holds, J.
    pub(super) stored: f64,
    /// Sum over the facets of pressed area times stiffness, N/m, and times damping, N s/m.
    pub(super) stiffness: f64,
    pub(super) damping: f64,
}

impl FacetsPush {
    /// Adds it to what else walls do to particle `i`; the powers of the wall, W.
    pub(super) fn add_to(&self, sum: &mut FacePushes<f64>, p: &Particles, i: usize) -> WallLedger {
        let mass = p.mass[i];
        let of_force = dot(self.force, p.evaluated_velocity[i]);
        let of_moment = (0..3).map(|k| dot(self.moment[k], p.evaluated_gradient[i][k])).sum();
        let stress = stress_of_moment(&self.moment, &p.deformation[i]);
        let power = sum.add_at_facets(mass, (self.force, of_force), (stress, of_moment), self.heat);
        WallLedger { work: mass * power, friction_work: self.rubbed, damping_work: self.heat - self.rubbed }
    }
}

/// Largest stable step over the margin of a particle of that mass (kg) with these [sums](FacetsPush::stiffness) of stiffness and damping, s.
pub(super) fn limit_of_facets((stiffness, damping): (f64, f64), mass: f64) -> f64 {
    let mobility = MOBILITY / mass;
    MARGIN * oscillator_limit(mobility * stiffness, mobility * damping)
}

/// The tangential springs of the faces of a cell that rub on walls, and the power of their friction, W: over the stiffness of a
/// spring, m²/s, where it has one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Springs {
    of_face: [FacetSlip<f64>; 6],
    rubbed: [f64; 6],
}

impl Springs {
    /// From the springs of the faces on the low and on the high sides of a cell.
    pub(super) fn from_columns(low: &Tensor<f64>, high: &Tensor<f64>) -> Self {
        let of_face = std::array::from_fn(|face| {
            let [x, y, stiffness] = if face % 2 == 0 { low[face / 2] } else { high[face / 2] };
            FacetSlip { slip: [x, y], stiffness }
        });
        Self { of_face, rubbed: [0.0; 6] }
    }

    pub(super) fn to_columns(
        self,
        slips: (&mut Tensor<f64>, &mut Tensor<f64>),
        rubbed: (&mut Vector<f64>, &mut Vector<f64>),
    ) {
        for axis in 0..3 {
            let row = |FacetSlip { slip: [x, y], stiffness }: FacetSlip<f64>| [x, y, stiffness];
            (slips.0[axis], slips.1[axis]) = (row(self.of_face[2 * axis]), row(self.of_face[2 * axis + 1]));
            (rubbed.0[axis], rubbed.1[axis]) = (self.rubbed[2 * axis], self.rubbed[2 * axis + 1]);
        }
    }
}

/// A particle as walls meet it.
#[derive(Clone, Copy)]
struct AtWalls {
    x: Vector<f64>,
    velocity: Vector<f64>,
    gradient: Tensor<f64>,
    /// Since the start.
    deformation: Tensor<f64>,
    body: usize,
    id: u32,
}

impl AtWalls {
    fn new(p: &Particles, i: usize) -> Self {
        let whole = WholeDeformation { since: &p.deformation, earlier: &p.earlier_deformation };
        Self {
            x: p.position[i],
            velocity: p.evaluated_velocity[i],
            gradient: p.evaluated_gradient[i],
            deformation: whole.at(i),
            body: p.body[i] as usize,
            id: p.id[i],
        }
    }
}

/// A facet that a wall presses.
struct Met<'a> {
    face: usize,
    facet: Facet<f64>,
    /// The first part of the face that the facet is a part of: the slip is along its edges.
    lead: Facet<f64>,
    stretch: f64,
    press: FacetPress<f64>,
    law: &'a FacetPairLaw<f64>,
    /// Of the material at the centre of pressure relative to the wall, m/s.
    velocity: Vector<f64>,
}

impl FacetsOnWalls {
    /// `None` if no wall pushes at facets.
    pub(super) fn new(model: &Model) -> Option<Self> {
        if !model.meets_walls_at_facets() {
            return None;
        }
        let thickness = facet_thickness(model);
        let missing = thickness.powi(3 - model.dimensions.count() as i32);
        let law = |wall: &Wall, body: &Body| match wall.contact {
            WallContact::Penalty { stiffness, damping, friction, at_facets: true } => {
                let material = &model.materials[body.material];
                let speed = material.equation_of_state.reference_sound_speed();
                let of = FacetMaterial {
                    half_depth: 0.5 * body.spacing,
                    density: material.density,
                    bulk_modulus: material.density * speed * speed,
                };
                // That of a deck is per closure of a spacing, not of the half cell.
                let strength = FacetStrength { stiffness: 0.5 * stiffness, damping, friction };
                let law = FacetPairLaw::against_rigid(&of, strength);
                let sliding_damping = law.sliding_damping(&of) / missing;
                let law = FacetPairLaw {
                    stiffness: law.stiffness / missing,
                    damping: law.damping / missing,
                    tangential_stiffness: law.tangential_stiffness / missing,
                    coincidence: COINCIDENCE,
                    ..law
                };
                Some((law, sliding_damping))
            }
            WallContact::Penalty { at_facets: false, .. } | WallContact::MonaghanKos { .. } => None,
        };
        let of_wall = |wall| model.bodies.iter().filter_map(|body| law(wall, body)).unzip();
        let (laws, sliding_damping) = model.walls.iter().map(of_wall).unzip();
        let reference = ReferenceFacets::new(model);
        Some(Self {
            dimension: model.dimensions.into(),
            farthest: (0..model.bodies.len()).map(|body| reference.farthest(body)).collect(),
            reference,
            thickness,
            laws,
            sliding_damping,
            has_friction: model.rubs_at_facets_of_walls(),
            rubbing: model.walls.iter().position(|wall| wall.is_at_facets() && wall.rubs()),
        })
    }

    /// Whether a wall meets facets of a particle.
    fn is_met(&self, wall: usize, id: u32) -> bool {
        !self.laws[wall].is_empty() && !self.reference.range(id).is_empty()
    }

    pub(super) fn has_friction(&self) -> bool {
        self.has_friction
    }

    /// Whether a wall may reach the facets of a particle at this place (m) with this deformation since the start.
    fn is_near(
        &self,
        model: &Model,
        states: &[WallState],
        wall: usize,
        (body, x): (usize, Vector<f64>),
        f: &Tensor<f64>,
    ) -> bool {
        let stretch = f.as_flattened().iter().map(|c| c * c).sum::<f64>().sqrt();
        let reach = stretch * self.farthest[body] + WIDTH_OF_ENDS * model.bodies[body].spacing;
        states[wall].gap(&model.walls[wall].surface, x).is_none_or(|gap| gap.distance <= reach)
    }

    /// Whether any wall may reach the facets of particle `i`.
    pub(super) fn is_near_any(&self, model: &Model, states: &[WallState], p: &Particles, i: usize) -> bool {
        let whole = WholeDeformation { since: &p.deformation, earlier: &p.earlier_deformation };
        let (at, f) = ((p.body[i] as usize, p.position[i]), whole.at(i));
        (0..self.laws.len()).any(|wall| self.is_met(wall, p.id[i]) && self.is_near(model, states, wall, at, &f))
    }

    /// Calls `visit` with every facet of a particle that a wall presses.
    fn each<'a>(
        &'a self,
        model: &Model,
        states: &[WallState],
        walls: std::ops::Range<usize>,
        of: &AtWalls,
        mut visit: impl FnMut(Met<'a>),
    ) {
        let body = of.body;
        let width = WIDTH_OF_ENDS * model.bodies[body].spacing;
        for wall in walls.filter(|&wall| self.is_met(wall, of.id)) {
            if !self.is_near(model, states, wall, (body, of.x), &of.deformation) {
                continue;
            }
            let (surface, state) = (&model.walls[wall].surface, &states[wall]);
            let law = &self.laws[wall][body];
            let mut lead: Option<(u8, Facet<f64>)> = None;
            for &CellFacet { side, facet: reference } in self.reference.of(of.id) {
                let (facet, stretch) = Facet::now(of.x, &of.deformation, &reference).held(reference.depth);
                let first = match lead {
                    Some((known, first)) if known == side => first,
                    _ => facet,
                };
                lead = Some((side, first));
                let presses = match *surface {
                    WallSurface::Plane { point, normal } => {
                        let foot = facet.foot_on_plane(state.at(point), normal);
                        [Some(press(&facet, &foot, Partner::Plane, law)), None, None]
                    }
                    WallSurface::Segment { from, to } => {
                        let ends = [state.at(from), state.at(to)];
                        let segment = RigidSegment { ends, thickness: self.thickness };
                        let end = |end| Some(segment.press_end(&facet, end, width, law));
                        [Some(segment.press_side(&facet, law)), end(0), end(1)]
                    }
                };
                for press in presses.into_iter().flatten().filter(|press| press.energy > 0.0) {
                    let press = press.within(self.dimension);
                    let at_rest = [[0.0; 3]; 3];
                    let velocity = press.velocity(of.velocity, &of.gradient, state.velocity(), &at_rest);
                    visit(Met { face: usize::from(side), facet, lead: first, stretch, press, law, velocity });
                }
            }
        }
    }

    /// Springs of a particle after a step `dt` (s) on all walls.
    pub(super) fn slip(
        &self,
        model: &Model,
        states: &[WallState],
        p: &Particles,
        i: usize,
        mut springs: Springs,
        dt: f64,
    ) -> Springs {
        let mut drives = [SlipDrive::none(); 6];
        let mut leads: [Option<Facet<f64>>; 6] = [None; 6];
        self.each(model, states, 0..self.laws.len(), &AtWalls::new(p, i), |met| {
            drives[met.face].add(&FrictionShare::of(&met.press, met.law, met.velocity, true));
            leads[met.face] = Some(met.lead);
        });
        for (face, spring) in springs.of_face.iter_mut().enumerate() {
            let (after, heat) = match &leads[face] {
                Some(lead) => slip_after(spring, lead, &drives[face], dt),
                None => (FacetSlip::none(), spring.energy()),
            };
            let power = if dt > 0.0 { heat / dt } else { 0.0 };
            springs.rubbed[face] = if after.stiffness > 0.0 { power / after.stiffness } else { power };
            *spring = after;
        }
        springs
    }

    /// What a wall does to particle `i` at its facets; `None` if the wall or the particle has none.
    pub(super) fn on(
        &self,
        model: &Model,
        states: &[WallState],
        wall: usize,
        p: &Particles,
        i: usize,
    ) -> Option<FacetsPush> {
        if !self.is_met(wall, p.id[i]) {
            return None;
        }
        let mut push = FacetsPush::default();
        let springs = self.has_friction.then(|| {
            let springs = Springs::from_columns(&p.wall_slip_of_low_faces[i], &p.wall_slip_of_high_faces[i]);
            let (low, high) = (p.rubbed_on_walls_at_low_faces[i], p.rubbed_on_walls_at_high_faces[i]);
            let rubbed = std::array::from_fn(|face| if face % 2 == 0 { low[face / 2] } else { high[face / 2] });
            Springs { rubbed, ..springs }
        });
        self.each(model, states, wall..wall + 1, &AtWalls::new(p, i), |mut met| {
            push.stored += met.press.energy;
            if met.stretch > 1.0 {
                add(&mut push.moment, &moment_of_torn(&met.facet, met.stretch, met.press.force));
            }
            let (mut force, damped) = met.press.damping(met.law, met.velocity);
            push.heat += damped;
            if let Some(springs) = springs.filter(|_| met.law.friction > 0.0) {
                let spring = &springs.of_face[met.face];
                let pull = friction_force(&met.press, met.law, spring.vector(&met.lead), [0.0; 3], true);
                (0..3).for_each(|k| force[k] += pull[k]);
                let coefficient = self.sliding_damping[wall][p.body[i] as usize];
                let (held, damped) = damp_sliding(&met.press, met.law, coefficient, pull, met.velocity);
                (0..3).for_each(|k| force[k] += held[k]);
                push.heat += damped;
                let share = FrictionShare::of(&met.press, met.law, met.velocity, true).stiffness;
                if spring.stiffness > 0.0 {
                    push.rubbed += share * springs.rubbed[met.face];
                    push.stored += share / spring.stiffness * spring.energy();
                }
            }
            met.press.add_at_centre(force);
            (0..3).for_each(|k| push.force[k] += met.press.force[k]);
            add(&mut push.moment, &met.press.moment_a);
            push.stiffness += met.press.area * met.press.stiffness;
            push.damping += met.press.area * met.law.damping;
        });
        if let Some(springs) = springs.filter(|_| self.rubbing == Some(wall)) {
            // Of springs that have let go.
            let free = springs.of_face.iter().zip(springs.rubbed).filter(|(spring, _)| spring.stiffness == 0.0);
            push.rubbed += free.map(|(_, power)| power).sum::<f64>();
        }
        push.heat += push.rubbed;
        Some(push)
    }

    pub(super) fn bytes(&self) -> usize {
        self.reference.bytes()
    }
}

fn add(sum: &mut Tensor<f64>, more: &Tensor<f64>) {
    for (sum, more) in sum.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
        *sum += more;
    }
}
