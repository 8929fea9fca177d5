//! Dense linear algebra for matrices of the size of a system.

/// A matrix by rows.
pub type Matrix = Vec<Vec<f64>>;

/// The unit vector e_i of length n.
pub fn axis(n: usize, i: usize) -> Vec<f64> {
    let mut axis = vec![0.0; n];
    axis[i] = 1.0;
    axis
}

pub fn transposed(a: &Matrix) -> Matrix {
    (0..a.len()).map(|i| a.iter().map(|row| row[i]).collect()).collect()
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// ‖a‖₂.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// max |aᵢ|; NaN if one of them is.
pub fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().map(|x| x.abs()).max_by(f64::total_cmp).unwrap_or(0.0)
}

pub fn times(matrix: &Matrix, v: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| dot(row, v)).collect()
}

/// AᵀA.
pub fn gram(a: &Matrix) -> Matrix {
    let n = a.first().map_or(0, Vec::len);
    (0..n).map(|i| (0..n).map(|j| a.iter().map(|row| row[i] * row[j]).sum()).collect()).collect()
}

/// ‖A‖₂.
pub fn spectral_norm(a: &Matrix) -> f64 {
    eigenvalues(gram(a)).last().map_or(0.0, |&square| square.max(0.0).sqrt())
}

/// Limit of the sweeps of Jacobi's method, which converges quadratically: ten have always sufficed.
const SWEEPS: usize = 30;

/// The eigenvalues of a symmetric matrix in ascending order, by Jacobi's rotations.
pub fn eigenvalues(mut a: Matrix) -> Vec<f64> {
    let n = a.len();
    for _ in 0..SWEEPS {
        let off: f64 = (0..n).map(|i| (0..i).map(|j| a[i][j] * a[i][j]).sum::<f64>()).sum();
        if off == 0.0 {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..n {
                    let (x, y) = (a[k][p], a[k][q]);
                    (a[k][p], a[k][q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..n {
                    let (x, y) = (a[p][k], a[q][k]);
                    (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
    }
    let mut eigenvalues: Vec<f64> = (0..n).map(|i| a[i][i]).collect();
    eigenvalues.sort_by(f64::total_cmp);
    eigenvalues
}

/// A pivot this much smaller than the first counts as zero: far above the rounding errors of an
/// elimination, far below the pivots that random points give for a function that is no Casimir.
const RANK: f64 = 1e-9;

/// A basis of {x : Ax = 0}, each vector with a 1 where all others have a 0. Gauss–Jordan with
/// complete pivoting.
pub fn null_space(mut rows: Matrix, unknowns: usize) -> Matrix {
    let mut pivots: Vec<usize> = Vec::new();
    let mut first = 0.0;
    while pivots.len() < rows.len().min(unknowns) {
        let rank = pivots.len();
        let free = (0..unknowns).filter(|j| !pivots.contains(j));
        let candidate = free
            .flat_map(|j| (rank..rows.len()).map(move |i| (i, j)))
            .max_by(|a, b| rows[a.0][a.1].abs().total_cmp(&rows[b.0][b.1].abs()));
        let Some((i, j)) = candidate else { break };
        let pivot = rows[i][j];
        if rank == 0 {
            first = pivot.abs();
        }
        if pivot.abs() <= RANK * first {
            break;
        }
        rows.swap(rank, i);
        for x in &mut rows[rank] {
            *x /= pivot;
        }
        let pivot_row = rows[rank].clone();
        for (k, row) in rows.iter_mut().enumerate() {
            let factor = row[j];
            if k != rank && factor != 0.0 {
                for (x, p) in row.iter_mut().zip(&pivot_row) {
                    *x -= factor * p;
                }
            }
        }
        pivots.push(j);
    }
    (0..unknowns)
        .filter(|j| !pivots.contains(j))
        .map(|free| {
            let mut x = vec![0.0; unknowns];
            x[free] = 1.0;
            for (row, &pivot) in pivots.iter().enumerate() {
                x[pivot] = -rows[row][free];
            }
            x
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_of_known_matrices() {
        let second_differences =
            vec![vec![2.0, -1.0, 0.0], vec![-1.0, 2.0, -1.0], vec![0.0, -1.0, 2.0]];
        let root = 2f64.sqrt();
        // Some fifteen rotations round entries of up to 4 by an ulp each.
        for (found, exact) in
            eigenvalues(second_differences).iter().zip([2.0 - root, 2.0, 2.0 + root])
        {
            assert!((found - exact).abs() < 60.0 * f64::EPSILON, "{found} {exact}");
        }
        assert_eq!(eigenvalues(vec![vec![3.0, 0.0], vec![0.0, -1.0]]), [-1.0, 3.0]);
        // The norm of a shear, (1 + √5)/2.
        let shear = spectral_norm(&vec![vec![1.0, 1.0], vec![0.0, 1.0]]);
        assert!((shear - 0.5 * (1.0 + 5f64.sqrt())).abs() < 1e-15);
    }

    #[test]
    fn null_spaces_of_known_matrices() {
        let rank_one = vec![vec![1.0, 2.0, -1.0], vec![2.0, 4.0, -2.0]];
        let basis = null_space(rank_one.clone(), 3);
        assert_eq!(basis.len(), 2);
        for x in &basis {
            assert!(times(&rank_one, x).iter().all(|residual| residual.abs() < 1e-15));
        }
        assert!(null_space(vec![vec![1.0, 1.0], vec![1.0, -1.0]], 2).is_empty());
        assert_eq!(null_space(vec![vec![0.0, 0.0]], 2).len(), 2);
        assert_eq!(null_space(Vec::new(), 1), [[1.0]]);
    }
}
