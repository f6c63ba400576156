//! Heat: the flow between particles and through boundaries, and what it does to energy and temperature.
//!
//! Forward Euler with the temperatures of the start of the step, in double precision. Conduction in metals is slower than sound by
//! many orders, so beside mechanics the flow is summed anew only when a tenth of the step that it bears itself has passed, or fifty steps; until
//! then the last flow goes on. Each sum is antisymmetric, so heat is conserved either way.

use super::CpuEngine;
use super::contact::Places;
use super::reference_conduction::ReferenceState;
use crate::HeatLedger;
use crate::lanes::PairScalar;
use crate::model::{HeatBoundaryKind, Model, TemperatureSource};
use crate::neighbors::BLOCK;
use crate::particles::{Particles, Permutation};
use rayon::prelude::*;
use sphorge_physics::conduction::{
    HeatPair, Inflow, cell_size, lattice, pair_conductivity, surface_area, surface_conductance,
};
use sphorge_physics::kernel::{Kernel, pair_smoothing_length};
use sphorge_physics::pair::mean;
use sphorge_physics::time_step::conduction_limit;
use sphorge_physics::{Dimension, Vector, tensor::dot};

/// Share of its own time step after which a flow beside mechanics is summed anew.
const RENEWAL: f64 = 0.1;

/// Steps beside mechanics after which it is summed anew in any case: work has warmed particles since.
const RENEWAL_STEPS: u32 = 50;

/// Flow of heat.
#[derive(Clone, Debug)]
pub(super) struct HeatFlow {
    table: Table,
    /// Heat that flows in, W/kg.
    rate: Vec<f64>,
    /// Flow at the initial positions, W/m²; empty but with the total Lagrangian form.
    flow: Vec<Vector<f64>>,
    /// Power of each boundary by block, W; its heat of a step by block, J.
    partial: Vec<f64>,
    /// Heat that changed places in a step by block, J.
    moved: Vec<f64>,
    /// Largest stable step over the margin by block, s.
    limits: Vec<f64>,
    /// Power of each boundary at the last evaluation, W.
    power: Vec<f64>,
    /// Heat of each boundary so far, J.
    supplied: Vec<f64>,
    /// Heat that changed places so far, J.
    exchanged: f64,
    /// Time since the last evaluation, s; infinite before the first.
    age: f64,
    /// Steps since then.
    steps: u32,
    surfaces: bool,
}

/// Constants by body.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub(super) kernel: Kernel,
    pub(super) dimension: Dimension,
    pub(super) conductivity: Vec<f64>,
    specific_heat: Vec<f64>,
    /// `1 / moment` of the body's lattice.
    correction: Vec<f64>,
    /// Moment of its outermost layer over that of a full lattice.
    flat: Vec<f64>,
}

impl HeatFlow {
    /// `None` where no heat flows.
    pub(super) fn new(model: &Model, particles: usize) -> Option<Self> {
        let dimension = super::dimension(model);
        let kernel = model.numerics.kernel;
        let material = |body: &crate::model::Body| &model.materials[body.material];
        let lattices = model.bodies.iter().map(|b| (b, lattice(kernel, dimension, b.spacing, b.smoothing_length)));
        let table = Table {
            kernel,
            dimension,
            conductivity: model.bodies.iter().map(|b| material(b).conductivity).collect(),
            specific_heat: model.bodies.iter().map(|b| material(b).specific_heat).collect(),
            correction: lattices.clone().map(|(_, l)| 1.0 / l.moment).collect(),
            flat: lattices.map(|(_, l)| l.surface_moment / l.moment).collect(),
        };
        let (blocks, boundaries) = (particles.div_ceil(BLOCK), model.thermal.boundaries.len());
        let on_surface = |kind| !matches!(kind, HeatBoundaryKind::Hold(_));
        model.thermal.conduction.then(|| Self {
            table,
            rate: vec![0.0; particles],
            flow: Vec::new(),
            // At least one column, so that a block always has a chunk.
            partial: vec![0.0; blocks * boundaries.max(1)],
            moved: vec![0.0; blocks],
            limits: vec![f64::INFINITY; blocks],
            power: vec![0.0; boundaries],
            supplied: vec![0.0; boundaries],
            exchanged: 0.0,
            age: f64::INFINITY,
            steps: 0,
            surfaces: model.thermal.boundaries.iter().any(|b| on_surface(b.kind)),
        })
    }

