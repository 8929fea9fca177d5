//! Checks of the assumptions against the samples.

use super::{
    bias::{BIAS_LEVELS, lowest},
    level::Samples,
    report::{Estimate, Judged, Level, LevelValue, Warning},
    resolution::{Unresolved, coupled, share, unresolved, unresolved_function},
    tails::{is_heavy, tail_index},
};

/// Standard errors between two means of one expectation: exceeded once in 10⁵ comparisons of
/// normals.
const DEVIATION_LIMIT: f64 = 4.5;
/// How far the observed order may significantly fall below the given one. With large steps it does
/// by a tenth or so, and the bound on the bias allows for it.
const ORDER_TOLERANCE: f64 = 0.25;
/// Distance in standard errors of the fine mean of one level and the coarse mean of another, which
/// have the same expectation; relative to rounding where neither varies.
fn deviation(fine: &Samples, coarse: &Samples, k: usize) -> f64 {
    let (a, b) = (&fine.values[k].fine, &coarse.values[k].coarse);
    let rounding = 64.0 * f64::EPSILON * a.mean().abs();
    let variance = a.variance_of_mean() + b.variance_of_mean() + rounding * rounding;
    if variance > 0.0 { (a.mean() - b.mean()).abs() / variance.sqrt() } else { 0.0 }
}

/// The values of one of these levels.
pub fn level_values(levels: &[Samples], samples: &Samples) -> Vec<LevelValue> {
    let below = levels.iter().find(|other| other.level + 1 == samples.level);
    let below = below.filter(|_| samples.coupling.is_some());
    let value = |k: usize| {
        let sample = &samples.values[k].sample;
        LevelValue {
            mean: sample.mean(),
            variance: sample.variance(),
            kurtosis: if samples.values[k].varies() { sample.kurtosis() } else { f64::NAN },
            deviation: below.map_or(0.0, |below| deviation(below, samples, k)),
        }
    };
    (0..samples.values.len()).map(value).collect()
}

/// What the checks read.
pub struct Evidence<'a> {
    /// All levels; all but the first are differences.
    pub levels: &'a [Samples],
    /// The one that the sums begin with.
    pub first: usize,
    /// How many of them, from the first on, make the estimates.
    pub terms: usize,
    pub accuracy: f64,
    /// The weak order given.
    pub order: f64,
    /// How the last level does not resolve the damping.
    pub damping: Option<Warning>,
    /// Whether there is noise.
    pub random: bool,
}

impl Evidence<'_> {
    /// The levels that decide: the last differences, and the last of the terms.
    fn deciding(&self) -> impl Iterator<Item = &Samples> {
        let differences = &self.levels[1..];
        let first = differences.len().saturating_sub(BIAS_LEVELS);
        self.levels[..1].iter().take(usize::from(self.terms == 1)).chain(&differences[first..])
    }

    /// Judges the estimates, and returns all warnings but those about limits. `reports` are of the
    /// same levels.
    pub fn judge(&self, reports: &[Level], estimates: &mut [Estimate]) -> Vec<Warning> {
        let failing = reports[self.first..].iter().filter(|level| level.failed > 0);
        let mut warnings: Vec<Warning> = failing
            .map(|&Level { level, failed, .. }| Warning::FailedPaths { level, failed })
            .collect();
        let differences = &self.levels[1..];
        let (enough, last) =
            (differences.len() >= BIAS_LEVELS, &differences[differences.len() - 1]);
        if !enough {
            warnings.push(Warning::FewLevels { differences: differences.len() });
        }
        let unresolved = unresolved(differences);
        if let Some(&Unresolved { component, last: difference, before }) = unresolved.as_ref() {
            let (component, level) = (component + 1, last.level);
            warnings.push(Warning::Unresolved { component, level, difference, before });
        }
        warnings.extend(self.damping.clone());
        let resolution = unresolved.is_none() && self.damping.is_none();
        for (k, estimate) in estimates.iter_mut().enumerate() {
            let judged = &mut estimate.judged;
            *judged = Judged { variance: true, bias: enough, resolution };
            let name = &estimate.name;
            let observable = || name.clone();
            let blind = |samples: &&Samples| self.random && samples.values[k].is_blind();
            if let Some(blind) = self.deciding().find(blind) {
                judged.variance = false;
                let (level, samples) = (blind.level, blind.count());
                warnings.push(Warning::Constant { observable: observable(), level, samples });
            }
            if !coupled(&last.values[k], self.accuracy) {
                judged.resolution = false;
                let (level, share) = (last.level, share(&last.values[k]));
                warnings.push(Warning::Uncoupled { observable: observable(), level, share });
            }
            if let Some(difference) = unresolved_function(differences, k, self.accuracy) {
                judged.resolution = false;
                let level = last.level;
                warnings.push(Warning::UnresolvedFunction {
                    observable: observable(),
                    level,
                    difference,
                });
            }
            for &Level { level, ref values, .. } in reports {
                let deviation = values[k].deviation;
                if deviation > DEVIATION_LIMIT {
                    judged.bias = false;
                    warnings.push(Warning::Inconsistent {
                        observable: observable(),
                        level,
                        deviation,
                    });
                }
            }
            let begin = &self.levels[self.first];
            if is_heavy(begin, k) {
                judged.variance = false;
                let (level, index) = (begin.level, tail_index(begin, k));
                warnings.push(Warning::HeavyTail { observable: observable(), level, index });
            }
            let assumed = self.order;
            if let Some(alpha) = estimate.alpha {
                let slow = alpha.upper < lowest(assumed);
                judged.bias &= !slow;
                if slow || alpha.upper < assumed - ORDER_TOLERANCE {
                    warnings.push(Warning::WeakOrder { observable: observable(), alpha, assumed });
                }
            }
        }
        warnings
    }
}
