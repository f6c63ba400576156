//! What computes: arguments of the commands that run a deck.

use crate::failure::Failure;
use clap::Args;
use sphorge::bench::KernelClock;
use sphorge::engine::{Cpu, EngineKind};
use std::sync::Arc;

/// The engines of this program.
pub(crate) fn engines(device: Option<&str>) -> Vec<Arc<dyn EngineKind>> {
    let _ = device;
    vec![
        Arc::new(Cpu),
        #[cfg(feature = "gpu")]
        Arc::new(sphorge_gpu::Gpu { device: device.map(str::to_owned), number: 0, profile: None }),
    ]
}

/// The engines of which several can share a run; those of a card take the one of a number among cards that are alike.
#[cfg(feature = "mpi")]
pub(crate) fn part_kinds(device: Option<&str>, number: usize) -> Vec<Arc<dyn sphorge::engine::PartKind>> {
    let _ = (device, number);
    vec![
        Arc::new(Cpu),
        #[cfg(feature = "gpu")]
        Arc::new(sphorge_gpu::Gpu { device: device.map(str::to_owned), number, profile: None }),
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
        "this program was built without the engine for graphics cards".to_owned(),
        "build the program with `cargo build --release --features gpu`, or the package for Python with `maturin build --features gpu` in \
         crates/sphorge-py; or run on the processor with `--engine cpu`"
            .to_owned(),
    )
}

/// What computes.
#[derive(Clone, Debug, Args)]
pub(crate) struct EngineArguments {
    /// Engine: `cpu`, or `gpu` for a graphics card (only in programs built with `--features gpu`)
    #[arg(long, value_name = "ENGINE", default_value_t = Cpu.name().to_owned())]
    engine: String,
    /// Graphics card to use, by words of its name or interface, such as `nvidia` or `vulkan` [default: the first that `sphorge devices` lists]
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
}

/// The engine of a name, `cpu` or `gpu`, as `--engine` and `--device` choose it.
///
/// # Errors
/// There is no such engine in this program, or a card is named for the processor.
pub fn engine_of(engine: &str, device: Option<&str>) -> Result<Arc<dyn EngineKind>, miette::Report> {
    let arguments = EngineArguments { engine: engine.to_owned(), device: device.map(str::to_owned) };
    arguments.find().map_err(|failure| match failure {
        Failure::BadInput(report) | Failure::Failed(report) => report,
        Failure::Told => miette::miette!("the engine cannot be used"),
        #[cfg(feature = "mpi")]
        Failure::ToldOfBadInput => miette::miette!("the engine cannot be used"),
    })
}

/// What a card can do at most.
#[derive(Clone, Debug, serde::Serialize)]
pub(crate) struct CardLimits {
    /// Its name.
    pub(crate) name: String,
    /// Bytes that a copy reads and writes in a second.
    pub(crate) bytes_per_second: f64,
    /// Operations per second of products that are added to something, two each.
    pub(crate) operations_per_second: f64,
    /// Seconds of a launch that does next to nothing, waited for.
    pub(crate) launch_seconds: f64,
}

/// What times the kernels of a card.
pub(crate) struct KernelTimes {
    pub(crate) limits: CardLimits,
    pub(crate) clock: KernelClock,
}

impl EngineArguments {
    /// Words of the name of the card, where some are given.
    pub(crate) fn device(&self) -> Option<&str> {
        self.device.as_deref()
    }

    /// What times single kernels, where the engine has such.
    pub(crate) fn kernel_times(&self) -> Result<Option<KernelTimes>, Failure> {
        #[cfg(feature = "gpu")]
        if self.engine == "gpu" {
            return of_card(self.device.as_deref()).map(Some);
        }
        Ok(None)
    }

    /// Its name, where it is not the default one.
    pub(crate) fn unusual(&self) -> Option<&str> {
        (self.engine != Cpu.name()).then_some(self.engine.as_str())
    }

    /// The engine of that name.
    pub(crate) fn find(&self) -> Result<Arc<dyn EngineKind>, Failure> {
        let name = self.engine.as_str();
        if name == Cpu.name() && self.device.is_some() {
            return Err(Failure::bad_input(
                "`--device` selects a graphics card, but the engine is `cpu`".to_owned(),
                "add `--engine gpu`, or leave out `--device`".to_owned(),
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

/// Measures what a card can do, and makes an engine that can wait for each of its kernels.
#[cfg(feature = "gpu")]
fn of_card(device: Option<&str>) -> Result<KernelTimes, Failure> {
    use sphorge::bench::KernelRow;
    use sphorge_gpu::Gpu;
    use sphorge_gpu::device::{Card, CardFault, Profile};

    let failed = |fault: CardFault| match fault {
        CardFault::NotFound { what, help } => Failure::bad_input(what, help),
        fault => Failure::bad_input(fault.to_string(), "`sphorge devices` lists the cards".to_owned()),
    };
    let card = Card::open(device).map_err(failed)?;
    let measured = card.yardstick().map_err(failed)?;
    let limits = CardLimits {
        name: card.found().title(),
        bytes_per_second: measured.bytes_per_second,
        operations_per_second: measured.operations_per_second,
        launch_seconds: measured.launch_seconds,
    };
    let profile = Profile::default();
    profile.pause(true);
    let (pausing, clearing, taking) = (profile.clone(), profile.clone(), profile.clone());
    let take = move |steps: u64| {
        let times = taking.take();
        let all: f64 = times.iter().map(|of| of.seconds).sum();
        let row = |of: sphorge_gpu::device::KernelTime| {
            let seconds = of.seconds / of.launches as f64;
            KernelRow {
                launches_per_step: of.launches as f64 / steps.max(1) as f64,
                seconds,
                share: of.seconds / all,
                bytes: of.work.map(|work| work.bytes),
                operations: of.work.map(|work| work.operations),
                share_of_bandwidth: of.work.map(|work| work.bytes / seconds / measured.bytes_per_second),
                share_of_arithmetic: of.work.map(|work| work.operations / seconds / measured.operations_per_second),
                kernel: of.kernel,
            }
        };
        times.into_iter().map(row).collect()
    };
    let clock = KernelClock {
        engine: Arc::new(Gpu { device: device.map(str::to_owned), number: 0, profile: Some(profile) }),
        pause: Arc::new(move |is_paused| pausing.pause(is_paused)),
        clear: Arc::new(move || clearing.clear()),
        take: Arc::new(take),
    };
    Ok(KernelTimes { limits, clock })
}
