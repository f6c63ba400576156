//! Sums, extremes and checks over selected particles.

use super::quantities::{Number, is_known};
use super::reference::{References, integrities};
use super::sums::{Lane, Partition, given};
use crate::engine::columns::{
    Binder, CompensatedTensor, CompensatedVector, Group, Read, ReadColumns, Reading, Recording, groups, recording,
};
use crate::record::{Double, Index, Indices, KernelFault, Recorded};
use sphorge_engine::model::{Material, MeasureKind, Model, ParticleSelection, TemperatureSource};
use sphorge_engine::reduction::{AGAINST, Looked, Quantity, Suspicion, reach};
use sphorge_physics::tensor::{dot, identity};
use sphorge_physics::{Elementary, Real, Vector};

/// Numbers that reductions are given, each with its low part: a point, the row of a particle, and of each body its spacing and smoothing length, whether it is looked at,
/// and what its particles are held against.
const POINT: usize = 0;
pub(in crate::engine) const ROW: usize = 3;
const BODIES: usize = 4;
const SPACING: usize = 0;
const SMOOTHING: usize = 1;
const SEEN: usize = 2;
const HELD_AGAINST: usize = 3;
const OF_BODY: usize = HELD_AGAINST + AGAINST;

/// How many numbers reductions of so many bodies are given.
pub(in crate::engine) fn numbers_given(bodies: usize) -> usize {
    2 * (BODIES + OF_BODY * bodies)
}

/// Beyond every place, m: no axis that does not count is farther.
const FAR: f64 = 1e30;

/// The numbers that a reduction is given: a point, m, the row of a particle, and of each body what its particles are held against, if they are.
pub(in crate::engine) fn numbers(
    model: &Model,
    point: Vector<f64>,
    row: usize,
    against: impl Fn(usize) -> Option<[f64; AGAINST]>,
) -> Vec<f32> {
    let mut numbers = vec![point[0], point[1], point[2], row as f64];
    for (k, body) in model.bodies.iter().enumerate() {
        let against = against(k);
        numbers.extend([body.spacing, body.smoothing_length, f64::from(u8::from(against.is_some()))]);
        numbers.extend(against.unwrap_or_default());
    }
    let bounded = numbers.into_iter().map(|number| number.clamp(-FAR, FAR));
    bounded.flat_map(|number| [number as f32, (number - f64::from(number as f32)) as f32]).collect()
}

/// What kernels know of the numbers they are given.
#[derive(Clone, Copy)]
struct Given {
    numbers: Reading,
}

impl Given {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self { numbers: bind.read(Group::SumNumbers) }
    }

    fn point(self) -> Vector<Double> {
        [0, 1, 2].map(|a| given(self.numbers, Index::of(2 * (POINT + a) as u32)))
    }

    fn row(self) -> Index {
        // A number below 2^24 has no rest.
        Index::floor(self.numbers.get_at(Index::of(2 * ROW as u32)))
    }

    fn of_body(self, body: Index, k: usize) -> Double {
        let first = Index::of(2 * (BODIES + k) as u32);
        given(self.numbers, first + Index::of(2 * OF_BODY as u32) * body)
    }
}

/// Which particles a reduction is of.
struct Selected<'a> {
    of: &'a ParticleSelection,
    lane: Lane,
    place: Option<CompensatedVector<Read>>,
    regions: Option<(Indices, usize)>,
}

impl<'a> Selected<'a> {
    fn new(bind: &mut Binder<'_>, of: &'a ParticleSelection, lane: Lane) -> Self {
        Self {
            of,
            lane,
            place: of.window.map(|_| groups::Place::read(bind).position),
            regions: of.region.map(|region| (bind.indices(Group::Regions), region)),
        }
    }

