//! Checks of the assumptions against the samples.

use stats::Warning as Message;

use super::{
    extrapolation::lowest,
    level::{Samples, tail},
    report::{Estimate, Judged, Rate, Warning, WarningKind},
    rules::{DEVIATION_LIMIT, ORDER_TOLERANCE},
    sum::BIAS_LEVELS,
};

/// Distance in standard errors of the fine mean of one level and the coarse mean of another, which
/// have the same expectation; relative to rounding where neither varies.
pub fn deviation(fine: &Samples, coarse: &Samples, k: usize) -> f64 {
    let (a, b) = (&fine.values[k].fine, &coarse.values[k].coarse);
    let rounding = 64.0 * f64::EPSILON * a.mean().abs();
    let variance = a.variance_of_mean() + b.variance_of_mean() + rounding * rounding;
    if variance > 0.0 { (a.mean() - b.mean()).abs() / variance.sqrt() } else { 0.0 }
}

/// The input of the checks.
pub struct Evidence<'a> {
    /// All levels; all except the first are differences.
    pub levels: &'a [Samples],
    /// Number of the level that the sums begin with.
    pub first: usize,
    /// The weak order assumed.
    pub order: f64,
    /// Whether there is noise.
    pub noisy: bool,
    /// Whether each test function [does not vary](super::estimator::Estimator::is_still).
    pub still: Vec<bool>,
    /// Warnings of what the steps do not resolve.
    pub unresolved: Vec<Warning>,
}

impl Evidence<'_> {
    /// Judges the estimates, and returns all warnings except those about limits.
    pub fn judge(&self, estimates: &mut [Estimate]) -> Vec<Warning> {
        let failing = self.levels[self.first..].iter().filter(|level| level.failed > 0);
        let mut warnings: Vec<Warning> = failing
            .map(|&Samples { level, failed, .. }| {
                let what = format!("{failed} paths failed on level {level} and were left out");
                let message = Message::new(what).with_reason("this may bias the estimate");
                Warning::of_all(WarningKind::FailedPaths, message)
            })
            .chain(self.unresolved.iter().cloned())
            .collect();
        for (k, estimate) in estimates.iter_mut().enumerate() {
            let (few, order) = (self.few_samples(k), estimate.alpha.and_then(|a| self.slow(a)));
            let pairs = self.levels.windows(2).map(|pair| (deviation(&pair[0], &pair[1], k), pair));
            let apart = pairs.filter(|(by, _)| *by > DEVIATION_LIMIT).map(|(by, pair)| {
                let [below, level] = [pair[0].level, pair[1].level];
                let text = format!(
                    "the coarse mean of level {level} is {by:.1} standard errors from the fine \
                     mean of level {below}"
                );
                (WarningKind::Telescope, Message::new(text))
            });
            let found: Vec<_> = few.into_iter().chain(apart).chain(order).collect();
            let good = |bad: &[WarningKind]| !found.iter().any(|(kind, _)| bad.contains(kind));
            estimate.judged = Judged {
                variance: good(&[WarningKind::FewSamples]),
                bias: good(&[WarningKind::Telescope, WarningKind::Slow]),
                resolution: !self.unresolved.iter().any(|warning| warning.concerns(&estimate.name)),
            };
            for (kind, text) in found {
                Warning::of_all(kind, text).add_to(&mut warnings, &estimate.name);
            }
        }
        warnings
    }

    /// Warning if a few samples of test function number k decide: on the level that the sum begins
    /// with, where its tail shows it or few carry the variance; or because φ is the same on every
    /// path of one of the last levels.
    fn few_samples(&self, k: usize) -> Option<(WarningKind, Message)> {
        let last = self.levels.len() - BIAS_LEVELS;
        if self.still[k] {
            return None;
        }
        let blind = |samples: &&Samples| self.noisy && samples.values[k].is_blind();
        let begin = &self.levels[self.first];
        let tail = tail(self.levels, k);
        if tail.is_heavy() {
            let message = Message::new(tail.to_string()).with_reason("more paths do not help");
            return Some((WarningKind::FewSamples, message));
        }
        let found = self.levels[last..].iter().find(blind).map(|samples| (samples, 0.0));
        let heavy = begin.values[k].is_heavy();
        let few = || (begin, begin.values[k].fine.effective_samples());
        let (samples, effective) = found.or_else(|| heavy.then(few))?;
        let what = format!(
            "{effective:.0} of {} samples carry the variance on level {}",
            samples.count(),
            samples.level
        );
        let why = "a few large ones decide, or the noise is too weak for these steps";
        Some((WarningKind::FewSamples, Message::new(what).with_reason(why)))
    }

    /// Warning of a low order by which differences fall.
    fn slow(&self, Rate { value, lower, upper }: Rate) -> Option<(WarningKind, Message)> {
        let kind = match upper {
            _ if upper < lowest(self.order) => WarningKind::Slow,
            _ if upper < self.order - ORDER_TOLERANCE => WarningKind::Order,
            _ => return None,
        };
        let (seen, given) = (format!("{value:.2} ({lower:.2} to {upper:.2})"), self.order);
        let what =
            format!("differences fall with exponent {seen}, the weak order given is {given}");
        Some((kind, Message::new(what)))
    }
}
