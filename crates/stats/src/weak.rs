//! The weak order from signed errors whose covariance is known.

use real::elementary;

use crate::{
    least_squares::{Weighting, diagonal},
    moments::CrossMoments,
    point::Point,
    quantile::{CONFIDENCE, chi_square_p_value, two_sided},
    rate::{Against, Expansion, Rate},
};

/// Candidates for the weak order: up to 4, on a grid of 1/500.
const GRID: u32 = 500;
const HIGHEST: u32 = 4 * GRID;
/// Number of standard errors from zero that an error must reach somewhere to be outside the noise.
const NOISE: f64 = 4.0;

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
/// In even powers (`expansion`) an order below one is no candidate: the power two above it would be
/// taken for the leading one.
///
/// `None` if no error stands out of the noise, if there are fewer than four levels, or if the
/// covariance is singular.
pub fn fit_weak(
    taus: &[f64],
    errors: &[f64],
    covariance: &[Vec<f64>],
    against: Against,
    expansion: Expansion,
) -> Option<Rate> {
    let levels = taus.len();
    let visible = (0..levels).any(|l| errors[l].abs() > NOISE * covariance[l][l].sqrt());
    if levels < 4 || !visible {
        return None;
    }
    let terms = if levels >= 7 { 3 } else { 2 };
    let (coarsest, finest) = (taus[0], taus[levels - 1]);
    let weighting = Weighting::new(covariance)?;
    let lowest = match expansion {
        Expansion::EveryPower => 0,
        Expansion::EvenPowers => GRID,
    };
    let candidate = |i: u32| {
        let p = f64::from(i) / f64::from(GRID);
        let powers = (0..terms).map(|term| p + expansion.step() * f64::from(term));
        // With p = 0 against another step there is nothing to fit: a constant has no difference.
        let fit = weighting.fit(&against.design(taus, powers.clone()), errors)?;
        // What the terms contribute at the finest step to what was measured. The term of an error
        // that hardly changes from step to step, p ≈ 0, is large in the error and nothing in a
        // difference.
        let size =
            |(q, parameter): (f64, &f64)| (parameter * against.power(finest, coarsest, q)).abs();
        let mut sizes = powers.zip(&fit.parameters).map(size);
        (sizes.next()? > sizes.sum()).then_some((p, fit.chi_square))
    };
    let profile: Vec<(f64, f64)> = (lowest..=HIGHEST).filter_map(candidate).collect();
    let (estimate, least) = profile.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let allowed = least + two_sided(CONFIDENCE, None).powi(2);
    let mut inside = profile.iter().filter(|(_, chi)| *chi <= allowed).map(|(p, _)| *p);
    let lo = inside.next()?;
    let degrees = levels - terms as usize - 1;
    let rate = Rate {
        estimate,
        lo,
        hi: inside.next_back().unwrap_or(lo),
        confidence: CONFIDENCE,
        chi_square: least,
        degrees,
        p_value: chi_square_p_value(least, degrees),
        ..Rate::default()
    };
    let what = match against {
        Against::Exact => "error",
        Against::HalfStep => "differences e(τ) − e(τ/2) of an error",
    };
    let next = (1..terms).map(|k| format!(" + cτ^(p+{})", f64::from(k) * expansion.step()));
    let powers: String = next.collect();
    let law = format!("profile of generalised least squares, {what} = aτ^p{powers}");
    Some(rate.described(&law))
}

/// Upper bound of the terms of order below `order` in the error at the finest step: the upper end
/// of a 95 % interval, with e = A₁τ + A₂τ² + … fitted by generalised least squares, as errors or
/// differences ([`Against`]). `None` if there are too few levels or the covariance is singular.
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
    let powers = (1..=order + 1).map(f64::from);
    if order as usize >= taus.len() {
        return None;
    }
    let weighting = Weighting::new(covariance)?;
    let fit = weighting.fit(&against.design(taus, powers.clone()), errors)?;
    let quantile = two_sided(CONFIDENCE, None);
    let term = |(c, q): (usize, f64)| {
        let largest = fit.parameters[c].abs() + quantile * fit.covariance(c)[c].sqrt();
        largest * against.power(finest, coarsest, q).abs()
    };
    let lower = powers.enumerate().take(order as usize - 1).map(term).sum::<f64>();
    Some(lower / errors[errors.len() - 1].abs())
}

impl Against {
    /// Columns of the given powers at all step sizes.
    fn design(self, taus: &[f64], powers: impl Iterator<Item = f64>) -> Vec<Vec<f64>> {
        let column = |q| taus.iter().map(|&tau| self.power(tau, taus[0], q)).collect();
        powers.map(column).collect()
    }

