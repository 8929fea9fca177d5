//! so(3): time changes, rotations about one axis, Brownian motion on the sphere, and noise without
//! effect.
//!
//! Linear noises Hₘ = σ_m·y without a drift have the generator ½Σ L_m² with the rotations L_m
//! about σ_m: E y = exp(½T Σ(σ_mσ_mᵀ − |σ_m|²I)) y₀. Three of size σ along the axes have the
//! Laplacian of the sphere, and E of a harmonic polynomial of degree l decays by
//! e^{−l(l+1)σ²T/2}; a linear H₀ turns it.

use schemes::{Sexp, SexpLevy};

use super::{
    Entry, expected,
    law::Normal,
    system::{Body, Rate, START, on_sphere, problem},
};

/// E y₁ where (y₁, y₂) = r(cos, sin)(φ − θ): y₁ cos θ + y₂ sin θ.
fn turned(theta: Normal) -> f64 {
    START[0] * theta.cos(1.0) + START[1] * theta.sin(1.0)
}

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp;
    let first = |y: [f64; 3]| y[0];
    // One noise.
    let one = |kind, name, problem, function, accuracy, truth| {
        expected((kind, name), sexp, problem, function, accuracy, truth)
    };
    // A symmetric top with H₁ = cH₀: θ = (a₃ − a₁)y₃(T + cW).
    let top = Body::top(0.0, 1.4);
    let rate = 2.0 * START[2];
    // With damping y₃ decays, and so does the rate of θ: with y₃(t) = y₃e^{−∫γ} and γ = 1 on
    // [0, 0.6], ∫e^{−Γ} = 1 − e^{−0.6} + 0.4e^{−0.6} and ∫e^{−2Γ} = ½(1 − e^{−1.2}) + 0.4e^{−1.2}.
    let damping = Rate::Jump { at: 0.6, before: 1.0, after: 0.0 };
    let (e, e2) = ((-0.6f64).exp(), (-1.2f64).exp());
    let (mean, square) = (1.0 - e + 0.4 * e, 0.5 * (1.0 - e2) + 0.4 * e2);
    let damped = Normal::new(rate * mean, (0.7 * rate).powi(2) * square);
    // About one axis: θ = (c₃ + a₃y₃)T + (σ₃ + b y₃)W.
    let axis = Body {
        a: [0.0, 0.0, 1.0],
        c: [0.0, 0.0, 0.5],
        b: [0.5],
        ..Body::linear([[0.0, 0.0, 0.8]])
    };
    let about = Normal::new(0.5 + START[2], (0.8 + 0.5 * START[2]).powi(2));
    // Two noises: Σσσᵀ − |σ|²I = −σ² diag(1, 1, 2).
    let plane = Body::linear([[0.8, 0.0, 0.0], [0.0, 0.8, 0.0]]);
    let accuracy = 0.005;
    let three = |name, sigma: f64, function, truth| {
        let problem = on_sphere(Body::isotropic(sigma));
        expected(("sphere", name), sexp, problem, function, accuracy, truth)
    };
    let linear = (-0.49f64).exp();
    let third = START[2];
    vec![
        one(
            "time change",
            "y₁ of a damped top, c = 0.7",
            problem(top, damping, START, 1.0),
            first,
            0.005,
            e * turned(damped),
        ),
        one("one axis", "y₁", on_sphere(axis), first, 0.005, turned(about)),
        expected(
            ("sphere", "y₃, two noises, areas"),
            SexpLevy::new(&plane, START),
            on_sphere(plane),
            |y| y[2],
            0.01,
            third * (-0.64f64).exp(),
        ),
        three("y₃, three noises", 0.7, |y| y[2], third * linear),
        // Turned by 2T about the third axis, clockwise.
        expected(
            ("sphere", "y₁, three noises on a rotation"),
            sexp,
            on_sphere(Body { c: [0.0, 0.0, 2.0], ..Body::isotropic(0.5) }),
            first,
            0.01,
            (-0.25f64).exp() * turned(Normal::new(2.0, 0.0)),
        ),
        // H₁ is a Casimir, which does nothing; and the same with weak noise about the axis of the
        // top.
        one(
            "Casimir noise",
            "y₁ of a top, H₁ = |y|²",
            on_sphere(Body::top(2.0, 0.0)),
            first,
            0.01,
            turned(Normal::new(rate, 0.0)),
        ),
    ]
}
