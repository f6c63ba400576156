//! Why Vulkan reaches no GPU: its loader says nothing to a program, so its steps are repeated and the first that fails is reported.

use libloading::Library;
use std::error::Error;
use std::path::{Path, PathBuf};

/// The loader of Vulkan.
const LOADER: &str = "libvulkan.so.1";

/// Variables that name files, or folders of files, that describe drivers; the first that is set replaces all folders.
const NAMED: [&str; 2] = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];

/// Where such files are otherwise.
const FOLDERS: [&str; 4] =
    ["/usr/local/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/share/vulkan/icd.d"];

/// What is in the way, on Linux.
pub(super) fn what_is_missing() -> String {
    if let Err(why) = load(Path::new(LOADER)) {
        return format!("its loader cannot be used: {why}");
    }
    let named = NAMED.iter().find_map(|name| std::env::var_os(name).filter(|value| !value.is_empty()));
    let (places, among) = match &named {
        Some(paths) => (std::env::split_paths(paths).collect(), paths.to_string_lossy().replace(':', ", ")),
        None => (FOLDERS.map(PathBuf::from).to_vec(), FOLDERS.join(", ")),
    };
    what_is_wrong_with(&places, &among)
}

/// The same of drivers that are described by these files, or by those in these folders.
fn what_is_wrong_with(places: &[PathBuf], among: &str) -> String {
    let mut faults = Vec::new();
    for file in places.iter().flat_map(|place| described(place)) {
        let shown = file.display();
        let text = match std::fs::read_to_string(&file) {
            Ok(text) => text,
            Err(why) => {
                faults.push(format!("{shown} cannot be read: {why}"));
                continue;
            }
        };
        let Some(library) = library_of(&text) else {
            faults.push(format!("{shown} names no driver"));
            continue;
        };
        // With a folder it is one beside the file, without one the system looks for it.
        let path = if library.contains('/') { file.with_file_name("").join(library) } else { library.into() };
        faults.push(match load(&path) {
            Err(why) => format!("the driver of {shown} cannot be loaded: {why}"),
            Ok(()) => format!("the driver of {shown}, {library}, finds no card"),
        });
    }
    if faults.is_empty() { format!("no driver is installed (none is described in {among})") } else { faults.join("; ") }
}

/// Files at a place that describe drivers.
fn described(place: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(place) else {
        // A file that is named is told of though it is not there; a folder is not.
        return if place.extension().is_some_and(|of| of == "json") { vec![place.to_owned()] } else { Vec::new() };
    };
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|of| of == "json"));
    files.sort();
    files
}

/// The library that a description names.
fn library_of(text: &str) -> Option<&str> {
    let value = text.split_once("\"library_path\"")?.1.trim_start().strip_prefix(':')?.trim_start();
    Some(value.strip_prefix('"')?.split_once('"')?.0).filter(|name| !name.is_empty())
}

/// Loads a library, or gives what the system says, which names the first library that it needs and that is not there.
fn load(path: &Path) -> Result<(), String> {
    // SAFETY: it is what the loader of Vulkan itself loads. It stays loaded.
    let loaded = unsafe { Library::new(path) }.map(std::mem::forget);
    loaded.map_err(|why| why.source().map_or_else(|| why.to_string(), ToString::to_string))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_driver_that_cannot_be_loaded_is_reported_with_the_missing_library() {
        let folder = std::env::temp_dir().join(format!("sphorge-vulkan-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let of = |places: &[PathBuf]| what_is_wrong_with(places, "nowhere");
        assert_eq!(of(std::slice::from_ref(&folder)), "no driver is installed (none is described in nowhere)");
        let write = |name: &str, text: &str| {
            std::fs::write(folder.join(name), text).unwrap();
            folder.join(name)
        };
        let lost = write("lost.json", "{ \"ICD\": { \"library_path\" : \"libno_such_driver.so.0\" } }");
        assert!(of(&[lost]).contains("libno_such_driver.so.0: cannot open shared object file"));
        let empty = write("empty.json", "{}");
        assert!(of(&[empty]).contains("empty.json names no driver"));
        // What stands beside the file is looked for there.
        let beside = write("beside.json", "{\"ICD\":{\"library_path\":\"./libbeside.so\"}}");
        assert!(of(&[beside]).contains(&format!("{}/./libbeside.so", folder.display())));
        assert!(of(&[folder.join("gone.json")]).contains("gone.json cannot be read"));
        assert_eq!(of(std::slice::from_ref(&folder)).matches("; ").count(), 2, "all in a folder");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
