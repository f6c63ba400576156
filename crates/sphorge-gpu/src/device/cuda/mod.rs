//! GPUs that NVIDIA's CUDA driver reaches. Nothing of CUDA is needed to build or to start the program: driver and compiler are loaded where they are there.

mod compile;
mod context;
mod library;

use super::deferred_error::DeferredError;
use super::{CardFault, Found, Interface, Memory, Missing};
use crate::record::Kernel;
use crate::source::WORKGROUP;
use compile::{Architecture, advice, compile};
use context::{Context, Event, Function, HostCopy, described};
use cudarc::driver::result::{self, DriverError};
use cudarc::driver::sys::{self, CUdevice, CUdevice_attribute};
use library::Versions;
use rayon::prelude::*;
use std::sync::Arc;

pub(in crate::device) use context::Block;
pub use library::NVRTC_FOLDER;

/// Numbers that a thread touches at a time.
const TOUCHED: usize = 1 << 18;

/// A GPU that is open.
#[derive(Debug)]
pub(super) struct Cuda {
    name: String,
    versions: Versions,
    architecture: Architecture,
    context: Arc<Context>,
    /// The first thing that went wrong with a launch or a copy. They are reported by the next wait.
    deferred_error: DeferredError,
}

/// A kernel with its memory.
#[derive(Debug)]
pub(super) struct Bound {
    function: Arc<Function>,
    blocks: Vec<Arc<Block>>,
    threads: u32,
}

/// A kernel compiled for a GPU.
#[derive(Clone, Debug)]
pub(super) struct Compiled {
    function: Arc<Function>,
    /// How many it is bound to.
    buffers: usize,
}

/// A GPU by its number, and what it is.
pub(super) struct Candidate {
    number: i32,
    pub(super) found: Found,
}

fn device(number: i32) -> Result<CUdevice, DriverError> {
    result::device::get(number)
}

fn attribute(device: CUdevice, of: CUdevice_attribute) -> Result<i32, DriverError> {
    // SAFETY: the device is one the driver has given.
    unsafe { result::device::get_attribute(device, of) }
}

/// Ten times the compute capability.
fn capability(device: CUdevice) -> Result<i32, DriverError> {
    let major = attribute(device, CUdevice_attribute::CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR)?;
    let minor = attribute(device, CUdevice_attribute::CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MINOR)?;
    Ok(10 * major + minor)
}

/// Every GPU that driver and compiler serve, in the driver's order, which is the fastest first.
///
/// # Errors
/// There is no driver, no GPU or no compiler.
pub(super) fn candidates() -> Result<Vec<Candidate>, Missing> {
    let versions = library::reach()?;
    let silent = |error: DriverError| Missing {
        interface: Interface::Cuda,
        why: format!("NVIDIA's driver does not list its cards: {}", described(error)),
        cure: "see what `nvidia-smi` says".to_owned(),
    };
    let candidate = |number: i32| -> Result<Option<Candidate>, DriverError> {
        let of = device(number)?;
        // SAFETY: the device is one the driver has given.
        let total = unsafe { result::device::total_mem(of) }? as u64;
        let capability = capability(of)?;
        // GPUs that the compiler does not know are left to other routes.
        if Architecture::of(capability).is_err() {
            return Ok(None);
        }
        let Versions { driver, compiler } = versions;
        let found = Found {
            name: result::device::get_name(of)?,
            interface: Interface::Cuda,
            driver: format!(
                "CUDA {}.{}, NVRTC {}.{}, compute capability {}.{}",
                driver.0,
                driver.1,
                compiler.0,
                compiler.1,
                capability / 10,
                capability % 10
            ),
            is_software: false,
            largest_buffer: total,
            // What is free, a context must be asked for.
            memory: Some(Memory { total, free: None }),
        };
        Ok(Some(Candidate { number, found }))
    };
    let count = result::device::get_count().map_err(silent)?;
    // One GPU that does not answer hides no other.
    let (known, silent_ones): (Vec<_>, Vec<_>) = (0..count).map(candidate).partition(Result::is_ok);
    let known: Vec<Candidate> = known.into_iter().flatten().flatten().collect();
    match silent_ones.into_iter().find_map(Result::err) {
        Some(error) if known.is_empty() => Err(silent(error)),
        None if known.is_empty() => Err(Missing {
            interface: Interface::Cuda,
            why: "NVRTC does not support the NVIDIA cards of this machine".to_owned(),
            cure: "install an NVRTC that supports them, such as that of CUDA 12 for cards older than Turing".to_owned(),
        }),
        _ => Ok(known),
    }
}

impl Candidate {
    pub(super) fn open(&self) -> Result<Cuda, CardFault> {
        let refused = |why: String| CardFault::DoesNotOpen { name: self.found.name.clone(), why };
        let by_driver = |error: DriverError| refused(described(error));
        let device = device(self.number).map_err(by_driver)?;
        let versions = library::reach().map_err(|missing| refused(missing.why))?;
        let architecture = Architecture::of(capability(device).map_err(by_driver)?).map_err(refused)?;
        let context = Context::new(device).map_err(by_driver)?;
        let name = self.found.name.clone();
        Ok(Cuda { name, versions, architecture, context, deferred_error: DeferredError::default() })
    }
}

