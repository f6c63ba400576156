//! Bodies: shape, lattice, first motion.

use super::{Dimensions, Parts};
use std::{path::PathBuf, sync::Arc};

/// A body of particles.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name in the deck.
    pub name: String,
    /// Index into [`super::Model::materials`].
    pub material: usize,
    /// Shape in the initial configuration.
    pub shape: Shape,
    /// Lattice that fills the shape.
    pub lattice: Lattice,
    /// Particle spacing of this body, m.
    pub spacing: f64,
    /// Smoothing length of this body, m.
    pub smoothing_length: f64,
    /// Initial velocity, m/s.
    pub velocity: [f64; 3],
    /// Initial angular velocity, rad/s, about `spin_centre`.
    pub spin: [f64; 3],
    /// Centre of the initial spin, m.
    pub spin_centre: [f64; 3],
    /// Gradient of an initial velocity linear in space, 1/s, about `gradient_centre`; added to `velocity`.
    pub velocity_gradient: [[f64; 3]; 3],
    /// Where that velocity is zero, m.
    pub gradient_centre: [f64; 3],
    /// Initial velocity by a table along an axis, added to `velocity`.
    pub velocity_profile: Option<VelocityProfile>,
    /// Initial velocity away from a centre or axis, added to `velocity`.
    pub radial_velocity: Option<RadialVelocity>,
    /// Initial temperature, K.
    pub temperature: f64,
}

/// A velocity that varies along one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityProfile {
    /// Axis 0, 1, 2 it varies along.
    pub along: usize,
    /// Velocity where the table says one, m/s.
    pub amplitude: [f64; 3],
    /// Place on the axis, m, and share of the amplitude; places increase. Linear between rows, constant outside.
    pub rows: Vec<(f64, f64)>,
}

/// A velocity away from a centre, or from a line along a coordinate axis.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialVelocity {
    /// The centre, or a point of the line, m.
    pub centre: [f64; 3],
    /// Axis 0, 1, 2 the line is along; the centre alone if none.
    pub axis: Option<usize>,
    /// Radius, m, and velocity outwards, m/s; radii increase. Linear between rows, constant outside, zero in the centre itself.
    pub rows: Vec<(f64, f64)>,
}

impl Body {
    /// Initial velocity of the body at a point, m/s.
    pub fn initial_velocity(&self, x: [f64; 3]) -> [f64; 3] {
        let r: [f64; 3] = std::array::from_fn(|k| x[k] - self.spin_centre[k]);
        let w = self.spin;
        let turning = [w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]];
        let d: [f64; 3] = std::array::from_fn(|k| x[k] - self.gradient_centre[k]);
        let g = &self.velocity_gradient;
        let shape = self.velocity_profile.as_ref().map_or([0.0; 3], |profile| profile.at(x));
        let radial = self.radial_velocity.as_ref().map_or([0.0; 3], |radial| radial.at(x));
        std::array::from_fn(|k| {
            self.velocity[k] + turning[k] + (g[k][0] * d[0] + g[k][1] * d[1] + g[k][2] * d[2]) + shape[k] + radial[k]
        })
    }

    /// Least and largest initial velocity of any point of the body by components, m/s, or beyond.
    pub fn velocity_bounds(&self, dimensions: Dimensions) -> [[f64; 3]; 2] {
        let (low, high) = self.shape.bounds(dimensions);
        let bounds = [low, high];
        let linear = Self { velocity_profile: None, radial_velocity: None, ..self.clone() };
        let corners = (0..8).map(|k| linear.initial_velocity([0, 1, 2].map(|a| bounds[k >> a & 1][a])));
        let rows = |rows: &[(f64, f64)]| {
            rows.iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], row| [least.min(row.1), most.max(row.1)])
        };
        let profile = self.velocity_profile.as_ref().map_or([[0.0; 3]; 2], |profile| {
            let ends = rows(&profile.rows).map(|share| profile.amplitude.map(|v| share * v));
            [f64::min, f64::max].map(|pick| [0, 1, 2].map(|a| pick(ends[0][a], ends[1][a])))
        });
        let radial = self.radial_velocity.as_ref().map_or(0.0, |radial| {
            let [least, most] = rows(&radial.rows);
            most.max(-least)
        });
        let listed = self.listed_velocities();
        let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in corners {
            for a in 0..3 {
                least[a] = least[a].min(corner[a] + profile[0][a] + listed[0][a] - radial);
                most[a] = most[a].max(corner[a] + profile[1][a] + listed[1][a] + radial);
            }
        }
        [least, most]
    }
}

impl Body {
    /// Least and largest velocity by components that particles from a file have beside that of the body, m/s.
    fn listed_velocities(&self) -> [[f64; 3]; 2] {
        let Solid::Cloud { particles, .. } = &self.shape.solid else { return [[0.0; 3]; 2] };
        let turned = particles.iter().map(|particle| self.shape.transform.turn(particle.velocity));
        turned.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[least, most], v| {
            [0, 1].map(|end| [0, 1, 2].map(|a| if end == 0 { least[a].min(v[a]) } else { most[a].max(v[a]) }))
        })
    }
}

impl VelocityProfile {
    fn at(&self, x: [f64; 3]) -> [f64; 3] {
        let share = super::boundary::linear(&self.rows, x[self.along]);
        self.amplitude.map(|v| v * share)
    }
}

