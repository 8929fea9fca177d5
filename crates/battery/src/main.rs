//! `cargo xtask verify`: all statements for many master seeds, all twins, the coverage of the
//! intervals, the library of known answers, and the page `docs/verification.md`.

use std::{path::PathBuf, process::ExitCode, time::Instant};

use analysis::{
    Mode, Progress, Settings, Silent,
    results::{Claim, Evidence},
};
use anyhow::Result;
use battery::{
    library,
    page::{self, Battery},
    twins::{TWINS, measure_twins},
};
use clap::{Parser, value_parser};
use mc::parts::{Job, limit_threads};
use report::{Bars, files, terminal};
use verify::{
    EXPERIMENTS, Experiment, Method, STATEMENTS, SUPPLEMENTS,
    command::{self, Parts, Study},
    ids,
};

/// Runs the whole battery for many seeds, with all wrong twins, and writes docs/verification.md.
#[derive(Parser)]
#[command(name = "cargo xtask verify", version)]
struct Arguments {
    /// Master seeds 1 … N.
    #[arg(long, value_name = "N", default_value_t = 20)]
    #[arg(value_parser = value_parser!(u64).range(1..))]
    seeds: u64,
    /// Replications behind each coverage figure.
    #[arg(long, value_name = "N", default_value_t = 4000)]
    #[arg(value_parser = value_parser!(u64).range(100..))]
    replications: u64,
    /// Seeds of the library of known answers.
    #[arg(long, value_name = "N", default_value_t = 20)]
    #[arg(value_parser = value_parser!(u64).range(5..))]
    library_seeds: u64,
    /// Half-width of the intervals of the expectations.
    #[arg(long, value_name = "ACCURACY", default_value_t = 2e-5, value_parser = accuracy)]
    accuracy: f64,
    /// The page to write.
    #[arg(long, value_name = "FILE", default_value = "docs/verification.md")]
    page: PathBuf,
    /// Folder for parts and checkpoints; created if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "target/verify")]
    out: PathBuf,
    /// Worker threads; all processors unless given.
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(flatten)]
    parts: Parts,
}

impl Arguments {
    /// Those that decide what is computed. Seeds may be added.
    fn study(&self) -> Result<Study> {
        let arguments = [
            ("--replications", self.replications.to_string()),
            ("--accuracy", self.accuracy.to_string()),
        ];
        let arguments = arguments.map(|(name, value)| [name.to_owned(), value]).concat();
        let sizes = [("--seeds", self.seeds), ("--library-seeds", self.library_seeds)];
        let sizes = sizes.map(|(name, seeds)| (name.to_owned(), seeds as f64)).into();
        Study::new("analysis", arguments, sizes, &self.out)
    }
}

/// A half-width that can be reached: at 1e-6 the cost would be days.
fn accuracy(text: &str) -> Result<f64, String> {
    let accuracy: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    match accuracy {
        1e-6..1.0 => Ok(accuracy),
        _ => Err(format!("the half-width must be at least 1e-6 and below 1, got {accuracy}")),
    }
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

/// Runs the battery. Succeeds when nothing is refuted, documented misprints aside, and every twin
/// is.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    files::prepare_file(&arguments.page)?;
    files::prepare(&arguments.out)?;
    arguments.threads.map_or(Ok(()), |threads| limit_threads(threads.into()))?;
    let start = Instant::now();
    let running = arguments.parts.begin(arguments.study()?, &arguments.out, |_| ())?;
    let bars = Bars::default();
    let battery = measure(arguments, &running.job, &bars);
    bars.finish();
    if let Some(code) = running.end()? {
        return Ok(code);
    }
    page::page(&battery).write(&arguments.page)?;
    arguments.parts.forget(&arguments.out)?;
    let false_answers = battery.false_answers();
    let alarms = battery.false_alarms() + false_answers.len();
    let missed = battery.missed_twins() + battery.missed_rules();
    println!(
        "{} seeds in {:.0} s: {alarms} false alarms, {missed} twins not refuted",
        arguments.seeds,
        start.elapsed().as_secs_f64()
    );
    println!("page: {}", arguments.page.display());
    Ok(if alarms + missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Everything that is asked, as work of a job; incomplete where that gives no results.
fn measure(arguments: &Arguments, job: &Job, bars: &Bars) -> Battery {
    let &Arguments { seeds, replications, library_seeds, accuracy, .. } = arguments;
    // Where many things are asked at a time, only the last one would be on the bar.
    let part = |name: &str, work| {
        bars.end();
        bars.begin(name, work);
    };
    part("claims", seeds);
    let claims = job.tasks("claims", &all_ids(), seeds, |n| {
        let claims = claims(n + 1, job).ok()?;
        bars.println(&format!("seed {}: {}", n + 1, terminal::counts(&claims)));
        bars.advance(1);
        Some(claims.into_iter().map(in_words).collect::<Vec<_>>())
    });
    part("twins", seeds);
    let mistakes: Vec<&str> = TWINS.iter().map(|(_, mistake, _)| *mistake).collect();
    let twins = job.tasks("twins", &mistakes.join("\n"), seeds, |n| {
        let twins = measure_twins(Settings::new(n + 1, Mode::Quick), &Silent);
        bars.advance(1);
        Some(twins.into_iter().map(in_words).collect::<Vec<_>>())
    });
    part("expectations", 1);
    let settings = Settings::new(1, Mode::Paper);
    let expectations = verify::expectation_claims(settings, accuracy, job, bars);
    part("coverage of the intervals", 1);
    let coverage = battery::coverage(replications, 1, job);
    part("the library of known answers", 1);
    let library = library::ask(&library::entries(), library_seeds, job);
    Battery {
        claims: claims.unwrap_or_default(),
        twins: twins.unwrap_or_default(),
        expectations,
        coverage: coverage.unwrap_or_default(),
        library: library.unwrap_or_default(),
    }
}

/// A claim with its verdict in words, and without the numbers that the page does not need: they may
/// be infinite, which the file of a part cannot say.
fn in_words(claim: Claim) -> Claim {
    let measured = match claim.measured {
        Evidence::Order { order, one_sided, .. } => {
            Evidence::Order { order, one_sided, rate: None, wrong_limit: None }
        }
        _ => Evidence::Undecided { reason: String::new() },
    };
    Claim { measured, ..claim }
}

fn all_experiments() -> Vec<Experiment> {
    [EXPERIMENTS, STATEMENTS, SUPPLEMENTS].concat()
}

fn all_ids() -> String {
    ids(&all_experiments()).join(" ")
}

/// All claims for one seed, at the paper's sizes; what takes long is small but for the first seed.
///
/// # Errors
/// When the job was stopped.
fn claims(seed: u64, job: &Job) -> Result<Vec<Claim>> {
    let (long, short): (Vec<_>, Vec<_>) =
        all_experiments().into_iter().partition(|experiment| experiment.takes_long);
    let run = |mode, experiments: &[Experiment]| -> Result<Vec<Claim>> {
        let here = Job::here().stopped_by(job.stop());
        let (ids, settings) = (ids(experiments), Settings::new(seed, mode));
        let results = verify::reproduce(settings, &ids, &Method::FURTHER, &here, &Silent)?;
        here.finish()?;
        Ok(results.claims)
    };
    let mut claims = run(Mode::Paper, &short)?;
    claims.extend(run(if seed == 1 { Mode::Paper } else { Mode::Quick }, &long)?);
    Ok(claims)
}
