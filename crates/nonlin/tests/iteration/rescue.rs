//! Where the fixed point does not contract the robust method takes over, and finds the solution
//! that is connected with the start.

use crate::common::{Numbers, difference};
use nonlin::{FixedPoint, Method, Outcome, Solver};
use real::Real;

/// z = ẑ + s·m × Km with m = (ẑ + z)/2: a step of the free rigid body, a nonlinear rotation. It
/// keeps |z| = |ẑ|, has a solution for every s, and several for large s.
#[derive(Clone, Copy, Debug)]
struct Rotation {
    s: f64,
    k: [f64; 3],
    start: [f64; 3],
}

impl FixedPoint<3> for Rotation {
    fn start(&self) -> [f64; 3] {
        self.start
    }
    #[inline(always)]
    fn map<R: Real>(&self, z: [R; 3]) -> [R; 3] {
        let (mut m, mut v) = ([R::zero(); 3], [R::zero(); 3]);
        for i in 0..3 {
            m[i] = (z[i] + self.start[i]) * 0.5;
            v[i] = m[i] * (self.k[i] * self.s);
        }
        [
            m[1] * v[2] - m[2] * v[1] + self.start[0],
            m[2] * v[0] - m[0] * v[2] + self.start[1],
            m[0] * v[1] - m[1] * v[0] + self.start[2],
        ]
    }
}

impl Rotation {
    fn random(s: f64, numbers: &mut Numbers) -> Self {
        let mut three = || [numbers.next(), numbers.next(), numbers.next()];
        Self { s, k: three(), start: three() }
    }
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

/// Steps in s of the reference.
const STEPS: u32 = 4000;
/// The reference is believed while det(I − ψ′) stays above this and no step moves z by more.
const REGULAR: f64 = 0.1;

/// The solution on the branch of the start by brute force: thousands of steps in s, Newton by
/// cofactors. `None` where the branch comes close to a fold.
fn fine_continuation(equation: &Rotation) -> Option<[f64; 3]> {
    let mut z = equation.start;
    for n in 1..=STEPS {
        let before = z;
        let partial = Rotation { s: equation.s * f64::from(n) / f64::from(STEPS), ..*equation };
        for _ in 0..6 {
            let (value, jacobian) = partial.jacobian(z);
            let identity = |i, j| f64::from(u8::from(i == j));
            let [u, v, w] = [0, 1, 2].map(|i| [0, 1, 2].map(|j| identity(i, j) - jacobian[i][j]));
            let defect = [0, 1, 2].map(|i| z[i] - value[i]);
            let columns = [cross(v, w), cross(w, u), cross(u, v)];
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let determinant = dot(u, columns[0]);
            if determinant < REGULAR {
                return None;
            }
            for j in 0..3 {
                z[j] -= dot(columns.map(|column| column[j]), defect) / determinant;
            }
        }
        if difference(z, before) > REGULAR {
            return None;
        }
    }
    Some(z)
}

/// Error of a solution: a residual of a few ε, amplified by the inverse of I − ψ′, which is at most
/// the cofactors, below (1 + s)², over a determinant of at least 0.1.
fn tolerance(s: f64) -> f64 {
    8.0 * f64::EPSILON * (1.0 + s) * (1.0 + s) / REGULAR
}

#[test]
fn the_branch_is_the_one_of_the_start() {
    let mut numbers = Numbers(12_345);
    let (mut robust, mut folded, mut elsewhere) = (0, 0, 0);
    for s in [1.0, 2.0, 4.0, 8.0, 16.0, 32.0] {
        for _ in 0..60 {
            let equation = Rotation::random(s, &mut numbers);
            let Some(expected) = fine_continuation(&equation) else {
                folded += 1;
                continue;
            };
            let found = Solver::default().solve(&equation);
            assert!(found.outcome.converged(), "{equation:?}");
            let distance = difference(found.z, expected);
            assert!(distance <= tolerance(s), "{equation:?} {found:?} {expected:?}");
            robust += u32::from(matches!(found.outcome, Outcome::Robust { .. }));

            // A rotation keeps the length.
            let square = |z: [f64; 3]| z.iter().map(|x| x * x).sum::<f64>();
            let defect = square(found.z) / square(equation.start) - 1.0;
            assert!(defect.abs() <= 16.0 * f64::EPSILON * (1.0 + s), "{defect}");

            // The twin: Newton from the start, without continuation.
            let twin = Solver::new(Method::Newton).solve(&equation);
            elsewhere += u32::from(difference(twin.z, expected) > 1e-3);
        }
    }
    assert!(robust > 200, "{robust}");
    assert!(folded < 20, "{folded}");
    assert!(elsewhere >= 10, "{elsewhere}");
}
