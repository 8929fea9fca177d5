//! Small changes of Newton's method are no solution by themselves.

use crate::common::residual;
use nonlin::{FixedPoint, Method, Solver};
use real::Real;

/// ψ(z) = z + f(z) with f(z) = −(z − 1)(1 + k(z − 1)) and a start far away: Newton's method, which
/// divides by the slope 1 + 2k(z − 1), halves the distance from far away and is quadratic with the
/// constant k only near 1.
#[derive(Clone, Copy)]
struct Parabola {
    k: f64,
    start: f64,
}

impl FixedPoint<1> for Parabola {
    const METHOD: Method = Method::Newton;

    fn start(&self) -> [f64; 1] {
        [self.start]
    }
    fn map<R: Real>(&self, [z]: [R; 1]) -> [R; 1] {
        let distance = z - 1.0;
        [z - distance * (distance * self.k + 1.0)]
    }
}

#[test]
fn newton_stops_at_solutions_alone() {
    let mut converged = 0;
    // The last change is at most 2⁻³², and its square times k = 10⁴ is an ε.
    for n in 0..=14 {
        let k = 10f64.powi(n - 10);
        for m in 0..=800 {
            let distance = 10f64.powf(f64::from(m) / 25.0 - 16.0);
            if k * distance > 0.25 {
                // Closer to the other root's branch than a contraction comes.
                continue;
            }
            let start = 1.0 + distance;
            let solution = Solver::default().solve(&Parabola { k, start });
            let distance = (solution.z[0] - 1.0).abs();
            if solution.outcome.converged() {
                converged += 1;
                assert!(distance <= 4.0 * f64::EPSILON, "{k:e} {start:e}: {solution:?}");
            }
        }
    }
    assert!(converged > 6_000, "{converged}");
}

/// An equation whose first two Newton changes look quadratic with the constant 10⁻³ and whose next
/// one is as large as the constant `k` of another direction makes it.
#[derive(Clone, Copy)]
struct TwoDirections {
    k: f64,
    start: [f64; 2],
}

impl FixedPoint<2> for TwoDirections {
    const METHOD: Method = Method::Newton;

    fn start(&self) -> [f64; 2] {
        self.start
    }
    fn map<R: Real>(&self, [x, y]: [R; 2]) -> [R; 2] {
        let (u, v) = (x - 1.0, y - 1.0);
        [(v * v * self.k + u * u * 1e-3) + 1.0, (u * u * 1e-3 + u * v * self.k * 0.5) + 1.0]
    }
}

#[test]
fn a_constant_seen_in_one_direction_is_trusted_with_a_margin() {
    for k in [0.0, 1e-2, 1.0, 1e2, 1e4] {
        for n in 0..200 {
            let distance = 10f64.powf(-8.0 * f64::from(n) / 200.0);
            let equation = TwoDirections { k, start: [1.0 + distance / (1.0 + k), 1.0] };
            let found = Solver::default().solve(&equation);
            let left = residual(&equation, found.z);
            let solved = found.outcome.converged() && left <= 8.0 * f64::EPSILON;
            assert!(solved, "{k:e} {distance:e}: {left:e} {found:?}");
        }
    }
}
