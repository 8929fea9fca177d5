//! Where a run comes from.

use std::fs;
use std::process::Command;

use real::Level;

/// First line that a command prints, or `unknown`.
fn first_line(program: &str, arguments: &[&str]) -> String {
    Command::new(program)
        .args(arguments)
        .output()
        .ok()
        .filter(|output| output.status.success())
        .and_then(|output| String::from_utf8(output.stdout).ok())
        .and_then(|text| text.lines().next().map(str::to_owned))
        .unwrap_or_else(|| "unknown".to_owned())
}

/// Commit of the workspace, with `-dirty` when the tree differs from it.
pub fn git() -> String {
    first_line("git", &["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"])
}

/// Version of the compiler.
pub fn rustc() -> String {
    first_line("rustc", &["--version"])
}

/// Name of the processor.
pub fn cpu() -> String {
    fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        })
        .unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

/// Instruction set that the kernels run on.
pub fn simd() -> String {
    Level::current().name().to_owned()
}

/// Largest resident memory of this process so far in MB, where the system tells.
pub fn peak_memory_mb() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}
