//! Checks that say of a run that it is broken.
//!
//! Sums of the ledger are looked at in every row of the history, particles at most every [`PARTICLE_STEPS`] steps, pairs of particles,
//! which need a search, and cells of other bodies at most every [`PAIR_STEPS`], pieces of bodies every [`PIECE_STEPS`]: all of it is less than a hundredth
//! of the work of the steps. What a check says, and what to do about it, is in `docs/warnings.md`.

mod cure;
mod start;

use self::cure::{cure, cure_of_collapse};
use self::start::{Start, energy_at_start};
use super::conservation::Conservation;
use crate::{
    engine::{
        Ledger, ParticleSource, Quantity, Reduction, RunFailure, Simulation, StepReport,
        persist::{Archive, ArchiveError, Persist, persist_all, persist_count, persist_option, require},
        persist_fields,
        reduction::{Suspects, Suspicion, TEARING_RADIUS},
    },
    model::{
        Formulation, HeatBoundaryKind, Material, Model, Search, TemperatureSource, TimeTable, WarningKind,
        WarningLimits,
    },
    output::WarningRecord,
};
use std::f64::consts::PI;

/// Steps between two looks at the particles.
const PARTICLE_STEPS: u64 = 20;
/// Steps between two searches for pairs, and for particles in cells of other bodies.
const PAIR_STEPS: u64 = 200;
/// Steps between two looks for pieces, a search on one thread.
const PIECE_STEPS: u64 = 500;
/// Steps in a row with too many to go after which a run is stopped: a step may be short for once.
const HOPELESS_STEPS: u64 = 100;
/// A step below this share of the first is small because of the solution, not because the deck asks for small steps.
const COLLAPSED: f64 = 0.1;
/// Largest number a share of next to nothing is said to be.
const LARGEST: f64 = 1e6;

/// Follows a run and says when it is broken.
pub(super) struct Watch {
    limits: WarningLimits,
    start: Option<Start>,
    supply: Supply,
    /// What was seen, in the order it was first.
    seen: Vec<Seen>,
    /// How many of them have been told.
    told: usize,
    /// Kinds that this process has told of: a step that is repeated comes upon them again.
    told_kinds: Vec<u8>,
    particles_at: Option<u64>,
    pairs_at: Option<u64>,
    pieces_at: Option<u64>,
    cells_at: Option<u64>,
    /// Size of the first step, s.
    first_step: Option<f64>,
    hopeless_steps: u64,
}

/// Share of the particles of a body up to which energies of single ones, which pairs in tension and artificial stress drive up, are no shock.
const HEATED_SHARE: f64 = 0.01;

/// The largest so far of what supplies energy, J: plastic work stays when a wall takes back what it gave.
#[derive(Clone, Copy, Debug, Default)]
struct Supply {
    work: f64,
    heat: f64,
    /// Heat that boundaries have taken, J.
    removed: f64,
    /// Sum of all changes of the kinetic energy since the start, J, up and down: in a body that vibrates, energy passes between motion and
    /// matter again and again.
    exchanged: f64,
    /// Kinetic energy when it was last looked at, J.
    kinetic: Option<f64>,
}

/// A warning.
#[derive(Clone, Debug, Default)]
struct Seen {
    /// Place of the check in [`WarningKind::ALL`].
    kind: u8,
    step: u64,
    time: f64,
    particle: Option<u32>,
    body: Option<u32>,
    position: Option<[f64; 3]>,
    /// The worst number so far, and when it was.
    worst: f64,
    worst_time: f64,
    /// Temperature that the particle of that number has, K, where it tells more than the number.
    beside: Option<f64>,
}

persist_fields!(Supply { work, heat, removed, exchanged, kinetic });
persist_fields!(Seen { kind, step, time, particle, body, position, worst, worst_time, beside });

/// Where something was seen.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    particle: Option<u32>,
    body: Option<usize>,
    position: Option<[f64; 3]>,
    /// Temperature there, K.
    temperature: Option<f64>,
}

impl Place {
    fn of(worst: (f64, u32, [f64; 3]), body: usize) -> Self {
        Self { particle: Some(worst.1), body: Some(body), position: Some(worst.2), temperature: None }
    }
}

