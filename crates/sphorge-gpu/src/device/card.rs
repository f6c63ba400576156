//! A GPU that is open: its memory, kernels compiled for it, and launches.

use super::found::{Candidate, find_called};
use super::graphics::{self, Graphics};
use super::host::{self, Host};
use super::{CardFault, Found, Memory, Profile, cuda};
use crate::record::Kernel;
use crate::source;
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A GPU that is open.
#[derive(Debug)]
pub struct Card {
    found: Found,
    way: Way,
    /// Kernels by their text: lists that grow are bound anew, not compiled.
    compiled: Mutex<HashMap<String, Compiled>>,
    /// Where times of kernels go, if they are asked for.
    profile: Option<Profile>,
    /// What threads count then, of all launches: each is read before the next. The longest there was.
    counts: Mutex<Option<Arc<Array>>>,
}

/// How a GPU is reached.
#[derive(Debug)]
enum Way {
    Cuda(cuda::Cuda),
    Graphics(Graphics),
    Host(Host),
}

/// A kernel compiled for a GPU.
#[derive(Clone, Debug)]
pub struct Program {
    name: String,
    compiled: Compiled,
    /// What it was made of, where times are asked for.
    kernel: Option<Arc<Kernel>>,
}

#[derive(Clone, Debug)]
enum Compiled {
    Cuda(cuda::Compiled),
    Graphics(graphics::Pipeline),
    Host(host::Compiled),
}

/// A kernel with its buffers.
#[derive(Debug)]
pub struct Launch {
    name: String,
    bound: Bound,
    /// What counts what it does is made of these when that is asked for, where times are.
    counting: Option<Counting>,
}

/// A kernel and its buffers, for so many threads.
#[derive(Debug)]
struct Counting {
    kernel: Arc<Kernel>,
    arrays: Vec<Array>,
    threads: u32,
}

#[derive(Debug)]
enum Bound {
    Cuda(cuda::Bound),
    Graphics(graphics::Bound),
    Host(host::Bound),
}

/// Numbers or whole numbers in the memory of a GPU.
#[derive(Debug)]
pub struct Array {
    buffer: Buffer,
    /// Number of elements, of four bytes each.
    count: usize,
}

#[derive(Clone, Debug)]
enum Buffer {
    Cuda(Arc<cuda::Block>),
    Graphics(wgpu::Buffer),
    Host(Arc<host::Column>),
}

impl Array {
    /// Number of elements.
    pub fn count(&self) -> usize {
        self.count
    }
}

/// Numbers on their way from a GPU, which goes on meanwhile.
#[derive(Debug)]
pub struct Pending {
    copying: Copying,
    /// Where it is counted whether they are waited for, and the place of the copies in the queue.
    counted: Option<(Profile, u64)>,
}

/// Memory for numbers that are copied from a GPU while it goes on, of one array behind the other.
#[derive(Debug)]
pub struct Reservation {
    copying: Copying,
    /// Numbers that there is room for, and those that copies were queued for.
    count: usize,
    filled: usize,
}

#[derive(Debug)]
enum Copying {
    Nothing,
    Cuda(cuda::Copying),
    Graphics(graphics::Copying),
    Host(host::Copying),
}

impl Reservation {
    fn close(mut self) -> Pending {
        match &mut self.copying {
            _ if self.filled == 0 => self.copying = Copying::Nothing,
            Copying::Nothing | Copying::Host(_) => {}
            Copying::Cuda(copying) => copying.close(),
            Copying::Graphics(copying) => copying.close(),
        }
        Pending { copying: self.copying, counted: None }
    }
}

impl Pending {
    /// The numbers, when they are there.
    ///
    /// # Errors
    /// The GPU does not answer, or something that was asked of it before went wrong.
    pub fn wait(self) -> Result<Vec<f32>, CardFault> {
        if let Some((profile, place)) = self.counted {
            profile.wait_for(place);
        }
        match self.copying {
            Copying::Nothing => Ok(Vec::new()),
            Copying::Cuda(copying) => copying.wait(),
            Copying::Graphics(copying) => copying.wait(),
            Copying::Host(copying) => copying.wait(),
        }
    }
}

