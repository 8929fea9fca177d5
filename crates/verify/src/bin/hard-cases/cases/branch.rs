//! The solution that belongs to the flow, found without the solver that is tested.
//!
//! z(s) = y + sψ₁(z) with ψ₁ = B((y+z)/2)∇̄h(y, z), from z(0) = y to s = 1 in small equal steps,
//! each with a few Newton iterations from the point before. det(I − sψ₁′) is 1 at s = 0 and
//! vanishes where the branch turns back.

use real::{Real, VectorFunction, jacobian};
use systems::{PoissonSystem, RigidBody};
use verify::rounding::length;

const STEPS: u32 = 2048;
const ITERATIONS: u32 = 4;
/// A solution that is found twice agrees to this fraction: √ε, as near a turning point it is known
/// no better.
const AGREES: f64 = 1.0 / (1u64 << 24) as f64;

struct Field<'a> {
    body: &'a RigidBody<3>,
    start: [f64; 3],
    tau: f64,
    dw: [f64; 3],
}

impl VectorFunction<3, 3> for Field<'_> {
    fn value<R: Real>(&self, z: [R; 3]) -> [R; 3] {
        self.body.averaged_field(self.start.map(R::constant), z, self.tau, self.dw)
    }
}

/// Whether a is b, to the accuracy of a branch.
pub fn agree(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() <= AGREES * length(b))
}

/// The solution at s = 1 on the branch of the undamped step of `sexp` from `start`; none if the
/// branch turns back before, or comes closer to a turning point than the steps resolve.
pub fn follow(body: &RigidBody<3>, tau: f64, dw: [f64; 3], start: [f64; 3]) -> Option<[f64; 3]> {
    let field = Field { body, start, tau, dw };
    let mut z = start;
    for n in 1..=STEPS {
        let s = f64::from(n) / f64::from(STEPS);
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let (value, slopes) = jacobian(&field, z);
            let identity = |i, j| f64::from(u8::from(i == j));
            let columns = [0, 1, 2].map(|j| [0, 1, 2].map(|i| identity(i, j) - s * slopes[i][j]));
            let defect = [0, 1, 2].map(|i| z[i] - start[i] - s * value[i]);
            let change = solve_if_positive(columns, defect)?;
            z = [0, 1, 2].map(|i| z[i] - change[i]);
            last = length(change);
        }
        if last.is_nan() || last > AGREES * length(z) {
            return None;
        }
    }
    Some(z)
}

/// A⁻¹b by Cramer's rule for the matrix with these columns, if det A > 0.
fn solve_if_positive([a, b, c]: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    let det = determinant(a, b, c);
    let numerators = [determinant(right, b, c), determinant(a, right, c), determinant(a, b, right)];
    (det > 0.0).then(|| numerators.map(|numerator| numerator / det))
}

fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}
