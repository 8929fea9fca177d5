//! The hard cases.

mod branch;
mod damping;
mod hamiltonians;
mod increments;
mod large_noise;
mod near_singular;
mod states;

use crate::Case;

/// The quantity of most cases.
const SQUARED_LENGTH: &str = "largest relative distance of |y|² from its law, before a path ends";

/// All families, in the order of the tables and of their streams.
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
