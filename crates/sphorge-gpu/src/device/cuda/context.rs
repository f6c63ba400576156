//! The context of a GPU, and what is made in it.

use cudarc::driver::result::{self, DriverError};
use cudarc::driver::sys::{self, CUcontext, CUdevice, CUdeviceptr, CUevent, CUfunction, CUmodule, CUstream};
use std::collections::HashMap;
use std::ffi::{CString, c_void};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Blocks of page-locked memory that are kept for the next copy: taking and returning one makes the driver wait, and a
/// history row and the frame beside it need two.
const KEPT_BLOCKS: usize = 2;

/// Contexts of the GPUs of this process, by device, as numbers. They are retained once and until it ends: where one engine follows another, the last
/// release would destroy a context that is still the current one of other threads, while another engine asks for it anew. On an H200
/// processes with engines on two threads ended by a segmentation fault then.
static RETAINED: LazyLock<Mutex<HashMap<CUdevice, usize>>> = LazyLock::new(Mutex::default);

/// The context of a GPU.
fn retained(device: CUdevice) -> Result<CUcontext, DriverError> {
    let mut retained = RETAINED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(&context) = retained.get(&device) {
        return Ok(context as CUcontext);
    }
    // SAFETY: the device is one the driver has given.
    let context = unsafe { result::primary_ctx::retain(device) }?;
    retained.insert(device, context as usize);
    Ok(context)
}

/// A context with the one stream everything goes through.
#[derive(Debug)]
pub(super) struct Context {
    context: CUcontext,
    stream: CUstream,
    page_locked: Mutex<Vec<PageLocked>>,
}

/// Page-locked memory of the driver.
#[derive(Debug)]
struct PageLocked {
    pointer: *mut u8,
    bytes: usize,
}

// SAFETY: the driver's handles may be used on every thread on which the context is current; `enter` makes it so before each use.
unsafe impl Send for Context {}
// SAFETY: as above; calls of the driver are safe from several threads at once.
unsafe impl Sync for Context {}

impl Context {
    pub(super) fn new(device: CUdevice) -> Result<Arc<Self>, DriverError> {
        let context = retained(device)?;
        let mut new = Self { context, stream: std::ptr::null_mut(), page_locked: Mutex::default() };
        new.enter()?;
        // Nobody else waits for it.
        new.stream = result::stream::create(result::stream::StreamKind::NonBlocking)?;
        Ok(Arc::new(new))
    }

    /// Makes it the context of this thread.
    pub(super) fn enter(&self) -> Result<(), DriverError> {
        // SAFETY: the context lives as long as this.
        unsafe { result::ctx::set_current(self.context) }
    }

    /// Waits for everything that was asked for.
    pub(super) fn wait(&self) -> Result<(), DriverError> {
        self.enter()?;
        // SAFETY: the stream is one of this context.
        unsafe { result::stream::synchronize(self.stream) }
    }

    /// Page-locked memory of at least so many bytes, a kept block if one is large enough and not far too large.
    fn page_locked(&self, bytes: usize) -> Option<PageLocked> {
        let mut kept = self.page_locked.lock().unwrap_or_else(PoisonError::into_inner);
        let fits = |of: &PageLocked| (bytes..=bytes.saturating_mul(4)).contains(&of.bytes);
        if let Some(k) = kept.iter().position(fits) {
            return Some(kept.swap_remove(k));
        }
        drop(kept);
        // SAFETY: freed in `put_back` or when this is dropped.
        let pointer = unsafe { result::malloc_host(bytes, 0) }.ok()?;
        Some(PageLocked { pointer: pointer.cast(), bytes })
    }

    /// Keeps memory to which no copy is under way for the next one that needs some; what is too much is freed.
    fn put_back(&self, memory: PageLocked) {
        let mut kept = self.page_locked.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push(memory);
        if kept.len() > KEPT_BLOCKS {
            let oldest = kept.remove(0);
            drop(kept);
            // SAFETY: taken in `page_locked`, and nobody has it.
            let _ = unsafe { result::free_host(oldest.pointer.cast()) };
        }
    }

    /// Free and all memory of the GPU, bytes.
    pub(super) fn memory(&self) -> Result<(usize, usize), DriverError> {
        self.enter()?;
        result::mem_get_info()
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // There is nobody to tell of a GPU that is lost by now.
        let _ = self.enter();
        for memory in self.page_locked.get_mut().unwrap_or_else(PoisonError::into_inner).drain(..) {
            // SAFETY: taken in `page_locked`, and nobody has it.
            let _ = unsafe { result::free_host(memory.pointer.cast()) };
        }
        if !self.stream.is_null() {
            // SAFETY: made in `new`, and nothing that uses it is left: blocks and modules hold the context.
            let _ = unsafe { result::stream::destroy(self.stream) };
        }
    }
}

