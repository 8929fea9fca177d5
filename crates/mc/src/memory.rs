//! Memory, estimated before it is taken: an allocation that fails ends the process.

use std::{fs, path::Path};

use crate::RunError;

/// Bytes that any work may take where the system does not say how many are free.
const UNKNOWN: f64 = (1u64 << 40) as f64;

/// Refuses `what` where it takes about so many bytes and fewer are free.
///
/// # Errors
/// [`RunError::Memory`].
pub fn demand(what: impl Into<String>, bytes: f64) -> Result<(), RunError> {
    let free = free().unwrap_or(UNKNOWN);
    match bytes <= free {
        true => Ok(()),
        false => Err(RunError::Memory { what: what.into(), bytes, free }),
    }
}

/// Bytes that are free on Linux, within the limits of the control groups of the process (version
/// 2), whose pages of files can be dropped.
fn free() -> Option<f64> {
    let number = |text: &str, key: &str| -> Option<f64> {
        let after = text.lines().find_map(|line| line.strip_prefix(key))?;
        after.split_whitespace().next()?.parse().ok()
    };
    let read = |folder: &Path, file| fs::read_to_string(folder.join(file)).ok();
    let machine = 1024.0 * number(&read(Path::new("/proc"), "meminfo")?, "MemAvailable:")?;
    let groups = read(Path::new("/proc/self"), "cgroup").unwrap_or_default();
    let group = groups.lines().find_map(|line| line.strip_prefix("0::/")).unwrap_or_default();
    let left = |group: &Path| {
        let folder = Path::new("/sys/fs/cgroup").join(group);
        let [limit, used] = ["memory.max", "memory.current"]
            .map(|file| read(&folder, file)?.trim().parse::<f64>().ok());
        Some(limit? - used? + number(&read(&folder, "memory.stat")?, "file ")?)
    };
    Some(Path::new(group).ancestors().filter_map(left).fold(machine, f64::min))
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

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_says_what_is_free() {
        let free = free().unwrap();
        assert!(free > 1e6 && free < 1e15, "{free}");
        assert!(demand("twice what is free", 2.0 * free).is_err());
        assert!(demand("half of it", 0.5 * free).is_ok());
    }
}
