//! Declared measures.

use super::super::{choice::*, value::*};
use schemars::JsonSchema;
use serde::Deserialize;

/// A number to report: a name and one kind.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawMeasure {
    /// Name of the measure: column of `history.csv`, key in `summary.json`.
    #[schemars(extend("examples" = ["height"]))]
    pub(crate) name: Word,
    /// Particle extent along an axis plus one spacing, m.
    pub(crate) extent: Option<RawAlongAxis>,
    /// Diameter of the section across an axis, m: twice the largest distance from the axis through the mean position, plus
    /// one spacing.
    pub(crate) diameter: Option<RawAlongAxis>,
    /// Largest value of a field.
    pub(crate) maximum: Option<RawExtreme>,
    /// Smallest value of a field.
    pub(crate) minimum: Option<RawExtreme>,
    /// Mean of a field, weighted by mass.
    pub(crate) mean: Option<RawFieldMeasure>,
    /// Kernel-interpolated value of a field at a point.
    pub(crate) value: Option<RawValue>,
    /// Speed of a front: where a field crosses a level, followed over time and fitted by a straight line, m/s.
    pub(crate) front_speed: Option<RawFrontSpeed>,
    /// Period of an oscillation: mean distance of the upward crossings of the mean of a field about its own mean, s.
    pub(crate) period: Option<RawFieldMeasure>,
    /// Time at which the mean velocity along an axis changes sign, s.
    pub(crate) reversal_time: Option<RawAlongAxis>,
    /// Diameter of the hole in a plate, m.
    pub(crate) crater_diameter: Option<RawCrater>,
    /// Length of the debris cloud behind a plate, m: from the undeformed back face to the foremost debris, along the flight.
    pub(crate) cloud_length: Option<RawCloud>,
    /// Width of the debris cloud behind a plate across the flight, m.
    pub(crate) cloud_width: Option<RawCloud>,
}

/// An axis-aligned window in space.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawWindow {
    /// Corner with the smallest coordinates.
    #[schemars(extend("examples" = [["-5 mm", "0 mm"]]))]
    pub(crate) min: VectorOf<Length>,
    /// Corner with the largest coordinates.
    #[schemars(extend("examples" = [["5 mm", "1 mm"]]))]
    pub(crate) max: VectorOf<Length>,
}

/// Which particles a measure looks at.
pub(crate) struct RawProbe<'a> {
    pub(crate) body: Option<&'a Word>,
    pub(crate) region: Option<&'a Word>,
    pub(crate) window: Option<&'a RawWindow>,
}