/// Numbers that a thread counts: those it reads and writes, and its arithmetic.
const COUNTED: usize = 2;

/// What is of one GPU is used with another.
const OTHER_CARD: &str = "it is of another card";

impl Card {
    /// Opens a GPU: the first whose name and interface contain all requested words, in any case, or the first of all.
    ///
    /// # Errors
    /// There is none, or it does not open.
    pub fn open(asked: Option<&str>) -> Result<Self, CardFault> {
        Self::open_number(asked, 0)
    }

    /// The same of a number among those that are asked for and are like the first of them, from the first again where there are fewer.
    ///
    /// # Errors
    /// See [`Self::open`].
    pub fn open_number(asked: Option<&str>, number: usize) -> Result<Self, CardFault> {
        let chosen = find_called(asked, number).map_err(|(what, help)| CardFault::NotFound { what, help })?;
        let mut found = chosen.found().clone();
        let way = match &chosen {
            Candidate::Cuda(candidate) => Way::Cuda(candidate.open()?),
            Candidate::Graphics(adapter, _) => Way::Graphics(Graphics::open(adapter)?),
            Candidate::Host(_) => Way::Host(Host::open()),
        };
        if let Way::Cuda(cuda) = &way {
            found.memory = cuda.memory().or(found.memory);
        }
        Ok(Self { found, way, compiled: Mutex::default(), profile: None, counts: Mutex::default() })
    }

    /// Times every kernel from here on, each by itself.
    #[must_use]
    pub fn profiled(self, profile: Profile) -> Self {
        Self { profile: Some(profile), ..self }
    }

    /// Bytes that times of kernels take of its memory, for so many threads.
    pub fn profile_bytes(&self, threads: usize) -> usize {
        if self.profile.is_some() { 4 * COUNTED * threads } else { 0 }
    }

    /// Memory for what so many threads count.
    fn counts(&self, threads: usize) -> Result<Arc<Array>, CardFault> {
        let mut longest = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        match longest.as_ref().filter(|known| known.count() >= COUNTED * threads) {
            Some(known) => Ok(known.clone()),
            None => Ok(longest.insert(Arc::new(self.zeros(COUNTED * threads)?)).clone()),
        }
    }

    /// Launches a kernel that counts what it does, compiled for that: numbers that its threads read or write, and their arithmetic.
    fn count(&self, of: &Counting) -> Result<[f64; COUNTED], CardFault> {
        let kernel = of.kernel.counted();
        let refused = |why| CardFault::Kernel { kernel: kernel.name.clone(), why };
        let compiled = self.compiled(&kernel).map_err(refused)?;
        let counts = self.counts(of.threads as usize)?;
        let arrays: Vec<_> = of.arrays.iter().chain([&*counts]).collect();
        self.launch_all([&self.bound(&compiled, &arrays, of.threads).map_err(refused)?]);
        let numbers = self.copy_back(&counts, COUNTED * of.threads as usize)?;
        Ok(std::array::from_fn(|k| numbers.chunks_exact(COUNTED).map(|of| f64::from(of[k])).sum()))
    }

    /// What it is, and what of its memory was free when it was opened.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// Its memory now, where its driver says.
    pub fn memory(&self) -> Option<Memory> {
        match &self.way {
            Way::Cuda(cuda) => cuda.memory(),
            Way::Graphics(_) | Way::Host(_) => self.found.memory,
        }
    }

