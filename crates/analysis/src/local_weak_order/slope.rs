//! The order of errors at halved step sizes.

use std::f64::consts::LN_2;

use super::LocalError;

/// An extrapolated slope and how far it may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    pub order: f64,
    pub uncertainty: f64,
}

/// An uncertainty that is small enough to take the finest step sizes that have it.
const ENOUGH: f64 = 0.02;

/// log₂(e(τ)/e(τ/2)) of successive errors.
pub fn slopes(errors: &[LocalError]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0].error / pair[1].error).abs().log2()).collect()
}

/// The slope as τ → 0, of errors at step sizes each half of the one before; `None` for fewer than
/// four of them.
///
/// Of errors cτ^q(1 + O(τ)) the slopes are q + O(τ), and 2s(τ/2) − s(τ) is q + O(τ²). It differs
/// from the one before by three times its own error, at least, and is as far off as the square of
/// the change from s(τ/2). Errors of the errors add to that. The finest step sizes are taken at
/// which the sum is small, or else those at which it is smallest.
pub fn extrapolated(errors: &[LocalError]) -> Option<Slope> {
    let slopes = slopes(errors);
    let values: Vec<f64> = slopes.windows(2).map(|pair| 2.0 * pair[1] - pair[0]).collect();
    let doubt = |n: usize| errors[n].doubt / errors[n].error.abs();
    let mut least: Option<Slope> = None;
    for n in (1..values.len()).rev() {
        let rounding = (doubt(n) + 3.0 * doubt(n + 1) + 2.0 * doubt(n + 2)) / LN_2;
        let change = (slopes[n + 1] - slopes[n]).powi(2);
        let uncertainty = (values[n] - values[n - 1]).abs() + change + rounding;
        if least.is_none_or(|least| uncertainty < least.uncertainty) {
            least = Some(Slope { order: values[n], uncertainty });
        }
        if uncertainty <= ENOUGH {
            break;
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(of: impl Fn(f64) -> f64, doubt: f64, count: i32) -> Vec<LocalError> {
        let at = |n: i32| {
            let tau = f64::powi(0.5, n);
            LocalError { tau, error: of(tau), doubt }
        };
        (1..=count).map(at).collect()
    }

    #[test]
    fn the_slope_is_that_as_the_step_size_tends_to_zero() {
        let of = |e: &[LocalError]| extrapolated(e).unwrap();
        let found = of(&errors(|tau| tau.powi(3) * (1.0 + 4.0 * tau), 0.0, 8));
        assert!((found.order - 3.0).abs() < found.uncertainty && found.uncertainty < 0.02);
        // A small term of order two is found if the errors reach it, and not averaged.
        let found = of(&errors(|tau| tau.powi(3) + 1e-3 * tau.powi(2), 0.0, 17));
        assert!((found.order - 2.0).abs() < 0.02, "{found:?}");
        // At the finest sizes errors are half rounding; those before them are not.
        let rounded = |tau: f64| tau.powi(2) + if tau < 2e-3 { 0.5 * tau.powi(2) } else { 0.0 };
        let mut all = errors(rounded, 0.0, 10);
        all.last_mut().unwrap().doubt = 0.5 * 1e-6;
        assert!((of(&all).order - 2.0).abs() < 0.02, "{:?}", of(&all));
    }

    #[test]
    fn errors_that_have_no_order_have_a_large_uncertainty() {
        let found = extrapolated(&errors(|tau| tau * (1.0 + 0.5 * (2.0 * tau.ln()).sin()), 0.0, 9));
        assert!(found.unwrap().uncertainty > 0.2, "{found:?}");
        assert_eq!(extrapolated(&errors(|tau| tau, 0.0, 3)), None);
        assert_eq!(extrapolated(&[]), None);
    }
}
