//! A card that is open: its memory, kernels compiled for it, and launches.

use super::found::{Candidate, candidates, choose};
use super::graphics::{self, Graphics};
use super::{CardFault, Found, Memory, Profile, cuda};
use crate::record::Kernel;
use crate::source;
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A card that is open.
#[derive(Debug)]
pub struct Card {
    found: Found,
    way: Way,
    /// Kernels by their text: lists that grow are bound anew, not compiled.
    compiled: Mutex<HashMap<String, Compiled>>,
    /// Where times of kernels go, if they are asked for.
    profile: Option<Profile>,
}

/// How a card is reached.
#[derive(Debug)]
enum Way {
    Cuda(cuda::Cuda),
    Graphics(Graphics),
}

/// A kernel compiled for a card.
#[derive(Clone, Debug)]
pub struct Program {
    name: String,
    compiled: Compiled,
}

#[derive(Clone, Debug)]
enum Compiled {
    Cuda(cuda::Compiled),
    Graphics(graphics::Pipeline),
}

/// A kernel with its buffers.
#[derive(Debug)]
pub struct Launch {
    name: String,
    bound: Bound,
}

#[derive(Debug)]
enum Bound {
    Cuda(cuda::Bound),
    Graphics(graphics::Bound),
}

/// Numbers or whole numbers in the memory of a card.
#[derive(Debug)]
pub struct Array {
    buffer: Buffer,
    /// Number of elements, of four bytes each.
    count: usize,
}

#[derive(Debug)]
enum Buffer {
    Cuda(Arc<cuda::Block>),
    Graphics(wgpu::Buffer),
}

impl Array {
    /// Number of elements.
    pub fn count(&self) -> usize {
        self.count
    }
}

/// What is of one card is used with another.
const OTHER_CARD: &str = "it is of another card";

impl Card {
    /// Opens a card: the first of whose name and interface all words are that are asked for, whatever their case, or the first of all.
    ///
    /// # Errors
    /// There is none, or it does not open.
    pub fn open(asked: Option<&str>) -> Result<Self, CardFault> {
        let (candidates, missing) = candidates();
        let chosen = choose(asked, candidates, &missing).map_err(|(what, help)| CardFault::NotFound { what, help })?;
        let mut found = chosen.found().clone();
        let way = match &chosen {
            Candidate::Cuda(candidate) => Way::Cuda(candidate.open()?),
            Candidate::Graphics(adapter, _) => Way::Graphics(Graphics::open(adapter)?),
        };
        if let Way::Cuda(cuda) = &way {
            found.memory = cuda.memory().or(found.memory);
        }
        Ok(Self { found, way, compiled: Mutex::default(), profile: None })
    }

    /// Times every kernel from here on, each by itself.
    #[must_use]
    pub fn profiled(self, profile: Profile) -> Self {
        Self { profile: Some(profile), ..self }
    }

    /// What it is, and what of its memory was free when it was opened.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// Its memory now, where its driver says.
    pub fn memory(&self) -> Option<Memory> {
        match &self.way {
            Way::Cuda(cuda) => cuda.memory(),
            Way::Graphics(_) => self.found.memory,
        }
    }

    /// Room for that many elements, all zero.
    ///
    /// # Errors
    /// There is no room.
    pub fn zeros(&self, count: usize) -> Result<Array, CardFault> {
        // No binding is empty.
        let bytes = 4 * count.max(1) as u64;
        let buffer = match &self.way {
            Way::Cuda(cuda) => cuda.zeros(bytes).map(Buffer::Cuda),
            Way::Graphics(graphics) => graphics.zeros(bytes).map(Buffer::Graphics),
        };
        let refused = |why| CardFault::Memory { name: self.found.name.clone(), bytes, why };
        Ok(Array { buffer: buffer.map_err(refused)?, count })
    }

    /// Numbers, copied to the card.
    ///
    /// # Errors
    /// There is no room.
    pub fn numbers(&self, numbers: &[f32]) -> Result<Array, CardFault> {
        let array = self.zeros(numbers.len())?;
        self.write_bytes(&array, bytemuck::cast_slice(numbers));
        Ok(array)
    }

    /// Whole numbers, copied to the card.
    ///
    /// # Errors
    /// There is no room.
    pub fn indices(&self, indices: &[u32]) -> Result<Array, CardFault> {
        let array = self.zeros(indices.len())?;
        self.write_bytes(&array, bytemuck::cast_slice(indices));
        Ok(array)
    }

    /// Overwrites the first numbers of an array, after everything that was launched.
    pub fn write(&self, array: &Array, numbers: &[f32]) {
        self.write_bytes(array, bytemuck::cast_slice(&numbers[..numbers.len().min(array.count)]));
    }

    fn write_bytes(&self, array: &Array, bytes: &[u8]) {
        match (&self.way, &array.buffer) {
            (Way::Cuda(cuda), Buffer::Cuda(block)) => cuda.write(block, bytes),
            (Way::Graphics(graphics), Buffer::Graphics(buffer)) => graphics.write(buffer, bytes),
            _ => debug_assert!(false, "{OTHER_CARD}"),
        }
    }

