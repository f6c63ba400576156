//! Shapes.

use super::super::declare::tables;
use super::super::{value::*, written::Spanned};

tables! {
    /// One solid, or several combined by `union`, `difference` or `intersection`; rotated and then shifted. Every part is a shape
    /// like this one, with its own `rotate` and `shift`, and can be a combination itself; at most 1000 parts each.
    RawShape {
        /// Box along the axes; an interval in one dimension.
        cuboid as "box": Option<RawBox>;
        /// Disc or ring, in plane strain.
        disc: Option<RawBall>;
        /// Sphere or hollow sphere, in three dimensions.
        sphere: Option<RawBall>;
        /// Round cylinder or tube, in three dimensions.
        cylinder: Option<RawCylinder>;
        /// Bar turned on a lathe: stepped, conical or waisted; in plane strain a plate of this outline.
        revolution: Option<RawRevolution>;
        /// Round bar with an ogive nose, as bullets have; in plane strain a plate of this outline.
        ogive: Option<RawOgive>;
        /// Area inside a closed polygon, in plane strain.
        polygon: Option<RawPolygon>;
        /// Particles from a file; the whole shape of a body.
        table: Option<RawTable>;
        /// The volume inside any of these shapes.
        union: Option<Vec<Spanned<RawShape>>>, otherwise "none";
        /// The volume inside the first of these shapes and outside all others.
        difference: Option<Vec<Spanned<RawShape>>>, otherwise "none";
        /// The volume inside all of these shapes.
        intersection: Option<Vec<Spanned<RawShape>>>, otherwise "none";
        /// Rotation, done before the shift.
        rotate: Option<RawRotate>;
        /// Translation.
        shift: Option<VectorOf<Length>>, example ["5 mm", "0 mm"], otherwise "none";
    }

    /// Two opposite corners.
    RawBox {
        /// Corner with the smallest coordinates.
        min: VectorOf<Length>, example ["-3.8 mm", "0 mm"];
        /// Corner with the largest coordinates.
        max: VectorOf<Length>, example ["3.8 mm", "25.46 mm"];
    }

    /// Centre and radius.
    RawBall {
        /// Centre.
        centre: VectorOf<Length>, example ["0 mm", "10 mm"];
        /// Radius.
        radius: Given<Length>, example "5 mm";
        /// Radius of a hole.
        inner_radius: Option<Given<Length>>, example "3 mm", otherwise "no hole";
    }

    /// Axis and radius.
    RawCylinder {
        /// Centre of one end.
        from: VectorOf<Length>, example ["0 mm", "0 mm", "0 mm"];
        /// Centre of the other end.
        to: VectorOf<Length>, example ["0 mm", "0 mm", "25.46 mm"];
        /// Radius.
        radius: Given<Length>, example "3.8 mm";
        /// Radius of a hole.
        inner_radius: Option<Given<Length>>, example "3 mm", otherwise "no hole";
    }

    /// Solid between an axis and a profile rotated about it.
    RawRevolution {
        /// Point of the axis from which axial distances are measured.
        from: Option<VectorOf<Length>>, example ["0 mm", "0 mm", "0 mm"], otherwise "the origin";
        /// Direction of the axis, any length.
        axis: VectorOf<Number>, example [1, 0, 0];
        /// Axial distance and radius, point by point along the axis, with straight lines between them. Two points at the same axial distance make a step.
        profile: Vec<VectorOf<Length>>, example [["0 mm", "75 mm"], ["200 mm", "75 mm"], ["225 mm", "50 mm"]];
    }

    /// Round bar with a tangent ogive: the outline of the nose is an arc of a circle that leaves the bar without a kink.
    RawOgive {
        /// Centre of the flat end.
        from: VectorOf<Length>, example ["0 mm", "0 mm", "0 mm"];
        /// Tip.
        to: VectorOf<Length>, example ["0 mm", "0 mm", "261 mm"];
        /// Radius of the bar.
        radius: Given<Length>, example "15 mm";
        /// Length of the nose, at least the radius, which makes it a hemisphere; or `head-radius`.
        nose_length: Option<Given<Length>>, example "75 mm", otherwise "from `head-radius`";
        /// Radius of the arc of the nose; or `nose-length`. The length then is sqrt(radius (2 head-radius - radius)).
        head_radius: Option<Given<Length>>, example "90 mm", otherwise "from `nose-length`";
    }

    /// Area inside a closed line.
    RawPolygon {
        /// Corners in order, at least three, at most 10000; the last is joined to the first. The line must not cross itself.
        corners: Vec<VectorOf<Length>>, example [["0 mm", "0 mm"], ["10 mm", "0 mm"], ["0 mm", "5 mm"]];
    }

    /// Particles from a CSV file. The first line names the columns: `x` and, depending on the dimensions of the deck, `y` and `z`;
    /// optionally `mass` or `volume` of each particle (the default volume is the spacing to the power of the dimensions); optionally the
    /// velocity `vx`, `vy`, `vz`, to which that of the body is added. Of axes that the deck does not have, all numbers must
    /// be zero. Other columns are ignored; lines that begin with `#` are comments.
    RawTable {
        /// The file; its path is relative to the folder of the deck.
        file: Word, example "bar.csv";
        /// Unit of the coordinates.
        length_unit: Option<Word>, example "mm", default "m";
        /// Unit of the velocities.
        velocity_unit: Option<Word>, example "km/s", default "m/s";
        /// Unit of the masses; in plane strain per length, in one dimension per area.
        mass_unit: Option<Word>, example "mg", otherwise "kg, kg/m, kg/m^2";
        /// Unit of the volumes; of areas in plane strain, of lengths in one dimension.
        volume_unit: Option<Word>, example "mm^3", otherwise "m^3, m^2, m";
    }

    /// Rotation by the right-hand rule.
    RawRotate {
        /// Direction of the axis, any length; three components. In plane strain it is z and may be left out.
        axis: Option<VectorOf<Number>>, example [0, 0, 1], otherwise "z in plane strain";
        /// Angle.
        angle: Given<Angle>, example "30 deg";
        /// A point on the axis.
        about: Option<VectorOf<Length>>, example ["0 mm", "10 mm"], otherwise "the origin";
    }
}
