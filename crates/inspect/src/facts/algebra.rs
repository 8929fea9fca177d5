//! Dense linear algebra for matrices of the size of a system.

use real::elementary::{exp, ln};

use super::ZERO;

/// Matrix by rows.
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

/// Coefficient c that minimizes ‖ca − b‖; zero if a is zero.
pub fn share(a: &[f64], b: &[f64]) -> f64 {
    let square = dot(a, a);
    if square > 0.0 { dot(a, b) / square } else { 0.0 }
}

/// Norm ‖a‖₂.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Vector a + cb.
pub fn moved(a: &[f64], c: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + c * b).collect()
}

/// Vector ca.
pub fn scaled(c: f64, a: &[f64]) -> Vec<f64> {
    a.iter().map(|x| c * x).collect()
}

/// Largest |aᵢ|; NaN if an element is NaN.
pub fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().map(|x| x.abs()).max_by(f64::total_cmp).unwrap_or(0.0)
}

/// The product of two matrices.
pub fn multiplied(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = transposed(b);
    let times = |row: &Vec<f64>| columns.iter().map(|column| dot(column, row)).collect();
    a.iter().map(times).collect()
}

/// The spectral radius by Gelfand's formula ρ = lim ‖Aᵏ‖^{1/k} with k = 2^squarings, to the factor
/// 1 ± n ln κ/k, κ the condition of the eigenvectors.
pub fn spectral_radius(mut power: Matrix, squarings: u32) -> f64 {
    let mut log_radius = 0.0;
    for n in 0..=squarings {
        let size = power.iter().map(|row| norm(row)).fold(0.0, f64::max);
        if size == 0.0 {
            return 0.0;
        }
        log_radius += ln(size) * f64::powi(0.5, n as i32);
        power.iter_mut().flatten().for_each(|x| *x /= size);
        power = multiplied(&power, &power);
    }
    exp(log_radius)
}

/// Smallest eigenvalue of a symmetric matrix A, to a modest multiple of u‖A‖; NaN unless A is
/// finite. It is s − ρ(sI − A) with the shift s = ‖A‖_F and the spectral radius ρ.
pub fn smallest_eigenvalue(a: &Matrix) -> f64 {
    let shift = a.iter().map(|row| dot(row, row)).sum::<f64>().sqrt();
    if !shift.is_finite() {
        return f64::NAN;
    }
    // Rows of zeros, which most are of a form of few components, have the eigenvalue zero.
    let used: Vec<usize> = (0..a.len()).filter(|&i| norm(&a[i]) != 0.0).collect();
    let shifted = |&i: &usize| used.iter().map(|&j| f64::from(i == j) * shift - a[i][j]).collect();
    // After 60 squarings ln n/2⁶⁰ is below the rounding of a sum.
    let least = shift - spectral_radius(used.iter().map(shifted).collect(), 60);
    if used.len() < a.len() && least > 0.0 { 0.0 } else { least }
}

/// Basis of the null space Ax = 0, in which each vector has a 1 where all others have a 0, and the
/// smallest pivot. Pivots up to `zero` count as zero. Gauss–Jordan elimination with complete
/// pivoting gives the same bits on every machine.
pub fn null_space(mut rows: Matrix, unknowns: usize, zero: f64) -> (Matrix, f64) {
    let mut pivots: Vec<usize> = Vec::new();
    let mut least = f64::INFINITY;
    while pivots.len() < rows.len() {
        let rank = pivots.len();
        let places = (rank..rows.len()).flat_map(|i| (0..unknowns).map(move |j| (i, j)));
        let size = |(i, j): (usize, usize)| rows[i][j].abs();
        let place = places.max_by(|a, b| size(*a).total_cmp(&size(*b)).then(b.cmp(a)));
        let Some((i, j)) = place else { break };
        let pivot = rows[i][j];
        if pivot.is_nan() || pivot.abs() <= zero {
            break;
        }
        least = least.min(pivot.abs());
        rows.swap(rank, i);
        rows[rank].iter_mut().for_each(|x| *x /= pivot);
        let pivot_row = rows[rank].clone();
        for (k, row) in rows.iter_mut().enumerate() {
            let factor = row[j];
            if k != rank && factor != 0.0 {
                row.iter_mut().zip(&pivot_row).for_each(|(x, p)| *x -= factor * p);
                row[j] = 0.0;
            }
        }
        pivots.push(j);
    }
    let solutions = (0..unknowns).filter(|j| !pivots.contains(j)).map(|free| {
        let mut x = axis(unknowns, free);
        pivots.iter().zip(&rows).for_each(|(&pivot, row)| x[pivot] = -row[free]);
        x
    });
    (solutions.collect(), least)
}

/// The rank of a matrix with `unknowns` columns: pivots up to 10⁻⁹ of the largest entry are zero.
pub fn rank(matrix: Matrix, unknowns: usize) -> usize {
    let zero = ZERO * largest(matrix.iter().flatten());
    unknowns - null_space(matrix, unknowns, zero).0.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_eigenvalue_is_that_of_closed_forms() {
        let of = |a: &[&[f64]]| {
            smallest_eigenvalue(&a.iter().map(|row| row.to_vec()).collect::<Matrix>())
        };
        // Rounding of a shift of 10^{1/2}, n = 2.
        let near = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-14, "{found}");
        near(of(&[&[2.0, 1.0], &[1.0, 2.0]]), 1.0);
        near(of(&[&[1.0, 2.0], &[2.0, 1.0]]), -1.0);
        assert_eq!(of(&[&[2.0, 0.0], &[0.0, 0.0]]), 0.0);
        assert!(of(&[&[f64::INFINITY, 0.0], &[0.0, 1.0]]).is_nan());
        assert!(of(&[&[f64::NAN, 0.0], &[0.0, 1.0]]).is_nan());
    }
}
