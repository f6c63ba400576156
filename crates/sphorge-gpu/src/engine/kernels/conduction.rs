//! Heat conduction between particles and through boundaries, with the temperatures of the start of the step.

use super::grid::Grid;
use super::images::{Image, split};
use super::neighbors::{Pair, apart, different, now, over_cells, over_list, over_present_neighbors};
use super::reduce::{Together, over_particles, rows};
use super::reference::integrities;
use crate::engine::columns::{
    Binder, Compensated, CompensatedVector, Group, Handles, Layout, Member, NOTHING, Number, Read, ReadColumns,
    ReadRecords, ReadShared, Recording, Records, WriteColumns, groups, recording,
};
use crate::record::{Index, Indices, KernelFault, Recorded};
use sphorge_engine::geometry::HeatFaces;
use sphorge_engine::model::{HeatBoundaryKind, Model};
use sphorge_engine::{ConductionTable, Particles};
use sphorge_physics::conduction::{
    HeatPair, Inflow, Surroundings, add_temperature_gradient, added_flow, best_flow, cell_size, conducting_share,
    face_area, outline_area, pair_conductivity, replaced, touching_below, turned, turned_back,
};
use sphorge_physics::kernel::PairScale;
use sphorge_physics::pair::mean;
use sphorge_physics::tensor::dot;
use sphorge_physics::time_step::conduction_limit;
use sphorge_physics::{Elementary, Numbers, Real, SymmetricTensor, Tensor, Vector};

/// Numbers of a row of [`Group::HeatExtremes`]: the smallest limit, s, the lowest temperature, K, and whether one is
/// not a number.
pub(in crate::engine) const EXTREMES: usize = 3;

/// Beyond every limit, s, and every temperature, K.
pub(in crate::engine) const BEYOND: f64 = 1e30;

/// The constants of every body.
pub(in crate::engine) fn laws(model: &Model) -> Vec<f32> {
    let table = ConductionTable::new(model);
    (0..model.bodies.len()).flat_map(|body| table.of_body(body)).map(|number| number as f32).collect()
}

/// Which particles belong to which boundary.
pub(in crate::engine) fn claims(model: &Model, p: &Particles, stride: usize) -> Vec<f32> {
    let (boundaries, faces) = (&model.thermal.boundaries, HeatFaces::new(model));
    let length = <groups::Boundaries<()> as Handles<()>>::LENGTH;
    let mut numbers = vec![0.0; (length * boundaries.len()).max(1) * stride];
    for (k, boundary) in boundaries.iter().enumerate() {
        for i in (0..p.len()).filter(|i| boundary.claims(p.body[*i], p.regions[*i])) {
            let columns = groups::Boundaries::layout().of(k);
            let (claimed, outline) = (columns.claimed.column(), columns.outline.column());
            numbers[outline * stride + i] = faces.outline(p.id[i]) as f32;
            numbers[claimed * stride + i] = faces.at_unit_density(k, p.id[i]).map_or(1.0, |face| face as f32);
        }
    }
    numbers
}

/// The kernels that sum the flow, each for every particle.
pub(in crate::engine) fn sums<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Vec<Recording>, KernelFault> {
    let mut kernels = Vec::new();
    if model.is_total_lagrangian() {
        kernels.push(flow_of_deformation::<D>(model, count)?);
    }
    kernels.push(sum::<D>(model, grid, count)?);
    Ok(kernels)
}

/// The kernels that find what lies about every particle, which is the same while nothing moves: the body it touches, and what replaces missing pairs.
pub(in crate::engine) fn surroundings<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Vec<Recording>, KernelFault> {
    let mut kernels = Vec::new();
    if model.conducts_between_bodies() {
        kernels.push(touch::<D>(model, grid, count)?);
    }
    kernels.push(replacements::<D>(model, grid, count)?);
    Ok(kernels)
}

/// Particle data that heat conduction reads.
#[derive(Clone, Copy)]
struct Points {
    place: CompensatedVector<Read>,
    constants: groups::Constants<Read>,
    temperature: Compensated<Read>,
    density: Compensated<Read>,
    body: Indices,
    laws: groups::HeatLaws<Records>,
    /// Positions by which particles near other bodies are sorted.
    surface: Option<CompensatedVector<Read>>,
    /// Pressure and integrity, if some material breaks.
    cracks: Option<(Number<Read>, Number<Read>)>,
}

