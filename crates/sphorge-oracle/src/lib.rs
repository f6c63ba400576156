//! A second engine: one thread, plain columns, double precision, all pairs tested.
//!
//! It shares the laws of `sphorge-physics` with the engine for processors and nothing else: no lists, no lanes, no ghosts in memory,
//! no shortcuts. What it says of a deck is what the equations say of it.

use faces::Faces;
use facets::Facets;
use facets_on_walls::WallFacets;
use pairs::{Image, plus};
use sphorge_engine::model::{Integrator, Material, Model, MotionAxis, Precision, Search, SmoothingLength};
use sphorge_engine::persist::{Archive, ArchiveError};
use sphorge_engine::reduction::{self, Reduction};
use sphorge_engine::{Audit, Column, Engine, EngineKind, Ledger, RunFailure, SearchReport, TimeStepLimit, Unsupported};
use sphorge_engine::{LimitReason, Particles};
use sphorge_physics::contact::Overlap;
use sphorge_physics::damage::KEPT;
use sphorge_physics::integrity::INTEGRITY;
use sphorge_physics::{Dimension, Tensor, Vector};
use std::borrow::Cow;
use std::sync::Arc;
use sums::uncorrected;
use surroundings::Accounts;

mod faces;
mod facets;
mod facets_on_walls;
mod pairs;
mod section;
mod sums;
mod surroundings;

/// The oracle, to be started on a model.
#[derive(Clone, Copy, Debug, Default)]
pub struct OracleKind;

/// The engine. Columns with a name are those of `p`; the others stand beside it.
pub(crate) struct Oracle {
    pub(crate) model: Arc<Model>,
    pub(crate) dimension: Dimension,
    pub(crate) p: Particles,
    pub(crate) images: Vec<Image>,
    /// Neighbours of each particle in the kernel sums and in the contact between bodies: number, and which image.
    pub(crate) rows: Vec<Vec<(usize, usize)>>,
    pub(crate) foreign: Vec<Vec<(usize, usize)>>,
    pub(crate) searched_at: Vec<Vector<f64>>,
    /// Start and size of the step, s, and steps begun.
    pub(crate) time: f64,
    pub(crate) dt: f64,
    count: u64,
    /// Velocities the last forces were evaluated with, and what the particles are smoothed by.
    pub(crate) evaluated: Vec<Vector<f64>>,
    pub(crate) xsph: Vec<Vector<f64>>,
    /// The part of the acceleration that pairs do not make.
    pub(crate) external: Vec<Vector<f64>>,
    /// Power of walls beyond that on the centre, W/kg, and the stress of their forces at faces, Pa.
    pub(crate) external_power: Vec<f64>,
    pub(crate) face_stress: Vec<Tensor<f64>>,
    pub(crate) mu: Vec<f64>,
    base_position: Vec<Vector<f64>>,
    base_velocity: Vec<Vector<f64>>,
    pub(crate) base_density: Vec<f64>,
    /// Weights of the gradient sum.
    pub(crate) weight: Vec<f64>,
    pub(crate) correction: Vec<Tensor<f64>>,
    pub(crate) deformation: Vec<Tensor<f64>>,
    /// Of the configuration the sums are taken in, from the start; by body whether that has been renewed; whether it just was.
    pub(crate) earlier_deformation: Vec<Tensor<f64>>,
    pub(crate) has_come_apart: Vec<bool>,
    pub(crate) is_renewed: bool,
    pub(crate) faces: Faces,
    pub(crate) facets: Option<Facets>,
    pub(crate) wall_facets: Option<WallFacets>,
    /// Force of the contact, N, power that goes to heat, W, and speed of approach, m/s, of every particle.
    pub(crate) contact_push: Vec<(Vector<f64>, f64, f64)>,
    pub(crate) initial_volume: Vec<f64>,
    pub(crate) history: Vec<Vec<f64>>,
    /// What particles bear of tension and shear, and of viscous pressure at the last stress.
    pub(crate) integrity: Vec<f64>,
    pub(crate) share: Vec<f64>,
    /// Damage, time of failure (s) and fracture energy (J/kg).
    pub(crate) damage: Vec<[f64; 3]>,
    /// Scaled stress and artificial stress, and Balsara's switch.
    pub(crate) stress: Vec<Tensor<f64>>,
    pub(crate) repulsion: Vec<Tensor<f64>>,
    pub(crate) switch: Vec<f64>,
    pub(crate) overlap: Vec<Overlap<f64>>,
    /// Forces between particles as last evaluated, N, each on the first by an image of the second, and where particles then were.
    pub(crate) exerted: Vec<(usize, usize, Image, Vector<f64>)>,
    pub(crate) exerted_at: Vec<Vector<f64>>,
    /// Those of the contact.
    pub(crate) contact_exerted: Vec<(usize, usize, Image, Vector<f64>)>,
    pub(crate) friction_heat: Vec<f64>,
    /// Work and power of the artificial stress, J/kg and W/kg.
    pub(crate) artificial_energy: Vec<f64>,
    pub(crate) artificial_power: Vec<f64>,
    /// Bulk viscosity of the last stress, Pa, and powers of the viscosity of pairs and of hourglass springs on all particles, W.
    pub(crate) viscous_pressure: Vec<f64>,
    /// `chi c rho_0` of the viscosity of shocks, Pa s/m, and how fast viscosity damps a particle, 1/s.
    pub(crate) impedance: Vec<f64>,
    pub(crate) damping_rate: Vec<f64>,
    /// Divergence of the velocity, filtered once and twice, 1/s.
    pub(crate) filtered: Vec<[f64; 2]>,
    pub(crate) viscous_power: f64,
    pub(crate) hourglass_power: f64,
    /// Least stretch at which a particle has yielded, zero without springs, and, of its springs, mean square of the misfit and stress of the
    /// moment, Pa.
    pub(crate) yielded_stretch: Vec<f64>,
    pub(crate) spring_misfit: Vec<f64>,
    pub(crate) spring_moment: Vec<Tensor<f64>>,
    pub(crate) heat_rate: Vec<f64>,
    pub(crate) ledger: Ledger,
    pub(crate) accounts: Accounts,
}

