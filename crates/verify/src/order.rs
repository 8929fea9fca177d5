//! Convergence orders with intervals, and when an order is said to hold.

use mc::CrossMoments;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::least_squares::{Fit, fit};
use crate::results::{Rate, Verdict};

/// Confidence of the reported intervals.
const CONFIDENCE: f64 = 0.95;
/// Confidence at which verdicts are given: one run gives some thirty verdicts, and a false alarm fails it.
const VERDICT_CONFIDENCE: f64 = 0.999;
/// Orders are multiples of ½. An order is said to hold when the whole interval lies within this distance of it.
pub const ORDER_MARGIN: f64 = 0.1;

/// Two-sided quantile of the standard normal distribution.
fn quantile(confidence: f64) -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * confidence)
}

/// The strong order from squared errors at several step sizes, coarsest first.
///
/// With m_l the mean squares, ln m = a + 2p ln τ + bτ + c τ_ref/τ is fitted by generalised least squares with the
/// estimated covariance of the ln m_l, which share paths. The term bτ is the next order of the error; c τ_ref/τ is the
/// error of the reference, present when it is a run at step `reference` (for an order-½ scheme against itself the
/// squared error is C(τ − τ_ref), so c = −1). Terms are left out when there are fewer than two levels more than
/// parameters. `None` when an error is zero, or the covariance singular: with fewer paths than levels, for example.
#[must_use]
pub fn fit_strong(taus: &[f64], reference: Option<f64>, squares: &CrossMoments) -> Option<Rate> {
    let levels = taus.len();
    let means: Vec<f64> = (0..levels).map(|l| squares.mean(l)).collect();
    if means.iter().any(|mean| !(mean.is_finite() && *mean > 0.0)) {
        return None;
    }
    let logarithms: Vec<f64> = means.iter().map(|mean| mean.ln()).collect();
    let covariance: Vec<Vec<f64>> = (0..levels)
        .map(|l| (0..levels).map(|m| squares.covariance_of_means(l, m) / (means[l] * means[m])).collect())
        .collect();
    let coarsest = taus[0];
    let with_reference = reference.filter(|_| levels >= 5);
    let with_curvature = levels >= 6;
    let design: Vec<Vec<f64>> = taus
        .iter()
        .map(|&tau| {
            let mut row = vec![1.0, tau.ln()];
            row.extend(with_reference.map(|reference| reference / tau));
            if with_curvature {
                row.push(tau / coarsest);
            }
            row
        })
        .collect();
    let Fit { parameters, covariance, chi_square } = fit(&design, &logarithms, &covariance)?;
    let estimate = 0.5 * parameters[1];
    let half_width = quantile(CONFIDENCE) * 0.5 * covariance[1][1].sqrt();
    Some(Rate {
        estimate,
        lo: estimate - half_width,
        hi: estimate + half_width,
        confidence: CONFIDENCE,
        method: format!(
            "generalised least squares, ln mean square = a + 2p ln τ{}{}, χ² = {chi_square:.1} with {} degrees of freedom",
            if with_curvature { " + bτ" } else { "" },
            if with_reference.is_some() { " + c τ_ref/τ" } else { "" },
            levels - parameters.len(),
        ),
    })
}

/// Orders among which the weak order is looked for.
const WEAK_ORDERS: std::ops::RangeInclusive<u32> = 0..=4 * WEAK_GRID;
/// Grid points for one unit of order.
const WEAK_GRID: u32 = 500;
/// Errors that are nowhere this many standard errors away from zero are inside the noise.
const NOISE: f64 = 4.0;

/// The weak order from signed errors at several step sizes with their covariance.
///
/// e(τ) = Aτᵖ + Bτ^{p+1} is fitted by generalised least squares for every p on a grid; the estimate minimises χ², the
/// interval is where χ² is at most its minimum plus the χ²₁ quantile. Signed errors are used, so a change of sign
/// needs no special case. `None` when no error stands out of the noise, when there are fewer than four levels, or
/// when the covariance is singular.
#[must_use]
pub fn fit_weak(taus: &[f64], errors: &[f64], covariance: &[Vec<f64>]) -> Option<Rate> {
    let levels = taus.len();
    let visible = (0..levels).any(|l| errors[l].abs() > NOISE * covariance[l][l].sqrt());
    if levels < 4 || !visible {
        return None;
    }
    let coarsest = taus[0];
    let profile: Vec<(f64, f64)> = WEAK_ORDERS
        .map(|i| f64::from(i) / f64::from(WEAK_GRID))
        .map(|p| {
            let row = |tau: f64| vec![(tau / coarsest).powf(p), (tau / coarsest).powf(p + 1.0)];
            let design: Vec<Vec<f64>> = taus.iter().map(|&tau| row(tau)).collect();
            fit(&design, errors, covariance).map(|fit| (p, fit.chi_square))
        })
        .collect::<Option<_>>()?;
    let (estimate, least) = profile.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let allowed = least + quantile(CONFIDENCE).powi(2);
    let mut inside = profile.iter().filter(|(_, chi_square)| *chi_square <= allowed).map(|(p, _)| *p);
    let lo = inside.next()?;
    let hi = inside.next_back().unwrap_or(lo);
    Some(Rate {
        estimate,
        lo,
        hi,
        confidence: CONFIDENCE,
        method: format!(
            "profile of generalised least squares, error = Aτ^p + Bτ^(p+1), χ² = {least:.1} with {} degrees of freedom",
            levels - 3
        ),
    })
}

/// Whether a fitted order is `order`.
///
/// The interval is widened about its estimate from [`Rate::confidence`] to 99.9 %. The order holds when the widened
/// interval lies within [`ORDER_MARGIN`] of it, is refuted when the two are disjoint, and is undecided otherwise or
/// without a fit.
#[must_use]
pub fn order_verdict(rate: Option<&Rate>, order: f64) -> Verdict {
    let Some(rate) = rate else { return Verdict::Undecided };
    let widening = quantile(VERDICT_CONFIDENCE) / quantile(rate.confidence);
    let lo = rate.estimate - widening * (rate.estimate - rate.lo);
    let hi = rate.estimate + widening * (rate.hi - rate.estimate);
    if lo > order + ORDER_MARGIN || hi < order - ORDER_MARGIN {
        Verdict::Refuted
    } else if lo >= order - ORDER_MARGIN && hi <= order + ORDER_MARGIN {
        Verdict::Holds
    } else {
        Verdict::Undecided
    }
}
