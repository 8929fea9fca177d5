//! The arguments of a user's program.

use std::{path::Path, str::FromStr, time::Duration};

use super::{Job, JobError, Program, Share, Stop};

impl Job {
    /// The job that the command line of a program asks for. It stops on Ctrl-C and SIGTERM. Its
    /// arguments are taken out; what is left are those of the program.
    ///
    /// | arguments | job |
    /// |---|---|
    /// | none | everything here |
    /// | `--out DIR` | everything here, with checkpoints in the folder |
    /// | `--out DIR --part 3 --parts 64` | part 3 of 64 |
    /// | `--merge DIR` | results from the parts in the folder |
    ///
    /// `--threads N` limits the threads; without it there is one for each processor.
    /// `--checkpoint-every SECONDS` is a minute unless given.
    ///
    /// # Errors
    /// [`JobError::Argument`] for a value that is not understood or a combination that is none, and
    /// the errors of [`part`](Self::part) and [`merge`](Self::merge).
    pub fn from_arguments(program: Program, arguments: &mut Vec<String>) -> Result<Self, JobError> {
        let stop = Stop::default();
        let job = Self::of(program, arguments)?.stopped_by(&stop);
        if let Err(error) = stop.on_signals() {
            eprintln!("warning: Ctrl-C loses what is not in a checkpoint: {error}");
        }
        Ok(job)
    }

    fn of(program: Program, arguments: &mut Vec<String>) -> Result<Self, JobError> {
        let mut take = |name: &str| {
            let at = arguments.iter().position(|argument| argument == name)?;
            let value = (at + 1 < arguments.len()).then(|| arguments.remove(at + 1));
            arguments.remove(at);
            value.or(Some(String::new()))
        };
        let [out, merge] = ["--out", "--merge"].map(&mut take);
        let [part, parts, threads] =
            ["--part", "--parts", "--threads"].map(|name| number::<u64>(name, take(name)));
        let every = number("--checkpoint-every", take("--checkpoint-every"))?;
        threads?.map_or(Ok(()), limit_threads)?;
        let (out, merge) = (out.as_deref().map(Path::new), merge.as_deref().map(Path::new));
        let job = match (out, merge, part?, parts?) {
            (None, None, None, None) => Self::here(),
            (None, Some(folder), None, None) => Self::merge(folder, program)?,
            (Some(folder), None, None, None) => Self::part(folder, Share::WHOLE, program)?,
            (Some(folder), None, Some(part), Some(parts)) => {
                Self::part(folder, Share::new(part, parts)?, program)?
            }
            _ => return Err(not_understood("this combination of arguments")),
        };
        let every = every.map(|every: f64| Duration::from_secs_f64(every.clamp(0.0, 1e9)));
        Ok(every.into_iter().fold(job, Self::with_checkpoints_every))
    }
}

fn not_understood(what: &str) -> JobError {
    JobError::Argument(format!(
        "cannot understand {what}; arguments are [--out DIR [--part K --parts N]] or --merge DIR, \
         and [--threads N] and [--checkpoint-every SECONDS]"
    ))
}

fn number<T: FromStr>(name: &str, value: Option<String>) -> Result<Option<T>, JobError> {
    let parse = |text: String| text.parse().map_err(|_| not_understood(&format!("{name} {text}")));
    value.map(parse).transpose()
}

/// Limits the threads of everything that is computed from now on in this process.
///
/// # Errors
/// [`JobError::Argument`] for no thread, or if work has begun already.
pub fn limit_threads(threads: u64) -> Result<(), JobError> {
    let refused =
        |why: String| JobError::Argument(format!("cannot compute with {threads} threads: {why}"));
    if threads == 0 {
        return Err(refused("at least one is needed".into()));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
    pool.build_global().map_err(|error| refused(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(line: &str) -> Result<Vec<String>, String> {
        let mut arguments: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        let program = Program { name: "test".into(), version: "1".into() };
        let finished = Job::of(program, &mut arguments).and_then(Job::finish);
        finished.map(|_| arguments).map_err(|error| error.to_string())
    }

    #[test]
    fn the_arguments_of_a_job_are_taken_out() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().to_str().unwrap();
        assert_eq!(job("1e6 --fast").unwrap(), ["1e6", "--fast"]);
        let part = format!("1e6 --part 2 --out {folder} --parts 3");
        assert_eq!(job(&part).unwrap(), ["1e6"]);
        assert!(std::path::Path::new(folder).join("part-2-of-3.bin").exists());
        for (line, told) in [
            ("--part 2 --parts 3".to_owned(), "this combination"),
            (format!("--out {folder} --part 2"), "this combination"),
            (format!("--out {folder} --merge {folder}"), "this combination"),
            (format!("--out {folder} --part two --parts 3"), "--part two"),
            (format!("--out {folder} --part 4 --parts 3"), "no part 4 of 3"),
            (format!("--out {folder} --checkpoint-every ever"), "--checkpoint-every"),
            ("--threads 0".to_owned(), "with 0 threads: at least one"),
            ("--threads".to_owned(), "--threads "),
        ] {
            let error = job(&line).unwrap_err();
            assert!(error.contains(told), "{line}: {error}");
        }
    }
}
