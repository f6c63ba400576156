//! Who writes to the folder of a run.
//!
//! The file `.sphorge-lock` names the process that writes to the folder and its machine, and the process writes it anew every few seconds. It is
//! held by a lock of the system, too, where there is one: that ends with the process, however it ends. On file systems without, and where the lock of
//! one machine does not hold on another, the file itself tells: a run whose file was written a short while ago is alive.
//!
//! Before each file that a run writes it looks whether the lock is still its own ([`Lock::is_held`]). Whoever takes it away by force stops that run.

use super::folder::{Folder, Identity, has_second_names, identity_of_file, random_name};
use std::{
    fs::{self, File, TryLockError},
    io::{self, Read, Seek, SeekFrom, Write},
    sync::mpsc::{self, RecvTimeoutError, Sender},
    thread::{self, JoinHandle},
    time::{Duration, SystemTime},
};

/// Name of the file.
pub(super) const LOCK: &str = ".sphorge-lock";
/// How its text begins.
const HEAD: &str = "Sphorge writes to this folder";
/// Bytes of its text, so that it is replaced by one write.
const LENGTH: usize = 512;
/// How often the file is written anew.
const REFRESHED_EVERY: Duration = Duration::from_secs(10);
/// A process of another machine that has not written it for so long has ended.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(60);
/// How long whoever takes over a file without the system's lock waits for another one that does the same.
const SETTLED_AFTER: Duration = Duration::from_millis(400);

/// A lock that is held until it is dropped.
#[derive(Debug)]
pub(super) struct Lock {
    folder: Folder,
    identity: Identity,
    owner: Owner,
    refresher: Option<(Sender<()>, JoinHandle<()>)>,
    /// Holds the lock of the system, and is written to: by its name somebody else could be met.
    file: File,
}

/// Why there is no lock.
#[derive(Debug)]
pub(super) enum Refusal {
    /// Somebody else has it, who is named.
    Held(String),
    /// What has the name of the file is none that may be used.
    InTheWay(io::Error),
    Failed(io::Error),
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Self::Failed(error)
    }
}

/// What the file says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Owner {
    /// Of this lock alone.
    session: String,
    machine: String,
    /// Since when the machine is up, and which processes its numbers are of.
    boot: String,
    processes: String,
    process: u32,
    /// When the process began, as the system counts.
    began: String,
    has_ended: bool,
}

impl Owner {
    /// This process.
    fn own() -> Self {
        let word = |path: &str| fs::read_to_string(path).map(|text| text.trim().to_owned()).unwrap_or_default();
        let processes = fs::read_link("/proc/self/ns/pid").map(|link| link.to_string_lossy().into_owned());
        let machine = word("/proc/sys/kernel/hostname");
        let named = || ["HOSTNAME", "COMPUTERNAME"].iter().find_map(|name| std::env::var(name).ok());
        Self {
            session: format!("{}{}", random_name(), random_name()),
            machine: if machine.is_empty() { named().unwrap_or_default() } else { machine },
            boot: word("/proc/sys/kernel/random/boot_id"),
            processes: processes.unwrap_or_default(),
            process: std::process::id(),
            began: began(std::process::id()).unwrap_or_default(),
            has_ended: false,
        }
    }

    /// The text of the file.
    fn text(&self) -> String {
        let Self { session, machine, boot, processes, process, began, has_ended } = self;
        let now = if *has_ended { "ended" } else { "writes" };
        let text = format!(
            "{HEAD}\nstate {now}\nsession {session}\nprocess {process}\nbegan {began}\nmachine {machine}\nboot {boot}\nprocesses {processes}\n"
        );
        // Long names of machines are cut, the same way each time.
        let mut end = text.len().min(LENGTH - 1);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        format!("{:<width$}\n", &text[..end], width = LENGTH - 1 - (end - text[..end].chars().count()))
    }

    /// Understands the text; nothing where it is of no lock.
    fn read(text: &str) -> Option<Self> {
        let mut lines = text.lines();
        (lines.next() == Some(HEAD)).then_some(())?;
        let mut owner = Self::default();
        for (key, value) in lines.filter_map(|line| line.trim_end().split_once(' ')) {
            let value = value.to_owned();
            match key {
                "state" => owner.has_ended = value == "ended",
                "session" => owner.session = value,
                "process" => owner.process = value.parse().ok()?,
                "began" => owner.began = value,
                "machine" => owner.machine = value,
                "boot" => owner.boot = value,
                "processes" => owner.processes = value,
                _ => {}
            }
        }
        Some(owner)
    }

