//! What to do about a finding: of what helps, that which the deck does not have already.

use crate::model::{Formulation, Model, Precision, TemperatureSource, Wall, WallContact, WarningKind};
use sphorge_physics::pair::EnergySplit;

/// What to do about what a check has found, in a body if it is about one.
pub(super) fn cure(kind: WarningKind, model: &Model, body: Option<usize>) -> String {
    let numerics = &model.numerics;
    let is_total = matches!(model.formulation, Formulation::TotalLagrangian { .. });
    let step = lower_step(model);
    match kind {
        WarningKind::PlasticWork if is_total => format!(
            "use a smaller spacing, or {step} if `integration_energy` in history.csv is as large as what is too much; \
             do not use the stresses and temperatures of this run"
        ),
        WarningKind::PlasticWork => {
            let repulsion = match (&numerics.artificial_stress, numerics.xsph > 0.0) {
                (Some(_), true) => ", or leave out `xsph` or `artificial-stress`, which add plastic work together",
                (Some(_), false) => ", or lower `artificial-stress`, which adds plastic work in tension",
                (None, _) => "",
            };
            format!("{TOTAL_LAGRANGIAN}{repulsion}; do not use the stresses and temperatures of this run")
        }
        WarningKind::NegativeEnergy => {
            let mut ways = vec![format!("{step} if `integration_energy` in history.csv is as large")];
            if is_total {
                let viscosity = if numerics.viscosity_alpha > 0.0 { "raise `viscosity.alpha`" } else { "add artificial viscosity" };
                ways.push(format!("{viscosity} if `hourglass_energy` is"));
            }
            if numerics.energy_split != EnergySplit::OwnStress {
                ways.push("set `energy-split = \"own-stress\"`".to_owned());
            }
            if numerics.artificial_stress.is_some() {
                ways.push("lower `artificial-stress` if `artificial_stress_energy` is".to_owned());
            }
            joined(&ways)
        }
        WarningKind::Cold => {
            let mut ways = Vec::new();
            if model.thermal.is_cooled() {
                ways.push("remove less heat at the boundary".to_owned());
            }
            ways.push(step);
            if numerics.temperature == TemperatureSource::Energy {
                ways.push("set `numerics.temperature = \"plastic-work\"`, which counts no energy that the numerics have taken".to_owned());
            }
            format!("{}; the flow stress of this particle is wrong", joined(&ways))
        }
        WarningKind::Hot => {
            format!("its heat comes from work for which no energy was supplied: {}", cure(WarningKind::PlasticWork, model, body))
        }
        WarningKind::MissingHeat => "set `numerics.temperature = \"energy\"`: plastic work knows nothing of the heat of shocks, and metal that has melted keeps its strength".to_owned(),
        WarningKind::WallEnergy => {
            let has = |of: fn(&WallContact) -> bool| model.walls.iter().any(|wall: &Wall| of(&wall.contact));
            let mut ways = Vec::new();
            if has(|contact| matches!(contact, WallContact::MonaghanKos { .. })) {
                ways.push("use `contact = \"penalty\"` at the wall".to_owned());
            }
            if has(|contact| matches!(contact, WallContact::Penalty { .. })) {
                ways.push("lower the stiffness or damping of the wall".to_owned());
            }
            ways.push(step);
            ways.push("where nothing leaves the wall again, use a symmetry plane instead".to_owned());
            joined(&ways)
        }
        WarningKind::EnergyDrift | WarningKind::MomentumDrift => {
            let what = if kind == WarningKind::EnergyDrift { "energy" } else { "momentum" };
            let report = "do not use the run, and report its deck as a fault of the program";
            match numerics.precision {
                Precision::Mixed => format!(
                    "the sums of this run do not conserve {what}: set `precision = \"double\"`; if the drift stays, {report}"
                ),
                Precision::Double => format!("the sums of this run do not conserve {what}: {report}"),
            }
        }
        WarningKind::Pairing | WarningKind::Tearing | WarningKind::Pieces if !is_total => {
            let mut ways = vec![TOTAL_LAGRANGIAN.to_owned()];
            ways.push(match numerics.artificial_stress {
                Some(_) => "raise `artificial-stress`".to_owned(),
                None => "add `artificial-stress`".to_owned(),
            });
            if !numerics.kernel.key().contains("wendland") {
                ways.push("take a Wendland kernel".to_owned());
            }
            if kind != WarningKind::Pairing {
                ways.push(MEANT_TO_BREAK.to_owned());
            }
            format!("numerical fracture: {}", joined(&ways))
        }
        WarningKind::Pairing | WarningKind::Tearing | WarningKind::Pieces => {
            let ways = [
                "use a smaller spacing".to_owned(),
                "raise `search.total-lagrangian.renewal`, beyond which a body has come apart".to_owned(),
                MEANT_TO_BREAK.to_owned(),
            ];
            format!("numerical fracture: {}", joined(&ways))
        }
        WarningKind::FarAway | WarningKind::Compression => {
            let mut ways = vec![step];
            if touches(model) {
                ways.push("soften the contact".to_owned());
            }
            ways.push(match kind {
                WarningKind::FarAway => "look at the start for bodies or particles that press on each other".to_owned(),
                _ => "use a pressure law that is valid at such compression".to_owned(),
            });
            joined(&ways)
        }
        WarningKind::Expansion => {
            let of = body.and_then(|body| model.bodies.get(body)).and_then(|body| model.materials.get(body.material));
            let spalls = of.map_or_else(|| model.materials.iter().all(|of| of.spalls()), |of| of.spalls());
            let way = if spalls { "lower the `spall-pressure` of the material" } else { "give the material a `spall-pressure`" };
            format!("{way}; the pressure law is not valid at so low a density")
        }
        WarningKind::TimeStep => {
            format!("the solution is breaking down: {}; `dt_reason` in history.csv names the limit of the step", steadier(model))
        }
        WarningKind::StepsLeft => {
            let mut ways = vec!["use a larger spacing".to_owned(), "end the run earlier".to_owned()];
            match (model.time.fixed_step, model.time.max_step) {
                (Some(_), _) => ways.push("raise `time.fixed-step`".to_owned()),
                (None, Some(_)) => ways.push("raise `time.max-step` or `time.courant` where it was set low".to_owned()),
                (None, None) => ways.push("raise `time.courant` where it was set low".to_owned()),
            }
            joined(&ways)
        }
        WarningKind::Integration => format!("{step}: what is missing, or too much, falls with its square"),
        WarningKind::ContactEnergy if model.has_facets() => {
            "contacts have set bodies in motion with energy from nowhere: do not use the run, and report its deck as a fault of the program".to_owned()
        }
        WarningKind::ContactEnergy => {
            let at_faces = match is_total {
                true => "leave `surfaces = \"overlap\"` out, so that they meet at their faces".to_owned(),
                false => format!("{TOTAL_LAGRANGIAN}, in which they meet at their faces"),
            };
            let mut ways = vec![at_faces, "start them further apart".to_owned(), step];
            if numerics.xsph > 0.0 {
                ways.push("leave out `xsph`, which moves particles without work".to_owned());
            }
            let why = "bodies press each other by overlaps of their kernels, before they touch and with an error of the step";
            format!("{why}: {}", joined(&ways))
        }
        WarningKind::HourglassWork => "use a smaller spacing: springs take from motion that varies from particle to particle; or lower `search.total-lagrangian.hourglass`".to_owned(),
        WarningKind::LostNeighbors => "numerical fracture: raise `particles.smoothing`, or give the material a `spall-pressure` if it is meant to break".to_owned(),
        WarningKind::Interpenetration => {
            let mut ways = Vec::new();
            match model.contact.strength() {
                None => ways.push("give them a `contact`".to_owned()),
                Some(strength) if strength.stiffness < 1.0 => {
                    ways.push("raise the `stiffness` of the contact to 1, its default".to_owned());
                }
                Some(_) => {}
            }
            if model.has_facets() {
                ways.push("let them meet by `contact = { penalty = { surfaces = \"overlap\" } }`".to_owned());
            }
            ways.push("use `method = \"updated-lagrangian\"`".to_owned());
            format!("bodies have passed into each other, so that less momentum was exchanged than is right: {}", joined(&ways))
        }
        WarningKind::BehindSymmetry => "the body has folded through its image, or has come apart and mixes with it: choose a spacing with the first layer of particles half a spacing from the plane (`sphorge check` suggests some), or use a penalty wall instead of the plane".to_owned(),
    }
}

