//! What is not a kernel sum of stress: contact between bodies, walls, gravity, heat, and the accounts of all of it.

use super::facets_on_walls::limit_on_walls;
use super::pairs::{apply, minus, plus};
use super::{Oracle, elastic_energy};
use sphorge_engine::geometry::HeatFaces;
use sphorge_engine::model::{
    BodyContact, Formulation, HeatBoundaryKind, Integrator, Model, MotionAxis, TemperatureSource, TimeTable, Wall,
    WallContact, WallSurface,
};
use sphorge_engine::{BodyLedger, ContactLedger, Ledger, LimitReason, TimeStepLimit, WallLedger};
use sphorge_physics::conduction::{
    HeatPair, Inflow, Lattice, Surroundings, add_temperature_gradient, added_flow, best_flow, cell_size,
    conducting_share, face_area, friction_share, lattice, outline_area, pair_conductivity, replaced,
    surface_conductance, touch, turned, turned_back,
};
use sphorge_physics::contact::{
    ContactBody, ContactKernel, ContactLaw, ContactPair, ContactStiffness, Overlap, contact_force, stopping,
};
use sphorge_physics::kernel::pair_smoothing_length;
use sphorge_physics::pair::mean;
use sphorge_physics::tensor::{dot, multiply};
use sphorge_physics::time_step::{
    acceleration_limit, conduction_limit, longitudinal_speed, penalty_limit, sound_limit,
};
use sphorge_physics::total_lagrangian::{extreme_point, limiting_length, smallest_stretch};
use sphorge_physics::wall::{Gap, PenaltyParameters, monaghan_kos, penalty_contact, penalty_energy};
use sphorge_physics::{Dimension, SymmetricTensor, Tensor, Vector};

/// What the last evaluation of forces left for the accounts, and constants by body.
#[derive(Default)]
pub(crate) struct Accounts {
    /// `1/S`, `K` and so on, by ordered pair of bodies.
    laws: Vec<Vec<ContactLaw<f64>>>,
    lattices: Vec<Lattice>,
    /// Powers of the contacts, by pair of bodies, and of the heat boundaries, W.
    pub(crate) contacts: Vec<ContactLedger>,
    /// What facets and their springs hold, by pair of bodies, now and at the start, J.
    pub(crate) held: Vec<f64>,
    held_first: Option<Vec<f64>>,
    boundary_power: Vec<f64>,
    /// Powers of the walls, W.
    wall_power: Vec<WallLedger>,
    pub(crate) contact_limit: f64,
    wall_limit: f64,
    heat_limit: f64,
    /// Time and steps since the flow of heat was summed.
    heat_age: f64,
    heat_steps: u32,
}

/// What a wall does to a particle: acceleration, m/s^2, power and heat of friction and of damping, W/kg, the stress that its moment is, Pa, and
/// sums of its facets for the limit of the step: pressed area times stiffness, N/m, and times damping, N s/m.
pub(crate) struct AtFace {
    pub(crate) push: Vector<f64>,
    pub(crate) power: f64,
    pub(crate) rubbed: f64,
    pub(crate) damped: f64,
    pub(crate) stress: Tensor<f64>,
    pub(crate) stability: [f64; 2],
}

impl Default for AtFace {
    fn default() -> Self {
        Self { push: [0.0; 3], power: 0.0, rubbed: 0.0, damped: 0.0, stress: [[0.0; 3]; 3], stability: [0.0; 2] }
    }
}