impl Watch {
    pub(super) fn new(model: &Model) -> Self {
        Self {
            limits: model.warnings.clone(),
            start: None,
            supply: Supply::default(),
            seen: Vec::new(),
            told: 0,
            told_kinds: Vec::new(),
            particles_at: None,
            pairs_at: None,
            pieces_at: None,
            cells_at: None,
            first_step: None,
            hopeless_steps: 0,
        }
    }

    /// Number of checks that have something to say.
    pub(super) fn count(&self) -> usize {
        self.seen.len()
    }

    /// What was seen so far.
    pub(super) fn records(&self, model: &Model) -> Vec<WarningRecord> {
        self.seen.iter().map(|seen| self.record(seen, model)).collect()
    }

    /// What was seen and has not been told.
    pub(super) fn news(&mut self, model: &Model) -> Vec<WarningRecord> {
        let untold = self.seen[self.told..].iter().filter(|seen| !self.told_kinds.contains(&seen.kind));
        let (kinds, news): (Vec<_>, Vec<_>) = untold.map(|seen| (seen.kind, self.record(seen, model))).unzip();
        self.told_kinds.extend(kinds);
        self.told = self.seen.len();
        news
    }

    /// What [`Self::look`] will ask of the particles at this moment. It is known once a first state has been looked at.
    pub(super) fn asks(&self, model: &Model, clock: Clock) -> Option<Vec<Reduction<'static>>> {
        self.start.as_ref()?;
        let checks = self.due(model, clock, false).into_iter().flat_map(|of| self.checks(of, model, clock));
        Some(checks.map(|check| Reduction::Suspects(check.suspicion)).collect())
    }

    /// Looks at a state whose ledger is given, and what it says of conservation; `thoroughly` at all of it, however short
    /// the time since the last look.
    pub(super) fn look(
        &mut self,
        source: &dyn ParticleSource,
        model: &Model,
        clock: Clock,
        (ledger, conservation): (&Ledger, &Conservation),
        thoroughly: bool,
    ) -> Result<(), RunFailure> {
        if self.start.is_none() {
            self.start = Some(Start::of(source, model, ledger)?);
        }
        self.look_at_ledger(model, ledger, clock);
        self.look_at_drift(model, conservation, clock);
        for of in self.due(model, clock, thoroughly) {
            *self.last_look(of) = Some(clock.step);
            self.look_at(of, source, model, clock)?;
        }
        Ok(())
    }

    /// What of the particles is to be looked at now.
    fn due(&self, model: &Model, clock: Clock, thoroughly: bool) -> Vec<Aspect> {
        let is_due = |last: Option<u64>, interval: u64| {
            last.is_none_or(|last| clock.step >= last + interval || thoroughly && clock.step > last)
        };
        // Sums over the neighbours of the start know no instability in tension.
        let pairs = model.formulation == Formulation::UpdatedLagrangian;
        // Particles that leave a periodic cell come in at its other end, far from their piece.
        let is_open = model.periodic.iter().all(Option::is_none);
        [
            (Aspect::Particles, is_due(self.particles_at, PARTICLE_STEPS)),
            (Aspect::Pairs, pairs && is_due(self.pairs_at, PAIR_STEPS)),
            (Aspect::Pieces, is_open && is_due(self.pieces_at, PIECE_STEPS)),
            // Cells are known where the deformation is.
            (Aspect::Cells, !pairs && model.bodies.len() > 1 && is_due(self.cells_at, PAIR_STEPS)),
        ]
        .into_iter()
        .filter_map(|(of, is_due)| is_due.then_some(of))
        .collect()
    }

    /// The step of the last look at this.
    fn last_look(&mut self, of: Aspect) -> &mut Option<u64> {
        match of {
            Aspect::Particles => &mut self.particles_at,
            Aspect::Pairs => &mut self.pairs_at,
            Aspect::Pieces => &mut self.pieces_at,
            Aspect::Cells => &mut self.cells_at,
        }
    }

    /// Looks at the size of the next step, before the first and after every step; fails where the run would not end.
    pub(super) fn step(&mut self, model: &Model, dt: f64, step: u64, time: f64) -> Result<(), RunFailure> {
        let clock = Clock { step, time };
        let first = *self.first_step.get_or_insert(dt);
        self.hold(WarningKind::TimeStep, dt / first, Place::default(), clock);
        let left = (model.time.end - time) / dt;
        self.hold(WarningKind::StepsLeft, left, Place::default(), clock);
        // The deck may end the run before.
        let asked = model.time.max_steps.map_or(left, |most| left.min(most.saturating_sub(step) as f64));
        if asked > self.limits.stop_at_steps {
            self.hopeless_steps += 1;
        } else {
            self.hopeless_steps = 0;
        }
        if self.hopeless_steps < HOPELESS_STEPS {
            return Ok(());
        }
        Err(RunFailure {
            step,
            time,
            field: "time step",
            ..RunFailure::of_engine(format!(
                "the time step is {dt:.3e} s, which leaves {left:.1e} steps to the end: the run would not end; {}, \
                 or raise `warnings.stop-at-steps` to continue",
                self.cure_of_steps(model, dt)
            ))
        })
    }

    /// What to do about too many steps of this size.
    fn cure_of_steps(&self, model: &Model, dt: f64) -> String {
        match self.first_step {
            Some(first) if dt < COLLAPSED * first => cure_of_collapse(model),
            _ => cure(WarningKind::StepsLeft, model, None),
        }
    }

    fn look_at_ledger(&mut self, model: &Model, ledger: &Ledger, clock: Clock) {
        let Some(start) = &self.start else { return };
        self.supply.work = self.supply.work.max(ledger.external_work - start.external_work);
        self.supply.heat = self.supply.heat.max(ledger.boundary_heat());
        self.supply.removed = self.supply.removed.max(-ledger.boundary_heat());
        let kinetic = ledger.total.energies.kinetic;
        self.supply.exchanged += (kinetic - self.supply.kinetic.unwrap_or(start.kinetic)).abs();
        self.supply.kinetic = Some(kinetic);
        let supplied = start.kinetic + start.internal.max(0.0) + start.pressed + self.supply.work + self.supply.heat;
        let floors: Vec<f64> =
            (0..ledger.bodies.len()).map(|body| ledger.bodies[body].mass * least_energy(model, body)).collect();
        let floor = floors.iter().sum::<f64>();
        // Heat that may leave is in play as well: it expands what it enters.
        let in_play = supplied - floor;
        let (nothing, kinetic) = (start.nothing, start.kinetic);
        // A share of next to nothing is no number for people.
        let share =
            |amount: f64, of: f64| if amount.abs() <= nothing { 0.0 } else { amount / of.max(amount.abs() / LARGEST) };
        let plastic = share(ledger.total.energies.plastic_work, in_play);
        self.hold(WarningKind::PlasticWork, plastic, Place::default(), clock);

        // The work is taken at predicted velocities; the integrator has booked how far that is off.
        let springs =
            (ledger.hourglass_energy - ledger.hourglass_stored_energy).abs() - ledger.integration_energy.abs();
        self.hold(WarningKind::HourglassWork, share(springs.max(0.0), in_play), Place::default(), clock);

        // Every passage between motion and matter has its error, so that of a vibration grows without end.
        let passed = supplied.max(self.supply.exchanged).max(self.supply.removed);
        let booked = ledger.integration_energy;
        let by_contacts = ledger.contacts.iter().map(|contact| contact.integration_energy).sum::<f64>();
        let lost = booked.abs().max((booked + by_contacts).abs());
        self.hold(WarningKind::Integration, share(lost, passed), Place::default(), clock);

        // What they hold is never less than nothing.
        let given = 0.0 - ledger.contacts.iter().map(|contact| contact.stored_energy).sum::<f64>();
        self.hold(WarningKind::ContactEnergy, share(given.max(0.0), in_play), Place::default(), clock);

        let at_rest: Vec<f64> =
            (0..ledger.bodies.len()).map(|body| ledger.bodies[body].mass * energy_at_start(model, body)).collect();
        let gained = ledger.total.energies.internal - at_rest.iter().sum::<f64>();
        let mut worst = (share(floor - gained, in_play), Place::default());
        for (body, ((sums, floor), at_rest)) in ledger.bodies.iter().zip(&floors).zip(&at_rest).enumerate() {
            let missing = share(floor - (sums.energies.internal - at_rest), in_play);
            if missing > worst.0 {
                worst = (missing, Place { body: Some(body), ..Place::default() });
            }
        }
        self.hold(WarningKind::NegativeEnergy, worst.0, worst.1, clock);

        // What the springs of walls hold they give back: it is not lost.
        let held = ledger.wall_stored_energies.iter().copied().chain(std::iter::repeat(0.0));
        let walls = model.walls.iter().zip(&ledger.walls).zip(held);
        let resting = walls.filter(|((wall, _), _)| wall.velocity.iter().all(is_zero));
        let taken = resting.map(|((_, done), held)| done.work + held).sum::<f64>();
        // Without motion at the start there is nothing to hold it against.
        if kinetic > nothing {
            self.hold(WarningKind::WallEnergy, taken.abs() / kinetic, Place::default(), clock);
        }
    }

    /// Energy (J) and momentum (kg m/s) of rounding, once the run has been looked at.
    pub(super) fn rounding(&self) -> [f64; 2] {
        self.start.as_ref().map_or([0.0; 2], |start| start.rounding)
    }

    fn look_at_drift(&mut self, model: &Model, conservation: &Conservation, clock: Clock) {
        let Some(start) = &self.start else { return };
        // Sums over distances stored by one of the two particles are those of the paper, and not antisymmetric.
        if matches!(model.search, Search::Adaptive(rule) if rule.guard.is_none()) {
            return;
        }
        let drift = conservation.drift_beyond(start.nothing, start.no_momentum);
        self.hold(WarningKind::EnergyDrift, drift.energy, Place::default(), clock);
        self.hold(WarningKind::MomentumDrift, drift.momentum, Place::default(), clock);
    }

    /// The checks that the deck asks for.
    fn checks(&self, of: Aspect, model: &Model, clock: Clock) -> Vec<Check> {
        match of {
            Aspect::Particles => self.checks_of_particles(model, clock),
            Aspect::Pairs => {
                // Zones in tension are counted in what one kernel reaches.
                let around = match model.dimensions.count() {
                    1 => 2.0 * TEARING_RADIUS,
                    2 => PI * TEARING_RADIUS.powi(2),
                    _ => 4.0 / 3.0 * PI * TEARING_RADIUS.powi(3),
                };
                let pairing = self.check(WarningKind::Pairing, |_| (Suspicion::Paired, 1.0));
                pairing.into_iter().chain(self.check(WarningKind::Tearing, |_| (Suspicion::Torn, around))).collect()
            }
            Aspect::Pieces => self.check(WarningKind::Pieces, |_| (Suspicion::Apart, 1.0)).into_iter().collect(),
            Aspect::Cells => {
                let (faces, breaks) = (model.has_faces(), model.materials.iter().any(Material::breaks));
                let check = self.check(WarningKind::Interpenetration, |_| (Suspicion::Inside { faces, breaks }, 1.0));
                check.into_iter().collect()
            }
        }
    }

    /// A check with what its limit makes of it, unless it is switched off.
    fn check(&self, kind: WarningKind, of: impl FnOnce(f64) -> (Suspicion, f64)) -> Option<Check> {
        let (suspicion, unit) = of(self.limits.of(kind)?);
        Some(Check { kind, suspicion, unit })
    }

    fn checks_of_particles(&self, model: &Model, clock: Clock) -> Vec<Check> {
        let Some(start) = &self.start else { return Vec::new() };
        let gravity = model.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        let length = (0..3).map(|a| (start.high[a] - start.low[a]).powi(2)).sum::<f64>().sqrt();
        let reach = length + start.speed * clock.time + 0.5 * gravity * clock.time.powi(2);
        // Along a periodic axis nothing gets away.
        let side =
            |corner: [f64; 3], open: f64| [0, 1, 2].map(|a| if model.periodic[a].is_some() { open } else { corner[a] });
        let (low, high) = (side(start.low, f64::NEG_INFINITY), side(start.high, f64::INFINITY));
        let of_single = WarningKind::ALL.into_iter().filter_map(|kind| match kind {
            WarningKind::Cold => self.check(kind, |limit| (Suspicion::Cold(limit), 1.0)),
            WarningKind::Hot => self.check(kind, |limit| (Suspicion::Hot(limit), 1.0)),
            WarningKind::MissingHeat if model.numerics.temperature == TemperatureSource::PlasticWork => {
                self.check(kind, |limit| (Suspicion::MissingHeat(limit), 1.0))
            }
            WarningKind::Compression => self.check(kind, |limit| (Suspicion::Compressed(limit), 1.0)),
            WarningKind::Expansion => self.check(kind, |limit| (Suspicion::Expanded(limit), 1.0)),
            WarningKind::BehindSymmetry if !model.symmetry.is_empty() => {
                let breaks = model.materials.iter().any(Material::breaks);
                self.check(kind, |limit| (Suspicion::Behind { limit, breaks }, 1.0))
            }
            WarningKind::FarAway if reach > 0.0 => {
                self.check(kind, |limit| (Suspicion::Away { low, high, limit: limit * reach }, reach))
            }
            _ => None,
        });
        of_single.chain(self.check(WarningKind::LostNeighbors, |_| (Suspicion::Lonely, 1.0))).collect()
    }

    fn look_at(
        &mut self,
        of: Aspect,
        source: &dyn ParticleSource,
        model: &Model,
        clock: Clock,
    ) -> Result<(), RunFailure> {
        for check in self.checks(of, model, clock) {
            let bodies = Suspects::of(&source.reduce(&Reduction::Suspects(check.suspicion))?);
            let before = self.shares_at_start(check.kind, &bodies);
            for (body, found) in bodies.iter().enumerate() {
                let Some(worst) = found.worst else { continue };
                let number = match check.kind {
                    WarningKind::LostNeighbors | WarningKind::Pieces => {
                        share_of(found) - before.get(body).copied().unwrap_or(0.0)
                    }
                    WarningKind::Pairing | WarningKind::Interpenetration => share_of(found),
                    WarningKind::Tearing => found.suspects as f64 / check.unit,
                    _ => worst.0 / check.unit,
                };
                if check.kind == WarningKind::MissingHeat && share_of(found) <= HEATED_SHARE {
                    continue;
                }
                let mut place = Place::of(worst, body);
                if check.kind == WarningKind::MissingHeat {
                    // Sums that are on their way from a card know of no particle that was not asked for.
                    place.temperature = temperature_of(source, worst.1);
                }
                self.hold(check.kind, number, place, clock);
            }
        }
        Ok(())
    }

    /// The shares of particles that bodies had lost at the first look, of a check for what a body cannot lose: more is held against these.
    fn shares_at_start(&mut self, kind: WarningKind, bodies: &[Suspects]) -> Vec<f64> {
        let Some(start) = &mut self.start else { return Vec::new() };
        let shares = match kind {
            WarningKind::Pieces => &mut start.apart,
            WarningKind::LostNeighbors => &mut start.lonely,
            _ => return Vec::new(),
        };
        if shares.is_empty() {
            *shares = bodies.iter().map(share_of).collect();
        }
        shares.clone()
    }

    /// Holds a number against the limit of its check.
    fn hold(&mut self, kind: WarningKind, number: f64, place: Place, clock: Clock) {
        let info = kind.info();
        let worse = |a: f64, b: f64| if info.is_floor { a < b } else { a > b };
        if self.limits.of(kind).is_none_or(|limit| !worse(number, limit)) {
            return;
        }
        // JSON has no words for what is not finite.
        let number = number.clamp(-f64::MAX, f64::MAX);
        let Place { particle, body, position, temperature } = place;
        match self.seen.iter_mut().find(|seen| seen.kind == kind as u8) {
            Some(seen) if worse(number, seen.worst) => {
                (seen.worst, seen.worst_time, seen.beside) = (number, clock.time, temperature);
            }
            Some(_) => {}
            None => self.seen.push(Seen {
                kind: kind as u8,
                step: clock.step,
                time: clock.time,
                particle,
                body: body.map(|body| body as u32),
                position,
                worst: number,
                worst_time: clock.time,
                beside: temperature,
            }),
        }
    }

    fn record(&self, seen: &Seen, model: &Model) -> WarningRecord {
        let kind = WarningKind::ALL[usize::from(seen.kind)];
        let info = kind.info();
        let cure = match kind {
            WarningKind::StepsLeft => self.cure_of_steps(model, (model.time.end - seen.worst_time) / seen.worst),
            _ => cure(kind, model, seen.body.map(|body| body as usize)),
        };
        WarningRecord {
            name: info.name.to_owned(),
            meaning: match seen.beside {
                Some(own) => format!("{} ({:.0} K over {own:.0} K)", info.meaning, seen.worst * own.max(1.0)),
                None => info.meaning.to_owned(),
            },
            value: seen.worst,
            value_time: seen.worst_time,
            limit: self.limits.of(kind).unwrap_or(info.limit),
            unit: info.unit.to_owned(),
            step: seen.step,
            time: seen.time,
            particle: seen.particle,
            body: seen.body.and_then(|body| model.bodies.get(body as usize)).map(|body| body.name.clone()),
            position: seen.position,
            cure,
        }
    }
}

