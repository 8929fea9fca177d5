//! The weak order from signed errors whose covariance is known.

use std::ops::RangeInclusive;

use crate::{
    describe::describe,
    least_squares::{Weighting, diagonal},
    moments::CrossMoments,
    point::Point,
    quantile::{CONFIDENCE, chi_square_p_value, two_sided},
    rate::{Against, Model, Rate},
};

/// Orders among which the weak order is looked for: 0 to 4, on a grid of 1/500.
const ORDERS: RangeInclusive<u32> = 0..=4 * GRID;
const GRID: u32 = 500;
/// Errors that are nowhere this many standard errors away from zero are inside the noise.
pub const NOISE: f64 = 4.0;

/// The weak order from signed errors at several step sizes with their covariance, coarsest first.
///
/// e(τ) = Aτᵖ + Bτ^{p+1} (+ Cτ^{p+2} from seven levels on) is fitted by generalised least squares
/// for every p on a grid, each power less that of the step that the error is measured against
/// ([`Against`]). The estimate minimises χ², the interval is where χ² is at most its minimum plus
/// the χ²₁ quantile: a profile likelihood. Signed errors are used, so a change of sign needs no
/// special case. An order whose leading term is not the largest at the finest step is no candidate:
/// it would pass off a small remainder as the leading term. If χ² rejects the model, the rate
/// carries a warning ([`Rate::misfits`]).
///
/// `None` if no error stands out of the noise, if there are fewer than four levels, or if the
/// covariance is singular.
pub fn fit_weak(
    taus: &[f64],
    errors: &[f64],
    covariance: &[Vec<f64>],
    against: Against,
) -> Option<Rate> {
    let levels = taus.len();
    let visible = (0..levels).any(|l| errors[l].abs() > NOISE * covariance[l][l].sqrt());
    if levels < 4 || !visible {
        return None;
    }
    let terms = if levels >= 7 { 3 } else { 2 };
    let (coarsest, finest) = (taus[0], taus[levels - 1]);
    let weighting = Weighting::new(covariance)?;
    let mut profile = Vec::new();
    for p in ORDERS.map(|i| f64::from(i) / f64::from(GRID)) {
        let powers = (0..terms).map(|term| p + f64::from(term));
        let column = |q| taus.iter().map(|&tau| against.power(tau, coarsest, q)).collect();
        let design: Vec<Vec<f64>> = powers.clone().map(column).collect();
        // With p = 0 against another step there is nothing to fit: a constant has no difference.
        let Some(fit) = weighting.fit(&design, errors) else {
            continue;
        };
        // What the terms contribute at the finest step to what was measured. The term of an error
        // that hardly changes from step to step, p ≈ 0, is large in the error and nothing in a
        // difference.
        let size =
            |(q, parameter): (f64, &f64)| (parameter * against.power(finest, coarsest, q)).abs();
        let mut sizes = powers.zip(&fit.parameters).map(size);
        if sizes.next()? > sizes.sum() {
            profile.push((p, fit.chi_square));
        }
    }
    let (estimate, least) = profile.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let allowed = least + two_sided(CONFIDENCE, None).powi(2);
    let mut inside = profile.iter().filter(|(_, chi)| *chi <= allowed).map(|(p, _)| *p);
    let lo = inside.next()?;
    let degrees = levels - terms as usize - 1;
    Some(describe(Rate {
        estimate,
        lo,
        hi: inside.next_back().unwrap_or(lo),
        confidence: CONFIDENCE,
        model: Model::Powers { against, terms },
        chi_square: least,
        degrees,
        p_value: chi_square_p_value(least, degrees),
        ..Rate::default()
    }))
}

/// How much of the error at the finest step terms of order below `order` may be, at most: the upper
/// end of a 95 % interval, with e = A₁τ + A₂τ² + … fitted by generalised least squares, as errors
/// or differences ([`Against`]). `None` if there are too few levels or the covariance is singular.
///
/// A small term of low order wins as τ → 0, however well a higher order fits here.
pub fn lower_share(
    taus: &[f64],
    errors: &[f64],
    covariance: &[Vec<f64>],
    order: u32,
    against: Against,
) -> Option<f64> {
    let (coarsest, finest) = (taus[0], taus[taus.len() - 1]);
    let powers = || (1..=order + 1).map(f64::from);
    if powers().count() > taus.len() {
        return None;
    }
    let column = |q| taus.iter().map(|&tau| against.power(tau, coarsest, q)).collect();
    let design: Vec<Vec<f64>> = powers().map(column).collect();
    let weighting = Weighting::new(covariance)?;
    let fit = weighting.fit(&design, errors)?;
    let quantile = two_sided(CONFIDENCE, None);
    let term = |(c, q): (usize, f64)| {
        let largest = fit.parameters[c].abs() + quantile * fit.covariance(c)[c].sqrt();
        largest * against.power(finest, coarsest, q).abs()
    };
    let lower = powers().enumerate().take(order as usize - 1).map(term).sum::<f64>();
    Some(lower / errors[errors.len() - 1].abs())
}

impl Against {
    /// What τ^q contributes to the error measured at step τ, with all steps in units of `unit`.
    fn power(self, tau: f64, unit: f64, q: f64) -> f64 {
        let e = |tau: f64| (tau / unit).powf(q);
        match self {
            Self::Exact => e(tau),
            Self::HalfStep => e(tau) - e(0.5 * tau),
        }
    }
}

/// Weak errors and their order from independent differences d_l = e(τ_l) − e(τ_l/2) at step sizes
/// that halve, coarsest first: component `index` of the moments.
///
/// The errors are the sums e_l = Σ_{j ≥ l} d_j with a Richardson tail: below the finest step L, an
/// error Cτ + O(τ²) leaves d_L once more, up to O(τ²). The order is fitted to the differences,
/// without the tail.
pub fn weak_errors(
    taus: &[f64],
    differences: &[CrossMoments],
    index: usize,
) -> (Vec<Point>, Option<Rate>) {
    let means: Vec<f64> = differences.iter().map(|d| d.mean(index)).collect();
    let variances: Vec<f64> =
        differences.iter().map(|d| d.covariance_of_means(index, index)).collect();
    let finest = taus.len() - 1;
    let point = |l: usize| {
        let error = means[l..finest].iter().sum::<f64>() + 2.0 * means[finest];
        let variance = variances[l..finest].iter().sum::<f64>() + 4.0 * variances[finest];
        Point::normal(taus[l], error, variance.sqrt())
    };
    let rate = fit_weak(taus, &means, &diagonal(&variances), Against::HalfStep);
    ((0..taus.len()).map(point).collect(), rate)
}
