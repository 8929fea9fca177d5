//! Approximations of the Lévy areas, with their errors and costs as formulas.

use std::f64::consts::PI;

use crate::NoiseError;

/// An approximation of the Lévy areas over a step h, given the increment W = √h w.
///
/// All four methods begin with n terms of the Fourier series of the Brownian bridge,
///
/// W(t) = Wt/h + Σ_r [a_r (cos(2πrt/h) − 1) + b_r sin(2πrt/h)].
///
/// For each noise, a_r = √(h/2)/(πr) X_r and b_r = √(h/2)/(πr) Y_r with independent standard
/// normals X_r and Y_r. The constants −a_r make W(0) = 0. In A_ij = ½∫(W_i dW_j − W_j dW_i) one has
/// ∫ t sin(2πrt/h) dt = −h²/(2πr) over a step, and all other products are orthogonal. This gives
///
/// A_ij = (h/2π) Σ_{r≥1} (1/r)[X_r^i (Y_r^j − √2 w_j) − X_r^j (Y_r^i − √2 w_i)].
///
/// The methods differ in the approximation of the tail r > n. Let a² = 2ψ₁(n+1) = 2Σ_{r>n} r⁻²,
/// where ψ₁ is the trigamma function. The tail terms that contain w sum up to
/// (h/2π)·a(w_iΨ_j − w_jΨ_i) *exactly*, with standard normals Ψ. The other tail terms are normal
/// given X, with a covariance that tends to a² times the identity.
///
/// ```
/// use noise::{AreaMethod, strong_order_one_error};
///
/// let step = 2f64.powi(-12);
/// let error = strong_order_one_error(step); // h^{3/2}
/// assert_eq!(AreaMethod::cheapest(error, step, 3)?, (AreaMethod::MrongowiusRoessler, 11));
/// assert_eq!(AreaMethod::MrongowiusRoessler.normals(11, 3), 72);
/// assert_eq!(AreaMethod::Fourier.terms_for(error, step, 3)?, 623);
/// # Ok::<(), noise::NoiseError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AreaMethod {
    /// n terms without a tail: the area of the truncated Fourier series (Kloeden, Platen and Wright
    /// 1992, without their correction). Error √3 h/(√2 π) n^{−1/2}.
    Fourier,
    /// Adds the exact tail of the terms with w, (h/2π) a (w_iΨ_j − w_jΨ_i), with one normal Ψ_i per
    /// noise (Milstein 1988; Kloeden, Platen and Wright 1992). Error h/(√2 π) n^{−1/2}.
    Milstein,
    /// Adds a normal tail with the covariance of the whole tail given w (Wiktorsson 2001):
    /// (h/2π){G + [(Gw)wᵀ − w(Gw)ᵀ]/(1 + √(1+|w|²))}. G is skew with entries a g_ij, one normal
    /// g_ij per pair. Error √(5m/12) h/(πn).
    ///
    /// The law of (W, A) equals that of [`MrongowiusRoessler`](Self::MrongowiusRoessler) with the
    /// same n: both tails are normal given w, with covariance (h/2π)²a²(1 + L) for the linear map
    /// L: G ↦ (Gw)wᵀ − w(Gw)ᵀ. Only the published bound is larger, by √5, and
    /// [`cheapest`](Self::cheapest) compares bounds.
    Wiktorsson,
    /// Adds the tail of [`Milstein`](Self::Milstein), and (h/2π) a g_ij for each i < j as the tail
    /// of the terms without w (Mrongowius and Rößler 2022, *On the approximation and simulation of
    /// iterated stochastic integrals*; comparison by Kastner and Rößler 2023). Error √(m/12)
    /// h/(πn).
    MrongowiusRoessler,
}

/// The root-mean-square error h^{3/2} of each area that a method of strong order one tolerates. The
/// errors of the N = T/h steps are independent, so their sum has the size √N h^{3/2} = √T h.
pub fn strong_order_one_error(step: f64) -> f64 {
    step * step.sqrt()
}

impl AreaMethod {
    /// All methods, the oldest first.
    pub const ALL: [Self; 4] =
        [Self::Fourier, Self::Milstein, Self::Wiktorsson, Self::MrongowiusRoessler];

    /// The largest result of [`terms_for`](Self::terms_for).
    pub const MAX_TERMS: usize = 1 << 24;

