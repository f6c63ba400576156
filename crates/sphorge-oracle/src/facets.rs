//! Contact at facets, in the total Lagrangian form: every facet with every facet, and with the images of all.

use super::Oracle;
use super::pairs::{Image, minus, plus};
use sphorge_engine::geometry::{ReferenceFacets, facet_thickness};
use sphorge_engine::model::{BodyContact, Model};
use sphorge_engine::{COINCIDENCE, FacetLaws, Particles};
use sphorge_physics::conduction::friction_share;
use sphorge_physics::facet::{
    Facet, FacetMaterial, FacetPairLaw, FacetPress, FacetSlip, FacetStrength, FrictionShare, OnSides, Partner,
    ReferenceFacet, SharedEdge, SlipDrive, edges_reversed, friction_force, half_of_misfit, moment_of_edge,
    moment_of_torn, press, slip_after, stress_of_moment,
};
use sphorge_physics::tensor::{dot, multiply};
use sphorge_physics::time_step::oscillator_limit;
use sphorge_physics::{SymmetricTensor, Tensor, Vector};

/// Half of the limit of stability at a Courant number of 0.3.
const MARGIN: f64 = 1.5;
const MOBILITY: f64 = 2.5;

/// The facets of all particles, and their springs of friction.
pub(crate) struct Facets {
    all: ReferenceFacets,
    reference: Vec<Part>,
    /// Where each is, and the stretch of its cell along its normal, one at least.
    now: Vec<(Facet<f64>, f64)>,
    /// By pair of bodies.
    laws: Vec<Vec<FacetPairLaw<f64>>>,
    has_friction: bool,
    /// By particle and face of its cell: the spring, and its power of friction over its stiffness, m^2/s; the power itself, W, if it has let go.
    springs: Vec<[(FacetSlip<f64>, f64); 6]>,
    /// Velocity gradients at the velocities at which forces are evaluated, 1/s.
    gradient: Vec<Tensor<f64>>,
    /// Shifts of the edges of cells, m.
    shifts: Vec<OnSides<f64>>,
}

/// An edge between the cell of a particle and the next one, or an image of it.
struct EdgeTo {
    side: usize,
    way: Vector<f64>,
    j: usize,
    image: Image,
    edge: SharedEdge<f64>,
    /// Rate of its distance, m/s.
    rate: Vector<f64>,
}

/// A face of a cell, or a part of one.
struct Part {
    owner: usize,
    face: usize,
    /// Place in the order of all.
    place: usize,
    facet: ReferenceFacet<f64>,
    /// The first part of the same face, whose edge the slip is along.
    lead: usize,
}

/// A facet and one that presses it.
struct Met {
    own: usize,
    other: usize,
    image: usize,
    /// Whether the own one is the first of both.
    is_first: bool,
    press: FacetPress<f64>,
    /// Of the first relative to the second at the centre of pressure, m/s.
    velocity: Vector<f64>,
}

