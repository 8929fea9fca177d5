//! Kubo's oscillator: q + ip is turned by −θ with θ normal of mean ωT and variance σ²T, and damped
//! by e^{−∫γ}.

use schemes::{EulerMaruyama, Heun, Midpoint, Sexp};

use super::{
    Entry, How, OldRule, expected,
    law::Normal,
    system::{Plane, Rate, UNDAMPED, problem},
};

/// θ after the time t.
fn angle(omega: f64, sigma: f64, t: f64) -> Normal {
    Normal::new(omega * t, sigma * sigma * t)
}

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp::default();
    let start = [1.0, 0.0];
    let kubo = |omega, sigma, t| problem(Plane::kubo(omega, sigma), UNDAMPED, start, t);
    let q = |y: [f64; 2]| y[0];
    let p_negative = |y: [f64; 2]| f64::from(u8::from(y[1] < 0.0));
    let mut all = vec![
        // E q = E cos θ.
        expected(
            ("Kubo", "q, ω = σ = 1"),
            sexp,
            kubo(1.0, 1.0, 1.0),
            q,
            How::to(0.01),
            angle(1.0, 1.0, 1.0).cos(1.0),
        ),
        // E p = −E sin θ.
        expected(
            ("Kubo", "p, ω = 2, σ = ½, midpoint"),
            Midpoint::default(),
            kubo(2.0, 0.5, 1.0),
            |y| y[1],
            How::to(0.005),
            -angle(2.0, 0.5, 1.0).sin(1.0),
        ),
        // E q² = ½(1 + E cos 2θ).
        expected(
            ("Kubo", "q², ω = σ = 1, Heun"),
            Heun,
            kubo(1.0, 1.0, 1.0),
            |y| y[0] * y[0],
            How::to(0.01),
            0.5 * (1.0 + angle(1.0, 1.0, 1.0).cos(2.0)),
        ),
        // cos³ = ¾ cos + ¼ cos 3θ.
        expected(
            ("Kubo", "q³, ω = 1, σ = ½, T = 2"),
            sexp,
            kubo(1.0, 0.5, 2.0),
            |y| y[0].powi(3),
            How::to(0.01),
            0.75 * angle(1.0, 0.5, 2.0).cos(1.0) + 0.25 * angle(1.0, 0.5, 2.0).cos(3.0),
        ),
        // P(cos θ > ½).
        expected(
            ("indicators", "q > ½, Kubo, ω = σ = 1"),
            sexp,
            kubo(1.0, 1.0, 1.0),
            |y| f64::from(u8::from(y[0] > 0.5)),
            How::to(0.02),
            angle(1.0, 1.0, 1.0).cos_above(0.5),
        ),
        // P(sin θ > 0.3).
        expected(
            ("indicators", "p < −0.3, Kubo, ω = σ = 1, T = 2"),
            sexp,
            kubo(1.0, 1.0, 2.0),
            |y| f64::from(u8::from(y[1] < -0.3)),
            How::to(0.02),
            angle(1.0, 1.0, 2.0).sin_above(0.3),
        ),
        // θ has the median π: sin θ > 0 with probability ½, up to e^{−10⁶}. Coarse paths are all on
        // one side of it.
        expected(
            ("weak noise", "p < 0 at its median, σ = 1e-3, T = π"),
            sexp,
            kubo(1.0, 1e-3, std::f64::consts::PI),
            p_negative,
            How::to(0.02).against(OldRule::NothingMissed),
            0.5,
        ),
        // E q = E cos θ, all but deterministic.
        expected(
            ("weak noise", "q, ω = 2, σ = 0.01"),
            sexp,
            kubo(2.0, 0.01, 1.0),
            q,
            How::to(1e-3),
            angle(2.0, 0.01, 1.0).cos(1.0),
        ),
        expected(
            ("weak noise", "q², ω = 6, σ = 0.1"),
            Heun,
            kubo(6.0, 0.1, 1.0),
            |y| y[0] * y[0],
            How::to(5e-3),
            0.5 * (1.0 + angle(6.0, 0.1, 1.0).cos(2.0)),
        ),
    ];
    // With Euler–Maruyama E(q + ip) after n steps is (1 − ½σ²τ − iωτ)ⁿ. Here its errors of order τ
    // and τ² are such that E q hardly changes from level 2 to level 3, and is far from the limit.
    for (omega, sigma, steps, accuracy) in [(5.1, 0.3, 4, 0.05), (4.7, 1.1, 4, 0.02)] {
        let how = How::to(accuracy).steps(steps).against(OldRule::LastDifference);
        let name = format!("q, ω = {omega}, σ = {sigma}, Euler–Maruyama from {steps} steps");
        let (problem, truth) = (kubo(omega, sigma, 1.0), angle(omega, sigma, 1.0).cos(1.0));
        all.push(expected(("large steps", name), EulerMaruyama, problem, q, how, truth));
    }
    // E q = e^{−∫γ} E cos θ.
    let damped = [
        ("γ = 20", Rate::Constant(20.0), 1e-10),
        ("γ = ½ until 0.37, 3 after", Rate::Jump { at: 0.37, before: 0.5, after: 3.0 }, 2e-3),
        (
            "γ = 1.5e4 on [0.37, 0.3701]",
            Rate::Pulse { start: 0.37, end: 0.3701, height: 1.5e4 },
            2e-3,
        ),
        ("γ = −1", Rate::Constant(-1.0), 0.02),
    ];
    for (name, rate, accuracy) in damped {
        let truth = (-rate.until(1.0)).exp() * angle(1.0, 1.0, 1.0).cos(1.0);
        let problem = problem(Plane::kubo(1.0, 1.0), rate, start, 1.0);
        all.push(expected(("damping", name), sexp, problem, q, How::to(accuracy), truth));
    }
    // Eight steps turn by several radians. With 77.2, the phases of 32 and 64 steps of the midpoint
    // rule are nearly the same, 2n arctan(ω/2n) modulo 2π, and far from ω.
    let aliased = How::to(0.05).against(OldRule::NoResolution);
    for (omega, sigma, how) in
        [(55.6, 0.3, How::to(0.02)), (26.7, 0.3, How::to(0.02)), (77.2, 0.1, aliased)]
    {
        let (name, truth) = (format!("q, ω = {omega}"), angle(omega, sigma, 1.0).cos(1.0));
        let problem = kubo(omega, sigma, 1.0);
        all.push(expected(("fast rotation", name), sexp, problem, q, how, truth));
    }
    all
}