    /// Contribution of τ^q to the error measured at step τ, with all steps in units of `unit`.
    fn power(self, tau: f64, unit: f64, q: f64) -> f64 {
        let e = |tau: f64| elementary::powf(tau / unit, q);
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
/// error of first order leaves d_L once more, and one in even powers d_L/3, up to the next power.
/// The order is fitted to the differences, without the tail; the further terms of the fit are those
/// of the expansion.
pub fn weak_errors(
    taus: &[f64],
    differences: &[CrossMoments],
    index: usize,
    expansion: Expansion,
) -> (Vec<Point>, Option<Rate>) {
    let last = 1.0 + 1.0 / (elementary::exp2(expansion.step()) - 1.0);
    let means: Vec<f64> = differences.iter().map(|d| d.mean(index)).collect();
    let variances: Vec<f64> =
        differences.iter().map(|d| d.covariance_of_means(index, index)).collect();
    let finest = taus.len() - 1;
    let point = |l: usize| {
        let error = means[l..finest].iter().sum::<f64>() + last * means[finest];
        let variance = variances[l..finest].iter().sum::<f64>() + last * last * variances[finest];
        Point::normal(taus[l], error, variance.sqrt())
    };
    let rate = fit_weak(taus, &means, &diagonal(&variances), Against::HalfStep, expansion);
    ((0..taus.len()).map(point).collect(), rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taus(levels: usize) -> Vec<f64> {
        (0..levels).map(|l| 0.1 * 0.5f64.powi(l as i32)).collect()
    }

    /// The fit to independent errors in every power.
    fn fit(taus: &[f64], errors: &[f64], variances: &[f64], against: Against) -> Option<Rate> {
        fit_weak(taus, errors, &diagonal(variances), against, Expansion::EveryPower)
    }

    #[test]
    fn an_order_on_the_grid_is_recovered_from_errors_and_from_differences() {
        for (levels, terms) in [(4, 2), (5, 2), (6, 2), (7, 3), (8, 3)] {
            for against in [Against::Exact, Against::HalfStep] {
                // e = 2τᵖ − 3τ^{p+1} (+ τ^{p+2}/2), with errors of 10⁻⁴ of each value.
                let (taus, p) = (taus(levels), 1.5);
                let e = |tau: f64| {
                    let third = if terms == 3 { 0.5 * tau * tau } else { 0.0 };
                    tau.powf(p) * (2.0 - 3.0 * tau + third)
                };
                let error = |tau: f64| match against {
                    Against::Exact => e(tau),
                    Against::HalfStep => e(tau) - e(0.5 * tau),
                };
                let errors: Vec<f64> = taus.iter().map(|&tau| error(tau)).collect();
                let variances: Vec<f64> = errors.iter().map(|e| (1e-4 * e).powi(2)).collect();
                let rate = fit(&taus, &errors, &variances, against).unwrap();
                assert_eq!(rate.estimate, p, "{rate:?}");
                assert!(rate.chi_square < 1e-9 && rate.lo <= p && p <= rate.hi, "{rate:?}");
                assert_eq!((rate.degrees, rate.confidence), (levels - terms as usize - 1, 0.95));
                let third = rate.method.contains("error = aτ^p + cτ^(p+1) + cτ^(p+2), χ²");
                assert_eq!(third, terms == 3, "{}", rate.method);
                assert_eq!(rate.method.contains("differences"), against == Against::HalfStep);
                assert_eq!(rate.p_value.is_some(), rate.degrees > 0);
                assert!(rate.p_value.is_none_or(|p| p > 0.999) && rate.warning.is_none());
                // Signs do not matter.
                let negative: Vec<f64> = errors.iter().map(|e| -e).collect();
                let same = fit(&taus, &negative, &variances, against).unwrap();
                assert_eq!((same.estimate, same.lo, same.hi), (rate.estimate, rate.lo, rate.hi));
            }
        }
        let three = taus(3);
        assert!(fit(&three, &three, &[1e-8; 3], Against::Exact).is_none());
    }

    #[test]
    fn one_error_must_stand_out_of_the_noise() {
        let taus = taus(5);
        let of = |deviations: f64| {
            let mut variances = vec![1.0; 5];
            variances[2] = (taus[2] / deviations).powi(2);
            fit(&taus, &taus, &variances, Against::Exact)
        };
        assert!(of(3.99).is_none() && of(4.01).is_some());
    }

    #[test]
    fn the_leading_term_is_the_largest_at_the_finest_step() {
        // 2τ − 3τ² at two step sizes more than parameters: as −3τ² + 2τ it would be of order two.
        let taus = [0.8, 0.4, 0.2, 0.1];
        let errors = taus.map(|tau| 2.0 * tau - 3.0 * tau * tau);
        let rate = fit(&taus, &errors, &[1e-10; 4], Against::Exact).unwrap();
        assert!(rate.lo > 0.95 && rate.hi < 1.05, "{rate:?}");
    }

    #[test]
    fn a_lower_term_is_bounded_by_its_interval() {
        // e/τ = A₁ + A₂τ + A₃τ² through three points at 1, ½, ¼: A₁ = e₁/3 − 4e₂ + 32e₃/3 in units
        // of the coarsest step, with the standard error σ√(1/9 + 16 + 1024/9). Of differences with
        // half the step it is twice that, and contributes half. Signs do not matter.
        let taus = taus(3);
        let (sigma, errors) = (0.01, [-0.9, -0.5, -0.3]);
        let a = 0.3 - 2.0 + 3.2;
        let se = sigma * (1.0 / 9.0 + 16.0 + 1024.0 / 9.0f64).sqrt();
        let exact = (a + 1.959_963_984_540_054 * se) * 0.25 / 0.3;
        let covariance = diagonal(&[sigma * sigma; 3]);
        for against in [Against::Exact, Against::HalfStep] {
            let of = |order| lower_share(&taus, &errors, &covariance, order, against);
            assert!((of(2).unwrap() / exact - 1.0).abs() < 1e-9, "{against:?}: {:?}", of(2));
            // Nothing is lower than order one; order three has a term more than there are points.
            assert_eq!((of(1), of(3)), (Some(0.0), None));
        }
        let singular = vec![vec![1.0; 3]; 3];
        assert_eq!(lower_share(&taus, &errors, &singular, 2, Against::Exact), None);
        // Two lower terms are added up: 0.1τ − 0.2τ² + 5τ³ without noise.
        let taus = self::taus(6);
        let e = |x: f64| 0.1 * x - 0.2 * x * x + 5.0 * x.powi(3);
        let errors: Vec<f64> = taus.iter().map(|tau| e(tau / 0.1)).collect();
        let share = lower_share(&taus, &errors, &diagonal(&[1e-24; 6]), 3, Against::Exact).unwrap();
        let x = 0.5f64.powi(5);
        let exact = (0.1 * x + 0.2 * x * x) / e(x);
        assert!((share / exact - 1.0).abs() < 1e-6, "{share} {exact}");
    }

    #[test]
    fn errors_are_sums_of_differences_with_a_tail() {
        // 64 differences ±1 about 8, 4 and 2, and ±2 about 1: their means have the variances 1/63
        // and 4/63. The last counts twice, and of order two a third more.
        let all = [(8.0, 1.0), (4.0, 1.0), (2.0, 1.0), (1.0, 2.0)].map(|(mean, spread)| {
            CrossMoments::of((0..64).map(|n| [mean + if n % 2 == 0 { spread } else { -spread }]))
        });
        for (expansion, last, square) in
            [(Expansion::EveryPower, 2.0, 16.0), (Expansion::EvenPowers, 4.0 / 3.0, 64.0 / 9.0)]
        {
            let (points, rate) = weak_errors(&taus(4), &all, 0, expansion);
            let before = [(14.0, 3.0), (6.0, 2.0), (2.0, 1.0), (0.0, 0.0)];
            for ((point, tau), (value, of_sum)) in points.iter().zip(taus(4)).zip(before) {
                let Point::Error { tau: at, value: found, se, lo: None, .. } = *point else {
                    panic!("{points:?}")
                };
                assert!(at == tau && (found - value - last).abs() < 1e-14, "{points:?}");
                let variance: f64 = (of_sum + square) / 63.0;
                assert!((se / variance.sqrt() - 1.0).abs() < 1e-12, "{se}");
            }
            assert_eq!(points.len(), 4);
            if expansion == Expansion::EveryPower {
                assert_eq!(rate.unwrap().estimate, 1.0);
            }
        }
    }

    #[test]
    fn an_order_is_found_in_even_powers() {
        let taus = taus(5);
        // Differences of e, in units of the coarsest step, with errors of so much of each.
        let fit = |e: fn(f64) -> f64, error: f64, expansion| {
            let differences = taus.iter().map(|tau| e(tau / 0.1) - e(tau / 0.2));
            let errors: Vec<f64> = differences.collect();
            let variances: Vec<f64> = errors.iter().map(|e| (error * e).powi(2)).collect();
            let covariance = diagonal(&variances);
            fit_weak(&taus, &errors, &covariance, Against::HalfStep, expansion).unwrap()
        };
        // With τ³ in the place of τ⁴ another order fits.
        let second = |x: f64| 2.0 * x.powi(2) - 3.0 * x.powi(4);
        let even = fit(second, 1e-3, Expansion::EvenPowers);
        assert!(even.estimate == 2.0 && even.lo > 1.98 && even.hi < 2.02, "{even:?}");
        assert!(even.chi_square < 1e-9 && even.degrees == 2, "{even:?}");
        let every = fit(second, 1e-3, Expansion::EveryPower);
        assert!(every.chi_square > 100.0, "{every:?}");
        // Order one is seen, though it is no such expansion.
        let one = fit(|x| 2.0 * x - 3.0 * x.powi(2), 0.03, Expansion::EvenPowers);
        assert!(one.hi < 1.5, "{one:?}");
    }
}
