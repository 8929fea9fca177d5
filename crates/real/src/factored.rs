//! Small dense linear systems.
//!
//! D is usually 2 or 3, and the systems are solved in registers inside a vectorised loop over
//! paths. Results must be the same bits on every machine. Linear-algebra libraries offer neither.

use crate::Real;

/// A factored matrix near the identity, for A x = b with many b. Branch-free, without pivoting.
///
/// For D ≤ 3 this is the inverse by cofactors, which needs one division; an elimination needs D
/// divisions one after the other. For larger D these are the LU factors, with the reciprocal pivots
/// on the diagonal.
#[derive(Clone, Copy, Debug)]
pub struct Factored<R, const D: usize>([[R; D]; D]);

impl<R: Real, const D: usize> Factored<R, D> {
    /// The factors of A, not finite if a pivot is zero.
    #[inline(always)]
    pub fn new(a: [[R; D]; D]) -> Self {
        Self(match D {
            1 => [[R::one() / a[0][0]; D]; D],
            2 => inverse_2(a),
            3 => inverse_3(a),
            _ => lu(a),
        })
    }

    /// x with A x = b.
    #[inline(always)]
    pub fn solve(&self, b: [R; D]) -> [R; D] {
        if D > 3 { substitute(&self.0, b) } else { product(&self.0, b) }
    }
}

#[inline(always)]
fn product<R: Real, const D: usize>(a: &[[R; D]; D], b: [R; D]) -> [R; D] {
    let mut x = b;
    for i in 0..D {
        x[i] = a[i][0] * b[0];
        for j in 1..D {
            x[i] = x[i] + a[i][j] * b[j];
        }
    }
    x
}

#[inline(always)]
fn inverse_2<R: Real, const D: usize>(mut a: [[R; D]; D]) -> [[R; D]; D] {
    let inverse = R::one() / (a[0][0] * a[1][1] - a[0][1] * a[1][0]);
    (a[0][0], a[1][1]) = (a[1][1] * inverse, a[0][0] * inverse);
    (a[0][1], a[1][0]) = (-(a[0][1] * inverse), -(a[1][0] * inverse));
    a
}

#[inline(always)]
fn inverse_3<R: Real, const D: usize>(a: [[R; D]; D]) -> [[R; D]; D] {
    // Column i of the adjugate is the cross product of the other two rows.
    let columns = [cross(a[1], a[2]), cross(a[2], a[0]), cross(a[0], a[1])];
    let inverse =
        R::one() / (a[0][0] * columns[0][0] + a[0][1] * columns[0][1] + a[0][2] * columns[0][2]);
    let mut x = a;
    for i in 0..3 {
        for j in 0..3 {
            x[i][j] = columns[j][i] * inverse;
        }
    }
    x
}

#[inline(always)]
fn cross<R: Real, const D: usize>(u: [R; D], v: [R; D]) -> [R; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

#[inline(always)]
fn lu<R: Real, const D: usize>(mut a: [[R; D]; D]) -> [[R; D]; D] {
    for k in 0..D {
        a[k][k] = R::one() / a[k][k];
        for i in k + 1..D {
            a[i][k] = a[i][k] * a[k][k];
            for j in k + 1..D {
                a[i][j] = a[i][j] - a[i][k] * a[k][j];
            }
        }
    }
    a
}

/// Forward and backward substitution.
#[inline(always)]
fn substitute<R: Real, const D: usize>(lu: &[[R; D]; D], b: [R; D]) -> [R; D] {
    let mut x = b;
    for k in 0..D {
        for i in k + 1..D {
            x[i] = x[i] - lu[i][k] * x[k];
        }
    }
    for k in (0..D).rev() {
        for j in k + 1..D {
            x[k] = x[k] - lu[k][j] * x[j];
        }
        x[k] = x[k] * lu[k][k];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_elimination_solves() {
        let a = [[1.1, -0.2, 0.3], [0.25, 0.9, -0.1], [-0.3, 0.15, 1.05]];
        let x = [0.3, -2.0, 5.0];
        let b = product(&a, x);
        for solution in [Factored::new(a).solve(b), substitute(&lu(a), b)] {
            for i in 0..3 {
                assert!((solution[i] - x[i]).abs() < 1e-14, "{solution:?}");
            }
        }
        let (plane, y) = ([[1.1, -0.2], [0.25, 0.9]], [0.3, -2.0]);
        let solution = Factored::new(plane).solve(product(&plane, y));
        assert!(
            (solution[0] - y[0]).abs() < 1e-15 && (solution[1] - y[1]).abs() < 1e-15,
            "{solution:?}"
        );
    }

    #[test]
    fn a_zero_pivot_gives_no_number() {
        let a = [[0.0, 2.0], [3.0, 1.0]];
        assert!(!substitute(&lu(a), [4.0, 5.0])[0].is_finite());
    }
}