impl Accounts {
    pub(crate) fn new(model: &Model, dimension: Dimension) -> Self {
        let kernel = model.numerics.kernel;
        let bodies: Vec<ContactBody> = model
            .bodies
            .iter()
            .map(|b| {
                let material = &model.materials[b.material];
                let c = material.equation_of_state.reference_sound_speed();
                let (spacing, smoothing_length, density) = (b.spacing, b.smoothing_length, material.density);
                ContactBody { spacing, smoothing_length, density, bulk_modulus: density * c * c }
            })
            .collect();
        let law = |a: usize, b: usize| match model.contact {
            BodyContact::Sph => ContactLaw::default(),
            BodyContact::Penalty(strength) | BodyContact::Facets { apart: strength, .. } if a == b => {
                ContactLaw::with_itself(kernel, dimension, &bodies[a], strength)
            }
            BodyContact::Penalty(strength) | BodyContact::Facets { apart: strength, .. } => {
                ContactLaw::new(kernel, dimension, &bodies[a], &bodies[b], strength)
            }
        };
        let all = || 0..bodies.len();
        Self {
            laws: all().map(|a| all().map(|b| law(a, b)).collect()).collect(),
            lattices: bodies.iter().map(|b| lattice(kernel, dimension, b.spacing, b.smoothing_length)).collect(),
            contacts: vec![ContactLedger::default(); model.contact_pairs().len()],
            held: vec![0.0; model.contact_pairs().len()],
            held_first: None,
            boundary_power: vec![0.0; model.thermal.boundaries.len()],
            wall_power: vec![WallLedger::default(); model.walls.len()],
            contact_limit: f64::INFINITY,
            wall_limit: f64::INFINITY,
            heat_limit: f64::INFINITY,
            heat_age: f64::INFINITY,
            heat_steps: 0,
        }
    }
}

impl Accounts {
    /// Keeps what the first evaluation found.
    pub(crate) fn start_holding(&mut self) {
        self.held_first.get_or_insert_with(|| self.held.clone());
    }
}

/// Integral of a table from time zero to `t`: trapezoids between its points.
pub(crate) fn integral(table: &TimeTable, t: f64) -> f64 {
    let inside = table.points.iter().map(|p| p.0).filter(|&corner| corner > 0.0 && corner < t);
    let corners: Vec<f64> = [0.0].into_iter().chain(inside).chain([t]).collect();
    corners.windows(2).map(|w| 0.5 * (table.at(w[0]) + table.at(w[1])) * (w[1] - w[0])).sum()
}

impl Oracle {
    /// Volume at rest, m^d, that the contact knows.
    fn rest_volume(&self, i: usize) -> f64 {
        self.p.mass[i] / self.material(i).density
    }

    fn contact_law(&self, i: usize, j: usize) -> &ContactLaw<f64> {
        &self.accounts.laws[self.p.body[i] as usize][self.p.body[j] as usize]
    }

    /// The contact has the smoothing lengths of the start.
    fn contact_kernel(&self, i: usize, j: usize, r: f64) -> ContactKernel<f64> {
        let [h_i, h_j] = [i, j].map(|k| self.model.bodies[self.p.body[k] as usize].smoothing_length);
        ContactKernel::new(self.model.numerics.kernel, self.dimension, r, pair_smoothing_length(h_i, h_j))
    }

    /// `s_i = sum_j V_j W_ij / S_ab - 1`.
    pub(crate) fn overlap_bodies(&mut self) {
        if self.facets.is_some() {
            return self.follow_facets();
        }
        self.overlap = self.each(|i| {
            let mut sum = Overlap::default();
            for (count, n) in self.contacts(i).enumerate() {
                if count == 0 {
                    sum = Overlap::before_the_first();
                }
                let kernel = self.contact_kernel(i, n.j, n.r);
                sum.add(self.contact_law(i, n.j), &kernel, n.x, self.rest_volume(i), self.rest_volume(n.j));
            }
            sum
        });
    }

