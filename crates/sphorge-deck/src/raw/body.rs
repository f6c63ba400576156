//! Bodies and regions.

use super::super::declare::tables;
use super::super::{choice::*, value::*};
use super::RawShape;

tables! {
    /// A body of particles.
    RawBody {
        /// Name of the body: letters, digits, `-` and `_`.
        name: Word, example "bar";
        /// A material of the deck or of the catalogue.
        material: Word, example "armco-iron";
        /// Shape in the initial configuration.
        shape: RawShape;
        /// Initial velocity.
        velocity: Option<VectorOf<Velocity>>, example ["0 m/s", "-200 m/s"], otherwise "at rest";
        /// Initial rotation, added to the velocity.
        spin: Option<RawSpin>;
        /// Initial velocity linear in space, added to the velocity.
        velocity_gradient: Option<RawVelocityGradient>;
        /// Initial velocity as a table along an axis, added to the velocity.
        velocity_profile: Option<RawVelocityProfile>;
        /// Initial outward velocity as a table of the radius, added to the velocity.
        radial_velocity: Option<RawRadialVelocity>;
        /// Initial temperature. The body starts at rest: with the density of zero pressure at this temperature, by the pressure law and the specific
        /// heat of its material.
        temperature: Option<Given<Temperature>>, example "20 degC", otherwise "the material's `reference-temperature`";
        /// Particle spacing of this body.
        spacing: Option<Given<Length>>, example "0.3 mm", otherwise "that of `particles`";
        /// Smoothing length over spacing of this body.
        smoothing: Option<Given<Number>>, example 1.2, otherwise "that of `particles`";
        /// Arrangement of the particles of this body.
        lattice: Option<Choice<ArrangementWord>>, example "rings", otherwise "that of `particles`";
        /// Placement of the square or cubic lattice in this body.
        placement: Option<Choice<PlacementWord>>, example "on-faces", otherwise "that of `particles`";
    }

    /// Rigid rotation of the initial velocity.
    RawSpin {
        /// Angular velocity: three components, or in plane strain the one about z.
        rate: ScalarOr<Given<AngularVelocity>, Vec<Given<AngularVelocity>>>, example "1200 rpm";
        /// Centre of the rotation.
        centre: Option<VectorOf<Length>>, example ["0 mm", "0 mm"], otherwise "the origin";
    }

    /// Initial velocity linear in space.
    RawVelocityGradient {
        /// One row per component of the velocity: how it changes along each axis.
        rows: Vec<VectorOf<Rate>>, example [["0 /s", "1000 /s"], ["0 /s", "0 /s"]];
        /// Where this velocity is zero.
        centre: Option<VectorOf<Length>>, example ["0 mm", "0 mm"], otherwise "the origin";
    }

    /// Initial velocity that varies along an axis, such as the shape of a mode of vibration.
    RawVelocityProfile {
        /// The axis.
        along: Choice<AxisWord>, example "x";
        /// Velocity where the table says 1.
        amplitude: VectorOf<Velocity>, example ["0 m/s", "0.57 m/s"];
        /// Rows of coordinate on the axis and share of the amplitude, with increasing coordinates: linear between rows, constant outside.
        rows: Vec<(Given<Length>, Given<Number>)>, example [["0 mm", 0.0], ["200 mm", 1.0]];
    }

    /// Initial velocity away from a centre or a line, such as that of an expanding ring or shell.
    RawRadialVelocity {
        /// Centre, or a point of the line.
        centre: Option<VectorOf<Length>>, example ["0 mm", "0 mm"], otherwise "the origin";
        /// In three dimensions: away from the line along this axis through the centre.
        axis: Option<Choice<AxisWord>>, example "z", otherwise "away from the centre itself";
        /// Rows of radius and velocity (positive outwards), with increasing radii: linear between rows, constant outside.
        rows: Vec<(Given<Length>, Given<Velocity>)>, example [["20 mm", "120 m/s"], ["24 mm", "100 m/s"]];
    }

    /// A named set of particles, selected in the initial configuration by `body`, `shape` or both.
    RawRegion {
        /// Name of the region.
        name: Word, example "left-end";
        /// Only particles of this body.
        body: Option<Word>, example "bar", otherwise "all bodies";
        /// Only particles inside this shape or on its surface.
        shape: Option<RawShape>;
    }
}
