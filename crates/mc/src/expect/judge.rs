//! Checks of the assumptions against the samples.

use super::{
    extrapolation::{ORDER_TOLERANCE, lowest},
    level::Samples,
    report::{Estimate, Judged, Unbounded, Warning},
    sum::BIAS_LEVELS,
};

/// Standard errors between two means of one expectation: exceeded once in 10⁵ comparisons of
/// normals.
const DEVIATION_LIMIT: f64 = 4.5;

/// Distance in standard errors of the fine mean of one level and the coarse mean of another, which
/// have the same expectation; relative to rounding where neither varies.
pub fn deviation(fine: &Samples, coarse: &Samples, k: usize) -> f64 {
    let (a, b) = (&fine.values[k].fine, &coarse.values[k].coarse);
    let rounding = 64.0 * f64::EPSILON * a.mean().abs();
    let variance = a.variance_of_mean() + b.variance_of_mean() + rounding * rounding;
    if variance > 0.0 { (a.mean() - b.mean()).abs() / variance.sqrt() } else { 0.0 }
}

/// What the checks read.
pub struct Evidence<'a> {
    /// All levels; all but the first are differences.
    pub levels: &'a [Samples],
    /// The one that the sums begin with.
    pub first: usize,
    /// The weak order assumed.
    pub order: f64,
    /// Whether there is noise.
    pub noisy: bool,
    /// What the steps do not resolve.
    pub unresolved: Vec<Warning>,
}

impl Evidence<'_> {
    /// Judges the estimates, and returns all warnings but those about limits.
    pub fn judge(&self, estimates: &mut [Estimate]) -> Vec<Warning> {
        let failing = self.levels[self.first..].iter().filter(|level| level.failed > 0);
        let mut warnings: Vec<Warning> = failing
            .map(|&Samples { level, failed, .. }| Warning::FailedPaths { level, failed })
            .collect();
        warnings.extend(self.unresolved.iter().cloned());
        for (k, estimate) in estimates.iter_mut().enumerate() {
            let few = self.few_samples(k, &estimate.name);
            let (bounded, bias) = self.bias(k, estimate);
            let of_this = |warning: &Warning| {
                warning.observable().is_none_or(|observable| observable == estimate.name)
            };
            let resolution = !self.unresolved.iter().any(of_this);
            estimate.judged = Judged { variance: few.is_none(), bias: bounded, resolution };
            warnings.extend(few.into_iter().chain(bias));
        }
        warnings
    }

    /// Whether a few samples of test function number k decide: on the level that the sum begins
    /// with, or because φ is the same on every path of one of the last levels.
    fn few_samples(&self, k: usize, name: &str) -> Option<Warning> {
        let last = self.levels.len() - BIAS_LEVELS;
        let blind = |samples: &&Samples| self.noisy && samples.values[k].is_blind();
        let begin = &self.levels[self.first];
        let found = self.levels[last..].iter().find(blind).map(|samples| (samples, 0.0));
        let heavy = begin.values[k].is_heavy();
        let few = || (begin, begin.values[k].fine.effective_samples());
        let (samples, effective) = found.or_else(|| heavy.then(few))?;
        let (observable, level, samples) = (name.to_owned(), samples.level, samples.count());
        Some(Warning::FewSamples { observable, level, effective, samples })
    }

    /// Whether the bias of test function number k is bounded, and what there is to say of it.
    fn bias(&self, k: usize, estimate: &Estimate) -> (bool, Vec<Warning>) {
        let neighbours = self.levels.windows(2).map(|pair| (&pair[1], &pair[0]));
        let apart = neighbours.filter_map(|(samples, below)| {
            let (level, deviation) = (samples.level, deviation(below, samples, k));
            (deviation > DEVIATION_LIMIT).then_some(Unbounded::Telescope { level, deviation })
        });
        let mut found: Vec<Unbounded> = apart.collect();
        let mut bounded = found.is_empty();
        if let Some(alpha) = estimate.alpha {
            let (assumed, slow) = (self.order, alpha.upper < lowest(self.order));
            bounded &= !slow;
            if slow || alpha.upper < assumed - ORDER_TOLERANCE {
                found.push(Unbounded::Order { alpha, assumed });
            }
        }
        let warning = |why| Warning::Bias { observable: estimate.name.clone(), why };
        (bounded, found.into_iter().map(warning).collect())
    }
}
