//! `sphorge materials`: the catalogue.

use crate::{
    failure::{Ending, Failure, Outcome},
    readable, table, terminal,
};
use clap::Args;
use sphorge::deck::did_you_mean;
use sphorge::material::{self, ConstantLine, LawListing, MaterialListing};
use std::fmt::Write;

/// Arguments of `materials`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge materials
  sphorge materials armco-iron

A deck refers to a material by its name, changes it under [material.<name>],
or defines its own there.")]
pub(crate) struct MaterialsArguments {
    /// Material to print
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

pub(crate) fn execute(arguments: MaterialsArguments) -> Ending {
    let text = match arguments.name {
        None => overview(&material::catalogue()),
        Some(name) => details(&material::find(&name).map_err(|near| {
            let near = did_you_mean(near);
            let help = format!("{near}`sphorge materials` lists all; a deck can also define its own");
            Failure::bad_input(format!("there is no material `{name}` in the catalogue"), help)
        })?),
    };
    terminal::print(&text)?;
    Ok(Outcome::Done)
}

fn overview(materials: &[MaterialListing]) -> String {
    let key = |law: &Option<LawListing>| law.as_ref().map_or("-", |law| law.key).to_owned();
    let rows = materials.iter().map(|m| {
        let complete = if m.missing.is_empty() { "" } else { "incomplete" };
        vec![m.name.clone(), m.description.clone(), key(&m.equation_of_state), key(&m.strength), complete.to_owned()]
    });
    let table = table::columns(&["name", "material", "pressure", "strength", ""], &[], rows.collect());
    format!("{table}\n`sphorge materials NAME` prints the constants and where they are published.\n")
}

fn details(material: &MaterialListing) -> String {
    let mut text = format!("{}: {}\n", material.name, material.description);
    for (name, value) in [("reference", &material.reference), ("note", &material.note)] {
        if !value.is_empty() {
            let _ = writeln!(text, "{name}: {value}");
        }
    }
    for doubt in &material.doubts {
        let _ = writeln!(text, "note: {doubt}");
    }
    text += &format!("\n{}", constants(&material.constants));
    let laws =
        [("pressure", &material.equation_of_state), ("strength", &material.strength), ("damage", &material.damage)];
    for (what, law) in laws {
        if let Some(law) = law {
            // Strength and pressure act by themselves.
            let acts = match what {
                "damage" => {
                    format!("; acts where the deck gives the material `damage = \"{}\"`", law.key)
                }
                _ => String::new(),
            };
            let _ = write!(
                text,
                "\n{what}: {}, {} ({}){acts}\n\n{}",
                law.key,
                law.name,
                law.reference,
                constants(&law.constants)
            );
        }
    }
    if !material.missing.is_empty() {
        text += "\nA deck that uses this material has to add:\n";
        for missing in &material.missing {
            let _ = writeln!(text, "  {missing}");
        }
    }
    text
}

fn constants(lines: &[ConstantLine]) -> String {
    let rows = lines.iter().map(|line| {
        let value = line.value.map_or_else(|| "not given".to_owned(), |value| readable::quantity(value, line.unit));
        vec![line.key.to_owned(), line.symbol.to_owned(), value, line.meaning.to_owned()]
    });
    table::columns(&["key", "symbol", "value", "meaning"], &[2], rows.collect())
}
