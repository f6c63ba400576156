//! What a picture of particles shall show.

use super::{ColorMap, Condition, FrameChoice, Mirror, Paper, Section, View};

/// A picture of particles; of a problem in one dimension, a curve over x for each frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture {
    /// Field, or a component as in `stress.xy`. A vector or tensor without component is shown by its norm.
    pub field: String,
    /// Frames, side by side at one scale: the first and the last make a before and after.
    pub frames: Vec<FrameChoice>,
    /// Direction of view; the plane of a plane problem, a corner of a solid one if not given.
    pub view: Option<View>,
    /// Leave out what is in front of a plane, to show the inside; the plane in which a plane problem lies is refused.
    pub section: Option<Section>,
    /// Show these bodies alone; all if there are none.
    pub bodies: Vec<String>,
    /// Show the particles alone that meet all of these.
    pub conditions: Vec<Condition>,
    /// Show the images of particles in these planes of symmetry of the deck, too.
    pub mirror: Option<Mirror>,
    /// Show the crater and cloud measures of the deck as lines on the particles, in views along an axis.
    pub measures: bool,
    /// Values of the ends of the colour bar (or the upright axis). If not given: the extremes shown, or where a few outliers stretch them by half
    /// or more, the range of 99 % of the particles; arrows at the bar then give the extremes.
    pub range: Option<(f64, f64)>,
    /// Colours; viridis, or diverging where values of both signs matter, if not given.
    pub color_map: Option<ColorMap>,
    /// Part of the plane of view to show, right then up, m; all if not given.
    pub window: Option<[(f64, f64); 2]>,
    /// Hundredths of an inch across and down, which are pixels at 100 to the inch; to fit if not given.
    pub size: Option<(u32, u32)>,
    /// Title; that of the deck if not given.
    pub title: Option<String>,
    /// Fineness, and the width where `size` is not given.
    pub paper: Paper,
}

impl FieldPicture {
    /// The last frame, everything else as it fits.
    pub fn new(field: impl Into<String>) -> Self {
        Self {
            field: field.into(),
            frames: vec![FrameChoice::Last],
            view: None,
            section: None,
            bodies: Vec::new(),
            conditions: Vec::new(),
            mirror: None,
            measures: false,
            range: None,
            color_map: None,
            window: None,
            size: None,
            title: None,
            paper: Paper::default(),
        }
    }
}