    /// A bound of E[(A_ij − Â_ij)²]^{1/2}, the same for every pair i ≠ j of the m = `noises`. The
    /// expectation includes W. The error in the Frobenius norm of the matrix is √(m(m−1)) times
    /// that of one entry.
    ///
    /// For [`Fourier`](Self::Fourier) and [`Milstein`](Self::Milstein) it bounds the difference
    /// from the full series, which is exactly their constant times √ψ₁(n+1) < n^{−1/2}.
    ///
    /// For the other two methods it bounds the error of a coupling with the exact areas. The exact
    /// tail is S^{1/2}g, where g is normal and independent of the random covariance S; the method
    /// uses a g. The published constant follows from ‖S^{1/2} − a‖ ≤ ‖S − a²‖/a. Since S^{1/2} − a
    /// ≈ (S − a²)/2a, the error of [`MrongowiusRoessler`](Self::MrongowiusRoessler) tends to *half*
    /// this bound as n → ∞, and it is below half of the bound wherever the tests compute it. The
    /// published bound is proven for all n.
    ///
    /// Infinite for n = 0. Zero for fewer than two noises, which have no areas.
    pub fn rms_error(self, step: f64, terms: usize, noises: usize) -> f64 {
        if noises < 2 {
            return 0.0;
        }
        let (n, m) = (terms as f64, noises as f64);
        let square = match self {
            Self::Fourier => 1.5 / n,
            Self::Milstein => 0.5 / n,
            Self::Wiktorsson => 5.0 * m / (12.0 * n * n),
            Self::MrongowiusRoessler => m / (12.0 * n * n),
        };
        step / PI * square.sqrt()
    }

    /// The smallest number of terms whose [`rms_error`](Self::rms_error) is at most `error`; zero
    /// for fewer than two noises.
    ///
    /// # Errors
    /// [`NoiseError::AreaErrorNotPositive`] or [`NoiseError::StepNotPositive`] if a value is not
    /// positive and finite. [`NoiseError::TooManyTerms`] beyond [`MAX_TERMS`](Self::MAX_TERMS).
    pub fn terms_for(self, error: f64, step: f64, noises: usize) -> Result<usize, NoiseError> {
        if !(error > 0.0 && error.is_finite()) {
            return Err(NoiseError::AreaErrorNotPositive { error });
        }
        if !(step > 0.0 && step.is_finite()) {
            return Err(NoiseError::StepNotPositive { step });
        }
        if noises < 2 {
            return Ok(0);
        }
        let ratio = self.rms_error(step, 1, noises) / error;
        let real = match self {
            Self::Fourier | Self::Milstein => ratio * ratio,
            Self::Wiktorsson | Self::MrongowiusRoessler => ratio,
        };
        if real > Self::MAX_TERMS as f64 || real.is_nan() {
            return Err(NoiseError::TooManyTerms { terms: real });
        }
        // Rounding may have moved the quotient across an integer.
        let mut terms = (real.ceil() as usize).max(1);
        while terms > 1 && self.rms_error(step, terms - 1, noises) <= error {
            terms -= 1;
        }
        while self.rms_error(step, terms, noises) > error {
            terms += 1;
        }
        Ok(terms)
    }

    /// The cost of the areas of one step of one path in normal variables: 2mn for the series plus
    /// those of the tail.
    pub fn normals(self, terms: usize, noises: usize) -> usize {
        if noises < 2 { 0 } else { 2 * noises * terms + self.tail_normals(noises) }
    }

    /// The number of normals of the tail: one per noise, per pair, or both.
    #[inline(always)]
    pub(crate) fn tail_normals(self, noises: usize) -> usize {
        let pairs = noises * noises.saturating_sub(1) / 2;
        match self {
            Self::Fourier => 0,
            Self::Milstein => noises,
            Self::Wiktorsson => pairs,
            Self::MrongowiusRoessler => noises + pairs,
        }
    }

    /// The method that reaches the root-mean-square error `error` with the fewest normals, and its
    /// number of terms.
    ///
    /// # Errors
    /// Those of [`terms_for`](Self::terms_for), if no method reaches the error.
    pub fn cheapest(error: f64, step: f64, noises: usize) -> Result<(Self, usize), NoiseError> {
        let reach =
            |method: Self| method.terms_for(error, step, noises).map(|terms| (method, terms));
        let cheapest = Self::ALL.into_iter().filter_map(|method| reach(method).ok());
        match cheapest.min_by_key(|&(method, terms)| method.normals(terms, noises)) {
            Some(best) => Ok(best),
            None => reach(Self::MrongowiusRoessler),
        }
    }

    /// a = √(2ψ₁(n+1)), the amplitude of the normals in the tail.
    pub(crate) fn tail_amplitude(terms: usize) -> f64 {
        (2.0 * trigamma_after(terms)).sqrt()
    }
}

