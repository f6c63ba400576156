//! Sums, means and extrema over particles: what measures, tracers and sections of a deck need.
//!
//! An engine evaluates them where its columns are; [`evaluate`] does so for columns in memory.

mod answers;
mod message;
mod suspicion;
mod turns;

pub use answers::{Answers, Question, QueuedSums};
pub use message::ReductionMessage;
pub use suspicion::{
    AGAINST, Looked, PAIR_DISTANCE, PAIR_GAP, Standard, Suspects, Suspicion, TEARING_RADIUS, TEARING_SHARE,
};

use crate::RunFailure;
use crate::model::{Extremum, Model, ParticleSelection, Section};
use crate::particles::{Column, Particles, stored_behind};
use sphorge_physics::{Real, Tensor, Vector, tensor};
use turns::best;
pub use turns::{Alone, Turns};

/// A number per particle: a field, of which one component may be chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity<'a> {
    /// Name of the field.
    pub field: &'a str,
    /// The component; without one the value, or the norm of a vector or tensor.
    pub component: Option<usize>,
}

/// What is asked for, and the numbers that come back: none where no particle is selected.
#[derive(Clone, Copy, Debug)]
pub enum Reduction<'a> {
    /// `max(x + s/2) - min(x - s/2)` along an axis with the spacing `s`, not beyond planes of symmetry, m.
    Extent {
        /// Which particles.
        of: &'a ParticleSelection,
        /// Axis 0, 1, 2.
        axis: usize,
    },
    /// `2 max(r + s/2)` about a line along an axis through the mean position of the particles, or in the symmetry planes that
    /// contain it, m.
    Diameter {
        /// Which particles.
        of: &'a ParticleSelection,
        /// Axis 0, 1, 2.
        axis: usize,
    },
    /// Largest or smallest value.
    Extremum {
        /// Which particles.
        of: &'a ParticleSelection,
        /// Of what.
        quantity: Quantity<'a>,
        /// Which one.
        extremum: Extremum,
    },
    /// Mass-weighted mean.
    Mean {
        /// Which particles.
        of: &'a ParticleSelection,
        /// Of what.
        quantity: Quantity<'a>,
    },
    /// `sum (m/rho) f W / sum (m/rho) W` at a point (Shepard); nothing where no kernel reaches.
    Interpolation {
        /// Which particles.
        of: &'a ParticleSelection,
        /// Of what.
        quantity: Quantity<'a>,
        /// Where, m.
        point: Vector<f64>,
    },
    /// Means over slabs of one spacing across an axis: coordinate along `direction` (m) and quantity of each slab that holds
    /// particles, one after the other.
    Slabs {
        /// Which particles.
        of: &'a ParticleSelection,
        /// Of what.
        quantity: Quantity<'a>,
        /// Axis 0, 1, 2.
        axis: usize,
        /// Sign of the coordinate: +1 or -1.
        direction: f64,
    },
    /// Force through a plane, N: x, y, z. Of an engine alone, which knows the forces between particles, and of that only once it
    /// has evaluated them.
    SectionForce(&'a Section),
    /// `id` and distance (m) of the particle nearest to a point.
    Nearest {
        /// The point, m.
        point: Vector<f64>,
        /// Only particles of this body, if given.
        body: Option<usize>,
    },
    /// Particles that are not as they should be, of each body the numbers that [`Suspects::of`] reads.
    Suspects(Suspicion),
    /// Quantity of the particle with this `id`.
    OfParticle {
        /// Which particle.
        id: u32,
        /// Of what.
        quantity: Quantity<'a>,
    },
}

/// Stored fields that every reduction may read.
const READ_BY_ALL: [&str; 8] = ["id", "body", "material", "regions", "mass", "smoothing_length", "position", "density"];

impl Reduction<'_> {
    /// The stored fields that [`evaluate`] reads of the particles.
    pub fn fields(&self) -> Vec<&str> {
        let of_quantity = match *self {
            Self::Extremum { quantity, .. }
            | Self::Mean { quantity, .. }
            | Self::Interpolation { quantity, .. }
            | Self::Slabs { quantity, .. }
            | Self::OfParticle { quantity, .. } => stored_behind(quantity.field),
            Self::Suspects(suspicion) => suspicion.fields(),
            Self::Extent { .. } | Self::Diameter { .. } => vec!["deformation", "earlier_deformation"],
            Self::SectionForce(_) | Self::Nearest { .. } => Vec::new(),
        };
        let more = of_quantity.into_iter().filter(|field| !READ_BY_ALL.contains(field));
        READ_BY_ALL.into_iter().chain(more).collect()
    }
}

