//! Root-mean-square errors at a step size, on Kubo's oscillator.
//!
//! A step multiplies q + ip, as a complex number, by A(a) with a = ωτ + σΔW, where the solution
//! turns by e^{−ia}. Steps are independent: after n of them
//! E|Π A − Π e^{−ia}|² = (E|A|²)ⁿ + 1 − 2 Re (E[A e^{ia}])ⁿ, with expectations over one normal.

use analysis::{StepSizes, strong_order};
use mc::Setup;
use noise::StreamKey;
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme};
use stats::Point;

use super::{
    Entry, Question, Stated,
    law::Normal,
    orders::cost,
    system::{Plane, kubo},
    truncation,
};

/// Real and imaginary part of A(a).
type Factor = fn(a: f64, correction: f64) -> [f64; 2];

/// Euler–Maruyama, A = 1 − ½σ²τ − ia.
fn euler(a: f64, correction: f64) -> [f64; 2] {
    [1.0 - correction, -a]
}

/// Heun, A = 1 − ia − ½a².
fn heun(a: f64, _: f64) -> [f64; 2] {
    [1.0 - 0.5 * a * a, -a]
}

/// The midpoint rule, A = (1 − ½ia)/(1 + ½ia).
fn midpoint(a: f64, _: f64) -> [f64; 2] {
    let square = 0.25 * a * a;
    [(1.0 - square) / (1.0 + square), -a / (1.0 + square)]
}

/// The error after n steps on [0, 1].
fn error(factor: Factor, omega: f64, sigma: f64, n: i32) -> f64 {
    let tau = 1.0 / f64::from(n);
    let law = Normal::new(omega * tau, sigma * sigma * tau);
    let correction = 0.5 * sigma * sigma * tau;
    let of = |f: fn([f64; 2], f64) -> f64| law.expect(|a| f(factor(a, correction), a));
    let square = of(|[x, y], _| x * x + y * y);
    let real = of(|[x, y], a| x * a.cos() - y * a.sin());
    let imaginary = of(|[x, y], a| x * a.sin() + y * a.cos());
    let angle = f64::from(n) * imaginary.atan2(real);
    (square.powi(n) + 1.0 - 2.0 * real.hypot(imaginary).powi(n) * angle.cos()).sqrt()
}

const COARSEST: u64 = 8;

/// The error at the step size number `index`, with `refinement` step sizes beyond the last.
fn entry<X: Scheme<Plane, 2, 1> + Copy + 'static>(
    scheme: X,
    factor: Factor,
    [omega, sigma]: [f64; 2],
    index: usize,
    refinement: u32,
) -> Entry {
    let n = (COARSEST as i32) << index;
    let name = format!("{}: Kubo, ω = {omega}, σ = {sigma}, τ = 1/{n}", scheme.id());
    let problem = kubo(omega, sigma, 1.0);
    let ask = move |key: StreamKey| {
        let levels = index.max(3) + 1;
        let sizes = StepSizes { levels, refinement, ..StepSizes::new(COARSEST, truncation(), key) };
        let stated = match strong_order(&Setup::of(&problem, &scheme), &sizes) {
            Ok(order) => interval(order.points.get(index)),
            Err(error) => Stated::undecided(error),
        };
        (stated, cost(&sizes))
    };
    let truth = Some(error(factor, omega, sigma, n));
    Entry::new("Kubo", name, Question::StrongError, truth, ask)
}

/// The interval of a point.
fn interval(point: Option<&Point>) -> Stated {
    match point {
        Some(&Point::Error { lo: Some(lo), hi: Some(hi), .. }) => Stated::Interval(lo, hi),
        _ => Stated::undecided("no point with an interval"),
    }
}

pub fn entries() -> Vec<Entry> {
    let (em, half) = (EulerMaruyama, Midpoint);
    vec![
        entry(em, euler, [1.0, 1.0], 0, 2),
        entry(Heun, heun, [1.0, 0.5], 3, 1),
        entry(half, midpoint, [1.0, 1.0], 2, 2),
    ]
}
