//! Declared measures.

use super::super::declare::tables;
use super::super::{choice::*, scalar::Scalar, value::*};

tables! {
    /// A number to report: a name and exactly one kind.
    RawMeasure {
        /// Name of the measure: column of `history.csv`, key in `summary.json`.
        name: Word, example "height";
        /// Extent along an axis, m, between the outermost points of the particles. These are half a spacing from the centres; in the total
        /// Lagrangian form they deform with the body until it comes apart.
        extent: Option<RawAlongAxis>;
        /// Diameter of the section across an axis, m: twice the largest distance of a point of a particle, as for `extent`, from the axis through
        /// the mean position. In plane strain this is the diameter of a disc for `z` and a width for `x` or `y`.
        diameter: Option<RawAlongAxis>;
        /// Largest value of a field at the centres of the particles. That of `position` is half a spacing inside of the face that `extent`
        /// measures to.
        maximum: Option<RawExtreme>;
        /// Smallest value of a field at the centres of the particles, as for `maximum`.
        minimum: Option<RawExtreme>;
        /// Mean of a field, weighted by mass.
        mean: Option<RawFieldMeasure>;
        /// Value of a field at a point, interpolated with the kernel.
        value: Option<RawValue>;
        /// Speed of a front: where a field crosses a level, followed over time and fitted by a straight line, m/s.
        front_speed: Option<RawFrontSpeed>;
        /// Period of an oscillation, s: mean time between the upward crossings of the mean of a field through its own mean value.
        period: Option<RawFieldMeasure>;
        /// Time at which the mean velocity along an axis changes sign, s.
        reversal_time: Option<RawAlongAxis>;
        /// Diameter of the hole in a plate, m.
        crater_diameter: Option<RawCrater>;
        /// Length of the debris cloud behind a plate, m: from the undeformed back face to the foremost debris, along the flight.
        cloud_length: Option<RawCloud>;
        /// Width of the debris cloud behind a plate across the flight, m.
        cloud_width: Option<RawCloud>;
        /// Fragments of a body: what hangs together of its particles that have some integrity. Their number, or a mass, kg; kg/m in plane strain, kg/m^2 in one dimension.
        fragments: Option<RawFragments>;
    }

    /// Fragments of a body.
    RawFragments {
        /// The body.
        body: Word, example "plate";
        /// What of them.
        of: Option<Choice<FragmentWord>>, example "second", default "number";
        /// Particles hang together up to this distance, in spacings of the body; that before the deformation, but in the updated Lagrangian methods.
        link: Option<Given<Number>>, example 1.5, default 1.5;
        /// Particles that a fragment has at least.
        least: Option<Count>, example 20, default 10;
    }

    /// An axis-aligned window in space.
    RawWindow {
        /// Corner with the smallest coordinates.
        min: VectorOf<Length>, example ["-5 mm", "0 mm"];
        /// Corner with the largest coordinates.
        max: VectorOf<Length>, example ["5 mm", "1 mm"];
    }
}

/// Which particles a measure looks at.
pub(crate) struct RawSelection<'a> {
    pub(crate) body: Option<&'a Word>,
    pub(crate) region: Option<&'a Word>,
    pub(crate) window: Option<&'a RawWindow>,
}

