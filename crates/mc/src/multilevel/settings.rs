//! How an expectation is computed.

use noise::{AREA_STREAM, StreamKey, Truncation};
use systems::Problem;

use super::MultilevelError;

/// How the fine and the coarse paths of a level are coupled. Both share the noise, and the mean of
/// either difference is E[φ(y_τ)] − E[φ(y_{2τ})].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupling {
    /// ½(φ(fine) + φ(swapped)) − φ(coarse), where the swapped path takes the two increments of
    /// every coarse step in the other order (Giles and Szpruch 2014): for several noises and a
    /// scheme without Lévy areas, whose variance then falls like τ² in place of τ. Takes 5/3 of the
    /// steps of `Plain`.
    Antithetic,
    /// φ(fine) − φ(coarse): for one noise, for several that commute, or for a scheme that reads
    /// Lévy areas.
    Plain,
}

/// What [`expectation`](super::expectation) and [`expectation_plain`](super::expectation_plain) are
/// told beside the accuracy. [`Settings::new`] fills in what has a default.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Seed and experiment. Level l (round r) draws from the family with the experiment number
    /// experiment + 2⁴⁰(l + 1) + 2⁴⁸r, so the experiment must be below 2⁴⁰, and all families of all
    /// experiments below it are distinct from each other and from these experiments themselves.
    pub key: StreamKey,
    /// How increments are truncated, on every level at its own step size.
    pub truncation: Truncation,
    /// Steps on [0, T] of level 0; level l has 2^l times as many.
    pub coarsest_steps: u64,
    /// The coupling of the levels above 0.
    pub coupling: Coupling,
    /// Weak order of the scheme, from theory: what the bias is judged by. Default 1.
    pub weak_order: f64,
    /// Paths with which levels 0 to 2 begin; a level that is added later begins with at least a
    /// quarter of it. Default
    /// 1024. At least 128, or variances mean little.
    pub pilot: u64,
    /// The finest level that may be used, from 2 to 24. Default 16.
    pub max_level: usize,
    /// Path-steps after which computing ends, whether the accuracy is reached or not. Default 10¹⁰:
    /// minutes.
    pub max_cost: u64,
}

/// Smallest pilot.
const MIN_PILOT: u64 = 128;
/// Coarsest and finest choice of the finest level: two differences show how they decay.
const MAX_LEVEL: std::ops::RangeInclusive<usize> = 2..=24;
/// Coarsest steps of which even the finest level has a number of steps that is exact as a
/// floating-point number.
const MAX_COARSEST: u64 = 1 << 24;
/// Where the number of the level begins in an experiment number.
const LEVEL_BIT: u32 = 40;
/// Where the number of the round begins.
const ROUND_BIT: u32 = 48;
/// Rounds that have stream families of their own: the bits from that of the areas on are taken, by
/// areas and clocks.
pub(crate) const MAX_ROUNDS: u64 = AREA_STREAM >> ROUND_BIT;

impl Settings {
    /// The defaults with what has none.
    #[must_use]
    pub fn new(
        key: StreamKey,
        truncation: Truncation,
        coarsest_steps: u64,
        coupling: Coupling,
    ) -> Self {
        Self {
            key,
            truncation,
            coarsest_steps,
            coupling,
            weak_order: 1.0,
            pilot: 1024,
            max_level: 16,
            max_cost: 10_000_000_000,
        }
    }

    /// The family of streams of one round of a level.
    pub(crate) fn stream(&self, level: usize, round: u64) -> StreamKey {
        let experiment =
            self.key.experiment + ((level as u64 + 1) << LEVEL_BIT) + (round << ROUND_BIT);
        StreamKey { experiment, ..self.key }
    }

    pub(crate) fn check(&self, accuracy: f64, observables: usize) -> Result<(), MultilevelError> {
        let Self { key, coarsest_steps, weak_order, pilot, max_level, .. } = *self;
        if !(accuracy > 0.0 && accuracy.is_finite()) {
            return Err(MultilevelError::Accuracy { accuracy });
        }
        if observables == 0 {
            return Err(MultilevelError::NoObservable);
        }
        if key.experiment >> LEVEL_BIT != 0 {
            return Err(MultilevelError::Experiment { experiment: key.experiment });
        }
        if !(1..=MAX_COARSEST).contains(&coarsest_steps) {
            return Err(MultilevelError::CoarsestSteps {
                steps: coarsest_steps,
                at_most: MAX_COARSEST,
            });
        }
        if !(weak_order > 0.0 && weak_order.is_finite()) {
            return Err(MultilevelError::WeakOrder { weak_order });
        }
        if pilot < MIN_PILOT {
            return Err(MultilevelError::Pilot { pilot, at_least: MIN_PILOT });
        }
        if !MAX_LEVEL.contains(&max_level) {
            return Err(MultilevelError::MaxLevel {
                max_level,
                at_least: *MAX_LEVEL.start(),
                at_most: *MAX_LEVEL.end(),
            });
        }
        Ok(())
    }

    /// Steps of the fine path of a level.
    pub(crate) fn steps(&self, level: usize) -> u64 {
        self.coarsest_steps << level
    }

    /// Step size of the fine path of a level.
    pub(crate) fn tau<S, G, const D: usize>(
        &self,
        problem: &Problem<S, G, D>,
        level: usize,
    ) -> f64 {
        problem.t_end / self.steps(level) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_rounds_share_a_family() {
        let mut seen = std::collections::HashSet::new();
        for experiment in [0, 1, (1 << LEVEL_BIT) - 1] {
            assert!(seen.insert(experiment));
            let key = StreamKey { seed: 0, experiment };
            let settings = Settings::new(key, Truncation::none(), 1, Coupling::Plain);
            for level in 0..=*MAX_LEVEL.end() {
                for round in [0, 1, 2, MAX_ROUNDS - 1] {
                    let family = settings.stream(level, round).experiment;
                    assert!(seen.insert(family) && family < AREA_STREAM);
                }
            }
        }
    }
}
