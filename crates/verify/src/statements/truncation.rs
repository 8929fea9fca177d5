//! `truncation-moments`: errors from truncating the increments (Bréhier, Cohen and Komori 2025,
//! §3).
//!
//! With ζ standard normal, χ its truncation at A = √(2k|log τ|) and s = |ζ| − A beyond the
//! threshold, E|ζ − χ|ᵖ = 2φ(A) ∫₀^∞ sᵖ e^{−As − s²/2} ds and Eζ² − Eχ² = 2φ(A) ∫₀^∞ s(s + 2A)
//! e^{−As − s²/2} ds: sums of positive terms, where the textbook forms in Q(A) cancel. φ(A) =
//! τᵏ/√(2π).

use std::{f64::consts::PI, ops::RangeInclusive};

use dgrad::Rule;
use real::elementary::{exp, ln, log2, powf, powi};

use crate::*;

/// Orders k and exponents j of τ = 2^−j at which the closed forms are evaluated.
const ORDERS: RangeInclusive<u32> = 1..=6;
const EXPONENTS: RangeInclusive<i32> = 1..=40;
const RANGE: &str = "k = 1 … 6 and τ = 2^-1 … 2^-40";
const ID: &str = "truncation-moments";

/// Threshold A of the truncation.
fn threshold(tau: f64, k: u32) -> f64 {
    (2.0 * f64::from(k) * ln(tau).abs()).sqrt()
}

/// Tail integral 2φ(A)∫₀^∞ g(s) e^{−As − s²/2} ds with φ(A) = τᵏ/√(2π).
fn tail(tau: f64, k: u32, g: impl Fn(f64) -> f64) -> f64 {
    let threshold = threshold(tau, k);
    // Beyond s = 60/(A + 3) the exponential is below e^{−50}, and the powers of s do not matter.
    let end = 60.0 / (threshold + 3.0);
    let integrand = |s| g(s) * exp(-threshold * s - 0.5 * s * s);
    let density = powi(tau, k as i32) / (2.0 * PI).sqrt();
    2.0 * density * valid(Rule::new(128)).integrate(0.0, end, integrand)
}

/// Lost variance E[ζ²] − E[χ²].
fn lost_variance(tau: f64, k: u32) -> f64 {
    tail(tau, k, |s| s * (s + 2.0 * threshold(tau, k)))
}

/// Distance ‖ΔW − ΔŴ‖_{Lᵖ}.
fn distance(tau: f64, k: u32, p: i32) -> f64 {
    tau.sqrt() * powf(tail(tau, k, |s| powi(s, p)), 1.0 / f64::from(p))
}

pub(super) fn measure(conditions: &Conditions) -> Findings {
    let mut fourth = distances(&[4], "4");
    if fourth.verdict == Verdict::Refuted {
        fourth.erratum = "The estimate is stated for all p but holds for p ≤ 2 only, which is all \
                          that the proofs use: the sharp order is τ^(1/2 + k/p)."
            .into();
    }
    let bound = valid(valid(Truncation::new(SAMPLED_ORDER)).bound(SAMPLED_STEP));
    Findings::of([
        variance(),
        sampled_variance(conditions, bound),
        distances(&[1, 2], "1, 2"),
        fourth,
    ])
}

fn variance() -> Claim {
    let (mut largest, mut smallest) = (0.0, f64::INFINITY);
    for (k, j) in ORDERS.flat_map(|k| EXPONENTS.map(move |j| (k, j))) {
        let tau = 0.5f64.powi(j);
        let ratio = lost_variance(tau, k) / ((1.0 + threshold(tau, k)) * powi(tau, k as i32));
        (largest, smallest) = (worse(largest, ratio), f64::min(smallest, ratio));
    }
    let quantities = [
        Bounded::at_least("smallest ratio of the closed form to its bound", smallest, 0.0),
        Bounded::at_most(format!("largest, {RANGE}"), largest, 1.0),
    ];
    Claim::new(ID, "0 ≤ E[ΔW²] − E[ΔŴ²] ≤ (1 + A) τ^(k+1)", Evidence::bounds(quantities))
}

/// Step size and order k at which enough increments are clipped to see the lost variance.
const SAMPLED_STEP: f64 = 0.25;
const SAMPLED_ORDER: u32 = 1;