    /// How it is named to people.
    fn name(&self) -> String {
        // What a file says is shown without what moves a cursor or colours.
        let machine: String = self.machine.chars().filter(|c| c.is_ascii_graphic()).collect();
        let machine = if machine.is_empty() { "an unnamed machine" } else { &machine };
        format!("process {} on {machine}", self.process)
    }

    /// Whether it still writes. `is_locked` is whether the lock of the system could be had, `age` when the file was written last.
    fn is_alive(&self, here: &Self, is_locked: bool, age: Duration) -> bool {
        let is_known = !self.boot.is_empty() && self.boot == here.boot;
        if self.has_ended || is_known && is_locked {
            return false;
        }
        // Without the lock of the system, numbers of processes tell; of other machines and containers only the age does.
        let seen = is_known && !self.processes.is_empty() && self.processes == here.processes;
        if seen { began(self.process).is_some_and(|began| began == self.began) } else { age < FORGOTTEN_AFTER }
    }
}

/// When a process of this machine began; nothing where there is none, or nobody tells.
fn began(process: u32) -> Option<String> {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // Behind its name, which may contain anything, come its state and eighteen other numbers.
    let (_, numbers) = stat.rsplit_once(')')?;
    let mut numbers = numbers.split_whitespace();
    let is_dead = matches!(numbers.next()?, "Z" | "X");
    numbers.nth(18).filter(|_| !is_dead).map(str::to_owned)
}

impl Lock {
    /// Takes the lock of a folder, by force whoever has it.
    pub(super) fn take(folder: &Folder, by_force: bool) -> Result<Self, Refusal> {
        Self::take_by(folder, by_force, &File::try_lock)
    }

    /// The same by this lock of the system.
    fn take_by(
        folder: &Folder,
        by_force: bool,
        try_lock: &dyn Fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, Refusal> {
        let here = Owner::own();
        if by_force {
            folder.remove_file(LOCK)?;
        }
        let (mut file, is_new) = match folder.create_new(LOCK) {
            Ok(file) => (file, true),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                (folder.open_to_change(LOCK).map_err(Refusal::InTheWay)?, false)
            }
            Err(error) => return Err(error.into()),
        };
        let text = read_text(&mut file)?;
        let owner = Owner::read(&text);
        // A power cut may leave zeros in place of what was written last.
        if owner.is_none() && text.chars().any(|c| c != '\0') {
            return Err(Refusal::InTheWay(io::Error::other("is not written by Sphorge")));
        }
        let name = owner.as_ref().map_or_else(|| "a process that has just begun".to_owned(), Owner::name);
        let is_locked = match try_lock(&file) {
            Ok(()) => true,
            Err(TryLockError::WouldBlock) => return Err(Refusal::Held(name)),
            Err(TryLockError::Error(_)) => false,
        };
        if !is_new {
            let age = age(folder, &file)?;
            // An empty one is of somebody who is about to write to it, or was killed then.
            let is_alive = match &owner {
                Some(owner) => owner.is_alive(&here, is_locked, age),
                None => !is_locked && age < FORGOTTEN_AFTER,
            };
            if is_alive {
                return Err(Refusal::Held(name));
            }
        }
        if has_second_names(&file)? {
            // As in a copy by links, whose lock stays what it is. The lock of the system on the former file is held until the new one has its name.
            let new = folder.replace(LOCK, |file| {
                if is_locked {
                    try_lock(file).map_err(io::Error::other)?;
                }
                write_text(file, &here)
            });
            file = new?;
        } else if folder.identity_of(LOCK).ok() == identity_of_file(&file).ok() {
            write_text(&mut file, &here)?;
        } else {
            return Err(Refusal::Held("another process".to_owned()));
        }
        if !is_locked {
            thread::sleep(SETTLED_AFTER);
        }
        let identity = identity_of_file(&file)?;
        let mut lock = Self { folder: folder.clone(), identity, owner: here, refresher: None, file };
        if !lock.is_held() {
            let other = read_owner(folder).map_or_else(|| "another process".to_owned(), |owner| owner.name());
            return Err(Refusal::Held(other));
        }
        lock.refresher = lock.refresh();
        Ok(lock)
    }