    /// Memory for that many elements, all zero.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn zeros(&self, count: usize) -> Result<Array, CardFault> {
        // No binding is empty.
        let bytes = 4 * count.max(1) as u64;
        let refused = |why| CardFault::Memory { name: self.found.name.clone(), bytes, why };
        if u32::try_from(count).is_err() {
            return Err(refused(format!("kernels count up to {} numbers of a column", u32::MAX)));
        }
        let buffer = match &self.way {
            Way::Cuda(cuda) => cuda.zeros(bytes).map(Buffer::Cuda),
            Way::Graphics(graphics) => graphics.zeros(bytes).map(Buffer::Graphics),
            Way::Host(host) => host.zeros(bytes).map(Buffer::Host),
        };
        Ok(Array { buffer: buffer.map_err(refused)?, count })
    }

    /// Numbers, copied to the GPU.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn numbers(&self, numbers: &[f32]) -> Result<Array, CardFault> {
        let array = self.zeros(numbers.len())?;
        self.write_bytes(&array, bytemuck::cast_slice(numbers));
        Ok(array)
    }

    /// Whole numbers, copied to the GPU.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn indices(&self, indices: &[u32]) -> Result<Array, CardFault> {
        let array = self.zeros(indices.len())?;
        self.write_bytes(&array, bytemuck::cast_slice(indices));
        Ok(array)
    }

    /// Overwrites the first numbers of an array, after everything that was launched.
    pub fn write(&self, array: &Array, numbers: &[f32]) {
        self.write_bytes(array, bytemuck::cast_slice(&numbers[..numbers.len().min(array.count)]));
    }

    /// The same of whole numbers.
    pub fn write_indices(&self, array: &Array, indices: &[u32]) {
        self.write_bytes(array, bytemuck::cast_slice(&indices[..indices.len().min(array.count)]));
    }

    fn write_bytes(&self, array: &Array, bytes: &[u8]) {
        match (&self.way, &array.buffer) {
            (Way::Cuda(cuda), Buffer::Cuda(block)) => cuda.write(block, bytes),
            (Way::Graphics(graphics), Buffer::Graphics(buffer)) => graphics.write(buffer, bytes),
            (Way::Host(host), Buffer::Host(column)) => host.write(column, bytes),
            _ => debug_assert!(false, "{OTHER_CARD}"),
        }
    }

    /// Compiles a kernel, or takes what was made of its text before.
    ///
    /// # Errors
    /// The driver does not take it.
    pub fn compile(&self, kernel: &Kernel) -> Result<Program, CardFault> {
        let refused = |why| CardFault::Kernel { kernel: kernel.name.clone(), why };
        let compiled = self.compiled(kernel).map_err(refused)?;
        let of_counts = self.profile.as_ref().map(|_| Arc::new(kernel.clone()));
        Ok(Program { name: kernel.name.clone(), compiled, kernel: of_counts })
    }

    fn compiled(&self, kernel: &Kernel) -> Result<Compiled, String> {
        let text = match &self.way {
            Way::Cuda(_) => source::cuda(kernel),
            Way::Graphics(_) => source::wgsl(kernel),
            // There is no text, and this is as fast as to look whether there is one.
            Way::Host(host) => return Ok(Compiled::Host(host.compile(kernel))),
        };
        let known = || self.compiled.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(compiled) = known().get(&text) {
            return Ok(compiled.clone());
        }
        // Others may compile meanwhile.
        let compiled = match &self.way {
            Way::Cuda(cuda) => Compiled::Cuda(cuda.compile(kernel, &text)?),
            Way::Graphics(graphics) => Compiled::Graphics(graphics.compile(kernel, &text)?),
            Way::Host(host) => Compiled::Host(host.compile(kernel)),
        };
        known().insert(text, compiled.clone());
        Ok(compiled)
    }

    /// Compiles kernels side by side, so that each is there when it is asked for. What fails is reported then.
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
    /// There is not enough memory for the arguments, or the buffers are not those of the kernel.
    pub fn bind(&self, program: &Program, arrays: &[&Array], threads: u32) -> Result<Launch, CardFault> {
        let refused = |why| CardFault::Kernel { kernel: program.name.clone(), why };
        let bound = self.bound(&program.compiled, arrays, threads).map_err(refused)?;
        let counting = program.kernel.clone().map(|kernel| {
            let arrays =
                arrays.iter().map(|array| Array { buffer: array.buffer.clone(), count: array.count }).collect();
            Counting { kernel, arrays, threads }
        });
        Ok(Launch { name: program.name.clone(), bound, counting })
    }

    fn bound(&self, compiled: &Compiled, arrays: &[&Array], threads: u32) -> Result<Bound, String> {
        match (&self.way, compiled) {
            (Way::Cuda(cuda), Compiled::Cuda(of)) => {
                let block = |array: &&Array| match &array.buffer {
                    Buffer::Cuda(block) => Some(block.clone()),
                    _ => None,
                };
                let blocks: Option<Vec<_>> = arrays.iter().map(block).collect();
                cuda.bind(of, blocks.ok_or(OTHER_CARD)?, threads).map(Bound::Cuda)
            }
            (Way::Graphics(graphics), Compiled::Graphics(of)) => {
                let buffer = |array: &&Array| match &array.buffer {
                    Buffer::Graphics(buffer) => Some(buffer.clone()),
                    _ => None,
                };
                let buffers: Option<Vec<_>> = arrays.iter().map(buffer).collect();
                graphics.bind(of, &buffers.ok_or(OTHER_CARD)?, threads).map(Bound::Graphics)
            }
            (Way::Host(host), Compiled::Host(of)) => {
                let column = |array: &&Array| match &array.buffer {
                    Buffer::Host(column) => Some(column.clone()),
                    _ => None,
                };
                let columns: Option<Vec<_>> = arrays.iter().map(column).collect();
                host.bind(of, columns.ok_or(OTHER_CARD)?, threads).map(Bound::Host)
            }
            _ => Err(OTHER_CARD.to_owned()),
        }
    }

    /// Launches kernels one after the other, each when what the last has written is there.
    pub fn launch<'a>(&self, launches: impl IntoIterator<Item = &'a Launch>) {
        let bounds = launches.into_iter();
        let Some(profile) = self.profile.as_ref().filter(|profile| !profile.is_paused()) else {
            return self.launch_all(bounds.map(|launch| &launch.bound));
        };
        for launch in bounds {
            let counting = launch.counting.as_ref().filter(|_| profile.counts_next(&launch.name));
            if let Some([numbers, operations]) = counting.and_then(|of| self.count(of).ok()) {
                profile.count(&launch.name, numbers, operations);
                continue;
            }
            // What goes wrong is reported by the next read.
            if let Ok(seconds) = self.time([launch]) {
                profile.add(&launch.name, seconds);
            }
        }
    }

    fn launch_all<'a>(&self, bounds: impl IntoIterator<Item = &'a Bound>) {
        let bounds = bounds.into_iter();
        match &self.way {
            Way::Cuda(cuda) => cuda.launch(bounds.filter_map(|bound| match bound {
                Bound::Cuda(bound) => Some(bound),
                _ => None,
            })),
            Way::Graphics(graphics) => graphics.launch(bounds.filter_map(|bound| match bound {
                Bound::Graphics(bound) => Some(bound),
                _ => None,
            })),
            Way::Host(host) => host.launch(bounds.filter_map(|bound| match bound {
                Bound::Host(bound) => Some(bound),
                _ => None,
            })),
        }
    }

    /// Seconds that launches take, waited for: by the clock of the GPU with CUDA, else by that of the processor, which counts the wait as well.
    ///
    /// # Errors
    /// The GPU does not answer.
    pub fn time<'a>(&self, launches: impl IntoIterator<Item = &'a Launch>) -> Result<f64, CardFault> {
        let bounds = launches.into_iter().map(|launch| &launch.bound);
        match &self.way {
            Way::Cuda(cuda) => cuda.time(|| self.launch_all(bounds)),
            Way::Graphics(graphics) => {
                graphics.wait()?;
                let start = std::time::Instant::now();
                self.launch_all(bounds);
                graphics.wait()?;
                Ok(start.elapsed().as_secs_f64())
            }
            Way::Host(_) => {
                let start = std::time::Instant::now();
                self.launch_all(bounds);
                Ok(start.elapsed().as_secs_f64())
            }
        }
    }

    /// Memory for so many numbers that are copied back while the GPU goes on; none where there is no page-locked memory for it.
    ///
    /// # Errors
    /// The GPU does not answer.
    pub fn reserve(&self, count: usize) -> Result<Option<Reservation>, CardFault> {
        let copying = match &self.way {
            _ if count == 0 => Copying::Nothing,
            Way::Cuda(cuda) => match cuda.reserve(count)? {
                Some(copying) => Copying::Cuda(copying),
                None => return Ok(None),
            },
            Way::Graphics(graphics) => Copying::Graphics(graphics.reserve(count)),
            Way::Host(host) => Copying::Host(host.reserve(count)),
        };
        Ok(Some(Reservation { copying, count, filled: 0 }))
    }

    /// Queues a copy of the first numbers of an array behind everything that was launched. They come behind those that were added before.
    ///
    /// # Errors
    /// There is not enough memory for them, or the array is of another GPU.
    pub fn add(&self, reservation: &mut Reservation, array: &Array, count: usize) -> Result<(), CardFault> {
        if count == 0 {
            return Ok(());
        }
        let refused = |why: &str| CardFault::Lost { name: self.found.name.clone(), why: why.to_owned() };
        if count > array.count.min(reservation.count - reservation.filled) {
            return Err(refused("more numbers are copied than there is room for"));
        }
        match (&mut reservation.copying, &array.buffer) {
            (Copying::Cuda(copying), Buffer::Cuda(block)) => copying.add(block, count),
            (Copying::Graphics(copying), Buffer::Graphics(buffer)) => copying.add(buffer, count),
            (Copying::Host(copying), Buffer::Host(column)) => copying.add(column, count),
            _ => return Err(refused(OTHER_CARD)),
        }
        reservation.filled += count;
        Ok(())
    }

    /// What was added to a room, on its way.
    pub fn pending(&self, reservation: Reservation) -> Pending {
        let of_all = |profile: &Profile| {
            profile.add_read(4 * reservation.filled as u64);
            (profile.clone(), profile.queue_copy())
        };
        Pending { counted: self.profile.as_ref().map(of_all), ..reservation.close() }
    }

    /// Queues a copy of numbers behind everything that was launched, and goes on; none where there is no page-locked memory for it. It is not counted.
    ///
    /// # Errors
    /// The GPU does not answer.
    pub fn queue_read(&self, array: &Array) -> Result<Option<Pending>, CardFault> {
        let Some(mut reservation) = self.reserve(array.count)? else { return Ok(None) };
        self.add(&mut reservation, array, array.count)?;
        Ok(Some(reservation.close()))
    }

    /// Copies numbers back, after everything that was launched.
    ///
    /// # Errors
    /// The GPU does not answer, or something that was asked of it before went wrong.
    pub fn read(&self, array: &Array) -> Result<Vec<f32>, CardFault> {
        self.read_first(array, array.count)
    }

    /// The same of the first numbers.
    ///
    /// # Errors
    /// As above.
    pub fn read_first(&self, array: &Array, count: usize) -> Result<Vec<f32>, CardFault> {
        let count = count.min(array.count);
        if let Some(profile) = self.profile.as_ref().filter(|_| count > 0) {
            profile.add_read(4 * count as u64);
            profile.wait_for(profile.queue_copy());
        }
        self.copy_back(array, count)
    }

    fn copy_back(&self, array: &Array, count: usize) -> Result<Vec<f32>, CardFault> {
        if count == 0 {
            return Ok(Vec::new());
        }
        match (&self.way, &array.buffer) {
            (Way::Cuda(cuda), Buffer::Cuda(block)) => cuda.read(block, count),
            (Way::Graphics(graphics), Buffer::Graphics(buffer)) => graphics.read(buffer, count),
            (Way::Host(host), Buffer::Host(column)) => host.read(column, count),
            _ => Err(CardFault::Lost { name: self.found.name.clone(), why: OTHER_CARD.to_owned() }),
        }
    }
}

#[cfg(test)]
impl Array {
    /// Takes the memory of an array away, as a GPU that is lost does. With CUDA that would end every GPU of the process.
    pub(crate) fn destroy(&self) {
        match &self.buffer {
            Buffer::Graphics(buffer) => buffer.destroy(),
            Buffer::Host(column) => column.destroy(),
            Buffer::Cuda(_) => {}
        }
    }
}
