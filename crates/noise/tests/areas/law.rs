//! What the law of the areas is, given the increments, for all terms of the Fourier series and for
//! a tail replaced.
//!
//! Everything is in units of h/2π for areas and √h for increments, so that A_ij = Σ_r (1/r)(X_i Z_j
//! − X_j Z_i) with Z = Y − √2 w. Write u = w_i² + w_j², s_k = Σ r^{−k} over the terms drawn, t = Σ
//! r⁻² over those that are not.
//!
//! *Characteristic function.* Given Z, A_ij is normal with variance Σ (Z_i² + Z_j²)/r², where
//! Z_i² + Z_j² is χ² with two degrees of freedom and noncentrality 2u:
//! E[e^{iθA} | w] = Π_r (1 + θ²/r²)⁻¹ exp(−uθ²/(r² + θ²)) = exp(−c₀ − uc₁). A tail for the terms
//! with w multiplies it by exp(−uθ²t), one for those without w by exp(−θ²t). With all terms and
//! x = πθ it is Lévy's (x/sinh x) exp(−(u/2)(x coth x − 1)), and since u/2 is exponential,
//! E[e^{iθA}] = e^{−c₀}/(1 + 2c₁) = 1/cosh x.
//!
//! *Cumulants.* The coefficients of θ² and θ⁴ in −c₀ − uc₁ give the variance 2p + 2qu, where p and
//! q are s₂, plus t with the respective tail, and the fourth cumulant (12 + 24u)s₄, to which a
//! normal tail adds nothing. With E u = 2 and E u² = 8 the unconditional moments are E A² = 2p + 4q
//! and E A⁴ = 60 s₄ + 12(p² + 4pq + 8q²): for all terms π² and 5π⁴, that is h²/4 and 5h⁴/16, and
//! the fourth cumulant is h⁴/8 as that of 1/cosh(λh/2) is.
//!
//! *Two areas that share a noise.* E[A_12 A_13 | w] = Σ E[X_1²] E[Z_2 Z_3]/r² = 2q w_2 w_3, the
//! sign being that of the orientation: −2q w_1 w_3 for A_12 A_23, +2q w_1 w_2 for A_13 A_23. Given
//! noise 1, A_12 is linear in the normals of noise 2 and A_13 is the same function of noise 3: both
//! normal, independent, with one variance V. So E[A_12² A_13²] = E[V²] = ⅓E[A_12⁴], for all terms
//! and with either tail (5h⁴/48; independent areas would have h⁴/16).

use std::f64::consts::PI;

use crate::written_out::AreaMethod;

/// The law of areas of which `terms` are drawn (`None`: all of them), and which tails are added.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    terms: Option<usize>,
    noise_tail: bool,
    pair_tail: bool,
}

impl Law {
    pub const EXACT: Self = Self { terms: None, noise_tail: false, pair_tail: false };

    /// That of a method.
    pub fn of(method: AreaMethod, terms: usize) -> Self {
        let noise_tail = method != AreaMethod::Fourier;
        let pair_tail = method == AreaMethod::MrongowiusRoessler;
        Self { terms: Some(terms), noise_tail, pair_tail }
    }

    /// Σ r^{−k} over the terms drawn, k = 2 or 4.
    fn sum(&self, k: i32) -> f64 {
        match self.terms {
            Some(n) => (1..=n).rev().map(|r| (r as f64).powi(-k)).sum(),
            None if k == 2 => PI * PI / 6.0,
            None => PI.powi(4) / 90.0,
        }
    }

    /// t, the Σ r⁻² of the terms that are not drawn.
    fn rest(&self) -> f64 {
        PI * PI / 6.0 - self.sum(2)
    }

    fn p(&self) -> f64 {
        self.sum(2) + if self.pair_tail { self.rest() } else { 0.0 }
    }

    fn q(&self) -> f64 {
        self.sum(2) + if self.noise_tail { self.rest() } else { 0.0 }
    }

    /// (c₀, c₁) at θ.
    pub fn exponents(&self, theta: f64) -> (f64, f64) {
        let Some(n) = self.terms else {
            let x = PI * theta;
            return ((x.sinh() / x).ln(), 0.5 * (x / x.tanh() - 1.0));
        };
        let square = theta * theta;
        let (mut c0, mut c1) = (0.0, 0.0);
        for r in 1..=n {
            let r2 = (r * r) as f64;
            c0 += (square / r2).ln_1p();
            c1 += square / (r2 + square);
        }
        c0 += if self.pair_tail { square * self.rest() } else { 0.0 };
        c1 += if self.noise_tail { square * self.rest() } else { 0.0 };
        (c0, c1)
    }

    /// The numbers that a battery needs again and again.
    pub fn moments(&self) -> Moments {
        let (p, q, s4) = (self.p(), self.q(), self.sum(4));
        Moments {
            p,
            q,
            s4,
            second: 2.0 * p + 4.0 * q,
            fourth: 60.0 * s4 + 12.0 * (p * p + 4.0 * p * q + 8.0 * q * q),
        }
    }
}

/// Moments in units of h/2π.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    p: f64,
    q: f64,
    s4: f64,
    /// E[A²].
    pub second: f64,
    /// E[A⁴].
    pub fourth: f64,
}

impl Moments {
    /// E[A² | u].
    pub fn variance(&self, u: f64) -> f64 {
        2.0 * self.p + 2.0 * self.q * u
    }

    /// E[A⁴ | u].
    pub fn fourth_given(&self, u: f64) -> f64 {
        (12.0 + 24.0 * u) * self.s4 + 3.0 * self.variance(u).powi(2)
    }

    /// E[A_ij A_ik | w]/(w_j w_k).
    pub fn coupling(&self) -> f64 {
        2.0 * self.q
    }
}

#[test]
fn closed_forms_are_limits_of_sums() {
    let (h2, h4) = ((2.0 * PI).powi(-2), (2.0 * PI).powi(-4));
    let exact = Law::EXACT.moments();
    assert!((exact.second * h2 - 1.0 / 4.0).abs() < 1e-15);
    assert!((exact.fourth * h4 - 5.0 / 16.0).abs() < 1e-15);
    for u in [0.0, 0.5, 9.0] {
        assert!((exact.variance(u) * h2 - (1.0 + u) / 12.0).abs() < 1e-15);
    }
    // Both tails leave out c⁴/2 and uc⁴ with c = θ/r: with n terms no more than θ⁴/(6n³) and
    // uθ⁴/(3n³).
    let n: usize = 1000;
    for theta in [0.1, 0.5, 1.0, 2.0] {
        let (x0, x1) = Law::EXACT.exponents(theta);
        let (c0, c1) = Law::of(AreaMethod::MrongowiusRoessler, n).exponents(theta);
        let bound = theta.powi(4) / (3.0 * (n as f64).powi(3)) + 1e-12;
        assert!((x0 - c0).abs() < 0.5 * bound + 1e-12 && (x1 - c1).abs() < bound, "{theta}");
        assert!(((-x0).exp() / (1.0 + 2.0 * x1) - 1.0 / (PI * theta).cosh()).abs() < 1e-14);
    }
}
