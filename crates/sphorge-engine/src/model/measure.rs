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

/// Particles a measure is taken over: all conditions must hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleSelection {
    /// Only this body.
    pub body: Option<usize>,
    /// Only this region (by initial position).
    pub region: Option<usize>,
    /// Only particles now inside this axis-aligned box, m.
    pub window: Option<([f64; 3], [f64; 3])>,
}

/// A plate, and the flight of what goes through it.
#[derive(Clone, Debug, PartialEq)]
pub struct Perforation {
    /// Body that is perforated.
    pub plate: usize,
    /// Axis 0, 1, 2 of flight.
    pub axis: usize,
    /// Flight towards larger (+1) or smaller (-1) coordinates.
    pub direction: f64,
    /// A point of the line of flight, m.
    pub point: [f64; 3],
    /// Particles of the plate hang together up to this distance, in spacings of the plate.
    pub link: f64,
}

/// Which edge of a hole is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CraterEdge {
    /// The clear opening.
    Clear,
    /// From crest to crest of the lips on the side the projectile came from.
    EntryLips,
    /// From crest to crest of the lips on the side it left by.
    ExitLips,
}

/// Which extent of a debris cloud is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CloudExtent {
    /// Along the flight, from the back of the plate to the foremost particle.
    Length,
    /// Across the flight.
    Width,
}

/// What is measured of the fragments of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FragmentQuantity {
    /// How many there are.
    Number,
    /// Mass of the heaviest, kg.
    Largest,
    /// Mass of the second heaviest, kg: that of a plug that has left a plate.
    Second,
    /// Mass of the particles of the body that are part of no fragment, kg.
    Loose,
}

/// Kinds of measure.
#[derive(Clone, Debug, PartialEq)]
pub enum MeasureKind {
    /// Extent along an axis, m: between the farthest points of particles, each of which is a ball of one spacing at the start and what its
    /// deformation gradient makes of it then, while its body is in one piece; always that ball in sums over current neighbours.
    Extent {
        /// Which particles.
        selection: ParticleSelection,
        /// Axis 0, 1, 2.
        axis: usize,
    },
    /// Diameter of the section across an axis: twice the distance of the farthest point of a particle from the body's axis line, m; particles are
    /// as large as for the extent.
    Diameter {
        /// Which particles.
        selection: ParticleSelection,
        /// Axis 0, 1, 2 the section is normal to; the line runs through the mean position of the selected particles.
        axis: usize,
    },
    /// Extremum of a field over particles (of the history so far when `over_time`).
    Extreme {
        /// Which particles.
        selection: ParticleSelection,
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
        selection: ParticleSelection,
        /// Field name.
        field: String,
        /// Component.
        component: Option<usize>,
    },
    /// Kernel-interpolated (Shepard) value of a field at a fixed point.
    Value {
        /// Which particles.
        selection: ParticleSelection,
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
        selection: ParticleSelection,
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
        selection: ParticleSelection,
        /// Field name.
        field: String,
        /// Component.
        component: Option<usize>,
    },
    /// Time at which the mean velocity of the selected particles along an axis changes sign, s (contact or rebound time).
    ReversalTime {
        /// Which particles.
        selection: ParticleSelection,
        /// Axis 0, 1, 2.
        axis: usize,
    },
    /// Diameter of the hole in a plate, m.
    CraterDiameter {
        /// The plate and the flight.
        perforation: Perforation,
        /// Which edge.
        edge: CraterEdge,
    },
    /// Extent of the debris behind a plate, m.
    Cloud {
        /// The plate and the flight.
        perforation: Perforation,
        /// Which extent.
        extent: CloudExtent,
        /// Share of the mass of the cloud that is left out at its outer end.
        leave_out: f64,
    },
    /// What hangs together of a body: its particles with integrity, joined up to a distance.
    Fragments {
        /// The body.
        body: usize,
        /// What of them.
        quantity: FragmentQuantity,
        /// Particles hang together up to this distance, in spacings of the body.
        link: f64,
        /// Particles that a fragment has at least.
        least: u64,
    },
}

impl MeasureKind {
    /// Whether pictures can show it as a line on the particles.
    pub fn is_drawn(&self) -> bool {
        match self {
            Self::CraterDiameter { .. } | Self::Cloud { .. } => true,
            Self::Extent { .. }
            | Self::Diameter { .. }
            | Self::Extreme { .. }
            | Self::Mean { .. }
            | Self::Value { .. }
            | Self::FrontSpeed { .. }
            | Self::Period { .. }
            | Self::ReversalTime { .. }
            | Self::Fragments { .. } => false,
        }
    }

    /// Whether it is made of the positions of all particles.
    pub fn needs_positions(&self) -> bool {
        self.is_drawn() || matches!(self, Self::Fragments { .. })
    }
}
