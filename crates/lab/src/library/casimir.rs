//! Noise that does nothing: H₁ is a function of a Casimir.

use schemes::Sexp;

use super::{
    Entry, How, expected,
    law::Normal,
    system::{Body, UNDAMPED, problem},
};

pub fn entries() -> Vec<Entry> {
    // A symmetric top, turned by 2y₃ without noise; and the same with weak noise about its axis.
    let start = [0.48, 0.6, 0.64];
    let top = Body { a: [1.0, 1.0, 3.0], k: 2.0, ..Body::linear([[0.0; 3]]) };
    let both = Body { b: [0.5], ..top };
    let turned = |theta: Normal| start[0] * theta.cos(1.0) + start[1] * theta.sin(1.0);
    vec![
        expected(
            ("Casimir noise", "y₁ of a top, H₁ = |y|²"),
            Sexp::default(),
            problem(top, UNDAMPED, start, 1.0),
            |y| y[0],
            How::to(0.01),
            turned(Normal::new(1.28, 0.0)),
        ),
        expected(
            ("Casimir noise", "y₁ of a top, H₁ = |y|² + ¼y₃²"),
            Sexp::default(),
            problem(both, UNDAMPED, start, 1.0),
            |y| y[0],
            How::to(0.005),
            turned(Normal::new(1.28, 0.32f64.powi(2))),
        ),
    ]
}