impl Cuda {
    /// Free and all memory, where the driver says.
    pub(super) fn memory(&self) -> Option<Memory> {
        let (free, total) = self.context.memory().ok()?;
        Some(Memory { total: total as u64, free: Some(free as u64) })
    }

    pub(super) fn zeros(&self, bytes: u64) -> Result<Arc<Block>, String> {
        Block::zeros(&self.context, bytes as usize).map(Arc::new).map_err(|error| match (error.0, self.memory()) {
            (sys::CUresult::CUDA_ERROR_OUT_OF_MEMORY, Some(Memory { total, free: Some(free) })) => {
                format!("{free} of its {total} bytes are free")
            }
            _ => described(error),
        })
    }

    pub(super) fn write(&self, block: &Block, bytes: &[u8]) {
        self.note(block.write(bytes));
    }

    pub(super) fn compile(&self, kernel: &Kernel, text: &str) -> Result<Compiled, String> {
        let code = compile(&kernel.name, text, &self.architecture)?;
        let function = Function::load(&self.context, &kernel.name, &code)
            .map_err(|error| format!("{}{}", described(error), advice(self.versions)))?;
        Ok(Compiled { function: Arc::new(function), buffers: kernel.buffers.len() })
    }

    pub(super) fn bind(&self, of: &Compiled, blocks: Vec<Arc<Block>>, threads: u32) -> Result<Bound, String> {
        if blocks.len() != of.buffers {
            return Err(format!("it has {} buffers, and {} are given", of.buffers, blocks.len()));
        }
        Ok(Bound { function: of.function.clone(), blocks, threads })
    }

    pub(super) fn launch<'a>(&self, launches: impl Iterator<Item = &'a Bound>) {
        for launch in launches {
            self.note(launch.function.launch(&launch.blocks, launch.threads, WORKGROUP));
        }
    }

    /// Seconds that what is launched takes on the GPU.
    pub(super) fn time(&self, launch: impl FnOnce()) -> Result<f64, CardFault> {
        let lost = |error| self.lost(&described(error));
        let start = Event::now(&self.context).map_err(lost)?;
        launch();
        let end = Event::now(&self.context).map_err(lost)?;
        end.since(&start).map_err(lost)
    }

    pub(super) fn read(&self, block: &Block, count: usize) -> Result<Vec<f32>, CardFault> {
        let mut numbers = vec![0.0f32; count];
        // Memory that has just been taken is provided page by page when it is touched: on all threads, not on the one that the driver copies by.
        numbers.par_chunks_mut(TOUCHED).for_each(|numbers| numbers.fill(0.0));
        let read = block.read(bytemuck::cast_slice_mut(&mut numbers));
        if let Some(why) = self.deferred_error.first() {
            return Err(self.lost(&why));
        }
        read.map_err(|error| self.lost(&described(error)))?;
        Ok(numbers)
    }

    /// Memory for so many numbers that are copied back while the GPU goes on; none where there is no memory for it.
    pub(super) fn reserve(&self, count: usize) -> Result<Option<Copying>, CardFault> {
        let copy = HostCopy::reserve(&self.context, 4 * count).map_err(|error| self.lost(&described(error)))?;
        let (name, deferred_error) = (self.name.clone(), self.deferred_error.clone());
        Ok(copy.map(|copy| Copying { name, deferred_error, copy, count: 0 }))
    }

    fn note(&self, done: Result<(), DriverError>) {
        if let Err(error) = done {
            self.deferred_error.keep(described(error));
        }
    }

    fn lost(&self, why: &dyn std::fmt::Display) -> CardFault {
        CardFault::Lost { name: self.name.clone(), why: why.to_string() }
    }
}

/// Numbers on their way from a GPU.
#[derive(Debug)]
pub(super) struct Copying {
    name: String,
    deferred_error: DeferredError,
    copy: HostCopy,
    count: usize,
}

impl Copying {
    /// Queues a copy of the first numbers of a block behind everything that was asked for.
    pub(super) fn add(&mut self, block: &Block, count: usize) {
        self.count += count;
        if let Err(error) = self.copy.add(block, 4 * count) {
            self.deferred_error.keep(described(error));
        }
    }

    /// Nothing is added any more.
    pub(super) fn close(&mut self) {
        if let Err(error) = self.copy.close() {
            self.deferred_error.keep(described(error));
        }
    }

    /// The numbers, when they are there.
    pub(super) fn wait(self) -> Result<Vec<f32>, CardFault> {
        let lost = |why: String| CardFault::Lost { name: self.name.clone(), why };
        let mut numbers = vec![0.0f32; self.count];
        let copied = self.copy.wait(bytemuck::cast_slice_mut(&mut numbers));
        if let Some(why) = self.deferred_error.first() {
            return Err(lost(why));
        }
        copied.map_err(|error| lost(described(error)))?;
        Ok(numbers)
    }
}