/// Particles whose fields can be read: those of a running engine, or columns in memory.
pub trait FieldSource {
    /// Number of particles.
    fn count(&self) -> usize;
    /// A field of all particles.
    ///
    /// # Errors
    /// There is no such field, or the engine is lost.
    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure>;

    /// Particles with the named stored fields, all others at their initial values.
    ///
    /// # Errors
    /// There is no such field, or the engine is lost.
    fn with_fields(&self, fields: &[&str]) -> Result<Particles, RunFailure> {
        let mut particles = Particles::new(self.count());
        for field in fields {
            particles.set_column(field, &self.read(field)?);
        }
        Ok(particles)
    }
}

/// Particles that can be asked for sums, too.
pub trait ParticleSource: FieldSource {
    /// A sum, mean or extremum.
    ///
    /// # Errors
    /// The engine is lost.
    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure>;
}

/// Columns in memory, in their order.
impl FieldSource for Particles {
    fn count(&self) -> usize {
        self.len()
    }
    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        self.column(field).ok_or_else(|| RunFailure::of_engine(format!("there is no field `{field}`")))
    }
}

impl FieldSource for (&Model, &Particles) {
    fn count(&self) -> usize {
        self.1.len()
    }
    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        self.1.read(field)
    }
}

impl ParticleSource for (&Model, &Particles) {
    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        Ok(evaluate(reduction, self.0, self.1))
    }
}

/// Evaluates a reduction over columns in memory, in their order.
pub fn evaluate(reduction: &Reduction<'_>, model: &Model, particles: &Particles) -> Vec<f64> {
    let Ok(found) = evaluate_in_turn(reduction, model, particles, &Alone);
    found
}

/// Evaluates a reduction over the particles of all processes, each over its own columns in their order: to the bit what one process finds that has all of
/// them. What looks at particles around others ([`Suspicion::Apart`] and those behind it) is right on one process alone.
///
/// # Errors
/// A process is lost.
pub fn evaluate_in_turn<R: Turns>(
    reduction: &Reduction<'_>,
    model: &Model,
    particles: &Particles,
    turns: &R,
) -> Result<Vec<f64>, R::Lost> {
    let select = |selection| Selected { model, particles, selection };
    let values = |quantity| Values::of(particles, quantity);
    let found = match *reduction {
        Reduction::Extent { of, axis } => select(of).extent(axis, turns)?,
        Reduction::Diameter { of, axis } => select(of).diameter(axis, turns)?,
        Reduction::Extremum { of, quantity, extremum } => {
            let better = match extremum {
                Extremum::Maximum => f64::max,
                Extremum::Minimum => f64::min,
            };
            let Some(values) = values(quantity) else { return Ok(Vec::new()) };
            best(turns, better, select(of).indices().map(|i| values.at(i)))?
        }
        Reduction::Mean { of, quantity } => {
            let Some(values) = values(quantity) else { return Ok(Vec::new()) };
            select(of).mean(&values, turns)?
        }
        Reduction::Interpolation { of, quantity, point } => {
            let Some(values) = values(quantity) else { return Ok(Vec::new()) };
            select(of).interpolate(&values, point, turns)?
        }
        Reduction::Slabs { of, quantity, axis, direction } => {
            let Some(values) = values(quantity) else { return Ok(Vec::new()) };
            return select(of).slabs(&values, axis, direction, turns);
        }
        // Forces between particles are in no column.
        Reduction::SectionForce(_) => None,
        Reduction::Nearest { point, body } => {
            let mut nearest = [0.0; 3];
            turns.pass(&mut nearest, |sums| {
                let Some((i, squared)) = particles.nearest_squared(point, body) else { return };
                let id = f64::from(particles.id[i]);
                if sums[0] == 0.0 || squared.total_cmp(&sums[2]).then(id.total_cmp(&sums[1])).is_lt() {
                    sums.copy_from_slice(&[1.0, id, squared]);
                }
            })?;
            let [found, id, squared] = nearest;
            return Ok(if found > 0.0 { vec![id, squared.sqrt()] } else { Vec::new() });
        }
        Reduction::Suspects(suspicion) => return suspicion::evaluate(suspicion, model, particles, turns),
        Reduction::OfParticle { id, quantity } => {
            let Some(values) = values(quantity) else { return Ok(Vec::new()) };
            let place = particles.id.iter().position(|&other| other == id);
            best(turns, |_, value| value, place.into_iter().map(|place| values.at(place)))?
        }
    };
    Ok(found.into_iter().collect())
}