impl RadialVelocity {
    fn at(&self, x: [f64; 3]) -> [f64; 3] {
        let across = |k: usize| if self.axis == Some(k) { 0.0 } else { x[k] - self.centre[k] };
        let outwards: [f64; 3] = std::array::from_fn(across);
        let radius = outwards.iter().map(|c| c * c).sum::<f64>().sqrt();
        // The centre has no direction.
        let share = if radius > 0.0 { super::boundary::linear(&self.rows, radius) / radius } else { 0.0 };
        outwards.map(|c| share * c)
    }
}

/// A solid, placed: points are turned about the origin and shifted.
#[derive(Clone, Debug)]
pub struct Shape {
    /// The solid in its own frame.
    pub solid: Solid,
    /// From its own frame into space.
    pub transform: Transform,
}

/// Solids in their own frame. In plane strain z is ignored, in one dimension y and z.
#[derive(Clone, Debug)]
pub enum Solid {
    /// Axis-aligned box between two corners, m.
    Box {
        /// Lower corner.
        min: [f64; 3],
        /// Upper corner.
        max: [f64; 3],
    },
    /// Disc (plane strain) or sphere (3D), or with a hole a ring or a shell.
    Ball {
        /// Centre, m.
        centre: [f64; 3],
        /// Radius, m.
        radius: f64,
        /// Radius of the hole, m; 0 for none.
        inner_radius: f64,
    },
    /// Circular cylinder between two axis points, or with a hole a tube.
    Cylinder {
        /// Centre of one end, m.
        from: [f64; 3],
        /// Centre of the other end, m.
        to: [f64; 3],
        /// Radius, m.
        radius: f64,
        /// Radius of the hole, m; 0 for none.
        inner_radius: f64,
    },
    /// What lies between an axis and a profile turned about it; in plane strain the profile and its mirror image.
    Revolution {
        /// Point of the axis the axial distances are counted from, m.
        from: [f64; 3],
        /// Unit vector along the axis.
        axis: [f64; 3],
        /// Axial distance and radius of the points of the profile, m; axial distances never fall, two equal ones are a step.
        profile: Vec<[f64; 2]>,
    },
    /// Round bar with a tangent ogive at one end: the nose is an arc of a circle that leaves the bar without a kink.
    Ogive {
        /// Centre of the flat end, m.
        from: [f64; 3],
        /// Tip, m.
        to: [f64; 3],
        /// Radius of the bar, m.
        radius: f64,
        /// Length of the nose, m, at least the radius and at most the whole length.
        nose_length: f64,
    },
    /// Area inside a closed polygon, in plane strain.
    Polygon {
        /// Corners in order, m; the last is joined to the first.
        corners: Vec<[f64; 2]>,
    },
    /// Particles from a file.
    Cloud {
        /// The file.
        file: PathBuf,
        /// The particles.
        particles: Arc<[CloudParticle]>,
    },
    /// Shapes put together.
    Composed {
        /// How.
        operation: Operation,
        /// The shapes, at least one; each is placed in the frame of the whole.
        parts: Parts,
    },
}

/// A particle from a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudParticle {
    /// Where, m.
    pub position: [f64; 3],
    /// Velocity in the frame of the cloud, m/s; that of the body is added.
    pub velocity: [f64; 3],
    /// What it stands for.
    pub share: CloudShare,
}

/// How much material a particle from a file stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CloudShare {
    /// Spacing to the power of the dimensions.
    Spacing,
    /// Volume, m³; area (m²) in plane strain, length (m) in one dimension.
    Volume(f64),
    /// Mass, kg; per metre of thickness in plane strain, per square metre in one dimension.
    Mass(f64),
}

/// How shapes are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// What is in any of them.
    Union,
    /// What is in the first and in no other.
    Difference,
    /// What is in all of them.
    Intersection,
}

/// A rotation followed by a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Rotation, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Translation, m.
    pub translation: [f64; 3],
}

impl Default for Transform {
    fn default() -> Self {
        Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] }
    }
}

/// How the particles of a body are arranged; the arrangement turns with the shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lattice {
    /// Pattern of the particles.
    pub arrangement: Arrangement,
    /// Where the particles of a square or cubic lattice sit with respect to the faces of the shape.
    pub placement: LatticePlacement,
}

/// Pattern of particles. The spacing is the edge of the square or cube a particle stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrangement {
    /// Square in the plane, cubic in space.
    #[default]
    Square,
    /// Triangular in the plane, hexagonal close-packed in space.
    Hexagonal,
    /// Concentric rings of equally spaced particles, in discs and cylinders.
    Rings,
}

/// Placement of a square or cubic lattice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LatticePlacement {
    /// Particles at cell centres: the outermost layer is half a spacing inside the face.
    #[default]
    CellCentres,
    /// Particles on the faces.
    OnFaces,
}

/// A named set of particles, chosen in the initial configuration.
#[derive(Clone, Debug)]
pub struct Region {
    /// Name in the deck.
    pub name: String,
    /// Only particles of this body, if given.
    pub body: Option<usize>,
    /// Only particles inside this shape, if given.
    pub shape: Option<Shape>,
}
