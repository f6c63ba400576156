//! What heat acts on, and what it does not do, said before the run.

use super::fault::{Fault, Problems};
use super::interpret::SourceSpans;
use super::reach::seconds;
use super::suggest::listed;
use sphorge_engine::Particles;
use sphorge_engine::geometry::{HeatFaces, ReferenceFacets, faces_by_direction};
use sphorge_engine::model::{Body, Dimensions, HeatBoundary, HeatBoundaryKind, Material, Model};

/// Heat boundaries that name faces which no particle of theirs has.
pub(crate) fn check_faces(model: &Model, particles: &Particles, places: &SourceSpans, problems: &mut Problems) {
    for k in HeatFaces::new(model).nameless(model, particles) {
        let boundary = &model.thermal.boundaries[k];
        let message = format!("no face that heat boundary `{}` could act on looks along its `normal`", boundary.name);
        let at = places.heat_boundaries.get(k).cloned().unwrap_or(0..0);
        let help = "the normal points out of the body; a region must hold the outermost layer of particles there, half a spacing below the face";
        problems.push(Fault::new("no-face", message, at, "this boundary").help(help));
    }
}

/// What a user should know of the heat of a deck, given the names of materials that do not state their conductivity.
pub(crate) fn notes(
    model: &Model,
    particles: &Particles,
    without_conductivity: &[String],
    is_asked_for: bool,
) -> Vec<String> {
    let of_materials =
        (0..model.materials.len()).filter_map(|m| no_conduction(model, particles, m, without_conductivity));
    of_materials
        .chain(side_faces(model, particles))
        .chain(without_expansion(model))
        .chain(too_short(model))
        .chain(if is_asked_for { None } else { not_asked_for(model) })
        .collect()
}

/// Bodies of unequal temperatures that touch and between which heat would have the time to flow, in a deck that says nothing of heat.
fn not_asked_for(model: &Model) -> Option<String> {
    let has_time = |index: usize| {
        let body = &model.bodies[index];
        model.materials[body.material].conductivity > 0.0 && time_to_the_next(model, body) < model.time.end
    };
    let differ = |(a, b): &(usize, usize)| (model.bodies[*a].temperature - model.bodies[*b].temperature).abs() > 1.0;
    let bounds = |index: usize| model.bodies[index].shape.bounds(model.dimensions);
    let touch = |(a, b): &(usize, usize)| {
        let ((low_a, high_a), (low_b, high_b)) = (bounds(*a), bounds(*b));
        let near = model.bodies[*a].spacing.max(model.bodies[*b].spacing);
        (0..model.dimensions.count()).all(|k| low_a[k] - high_b[k] < near && low_b[k] - high_a[k] < near)
    };
    let is_told = |pair: &(usize, usize)| differ(pair) && has_time(pair.0) && has_time(pair.1) && touch(pair);
    let (a, b) = model.contact_pairs().into_iter().find(is_told)?;
    let of = |index: usize| format!("`{}` ({:.0} K)", model.bodies[index].name, model.bodies[index].temperature);
    Some(format!(
        "no heat flows between bodies {} and {}, and none within them: the deck has no [thermal] table; add one, with `mechanics = false` for heat alone, or \
         with `conduction = false` if that is meant",
        of(a),
        of(b)
    ))
}

