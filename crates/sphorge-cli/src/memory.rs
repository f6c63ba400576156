//! Memory of the machine and of this process, as Linux tells it.

use sphorge::geometry::{BYTES_PER_PARTICLE, MAX_PARTICLES};

/// Particles that can be run on this machine now.
pub(crate) fn particle_limit() -> f64 {
    let free = std::fs::read_to_string("/proc/meminfo").ok().and_then(|text| available_bytes(&text));
    free.map_or(MAX_PARTICLES, |bytes| (bytes / BYTES_PER_PARTICLE).min(MAX_PARTICLES))
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
    parse_high_water_mark(&status)
}

fn parse_high_water_mark(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
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
    fn the_high_water_mark_is_read() {
        let status = "VmPeak:\t  9 kB\nVmHWM:\t   12345 kB\nVmRSS:\t  1 kB\n";
        assert_eq!(parse_high_water_mark(status), Some(12345 * 1024));
        assert_eq!(parse_high_water_mark("VmHWM: many"), None);
    }
}
