//! Small dense linear systems, solved in registers.
//!
//! D is 2 or 3 here and the systems sit inside a vectorised loop over paths, or must give the same bits on every
//! machine; a linear-algebra library is made for neither.

/// Solves A x = b without pivoting, for A near the identity; branch-free.
#[inline(always)]
pub(crate) fn solve_near_identity<const D: usize>(mut a: [[f64; D]; D], mut b: [f64; D]) -> [f64; D] {
    for k in 0..D {
        let pivot = 1.0 / a[k][k];
        for i in k + 1..D {
            let factor = a[i][k] * pivot;
            for j in k + 1..D {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    back_substitute(&a, b)
}

/// Solves A x = b with partial pivoting; infinite or NaN when A is singular.
pub(crate) fn solve_pivoted<const D: usize>(mut a: [[f64; D]; D], mut b: [f64; D]) -> [f64; D] {
    for k in 0..D {
        let largest = (k..D).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap_or(k);
        a.swap(k, largest);
        b.swap(k, largest);
        for i in k + 1..D {
            let factor = a[i][k] / a[k][k];
            for j in k + 1..D {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    back_substitute(&a, b)
}

#[inline(always)]
fn back_substitute<const D: usize>(a: &[[f64; D]; D], b: [f64; D]) -> [f64; D] {
    let mut x = b;
    for k in (0..D).rev() {
        for j in k + 1..D {
            x[k] -= a[k][j] * x[j];
        }
        x[k] /= a[k][k];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product<const D: usize>(a: &[[f64; D]; D], x: [f64; D]) -> [f64; D] {
        std::array::from_fn(|i| (0..D).map(|j| a[i][j] * x[j]).sum())
    }

    #[test]
    fn both_eliminations_solve() {
        let a = [[1.1, -0.2, 0.3], [0.25, 0.9, -0.1], [-0.3, 0.15, 1.05]];
        let x = [0.3, -2.0, 5.0];
        for solution in [solve_near_identity(a, product(&a, x)), solve_pivoted(a, product(&a, x))] {
            for i in 0..3 {
                assert!((solution[i] - x[i]).abs() < 1e-14, "{solution:?}");
            }
        }
    }

    #[test]
    fn pivoting_survives_a_zero_on_the_diagonal() {
        let a = [[0.0, 2.0], [3.0, 1.0]];
        assert_eq!(solve_pivoted(a, [4.0, 5.0]), [1.0, 2.0]);
        assert!(!solve_near_identity(a, [4.0, 5.0])[0].is_finite());
    }
}