/// When something is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    pub(super) step: u64,
    /// s.
    pub(super) time: f64,
}

impl Clock {
    /// The present moment of a run.
    pub(super) fn of(engine: &Simulation) -> Self {
        Self { step: engine.steps(), time: engine.time() }
    }
}

/// What of the particles is looked at together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Aspect {
    /// Each by itself.
    Particles,
    /// Pairs as a share of each body, and zones of pairs in tension.
    Pairs,
    /// Pieces of bodies.
    Pieces,
    /// Bodies in cells of others.
    Cells,
}

/// A check of particles.
#[derive(Clone, Copy, Debug)]
struct Check {
    kind: WarningKind,
    suspicion: Suspicion,
    /// What a number that is found is divided by.
    unit: f64,
}

fn is_zero(table: &TimeTable) -> bool {
    table.points.iter().all(|point| point.1 == 0.0)
}

/// What heat can leave a body of the internal energy it starts with, J/kg, zero or less: it may become as cold as the coldest that anything
/// starts with or a boundary has.
fn least_energy(model: &Model, body: usize) -> f64 {
    let Some(body) = model.bodies.get(body) else { return 0.0 };
    let Some(material) = model.materials.get(body.material).filter(|material| material.heats()) else { return 0.0 };
    let mut coldest = body.temperature;
    if model.thermal.conduction {
        let bodies = model.bodies.iter().map(|body| body.temperature);
        let boundaries = model.thermal.boundaries.iter().map(|boundary| match boundary.kind {
            HeatBoundaryKind::HeldTemperature(t) | HeatBoundaryKind::SurfaceTemperature(t) => t,
            HeatBoundaryKind::Convection { ambient, .. } => ambient,
            HeatBoundaryKind::Flux(flux) if flux < 0.0 => 0.0,
            HeatBoundaryKind::Flux(_) => f64::INFINITY,
        });
        coldest = bodies.chain(boundaries).fold(coldest, f64::min);
    }
    material.specific_heat * (coldest - body.temperature)
}

