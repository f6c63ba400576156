//! `sphorge devices`: the graphics cards there are.

use crate::failure::Ending;
use clap::Args;

/// Arguments of `devices`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge devices
  sphorge run taylor-plate --engine gpu --device nvidia

A card is reached by Vulkan, Metal or Direct3D 12; on Linux its driver and
the package libvulkan1 must be there. A software renderer (Debian:
mesa-vulkan-drivers) shows that a deck runs, and is slower than the
processor's own engine.")]
pub(crate) struct DevicesArguments {}

#[cfg(feature = "gpu")]
pub(crate) fn execute(_: DevicesArguments) -> Ending {
    use crate::{
        failure::{Failure, Outcome},
        readable, table, terminal,
    };
    let found = sphorge_gpu::device::find();
    if found.is_empty() {
        return Err(Failure::bad_input(
            "no graphics card is reached by Vulkan, Metal or Direct3D 12".to_owned(),
            "install the driver of the card; on Linux also `libvulkan1`, and `mesa-vulkan-drivers` to try without a card".to_owned(),
        ));
    }
    let rows = found.iter().map(|card| {
        let kind = if card.is_software { "software, slower than the processor" } else { "graphics card" };
        let largest = readable::bytes(card.largest_buffer as f64);
        vec![card.name.clone(), card.interface.to_owned(), card.driver.clone(), kind.to_owned(), largest]
    });
    let table = table::columns(&["name", "by", "driver", "what", "largest column"], &[], rows.collect());
    terminal::print(&format!("{table}\n`--device` chooses by words of the name; the first is taken without.\n"))?;
    Ok(Outcome::Done)
}

#[cfg(not(feature = "gpu"))]
pub(crate) fn execute(_: DevicesArguments) -> Ending {
    Err(crate::engine_arguments::no_cards())
}
