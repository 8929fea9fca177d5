//! Generalised least squares for a handful of correlated points.
//!
//! min (y − Xβ)ᵀV⁻¹(y − Xβ) by Cholesky. At most a dozen points and four parameters; written here
//! because a linear-algebra library's kernels are not bit-stable between processors, and
//! `results.json` is.

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
    Weighting::new(covariance)?.fit(design, y)
}

/// The Cholesky factor of a covariance, for several fits with the same one.
#[derive(Clone, Debug)]
pub(crate) struct Weighting {
    factor: Vec<Vec<f64>>,
}

impl Weighting {
    /// `None` when V is not positive definite.
    pub(crate) fn new(covariance: &[Vec<f64>]) -> Option<Self> {
        Some(Self { factor: cholesky(covariance)? })
    }

    /// L⁻¹X, column by column.
    fn whitened(&self, design: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let column =
            |c: usize| forward(&self.factor, &design.iter().map(|row| row[c]).collect::<Vec<_>>());
        (0..design[0].len()).map(column).collect()
    }

    /// Fits y ≈ Xβ; `None` when XᵀV⁻¹X is not positive definite.
    pub(crate) fn fit(&self, design: &[Vec<f64>], y: &[f64]) -> Option<Fit> {
        let columns = self.whitened(design);
        let parameters = columns.len();
        let target = forward(&self.factor, y);
        let normal: Vec<Vec<f64>> =
            columns.iter().map(|a| columns.iter().map(|b| dot(a, b)).collect()).collect();
        let normal_factor = cholesky(&normal)?;
        let right: Vec<f64> = columns.iter().map(|column| dot(column, &target)).collect();
        let beta = backward(&normal_factor, &forward(&normal_factor, &right));
        let inverse: Vec<Vec<f64>> = (0..parameters)
            .map(|c| {
                let unit: Vec<f64> =
                    (0..parameters).map(|r| if r == c { 1.0 } else { 0.0 }).collect();
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

    /// The weights w with β_c = w·y: row c of (XᵀV⁻¹X)⁻¹XᵀV⁻¹, where `inverse` is that row of
    /// (XᵀV⁻¹X)⁻¹.
    pub(crate) fn gain(&self, design: &[Vec<f64>], inverse: &[f64]) -> Vec<f64> {
        let columns = self.whitened(design);
        let whitened: Vec<f64> = (0..design.len())
            .map(|i| columns.iter().zip(inverse).map(|(column, a)| column[i] * a).sum())
            .collect();
        backward(&self.factor, &whitened)
    }
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
        assert!(
            (fit.parameters[0] - 3.0).abs() < 1e-15 && (fit.covariance[0][0] - 0.1).abs() < 1e-15
        );
        assert!((fit.chi_square - 20.0).abs() < 1e-13);
    }

    #[test]
    fn gains_give_back_the_parameters() {
        let design: Vec<Vec<f64>> =
            [0.0f64, 1.0, 2.5, 4.0].iter().map(|&x| vec![1.0, x, x.sin()]).collect();
        let covariance: Vec<Vec<f64>> =
            (0..4i32).map(|i| (0..4i32).map(|j| 0.5f64.powi((i - j).abs())).collect()).collect();
        let y = [0.3, -1.0, 2.0, 0.7];
        let weighting = Weighting::new(&covariance).unwrap();
        let fit = weighting.fit(&design, &y).unwrap();
        for c in 0..3 {
            let gain = weighting.gain(&design, &fit.covariance[c]);
            assert!((dot(&gain, &y) - fit.parameters[c]).abs() < 1e-13);
            let variance: f64 = (0..4).map(|i| gain[i] * dot(&covariance[i], &gain)).sum();
            assert!((variance - fit.covariance[c][c]).abs() < 1e-13 * variance.max(1.0));
        }
    }

    #[test]
    fn singular_covariances_are_refused() {
        let design = vec![vec![1.0], vec![1.0]];
        assert!(fit(&design, &[1.0, 1.0], &[vec![1.0, 1.0], vec![1.0, 1.0]]).is_none());
        assert!(fit(&design, &[1.0, 1.0], &[vec![f64::NAN, 0.0], vec![0.0, 1.0]]).is_none());
    }
}
