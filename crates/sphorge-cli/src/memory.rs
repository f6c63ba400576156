//! Memory of the machine and of this process, as Linux tells it, and what happens where there is no more.

use sphorge::geometry::{BYTES_PER_PARTICLE, MAX_PARTICLES};
use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Particles that can be run here now: by what the machine has free, and what the process and its control group may take.
pub fn particle_limit() -> f64 {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let free = read("/proc/meminfo").and_then(|text| available_bytes(&text));
    let addresses = read("/proc/self/limits").zip(read("/proc/self/status"));
    let addresses = addresses.and_then(|(limits, status)| addresses_left(&limits, &status));
    let groups = control_groups(&read("/proc/self/cgroup").unwrap_or_default());
    let groups = groups.iter().filter_map(|(folder, names)| {
        let file = |name: &str| read(&format!("{folder}/{name}"));
        group_left(&file(names[0])?, &file(names[1])?, &file("memory.stat")?)
    });
    let bytes = [free, addresses].into_iter().flatten().chain(groups).fold(f64::INFINITY, f64::min);
    let [ranks, here] = [&RANKS, &RANKS_HERE].map(|count| count.load(Ordering::Relaxed));
    (bytes.max(0.0) / BYTES_PER_PARTICLE * share_of_ranks(ranks, here)).min(MAX_PARTICLES)
}

/// What each rank takes of all particles at the start, over what a particle takes in a run: up to 250 bytes of 1000, measured.
const AT_START: f64 = 0.25;

/// Particles that fit the memory of a machine with some of the ranks of a run, over those that fit a process alone.
fn share_of_ranks(ranks: usize, here: usize) -> f64 {
    if ranks <= 1 { 1.0 } else { 1.0 / (here.max(1) as f64 * (AT_START + 1.0 / ranks as f64)) }
}

/// Folders of the control groups of memory that the process is in, innermost first, by `/proc/self/cgroup`, each with the names of the files of
/// limit and use: those of the second version, and of the first.
fn control_groups(cgroup: &str) -> Vec<(String, [&'static str; 2])> {
    let mut folders = Vec::new();
    for line in cgroup.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
        let (root, names) = match controllers {
            "" => ("/sys/fs/cgroup", ["memory.max", "memory.current"]),
            _ if controllers.split(',').any(|name| name == "memory") => {
                ("/sys/fs/cgroup/memory", ["memory.limit_in_bytes", "memory.usage_in_bytes"])
            }
            _ => continue,
        };
        let mut path = path.trim_end_matches('/');
        loop {
            folders.push((format!("{root}{path}"), names));
            let Some(parent) = path.rfind('/') else { break };
            path = &path[..parent];
        }
    }
    folders
}

/// What a control group leaves, bytes: its limit less what is in use and cannot be given back, as files that are kept in memory can.
fn group_left(most: &str, used: &str, stat: &str) -> Option<f64> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let of_stat = |name: &str| stat.lines().find_map(|line| number(line.strip_prefix(name)?.strip_prefix(' ')?));
    let files = |kind: &str| of_stat(&format!("total_{kind}")).or_else(|| of_stat(kind)).unwrap_or(0.0);
    Some(number(most)? - (number(used)? - files("inactive_file") - files("active_file")).max(0.0))
}

/// What `ulimit -v` leaves of the address space, bytes, by `/proc/self/limits` and `/proc/self/status`; `None` without a limit.
fn addresses_left(limits: &str, status: &str) -> Option<f64> {
    let most = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let most: f64 = most.split_whitespace().next()?.parse().ok()?;
    Some(most - kibibytes_of(status, "VmSize:")? as f64 * 1024.0)
}

/// Number of this process among the ranks of a run, plus one; zero where it is none of several.
static RANK: AtomicUsize = AtomicUsize::new(0);
/// Ranks of the run.
static RANKS: AtomicUsize = AtomicUsize::new(1);
/// Those of them that share the memory of this machine.
static RANKS_HERE: AtomicUsize = AtomicUsize::new(1);

/// Notes that so many ranks share the particles, so many of them on this machine.
#[cfg(feature = "mpi")]
pub(crate) fn note_ranks(ranks: usize, here: usize) {
    RANKS.store(ranks, Ordering::Relaxed);
    RANKS_HERE.store(here.min(ranks), Ordering::Relaxed);
}

/// Notes which of them this process is, for it to say so when it has no more memory.
#[cfg(feature = "mpi")]
pub(crate) fn note_rank(rank: usize) {
    RANK.store(rank + 1, Ordering::Relaxed);
}

/// The allocator of the system, which ends the program with a message and exit code 1 where there is no more memory. What a run has written is
/// complete then, as at any moment.
#[derive(Clone, Copy, Debug)]
pub struct OrEnd;

