//! What a run on ranks cannot do so far; all else is refused before a run.

use sphorge_engine::Unsupported;
use sphorge_engine::model::{Formulation, Model, Search};

const ALONE: &str = "run it without `--ranks`";

/// Whether ranks can share a model.
///
/// # Errors
/// What they cannot do.
pub fn supports(model: &Model) -> Result<(), Unsupported> {
    let asked = [
        (
            matches!(model.search, Search::Adaptive(_)),
            "adaptive neighbour search (`search`)",
            "keep lists with `search = \"skin\"`; or run it without `--ranks`",
        ),
        (
            model.search == Search::Initial && model.formulation == Formulation::UpdatedLagrangian,
            "kernel values of the start (`search`)",
            ALONE,
        ),
        (model.audit.is_some(), "audits of the search (`audit`)", "leave `audit` out"),
    ];
    match asked.into_iter().find(|(asked, ..)| *asked) {
        Some((_, what, help)) => Err(Unsupported { what: what.to_owned(), help: help.to_owned() }),
        None => Ok(()),
    }
}
