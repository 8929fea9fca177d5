//! Where a run comes from, and what it took.

use std::{collections::BTreeMap, fs, process::Command, time::Instant};

use real::Level;
use serde::Serialize;

/// Where a run comes from and how long it took.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Provenance {
    /// Commit of the workspace, with `-dirty` appended when the tree differs from it.
    pub git: String,
    /// Compiler version.
    pub rustc: String,
    /// Processor name.
    pub cpu: String,
    /// Instruction set the kernels ran on: `avx512`, `avx2` or `baseline`.
    pub simd: String,
    /// Worker threads.
    pub threads: usize,
    /// Master seed.
    pub seed: u64,
    /// `paper` or `quick`.
    pub mode: String,
    /// The command line.
    pub command: String,
    /// Wall time of the whole run in seconds.
    pub wall_s: f64,
    /// Wall time of each panel and each statement in seconds, by id.
    pub wall_s_by_id: BTreeMap<String, f64>,
}

impl Provenance {
    /// Seed, mode and threads of a run on the current rayon pool; the rest is empty.
    pub fn of_run(seed: u64, mode: &str) -> Self {
        let threads = rayon::current_num_threads();
        Self { seed, mode: mode.into(), threads, ..Self::default() }
    }
}

/// What is written for a fact that nobody tells.
const UNKNOWN: &str = "unknown";

/// Completes the provenance of a run that began at `start`: commit of the sources, compiler,
/// processor, instruction set, command and wall time. What else it holds stays.
///
/// `program` is what a user types in front of the arguments.
pub fn complete(known: Provenance, program: &str, start: Instant) -> Provenance {
    Provenance {
        git: first_line(
            "git",
            &[
                // The folder of the run may be of another repository.
                "-C",
                env!("CARGO_MANIFEST_DIR"),
                "describe",
                "--always",
                "--dirty",
                "--abbrev=12",
                "--exclude=*",
            ],
        ),
        rustc: first_line("rustc", &["--version"]),
        cpu: fact("/proc/cpuinfo", "model name").unwrap_or(std::env::consts::ARCH.into()),
        simd: Level::current().name().into(),
        command: std::iter::once(program.into())
            .chain(std::env::args().skip(1))
            .collect::<Vec<_>>()
            .join(" "),
        wall_s: start.elapsed().as_secs_f64(),
        ..known
    }
}

/// First line that a command prints, or `unknown`.
fn first_line(program: &str, arguments: &[&str]) -> String {
    match Command::new(program).args(arguments).output() {
        Ok(output) if output.status.success() => {
            String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or(UNKNOWN).into()
        }
        _ => UNKNOWN.into(),
    }
}

/// What follows the first `key:` in a file of the system.
fn fact(file: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    Some(line.split_once(':')?.1.trim().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fact_is_found() {
        let run = Provenance::of_run(7, "quick");
        assert_eq!(run.threads, rayon::current_num_threads());
        let found = complete(run, "program", Instant::now());
        assert_eq!((found.seed, &*found.mode), (7, "quick"));
        for text in [found.git, found.rustc, found.cpu, found.simd, found.command] {
            assert!(!text.is_empty());
        }
    }
}
