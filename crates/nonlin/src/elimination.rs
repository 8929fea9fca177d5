//! Elimination with pivoting, for the robust method. See [`real::Factored`] for the fast one.

/// Solves A x = b with partial pivoting. The result is infinite or NaN if A is singular.
pub fn solve_pivoted<const D: usize>(mut a: [[f64; D]; D], mut b: [f64; D]) -> [f64; D] {
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
    for k in (0..D).rev() {
        for j in k + 1..D {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pivoting_solves_and_survives_a_zero_on_the_diagonal() {
        let a = [[1.1, -0.2, 0.3], [0.25, 0.9, -0.1], [-0.3, 0.15, 1.05]];
        let x = [0.3, -2.0, 5.0];
        let b = a.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2]);
        for (found, expected) in solve_pivoted(a, b).into_iter().zip(x) {
            assert!((found - expected).abs() < 1e-14, "{found}");
        }
        assert_eq!(solve_pivoted([[0.0, 2.0], [3.0, 1.0]], [4.0, 5.0]), [1.0, 2.0]);
    }
}