/// The values of a quantity.
struct Values<'a> {
    column: Column<'a>,
    component: Option<usize>,
}

impl<'a> Values<'a> {
    /// `None` for an unknown field or component.
    fn of(particles: &'a Particles, quantity: Quantity<'_>) -> Option<Self> {
        let (column, component) = (particles.column(quantity.field)?, quantity.component);
        component.is_none_or(|k| k < column.kind().width()).then_some(Self { column, component })
    }

    fn at(&self, i: usize) -> f64 {
        match self.component {
            Some(k) => self.column.component(i, k),
            None => self.column.magnitude(i),
        }
    }
}

fn unit(axis: usize) -> Vector<f64> {
    std::array::from_fn(|a| if a == axis { 1.0 } else { 0.0 })
}

/// How far a ball of that radius (m) reaches along a unit vector once it is deformed, m.
pub fn reach<T: Real>(radius: T, deformation: &Tensor<T>, direction: Vector<T>) -> T {
    let stretched = tensor::apply(&tensor::transpose(deformation), direction);
    radius * tensor::dot(stretched, stretched).sqrt()
}

/// What is between two ends along an axis, m, and not beyond planes of symmetry.
pub fn extent_between_planes(model: &Model, axis: usize, mut low: f64, mut high: f64) -> f64 {
    // Particles pressed against the plane are flatter than half a spacing.
    for plane in model.symmetry.iter().filter(|plane| plane.axis == axis) {
        if plane.side > 0.0 {
            low = low.max(plane.position);
        } else {
            high = high.min(plane.position);
        }
    }
    high - low
}

/// A point of the line along an axis that diameters are taken about, m: of the sums of places and their number the mean, or in the planes of symmetry.
pub fn line_of_diameter(model: &Model, axis: usize, [x, y, z, count]: [f64; 4]) -> Vector<f64> {
    let mut centre = [x, y, z].map(|sum| sum / count);
    for plane in model.symmetry.iter().filter(|plane| plane.axis != axis) {
        centre[plane.axis] = plane.position;
    }
    centre
}

/// Selected particles at one time.
struct Selected<'a> {
    model: &'a Model,
    particles: &'a Particles,
    selection: &'a ParticleSelection,
}