impl Points {
    fn of(bind: &mut Binder<'_>, model: &Model) -> Self {
        let faces = model.conducts_across_contact() && model.has_faces();
        Self {
            place: groups::Place::read(bind).position,
            constants: groups::Constants::read(bind),
            temperature: groups::Temperature::read(bind).temperature,
            density: groups::Density::read(bind).density,
            body: bind.indices(Group::Body),
            laws: groups::HeatLaws::records(bind),
            surface: faces.then(|| groups::Standing::read(bind).position),
            cracks: integrities(bind, model).map(|integrity| (groups::Pressure::read(bind).pressure, integrity)),
        }
    }

    /// Current volume, m^d.
    fn volume(self, i: Index) -> Recorded {
        self.constants.mass.get(i) / self.density.high().get(i)
    }

    fn conductivity(self, i: Index) -> Recorded {
        self.laws.conductivity.get(self.body.at(i))
    }

    fn correction(self, i: Index) -> Recorded {
        self.laws.correction.get(self.body.at(i))
    }

    /// `T_j - T_i`, K.
    fn difference(self, i: Index, j: Index) -> Recorded {
        let ([own, own_rest], [other, other_rest]) = (self.temperature.get(i), self.temperature.get(j));
        (other - own) + (other_rest - own_rest)
    }

    /// Share with which a pair conducts: the smaller of those of its particles, all of it where no material breaks.
    fn share(self, i: Index, j: Index) -> Option<Recorded> {
        let (pressure, integrity) = self.cracks?;
        let [own, other] = [i, j].map(|i| conducting_share(pressure.get(i), integrity.get(i)));
        Some(own.min(other))
    }

    /// A pair with volumes (m^d), its distance (m) and the square of it, and what replaces missing pairs of both particles.
    fn pair(
        self,
        model: &Model,
        (i, j): (Index, Index),
        volumes: (Recorded, Recorded),
        (x, r2): (Vector<Recorded>, Recorded),
        scale: PairScale<Recorded>,
        [own, other]: [SymmetricTensor<Recorded>; 2],
    ) -> HeatPair<Recorded> {
        let conductivity = pair_conductivity(self.conductivity(i), self.conductivity(j));
        HeatPair {
            volumes,
            conductivity: self.share(i, j).map_or(conductivity, |share| share * conductivity),
            correction: mean(self.correction(i), self.correction(j)),
            replaced: replaced(own, other, x, r2),
            slope: slope(model, r2, scale),
            r2,
            difference: self.difference(i, j),
        }
    }

    /// Adds a pair to what particle `i` sees of its surroundings, in the direction `seen`: volume of the other (m^d), square of the
    /// distance (m²).
    fn see(
        self,
        model: &Model,
        (i, j): (Index, Index),
        volume: Recorded,
        (r2, scale): (Recorded, PairScale<Recorded>),
        seen: Vector<Recorded>,
        mut surroundings: Surroundings<Recorded>,
    ) -> Surroundings<Recorded> {
        let correction = mean(self.correction(i), self.correction(j));
        surroundings.add(correction * volume * slope(model, r2, scale), r2, seen);
        surroundings
    }

    /// `x_i - x_j`, m, at the current positions.
    fn apart<const D: usize>(self, image: &Image, i: Index, j: Index) -> Vector<Recorded> {
        apart::<D>(image, &self.place.get(i), &self.place.get(j))
    }

    /// Folds a state over every particle of another body that is near.
    fn over_others<S: Numbers<Recorded>, const D: usize>(
        self,
        bind: &mut Binder<'_>,
        model: &Model,
        grid: &Grid,
        i: Index,
        start: S,
        add: impl Fn(S, &Pair, Index) -> S,
    ) -> S {
        let near = (self.surface.unwrap_or(self.place), now(self.constants));
        over_cells::<_, D>(bind, model, grid, i, near, start, |state, pair, j| {
            Recorded::if_lt(Recorded::of(0.5), different(self.body, i, j), || add(state, pair, j), || state)
        })
    }
}

/// `-(1/r) dW/dr`, m^-(d+2).
fn slope(model: &Model, r2: Recorded, scale: PairScale<Recorded>) -> Recorded {
    let (q, inverse_q) = scale.reduced_distance(r2);
    let within = scale.f(model.numerics.kernel.dw_over_q_by(q, inverse_q));
    -within
}

