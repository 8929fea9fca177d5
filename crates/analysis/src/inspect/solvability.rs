//! The contraction constant of the implicit equation of `sexp`.

use std::f64::consts::E;

use real::WIDTH;

use super::{
    algebra::norm,
    probe::{Local, Probe},
    spectrum::spectral_norm,
};

/// The truncation order k.
const ORDER: f64 = 4.0;

/// The step τ̄ ≤ 1/e below which the implicit step of `sexp` is a contraction, and has exactly one
/// solution (solvability lemma of the paper): C(k, τ) < 1 with k = 4 and
///
/// C(k, τ) = τ(½‖B′‖‖∇H₀‖ + ‖B‖‖∇²H₀‖) + √(2kτ|log τ|) Σₘ (½‖B′‖‖∇Hₘ‖ + ‖B‖‖∇²Hₘ‖).
///
/// Each norm is the largest over the points, hence found by search: a supremum may be larger.
pub fn contraction_below(probe: &mut Probe<'_>, points: &[Vec<f64>]) -> f64 {
    let (mut b, mut b_slope) = (0.0f64, 0.0f64);
    // ‖∇Hₘ‖ and ‖∇²Hₘ‖.
    let mut h = vec![(0.0f64, 0.0f64); probe.noises() + 1];
    for chunk in points.chunks(WIDTH) {
        for local in probe.locals(chunk) {
            let Local { b: structure, slopes, gradients, hessians } = local;
            b = b.max(spectral_norm(&structure));
            // The root of ‖Σ_l (∂_l B)ᵀ∂_l B‖ bounds ‖Σ v_l ∂_l B‖ over unit vectors v.
            b_slope = b_slope.max(spectral_norm(&slopes.concat()));
            for ((most, slope), hessian) in h.iter_mut().zip(&gradients).zip(&hessians) {
                *most = (most.0.max(norm(slope)), most.1.max(spectral_norm(hessian)));
            }
        }
    }
    let lipschitz = |&(slope, hessian): &(f64, f64)| 0.5 * b_slope * slope + b * hessian;
    largest_step(lipschitz(&h[0]), h[1..].iter().map(lipschitz).sum())
}

/// The largest τ̄ ≤ 1/e with τ·`drift` + √(2kτ|log τ|)·`noises` < 1 for all τ < τ̄: both grow
/// there.
fn largest_step(drift: f64, noises: f64) -> f64 {
    // False for NaN.
    let contracts =
        |tau: f64| tau * drift + (2.0 * ORDER * tau * tau.ln().abs()).sqrt() * noises < 1.0;
    let (mut below, mut above) = (0.0, 1.0 / E);
    if contracts(above) {
        return above;
    }
    for _ in 0..100 {
        let middle = 0.5 * (below + above);
        if contracts(middle) { below = middle } else { above = middle }
    }
    below
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_step_is_below_all_that_do_not_contract() {
        let tau = largest_step(0.5, 1.0);
        let constant = |tau: f64| 0.5 * tau + (8.0 * tau * tau.ln().abs()).sqrt();
        assert!((constant(tau) - 1.0).abs() < 1e-9 && constant(0.5 * tau) < 1.0, "{tau}");
        // Nothing is solvable where a norm is infinite or unknown.
        let of = [0.0, f64::INFINITY, f64::NAN].map(|drift| largest_step(drift, 0.0));
        assert_eq!(of, [1.0 / E, 0.0, 0.0]);
        for size in [3.0, 2f64.powi(50)] {
            assert!((size * largest_step(size, 0.0) - 1.0).abs() < 1e-9, "{size}");
        }
    }
}
