//! The sum over the levels for one test function: value, interval, cost.

use real::elementary::{exp, hypot, ln, powi};
use stats::{FEW_SAMPLES, two_sided};

use super::{
    extrapolation::Extrapolation,
    level::Samples,
    report::QUANTILE,
    rules::{FEW_DECIDE, HIGH_CONFIDENCE, UNSEEN},
};

/// Number of differences that bound the bias.
pub const BIAS_LEVELS: usize = 3;
/// Bound on what events that `n` samples missed may add to their mean, if `effective` of them carry
/// the variance (NaN where none differs) and an event reaches as far as `reach`.
fn missed(n: f64, effective: f64, reach: f64) -> f64 {
    if effective >= FEW_SAMPLES { 0.0 } else { UNSEEN * reach / n }
}

/// One test function on one level.
#[derive(Clone, Copy, Debug, Default)]
pub struct Term {
    /// Path-steps of all samples.
    pub cost: f64,
    /// The mean over replicates.
    pub mean: f64,
    /// Variance of the mean over replicates.
    pub variance: f64,
    /// Bound on what events that the samples missed may add.
    pub missed: f64,
    /// The third central moment of the mean of a replicate.
    pub third: f64,
    /// Variance that the largest and the least value of a replicate give to its mean.
    pub ends: f64,
}

impl Term {
    fn new(samples: &Samples, k: usize, fine: bool, missed: f64) -> Self {
        let means = &samples.means[k][usize::from(fine)];
        // One path without noise has no error of sampling.
        let is_one = means.mean.count() == 1;
        let variance = if is_one { 0.0 } else { means.mean.variance_of_mean() };
        let (cost, mean) = ((samples.count() * samples.cost_per_path) as f64, means.mean.mean());
        let (third, ends) = (means.mean.third_moment(), means.variance_of_ends(samples.points));
        Self { cost, mean, variance, missed, third, ends }
    }

    /// The term of φ number k itself on the fine paths of a level, where it spreads by `range`.
    pub fn first(samples: &Samples, k: usize, range: f64) -> Self {
        let effective = samples.values[k].fine.effective_samples();
        Self::new(samples, k, true, missed(samples.count() as f64, effective, range))
    }

    /// The terms of test function number k on each of these differences.
    ///
    /// A difference may be as large as the largest of its level and of the level below, where
    /// events of the same kind are more frequent; where none differs, as large as `range`. Nor is
    /// its kurtosis less than on the level below.
    pub fn differences(levels: &[Samples], k: usize, range: f64) -> Vec<Self> {
        let mut below = (f64::NAN, 0.0);
        let term = |samples: &Samples| {
            let (n, sample) = (samples.count() as f64, &samples.values[k].sample);
            let own = (sample.kurtosis(), sample.largest_deviation());
            let kurtosis = if own.0.is_nan() { own.0 } else { own.0.max(below.0) };
            let reach = own.1.max(below.1);
            below = own;
            let reach = if reach > 0.0 { reach } else { range };
            Self::new(samples, k, false, missed(n, n / kurtosis, reach))
        };
        levels.iter().map(term).collect()
    }
}

/// The sum over the levels for one test function.
pub struct Sum {
    /// The first level and all differences above it; or two differences and `single` paths.
    pub terms: Vec<Term>,
    pub extrapolation: Extrapolation,
    /// Whether single paths of the last level are taken.
    pub single: bool,
    /// Number of replicates.
    pub replicates: f64,
    /// Confidence of Student's quantile.
    pub confidence: f64,
    /// Bound on what failed paths may add: their share of each level times the range of φ.
    pub lost: f64,
    /// Bound of the rounding errors of all steps.
    pub rounding: f64,
    /// Error of a derivative that the change of its parameter leaves.
    pub beside: f64,
}

impl Sum {
    /// The weight of a term: one, and another for the last two differences.
    fn weight(&self, term: usize) -> f64 {
        let [before, last] = self.extrapolation.weights;
        match self.terms.len() - term {
            place if self.single => [1.0, last, before][place - 1],
            1 => 1.0 + last,
            2 => 1.0 + before,
            _ => 1.0,
        }
    }

