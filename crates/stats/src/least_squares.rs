//! Generalised least squares for a handful of correlated points: min (y − Xβ)ᵀV⁻¹(y − Xβ).
//!
//! With V = LLᵀ the problem is min |L⁻¹y − L⁻¹Xβ|², solved by its normal equations. There are at
//! most a dozen points and four parameters. The algebra is written here because the kernels of a
//! linear-algebra library give different bits on different processors, and `results.json` must
//! not.

/// The Cholesky factor L of a covariance V, for several fits with the same one.
pub struct Weighting {
    factor: Vec<Vec<f64>>,
}

/// The fit of a linear model.
pub struct Fit<'a> {
    weighting: &'a Weighting,
    /// Matrix L⁻¹X, column by column.
    columns: Vec<Vec<f64>>,
    /// Cholesky factor of XᵀV⁻¹X.
    normal: Vec<Vec<f64>>,
    /// Parameters β.
    pub parameters: Vec<f64>,
    /// χ² of the residuals; it has (points − parameters) degrees of freedom if the model is right.
    pub chi_square: f64,
}

impl Weighting {
    /// Factors the covariance V; `None` if V is not positive definite.
    pub fn new(covariance: &[Vec<f64>]) -> Option<Self> {
        Some(Self { factor: cholesky(covariance)? })
    }

    /// Fits y ≈ Xβ, with X given column by column; `None` if XᵀV⁻¹X is not positive definite.
    pub fn fit(&self, design: &[Vec<f64>], y: &[f64]) -> Option<Fit<'_>> {
        let columns: Vec<_> = design.iter().map(|column| forward(&self.factor, column)).collect();
        let y = forward(&self.factor, y);
        let normal = cholesky(&matrix(columns.len(), |i, j| dot(&columns[i], &columns[j])))?;
        let right: Vec<f64> = columns.iter().map(|column| dot(column, &y)).collect();
        let parameters = backward(&normal, &forward(&normal, &right));
        let residuals = y.iter().zip(product(&columns, &parameters)).map(|(y, model)| y - model);
        let chi_square = residuals.map(|residual| residual * residual).sum();
        Some(Fit { weighting: self, columns, normal, parameters, chi_square })
    }
}

impl Fit<'_> {
    /// Covariances of parameter c with all of them: row c of (XᵀV⁻¹X)⁻¹.
    pub fn covariance(&self, c: usize) -> Vec<f64> {
        let mut unit = vec![0.0; self.parameters.len()];
        unit[c] = 1.0;
        backward(&self.normal, &forward(&self.normal, &unit))
    }

    /// The weights w with β_c = w·y: row c of (XᵀV⁻¹X)⁻¹XᵀV⁻¹.
    pub fn gain(&self, c: usize) -> Vec<f64> {
        backward(&self.weighting.factor, &product(&self.columns, &self.covariance(c)))
    }
}

/// Fraction of the diagonal below which a pivot means that the matrix is singular to round-off.
const SINGULAR: f64 = 64.0 * f64::EPSILON;

/// Cholesky factor L with LLᵀ = A; `None` if A is not positive definite.
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

/// Solves Lx = b.
fn forward(l: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let mut x = Vec::with_capacity(b.len());
    for i in 0..b.len() {
        x.push((b[i] - dot(&l[i][..i], &x)) / l[i][i]);
    }
    x
}

/// Solves Lᵀx = b.
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

/// Product Xβ, with X given column by column.
fn product(columns: &[Vec<f64>], parameters: &[f64]) -> Vec<f64> {
    let row = |i| columns.iter().zip(parameters).map(|(column, beta)| column[i] * beta).sum();
    (0..columns.first().map_or(0, Vec::len)).map(row).collect()
}

/// Scalar product a·b.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The n × n matrix with the given entries, row by row.
pub fn matrix(n: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// The diagonal matrix of these variances.
pub fn diagonal(variances: &[f64]) -> Vec<Vec<f64>> {
    matrix(variances.len(), |i, j| if i == j { variances[i] } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: &[f64], exact: &[f64]) -> bool {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-13 * b.abs().max(1.0);
        found.len() == exact.len() && found.iter().zip(exact).all(near)
    }

    #[test]
    fn gains_give_back_the_parameters() {
        let x = vec![0.0f64, 1.0, 2.5, 4.0];
        let design = [vec![1.0; 4], x.clone(), x.iter().map(|x| x.sin()).collect()];
        let y = [0.3, -1.0, 2.0, 0.7];
        let correlations = matrix(4, |i, j| 0.5f64.powi(i.abs_diff(j) as i32));
        let weighting = Weighting::new(&correlations).unwrap();
        let fit = weighting.fit(&design, &y).unwrap();
        for c in 0..3 {
            let gain = fit.gain(c);
            assert!(close(&[dot(&gain, &y)], &[fit.parameters[c]]));
            // Var(w·y) = |Lᵀw|².
            let lower = &weighting.factor;
            let row = |j: usize| (0..4).map(|i| lower[i][j] * gain[i]).sum::<f64>().powi(2);
            let variance: f64 = (0..4).map(row).sum();
            assert!(close(&[variance], &[fit.covariance(c)[c]]));
        }
    }

    #[test]
    fn covariances_of_parameters_are_those_of_a_line() {
        // Points −1, 0, 2 with variances 1, ½, ¼: XᵀV⁻¹X = (7, 7; 7, 17), with determinant 70.
        let weighting = Weighting::new(&diagonal(&[1.0, 0.5, 0.25])).unwrap();
        let x = vec![-1.0, 0.0, 2.0];
        let fit = weighting.fit(&[vec![1.0; 3], x], &[0.0, 1.0, 1.0]).unwrap();
        for (c, exact) in [[17.0 / 70.0, -0.1], [-0.1, 0.1]].iter().enumerate() {
            assert!(close(&fit.covariance(c), exact));
        }
        // XᵀV⁻¹y = (6, 8): β = (17·6 − 7·8, −7·6 + 7·8)/70 = (46, 14)/70.
        assert!(close(&fit.parameters, &[46.0 / 70.0, 0.2]));
        // χ² = yᵀV⁻¹y − βᵀXᵀV⁻¹y = 6 − (46·6 + 14·8)/70.
        assert!(close(&[fit.chi_square], &[6.0 - 388.0 / 70.0]));
    }

    #[test]
    fn a_matrix_is_singular_below_sixty_four_roundings() {
        // The second pivot is δ of a diagonal of 1 + δ.
        let with = |delta: f64| Weighting::new(&[vec![1.0, 1.0], vec![1.0, 1.0 + delta]]);
        assert!(with(60.0 * f64::EPSILON).is_none() && with(70.0 * f64::EPSILON).is_some());
        assert!(Weighting::new(&[vec![-1.0]]).is_none());
        assert!(Weighting::new(&[vec![f64::NAN, 0.0], vec![0.0, 1.0]]).is_none());
    }
}