impl OrEnd {
    fn or_end(pointer: *mut u8, bytes: usize) -> *mut u8 {
        if pointer.is_null() {
            // Standard error takes no memory.
            let mut out = std::io::stderr();
            let _ = match RANK.load(Ordering::Relaxed) {
                0 => write!(out, "error: out of memory"),
                rank => write!(out, "error: rank {} is out of memory", rank - 1),
            };
            let _ = writeln!(
                out,
                ": {bytes} more bytes could not be allocated\nFiles that were written are complete; a run can be \
                 resumed from its last checkpoint. `sphorge check` estimates the memory of a deck."
            );
            // At once: what else ends a program would write what is buffered, perhaps in the middle of the write that wanted memory.
            signal_hook::low_level::exit(1);
        }
        pointer
    }
}

// SAFETY: everything is done by the allocator of the system, whose contract this is.
unsafe impl GlobalAlloc for OrEnd {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        Self::or_end(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        Self::or_end(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        Self::or_end(unsafe { System.realloc(pointer, layout, size) }, size)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// `MemAvailable` of Linux's `/proc/meminfo`, bytes.
fn available_bytes(meminfo: &str) -> Option<f64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? * 1024.0)
}

/// Lets the high-water mark of the process start again, so that a run does not inherit that of the one before it. Systems that cannot do
/// this leave it as it is.
pub(crate) fn reset_peak() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Largest resident memory of the process since [`reset_peak`], bytes; `None` where the system does not tell.
pub(crate) fn peak_resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    Some(1024 * kibibytes_of(&status, "VmHWM:")?)
}

/// A line of `/proc/self/status` in kibibytes.
fn kibibytes_of(status: &str, name: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_memory_is_read_as_linux_writes_it() {
        let text = "MemTotal:       24000000 kB\nMemFree:         1000000 kB\nMemAvailable:   20000000 kB\n";
        assert_eq!(available_bytes(text), Some(20_000_000.0 * 1024.0));
        assert_eq!(available_bytes("nothing"), None);
    }

    #[test]
    fn control_groups_are_read_up_to_the_root() {
        let folders = |text| control_groups(text).into_iter().map(|(folder, names)| format!("{folder}/{}", names[0]));
        let found: Vec<_> = folders("4:memory:/jobs/7\n2:cpu:/jobs\n0::/user/a.scope\n").collect();
        let wanted = [
            "/sys/fs/cgroup/memory/jobs/7/memory.limit_in_bytes",
            "/sys/fs/cgroup/memory/jobs/memory.limit_in_bytes",
            "/sys/fs/cgroup/memory/memory.limit_in_bytes",
            "/sys/fs/cgroup/user/a.scope/memory.max",
            "/sys/fs/cgroup/user/memory.max",
            "/sys/fs/cgroup/memory.max",
        ];
        assert_eq!(found, wanted);
        assert_eq!(folders("0::/\n").collect::<Vec<_>>(), ["/sys/fs/cgroup/memory.max"]);
        // 900 in use, of which 500 are files.
        assert_eq!(group_left("1000\n", "900\n", "anon 400\ninactive_file 300\nactive_file 200\n"), Some(600.0));
        let first_version = "inactive_file 1\nactive_file 1\ntotal_inactive_file 300\ntotal_active_file 100\n";
        assert_eq!(group_left("1000\n", "900\n", first_version), Some(500.0));
        assert_eq!(group_left("max\n", "900\n", ""), None);
    }

    #[test]
    fn ranks_share_the_memory_of_their_machines() {
        assert_eq!(share_of_ranks(1, 1), 1.0);
        // Two on one machine have less room than a process alone, since each has all particles at first.
        assert!(share_of_ranks(2, 2) < 1.0);
        assert_eq!(share_of_ranks(4, 4), 0.5);
        // On as many machines each has more room, up to four times as much as one.
        assert!(share_of_ranks(2, 1) > 1.3 && share_of_ranks(4, 1) == 2.0 && share_of_ranks(64, 1) > 3.7);
        assert!(share_of_ranks(1 << 20, 1) < 4.0);
    }

    #[test]
    fn what_the_process_takes_and_may_take_is_read() {
        let status = "VmPeak:\t  9 kB\nVmSize:\t  1000 kB\nVmHWM:\t   12345 kB\nVmRSS:\t  1 kB\n";
        assert_eq!(kibibytes_of(status, "VmHWM:"), Some(12345));
        assert_eq!(kibibytes_of("VmHWM: many", "VmHWM:"), None);
        let limits = |most: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units\nMax address space         {most}   unlimited            bytes\n"
            )
        };
        assert_eq!(addresses_left(&limits("2048000   "), status), Some(1_024_000.0));
        assert_eq!(addresses_left(&limits("unlimited"), status), None);
    }
}
