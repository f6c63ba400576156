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
        (
            !model.contact_pairs().is_empty(),
            "contact between bodies, or of a body with itself (`contact`)",
            "one body has none with `search.total-lagrangian.self-contact = false`, bodies with `contact = \"kernel-sum\"` in the updated Lagrangian form",
        ),
        (
            model.thermal.conduction || !model.thermal.boundaries.is_empty() || !model.thermal.mechanics,
            "conduction of heat (`thermal`)",
            ALONE,
        ),
        (!model.symmetry.is_empty(), "planes of symmetry (`symmetry`)", ALONE),
        (model.periodic.iter().any(Option::is_some), "periodic axes (`periodic`)", ALONE),
        (!model.sections.is_empty(), "forces through sections (`section`)", ALONE),
        (model.audit.is_some(), "audits of the search (`audit`)", "leave `audit` out"),
    ];
    match asked.into_iter().find(|(asked, ..)| *asked) {
        Some((_, what, help)) => Err(Unsupported { what: what.to_owned(), help: help.to_owned() }),
        None => Ok(()),
    }
}
