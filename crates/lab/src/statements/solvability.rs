//! `solvability`: the step has a unique solution once the contraction constant is below one (paper,
//! `lem:scheme`).
//!
//! C_{k,τ} = τ(½‖B′‖‖∇H₀‖ + ‖B‖‖∇²H₀‖) + √(2kτ|log τ|) Σₘ (½‖B′‖‖∇Hₘ‖ + ‖B‖‖∇²Hₘ‖). Two systems
//! have globally Lipschitz data with constant B: the pendulum (‖B‖ = 1) and the three-dimensional
//! Poisson system (‖B‖ = √3), both with ‖∇²H‖ ≤ 1. At the largest step 2^−j with C_{k,τ} < 1,
//! random pairs of points with increments up to the truncation bound are mapped, and the iteration
//! is started from both.

use noise::WienerPath;
use real::elementary;
use systems::paper::valid;
use systems::{Pendulum, Poisson3, PoissonSystem};
use verify::results::Claim;
use verify::{claim, decide, worse};

use crate::experiment::{Context, TRUNCATION_ORDER, bound};

pub(super) fn measure(context: &Context<'_>) -> Vec<Claim> {
    context.progress.begin("solvability", 2);
    let claims = vec![
        contraction::<_, 2>(context, 0, &valid(Pendulum::new(1.0)), 1.0, 1.0),
        contraction::<_, 3>(context, 1, &valid(Poisson3::new(1.0)), 3f64.sqrt(), 1.0),
    ];
    context.progress.end();
    claims
}

/// C_{k,τ} for constant B and ‖∇²H‖ ≤ 1, one noise of size 1.
fn constant(tau: f64, structure: f64) -> f64 {
    structure * (tau + (2.0 * f64::from(TRUNCATION_ORDER) * tau * tau.ln().abs()).sqrt())
}

/// Points are drawn with this spread: several periods of the sines.
const SPREAD: f64 = 10.0;
/// Two iterations agree when they differ by round-off, amplified by 1/(1 − C) near the bound.
const AGREEMENT: f64 = 1e-9;

/// The claim for one system, ‖B‖ = `structure`; increments go up to `reach` times the truncation
/// bound.
pub(crate) fn contraction<S: PoissonSystem<D, 1>, const D: usize>(
    context: &Context<'_>,
    part: u64,
    system: &S,
    structure: f64,
    reach: f64,
) -> Claim {
    // The constant rises from 0, and below one there is a largest step.
    let exponent = (1..60).find(|&j| constant(0.5f64.powi(j), structure) < 1.0).unwrap_or(60);
    let tau = 0.5f64.powi(exponent);
    let lipschitz = constant(tau, structure);
    let bound = reach * bound(tau);
    let mut noise = WienerPath::<1>::new(context.key(part), 0);
    let mut point = || -> [f64; D] { std::array::from_fn(|_| noise.normal() * SPREAD) };
    let pairs = context.choose(5_000, 500);
    let (mut quotient, mut apart) = (0.0, 0.0);
    for pair in 0..pairs {
        let (z_hat, mut one, mut other) = (point(), point(), point());
        // Increments sweep the whole truncated range, its ends included.
        let dw = bound * (2.0 * f64::from(pair) / f64::from(pairs - 1) - 1.0);
        let distance = norm(&one, &other);
        quotient = worse(
            quotient,
            norm(&map(system, z_hat, one, tau, dw), &map(system, z_hat, other, tau, dw)) / distance,
        );
        // q^n·distance below round-off.
        let sweeps =
            (elementary::ln(AGREEMENT * 1e-3 / distance) / elementary::ln(lipschitz)).ceil() as u32;
        for _ in 0..sweeps {
            one = map(system, z_hat, one, tau, dw);
            other = map(system, z_hat, other, tau, dw);
        }
        apart = worse(apart, norm(&one, &other));
    }
    claim(
        "solvability",
        &format!("{}: the step has a unique solution once C(k, τ) < 1", system.name()),
        decide(quotient <= lipschitz && apart <= AGREEMENT),
        format!(
            "τ = 2^-{exponent}, k = {TRUNCATION_ORDER}: C = {lipschitz:.3}; largest measured Lipschitz quotient {quotient:.3}; \
             iterations from {pairs} pairs of starts end within {apart:.1e} of each other"
        ),
    )
}

fn norm<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// ψ(z) of the scheme.
fn map<S: PoissonSystem<D, 1>, const D: usize>(
    system: &S,
    z_hat: [f64; D],
    z: [f64; D],
    tau: f64,
    dw: f64,
) -> [f64; D] {
    let middle = dgrad::midpoint(z_hat, z);
    let change = system.structure(middle, system.averaged_gradient(z_hat, z, tau, [dw]));
    std::array::from_fn(|i| z_hat[i] + change[i])
}
