//! A study on one machine, or in parts on many. Either goes on after a kill.
//!
//! ```text
//! cargo run --release -p casimir-poisson --example in_parts -- 1e6 --out run
//! ```
//!
//! takes a million paths. `--part 3 --parts 64` beside `--out run` computes a part, `--merge run`
//! merges the parts.

use std::{env, path::Path, process::ExitCode, time::Duration};

use casimir::{
    mc::{
        Observable, Setup,
        parts::{Job, Program, Share, Stop, limit_threads},
    },
    prelude::*,
    real::{Simd, limit_to},
    study::{Study, StudySettings},
    systems::{Cosine, RigidBody},
};

fn main() -> ExitCode {
    match run(env::args().skip(1).collect()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

type Error = Box<dyn std::error::Error>;

fn run(arguments: Vec<String>) -> Result<(), Error> {
    let program = Program {
        name: "in_parts".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        input: String::new(),
    };
    let value = |name: &str| {
        let at = arguments.iter().position(|argument| argument == name)?;
        arguments.get(at + 1)
    };
    let (out, merge) = (value("--out").map(Path::new), value("--merge").map(Path::new));
    let job = match (out, merge, value("--part"), value("--parts")) {
        (Some(out), None, Some(number), Some(of)) => {
            Job::part(out, Share::new(number.parse()?, of.parse()?)?, program)?
        }
        (Some(out), None, None, None) => Job::part(out, Share::WHOLE, program)?,
        (None, Some(folder), None, None) => Job::merge(folder, program)?,
        _ => Job::here(),
    };
    // Ctrl-C and SIGTERM end it with a checkpoint.
    let stop = Stop::default();
    let asked = stop.clone();
    ctrlc::set_handler(move || asked.now())?;
    let seconds = value("--checkpoint-every").map_or(Ok(2.0), |text| text.parse())?;
    let job = job.stopped_by(&stop).with_checkpoints_every(Duration::from_secs_f64(seconds));
    value("--threads")
        .map_or(Ok(()), |threads| Ok::<_, Error>(limit_threads(threads.parse()?)?))?;
    // Paths, and the instruction set.
    let paths = arguments.first().map_or(Ok(1e5), |text| text.parse::<f64>())? as u64;
    // The bits are the same on all.
    let named = |level: &&Simd| arguments.get(1).is_some_and(|name| name == level.name());
    Simd::BUILT.iter().find(named).copied().into_iter().for_each(limit_to);

    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [2.0, 4.0, 6.0])?;
    let problem = Problem::new(body, Cosine::new(0.5, 2.0)?, [0.45, 0.0, 0.89], 1.0)?;
    let (truncation, key) = (Truncation::new(4)?, StreamKey { seed: 1, experiment: 0 });
    let scheme = SexpLi::new(problem.system(), problem.y0())?;
    let phi = [
        Observable { name: "y3", function: |y: [f64; 3]| y[2] },
        Observable { name: "y1 y2", function: |y: [f64; 3]| y[0] * y[1] },
    ];
    // 240 steps, quantile bands at 40 of them.
    let settings = StudySettings::new(240, 40, paths, truncation, key);
    let setup = Setup::of(&problem, &scheme);
    let bands = Study::new(&setup, &phi, &settings)?.run_in(&job, "bands");
    // A part has no results.
    if let Some(bands) = bands {
        bands.write_csv(&mut std::io::stdout().lock())?;
        bands.warnings.iter().for_each(|warning| println!("{warning}"));
    }
    Ok(job.finish()?)
}
