//! Models that the engine for GPUs cannot run; they are refused before a run.

use sphorge_engine::Unsupported;
use sphorge_engine::model::{Model, Precision};

/// Whether the engine can run a model.
pub(super) fn supports(model: &Model) -> Result<(), Unsupported> {
    let asked = [
        (
            model.numerics.precision == Precision::Double,
            "pair sums in double precision: cards compute pairs in single precision, with compensated sums over the steps",
            "leave `numerics.precision` out, or run it with `--engine cpu`",
        ),
        (
            model.audit.is_some() && model.has_facets(),
            "audits of neighbour lists where bodies meet at facets",
            "leave `audit` out, run it with `--engine cpu`, or let bodies meet by overlap: `contact = { penalty = { surfaces = \"overlap\" } }`",
        ),
        (
            model.meets_walls_at_facets(),
            "walls that push bodies at their facets, as segments, friction and round surfaces need",
            "run it with `--engine cpu`, or let walls push particles: `contact = { penalty = { surfaces = \"particles\" } }`",
        ),
    ];
    match asked.into_iter().find(|(asked, ..)| *asked) {
        Some((_, what, help)) => Err(Unsupported { what: what.to_owned(), help: help.to_owned() }),
        None => Ok(()),
    }
}

/// Whether several GPUs can share a model.
pub(super) fn supports_in_parts(model: &Model) -> Result<(), Unsupported> {
    if model.formulation.is_quadratic_at_faces() {
        let what = "gradients that are exact for quadratic fields at faces, on several cards".to_owned();
        let help = "run it on one card, with `--engine cpu`, or leave out `search.total-lagrangian.faces`".to_owned();
        return Err(Unsupported { what, help });
    }
    Ok(())
}
