//! `solvability`: the step has a unique solution once the contraction constant is below one
//! (Bréhier, Cohen and Komori 2025, §3).
//!
//! C_{k,τ} = τ(½‖B′‖‖∇H₀‖ + ‖B‖‖∇²H₀‖) + √(2kτ|log τ|) Σₘ (½‖B′‖‖∇Hₘ‖ + ‖B‖‖∇²Hₘ‖). Two systems
//! have globally Lipschitz data with constant B: the pendulum (‖B‖ = 1) and the three-dimensional
//! Poisson system (‖B‖ = √3), both with ‖∇²H‖ ≤ 1. At the largest step 2^−j with C_{k,τ} < 1,
//! random pairs of points with increments up to the truncation bound are mapped, and the iteration
//! is started from both.

use real::elementary::ln;

use crate::*;

pub(super) fn measure(conditions: &Conditions) -> Findings {
    Findings::of([
        contraction(conditions, 0, paper::pendulum().system(), 1.0, 1.0),
        contraction(conditions, 1, paper::poisson3_strong().system(), 3f64.sqrt(), 1.0),
    ])
}

/// Spread of the random points: several periods of the sines.
const SPREAD: f64 = 10.0;
/// Tolerance for two iterations to agree: round-off, amplified by 1/(1 − C) near the bound.
const AGREEMENT: f64 = 1e-9;

/// The claim for one system, ‖B‖ = `structure`; increments go up to `reach` times the truncation
/// bound.
pub fn contraction<S: PoissonSystem<D, 1>, const D: usize>(
    conditions: &Conditions,
    part: u64,
    system: &S,
    structure: f64,
    reach: f64,
) -> Claim {
    // C_{k,τ} for constant B and ‖∇²H‖ ≤ 1, one noise of size 1. It rises from 0, and below one
    // there is a largest step.
    let constant = |tau: f64| {
        structure * (tau + (2.0 * f64::from(TRUNCATION_ORDER) * tau * ln(tau).abs()).sqrt())
    };
    let exponent = (1..60).find(|&j| constant(0.5f64.powi(j)) < 1.0).unwrap_or(60);
    let tau = 0.5f64.powi(exponent);
    let lipschitz = constant(tau);
    let bound = reach * valid(truncation().bound(tau));
    let mut noise = WienerPath::<1>::new(conditions.key(part), 0);
    let mut point = || -> [f64; D] { std::array::from_fn(|_| noise.normal() * SPREAD) };
    let pairs = conditions.choose(5_000, 500);
    let (mut quotient, mut apart) = (0.0, 0.0);
    for pair in 0..pairs {
        let (z_hat, mut one, mut other) = (point(), point(), point());
        // Increments sweep the whole truncated range, its ends included.
        let dw = bound * (2.0 * f64::from(pair) / f64::from(pairs - 1) - 1.0);
        // ψ(z) of the scheme.
        let psi = |z: [f64; D]| -> [f64; D] {
            let change = system.averaged_field(z_hat, z, tau, [dw]);
            std::array::from_fn(|i| z_hat[i] + change[i])
        };
        let before = distance(&one, &other);
        quotient = worse(quotient, distance(&psi(one), &psi(other)) / before);
        // Cⁿ·distance below round-off.
        for _ in 0..(ln(AGREEMENT * 1e-3 / before) / ln(lipschitz)).ceil() as u32 {
            (one, other) = (psi(one), psi(other));
        }
        apart = worse(apart, distance(&one, &other));
    }
    let words = format!("largest Lipschitz quotient at τ = 2^-{exponent}, k = {TRUNCATION_ORDER}");
    let limits = format!("largest distance between limits from {pairs} pairs of starts");
    let quantities =
        [Bounded::at_most(words, quotient, lipschitz), Bounded::at_most(limits, apart, AGREEMENT)];
    let statement = format!("{}: the step has a unique solution once C(k, τ) < 1", system.name());
    Claim::new("solvability", statement, Evidence::bounds(quantities))
}
