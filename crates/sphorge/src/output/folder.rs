//! A folder that is open: files in it are named relative to it, whatever becomes of its own name, and no symbolic link in it is followed.

use super::atomic::{Durability, Sink, UNFINISHED_PREFIX, UNFINISHED_SUFFIX};
use cap_fs_ext::{DirExt, FollowSymlinks, MetadataExt, OpenOptionsFollowExt, OpenOptionsSyncExt};
use cap_std::{
    ambient_authority,
    fs::{Dir, Metadata, OpenOptions},
};
use std::{
    fs::File,
    hash::{BuildHasher, Hasher, RandomState},
    io::{self, BufWriter},
    path::{Path, PathBuf},
    sync::Arc,
};

/// A folder that is open. Names of files in it are relative to it, with `/` between their parts.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    dir: Arc<Dir>,
}

/// What tells one file or folder of a machine from all others while it is open.
pub(super) type Identity = (u64, u64);

/// What stands under a name in a folder. Links are not followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    File,
    Folder,
    Other,
}

impl Folder {
    /// Opens a folder by the name that the user gave it, which may lead over links.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let named = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        Ok(Self { path: path.to_owned(), dir: Arc::new(Dir::open_ambient_dir(named, ambient_authority())?) })
    }

    /// The name it was opened by.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn identity(&self) -> io::Result<Identity> {
        self.dir.dir_metadata().map(|of| identity_of(&of))
    }

    /// Whether its name still leads to it.
    pub(super) fn is_in_place(&self) -> bool {
        let there = Self::open(&self.path).and_then(|folder| folder.identity());
        there.ok().zip(self.identity().ok()).is_some_and(|(there, own)| there == own)
    }

    /// A folder in it.
    pub(crate) fn inside(&self, name: &str) -> io::Result<Self> {
        let mut folder = self.clone();
        for part in name.split('/') {
            let opened = folder.dir.open_dir_nofollow(part);
            let dir = opened.map_err(|error| if folder.is_link(part) { is_a_link() } else { error })?;
            folder = Self { path: folder.path.join(part), dir: Arc::new(dir) };
        }
        Ok(folder)
    }

    /// The same, made where it is not there.
    pub(crate) fn make_inside(&self, name: &str) -> io::Result<Self> {
        let mut folder = self.clone();
        for part in name.split('/') {
            match folder.dir.create_dir(part) {
                Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
                _ => folder = folder.inside(part)?,
            }
        }
        Ok(folder)
    }

    /// Makes a folder that was not there.
    pub(super) fn make_new(&self, name: &str) -> io::Result<()> {
        self.dir.create_dir(name)
    }

    /// The folder that a name leads to, and what the file is called there.
    fn place<'a>(&self, name: &'a str) -> io::Result<(Self, &'a str)> {
        match name.rsplit_once('/') {
            Some((folder, file)) => Ok((self.inside(folder)?, file)),
            None => Ok((self.clone(), name)),
        }
    }

    fn is_link(&self, name: &str) -> bool {
        self.dir.symlink_metadata(name).is_ok_and(|found| found.is_symlink())
    }

    /// Whether anything has this name, a link perhaps.
    pub(super) fn has(&self, name: &str) -> bool {
        self.dir.symlink_metadata(name).is_ok()
    }

    /// Which file stands under a name, and nothing behind a link.
    pub(super) fn identity_of(&self, name: &str) -> io::Result<Identity> {
        self.dir.symlink_metadata(name).map(|found| identity_of(&found))
    }

    /// Opens a regular file as `options` say, and nothing else: no link, no device, and no pipe, which might never open.
    fn open_as(&self, name: &str, options: &mut OpenOptions) -> io::Result<File> {
        let (folder, name) = self.place(name)?;
        // Asked before it is opened, too: what the system says of folders and sockets names no reason.
        match folder.dir.symlink_metadata(name) {
            Ok(found) if found.is_symlink() => return Err(is_a_link()),
            Ok(found) if !found.is_file() => return Err(is_no_file()),
            _ => {}
        }
        let file = folder.dir.open_with(name, options.follow(FollowSymlinks::No).nonblock(true))?;
        if !file.metadata()?.is_file() {
            return Err(is_no_file());
        }
        Ok(file.into_std())
    }

    /// Opens a regular file for reading.
    pub(crate) fn open_file(&self, name: &str) -> io::Result<File> {
        self.open_as(name, OpenOptions::new().read(true))
    }

    /// Opens a regular file for reading and writing in its place. Who writes asks before for [`has_second_names`].
    pub(super) fn open_to_change(&self, name: &str) -> io::Result<File> {
        self.open_as(name, OpenOptions::new().read(true).write(true))
    }

    /// Opens a regular file to add to its end. One that has a second name, in a folder of somebody else or in a copy by links perhaps, is refused.
    pub(crate) fn open_to_append(&self, name: &str) -> io::Result<File> {
        let file = self.open_as(name, OpenOptions::new().append(true))?;
        if has_second_names(&file)? { Err(io::Error::other("has a second name elsewhere")) } else { Ok(file) }
    }

    /// Makes a file that was not there.
    pub(super) fn create_new(&self, name: &str) -> io::Result<File> {
        let made = self.dir.open_with(name, OpenOptions::new().read(true).write(true).create_new(true))?;
        Ok(made.into_std())
    }

    /// What is in it; what has a name that no run gives is left out.
    pub(super) fn entries(&self) -> io::Result<Vec<(String, Kind)>> {
        let mut entries = Vec::new();
        for entry in self.dir.entries()? {
            let entry = entry?;
            let Ok(name) = entry.file_name().into_string() else { continue };
            let kind = entry.file_type()?;
            let kind = match kind {
                _ if kind.is_file() => Kind::File,
                _ if kind.is_dir() => Kind::Folder,
                _ => Kind::Other,
            };
            entries.push((name, kind));
        }
        Ok(entries)
    }

    /// Removes a file, if it is there. A link under its name is removed itself, a folder stays.
    pub(crate) fn remove_file(&self, name: &str) -> io::Result<()> {
        let (folder, name) = match self.place(name) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            placed => placed?,
        };
        match folder.dir.symlink_metadata(name) {
            Ok(found) if found.is_dir() => return Ok(()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(error),
            Ok(_) => {}
        }
        folder.dir.remove_file_or_symlink(name)
    }

    /// Removes all files of these names, whatever else is in it.
    pub(super) fn remove_matching(&self, ours: impl Fn(&str) -> bool) -> io::Result<()> {
        let files = self.entries()?.into_iter().filter(|(name, kind)| *kind == Kind::File && ours(name));
        files.map(|(name, _)| name).try_for_each(|name| self.remove_file(&name))
    }

    /// Removes a folder that is empty, and leaves one that is not.
    pub(super) fn remove_if_empty(&self, name: &str) -> io::Result<()> {
        let (folder, name) = self.place(name)?;
        match folder.dir.remove_dir(name) {
            Err(e) if !matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::DirectoryNotEmpty) => Err(e),
            _ => Ok(()),
        }
    }

    /// Writes a file through `content`. Readers see the former one until the new one is complete.
    pub(crate) fn write(
        &self,
        name: &str,
        durability: Durability,
        content: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
    ) -> io::Result<()> {
        self.write_and(name, durability, content, |_| Ok(()))
    }

    /// The same, with a look at the file before it takes its name.
    pub(super) fn write_and<T>(
        &self,
        name: &str,
        durability: Durability,
        content: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
        look: impl FnOnce(&mut File) -> io::Result<T>,
    ) -> io::Result<T> {
        let (folder, name) = self.place(name)?;
        let (mut unfinished, file) = folder.unfinished()?;
        let mut writer = BufWriter::with_capacity(1 << 17, file);
        content(&mut writer)?;
        let mut file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
        let seen = look(&mut file)?;
        if durability == Durability::Disk {
            file.sync_all()?;
        }
        folder.dir.rename(&unfinished.name, &folder.dir, name)?;
        unfinished.is_there = false;
        if durability == Durability::Disk {
            folder.sync();
        }
        Ok(seen)
    }

    /// Makes a file through `content` in the place of another, whose other names keep what it is; returns it, open.
    pub(super) fn replace(&self, name: &str, content: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<File> {
        let (mut unfinished, mut file) = self.unfinished()?;
        content(&mut file)?;
        self.dir.rename(&unfinished.name, &self.dir, name)?;
        unfinished.is_there = false;
        Ok(file)
    }

    /// Gives what has a name another one, whatever it is.
    pub(crate) fn rename(&self, name: &str, to: &str) -> io::Result<()> {
        self.dir.rename(name, &self.dir, to)
    }

    /// A file of a name of its own, which goes with what is returned beside it.
    pub(super) fn unfinished(&self) -> io::Result<(Unfinished, File)> {
        loop {
            let name = format!("{UNFINISHED_PREFIX}{}{UNFINISHED_SUFFIX}", random_name());
            match self.create_new(&name) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                made => return Ok((Unfinished { dir: Arc::clone(&self.dir), name, is_there: true }, made?)),
            }
        }
    }

    /// Makes names in it durable, where the file system can: some network and user-space ones refuse.
    pub(super) fn sync(&self) {
        #[cfg(unix)]
        let _ = self.dir.try_clone().and_then(|dir| dir.into_std_file().sync_all());
    }
}