    /// Compiles a kernel, or takes what was made of its text before.
    ///
    /// # Errors
    /// The driver does not take it.
    pub fn compile(&self, kernel: &Kernel) -> Result<Program, CardFault> {
        let text = match self.way {
            Way::Cuda(_) => source::cuda(kernel),
            Way::Graphics(_) => source::wgsl(kernel),
        };
        let known = self.compiled.lock().unwrap_or_else(PoisonError::into_inner).get(&text).cloned();
        let compiled = match known {
            Some(compiled) => compiled,
            None => {
                let compiled = match &self.way {
                    Way::Cuda(cuda) => cuda.compile(kernel, &text).map(Compiled::Cuda),
                    Way::Graphics(graphics) => graphics.compile(kernel, &text).map(Compiled::Graphics),
                };
                let compiled = compiled.map_err(|why| CardFault::Kernel { kernel: kernel.name.clone(), why })?;
                self.compiled.lock().unwrap_or_else(PoisonError::into_inner).insert(text, compiled.clone());
                compiled
            }
        };
        Ok(Program { name: kernel.name.clone(), compiled })
    }

    /// Compiles kernels side by side, so that each is there when it is asked for. What fails is told then.
    pub fn compile_ahead(&self, kernels: &[&Kernel]) {
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(kernels.len());
        let next = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    while let Some(kernel) = kernels.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let _ = self.compile(kernel);
                    }
                });
            }
        });
    }

    /// Binds a kernel to its buffers, in their order, for launches of that many threads.
    ///
    /// # Errors
    /// There is no room for the arguments, or the buffers are not those of the kernel.
    pub fn bind(&self, program: &Program, arrays: &[&Array], threads: u32) -> Result<Launch, CardFault> {
        let bound = match (&self.way, &program.compiled) {
            (Way::Cuda(cuda), Compiled::Cuda(of)) => {
                let block = |array: &&Array| match &array.buffer {
                    Buffer::Cuda(block) => Some(block.clone()),
                    Buffer::Graphics(_) => None,
                };
                let blocks: Option<Vec<_>> = arrays.iter().map(block).collect();
                blocks.ok_or(OTHER_CARD.to_owned()).and_then(|blocks| cuda.bind(of, blocks, threads)).map(Bound::Cuda)
            }
            (Way::Graphics(graphics), Compiled::Graphics(of)) => {
                let buffer = |array: &&'_ Array| match &array.buffer {
                    Buffer::Graphics(buffer) => Some(buffer.clone()),
                    Buffer::Cuda(_) => None,
                };
                let buffers: Option<Vec<_>> = arrays.iter().map(buffer).collect();
                buffers
                    .ok_or(OTHER_CARD.to_owned())
                    .and_then(|buffers| graphics.bind(of, &buffers, threads))
                    .map(Bound::Graphics)
            }
            _ => Err(OTHER_CARD.to_owned()),
        };
        let bound = bound.map_err(|why| CardFault::Kernel { kernel: program.name.clone(), why })?;
        Ok(Launch { name: program.name.clone(), bound })
    }

    /// Launches kernels one after the other, each when what the last has written is there.
    pub fn launch<'a>(&self, launches: impl IntoIterator<Item = &'a Launch>) {
        let Some(profile) = &self.profile else { return self.launch_all(launches) };
        for launch in launches {
            // What goes wrong is told when something is read.
            if let Ok(seconds) = self.time([launch]) {
                profile.add(&launch.name, seconds);
            }
        }
    }

    fn launch_all<'a>(&self, launches: impl IntoIterator<Item = &'a Launch>) {
        let launches = launches.into_iter();
        match &self.way {
            Way::Cuda(cuda) => cuda.launch(launches.filter_map(|launch| match &launch.bound {
                Bound::Cuda(bound) => Some(bound),
                Bound::Graphics(_) => None,
            })),
            Way::Graphics(graphics) => graphics.launch(launches.filter_map(|launch| match &launch.bound {
                Bound::Graphics(bound) => Some(bound),
                Bound::Cuda(_) => None,
            })),
        }
    }

    /// Seconds that launches take, waited for: by the clock of the card with CUDA, else by that of the processor, which counts the wait as well.
    ///
    /// # Errors
    /// The card does not answer.
    pub fn time<'a>(&self, launches: impl IntoIterator<Item = &'a Launch>) -> Result<f64, CardFault> {
        match &self.way {
            Way::Cuda(cuda) => cuda.time(launches.into_iter().filter_map(|launch| match &launch.bound {
                Bound::Cuda(bound) => Some(bound),
                Bound::Graphics(_) => None,
            })),
            Way::Graphics(graphics) => {
                graphics.wait()?;
                let start = std::time::Instant::now();
                self.launch_all(launches);
                graphics.wait()?;
                Ok(start.elapsed().as_secs_f64())
            }
        }
    }

    /// Copies numbers back, after everything that was launched.
    ///
    /// # Errors
    /// The card does not answer, or something that was asked of it before went wrong.
    pub fn read(&self, array: &Array) -> Result<Vec<f32>, CardFault> {
        match (&self.way, &array.buffer) {
            (Way::Cuda(cuda), Buffer::Cuda(block)) => cuda.read(block, array.count),
            (Way::Graphics(graphics), Buffer::Graphics(buffer)) => graphics.read(buffer, array.count),
            _ => Err(CardFault::Lost { name: self.found.name.clone(), why: OTHER_CARD.to_owned() }),
        }
    }
}

#[cfg(test)]
impl Array {
    /// Takes the memory of an array away, as a card that is lost does. With CUDA that would end every card of the process.
    pub(crate) fn destroy(&self) {
        if let Buffer::Graphics(buffer) = &self.buffer {
            buffer.destroy();
        }
    }
}