/// The other body whose face each particle touches, which is that of the nearest particle: its index plus one, zero for
/// none.
fn touch<const D: usize>(model: &Model, grid: &Grid, count: usize) -> Result<Recording, KernelFault> {
    let dimension = model.dimensions.into();
    recording("touch", count, |bind, i| {
        let (points, touched) = (Points::of(bind, model), bind.index_output(Group::Touched));
        let cell = |i: Index| cell_size(dimension, points.volume(i));
        let own = cell(i);
        let nearest = |state: [Recorded; 2], pair: &Pair, j: Index| {
            let x = points.apart::<D>(&pair.image, i, j);
            let r2 = dot(x, x);
            // Of equally near ones the first.
            let bound = touching_below(own, cell(j)).min(state[0]);
            let body = points.body.at(j).number() + Recorded::one();
            Recorded::if_lt(r2, bound, || [r2, body], || state)
        };
        let start = [Recorded::of(BEYOND), Recorded::zero()];
        let found = if model.conducts_across_contact() {
            points.over_others::<_, D>(bind, model, grid, i, start, nearest)
        } else {
            let near = (points.place, points.constants);
            over_present_neighbors::<_, D>(bind, model, i, near, start, |state: [Recorded; 2], pair, j| {
                let is_other = different(points.body, i, j);
                Recorded::if_lt(Recorded::of(0.5), is_other, || nearest(state, pair, j), || state)
            })
        };
        touched.set(i, Index::floor(found[1]));
    })
}

/// Contribution of the deformation to the flow of every particle in the reference configuration.
fn flow_of_deformation<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("heat_of_deformation", count, |bind, i| {
        let (points, heat) = (Points::of(bind, model), groups::Heat::write(bind));
        let near = (groups::Reference::read(bind), points.constants);
        let (deformation, correction) =
            (groups::Deformation::read(bind).deformation, groups::Correction::read(bind).correction);
        let (start, dimension) = ([Recorded::zero(); 3], model.dimensions.into());
        let gradient = over_list::<_, D>(bind, model, i, near, start, |mut gradient: Vector<Recorded>, pair, j| {
            let slope = slope(model, pair.r2, pair.scale);
            let slope = points.share(i, j).map_or(slope, |share| share * slope);
            add_temperature_gradient(
                &mut gradient,
                near.0.volume.high().get(j),
                slope,
                points.difference(i, j),
                pair.x,
            );
            gradient
        });
        let flow =
            added_flow(points.conductivity(i), gradient, &deformation.high().get(i), &correction.get(i), dimension);
        heat.flow.set(i, flow);
    })
}

/// Whether particles are not of one body, nor of two whose faces touch at one of the particles: one, else zero.
fn are_apart(points: &Points, touched: Option<Indices>, i: Index, j: Index) -> Recorded {
    let Some(touched) = touched else { return Recorded::zero() };
    let at =
        |of: Index, body: Index| (touched.at(of).number() - (points.body.at(body).number() + Recorded::one())).abs();
    different(points.body, i, j).min(at(i, j)).min(at(j, i))
}

/// What replaces the pairs that every particle lacks.
fn replacements<const D: usize>(model: &Model, grid: &Grid, count: usize) -> Result<Recording, KernelFault> {
    recording("replacements", count, |bind, i| {
        let (points, replacement) = (Points::of(bind, model), groups::Replacement::write(bind).replacement);
        let touched = model.conducts_between_bodies().then(|| bind.indices(Group::Touched));
        let initial = model.is_total_lagrangian();
        let start = Surroundings::none();
        let present = |state: Surroundings<Recorded>, pair: &Pair, j: Index, f: Option<&Tensor<Recorded>>| {
            let look = || {
                let x = points.apart::<D>(&pair.image, i, j);
                let seen = f.map_or(x, |f| turned_back(x, f));
                points.see(model, (i, j), points.volume(j), (dot(x, x), pair.scale), seen, state)
            };
            Recorded::if_lt(are_apart(&points, touched, i, j), Recorded::of(0.5), look, || state)
        };
        let mut surroundings = if initial {
            let near = (groups::Reference::read(bind), points.constants);
            over_list::<_, D>(bind, model, i, near, start, |state, pair, j| {
                let volume = near.0.volume.high().get(j);
                points.see(model, (i, j), volume, (pair.r2, pair.scale), pair.x, state)
            })
        } else {
            let near = (points.place, points.constants);
            over_present_neighbors::<_, D>(bind, model, i, near, start, |state, pair, j| present(state, pair, j, None))
        };
        if model.conducts_across_contact() {
            let f = initial.then(|| groups::Deformation::read(bind).deformation.high().get(i));
            surroundings = points.over_others::<_, D>(bind, model, grid, i, surroundings, |state, pair, j| {
                present(state, pair, j, f.as_ref())
            });
        }
        replacement.set(i, surroundings.replacement(points.laws.most_replaced.get(points.body.at(i))));
    })
}