/// What to do about a step that has collapsed.
pub(super) fn cure_of_collapse(model: &Model) -> String {
    format!(
        "the time step has collapsed because the solution is breaking down: {}; `dt_reason` in history.csv names the limit of the step",
        steadier(model)
    )
}

fn steadier(model: &Model) -> String {
    let mut ways = vec![lower_step(model)];
    if model.time.step_control.is_none() && model.time.fixed_step.is_none() {
        ways.push("use step control (`time.step-control.repeats` above 0)".to_owned());
    }
    if touches(model) {
        ways.push("soften the contact".to_owned());
    }
    joined(&ways)
}

const TOTAL_LAGRANGIAN: &str = "use `search = \"total-lagrangian\"`";
const MEANT_TO_BREAK: &str = "give the material a `spall-pressure` if it is meant to break";

/// The key by which a deck has smaller steps.
fn lower_step(model: &Model) -> String {
    match model.time.fixed_step {
        Some(_) => "lower `time.fixed-step`".to_owned(),
        None => "lower `time.courant`".to_owned(),
    }
}

/// Whether bodies or walls push each other by a contact with a stiffness.
fn touches(model: &Model) -> bool {
    model.contact.strength().is_some() || !model.walls.is_empty()
}

fn joined(ways: &[String]) -> String {
    match ways {
        [] => String::new(),
        [only] => only.clone(),
        [first, second] => format!("{first}, or {second}"),
        [first @ .., last] => format!("{}, or {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck;

    /// A bar of iron that strikes a wall, with lines more and keys changed.
    fn model(changes: &[(&str, &str)]) -> Model {
        let text = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"20 us\" }\n\
                    [material.m]\nbase = \"armco-iron\"\n[[body]]\nname = \"bar\"\nmaterial = \"m\"\n\
                    shape = { box = { min = [0, 0], max = [\"6 mm\", \"12 mm\"] } }\nvelocity = [\"0 m/s\", \"-10 m/s\"]\n\
                    [[wall]]\nname = \"anvil\"\nplane = { point = [0, 0], normal = [0, 1] }\n";
        let changes: Vec<_> = changes.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
        deck::load_text("bar", text, &changes).unwrap_or_else(|report| panic!("{report:?}")).model
    }

    const UPDATED: (&str, &str) = ("method", "updated-lagrangian");
    const REPULSION: (&str, &str) = ("numerics.artificial-stress", "{ epsilon = 0.3, exponent = 4 }");

    fn all(model: &Model) -> Vec<(WarningKind, String)> {
        let cures = WarningKind::ALL.into_iter().map(|kind| (kind, cure(kind, model, Some(0))));
        cures.collect()
    }

    #[track_caller]
    fn none_has(model: &Model, words: &str) {
        for (kind, cure) in all(model) {
            assert!(!cure.contains(words), "{}: {cure}", kind.name());
        }
    }

    #[track_caller]
    fn has(kind: WarningKind, changes: &[(&str, &str)], words: &str) {
        let cure = cure(kind, &model(changes), Some(0));
        assert!(cure.contains(words), "{cure}");
    }

    #[test]
    fn nothing_is_recommended_that_is_there_already() {
        none_has(&model(&[]), "search = \"total-lagrangian\"");
        none_has(&model(&[]), "artificial-stress");
        has(WarningKind::PlasticWork, &[UPDATED], "search = \"total-lagrangian\"");
        none_has(&model(&[("numerics.precision", "double")]), "precision");
        has(WarningKind::EnergyDrift, &[], "precision = \"double\"");
        has(WarningKind::Pairing, &[UPDATED], "add `artificial-stress`");
        has(WarningKind::Pairing, &[UPDATED, REPULSION], "raise `artificial-stress`");
        has(WarningKind::Pairing, &[UPDATED, ("numerics.kernel", "cubic-spline")], "Wendland");
        none_has(&model(&[UPDATED, ("numerics.kernel", "wendland-c2")]), "Wendland");
        has(WarningKind::Expansion, &[], "give the material a `spall-pressure`");
        has(WarningKind::Expansion, &[("material.m.spall-pressure", "1 GPa")], "lower the `spall-pressure`");
        has(WarningKind::TimeStep, &[("time.step-control", "{ repeats = 0 }")], "use step control");
        none_has(&model(&[("time.step-control", "{ repeats = 5 }")]), "step control");
        has(WarningKind::NegativeEnergy, &[UPDATED, ("numerics.energy-split", "symmetric")], "own-stress");
        none_has(&model(&[UPDATED, ("numerics.energy-split", "own-stress")]), "own-stress");
    }

    #[test]
    fn nothing_is_recommended_that_the_deck_does_not_have() {
        let fixed = model(&[("time.fixed-step", "1 ns")]);
        none_has(&fixed, "courant");
        has(WarningKind::StepsLeft, &[("time.fixed-step", "1 ns")], "raise `time.fixed-step`");
        has(WarningKind::StepsLeft, &[("time.max-step", "1 ns")], "`time.max-step`");
        none_has(&model(&[]), "max-step");
        // No boundary takes heat away.
        none_has(&model(&[]), "less heat");
        has(WarningKind::Cold, &[("numerics.temperature", "energy")], "numerics.temperature = \"plastic-work\"");
        none_has(&model(&[]), "numerics.temperature = \"plastic-work\"");
        has(WarningKind::MissingHeat, &[], "numerics.temperature = \"energy\"");
        has(WarningKind::PlasticWork, &[UPDATED, REPULSION, ("numerics.xsph", "0.5")], "`xsph` or `artificial-stress`");
        has(WarningKind::ContactEnergy, &[UPDATED, ("numerics.xsph", "0.5")], "leave out `xsph`");
        assert!(!cure(WarningKind::ContactEnergy, &model(&[UPDATED]), None).contains("xsph"));
        let plain = cure(WarningKind::PlasticWork, &model(&[UPDATED]), None);
        assert!(!plain.contains("xsph") && !plain.contains("artificial"), "{plain}");
        has(WarningKind::WallEnergy, &[UPDATED, ("wall.anvil.contact", "monaghan-kos")], "`contact = \"penalty\"`");
        has(WarningKind::WallEnergy, &[], "lower the stiffness");
        none_has(&model(&[]), "contact = \"penalty\"");
    }

    #[test]
    fn every_key_and_column_that_is_named_is_one() {
        const COLUMNS: [&str; 4] = ["integration_energy", "hourglass_energy", "artificial_stress_energy", "dt_reason"];
        let schema = deck::schema().to_string();
        let decks: [&[(&str, &str)]; 5] = [
            &[],
            &[UPDATED],
            &[UPDATED, REPULSION, ("numerics.xsph", "0.5"), ("wall.anvil.contact", "monaghan-kos")],
            &[("time.fixed-step", "1 ns"), ("numerics.temperature", "energy")],
            &[("time.max-step", "1 ns"), ("material.m.spall-pressure", "1 GPa")],
        ];
        for model in decks.map(model) {
            for (kind, cure) in all(&model).into_iter().chain([(WarningKind::StepsLeft, cure_of_collapse(&model))]) {
                for named in cure.split('`').skip(1).step_by(2).filter(|named| !named.starts_with("sphorge ")) {
                    let key = named.split(" = ").next().unwrap_or(named).rsplit('.').next().unwrap_or(named);
                    let is_key = schema.contains(&format!("\"{key}\""));
                    assert!(is_key || COLUMNS.contains(&key), "{}: `{named}` in: {cure}", kind.name());
                }
            }
        }
    }
}
