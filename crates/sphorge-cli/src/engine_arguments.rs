//! What computes: arguments of the commands that run a deck.

use crate::failure::Failure;
use clap::Args;
use sphorge::engine::{Cpu, EngineKind};

/// The engines of this program.
pub(crate) fn engines() -> &'static [&'static dyn EngineKind] {
    #[cfg(feature = "gpu")]
    {
        const GPU: &sphorge_gpu::Gpu = &sphorge_gpu::Gpu { device: None };
        const ALL: &[&dyn EngineKind] = &[&Cpu, GPU];
        ALL
    }
    #[cfg(not(feature = "gpu"))]
    sphorge::engine::ENGINES
}

/// What computes.
#[derive(Clone, Debug, Args)]
pub(crate) struct EngineArguments {
    /// What computes: `cpu`, the processor, or `gpu`, a graphics card (in a program built with `--features gpu`)
    #[arg(long, value_name = "ENGINE", default_value_t = Cpu.name().to_owned())]
    engine: String,
    /// Words of the name of the graphics card [default: the first that `sphorge devices` lists]
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
}

impl EngineArguments {
    /// The engine of that name.
    pub(crate) fn find(&self) -> Result<Box<dyn EngineKind>, Failure> {
        match self.engine.as_str() {
            #[cfg(feature = "gpu")]
            "gpu" => Ok(Box::new(sphorge_gpu::Gpu { device: self.device.clone() })),
            "cpu" if self.device.is_some() => Err(Failure::bad_input(
                "`--device` chooses a graphics card, and the processor is to compute".to_owned(),
                "add `--engine gpu`, or leave `--device` out".to_owned(),
            )),
            "cpu" => Ok(Box::new(Cpu)),
            #[cfg(not(feature = "gpu"))]
            "gpu" => Err(Failure::bad_input(
                "this program has no engine for graphics cards: it was built without".to_owned(),
                "build it with `cargo build --release --features gpu`, or choose `--engine cpu`".to_owned(),
            )),
            name => {
                let known = if cfg!(feature = "gpu") { "`cpu` and `gpu`" } else { "`cpu`" };
                Err(Failure::bad_input(
                    format!("there is no engine `{name}`"),
                    format!("choose from {known}: `--engine cpu`"),
                ))
            }
        }
    }
}