/// Every kind of measure chooses its particles with the same three keys.
macro_rules! probed {
    ($( $(#[$doc:meta])* $name:ident { $( $(#[$attribute:meta])* $field:ident : $type:ty, )* } )+) => { $(
        $(#[$doc])*
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub(crate) struct $name {
            /// Only particles of this body.
            #[schemars(extend("examples" = ["bar"], "x-default" = "all"))]
            pub(crate) body: Option<Word>,
            /// Only particles of this region.
            #[schemars(extend("examples" = ["left-end"], "x-default" = "all"))]
            pub(crate) region: Option<Word>,
            /// Only particles that are inside this box at the time.
            #[schemars(extend("x-default" = "everywhere"))]
            pub(crate) window: Option<RawWindow>,
            $( $(#[$attribute])* pub(crate) $field: $type, )*
        }
        impl $name {
            pub(crate) fn probe(&self) -> RawProbe<'_> {
                RawProbe { body: self.body.as_ref(), region: self.region.as_ref(), window: self.window.as_ref() }
            }
        }
    )+ };
}

probed! {
    /// A measure along an axis.
    RawAlongAxis {
        /// The axis.
        #[schemars(extend("examples" = ["y"]))]
        axis: Choice<AxisWord>,
    }
    /// A measure of a field.
    RawFieldMeasure {
        /// The field.
        #[schemars(extend("examples" = ["velocity"]))]
        field: Choice<FieldWord>,
        /// Component of a vector or tensor: `x` to `z`, `xx` to `zz`.
        #[schemars(extend("examples" = ["y"], "x-default" = "the magnitude"))]
        component: Option<Word>,
    }
    /// An extremum of a field.
    RawExtreme {
        /// The field.
        #[schemars(extend("examples" = ["temperature"]))]
        field: Choice<FieldWord>,
        /// Component of a vector or tensor: `x` to `z`, `xx` to `zz`.
        #[schemars(extend("examples" = ["y"], "x-default" = "the magnitude"))]
        component: Option<Word>,
        /// Over all rows of the history so far rather than now.
        #[schemars(extend("examples" = [true], "default" = false))]
        over_time: Option<Flag>,
    }
    /// A field at a point.
    RawValue {
        /// The field.
        #[schemars(extend("examples" = ["pressure"]))]
        field: Choice<FieldWord>,
        /// Component of a vector or tensor: `x` to `z`, `xx` to `zz`.
        #[schemars(extend("examples" = ["y"], "x-default" = "the magnitude"))]
        component: Option<Word>,
        /// The point.
        #[schemars(extend("examples" = [["0 mm", "5 mm"]]))]
        point: VectorOf<Length>,
    }
    /// A moving front.
    RawFrontSpeed {
        /// The field that marks the front.
        #[schemars(extend("examples" = ["pressure"]))]
        field: Choice<FieldWord>,
        /// Component of a vector or tensor: `x` to `z`, `xx` to `zz`.
        #[schemars(extend("examples" = ["y"], "x-default" = "the magnitude"))]
        component: Option<Word>,
        /// Axis the front runs along.
        #[schemars(extend("examples" = ["x"]))]
        axis: Choice<AxisWord>,
        /// Value of the field that marks the front, in the unit of the field.
        #[schemars(extend("examples" = ["5 GPa"]))]
        level: FieldLevel,
        /// Whether the outermost crossing on the positive or on the negative side is the front.
        #[schemars(extend("examples" = ["positive"], "default" = "positive"))]
        side: Option<Choice<SideWord>>,
        /// First and last time of the rows used.
        #[schemars(extend("examples" = [["1 us", "4 us"]], "x-default" = "the whole run"))]
        during: Option<VectorOf<Time>>,
    }
}

/// A plate that is perforated, and the flight of the projectile, in every measure of the perforation.
macro_rules! perforation {
    ($( $(#[$doc:meta])* $name:ident { $( $(#[$attribute:meta])* $field:ident : $type:ty, )* } )+) => { $(
        $(#[$doc])*
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub(crate) struct $name {
            /// The plate.
            #[schemars(extend("examples" = ["plate"]))]
            pub(crate) body: Word,
            /// Axis of flight.
            #[schemars(extend("examples" = ["y"]))]
            pub(crate) axis: Choice<AxisWord>,
            /// Whether the flight is towards larger or smaller coordinates.
            #[schemars(extend("examples" = ["negative"], "default" = "positive"))]
            pub(crate) side: Option<Choice<SideWord>>,
            /// A point of the line of flight.
            #[schemars(extend("examples" = [["0 mm", "0 mm"]], "x-default" = "the origin"))]
            pub(crate) point: Option<VectorOf<Length>>,
            /// Particles of the plate hang together up to this distance, in its spacings. What hangs together with a piece of at
            /// least a tenth of the plate's mass is the plate, all else is debris.
            #[schemars(extend("examples" = [1.5], "default" = 1.5))]
            pub(crate) link: Option<Given<Number>>,
            $( $(#[$attribute])* pub(crate) $field: $type, )*
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
        #[schemars(extend("examples" = ["entry-lips"], "default" = "clear"))]
        edge: Option<Choice<EdgeWord>>,
    }
    /// The debris behind a plate: all particles, of any body, that are no longer part of the plate.
    RawCloud {
        /// Share of the mass of the cloud to leave out at its outer end, where a few particles fly alone; 0 to 0.5.
        #[schemars(extend("examples" = [0.01], "default" = 0.0))]
        leave_out: Option<Given<Number>>,
    }
}
