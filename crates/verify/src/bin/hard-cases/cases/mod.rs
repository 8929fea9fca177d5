//! The hard cases.

mod branch;
mod damping;
mod hamiltonians;
mod increments;
mod large_noise;
mod near_singular;
mod states;

use anyhow::Result;
use noise::StreamKey;
use verify::streams;

use crate::{
    Arguments,
    case::{Case, Context},
    results::CaseResult,
};

/// All families, in the order of the page and of their streams.
pub static CASES: [Case; 14] = [
    damping::STIFF,
    damping::ANTI,
    damping::ROUGH,
    large_noise::CASE,
    increments::EXTREME,
    increments::BIG_STEPS,
    states::SCALES,
    states::EQUILIBRIA,
    hamiltonians::NEAR_EQUAL,
    hamiltonians::SHARP,
    hamiltonians::STIFF,
    states::LOTKA_VOLTERRA,
    increments::NO_NOISE,
    near_singular::CASE,
];

/// Runs the cases that are asked for.
pub fn run(arguments: &Arguments) -> Result<Vec<CaseResult>> {
    CASES
        .iter()
        .zip(streams::HARD_CASES..)
        .filter(|(case, _)| arguments.wants(case.id))
        .map(|(case, experiment)| {
            let key = StreamKey { seed: arguments.seed, experiment };
            Ok(CaseResult { case, rows: (case.rows)(&Context { key, arguments })? })
        })
        .collect()
}
