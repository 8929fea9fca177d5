//! `cargo xtask work-precision`: which scheme is cheapest on each of the paper's problems, by
//! [`analysis::compare()`]. Errors are the same bits for the same seed, unless the budget ends
//! them; times are what they are.

use std::process::ExitCode;

use analysis::{Candidates, CompareSettings, compare};
use anyhow::Result;
use clap::Parser;
use mc::bind;
use noise::StreamKey;
use systems::{Damping, PoissonSystem};
use verify::{
    command,
    setups::{self, Setup, Visit, visit_paper},
    streams::{WORK_PRECISION, WORK_PRECISION_PARTS},
    truncation,
};

/// Which scheme is cheapest for an error, on each of the paper's problems.
#[derive(Parser)]
#[command(name = "cargo xtask work-precision", version)]
struct Arguments {
    /// The wanted strong error at the final time.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-3)]
    error: f64,
    /// Seconds for each problem.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    budget: f64,
    /// Only this problem; may be given several times.
    #[arg(long, value_name = "ID", value_parser = setups::PAPER)]
    only: Vec<String>,
    /// Master seed, 0 to 2^64 − 1.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
}

fn main() -> ExitCode {
    let mut compared = Compared { arguments: Arguments::parse(), number: 0 };
    command::exit_code(visit_paper(&mut compared).map(|()| ExitCode::SUCCESS))
}

struct Compared {
    arguments: Arguments,
    number: u64,
}

impl Visit for Compared {
    /// Prints the comparison of all schemes for one problem.
    fn visit<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        Setup { id, problem, schemes, .. }: Setup<S, G, D, M>,
    ) -> Result<()> {
        self.number += 1;
        let Arguments { error, budget, ref only, seed } = self.arguments;
        if !only.is_empty() && !only.iter().any(|name| name == id) {
            return Ok(());
        }
        let schemes: Vec<_> =
            schemes.iter().map(|scheme| bind(&problem, scheme.as_ref())).collect();
        // The reference is of strong order one.
        let reference = schemes.iter().find(|scheme| scheme.reads_areas()).unwrap_or(&schemes[0]);
        let candidates = Candidates::against(reference.clone());
        let candidates = schemes.iter().cloned().fold(candidates, Candidates::and);
        let experiment = WORK_PRECISION + WORK_PRECISION_PARTS * self.number;
        let key = StreamKey { seed, experiment };
        let settings =
            CompareSettings { budget_s: budget, ..CompareSettings::new(error, truncation(), key) };
        let comparison = compare(&mc::Problem::of(&problem), &candidates, &settings)?;
        println!("{id}\n{comparison}\n");
        Ok(())
    }
}
