//! Dense linear algebra for matrices of the size of a system.

use nalgebra::DMatrix;
use real::{Bounded, Real};

/// A matrix by rows.
pub type Matrix<R = f64> = Vec<Vec<R>>;

/// The unit vector e_i of length n.
pub fn axis(n: usize, i: usize) -> Vec<f64> {
    let mut axis = vec![0.0; n];
    axis[i] = 1.0;
    axis
}

pub fn transposed<R: Copy>(a: &Matrix<R>) -> Matrix<R> {
    (0..a.len()).map(|i| a.iter().map(|row| row[i]).collect()).collect()
}

pub fn dot<R: Real>(a: &[R], b: &[R]) -> R {
    a.iter().zip(b).fold(R::zero(), |sum, (a, b)| sum + *a * *b)
}

/// Σ|aᵢbᵢ|, the size of the terms of a product.
pub fn size(a: &[Bounded], b: &[Bounded]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a.value * b.value).abs()).sum()
}

/// ‖a‖₂.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// max |aᵢ|; NaN if one of them is.
pub fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().map(|x| x.abs()).max_by(f64::total_cmp).unwrap_or(0.0)
}

pub fn times<R: Real>(matrix: &Matrix<R>, v: &[R]) -> Vec<R> {
    matrix.iter().map(|row| dot(row, v)).collect()
}

pub fn values(a: &[Bounded]) -> Vec<f64> {
    a.iter().map(|x| x.value).collect()
}

pub fn matrix_values(a: &Matrix<Bounded>) -> Matrix {
    a.iter().map(|row| values(row)).collect()
}

/// ‖errors‖, the Frobenius norm: no eigenvalue and no singular value is off by more.
pub fn error_norm<'a>(entries: impl IntoIterator<Item = &'a Bounded>) -> f64 {
    entries.into_iter().map(|x| x.error * x.error).sum::<f64>().sqrt()
}

fn dense(a: &Matrix) -> DMatrix<f64> {
    DMatrix::from_fn(a.len(), a.first().map_or(0, Vec::len), |i, j| a[i][j])
}

fn finite(a: &Matrix) -> bool {
    a.iter().flatten().all(|x| x.is_finite())
}

/// ‖A‖₂; NaN unless A is finite.
pub fn spectral_norm(a: &Matrix) -> f64 {
    let scale = largest(a.iter().flatten());
    if !finite(a) {
        return f64::NAN;
    }
    if scale == 0.0 {
        return 0.0;
    }
    let scaled = dense(a) / scale;
    // AᵀA is much smaller than a tall A, and its largest eigenvalue is as accurate.
    scale * (scaled.transpose() * &scaled).symmetric_eigenvalues().max().sqrt()
}

/// The smallest eigenvalue of a symmetric matrix; NaN unless it is finite.
pub fn smallest_eigenvalue(a: &Matrix) -> f64 {
    if finite(a) { dense(a).symmetric_eigenvalues().min() } else { f64::NAN }
}

/// The bound of the errors of the decompositions of an n × m matrix, relative to its norm:
/// backward stable, with a modest multiple of u√(nm) (Golub and Van Loan 2013, section 8.6).
pub fn backward_error(rows: usize, columns: usize) -> f64 {
    8.0 * f64::EPSILON * ((rows * columns) as f64).sqrt()
}

/// The singular values σ of A in descending order, padded by zeros, and its right singular vectors.
pub fn singular_vectors(a: &Matrix, columns: usize) -> (Vec<f64>, Matrix) {
    let mut rows = a.clone();
    rows.resize(a.len().max(columns), vec![0.0; columns]);
    let svd = finite(&rows).then(|| dense(&rows).svd(false, true));
    let Some((svd, v)) = svd.and_then(|mut svd| svd.v_t.take().map(|v| (svd, v))) else {
        return (vec![f64::NAN; columns], vec![vec![f64::NAN; columns]; columns]);
    };
    let sigma = svd.singular_values.iter().copied().collect();
    (sigma, v.row_iter().map(|row| row.iter().copied().collect()).collect())
}

