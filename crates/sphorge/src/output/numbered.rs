//! Folders of files that the processes of a run write side by side, each one of its own under its number.

use super::{directory::is_unfinished, folder::Folder};
use std::io;

/// Name of the file of a process.
pub(super) fn numbered(number: usize, extension: &str) -> String {
    format!("{number:04}.{extension}")
}

/// Whether a file has such a name.
pub(super) fn is_numbered(name: &str, extension: &str) -> bool {
    let number = name.strip_suffix(extension).and_then(|name| name.strip_suffix('.'));
    number.is_some_and(|number| number.len() >= 4 && number.bytes().all(|b| b.is_ascii_digit()))
}

/// Removes a folder with the files of processes, whole or not, that are in it; what else is in it stays, and the folder with it.
pub(super) fn remove_numbered(run: &Folder, name: &str, extension: &str) -> io::Result<()> {
    match run.inside(name) {
        Ok(folder) => folder.remove_matching(|name| is_numbered(name, extension) || is_unfinished(name))?,
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(e) => return Err(e),
    }
    run.remove_if_empty(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn files_of_processes_go_and_others_stay_with_their_folder() {
        let run = tempfile::tempdir().unwrap();
        let (folder, opened) = (run.path().join("parts"), Folder::open(run.path()).unwrap());
        assert!(is_numbered(&numbered(7, "zip"), "zip") && is_numbered(&numbered(12_345, "zip"), "zip"));
        let write = |names: &[&str]| {
            fs::create_dir_all(&folder).unwrap();
            names.iter().for_each(|name| fs::write(folder.join(name), "").unwrap());
        };
        let ours = ["0000.zip", "12345.zip"];
        let others = ["0000.vtp", "000.zip", "000x.zip", "0000zip", ".zip"];
        write(&[&ours[..], &others].concat());
        remove_numbered(&opened, "parts", "zip").unwrap();
        assert!(others.iter().all(|name| folder.join(name).exists()), "{others:?}");
        assert!(ours.iter().all(|name| !folder.join(name).exists()));
        others.iter().for_each(|name| fs::remove_file(folder.join(name)).unwrap());
        write(&ours);
        remove_numbered(&opened, "parts", "zip").unwrap();
        assert!(!folder.exists());
        remove_numbered(&opened, "parts", "zip").unwrap();
    }
}
