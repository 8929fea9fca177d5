//! The memory of this process.

use std::fs;

/// Largest resident memory of this process so far in MB, or since the mark was last set back;
/// `None` where the system does not tell.
#[must_use]
pub fn peak_memory_mb() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

/// Sets the mark of [`peak_memory_mb`] back to what is in use now; says whether the system did.
pub(crate) fn forget_peak() -> bool {
    fs::write("/proc/self/clear_refs", "5").is_ok()
}