impl Selected<'_> {
    /// Places of the particles in the columns, ascending.
    fn indices(&self) -> impl Iterator<Item = usize> {
        let ParticleSelection { body, region, window } = *self.selection;
        let p = self.particles;
        (0..p.len()).filter(move |&i| {
            body.is_none_or(|body| p.body[i] as usize == body)
                && region.is_none_or(|region| p.regions[i] >> region & 1 == 1)
                && window.is_none_or(|(min, max)| (0..3).all(|a| (min[a]..=max[a]).contains(&p.position[i][a])))
        })
    }

    /// Spacing of the particle's body, m.
    fn spacing(&self, i: usize) -> f64 {
        self.model.bodies.get(self.particles.body[i] as usize).map_or(self.model.spacing, |body| body.spacing)
    }

    /// How far particle `i` reaches from its centre along a unit vector, m: half a spacing as its deformation gradient has made it, where the form of
    /// the sums has one and the body is in one piece.
    fn reach(&self, i: usize, direction: Vector<f64>) -> f64 {
        let (p, half) = (self.particles, 0.5 * self.spacing(i));
        let is_in_one_piece = p.earlier_deformation.get(i).is_none_or(|earlier| *earlier == tensor::identity());
        let deformation = p.deformation.get(i).filter(|_| is_in_one_piece);
        deformation.map_or(half, |f| reach(half, f, direction))
    }

    fn mean<R: Turns>(&self, values: &Values<'_>, turns: &R) -> Result<Option<f64>, R::Lost> {
        let mut sums = [0.0; 2];
        turns.pass(&mut sums, |sums| {
            for i in self.indices() {
                let m = self.particles.mass[i];
                sums[0] += m * values.at(i);
                sums[1] += m;
            }
        })?;
        let [sum, mass] = sums;
        Ok((mass > 0.0).then(|| sum / mass))
    }

    /// The smallest and the largest of pairs of numbers.
    fn range<R: Turns>(&self, of: impl Fn(usize) -> (f64, f64), turns: &R) -> Result<Option<(f64, f64)>, R::Lost> {
        let mut sums = [0.0; 3];
        turns.pass(&mut sums, |sums| {
            for i in self.indices() {
                let (low, high) = of(i);
                let is_first = sums[0] == 0.0;
                sums[1] = if is_first { low } else { sums[1].min(low) };
                sums[2] = if is_first { high } else { sums[2].max(high) };
                sums[0] = 1.0;
            }
        })?;
        Ok((sums[0] > 0.0).then_some((sums[1], sums[2])))
    }

    fn extent<R: Turns>(&self, axis: usize, turns: &R) -> Result<Option<f64>, R::Lost> {
        let ends = |i: usize| {
            let (x, reach) = (self.particles.position[i][axis], self.reach(i, unit(axis)));
            (x - reach, x + reach)
        };
        let range = self.range(ends, turns)?;
        Ok(range.map(|(low, high)| extent_between_planes(self.model, axis, low, high)))
    }

    fn diameter<R: Turns>(&self, axis: usize, turns: &R) -> Result<Option<f64>, R::Lost> {
        let positions = &self.particles.position;
        let mut sums = [0.0; 4];
        turns.pass(&mut sums, |sums| {
            for i in self.indices() {
                for a in 0..3 {
                    sums[a] += positions[i][a];
                }
                sums[3] += 1.0;
            }
        })?;
        let centre = line_of_diameter(self.model, axis, sums);
        let radius = |i: usize| {
            let outward: Vector<f64> =
                std::array::from_fn(|a| if a == axis { 0.0 } else { positions[i][a] - centre[a] });
            let distance = tensor::dot(outward, outward).sqrt();
            let along = if distance > 0.0 { outward.map(|c| c / distance) } else { unit((axis + 1) % 3) };
            distance + self.reach(i, along)
        };
        Ok(best(turns, f64::max, self.indices().map(radius))?.map(|radius| 2.0 * radius))
    }

    /// The normalisation of the kernel cancels, but for its `1/h^d`.
    fn interpolate<R: Turns>(
        &self,
        values: &Values<'_>,
        point: Vector<f64>,
        turns: &R,
    ) -> Result<Option<f64>, R::Lost> {
        let p = self.particles;
        let kernel = self.model.numerics.kernel;
        let dimensions = self.model.dimensions.count();
        let mut sums = [0.0; 2];
        turns.pass(&mut sums, |sums| {
            for i in self.indices() {
                let r = (0..dimensions).map(|a| (p.position[i][a] - point[a]).powi(2)).sum::<f64>().sqrt();
                let h = p.smoothing_length[i];
                let w = p.mass[i] / p.density[i] * kernel.w(r / h) / h.powi(dimensions as i32);
                // The field may be anything where the kernel does not reach.
                if w > 0.0 {
                    sums[0] += w * values.at(i);
                    sums[1] += w;
                }
            }
        })?;
        let [sum, weight] = sums;
        Ok((weight > 0.0).then(|| sum / weight))
    }

    fn slabs<R: Turns>(
        &self,
        values: &Values<'_>,
        axis: usize,
        direction: f64,
        turns: &R,
    ) -> Result<Vec<f64>, R::Lost> {
        let x = |i: usize| direction * self.particles.position[i][axis];
        let Some((low, high)) = self.range(|i| (x(i), x(i)), turns)? else { return Ok(Vec::new()) };
        // Particles of a lattice fall in the middle of a slab. A flung-off particle must not ask for endless slabs.
        let width = self.model.spacing.max((high - low) / 1e6);
        let mut slabs = vec![[0.0; 3]; ((high - low) / width + 0.5) as usize + 1];
        turns.pass(slabs.as_flattened_mut(), |sums| {
            let slabs = sums.as_chunks_mut::<3>().0;
            for i in self.indices() {
                let [count, place, value] = &mut slabs[((x(i) - low) / width + 0.5) as usize];
                *count += 1.0;
                *place += x(i);
                *value += values.at(i);
            }
        })?;
        let filled = slabs.into_iter().filter(|slab| slab[0] > 0.0);
        Ok(filled.flat_map(|[count, place, value]| [place / count, value / count]).collect())
    }
}

#[cfg(test)]
mod tests;