/// Temperature of a particle, K.
fn temperature_of(source: &dyn ParticleSource, id: u32) -> Option<f64> {
    let quantity = Quantity { field: "temperature", component: None };
    source.reduce(&Reduction::OfParticle { id, quantity }).ok()?.first().copied()
}

fn share_of(found: &Suspects) -> f64 {
    found.suspects as f64 / found.particles.max(1) as f64
}

/// Size of a step that says what limits the run; none where it was cut for an output time.
pub(super) fn telling(report: &StepReport) -> Option<f64> {
    (report.reason != crate::engine::LimitReason::Output).then_some(report.dt)
}

impl Persist for Watch {
    /// Limits are those of the model.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let of = |field: &str| format!("{name}.{field}");
        persist_option(&mut self.start, &of("start"), archive)?;
        self.supply.persist(&of("supply"), archive)?;
        persist_all(&mut self.seen, &of("seen"), archive)?;
        self.told.persist(&of("told"), archive)?;
        self.particles_at.persist(&of("particles_at"), archive)?;
        self.pairs_at.persist(&of("pairs_at"), archive)?;
        self.pieces_at.persist(&of("pieces_at"), archive)?;
        self.cells_at.persist(&of("cells_at"), archive)?;
        self.first_step.persist(&of("first_step"), archive)?;
        persist_count(&mut self.hopeless_steps, &of("hopeless_steps"), archive)?;
        let known = self.seen.iter().all(|seen| usize::from(seen.kind) < WarningKind::ALL.len());
        require(archive.is_saving() || known && self.told <= self.seen.len(), &of("seen"))
    }
}

#[cfg(test)]
mod tests;