    /// One for those that are selected, zero for others.
    fn is_selected(&self, i: Index) -> Recorded {
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let mut is_selected = one;
        if let Some(body) = self.of.body {
            let strange = (self.lane.body().number() - Recorded::of(body as f64)).abs();
            is_selected = Recorded::select_lt(strange, Recorded::of(0.5), is_selected, zero);
        }
        if let Some((regions, region)) = self.regions {
            let bit = regions.at(i).and(Index::of(1 << region));
            is_selected = Recorded::select_lt(zero, bit.number(), is_selected, zero);
        }
        if let Some(((low, high), place)) = self.of.window.zip(self.place) {
            let x = place.doubles(i);
            for a in 0..3 {
                let [low, high] = [low[a], high[a]].map(|bound| Double::of(bound.clamp(-FAR, FAR)));
                is_selected = Recorded::select_lt((x[a] - low).high, zero, zero, is_selected);
                is_selected = Recorded::select_lt((high - x[a]).high, zero, zero, is_selected);
            }
        }
        is_selected
    }
}

/// What the kernels of a reduction make of the particles.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) enum Reduced<'a> {
    /// Mass times quantity, and mass.
    Mean(Quantity<'a>),
    /// Places, m, and their number.
    Centre,
    /// Weight of the kernel at the point times quantity, and the weights.
    Interpolation(Quantity<'a>),
    /// The largest of what is found, of its negative, and whether there is any.
    Range(Quantity<'a>),
    /// The same of the ends along an axis, m.
    Ends(usize),
    /// How far particles reach from a line along an axis through the point, m.
    Radius(usize),
}

impl Reduced<'_> {
    /// Sums or extremes that are taken.
    pub(in crate::engine) fn count(&self) -> usize {
        match self {
            Self::Mean(_) | Self::Interpolation(_) => 2,
            Self::Centre => 4,
            Self::Range(_) | Self::Ends(_) | Self::Radius(_) => 3,
        }
    }

    /// The name of its kernel: letters, digits and underscores.
    pub(in crate::engine) fn name(&self, of: &ParticleSelection) -> String {
        let mut name = match self {
            Self::Mean(_) => "mean".to_owned(),
            Self::Centre => "centre".to_owned(),
            Self::Interpolation(_) => "interpolation".to_owned(),
            Self::Range(_) => "range".to_owned(),
            Self::Ends(axis) => format!("ends_{axis}"),
            Self::Radius(axis) => format!("radius_{axis}"),
        };
        if let Some(Quantity { field, component }) = self.quantity() {
            name += &format!("_of_{field}");
            name.extend(component.map(|k| format!("_{k}")));
        }
        name.extend(of.body.map(|body| format!("_in_body_{body}")));
        name.extend(of.region.map(|region| format!("_in_region_{region}")));
        name.extend(of.window.map(|_| "_in_window"));
        name
    }

    pub(in crate::engine) fn quantity(&self) -> Option<Quantity<'_>> {
        match self {
            Self::Mean(of) | Self::Interpolation(of) | Self::Range(of) => Some(*of),
            Self::Centre | Self::Ends(_) | Self::Radius(_) => None,
        }
    }

    pub(in crate::engine) fn is_sum(&self) -> bool {
        matches!(self, Self::Mean(_) | Self::Interpolation(_) | Self::Centre)
    }
}

/// The kernels of the measures of a deck and of the checks of a run, where a GPU knows the quantities.
pub(in crate::engine) fn of_deck(
    model: &Model,
    references: References,
    (partition, count): (Partition, usize),
) -> Result<Vec<Recording>, KernelFault> {
    let mut kernels = vec![largest_of_lanes(partition.lanes(), count)?];
    let mut names = Vec::new();
    for measure in &model.measures {
        let (of, asked) = match &measure.kind {
            MeasureKind::Extent { selection, axis } => (selection, vec![Reduced::Ends(*axis)]),
            MeasureKind::Diameter { selection, axis } => (selection, vec![Reduced::Centre, Reduced::Radius(*axis)]),
            MeasureKind::Extreme { selection, field, component, .. } => {
                (selection, vec![Reduced::Range(Quantity { field, component: *component })])
            }
            MeasureKind::Mean { selection, field, component } | MeasureKind::Period { selection, field, component } => {
                (selection, vec![Reduced::Mean(Quantity { field, component: *component })])
            }
            MeasureKind::Value { selection, field, component, .. } => {
                (selection, vec![Reduced::Interpolation(Quantity { field, component: *component })])
            }
            MeasureKind::ReversalTime { selection, axis } => {
                (selection, vec![Reduced::Mean(Quantity { field: "velocity", component: Some(*axis) })])
            }
            MeasureKind::FrontSpeed { .. }
            | MeasureKind::CraterDiameter { .. }
            | MeasureKind::Cloud { .. }
            | MeasureKind::Fragments { .. } => continue,
        };
        for reduced in asked {
            let name = reduced.name(of);
            let is_new = !names.contains(&name);
            if is_new && reduced.quantity().is_none_or(|quantity| is_known(quantity, model)) {
                kernels.push(of_particles(model, &reduced, of, references, (partition, count))?);
                names.push(name);
            }
        }
    }
    let nowhere = [0.0; 3];
    let mut checks = vec![
        Suspicion::Cold(0.0),
        Suspicion::Hot(0.0),
        Suspicion::Compressed(0.0),
        Suspicion::Expanded(0.0),
        Suspicion::Away { low: nowhere, high: nowhere, limit: 0.0 },
        Suspicion::Lonely,
    ];
    checks
        .extend((model.numerics.temperature == TemperatureSource::PlasticWork).then_some(Suspicion::MissingHeat(0.0)));
    checks.extend(
        (!model.symmetry.is_empty())
            .then_some(Suspicion::Behind { limit: 0.0, breaks: model.materials.iter().any(Material::breaks) }),
    );
    for check in checks {
        kernels.extend(suspects(model, check, (partition, count))?);
    }
    Ok(kernels)
}

