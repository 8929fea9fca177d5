//! Whether a law has a variance and a mean, from its largest values.
//!
//! Values above a high threshold u have nearly a generalised Pareto law, P(x − u > y) = (1 +
//! ξy/σ)^{−1/ξ} (Pickands, *Ann. Statist.* 3, 1975), wherever the centre is. α = 1/ξ is the tail
//! index: moments of an order below α exist. ξ is fitted by Zhang and Stephens (*Technometrics* 51,
//! 2009), as Vehtari and others do to tell whether means of weights have a variance (*JMLR* 25,
//! 2024). Its standard error is about (1 + ξ)/√M with M values.
//!
//! A lognormal law with σ = 1, which has all moments, has ξ ≈ 0.3 where samples end, and its N/κ
//! grows with N (κ is the kurtosis); where there is no variance N/κ stays below some dozens. So a
//! tail is named heavy where ξ − 0.07 ln(N/κ) exceeds 0.1 by 3.8/√M, for one of three M at least;
//! the largest M counts, or one that shows no variance, unless a smaller one has a ξ smaller by 3.8
//! standard errors of both: the M largest values of a mixture may not be in its tail. It is also
//! named where N/κ is below thirty and more than 128 values give ξ ≥ ½ within a quarter of its
//! error: samples of a law without a variance that look light have means that are too small. Of
//! laws with fourth moments, up to that lognormal one, it names two in a hundred or less at 100
//! and at 1000 values and none at 5000; of those with α = 1.67 it names 0.9 at 1000 values and
//! 0.96 at 5000; with α = 1.1 all at 1000 and a third at 100, which are too few to tell:
//! `tests/all/statistical/tails.rs`. With α = 1.67 seven
//! means in a hundred have an interval at 1000 values that misses, three at 5000.

use std::fmt;

use real::elementary;

use crate::{CentralMoments, FEW_SAMPLES};

/// Numbers of largest values that are tried: many are steady, few see a heavy tail of small weight.
const LARGEST: [usize; 3] = [512, 128, 32];
/// Least number of values that have a tail.
const FEWEST: usize = 16;
/// Least ratio of the number of values to the number in the tail.
const PART: usize = 5;
/// Standard errors of a shape that count as sure.
const SURELY: f64 = 3.8;
/// Kurtosis below which no tail is fitted; the exponential law has nine.
const MIN_KURTOSIS: f64 = 10.0;

/// The tail of a law that is too heavy for intervals of means; zero for other laws.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tail {
    /// Shape ξ = 1/α.
    shape: f64,
    /// Standard error of ξ.
    error: f64,
}

impl Tail {
    /// Whether the tail is heavy.
    pub fn is_heavy(self) -> bool {
        self.shape > 0.0
    }

    /// Whether the mean exists: α is above one by a standard error.
    pub fn has_mean(self) -> bool {
        self.shape + self.error < 1.0
    }

    /// Whether the variance exists: α is above two by a standard error.
    pub fn has_variance(self) -> bool {
        self.shape + self.error < 0.5
    }
}

/// Names the moment that perhaps does not exist, and the index. It is never certain: a lognormal
/// law of large deviation has a mean that no sample shows.
impl fmt::Display for Tail {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { shape, error } = self;
        let lacks = match (self.has_mean(), self.has_variance()) {
            (false, _) => "perhaps no mean",
            (_, false) => "perhaps no variance",
            _ => "variance hardly known",
        };
        let (index, error) = (1.0 / shape, error / (shape * shape));
        write!(f, "{lacks} (tail index {index:.1} ± {error:.1})")
    }
}

impl CentralMoments {
    /// Whether the distribution may be so heavy that an interval of its mean is wrong.
    pub fn may_be_heavy(&self) -> bool {
        self.kurtosis() > MIN_KURTOSIS && !self.is_two_valued()
    }

    /// Fits the tail on the side of the furthest sample to some of the `samples`.
    pub fn tail(&self, samples: &[f64]) -> Tail {
        let (up, down) = (self.largest - self.mean, self.mean - self.least);
        if !self.may_be_heavy() {
            return Tail::default();
        }
        let sign = if up < down { -1.0 } else { 1.0 };
        let mut falling: Vec<f64> = samples.iter().map(|x| sign * x).collect();
        falling.sort_by(|a, b| b.total_cmp(a));
        let effective = self.effective_samples();
        let limit = 0.1 + 0.07 * elementary::ln(effective);
        let fit = |most: usize| {
            let largest = most.min(falling.len() / PART);
            let shape = shape(falling.get(..=largest).filter(|_| largest >= FEWEST)?);
            Some((largest, Tail { shape, error: (1.0 + shape) / (largest as f64).sqrt() }))
        };
        let fits: Vec<_> = LARGEST.into_iter().filter_map(fit).collect();
        let tail = |(n, &(largest, tail)): (usize, &(usize, Tail))| {
            let root = (largest as f64).sqrt();
            let few = effective < FEW_SAMPLES && largest > LARGEST[1];
            let near = few && tail.shape + 0.25 * tail.error >= 0.5;
            // Of the same law both differ by less.
            let is_lighter = |(_, further): &(usize, Tail)| {
                further.shape + SURELY * elementary::hypot(further.error, tail.error) < tail.shape
            };
            let is_heavy = near || tail.shape - SURELY / root > limit;
            (is_heavy && !fits[n + 1..].iter().any(is_lighter)).then_some(tail)
        };
        let mut tails = fits.iter().enumerate().filter_map(tail);
        let first = tails.next().unwrap_or_default();
        let heavier = |tail: &Tail| first.has_variance() && !tail.has_variance();
        tails.find(heavier).unwrap_or(first)
    }
}

/// Estimates ξ from the values above the last of `falling`, which are in decreasing order. NaN
/// where a quarter of them are equal.
///
/// With θ = −ξ/σ the likelihood of θ alone has k(θ) = mean ln(1 − θy) = ξ; the estimate is k at the
/// mean of θ with the weights of the likelihood on Zhang's and Stephens' grid, which an empirical
/// prior gives.
fn shape(falling: &[f64]) -> f64 {
    let above = falling.len() - 1;
    let (n, threshold) = (above as f64, falling[above]);
    let (largest, quartile) = (falling[0] - threshold, falling[above * 3 / 4] - threshold);
    let k = |theta: f64| {
        let logarithm = |x: &f64| elementary::ln(1.0 - theta * (x - threshold));
        falling[..above].iter().map(logarithm).sum::<f64>() / n
    };
    let points = (30.0 + n.sqrt()).floor();
    let likelihood = |j| {
        let root = (points / (f64::from(j) + 0.5)).sqrt();
        let theta = 1.0 / largest + (1.0 - root) / (3.0 * quartile);
        let k = k(theta);
        (theta, n * (elementary::ln(-theta / k) - k - 1.0))
    };
    let grid: Vec<(f64, f64)> = (0..points as u32).map(likelihood).collect();
    let most = grid.iter().map(|one| one.1).fold(f64::NEG_INFINITY, f64::max);
    let mean = grid.iter().fold((0.0, 0.0), |(sum, weights), (theta, likelihood)| {
        let weight = elementary::exp(likelihood - most);
        (sum + weight * theta, weights + weight)
    });
    k(mean.0 / mean.1)
}