impl EngineKind for OracleKind {
    fn name(&self) -> &'static str {
        "oracle"
    }

    fn supports(&self, model: &Model) -> Result<(), Unsupported> {
        let refuse = |what: &str, help: &str| Err(Unsupported { what: what.to_owned(), help: help.to_owned() });
        match model.search {
            _ if model.numerics.precision != Precision::Double => {
                refuse("pair sums in single precision", "set `numerics.precision` to \"double\"")
            }
            Search::Adaptive(adaptive) if adaptive.guard.is_none() => {
                refuse("kernel values of former searches", "give the adaptive search its guard")
            }
            _ if model.audit.is_some() => refuse("audits: its lists are exact", "leave `audit` out"),
            _ => Ok(()),
        }
    }

    fn start(&self, model: Arc<Model>, mut p: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        let dimension = model.dimensions.into();
        let n = p.len();
        let material = |i: usize| &model.materials[p.material[i] as usize];
        let history = (0..n).map(|i| material(i).flow_law.history().iter().map(|v| v.initial).collect()).collect();
        let integrity = vec![1.0; n];
        let warmth = |i: usize| match material(i).heats() {
            true => material(i).cold_energies().of_temperature(p.density[i], p.temperature[i]),
            false => 0.0,
        };
        let energies: Vec<f64> = (0..n).map(|i| p.energy[i] + warmth(i)).collect();
        p.energy = energies;
        let mut oracle = Oracle {
            dimension,
            images: Image::all(&model),
            rows: Vec::new(),
            foreign: Vec::new(),
            searched_at: Vec::new(),
            time: 0.0,
            dt: 0.0,
            count: 0,
            evaluated: p.velocity.clone(),
            xsph: vec![[0.0; 3]; n],
            external: vec![[0.0; 3]; n],
            external_power: vec![0.0; n],
            face_stress: vec![[[0.0; 3]; 3]; n],
            mu: vec![0.0; n],
            base_position: p.position.clone(),
            base_velocity: p.velocity.clone(),
            base_density: p.density.clone(),
            weight: vec![0.0; n],
            correction: uncorrected(n),
            faces: Faces::default(),
            deformation: uncorrected(n),
            earlier_deformation: uncorrected(n),
            has_come_apart: vec![false; model.bodies.len()],
            is_renewed: true,
            facets: Facets::new(&model, &p),
            wall_facets: WallFacets::new(&model, &p),
            contact_push: Vec::new(),
            initial_volume: (0..n).map(|i| p.mass[i] / p.density[i]).collect(),
            history,
            integrity,
            share: vec![1.0; n],
            damage: vec![[0.0; 3]; n],
            stress: uncorrected(n),
            repulsion: uncorrected(n),
            switch: vec![1.0; n],
            overlap: vec![Overlap::default(); n],
            exerted: Vec::new(),
            exerted_at: Vec::new(),
            contact_exerted: Vec::new(),
            friction_heat: vec![0.0; n],
            artificial_energy: vec![0.0; n],
            artificial_power: vec![0.0; n],
            viscous_pressure: vec![0.0; n],
            impedance: vec![0.0; n],
            damping_rate: vec![0.0; n],
            filtered: vec![[0.0; 2]; n],
            viscous_power: 0.0,
            hourglass_power: 0.0,
            yielded_stretch: vec![1.0; n],
            spring_misfit: vec![0.0; n],
            spring_moment: vec![[[0.0; 3]; 3]; n],
            heat_rate: vec![0.0; n],
            ledger: Ledger::default(),
            accounts: Accounts::new(&model, dimension),
            model,
            p,
        };
        oracle.hold_temperatures();
        oracle.ledger.heat.supplied.fill(0.0);
        Ok(Box::new(oracle))
    }
}

