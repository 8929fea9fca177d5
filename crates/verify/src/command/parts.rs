//! Runs whole, in parts, merged and planned: the arguments for it, and what comes of them.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::ExitCode,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use mc::parts::{Job, JobError, Outcome, Plan, PlannedPart, Share, Stop, remove};
use report::{
    cluster::{JOB, Script},
    files,
};

use super::{Study, table};

/// How long each piece of work is measured for a plan.
const MEASURED: Duration = Duration::from_millis(200);
/// The exit code of a program that was stopped.
const STOPPED: u8 = 130;

/// The arguments of runs in parts.
#[derive(Args, Clone, Debug)]
pub struct Parts {
    /// Divide the work among N parts, of which this is the one that --part says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    parts: Option<u64>,
    /// Compute part K of N and keep it in --out; `cargo xtask merge DIR` makes the results.
    #[arg(long, value_name = "K", requires = "parts")]
    part: Option<u64>,
    /// What `cargo xtask merge` calls.
    #[arg(long, hide = true, conflicts_with_all = ["parts", "plan"])]
    merge: bool,
    /// What `cargo xtask plan` calls.
    #[arg(long, hide = true, requires = "parts", conflicts_with = "part")]
    plan: bool,
    #[command(flatten)]
    script: ScriptArguments,
}

/// What goes into a job script.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "With `cargo xtask plan`, for the job script")]
struct ScriptArguments {
    /// Account that pays.
    #[arg(long, value_name = "A", requires = "plan")]
    account: Option<String>,
    /// Partition of the cluster.
    #[arg(long, value_name = "P", requires = "plan")]
    partition: Option<String>,
    /// Most minutes of a part; from the measurement, with a margin, unless given.
    #[arg(long, value_name = "MINUTES", requires = "plan")]
    time: Option<u64>,
    /// Memory of a part, such as 500M; that of the cluster unless given.
    #[arg(long, value_name = "SIZE", requires = "plan")]
    memory: Option<String>,
    /// Processors of a part.
    #[arg(long, value_name = "C", default_value_t = 1, requires = "plan")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    cpus: u64,
}

/// A run that has begun.
pub struct Running {
    /// What is done with work for parts.
    pub job: Job,
    parts: Parts,
    study: Study,
    folder: PathBuf,
    start: Instant,
}

impl Parts {
    /// Begins a run of `study`, with its parts or its checkpoint in `folder`. `works` does with a
    /// job what the run will do with its own, so that parts can be made equal.
    ///
    /// # Errors
    /// When the folder has another study or cannot be written, or the arguments make no sense.
    pub fn begin(&self, study: Study, folder: &Path, works: impl FnOnce(&Job)) -> Result<Running> {
        let stop = Stop::default();
        stop.on_signals().context("cannot wait for Ctrl-C")?;
        let plan = || {
            let job = Job::pilot(Duration::ZERO);
            works(&job);
            job.plan()
        };
        let job = match (self.plan, self.merge, self.part, self.parts) {
            (true, ..) => {
                study.settle(folder)?;
                Job::pilot(MEASURED)
            }
            (_, true, ..) => Job::merge(folder, study.program())?.balanced(&plan()?),
            (.., Some(part), Some(parts)) => {
                let share = Share::new(part, parts)?;
                study.settle(folder)?;
                Job::part(folder, share, study.program())?.balanced(&plan()?)
            }
            (.., None, Some(parts)) => {
                bail!("which of the {parts} parts? --part 1 to --part {parts}")
            }
            _ => Job::part(folder, Share::WHOLE, study.program())
                .map_err(|error| of_whole(error, folder))?,
        };
        let job = job.stopped_by(&stop);
        if job.resumes() {
            eprintln!("going on from a checkpoint in {}", folder.display());
            if self.part.is_none() {
                eprintln!("{}", anew(folder));
            }
        }
        let (parts, folder) = (self.clone(), folder.to_owned());
        Ok(Running { job, parts, study, folder, start: Instant::now() })
    }

    /// Whether everything is computed here.
    fn is_whole(&self) -> bool {
        self.parts.is_none() && !self.merge
    }
}

/// How to begin a whole run anew.
fn anew(folder: &Path) -> String {
    let file = folder.join(Share::WHOLE.file_name());
    format!("to begin anew, delete {}", file.display())
}

/// An error of a whole run, which may go on from a checkpoint of another one.
fn of_whole(error: JobError, folder: &Path) -> anyhow::Error {
    match error {
        JobError::Foreign { .. } => anyhow!("{error}; or {}", anew(folder)),
        error => error.into(),
    }
}

impl Running {
    /// Ends the run. `None` if there are results to be written; otherwise this was all, and the
    /// exit code is given.
    ///
    /// # Errors
    /// That of the job.
    pub fn end(self) -> Result<Option<ExitCode>> {
        let Self { job, parts, study, folder, start } = self;
        if parts.plan {
            let plan = job.plan()?;
            parts.write_plan(&plan, &study, &folder, start.elapsed().as_secs_f64())?;
            return Ok(Some(ExitCode::SUCCESS));
        }
        match job.finish() {
            Ok(Outcome::Complete) => {
                if parts.merge {
                    study.note_merged(&folder)?;
                }
                Ok(None)
            }
            Ok(Outcome::Part(share)) => {
                let file = folder.join(share.file_name());
                let bytes = fs::metadata(&file).map_or(0, |file| file.len());
                let seconds = start.elapsed().as_secs_f64();
                let file = file.display();
                println!("{share} in {seconds:.1} s: {file}, {}", size(bytes));
                Ok(Some(ExitCode::SUCCESS))
            }
            Err(error @ JobError::Stopped) => {
                eprintln!("{error}");
                Ok(Some(ExitCode::from(STOPPED)))
            }
            Err(error) if parts.is_whole() => Err(of_whole(error, &folder)),
            Err(error) => Err(error.into()),
        }
    }
}

