//! The sums of the ledger, and where each is.

use super::reference::References;
use super::sums::{Lane, Partition, Term, given, of_columns, of_lanes};
use super::walls;
use super::walls::{AtWall, Deformed, of_wall};
use crate::engine::columns::{
    Compensated, Group, Layout, Member, NOTHING, ReadColumns, Recording, ValuedMember, groups, recording,
};
use crate::record::{Double, Index, KernelFault, Recorded};
use sphorge_engine::model::{Formulation, Model};
use sphorge_engine::particles::HistoryVariables;
use sphorge_physics::damage::FRACTURE_ENERGY;
use sphorge_physics::heat::elastic_energy;
use sphorge_physics::hourglass::Spring;
use sphorge_physics::tensor::{dot, multiply};
use sphorge_physics::{Real, Vector};

/// Kinetic energy, J, mass times speed, momentum, angular momentum about the origin, mass times place, mass times acceleration.
pub(in crate::engine) const KINETIC: usize = 0;
pub(in crate::engine) const SPEED: usize = 1;
pub(in crate::engine) const MOMENTUM: usize = 2;
pub(in crate::engine) const ANGULAR: usize = 5;
pub(in crate::engine) const PLACE: usize = 8;
pub(in crate::engine) const FORCE: usize = 11;
const MOTION: usize = 14;
/// Internal and elastic energy, plastic work, and energy that hourglass springs hold, J.
pub(in crate::engine) const INTERNAL: usize = MOTION;
pub(in crate::engine) const ELASTIC: usize = MOTION + 1;
pub(in crate::engine) const PLASTIC: usize = MOTION + 2;
pub(in crate::engine) const HELD: usize = MOTION + 3;
/// What breaking has dissipated, J.
pub(in crate::engine) const FRACTURE: usize = MOTION + 4;
const ENERGIES: usize = 5;
/// The accounts, in their order.
pub(in crate::engine) const ACCOUNTS: usize = MOTION + ENERGIES;
pub(in crate::engine) const OF_ACCOUNTS: usize = 9;

/// Sums of the contact with each body: force, N, works, J, and energy that facets hold, J.
pub(in crate::engine) const MEETING: usize = MEETING_ENERGY + 1;
pub(in crate::engine) const MEETING_ENERGY: usize = 3 + 3;

/// Numbers the ledger is given with their low parts: the length of the step, of each wall displacement and velocity, of each body smoothing length, spacing and
/// sound speed at rest.
const OF_WALL: usize = 6;
const OF_BODY: usize = 3;

/// Where the sums of a model are behind those that every model has.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct LedgerSums {
    /// Of each wall the works.
    pub(in crate::engine) walls: usize,
    /// Of each wall the force.
    pub(in crate::engine) wall_forces: usize,
    /// Heat exchanged, and what each boundary has supplied.
    pub(in crate::engine) heat: usize,
    /// Of the contact with each body.
    pub(in crate::engine) meetings: usize,
    /// Number of sums.
    pub(in crate::engine) count: usize,
}

impl LedgerSums {
    pub(in crate::engine) fn of(model: &Model) -> Self {
        let walls = ACCOUNTS + OF_ACCOUNTS;
        let wall_forces = walls + walls::SUMS * model.walls.len();
        let heat = wall_forces + 3 * model.walls.len();
        let meetings = heat + if model.thermal.conduction { 1 + model.thermal.boundaries.len() } else { 0 };
        let count = meetings + if model.has_contact() { MEETING * model.bodies.len() } else { 0 };
        Self { walls, wall_forces, heat, meetings, count }
    }
}

/// How many numbers the ledger is given, with their low parts.
pub(in crate::engine) fn numbers_given(model: &Model) -> usize {
    2 * (1 + OF_WALL * model.walls.len() + OF_BODY * model.bodies.len())
}