/// Heat flow to every particle, and its limit of the step.
fn sum<const D: usize>(model: &Model, grid: &Grid, count: usize) -> Result<Recording, KernelFault> {
    let dimension = model.dimensions.into();
    let boundaries = &model.thermal.boundaries;
    recording("sum_heat", count, |bind, i| {
        let (points, heat) = (Points::of(bind, model), groups::Heat::write(bind));
        let through = (!boundaries.is_empty()).then(|| groups::Boundaries::write(bind));
        let touched = model.conducts_between_bodies().then(|| bind.indices(Group::Touched));
        let volume = points.volume(i);
        let replacement = groups::Replacement::read(bind).replacement;
        let deformation = model.is_total_lagrangian().then(|| groups::Deformation::read(bind).deformation.high());
        let replaced = |pair: &Pair, j: Index, seen: &dyn Fn(Index) -> SymmetricTensor<Recorded>| {
            [seen(i), pair.image.symmetric(seen(j))]
        };
        let in_turn = |i: Index| match deformation {
            Some(deformation) => turned(replacement.get(i), &deformation.get(i)),
            None => replacement.get(i),
        };
        let numbers = |sum: Inflow<Recorded>| [sum.power, sum.conductance, sum.filled];
        let inflow = |[power, conductance, filled]: [Recorded; 3]| Inflow { power, conductance, filled };
        let add = |state: [Recorded; 3], pair: &Pair, j: Index| {
            let add = || {
                let x = points.apart::<D>(&pair.image, i, j);
                let mut sum = inflow(state);
                let volumes = (volume, points.volume(j));
                let replaced = replaced(pair, j, &in_turn);
                sum.add(&points.pair(model, (i, j), volumes, (x, dot(x, x)), pair.scale, replaced), dimension);
                numbers(sum)
            };
            Recorded::if_lt(are_apart(&points, touched, i, j), Recorded::of(0.5), add, || state)
        };
        let start = numbers(Inflow::zero());
        let mut sums = if model.is_total_lagrangian() {
            let near = (groups::Reference::read(bind), points.constants);
            let better = deformation.map_or(Recorded::one(), |deformation| best_flow(&deformation.get(i)));
            let own = heat.flow.get(i);
            over_list::<_, D>(bind, model, i, near, start, |state: [Recorded; 3], pair, j| {
                let other = pair.image.vector(heat.flow.get(j));
                let flow = [0, 1, 2].map(|a| own[a] + other[a]);
                let flow = points.share(i, j).map_or(flow, |share| flow.map(|component| share * component));
                let volumes = (near.0.volume.high().get(i), near.0.volume.high().get(j));
                let mut sum = inflow(state);
                let replaced = replaced(pair, j, &|i| replacement.get(i));
                let of_pair = points.pair(model, (i, j), volumes, (pair.x, pair.r2), pair.scale, replaced);
                sum.add_reference(&of_pair, pair.x, flow, better, dimension);
                numbers(sum)
            })
        } else {
            let near = (points.place, points.constants);
            over_present_neighbors::<_, D>(bind, model, i, near, start, add)
        };
        if model.conducts_across_contact() {
            sums = points.over_others::<_, D>(bind, model, grid, i, sums, add);
        }
        let mut sum = inflow(sums);
        for (k, boundary) in boundaries.iter().enumerate() {
            let Some(through) = through else { continue };
            if matches!(boundary.kind, HeatBoundaryKind::HeldTemperature(_)) {
                continue;
            }
            let claimed = through.of(k).claimed.get(i);
            let area = match boundary.normal {
                Some(_) => face_area(dimension, claimed, points.density.high().get(i)),
                None => {
                    let (flat, outline) = (points.laws.surface.get(points.body.at(i)), through.of(k).outline.get(i));
                    outline_area(dimension, (volume, points.density.high().get(i)), sum.filled, flat, outline)
                }
            };
            let cell = cell_size(dimension, volume);
            let temperature = points.temperature.high().get(i);
            let (power, conductance) = boundary.kind.through_surface(area, temperature, points.conductivity(i), cell);
            // Faces that are not named have no area.
            let zero = Recorded::zero();
            let power = Recorded::select_lt(zero, claimed, power, zero);
            sum.power += power;
            sum.conductance += Recorded::select_lt(zero, claimed, conductance, zero);
            through.of(k).power.set(i, power);
        }
        let mass = points.constants.mass.get(i);
        heat.rate.set(i, sum.power / mass);
        let limit = conduction_limit(mass * points.laws.specific_heat.get(points.body.at(i)), sum.conductance);
        heat.limit.set(i, Recorded::select_lt(Recorded::zero(), sum.conductance, limit, Recorded::of(BEYOND)));
    })
}

