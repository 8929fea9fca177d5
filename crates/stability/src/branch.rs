//! The solution that belongs to the flow, found without the solver that is put to the test.
//!
//! z(s) = y + sψ₁(z) with ψ₁ = B((y+z)/2)∇̄h(y, z), from z(0) = y to s = 1 in small equal steps,
//! each with a few Newton iterations from the point before. det(I − sψ₁′) is 1 at s = 0 and
//! vanishes where the branch turns back.

use real::{Real, VectorFunction, directional};
use systems::PoissonSystem;

/// Where the branch leads.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Branch<const D: usize> {
    /// To this solution at s = 1.
    Leads([f64; D]),
    /// It turns back before s = 1, or comes closer to a turning point than the steps resolve.
    Turns,
}

const STEPS: u32 = 2048;
const ITERATIONS: u32 = 4;
/// A solution that is found twice agrees to this fraction: √ε, as near a turning point it is known
/// no better.
const AGREES: f64 = 1.0 / (1u64 << 24) as f64;

impl<const D: usize> Branch<D> {
    /// Whether z is what the branch leads to.
    pub(crate) fn holds(&self, z: [f64; D]) -> bool {
        match self {
            Self::Leads(end) => {
                (0..D).all(|i| (z[i] - end[i]).abs() <= AGREES * super::cases::length(*end))
            }
            Self::Turns => false,
        }
    }
}

struct Field<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    start: [f64; D],
    tau: f64,
    dw: [f64; M],
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> VectorFunction<D, D>
    for Field<'_, S, D, M>
{
    fn value<R: Real>(&self, z: [R; D]) -> [R; D] {
        self.system.averaged_field(self.start.map(R::constant), z, self.tau, self.dw)
    }
}

/// Follows the branch of the undamped step of `sexp` from `start`.
pub(crate) fn follow<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    tau: f64,
    dw: [f64; M],
    start: [f64; D],
) -> Branch<D> {
    let field = Field { system, start, tau, dw };
    let mut z = start;
    for n in 1..=STEPS {
        let s = f64::from(n) / f64::from(STEPS);
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let mut matrix = [[0.0; D]; D];
            let mut value = [0.0; D];
            for j in 0..D {
                let mut direction = [0.0; D];
                direction[j] = 1.0;
                let (at, column) = directional(&field, z, direction);
                value = at;
                for i in 0..D {
                    matrix[i][j] = f64::from(u8::from(i == j)) - s * column[i];
                }
            }
            let mut defect = [0.0; D];
            for i in 0..D {
                defect[i] = z[i] - start[i] - s * value[i];
            }
            let Some(change) = solve_if_positive(matrix, defect) else { return Branch::Turns };
            for i in 0..D {
                z[i] -= change[i];
            }
            last = super::cases::length(change);
        }
        if last.is_nan() || last > AGREES * super::cases::length(z) {
            return Branch::Turns;
        }
    }
    Branch::Leads(z)
}

/// A⁻¹b by elimination with pivoting, if det A > 0.
fn solve_if_positive<const D: usize>(mut a: [[f64; D]; D], mut b: [f64; D]) -> Option<[f64; D]> {
    let mut positive = true;
    for k in 0..D {
        let pivot = (k..D).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))?;
        if pivot != k {
            a.swap(k, pivot);
            b.swap(k, pivot);
            positive = !positive;
        }
        positive ^= a[k][k] < 0.0;
        if a[k][k] == 0.0 {
            return None;
        }
        for i in k + 1..D {
            let factor = a[i][k] / a[k][k];
            for j in k..D {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..D).rev() {
        for j in k + 1..D {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    positive.then_some(b)
}