impl Parts {
    /// Ends a run whose results are written: without parts, its checkpoint is not needed any more.
    ///
    /// # Errors
    /// When the checkpoint stays.
    pub fn forget(&self, folder: &Path) -> Result<()> {
        if self.is_whole() {
            remove(folder, Share::WHOLE)?;
        }
        Ok(())
    }

    /// Writes the job script, and says what the study takes.
    fn write_plan(&self, plan: &Plan, study: &Study, folder: &Path, pilot: f64) -> Result<()> {
        let (parts, cpus) = (self.parts.unwrap_or(1), self.script.cpus);
        let path = |path: &Path| path.display().to_string();
        let folder = fs::canonicalize(folder)?;
        let longest = longest(&plan.parts(parts, cpus));
        let minutes = self.script.time.unwrap_or_else(|| minutes_for(longest));
        let given = |name: &str, value: &Option<String>| {
            value.as_ref().map(|value| format!("--{name}={value}"))
        };
        let ScriptArguments { account, partition, memory, .. } = &self.script;
        let options: Vec<String> =
            [given("account", account), given("partition", partition), given("mem", memory)]
                .into_iter()
                .flatten()
                .collect();
        let (program, directory) = (env::current_exe()?, env::current_dir()?);
        let mut arguments = study.command();
        arguments.extend(["--parts".into(), parts.to_string(), "--out".into(), path(&folder)]);
        let script = Script {
            name: &study.program,
            written_by: "cargo xtask plan",
            parts,
            program: &path(&program),
            arguments: &arguments,
            folder: &path(&folder),
            directory: &path(&directory),
            minutes,
            cpus,
            options: &options,
        };
        files::write(&folder.join(JOB), script.slurm())?;
        println!("{}\n", works(plan));
        println!("{}", summary(plan, parts, cpus, pilot));
        println!("job script, {minutes} minutes a part: {}\n", folder.join(JOB).display());
        print!("{}", script.lines());
        println!("then:\n  cargo xtask merge {}", report::cluster::quoted(&path(&folder)));
        Ok(())
    }
}

/// Twice what was measured, for slower machines, and five minutes to begin.
fn minutes_for(seconds: f64) -> u64 {
    (2.0 * seconds / 60.0).ceil() as u64 + 5
}

/// What there is to compute.
fn works(plan: &Plan) -> comfy_table::Table {
    let rows = plan.works.iter().map(|work| {
        let steps = if work.steps > 0 { work.steps.to_string() } else { String::new() };
        let seconds = format!("{:.1}", work.groups as f64 * work.seconds);
        [work.name.clone(), work.items.to_string(), steps, seconds]
    });
    table(["work", "paths", "steps of a path", "seconds of a thread"], 1, rows)
}

/// Hours below which nobody needs a cluster.
const ONE_MACHINE_HOURS: f64 = 1.0;

/// Seconds of the part that takes longest.
fn longest(parts: &[PlannedPart]) -> f64 {
    parts.iter().map(|part| part.seconds).fold(0.0, f64::max)
}

fn summary(plan: &Plan, number: u64, cpus: u64, pilot: f64) -> String {
    let threads = rayon::current_num_threads() as u64;
    let (here, parts) = (longest(&plan.parts(1, threads)), plan.parts(number, cpus));
    let part = longest(&parts);
    let largest = parts.iter().map(|part| part.bytes).max().unwrap_or(0);
    let need = if here < 3600.0 * ONE_MACHINE_HOURS {
        "a cluster is not needed"
    } else {
        "parts make it shorter"
    };
    let steps = plan.path_steps() as f64;
    let speed = if steps > 0.0 {
        format!("{steps:.1e} path-steps of {:.1} ns on one thread", plan.nanoseconds())
    } else {
        "no path-steps".into()
    };
    let short = if part < 60.0 && number > 1 {
        "; such short parts mostly wait to be started, fewer would do"
    } else {
        ""
    };
    format!(
        "{speed}, measured here in {pilot:.0} s\n\
         this machine with {threads} threads: {}; {need}\n\
         the longest of {number} parts with {cpus} threads: {}, {} of file{short}\n\
         What has no ladders is computed when the parts are merged.",
        duration(here),
        duration(part),
        size(largest),
    )
}

/// A time in words.
fn duration(seconds: f64) -> String {
    match seconds {
        0.0..120.0 => format!("{seconds:.0} s"),
        120.0..7200.0 => format!("{:.0} minutes", seconds / 60.0),
        7200.0..172_800.0 => format!("{:.0} hours", seconds / 3600.0),
        _ => format!("{:.0} days", seconds / 86_400.0),
    }
}

/// A size in words.
fn size(bytes: u64) -> String {
    match bytes as f64 {
        bytes @ 0.0..1e6 => format!("{:.0} kB", bytes / 1e3),
        bytes => format!("{:.1} MB", bytes / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_sizes_have_units() {
        let times = [5.0, 600.0, 36_000.0, 864_000.0].map(duration);
        assert_eq!(times, ["5 s", "10 minutes", "10 hours", "10 days"]);
        assert_eq!([12_345, 12_345_678].map(size), ["12 kB", "12.3 MB"]);
        assert_eq!([1.0, 600.0].map(minutes_for), [6, 25]);
    }
}
