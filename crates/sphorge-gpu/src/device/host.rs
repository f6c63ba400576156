//! The processor in place of a GPU: kernels are executed by [`sphorge_host`] when they are launched, without a driver
//! and without a compiler. It is there for tests and for looking at a fault; accesses beyond the end of a column are
//! reported.

use super::deferred_error::DeferredError;
use super::{CardFault, Found, Interface};
use crate::record::Kernel;
use crate::source::instructions;
use sphorge_host::Program;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// The word that asks for it; it is never chosen otherwise.
pub(super) const NAME: &str = "host";

/// The processor, to be used as a GPU.
#[derive(Debug)]
pub(super) struct Host {
    /// The first thing that went wrong with a launch. It is reported by the next read.
    deferred_error: DeferredError,
}

/// Numbers of a column, as their bits.
#[derive(Debug)]
pub(super) struct Column {
    numbers: Vec<AtomicU32>,
    is_lost: AtomicBool,
}

/// A kernel as it is executed.
#[derive(Clone, Debug)]
pub(super) struct Compiled {
    name: String,
    program: Arc<Program>,
}

/// A kernel with its columns.
#[derive(Debug)]
pub(super) struct Bound {
    compiled: Compiled,
    columns: Vec<Arc<Column>>,
    threads: u32,
}

/// Numbers that were copied, of one array behind the other.
#[derive(Debug)]
pub(super) struct Copying {
    numbers: Vec<f32>,
    deferred_error: DeferredError,
}

/// Whether it is asked for.
pub(super) fn is_called(asked: Option<&str>) -> bool {
    asked.is_some_and(|words| words.trim().eq_ignore_ascii_case(NAME))
}

/// What it is.
pub(super) fn found() -> Found {
    Found {
        name: "host processor".to_owned(),
        interface: Interface::Host,
        driver: String::new(),
        is_software: true,
        // Kernels number elements with 32 bits.
        largest_buffer: 4 * u64::from(u32::MAX),
        memory: None,
    }
}

fn lost(why: String) -> CardFault {
    CardFault::Lost { name: found().name, why }
}

impl Column {
    fn first(&self, count: usize) -> impl Iterator<Item = f32> {
        self.numbers[..count].iter().map(|bits| f32::from_bits(bits.load(Ordering::Relaxed)))
    }

    /// Takes the memory away, as a GPU that is lost does.
    #[cfg(test)]
    pub(super) fn destroy(&self) {
        self.is_lost.store(true, Ordering::Relaxed);
    }
}

impl Host {
    pub(super) fn open() -> Self {
        Self { deferred_error: DeferredError::default() }
    }

    pub(super) fn zeros(&self, bytes: u64) -> Result<Arc<Column>, String> {
        let count = (bytes / 4) as usize;
        let mut numbers = Vec::new();
        numbers.try_reserve_exact(count).map_err(|error| error.to_string())?;
        numbers.resize_with(count, AtomicU32::default);
        Ok(Arc::new(Column { numbers, is_lost: AtomicBool::new(false) }))
    }

    pub(super) fn write(&self, column: &Column, bytes: &[u8]) {
        for (element, bytes) in column.numbers.iter().zip(bytes.chunks_exact(4)) {
            element.store(bytemuck::pod_read_unaligned(bytes), Ordering::Relaxed);
        }
    }

    pub(super) fn compile(&self, kernel: &Kernel) -> Compiled {
        Compiled { name: kernel.name.clone(), program: Arc::new(instructions(kernel).program) }
    }

    pub(super) fn bind(&self, of: &Compiled, columns: Vec<Arc<Column>>, threads: u32) -> Result<Bound, String> {
        let count = of.program.buffers();
        if columns.len() != count {
            return Err(format!("it has {count} buffers, and {} are given", columns.len()));
        }
        Ok(Bound { compiled: of.clone(), columns, threads })
    }

    pub(super) fn launch<'a>(&self, launches: impl Iterator<Item = &'a Bound>) {
        for launch in launches {
            // As a GPU that was lost, it does nothing any more.
            if self.deferred_error.first().is_some() {
                return;
            }
            let name = &launch.compiled.name;
            if launch.columns.iter().any(|column| column.is_lost.load(Ordering::Relaxed)) {
                self.deferred_error.keep(format!("memory of kernel `{name}` is gone"));
                return;
            }
            let buffers: Vec<&[AtomicU32]> = launch.columns.iter().map(|column| &column.numbers[..]).collect();
            if let Err(beyond) = launch.compiled.program.run(&buffers, launch.threads) {
                self.deferred_error.keep(format!("kernel `{name}`: {beyond}"));
            }
        }
    }

    pub(super) fn read(&self, column: &Column, count: usize) -> Result<Vec<f32>, CardFault> {
        let mut copying = self.reserve(count);
        copying.add(column, count);
        copying.wait()
    }

    /// Memory for so many numbers that are copied.
    pub(super) fn reserve(&self, count: usize) -> Copying {
        Copying { numbers: Vec::with_capacity(count), deferred_error: self.deferred_error.clone() }
    }
}

impl Copying {
    /// Copies the first numbers of a column.
    pub(super) fn add(&mut self, column: &Column, count: usize) {
        self.numbers.extend(column.first(count));
    }

    pub(super) fn wait(self) -> Result<Vec<f32>, CardFault> {
        match self.deferred_error.first() {
            Some(why) => Err(lost(why)),
            None => Ok(self.numbers),
        }
    }
}