/// A file that is gone when this is dropped, unless it has been given its name.
#[derive(Debug)]
pub(super) struct Unfinished {
    dir: Arc<Dir>,
    name: String,
    is_there: bool,
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if self.is_there {
            // What is left is known by its name and removed with the next run.
            let _ = self.dir.remove_file(&self.name);
        }
    }
}

fn identity_of(file: &Metadata) -> Identity {
    (file.dev(), file.ino())
}

fn is_a_link() -> io::Error {
    io::Error::other("is a symbolic link, which is not followed")
}

fn is_no_file() -> io::Error {
    io::Error::other("is not a regular file")
}

/// Whether a file has more than one name: what is written to it changes what has the others.
pub(super) fn has_second_names(file: &File) -> io::Result<bool> {
    Metadata::from_file(file).map(|of| of.nlink() > 1)
}

/// Which file is open.
pub(super) fn identity_of_file(file: &File) -> io::Result<Identity> {
    Metadata::from_file(file).map(|of| identity_of(&of))
}

/// 16 hexadecimal digits that nobody else has: the standard library's seeds of hash tables are random.
pub(super) fn random_name() -> String {
    format!("{:016x}", RandomState::new().build_hasher().finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{fs, io::Write};

    fn text(of: &'static str) -> impl FnOnce(&mut dyn Sink) -> io::Result<()> {
        move |out| out.write_all(of.as_bytes())
    }

    #[test]
    fn files_go_to_the_folder_that_was_opened_whatever_is_under_its_name_now() {
        let place = tempfile::tempdir().unwrap();
        let (name, moved) = (place.path().join("run"), place.path().join("moved"));
        fs::create_dir(&name).unwrap();
        let folder = Folder::open(&name).unwrap();
        assert!(folder.is_in_place());
        fs::rename(&name, &moved).unwrap();
        assert!(!folder.is_in_place());
        fs::create_dir(&name).unwrap();
        assert!(!folder.is_in_place());
        folder.make_inside("fields").unwrap();
        folder.write("fields/a", Durability::Disk, text("first")).unwrap();
        assert_eq!(fs::read_to_string(moved.join("fields/a")).unwrap(), "first");
        assert_eq!(fs::read_dir(&name).unwrap().count(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn no_link_in_it_is_followed() {
        use std::os::unix::fs::symlink;
        let place = tempfile::tempdir().unwrap();
        let (run, own) = (place.path().join("run"), place.path().join("own"));
        for folder in [&run, &own] {
            fs::create_dir(folder).unwrap();
        }
        fs::write(own.join("000000.vtp"), "mine").unwrap();
        symlink(&own, run.join("fields")).unwrap();
        symlink(own.join("000000.vtp"), run.join("lock")).unwrap();
        fs::hard_link(own.join("000000.vtp"), run.join("second")).unwrap();
        let folder = Folder::open(&run).unwrap();
        let refused = [
            folder.write("fields/000000.vtp", Durability::Process, text("")),
            folder.make_inside("fields").map(drop),
            folder.remove_file("fields/000000.vtp"),
            folder.open_file("lock").map(drop),
            folder.open_to_change("lock").map(drop),
            folder.open_to_append("lock").map(drop),
        ];
        for refused in refused {
            assert_eq!(refused.unwrap_err().to_string(), "is a symbolic link, which is not followed");
        }
        assert_eq!(folder.open_to_append("second").unwrap_err().to_string(), "has a second name elsewhere");
        assert!(has_second_names(&folder.open_to_change("second").unwrap()).unwrap());
        drop(folder.replace("second", |file| file.write_all(b"ours")).unwrap());
        assert_eq!(fs::read_to_string(run.join("second")).unwrap(), "ours");
        fs::create_dir(run.join("a")).unwrap();
        assert_eq!(folder.open_file("a").unwrap_err().to_string(), "is not a regular file");
        // A link in the place of a file is replaced, and not what it leads to.
        folder.write("lock", Durability::Process, text("ours")).unwrap();
        folder.remove_file("second").unwrap();
        assert_eq!(fs::read_to_string(own.join("000000.vtp")).unwrap(), "mine");
        assert_eq!(fs::read_to_string(run.join("lock")).unwrap(), "ours");
    }

    #[test]
    fn a_write_that_fails_leaves_the_former_file_and_nothing_else() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        folder.write("a", Durability::Disk, text("first")).unwrap();
        let failed = folder.write("a", Durability::Disk, |out| {
            out.write_all(b"sec")?;
            Err(io::Error::other("disk full"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "disk full");
        assert_eq!(fs::read(place.path().join("a")).unwrap(), b"first");
        assert_eq!(folder.entries().unwrap(), [("a".to_owned(), Kind::File)]);
    }

    #[test]
    fn the_file_that_is_written_can_be_changed_before_its_end() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::open(place.path()).unwrap();
        folder
            .write("a", Durability::Process, |out| {
                out.write_all(b"0000 particles")?;
                out.seek(io::SeekFrom::Start(0))?;
                out.write_all(b"0012")
            })
            .unwrap();
        assert_eq!(fs::read(place.path().join("a")).unwrap(), b"0012 particles");
    }
}
