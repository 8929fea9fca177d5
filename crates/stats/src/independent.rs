//! The order of a positive error measured independently at several step sizes.

use crate::{
    describe::describe,
    least_squares::{Weighting, diagonal},
    quantile::{CONFIDENCE, chi_square_p_value, two_sided},
    rate::{Model, Rate},
    weak::NOISE,
};

/// The order of a positive error known at several step sizes from independent samples, as (value,
/// standard error): ln e = a + p ln τ + bτ + cτ² by weighted least squares, with the variances of
/// the logarithms by the delta method. `None` if a value is zero or inside its noise, or with fewer
/// than five step sizes.
pub fn fit_independent(taus: &[f64], values: &[(f64, f64)]) -> Option<Rate> {
    let levels = taus.len();
    if levels < 5 || values.iter().any(|&(value, se)| value.is_nan() || value <= NOISE * se) {
        return None;
    }
    let column = |regressor: fn(f64, f64) -> f64| -> Vec<f64> {
        taus.iter().map(|&tau| regressor(tau, taus[0])).collect()
    };
    let design = [
        column(|_, _| 1.0),
        column(|tau, _| tau.ln()),
        column(|tau, unit| tau / unit),
        column(|tau, unit| (tau / unit).powi(2)),
    ];
    let logarithms: Vec<f64> = values.iter().map(|(value, _)| value.ln()).collect();
    let variances: Vec<f64> = values.iter().map(|(value, se)| (se / value).powi(2)).collect();
    let weighting = Weighting::new(&diagonal(&variances))?;
    let fit = weighting.fit(&design, &logarithms)?;
    let estimate = fit.parameters[1];
    let half_width = two_sided(CONFIDENCE, None) * fit.covariance(1)[1].sqrt();
    Some(describe(Rate {
        estimate,
        lo: estimate - half_width,
        hi: estimate + half_width,
        confidence: CONFIDENCE,
        model: Model::Logarithms,
        chi_square: fit.chi_square,
        degrees: levels - 4,
        p_value: chi_square_p_value(fit.chi_square, levels - 4),
        ..Rate::default()
    }))
}
