//! `local-exact` and `local-sexp`: one-step Taylor remainders (Bréhier, Cohen and Komori 2025, §4),
//! on the rigid body with three noises; `local-sexp-li` and `local-split`: the same of schemes that
//! are not in the paper.
//!
//! Exact flow: R = y(τ) − y − τ(f₀ − γy) − Σ fₘΔWₘ − Σ fₘ′f_l J_lm with J_lm = ∫∫ ∘dW_l ∘dWₘ.
//! Scheme: the same with increments truncated if the scheme asks for it and ½ΔŴ_lΔŴₘ for J_lm.
//! Claimed: (E‖R‖²)^½ ≤ Cτ^{3/2} and ‖E R‖ ≤ Cτ².
//!
//! The exact flow is taken on noise that is linear on 64 pieces of the step, with the iterated
//! integrals of that noise: for such noise y(τ) and J_lm are computable to round-off, and the
//! expansion is the same. R(W) and R(−W) are averaged: all terms of odd degree in W cancel, among
//! them those of size τ^{3/2}, so that a mean of size τ² can be seen.

use std::array::from_fn;

use noise::Noise;
use schemes::Scheme;
use stats::{Against, diagonal, fit_weak};
use systems::{Cosine, RigidBody, unit_noise, vector_field, vector_field_derivative};

use crate::*;

/// A point of the rigid body.
pub type Vector = [f64; 3];

/// A scheme for the rigid body.
pub type BodyScheme = dyn Scheme<RigidBody<3>, 3, 3>;

/// Linear pieces of the noise in a step.
pub const PIECES: usize = 64;

/// Measures both claims about the remainder of a scheme; `proven` says whether the paper proves
/// them.
pub(super) fn of_scheme(conditions: &Conditions, scheme: &BodyScheme, proven: bool) -> Findings {
    let remainder = |tau: f64, pieces: &_| scheme_remainder(scheme, tau, pieces);
    let claims = remainder_claims(conditions, scheme.about().id, remainder);
    Findings::of(claims.map(|claim| claim.proven(proven)))
}

/// Measures both claims about a remainder, at steps τ = 2⁻² … 2⁻⁹.
pub fn remainder_claims(
    conditions: &Conditions,
    of: &str,
    remainder: impl Fn(f64, &[Vector; PIECES]) -> Vector,
) -> [Claim; 2] {
    let taus = [2, 3, 4, 5, 6, 7, 8, 9].map(|exponent| 0.5f64.powi(exponent));
    // (E‖R‖²)^½ and ‖E R‖ with the relative variances of both.
    let measured = taus.map(|tau| {
        let mut noise = WienerPath::<3>::new(conditions.key(0), -elementary::log2(tau) as u64);
        let (mut square, mut mean) = (CrossMoments::new(1), CrossMoments::new(3));
        for _ in 0..conditions.choose(4000, 1000) {
            let pieces: [Vector; PIECES] =
                from_fn(|_| noise.increments((tau / PIECES as f64).sqrt()));
            let plus = remainder(tau, &pieces);
            let minus = remainder(tau, &pieces.map(|dw| dw.map(|w| -w)));
            // Both signs have the same law: their average square is one sample of E‖R‖².
            square.add(&[0.5 * (dot(plus, plus) + dot(minus, minus))]);
            mean.add(&[0, 1, 2].map(|i| 0.5 * (plus[i] + minus[i])));
        }
        let root = square.mean(0).sqrt();
        let m = [0, 1, 2].map(|i| mean.mean(i));
        let length = dot(m, m).sqrt();
        // mᵀΣm/|m|², the variance of |m| along m.
        let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
        let variance: f64 = pairs.map(|(i, j)| m[i] * mean.covariance_of_means(i, j) * m[j]).sum();
        let of_root = (square.standard_error(0) / (2.0 * root)).powi(2);
        [(root, of_root), (length, variance / (length * length))]
    });
    [(0, "(E‖R‖²)^½ ≤ C τ^(3/2)", 1.5), (1, "‖E R‖ ≤ C τ²", 2.0)].map(|(which, bound, order)| {
        let values = measured.map(|both| both[which].0);
        let covariance = diagonal(&measured.map(|both| both[which].1));
        let rate = fit_weak(&taus, &values, &covariance, Against::Exact, Expansion::EveryPower);
        let measured = Evidence::Order { order, one_sided: false, rate, wrong_limit: None };
        Claim::new(conditions.id, format!("one-step remainder of {of}: {bound}"), measured)
    })
}

pub(super) fn problem() -> Problem<RigidBody<3>, Cosine, 3> {
    rigid_body_three_noises(1.0)
}