/// Compares the variance of sampled increments clipped to ±`bound` with the closed form.
pub fn sampled_variance(conditions: &Conditions, bound: f64) -> Claim {
    let samples = conditions.choose(4_000_000, 200_000);
    let mut noise = WienerPath::<1>::new(conditions.key(0), 0);
    let mut lost = CrossMoments::new(1);
    for _ in 0..samples {
        let [dw] = noise.increments(SAMPLED_STEP.sqrt());
        let clipped = dw.clamp(-bound, bound);
        lost.add(&[dw * dw - clipped * clipped]);
    }
    let quantity = format!("E[ΔW²] − E[ΔŴ²] ({samples} increments, τ = 1/4, k = 1)");
    let expected = SAMPLED_STEP * lost_variance(SAMPLED_STEP, SAMPLED_ORDER);
    let measured = Evidence::mean(quantity, lost.mean(0), lost.standard_error(0), expected);
    Claim::new(ID, "sampled increments lose the variance of the closed form", measured)
}

/// Claim ‖ΔW − ΔŴ‖_{Lᵖ} ≤ C τ^((1+k)/2): the ratio of both sides must stay bounded as τ → 0. Since
/// E|ζ − χ|ᵖ ≈ 2φ(A) p!/A^{p+1}, the norm is of order τ^{1/2 + k/p} up to powers of |log τ|: enough
/// for p ≤ 2 only.
fn distances(powers: &[i32], names: &str) -> Claim {
    let [coarse, fine] = [EXPONENTS.start(), EXPONENTS.end()].map(|&j| 0.5f64.powi(j));
    let quantities = powers.iter().flat_map(|&p| {
        let growth = ORDERS.map(|k| {
            let ratio = |tau: f64| distance(tau, k, p) / powf(tau, 0.5 * f64::from(1 + k));
            ratio(fine) / ratio(coarse)
        });
        // The exponent that is seen between two fine steps, at the k of the reproduction.
        let k = TRUNCATION_ORDER;
        let seen = log2(distance(2.0 * fine, k, p) / distance(fine, k, p));
        let (bound, sharp) = (0.5 * f64::from(1 + k), 0.5 + f64::from(k) / f64::from(p));
        let growing = format!("growth of the ratio for p = {p} as τ falls, {RANGE}");
        let exponent = format!(
            "exponent at τ = 2^-40, k = {k} (the bound asks {bound:.1}, 1/2 + k/p is {sharp:.2})"
        );
        [Bounded::at_most(growing, growth.fold(0.0, worse), 1.0), Bounded::reported(exponent, seen)]
    });
    let statement = format!("‖ΔW − ΔŴ‖ in L^p ≤ C τ^((1+k)/2) for p = {names}");
    Claim::new(ID, statement, Evidence::bounds(quantities))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_is_the_textbook_formula() {
        // 2[(1−A²)Q + Aφ], 2[(1+A²)Q − Aφ] and 2[(A⁴+6A²+3)Q − (A³+5A)φ] at A = √(2k|log τ|), to 40
        // digits: in double precision these forms cancel.
        let exact: [(f64, u32, f64, f64, f64); 4] = [
            (0.25, 1, 0.16216598821258041, 0.029615946072350398, 0.03841063415548144),
            (0.1, 1, 0.056306031291669242, 0.0074453473219366392, 0.0077624495073862047),
            (0.1, 2, 0.0044562897048776339, 0.00035674921276788426, 0.00025648882322066853),
            (0.01, 2, 3.3882554161687979e-5, 1.542476863254036e-6, 7.0082714426383272e-7),
        ];
        for (tau, k, lost, square, fourth) in exact {
            // 128 nodes and a few roundings of τᵏ = e^{−A²/2}, whose exponent is up to 10.
            let close = |value: f64, exact: f64| {
                assert!((value / exact - 1.0).abs() < 1e-13, "{tau} {k} {:e}", value / exact - 1.0)
            };
            close(lost_variance(tau, k), lost);
            close(distance(tau, k, 2).powi(2) / tau, square);
            close(distance(tau, k, 4).powi(4) / (tau * tau), fourth);
        }
    }
}
