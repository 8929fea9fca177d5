//! What the law of the areas is, given the increments, for all terms of the Fourier series and for
//! a tail replaced.
//!
//! Everything is in units of h/2π for areas and √h for increments, so that A_ij = Σ_r (1/r)(X_i Z_j
//! − X_j Z_i) with Z = Y − √2 w. Write u = w_i² + w_j², s_k = Σ r^{−k} over the terms drawn, t = Σ
//! r⁻² over those that are not.
//!
//! *Characteristic function.* Given Z, A_ij is normal with variance Σ (Z_i² + Z_j²)/r², where
//! Z_i² + Z_j² is χ² with two degrees of freedom and noncentrality 2u:
//! E[e^{iθA} | w] = Π_r (1 + θ²/r²)⁻¹ exp(−uθ²/(r² + θ²)) = exp(−c₀ − uc₁). The tails multiply it
//! by exp(−θ²t) and exp(−uθ²t). With all terms and x = πθ it is Lévy's
//! (x/sinh x) exp(−(u/2)(x coth x − 1)), and since u/2 is exponential,
//! E[e^{iθA}] = e^{−c₀}/(1 + 2c₁) = 1/cosh x.
//!
//! *Cumulants.* The coefficients of θ² and θ⁴ in −c₀ − uc₁ give the variance 2p(1 + u), where p is
//! s₂ + t = π²/6, and the fourth cumulant (12 + 24u)s₄, to which a normal tail adds nothing. With
//! E u = 2 and E u² = 8 the unconditional moments are E A² = 6p and E A⁴ = 60 s₄ + 156p²: for all
//! terms π² and 5π⁴, that is h²/4 and 5h⁴/16, and the fourth cumulant is h⁴/8 as that of
//! 1/cosh(λh/2) is.
//!
//! *Two areas that share a noise.* E[A_12 A_13 | w] = Σ E[X_1²] E[Z_2 Z_3]/r² = 2p w_2 w_3, the
//! sign being that of the orientation: −2p w_1 w_3 for A_12 A_23, +2p w_1 w_2 for A_13 A_23. Given
//! noise 1, A_12 is linear in the normals of noise 2 and A_13 is the same function of noise 3: both
//! normal, independent, with one variance V. So E[A_12² A_13²] = E[V²] = ⅓E[A_12⁴] (for all terms
//! 5h⁴/48; independent areas would have h⁴/16).

use std::f64::consts::PI;

/// p.
const P: f64 = PI * PI / 6.0;

/// The law of areas of which so many terms are drawn, and tails for the others.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    /// `None`: all of them.
    terms: Option<usize>,
    s4: f64,
}

impl Law {
    pub const EXACT: Self = Self { terms: None, s4: PI * PI * PI * PI / 90.0 };
    /// E[A²].
    pub const SECOND: f64 = 6.0 * P;
    /// E[A_ij A_ik | w]/(w_j w_k).
    pub const COUPLING: f64 = 2.0 * P;

    pub fn of(terms: usize) -> Self {
        let s4 = (1..=terms).rev().map(|r| (r as f64).powi(-4)).sum();
        Self { terms: Some(terms), s4 }
    }

    /// (c₀, c₁) at θ.
    pub fn exponents(&self, theta: f64) -> (f64, f64) {
        let Some(n) = self.terms else {
            let x = PI * theta;
            return ((x.sinh() / x).ln(), 0.5 * (x / x.tanh() - 1.0));
        };
        let square = theta * theta;
        let rest = square * (P - (1..=n).rev().map(|r| (r as f64).powi(-2)).sum::<f64>());
        (1..=n).map(|r| (r * r) as f64).fold((rest, rest), |(c0, c1), r2| {
            (c0 + (square / r2).ln_1p(), c1 + square / (r2 + square))
        })
    }

    /// E[A⁴].
    pub fn fourth(&self) -> f64 {
        60.0 * self.s4 + 156.0 * P * P
    }

    /// E[A² | u].
    pub fn variance(&self, u: f64) -> f64 {
        2.0 * P * (1.0 + u)
    }

    /// E[A⁴ | u].
    pub fn fourth_given(&self, u: f64) -> f64 {
        (12.0 + 24.0 * u) * self.s4 + 3.0 * self.variance(u).powi(2)
    }
}

#[test]
fn closed_forms_are_limits_of_sums() {
    assert!((Law::EXACT.fourth() / (2.0 * PI).powi(4) - 5.0 / 16.0).abs() < 1e-15);
    // Both tails leave out c⁴/2 and uc⁴ with c = θ/r: with n terms no more than θ⁴/(6n³) and
    // uθ⁴/(3n³).
    let n: usize = 1000;
    for theta in [0.1, 0.5, 1.0, 2.0] {
        let (x0, x1) = Law::EXACT.exponents(theta);
        let (c0, c1) = Law::of(n).exponents(theta);
        let bound = theta.powi(4) / (3.0 * (n as f64).powi(3)) + 1e-12;
        assert!((x0 - c0).abs() < 0.5 * bound + 1e-12 && (x1 - c1).abs() < bound, "{theta}");
        assert!(((-x0).exp() / (1.0 + 2.0 * x1) - 1.0 / (PI * theta).cosh()).abs() < 1e-14);
    }
}