    /// Forces between bodies and their heat.
    pub(crate) fn push_bodies(&mut self) {
        self.contact_exerted.clear();
        self.contact_push.clear();
        self.accounts.contacts.fill(ContactLedger::default());
        self.accounts.contact_limit = f64::INFINITY;
        if self.facets.is_some() {
            return self.push_facets();
        }
        let places = self.model.contact_pairs();
        for i in 0..self.p.len() {
            let (mut force, mut heat, mut rubbed, mut approach) = ([0.0; 3], 0.0, 0.0, 0.0_f64);
            let mut stiffness = ContactStiffness::default();
            let pairs: Vec<_> = self.contacts(i).collect();
            for n in &pairs {
                let (j, own, other) = (n.j, self.overlap[i], self.overlap[n.j]);
                let (masses, volumes) = ((self.p.mass[i], self.p.mass[j]), (self.rest_volume(i), self.rest_volume(j)));
                let kernel = self.contact_kernel(i, j, n.r);
                let weight = kernel.weight(volumes.0, volumes.1);
                let law = *self.contact_law(i, j);
                let f = contact_force(
                    &law,
                    &ContactPair {
                        x: n.x,
                        v: minus(self.evaluated[i], n.image.vector(self.evaluated[j])),
                        weight,
                        overlaps: (own.overlap, other.overlap),
                        direction: minus(own.away, n.image.vector(other.away)),
                        stopping: stopping(masses.0, masses.1, weight, (own.weight, other.weight), self.dt),
                    },
                );
                stiffness.add(&law, &kernel, (own.overlap, other.overlap), volumes.0, volumes.1);
                force = plus(force, 1.0, f.force);
                self.contact_exerted.push((i, j, n.image, f.force));
                let share = friction_share(self.material(i).effusivity(), self.material(j).effusivity());
                (heat, rubbed) = (heat + 0.5 * f.damped + share * f.rubbed, rubbed + share * f.rubbed);
                approach = approach.max(f.approach);
                let (a, b) = (self.p.body[i] as usize, self.p.body[j] as usize);
                let place = places.iter().position(|&pair| pair == (a.min(b), a.max(b)));
                let account = &mut self.accounts.contacts[place.expect("a pair of bodies")];
                if a < b {
                    account.force = plus(account.force, -1.0, f.force);
                }
                // The other half is that of the other particle.
                account.stored_energy += 0.5 * f.stored;
                account.friction_work += 0.5 * f.rubbed;
                account.damping_work += 0.5 * f.damped;
            }
            let mass = self.p.mass[i];
            self.friction_heat[i] += rubbed / mass;
            self.contact_push.push((force, heat, approach));
            if !pairs.is_empty() {
                let limit = stiffness.limit(&self.overlap[i], self.rest_volume(i), mass);
                self.accounts.contact_limit = self.accounts.contact_limit.min(limit);
            }
        }
    }

    /// Adds them to the rates of the pair sums.
    pub(crate) fn add_contacts(&mut self) {
        self.exerted.extend(self.contact_exerted.iter().copied());
        for (i, &(force, heat, approach)) in self.contact_push.iter().enumerate() {
            let mass = self.p.mass[i];
            self.p.acceleration[i] = plus(self.p.acceleration[i], 1.0 / mass, force);
            self.p.energy_rate[i] += heat / mass;
            self.mu[i] = self.mu[i].max(approach);
        }
    }

    /// Adds the powers of the last evaluation over a time, s.
    pub(crate) fn book_contacts(&mut self, dt: f64) {
        self.ledger.contacts.resize(self.accounts.contacts.len(), ContactLedger::default());
        for (works, now) in self.ledger.contacts.iter_mut().zip(&self.accounts.contacts) {
            works.stored_energy += dt * now.stored_energy;
            works.friction_work += dt * now.friction_work;
            works.damping_work += dt * now.damping_work;
        }
    }

    /// Where temperature is not that of the energy, what friction heats is added to it.
    pub(crate) fn warm_by_friction(&mut self) {
        if self.model.numerics.temperature == TemperatureSource::PlasticWork {
            for i in 0..self.p.len() {
                self.p.temperature[i] += self.dt * self.friction_heat[i] / self.material(i).specific_heat;
            }
        }
    }

