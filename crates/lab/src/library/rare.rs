//! Rare events, at several levels and accuracies.

use schemes::Sexp;

use super::{
    Entry, How, OldRule, expected,
    law::{Normal, above},
    system::{Plane, UNDAMPED, problem},
};

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp::default();
    let walk = problem(Plane::additive(0.0, 0.0, 1.0), UNDAMPED, [0.0; 2], 1.0);
    let w = |name: &'static str, function, accuracy, truth| {
        let how = How::to(accuracy).against(OldRule::NothingMissed);
        expected(("rare events", name), sexp, walk.clone(), function, how, truth)
    };
    let kubo = |sigma: f64| problem(Plane::kubo(0.0, sigma), UNDAMPED, [1.0, 0.0], 1.0);
    let how = How::to(0.004).against(OldRule::NothingMissed);
    vec![
        w("W > 2.33", |y| f64::from(u8::from(y[1] > 2.33)), 5e-3, above(2.33)),
        w("W > 3.09", |y| f64::from(u8::from(y[1] > 3.09)), 1e-3, above(3.09)),
        w("W > 3.29", |y| f64::from(u8::from(y[1] > 3.29)), 2e-4, above(3.29)),
        w("W > 4", |y| f64::from(u8::from(y[1] > 4.0)), 1e-4, above(4.0)),
        // E(W − 3)₊ = φ(3) − 3Φ(−3).
        w(
            "(W − 3)₊",
            |y| (y[1] - 3.0).max(0.0),
            5e-4,
            (-4.5f64).exp() / std::f64::consts::TAU.sqrt() - 3.0 * above(3.0),
        ),
        // cos θ < −0.8: the angle beyond 2.498.
        expected(
            ("rare events", "q < −0.8, Kubo"),
            sexp,
            kubo(1.0),
            |y| f64::from(u8::from(y[0] < -0.8)),
            how,
            1.0 - Normal::new(0.0, 1.0).cos_above(-0.8),
        ),
        expected(
            ("rare events", "q < −0.6, Kubo, σ = 0.9"),
            sexp,
            kubo(0.9),
            |y| f64::from(u8::from(y[0] < -0.6)),
            how,
            1.0 - Normal::new(0.0, 0.81).cos_above(-0.6),
        ),
    ]
}
