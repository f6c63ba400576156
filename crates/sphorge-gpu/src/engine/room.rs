//! Whether what a run needs has room on a card, before anything is brought there.

use super::failure;
use super::kernels::grid::Grid;
use super::plan::keeps_lists;
use super::renewal::EARLIER;
use super::search::SPARE;
use super::snapshot::fields;
use crate::device::{Card, Memory};
use sphorge_engine::model::{Body, Dimensions};
use sphorge_engine::{Model, Particles, RunFailure};
use std::f64::consts::PI;

/// About how many bytes a run takes on a card: columns, cells, and lists of the neighbours that particles of the spacing of the largest support have.
fn bytes(model: &Model, p: &Particles, stride: usize, grid: &Grid) -> f64 {
    let columns: usize = fields(model).map(|(_, fields)| fields).sum();
    let of_body = |body: &Body| {
        let radius = grid.reach * body.smoothing_length / body.spacing;
        match model.dimensions {
            Dimensions::One => 2.0 * radius,
            Dimensions::PlaneStrain => PI * radius.powi(2),
            Dimensions::Three => 4.0 / 3.0 * PI * radius.powi(3),
        }
    };
    let neighbors = model.bodies.iter().map(of_body).fold(0.0, f64::max);
    let may_grow = keeps_lists(model) || model.formulation.renews();
    let spare = if may_grow { 1.0 + SPARE } else { 1.0 };
    let columns = columns + if model.formulation.renews() { EARLIER } else { 0 };
    // Counts, starts and particles of cells, twice.
    let cells = 2 * grid.cells() + 3 * p.len();
    4.0 * ((columns * stride + cells) as f64 + spare * neighbors * stride as f64)
}

/// Refuses a run that has no room, where the card says what it has.
pub(super) fn refuse_what_has_no_room(
    card: &Card,
    (model, p): (&Model, &Particles),
    stride: usize,
    grid: &Grid,
) -> Result<(), RunFailure> {
    let needed = bytes(model, p, stride, grid) + card.profile_bytes(stride) as f64;
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
