//! Growth that is not exponential, or not yet.
//!
//! In integrable systems neighbouring paths part like a power of t. The exponent is zero, and its
//! estimate k ln(t₁/t₀)/(t₁ − t₀) falls, but for long it is many standard errors from zero. So each
//! chain's growth is fitted by λt + k ln t, with t from the time at which tangent vectors are
//! anew. Least squares over batches of time give both; the error is that over the chains.
//!
//! An exponent x ≠ 0 is **not seen** where k has its sign, by 2 standard errors over all of the
//! time, λ over the time that is kept does not have it by 2, and a power of at most 3 explains x:
//! then its interval has 0 in it. Growth is **bent** where k over the time that is kept differs
//! from 0 by 3, and λ is outside of the interval: then this reaches to λ ± 2 standard errors, and
//! to 0 where growth becomes faster, as a slow shear does at first.

use real::elementary::ln;

use super::{
    chains::{Living, moments},
    rules::{BENT, MAX_POWER, SEEN},
};

/// Standard deviations that the range of a Brownian bridge exceeds with a probability of 5 %.
const KUIPER: f64 = 1.747;

/// Fit of growth by λt + k ln t with t in batches.
struct Fit {
    /// Estimates of λ and k, each with its standard error.
    slope: (f64, f64),
    power: (f64, f64),
    /// The mean of ln(t + 1) − ln t.
    logarithm: f64,
}

impl Fit {
    /// The fit of batches from number `first` > 0 on.
    fn new(living: &Living<'_>, row: usize, first: usize) -> Self {
        let late = &living.batches[first..];
        let count = late.len() as f64;
        let z: Vec<f64> = (first..living.batches.len()).map(|b| ln(1.0 + 1.0 / b as f64)).collect();
        let logarithm = z.iter().sum::<f64>() / count;
        let square: f64 = z.iter().map(|z| (z - logarithm) * (z - logarithm)).sum();
        let of = |weight: &dyn Fn(f64) -> f64| {
            let grown =
                |&n: &usize| late.iter().zip(&z).map(|(batch, &z)| weight(z) * batch[row][n]).sum();
            let moments = moments(living.chains.iter().map(grown));
            (moments.mean(), moments.variance_of_mean().sqrt())
        };
        let power = |z: f64| (z - logarithm) / square;
        Self { slope: of(&|z| 1.0 / count - logarithm * power(z)), power: of(&power), logarithm }
    }
}

/// The error of an exponent by the bounded motion of ln|v| that all chains share, such as the phase
/// of a damped oscillator, which no standard error shows: the range of the mean growth about its
/// line at the ends of batches from number `first` on, twice since the line takes a part of the
/// motion, over their number. Zero where the range is that of independent batches (N. Kuiper,
/// *Indag. Math.* 63, 1960).
pub fn wander(living: &Living<'_>, row: usize, first: usize) -> f64 {
    let batches = first..living.batches.len();
    let count = batches.len() as f64;
    let totals = moments(living.sums(row, batches.clone()));
    let (mut sum, mut least, mut most) = (0.0, 0.0f64, 0.0f64);
    for b in batches {
        let grown: f64 = living.sums(row, b..b + 1).sum();
        sum += grown / living.chains.len() as f64 - totals.mean() / count;
        (least, most) = (least.min(sum), most.max(sum));
    }
    let range = most - least;
    if range > KUIPER * totals.variance_of_mean().sqrt() { 2.0 * range / count } else { 0.0 }
}

/// The interval of the exponent in a row of batches, in their units, if growth is bent or shows no
/// exponent, from batch number `first` on.
pub fn unsettled(
    living: &Living<'_>,
    row: usize,
    first: usize,
    (mut lo, mut hi): (f64, f64),
) -> Option<(f64, f64)> {
    let [all, kept] = [1, first].map(|first| Fit::new(living, row, first));
    let mean = 0.5 * (lo + hi);
    let sign = mean.signum();
    let exceeds = |(value, error): (f64, f64), times: f64| value > times * error;
    let falls = exceeds((sign * all.power.0, all.power.1), SEEN);
    let is_seen = exceeds((sign * kept.slope.0, kept.slope.1), SEEN);
    let is_power = mean.abs() <= MAX_POWER * kept.logarithm;
    let (slope, error) = kept.slope;
    let rises = sign * kept.power.0 < 0.0;
    let is_bent = exceeds((kept.power.0.abs(), kept.power.1), BENT) && !(lo..=hi).contains(&slope);
    if !(is_bent || falls && !is_seen && is_power) {
        return None;
    }
    let reach = SEEN * error;
    if kept.power.0 > 0.0 {
        lo = lo.min(slope - reach);
    } else {
        hi = hi.max(slope + reach);
    }
    if is_power && (rises || !is_seen) {
        (lo, hi) = (lo.min(0.0), hi.max(0.0));
    }
    Some((lo, hi))
}
