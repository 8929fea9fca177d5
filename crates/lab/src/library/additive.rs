//! Additive noise: W itself, its integral, and Langevin equations with normal laws.

use schemes::{EulerMaruyama, Heun, Sexp};

use super::{
    Entry, How, expected,
    law::{Normal, above},
    system::{Plane, Rate, UNDAMPED, problem},
};

/// E|N|^½ of a standard normal, 2^{1/4}Γ(3/4)/√π.
const ROOT: f64 = 1.189_207_115_002_721 * 1.225_416_702_465_177_6 / 1.772_453_850_905_516;

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp::default();
    let origin = [0.0; 2];
    // dq = p dt, dp = dW: p = W(1), q = ∫W with variance ⅓ and covariance ½ with p.
    let integrated = problem(Plane::additive(0.0, 1.0, 1.0), UNDAMPED, origin, 1.0);
    // dp = −q dt − γp dt + dW, dq = p dt − γq dt. With a = b = ω the state is e^{−γT} times y₀ turned,
    // plus a normal of covariance ∫ e^{−2γs}(sin² ωs, sin ωs cos ωs; cos² ωs) ds.
    let (gamma, omega, t) = (0.7, 2.0, 1.5);
    let langevin =
        problem(Plane::additive(omega, omega, 1.0), Rate::Constant(gamma), [1.0, 0.0], t);
    let decay = (-gamma * t).exp();
    // ∫ e^{−2γs} cos 2ωs ds = [e^{−2γs}(ω sin 2ωs − γ cos 2ωs)]/(2(γ² + ω²)).
    let primitive = |s: f64| {
        (-2.0 * gamma * s).exp()
            * (omega * (2.0 * omega * s).sin() - gamma * (2.0 * omega * s).cos())
            / (2.0 * (gamma * gamma + omega * omega))
    };
    let (whole, wave) = ((1.0 - decay * decay) / (2.0 * gamma), primitive(t) - primitive(0.0));
    let q = Normal::new(decay * (omega * t).cos(), 0.5 * (whole - wave));
    let p = Normal::new(-decay * (omega * t).sin(), 0.5 * (whole + wave));
    // γ alone: Ornstein–Uhlenbeck, p of variance (1 − e^{−2γT})/(2γ).
    let relaxed = problem(Plane::additive(0.0, 0.0, 1.0), Rate::Constant(2.0), [0.0, 1.0], 1.0);
    let ornstein = Normal::new((-2.0f64).exp(), 0.25 * (1.0 - (-4.0f64).exp()));
    vec![
        // P(W > 1).
        expected(
            ("additive noise", "W > 1"),
            sexp,
            integrated.clone(),
            |y| f64::from(u8::from(y[1] > 1.0)),
            How::to(0.01),
            above(1.0),
        ),
        // E(W − K)₊ = φ(K) − KΦ(−K).
        expected(
            ("additive noise", "(W − ½)₊"),
            sexp,
            integrated.clone(),
            |y| (y[1] - 0.5).max(0.0),
            How::to(0.01),
            (-0.125f64).exp() / std::f64::consts::TAU.sqrt() - 0.5 * above(0.5),
        ),
        // E e^W = e^{½}.
        expected(
            ("additive noise", "e^W"),
            sexp,
            integrated.clone(),
            |y| y[1].exp(),
            How::to(0.05),
            0.5f64.exp(),
        ),
        // E q² = ⅓.
        expected(
            ("additive noise", "(∫W)²"),
            Heun,
            integrated.clone(),
            |y| y[0] * y[0],
            How::to(0.01),
            1.0 / 3.0,
        ),
        // P(∫W > ½), ∫W normal of variance ⅓.
        expected(
            ("additive noise", "∫W > ½, Euler–Maruyama"),
            EulerMaruyama,
            integrated.clone(),
            |y| f64::from(u8::from(y[0] > 0.5)),
            How::to(0.02),
            Normal::new(0.0, 1.0 / 3.0).above(0.5),
        ),
        // E|q|^½ = (1/3)^{1/4} E|N|^½: a cusp where the density is largest.
        expected(
            ("kinks", "|∫W|^½"),
            sexp,
            integrated,
            |y| y[0].abs().sqrt(),
            How::to(0.01),
            (1.0f64 / 3.0).powf(0.25) * ROOT,
        ),
        expected(
            ("Langevin", "q > 0.2"),
            sexp,
            langevin.clone(),
            |y| f64::from(u8::from(y[0] > 0.2)),
            How::to(0.02),
            q.above(0.2),
        ),
        // E p² = mean² + variance.
        expected(
            ("Langevin", "p²"),
            sexp,
            langevin.clone(),
            |y| y[1] * y[1],
            How::to(0.01),
            p.mean * p.mean + p.deviation * p.deviation,
        ),
        expected(
            ("Langevin", "cos q, Heun"),
            Heun,
            langevin,
            |y| y[0].cos(),
            How::to(0.01),
            q.cos(1.0),
        ),
        expected(
            ("Langevin", "|p − ½|, Ornstein–Uhlenbeck"),
            sexp,
            relaxed,
            |y| (y[1] - 0.5).abs(),
            How::to(0.01),
            {
                // E|X| = s√(2/π)e^{−m²/2s²} + m(1 − 2Φ(−m/s)) with m = mean − ½.
                let (m, s) = (ornstein.mean - 0.5, ornstein.deviation);
                s * (2.0 / std::f64::consts::PI).sqrt() * (-0.5 * m * m / (s * s)).exp()
                    + m * (1.0 - 2.0 * above(m / s))
            },
        ),
    ]
}