    /// What a wall, as it stands where forces are evaluated, does to a particle.
    fn wall_push(&self, wall: &Wall, time: f64, i: usize) -> (AtFace, f64) {
        if self.is_pushed_at_facets(wall, i) {
            return self.wall_push_at_facets(wall, time, i);
        }
        let shift = [0, 1, 2].map(|a| integral(&wall.velocity[a], time));
        let x = minus(self.p.position[i], shift);
        let gap = match wall.surface {
            WallSurface::Plane { point, normal } => Some(Gap::to_plane(x, point, normal)),
            WallSurface::Segment { from, to } => Gap::to_segment(x, from, to),
        };
        let Some(gap) = gap else { return (AtFace::default(), 0.0) };
        let body = &self.model.bodies[self.p.body[i] as usize];
        let c = self.material(i).equation_of_state.reference_sound_speed();
        let wall_velocity = [0, 1, 2].map(|a| wall.velocity[a].at(time));
        let v = self.evaluated[i];
        match wall.contact {
            WallContact::MonaghanKos { range } => {
                let push = monaghan_kos(&gap, minus(v, wall_velocity), range, c, body.smoothing_length);
                (AtFace { push, power: dot(push, v), ..AtFace::default() }, 0.0)
            }
            WallContact::Penalty { stiffness, damping, friction, at_facets: _ } => {
                let parameters = PenaltyParameters::from_sound_speed(c, body.spacing, stiffness, damping, friction);
                let (mut radius, mut xi, mut v) = (0.5 * body.spacing, [0.0; 3], v);
                if self.total_lagrangian().is_some() {
                    let f = multiply(&self.deformation[i], &self.earlier_deformation[i]);
                    let initial = extreme_point(body.spacing, &f, gap.normal);
                    xi = apply(&self.earlier_deformation[i], initial);
                    radius = dot(gap.normal, apply(&f, initial));
                    v = minus(v, apply(&self.p.velocity_gradient[i], apply(&f, initial)));
                }
                let push = penalty_contact(parameters, &gap, radius, minus(v, wall_velocity), self.dt);
                let power = dot(push.acceleration, v) + push.heat;
                let damped = push.heat - push.rubbed;
                let scale = self.p.mass[i] / self.initial_volume[i];
                let stress = push.acceleration.map(|f| xi.map(|c| scale * f * c));
                let (held, push, rubbed) = (penalty_energy(parameters, &gap, radius), push.acceleration, push.rubbed);
                (AtFace { push, power, rubbed, damped, stress, stability: [0.0; 2] }, self.p.mass[i] * held)
            }
        }
    }

    /// What walls and gravity do, and the stress that the moments of forces at faces are, Pa.
    pub(crate) fn push_externally(&mut self) {
        let time = self.time + self.dt_to_evaluation();
        let walls = self.model.walls.clone();
        self.external = vec![self.model.gravity; self.p.len()];
        self.external_power = vec![0.0; self.p.len()];
        self.face_stress = vec![[[0.0; 3]; 3]; self.p.len()];
        self.friction_heat = vec![0.0; self.p.len()];
        self.accounts.wall_power = vec![WallLedger::default(); walls.len()];
        let mut stability = vec![[0.0; 2]; self.p.len()];
        self.slip_on_walls(time);
        for (k, wall) in walls.iter().enumerate() {
            for i in 0..self.p.len() {
                let (AtFace { push, power, rubbed, damped, stress, stability: of_wall }, _) =
                    self.wall_push(wall, time, i);
                (0..2).for_each(|k| stability[i][k] += of_wall[k]);
                self.external[i] = plus(self.external[i], 1.0, push);
                // Walls are adiabatic: what friction takes heats the particle.
                self.friction_heat[i] += rubbed;
                self.external_power[i] += power - dot(push, self.evaluated[i]);
                let (of_wall, mass) = (&mut self.accounts.wall_power[k], self.p.mass[i]);
                of_wall.work += mass * power;
                of_wall.friction_work += mass * rubbed;
                of_wall.damping_work += mass * damped;
                for (row, more) in self.face_stress[i].iter_mut().zip(stress) {
                    *row = plus(*row, 1.0, more);
                }
            }
        }
        let limit = |(sums, mass): (&[f64; 2], &f64)| limit_on_walls(*sums, *mass);
        self.accounts.wall_limit = stability.iter().zip(&self.p.mass).map(limit).fold(f64::INFINITY, f64::min);
    }

