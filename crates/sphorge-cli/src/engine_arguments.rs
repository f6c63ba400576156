//! What computes: arguments of the commands that run a deck.

use crate::failure::Failure;
use clap::Args;
use sphorge::engine::{Cpu, EngineKind};
use std::sync::Arc;

/// The engines of this program.
pub(crate) fn engines(device: Option<&str>) -> Vec<Arc<dyn EngineKind>> {
    let _ = device;
    vec![
        Arc::new(Cpu),
        #[cfg(feature = "gpu")]
        Arc::new(sphorge_gpu::Gpu { device: device.map(str::to_owned), profile: None }),
    ]
}

/// The engines a run may be resumed on: that of the card of this name, if one is asked for, and no other.
pub(crate) fn engines_to_resume(device: Option<&str>) -> Result<Vec<Arc<dyn EngineKind>>, Failure> {
    let engines = engines(device);
    match device {
        None => Ok(engines),
        Some(_) if engines.len() == 1 => Err(no_cards()),
        Some(_) => Ok(engines.into_iter().filter(|engine| engine.name() != Cpu.name()).collect()),
    }
}

/// This program was built without an engine for cards.
pub(crate) fn no_cards() -> Failure {
    Failure::bad_input(
        "this program has no engine for graphics cards: it was built without".to_owned(),
        "build it with `cargo build --release --features gpu`; without it `sphorge run` has `--engine cpu`".to_owned(),
    )
}

/// What computes.
#[derive(Clone, Debug, Args)]
pub(crate) struct EngineArguments {
    /// What computes: `cpu`, the processor, or `gpu`, a graphics card (in a program built with `--features gpu`)
    #[arg(long, value_name = "ENGINE", default_value_t = Cpu.name().to_owned())]
    engine: String,
    /// Words of the name of the graphics card, or `cuda`, `vulkan`, `metal` [default: the first that `sphorge devices` lists]
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
}

impl EngineArguments {
    /// The engine of that name.
    pub(crate) fn find(&self) -> Result<Arc<dyn EngineKind>, Failure> {
        let name = self.engine.as_str();
        if name == Cpu.name() && self.device.is_some() {
            return Err(Failure::bad_input(
                "`--device` chooses a graphics card, and the processor is to compute".to_owned(),
                "add `--engine gpu`, or leave `--device` out".to_owned(),
            ));
        }
        let engines = engines(self.device.as_deref());
        let known: Vec<String> = engines.iter().map(|engine| format!("`{}`", engine.name())).collect();
        engines.into_iter().find(|engine| engine.name() == name).ok_or_else(|| match name {
            "gpu" => no_cards(),
            _ => Failure::bad_input(
                format!("there is no engine `{name}`"),
                format!("choose from {}: `--engine {}`", known.join(", "), Cpu.name()),
            ),
        })
    }
}
