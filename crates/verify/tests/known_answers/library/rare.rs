//! Rare events, at several levels and accuracies.

use schemes::Sexp;

use super::{
    Entry, How, expected, indicator,
    law::{Normal, above},
    system::{Plane, UNDAMPED, kubo, problem},
};

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp;
    let walk = problem(Plane::additive(0.0, 0.0), UNDAMPED, [0.0; 2], 1.0);
    let w = |name, function, accuracy, truth| {
        expected(("rare events", name), sexp, walk.clone(), function, How::to(accuracy), truth)
    };
    // cos θ below −x, for θ of variance σ².
    let q = |name, sigma, function, x: f64| {
        let truth = 1.0 - Normal::new(0.0, sigma * sigma).cos_above(-x);
        expected(
            ("rare events", name),
            sexp,
            kubo(0.0, sigma, 1.0),
            function,
            How::to(0.004),
            truth,
        )
    };
    vec![
        w("W > 2.33", |y| indicator(y[1] > 2.33), 5e-3, above(2.33)),
        w("W > 4", |y| indicator(y[1] > 4.0), 1e-4, above(4.0)),
        q("q < −0.8, Kubo", 1.0, |y| indicator(y[0] < -0.8), 0.8),
    ]
}
