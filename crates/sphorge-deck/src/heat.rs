//! What heat acts on, and what it does not do, said before the run.

use super::fault::{Fault, Problems};
use super::interpret::SourceSpans;
use sphorge_engine::Particles;
use sphorge_engine::geometry::{HeatFaces, ReferenceFacets, faces_by_direction};
use sphorge_engine::model::{Dimensions, HeatBoundary, HeatBoundaryKind, Material, Model};

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

/// What a user should know of the heat of a deck.
pub(crate) fn notes(model: &Model, particles: &Particles) -> Vec<String> {
    side_faces(model, particles).into_iter().chain(without_expansion(model)).collect()
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