/// How far particles reach from their centres.
struct Reach {
    deformation: Option<CompensatedTensor<Read>>,
    earlier: Option<CompensatedTensor<Read>>,
}

impl Reach {
    fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Self {
        let deformation = model.is_total_lagrangian().then(|| groups::Deformation::read(bind).deformation);
        let is_renewed = deformation.is_some() && references == References::Renewed;
        Self { deformation, earlier: is_renewed.then(|| groups::Earlier::read(bind).deformation) }
    }

    /// Along a unit vector, m: half a spacing, deformed where the body is in one piece.
    fn along(&self, half: Double, direction: Vector<Double>, i: Index) -> Double {
        let Some(deformation) = self.deformation else { return half };
        let deformed = || reach(half, &deformation.doubles(i), direction);
        let Some(earlier) = self.earlier else { return deformed() };
        let mut off = Recorded::zero();
        for (row, ones) in earlier.doubles(i).iter().zip(&identity::<Double>()) {
            for (c, one) in row.iter().zip(ones) {
                off += (c.high - one.high).abs() + c.low.abs();
            }
        }
        Recorded::if_lt(Recorded::zero(), off, || half, deformed)
    }
}

fn unit(axis: usize) -> Vector<Double> {
    core::array::from_fn(|a| if a == axis { Double::one() } else { Double::zero() })
}

/// Most numbers of a reduction.
const MOST: usize = 4;

/// What a particle adds to the numbers of a reduction.
type Terms<'a> = Box<dyn Fn(Index) -> [Double; MOST] + 'a>;

