//! The arguments of a user's program.

use std::{env, path::PathBuf};

use super::{Job, JobError, Program, Share, Stop};

pub const USAGE: &str = "[--out DIR [--part K --parts N]] | --merge DIR, and --threads N";

impl Job {
    /// The job that the command line asks for; it stops on Ctrl-C and SIGTERM.
    ///
    /// | arguments | job |
    /// |---|---|
    /// | none | everything here |
    /// | `--out DIR` | everything here, with checkpoints in the folder |
    /// | `--out DIR --part 3 --parts 64` | part 3 of 64 |
    /// | `--merge DIR` | results from the parts in the folder |
    ///
    /// `--threads N` limits the threads, by default one for each processor.
    ///
    /// # Errors
    /// [`JobError::Argument`] for anything else, and the errors of [`part`](Self::part) and
    /// [`merge`](Self::merge).
    pub fn from_arguments(program: Program) -> Result<Self, JobError> {
        let job = Self::parse(program, env::args().skip(1))?;
        let stop = Stop::default();
        if let Err(error) = stop.on_signals() {
            eprintln!("warning: Ctrl-C loses what is not in a checkpoint: {error}");
        }
        Ok(job.stopped_by(&stop))
    }

    fn parse(
        program: Program,
        mut arguments: impl Iterator<Item = String>,
    ) -> Result<Self, JobError> {
        let wrong = |text: &str| JobError::Argument(text.to_owned());
        let number = |text: &str| text.parse::<u64>().map_err(|_| wrong(text));
        let (mut out, mut merge): (Option<PathBuf>, Option<PathBuf>) = (None, None);
        let (mut part, mut parts) = (None, None);
        while let Some(name) = arguments.next() {
            let value = arguments.next().ok_or_else(|| wrong(&name))?;
            match name.as_str() {
                "--out" => out = Some(value.into()),
                "--merge" => merge = Some(value.into()),
                "--part" => part = Some(number(&value)?),
                "--parts" => parts = Some(number(&value)?),
                "--threads" => limit_threads(number(&value)?),
                _ => return Err(wrong(&name)),
            }
        }
        match (out, merge, part, parts) {
            (None, None, None, None) => Ok(Self::here()),
            (None, Some(folder), None, None) => Self::merge(&folder, program),
            (Some(folder), None, None, None) => Self::part(&folder, Share::WHOLE, program),
            (Some(folder), None, Some(part), Some(parts)) => {
                Self::part(&folder, Share::new(part, parts)?, program)
            }
            _ => Err(wrong("this combination")),
        }
    }
}

/// Limits the threads of everything that runs on the global pool.
fn limit_threads(threads: u64) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
    if let Err(error) = pool.build_global() {
        eprintln!("warning: the number of threads stays: {error}");
    }
}
