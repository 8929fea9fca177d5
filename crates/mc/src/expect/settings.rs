//! What every attempt to compute an expectation shares.

use noise::{StreamKey, Truncation};

use crate::RunError;

/// How far a computation is, between two rounds of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoFar {
    /// The largest half-width of an interval.
    pub half_width: f64,
    /// The requested one.
    pub accuracy: f64,
    /// Path-steps so far.
    pub cost: u64,
    /// Path-steps that the accuracy takes in all, roughly; `None` while levels are added.
    pub expected: Option<f64>,
    /// Path-steps that are allowed.
    pub max_cost: u64,
}

/// The powers of τ in an expansion of the bias.
#[derive(Clone, Copy, Debug)]
pub struct Orders {
    /// The weak order p.
    pub weak: f64,
    /// The next one q.
    pub next: f64,
}

/// The settings of [`Expect`](super::Expect), which documents them where they are set.
#[derive(Clone, Copy)]
pub struct Settings {
    pub key: StreamKey,
    pub truncation: Truncation,
    pub random_points: bool,
    pub replicates: u64,
    pub coarsest_steps: u64,
    pub max_level: usize,
    pub max_cost: u64,
    pub watch: fn(&SoFar),
}

/// First bit of the level in an experiment number.
const LEVEL_BIT: u32 = 40;

impl Settings {
    /// The family of streams of a level.
    pub fn stream(&self, level: usize) -> StreamKey {
        let experiment = self.key.experiment + ((level as u64 + 1) << LEVEL_BIT);
        StreamKey { experiment, ..self.key }
    }

    /// Steps of the fine path of a level.
    pub fn steps(&self, level: usize) -> u64 {
        self.coarsest_steps << level
    }

    pub fn check(&self, accuracy: f64, weak_order: f64) -> Result<(), RunError> {
        let &Self { key, replicates, coarsest_steps, max_level, .. } = self;
        // Fourth powers of the accuracy must be numbers.
        let fourth = (1e-70..1e70).contains(&accuracy);
        // Beyond, 1/(2^p − 1) is no weight.
        let order = (1.0 / 16.0..=16.0).contains(&weak_order);
        let within = |x: u64, from: u64, to: u64| (from..=to).contains(&x);
        let experiment = key.experiment >> LEVEL_BIT == 0;
        let requirements = [
            (fourth, "accuracy", "from 1e-70 to 1e70 (else scale the function)", accuracy),
            (experiment, "experiment number", "below 2^40", key.experiment as f64),
            (
                within(coarsest_steps, 1, 1 << 24),
                "number of coarsest steps",
                "from 1 to 2^24",
                coarsest_steps as f64,
            ),
            (order, "weak order", "from 1/16 to 16", weak_order),
            (within(max_level as u64, 3, 24), "finest level", "from 3 to 24", max_level as f64),
            (
                within(replicates, 16, 1 << 20),
                "number of replicates",
                "from 16 to 2^20",
                replicates as f64,
            ),
        ];
        RunError::unmet(requirements)
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
            let settings = Settings {
                key: StreamKey { seed: 0, experiment },
                truncation: Truncation::none(),
                random_points: false,
                replicates: 32,
                coarsest_steps: 4,
                max_level: 24,
                max_cost: 1,
                watch: |_| (),
            };
            assert_eq!((settings.steps(0), settings.steps(3)), (4, 32));
            for level in 0..=24 {
                let family = settings.stream(level).experiment;
                assert!(seen.insert(family) && family < AREA_STREAM);
            }
        }
    }
}
