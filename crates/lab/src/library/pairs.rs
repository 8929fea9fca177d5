//! Two planes: a fast rotation beside a slow one, and two noises that commute.

use schemes::Sexp;

use super::{
    Entry, How, OldRule, expected,
    law::Normal,
    system::{Planes, UNDAMPED, problem},
};

impl Planes {
    /// The angle of a plane after the time one, normal of mean ω and variance Σ σ².
    fn angle(&self, plane: usize) -> Normal {
        let [a, b] = self.sigma[plane];
        Normal::new(self.omega[plane], a * a + b * b)
    }
}

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp::default();
    let start = [1.0, 0.0, 1.0, 0.0];
    let beside = Planes { omega: [77.2, 1.0], sigma: [[0.0; 2], [0.3, 0.4]] };
    let slow = Planes { omega: [1.0, -2.0], sigma: [[1.0, 0.5], [0.3, -0.6]] };
    vec![
        // E[q₁ + q₂] = cos ω₁ + E cos θ₂.
        expected(
            ("fast rotation", "q₁ + q₂, ω = 77.2 without noise beside 1 with"),
            sexp,
            problem(beside, UNDAMPED, start, 1.0),
            |y| y[0] + y[2],
            How::to(0.1).against(OldRule::NoResolution),
            beside.angle(0).cos(1.0) + beside.angle(1).cos(1.0),
        ),
        // E q₂ alone.
        expected(
            ("fast rotation", "the slow q₂ beside ω = 77.2"),
            sexp,
            problem(beside, UNDAMPED, start, 1.0),
            |y| y[2],
            How::to(0.02),
            beside.angle(1).cos(1.0),
        ),
        // q₁q₂ = ½(cos(θ₁ − θ₂) + cos(θ₁ + θ₂)), with the variances |σ₁ ∓ σ₂|².
        expected(
            ("commuting noises", "q₁q₂ of two planes"),
            sexp,
            problem(slow, UNDAMPED, start, 1.0),
            |y| y[0] * y[2],
            How::to(0.01),
            0.5 * (Normal::new(3.0, 0.7f64.powi(2) + 1.1f64.powi(2)).cos(1.0)
                + Normal::new(-1.0, 1.3f64.powi(2) + 0.1f64.powi(2)).cos(1.0)),
        ),
        expected(
            ("commuting noises", "q₁² of two planes"),
            sexp,
            problem(slow, UNDAMPED, start, 1.0),
            |y| y[0] * y[0],
            How::to(0.01),
            0.5 * (1.0 + slow.angle(0).cos(2.0)),
        ),
    ]
}