/// What the driver says of an error.
pub(super) fn described(error: DriverError) -> String {
    let text = |of: Result<&std::ffi::CStr, DriverError>| of.map(|text| text.to_string_lossy().into_owned()).ok();
    match (text(error.error_string()), text(error.error_name())) {
        (Some(string), Some(name)) => format!("{string} ({name})"),
        _ => format!("driver error {}", error.0 as u32),
    }
}

/// Memory of a GPU.
#[derive(Debug)]
pub(in crate::device) struct Block {
    context: Arc<Context>,
    pointer: CUdeviceptr,
    bytes: usize,
}

impl Block {
    /// Memory of so many bytes, more than none, all zero.
    pub(super) fn zeros(context: &Arc<Context>, bytes: usize) -> Result<Self, DriverError> {
        context.enter()?;
        // SAFETY: freed when this is dropped.
        let pointer = unsafe { result::malloc_sync(bytes) }?;
        let block = Self { context: context.clone(), pointer, bytes };
        // SAFETY: as long as it was asked for.
        unsafe { result::memset_d8_async(pointer, 0, bytes, context.stream) }?;
        Ok(block)
    }

    /// Overwrites the first bytes, after everything that was asked for.
    pub(super) fn write(&self, bytes: &[u8]) -> Result<(), DriverError> {
        self.context.enter()?;
        let bytes = &bytes[..bytes.len().min(self.bytes)];
        // SAFETY: within the block. The source is pageable memory, which the driver has copied when it returns.
        unsafe { result::memcpy_htod_async(self.pointer, bytes, self.context.stream) }
    }

    /// Copies the first bytes back, after everything that was asked for.
    pub(super) fn read(&self, into: &mut [u8]) -> Result<(), DriverError> {
        self.context.enter()?;
        let length = into.len().min(self.bytes);
        // SAFETY: within the block, and waited for before `into` can go.
        let copied = unsafe { result::memcpy_dtoh_async(&mut into[..length], self.pointer, self.context.stream) };
        self.context.wait()?;
        copied
    }
}

/// Page-locked memory that copies go to, one behind the other.
#[derive(Debug)]
pub(super) struct HostCopy {
    context: Arc<Context>,
    /// None once it has been given back.
    memory: Option<PageLocked>,
    /// How many of its bytes copies were queued for.
    filled: usize,
    /// When all of it is there.
    done: Option<Event>,
}

// SAFETY: nobody else has the memory; events may be waited for on every thread the context is made current on.
unsafe impl Send for HostCopy {}

impl HostCopy {
    /// Memory for so many bytes, more than none; none where there is no page-locked memory for it.
    pub(super) fn reserve(context: &Arc<Context>, bytes: usize) -> Result<Option<Self>, DriverError> {
        context.enter()?;
        let new = |memory| Self { context: context.clone(), memory: Some(memory), filled: 0, done: None };
        Ok(context.page_locked(bytes).map(new))
    }

    /// Queues a copy of the first bytes of a block behind everything that was asked for, as far as there is room.
    pub(super) fn add(&mut self, block: &Block, bytes: usize) -> Result<(), DriverError> {
        self.context.enter()?;
        let Some(memory) = &self.memory else { return Ok(()) };
        let bytes = bytes.min(block.bytes).min(memory.bytes - self.filled);
        // SAFETY: within the room, and nobody else has it. It is given back when the driver has written it.
        let target = unsafe { std::slice::from_raw_parts_mut(memory.pointer.add(self.filled), bytes) };
        self.filled += bytes;
        // SAFETY: within the block, and the target is page-locked and stays until the copy is done.
        unsafe { result::memcpy_dtoh_async(target, block.pointer, self.context.stream) }
    }

    /// Notes the moment when everything that was added is there.
    pub(super) fn close(&mut self) -> Result<(), DriverError> {
        self.done = Some(Event::now(&self.context)?);
        Ok(())
    }

    /// Waits for the copies and takes their first bytes.
    pub(super) fn wait(&self, into: &mut [u8]) -> Result<(), DriverError> {
        match &self.done {
            Some(done) => done.wait()?,
            None => self.context.wait()?,
        }
        let Some(memory) = &self.memory else { return Ok(()) };
        let length = into.len().min(self.filled);
        // SAFETY: so many were asked for, and the driver has written them.
        into[..length].copy_from_slice(unsafe { std::slice::from_raw_parts(memory.pointer, length) });
        Ok(())
    }
}

impl Drop for HostCopy {
    fn drop(&mut self) {
        // Nobody may write to it any more; where that cannot be known the memory stays.
        let is_done = match &self.done {
            Some(done) => done.wait().is_ok(),
            None => self.context.wait().is_ok(),
        };
        if is_done
            && self.context.enter().is_ok()
            && let Some(memory) = self.memory.take()
        {
            self.context.put_back(memory);
        }
    }
}