impl Oracle {
    /// Bodies that stand still while heat flows. The initial rates are those of bodies that could move.
    fn is_idle(&self) -> bool {
        !self.model.thermal.mechanics && self.dt > 0.0
    }

    /// From the start of the step to where forces are evaluated, s.
    pub(crate) fn dt_to_evaluation(&self) -> f64 {
        match self.model.numerics.integrator {
            Integrator::Leapfrog => self.dt,
            Integrator::PredictorCorrector => 0.5 * self.dt,
        }
    }

    /// Prescribed motion of a particle: of two that claim it the later in the deck.
    pub(crate) fn motion_of(&self, i: usize) -> Option<usize> {
        self.model.motions.iter().rposition(|m| self.p.regions[i] >> m.region & 1 == 1)
    }

    /// Velocity `v` at a time with what is prescribed of it.
    fn held(&self, i: usize, time: f64, mut v: Vector<f64>) -> Vector<f64> {
        let Some(k) = self.motion_of(i) else { return v };
        for (v, axis) in v.iter_mut().zip(&self.model.motions[k].axes) {
            if let MotionAxis::Velocity(table) = axis {
                *v = table.at(time);
            }
        }
        v
    }

    /// Velocity the particle is carried with: smoothed, but along prescribed axes.
    pub(crate) fn drift_velocity(&self, i: usize, v: Vector<f64>) -> Vector<f64> {
        let motion = self.motion_of(i).map(|k| &self.model.motions[k].axes);
        [0, 1, 2].map(|a| match motion.map(|axes| &axes[a]) {
            Some(MotionAxis::Velocity(_)) => v[a],
            _ => v[a] + self.xsph[i][a],
        })
    }

    /// Adds the powers of the viscosity of pairs, of hourglass springs and of the artificial stress at the last evaluation over a time, s.
    fn book_numerical_work(&mut self, dt: f64) {
        self.ledger.viscous_energy += dt * self.viscous_power;
        self.ledger.hourglass_energy += dt * self.hourglass_power;
        for (mass, power) in self.p.mass.iter().zip(&self.artificial_power) {
            self.ledger.artificial_stress_energy += dt * mass * power;
        }
    }

    /// Takes the velocity from `before` through `dt` to a time. Pair forces have worked at the velocity they were evaluated with; what
    /// the mean velocity of the kick differs from that goes to the internal energy.
    fn kick(&mut self, i: usize, before: Vector<f64>, dt: f64, time: f64) {
        let (a, external, evaluated) = (self.p.acceleration[i], self.external[i], self.evaluated[i]);
        let (after, mass) = (self.held(i, time, plus(before, dt, a)), self.p.mass[i]);
        self.p.velocity[i] = after;
        self.p.energy[i] += dt * self.p.energy_rate[i];
        self.artificial_energy[i] += dt * self.artificial_power[i];
        for k in 0..3 {
            let (pair, mean) = (a[k] - external[k], 0.5 * (before[k] + after[k]));
            let impulse = mass * (after[k] - before[k] - pair * dt);
            self.p.energy[i] -= pair * (mean - evaluated[k]) * dt;
            self.ledger.integration_energy -= mass * pair * (mean - evaluated[k]) * dt;
            self.ledger.external_work += mean * impulse;
            self.ledger.external_impulse[k] += impulse;
        }
    }
}