/// ψ₁(n+1) = Σ_{r>n} r⁻² = π²/6 − Σ_{r≤n} r⁻², without the cancellation of that difference.
///
/// For x ≥ 21 by the asymptotic series ψ₁(x) = 1/x + 1/(2x²) + Σ B_{2k}/x^{2k+1}. Its first omitted
/// term B₁₂/x¹³ is below 4e-17 of the value. For smaller x, terms r⁻² are added to ψ₁(21).
pub(crate) fn trigamma_after(n: usize) -> f64 {
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
        // The recurrence ψ₁(n+1) = ψ₁(n) − 1/n², below and above x = 21.
        for n in 1..200 {
            let step = trigamma_after(n - 1) - trigamma_after(n) - 1.0 / (n * n) as f64;
            assert!(step.abs() < 4.0 * f64::EPSILON * trigamma_after(n - 1), "{n}: {step:e}");
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
    fn terms_for_strong_order_one() {
        // The closed forms ⌈√(m/(12π²h))⌉ and ⌈3/(2π²h)⌉, at steps where neither is close to an
        // integer.
        for exponent in 4..=16 {
            let step = 2f64.powi(-exponent);
            let error = strong_order_one_error(step);
            for m in 2..=6 {
                let closed = (m as f64 / (12.0 * PI * PI * step)).sqrt().ceil() as usize;
                assert_eq!(
                    AreaMethod::MrongowiusRoessler.terms_for(error, step, m),
                    Ok(closed.max(1))
                );
                let closed = (3.0 / (2.0 * PI * PI * step)).ceil() as usize;
                assert_eq!(AreaMethod::Fourier.terms_for(error, step, m), Ok(closed));
            }
        }
        let step = 2f64.powi(-12);
        let terms = AreaMethod::ALL
            .map(|method| method.terms_for(strong_order_one_error(step), step, 3).unwrap());
        assert_eq!(terms, [623, 208, 23, 11]);
        // 2·3 for each term, and 0, 3, 3 and 6 for the tails.
        let normals = AreaMethod::ALL.map(|method| method.normals(11, 3));
        assert_eq!(normals, [66, 69, 69, 72]);
    }

    #[test]
    fn the_number_of_terms_is_the_least() {
        for method in AreaMethod::ALL {
            for m in [2, 3, 7] {
                for terms in [1, 2, 3, 10, 49, 1000, 12_345] {
                    // An error that is reached exactly, and one just below it.
                    let error = method.rms_error(0.3, terms, m);
                    assert_eq!(method.terms_for(error, 0.3, m), Ok(terms), "{method:?}");
                    assert_eq!(
                        method.terms_for(error * (1.0 - 1e-12), 0.3, m),
                        Ok(terms + 1),
                        "{method:?}"
                    );
                }
                // The quotient may round to either side of the integer.
                for terms in 1..500 {
                    let error = method.rms_error(0.3, terms, m);
                    assert_eq!(method.terms_for(error.next_up(), 0.3, m), Ok(terms), "{method:?}");
                    assert_eq!(
                        method.terms_for(error.next_down(), 0.3, m),
                        Ok(terms + 1),
                        "{method:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_cheapest_changes_with_the_step() {
        let cheapest = |step| AreaMethod::cheapest(strong_order_one_error(step), step, 3).unwrap();
        assert_eq!(cheapest(2f64.powi(-12)), (AreaMethod::MrongowiusRoessler, 11));
        // At h = 1/4 an error of 1/8 is allowed: one term is enough, without a tail.
        assert_eq!(cheapest(0.25), (AreaMethod::Fourier, 1));
        for exponent in 0..40 {
            let step = 2f64.powf(-0.5 * f64::from(exponent));
            let error = strong_order_one_error(step);
            let (method, terms) = cheapest(step);
            assert!(method.rms_error(step, terms, 3) <= error);
            for other in AreaMethod::ALL {
                let normals = other.normals(other.terms_for(error, step, 3).unwrap(), 3);
                assert!(method.normals(terms, 3) <= normals);
            }
        }
    }

    #[test]
    fn bad_requests_name_the_value() {
        for method in AreaMethod::ALL {
            for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                let message = method.terms_for(bad, 0.1, 3).unwrap_err().to_string();
                assert!(
                    message.contains("error") && message.ends_with(&format!("got {bad}")),
                    "{message}"
                );
                let message = method.terms_for(0.1, bad, 3).unwrap_err().to_string();
                assert!(
                    message.contains("step") && message.ends_with(&format!("got {bad}")),
                    "{message}"
                );
            }
            let absurd = method.terms_for(1e-300, 1.0, 3).unwrap_err();
            assert!(matches!(absurd, NoiseError::TooManyTerms { .. }), "{absurd}");
        }
        assert!(matches!(AreaMethod::cheapest(1e-9, 1.0, 2), Err(NoiseError::TooManyTerms { .. })));
        assert!(matches!(
            AreaMethod::cheapest(f64::NAN, 1.0, 2),
            Err(NoiseError::AreaErrorNotPositive { .. })
        ));
    }

    #[test]
    fn one_noise_has_no_areas() {
        for method in AreaMethod::ALL {
            for noises in [0, 1] {
                assert_eq!(method.terms_for(1e-9, 0.1, noises), Ok(0));
                assert_eq!((method.rms_error(0.1, 0, noises), method.normals(9, noises)), (0.0, 0));
            }
        }
    }
}