impl Drop for Block {
    fn drop(&mut self) {
        if self.context.enter().is_ok() {
            // SAFETY: taken in `zeros`; the driver waits for what uses it.
            let _ = unsafe { result::free_sync(self.pointer) };
        }
    }
}

/// Code on a GPU.
#[derive(Debug)]
pub(super) struct Function {
    context: Arc<Context>,
    module: CUmodule,
    function: CUfunction,
}

// SAFETY: as for the context.
unsafe impl Send for Function {}
// SAFETY: as for the context.
unsafe impl Sync for Function {}

impl Function {
    /// Loads a kernel of code that was compiled for this GPU.
    pub(super) fn load(context: &Arc<Context>, name: &str, code: &[u8]) -> Result<Self, DriverError> {
        context.enter()?;
        // SAFETY: the code is what the compiler gave, with its own end.
        let module = unsafe { result::module::load_data(code.as_ptr().cast()) }?;
        let mut new = Self { context: context.clone(), module, function: std::ptr::null_mut() };
        // Names of kernels are letters, digits and underscores.
        let name = CString::new(name).unwrap_or_default();
        // SAFETY: the module was just loaded, and lives as long as this.
        new.function = unsafe { result::module::get_function(module, name) }?;
        Ok(new)
    }

    /// Launches it on blocks of memory, in their order, and a number of threads, the last argument.
    pub(super) fn launch(&self, blocks: &[Arc<Block>], threads: u32, group: u32) -> Result<(), DriverError> {
        if threads == 0 {
            return Ok(());
        }
        self.context.enter()?;
        let pointers: Vec<CUdeviceptr> = blocks.iter().map(|block| block.pointer).collect();
        let of = |pointer: &CUdeviceptr| std::ptr::from_ref(pointer).cast_mut().cast::<c_void>();
        let mut arguments: Vec<*mut c_void> = pointers.iter().map(of).collect();
        arguments.push(std::ptr::from_ref(&threads).cast_mut().cast());
        let groups = (threads.div_ceil(group), 1, 1);
        // SAFETY: as many pointers as the kernel has buffers, which was checked when it was bound, to memory that the launch keeps; the driver
        // copies the arguments before it returns.
        unsafe {
            let stream = self.context.stream;
            result::launch_kernel(self.function, groups, (group, 1, 1), 0, stream, &mut arguments)
        }
    }
}

impl Drop for Function {
    fn drop(&mut self) {
        if self.context.enter().is_ok() {
            // SAFETY: loaded in `load`.
            let _ = unsafe { result::module::unload(self.module) };
        }
    }
}

/// A moment of the stream.
#[derive(Debug)]
pub(super) struct Event {
    context: Arc<Context>,
    event: CUevent,
}

impl Event {
    /// The moment when everything that was asked for so far is done.
    pub(super) fn now(context: &Arc<Context>) -> Result<Self, DriverError> {
        context.enter()?;
        let event = result::event::create(sys::CUevent_flags::CU_EVENT_DEFAULT)?;
        let new = Self { context: context.clone(), event };
        // SAFETY: event and stream are of this context.
        unsafe { result::event::record(event, context.stream) }?;
        Ok(new)
    }

    /// Waits for it.
    pub(super) fn wait(&self) -> Result<(), DriverError> {
        self.context.enter()?;
        // SAFETY: recorded in a stream of this context.
        unsafe { result::event::synchronize(self.event) }
    }

    /// Seconds from an earlier moment to this one, both waited for.
    pub(super) fn since(&self, earlier: &Self) -> Result<f64, DriverError> {
        type Elapsed = unsafe extern "C" fn(*mut f32, CUevent, CUevent) -> sys::CUresult;
        self.context.wait()?;
        let mut milliseconds = 0.0;
        // The call of that name is in every driver; what cudarc calls instead, in those since CUDA 12.8 alone.
        // SAFETY: the driver is loaded, and this is how it declares the call.
        let Ok(elapsed) = (unsafe { sys::culib().get::<Elapsed>(b"cuEventElapsedTime\0") }) else {
            return Err(DriverError(sys::CUresult::CUDA_ERROR_NOT_SUPPORTED));
        };
        // SAFETY: both were recorded in this stream.
        unsafe { elapsed(&raw mut milliseconds, earlier.event, self.event) }.result()?;
        Ok(1e-3 * f64::from(milliseconds))
    }
}

impl Drop for Event {
    fn drop(&mut self) {
        if self.context.enter().is_ok() {
            // SAFETY: made in `now`.
            let _ = unsafe { result::event::destroy(self.event) };
        }
    }
}
