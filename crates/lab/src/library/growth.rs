//! Lotka–Volterra structure with logarithmic Hamiltonians: two geometric Brownian motions.

use schemes::{EulerMaruyama, Heun};

use super::{
    Entry, How, expected, indicator,
    law::Normal,
    system::{Rate, UNDAMPED, growth},
};

pub fn entries() -> Vec<Entry> {
    let heun = |name, rate, function, accuracy, truth| {
        expected(("geometric", name), Heun, growth(rate), function, How::to(accuracy), truth)
    };
    // ln x = bT + βW and ln y = −aT − αW − ∫γ.
    let x = Normal::new(0.3, 0.36);
    vec![
        heun("x, Heun", UNDAMPED, |y| y[0], 0.02, x.exp(1.0)),
        heun("x², Heun", UNDAMPED, |y| y[0] * y[0], 0.1, x.exp(2.0)),
        expected(
            ("geometric", "x > 2, Euler–Maruyama"),
            EulerMaruyama,
            growth(UNDAMPED),
            |y| indicator(y[0] > 2.0),
            How::to(0.02),
            x.above(2.0f64.ln()),
        ),
        // ln(xy) = (b − a)T + (β − α)W.
        heun("xy, Heun", UNDAMPED, |y| y[0] * y[1], 0.01, Normal::new(-0.1, 0.01).exp(1.0)),
        heun(
            "y with γ = ½, Heun",
            Rate::Constant(0.5),
            |y| y[1],
            0.01,
            Normal::new(-0.4 - 0.5, 0.25).exp(1.0),
        ),
    ]
}
