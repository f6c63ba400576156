//! Tracers and sections.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

tables! {
    /// A particle to follow, or a point to watch: columns `tracer.NAME.FIELD` of `history.csv`.
    RawTracer {
        /// Name of the tracer.
        name: Word, example "tail";
        /// The particle nearest to this point of the initial configuration is followed.
        point: VectorOf<Length>, example ["0 mm", "25 mm"];
        /// Only particles of this body.
        body: Option<Word>, example "bar", otherwise "all";
        /// Stay at the point and interpolate with the kernel (Shepard) instead of following a particle; the cell is empty while no
        /// particle is near.
        fixed: Option<Flag>, example true, default false;
        /// Fields to write, with all their components.
        fields: Option<Vec<Choice<FieldWord>>>, example ["velocity", "stress"], otherwise "position (not if `fixed`), velocity, pressure, von_mises_stress, plastic_strain, temperature";
    }

    /// A plane fixed in space, the force through which is written: columns `section.NAME.normal_force` and `section.NAME.force_x` to
    /// `_z` of `history.csv`. It is what the material ahead of the plane (where the normal points) does to that behind; along the
    /// normal positive in tension: the sum of all forces between particles on either side, contact between bodies among them. What is
    /// behind takes up exactly that and what acts on it from outside, so the section of a bar at rest has the force of its grip,
    /// however far it is stretched. With planes of symmetry it is that of the part that is there.
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
