//! Settings of a study.

use noise::{StreamKey, Truncation};

use crate::{Observe, RunError};

/// The times of a study. The initial value is in the result without being asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Times {
    /// So many times, evenly spaced; the last is T. The number must divide the number of steps.
    Even(u64),
    /// The ends of these steps, counted from 1, in increasing order.
    AtSteps(Vec<u64>),
}

impl From<u64> for Times {
    fn from(times: u64) -> Self {
        Self::Even(times)
    }
}

impl From<Vec<u64>> for Times {
    fn from(steps: Vec<u64>) -> Self {
        Self::AtSteps(steps)
    }
}

/// Settings of a [`Study`](super::Study).
#[derive(Clone, Debug, PartialEq)]
pub struct StudySettings {
    /// Number of steps on [0, T].
    pub steps: u64,
    /// The times at which observables are evaluated.
    pub times: Times,
    /// Number of paths.
    pub paths: u64,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// Seed and experiment of the streams. The pilot draws from the streams of experiment +
    /// 2⁴⁷, which no other study or expectation uses, so the experiment must be below 2⁴⁰.
    pub key: StreamKey,
    /// The levels of the quantiles, between 0 and 1. Default 0.05, 0.25, 0.5, 0.75 and 0.95.
    pub quantiles: Vec<f64>,
    /// Bins of each histogram, from 2 to 65536. Default 256: for a normal law a bin is then a
    /// twentieth to a tenth of the standard deviation. A study keeps 2 bytes for each bin,
    /// observable and time in each group of 128 paths, and 8 groups per thread.
    pub bins: u32,
    /// Paths of the pilot that chooses the bins, at least 128. Default 1024. A study that is
    /// extended keeps its bins, and so its pilot.
    pub pilot: u64,
}

/// The experiment number of the pilot differs from that of the study in this bit. Levels of
/// `Expect` use the bits from 40 to 44.
const PILOT_STREAM: u64 = 1 << 47;
/// First bit that an experiment number may not use.
const EXPERIMENT_BITS: u32 = 40;

impl StudySettings {
    /// Default values for the settings that have one.
    pub fn new(
        steps: u64,
        times: impl Into<Times>,
        paths: u64,
        truncation: Truncation,
        key: StreamKey,
    ) -> Self {
        Self {
            steps,
            times: times.into(),
            paths,
            truncation,
            key,
            quantiles: vec![0.05, 0.25, 0.5, 0.75, 0.95],
            bins: 256,
            pilot: 1024,
        }
    }

    /// The streams of the pilot.
    pub(super) fn pilot_key(&self) -> StreamKey {
        StreamKey { experiment: self.key.experiment | PILOT_STREAM, ..self.key }
    }

    /// The steps at whose ends observables are evaluated.
    pub(super) fn time_steps(&self) -> Result<Vec<u64>, RunError> {
        let steps = self.steps;
        let wrong = |text: String| Err(RunError::Setting(text));
        let at: Vec<u64> = match &self.times {
            Times::Even(0) => Vec::new(),
            Times::Even(times) if steps.is_multiple_of(*times) => {
                return Ok((1..=*times).map(|n| n * (steps / times)).collect());
            }
            Times::Even(times) => {
                let divides = |n: &u64| steps.is_multiple_of(*n);
                let below = (1..=(*times).min(steps)).rev().find(divides).unwrap_or(1);
                let above = (*times..=steps).find(divides).unwrap_or(below);
                let nearest = if times - below <= above.abs_diff(*times) { below } else { above };
                return wrong(format!(
                    "{steps} steps cannot be divided into {times} equal parts; the nearest possible \
                     number is {nearest}, or list the steps"
                ));
            }
            Times::AtSteps(at) => at.clone(),
        };
        if at.is_empty() {
            return wrong("a study needs at least one time after t = 0, got none".into());
        }
        if let Some(step) = at.iter().find(|step| !(1..=steps).contains(*step)) {
            return wrong(format!(
                "a time must be the number of a step from 1 to {steps}, got {step}; t = 0 is always \
                 in the result"
            ));
        }
        match at.windows(2).find(|pair| pair[1] <= pair[0]) {
            Some(&[before, step]) => {
                wrong(format!("the times must increase, got step {step} after step {before}"))
            }
            _ => Ok(at),
        }
    }

    /// Checks all but the times, the steps and the truncation.
    pub(super) fn check(&self, observables: &[&dyn Observe]) -> Result<(), RunError> {
        let Self { paths, key, bins, pilot, .. } = *self;
        let mut requirements = vec![
            (paths > 0, "number of paths", "at least 1", paths as f64),
            (
                key.experiment >> EXPERIMENT_BITS == 0,
                "experiment number",
                "below 2^40",
                key.experiment as f64,
            ),
            ((2..=1 << 16).contains(&bins), "number of bins", "from 2 to 65536", f64::from(bins)),
            (pilot >= 128, "number of pilot paths", "at least 128", pilot as f64),
        ];
        for &level in &self.quantiles {
            let inside = level > 0.0 && level < 1.0;
            requirements.push((inside, "level of a quantile", "between 0 and 1", level));
        }
        let wrong = |text: String| Err(RunError::Setting(text));
        RunError::unmet(requirements)?;
        if observables.is_empty() {
            return wrong("a study needs at least one observable, got none".into());
        }
        for (n, name) in observables.iter().map(|observable| observable.name()).enumerate() {
            if observables[..n].iter().any(|before| before.name() == name) {
                return wrong(format!("two observables have the name {name:?}; rename one"));
            }
        }
        for (n, level) in self.quantiles.iter().enumerate() {
            if self.quantiles[..n].contains(level) {
                return wrong(format!("the quantile of level {level} is asked for twice"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pilot_shares_its_streams_with_nothing() {
        for experiment in [0, 1, (1 << EXPERIMENT_BITS) - 1] {
            let key = StreamKey { seed: 0, experiment };
            let study = StudySettings::new(1, 1, 1, Truncation::none(), key);
            let pilot = study.pilot_key().experiment;
            assert!(pilot < noise::AREA_STREAM && pilot != experiment);
            // Those of the levels of an expectation.
            for level in 0..=24 {
                assert_ne!(pilot, experiment + ((level + 1) << 40));
            }
        }
    }
}
