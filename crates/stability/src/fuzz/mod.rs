//! Arbitrary inputs: nothing may panic, hang or give NaN.
//!
//! A [`Target`] is a function of [`Bits`], a deterministic source of awkward numbers. [`run`] calls
//! it many times, catches panics and counts.

mod bits;
mod constructors;
mod functions;
mod steps;

use std::panic::{AssertUnwindSafe, catch_unwind};

pub use bits::Bits;

use crate::results::Fuzzed;
use crate::{Effort, Settings};

/// What became of one input that broke no check.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    accepted: bool,
    iterations: u64,
}

impl Report {
    /// The input was accepted.
    #[must_use]
    pub fn accepted() -> Self {
        Self { accepted: true, iterations: 0 }
    }

    /// The input was refused, or ended in a typed error.
    #[must_use]
    pub fn refused() -> Self {
        Self { accepted: false, iterations: 0 }
    }

    /// The same with the iterations of a solve.
    #[must_use]
    pub fn with_iterations(self, iterations: u64) -> Self {
        Self { iterations, ..self }
    }
}

/// Something that takes input.
#[derive(Clone, Copy)]
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// What is checked, in words.
    pub checks: &'static str,
    /// About how many times as long as the cheapest target one input takes; the number of inputs is
    /// divided by it.
    pub cost: u64,
    /// Feeds one input. A broken check is an error in words.
    pub run: fn(&mut Bits) -> Result<Report, String>,
}

/// Inputs for a target of cost one.
const INPUTS: u64 = 1_000_000;
const QUICK_INPUTS: u64 = 10_000;
/// Failures that are described one by one; the rest are counted.
const DESCRIBED: usize = 5;

/// Feeds all targets of this crate, and `more`. `inputs` for a target of cost one, or a default
/// that depends on the effort, and as many times fewer for one that takes longer.
#[must_use]
pub fn run(
    settings: Settings,
    inputs: Option<u64>,
    more: &[Target],
    begin: &dyn Fn(&str),
) -> Vec<Fuzzed> {
    let targets = [&functions::TARGETS[..], &constructors::TARGETS, &steps::TARGETS, more].concat();
    let base = match settings.effort {
        Effort::Full => INPUTS,
        Effort::Quick => QUICK_INPUTS,
    };
    targets
        .iter()
        .zip(0..)
        .map(|(target, number)| {
            begin(target.name);
            feed(target, settings.seed, number, (inputs.unwrap_or(base) / target.cost).max(1))
        })
        .collect()
}

fn feed(target: &Target, seed: u64, number: u64, inputs: u64) -> Fuzzed {
    let mut fuzzed = Fuzzed {
        target: target.name.to_owned(),
        checks: target.checks.to_owned(),
        inputs,
        accepted: 0,
        refused: 0,
        most_iterations: 0,
        failures: 0,
        examples: Vec::new(),
    };
    for input in 0..inputs {
        // Every input has bits of its own, so that one that fails can be fed again alone.
        let mut bits = Bits::new(seed, number, input);
        let outcome = catch_unwind(AssertUnwindSafe(|| (target.run)(&mut bits)));
        match outcome.unwrap_or_else(|_| Err("panicked".to_owned())) {
            Ok(report) => {
                fuzzed.accepted += u64::from(report.accepted);
                fuzzed.refused += u64::from(!report.accepted);
                fuzzed.most_iterations = fuzzed.most_iterations.max(report.iterations);
            }
            Err(message) => {
                fuzzed.failures += 1;
                if fuzzed.examples.len() < DESCRIBED {
                    fuzzed.examples.push(format!("input {input}: {message}"));
                }
            }
        }
    }
    fuzzed
}

/// A broken check unless `condition`.
fn check(condition: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if condition { Ok(()) } else { Err(message()) }
}
