//! The order of errors whose covariance is known.

use super::{CONFIDENCE, misfit, normal_quantile};
use crate::Rate;
use crate::least_squares::{Fit, Weighting, fit};

/// The order of a positive error known at several step sizes from independent samples, as (value,
/// standard error): ln value = a + p ln τ + bτ + cτ² by weighted least squares. `None` when a value
/// is zero or inside its noise, or with fewer than five step sizes.
pub fn fit_independent(taus: &[f64], values: &[(f64, f64)]) -> Option<Rate> {
    let levels = taus.len();
    if levels < 5 || values.iter().any(|&(value, se)| value.is_nan() || value <= NOISE * se) {
        return None;
    }
    let design: Vec<Vec<f64>> = taus
        .iter()
        .map(|&tau| vec![1.0, tau.ln(), tau / taus[0], (tau / taus[0]).powi(2)])
        .collect();
    let logarithms: Vec<f64> = values.iter().map(|(value, _)| value.ln()).collect();
    let covariance: Vec<Vec<f64>> = (0..levels)
        .map(|l| {
            (0..levels)
                .map(|m| if l == m { (values[l].1 / values[l].0).powi(2) } else { 0.0 })
                .collect()
        })
        .collect();
    let Fit { parameters, covariance, chi_square } = fit(&design, &logarithms, &covariance)?;
    let half_width = normal_quantile(CONFIDENCE) * covariance[1][1].sqrt();
    Some(misfit::flag(Rate {
        estimate: parameters[1],
        lo: parameters[1] - half_width,
        hi: parameters[1] + half_width,
        confidence: CONFIDENCE,
        method: format!(
            "weighted least squares, ln error = a + p ln τ + bτ + cτ², χ² = {chi_square:.1} with {} degrees of freedom",
            levels - 4
        ),
        p_value: misfit::probability(chi_square, levels - 4),
        ..Rate::default()
    }))
}

/// Orders among which the weak order is looked for, on a grid of 1/500.
const WEAK_ORDERS: std::ops::RangeInclusive<u32> = 0..=4 * WEAK_GRID;
const WEAK_GRID: u32 = 500;
/// Errors that are nowhere this many standard errors away from zero are inside the noise.
const NOISE: f64 = 4.0;

/// The weak order from signed errors at several step sizes with their covariance, coarsest first.
///
/// e(τ) = Aτᵖ + Bτ^{p+1} (+ Cτ^{p+2} from seven levels on) is fitted by generalised least squares
/// for every p on a grid; the estimate minimises χ², the interval is where χ² is at most its
/// minimum plus the χ²₁ quantile. Signed errors are used, so a change of sign needs no special
/// case. An order whose leading term is not the largest at the finest step is no candidate: it
/// would pass off a small remainder as the leading term. When χ² is improbable, the rate carries a
/// warning, and `order_verdict` is undecided. `None` when no error stands
/// out of the noise, when there are fewer than four levels, or when the covariance is singular.
///
/// The errors are against the exact solution. Where they are against a finer step of the same
/// scheme, its error is part of the model: see [`fit_weak_differences`].
#[must_use]
pub fn fit_weak(taus: &[f64], errors: &[f64], covariance: &[Vec<f64>]) -> Option<Rate> {
    profile(taus, errors, covariance, &Against::Exact)
}

/// The weak order from differences e(τ) − e(τ/2) of signed errors at neighbouring step sizes,
/// coarsest first.
///
/// As [`fit_weak`], with the model A(1 − 2^{−p})τᵖ + B(1 − 2^{−(p+1)})τ^{p+1} + …: nothing is
/// assumed about what is left below the finest step. A bias that is the same at all step sizes
/// leaves no trace in differences; they say how fast a scheme converges, and not whether to the
/// right limit.
#[must_use]
pub fn fit_weak_differences(
    taus: &[f64],
    differences: &[f64],
    covariance: &[Vec<f64>],
) -> Option<Rate> {
    profile(taus, differences, covariance, &Against::Half)
}