impl Facets {
    /// Of the particles of a model in the order of their numbers; none where bodies do not meet at facets.
    pub(crate) fn new(model: &Model, p: &Particles) -> Option<Self> {
        let BodyContact::Facets { whole: strength, .. } = model.contact else { return None };
        if !model.has_facets() {
            return None;
        }
        let material = |body: &sphorge_engine::model::Body| {
            let material = &model.materials[body.material];
            let c = material.equation_of_state.reference_sound_speed();
            let (half_depth, density) = (0.5 * body.spacing, material.density);
            FacetMaterial { half_depth, density, bulk_modulus: density * c * c }
        };
        let (stiffness, damping, friction) = (strength.stiffness, strength.damping, strength.friction);
        // Facets have a thickness where the space has none.
        let missing = facet_thickness(model).powi(3 - model.dimensions.count() as i32);
        // Where pairs give way is a choice, not a law.
        let chosen = FacetLaws::new(model, strength);
        let law = |i: usize, j: usize| {
            let (a, b) = (&model.bodies[i], &model.bodies[j]);
            let law = FacetPairLaw::new(&material(a), &material(b), FacetStrength { stiffness, damping, friction });
            FacetPairLaw {
                stiffness: law.stiffness / missing,
                damping: law.damping / missing,
                tangential_stiffness: law.tangential_stiffness / missing,
                friction,
                gives_way: chosen.of(i, j).gives_way,
                coincidence: COINCIDENCE,
            }
        };
        let bodies = || 0..model.bodies.len();
        let mut facets = Self {
            all: ReferenceFacets::new(model),
            reference: Vec::new(),
            now: Vec::new(),
            laws: bodies().map(|i| bodies().map(|j| law(i, j)).collect()).collect(),
            has_friction: friction > 0.0,
            springs: vec![[(FacetSlip::none(), 0.0); 6]; p.len()],
            gradient: vec![[[0.0; 3]; 3]; p.len()],
            shifts: vec![OnSides::zero(); p.len()],
        };
        facets.list(p);
        Some(facets)
    }

    /// Makes the list of those that are exposed.
    fn list(&mut self, p: &Particles) {
        self.reference.clear();
        for owner in 0..p.len() {
            for place in self.all.range(p.id[owner]) {
                let of_cell = self.all.at(place);
                let (face, index) = (usize::from(of_cell.side), self.reference.len());
                let same = self.reference.iter().position(|part| (part.owner, part.face) == (owner, face));
                self.reference.push(Part { owner, face, place, facet: of_cell.facet, lead: same.unwrap_or(index) });
            }
        }
    }

    /// The spring of a facet, in space, m.
    fn slip(&self, facet: usize) -> Vector<f64> {
        let Part { owner, face, lead, .. } = self.reference[facet];
        self.springs[owner][face].0.vector(&self.now[lead].0)
    }

    fn rubbed(&self, facet: usize) -> f64 {
        let Part { owner, face, .. } = self.reference[facet];
        self.springs[owner][face].1
    }
}

/// A facet as its image.
fn reflected(facet: &Facet<f64>, image: &Image) -> Facet<f64> {
    let corners = facet.corners.map(|c| image.vector(c));
    let [a, b, c, d] = corners;
    let curvature = image.tensor(&facet.curvature.to_tensor());
    Facet {
        owner: image.point(facet.owner),
        corners: if image.is_mirrored() { [b, a, d, c] } else { corners },
        middle: image.vector(facet.middle),
        normal: image.vector(facet.normal),
        curvature: SymmetricTensor::symmetric_part(&curvature),
        free: if image.is_mirrored() { edges_reversed(facet.free) } else { facet.free },
        shift: image.vector(facet.shift),
        shear: image.tensor(&facet.shear),
        ..*facet
    }
}

impl Oracle {
    /// Whether facets of two particles may meet at all: those of different bodies, and those of one that meets itself and were no neighbours.
    fn may_meet(&self, i: usize, j: usize, image: &Image) -> bool {
        let body = self.p.body[i] as usize;
        if self.p.body[j] as usize != body {
            return true;
        }
        let apart = minus(self.searched_at[i], image.point(self.searched_at[j]));
        let reach = self.model.numerics.kernel.support() * self.model.bodies[body].smoothing_length;
        let are_whole = self.integrity[i] > 0.0 && self.integrity[j] > 0.0;
        self.model.has_self_contact() && !self.has_come_apart[body] && are_whole && dot(apart, apart) >= reach * reach
    }

    fn whole_deformation(&self, i: usize) -> Tensor<f64> {
        multiply(&self.deformation[i], &self.earlier_deformation[i])
    }

