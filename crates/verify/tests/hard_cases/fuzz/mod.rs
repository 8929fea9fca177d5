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

/// Something that takes input.
struct Target {
    name: &'static str,
    /// What is checked.
    checks: &'static str,
    /// How many times as long as the cheapest target one input takes, about.
    cost: u64,
    /// Feeds one input.
    feed: fn(&mut Bits) -> Fed,
}

/// All targets; the place of a target in this list decides which bits it is fed.
const TARGETS: [Target; 9] = [
    Target {
        name: "elementary functions",
        checks: "sin, cos in [−1, 1]; eˣ in [0, ∞]; NaN only where not defined",
        cost: 1,
        feed: numbers::elementary_functions,
    },
    Target {
        name: "discrete gradients of sines",
        checks: "a mean over finite arguments is in [−1, 1]",
        cost: 1,
        feed: numbers::means,
    },
    Target {
        name: "quadrature rules",
        checks: "refused, or weights are positive and add up to one",
        cost: 2000,
        feed: numbers::rules,
    },
    Target {
        name: "systems, dampings, problems",
        checks: "refused, or parameters are finite and the start is in the domain",
        cost: 1,
        feed: |bits| steps::any_system(bits, Job::Problem, 2),
    },
    Target {
        name: "steps and truncation",
        checks: "refused, or no factor is negative; bounds are positive and finite",
        cost: 1,
        feed: numbers::steps,
    },
    Target {
        name: "Lévy areas: error bounds and terms",
        checks: "refused, or that many terms keep the error asked for",
        cost: 1,
        feed: numbers::areas,
    },
    Target {
        name: "ladders, trajectories, settings of expectations",
        checks: "refused, or every state of the result is finite",
        cost: 40,
        feed: drivers::drivers,
    },
    Target {
        name: "steps of single paths",
        checks: "failed, or the state is finite and the iterations are bounded",
        cost: 1,
        feed: |bits| steps::any_system(bits, Job::Step, 8),
    },
    Target {
        name: "steps of blocks",
        checks: "the same, and a path of a block has the bits of the single path",
        cost: 40,
        feed: steps::block,
    },
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
    for (target, number) in TARGETS.iter().zip(0..) {
        let fuzzed = feed(target, SEED, number, (inputs / target.cost).max(1));
        println!("{} ({}): {fuzzed:?}", target.name, target.checks);
        let sound = fuzzed.failures == 0 && fuzzed.accepted > 0 && fuzzed.refused > 0;
        assert!(sound, "{}: {fuzzed:#?}", target.name);
    }
}

fn feed(target: &Target, seed: u64, number: u64, inputs: u64) -> Fuzzed {
    let mut fuzzed = Fuzzed::default();
    for input in 0..inputs {
        // Every input has bits of its own, so that one that fails can be fed again alone.
        let mut bits = Bits::new(seed, number, input);
        let fed = catch_unwind(AssertUnwindSafe(|| (target.feed)(&mut bits)));
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

#[test]
fn a_target_that_breaks_is_caught() {
    fn breaks(bits: &mut Bits) -> Fed {
        match bits.below(4) {
            0 => panic!("on purpose"),
            1 => Err(anyhow!("a NaN")),
            2 => accepted(Err("no such number")),
            _ => Ok(0),
        }
    }
    let target = Target { name: "broken", checks: "", cost: 1, feed: breaks };
    let broken = feed(&target, 1, 0, 30);
    assert!(broken.failures > 0 && broken.accepted > 0 && broken.refused > 0);
    assert!(!broken.examples.is_empty());
}
