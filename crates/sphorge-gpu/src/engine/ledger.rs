//! Conservation sums, taken on the GPU when asked for.

use super::columns::Group;
use super::kernels::ledger::{
    ACCOUNTS, ANGULAR, ELASTIC, FORCE, FRACTURE, HELD, INTERNAL, KINETIC, LedgerSums, MEETING, MEETING_ENERGY,
    MOMENTUM, OF_ACCOUNTS, PLACE, PLASTIC, SPEED, numbers,
};
use super::kernels::walls::SUMS;
use super::made::SegmentSums;
use super::ranks::agreement::Order;
use super::stages::Stage;
use super::{GpuEngine, failure};
use crate::device::Array;
use sphorge_engine::reduction::Turns;
use sphorge_engine::{BodyLedger, ContactLedger, Energies, HeatLedger, Ledger, Model, RunFailure, WallLedger};

/// Sums over the segments of each body and motion: those of the GPU, and then the mass.
struct Table<'a> {
    model: &'a Model,
    of: LedgerSums,
    sums: Vec<f64>,
}

impl<'a> Table<'a> {
    /// Adds segments in their order, each process its own, one after the other.
    fn add(found: SegmentSums<'a>, order: Order<'_>) -> Result<Self, RunFailure> {
        let model = found.model;
        let of = LedgerSums::of(model);
        let motions = model.motions.len() + 1;
        let width = of.count + 1;
        let mut sums = vec![0.0; model.bodies.len() * motions * width];
        order.pass(&mut sums, |sums| {
            for (k, segment) in found.segments.list.iter().enumerate() {
                let row = (segment.body as usize * motions + segment.motion as usize) * width;
                for (sum, place) in sums[row..row + of.count].iter_mut().enumerate() {
                    *place += found.at(sum, k);
                }
                sums[row + of.count] += segment.mass;
            }
        })?;
        Ok(Self { model, of, sums })
    }

    /// A sum over the particles of a body that a motion drives, by its number and one, zero for none.
    fn at(&self, body: usize, motion: usize, sum: usize) -> f64 {
        self.sums[(body * (self.model.motions.len() + 1) + motion) * (self.of.count + 1) + sum]
    }

    fn of_body(&self, body: usize, sum: usize) -> f64 {
        (0..=self.model.motions.len()).map(|motion| self.at(body, motion, sum)).sum()
    }

    fn of_all(&self, sum: usize) -> f64 {
        (0..self.model.bodies.len()).map(|body| self.of_body(body, sum)).sum()
    }

    fn mass(&self, body: usize, motion: usize) -> f64 {
        self.at(body, motion, self.of.count)
    }

    /// The sums of a body, whose particles have the accelerations that motions impose along the axes they drive, m/s².
    fn body(&self, body: usize, driven: &[[Option<f64>; 3]]) -> BodyLedger {
        let vector = |first: usize| [0, 1, 2].map(|a| self.of_body(body, first + a));
        let force = |motion: usize, a: usize| match driven[motion][a] {
            Some(driven) => self.mass(body, motion) * driven,
            None => self.at(body, motion, FORCE + a),
        };
        let [kinetic, internal, elastic, plastic_work] =
            [KINETIC, INTERNAL, ELASTIC, PLASTIC].map(|sum| self.of_body(body, sum));
        BodyLedger {
            mass: (0..driven.len()).map(|motion| self.mass(body, motion)).sum(),
            energies: Energies { kinetic, internal, elastic, plastic_work },
            momentum: vector(MOMENTUM),
            angular_momentum: vector(ANGULAR),
            momentum_scale: self.of_body(body, SPEED),
            centre: vector(PLACE),
            force: [0, 1, 2].map(|a| (0..driven.len()).map(|motion| force(motion, a)).sum()),
        }
    }

    /// Reaction of a motion on its particles, N: what the last step's accelerations lack.
    fn reaction(&self, motion: usize, driven: [Option<f64>; 3]) -> [f64; 3] {
        let lacking = |body: usize, a: usize| {
            driven[a].map_or(0.0, |driven| self.mass(body, motion) * driven - self.at(body, motion, FORCE + a))
        };
        [0, 1, 2].map(|a| (0..self.model.bodies.len()).map(|body| lacking(body, a)).sum())
    }

    fn wall(&self, wall: usize) -> WallLedger {
        let [work, friction_work, damping_work] = [0, 1, 2].map(|k| self.of_all(self.of.walls + SUMS * wall + k));
        WallLedger { work, friction_work, damping_work }
    }

    fn contact(&self, (a, b): (usize, usize)) -> ContactLedger {
        let meeting = |one: usize, other: usize, k: usize| self.of_body(one, self.of.meetings + MEETING * other + k);
        // Of a pair of particles each has a half of the works.
        let work = |k: usize| meeting(a, b, 3 + k) + if a == b { 0.0 } else { meeting(b, a, 3 + k) };
        // On the second.
        let force = |axis: usize| if a == b { 0.0 } else { 0.0 - meeting(a, b, axis) };
        let (taken_up, held) = (work(0), work(MEETING_ENERGY - 3));
        // What facets hold is known; what else the contact has taken up is left to the steps.
        let (stored_energy, integration_energy) =
            if self.model.has_facets() { (held, taken_up - held) } else { (taken_up, 0.0) };
        ContactLedger {
            force: [0, 1, 2].map(force),
            stored_energy,
            friction_work: work(1),
            damping_work: work(2),
            integration_energy,
        }
    }

