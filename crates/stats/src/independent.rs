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

#[cfg(test)]
mod tests {
    use super::*;

    const TAUS: [f64; 6] = [0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625];

    /// ln e = ¼ + 1.5 ln τ + 0.3τ − 0.7τ² with relative errors `se`.
    fn values(se: f64) -> Vec<(f64, f64)> {
        let error = |tau: f64| (0.25 + 1.5 * tau.ln() + 0.3 * tau - 0.7 * tau * tau).exp();
        TAUS.iter().map(|&tau| (error(tau), se * error(tau))).collect()
    }

    #[test]
    fn the_order_behind_two_more_terms_is_recovered() {
        let rate = fit_independent(&TAUS, &values(1e-3)).unwrap();
        assert!((rate.estimate - 1.5).abs() < 1e-9 && rate.chi_square < 1e-9, "{rate:?}");
        assert_eq!((rate.degrees, rate.confidence, rate.model), (2, 0.95, Model::Logarithms));
        assert!(rate.p_value.unwrap() > 0.999 && rate.method.starts_with("weighted least squares"));
        assert!(fit_independent(&TAUS[..5], &values(1e-3)[..5]).is_some());
        assert!(fit_independent(&TAUS[..4], &values(1e-3)[..4]).is_none());
    }

    #[test]
    fn the_interval_is_that_of_a_linear_estimate() {
        // p = Σ g ln e: the weights g by moving one value at a time, with equal relative errors.
        let (se, shift) = (1e-3, 1e-2f64);
        let estimate = |values: &[(f64, f64)]| fit_independent(&TAUS, values).unwrap().estimate;
        let square = |l: usize| {
            let mut moved = values(se);
            moved[l] = (moved[l].0 * shift.exp(), moved[l].1 * shift.exp());
            ((estimate(&moved) - 1.5) / shift).powi(2)
        };
        let exact = 1.959_963_984_540_054 * se * (0..6).map(square).sum::<f64>().sqrt();
        let rate = fit_independent(&TAUS, &values(se)).unwrap();
        for half_width in [rate.hi - rate.estimate, rate.estimate - rate.lo] {
            assert!((half_width / exact - 1.0).abs() < 1e-6, "{half_width} {exact}");
        }
        // A residual as large as the model leaves it: χ² with two degrees of freedom has the
        // probability exp(−χ²/2).
        let mut moved = values(se);
        moved[3].0 *= 1.002;
        let rate = fit_independent(&TAUS, &moved).unwrap();
        assert!(rate.chi_square > 0.5, "{rate:?}");
        assert!((rate.p_value.unwrap() - (-0.5 * rate.chi_square).exp()).abs() < 1e-9);
    }

    #[test]
    fn values_inside_their_noise_have_no_order() {
        // Four standard errors are inside the noise, and a little more is not.
        let with = |value: (f64, f64)| {
            let mut values = values(0.2);
            values[2] = value;
            fit_independent(&TAUS, &values)
        };
        assert!(with((1.0, 0.25)).is_none() && with((1.0, 0.249)).is_some());
        assert!(with((0.0, 0.0)).is_none() && with((f64::NAN, 0.1)).is_none());
    }
}