    /// Brings held particles to their temperature: part of the initial state.
    pub(super) fn hold(model: &Model, particles: &mut Particles) {
        for i in 0..particles.len() {
            for boundary in &model.thermal.boundaries {
                if let HeatBoundaryKind::Hold(held) = boundary.kind
                    && boundary.claims(particles.body[i], particles.regions[i])
                {
                    let cp = model.materials[particles.material[i] as usize].specific_heat;
                    particles.energy[i] += cp * (held - particles.temperature[i]);
                    particles.temperature[i] = held;
                }
            }
        }
    }

    pub(super) fn reorder(&mut self, permutation: &Permutation) {
        permutation.apply(&mut self.rate);
    }

    /// Largest stable step over the margin at the last evaluation, s.
    pub(super) fn limit(&self) -> f64 {
        self.limits.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Account of the heat.
    pub(super) fn ledger(&self) -> HeatLedger {
        HeatLedger { supplied: self.supplied.clone(), exchanged: self.exchanged }
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        24 * self.flow.capacity()
            + 8 * (self.rate.capacity() + self.partial.capacity() + self.moved.capacity() + self.limits.capacity())
    }
}

/// Adds the shares of all blocks, in their order, boundary by boundary.
fn add_by_boundary(partial: &[f64], totals: &mut [f64]) {
    for block in partial.chunks(totals.len().max(1)) {
        for (total, part) in totals.iter_mut().zip(block) {
            *total += part;
        }
    }
}

/// The state a flow is summed from.
#[derive(Clone, Copy)]
struct State<'a> {
    places: Places<'a>,
    particles: &'a Particles,
}

impl Table {
    /// A pair of particles of these bodies, at a distance whose square is given, m^2.
    pub(super) fn pair(
        &self,
        bodies: (u32, u32),
        volumes: (f64, f64),
        r2: f64,
        h: f64,
        difference: f64,
    ) -> HeatPair<f64> {
        let (a, b) = (bodies.0 as usize, bodies.1 as usize);
        HeatPair {
            volumes,
            conductivity: pair_conductivity(self.conductivity[a], self.conductivity[b]),
            correction: mean(self.correction[a], self.correction[b]),
            slope: self.kernel.slope(self.dimension, r2.sqrt(), h),
            r2,
            difference,
        }
    }

    fn add(&self, sum: &mut Inflow<f64>, i: usize, row: &[u32], state: State<'_>) {
        let p = state.particles;
        let volume = p.mass[i] / p.density[i];
        for &j in row {
            let (source, position, _) = state.places.of(j);
            let x = [0, 1, 2].map(|k| p.position[i][k] - position[k]);
            let h = pair_smoothing_length(p.smoothing_length[i], p.smoothing_length[source]);
            let volumes = (volume, p.mass[source] / p.density[source]);
            let difference = p.temperature[source] - p.temperature[i];
            sum.add(&self.pair((p.body[i], p.body[source]), volumes, dot(x, x), h, difference), self.dimension);
        }
    }