impl Reduced<'_> {
    /// What particles of a lane add, of the columns that this takes.
    fn terms<'a>(&self, bind: &mut Binder<'_>, model: &'a Model, references: References, body: Index) -> Terms<'a> {
        let (zero, one) = (Double::zero(), Double::one());
        match *self {
            Self::Mean(quantity) => {
                let (constants, number) = (groups::Constants::read(bind), Number::of(bind, model, quantity));
                Box::new(move |i| {
                    let mass = Double::from(constants.mass.get(i));
                    [mass * value(number, i), mass, zero, zero]
                })
            }
            Self::Centre => {
                let place = groups::Place::read(bind).position;
                Box::new(move |i| {
                    let [x, y, z] = place.doubles(i);
                    [x, y, z, one]
                })
            }
            Self::Interpolation(quantity) => {
                let (place, density) = (groups::Place::read(bind).position, groups::Density::read(bind).density);
                let (constants, number) = (groups::Constants::read(bind), Number::of(bind, model, quantity));
                let given = Given::of(bind);
                let (point, at_start) = (given.point(), given.of_body(body, SMOOTHING));
                let follows = model.smoothing_follows_density();
                let dimensions = model.dimensions.count();
                Box::new(move |i| {
                    let x = place.doubles(i);
                    let squares = (0..dimensions).map(|a| (x[a] - point[a]) * (x[a] - point[a]));
                    let r = squares.reduce(|a, b| a + b).map_or(zero, Double::sqrt);
                    let h = if follows { Double::from(constants.smoothing_length.get(i)) } else { at_start };
                    let volume = Double::from(constants.mass.get(i)) / Double::new(density.get(i));
                    let w = volume * model.numerics.kernel.w(r / h) / h.powu(dimensions as u32);
                    // The field may be anything where the kernel does not reach.
                    let reached = || [w * value(number, i), w];
                    let [sum, weight] = Recorded::if_lt(Recorded::zero(), w.high, reached, || [zero; 2]);
                    [sum, weight, zero, zero]
                })
            }
            Self::Range(quantity) => {
                let number = Number::of(bind, model, quantity);
                Box::new(move |i| {
                    let value = value(number, i);
                    [value, -value, one, zero]
                })
            }
            Self::Ends(axis) => {
                let (place, reach) = (groups::Place::read(bind).position, Reach::of(bind, model, references));
                let half = Double::of(0.5) * Given::of(bind).of_body(body, SPACING);
                Box::new(move |i| {
                    let (x, reach) = (place.doubles(i)[axis], reach.along(half, unit(axis), i));
                    [x + reach, reach - x, one, zero]
                })
            }
            Self::Radius(axis) => {
                let (place, reach) = (groups::Place::read(bind).position, Reach::of(bind, model, references));
                let given = Given::of(bind);
                let (centre, half) = (given.point(), Double::of(0.5) * given.of_body(body, SPACING));
                Box::new(move |i| {
                    let x = place.doubles(i);
                    let outward = core::array::from_fn(|a| if a == axis { zero } else { x[a] - centre[a] });
                    let distance = dot(outward, outward).sqrt();
                    let aside = unit((axis + 1) % 3);
                    let along = [0, 1, 2].map(|a| {
                        let share = || outward[a] / distance;
                        Recorded::if_lt(Recorded::zero(), distance.high, share, || aside[a])
                    });
                    let radius = distance + reach.along(half, along, i);
                    [radius, -radius, one, zero]
                })
            }
        }
    }
}

/// The value of what a GPU knows.
fn value(number: Option<Number>, i: Index) -> Double {
    number.map_or_else(Double::zero, |number| number.at(i))
}

/// The kernel of the lanes.
pub(in crate::engine) fn of_particles(
    model: &Model,
    reduced: &Reduced<'_>,
    selection: &ParticleSelection,
    references: References,
    (partition, count): (Partition, usize),
) -> Result<Recording, KernelFault> {
    recording(&reduced.name(selection), count, |bind, thread| {
        let lane = Lane::of(bind, partition, thread);
        let selected = Selected::new(bind, selection, lane);
        let terms = reduced.terms(bind, model, references, lane.body());
        let zero = Double::zero();
        let count = reduced.count();
        if reduced.is_sum() {
            lane.sum::<MOST>(bind, (0, count), |i| {
                Recorded::if_lt(Recorded::zero(), selected.is_selected(i), || terms(i), || [zero; MOST])
            });
        } else {
            let start = core::array::from_fn(|k| if k == 2 { zero } else { -Double::largest() });
            let found: [Double; MOST] = lane.fold(bind.scope, start, |found: [Double; MOST], i| {
                let larger = || {
                    let terms = terms(i);
                    core::array::from_fn(|k| if k < count { found[k].max(terms[k]) } else { found[k] })
                };
                Recorded::if_lt(Recorded::zero(), selected.is_selected(i), larger, || found)
            });
            lane.set_all(bind, &found[..count]);
        }
    })
}

/// The largest of what lanes have found, one thread for each number of each segment.
pub(in crate::engine) fn largest_of_lanes(lanes: usize, count: usize) -> Result<Recording, KernelFault> {
    recording("largest_of_lanes", count, |bind, number| {
        let (from, to) = (bind.read(Group::LaneSums), bind.write(Group::Sums));
        let first = number * Index::of(2 * lanes as u32);
        let largest = bind.scope.fold(Index::of(1), Index::of(lanes as u32), given(from, first), |_, largest, lane| {
            Double::max(largest, given(from, first + Index::of(2) * lane))
        });
        let at = Index::of(2) * number;
        to.set_at(at, largest.high);
        to.set_at(at + Index::of(1), largest.low);
    })
}