    /// What tells this lock from all others.
    pub(super) fn session(&self) -> &str {
        &self.owner.session
    }

    /// Whether the lock is still what it was when it was taken: the file is there, and nobody else has written to it.
    pub(super) fn is_held(&self) -> bool {
        is_of(&self.folder, self.identity, &self.owner)
    }

    /// Starts to write the file anew now and then.
    fn refresh(&self) -> Option<(Sender<()>, JoinHandle<()>)> {
        let (sender, receiver) = mpsc::channel();
        let (folder, identity, owner) = (self.folder.clone(), self.identity, self.owner.clone());
        let mut file = self.file.try_clone().ok()?;
        let refresh = move || {
            while receiver.recv_timeout(REFRESHED_EVERY) == Err(RecvTimeoutError::Timeout) {
                if !is_of(&folder, identity, &owner) {
                    return;
                }
                // One that fails is made good by the next.
                let _ = write_text(&mut file, &owner).and_then(|()| file.sync_data());
            }
        };
        // Without the thread the lock of the system is there.
        thread::Builder::new()
            .name("lock".to_owned())
            .stack_size(1 << 16)
            .spawn(refresh)
            .ok()
            .map(|thread| (sender, thread))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        if let Some((sender, thread)) = self.refresher.take() {
            drop(sender);
            let _ = thread.join();
        }
        if self.is_held() {
            let ended = Owner { has_ended: true, ..self.owner.clone() };
            // Without it, whoever comes next takes the process for alive at worst, and for a minute.
            let _ = write_text(&mut self.file, &ended);
        }
        // Where the process starts another one at this moment, that has a copy of the open file for a while: closing it would not give the lock back.
        let _ = self.file.unlock();
    }
}

/// Whether the folder is locked, and not by this session.
pub(super) fn is_locked_by_another(folder: &Folder, session: &str) -> bool {
    read_owner(folder).is_some_and(|owner| owner.session != session)
}

/// Whether somebody seems to write to the folder, as far as reading tells: nothing is written, and no lock is taken that a run might want.
pub(super) fn seems_held(folder: &Folder) -> bool {
    let found = || {
        let mut file = folder.open_file(LOCK).ok()?;
        let age = SystemTime::now().duration_since(file.metadata().ok()?.modified().ok()?).unwrap_or_default();
        Some((Owner::read(&read_text(&mut file).ok()?)?, age))
    };
    found().is_some_and(|(owner, age)| owner.is_alive(&Owner::own(), false, age))
}

fn is_of(folder: &Folder, identity: Identity, owner: &Owner) -> bool {
    folder.identity_of(LOCK).is_ok_and(|found| found == identity)
        && read_owner(folder).is_some_and(|found| found.session == owner.session)
}

fn read_owner(folder: &Folder) -> Option<Owner> {
    let mut file = folder.open_file(LOCK).ok()?;
    Owner::read(&read_text(&mut file).ok()?)
}

