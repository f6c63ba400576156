//! CUDA C++ compiled for a GPU.

use super::library::Versions;
use cudarc::nvrtc::{result, sys};
use std::collections::HashMap;
use std::ffi::{CStr, CString};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// What code is made for.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Architecture {
    /// This GPU.
    Own(i32),
    /// The newest that the compiler knows, older than the GPU: the driver compiles the rest of the way.
    Older(i32),
}

impl Architecture {
    /// That of a GPU of a compute capability, ten times it, for the compiler at hand.
    pub(super) fn of(capability: i32) -> Result<Self, String> {
        let known = known()?;
        if known.contains(&capability) {
            return Ok(Self::Own(capability));
        }
        let older = known.iter().copied().filter(|of| *of < capability).max();
        older.map(Self::Older).ok_or_else(|| {
            format!(
                "its compute capability {capability} is too old for the installed compiler NVRTC: install an older version of it"
            )
        })
    }

    fn option(&self) -> String {
        match self {
            Self::Own(of) => format!("--gpu-architecture=sm_{of}"),
            Self::Older(of) => format!("--gpu-architecture=compute_{of}"),
        }
    }
}

/// Architectures the compiler knows.
fn known() -> Result<Vec<i32>, String> {
    let mut count = 0;
    // SAFETY: writes one number.
    unsafe { sys::nvrtcGetNumSupportedArchs(&raw mut count) }.result().map_err(|error| error.to_string())?;
    let mut known = vec![0; count.max(0) as usize];
    // SAFETY: writes as many as it has just said.
    unsafe { sys::nvrtcGetSupportedArchs(known.as_mut_ptr()) }.result().map_err(|error| error.to_string())?;
    Ok(known)
}

/// Products and sums are rounded each by itself where a law does not say otherwise, so that what rounding leaves of a sum is kept and pairs of particles
/// round alike from both sides; that costs 1 to 4 % of the instructions of the pair sums. Quotients and roots are good to two units of the last
/// place, as with Vulkan: those that are rounded as the standard has it make the forces 40 % longer. (Instructions for compute capability 9.0, NVRTC 13.0.)
const OPTIONS: [&str; 3] = ["--fmad=false", "--prec-div=false", "--prec-sqrt=false"];

struct Program(sys::nvrtcProgram);

impl Drop for Program {
    fn drop(&mut self) {
        // SAFETY: made by `compile`. There is nothing to do about a failure.
        let _ = unsafe { result::destroy_program(self.0) };
    }
}

/// Machine code by the architecture and the text that it is of.
type Known = Mutex<HashMap<(Architecture, String), Arc<Vec<u8>>>>;

/// What this process has compiled: engines that follow one another mostly have the same kernels.
static KNOWN: LazyLock<Known> = LazyLock::new(Known::default);

/// Machine code of a text, or what the compiler has against it.
pub(super) fn compile(name: &str, text: &str, architecture: &Architecture) -> Result<Arc<Vec<u8>>, String> {
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let key = (architecture.clone(), text.to_owned());
    if let Some(code) = known().get(&key) {
        return Ok(code.clone());
    }
    let code = Arc::new(compile_anew(name, text, architecture)?);
    known().insert(key, code.clone());
    Ok(code)
}

fn compile_anew(name: &str, text: &str, architecture: &Architecture) -> Result<Vec<u8>, String> {
    let source = CString::new(text).map_err(|error| error.to_string())?;
    let file = CString::new(format!("{name}.cu")).map_err(|error| error.to_string())?;
    let program = Program(result::create_program(&source, Some(&file)).map_err(|error| error.to_string())?);
    let mut options = vec![architecture.option()];
    options.extend(OPTIONS.map(str::to_owned));
    // SAFETY: the program was just made.
    if let Err(error) = unsafe { result::compile_program(program.0, &options) } {
        // SAFETY: as above.
        let log = unsafe { result::get_program_log(program.0) }.unwrap_or_default();
        let log: Vec<u8> = log.into_iter().map(|c| c as u8).collect();
        let log = CStr::from_bytes_until_nul(&log).unwrap_or_default().to_string_lossy();
        return Err(format!("{error}\n{log}"));
    }
    let (size, take): (unsafe fn(_, _) -> _, unsafe fn(_, _) -> _) = match architecture {
        Architecture::Own(_) => (sys::nvrtcGetCUBINSize, sys::nvrtcGetCUBIN),
        Architecture::Older(_) => (sys::nvrtcGetPTXSize, sys::nvrtcGetPTX),
    };
    let mut bytes = 0;
    // SAFETY: writes one number.
    unsafe { size(program.0, &raw mut bytes) }.result().map_err(|error| error.to_string())?;
    let mut code = vec![0u8; bytes];
    // SAFETY: writes as many bytes as it has just said.
    unsafe { take(program.0, code.as_mut_ptr().cast()) }.result().map_err(|error| error.to_string())?;
    Ok(code)
}

/// What a user can do where the driver does not take the code.
pub(super) fn advice(versions: Versions) -> String {
    let (driver, compiler) = (versions.driver, versions.compiler);
    if compiler <= driver {
        return String::new();
    }
    format!(
        "; the compiler NVRTC {}.{} is newer than the driver, which knows CUDA {}.{}: take a newer driver, or `pip install \
         'nvidia-cuda-nvrtc-cu{}=={}.{}.*'`",
        compiler.0, compiler.1, driver.0, driver.1, driver.0, driver.0, driver.1
    )
}