/// A material without conductivity, where heat is to flow: it takes none of surroundings, either. One whose conductivity of zero is stated
/// is an insulator, told only of boundaries that act on nothing else.
fn no_conduction(
    model: &Model,
    particles: &Particles,
    index: usize,
    without_conductivity: &[String],
) -> Option<String> {
    let (material, thermal) = (&model.materials[index], &model.thermal);
    if !thermal.conduction || material.conductivity > 0.0 {
        return None;
    }
    let name = &material.name;
    let is_stated = !without_conductivity.contains(name);
    let needs_it = |boundary: &&HeatBoundary| {
        matches!(boundary.kind, HeatBoundaryKind::SurfaceTemperature(_) | HeatBoundaryKind::Convection { .. })
    };
    let without_effect = |boundary: &&HeatBoundary| {
        let claimed = (0..particles.len()).filter(|&i| boundary.claims(particles.body[i], particles.regions[i]));
        let mut materials = claimed.map(|i| particles.material[i] as usize).peekable();
        let conducts = |m: usize| model.materials[m].conductivity > 0.0;
        // Of several insulators the first tells of it.
        match is_stated {
            true => materials.peek() == Some(&index) && !materials.any(conducts),
            false => materials.any(|m| m == index),
        }
    };
    let boundaries = thermal.boundaries.iter().filter(needs_it).filter(without_effect);
    let names: Vec<&str> = boundaries.map(|boundary| boundary.name.as_str()).collect();
    if is_stated && names.is_empty() {
        return None;
    }
    let what = match names.len() {
        0 => "no heat flows between its particles, or into other bodies".to_owned(),
        1 => format!("no heat flows into its bodies through heat boundary {}", listed(names, "or")),
        _ => format!("no heat flows into its bodies through heat boundaries {}", listed(names, "or")),
    };
    let lacks = if is_stated { "has a `conductivity` of zero" } else { "has no `conductivity`" };
    let unless = if is_stated { "" } else { ", or `conductivity = 0` if that is meant" };
    Some(format!(
        "material `{name}` {lacks}: {what}; add `conductivity = \"80 W/(m K)\"` with the right value to [material.{name}]{unless}"
    ))
}

/// Share of the time that heat takes from one particle to the next within which none has moved.
const NO_TIME: f64 = 0.1;

/// Time that heat takes from one particle to the next, s: `d^2 / a`, with the spacing and the diffusivity.
fn time_to_the_next(model: &Model, body: &Body) -> f64 {
    let material = &model.materials[body.material];
    body.spacing * body.spacing * material.density * material.specific_heat / material.conductivity
}

/// Heat alone, with an end before any has moved.
fn too_short(model: &Model) -> Option<String> {
    if model.thermal.mechanics || model.time.max_steps.is_some() {
        return None;
    }
    let shortest = model
        .bodies
        .iter()
        .map(|body| time_to_the_next(model, body))
        .filter(|time| *time > 0.0)
        .fold(f64::INFINITY, f64::min);
    (shortest.is_finite() && model.time.end < NO_TIME * shortest).then(|| {
        format!(
            "the run ends at {}, and heat takes {} from one particle to the next: none is conducted until then; check the unit of `time.end`",
            seconds(model.time.end),
            seconds(shortest)
        )
    })
}

/// Share of the largest area by direction that is rounding.
const NO_AREA: f64 = 1e-6;

/// Boundaries of a region whose particles have faces in several directions: all take heat.
fn side_faces(model: &Model, particles: &Particles) -> Vec<String> {
    let thermal = &model.thermal;
    let is_open = |kind| !matches!(kind, HeatBoundaryKind::HeldTemperature(_));
    let by_region = thermal.boundaries.iter().filter(|of| of.normal.is_none() && is_open(of.kind));
    let by_region: Vec<_> = by_region.filter_map(|of| Some((of, of.region?))).collect();
    if !thermal.conduction || by_region.is_empty() {
        return Vec::new();
    }
    let facets = ReferenceFacets::new(model);
    let count = model.dimensions.count();
    let note = |(boundary, region): (&HeatBoundary, usize)| {
        let areas = faces_by_direction(model, particles, &facets, boundary);
        let most = areas.iter().copied().fold(0.0, f64::max);
        let mut sides: Vec<usize> = (0..2 * count).filter(|side| areas[*side] > NO_AREA * most).collect();
        if sides.len() < 2 {
            return None;
        }
        sides.sort_by(|a, b| areas[*b].total_cmp(&areas[*a]));
        let towards = |side: &usize| format!("{}{}", ["-", "+"][side % 2], ["x", "y", "z"][side / 2]);
        let size = |side: &usize| match model.dimensions {
            Dimensions::One => towards(side),
            Dimensions::PlaneStrain => format!("{:.4} mm towards {}", 1e3 * areas[*side], towards(side)),
            Dimensions::Three => format!("{:.4} mm2 towards {}", 1e6 * areas[*side], towards(side)),
        };
        let told: Vec<String> = sides.iter().map(size).collect();
        let normal: Vec<&str> =
            (0..count).map(|axis| if axis != sides[0] / 2 { "0" } else { ["-1", "1"][sides[0] % 2] }).collect();
        Some(format!(
            "heat boundary `{}` acts on all free faces of region `{}`: {}; `normal = [{}]` names those of the first direction alone",
            boundary.name,
            model.regions[region].name,
            told.join(", "),
            normal.join(", ")
        ))
    };
    by_region.into_iter().filter_map(note).collect()
}