impl Engine for Oracle {
    fn begin(&mut self, dt: f64) -> Result<(), RunFailure> {
        (self.dt, self.count) = (dt, self.count + u64::from(dt > 0.0));
        if self.is_idle() {
            return Ok(());
        }
        let (half, time) = (0.5 * dt, self.time);
        match self.model.numerics.integrator {
            Integrator::Leapfrog => {
                self.book_contacts(half);
                self.book_walls(half);
                self.book_numerical_work(half);
                for i in 0..self.p.len() {
                    self.kick(i, self.p.velocity[i], half, time + half);
                    let v = self.p.velocity[i];
                    self.p.position[i] = plus(self.p.position[i], dt, self.drift_velocity(i, v));
                    self.evaluated[i] = self.held(i, time + dt, plus(v, half, self.p.acceleration[i]));
                }
            }
            Integrator::PredictorCorrector => {
                self.base_position.clone_from(&self.p.position);
                self.base_velocity.clone_from(&self.p.velocity);
                self.base_density.clone_from(&self.p.density);
                for i in 0..self.p.len() {
                    let v = self.p.velocity[i];
                    let drift = self.drift_velocity(i, self.held(i, time + half, v));
                    self.p.position[i] = plus(self.p.position[i], half, drift);
                    self.p.velocity[i] = self.held(i, time + half, plus(v, half, self.p.acceleration[i]));
                    self.evaluated[i] = self.p.velocity[i];
                }
            }
        }
        Ok(())
    }

    fn refresh_neighbors(&mut self) -> Result<SearchReport, RunFailure> {
        if let SmoothingLength::FollowDensity { factor } = self.model.numerics.smoothing_length {
            let model = self.model.clone();
            let power = 1.0 / self.dimension.count() as f64;
            self.p.smoothing_length = self.each(|i| {
                let ratio = (self.material(i).density / self.p.density[i]).powf(power).clamp(1.0 / factor, factor);
                model.bodies[self.p.body[i] as usize].smoothing_length * ratio
            });
        }
        if self.total_lagrangian().is_some() && !self.rows.is_empty() && self.renew() {
            self.rows = self.near(&self.searched_at).0;
            self.is_renewed = true;
        }
        let due = self.rows.is_empty() || !(self.is_idle() || self.model.search == Search::Initial);
        if due {
            self.search();
        }
        Ok(SearchReport { searched_fraction: f64::from(u8::from(due)) })
    }

    fn audit(&mut self) -> Result<Option<Audit>, RunFailure> {
        Ok(None)
    }

    fn kinematics(&mut self) -> Result<(), RunFailure> {
        if !self.is_idle() {
            self.sum_gradients();
        }
        Ok(())
    }

    fn restore_density(&mut self) -> Result<(), RunFailure> {
        let due = |n: u64| self.dt > 0.0 && self.count.is_multiple_of(n);
        if !self.is_idle() && self.model.numerics.mls_interval.is_some_and(due) {
            self.restore();
        }
        Ok(())
    }

    fn correct_gradients(&mut self) -> Result<(), RunFailure> {
        if !self.is_idle() {
            self.correct_forces();
        }
        Ok(())
    }

    fn find_faces(&mut self) -> Result<(), RunFailure> {
        if !self.is_idle() {
            self.meet();
        }
        Ok(())
    }

    fn find_overlaps(&mut self) -> Result<(), RunFailure> {
        self.overlap_bodies();
        Ok(())
    }

    fn push_faces(&mut self) -> Result<(), RunFailure> {
        if !self.is_idle() {
            self.push_externally();
            self.push_bodies();
        }
        Ok(())
    }

    fn stress(&mut self) -> Result<(), RunFailure> {
        if !self.is_idle() {
            self.update_stress();
        }
        Ok(())
    }

    fn intermediate_sums(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }

    fn forces(&mut self) -> Result<(), RunFailure> {
        self.sum_heat();
        if !self.is_idle() {
            self.sum_forces();
            self.resist_hourglass();
            self.resist_shocks();
            self.add_contacts();
            self.exerted_at.clone_from(&self.p.position);
            self.add_external();
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), RunFailure> {
        let (dt, end) = (self.dt, self.time + self.dt);
        match self.model.numerics.integrator {
            _ if self.is_idle() => {}
            Integrator::Leapfrog => {
                self.book_contacts(0.5 * dt);
                self.book_walls(0.5 * dt);
                self.book_numerical_work(0.5 * dt);
                for i in 0..self.p.len() {
                    self.kick(i, self.p.velocity[i], 0.5 * dt, end);
                }
                self.warm_by_friction();
            }
            Integrator::PredictorCorrector => {
                self.book_contacts(dt);
                self.book_walls(dt);
                self.book_numerical_work(dt);
                for i in 0..self.p.len() {
                    let before = self.base_velocity[i];
                    self.kick(i, before, dt, end);
                    let mean = plus(before.map(|v| 0.5 * v), 0.5, self.p.velocity[i]);
                    self.p.position[i] = plus(self.base_position[i], dt, self.drift_velocity(i, mean));
                }
                self.commit_stress();
                self.warm_by_friction();
            }
        }
        if dt > 0.0 {
            for (rate, increment) in self.p.plastic_strain_rate.iter_mut().zip(&self.p.plastic_strain_increment) {
                *rate = increment / dt;
            }
        }
        self.flow_heat();
        self.time = end;
        Ok(())
    }

    fn guard(&self) -> Result<(), RunFailure> {
        let is_sound = |i: usize| self.p.density[i] > 0.0 && self.p.velocity[i].iter().all(|v| v.is_finite());
        match (0..self.p.len()).find(|&i| !is_sound(i)) {
            Some(i) => Err(RunFailure::of_engine(format!("particle {} is lost", self.p.id[i]))),
            None => Ok(()),
        }
    }

    fn time_step_limit(&self) -> Result<TimeStepLimit, RunFailure> {
        let of_heat = TimeStepLimit { dt: self.conduction_limit(), reason: LimitReason::Conduction };
        Ok(if self.model.thermal.mechanics { self.mechanical_limit().min(of_heat) } else { of_heat })
    }

    fn count(&self) -> usize {
        self.p.len()
    }

    fn pairs(&self) -> u64 {
        self.p.neighbors.iter().map(|&n| u64::from(n)).sum()
    }

    fn ledger(&self) -> Result<Ledger, RunFailure> {
        Ok(self.conservation())
    }

    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        Ok(match *reduction {
            Reduction::SectionForce(section) => self.section_force(section).to_vec(),
            _ => reduction::evaluate(reduction, &self.model, &self.p),
        })
    }

    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        // Particles stay in the order they came in, that of their ids.
        let of_law = |i: usize| self.material(i).flow_law.history().iter().position(|v| v.name == field);
        if (0..self.p.len()).any(|i| of_law(i).is_some()) {
            let values = self.each(|i| of_law(i).map_or(0.0, |k| self.history[i][k]));
            return Ok(Column::Scalar(Cow::Owned(values)));
        }
        if field == INTEGRITY.name {
            return Ok(Column::Scalar(Cow::Borrowed(&self.integrity)));
        }
        if let Some(k) = KEPT.iter().position(|variable| variable.name == field) {
            return Ok(Column::Scalar(Cow::Owned(self.damage.iter().map(|of| of[k]).collect())));
        }
        self.p.column(field).ok_or_else(|| RunFailure::of_engine(format!("no field `{field}`")))
    }

    fn persist(&mut self, _: &mut dyn Archive) -> Result<(), ArchiveError> {
        Err(ArchiveError::Unsupported("the oracle runs in one go".into()))
    }

    fn memory_bytes(&self) -> u64 {
        self.p.bytes() as u64
    }
}

/// Elastic energy per mass: shear, and volume by `p^2 / (2 rho c^2)`.
pub(crate) fn elastic_energy(material: &Material, p: &Particles, i: usize, shear_modulus: f64) -> f64 {
    let shear = material.elastic_energy(p.deviator[i], shear_modulus, p.density[i]);
    shear + 0.5 * (p.pressure[i] / (p.density[i] * p.sound_speed[i])).powi(2)
}