    /// Edges that the facets of a particle share with those beside it: whatever is where it was at the start.
    fn edges(&self, facets: &Facets, i: usize) -> Vec<EdgeTo> {
        let Some(beside) = facets.all.beside(self.p.id[i]) else { return Vec::new() };
        let f = self.whole_deformation(i);
        let turned = multiply(&facets.gradient[i], &f);
        let mut edges = Vec::new();
        for (side, way) in (0..6).filter_map(|side| Some((side, beside.way(side)?))) {
            for &(j, image) in &self.rows[i] {
                let image = self.images[image];
                let to = |own: Vector<f64>, other: Vector<f64>| minus(image.point(other), own);
                let off = minus(to(self.searched_at[i], self.searched_at[j]), way);
                if dot(off, off).sqrt() > 0.1 * dot(way, way).sqrt() {
                    continue;
                }
                let edge = SharedEdge::of(to(self.p.position[i], self.p.position[j]), &f, way);
                let velocity = minus(image.vector(self.evaluated[j]), self.evaluated[i]);
                edges.push(EdgeTo { side, way, j, image, edge, rate: half_of_misfit(velocity, &turned, way) });
            }
        }
        edges
    }

    /// All facets that press one.
    fn pressing(&self, facets: &Facets, own: usize) -> Vec<Met> {
        let mut met = Vec::new();
        let i = facets.reference[own].owner;
        for (k, image) in self.images.iter().enumerate() {
            for (other, part) in facets.reference.iter().enumerate() {
                let j = part.owner;
                let is_there = k == 0 || image.is_of(&self.model, self.p.position[j]);
                if (k == 0 && i == j) || !is_there || !self.may_meet(i, j, image) {
                    continue;
                }
                let (here, there) = (facets.now[own].0, reflected(&facets.now[other].0, image));
                let motion_i = (self.evaluated[i], facets.gradient[i]);
                let motion_j = (image.vector(self.evaluated[j]), image.tensor(&facets.gradient[j]));
                let is_first = (i, facets.reference[own].place) <= (j, part.place);
                let [(a, (v_a, l_a)), (b, (v_b, l_b))] = match is_first {
                    true => [(here, motion_i), (there, motion_j)],
                    false => [(there, motion_j), (here, motion_i)],
                };
                let law = &facets.laws[self.p.body[i] as usize][self.p.body[j] as usize];
                let press = press(&a, &b, Partner::Facet, law).within(self.dimension);
                if press.energy > 0.0 {
                    let velocity = press.velocity(v_a, &l_a, v_b, &l_b);
                    met.push(Met { own, other, image: k, is_first, press, velocity });
                }
            }
        }
        met
    }

    /// The nearest particle that one may meet, itself or as an image.
    fn nearest_with_facets(&self, facets: &Facets, i: usize) -> Option<usize> {
        let mut nearest = None;
        let mut least = f64::INFINITY;
        for (k, image) in self.images.iter().enumerate() {
            for j in facets.reference.iter().map(|part| part.owner) {
                let is_there = k == 0 || image.is_of(&self.model, self.p.position[j]);
                if (k == 0 && i == j) || !is_there || !self.may_meet(i, j, image) {
                    continue;
                }
                let apart = minus(self.p.position[i], image.point(self.p.position[j]));
                if dot(apart, apart) < least {
                    (least, nearest) = (dot(apart, apart), Some(j));
                }
            }
        }
        nearest
    }

