//! Files that are complete or absent: written beside their place, then renamed into it.

use super::error::{AtPath, OutputError};
use std::{
    io::{self, BufWriter, Seek, Write},
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
    try_write(path, durability, content).writing(path)
}

fn try_write(
    path: &Path,
    durability: Durability,
    content: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
) -> io::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED_PREFIX).suffix(UNFINISHED_SUFFIX);
    #[cfg(unix)]
    {
        // Results are as readable as any other file of the user, not private as temporary files are.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut writer = BufWriter::with_capacity(1 << 17, builder.tempfile_in(folder)?);
    content(&mut writer)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    if durability == Durability::Disk {
        file.as_file().sync_all()?;
    }
    file.persist(path).map_err(|e| e.error)?;
    if durability == Durability::Disk {
        sync_folder(folder);
    }
    Ok(())
}

/// Makes names in a folder durable, where the file system can: some network and user-space ones refuse.
pub(super) fn sync_folder(folder: &Path) {
    #[cfg(unix)]
    let _ = std::fs::File::open(folder).and_then(|file| file.sync_all());
    #[cfg(not(unix))]
    let _ = folder;
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
