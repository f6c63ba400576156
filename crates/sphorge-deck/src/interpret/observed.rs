//! Tracers and sections.

use super::{Names, measure::Scene, shape::direction, vector};
use crate::choice::FieldWord;
use crate::defaults;
use crate::fault::{Fault, Problems};
use crate::raw::{RawSection, RawTracer};
use crate::value::{Choice, Word};
use sphorge_engine::model::{Section, Tracer};

/// All tracers of a deck.
pub(crate) fn tracers(raw: &[RawTracer], scene: &Scene<'_>, problems: &mut Problems) -> Option<Vec<Tracer>> {
    Names::collect("tracer", raw.iter().map(|t| &t.name), problems);
    let read: Vec<_> = raw.iter().map(|t| tracer(t, scene, problems)).collect();
    read.into_iter().collect()
}

/// Names of the fields that are listed, each once.
pub(crate) fn listed_fields(given: &[Choice<FieldWord>], problems: &mut Problems) -> Option<Vec<String>> {
    let fields: Vec<_> = given.iter().map(|field| field.get(problems).map(|f| f.name)).collect();
    for (k, field) in fields.iter().enumerate() {
        if let (Some(name), Some(first)) = (field, fields.iter().position(|other| other == field).filter(|&j| j < k)) {
            let fault =
                Fault::new("duplicate-name", format!("field `{name}` is listed twice"), given[k].span(), "again");
            problems.push(fault.also(given[first].span(), "first here").help("remove one of them"));
        }
    }
    fields.into_iter().map(|field| field.map(str::to_owned)).collect()
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
            if given.is_empty() {
                problems.push(
                    Fault::new("empty-list", "a tracer needs a field to write", raw.name.span(), "no field to write")
                        .help("leave `fields` out for the default ones"),
                );
            }
            let fields = listed_fields(given, problems);
            for (name, given) in fields.iter().flatten().zip(given) {
                scene.check_field(name, given.span(), problems);
            }
            fields
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