    /// Adds them to the rates of the pair sums.
    pub(crate) fn add_external(&mut self) {
        for i in 0..self.p.len() {
            self.p.acceleration[i] = plus(self.p.acceleration[i], 1.0, self.external[i]);
            self.p.energy_rate[i] += self.external_power[i];
        }
    }

    /// Adds the powers of walls at the last evaluation over a time, s.
    pub(crate) fn book_walls(&mut self, dt: f64) {
        self.ledger.walls.resize(self.model.walls.len(), WallLedger::default());
        for (done, power) in self.ledger.walls.iter_mut().zip(&self.accounts.wall_power) {
            done.work += power.work * dt;
            done.friction_work += power.friction_work * dt;
            done.damping_work += power.damping_work * dt;
        }
        let beyond: f64 = self.external_power.iter().zip(&self.p.mass).map(|(power, mass)| power * mass).sum();
        self.ledger.external_work += beyond * dt;
    }

    pub(crate) fn mechanical_limit(&self) -> TimeStepLimit {
        let (model, p, courant) = (&self.model, &self.p, self.model.time.courant);
        let limit = |dt, reason| TimeStepLimit { dt, reason };
        let of_damping = if model.time.fixed_step.is_some() { courant } else { 1.0 };
        let mut least = limit(f64::INFINITY, LimitReason::SoundSpeed);
        for i in 0..p.len() {
            let shear = self.shear_modulus(i, p.density[i], p.pressure[i]);
            let speed = longitudinal_speed(p.sound_speed[i], shear, p.density[i]);
            let (mut h, a) = (p.smoothing_length[i], dot(p.acceleration[i], p.acceleration[i]).sqrt());
            if self.total_lagrangian().is_some() {
                h = limiting_length(h, smallest_stretch(&self.deformation[i]));
            }
            least = least.min(limit(sound_limit(h, speed, self.mu[i], courant), LimitReason::SoundSpeed));
            least = least.min(limit(of_damping / self.damping_rate[i], LimitReason::SoundSpeed));
            least = least.min(limit(acceleration_limit(h, a, courant), LimitReason::Acceleration));
        }
        let rate = |b: &sphorge_engine::model::Body| {
            model.materials[b.material].equation_of_state.reference_sound_speed() / b.spacing
        };
        let fastest = model.bodies.iter().map(rate).fold(0.0, f64::max);
        // Half of the stability limit at facets leaves room for the material behind them.
        let of_springs = if model.time.fixed_step.is_some() { courant } else { courant.min(1.0 / 3.0) };
        for wall in &model.walls {
            if let WallContact::Penalty { stiffness, .. } = wall.contact {
                least = least.min(limit(penalty_limit(stiffness, fastest, of_springs), LimitReason::Contact));
            }
        }
        let of_contacts = self.accounts.contact_limit.min(self.accounts.wall_limit);
        least.min(limit(of_springs * of_contacts, LimitReason::Contact))
    }

    pub(crate) fn conduction_limit(&self) -> f64 {
        self.model.time.courant * self.accounts.heat_limit
    }

    /// Keeps held particles at their temperature.
    pub(crate) fn hold_temperatures(&mut self) {
        self.ledger.heat.supplied.resize(self.model.thermal.boundaries.len(), 0.0);
        for i in 0..self.p.len() {
            let cp = self.material(i).specific_heat;
            for (k, boundary) in self.model.thermal.boundaries.iter().enumerate() {
                if let (HeatBoundaryKind::HeldTemperature(held), true) =
                    (boundary.kind, boundary.claims(self.p.body[i], self.p.regions[i]))
                {
                    let supply = cp * (held - self.p.temperature[i]);
                    self.p.energy[i] += supply;
                    self.p.temperature[i] = held;
                    self.ledger.heat.supplied[k] += self.p.mass[i] * supply;
                }
            }
        }
    }

