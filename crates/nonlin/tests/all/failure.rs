//! Equations without a solution, and input that is no number, end as `Failed`: no panic, no hang.

use approx::assert_relative_eq;
use nonlin::{FixedPoint, Method, Outcome, Solver};
use real::Real;

/// ψ(z) on the line, by number.
#[derive(Clone, Copy, Debug)]
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
    /// NaN everywhere.
    AlwaysNan,
    /// ∞ everywhere.
    AlwaysInfinite,
}

const LINES: [Line; 7] = [
    Line::Parallel,
    Line::NoRealRoot,
    Line::Exponential,
    Line::Pole,
    Line::NoNumber,
    Line::AlwaysNan,
    Line::AlwaysInfinite,
];

impl FixedPoint<1> for Line {
    fn start(&self) -> [f64; 1] {
        match self {
            Self::NoNumber => [-1.0],
            Self::Pole => [0.0],
            _ => [0.5],
        }
    }
    fn map<R: Real>(&self, [z]: [R; 1]) -> [R; 1] {
        [match self {
            Self::Parallel => z + 1.0,
            Self::NoRealRoot => z * z + z + 1.0,
            Self::Exponential => z.exp(),
            Self::Pole => z.recip(),
            Self::NoNumber => z.ln(),
            Self::AlwaysNan => z * f64::NAN,
            Self::AlwaysInfinite => R::constant(f64::INFINITY),
        }]
    }
}

/// An equation that counts its evaluations.
#[derive(Clone, Copy)]
struct Counted<'a, E> {
    equation: E,
    count: &'a std::cell::Cell<u32>,
}

impl<E: FixedPoint<D>, const D: usize> FixedPoint<D> for Counted<'_, E> {
    fn start(&self) -> [f64; D] {
        self.equation.start()
    }
    fn map<R: Real>(&self, z: [R; D]) -> [R; D] {
        self.count.set(self.count.get() + 1);
        self.equation.map(z)
    }
}

/// 56 sweeps of at most 3 evaluations, 5 more in the first, and 100 trials of at most 20 Newton
/// iterations of D = 1 evaluation: 14 halvings down to the smallest step in s and as many on each
/// of a few approaches to a fold.
const MOST_EVALUATIONS: u32 = 5 + 56 * 3 + 100 * 20;

#[test]
fn unsolvable_equations_fail_in_finite_time() {
    for method in [Method::FixedPoint, Method::Newton] {
        for equation in LINES {
            let count = std::cell::Cell::new(0);
            let counted = Counted { equation, count: &count };
            let found = Solver::new(method).solve(&counted);
            assert!(
                matches!(found.outcome, Outcome::Failed { .. }),
                "{equation:?} {method:?}: {found:?}"
            );
            assert!(!found.outcome.converged());
            assert!(count.get() <= MOST_EVALUATIONS, "{equation:?}: {count:?}");
        }
    }
}

#[test]
fn a_residual_is_the_defect_of_the_last_iterate() {
    let found = Solver::default().solve(&Line::NoRealRoot);
    let Outcome::Failed { residual } = found.outcome else { panic!("{found:?}") };
    // z − ψ(z) = −(z² + 1): a few roundings.
    let defect = found.z[0] * found.z[0] + 1.0;
    assert_relative_eq!(residual, defect, epsilon = 0.0, max_relative = 8.0 * f64::EPSILON);
    assert!(residual >= 1.0);
}
