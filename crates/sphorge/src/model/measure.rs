//! Numbers a deck asks for.

/// A declared measure: a column of the history and an entry of the summary.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Name in the deck, column name in `history.csv`, key in `summary.json`.
    pub name: String,
    /// What is measured.
    pub kind: MeasureKind,
}

/// Which extremum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extremum {
    /// Largest value.
    Maximum,
    /// Smallest value.
    Minimum,
}

/// Particles a measure looks at: all conditions must hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Probe {
    /// Only this body.
    pub body: Option<usize>,
    /// Only this region (by initial position).
    pub region: Option<usize>,
    /// Only particles now inside this axis-aligned box, m.
    pub window: Option<([f64; 3], [f64; 3])>,
}

/// Kinds of measure.
#[derive(Clone, Debug, PartialEq)]
pub enum MeasureKind {
    /// Particle extent along an axis plus one spacing, m.
    Extent {
        /// Which particles.
        probe: Probe,
        /// Axis 0, 1, 2.
        axis: usize,
    },
    /// Diameter of the section across an axis: twice the largest distance from the body's axis line plus one spacing, m.
    Diameter {
        /// Which particles.
        probe: Probe,
        /// Axis 0, 1, 2 the section is normal to; the line runs through the mean position of the probed particles.
        axis: usize,
    },
    /// Extremum of a field over particles (of the history so far when `over_time`).
    Extreme {
        /// Which particles.
        probe: Probe,
        /// Field name; vectors by magnitude unless `component` is given.
        field: String,
        /// Component of a vector or tensor field.
        component: Option<usize>,
        /// Maximum or minimum.
        extremum: Extremum,
        /// Over all history samples rather than now.
        over_time: bool,
    },
    /// Mass-weighted mean of a field (residual velocity: `velocity`, a component).
    Mean {
        /// Which particles.
        probe: Probe,
        /// Field name.
        field: String,
        /// Component.
        component: Option<usize>,
    },
    /// Kernel-interpolated (Shepard) value of a field at a fixed point.
    Value {
        /// Which particles.
        probe: Probe,
        /// Field name.
        field: String,
        /// Component.
        component: Option<usize>,
        /// The point, m.
        point: [f64; 3],
    },
    /// Speed of a front: the position along `axis` where the field (averaged in slabs of one spacing) crosses
    /// `level`, fitted by a straight line over the history samples in the time window, m/s.
    FrontSpeed {
        /// Which particles.
        probe: Probe,
        /// Field name.
        field: String,
        /// Component.
        component: Option<usize>,
        /// Axis 0, 1, 2 the front runs along.
        axis: usize,
        /// Field value that marks the front.
        level: f64,
        /// The front is the outermost crossing on the positive (+1) or negative (-1) side.
        direction: f64,
        /// Samples used, s.
        window: (f64, f64),
    },
    /// Period of a measured oscillation: mean distance of upward zero crossings of the mean of a field component about
    /// its own mean, s.
    Period {
        /// Which particles.
        probe: Probe,
        /// Field name.
        field: String,
        /// Component.
        component: Option<usize>,
    },
    /// Time at which the mean velocity of the probed particles along an axis changes sign, s (contact or rebound time).
    ReversalTime {
        /// Which particles.
        probe: Probe,
        /// Axis 0, 1, 2.
        axis: usize,
    },
}