/// The value of a particle.
pub(in crate::engine) fn of_particle(
    model: &Model,
    quantity: Quantity<'_>,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("of_particle", count, |bind, _| {
        let Some(number) = Number::of(bind, model, quantity) else { return };
        let (row, to) = (Given::of(bind).row(), bind.write(Group::Sums));
        let value = number.at(row);
        to.set_at(Index::of(0), value.high);
        to.set_at(Index::of(1), value.low);
    })
}

/// What a lane has found of suspicious particles: their number, and of the worst how many particles have an `id` before its own, how bad it is, and its
/// row.
#[derive(Clone, Copy)]
struct Tally {
    suspects: Recorded,
    place: Recorded,
    worst: Double,
    row: Recorded,
}

impl Tally {
    fn start() -> [Recorded; 5] {
        let worst = -Double::largest();
        [Recorded::zero(), Recorded::zero(), worst.high, worst.low, Recorded::zero()]
    }

    fn of([suspects, place, high, low, row]: [Recorded; 5]) -> Self {
        Self { suspects, place, worst: Double::new([high, low]), row }
    }

    /// With those of another, which has some: of equally bad ones the first `id` is the worst.
    fn with(self, other: Self) -> [Recorded; 5] {
        let ahead = (other.worst - self.worst).high;
        let zero = Recorded::zero();
        let is_first = Recorded::select_lt(other.place, self.place, Recorded::one(), zero);
        let is_worse =
            Recorded::select_lt(zero, ahead, Recorded::one(), Recorded::select_lt(ahead, zero, zero, is_first));
        let choose = |a: Recorded, b: Recorded| Recorded::select_lt(zero, is_worse, a, b);
        [
            self.suspects + other.suspects,
            choose(other.place, self.place),
            choose(other.worst.high, self.worst.high),
            choose(other.worst.low, self.worst.low),
            choose(other.row, self.row),
        ]
    }
}

/// Sums of a look for suspicious particles: of each segment how many there are and the place of the worst by its `id`, and how bad it is. Behind them is of each
/// body where its worst is, m: three numbers with their low parts. Rows of the worst of each segment follow, which nobody reads back.
pub(in crate::engine) const SUSPECTS: usize = 2;
pub(in crate::engine) const OF_WORST: usize = 6;

/// Numbers that a look for suspicious particles leaves, and those of them that are read back.
pub(in crate::engine) fn numbers_of_suspects(segments: usize, bodies: usize) -> [usize; 2] {
    let read = 2 * SUSPECTS * segments + OF_WORST * bodies;
    [read + segments, read]
}

