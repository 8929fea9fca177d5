//! The strong order from squared errors that share paths.
//!
//! With m_l the mean squares, ln m_l ≈ a + 2p ln τ_l + ln(1 + bτ_l + c τ_ref/τ_l). The term bτ is
//! the next order of the error; c τ_ref/τ is the error of the reference, present when it is a run
//! at step τ_ref (for an order-½ scheme against itself the squared error is C(τ − τ_ref), so c = −1
//! exactly).
//!
//! **Weights.** Weighting by the inverse of the *estimated* covariance V would be efficient if V
//! were known. Estimated from the same few hundred skewed squares it is not independent of the
//! means: large means come with large variances and are weighted down, and 95 % intervals cover 90
//! to 94 %. The weights here come from a fixed working covariance, equal variances with correlation
//! ½ between neighbours, so the estimate is linear in ln m; its variance gᵀVg uses the estimated V
//! (Liang and Zeger, *Biometrika* 73, 1986). The quantile is Student's, with degrees of freedom
//! from the kurtosis of the paths' influences. V's own weights serve χ² alone.
//!
//! **Heavy tails.** A level whose squared errors x are carried by fewer than 30 paths, (Σx)²/Σx² <
//! 30, is left out of the fit: there the mean of the few largest squares is measured and not a mean
//! square. With fewer than four levels left, all are used, and the interval reaches at each end as
//! far as the farther of the delta method's and the bootstrap's.
//!
//! How often the intervals cover is measured by `lab::coverage`.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::describe::describe;
use super::{CONFIDENCE, bootstrap, misfit, student_quantile};
use crate::least_squares::{Fit, Weighting};
use crate::{CrossMoments, Rate, StraightLine};

/// Levels whose squared errors are carried by fewer paths than this, (Σx)²/Σx², are called
/// unreliable.
pub(crate) const FEW_PATHS: f64 = 30.0;
/// Fewer levels than this make no fit from which others have been left out.
const LEAST_LEVELS: usize = 4;
/// Correlation between neighbouring levels in the working weights.
const WORKING_CORRELATION: f64 = 0.5;
/// Gauss–Newton ends when c and b move by less than this; it converges linearly, with a rate of the
/// size of the residuals.
const STANDSTILL: f64 = 1e-9;
/// Or after this many steps.
const GAUSS_NEWTON_STEPS: u32 = 50;
/// The corrections may take away this much of the leading term, and no more: 1 − 1/50.
const LEAST_FACTOR: f64 = 0.02;
/// Confidence at which a straight line is refuted.
pub(super) const STRAIGHT_CONFIDENCE: f64 = 0.99;

/// Terms of the model besides a + 2p ln τ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// c τ_ref/τ, with this τ_ref.
    pub reference: Option<f64>,
    /// bτ.
    pub curvature: bool,
}

impl Terms {
    /// What can be afforded with so many levels: two more than parameters.
    fn affordable(reference: Option<f64>, levels: usize) -> Self {
        Self { reference: reference.filter(|_| levels >= 5), curvature: levels >= 6 }
    }

    /// a + 2p ln τ and nothing else.
    pub const STRAIGHT: Self = Self { reference: None, curvature: false };

    /// The factors of c and b at each level.
    fn regressors(self, taus: &[f64]) -> Vec<Vec<f64>> {
        let row = |&tau: &f64| {
            let reference = self.reference.map(|reference| reference / tau);
            reference.into_iter().chain(self.curvature.then_some(tau / taus[0])).collect()
        };
        taus.iter().map(row).collect()
    }
}

/// Logarithms of mean squares at some levels, with their estimated covariance.
pub struct Logarithms<'a> {
    squares: &'a CrossMoments,
    levels: Vec<usize>,
    taus: Vec<f64>,
    values: Vec<f64>,
    covariance: Vec<Vec<f64>>,
}

/// A fitted order.
pub struct Estimate {
    /// p.
    pub order: f64,
    /// Its standard error.
    pub se: f64,
    /// χ² of the residuals.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub degrees: usize,
    /// Weights of the logarithms in the order.
    pub gain: Vec<f64>,
    /// Coefficients of the terms over their standard errors, in the order of [`Terms`].
    pub t: Vec<f64>,
}

impl<'a> Logarithms<'a> {
    /// `None` when a mean is not positive.
    pub fn new(taus: &[f64], squares: &'a CrossMoments, levels: Vec<usize>) -> Option<Self> {
        let means: Vec<f64> = levels.iter().map(|&l| squares.mean(l)).collect();
        if means.iter().any(|mean| !(mean.is_finite() && *mean > 0.0)) {
            return None;
        }
        let covariance = (0..levels.len())
            .map(|i| {
                let row = 0..levels.len();
                row.map(|j| {
                    squares.covariance_of_means(levels[i], levels[j]) / (means[i] * means[j])
                })
                .collect()
            })
            .collect();
        let values = means.iter().map(|mean| mean.ln()).collect();
        Some(Self {
            squares,
            taus: levels.iter().map(|&l| taus[l]).collect(),
            levels,
            values,
            covariance,
        })
    }

