//! A fit in words.

use super::normal_quantile;
use super::strong::{Estimate, FEW_PATHS, STRAIGHT_CONFIDENCE, Terms};
use crate::{Rate, StraightLine};

/// The fit in words. What bends the points is named by the larger of the two terms' t, when it is
/// beyond the same confidence as the straight line is refuted with.
pub(super) fn describe(
    rate: &Rate,
    estimate: &Estimate,
    terms: Terms,
    conservative: bool,
) -> String {
    let corrections = match (terms.curvature, terms.reference.is_some()) {
        (true, true) => " + ln(1 + bτ + c τ_ref/τ)",
        (true, false) => " + ln(1 + bτ)",
        (false, true) => " + ln(1 + c τ_ref/τ)",
        (false, false) => "",
    };
    let mut text = format!(
        "least squares, ln mean square = a + 2p ln τ{corrections}, χ² = {:.1} with {} degrees of freedom",
        estimate.chi_square, estimate.degrees,
    );
    if let (Some(low), Some(high)) = (rate.bootstrap_lo, rate.bootstrap_hi) {
        text += &format!("; bootstrap over paths [{low:.3}, {high:.3}]");
    }
    if let Some(line) = &rate.straight {
        let StraightLine { estimate, lo, hi, chi_square, degrees, refuted } = line;
        let (curvature, reference) =
            (rate.curvature_t.unwrap_or(0.0).abs(), rate.reference_t.unwrap_or(0.0).abs());
        let threshold = normal_quantile(STRAIGHT_CONFIDENCE);
        let reason = match refuted {
            false => "which the points do not contradict",
            true if curvature.max(reference) < threshold => "the points do not lie on a line",
            true if curvature > reference => "the coarse steps are not yet asymptotic",
            true => "the fine steps feel the error of the reference",
        };
        text += &format!(
            "; a straight line would give {estimate:.3} [{lo:.3}, {hi:.3}], χ² = {chi_square:.1} with {degrees} degrees of \
             freedom: {reason}"
        );
    }
    if !rate.left_out.is_empty() {
        let left_out: Vec<String> = rate.left_out.iter().map(|tau| format!("{tau:.3e}")).collect();
        text += &format!(
            "; left out, since fewer than {FEW_PATHS} effective paths carry the error: τ = {}",
            left_out.join(", ")
        );
    }
    if conservative {
        text += &format!(
            "; fewer than {FEW_PATHS} effective paths carry the error: the wider of both intervals at each end"
        );
    }
    text
}