    fn heat(&self) -> HeatLedger {
        if !self.model.thermal.conduction {
            return HeatLedger::default();
        }
        let boundaries = 0..self.model.thermal.boundaries.len();
        HeatLedger {
            exchanged: self.of_all(self.of.heat),
            supplied: boundaries.map(|k| self.of_all(self.of.heat + 1 + k)).collect(),
        }
    }

    fn ledger(&self, driven: &[[Option<f64>; 3]]) -> Ledger {
        let mut bodies: Vec<_> = (0..self.model.bodies.len()).map(|body| self.body(body, driven)).collect();
        let mut total = BodyLedger::total(&bodies);
        bodies.iter_mut().chain([&mut total]).for_each(BodyLedger::close);
        let accounts: [f64; OF_ACCOUNTS] = core::array::from_fn(|k| self.of_all(ACCOUNTS + k));
        let [work, x, y, z, integration_energy, viscous_energy, artificial_stress_energy, hourglass_energy, mls_energy] =
            accounts;
        let walls = 0..self.model.walls.len();
        let pairs = if self.model.has_contact() { self.model.contact_pairs() } else { Vec::new() };
        let wall_force = |wall: usize| [0, 1, 2].map(|a| self.of_all(self.of.wall_forces + 3 * wall + a));
        Ledger {
            bodies,
            total,
            external_work: work,
            external_impulse: [x, y, z],
            // GPUs take no loads of a program.
            load_work: 0.0,
            walls: walls.clone().map(|wall| self.wall(wall)).collect(),
            wall_forces: walls.map(wall_force).collect(),
            wall_stored_energies: Vec::new(),
            integration_energy,
            viscous_energy,
            artificial_stress_energy,
            hourglass_energy,
            hourglass_stored_energy: self.of_all(HELD),
            mls_energy,
            fracture_energy: self.of_all(FRACTURE),
            contacts: pairs.into_iter().map(|pair| self.contact(pair)).collect(),
            motion_forces: (1..driven.len()).map(|motion| self.reaction(motion, driven[motion])).collect(),
            heat: self.heat(),
        }
    }
}

/// A ledger that was launched: what is made of its sums.
pub(super) struct LaunchedLedger {
    /// Numbers that it leaves.
    pub(super) count: usize,
    /// Accelerations that motions impose, m/s²: of none, and of each.
    driven: Vec<[Option<f64>; 3]>,
}

impl LaunchedLedger {
    /// The ledger of its sums.
    pub(super) fn made(&self, found: SegmentSums<'_>, order: Order<'_>) -> Result<Ledger, RunFailure> {
        Ok(Table::add(found, order)?.ledger(&self.driven))
    }
}

impl GpuEngine {
    pub(super) fn conservation(&self) -> Result<Ledger, RunFailure> {
        let launched = self.launch_ledger()?;
        let numbers = self.first_sums(launched.count)?;
        launched.made(self.of_segments(&numbers), self.order())
    }

    /// Launches the sums of the ledger.
    pub(super) fn launch_ledger(&self) -> Result<LaunchedLedger, RunFailure> {
        let then = self.time - (self.dt - self.dt_to_evaluation());
        self.give_numbers(&numbers(&self.model, self.dt, then))?;
        self.launch_own(Stage::Ledger);
        let count = self.segments.numbers_of(LedgerSums::of(&self.model).count);
        Ok(LaunchedLedger { count, driven: self.accelerations() })
    }

    /// Launches kernels that read nothing of ghosts.
    pub(super) fn launch_own(&self, stage: Stage) {
        self.card.launch(self.stages.of(stage).iter().map(|staged| &staged.launch));
    }

    /// The numbers that the next sums are given.
    pub(super) fn give_numbers(&self, numbers: &[f32]) -> Result<(), RunFailure> {
        let array = self.columns.array(Group::SumNumbers).ok_or_else(|| failure("no numbers of sums"))?;
        self.card.write(array, numbers);
        Ok(())
    }

    /// Where sums are left, until the next.
    pub(super) fn sums(&self) -> Result<&Array, RunFailure> {
        self.columns.array(Group::Sums).ok_or_else(|| failure("no sums"))
    }

    /// The first numbers that sums have left, waited for.
    pub(super) fn first_sums(&self, count: usize) -> Result<Vec<f32>, RunFailure> {
        self.card.read_first(self.sums()?, count).map_err(failure)
    }

    /// Numbers as sums of the segments.
    pub(super) fn of_segments<'a>(&'a self, numbers: &'a [f32]) -> SegmentSums<'a> {
        SegmentSums { model: &self.model, segments: &self.segments, numbers }
    }

    /// Accelerations that motions impose now, m/s²: of none, and of each.
    fn accelerations(&self) -> Vec<[Option<f64>; 3]> {
        let of_motions = self.model.motions.iter();
        let imposed = of_motions.map(|motion| [0, 1, 2].map(|a| motion.axes[a].acceleration(self.time, self.dt)));
        [[None; 3]].into_iter().chain(imposed).collect()
    }
}