    /// Heat that flows to every particle (Cleary & Monaghan), from neighbours and through surfaces. Beside mechanics a flow goes on for
    /// a tenth of the step it bears itself, fifty steps at most.
    pub(crate) fn sum_heat(&mut self) {
        let accounts = &mut self.accounts;
        let bears = 0.1 * self.model.time.courant * accounts.heat_limit;
        let goes_on = self.model.thermal.mechanics && accounts.heat_steps < 50 && accounts.heat_age < bears;
        if goes_on || !self.model.thermal.conduction {
            return;
        }
        (accounts.heat_age, accounts.heat_steps) = (0.0, 0);
        let (model, d, p) = (self.model.clone(), self.dimension, &self.p);
        let initial = model.formulation != Formulation::UpdatedLagrangian;
        let at = if initial { &self.searched_at } else { &p.position };
        let volume = self.each(|i| if initial { self.initial_volume[i] } else { p.mass[i] / p.density[i] });
        let lattice_of = |i: usize| &self.accounts.lattices[p.body[i] as usize];
        // Across open cracks no heat flows.
        let share_of = |i: usize| conducting_share(p.pressure[i], self.integrity[i]);
        let added = self.each(|i| {
            let mut gradient = [0.0; 3];
            for n in self.pairs(i, at) {
                let difference = p.temperature[n.j] - p.temperature[i];
                let slope = -n.f * share_of(i).min(share_of(n.j));
                add_temperature_gradient(&mut gradient, volume[n.j], slope, difference, n.x);
            }
            added_flow(self.material(i).conductivity, gradient, &self.deformation[i], &self.correction[i], d)
        });
        // The other body whose face each particle touches: that of the nearest particle.
        let cell = |i: usize| cell_size(d, p.mass[i] / p.density[i]);
        let touched = self.each(|i| {
            let others = self.pairs(i, &p.position).chain(self.contacts(i)).filter(|n| p.body[n.j] != p.body[i]);
            let near = others.filter(|n| touch(n.r * n.r, cell(i), cell(n.j)));
            near.min_by(|a, b| a.r.total_cmp(&b.r)).map(|n| p.body[n.j])
        });
        let mut powers = vec![0.0; model.thermal.boundaries.len()];
        let mut limit = f64::INFINITY;
        // The pairs that exchange heat, and whether at initial positions.
        let joined = |i: usize| {
            let touching = self.contacts(i).filter(move |n| p.body[n.j] != p.body[i]).map(|n| (n, false));
            let (a, touched) = (p.body[i], &touched);
            self.pairs(i, at).map(|n| (n, initial)).chain(touching).filter(move |(n, _)| {
                let b = p.body[n.j];
                a == b || touched[i] == Some(b) || touched[n.j] == Some(a)
            })
        };
        let volume_at =
            |i: usize, initial: bool| if initial { self.initial_volume[i] } else { p.mass[i] / p.density[i] };
        let correction_of = |i: usize, j: usize| mean(1.0 / lattice_of(i).moment, 1.0 / lattice_of(j).moment);
        // What replaces missing pairs, in the configuration of the sums.
        let replacements = self.each(|i| {
            let mut surroundings = Surroundings::none();
            for (n, at_first) in joined(i) {
                let x = if initial && !at_first { turned_back(n.x, &self.deformation[i]) } else { n.x };
                surroundings.add(-n.f * volume_at(n.j, at_first) * correction_of(i, n.j), n.r * n.r, x);
            }
            surroundings.replacement(lattice_of(i).moment / lattice_of(i).row_moment - 1.0)
        });
        let rates = self.each(|i| {
            let mut sum = Inflow::default();
            for (n, initial) in joined(i) {
                let j = n.j;
                let volume = |i: usize| volume_at(i, initial);
                let seen = |i: usize| match initial || model.formulation == Formulation::UpdatedLagrangian {
                    true => replacements[i],
                    false => turned(replacements[i], &self.deformation[i]),
                };
                let of_other = SymmetricTensor::symmetric_part(&n.image.tensor(&seen(j).to_tensor()));
                let share = share_of(i).min(share_of(j));
                let pair = HeatPair {
                    volumes: (volume(i), volume(j)),
                    conductivity: share
                        * pair_conductivity(self.material(i).conductivity, self.material(j).conductivity),
                    correction: correction_of(i, j),
                    replaced: replaced(seen(i), of_other, n.x, n.r * n.r),
                    slope: -n.f,
                    r2: n.r * n.r,
                    difference: p.temperature[j] - p.temperature[i],
                };
                if initial {
                    let flow = plus(added[i], 1.0, n.image.vector(added[j]));
                    sum.add_reference(&pair, n.x, flow.map(|c| share * c), best_flow(&self.deformation[i]), d);
                } else {
                    sum.add(&pair, d);
                }
            }
            (sum, self.material(i).conductivity)
        });
        self.heat_rate.clear();
        let faces = HeatFaces::new(&model);
        for (i, (mut sum, conductivity)) in rates.into_iter().enumerate() {
            let present = p.mass[i] / p.density[i];
            let flat = lattice_of(i).surface_moment / lattice_of(i).moment;
            for (k, (boundary, total)) in model.thermal.boundaries.iter().zip(&mut powers).enumerate() {
                if !boundary.claims(p.body[i], p.regions[i]) {
                    continue;
                }
                let area = match faces.at_unit_density(k, p.id[i]) {
                    Some(face) => face_area(d, face, p.density[i]),
                    None => outline_area(d, (present, p.density[i]), sum.filled, flat, faces.outline(p.id[i])),
                };
                let through = |film| area * surface_conductance(film, conductivity, cell_size(d, present));
                let (power, conductance) = match boundary.kind {
                    HeatBoundaryKind::HeldTemperature(_) => (0.0, 0.0),
                    HeatBoundaryKind::Flux(flux) => (area * flux, 0.0),
                    HeatBoundaryKind::SurfaceTemperature(outside) => {
                        (through(None) * (outside - p.temperature[i]), through(None))
                    }
                    HeatBoundaryKind::Convection { coefficient, ambient } => {
                        let film = Some(coefficient);
                        (through(film) * (ambient - p.temperature[i]), through(film))
                    }
                };
                sum.power += power;
                sum.conductance += conductance;
                *total += power;
            }
            self.heat_rate.push(sum.power / p.mass[i]);
            limit = limit.min(conduction_limit(p.mass[i] * self.material(i).specific_heat, sum.conductance));
        }
        (self.accounts.boundary_power, self.accounts.heat_limit) = (powers, limit);
    }

