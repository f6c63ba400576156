//! Tracers and sections.

use super::{Names, measure::Scene, shape::direction, vector};
use crate::deck::defaults;
use crate::deck::raw::{RawSection, RawTracer};
use crate::deck::report::{Fault, Problems};
use crate::deck::value::Word;
use crate::model::{Section, Tracer};

/// All tracers of a deck.
pub(crate) fn tracers(raw: &[RawTracer], scene: &Scene<'_>, problems: &mut Problems) -> Option<Vec<Tracer>> {
    Names::collect("tracer", raw.iter().map(|t| &t.name), problems);
    let read: Vec<_> = raw.iter().map(|t| tracer(t, scene, problems)).collect();
    read.into_iter().collect()
}

/// All sections of a deck.
pub(crate) fn sections(raw: &[RawSection], scene: &Scene<'_>, problems: &mut Problems) -> Option<Vec<Section>> {
    Names::collect("section", raw.iter().map(|s| &s.name), problems);
    let read: Vec<_> = raw.iter().map(|s| section(s, scene, problems)).collect();
    read.into_iter().collect()
}

fn of_body(body: Option<&Word>, scene: &Scene<'_>, problems: &mut Problems) -> Option<Option<usize>> {
    body.map_or(Some(None), |b| scene.bodies.find(b, problems).map(Some))
}

fn tracer(raw: &RawTracer, scene: &Scene<'_>, problems: &mut Problems) -> Option<Tracer> {
    let name = raw.name.text(problems).map(str::to_owned);
    let point = vector(&raw.point, scene.dimensions, problems);
    let body = of_body(raw.body.as_ref(), scene, problems);
    let is_fixed = raw.fixed.as_ref().map_or(Some(false), |f| f.get(problems));
    let fields = match &raw.fields {
        Some(given) => {
            let fields: Vec<_> = given.iter().map(|field| field.get(problems)).collect();
            if given.is_empty() {
                problems.push(Fault::new(
                    "empty-list",
                    "a tracer needs a field to write",
                    raw.name.span(),
                    "writes nothing",
                ));
            }
            fields.into_iter().map(|field| field.map(|f| f.name.to_owned())).collect::<Option<Vec<_>>>()
        }
        None => {
            let usual = defaults::TRACER_FIELDS.iter().filter(|field| **field != "position" || is_fixed != Some(true));
            Some(usual.map(|field| (*field).to_owned()).collect())
        }
    };
    Some(Tracer { name: name?, point: point?, body: body?, is_fixed: is_fixed?, fields: fields? })
}

fn section(raw: &RawSection, scene: &Scene<'_>, problems: &mut Problems) -> Option<Section> {
    let name = raw.name.text(problems).map(str::to_owned);
    let point = vector(&raw.point, scene.dimensions, problems);
    let normal = direction(&raw.normal, "normal", scene.dimensions, problems);
    let body = of_body(raw.body.as_ref(), scene, problems);
    Some(Section { name: name?, point: point?, normal: normal?, body: body? })
}
