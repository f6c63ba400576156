//! Files that are complete or absent: written beside their place, then renamed into it.

use super::{
    error::{AtPath, OutputError},
    folder::Folder,
};
use std::{
    io::{self, Seek, Write},
    path::Path,
};

/// What the content of a file is written to; what stands before the end can still be changed.
pub(crate) trait Sink: Write + Seek {}

impl<T: Write + Seek> Sink for T {}

/// How names of unfinished files begin; a killed process may leave one behind.
pub(crate) const UNFINISHED_PREFIX: &str = ".sphorge-";
/// How names of unfinished files end.
pub(crate) const UNFINISHED_SUFFIX: &str = ".unfinished";

/// How hard to push data to the disk before a file takes its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Durability {
    /// Survives the end of the process; a power cut leaves the old or the new file.
    Process,
    /// On the disk when the call returns.
    Disk,
}

/// Writes `path` through `content`. Readers see the former file until the new one is complete.
pub(crate) fn write_file(
    path: &Path,
    durability: Durability,
    content: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
) -> Result<(), OutputError> {
    let name = path.file_name().and_then(|name| name.to_str()).filter(|name| !name.contains('/'));
    let name = name.ok_or_else(|| io::Error::other("its name is no text")).writing(path)?;
    let folder = Folder::open(path.parent().unwrap_or(Path::new(""))).writing(path)?;
    folder.write(name, durability, content).writing(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_write_that_fails_half_way_leaves_the_former_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        write_file(&path, Durability::Disk, |w| w.write_all(b"first")).unwrap();
        let failed = write_file(&path, Durability::Disk, |w| {
            w.write_all(b"sec")?;
            Err(io::Error::other("disk full"))
        });
        assert!(matches!(failed, Err(OutputError::Write { .. })));
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn files_get_the_permissions_of_ordinary_files() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("plain"), "").unwrap();
        write_file(&folder.path().join("ours"), Durability::Process, |_| Ok(())).unwrap();
        let mode = |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
        assert_eq!(mode("ours"), mode("plain"));
    }
}