    fn facet_law<'a>(&self, facets: &'a Facets, met: &Met) -> &'a FacetPairLaw<f64> {
        let of = |facet: usize| self.p.body[facets.reference[facet].owner] as usize;
        &facets.laws[of(met.own)][of(met.other)]
    }

    /// Moves the facets to where they are, and lets their springs slip.
    pub(crate) fn follow_facets(&mut self) {
        let Some(mut facets) = self.facets.take() else { return };
        facets.gradient = self.evaluated_gradients();
        for i in 0..self.p.len() {
            let mut shifts = OnSides::zero();
            self.edges(&facets, i).iter().for_each(|edge| *shifts.on_mut(edge.side) = edge.edge.shift());
            facets.shifts[i] = shifts;
        }
        let now = |part: &Part| {
            let i = part.owner;
            let whole = self.whole_deformation(i);
            let facet = Facet::now(self.p.position[i], &whole, &part.facet);
            facet.shifted(&part.facet, &whole, &facets.shifts[i]).held(part.facet.depth)
        };
        facets.now = facets.reference.iter().map(now).collect();
        if facets.has_friction {
            let mut drives = vec![[SlipDrive::none(); 6]; self.p.len()];
            for (own, part) in facets.reference.iter().enumerate() {
                for met in self.pressing(&facets, own) {
                    let law = self.facet_law(&facets, &met);
                    let share = FrictionShare::of(&met.press, law, met.velocity, false);
                    drives[part.owner][part.face].add(&if met.is_first { share } else { share.turned() });
                }
            }
            for (own, part) in facets.reference.iter().enumerate().filter(|(own, part)| part.lead == *own) {
                let spring = &mut facets.springs[part.owner][part.face];
                let (after, heat) = slip_after(&spring.0, &facets.now[own].0, &drives[part.owner][part.face], self.dt);
                let power = if self.dt > 0.0 { heat / self.dt } else { 0.0 };
                *spring = (after, if after.stiffness > 0.0 { power / after.stiffness } else { power });
            }
        }
        self.facets = Some(facets);
    }

    /// Forces of all pairs of facets, their heat, and the stress that their moments are, Pa.
    pub(crate) fn push_facets(&mut self) {
        let Some(facets) = self.facets.take() else { return };
        let count = self.p.len();
        let mut force = vec![[0.0; 3]; count];
        let mut moment: Vec<Tensor<f64>> = vec![[[0.0; 3]; 3]; count];
        let (mut heat, mut rubbed) = (vec![0.0; count], vec![0.0; count]);
        let (mut stiffness, mut lateral, mut damping) = (vec![0.0; count], vec![0.0f64; count], vec![0.0; count]);
        self.accounts.held.fill(0.0);
        let places = self.model.contact_pairs();
        let place = |a: usize, b: usize| places.iter().position(|&pair| pair == (a.min(b), a.max(b)));
        let edges: Vec<Vec<EdgeTo>> = (0..count).map(|i| self.edges(&facets, i)).collect();
        for own in 0..facets.reference.len() {
            let i = facets.reference[own].owner;
            let whole = self.whole_deformation(i);
            let a = self.p.body[i] as usize;
            for mut met in self.pressing(&facets, own) {
                let (law, j) = (*self.facet_law(&facets, &met), facets.reference[met.other].owner);
                let (b, image) = (self.p.body[j] as usize, self.images[met.image]);
                let (along, damped) = met.press.damping(&law, met.velocity);
                // Springs of both, as the first sees them.
                let (here, there) = (facets.slip(own), image.vector(facets.slip(met.other)));
                let (first, second) = if met.is_first { (here, there) } else { (there, here) };
                let pull = friction_force(&met.press, &law, first, second, false);
                let share = FrictionShare::of(&met.press, &law, met.velocity, false).stiffness;
                let friction = share * (facets.rubbed(own) + facets.rubbed(met.other));
                let sign = if met.is_first { 1.0 } else { -1.0 };
                let (facet, stretch) = &facets.now[own];
                let torn = moment_of_torn(facet, *stretch, met.press.force.map(|f| sign * f));
                met.press.add_at_centre(plus(along, 1.0, pull));
                let of_own = if met.is_first { met.press.moment_a } else { met.press.moment_b };
                let of_own = [0, 1, 2].map(|k| plus(of_own[k], 1.0, torn[k]));
                let f = met.press.force.map(|f| sign * f);
                let l = &facets.gradient[i];
                let mut power = dot(f, self.evaluated[i]) + (0..3).map(|k| dot(of_own[k], l[k])).sum::<f64>();
                let of_edges = if met.is_first { met.press.edges_a } else { met.press.edges_b };
                let cell = of_edges.on_cell(facet, &facets.reference[own].facet, &whole, &facets.shifts[i]);
                (0..3).for_each(|k| moment[i][k] = plus(moment[i][k], 1.0, cell.moment[k]));
                power += (0..3).map(|k| dot(cell.moment[k], l[k])).sum::<f64>();
                lateral[i] += cell.stiffness / self.p.mass[i];
                for edge in &edges[i] {
                    // On the way to the next particle and back from it.
                    let pull = edge.edge.tangent(*cell.sides.on(edge.side));
                    let half = pull.map(|c| 0.5 * c);
                    power += dot(pull, edge.rate);
                    force[i] = plus(force[i], -1.0, half);
                    force[edge.j] = plus(force[edge.j], 1.0, edge.image.vector(half));
                    self.contact_exerted.push((i, edge.j, edge.image, half.map(|c| -c)));
                    self.contact_exerted.push((edge.j, i, edge.image.back(), edge.image.vector(half)));
                    let turning = moment_of_edge(pull, &whole, edge.way);
                    (0..3).for_each(|k| moment[i][k] = plus(moment[i][k], 1.0, turning[k]));
                }
                force[i] = plus(force[i], 1.0, f);
                (0..3).for_each(|k| moment[i][k] = plus(moment[i][k], 1.0, of_own[k]));
                let of_friction =
                    friction * friction_share(self.material(i).effusivity(), self.material(j).effusivity());
                heat[i] += 0.5 * damped + of_friction;
                rubbed[i] += of_friction;
                let account = &mut self.accounts.contacts[place(a, b).expect("a pair of bodies")];
                if a < b {
                    account.force = plus(account.force, -1.0, f);
                }
                account.stored_energy += -power;
                account.friction_work += of_friction;
                account.damping_work += 0.5 * damped;
                let Part { owner, face, .. } = facets.reference[own];
                let spring = &facets.springs[owner][face].0;
                let of_spring = if share > 0.0 { share / spring.stiffness * spring.energy() } else { 0.0 };
                self.accounts.held[place(a, b).expect("a pair of bodies")] += 0.5 * met.press.energy + of_spring;
                self.contact_exerted.push((i, j, image, f));
                let mobility = MOBILITY * met.press.area / self.p.mass[i];
                stiffness[i] += mobility * met.press.stiffness;
                damping[i] += mobility * law.damping;
            }
        }
        for i in 0..count {
            // What springs held whose facets have lost their last partner.
            let free = facets.springs[i].iter().filter(|(slip, _)| slip.stiffness == 0.0);
            let released: f64 = free.map(|(_, power)| power).sum();
            if released != 0.0 {
                heat[i] += released;
                rubbed[i] += released;
                let b = self.nearest_with_facets(&facets, i).expect("it has let go of one");
                let pair = place(self.p.body[i] as usize, self.p.body[b] as usize).expect("a pair of bodies");
                self.accounts.contacts[pair].friction_work += released;
            }
            let l = &facets.gradient[i];
            heat[i] += (0..3).map(|k| dot(moment[i][k], l[k])).sum::<f64>();
            let stress = stress_of_moment(&moment[i], &self.deformation[i]);
            for (row, moment) in self.face_stress[i].iter_mut().zip(stress) {
                *row = plus(*row, -1.0 / self.initial_volume[i], moment);
            }
            self.friction_heat[i] += rubbed[i] / self.p.mass[i];
            self.contact_push.push((force[i], heat[i], 0.0));
            let limit = MARGIN * oscillator_limit(2.0 * lateral[i].max(stiffness[i]), 2.0 * damping[i]);
            self.accounts.contact_limit = self.accounts.contact_limit.min(limit);
        }
        self.accounts.start_holding();
        self.facets = Some(facets);
    }
}
