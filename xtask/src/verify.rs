//! `cargo xtask verify`: the whole battery for many master seeds, and `docs/verification.md`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;
use verify::results::{Claim, Verdict};
use verify::{EXPERIMENTS, Mode, STATEMENTS, SUPPLEMENTS, Settings, measure_twins};

use crate::progress::Bars;
use crate::{battery, output};

/// Arguments of `cargo xtask verify`.
#[derive(Args)]
pub struct Verify {
    /// Master seeds 1 … N.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Replications behind each coverage figure.
    #[arg(long, value_name = "N", default_value_t = 4000, value_parser = clap::value_parser!(u64).range(100..))]
    replications: u64,
    /// The page to write.
    #[arg(long, value_name = "FILE", default_value = "docs/verification.md")]
    out: PathBuf,
}

/// Runs the battery. Succeeds when nothing is refuted, documented misprints aside, and every twin is.
pub fn run(arguments: &Verify) -> Result<ExitCode> {
    anyhow::ensure!(!arguments.out.is_dir(), "{} is a folder; name a file", arguments.out.display());
    let folder = arguments.out.parent().filter(|folder| !folder.as_os_str().is_empty());
    output::prepare(folder.unwrap_or_else(|| std::path::Path::new(".")))?;
    let start = Instant::now();
    let bars = Bars::new();
    let mut battery = battery::Battery::default();
    for seed in 1..=arguments.seeds {
        battery.claims.push(claims(seed, &bars)?);
        battery.twins.push(measure_twins(Settings { seed, mode: Mode::Quick }, &bars));
        bars.println(&format!("seed {seed}: {}", crate::table::counts(&battery.claims[battery.claims.len() - 1])));
    }
    battery.coverage = verify::coverage(arguments.replications, 1);
    bars.finish();
    let page = battery::page(&battery);
    output::write(&arguments.out, page.as_bytes()).context("the battery is done, but its page cannot be written")?;
    let (alarms, missed) = (battery.false_alarms(), battery.missed_twins());
    println!(
        "{} seeds in {:.0} s: {alarms} false alarms, {missed} twins not refuted",
        arguments.seeds,
        start.elapsed().as_secs_f64()
    );
    println!("page: {}", arguments.out.display());
    Ok(if alarms + missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// All claims for one seed: everything at the paper's sizes, but the weak panels, which take most of the time, at the
/// paper's size for the first seed only.
fn claims(seed: u64, bars: &Bars) -> Result<Vec<Claim>> {
    let is_weak = |id: &str| id.starts_with("rigid-body-weak");
    let panels = EXPERIMENTS.iter().flat_map(|experiment| experiment.panels.iter().copied());
    let (weak, strong): (Vec<&str>, Vec<&str>) = panels.partition(|id| is_weak(id));
    let others = STATEMENTS.iter().map(|statement| statement.id).chain(SUPPLEMENTS.iter().map(|s| s.id));
    let paper: Vec<String> = strong.into_iter().chain(others).map(str::to_owned).collect();
    let weak: Vec<String> = weak.into_iter().map(str::to_owned).collect();
    let mut claims = verify::reproduce(Settings { seed, mode: Mode::Paper }, &paper, bars)?.claims;
    let mode = if seed == 1 { Mode::Paper } else { Mode::Quick };
    claims.extend(verify::reproduce(Settings { seed, mode }, &weak, bars)?.claims);
    Ok(claims)
}

/// Refuted, and not for a documented misprint.
pub fn is_alarm(claim: &Claim) -> bool {
    claim.verdict == Verdict::Refuted && claim.erratum.is_empty()
}
