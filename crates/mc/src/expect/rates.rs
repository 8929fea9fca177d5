//! How fast means and variances of differences fall from level to level.

pub use std::f64::consts::LN_2;

use real::elementary;

use super::{
    level::Samples,
    report::{QUANTILE, Rate},
    sum::Term,
};

/// Differences of this many standard errors have a logarithm that is nearly normal.
pub const SIGNIFICANT: f64 = 4.0;

/// How fast the means of the differences fall, if all that are significant have one sign.
pub fn alpha(differences: &[Samples], terms: &[Term], k: usize) -> Option<Rate> {
    let significant = differences.iter().zip(terms).filter(|(samples, term)| {
        let margin = SIGNIFICANT * term.variance.sqrt() + term.missed;
        samples.values[k].varies() && term.mean.abs() > margin
    });
    let significant: Vec<_> = significant.collect();
    let positive = significant.iter().filter(|(_, term)| term.mean > 0.0).count();
    if positive != 0 && positive != significant.len() {
        return None;
    }
    let point = |(samples, term): &(&Samples, &Term)| {
        let relative = term.variance / (term.mean * term.mean * LN_2 * LN_2);
        (samples.level, log2(term.mean.abs()), relative)
    };
    decay(&significant.iter().map(point).collect::<Vec<_>>())
}

/// How fast the variances of the differences fall. The relative variance of a sample variance is
/// (kurtosis − 1)/N.
pub fn beta(differences: &[Samples], k: usize) -> Option<Rate> {
    let points = differences.iter().filter_map(|samples| {
        let (values, n) = (&samples.values[k], samples.count() as f64);
        // At least one of two equally frequent values has kurtosis one; its variance is known to
        // 1/N.
        let relative = (values.sample.kurtosis() - 1.0 + 1.0 / n) / n;
        let variance = relative / (LN_2 * LN_2);
        values.varies().then(|| (samples.level, log2(values.sample.variance()), variance))
    });
    decay(&points.collect::<Vec<_>>())
}

fn log2(x: f64) -> f64 {
    elementary::ln(x) / LN_2
}

/// Weighted least squares for minus the slope of (level, logarithm, variance of it). If the points
/// are not on a line, the interval is widened by √(χ²/(n − 2)) > 1.
fn decay(points: &[(usize, f64, f64)]) -> Option<Rate> {
    if points.len() < 2 {
        return None;
    }
    let sum = |f: &dyn Fn(f64, f64) -> f64| {
        points.iter().map(|&(l, y, variance)| f(l as f64, y) / variance).sum::<f64>()
    };
    let weight = sum(&|_, _| 1.0);
    let (x_mean, y_mean) = (sum(&|x, _| x) / weight, sum(&|_, y| y) / weight);
    let spread = sum(&|x, _| (x - x_mean) * (x - x_mean));
    let slope = sum(&|x, y| (x - x_mean) * (y - y_mean)) / spread;
    let residual = |x: f64, y: f64| y - y_mean - slope * (x - x_mean);
    let excess = match points.len() - 2 {
        0 => 1.0,
        freedom => f64::max(sum(&|x, y| residual(x, y) * residual(x, y)) / freedom as f64, 1.0),
    };
    let half_width = QUANTILE * (excess / spread).sqrt();
    Some(Rate { value: -slope, lower: -slope - half_width, upper: -slope + half_width })
}