    /// Lets the heat flow for the step.
    pub(crate) fn flow_heat(&mut self) {
        if !self.model.thermal.conduction {
            return;
        }
        for i in 0..self.p.len() {
            let inflow = self.dt * self.heat_rate[i];
            self.p.energy[i] += inflow;
            self.p.temperature[i] += inflow / self.material(i).specific_heat;
            self.ledger.heat.exchanged += self.p.mass[i] * inflow.abs();
        }
        self.accounts.heat_age += self.dt;
        self.accounts.heat_steps += 1;
        self.hold_temperatures();
        for (supplied, power) in self.ledger.heat.supplied.iter_mut().zip(&self.accounts.boundary_power) {
            *supplied += self.dt * power;
        }
    }

    /// Acceleration a prescribed motion imposed in the last step, m/s^2.
    fn driven(&self, motion: usize) -> [Option<f64>; 3] {
        let (t, dt) = (self.time, self.dt);
        [0, 1, 2].map(|a| match &self.model.motions[motion].axes[a] {
            MotionAxis::Free => None,
            MotionAxis::Velocity(_) if dt == 0.0 => Some(0.0),
            MotionAxis::Velocity(table) => Some((table.at(t) - table.at(t - dt)) / dt),
        })
    }

    /// Sums over the particles a condition holds for.
    fn sums(&self, of: impl Fn(usize) -> bool) -> BodyLedger {
        let (mut sum, p) = (BodyLedger::default(), &self.p);
        for i in (0..p.len()).filter(|&i| of(i)) {
            let (m, x, v) = (p.mass[i], p.position[i], p.velocity[i]);
            let driven = self.motion_of(i).map_or([None; 3], |k| self.driven(k));
            sum.mass += m;
            sum.energies.kinetic += 0.5 * m * dot(v, v);
            sum.energies.internal += m * p.energy[i];
            let shear = self.shear_modulus(i, p.density[i], p.pressure[i]);
            sum.energies.elastic += m * elastic_energy(self.material(i), p, i, shear);
            sum.energies.plastic_work += m * p.plastic_work[i];
            sum.momentum_scale += m * dot(v, v).sqrt();
            for a in 0..3 {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                sum.momentum[a] += m * v[a];
                sum.angular_momentum[a] += m * (x[b] * v[c] - x[c] * v[b]);
                sum.centre[a] += m * x[a];
                sum.force[a] += m * driven[a].unwrap_or(p.acceleration[i][a]);
            }
        }
        sum.centre = sum.centre.map(|c| c / sum.mass);
        sum
    }

