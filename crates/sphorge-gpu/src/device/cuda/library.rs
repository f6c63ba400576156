//! The driver of NVIDIA and its compiler: libraries that are there or not, looked for before anything of them is called.

use super::context::described;
use crate::device::{Interface, Missing};
use cudarc::driver::{result, sys};
use cudarc::nvrtc;
use libloading::Library;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Names a folder with the libraries of NVRTC.
pub const NVRTC_FOLDER: &str = "SPHORGE_NVRTC";

/// The oldest CUDA whose driver and compiler have all that is called.
const OLDEST: i32 = 12;

/// Versions of the driver's interface and of the compiler, such as `(13, 0)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Versions {
    pub(super) driver: (i32, i32),
    pub(super) compiler: (i32, i32),
}

fn missing(why: String, cure: &str) -> Missing {
    Missing { interface: Interface::Cuda, why, cure: cure.to_owned() }
}

/// The libraries, looked for once.
///
/// # Errors
/// Which of them is not there, or does not start.
pub(super) fn reach() -> Result<Versions, Missing> {
    static REACHED: OnceLock<Result<Versions, Missing>> = OnceLock::new();
    REACHED.get_or_init(|| Ok(Versions { driver: driver()?, compiler: compiler()? })).clone()
}

fn driver() -> Result<(i32, i32), Missing> {
    // SAFETY: loading a driver runs its start-up code, as every program on GPUs does.
    if !unsafe { sys::is_culib_present() } {
        return Err(missing(
            "NVIDIA's driver is not installed (libcuda.so.1, nvcuda.dll)".to_owned(),
            "install the driver of the card; a container has to be started with the card (`docker run --gpus all`)",
        ));
    }
    let failed =
        |what: &str, error: result::DriverError| missing(format!("{what}: {}", described(error)), cure_of(error));
    result::init().map_err(|error| failed("NVIDIA's driver does not start", error))?;
    let count = result::device::get_count()
        .map_err(|error| failed("NVIDIA's driver does not report the number of its cards", error))?;
    if count == 0 {
        let cure = "check whether `nvidia-smi` lists a card, and whether CUDA_VISIBLE_DEVICES hides it";
        return Err(missing("NVIDIA's driver finds no card".to_owned(), cure));
    }
    let mut version = 0;
    // SAFETY: writes one number.
    let asked = unsafe { sys::cuDriverGetVersion(&raw mut version) };
    asked.result().map_err(|error| failed("NVIDIA's driver does not report its version", error))?;
    let (major, minor) = (version / 1000, version % 1000 / 10);
    if major < OLDEST {
        return Err(missing(
            format!("NVIDIA's driver supports CUDA {major}.{minor}; {OLDEST}.0 is needed"),
            "install a newer driver (525 or later on Linux)",
        ));
    }
    Ok((major, minor))
}

fn cure_of(error: result::DriverError) -> &'static str {
    match error.0 {
        sys::CUresult::CUDA_ERROR_NO_DEVICE => {
            "check whether `nvidia-smi` lists a card, and whether CUDA_VISIBLE_DEVICES hides it"
        }
        sys::CUresult::CUDA_ERROR_SYSTEM_DRIVER_MISMATCH => {
            "the library and the kernel module of the driver are of different versions: restart the machine, or reinstall one of them"
        }
        _ => "see what `nvidia-smi` says",
    }
}

fn compiler() -> Result<(i32, i32), Missing> {
    const CURE: &str = "install it: `pip install nvidia-cuda-nvrtc` (no newer than the driver's CUDA version that \
                        `nvidia-smi` shows), `apt install libnvrtc12`, or the CUDA toolkit; if it is in an unusual \
                        place, set SPHORGE_NVRTC to its folder";
    load_from_known_folders();
    // SAFETY: as for the driver.
    if !unsafe { nvrtc::sys::is_culib_present() } {
        return Err(missing(
            "there is an NVIDIA card, but its compiler NVRTC (libnvrtc) is not installed".to_owned(),
            CURE,
        ));
    }
    let (mut major, mut minor) = (0, 0);
    // SAFETY: writes two numbers.
    let asked = unsafe { nvrtc::sys::nvrtcVersion(&raw mut major, &raw mut minor) };
    asked.result().map_err(|error| missing(format!("NVRTC does not report its version: {error}"), CURE))?;
    if major < OLDEST {
        return Err(missing(format!("NVRTC is of CUDA {major}.{minor}, and {OLDEST}.0 is needed"), CURE));
    }
    Ok((major, minor))
}

/// Loads NVRTC from where the loader of the system does not look: once it is there, it is found by its name.
fn load_from_known_folders() {
    let is_of = |path: &Path, start: &str| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(start) && name.contains(".so") && !name.contains(".alt.")
    };
    let load = |path: &PathBuf| {
        // SAFETY: a library of that name is what NVRTC itself loads. It stays loaded.
        unsafe { Library::new(path) }.map(std::mem::forget).is_ok()
    };
    for folder in folders() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        let files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        // What it looks for by name while it compiles.
        for path in files.iter().filter(|path| is_of(path, "libnvrtc-builtins")) {
            let _ = load(path);
        }
        if files.iter().filter(|path| is_of(path, "libnvrtc.so")).any(load) {
            return;
        }
    }
}

/// Folders NVRTC may be in: the one that is named, that of the program, and those of Python's packages.
fn folders() -> Vec<PathBuf> {
    let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let mut folders: Vec<PathBuf> = variable(NVRTC_FOLDER).into_iter().collect();
    if let Some(own) = std::env::current_exe().ok().as_deref().and_then(Path::parent) {
        folders.extend([own.to_owned(), own.join("nvrtc")]);
    }
    folders.extend(variable("CUDA_HOME").into_iter().chain(variable("CUDA_PATH")).map(|home| home.join("lib64")));
    folders.push("/usr/local/cuda/lib64".into());
    let homes = variable("VIRTUAL_ENV").into_iter().chain(variable("HOME").map(|home| home.join(".local")));
    for home in homes.chain(["/usr/local".into(), "/usr".into()]) {
        for python in inside(&home.join("lib")) {
            for packages in ["site-packages", "dist-packages"] {
                folders.extend(inside(&python.join(packages).join("nvidia")).map(|package| package.join("lib")));
            }
        }
    }
    folders
}

/// What is in a folder, in the order of names.
fn inside(folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    paths.into_iter()
}
