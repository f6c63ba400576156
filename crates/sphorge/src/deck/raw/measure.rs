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
