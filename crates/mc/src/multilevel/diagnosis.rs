//! Checks of the assumptions against the samples.

use super::{
    level::Samples,
    plan,
    report::{Estimate, Level, LevelValue, Warning},
    settings::ExpectationSettings,
};

/// Largest kurtosis κ without a check of the number of samples N. The relative error of a variance
/// is √(κ/N), a third with κ = 100 and a thousand samples, and κ itself is underestimated.
const KURTOSIS_LIMIT: f64 = 100.0;
/// With this many samples for each unit of kurtosis the variance is known to a quarter, and the
/// standard error to an eighth.
const SAMPLES_PER_KURTOSIS: f64 = 16.0;
/// Standard errors between two means of one expectation: exceeded once in 10⁵ comparisons of
/// normals.
const DEVIATION_LIMIT: f64 = 4.5;
/// How far the observed order may significantly fall below the given one. With large steps it does
/// by a tenth or so, and the bound on the bias allows for it.
const ORDER_TOLERANCE: f64 = 0.25;
/// Least relative saving for which another number of coarsest steps is recommended.
const SAVING: f64 = 0.2;

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

/// All warnings but those about limits.
pub fn warnings(levels: &[Level], estimates: &[Estimate], assumed: f64) -> Vec<Warning> {
    let failing = levels.iter().filter(|level| level.failed > 0);
    let mut warnings: Vec<Warning> = failing
        .map(|&Level { level, failed, .. }| Warning::FailedPaths { level, failed })
        .collect();
    for (k, &Estimate { name: observable, alpha, beta, .. }) in estimates.iter().enumerate() {
        for &Level { level, samples, ref values, .. } in levels {
            let LevelValue { kurtosis, deviation, .. } = values[k];
            // A NaN is no kurtosis above the limit.
            if kurtosis > KURTOSIS_LIMIT && samples as f64 <= SAMPLES_PER_KURTOSIS * kurtosis {
                warnings.push(Warning::Kurtosis { observable, level, kurtosis });
            }
            if deviation > DEVIATION_LIMIT {
                warnings.push(Warning::Inconsistent { observable, level, deviation });
            }
        }
        if let Some(beta) = beta.filter(|beta| beta.upper < 1.0) {
            warnings.push(Warning::VarianceDecay { observable, beta });
        }
        if let Some(alpha) = alpha.filter(|alpha| alpha.upper < assumed - ORDER_TOLERANCE) {
            warnings.push(Warning::WeakOrder { observable, alpha, assumed });
        }
    }
    warnings
}

/// The number of coarsest steps with which the same levels would cost least, if that saves a fifth
/// or more. Begun on level m, they are single paths there and the differences above.
pub fn better_coarsest_steps(levels: &[Samples], settings: &ExpectationSettings) -> Option<u64> {
    let cost = |m: usize| {
        let mut planned = plan::costs_and_variances(&levels[m..]);
        if m > 0 {
            // Single paths on level m are the coarse paths of the level above it.
            let coarse = levels[m + 1].values.iter().map(|values| values.coarse.variance());
            planned[0] = (settings.steps(m) as f64, coarse.collect());
        }
        let root = |k: usize| planned.iter().map(|(cost, v)| (v[k] * cost).sqrt()).sum::<f64>();
        let values = levels[0].values.iter().enumerate().filter(|(_, values)| values.varies());
        values.map(|(k, _)| root(k) * root(k)).fold(0.0, f64::max)
    };
    let best = (0..levels.len() - 1).min_by(|&a, &b| cost(a).total_cmp(&cost(b)))?;
    (cost(best) < (1.0 - SAVING) * cost(0)).then(|| settings.steps(best))
}
