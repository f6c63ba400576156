//! How many of its things a deck can have. Most cost time in every step, columns in every row of the history, or both: more than
//! these are a slip of a script, and would be waited for in vain.

use crate::fault::{Fault, Problems};
use crate::raw::{RawDeck, RawMotion};
use sphorge_engine::geometry::MAX_REGIONS;
use std::ops::Range;

/// Bodies: each pair of them has a contact of its own, and each body a dozen columns.
pub(crate) const BODIES: usize = 1000;
const WALLS: usize = 1000;
/// Regions along three axes: more drive something twice.
const MOTIONS: usize = 3 * MAX_REGIONS;
/// Two sides of three axes: more hold the same side.
const SYMMETRY_PLANES: usize = 6;
const MEASURES: usize = 1000;
const TRACERS: usize = 1000;
const SECTIONS: usize = 1000;
const HEAT_BOUNDARIES: usize = 1000;
const MATERIALS: usize = 10_000;
/// Parts of a shape: every place of its lattice is asked for in each.
pub(crate) const PARTS: usize = 1000;
/// Points of the outline of a shape.
pub(crate) const OUTLINE: usize = 10_000;

/// Reports what a deck has too many of, and says whether it has.
pub(crate) fn exceeds(raw: &RawDeck, problems: &mut Problems) -> bool {
    let boundaries = raw.thermal.as_ref().map_or(&[][..], |thermal| &thermal.boundary);
    let motion = |motion: &RawMotion| motion.region.span();
    let body = "combine several bodies into one by a `union`, or use particles from a file";
    let counts = [
        check(raw.body.iter().map(|b| b.name.span()), BODIES, "bodies", body, problems),
        check(raw.region.iter().map(|r| r.name.span()), MAX_REGIONS, "regions", "", problems),
        check(raw.wall.iter().map(|w| w.name.span()), WALLS, "walls", "", problems),
        check(raw.motion.iter().map(motion), MOTIONS, "motions", "", problems),
        check(raw.symmetry.iter().map(|s| s.axis.span()), SYMMETRY_PLANES, "symmetry planes", "", problems),
        check(raw.measure.iter().map(|m| m.name.span()), MEASURES, "measures", "", problems),
        check(raw.tracer.iter().map(|t| t.name.span()), TRACERS, "tracers", "", problems),
        check(raw.section.iter().map(|s| s.name.span()), SECTIONS, "sections", "", problems),
        check(boundaries.iter().map(|b| b.name.span()), HEAT_BOUNDARIES, "heat boundaries", "", problems),
        check(raw.material.0.iter().map(|(name, _)| name.span()), MATERIALS, "materials", "", problems),
    ];
    counts.contains(&true)
}

/// Reports the first of too many.
fn check(
    places: impl ExactSizeIterator<Item = Range<usize>>,
    most: usize,
    what: &str,
    help: &str,
    problems: &mut Problems,
) -> bool {
    let count = places.len();
    let Some(extra) = places.into_iter().nth(most) else { return false };
    let message = format!("a deck can have {most} {what}, this one has {count}");
    let fault = Fault::new("too-many", message, extra, "one too many");
    problems.push(if help.is_empty() { fault } else { fault.help(help) });
    true
}