    /// The twin of everything here: levels taken for independent.
    pub fn forget_covariance(&mut self) {
        for (i, row) in self.covariance.iter_mut().enumerate() {
            row.iter_mut().enumerate().filter(|(j, _)| i != *j).for_each(|(_, entry)| *entry = 0.0);
        }
    }

    /// Fits the order with the working weights, and χ² with those of the estimated covariance.
    pub fn fit(&self, terms: Terms) -> Option<Estimate> {
        let levels = self.levels.len();
        let working = Weighting::new(&working_covariance(levels))?;
        let (design, Fit { parameters, covariance: inverse, .. }) =
            self.gauss_newton(&working, terms)?;
        let (_, Fit { chi_square, .. }) =
            self.gauss_newton(&Weighting::new(&self.covariance)?, terms)?;
        let gains: Vec<Vec<f64>> = inverse.iter().map(|row| working.gain(&design, row)).collect();
        let se = |c: usize| self.standard_error(&gains[c]);
        Some(Estimate {
            order: 0.5 * parameters[1],
            se: 0.5 * se(1),
            chi_square,
            degrees: levels - parameters.len(),
            t: (2..parameters.len()).map(|c| parameters[c] / se(c)).collect(),
            gain: gains[1].iter().map(|g| 0.5 * g).collect(),
        })
    }

    /// √(gᵀVg).
    fn standard_error(&self, gain: &[f64]) -> f64 {
        let row =
            |i: usize| -> f64 { self.covariance[i].iter().zip(gain).map(|(v, g)| v * g).sum() };
        (0..gain.len()).map(|i| gain[i] * row(i)).sum::<f64>().sqrt()
    }

    /// ln m ≈ a + 2p ln τ + ln(1 + c τ_ref/τ + bτ), linearised about the last c and b until they
    /// stand still; gives the last design, too. Steps are halved while the argument of the
    /// logarithm would fall below [`LEAST_FACTOR`].
    fn gauss_newton(&self, weighting: &Weighting, terms: Terms) -> Option<(Vec<Vec<f64>>, Fit)> {
        let regressors = terms.regressors(&self.taus);
        let mut extra = vec![0.0; regressors[0].len()];
        let mut left = GAUSS_NEWTON_STEPS;
        loop {
            let factors = factors(&regressors, &extra);
            let design: Vec<Vec<f64>> = (0..self.taus.len())
                .map(|l| {
                    let slopes = regressors[l].iter().map(|x| x / factors[l]);
                    [1.0, self.taus[l].ln()].into_iter().chain(slopes).collect()
                })
                .collect();
            let target: Vec<f64> = (0..self.taus.len())
                .map(|l| self.values[l] - factors[l].ln() + (factors[l] - 1.0) / factors[l])
                .collect();
            let fit = weighting.fit(&design, &target)?;
            let mut step: Vec<f64> =
                extra.iter().zip(&fit.parameters[2..]).map(|(old, new)| new - old).collect();
            let moved = |step: &[f64]| -> Vec<f64> {
                extra.iter().zip(step).map(|(old, step)| old + step).collect()
            };
            while self::factors(&regressors, &moved(&step))
                .iter()
                .any(|&factor| factor < LEAST_FACTOR)
            {
                step.iter_mut().for_each(|step| *step *= 0.5);
            }
            left -= 1;
            if left == 0 || step.iter().all(|step| step.abs() < STANDSTILL) {
                return Some((design, fit));
            }
            extra = moved(&step);
        }
    }

    /// Degrees of freedom of the standard error of an estimate.
    fn degrees(&self, estimate: &Estimate) -> f64 {
        bootstrap::degrees_of_freedom(self.squares, &self.levels, &estimate.gain)
    }
}

/// 1 + Σ θx at each level.
fn factors(regressors: &[Vec<f64>], extra: &[f64]) -> Vec<f64> {
    regressors
        .iter()
        .map(|row| 1.0 + row.iter().zip(extra).map(|(x, theta)| x * theta).sum::<f64>())
        .collect()
}

/// Equal variances and correlations ρ^|l − m|.
fn working_covariance(levels: usize) -> Vec<Vec<f64>> {
    let power = |l: usize, m: usize| WORKING_CORRELATION.powi(l.abs_diff(m) as i32);
    (0..levels).map(|l| (0..levels).map(|m| power(l, m)).collect()).collect()
}

