//! Measures of holes and clouds as dimension lines on the particles.

use super::{
    PlotError,
    clip::clip_line,
    font::text_width,
    page::{Anchor, Area, INK, Page, WHITE},
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
/// Units from a line too short for its label to the label.
const LEADER: f64 = 48.0;

/// Draws spans and, on top of all lines, their names and lengths inside an area of the page; `place` puts a point of space
/// on the page.
pub(super) fn draw_spans(page: &mut Page, area: Area, spans: &[NamedSpan], place: impl Fn([f64; 3]) -> (f64, f64)) {
    for span in spans {
        let [from, to] = span.ends.map(&place);
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        if length < 1.0 {
            continue;
        }
        let across = ((from.1 - to.1) / length * TICK, (to.0 - from.0) / length * TICK);
        for (width, color) in [(5.0, WHITE), (2.0, INK)] {
            let ends =
                [from, to].map(|end| [(end.0 - across.0, end.1 - across.1), (end.0 + across.0, end.1 + across.1)]);
            for line in [[from, to], ends[0], ends[1]] {
                if let Some([from, to]) = clip_line(line, area) {
                    page.line(from, to, width, color);
                }
            }
        }
    }
    let mut taken: Vec<Area> = Vec::new();
    for span in spans {
        let [from, to] = span.ends.map(&place);
        let text = format!("{} {}", span.name.replace('_', " "), quantity(span.length, "m"));
        // Off the middle, where a line along and one across are likely to cross.
        let lies = (to.0 - from.0).abs() > (to.1 - from.1).abs();
        let share = if lies { 0.5 } else { 0.4 };
        let foot = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
        let width = text_width(&text, SIZE) + 10.0;
        let short = lies && (to.0 - from.0).abs() < width + 30.0;
        let at = free_place(foot, (width, 1.5 * SIZE), if short { -LEADER } else { 0.0 }, area, &taken);
        let middle = (at.x + 0.5 * at.width, at.y + 0.5 * at.height);
        if !at.contains(foot) {
            page.line(foot, middle, 1.0, INK);
        }
        page.fill(at, WHITE);
        page.text((middle.0, middle.1 + 0.36 * SIZE), SIZE, Anchor::Centre, &text);
        taken.push(at);
    }
}

/// The place for a label of a size nearest to where it is wanted, `shift` below its point: inside the area and clear of others, as
/// far as there is one.
fn free_place(foot: (f64, f64), size: (f64, f64), shift: f64, area: Area, taken: &[Area]) -> Area {
    let at = |dy: f64| Area {
        x: (foot.0 - 0.5 * size.0).min(area.right() - size.0).max(area.x),
        y: (foot.1 + dy - 0.5 * size.1).min(area.bottom() - size.1).max(area.y),
        width: size.0,
        height: size.1,
    };
    let steps = (0..40).flat_map(|k| [-1.0, 1.0].map(|side| at(shift + 0.5 * f64::from(k) * side * size.1)));
    let mut places = steps.filter(|place| !taken.iter().any(|other| other.meets(place)));
    places.next().unwrap_or(at(shift))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{page::misplaced, paper::Paper};

    #[test]
    fn labels_of_measures_stay_apart_and_inside() {
        let span = |name: &str, x: f64| NamedSpan {
            name: name.to_owned(),
            length: 0.0302,
            ends: [[x, 0.0, 0.0], [x + 0.01, 0.0, 0.0]],
        };
        let spans = ["crater_diameter", "cloud_length", "cloud_width", "d"].map(|name| span(name, 0.0));
        let spans: Vec<_> = spans.into_iter().chain([span("far", 5.0)]).collect();
        let mut page = Page::new(300.0, 200.0, Paper::default()).unwrap();
        let area = Area { x: 10.0, y: 10.0, width: 250.0, height: 150.0 };
        draw_spans(&mut page, area, &spans, |p| (20.0 + 1e3 * p[0], 150.0));
        assert_eq!(misplaced(&page), Vec::<String>::new());
        let inside = |a: Area| area.contains((a.x, a.y)) && area.contains((a.right(), a.bottom()));
        assert!(page.texts().count() == 5 && page.texts().all(|text| inside(text.area())));
    }
}