/// The text of a lock, and of any other file the beginning.
fn read_text(file: &mut File) -> io::Result<String> {
    let mut text = Vec::with_capacity(LENGTH);
    file.seek(SeekFrom::Start(0))?;
    file.take(LENGTH as u64).read_to_end(&mut text)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

fn write_text(file: &mut File, owner: &Owner) -> io::Result<()> {
    file.seek(SeekFrom::Start(0))?;
    file.write_all(owner.text().as_bytes())
}

/// How long ago a file was written, by the clock of its file system.
fn age(folder: &Folder, file: &File) -> io::Result<Duration> {
    let (_unfinished, mut new) = folder.unfinished()?;
    new.write_all(b"now")?;
    let time = |file: &File| -> io::Result<SystemTime> { file.metadata()?.modified() };
    Ok(time(&new)?.duration_since(time(file)?).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn folder(path: &Path) -> Folder {
        Folder::open(path).unwrap()
    }

    type TryLock<'a> = &'a dyn Fn(&File) -> Result<(), TryLockError>;
    /// What was done to a lock that is left, how many seconds ago, and whether the next may have it where the system has locks, and where not.
    type Case<'a> = (&'a dyn Fn(&mut Owner), u64, bool, bool);

    /// A file system without locks.
    fn none(_: &File) -> Result<(), TryLockError> {
        Err(TryLockError::Error(io::Error::from(io::ErrorKind::Unsupported)))
    }

    fn who(refused: Result<Lock, Refusal>) -> String {
        match refused {
            Err(Refusal::Held(name)) => name,
            other => panic!("{other:?}"),
        }
    }

    /// A lock as another process has left it.
    fn leave(path: &Path, change: impl Fn(&mut Owner), seconds_ago: u64) {
        let mut owner = Owner::own();
        change(&mut owner);
        fs::write(path.join(LOCK), owner.text()).unwrap();
        let then = SystemTime::now() - Duration::from_secs(seconds_ago);
        File::options().write(true).open(path.join(LOCK)).unwrap().set_modified(then).unwrap();
    }

    #[test]
    fn what_is_written_is_read() {
        let long = Owner { machine: "é".repeat(400), ..Owner::own() };
        for owner in [Owner::own(), Owner { has_ended: true, ..Owner::own() }, long] {
            assert_eq!(owner.text().len(), LENGTH);
            let read = Owner::read(&owner.text()).unwrap();
            assert_eq!((read.session, read.process, read.has_ended), (owner.session, owner.process, owner.has_ended));
        }
        assert_eq!(Owner::read("my thesis\n"), None);
    }

    #[test]
    fn one_has_it_and_the_next_when_it_is_given_back() {
        let place = tempfile::tempdir().unwrap();
        let name = format!("process {} on ", std::process::id());
        for try_lock in [&File::try_lock as &dyn Fn(&File) -> _, &none] {
            let first = Lock::take_by(&folder(place.path()), false, try_lock).unwrap();
            assert!(who(Lock::take_by(&folder(place.path()), false, try_lock)).starts_with(&name));
            assert!(first.is_held());
            // As another process has it that was started meanwhile.
            let _copy = first.file.try_clone().unwrap();
            drop(first);
            drop(Lock::take_by(&folder(place.path()), false, try_lock).unwrap());
        }
    }

    #[test]
    fn by_force_it_is_taken_from_whoever_has_it_who_learns_of_it() {
        let place = tempfile::tempdir().unwrap();
        for try_lock in [&File::try_lock as &dyn Fn(&File) -> _, &none] {
            let first = Lock::take_by(&folder(place.path()), false, try_lock).unwrap();
            let second = Lock::take_by(&folder(place.path()), true, try_lock).unwrap();
            assert!(!first.is_held() && second.is_held());
            drop(first);
            assert!(second.is_held());
        }
    }

    #[test]
    fn one_whose_file_is_removed_or_replaced_learns_of_it() {
        let place = tempfile::tempdir().unwrap();
        let lock = Lock::take(&folder(place.path()), false).unwrap();
        let text = fs::read(place.path().join(LOCK)).unwrap();
        fs::remove_file(place.path().join(LOCK)).unwrap();
        assert!(!lock.is_held());
        // A copy of it is another file.
        fs::write(place.path().join("copy"), text).unwrap();
        fs::rename(place.path().join("copy"), place.path().join(LOCK)).unwrap();
        assert!(!lock.is_held());
    }

    #[test]
    fn processes_that_have_ended_and_those_of_other_machines_are_told_apart() {
        let other = |owner: &mut Owner| (owner.machine, owner.boot) = ("node7".to_owned(), "another".to_owned());
        let of_container = |owner: &mut Owner| owner.processes = "pid:[1]".to_owned();
        // More than there are.
        let no_process = |owner: &mut Owner| owner.process = u32::MAX;
        let later = |owner: &mut Owner| owner.began.push('0');
        let cases: [Case<'_>; 7] = [
            (&other, 5, false, false),
            (&other, 300, true, true),
            // The system gives back locks of processes of all its containers.
            (&of_container, 5, true, false),
            (&of_container, 300, true, true),
            (&no_process, 5, true, true),
            (&later, 5, true, true),
            (&|_| {}, 5, true, false),
        ];
        for (k, (change, seconds_ago, with, without)) in cases.into_iter().enumerate() {
            let tries: [(TryLock<'_>, bool); 2] = [(&File::try_lock, with), (&none, without)];
            for (try_lock, expected) in tries {
                let place = tempfile::tempdir().unwrap();
                leave(place.path(), change, seconds_ago);
                let taken = Lock::take_by(&folder(place.path()), false, try_lock);
                assert_eq!(taken.is_ok(), expected, "case {k}: {taken:?}");
            }
        }
    }

    #[test]
    fn of_two_that_take_over_a_forgotten_one_at_once_one_has_it() {
        let place = tempfile::tempdir().unwrap();
        for _ in 0..3 {
            leave(place.path(), |owner| owner.boot = "another".to_owned(), 300);
            let start = std::sync::Barrier::new(2);
            let take = || {
                start.wait();
                Lock::take_by(&folder(place.path()), false, &none)
            };
            let (first, second) = thread::scope(|scope| {
                let other = scope.spawn(take);
                (take(), other.join().unwrap())
            });
            let held = [&first, &second].iter().filter(|lock| lock.as_ref().is_ok_and(Lock::is_held)).count();
            assert_eq!(held, 1, "{first:?} {second:?}");
        }
    }

    #[test]
    fn zeros_that_a_power_cut_left_are_no_lock() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join(LOCK), [0; LENGTH]).unwrap();
        assert!(Lock::take(&folder(place.path()), false).unwrap().is_held());
        leave(place.path(), |owner| owner.machine.clear(), 5);
        let refused = who(Lock::take_by(&folder(place.path()), false, &none));
        assert!(refused.ends_with("on an unnamed machine"), "{refused}");
    }

    #[test]
    fn the_lock_of_a_copy_by_links_is_taken_and_the_copied_one_stays_what_it_is() {
        let place = tempfile::tempdir().unwrap();
        let copy = place.path().join("copy");
        for try_lock in [&File::try_lock as &dyn Fn(&File) -> _, &none] {
            drop(Lock::take_by(&folder(place.path()), false, try_lock).unwrap());
            fs::hard_link(place.path().join(LOCK), &copy).unwrap();
            let copied = fs::read(&copy).unwrap();
            let lock = Lock::take_by(&folder(place.path()), false, try_lock).unwrap();
            assert!(lock.is_held());
            who(Lock::take_by(&folder(place.path()), false, try_lock));
            assert_eq!(fs::read(&copy).unwrap(), copied);
            fs::remove_file(&copy).unwrap();
            // Copied while it is held, it is given back nevertheless.
            fs::hard_link(place.path().join(LOCK), &copy).unwrap();
            assert!(lock.is_held());
            drop(lock);
            assert!(read_owner(&folder(place.path())).unwrap().has_ended);
            fs::remove_file(&copy).unwrap();
        }
    }

    #[test]
    fn a_file_that_is_none_of_ours_is_left_alone() {
        let place = tempfile::tempdir().unwrap();
        let (own, lock) = (place.path().join("thesis"), place.path().join(LOCK));
        fs::write(&own, "my thesis").unwrap();
        let refused = |lock: Result<Lock, Refusal>| match lock {
            Err(Refusal::InTheWay(error)) => error.to_string(),
            other => panic!("{other:?}"),
        };
        fs::hard_link(&own, &lock).unwrap();
        assert!(refused(Lock::take(&folder(place.path()), false)).contains("not written by Sphorge"));
        assert_eq!(fs::read_to_string(&own).unwrap(), "my thesis");
        fs::remove_file(&lock).unwrap();
        fs::create_dir(&lock).unwrap();
        assert!(refused(Lock::take(&folder(place.path()), true)).contains("not a regular file"));
        fs::remove_dir(&lock).unwrap();
        fs::write(&lock, "").unwrap();
        #[cfg(unix)]
        for target in [own.clone(), place.path().join("none")] {
            fs::remove_file(&lock).unwrap();
            std::os::unix::fs::symlink(&target, &lock).unwrap();
            assert!(refused(Lock::take(&folder(place.path()), false)).contains("symbolic link"));
        }
        assert_eq!(fs::read_to_string(&own).unwrap(), "my thesis");
        assert!(!place.path().join("none").exists());
        // By force, too, only the name is taken.
        Lock::take(&folder(place.path()), true).unwrap();
        assert_eq!(fs::read_to_string(&own).unwrap(), "my thesis");
    }
}
