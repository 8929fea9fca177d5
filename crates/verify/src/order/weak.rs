//! The order of errors whose covariance is known.

use super::{CONFIDENCE, quantile};
use crate::least_squares::{Fit, Weighting, fit};
use crate::results::Rate;

/// The order of a positive error known at several step sizes from independent samples, as (value, standard error):
/// ln value = a + p ln τ + bτ + cτ² by weighted least squares. `None` when a value is zero or inside its noise, or
/// with fewer than five step sizes.
pub(crate) fn fit_independent(taus: &[f64], values: &[(f64, f64)]) -> Option<Rate> {
    let levels = taus.len();
    if levels < 5 || values.iter().any(|&(value, se)| value.is_nan() || value <= NOISE * se) {
        return None;
    }
    let design: Vec<Vec<f64>> =
        taus.iter().map(|&tau| vec![1.0, tau.ln(), tau / taus[0], (tau / taus[0]).powi(2)]).collect();
    let logarithms: Vec<f64> = values.iter().map(|(value, _)| value.ln()).collect();
    let covariance: Vec<Vec<f64>> = (0..levels)
        .map(|l| (0..levels).map(|m| if l == m { (values[l].1 / values[l].0).powi(2) } else { 0.0 }).collect())
        .collect();
    let Fit { parameters, covariance, chi_square } = fit(&design, &logarithms, &covariance)?;
    let half_width = quantile(CONFIDENCE) * covariance[1][1].sqrt();
    Some(Rate {
        estimate: parameters[1],
        lo: parameters[1] - half_width,
        hi: parameters[1] + half_width,
        confidence: CONFIDENCE,
        method: format!(
            "weighted least squares, ln error = a + p ln τ + bτ + cτ², χ² = {chi_square:.1} with {} degrees of freedom",
            levels - 4
        ),
        ..Rate::default()
    })
}

/// Orders among which the weak order is looked for, on a grid of 1/500.
const WEAK_ORDERS: std::ops::RangeInclusive<u32> = 0..=4 * WEAK_GRID;
const WEAK_GRID: u32 = 500;
/// Errors that are nowhere this many standard errors away from zero are inside the noise.
const NOISE: f64 = 4.0;

/// The weak order from signed errors at several step sizes with their covariance, coarsest first.
///
/// e(τ) = Aτᵖ + Bτ^{p+1} (+ Cτ^{p+2} from seven levels on) is fitted by generalised least squares for every p on a
/// grid; the estimate minimises χ², the interval is where χ² is at most its minimum plus the χ²₁ quantile. Signed
/// errors are used, so a change of sign needs no special case. An order whose leading term is not the largest at
/// the finest step is no candidate: it would pass off a small remainder as the leading term. `None` when no error
/// stands out of the noise, when there are fewer than four levels, or when the covariance is singular.
#[must_use]
pub fn fit_weak(taus: &[f64], errors: &[f64], covariance: &[Vec<f64>]) -> Option<Rate> {
    let levels = taus.len();
    let visible = (0..levels).any(|l| errors[l].abs() > NOISE * covariance[l][l].sqrt());
    if levels < 4 || !visible {
        return None;
    }
    let terms = if levels >= 7 { 3 } else { 2 };
    let (coarsest, finest) = (taus[0], taus[levels - 1]);
    let weighting = Weighting::new(covariance)?;
    let mut profile = Vec::new();
    for p in WEAK_ORDERS.map(|i| f64::from(i) / f64::from(WEAK_GRID)) {
        let row = |tau: f64| {
            let leading = (tau / coarsest).powf(p);
            (0..terms).map(|term| leading * (tau / coarsest).powi(term)).collect()
        };
        let design: Vec<Vec<f64>> = taus.iter().map(|&tau| row(tau)).collect();
        let Fit { parameters, chi_square, .. } = weighting.fit(&design, errors)?;
        let weights: Vec<f64> = row(finest);
        let rest: f64 = (1..parameters.len()).map(|term| (parameters[term] * weights[term]).abs()).sum();
        if (parameters[0] * weights[0]).abs() > rest {
            profile.push((p, chi_square));
        }
    }
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
            "profile of generalised least squares, error = Aτ^p + Bτ^(p+1){}, χ² = {least:.1} with {} degrees of freedom",
            if terms == 3 { " + Cτ^(p+2)" } else { "" },
            levels - terms as usize - 1
        ),
        ..Rate::default()
    })
}