/// First-order part y + τ(f₀ − γy) + Σ fₘwₘ of the expansion, for the exact flow and for schemes.
pub fn first_order(tau: f64, w: Vector) -> Vector {
    let (body, damping, y, _) = problem().into_parts();
    let field = vector_field(&body, y, tau, w);
    let rate = damping.rate(0.0) * tau;
    from_fn(|i| y[i] + field[i] - rate * y[i])
}

/// Difference a − b.
pub fn difference(a: Vector, b: Vector) -> Vector {
    from_fn(|i| a[i] - b[i])
}

pub(super) fn exact_remainder(tau: f64, pieces: &[Vector; PIECES]) -> Vector {
    difference(exact_end(tau, pieces), expansion(tau, pieces))
}

/// Exact state y(τ) on piecewise linear noise.
pub fn exact_end(tau: f64, pieces: &[Vector; PIECES]) -> Vector {
    let (body, damping, mut y, _) = problem().into_parts();
    let length = tau / PIECES as f64;
    for (n, dw) in pieces.iter().enumerate() {
        y = runge_kutta(&body, &damping, n as f64 * length, length, *dw, 1, y);
    }
    y
}

/// Expansion y + τ(f₀ − γy) + Σ fₘΔWₘ + Σ fₘ′f_l J_lm with the iterated integrals of piecewise
/// linear noise.
pub fn expansion(tau: f64, pieces: &[Vector; PIECES]) -> Vector {
    let (body, _, start, _) = problem().into_parts();
    // J_lm with l the inner index.
    let (mut w, mut iterated) = ([0.0; 3], [[0.0; 3]; 3]);
    for dw in pieces {
        for l in 0..3 {
            (0..3).for_each(|m| iterated[l][m] += (w[l] + 0.5 * dw[l]) * dw[m]);
        }
        (0..3).for_each(|m| w[m] += dw[m]);
    }
    let mut sum = first_order(tau, w);
    for m in 0..3 {
        for l in 0..3 {
            let inner = vector_field(&body, start, 0.0, unit_noise(l));
            let term = vector_field_derivative(&body, start, 0.0, unit_noise(m), inner);
            (0..3).for_each(|i| sum[i] += term[i] * iterated[l][m]);
        }
    }
    sum
}

/// Takes a step of a scheme; returns its end, and the increments of the whole step, truncated if
/// the scheme asks for it.
pub fn scheme_end(scheme: &BodyScheme, tau: f64, pieces: &[Vector; PIECES]) -> [Vector; 2] {
    let truncated = if scheme.about().clips_increments { truncation() } else { Truncation::none() };
    let bound = valid(truncated.bound(tau));
    let sum = |m| pieces.iter().map(|dw: &Vector| dw[m]).sum::<f64>().clamp(-bound, bound);
    let (body, damping, y0, _) = problem().into_parts();
    let (step, w) = (valid(Step::new(&damping, 0, tau)), from_fn(sum));
    [scheme.step(&body, &step, &Noise::increments(w), y0).z, w]
}

/// Remainder of a step of a scheme: the step minus its expansion.
pub fn scheme_remainder(scheme: &BodyScheme, tau: f64, pieces: &[Vector; PIECES]) -> Vector {
    let (body, _, start, _) = problem().into_parts();
    let [end, w] = scheme_end(scheme, tau, pieces);
    // ½Σ fₘ′f_l ΔŴ_lΔŴₘ = ½f′f with f = Σ fₘΔŴₘ.
    let field = vector_field(&body, start, 0.0, w);
    let second = vector_field_derivative(&body, start, 0.0, w, field);
    let rest = difference(end, first_order(tau, w));
    from_fn(|i| rest[i] - 0.5 * second[i])
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

#[cfg(test)]
mod tests {
    use schemes::Sexp;

    use super::*;

    #[test]
    fn a_wrong_second_order_term_is_seen() {
        // Without the iterated integrals the remainder is of order τ, not τ^{3/2}: the twin of the
        // measurement.
        let pieces: [Vector; PIECES] = from_fn(|n| [0.01 * (n as f64).sin(), 0.01, -0.004]);
        let scaled = |factor: f64| pieces.map(|dw| dw.map(|w| w * factor));
        let size = |remainder: Vector| dot(remainder, remainder).sqrt();
        let ratio = |f: &dyn Fn(f64, &[Vector; PIECES]) -> Vector| {
            size(f(4e-4, &scaled(0.05))) / size(f(1e-4, &scaled(0.025)))
        };
        // Halving the noise and quartering the step: τ^{3/2} falls by 8, τ by 4.
        assert!((ratio(&exact_remainder) - 8.0).abs() < 0.5, "{}", ratio(&exact_remainder));
        let without = |tau: f64, pieces: &[Vector; PIECES]| {
            let [end, w] = scheme_end(&Sexp, tau, pieces);
            difference(end, first_order(tau, w))
        };
        assert!((ratio(&without) - 4.0).abs() < 0.5, "{}", ratio(&without));
    }
}
