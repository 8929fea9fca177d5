//! Arbitrary inputs: nothing may panic, hang or give NaN.
//!
//! A [`Target`] is a function of [`Bits`], a deterministic source of awkward numbers. [`run`] calls
//! it many times, catches panics and counts.

mod arguments;
mod bits;
mod constructors;
mod drivers;
mod functions;
mod steps;
mod systems;

use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

use anyhow::{Result, anyhow, ensure};

pub use bits::Bits;

use crate::Arguments;
use crate::results::Fuzzed;

/// What became of an input: none if it was refused, or ended in a typed error; else the iterations
/// of the solve, zero where nothing is solved. A broken check is an error.
type Fed = Result<Option<u64>>;

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

/// Inputs for a target of cost one.
const INPUTS: u64 = 1_000_000;
const QUICK_INPUTS: u64 = 10_000;
/// Failures that are described one by one; the rest are counted.
const DESCRIBED: usize = 5;

/// Feeds all targets, as many times fewer inputs as one takes longer.
pub fn run(arguments: &Arguments) -> Vec<Fuzzed> {
    let inputs = arguments.inputs.unwrap_or(arguments.many(INPUTS, QUICK_INPUTS));
    let targets = functions::TARGETS.iter().chain(&constructors::TARGETS);
    let targets = targets.chain([&drivers::TARGET]).chain(&steps::TARGETS);
    let targets = targets.chain([&arguments::TARGET]).zip(0..);
    targets
        .map(|(target, number)| {
            eprintln!("{}", target.name);
            feed(target, arguments.seed, number, (inputs / target.cost).max(1))
        })
        .collect()
}

fn feed(target: &Target, seed: u64, number: u64, inputs: u64) -> Fuzzed {
    let Target { name, checks, .. } = target;
    let mut fuzzed = Fuzzed { target: name, checks, inputs, ..Fuzzed::default() };
    for input in 0..inputs {
        // Every input has bits of its own, so that one that fails can be fed again alone.
        let mut bits = Bits::new(seed, number, input);
        let fed = catch_unwind(AssertUnwindSafe(|| (target.feed)(&mut bits)));
        match fed.unwrap_or_else(|_| Err(anyhow!("panicked"))) {
            Ok(None) => fuzzed.refused += 1,
            Ok(Some(iterations)) => {
                fuzzed.accepted += 1;
                fuzzed.most_iterations = fuzzed.most_iterations.max(iterations);
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

/// What was accepted; a refusal must have words.
fn accepted<T, E: Display>(result: Result<T, E>) -> Result<Option<T>> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(error) => {
            let words = error.to_string();
            ensure!(words.len() > 8, "a refusal without words: {words:?}");
            Ok(None)
        }
    }
}

/// The end of a target that solves nothing.
fn counted<T>(accepted: Option<T>) -> Fed {
    Ok(accepted.map(|_| 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_that_breaks_is_caught() {
        fn breaks(bits: &mut Bits) -> Fed {
            match bits.below(3) {
                0 => panic!("on purpose"),
                1 => Err(anyhow!("a NaN")),
                _ => Ok(Some(0)),
            }
        }
        let target = Target { name: "broken", checks: "", cost: 1, feed: breaks };
        let broken = feed(&target, 1, 0, 30);
        assert!(broken.failures > 0 && broken.accepted > 0 && !broken.examples.is_empty());
    }
}
