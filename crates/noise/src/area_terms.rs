//! Number of terms of the series for an approximation of the Lévy areas.

use std::f64::consts::PI;

use crate::NoiseError;

/// The largest number of terms.
pub const MAX_AREA_TERMS: usize = 1 << 24;

/// The root-mean-square error h^{3/2} of each area that a method of strong order one tolerates. The
/// errors of the N = T/h steps are independent, so their sum has the size √N h^{3/2} = √T h.
pub fn strong_order_one_error(step: f64) -> f64 {
    step * step.sqrt()
}

/// A bound √(m/12) h/(πn) of E[(A_ij − Â_ij)²]^{1/2} for n terms over a step h, the same for every
/// pair i ≠ j of the m = `noises` (Mrongowius and Rößler 2022). The expectation includes W. The
/// error in the Frobenius norm of the matrix is √(m(m−1)) times that of one entry.
///
/// It bounds the error of a coupling with the exact areas. The exact tail is S^{1/2}g, where g is
/// normal and independent of the random covariance S; the method uses a g. The published constant
/// follows from ‖S^{1/2} − a‖ ≤ ‖S − a²‖/a. Since S^{1/2} − a ≈ (S − a²)/2a, the error tends to
/// *half* this bound as n → ∞, and it is below half of the bound wherever the tests compute it. The
/// published bound is proven for all n.
pub fn area_error(step: f64, terms: usize, noises: usize) -> f64 {
    if noises < 2 {
        return 0.0;
    }
    let (n, m) = (terms as f64, noises as f64);
    step / PI * (m / (12.0 * n * n)).sqrt()
}

/// The least number of terms, at least one, with [`area_error`] ≤ `error`; none for fewer than two
/// noises.
///
/// ```
/// let step = 2f64.powi(-12);
/// assert_eq!(noise::area_terms(noise::strong_order_one_error(step), step, 3)?, 11);
/// # Ok::<(), noise::NoiseError>(())
/// ```
///
/// # Errors
/// [`NoiseError`] unless `error` and `step` are positive and finite, and above
/// [`MAX_AREA_TERMS`] terms.
pub fn area_terms(error: f64, step: f64, noises: usize) -> Result<usize, NoiseError> {
    NoiseError::unless_positive("the root-mean-square error of an area", error)?;
    NoiseError::unless_positive("the step of Lévy areas", step)?;
    if noises < 2 {
        return Ok(0);
    }
    let real = area_error(step, 1, noises) / error;
    if real > MAX_AREA_TERMS as f64 || real.is_nan() {
        let needs = format!("{real:.3e} terms a step, more than {MAX_AREA_TERMS}");
        return Err(NoiseError(format!("the error asked of the areas needs {needs}")));
    }
    // The next integer, unless rounding has moved the quotient across one.
    let mut terms = (real as usize).max(1);
    while area_error(step, terms, noises) > error {
        terms += 1;
    }
    Ok(terms)
}

/// ψ₁(n+1) = Σ_{r>n} r⁻² = π²/6 − Σ_{r≤n} r⁻², without the cancellation of that difference.
///
/// For x ≥ 21 by the asymptotic series ψ₁(x) = 1/x + 1/(2x²) + Σ B_{2k}/x^{2k+1}. Its first omitted
/// term B₁₂/x¹³ is below 4e-17 of the value. For smaller x, terms r⁻² are added to ψ₁(21).
pub fn trigamma_after(n: usize) -> f64 {
    const SERIES_FROM: usize = 20;
    let start = n.max(SERIES_FROM);
    let reciprocal = 1.0 / (start as f64 + 1.0);
    let square = reciprocal * reciprocal;
    let mut bernoulli = 0.0;
    for b in [5.0 / 66.0, -1.0 / 30.0, 1.0 / 42.0, -1.0 / 30.0, 1.0 / 6.0] {
        bernoulli = b + square * bernoulli;
    }
    let mut sum = reciprocal * (1.0 + reciprocal * (0.5 + reciprocal * bernoulli));
    for r in (n + 1..=start).rev() {
        sum += 1.0 / (r * r) as f64;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trigamma_at_integers() {
        // π²/6 − Σ r⁻² in arithmetic of 40 digits, to the nearest double.
        for (n, value) in TRIGAMMA {
            let error = trigamma_after(n) / value - 1.0;
            assert!(error.abs() < 3.0 * f64::EPSILON, "{n}: {error:e}");
        }
        assert!((trigamma_after(0) / (PI * PI / 6.0) - 1.0).abs() < 3.0 * f64::EPSILON);
    }
    const TRIGAMMA: [(usize, f64); 6] = [
        (1, 0.644_934_066_848_226_4),
        (2, 0.394_934_066_848_226_46),
        (11, 0.086_901_872_871_768_38),
        (20, 0.048_770_822_935_203_12),
        (21, 0.046_503_249_239_057_99),
        (1000, 0.000_999_500_166_666_633_4),
    ];

    #[test]
    fn the_number_of_terms_is_the_least() {
        for m in [2, 3, 7] {
            // Its square is m h²/(12 π² n²).
            let square = 12.0 * (PI * 49.0 * area_error(0.3, 49, m) / 0.3).powi(2);
            assert!((square - m as f64).abs() < 1e-13, "{m}: {square}");
            for terms in [1, 2, 3, 10, 49, 1000, 12_345] {
                // An error that is reached exactly, and one just below it.
                let error = area_error(0.3, terms, m);
                assert_eq!(area_terms(error, 0.3, m), Ok(terms));
                assert_eq!(area_terms(error * (1.0 - 1e-12), 0.3, m), Ok(terms + 1));
            }
            // The quotient may round to either side of the integer.
            for terms in 1..500 {
                let error = area_error(0.3, terms, m);
                assert_eq!(area_terms(error.next_up(), 0.3, m), Ok(terms));
                assert_eq!(area_terms(error.next_down(), 0.3, m), Ok(terms + 1));
            }
        }
    }

    #[test]
    fn bad_requests_name_the_value() {
        assert_eq!((area_terms(1e-9, 0.1, 1), area_error(0.1, 0, 1)), (Ok(0), 0.0));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for (result, what) in
                [(area_terms(bad, 0.1, 3), "error"), (area_terms(0.1, bad, 3), "step")]
            {
                let message = result.unwrap_err().to_string();
                assert!(message.contains(what) && message.ends_with(&format!("got {bad}")));
            }
        }
        let absurd = area_terms(1e-300, 1.0, 3).unwrap_err();
        assert!(absurd.to_string().contains("terms a step"), "{absurd}");
    }
}
