//! Convergence orders with intervals, and when an order is said to hold.

use mc::CrossMoments;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::least_squares::{Fit, fit};
use crate::results::{Rate, Verdict};

/// Confidence of the reported intervals.
const CONFIDENCE: f64 = 0.95;
/// Confidence at which verdicts are given: one run gives some thirty verdicts, and a false alarm fails it.
const VERDICT_CONFIDENCE: f64 = 0.999;
/// Orders are multiples of ½; this is half the distance between neighbours.
pub const ORDER_MARGIN: f64 = 0.25;

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
    let mut profile = Vec::new();
    for p in WEAK_ORDERS.map(|i| f64::from(i) / f64::from(WEAK_GRID)) {
        let row = |tau: f64| (0..terms).map(|term| (tau / coarsest).powf(p + f64::from(term))).collect();
        let design: Vec<Vec<f64>> = taus.iter().map(|&tau| row(tau)).collect();
        let Fit { parameters, chi_square, .. } = fit(&design, errors, covariance)?;
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
    })
}

/// Whether a fitted order is `order`.
///
/// The interval is widened about its estimate from [`Rate::confidence`] to 99.9 %. The order holds when the widened
/// interval contains it and lies within [`ORDER_MARGIN`] of it, so that no other multiple of ½ is as near; it is
/// refuted when the widened interval lies farther away than that; anything else, or no fit, is undecided.
#[must_use]
pub fn order_verdict(rate: Option<&Rate>, order: f64) -> Verdict {
    let Some(rate) = rate else { return Verdict::Undecided };
    let widening = quantile(VERDICT_CONFIDENCE) / quantile(rate.confidence);
    let lo = rate.estimate - widening * (rate.estimate - rate.lo);
    let hi = rate.estimate + widening * (rate.hi - rate.estimate);
    if lo > order + ORDER_MARGIN || hi < order - ORDER_MARGIN {
        Verdict::Refuted
    } else if lo <= order && order <= hi && lo > order - ORDER_MARGIN && hi < order + ORDER_MARGIN {
        Verdict::Holds
    } else {
        Verdict::Undecided
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use noise::{StreamKey, WienerPath};

    const TAUS: [f64; 8] =
        [0.03125, 0.015625, 0.0078125, 0.00390625, 0.001953125, 0.0009765625, 0.00048828125, 0.000244140625];

    /// Squared errors C τ^{2p}(1 + τ)(1 − c τ_ref/τ) Z² of 400 paths; Z is normal, half shared between the levels.
    fn synthetic(seed: u64, order: f64, reference: Option<f64>) -> CrossMoments {
        let mut squares = CrossMoments::new(TAUS.len());
        for path in 0..400 {
            let mut noise = WienerPath::<1>::new(StreamKey { seed, experiment: 1 }, path);
            let shared = noise.normal();
            let errors: Vec<f64> = TAUS
                .iter()
                .map(|tau| {
                    let z = (shared + noise.normal()) / 2f64.sqrt();
                    let near_reference = 1.0 - reference.map_or(0.0, |reference| reference / tau);
                    tau.powf(2.0 * order) * (1.0 + tau) * near_reference * z * z
                })
                .collect();
            squares.add(&errors);
        }
        squares
    }

    #[test]
    fn strong_intervals_cover_the_order() {
        // 95 % intervals on 200 data sets: 190 expected; fewer than 176 or 200 of 200 has probability below 1e-4.
        for (order, reference) in [(0.5, None), (1.0, None), (0.5, Some(TAUS[7] / 4.0))] {
            let covered = (0..200)
                .filter(|&seed| {
                    let rate = fit_strong(&TAUS, reference, &synthetic(seed, order, reference)).unwrap();
                    rate.lo <= order && order <= rate.hi
                })
                .count();
            assert!((176..200).contains(&covered), "order {order}, reference {reference:?}: {covered} of 200");
        }
    }

    #[test]
    fn forgetting_the_reference_biases_the_order() {
        // The twin: the same data without the reference term.
        let reference = Some(TAUS[7] / 2.0);
        let covered = (0..50)
            .filter(|&seed| {
                let rate = fit_strong(&TAUS, None, &synthetic(seed, 0.5, reference)).unwrap();
                rate.lo <= 0.5 && 0.5 <= rate.hi
            })
            .count();
        assert!(covered < 40, "{covered} of 50");
    }

    #[test]
    fn wrong_orders_are_refuted_and_wide_intervals_undecided() {
        let rate = fit_strong(&TAUS, None, &synthetic(1, 0.5, None)).unwrap();
        assert_eq!(order_verdict(Some(&rate), 0.5), Verdict::Holds);
        assert_eq!(order_verdict(Some(&rate), 1.0), Verdict::Refuted);
        let wide = Rate { lo: 0.1, hi: 0.9, ..rate.clone() };
        assert_eq!(order_verdict(Some(&wide), 0.5), Verdict::Undecided);
        // Precise, near the order, and yet not it.
        let off = Rate { estimate: 0.55, lo: 0.54, hi: 0.56, ..rate };
        assert_eq!(order_verdict(Some(&off), 0.5), Verdict::Undecided);
        assert_eq!(order_verdict(None, 0.5), Verdict::Undecided);
    }

    #[test]
    fn zero_errors_and_too_few_paths_name_no_order() {
        let mut exact = CrossMoments::new(8);
        let mut few = CrossMoments::new(8);
        for path in 0..5 {
            exact.add(&[0.0; 8]);
            few.add(&TAUS.map(|tau| tau * (1.0 + f64::from(path) * tau)));
        }
        assert!(fit_strong(&TAUS, None, &exact).is_none());
        assert!(fit_strong(&TAUS, None, &few).is_none());
    }

    /// Errors Aτᵖ + Bτ^{p+1} with noise proportional to τ, half of it shared.
    fn weak(seed: u64, p: f64, a: f64, b: f64, noise_size: f64) -> (Vec<f64>, Vec<Vec<f64>>) {
        let mut noise = WienerPath::<1>::new(StreamKey { seed, experiment: 2 }, 0);
        let shared = noise.normal();
        let errors = TAUS
            .iter()
            .map(|&tau| {
                let scatter = (shared + noise.normal()) / 2f64.sqrt();
                a * tau.powf(p) + b * tau.powf(p + 1.0) + noise_size * tau * scatter
            })
            .collect();
        let covariance = (0..8)
            .map(|l| {
                (0..8).map(|m| noise_size * noise_size * TAUS[l] * TAUS[m] * if l == m { 1.0 } else { 0.5 }).collect()
            })
            .collect();
        (errors, covariance)
    }

    #[test]
    fn weak_intervals_cover_the_order_through_a_change_of_sign() {
        // B = −40 makes the error change its sign at τ = 1/40, between the first two step sizes.
        for b in [1.0, -40.0] {
            let covered = (0..200)
                .filter(|&seed| {
                    let (errors, covariance) = weak(seed, 1.0, 1.0, b, 0.02);
                    let rate = fit_weak(&TAUS, &errors, &covariance).unwrap();
                    rate.lo <= 1.0 && 1.0 <= rate.hi
                })
                .count();
            assert!((176..200).contains(&covered), "{b}: {covered} of 200");
        }
    }

    #[test]
    fn an_error_inside_the_noise_has_no_order() {
        let (errors, covariance) = weak(3, 1.0, 1e-3, 0.0, 1.0);
        assert!(fit_weak(&TAUS, &errors, &covariance).is_none());
        // A constant bias is no convergence: the order is far from one.
        let (errors, covariance) = weak(4, 0.0, 1.0, 0.0, 0.02);
        let rate = fit_weak(&TAUS, &errors, &covariance);
        assert_eq!(order_verdict(rate.as_ref(), 1.0), Verdict::Refuted);
    }
}