/// What the ledger is given: walls stand where they did when forces were evaluated.
pub(in crate::engine) fn numbers(model: &Model, dt: f64, then: f64) -> Vec<f32> {
    let mut numbers = vec![dt];
    for wall in &model.walls {
        numbers.extend([0, 1, 2].map(|a| wall.velocity[a].integral(0.0, then)));
        numbers.extend([0, 1, 2].map(|a| wall.velocity[a].at(then)));
    }
    for body in &model.bodies {
        let sound_speed = model.materials[body.material].equation_of_state.reference_sound_speed();
        numbers.extend([body.smoothing_length, body.spacing, sound_speed]);
    }
    numbers.into_iter().flat_map(|number| [number as f32, (number - f64::from(number as f32)) as f32]).collect()
}

/// Kernels that sum the ledger of so many segments, each with a thread of every lane, and the last, which adds what lanes have found.
pub(in crate::engine) fn ledger(
    model: &Model,
    references: References,
    partition: Partition,
    count: usize,
) -> Result<(Vec<Recording>, Recording), KernelFault> {
    let of = LedgerSums::of(model);
    let mut kernels = vec![motion(partition, count)?, energies(model, partition, count)?];
    let mut add = |group: Group, terms: &[Term], first: usize| -> Result<(), KernelFault> {
        kernels.extend(of_columns(group, terms, (partition, first), count)?);
        Ok(())
    };
    add(Group::Accounts, &accounts().map(Term::from), ACCOUNTS)?;
    let works = |wall: usize| [0, 1, 2].map(|sum| groups::Walls::layout().of(wall).works.number(sum));
    let works: Vec<Term> = (0..model.walls.len()).flat_map(works).map(Term::from).collect();
    add(Group::Walls, &works, of.walls)?;
    if model.thermal.conduction {
        add(Group::Heat, &[groups::Heat::layout().exchanged.into()], of.heat)?;
        let supplied = |k: usize| Term::from(groups::Boundaries::layout().of(k).supplied);
        let supplied: Vec<Term> = (0..model.thermal.boundaries.len()).map(supplied).collect();
        add(Group::Boundaries, &supplied, of.heat + 1)?;
    }
    if model.has_contact() {
        kernels.push(meetings(model.bodies.len(), (partition, of.meetings), count)?);
    }
    for wall in 0..model.walls.len() {
        kernels.push(wall_force(model, wall, references, (partition, of.wall_forces + 3 * wall), count)?);
    }
    Ok((kernels, of_lanes(partition.lanes(), count)?))
}

/// The accounts of a particle.
pub(in crate::engine) fn accounts() -> [Compensated<()>; OF_ACCOUNTS] {
    let of = groups::Accounts::layout();
    let [x, y, z] = [0, 1, 2].map(|axis| of.impulse.number(axis));
    let works = [of.integration, of.viscous, of.artificial_stress, of.hourglass, of.moving_least_squares];
    let [integration, viscous, artificial_stress, hourglass, moving_least_squares] = works;
    [of.external_work, x, y, z, integration, viscous, artificial_stress, hourglass, moving_least_squares]
}

/// Place and velocity, and what comes of them.
fn motion(partition: Partition, count: usize) -> Result<Recording, KernelFault> {
    recording("sum_motion", count, |bind, thread| {
        let lane = Lane::of(bind, partition, thread);
        let (place, velocity) = (groups::Place::read(bind).position, groups::Velocity::read(bind).velocity);
        let (rates, constants) = (groups::Rates::read(bind), groups::Constants::read(bind));
        lane.sum::<MOTION>(bind, (KINETIC, MOTION), |i| {
            let (m, x, v) = (Double::from(constants.mass.get(i)), place.doubles(i), velocity.doubles(i));
            let momentum = v.map(|v| m * v);
            let squared = dot(v, v);
            let angular = [(1, 2), (2, 0), (0, 1)].map(|(b, c)| x[b] * momentum[c] - x[c] * momentum[b]);
            let mut terms = [Double::zero(); MOTION];
            terms[KINETIC] = Double::of(0.5) * m * squared;
            terms[SPEED] = m * squared.sqrt();
            terms[MOMENTUM..ANGULAR].copy_from_slice(&momentum);
            terms[ANGULAR..PLACE].copy_from_slice(&angular);
            terms[PLACE..FORCE].copy_from_slice(&x.map(|x| m * x));
            terms[FORCE..].copy_from_slice(&rates.acceleration.get(i).map(|a| m * Double::from(a)));
            terms
        });
    })
}

