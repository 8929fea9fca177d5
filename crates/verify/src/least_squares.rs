//! Generalised least squares for a handful of correlated points.
//!
//! min (y − Xβ)ᵀV⁻¹(y − Xβ) by Cholesky. At most a dozen points and four parameters; written here because a
//! linear-algebra library's kernels are not bit-stable between processors, and `results.json` is.

/// The fit of a linear model.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// β.
    pub parameters: Vec<f64>,
    /// Covariance of β, (XᵀV⁻¹X)⁻¹, row by row.
    pub covariance: Vec<Vec<f64>>,
    /// χ² of the residuals, with (points − parameters) degrees of freedom when the model is right.
    pub chi_square: f64,
}

/// Fits y ≈ Xβ with covariance V of y; `None` when V or XᵀV⁻¹X is not positive definite.
pub(crate) fn fit(design: &[Vec<f64>], y: &[f64], covariance: &[Vec<f64>]) -> Option<Fit> {
    let factor = cholesky(covariance)?;
    // Whitened: L⁻¹X and L⁻¹y.
    let parameters = design[0].len();
    let columns: Vec<Vec<f64>> =
        (0..parameters).map(|c| forward(&factor, &design.iter().map(|row| row[c]).collect::<Vec<_>>())).collect();
    let target = forward(&factor, y);
    let normal: Vec<Vec<f64>> = columns.iter().map(|a| columns.iter().map(|b| dot(a, b)).collect()).collect();
    let normal_factor = cholesky(&normal)?;
    let right: Vec<f64> = columns.iter().map(|column| dot(column, &target)).collect();
    let beta = backward(&normal_factor, &forward(&normal_factor, &right));
    let inverse: Vec<Vec<f64>> = (0..parameters)
        .map(|c| {
            let unit: Vec<f64> = (0..parameters).map(|r| if r == c { 1.0 } else { 0.0 }).collect();
            backward(&normal_factor, &forward(&normal_factor, &unit))
        })
        .collect();
    let chi_square = (0..target.len())
        .map(|i| {
            let model: f64 = (0..parameters).map(|c| columns[c][i] * beta[c]).sum();
            (target[i] - model) * (target[i] - model)
        })
        .sum();
    Some(Fit { parameters: beta, covariance: inverse, chi_square })
}

/// Pivots below this fraction of the diagonal mean that the matrix is singular to round-off.
const SINGULAR: f64 = 64.0 * f64::EPSILON;

/// L with LLᵀ = A.
fn cholesky(a: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = a.len();
    let mut l = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let rest: f64 = a[i][j] - dot(&l[i][..j], &l[j][..j]);
            if i == j {
                if rest.is_nan() || rest <= SINGULAR * a[i][i].abs() {
                    return None;
                }
                l[i][i] = rest.sqrt();
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    Some(l)
}

/// L⁻¹b.
fn forward(l: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let mut x = Vec::with_capacity(b.len());
    for i in 0..b.len() {
        x.push((b[i] - dot(&l[i][..i], &x)) / l[i][i]);
    }
    x
}

/// L⁻ᵀb.
fn backward(l: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let mut x = b.to_vec();
    for i in (0..b.len()).rev() {
        for k in i + 1..b.len() {
            x[i] -= l[k][i] * x[k];
        }
        x[i] /= l[i][i];
    }
    x
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_correlated_points() {
        // y = 1 + 2x exactly: any covariance gives back the line, with no residual.
        let x = [0.0, 1.0, 2.0, 4.0];
        let design: Vec<Vec<f64>> = x.iter().map(|&x| vec![1.0, x]).collect();
        let y: Vec<f64> = x.iter().map(|x| 1.0 + 2.0 * x).collect();
        let covariance: Vec<Vec<f64>> =
            (0..4i32).map(|i| (0..4i32).map(|j| 0.5f64.powi((i - j).abs())).collect()).collect();
        let fit = fit(&design, &y, &covariance).unwrap();
        assert!((fit.parameters[0] - 1.0).abs() < 1e-14 && (fit.parameters[1] - 2.0).abs() < 1e-14);
        assert!(fit.chi_square < 1e-26);
    }

    #[test]
    fn independent_points_give_the_textbook_variance() {
        let design: Vec<Vec<f64>> = (0..5).map(|_| vec![1.0]).collect();
        let mut covariance = vec![vec![0.0; 5]; 5];
        for (i, row) in covariance.iter_mut().enumerate() {
            row[i] = 0.5;
        }
        let fit = fit(&design, &[1.0, 2.0, 3.0, 4.0, 5.0], &covariance).unwrap();
        assert!((fit.parameters[0] - 3.0).abs() < 1e-15 && (fit.covariance[0][0] - 0.1).abs() < 1e-15);
        assert!((fit.chi_square - 20.0).abs() < 1e-13);
    }

    #[test]
    fn singular_covariances_are_refused() {
        let design = vec![vec![1.0], vec![1.0]];
        assert!(fit(&design, &[1.0, 1.0], &[vec![1.0, 1.0], vec![1.0, 1.0]]).is_none());
        assert!(fit(&design, &[1.0, 1.0], &[vec![f64::NAN, 0.0], vec![0.0, 1.0]]).is_none());
    }
}