    /// Power and conductance of a boundary at a particle on a surface, W and W/K.
    fn through_surface(&self, kind: HeatBoundaryKind, i: usize, sum: &Inflow<f64>, p: &Particles) -> (f64, f64) {
        let body = p.body[i] as usize;
        let volume = p.mass[i] / p.density[i];
        let area = surface_area(self.dimension, volume, sum.filled, self.flat[body]);
        let (film, outside) = match kind {
            HeatBoundaryKind::Hold(_) => return (0.0, 0.0),
            HeatBoundaryKind::Flux(flux) => return (area * flux, 0.0),
            HeatBoundaryKind::SurfaceTemperature(temperature) => (None, temperature),
            HeatBoundaryKind::Convection { coefficient, ambient } => (Some(coefficient), ambient),
        };
        let spacing = cell_size(self.dimension, volume);
        let conductance = area * surface_conductance(film, self.conductivity[body], spacing);
        (conductance * (outside - p.temperature[i]), conductance)
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Sums the flow of heat anew where it is due.
    pub(super) fn sum_heat(&mut self) {
        let model = self.model.clone();
        let is_recent =
            |heat: &HeatFlow| heat.steps < RENEWAL_STEPS && heat.age < RENEWAL * model.time.courant * heat.limit();
        let due = |heat: &mut HeatFlow| !(model.thermal.mechanics && is_recent(heat));
        let Some(mut heat) = self.heat.take_if(due) else { return };
        (heat.age, heat.steps) = (0.0, 0);
        self.sum_reference_flow(&heat.table, &mut heat.flow);
        let p = &self.particles;
        let places = Places { position: &p.position, velocity: &p.velocity, ghosts: &self.halo.ghosts };
        let state = State { places, particles: p };
        let (list, foreign) = (&self.lists.list, self.contacts.as_ref().map(|c| c.foreign()));
        let HeatFlow { table, rate, flow, partial, limits, power, surfaces, .. } = &mut heat;
        let (table, boundaries) = (&*table, &model.thermal.boundaries);
        let reference = self.reference.as_ref().map(|reference| ReferenceState {
            places: Places { position: &reference.position, ..places },
            particles: p,
            reference,
            flow,
        });
        let parts = partial.par_chunks_mut(boundaries.len().max(1));
        (rate.par_chunks_mut(BLOCK), limits.par_iter_mut(), parts).into_par_iter().enumerate().for_each(
            |(b, (rate, limit, powers))| {
                *limit = f64::INFINITY;
                powers.fill(0.0);
                let mut rows = foreign.map(|f| f.blocks()[b].rows().peekable());
                for (k, rate) in rate.iter_mut().enumerate() {
                    let i = b * BLOCK + k;
                    let mut sum = Inflow::default();
                    match reference {
                        Some(state) => table.add_reference(&mut sum, i, list.row(i), state),
                        None => table.add(&mut sum, i, list.row(i), state),
                    }
                    if let Some((_, row)) = rows.as_mut().and_then(|rows| rows.next_if(|(own, _)| *own == i)) {
                        table.add(&mut sum, i, row, state);
                    }
                    if *surfaces {
                        for (boundary, total) in boundaries.iter().zip(powers.iter_mut()) {
                            if boundary.claims(p.body[i], p.regions[i]) {
                                let (power, conductance) = table.through_surface(boundary.kind, i, &sum, p);
                                sum.power += power;
                                sum.conductance += conductance;
                                *total += power;
                            }
                        }
                    }
                    *rate = sum.power / p.mass[i];
                    let capacity = p.mass[i] * table.specific_heat[p.body[i] as usize];
                    *limit = limit.min(conduction_limit(capacity, sum.conductance));
                }
            },
        );
        power.fill(0.0);
        add_by_boundary(partial, power);
        self.heat = Some(heat);
    }

    /// Lets the heat flow for the step: energy, temperature, account.
    pub(super) fn flow_heat(&mut self) {
        let model = &*self.model;
        let dt = self.step.dt;
        let Some(heat) = &mut self.heat else { return };
        let Particles { energy, temperature, mass, body, regions, .. } = &mut self.particles;
        let (mass, body, regions) = (&*mass, &*body, &*regions);
        let HeatFlow { table, rate, partial, moved, power, supplied, exchanged, age, steps, .. } = heat;
        let boundaries = &model.thermal.boundaries;
        let parts = partial.par_chunks_mut(boundaries.len().max(1));
        (
            energy.par_chunks_mut(BLOCK),
            temperature.par_chunks_mut(BLOCK),
            rate.par_chunks(BLOCK),
            moved.par_iter_mut(),
            parts,
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(b, (e, t, rate, moved, heats))| {
                *moved = 0.0;
                heats.fill(0.0);
                for k in 0..e.len() {
                    let i = b * BLOCK + k;
                    let cp = table.specific_heat[body[i] as usize];
                    let inflow = dt * rate[k];
                    e[k] += inflow;
                    t[k] += inflow / cp;
                    *moved += mass[i] * inflow.abs();
                    for (boundary, total) in boundaries.iter().zip(heats.iter_mut()) {
                        if let HeatBoundaryKind::Hold(held) = boundary.kind
                            && boundary.claims(body[i], regions[i])
                        {
                            let supply = cp * (held - t[k]);
                            e[k] += supply;
                            t[k] = held;
                            *total += mass[i] * supply;
                        }
                    }
                }
            });
        add_by_boundary(partial, supplied);
        for (supplied, power) in supplied.iter_mut().zip(power) {
            *supplied += dt * *power;
        }
        *exchanged += moved.iter().sum::<f64>();
        *age += dt;
        *steps += 1;
    }

    /// Warms particles by the heat of friction, where temperature is not that of the internal energy anyway.
    pub(super) fn warm_by_friction(&mut self) {
        let model = &*self.model;
        let Some(contacts) = &self.contacts else { return };
        if model.numerics.temperature != TemperatureSource::PlasticWork {
            return;
        }
        let dt = self.step.dt;
        let material = &self.particles.material;
        let rubbed = contacts.rubbed();
        self.particles.temperature.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, t)| {
            if rubbed[i] > 0.0 {
                *t += dt * rubbed[i] / model.materials[material[i] as usize].specific_heat;
            }
        });
    }
}
