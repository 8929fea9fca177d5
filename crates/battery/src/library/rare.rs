//! Rare events, at several levels and accuracies.

use schemes::Sexp;

use super::{
    Entry, How, OldRule, expected, indicator,
    law::{Normal, above, excess},
    system::{Plane, UNDAMPED, kubo, problem},
};

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp;
    let how = |accuracy| How::to(accuracy).against(OldRule::NothingMissed);
    let walk = problem(Plane::additive(0.0, 0.0), UNDAMPED, [0.0; 2], 1.0);
    let w = |name, function, accuracy, truth| {
        expected(("rare events", name), sexp, walk.clone(), function, how(accuracy), truth)
    };
    // cos θ below −x, for θ of variance σ².
    let q = |name, sigma, function, x: f64| {
        let truth = 1.0 - Normal::new(0.0, sigma * sigma).cos_above(-x);
        expected(("rare events", name), sexp, kubo(0.0, sigma, 1.0), function, how(0.004), truth)
    };
    vec![
        w("W > 2.33", |y| indicator(y[1] > 2.33), 5e-3, above(2.33)),
        w("W > 3.09", |y| indicator(y[1] > 3.09), 1e-3, above(3.09)),
        w("W > 3.29", |y| indicator(y[1] > 3.29), 2e-4, above(3.29)),
        w("W > 4", |y| indicator(y[1] > 4.0), 1e-4, above(4.0)),
        w("(W − 3)₊", |y| (y[1] - 3.0).max(0.0), 5e-4, excess(3.0)),
        q("q < −0.8, Kubo", 1.0, |y| indicator(y[0] < -0.8), 0.8),
        q("q < −0.6, Kubo, σ = 0.9", 0.9, |y| indicator(y[0] < -0.6), 0.6),
    ]
}
