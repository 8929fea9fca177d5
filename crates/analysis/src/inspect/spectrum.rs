//! Singular values and eigenvalues, by faer. Their last bits depend on the machine: only what is
//! printed may depend on them.

use faer::{Mat, Side};

use crate::facts::algebra::Matrix;

/// The matrix, if it is finite.
fn dense(a: &Matrix) -> Option<Mat<f64>> {
    let finite = a.iter().flatten().all(|x| x.is_finite());
    finite.then(|| Mat::from_fn(a.len(), a.first().map_or(0, Vec::len), |i, j| a[i][j]))
}

/// ‖A‖₂, the largest singular value; NaN unless A is finite.
pub fn spectral_norm(a: &Matrix) -> f64 {
    let values = dense(a).and_then(|a| a.singular_values().ok());
    values.map_or(f64::NAN, |values| values.into_iter().fold(0.0, f64::max))
}

/// The smallest eigenvalue of a symmetric matrix; NaN unless it is finite.
pub fn smallest_eigenvalue(a: &Matrix) -> f64 {
    let values = dense(a).and_then(|a| a.self_adjoint_eigenvalues(Side::Lower).ok());
    values.map_or(f64::NAN, |values| values.into_iter().fold(f64::INFINITY, f64::min))
}
