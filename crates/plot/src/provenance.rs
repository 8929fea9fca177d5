//! Provenance of a run, and its cost.

use std::{
    collections::BTreeMap,
    fs,
    time::{Instant, SystemTime},
};

use real::Simd;
use serde::Serialize;

/// Provenance of a run: sources, compiler, machine, command and times.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// Commit of the sources that the program was built from, with `-dirty` appended when the tree
    /// differed from it; `unknown` if the build was not told.
    pub git: String,
    /// Compiler that built the program.
    pub rustc: String,
    /// The day of the run (UTC).
    pub day: String,
    /// The folder in which the program was started.
    pub folder: String,
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

/// Text for an unknown fact.
const UNKNOWN: &str = "unknown";

/// Completes the provenance of a run that began at `start`: version, compiler, day, folder,
/// processor, instruction set, command and wall time. Other fields stay.
///
/// `program` is the command that a user types in front of the arguments; `commit` is the commit
/// that the build was told, `option_env!("CASIMIR_COMMIT")`.
pub fn complete(
    known: Provenance,
    program: &str,
    commit: Option<&str>,
    start: Instant,
) -> Provenance {
    let folder = std::env::current_dir();
    Provenance {
        version: env!("CARGO_PKG_VERSION").into(),
        git: commit.unwrap_or(UNKNOWN).into(),
        rustc: env!("CASIMIR_RUSTC").into(),
        day: day(SystemTime::UNIX_EPOCH.elapsed().map_or(0, |since| since.as_secs() / 86400)),
        folder: folder.map_or(UNKNOWN.into(), |folder| folder.display().to_string()),
        cpu: fact("/proc/cpuinfo", "model name").unwrap_or(std::env::consts::ARCH.into()),
        simd: Simd::current().name().into(),
        command: std::env::args().skip(1).fold(program.into(), |all, next| all + " " + &next),
        wall_s: start.elapsed().as_secs_f64(),
        ..known
    }
}

/// Date that is `number` days after 1970-01-01, in the Gregorian calendar; months are counted from
/// March on, and eras have 400 years.
fn day(number: u64) -> String {
    let (era, day) = ((number + 719_468) / 146_097, (number + 719_468) % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let year = 400 * era + year + month / 10;
    format!("{year}-{:02}-{day:02}", (month + 2) % 12 + 1)
}

/// Text after the first `key:` in a file of the system.
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
        let found = complete(run, "program", Some("abc"), Instant::now());
        assert_eq!((&*found.git, &*found.version), ("abc", env!("CARGO_PKG_VERSION")));
        assert_eq!(complete(found.clone(), "program", None, Instant::now()).git, UNKNOWN);
        assert!(found.rustc.starts_with("rustc 1."), "{}", found.rustc);
        assert_eq!(found.folder, std::env::current_dir().unwrap().display().to_string());
        assert_eq!((found.seed, &*found.mode), (7, "quick"));
        for text in [found.day, found.cpu, found.simd, found.command] {
            assert!(!text.is_empty());
        }
    }

    #[test]
    fn days_are_those_of_the_calendar() {
        let known =
            [(0, "1970-01-01"), (59, "1970-03-01"), (789, "1972-02-29"), (11_016, "2000-02-29")];
        for (number, expected) in known.into_iter().chain([
            (20_819, "2027-01-01"),
            (47_540, "2100-02-28"),
            (47_541, "2100-03-01"),
        ]) {
            assert_eq!(day(number), expected);
        }
    }
}
