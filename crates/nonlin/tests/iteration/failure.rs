//! Equations without a solution, and input that is no number, end as `Failed`: no panic, no hang.

use std::cell::Cell;

use nonlin::{FixedPoint, Method, Outcome, Solver};
use real::Real;

/// ψ(z) on the line, by number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Line {
    /// z + 1: parallel to the diagonal, I − ψ′ = 0.
    Parallel,
    /// z² + z + 1: z² = −1.
    NoRealRoot,
    /// eᶻ: above the diagonal everywhere, and overflowing.
    Exponential,
    /// 1/z from 0: infinite at the start.
    Pole,
    /// ln z from −1: NaN at the start.
    NoNumber,
    /// z times this, which is no number or infinite.
    Times(f64),
}

/// It counts its evaluations.
#[derive(Clone, Copy)]
struct Counted<'a>(Line, &'a Cell<u32>);

impl FixedPoint<1> for Counted<'_> {
    fn start(&self) -> [f64; 1] {
        match self.0 {
            Line::NoNumber => [-1.0],
            Line::Pole => [0.0],
            _ => [0.5],
        }
    }
    fn map<R: Real>(&self, [z]: [R; 1]) -> [R; 1] {
        self.1.set(self.1.get() + 1);
        [match self.0 {
            Line::Parallel => z + 1.0,
            Line::NoRealRoot => z * z + z + 1.0,
            Line::Exponential => z.exp(),
            Line::Pole => z.recip(),
            Line::NoNumber => z.ln(),
            Line::Times(factor) => z * factor,
        }]
    }
}

/// 56 sweeps of at most 3 evaluations, 5 more in the first, and 100 trials of at most 20 Newton
/// iterations of D = 1 evaluation: 14 halvings down to the smallest step in s and as many on each
/// of a few approaches to a fold.
const MAX_EVALUATIONS: u32 = 5 + 56 * 3 + 100 * 20;

#[test]
fn unsolvable_equations_fail_in_finite_time() {
    use Line::*;
    let others = [Times(f64::NAN), Times(f64::INFINITY)];
    for method in [Method::FixedPoint, Method::Newton] {
        for line in [Parallel, NoRealRoot, Exponential, Pole, NoNumber].into_iter().chain(others) {
            let count = Cell::new(0);
            let found = Solver::new(method).solve(&Counted(line, &count));
            let Outcome::Failed { residual } = found.outcome else {
                panic!("{line:?} {method:?}: {found:?}")
            };
            assert!(!found.outcome.converged());
            assert!(count.get() <= MAX_EVALUATIONS, "{line:?}: {count:?}");
            if line == NoRealRoot {
                // Of the last iterate, z − ψ(z) = −(z² + 1): a few roundings.
                let defect = found.z[0] * found.z[0] + 1.0;
                assert!((residual / defect - 1.0).abs() <= 8.0 * f64::EPSILON, "{found:?}");
            }
        }
    }
}
