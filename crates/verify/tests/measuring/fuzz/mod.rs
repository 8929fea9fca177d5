//! Arbitrary inputs: nothing may panic, hang or give NaN.
//!
//! A [`Target`] is a function of [`Bits`], a deterministic source of awkward numbers. [`all`] calls
//! it many times, catches panics and counts.

mod drivers;
mod steps;

use std::{
    fmt::Display,
    panic::{AssertUnwindSafe, catch_unwind},
};

use anyhow::{Context, Result, anyhow, ensure};
use thiserror::Error;

use crate::{SEED, bits::Bits};
use steps::Job;

/// What became of an input: it was accepted, or [`Refused`]. Any other error is a broken check.
type Fed = Result<()>;

/// The input was refused, or ended in a typed error.
#[derive(Debug, Error)]
#[error("refused")]
struct Refused;

/// Something that takes input: its name, how many times as long as the cheapest target one input
/// takes, and what feeds one.
type Target = (&'static str, u64, fn(&mut Bits) -> Fed);

/// All targets; the place of a target in this list decides which bits it is fed.
const TARGETS: [Target; 4] = [
    ("systems, dampings, problems", 1, |bits| steps::any_system(bits, Job::Problem, 2)),
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

/// Feeds all targets, as many times fewer inputs as one takes longer.
fn all(inputs: u64) {
    for (&(name, cost, target), number) in TARGETS.iter().zip(0..) {
        let (mut accepted, mut refused, mut wrong) = (0, 0, Vec::new());
        for input in 0..(inputs / cost).max(1) {
            // Every input has bits of its own, so that one that fails can be fed again alone.
            let mut bits = Bits::new(SEED, number, input);
            let fed = catch_unwind(AssertUnwindSafe(|| target(&mut bits)));
            match fed.unwrap_or_else(|_| Err(anyhow!("panicked"))) {
                Ok(()) => accepted += 1,
                Err(error) if error.is::<Refused>() => refused += 1,
                Err(error) => wrong.push(format!("input {input}: {error:#}")),
            }
        }
        println!("{name}: {accepted} accepted, {refused} refused, {} wrong", wrong.len());
        // Five are described, the rest are counted.
        wrong.truncate(5);
        assert!(wrong.is_empty() && accepted > 0 && refused > 0, "{name}: {wrong:#?}");
    }
}

/// What was accepted; [`Refused`], which must have words, ends the input.
fn accepted<T, E: Display>(result: Result<T, E>) -> Result<T> {
    if let Err(error) = &result {
        let words = error.to_string();
        ensure!(words.len() > 8, "a refusal without words: {words:?}");
    }
    result.ok().context(Refused)
}