/// Applies the heat flow of the step to energy, temperature and balance.
pub(in crate::engine) fn flow(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    let boundaries = &model.thermal.boundaries;
    recording("flow_heat", count, |bind, i| {
        let (energy, temperature) = (groups::Energy::write(bind), groups::Temperature::write(bind).temperature);
        let (heat, constants, step) =
            (groups::Heat::write(bind), groups::Constants::read(bind), groups::Step::shared(bind));
        let (body, laws) = (bind.indices(Group::Body), groups::HeatLaws::records(bind));
        let through = (!boundaries.is_empty()).then(|| groups::Boundaries::write(bind));
        let specific_heat = laws.specific_heat.get(body.at(i));
        let (dt, mass) = (step.dt.value(), constants.mass.get(i));
        let inflow = dt * heat.rate.get(i);
        energy.energy.add(i, inflow);
        temperature.add(i, inflow / specific_heat);
        heat.exchanged.add(i, mass * inflow.abs());
        for (k, boundary) in boundaries.iter().enumerate() {
            let Some(through) = through else { continue };
            let through = through.of(k);
            let HeatBoundaryKind::HeldTemperature(held) = boundary.kind else {
                through.supplied.add(i, dt * through.power.get(i));
                continue;
            };
            let hold = || {
                let ([now, rest], held) = (temperature.get(i), split(held));
                let supply = specific_heat * ((held[0] - now) + (held[1] - rest));
                energy.energy.add(i, supply);
                temperature.set(i, held);
                through.supplied.add(i, mass * supply);
                NOTHING
            };
            let claimed = through.claimed.get(i);
            Recorded::if_lt(Recorded::of(0.5), claimed, hold, || NOTHING);
        }
    })
}

/// Reduction of the numbers of [`Group::HeatExtremes`].
pub(in crate::engine) const TOGETHER: [Together; EXTREMES] = [Together::Least, Together::Least, Together::Largest];

/// For each row of the `particles`: the smallest limit and the lowest temperature, and whether one is not a number.
pub(in crate::engine) fn extremes(particles: usize, count: usize) -> Result<Recording, KernelFault> {
    recording("heat_extremes", count, |bind, row| {
        let (heat, temperature) = (groups::Heat::read(bind), groups::Temperature::read(bind).temperature);
        let extremes = bind.write(Group::HeatExtremes);
        let (zero, one, far) = (Recorded::zero(), Recorded::one(), Recorded::of(BEYOND));
        let all = over_particles(bind, (count, row), [far, far, zero], |all: [Recorded; EXTREMES], i| {
            // Columns are padded to whole chunks.
            let there =
                |a: Recorded, b: Recorded| Recorded::select_lt(i.number(), Recorded::of(particles as f64), a, b);
            let now = temperature.high().get(i);
            let broken = Recorded::select_lt(now.abs(), far, zero, one);
            [all[0].min(there(heat.limit.get(i), far)), all[1].min(there(now, far)), all[2].max(there(broken, zero))]
        });
        for (k, number) in all.into_iter().enumerate() {
            extremes.set_at(Index::of((k * rows(count)) as u32) + row, number);
        }
    })
}
