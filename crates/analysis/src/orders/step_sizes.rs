//! Step sizes, paths and noise of a measurement.

use std::sync::Arc;

use mc::{
    DampingResolution, DriveResolution, Ladder, LadderError, Setup,
    parts::{Job, Stop},
};
use noise::{Purpose, StreamKey, Truncation};

/// Step sizes, paths and noise of a measurement of an order.
///
/// [`StepSizes::new`] has cheap defaults.
#[derive(Clone, Debug)]
pub struct StepSizes {
    /// Number of the coarsest steps on [0, T].
    pub coarsest_steps: u64,
    /// Step sizes of the errors, each half of the one before.
    pub levels: usize,
    /// Step sizes beyond the finest of these; the last is the reference.
    pub refinement: u32,
    /// Paths.
    pub samples: u64,
    /// How increments are truncated.
    pub truncation: Truncation,
    /// Which noise.
    pub key: StreamKey,
    /// Path-steps of all measurements together, see [`within`](Self::within).
    pub path_steps: u64,
    /// Ends the measurement early: what it gives is then of no use.
    pub stop: Stop,
    /// Keeps measurements, by their steps and paths, if there is one.
    pub job: Option<Arc<Job>>,
}

/// The most step sizes: 2⁴⁸ steps would take years.
const MOST_SIZES: usize = 48;

impl StepSizes {
    /// Five step sizes from T/`coarsest_steps` on, two beyond, 1000 paths: some 250 000 steps for
    /// each of the coarsest.
    pub fn new(coarsest_steps: u64, truncation: Truncation, key: StreamKey) -> Self {
        let (levels, refinement, samples, path_steps) = (5, 2, 1000, 0);
        Self {
            coarsest_steps,
            levels,
            refinement,
            samples,
            truncation,
            key,
            path_steps,
            stop: Stop::default(),
            job: None,
        }
    }

    /// Measures again with more paths or finer steps, whatever would decide, until an order is
    /// named or the next measurement would exceed `path_steps` in all; the first has fewer paths
    /// where it would, but 32. Without that there is one measurement.
    #[must_use]
    pub fn within(self, path_steps: u64) -> Self {
        Self { path_steps, ..self }
    }

    /// The level above the finest of step size number `index`, coarsest first.
    pub(crate) fn level(&self, index: usize) -> usize {
        self.levels - 1 - index + self.refinement as usize
    }

    /// Number of steps of the reference.
    pub fn reference_steps(&self) -> u64 {
        self.coarsest_steps << self.level(0)
    }

    /// Number of step sizes, those beyond the finest included.
    pub(super) fn sizes(&self) -> usize {
        self.level(0) + 1
    }

    /// All step sizes, those beyond the finest included.
    pub(super) fn taus(&self, t_end: f64) -> Vec<f64> {
        (0..self.sizes()).map(|index| t_end / (self.coarsest_steps << index) as f64).collect()
    }

    /// Path-steps of a scheme at all step sizes.
    pub(super) fn cost(&self) -> u64 {
        self.samples.saturating_mul(2 * self.reference_steps())
    }

    /// A scheme in so many finest steps on these levels; see [`Setup::ladder`].
    pub(super) fn ladder<'a>(
        &self,
        setup: &Setup<'a>,
        steps: u64,
        levels: usize,
        paths: u64,
    ) -> Result<Ladder<'a>, LadderError> {
        setup.ladder(steps, levels, self.truncation, (self.key, Purpose::Paths), paths)
    }

    /// What of the damping or of H(t) the finest steps do not resolve.
    pub(super) fn unresolved(&self, setup: &Setup<'_>) -> Option<String> {
        let damping = DampingResolution::new(setup, self.coarsest_steps);
        let damping = damping.unresolved(self.sizes() - 1);
        let damping = damping.map(|by| format!("the steps resolve the damping to {by:.1e} only"));
        damping.or_else(|| {
            let t = DriveResolution::new(&setup.problem).unresolved(self.reference_steps())?;
            Some(format!("the steps do not resolve H(t) near t = {t:.4}"))
        })
    }

    /// Refuses sizes without a step, with fewer step sizes than these, or with too many of either.
    pub(super) fn check(&self, from: usize) -> Result<(), LadderError> {
        let given = self.levels.saturating_add(self.refinement as usize);
        if self.levels == 0 || !(from..=MOST_SIZES).contains(&given) {
            return Err(LadderError::StepSizes { given, from, to: MOST_SIZES });
        }
        if self.coarsest_steps == 0 || self.coarsest_steps.leading_zeros() <= self.level(0) as u32 {
            return Err(LadderError::Steps { steps: self.coarsest_steps, multiple_of: 1 });
        }
        Ok(())
    }
}
