//! Arbitrary inputs: nothing may panic, hang or give NaN.
//!
//! A [`Target`] is a function of [`Bits`], a deterministic source of awkward numbers. [`all`] calls
//! it many times, catches panics and counts.

mod drivers;
mod numbers;
mod steps;

use std::{
    fmt::Display,
    panic::{AssertUnwindSafe, catch_unwind},
};

use anyhow::{Context, Result, anyhow, ensure};
use thiserror::Error;

use crate::{SEED, bits::Bits};
use steps::Job;

/// What became of an input: the iterations of the solve, zero where nothing is solved; or
/// [`Refused`]. Any other error is a broken check.
type Fed = Result<u64>;

/// The input was refused, or ended in a typed error.
#[derive(Debug, Error)]
#[error("refused")]
struct Refused;

/// Something that takes input: its name, how many times as long as the cheapest target one input
/// takes, and what feeds one.
type Target = (&'static str, u64, fn(&mut Bits) -> Fed);

/// All targets; the place of a target in this list decides which bits it is fed.
const TARGETS: [Target; 6] = [
    ("systems, dampings, problems", 1, |bits| steps::any_system(bits, Job::Problem, 2)),
    ("steps and truncation", 1, numbers::steps),
    ("Lévy areas: error bounds and terms", 1, numbers::areas),
    ("ladders, trajectories, settings of expectations", 40, drivers::drivers),
    ("steps of single paths", 1, |bits| steps::any_system(bits, Job::Step, 8)),
    ("steps of blocks, with the bits of the single path", 40, steps::block),
];

#[test]
fn nothing_panics_hangs_or_gives_nan() {
    all(5000);
}

#[test]
#[ignore = "a million inputs: minutes"]
fn nothing_panics_hangs_or_gives_nan_on_a_million_inputs() {
    all(1_000_000);
}

/// Failures that are described one by one; the rest are counted.
const DESCRIBED: usize = 5;

/// What became of the inputs of a target.
#[derive(Debug, Default)]
struct Fuzzed {
    accepted: u64,
    refused: u64,
    /// Of one solve.
    most_iterations: u64,
    failures: u64,
    /// The first few failures.
    examples: Vec<String>,
}

/// Feeds all targets, as many times fewer inputs as one takes longer.
fn all(inputs: u64) {
    for ((name, cost, target), number) in TARGETS.iter().zip(0..) {
        let fuzzed = feed(*target, SEED, number, (inputs / cost).max(1));
        println!("{name}: {fuzzed:?}");
        let sound = fuzzed.failures == 0 && fuzzed.accepted > 0 && fuzzed.refused > 0;
        assert!(sound, "{name}: {fuzzed:#?}");
    }
}

fn feed(target: fn(&mut Bits) -> Fed, seed: u64, number: u64, inputs: u64) -> Fuzzed {
    let mut fuzzed = Fuzzed::default();
    for input in 0..inputs {
        // Every input has bits of its own, so that one that fails can be fed again alone.
        let mut bits = Bits::new(seed, number, input);
        let fed = catch_unwind(AssertUnwindSafe(|| target(&mut bits)));
        match fed.unwrap_or_else(|_| Err(anyhow!("panicked"))) {
            Ok(iterations) => {
                fuzzed.accepted += 1;
                fuzzed.most_iterations = fuzzed.most_iterations.max(iterations);
            }
            Err(error) if error.is::<Refused>() => fuzzed.refused += 1,
            Err(error) => {
                fuzzed.failures += 1;
                if fuzzed.examples.len() < DESCRIBED {
                    fuzzed.examples.push(format!("input {input}: {error:#}"));
                }
            }
        }
    }
    fuzzed
}

/// What was accepted; [`Refused`] ends the input.
fn accepted<T, E: Display>(result: Result<T, E>) -> Result<T> {
    answer(result)?.context(Refused)
}

/// What was accepted, if it was; a refusal must have words.
fn answer<T, E: Display>(result: Result<T, E>) -> Result<Option<T>> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(error) => {
            let words = error.to_string();
            ensure!(words.len() > 8, "a refusal without words: {words:?}");
            Ok(None)
        }
    }
}
