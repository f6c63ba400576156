//! `sphorge devices`: the graphics cards there are.

use crate::failure::Ending;
use clap::Args;

/// Arguments of `devices`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge devices
  sphorge run taylor-plate --engine gpu --device nvidia
  sphorge run taylor-plate --engine gpu --device \"radeon vulkan\"

NVIDIA cards are used through CUDA, which needs their driver and the compiler
NVRTC. All cards can be used through Vulkan, Metal or Direct3D 12, which need
only the driver. A software renderer (Debian: mesa-vulkan-drivers) can test
that a deck runs, but is slower than the engine `cpu`. So is `--device host`,
which needs no driver: the program executes the kernels itself.")]
pub(crate) struct DevicesArguments {}

#[cfg(feature = "gpu")]
pub(crate) fn execute(_: DevicesArguments) -> Ending {
    use crate::{
        failure::{Failure, Outcome},
        readable, table, terminal,
    };
    let survey = sphorge_gpu::device::find();
    let missing = survey.missing.iter().map(|of| format!("{}: {}; {}", of.interface, of.why, of.cure));
    let missing = missing.collect::<Vec<_>>().join("\n");
    if survey.cards.is_empty() {
        return Err(Failure::bad_input("no usable graphics card was found".to_owned(), missing));
    }
    let rows = survey.cards.iter().map(|card| {
        let kind = if card.is_software { "software, slower than the processor" } else { "graphics card" };
        let bytes = |bytes: u64| readable::bytes(bytes as f64);
        vec![
            card.name.clone(),
            card.interface.to_string(),
            card.driver.clone(),
            kind.to_owned(),
            card.memory.map_or("not told".to_owned(), |memory| bytes(memory.total)),
            bytes(card.largest_buffer),
        ]
    });
    let table = table::columns(&["name", "by", "driver", "what", "memory", "largest column"], &[], rows.collect());
    let missing = if missing.is_empty() { missing } else { format!("\n{missing}\n") };
    terminal::print(&format!(
        "{table}\n`--device` selects by words of name and interface; the default is the first.\n{missing}"
    ))?;
    Ok(Outcome::Done)
}

#[cfg(not(feature = "gpu"))]
pub(crate) fn execute(_: DevicesArguments) -> Ending {
    Err(crate::engine_arguments::no_cards())
}