/// What a particle holds: of its elastic energy the shear, and the volume by `p^2 / (2 rho c^2)`.
fn energies(model: &Model, partition: Partition, count: usize) -> Result<Recording, KernelFault> {
    recording("sum_energies", count, |bind, thread| {
        let lane = Lane::of(bind, partition, thread);
        let (energy, density) = (groups::Energy::read(bind), groups::Density::read(bind).density);
        let (deviator, pressures) = (groups::Deviator::read(bind).deviator, groups::Pressure::read(bind));
        let (plastic, constants) = (groups::Plastic::read(bind), groups::Constants::read(bind));
        let law = match model.formulation {
            Formulation::TotalLagrangian { hourglass, faces, .. } if hourglass != 0.0 => {
                Some((hourglass, faces.counted()))
            }
            _ => None,
        };
        let springs = law.map(|law| (law, groups::Springs::read(bind), groups::Reference::read(bind)));
        let variables = HistoryVariables::of(model).variables;
        let place = variables.iter().position(|variable| variable.name == FRACTURE_ENERGY.name);
        let broken = place.map(|place| groups::History::read(bind).of(place).value);
        let of_body = |b: usize| &model.materials[model.bodies[b].material];
        let hyperelastic: Vec<usize> =
            (0..model.bodies.len()).filter(|b| of_body(*b).flow_law.is_hyperelastic()).collect();
        let bodies = (!hyperelastic.is_empty()).then(|| bind.indices(Group::Body));
        lane.sum::<ENERGIES>(bind, (INTERNAL, ENERGIES), |i| {
            let [m, pressure, sound_speed, shear_modulus] = [
                constants.mass.get(i),
                pressures.pressure.get(i),
                pressures.sound_speed.get(i),
                pressures.shear_modulus.get(i),
            ]
            .map(Double::from);
            let rho = Double::new(density.get(i));
            let deviator = in_pairs(deviator.get(i));
            let bulk = pressure / (rho * sound_speed);
            let mut shear = elastic_energy(deviator, shear_modulus, rho);
            for (bodies, b) in bodies.iter().flat_map(|bodies| hyperelastic.iter().map(move |b| (bodies, *b))) {
                let other = Double::from((bodies.at(i).number() - Recorded::of(b as f64)).abs());
                let own = of_body(b).elastic_energy(deviator, shear_modulus, rho);
                shear = Double::select_lt(other, Double::of(0.5), own, shear);
            }
            let elastic = shear + Double::of(0.5) * bulk * bulk;
            let [internal, plastic_work] = [energy.energy.get(i), plastic.work.get(i)].map(Double::new);
            let held = springs.map_or_else(Double::zero, |((strength, counted), springs, reference)| {
                let [young, yield_stress, stretch, misfit] = [
                    constants.young_modulus.get(i),
                    plastic.yield_stress.get(i),
                    springs.least_stretch.get(i),
                    springs.misfit.get(i),
                ]
                .map(Double::from);
                let plastic_strain = Double::new(plastic.strain.get(i));
                let spring = Spring::new(counted, Double::of(strength), young, yield_stress, plastic_strain, stretch);
                Double::new(reference.volume.get(i)) * spring.energy(misfit, model.dimensions.into())
            });
            let broken = broken.map_or_else(Double::zero, |history| m * history.double(i));
            [m * internal, m * elastic, m * plastic_work, held, broken]
        });
    })
}

