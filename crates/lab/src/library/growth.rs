//! Lotka–Volterra structure with logarithmic Hamiltonians: two geometric Brownian motions.

use schemes::{EulerMaruyama, Heun};

use super::{
    Entry, How, expected,
    law::Normal,
    system::{Growth, Rate, UNDAMPED, problem},
};

pub fn entries() -> Vec<Entry> {
    // ln x = bT + βW and ln y = −aT − αW − ∫γ.
    let growth = Growth { drift: [0.4, 0.3], noise: [0.5, 0.6] };
    let x = Normal::new(0.3, 0.36);
    let (free, start) = (problem(growth, UNDAMPED, [1.0, 1.0], 1.0), [1.0, 1.0]);
    let damped = problem(growth, Rate::Constant(0.5), start, 1.0);
    vec![
        expected(("geometric", "x, Heun"), Heun, free.clone(), |y| y[0], How::to(0.02), x.exp(1.0)),
        expected(
            ("geometric", "x², Heun"),
            Heun,
            free.clone(),
            |y| y[0] * y[0],
            How::to(0.1),
            x.exp(2.0),
        ),
        expected(
            ("geometric", "x > 2, Euler–Maruyama"),
            EulerMaruyama,
            free.clone(),
            |y| f64::from(u8::from(y[0] > 2.0)),
            How::to(0.02),
            x.above(2.0f64.ln()),
        ),
        // ln(xy) = (b − a)T + (β − α)W.
        expected(
            ("geometric", "xy, Heun"),
            Heun,
            free,
            |y| y[0] * y[1],
            How::to(0.01),
            Normal::new(-0.1, 0.01).exp(1.0),
        ),
        expected(
            ("geometric", "y with γ = ½, Heun"),
            Heun,
            damped,
            |y| y[1],
            How::to(0.01),
            Normal::new(-0.4 - 0.5, 0.25).exp(1.0),
        ),
    ]
}
