//! What the engine for cards can run so far; all else is refused before a run.

use super::kernels::{conduction, contact, kept};
use sphorge_engine::Unsupported;
use sphorge_engine::model::{Formulation, Integrator, Model, Precision, Search, SmoothingLength};

const BY_CPU: &str = "run it with `--engine cpu`";

/// The first of what is asked for.
fn first_of(asked: &[(bool, &str, &str)]) -> Result<(), Unsupported> {
    match asked.iter().find(|(asked, ..)| *asked) {
        Some((_, what, help)) => Err(Unsupported { what: (*what).to_owned(), help: (*help).to_owned() }),
        None => Ok(()),
    }
}

/// Whether the engine can run a model.
pub(super) fn supports(model: &Model) -> Result<(), Unsupported> {
    let numerics = &model.numerics;
    let is_total = matches!(model.formulation, Formulation::TotalLagrangian { .. });
    let is_periodic = model.periodic.iter().any(Option::is_some);
    let asked = [
        (
            is_total && numerics.integrator != Integrator::Leapfrog,
            "sums in the initial configuration without the leapfrog",
            "set `numerics.integrator = \"leapfrog\"`",
        ),
        (numerics.precision == Precision::Double, "pair sums in double precision", "leave `numerics.precision` out"),
        (
            numerics.mls_interval.is_some() && (is_total || kept::keeps_distances(model)),
            "density by moving least squares with distances that are kept",
            BY_CPU,
        ),
        (
            numerics.smoothing_length != SmoothingLength::Constant
                && (is_total || model.search != Search::EveryStep || contact::meets(model)),
            "a smoothing length that follows the density with lists that are kept or with contact",
            "set `search = \"every-step\"` and leave `contact` out, or run it with `--engine cpu`",
        ),
        (
            model.audit.is_some() && is_total,
            "audits of sums in the initial configuration",
            "leave `audit` out, or run it with `--engine cpu`",
        ),
        (conduction::has_stale_pairs(model), "conduction of heat with distances that are kept", BY_CPU),
        (
            is_periodic && (contact::meets(model) || is_total || kept::adaptive(model).is_some()),
            "periodic axes with contact, an adaptive search or sums in the initial configuration",
            BY_CPU,
        ),
    ];
    first_of(&asked)
}
