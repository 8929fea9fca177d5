//! What the samples say about the assumptions.

use super::level::Row;
use super::plan;
use super::{Estimate, LevelValue, Settings, Warning};

/// Kurtosis above which a level is looked at: its variance has the relative error √(κ/N), a third
/// with a thousand samples, and κ itself is underestimated.
const KURTOSIS_LIMIT: f64 = 100.0;
/// With this many samples for each unit of kurtosis the variance is known to a quarter, and the
/// standard error to an eighth, all the same.
const SAMPLES_PER_KURTOSIS: f64 = 16.0;
/// Standard errors between two means of one expectation: exceeded once in 10⁵ comparisons of
/// normals.
const DEVIATION_LIMIT: f64 = 4.5;
/// How far the observed order may significantly fall below the given one: in the range of larger
/// steps it does by a tenth or so, and the bound on the bias allows for it.
const ORDER_TOLERANCE: f64 = 0.25;
/// A better number of coarsest steps is worth mentioning when it saves this part of the cost.
const SAVING: f64 = 0.2;

/// Fine mean of one row against the coarse mean of another, which have one expectation, in standard
/// errors. Where neither varies, against the rounding of the mean.
fn deviation(fine: &Row, coarse: &Row, k: usize) -> f64 {
    let (a, b) = (&fine.values[k].fine, &coarse.values[k].coarse);
    let rounding = 64.0 * f64::EPSILON * a.mean().abs();
    let variance = a.variance_of_mean() + b.variance_of_mean() + rounding * rounding;
    if variance > 0.0 { (a.mean() - b.mean()).abs() / variance.sqrt() } else { 0.0 }
}

/// What one row says, given the row of single paths or fine paths on the level below if there is
/// one.
pub(crate) fn level_values(rows: &[Row], row: &Row) -> Vec<LevelValue> {
    let below =
        row.level.checked_sub(1).and_then(|level| rows.iter().find(|other| other.level == level));
    let value = |k: usize| {
        let sample = &row.values[k].sample;
        let deviation = match below {
            Some(below) if row.coupling.is_some() => deviation(below, row, k),
            _ => 0.0,
        };
        LevelValue {
            mean: sample.mean(),
            variance: sample.variance(),
            kurtosis: sample.kurtosis(),
            deviation,
        }
    };
    (0..row.values.len()).map(value).collect()
}

/// All warnings but those about limits.
pub(crate) fn warnings(rows: &[Row], estimates: &[Estimate], settings: &Settings) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for row in rows.iter().filter(|row| row.failed > 0) {
        warnings.push(Warning::FailedPaths { level: row.level, failed: row.failed });
    }
    for (k, estimate) in estimates.iter().enumerate() {
        let observable = estimate.name;
        for row in rows {
            let value = level_values(rows, row)[k];
            let known = row.samples() as f64 > SAMPLES_PER_KURTOSIS * value.kurtosis;
            if row.values[k].varies() && value.kurtosis > KURTOSIS_LIMIT && !known {
                warnings.push(Warning::Kurtosis {
                    observable,
                    level: row.level,
                    kurtosis: value.kurtosis,
                });
            }
            if value.deviation > DEVIATION_LIMIT {
                warnings.push(Warning::Inconsistent {
                    observable,
                    level: row.level,
                    deviation: value.deviation,
                });
            }
        }
        if let Some(beta) = estimate.beta.filter(|beta| beta.upper < 1.0) {
            warnings.push(Warning::VarianceDecay { observable, beta });
        }
        let assumed = settings.weak_order;
        if let Some(alpha) = estimate.alpha.filter(|alpha| alpha.upper < assumed - ORDER_TOLERANCE)
        {
            warnings.push(Warning::WeakOrder { observable, alpha, assumed });
        }
    }
    warnings
}

/// The number of coarsest steps with which the same levels would cost least, if that saves a fifth
/// or more: begun on level m, the cost is that of single paths there and the differences above.
pub(crate) fn better_coarsest_steps(rows: &[Row], settings: &Settings) -> Option<u64> {
    let cost = |m: usize| {
        let mut levels = plan::costs_and_variances(&rows[m..]);
        if m > 0 {
            // Single paths on level m are the coarse paths of the level above it.
            let singles =
                rows[m + 1].values.iter().map(|values| values.coarse.variance()).collect();
            levels[0] = (settings.steps(m), singles);
        }
        let root =
            |k: usize| levels.iter().map(|(cost, v)| (v[k] * *cost as f64).sqrt()).sum::<f64>();
        let varying = (0..rows[0].values.len()).filter(|&k| rows[0].values[k].varies());
        varying.map(|k| root(k) * root(k)).fold(0.0, f64::max)
    };
    let best = (0..rows.len() - 1).min_by(|&a, &b| cost(a).total_cmp(&cost(b)))?;
    (cost(best) < (1.0 - SAVING) * cost(0)).then(|| settings.steps(best))
}