    /// The ledger as it is now.
    pub(crate) fn conservation(&self) -> Ledger {
        let (model, p) = (&self.model, &self.p);
        // Walls stand where forces were evaluated: half a step ago with the predictor–corrector.
        let back = if model.numerics.integrator == Integrator::Leapfrog { 0.0 } else { 0.5 * self.dt };
        let of_wall = |wall: &Wall| {
            let push = |i: usize| self.wall_push(wall, self.time - back, i).0.push.map(|a| p.mass[i] * a);
            (0..p.len()).map(push).fold([0.0; 3], |sum, push| plus(sum, 1.0, push))
        };
        let of_motion = |k: usize| {
            let driven = self.driven(k);
            let lack = |i: usize| [0, 1, 2].map(|a| driven[a].map_or(0.0, |d| p.mass[i] * (d - p.acceleration[i][a])));
            (0..p.len()).filter(|&i| self.motion_of(i) == Some(k)).map(lack).fold([0.0; 3], |s, f| plus(s, 1.0, f))
        };
        let mut ledger = self.ledger.clone();
        ledger.hourglass_stored_energy = self.energy_of_springs();
        ledger.fracture_energy = p.mass.iter().zip(&self.damage).map(|(mass, of)| mass * of[2]).sum();
        ledger.bodies = (0..model.bodies.len()).map(|b| self.sums(|i| p.body[i] as usize == b)).collect();
        ledger.total = self.sums(|_| true);
        ledger.contacts.resize(self.accounts.contacts.len(), ContactLedger::default());
        for (works, now) in ledger.contacts.iter_mut().zip(&self.accounts.contacts) {
            works.force = now.force;
        }
        if self.facets.is_some() {
            let first = self.accounts.held_first.iter().flatten().chain(std::iter::repeat(&0.0));
            for ((works, held), first) in ledger.contacts.iter_mut().zip(&self.accounts.held).zip(first) {
                let taken_up = works.stored_energy - works.friction_work - works.damping_work;
                (works.stored_energy, works.integration_energy) = (*held, taken_up - (held - first));
            }
        }
        if !model.thermal.conduction {
            ledger.heat.supplied.clear();
        }
        ledger.wall_forces = model.walls.iter().map(of_wall).collect();
        let held = |wall: &Wall| (0..p.len()).map(|i| self.wall_push(wall, self.time - back, i).1).sum();
        ledger.wall_stored_energies = model.walls.iter().map(held).collect();
        ledger.motion_forces = (0..model.motions.len()).map(of_motion).collect();
        ledger
    }
}
