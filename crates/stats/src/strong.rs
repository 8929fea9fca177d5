//! The strong order from squared errors.
//!
//! **Heavy tails.** A level whose squared errors x are carried by fewer than 30 paths, (Σx)²/Σx² <
//! 30, is left out of the fit: there the mean of the few largest squares is measured and not a mean
//! square. With fewer than four levels left, all are used, and the interval reaches at each end as
//! far as the farther of the delta method's and the bootstrap's.
//!
//! **Coarse steps.** While χ² rejects the model, the coarsest level is left out, down to four.

use crate::{
    mean_squares::{Bend, LogMeanSquares},
    moments::{CrossMoments, FEW_SAMPLES},
    rate::Rate,
};

/// Least number of levels of a fit from which others have been left out.
const MIN_LEVELS: usize = 4;

/// The strong order from squares at several step sizes, coarsest first.
///
/// The squares are those of the differences y_τ − y_{τ/2} of runs on the same noise, or of errors
/// against an exact solution: no reference with an error of its own is in them.
///
/// Fits ln m = a + 2p ln τ + ln(1 + bτ) to the mean squares m with fixed weights
/// ([`LogMeanSquares`]), and gives p with an interval by the delta method from the estimated
/// covariance of the ln m, which share paths; beside it a bootstrap-t interval over whole paths
/// (Efron and Tibshirani 1993).
///
/// The term b is fitted from five levels on, two more than there are parameters, and with four
/// where χ² rejects the straight line. The next order may also enter as (1 + bτ)² or 1 + bτ²: the
/// interval is widened to those of the fits with these that χ² does not reject.
///
/// Levels that a few paths dominate, and coarse levels with which χ² rejects the model, are left
/// out and named. If χ² rejects it to the end, the rate carries a warning ([`Rate::misfits`]).
///
/// `None` if an error is zero, if there are no more paths than levels, or if the covariance is
/// singular.
pub fn fit_strong(taus: &[f64], squares: &CrossMoments) -> Option<Rate> {
    let all: Vec<usize> = (0..taus.len()).collect();
    if squares.count() <= taus.len() as u64 {
        return None;
    }
    // A zero error anywhere means that there is no order to speak of, even where its level would be
    // left out.
    LogMeanSquares::new(taus, squares, all.clone())?;
    let (reliable, few): (Vec<usize>, Vec<usize>) =
        all.iter().partition(|&&l| squares.effective_samples(l) >= FEW_SAMPLES);
    let (mut levels, left_out) =
        if reliable.len() < MIN_LEVELS { (all, Vec::new()) } else { (reliable, few) };
    let mut coarse = Vec::new();
    let (logarithms, estimate) = loop {
        let logarithms = LogMeanSquares::new(taus, squares, levels.clone())?;
        let mut estimate = logarithms.fit((levels.len() > MIN_LEVELS).then_some(Bend::LINEAR))?;
        if levels.len() == MIN_LEVELS && estimate.rate.misfits() {
            estimate = logarithms.fit(Some(Bend::LINEAR))?;
        }
        if !estimate.rate.misfits() || levels.len() <= MIN_LEVELS {
            break (logarithms, estimate);
        }
        coarse.push(taus[levels.remove(0)]);
    };
    let curved = estimate.rate.curvature_t.is_some();
    let bootstrap = logarithms.bootstrap(&estimate);
    let effective = (0..taus.len()).map(|l| squares.effective_samples(l));
    let mut rate = Rate {
        bootstrap_lo: bootstrap.map(|(low, _)| low),
        bootstrap_hi: bootstrap.map(|(_, high)| high),
        effective_paths: Some(effective.fold(f64::INFINITY, f64::min)),
        left_out: left_out.iter().map(|&l| taus[l]).collect(),
        coarse,
        ..estimate.rate
    };
    for bend in [Bend::SQUARED, Bend::QUADRATIC].into_iter().filter(|_| curved) {
        let other = logarithms.fit(Some(bend)).map(|other| other.rate);
        if let Some(other) = other.filter(|other| !other.misfits()) {
            (rate.lo, rate.hi) = (rate.lo.min(other.lo), rate.hi.max(other.hi));
        }
    }
    if let Some((low, high)) = bootstrap.filter(|_| rate.rests_on_few_paths()) {
        (rate.lo, rate.hi) = (rate.lo.min(low), rate.hi.max(high));
    }
    let bend = if curved { " + ln(1 + bτ)" } else { "" };
    Some(rate.described(&format!("least squares, ln mean square = a + 2p ln τ{bend}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares with the means τ²·factor(τ) at steps 1/8, 1/16, …, scattered by `spread` to both
    /// sides, independently of each other.
    fn squares(
        paths: u64,
        levels: usize,
        spread: f64,
        factor: impl Fn(f64) -> f64,
    ) -> (Vec<f64>, CrossMoments) {
        let taus: Vec<f64> = (0..levels).map(|l| 0.5f64.powi(l as i32 + 3)).collect();
        let mut squares = CrossMoments::new(levels);
        for path in 0..paths {
            let sign = |l: usize| if path >> l & 1 == 0 { 1.0 + spread } else { 1.0 - spread };
            let values = taus.iter().enumerate().map(|(l, &tau)| tau * tau * factor(tau) * sign(l));
            squares.add(&values.collect::<Vec<f64>>());
        }
        (taus, squares)
    }

    #[test]
    fn five_levels_are_fitted_with_a_bend_and_four_with_one_only_if_they_need_it() {
        let degrees = |levels: usize, factor: fn(f64) -> f64| {
            let (taus, squares) = squares(64, levels, 0.1, factor);
            let rate = fit_strong(&taus, &squares).unwrap();
            assert!(rate.covers(1.0), "{rate:?}");
            (rate.degrees, rate.curvature_t.is_some())
        };
        assert_eq!(degrees(5, |_| 1.0), (2, true));
        assert_eq!(degrees(4, |_| 1.0), (2, false));
        assert_eq!(degrees(4, |tau| 1.0 + 40.0 * tau), (1, true));
    }

    #[test]
    fn coarse_steps_that_follow_no_power_are_left_out_one_by_one() {
        // Where errors grow and fall in turn, the order comes with a warning.
        let in_turn = |tau: f64| if tau.log2() % 2.0 == 0.0 { 9.0 } else { 1.0 };
        let (taus, in_turn) = squares(64, 5, 0.1, in_turn);
        let rate = fit_strong(&taus, &in_turn).unwrap();
        assert!(rate.misfits() && rate.coarse.len() == 1 && rate.warning.is_some(), "{rate:?}");
        // At the two coarsest steps the error is that of order one times 30 and 1/30.
        let (taus, squares) = squares(256, 8, 0.1, |tau| match tau {
            0.125 => 30.0,
            0.0625 => 1.0 / 30.0,
            _ => 1.0,
        });
        let rate = fit_strong(&taus, &squares).unwrap();
        assert_eq!((&rate.coarse[..], rate.degrees), (&taus[..2], 3), "{rate:?}");
        assert!(rate.covers(1.0) && !rate.misfits() && rate.method.contains("left out"));
    }

    #[test]
    fn the_interval_is_the_hull_over_the_bends() {
        let (taus, squares) = squares(256, 6, 0.4, |tau| 1.0 + 3.0 * tau);
        let rate = fit_strong(&taus, &squares).unwrap();
        let logarithms = LogMeanSquares::new(&taus, &squares, (0..6).collect()).unwrap();
        let of = |bend| logarithms.fit(Some(bend)).unwrap().rate;
        let bends = [Bend::LINEAR, Bend::SQUARED, Bend::QUADRATIC].map(of);
        assert!(bends.iter().all(|rate| !rate.misfits()));
        assert_eq!(rate.lo, bends.iter().map(|rate| rate.lo).fold(f64::INFINITY, f64::min));
        assert_eq!(rate.hi, bends.iter().map(|rate| rate.hi).fold(0.0, f64::max));
        assert_eq!(rate.estimate, bends[0].estimate);
        let estimate = logarithms.fit(Some(Bend::LINEAR)).unwrap();
        let (low, high) = logarithms.bootstrap(&estimate).unwrap();
        assert_eq!((rate.bootstrap_lo, rate.bootstrap_hi), (Some(low), Some(high)));
        // All paths carry an error that scatters by 0.4 alike, but for the factor 1 + 0.4².
        let effective = rate.effective_paths.unwrap();
        assert!((effective - 256.0 / 1.16).abs() < 1e-9, "{effective}");
    }

    #[test]
    fn thirty_effective_paths_are_reliable() {
        // One of n equal squares counts as n; 30 are enough and 29 are not, and of few reliable
        // levels all are used.
        let levels = |paths: u64, carried: usize| {
            let taus = [0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625];
            let level = |path: u64, l: usize| {
                let sign = if path >> l & 1 == 0 { 1.0 + 1e-6 } else { 1.0 - 1e-6 };
                let share = if l < carried && path >= paths { 1e-9 } else { 1.0 };
                taus[l] * taus[l] * sign * share
            };
            let path = |path| std::array::from_fn(|l| level(path, l));
            fit_strong(&taus, &CrossMoments::of::<6>((0..128).map(path))).unwrap()
        };
        assert!(levels(31, 2).left_out.is_empty());
        assert_eq!(levels(29, 2).left_out, [0.5, 0.25]);
        let few = levels(29, 3);
        assert!(few.left_out.is_empty() && few.rests_on_few_paths(), "{few:?}");
        let (low, high) = (few.bootstrap_lo.unwrap(), few.bootstrap_hi.unwrap());
        assert!(few.lo <= low && few.hi >= high, "{few:?}");
    }
}