fn in_pairs(tensor: sphorge_physics::SymmetricTensor<Recorded>) -> sphorge_physics::SymmetricTensor<Double> {
    sphorge_physics::SymmetricTensor::from_array(tensor.to_array().map(Double::from))
}

/// The contact with each body: however many there are, they are taken in one loop.
fn meetings(bodies: usize, (partition, first): (Partition, usize), count: usize) -> Result<Recording, KernelFault> {
    recording("sum_meetings", count, |bind, thread| {
        let (lane, meetings) = (Lane::of(bind, partition, thread), groups::Meetings::read(bind));
        let to = bind.write(Group::LaneSums);
        bind.scope.fold(Index::of(0), Index::of(bodies as u32), NOTHING, |scope, nothing, body| {
            let meeting = meetings.of_value(body);
            let sums = lane.fold(scope, [Double::zero(); MEETING], |all, i| {
                core::array::from_fn(|k| {
                    let term = match k.checked_sub(3) {
                        None => Double::from(meeting.force.axis(k).get(i)),
                        Some(_) if k == MEETING_ENERGY => Double::from(meeting.energy.get(i)),
                        Some(work) => meeting.works.number(work).double(i),
                    };
                    all[k] + term
                })
            });
            for (k, sum) in sums.into_iter().enumerate() {
                lane.set(to, Index::of((first + k) as u32) + body * Index::of(MEETING as u32), sum);
            }
            nothing
        });
    })
}

/// Force of a wall on particles where they are now.
fn wall_force(
    model: &Model,
    k: usize,
    references: References,
    (partition, first): (Partition, usize),
    count: usize,
) -> Result<Recording, KernelFault> {
    recording(&format!("sum_wall_force_{k}"), count, |bind, thread| {
        let (lane, numbers) = (Lane::of(bind, partition, thread), bind.read(Group::SumNumbers));
        let (place, evaluated) = (groups::Place::read(bind).position, groups::Evaluated::read(bind).velocity);
        let constants = groups::Constants::read(bind);
        let deformation = model.is_total_lagrangian().then(|| {
            let earlier = (references == References::Renewed).then(|| groups::Earlier::read(bind).deformation);
            (groups::Deformation::read(bind).deformation, earlier, groups::Gradient::read(bind).velocity_gradient)
        });
        let of_wall_at = 1 + OF_WALL * k;
        let of_body_at = 1 + OF_WALL * model.walls.len();
        let number = |at: usize| given(numbers, Index::of(2 * at as u32));
        let vector = |at: usize| -> Vector<Double> { [0, 1, 2].map(|a| number(at + a)) };
        let (dt, shift, moving) = (number(0), vector(of_wall_at), vector(of_wall_at + 3));
        let body = Index::of(2 * of_body_at as u32) + Index::of(2 * OF_BODY as u32) * lane.body();
        let [h, spacing, sound_speed] = [0, 2, 4].map(|at| given(numbers, body + Index::of(at)));
        lane.sum::<3>(bind, (first, 3), |i| {
            let deformed = deformation.map(|(since, earlier, gradient)| {
                let (f, earlier) = (since.doubles(i), earlier.map(|of| of.doubles(i)));
                let whole = earlier.map_or(f, |earlier| multiply(&f, &earlier));
                let velocity_gradient = gradient.get(i).map(|row| row.map(Double::from));
                Deformed { whole, earlier, velocity_gradient }
            });
            let at = place.doubles(i);
            let x = [0, 1, 2].map(|a| at[a] - shift[a]);
            let velocity = evaluated.get(i).map(Double::from);
            let own = AtWall { h, spacing, sound_speed, deformed };
            let push = of_wall(&model.walls[k], &own, x, velocity, moving, dt);
            push.acceleration.map(|a| Double::from(constants.mass.get(i)) * a)
        });
    })
}