/// Every kind of measure chooses its particles with the same three keys.
macro_rules! selected {
    ($( $(#[doc = $comment:literal])* $name:ident { $($own:tt)* } )+) => { $(
        tables! {
            $(#[doc = $comment])*
            $name {
                /// Only particles of this body.
                body: Option<Word>, example "bar", otherwise "all";
                /// Only particles of this region.
                region: Option<Word>, example "left-end", otherwise "all";
                /// Only particles that are currently inside this box.
                window: Option<RawWindow>, otherwise "everywhere";
                $($own)*
            }
        }
        impl $name {
            pub(crate) fn selection(&self) -> RawSelection<'_> {
                RawSelection { body: self.body.as_ref(), region: self.region.as_ref(), window: self.window.as_ref() }
            }
        }
    )+ };
}

selected! {
    /// A measure along an axis.
    RawAlongAxis {
        /// The axis.
        axis: Choice<AxisWord>, example "y";
    }
    /// A measure of a field.
    RawFieldMeasure {
        /// The field.
        field: Choice<FieldWord>, example "velocity";
        /// Component of a vector or tensor: `x` to `z`, `xx` to `zz`.
        component: Option<Word>, example "y", otherwise "the magnitude";
    }
    /// An extremum of a field.
    RawExtreme {
        /// The field.
        field: Choice<FieldWord>, example "temperature";
        /// Component of a vector or tensor: `x` to `z`, `xx` to `zz`.
        component: Option<Word>, example "y", otherwise "the magnitude";
        /// Extremum over all rows of the history so far instead of the current value.
        over_time: Option<Flag>, example true, default false;
    }
    /// A field at a point.
    RawValue {
        /// The field.
        field: Choice<FieldWord>, example "pressure";
        /// Component of a vector or tensor: `x` to `z`, `xx` to `zz`.
        component: Option<Word>, example "y", otherwise "the magnitude";
        /// The point.
        point: VectorOf<Length>, example ["0 mm", "5 mm"];
    }
    /// A moving front.
    RawFrontSpeed {
        /// The field that marks the front.
        field: Choice<FieldWord>, example "pressure";
        /// Component of a vector or tensor: `x` to `z`, `xx` to `zz`.
        component: Option<Word>, example "y", otherwise "the magnitude";
        /// Axis along which the front moves.
        axis: Choice<AxisWord>, example "x";
        /// Value of the field that marks the front, in the unit of the field.
        level: Scalar, example "5 GPa";
        /// Whether the outermost crossing on the positive or on the negative side is the front.
        side: Option<Choice<SideWord>>, example "positive", default "positive";
        /// First and last time of the rows used.
        during: Option<VectorOf<Time>>, example ["1 us", "4 us"], otherwise "the whole run";
    }
}

/// A plate that is perforated, and the flight of the projectile, in every measure of the perforation.
macro_rules! perforation {
    ($( $(#[doc = $comment:literal])* $name:ident { $($own:tt)* } )+) => { $(
        tables! {
            $(#[doc = $comment])*
            $name {
                /// The plate.
                body: Word, example "plate";
                /// Axis of flight.
                axis: Choice<AxisWord>, example "y";
                /// Whether the flight is towards larger or smaller coordinates.
                side: Option<Choice<SideWord>>, example "negative", default "positive";
                /// A point on the line of flight.
                point: Option<VectorOf<Length>>, example ["0 mm", "0 mm"], otherwise "the origin";
                /// Particles of the plate are connected up to this distance, in its spacings. Connected pieces of at least a tenth of
                /// the plate's mass are the plate, everything else is debris.
                link: Option<Given<Number>>, example 1.5, default 1.5;
                $($own)*
            }
        }
        impl $name {
            pub(crate) fn perforation(&self) -> RawPerforation<'_> {
                RawPerforation {
                    body: &self.body,
                    axis: &self.axis,
                    side: self.side.as_ref(),
                    point: self.point.as_ref(),
                    link: self.link.as_ref(),
                }
            }
        }
    )+ };
}

/// The plate and the flight of a measure.
pub(crate) struct RawPerforation<'a> {
    pub(crate) body: &'a Word,
    pub(crate) axis: &'a Choice<AxisWord>,
    pub(crate) side: Option<&'a Choice<SideWord>>,
    pub(crate) point: Option<&'a VectorOf<Length>>,
    pub(crate) link: Option<&'a Given<Number>>,
}

perforation! {
    /// The hole in a plate.
    RawCrater {
        /// Which edge of the hole is measured.
        edge: Option<Choice<EdgeWord>>, example "entry-lips", default "clear";
    }
    /// The debris behind a plate: all particles, of any body, that are no longer part of the plate.
    RawCloud {
        /// Share of the mass of the cloud to leave out at its outer end, where there are only single particles; 0 to 0.5.
        leave_out: Option<Given<Number>>, example 0.01, default 0.0;
    }
}