/// The basis of the span of the rows, which are independent, in which each vector has a 1 where all
/// others have a 0. Gauss–Jordan with complete pivoting.
pub fn echelon(mut rows: Matrix) -> Matrix {
    let mut pivots: Vec<usize> = Vec::new();
    while pivots.len() < rows.len() {
        let rank = pivots.len();
        let places = (rank..rows.len()).flat_map(|i| (0..rows[i].len()).map(move |j| (i, j)));
        // Of equal pivots the last column.
        let Some((i, j)) = places.max_by(|a, b| {
            let size = |place: &(usize, usize)| rows[place.0][place.1].abs();
            size(a).total_cmp(&size(b)).then(a.1.cmp(&b.1))
        }) else {
            break;
        };
        rows.swap(rank, i);
        let pivot = rows[rank][j];
        rows[rank].iter_mut().for_each(|x| *x /= pivot);
        let pivot_row = rows[rank].clone();
        for (k, row) in rows.iter_mut().enumerate() {
            let factor = row[j];
            if k != rank {
                row.iter_mut().zip(&pivot_row).for_each(|(x, p)| *x -= factor * p);
            }
        }
        pivots.push(j);
    }
    let mut order: Vec<usize> = (0..pivots.len()).collect();
    order.sort_by_key(|&i| pivots[i]);
    order.into_iter().map(|i| rows[i].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_of_known_matrices() {
        let second_differences =
            vec![vec![2.0, -1.0, 0.0], vec![-1.0, 2.0, -1.0], vec![0.0, -1.0, 2.0]];
        let exact = 2.0 - 2f64.sqrt();
        let bound = backward_error(3, 3) * 4.0;
        assert!((smallest_eigenvalue(&second_differences) - exact).abs() < bound);
        assert_eq!(smallest_eigenvalue(&vec![vec![3.0, 0.0], vec![0.0, -1.0]]), -1.0);
        assert!(smallest_eigenvalue(&vec![vec![f64::NAN]]).is_nan());
        // The norm of a shear, (1 + √5)/2.
        let shear = spectral_norm(&vec![vec![1.0, 1.0], vec![0.0, 1.0]]);
        assert!((shear - 0.5 * (1.0 + 5f64.sqrt())).abs() < 1e-15);
    }

    #[test]
    fn null_spaces_of_known_matrices() {
        let rank_one = vec![vec![1.0, 2.0, -1.0], vec![2.0, 4.0, -2.0]];
        let (sigma, vectors) = singular_vectors(&rank_one, 3);
        assert!(sigma[0] > 1.0 && sigma[1] < 1e-15 && sigma[2] < 1e-15, "{sigma:?}");
        let basis = echelon(vectors[1..].to_vec());
        for x in &basis {
            assert!(times(&rank_one, x).iter().all(|residual| residual.abs() < 1e-15));
        }
        assert_eq!(singular_vectors(&Vec::new(), 1).0, [0.0]);
    }

    #[test]
    fn sums_and_norms_of_small_numbers() {
        let bounded = |value, error| Bounded { error, ..Bounded::variable(value) };
        let (a, b) = ([bounded(3.0, 0.3), bounded(-2.0, 0.4)], [bounded(-2.0, 0.0); 2]);
        assert_eq!((axis(3, 1), norm(&[3.0, -4.0])), (vec![0.0, 1.0, 0.0], 5.0));
        assert_eq!((dot(&a, &b).value, size(&a, &b), error_norm(&a)), (-2.0, 10.0, 0.5));
        assert_eq!((largest(&[1.0, -3.0, 2.0]), largest(&[])), (3.0, 0.0));
        assert!(largest(&[1.0, f64::NAN, 2.0]).is_nan());
        let matrix = vec![vec![1.0, 2.0], vec![3.0, 4.0]];
        assert_eq!(transposed(&matrix), [[1.0, 3.0], [2.0, 4.0]]);
        assert_eq!(times(&matrix, &[1.0, -1.0]), [-1.0, -1.0]);
        assert_eq!(matrix_values(&vec![a.to_vec()]), [[3.0, -2.0]]);
        // 8u√(nm), twice: u is half of ε.
        assert_eq!(backward_error(2, 8), 32.0 * f64::EPSILON);
    }

    #[test]
    fn norms_neither_overflow_nor_lose_what_is_not_finite() {
        let of = |x: f64| spectral_norm(&vec![vec![3.0 * x, 0.0], vec![0.0, -4.0 * x]]);
        assert_eq!((of(0.0), of(1e200)), (0.0, 4e200));
        assert!(of(f64::NAN).is_nan() && of(f64::INFINITY).is_nan());
        // Singular values of a matrix of NaN, and of one with more columns than rows.
        let (sigma, vectors) = singular_vectors(&vec![vec![f64::NAN, 1.0]], 2);
        assert!(sigma.iter().chain(vectors.iter().flatten()).all(|x| x.is_nan()));
        assert_eq!((sigma.len(), vectors.len(), vectors[1].len()), (2, 2, 2));
        let (sigma, vectors) = singular_vectors(&vec![vec![0.0, 2.0, 0.0]], 3);
        assert_eq!((sigma, vectors.len()), (vec![2.0, 0.0, 0.0], 3));
    }

    #[test]
    fn the_reduced_basis_has_a_one_where_the_others_have_a_zero() {
        let of = |rows: [[f64; 3]; 2]| echelon(rows.map(|row| row.to_vec()).to_vec());
        assert_eq!(of([[2.0, 4.0, 0.0], [1.0, 1.0, 1.0]]), [[0.5, 1.0, 0.0], [0.5, 0.0, 1.0]]);
        // In the order of the ones, whichever came first.
        assert_eq!(of([[0.0, 0.0, 5.0], [1.0, 2.0, 0.0]]), [[0.5, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        // Of equal pivots the last column.
        assert_eq!(of([[1.0, 1.0, 0.0], [0.0, 3.0, 3.0]]), [[1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]]);
    }
}
