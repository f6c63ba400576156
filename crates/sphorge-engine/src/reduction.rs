//! Sums, means and extrema over particles: what measures, tracers and sections of a deck need.
//!
//! An engine evaluates them where its columns are; [`evaluate`] does so for columns in memory.

mod suspicion;

pub use suspicion::{PAIR_DISTANCE, PAIR_GAP, Suspects, Suspicion, TEARING_RADIUS, TEARING_SHARE};

use crate::RunFailure;
use crate::model::{Extremum, Model, ParticleSelection, Section};
use crate::particles::{Column, Particles, stored_behind};
use sphorge_physics::{Vector, tensor};

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
            Self::Suspects(_) => vec!["temperature", "energy", "pressure", "neighbors"],
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
    let select = |selection| Selected { model, particles, selection };
    let found = match *reduction {
        Reduction::Extent { of, axis } => select(of).extent(axis),
        Reduction::Diameter { of, axis } => select(of).diameter(axis),
        Reduction::Extremum { of, quantity, extremum } => {
            let better = match extremum {
                Extremum::Maximum => f64::max,
                Extremum::Minimum => f64::min,
            };
            Values::of(particles, quantity).and_then(|v| select(of).indices().map(|i| v.at(i)).reduce(better))
        }
        Reduction::Mean { of, quantity } => Values::of(particles, quantity).and_then(|v| select(of).mean(&v)),
        Reduction::Interpolation { of, quantity, point } => {
            Values::of(particles, quantity).and_then(|v| select(of).interpolate(&v, point))
        }
        Reduction::Slabs { of, quantity, axis, direction } => {
            let Some(values) = Values::of(particles, quantity) else { return Vec::new() };
            return select(of).slabs(&values, axis, direction);
        }
        // Forces between particles are in no column.
        Reduction::SectionForce(_) => None,
        Reduction::Nearest { point, body } => {
            let nearest = particles.nearest(point, body);
            return nearest.map_or_else(Vec::new, |(i, distance)| vec![f64::from(particles.id[i]), distance]);
        }
        Reduction::Suspects(suspicion) => return suspicion::evaluate(suspicion, model, particles),
        Reduction::OfParticle { id, quantity } => {
            let place = particles.id.iter().position(|&other| other == id);
            Values::of(particles, quantity).and_then(|v| Some(v.at(place?)))
        }
    };
    found.into_iter().collect()
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
        deformation.map_or(half, |f| {
            let stretched = tensor::apply(&tensor::transpose(f), direction);
            half * tensor::dot(stretched, stretched).sqrt()
        })
    }

    fn mean(&self, values: &Values<'_>) -> Option<f64> {
        let (sum, mass) = self.indices().fold((0.0, 0.0), |(sum, mass), i| {
            let m = self.particles.mass[i];
            (sum + m * values.at(i), mass + m)
        });
        (mass > 0.0).then(|| sum / mass)
    }

    fn extent(&self, axis: usize) -> Option<f64> {
        let ends = |i: usize| {
            let (x, reach) = (self.particles.position[i][axis], self.reach(i, unit(axis)));
            (x - reach, x + reach)
        };
        let (mut low, mut high) = self.indices().map(ends).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        // Particles pressed against the plane are flatter than half a spacing.
        for plane in self.model.symmetry.iter().filter(|plane| plane.axis == axis) {
            if plane.side > 0.0 {
                low = low.max(plane.position);
            } else {
                high = high.min(plane.position);
            }
        }
        Some(high - low)
    }

    fn diameter(&self, axis: usize) -> Option<f64> {
        let positions = &self.particles.position;
        let mut centre = [0.0; 3];
        let mut count = 0.0;
        for i in self.indices() {
            for a in 0..3 {
                centre[a] += positions[i][a];
            }
            count += 1.0;
        }
        centre = centre.map(|sum| sum / count);
        for plane in self.model.symmetry.iter().filter(|plane| plane.axis != axis) {
            centre[plane.axis] = plane.position;
        }
        let radius = |i: usize| {
            let outward: Vector<f64> =
                std::array::from_fn(|a| if a == axis { 0.0 } else { positions[i][a] - centre[a] });
            let distance = tensor::dot(outward, outward).sqrt();
            let along = if distance > 0.0 { outward.map(|c| c / distance) } else { unit((axis + 1) % 3) };
            distance + self.reach(i, along)
        };
        self.indices().map(radius).reduce(f64::max).map(|radius| 2.0 * radius)
    }

    /// The normalisation of the kernel cancels, but for its `1/h^d`.
    fn interpolate(&self, values: &Values<'_>, point: Vector<f64>) -> Option<f64> {
        let p = self.particles;
        let kernel = self.model.numerics.kernel;
        let dimensions = self.model.dimensions.count();
        let (sum, weight) = self.indices().fold((0.0, 0.0), |(sum, weight), i| {
            let r = (0..dimensions).map(|a| (p.position[i][a] - point[a]).powi(2)).sum::<f64>().sqrt();
            let h = p.smoothing_length[i];
            let w = p.mass[i] / p.density[i] * kernel.w(r / h) / h.powi(dimensions as i32);
            // The field may be anything where the kernel does not reach.
            if w > 0.0 { (sum + w * values.at(i), weight + w) } else { (sum, weight) }
        });
        (weight > 0.0).then(|| sum / weight)
    }

    fn slabs(&self, values: &Values<'_>, axis: usize, direction: f64) -> Vec<f64> {
        let x = |i: usize| direction * self.particles.position[i][axis];
        let Some((low, high)) = self.indices().map(|i| (x(i), x(i))).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else {
            return Vec::new();
        };
        // Particles of a lattice fall in the middle of a slab. A flung-off particle must not ask for endless slabs.
        let width = self.model.spacing.max((high - low) / 1e6);
        let mut slabs = vec![[0.0; 3]; ((high - low) / width + 0.5) as usize + 1];
        for i in self.indices() {
            let [count, place, value] = &mut slabs[((x(i) - low) / width + 0.5) as usize];
            *count += 1.0;
            *place += x(i);
            *value += values.at(i);
        }
        let filled = slabs.into_iter().filter(|slab| slab[0] > 0.0);
        filled.flat_map(|[count, place, value]| [place / count, value / count]).collect()
    }
}

#[cfg(test)]
mod tests;
