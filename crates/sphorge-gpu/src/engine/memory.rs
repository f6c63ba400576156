//! Whether what a run needs has room on a GPU, before anything is brought there.

use super::columns::Handles;
use super::columns::groups::{self, made_with_particles};
use super::failure;
use super::kernels::grid::Grid;
use super::search::SPARE;
use super::segments::numbers as sums;
use crate::device::{Card, Memory};
use sphorge_engine::model::{Body, Dimensions};
use sphorge_engine::{Model, Particles, RunFailure};
use std::f64::consts::PI;

/// About how many bytes a run takes on a GPU: columns, cells, and lists of the neighbours that particles of the spacing of the largest support have.
fn bytes(model: &Model, count: usize, stride: usize, grid: &Grid) -> f64 {
    let columns: usize = made_with_particles(model).map(|(_, fields)| fields).sum();
    let of_body = |body: &Body| {
        let radius = grid.reach * body.smoothing_length / body.spacing;
        match model.dimensions {
            Dimensions::One => 2.0 * radius,
            Dimensions::PlaneStrain => PI * radius.powi(2),
            Dimensions::Three => 4.0 / 3.0 * PI * radius.powi(3),
        }
    };
    let neighbors = model.bodies.iter().map(of_body).fold(0.0, f64::max);
    let may_grow = model.keeps_lists() || model.formulation.renews();
    let spare = if may_grow { 1.0 + SPARE } else { 1.0 };
    let columns = columns + of_features(model);
    // Counts, starts and particles of cells, twice.
    let cells = 2 * grid.cells() + 3 * count;
    let sums = sums(model, count);
    // A neighbour and three numbers of each term, for faces and for their neighbours; a third of bodies of six layers is at faces, which have
    // neighbours on one side.
    let terms = if model.formulation.is_quadratic_at_faces() { 8.0 * 0.6 / 3.0 * neighbors } else { 0.0 };
    4.0 * ((columns * stride + cells + sums) as f64 + (spare * neighbors + terms) * stride as f64)
}

/// Columns beside those of every model.
fn of_features(model: &Model) -> usize {
    let of = |is_needed: bool, columns: usize| if is_needed { columns } else { 0 };
    of(model.formulation.renews(), <groups::Earlier<()> as Handles<()>>::LENGTH)
        // Normals and depths of the surface, and who is of it.
        + of(model.has_faces(), 7)
        + of(model.keeps_lists(), <groups::Rows<()> as Handles<()>>::LENGTH + <groups::SearchedAt<()> as Handles<()>>::LENGTH)
        // Marks, candidates and where they were found, and the correction of the strain.
        + of(model.adaptive_search().is_some(), 8 + <groups::StrainCorrection<()> as Handles<()>>::LENGTH)
        // Tables of faces, and what is evaluated near them.
        + of(model.formulation.is_quadratic_at_faces(), 20)
        + of(model.formulation.is_quadratic_at_faces() && model.has_facets(), <groups::FaceLinear<()> as Handles<()>>::LENGTH + 1)
        // Bodies and motions, starts of lists, and what is reduced to a few rows.
        + 5
}

/// Refuses a group of columns whose places a GPU cannot number: each body that others meet has columns of its own.
fn refuse_too_long_columns(model: &Model, stride: usize) -> Result<(), RunFailure> {
    let longest = made_with_particles(model).map(|(_, fields)| fields as u64 * stride as u64).max().unwrap_or(0);
    let most = u64::from(u32::MAX);
    if longest <= most {
        return Ok(());
    }
    let count = model.bodies.len();
    Err(failure(format!(
        "{stride} particles of {count} bodies take a column of {longest} numbers, and a card takes up to {most}: take fewer bodies or a larger \
         `particles.spacing`, or run with `--engine cpu`"
    )))
}

/// Refuses a run that has no room, where the GPU says what it has.
pub(super) fn refuse_beyond_memory(
    card: &Card,
    (model, p): (&Model, &Particles),
    stride: usize,
    grid: &Grid,
) -> Result<(), RunFailure> {
    refuse_too_long_columns(model, stride)?;
    let needed = bytes(model, p.len(), stride, grid) + card.profile_bytes(stride) as f64;
    match card.memory() {
        Some(Memory { total, free: Some(free) }) if needed > free as f64 => {
            let title = card.found().title();
            let [needed, free, total] = [needed, free as f64, total as f64].map(|bytes| bytes / 1e6);
            Err(failure(format!(
                "{} particles take about {needed:.1} MB on {title}, of whose {total:.1} MB {free:.1} MB are free: take a larger `particles.spacing`, \
                 or run with `--engine cpu`",
                p.len()
            )))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::ranks::stride_for;
    use crate::engine::start::grid_of;
    use sphorge_deck::{decks, load_text};

    #[test]
    fn ten_million_particles_fit_in_16_gigabytes() {
        let count = 10_000_000;
        let stride = stride_for(count, 0);
        for (deck, overrides) in [
            ("copper-bar", &[][..]),
            ("block", &[]),
            ("block", &[("search", "\"adaptive\"")]),
            ("bullet", &[("search", "\"adaptive\""), ("particles.spacing", "\"20 mm\"")]),
            ("taylor-bar", &[("method", "\"fraser\""), ("search", "\"skin\"")]),
        ] {
            let text = decks::find(deck).unwrap().text;
            let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
            let setup = load_text(deck, text, &overrides).unwrap();
            let mut grid = grid_of(&setup.model, &setup.particles);
            // As many more cells as there are more particles, and twice as many along each axis at worst.
            let times = 8.0 * count as f64 / setup.particles.len() as f64;
            let cells = (grid.cells() as f64 * times) as u32;
            grid.counts = [cells, 1, 1];
            let needed = bytes(&setup.model, count, stride, &grid);
            assert!(needed < 16e9, "{deck}: {needed:e} bytes");
            // What is left out would be seen: columns alone take a good part of it.
            assert!(needed > 5e9, "{deck}: {needed:e} bytes");
        }
    }

    #[test]
    fn a_column_too_long_for_32_bit_indices_is_refused() {
        let block = |k: u32| {
            let (low, high) = (10 * k, 10 * k + 4);
            format!(
                "[[body]]\nname = \"b{k}\"\nmaterial = \"ofhc-copper\"\n\
                 shape = {{ box = {{ min = [\"{low} mm\", \"0 mm\"], max = [\"{high} mm\", \"4 mm\"] }} }}\n"
            )
        };
        let head = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"60 us\" }\n";
        let bodies: String = (0..30).map(block).collect();
        let model = load_text("blocks", &format!("{head}{bodies}"), &[]).unwrap().model;
        // Thirteen columns for each of thirty bodies.
        assert!(refuse_too_long_columns(&model, 11_012_736).is_ok());
        let refusal = refuse_too_long_columns(&model, 11_012_737).unwrap_err();
        assert!(refusal.message.contains("30 bodies") && refusal.message.contains("--engine cpu"), "{refusal}");
    }
}
