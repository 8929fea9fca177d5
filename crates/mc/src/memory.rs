//! Memory, estimated before it is taken: an allocation that fails ends the process.

use std::{fs, path::Path};

/// A demand for more memory than is free; nothing was computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{what} would take about {} of memory, and {} is free",
    gigabytes(*bytes), gigabytes(*free)
)]
pub struct MemoryError {
    /// Name of the work that takes the memory, and advice on what would take less.
    pub what: String,
    /// Estimated number of bytes of the work.
    pub bytes: f64,
    /// Number of bytes that are free.
    pub free: f64,
}

fn gigabytes(bytes: f64) -> String {
    match bytes / 1e9 {
        size @ 0.1..1e6 => format!("{size:.1} GB"),
        size => format!("{size:.0e} GB"),
    }
}

/// Bytes that any work may take where the system does not say how many are free.
const UNKNOWN: f64 = (1u64 << 40) as f64;

/// Number of bytes below which work is not refused.
const SMALL: f64 = 1e8;

/// Refuses `what` if it takes about `bytes` bytes and fewer are free.
///
/// # Errors
/// [`MemoryError`].
pub fn demand(what: impl Into<String>, bytes: f64) -> Result<(), MemoryError> {
    if bytes < SMALL {
        return Ok(());
    }
    let free = free().unwrap_or(UNKNOWN);
    if bytes <= free { Ok(()) } else { Err(MemoryError { what: what.into(), bytes, free }) }
}

/// Bytes that are free on Linux, within the limits of the process and of its control groups
/// (version 2), whose pages of files can be dropped.
fn free() -> Option<f64> {
    let number = |text: &str, key: &str| -> Option<f64> {
        let after = text.lines().find_map(|line| line.strip_prefix(key))?;
        after.split_whitespace().next()?.parse().ok()
    };
    let read = |folder: &Path, file| fs::read_to_string(folder.join(file)).ok();
    let machine = 1024.0 * number(&read(Path::new("/proc"), "meminfo")?, "MemAvailable:")?;
    let own = |file, key| number(&read(Path::new("/proc/self"), file)?, key);
    let addresses = own("limits", "Max address space").zip(own("status", "VmSize:"));
    let limit = addresses.map_or(machine, |(most, used)| machine.min(most - 1024.0 * used));
    let groups = read(Path::new("/proc/self"), "cgroup").unwrap_or_default();
    let group = groups.lines().find_map(|line| line.strip_prefix("0::/")).unwrap_or_default();
    let left = |group: &Path| {
        let folder = Path::new("/sys/fs/cgroup").join(group);
        let [limit, used] = ["memory.max", "memory.current"]
            .map(|file| read(&folder, file)?.trim().parse::<f64>().ok());
        Some(limit? - used? + number(&read(&folder, "memory.stat")?, "file ")?)
    };
    Some(Path::new(group).ancestors().filter_map(left).fold(limit, f64::min))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_any_machine_has_is_refused() {
        assert_eq!(demand("a byte", 1.0), Ok(()));
        let error = demand("an exabyte", 1e18).unwrap_err();
        let words = "an exabyte would take about 1e9 GB of memory, and ";
        assert!(error.to_string().starts_with(words), "{error}");
        assert!(demand("no number", f64::NAN).is_err());
    }

    /// Runs in a process of its own, with a limit of 2 GiB, of which it takes 1 GiB.
    #[cfg(target_os = "linux")]
    #[test]
    fn what_is_taken_counts_towards_a_limit() {
        const LIMITED: &str = "CASIMIR_TEST_IS_LIMITED";
        if std::env::var_os(LIMITED).is_some() {
            let _taken = std::hint::black_box(Vec::<u8>::with_capacity(1 << 30));
            assert!(demand("more than is left", 1.2e9).is_err());
            return;
        }
        let own = "memory::tests::what_is_taken_counts_towards_a_limit";
        let mut limited = std::process::Command::new("sh");
        limited.args(["-c", "ulimit -v 2097152 && exec \"$0\" --exact \"$1\""]);
        limited.arg(std::env::current_exe().unwrap()).arg(own).env(LIMITED, "");
        let output = limited.output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && said.contains("1 passed"), "{output:?}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_says_what_is_free() {
        let free = free().unwrap();
        assert!(free > 1e6 && free < 1e15, "{free}");
        assert!(demand("twice what is free", 2.0 * free).is_err());
        assert!(demand("half of it", 0.5 * free).is_ok());
    }
}