/// The strong order from squared errors at several step sizes, coarsest first.
///
/// Fits ln m = a + 2p ln τ + ln(1 + bτ + c τ_ref/τ) to the mean squares m with fixed weights, and
/// gives p with an interval by the delta method from the estimated covariance of the ln m, which
/// share paths; beside it a bootstrap-t interval over whole paths, and the straight line with a
/// test whether the points lie on one. The terms with c (five levels) and b (six levels) are left
/// out when there are fewer levels; levels that a few paths dominate are left out and named. When
/// χ² is improbable, the rate carries a warning, and `order_verdict` is
/// undecided.
///
/// `None` when an error is zero, or the covariance singular: with fewer paths than levels, for
/// example.
#[must_use]
pub fn fit_strong(taus: &[f64], reference: Option<f64>, squares: &CrossMoments) -> Option<Rate> {
    let all: Vec<usize> = (0..taus.len()).collect();
    // A zero error anywhere means that there is no order to speak of, even where its level would be
    // left out.
    Logarithms::new(taus, squares, all.clone())?;
    let (reliable, few): (Vec<usize>, Vec<usize>) =
        all.iter().copied().partition(|&l| squares.effective_samples(l) >= FEW_PATHS);
    let (levels, left_out) =
        if reliable.len() < LEAST_LEVELS { (all, Vec::new()) } else { (reliable, few.clone()) };
    let conservative = left_out.len() < few.len();
    let terms = Terms::affordable(reference, levels.len());
    let logarithms = Logarithms::new(taus, squares, levels)?;
    let estimate = logarithms.fit(terms)?;
    let degrees = logarithms.degrees(&estimate);
    let half_width = student_quantile(degrees, CONFIDENCE) * estimate.se;
    let bootstrap =
        bootstrap::reach(squares, &logarithms.levels, &estimate.gain).map(|(below, above)| {
            (estimate.order - below * estimate.se, estimate.order + above * estimate.se)
        });
    let (mut lo, mut hi) = (estimate.order - half_width, estimate.order + half_width);
    if let Some((low, high)) = bootstrap.filter(|_| conservative) {
        (lo, hi) = (lo.min(low), hi.max(high));
    }
    let straight = (terms != Terms::STRAIGHT).then(|| logarithms.straight()).flatten();
    let effective =
        (0..taus.len()).map(|l| squares.effective_samples(l)).fold(f64::INFINITY, f64::min);
    let mut t = estimate.t.iter().copied();
    let reference_t = terms.reference.and_then(|_| t.next());
    let curvature_t = t.next();
    let mut rate = Rate {
        estimate: estimate.order,
        lo,
        hi,
        confidence: CONFIDENCE,
        student_degrees: Some(degrees),
        method: String::new(),
        bootstrap_lo: bootstrap.map(|(low, _)| low),
        bootstrap_hi: bootstrap.map(|(_, high)| high),
        straight,
        curvature_t,
        reference_t,
        effective_paths: Some(effective),
        left_out: left_out.iter().map(|&l| taus[l]).collect(),
        p_value: logarithms.p_value(&estimate),
        warning: conservative.then(|| {
            format!(
                "fewer than {FEW_PATHS} effective paths carry the error; the interval is the wider of two at each end"
            )
        }),
    };
    rate.method = describe(&rate, &estimate, terms, conservative);
    Some(misfit::flag(rate))
}

impl Logarithms<'_> {
    /// The straight line, refuted when χ² is beyond the 99 % quantile of Hotelling's T² with the
    /// covariance estimated from n paths: χ²(n − d)/(d(n − 1)) has the F distribution with d and n
    /// − d degrees of freedom.
    fn straight(&self) -> Option<StraightLine> {
        let estimate = self.fit(Terms::STRAIGHT)?;
        let half_width = student_quantile(self.degrees(&estimate), CONFIDENCE) * estimate.se;
        Some(StraightLine {
            estimate: estimate.order,
            lo: estimate.order - half_width,
            hi: estimate.order + half_width,
            chi_square: estimate.chi_square,
            degrees: estimate.degrees as u32,
            refuted: self.p_value(&estimate).is_some_and(|p| p < 1.0 - STRAIGHT_CONFIDENCE),
        })
    }

    /// The probability of so large a χ² by Hotelling's T²; `None` without degrees of freedom.
    fn p_value(&self, estimate: &Estimate) -> Option<f64> {
        let (n, d) = (self.squares.count() as f64, estimate.degrees as f64);
        let f = estimate.chi_square * (n - d) / (d * (n - 1.0));
        FisherSnedecor::new(d, n - d).ok().map(|distribution| distribution.sf(f))
    }
}