/// The weak order from errors against the same scheme with the step `reference`, e(τ) − e(τ_ref).
///
/// As [`fit_weak`], with the model A(τᵖ − τ_refᵖ) + B(τ^{p+1} − τ_ref^{p+1}) + ….
pub fn fit_weak_against(
    taus: &[f64],
    reference: f64,
    errors: &[f64],
    covariance: &[Vec<f64>],
) -> Option<Rate> {
    profile(taus, errors, covariance, &Against::Step(reference))
}

/// What a measured value is the error against.
enum Against {
    /// The exact solution.
    Exact,
    /// The same scheme with half the step.
    Half,
    /// The same scheme with this step.
    Step(f64),
}

impl Against {
    /// What τ^q contributes to the value measured at step τ, with all steps in units of `unit`.
    fn power(&self, tau: f64, unit: f64, q: f64) -> f64 {
        let reference = match *self {
            Self::Exact => return (tau / unit).powf(q),
            Self::Half => 0.5 * tau,
            Self::Step(step) => step,
        };
        (tau / unit).powf(q) - (reference / unit).powf(q)
    }

    fn describe(&self) -> &'static str {
        match self {
            Self::Exact => "error",
            Self::Half => "differences e(τ) − e(τ/2) of an error",
            Self::Step(_) => "e(τ) − e(τ_ref) of an error",
        }
    }
}

fn profile(
    taus: &[f64],
    values: &[f64],
    covariance: &[Vec<f64>],
    against: &Against,
) -> Option<Rate> {
    let levels = taus.len();
    let visible = (0..levels).any(|l| values[l].abs() > NOISE * covariance[l][l].sqrt());
    if levels < 4 || !visible {
        return None;
    }
    let terms = if levels >= 7 { 3 } else { 2 };
    let (coarsest, finest) = (taus[0], taus[levels - 1]);
    let weighting = Weighting::new(covariance)?;
    let mut profile = Vec::new();
    for p in WEAK_ORDERS.map(|i| f64::from(i) / f64::from(WEAK_GRID)) {
        let powers = (0..terms).map(|term| p + f64::from(term));
        let row = |&tau: &f64| powers.clone().map(|q| against.power(tau, coarsest, q)).collect();
        let design: Vec<Vec<f64>> = taus.iter().map(row).collect();
        // A constant error has no difference to one at another step: with p = 0 there is nothing to
        // fit.
        let Some(Fit { parameters, chi_square, .. }) = weighting.fit(&design, values) else {
            continue;
        };
        // What the terms contribute at the finest step. Of differences it is the contribution to
        // the difference that counts: the term of an error that hardly changes from step to step, p
        // ≈ 0, would be large in the error and is nothing that was measured.
        let size =
            |(q, parameter): (f64, &f64)| (parameter * against.power(finest, coarsest, q)).abs();
        let mut sizes = powers.zip(&parameters).map(size);
        if sizes.next()? > sizes.sum() {
            profile.push((p, chi_square));
        }
    }
    let (estimate, least) = profile.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let allowed = least + normal_quantile(CONFIDENCE).powi(2);
    let mut inside =
        profile.iter().filter(|(_, chi_square)| *chi_square <= allowed).map(|(p, _)| *p);
    let lo = inside.next()?;
    let hi = inside.next_back().unwrap_or(lo);
    let degrees = levels - terms as usize - 1;
    Some(misfit::flag(Rate {
        estimate,
        lo,
        hi,
        confidence: CONFIDENCE,
        method: format!(
            "profile of generalised least squares, {} = Aτ^p + Bτ^(p+1){}, χ² = {least:.1} with {degrees} degrees of freedom",
            against.describe(),
            if terms == 3 { " + Cτ^(p+2)" } else { "" },
        ),
        p_value: misfit::probability(least, degrees),
        ..Rate::default()
    }))
}
