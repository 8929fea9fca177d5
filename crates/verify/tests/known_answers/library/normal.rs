//! Normal laws of additive noise, W itself, its integral and Langevin equations; and of the
//! logarithms of two geometric Brownian motions.

use schemes::{EulerMaruyama, Heun, Sexp};

use super::{
    Entry, expected, indicator,
    law::{Normal, above},
    system::{Plane, Rate, UNDAMPED, growth, integrated, kubo, problem},
};

/// E|N|^½ of a standard normal, 2^{1/4}Γ(3/4)/√π.
const ROOT: f64 = 1.189_207_115_002_721 * 1.225_416_702_465_177_6 / 1.772_453_850_905_516;

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp;
    let walk = |kind, name, function, accuracy, truth| {
        expected((kind, name), sexp, integrated(), function, accuracy, truth)
    };
    // dp = −q dt − γp dt + dW, dq = p dt − γq dt. With a = b = ω the state is e^{−γT} times y₀
    // turned, plus a normal of covariance ∫ e^{−2γs}(sin² ωs, sin ωs cos ωs; cos² ωs) ds.
    let (gamma, omega, t) = (0.7, 2.0, 1.5);
    let langevin = problem(Plane::additive(omega, omega), Rate::Constant(gamma), [1.0, 0.0], t);
    let decay = (-gamma * t).exp();
    // ∫ e^{−2γs} cos 2ωs ds = [e^{−2γs}(ω sin 2ωs − γ cos 2ωs)]/(2(γ² + ω²)).
    let primitive = |s: f64| {
        (-2.0 * gamma * s).exp()
            * (omega * (2.0 * omega * s).sin() - gamma * (2.0 * omega * s).cos())
            / (2.0 * (gamma * gamma + omega * omega))
    };
    let (whole, wave) = ((1.0 - decay * decay) / (2.0 * gamma), primitive(t) - primitive(0.0));
    let p = Normal::new(-decay * (omega * t).sin(), 0.5 * (whole + wave));
    // γ alone: Ornstein–Uhlenbeck, p of variance (1 − e^{−2γT})/(2γ).
    let relaxed = problem(Plane::additive(0.0, 0.0), Rate::Constant(2.0), [0.0, 1.0], 1.0);
    let ornstein = Normal::new((-2.0f64).exp(), 0.25 * (1.0 - (-4.0f64).exp()));
    // E|X| = s√(2/π)e^{−m²/2s²} + m(1 − 2Φ(−m/s)) of X = p − ½.
    let (m, s) = (ornstein.mean - 0.5, ornstein.deviation);
    let distance = s * (2.0 / std::f64::consts::PI).sqrt() * (-0.5 * m * m / (s * s)).exp()
        + m * (1.0 - 2.0 * above(m / s));
    let heun = |name, rate, function, accuracy, truth| {
        expected(("geometric", name), Heun, growth(rate), function, accuracy, truth)
    };
    // ln x = bT + βW and ln y = −aT − αW − ∫γ.
    let x = Normal::new(0.3, 0.36);
    vec![
        expected(("additive noise", "(∫W)²"), Heun, integrated(), |y| y[0] * y[0], 0.01, 1.0 / 3.0),
        // E|q|^½ = (1/3)^{1/4} E|N|^½: a cusp where the density is largest.
        walk("kinks", "|∫W|^½", |y| y[0].abs().sqrt(), 0.01, (1.0f64 / 3.0).powf(0.25) * ROOT),
        // E p² = mean² + variance.
        expected(
            ("Langevin", "p²"),
            sexp,
            langevin.clone(),
            |y| y[1] * y[1],
            0.01,
            p.mean * p.mean + p.deviation * p.deviation,
        ),
        expected(
            ("Langevin", "|p − ½|, Ornstein–Uhlenbeck"),
            sexp,
            relaxed,
            |y| (y[1] - 0.5).abs(),
            0.01,
            distance,
        ),
        heun("x, Heun", UNDAMPED, |y| y[0], 0.02, x.exp(1.0)),
        expected(
            ("geometric", "x > 2, Euler–Maruyama"),
            EulerMaruyama,
            growth(UNDAMPED),
            |y| indicator(y[0] > 2.0),
            0.02,
            x.above(2.0f64.ln()),
        ),
    ]
}

/// Rare events, at several levels and accuracies.
pub fn rare_entries() -> Vec<Entry> {
    let sexp = Sexp;
    let walk = problem(Plane::additive(0.0, 0.0), UNDAMPED, [0.0; 2], 1.0);
    let w = |name, function, accuracy, truth| {
        expected(("rare events", name), sexp, walk.clone(), function, accuracy, truth)
    };
    // cos θ below −x, for θ of variance σ².
    let q = |name, sigma, function, x: f64| {
        let truth = 1.0 - Normal::new(0.0, sigma * sigma).cos_above(-x);
        expected(("rare events", name), sexp, kubo(0.0, sigma, 1.0), function, 0.004, truth)
    };
    vec![
        w("W > 2.33", |y| indicator(y[1] > 2.33), 5e-3, above(2.33)),
        w("W > 4", |y| indicator(y[1] > 4.0), 1e-4, above(4.0)),
        q("q < −0.8, Kubo", 1.0, |y| indicator(y[0] < -0.8), 0.8),
    ]
}
