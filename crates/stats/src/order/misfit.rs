//! When a model does not fit, its parameters mean nothing.
//!
//! χ² of the residuals says how probable they are if the model is right. Where that probability is
//! below [`MISFIT`], the interval of a parameter has no known coverage, and no order is read off
//! it: the fit carries a warning, and its verdict is *undecided*, whichever way the interval lies.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::Rate;

/// Fits whose residuals are less probable than this are no fits.
///
/// This is the share of right models that are given up for it, where the distribution of χ² is
/// known. Where the covariance is estimated from a few hundred skewed squares, its tail is heavier:
/// of 20 000 sets of 400 squares of normals 1e-5 gives up 1e-4. A hundred runs with a hundred fits
/// each then lose one at most.
pub(super) const MISFIT: f64 = 1e-5;

/// The probability of so large a χ² with so many degrees of freedom, when the covariance is known;
/// `None` with none.
pub(super) fn probability(chi_square: f64, degrees: usize) -> Option<f64> {
    // What is not a number is no fit.
    let chi_square = if chi_square.is_nan() { f64::INFINITY } else { chi_square };
    ChiSquared::new(degrees as f64).ok().map(|distribution| distribution.sf(chi_square))
}

/// Whether the model of a fit is given up.
pub fn misfits(rate: &Rate) -> bool {
    rate.p_value.is_some_and(|p| p.is_nan() || p < MISFIT)
}

/// Adds the warning to a fit whose model is given up.
pub(super) fn flag(mut rate: Rate) -> Rate {
    if misfits(&rate) {
        let p = rate.p_value.unwrap_or(0.0);
        let text = format!(
            "the model does not fit: residuals so large have the probability {p:.0e}, no order can be read off"
        );
        rate.warning = Some(rate.warning.map_or(text.clone(), |other| format!("{text}; {other}")));
    }
    rate
}
