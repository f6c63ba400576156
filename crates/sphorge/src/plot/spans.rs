//! Measures of holes and clouds as dimension lines on the particles.

use super::{
    PlotError,
    canvas::{Anchor, Area, Canvas, INK},
    color::Rgb,
};
use crate::{
    deck::load_model,
    measures::span,
    model::Model,
    number::quantity,
    output::{FrameFile, RunDirectory},
    particles::Particles,
};

/// A measured length in a frame.
#[derive(Clone, Debug)]
pub(super) struct NamedSpan {
    name: String,
    length: f64,
    /// m.
    ends: [[f64; 3]; 2],
}

/// The model of a run, for its measures.
pub(super) fn model_of(run: &RunDirectory) -> Result<Model, PlotError> {
    let model = load_model(&run.deck()).map_err(PlotError::Deck)?;
    if model.measures.iter().any(|measure| measure.kind.is_drawn()) {
        return Ok(model);
    }
    Err(PlotError::Empty { reason: "the deck has no crater-diameter, cloud-length or cloud-width".into() })
}

/// What the measures of a model find in a frame.
pub(super) fn spans(model: &Model, frame: &mut FrameFile) -> Result<Vec<NamedSpan>, PlotError> {
    let positions = frame.positions()?;
    let body = frame.column("body")?.map(|column| column.values);
    let mut particles = Particles::new(positions.len());
    for (i, position) in positions.into_iter().enumerate() {
        let body = body.as_ref().map_or(0, |bodies| bodies[i] as usize).min(model.bodies.len() - 1);
        let of = &model.bodies[body];
        particles.position[i] = position;
        particles.body[i] = body as u32;
        particles.mass[i] = model.materials[of.material].density * of.spacing.powi(model.dimensions.count() as i32);
    }
    let found = model.measures.iter().filter_map(|measure| {
        let span = span(&measure.kind, model, &particles)?;
        Some(NamedSpan { name: measure.name.clone(), length: span.length, ends: span.ends })
    });
    Ok(found.collect())
}

const SIZE: f64 = 13.0;
const TICK: f64 = 7.0;
/// Pixels from a line too short for its label to the label.
const LEADER: f64 = 48.0;
const PAPER: Rgb = [255, 255, 255];

/// Draws spans and, on top of all lines, their names and lengths; `place` puts a point of space on the page.
pub(super) fn draw_spans(canvas: &mut Canvas, spans: &[NamedSpan], place: impl Fn([f64; 3]) -> (f64, f64)) {
    for span in spans {
        let [from, to] = span.ends.map(&place);
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        if length < 1.0 {
            continue;
        }
        let across = ((from.1 - to.1) / length * TICK, (to.0 - from.0) / length * TICK);
        for (width, color) in [(5.0, PAPER), (2.0, INK)] {
            canvas.line(from, to, width, color);
            for end in [from, to] {
                canvas.line((end.0 - across.0, end.1 - across.1), (end.0 + across.0, end.1 + across.1), width, color);
            }
        }
    }
    for span in spans {
        let [from, to] = span.ends.map(&place);
        let text = format!("{} {}", span.name.replace('_', " "), quantity(span.length, "m"));
        let width = Canvas::text_width(&text, SIZE) + 10.0;
        // Off the middle, where a line along and one across are likely to cross.
        let share = if (to.0 - from.0).abs() < (to.1 - from.1).abs() { 0.4 } else { 0.5 };
        let (x, mut y) = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
        if (to.0 - from.0).abs() > (to.1 - from.1).abs() && (to.0 - from.0).abs() < width + 30.0 {
            canvas.line((x, y), (x, y - LEADER), 1.0, INK);
            y -= LEADER;
        }
        canvas.fill(Area { x: x - 0.5 * width, y: y - 0.75 * SIZE, width, height: 1.5 * SIZE }, PAPER);
        canvas.text((x, y + 0.36 * SIZE), SIZE, Anchor::Centre, INK, &text);
    }
}
