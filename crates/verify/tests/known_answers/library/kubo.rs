//! Kubo's oscillator: q + ip is turned by −θ with θ normal of mean ωT and variance σ²T, and damped
//! by e^{−∫γ}. And two of them side by side.

use std::f64::consts::PI;

use schemes::{EulerMaruyama, Midpoint, Sexp};

use super::{
    Entry, How, expected, indicator,
    law::Normal,
    system::{Rate, damped_kubo, kubo, planes},
};

/// θ after the time t.
fn angle(omega: f64, sigma: f64, t: f64) -> Normal {
    Normal::new(omega * t, sigma * sigma * t)
}

pub fn entries() -> Vec<Entry> {
    let q = |y: [f64; 2]| y[0];
    let sexp = |kind, name, [omega, sigma, t]: [f64; 3], function, accuracy, truth| {
        let problem = kubo(omega, sigma, t);
        expected((kind, name), Sexp, problem, function, accuracy, truth)
    };
    let theta = angle(1.0, 1.0, 1.0);
    let mut all = vec![
        // E q = E cos θ.
        sexp("Kubo", "q, ω = σ = 1", [1.0; 3], q, 0.01, theta.cos(1.0)),
        // E p = −E sin θ.
        expected(
            ("Kubo", "p, ω = 2, σ = ½, midpoint"),
            Midpoint,
            kubo(2.0, 0.5, 1.0),
            |y| y[1],
            0.005,
            -angle(2.0, 0.5, 1.0).sin(1.0),
        ),
        // P(cos θ > ½).
        sexp(
            "indicators",
            "q > ½, Kubo, ω = σ = 1",
            [1.0; 3],
            |y| indicator(y[0] > 0.5),
            0.02,
            theta.cos_above(0.5),
        ),
        // P(sin θ > 0.3).
        sexp(
            "indicators",
            "p < −0.3, Kubo, ω = σ = 1, T = 2",
            [1.0, 1.0, 2.0],
            |y| indicator(y[1] < -0.3),
            0.02,
            angle(1.0, 1.0, 2.0).sin_above(0.3),
        ),
        // θ has the median π: sin θ > 0 with probability ½, up to e^{−10⁶}. Coarse paths are all on
        // one side of it.
        sexp(
            "weak noise",
            "p < 0 at its median, σ = 1e-3, T = π",
            [1.0, 1e-3, PI],
            |y| indicator(y[1] < 0.0),
            0.02,
            0.5,
        ),
    ];
    // With Euler–Maruyama E(q + ip) after n steps is (1 − ½σ²τ − iωτ)ⁿ. Here its errors of order τ
    // and τ² are such that E q hardly changes from level 2 to level 3, and is far from the limit.
    for (omega, sigma, accuracy) in [(5.1, 0.3, 0.05), (4.7, 1.1, 0.02)] {
        let how = How { accuracy, steps: 4 };
        let name = format!("q, ω = {omega}, σ = {sigma}, Euler–Maruyama from 4 steps");
        let (problem, truth) = (kubo(omega, sigma, 1.0), angle(omega, sigma, 1.0).cos(1.0));
        all.push(expected(("large steps", name), EulerMaruyama, problem, q, how, truth));
    }
    // E q = e^{−∫γ} E cos θ.
    for (name, rate, accuracy) in
        [("γ = 20", Rate::Constant(20.0), 1e-10), ("γ = ½ until 0.37, 3 after", Rate::JUMP, 2e-3)]
    {
        let truth = (-rate.until(1.0)).exp() * theta.cos(1.0);
        let problem = damped_kubo(1.0, 1.0, rate, 1.0);
        all.push(expected(("damping", name), Sexp, problem, q, accuracy, truth));
    }
    // Eight steps turn by several radians. With 77.2, the phases of 32 and 64 steps of the midpoint
    // rule are nearly the same, 2n arctan(ω/2n) modulo 2π, and far from ω.
    for (omega, sigma, accuracy) in [(26.7, 0.3, 0.02), (77.2, 0.1, 0.05)] {
        let (name, truth) = (format!("q, ω = {omega}"), angle(omega, sigma, 1.0).cos(1.0));
        let problem = kubo(omega, sigma, 1.0);
        all.push(expected(("fast rotation", name), Sexp, problem, q, accuracy, truth));
    }
    all.extend(planes_entries());
    all
}

/// Two planes: a fast rotation beside a slow one, and two noises that commute.
fn planes_entries() -> [Entry; 3] {
    let entry = |kind, name, problem, function, accuracy, truth| {
        expected((kind, name), Sexp, problem, function, accuracy, truth)
    };
    let beside = planes([77.2, 1.0], [[0.0; 2], [0.3, 0.4]]);
    let slow = planes([1.0, -2.0], [[1.0, 0.5], [0.3, -0.6]]);
    // The angles after the time one are normal of mean ω and variance Σ σ².
    let q2 = Normal::new(1.0, 0.3 * 0.3 + 0.4 * 0.4).cos(1.0);
    [
        entry("fast rotation", "the slow q₂ beside ω = 77.2", beside, |y| y[2], 0.02, q2),
        // q₁q₂ = ½(cos(θ₁ − θ₂) + cos(θ₁ + θ₂)), with the variances |σ₁ ∓ σ₂|².
        entry(
            "commuting noises",
            "q₁q₂ of two planes",
            slow.clone(),
            |y| y[0] * y[2],
            0.01,
            0.5 * (Normal::new(3.0, 0.7f64.powi(2) + 1.1f64.powi(2)).cos(1.0)
                + Normal::new(-1.0, 1.3f64.powi(2) + 0.1f64.powi(2)).cos(1.0)),
        ),
        entry(
            "commuting noises",
            "q₁² of two planes",
            slow,
            |y| y[0] * y[0],
            0.01,
            0.5 * (1.0 + Normal::new(1.0, 1.0 + 0.5 * 0.5).cos(2.0)),
        ),
    ]
}
