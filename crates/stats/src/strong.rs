//! The strong order from squared errors.
//!
//! **Heavy tails.** A level whose squared errors x are carried by fewer than 30 paths, (Σx)²/Σx² <
//! 30, is left out of the fit: there the mean of the few largest squares is measured and not a mean
//! square. With fewer than four levels left, all are used, and the interval reaches at each end as
//! far as the farther of the delta method's and the bootstrap's.
//!
//! **Coarse steps.** While χ² rejects the model, the coarsest level is left out, down to four.

use crate::{
    describe::describe,
    mean_squares::{Bend, LogMeanSquares},
    moments::{CrossMoments, FEW_SAMPLES},
    rate::{Rate, STRAIGHT_CONFIDENCE, StraightLine},
};

/// Fewer levels than this make no fit from which others have been left out.
const LEAST_LEVELS: usize = 4;

/// The strong order from squares at several step sizes, coarsest first.
///
/// The squares are those of the differences y_τ − y_{τ/2} of runs on the same noise, or of errors
/// against an exact solution: no reference with an error of its own is in them.
///
/// Fits ln m = a + 2p ln τ + ln(1 + bτ) to the mean squares m with fixed weights
/// ([`LogMeanSquares`]), and gives p with an interval by the delta method from the estimated
/// covariance of the ln m, which share paths; beside it a bootstrap-t interval over whole paths
/// (Efron and Tibshirani 1993), and the straight line with a test whether the points lie on one.
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
        if reliable.len() < LEAST_LEVELS { (all, Vec::new()) } else { (reliable, few) };
    let mut coarse = Vec::new();
    let (logarithms, estimate) = loop {
        let logarithms = LogMeanSquares::new(taus, squares, levels.clone())?;
        let mut estimate = logarithms.fit((levels.len() > LEAST_LEVELS).then_some(Bend::LINEAR))?;
        if levels.len() == LEAST_LEVELS && estimate.rate.misfits() {
            estimate = logarithms.fit(Some(Bend::LINEAR))?;
        }
        if !estimate.rate.misfits() || levels.len() <= LEAST_LEVELS {
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
        straight: curved.then(|| straight(&logarithms)).flatten(),
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
    Some(describe(rate))
}

/// The straight line through the points.
fn straight(logarithms: &LogMeanSquares<'_>) -> Option<StraightLine> {
    let Rate { estimate, lo, hi, chi_square, degrees, p_value, .. } = logarithms.fit(None)?.rate;
    let refuted = p_value.is_some_and(|p| p < 1.0 - STRAIGHT_CONFIDENCE);
    Some(StraightLine { estimate, lo, hi, chi_square, degrees: degrees as u32, refuted })
}
