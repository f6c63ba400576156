//! Tracers and sections.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

tables! {
    /// A particle to follow, or a fixed point to observe: columns `tracer.NAME.FIELD` of `history.csv`.
    RawTracer {
        /// Name of the tracer.
        name: Word, example "tail";
        /// The particle nearest to this point of the initial configuration is followed.
        point: VectorOf<Length>, example ["0 mm", "25 mm"];
        /// Only particles of this body.
        body: Option<Word>, example "bar", otherwise "all";
        /// Stay at the point and interpolate with the kernel (Shepard) instead of following a particle; the cell is empty while there is
        /// no particle nearby.
        fixed: Option<Flag>, example true, default false;
        /// Fields to write, with all their components.
        fields: Option<Vec<Choice<FieldWord>>>, example ["velocity", "stress"], otherwise "position (not if `fixed`), velocity, pressure, von_mises_stress, plastic_strain, temperature";
    }

    /// A plane fixed in space through which the force is reported: columns `section.NAME.normal_force` and `section.NAME.force_x` to
    /// `_z` of `history.csv`. It is the force of the material ahead of the plane (where the normal points) on the material behind it:
    /// the sum of all forces between particles on either side, including contact between bodies. The normal force is positive in
    /// tension. It balances exactly the other forces on the material behind and its change of momentum, so a section of a bar at
    /// rest has the force of the grip, however far the bar is stretched. With symmetry planes it is the force in the modelled part.
    RawSection {
        /// Name of the section.
        name: Word, example "waist";
        /// A point of the plane.
        point: VectorOf<Length>, example ["250 mm", "0 mm", "0 mm"];
        /// Normal of the plane, any length.
        normal: VectorOf<Number>, example [1, 0, 0];
        /// Only forces between particles of this body.
        body: Option<Word>, example "bar", otherwise "all";
    }
}