/// Materials that heat does not expand, where bodies move and temperatures change.
fn without_expansion(model: &Model) -> Vec<String> {
    if !model.thermal.conduction || !model.thermal.mechanics {
        return Vec::new();
    }
    let note = |material: &Material| {
        let law = &material.equation_of_state;
        let density = law.reference_density();
        (law.gruneisen(density, 0.0) == 0.0).then(|| {
            format!(
                "heat does not expand material `{}`: pressures of its law `{}` do not depend on the energy. With the coefficient alpha of linear expansion `mie-gruneisen` with `gruneisen` = 3 alpha K/(rho c_p) = {:.4e} K times alpha expands",
                material.name,
                law.key(),
                3.0 * law.reference_sound_speed().powi(2) / material.specific_heat
            )
        })
    };
    model.materials.iter().filter_map(note).collect()
}

#[cfg(test)]
mod tests {
    use crate::{load_text, tests::notes::notes_on};

    #[test]
    fn an_end_before_heat_gets_from_one_particle_to_the_next_is_told() {
        // (2 mm)^2 * 1000 kg/m^3 * 500 J/(kg K) / (20 W/(m K)) is 100 ms.
        let notes = |end: &str, thermal: &str| {
            let deck = format!(
                "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"2 mm\" }}\ntime = {{ end = \"{end}\" }}\n\
                 [[body]]\nname = \"block\"\nmaterial = \"block\"\nshape = {{ box = {{ min = [0, 0], max = [\"8 mm\", \"8 mm\"] }} }}\n\
                 temperature = \"800 degC\"\n\
                 [material.block]\ndensity = 1000\nyoung-modulus = \"10 GPa\"\npoisson-ratio = 0.3\nstrength = \"elastic\"\n\
                 specific-heat = 500\nconductivity = 20\n[thermal]\n{thermal}\n"
            );
            let notes = load_text("hot", &deck, &[]).unwrap().all_notes();
            notes.into_iter().filter(|note| note.contains("from one particle to the next")).collect::<Vec<_>>()
        };
        let told = notes("1 ms", "mechanics = false");
        assert!(
            told.len() == 1
                && told[0].contains("the run ends at 1 ms, and heat takes 100 ms from one particle to the next"),
            "{told:?}"
        );
        assert_eq!(notes("20 ms", "mechanics = false"), [""; 0]);
        // In an impact heat has no time, as is known.
        assert_eq!(notes("1 us", "conduction = true"), [""; 0]);
    }

    #[test]
    fn hot_and_cold_bodies_that_exchange_no_heat_are_told() {
        let deck = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"1 s\" }\n\
                    [[body]]\nname = \"hot\"\nmaterial = \"m\"\nshape = { box = { min = [0, 0], max = [\"8 mm\", \"8 mm\"] } }\ntemperature = \"400 K\"\n\
                    [[body]]\nname = \"cold\"\nmaterial = \"m\"\nshape = { box = { min = [\"8 mm\", 0], max = [\"16 mm\", \"8 mm\"] } }\ntemperature = \"300 K\"\n\
                    [material.m]\ndensity = 1000\nyoung-modulus = \"10 GPa\"\npoisson-ratio = 0.3\nstrength = \"elastic\"\nspecific-heat = 500\nconductivity = 20\n";
        let words = "no heat flows between bodies `hot` (400 K) and `cold` (300 K)";
        let told = |replaced: &[(&str, &str)]| {
            notes_on(deck, replaced).into_iter().filter(|note| note.contains(words)).count()
        };
        assert_eq!(told(&[]), 1);
        assert_eq!(told(&[("conductivity = 20", "conductivity = 20\n[thermal]\nconduction = true")]), 0);
        assert_eq!(told(&[("conductivity = 20", "conductivity = 20\n[thermal]\nconduction = false")]), 0);
        assert_eq!(told(&[("1 s", "1 us")]), 0);
        // What is far away takes no heat by touch.
        assert_eq!(told(&[("min = [\"8 mm\", 0], max = [\"16 mm\"", "min = [\"12 mm\", 0], max = [\"20 mm\"")]), 0);
        assert_eq!(told(&[("400 K", "300 K")]), 0);
    }
}