    /// Σ of a function of weight and term.
    pub fn over(&self, part: impl Fn(f64, &Term) -> f64) -> f64 {
        self.terms.iter().enumerate().map(|(n, term)| part(self.weight(n), term)).sum()
    }

    pub fn standard_error(&self) -> f64 {
        self.over(|weight, term| weight * weight * term.variance).sqrt()
    }

    pub fn missed(&self) -> f64 {
        self.over(|weight, term| (weight * term.missed).powi(2)).sqrt()
    }

    /// Number of standard errors on each side of the interval.
    ///
    /// Student's quantile x, and for means of replicates of skewness g, as those of an unbounded φ,
    /// x(x⁴ + 2x² − 3)g²/(18R) more: so much the two-sided coverage of R skew samples lacks to
    /// first order (Hall, *The Bootstrap and Edgeworth Expansion*, 1992, §2.6). Where the largest
    /// and the least value of a replicate make much of its variance, a few large values decide, and
    /// g is not seen well either: then x is the quantile of 99 %.
    pub fn quantile(&self) -> f64 {
        let variance = self.replicates * self.standard_error().powi(2);
        let third = self.over(|weight, term| weight * weight * weight * term.third);
        let few = self.over(|weight, term| weight * weight * term.ends) > FEW_DECIDE * variance;
        let confidence = if few { HIGH_CONFIDENCE } else { self.confidence };
        let x = two_sided(confidence, Some(self.replicates - 1.0));
        let skewness = third * third / powi(variance, 3).max(f64::MIN_POSITIVE);
        x + x * (powi(x, 4) + 2.0 * x * x - 3.0) * skewness / (18.0 * self.replicates)
    }

    /// Half of the interval without the bias.
    pub fn spread(&self) -> f64 {
        hypot(self.quantile() * self.standard_error(), self.missed())
    }

    /// Bound on the bias, with margins for its standard error and for failed paths.
    ///
    /// Below single paths it has no margin for its error: differences make it with their errors,
    /// which are not smaller than that of the paths.
    pub fn bias_bound(&self) -> f64 {
        let Extrapolation { size, standard_error, .. } = self.extrapolation;
        let margin = if self.single { 0.0 } else { self.quantile() * standard_error };
        size + margin + self.lost + self.beside
    }

    /// Amount that extrapolation adds.
    pub fn bias(&self) -> f64 {
        let is_plain = |n: usize| !self.single || n + 1 == self.terms.len();
        let added = |n: usize| self.weight(n) - f64::from(u8::from(is_plain(n)));
        self.terms.iter().enumerate().map(|(n, term)| added(n) * term.mean).sum()
    }

    /// Half of the interval, in standard errors, times the root of the path-steps that it takes:
    /// √(VC) for each term (Giles 2008), and for the margin of the bias.
    pub fn root(&self) -> f64 {
        let of = |weight: f64, term: &Term| weight.abs() * (term.variance * term.cost).sqrt();
        let last = self.terms.last().filter(|_| !self.single).map_or(0.0, |last| last.cost);
        self.over(of) + self.extrapolation.standard_error * last.sqrt()
    }

    pub fn half_width(&self) -> f64 {
        self.spread() + self.bias_bound()
    }

    /// Approximate half of the interval with twice the points of term n, whose variance falls as
    /// that of random points at least.
    pub fn with_twice(&self, n: usize) -> f64 {
        let gained = 0.5 * self.weight(n).powi(2) * self.terms[n].variance;
        let square = self.spread().powi(2) - self.quantile().powi(2) * gained;
        square.max(0.0).sqrt() + self.bias_bound()
    }

    /// Approximate gain of a path-step of more points on term n.
    pub fn gain(&self, n: usize) -> f64 {
        let Term { cost, variance, missed, .. } = self.terms[n];
        self.weight(n).powi(2) * (QUANTILE * QUANTILE * variance + missed * missed) / cost
    }

    /// Approximate number of path-steps that the half-width `wanted` takes, if the error of a level
    /// falls with its points as N^{−1/growth}.
    pub fn cost(&self, wanted: f64, growth: f64) -> f64 {
        self.over(|weight, term| {
            let error = weight * hypot(self.quantile() * term.variance.sqrt(), term.missed);
            term.cost * exp(growth * ln((error / wanted).max(1.0)))
        })
    }
}