/// The kernels that look for suspicious particles: that of the lanes, that of the segments, and that of the bodies.
pub(in crate::engine) fn suspects(
    model: &Model,
    suspicion: Suspicion,
    (partition, count): (Partition, usize),
) -> Result<[Recording; 3], KernelFault> {
    let kind = format!("{suspicion:?}").to_lowercase();
    let kind = kind.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
    let of_lanes = recording(&format!("suspects_{kind}"), count, |bind, thread| {
        let (lane, given) = (Lane::of(bind, partition, thread), Given::of(bind));
        let (place, density) = (groups::Place::read(bind).position, groups::Density::read(bind).density);
        let (temperature, energy) = (groups::Temperature::read(bind).temperature, groups::Energy::read(bind));
        let plastic = matches!(suspicion, Suspicion::MissingHeat(_)).then(|| groups::Plastic::read(bind));
        let integrity = matches!(suspicion, Suspicion::Behind { .. }).then(|| integrities(bind, model)).flatten();
        let (weight, places) = (groups::Weight::read(bind), bind.indices(Group::PlacesById));
        let body = lane.body();
        let against: [Double; AGAINST] = core::array::from_fn(|k| given.of_body(body, HELD_AGAINST + k));
        let (spacing, seen) = (given.of_body(body, SPACING), given.of_body(body, SEEN).high);
        let sense = Double::of(suspicion.sense());
        let found: [Recorded; 5] = lane.fold(bind.scope, Tally::start(), |found: [Recorded; 5], i| {
            let looked = Looked {
                position: place.doubles(i),
                density: Double::new(density.get(i)),
                temperature: Double::new(temperature.get(i)),
                energy: Double::new(energy.energy.get(i)),
                plastic_work: plastic.map_or(Double::zero(), |plastic| Double::new(plastic.work.get(i))),
                neighbors: Double::from(weight.neighbors.get(i)),
                spacing,
                integrity: integrity.map_or(Double::one(), |integrity| Double::from(integrity.get(i))),
            };
            let worst = sense * suspicion.number(model, &against, &looked);
            let beyond = (worst - sense * against[0]).high;
            let is_suspect = Recorded::select_lt(Recorded::zero(), beyond, seen, Recorded::zero());
            let own = Tally { suspects: Recorded::one(), place: places.at(i).number(), worst, row: i.number() };
            Recorded::if_lt(Recorded::zero(), is_suspect, || Tally::of(found).with(own), || found)
        });
        let [suspects, place, high, low, row] = found;
        let worst = Double::new([high, low]);
        lane.set_all(bind, &[Double::new([suspects, place]), worst, Double::new([row, Recorded::zero()])]);
    })?;
    let (segments, lanes) = (partition.segments, partition.lanes());
    let rows = numbers_of_suspects(segments, model.bodies.len())[1];
    let of_segments = recording("suspects_of_lanes", count, |bind, segment| {
        let (from, to) = (bind.read(Group::LaneSums), bind.write(Group::Sums));
        let part = |lane: Index, sum: usize| {
            let at = Index::of((2 * sum * segments * lanes) as u32) + Index::of(2) * lane;
            [from.get_at(at), from.get_at(at + Index::of(1))]
        };
        let first = segment * Index::of(lanes as u32);
        let found = bind.scope.fold(Index::of(0), Index::of(lanes as u32), Tally::start(), |_, found, lane| {
            let lane = first + lane;
            let ([suspects, place], [high, low], [row, _]) = (part(lane, 0), part(lane, 1), part(lane, 2));
            let other = Tally::of([suspects, place, high, low, row]);
            let with = || Tally::of(found).with(other);
            Recorded::if_lt(Recorded::zero(), suspects, with, || found)
        });
        let [tally @ .., row] = found;
        for (k, number) in tally.into_iter().enumerate() {
            to.set_at(of_segment(segment, k, segments), number);
        }
        to.set_at(Index::of(rows as u32) + segment, row);
    })?;
    let of_bodies = recording("worst_of_segments", count, |bind, body| {
        let (bodies, place) = (bind.indices(Group::Segments), groups::Place::read(bind).position);
        let sums = bind.write(Group::Sums);
        let found = bind.scope.fold(Index::of(0), Index::of(segments as u32), Tally::start(), |_, found, segment| {
            let part = |k: usize| sums.get_at(of_segment(segment, k, segments));
            let (suspects, zero) = (part(0), Recorded::zero());
            let with = || {
                let row = sums.get_at(Index::of(rows as u32) + segment);
                let strange = (bodies.at(Index::of(2) * segment + Index::of(1)).number() - body.number()).abs();
                let other = Tally::of([suspects, part(1), part(2), part(3), row]);
                Recorded::if_lt(strange, Recorded::of(0.5), || Tally::of(found).with(other), || found)
            };
            Recorded::if_lt(zero, suspects, with, || found)
        });
        let [suspects, .., row] = found;
        let at_worst = || place.doubles(Index::floor(row));
        let x = Recorded::if_lt(Recorded::zero(), suspects, at_worst, || [Double::zero(); 3]);
        let first = Index::of((2 * SUSPECTS * segments) as u32) + Index::of(OF_WORST as u32) * body;
        for (k, number) in x.into_iter().flat_map(|x| [x.high, x.low]).enumerate() {
            sums.set_at(first + Index::of(k as u32), number);
        }
    })?;
    Ok([of_lanes, of_segments, of_bodies])
}

/// Where a number of the tally of a segment is: that of two sums, each with a second number.
fn of_segment(segment: Index, k: usize, segments: usize) -> Index {
    Index::of((2 * (k / 2) * segments + k % 2) as u32) + Index::of(2) * segment
}
