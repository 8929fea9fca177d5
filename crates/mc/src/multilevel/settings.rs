//! Settings of the computation of an expectation.

use noise::{StreamKey, Truncation};

use super::error::MultilevelError;
use crate::driver::GROUP_PATHS;

/// How the fine and the coarse paths of a level are coupled. Both couplings share the noise, and
/// the mean of either difference is E[φ(y_τ)] − E[φ(y_{2τ})].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupling {
    /// ½(φ(fine) + φ(swapped)) − φ(coarse), where the swapped path takes the two increments of
    /// every coarse step in the other order (Giles and Szpruch 2014). For several noises and a
    /// scheme without Lévy areas: the variance then falls like τ² instead of τ. Takes 5/3 of the
    /// steps of `Plain`.
    Antithetic,
    /// φ(fine) − φ(coarse): for one noise, for several that commute, or for a scheme that reads
    /// Lévy areas.
    Plain,
}

/// The paths whose values are added up to an expectation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// Single paths on level 0 and differences on the levels above.
    Multilevel,
    /// Single paths on one level, the first on which the bias is bounded by a quarter of the
    /// accuracy. The bias is bounded as for `Multilevel`, from coupled differences. They are
    /// sampled until they show it, and count in the cost.
    SinglePaths,
}

/// How far a computation is, between two rounds of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoFar {
    /// The largest half-width of an interval.
    pub half_width: f64,
    /// The one that is requested.
    pub accuracy: f64,
    /// Path-steps so far.
    pub cost: u64,
    /// Path-steps that the accuracy takes in all, roughly; `None` while levels are added.
    pub expected: Option<f64>,
    /// Path-steps that are allowed.
    pub max_cost: u64,
}

/// Settings of [`expectation`](super::expectation), beside the accuracy.
#[derive(Clone, Copy, Debug)]
pub struct ExpectationSettings {
    /// Seed and experiment. Level l draws from the family of streams with the experiment number
    /// experiment + 2⁴⁰(l + 1), so the experiment must be below 2⁴⁰. The families of all such
    /// experiments are distinct from each other and from the experiments themselves.
    pub key: StreamKey,
    /// How increments are truncated, on every level at its own step size.
    pub truncation: Truncation,
    /// Steps on [0, T] of level 0, at most 2²⁴; level l has 2^l times as many.
    pub coarsest_steps: u64,
    /// Default multilevel.
    pub estimator: Estimator,
    /// The coupling of the levels above 0.
    pub coupling: Coupling,
    /// Theoretical weak order of the scheme, which the bound on the bias assumes. Default 1.
    pub weak_order: f64,
    /// Paths of the pilot on each of the levels 0 to 2; a level that is added later begins with at
    /// least a quarter of it. At least 128, or variances mean little; samples are drawn in groups
    /// of
    /// 128. Default 1024.
    pub pilot: u64,
    /// The finest level that may be used, from 3 to 24. Default 16.
    pub max_level: usize,
    /// Limit of the path-steps, whether the accuracy is reached or not. Default 10¹⁰: minutes.
    pub max_cost: u64,
    /// Is called between two rounds of samples. Default: does nothing.
    pub watch: fn(&SoFar),
}

/// The highest `max_level`: with 2²⁴ coarsest steps, its number of steps is still exact as a
/// floating-point number.
const MAX_LEVEL: usize = 24;
/// First bit of the level in an experiment number.
const LEVEL_BIT: u32 = 40;

/// As many paths in whole groups, rounded upwards.
pub fn whole(paths: u64) -> u64 {
    paths.div_ceil(GROUP_PATHS).saturating_mul(GROUP_PATHS)
}

impl ExpectationSettings {
    /// Default values for the settings that have one.
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
            estimator: Estimator::Multilevel,
            coupling,
            weak_order: 1.0,
            pilot: 1024,
            max_level: 16,
            max_cost: 10_000_000_000,
            watch: |_| (),
        }
    }

    /// The family of streams of a level.
    pub(crate) fn stream(&self, level: usize) -> StreamKey {
        let experiment = self.key.experiment + ((level as u64 + 1) << LEVEL_BIT);
        StreamKey { experiment, ..self.key }
    }

    pub(crate) fn check(&self, accuracy: f64) -> Result<(), MultilevelError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let has_fourth_power = (1e-70..1e70).contains(&accuracy);
        let Self { key, coarsest_steps, weak_order, pilot, max_level, .. } = *self;
        let requirements = [
            (
                has_fourth_power,
                "accuracy",
                "from 1e-70 to 1e70 (else scale the function)",
                accuracy,
            ),
            (
                key.experiment >> LEVEL_BIT == 0,
                "experiment number",
                "below 2^40",
                key.experiment as f64,
            ),
            (
                (1..=1 << 24).contains(&coarsest_steps),
                "number of coarsest steps",
                "from 1 to 2^24",
                coarsest_steps as f64,
            ),
            (positive(weak_order), "weak order", "positive and finite", weak_order),
            (pilot >= 128, "number of pilot paths", "at least 128", pilot as f64),
            (
                (3..=MAX_LEVEL).contains(&max_level),
                "finest level",
                "from 3 to 24",
                max_level as f64,
            ),
        ];
        match requirements.into_iter().find(|(met, ..)| !met) {
            Some((_, name, allowed, value)) => {
                Err(MultilevelError::Setting { name, allowed, value })
            }
            None => Ok(()),
        }
    }

    /// Paths of the pilot, in whole groups.
    pub(crate) fn whole_pilot(&self) -> u64 {
        whole(self.pilot)
    }

    /// Steps of the fine path of a level.
    pub(crate) fn steps(&self, level: usize) -> u64 {
        self.coarsest_steps << level
    }
}

#[cfg(test)]
mod tests {
    use noise::AREA_STREAM;

    use super::*;

    #[test]
    fn no_two_levels_share_a_family() {
        let mut seen = std::collections::HashSet::new();
        for experiment in [0, 1, (1 << LEVEL_BIT) - 1] {
            assert!(seen.insert(experiment));
            let key = StreamKey { seed: 0, experiment };
            let settings = ExpectationSettings::new(key, Truncation::none(), 1, Coupling::Plain);
            for level in 0..=MAX_LEVEL {
                let family = settings.stream(level).experiment;
                assert!(seen.insert(family) && family < AREA_STREAM);
            }
        }
    }
}
