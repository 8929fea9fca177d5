//! Covariances and singular values.

use faer::{Col, Mat, Side};

/// Part of the largest singular value below which another is zero: derivatives are known to 10⁻⁶.
pub const ZERO: f64 = 1e-5;
/// Eigenvalue of a matrix of correlations that is zero: a combination that is known a thousand
/// times better than its moments is a constant of the motion.
const SINGULAR: f64 = 1e-6;

/// A linear map to independent errors of size one.
#[derive(Clone)]
pub struct Whitening {
    /// The map W with WΣWᵀ = 1.
    pub map: Mat<f64>,
}

impl Whitening {
    /// Whitening of an n × n covariance Σ on the complement of its kernel; `None` without one.
    pub fn of(n: usize, covariance: impl Fn(usize, usize) -> f64) -> Option<Self> {
        if n == 0 {
            return None;
        }
        let scale = |size: f64| if size > 0.0 { 1.0 / size } else { 0.0 };
        let scale: Vec<f64> = (0..n).map(|i| scale(covariance(i, i).sqrt())).collect();
        let correlation = Mat::from_fn(n, n, |i, j| scale[i] * covariance(i, j) * scale[j]);
        let found = correlation.self_adjoint_eigen(Side::Lower).ok()?;
        let values = found.S().column_vector();
        let kept: Vec<usize> = (0..n).filter(|&k| values[k] > SINGULAR).collect();
        let entry =
            |k: usize, i: usize| found.U()[(i, kept[k])] * scale[i] / values[kept[k]].sqrt();
        (!kept.is_empty()).then(|| Self { map: Mat::from_fn(kept.len(), n, entry) })
    }

    /// W applied to the difference of two vectors.
    pub fn difference(&self, a: &[f64], b: &[f64]) -> Col<f64> {
        &self.map * Col::from_fn(a.len(), |i| a[i] - b[i])
    }

    /// W applied to columns.
    pub fn columns(&self, columns: &[Vec<f64>]) -> Mat<f64> {
        &self.map * Mat::from_fn(self.map.ncols(), columns.len(), |i, k| columns[k][i])
    }
}

/// Singular values of a matrix J = U diag(s) Vᵀ D whose columns D scales to length one.
pub struct Singular {
    u: Mat<f64>,
    /// The singular values, from the largest on; small ones are zero.
    pub values: Vec<f64>,
    v: Mat<f64>,
    /// Lengths of the columns.
    pub lengths: Vec<f64>,
}

impl Singular {
    /// Singular values of a matrix of finite numbers.
    pub fn of(matrix: &Mat<f64>) -> Option<Self> {
        let length = |k| matrix.col(k).norm_l2();
        let lengths: Vec<f64> = (0..matrix.ncols()).map(length).collect();
        let scaled = |i, k: usize| matrix[(i, k)] / if lengths[k] > 0.0 { lengths[k] } else { 1.0 };
        let svd = Mat::from_fn(matrix.nrows(), matrix.ncols(), scaled).thin_svd().ok()?;
        let values = (0..matrix.ncols().min(matrix.nrows()))
            .map(|k| svd.S().column_vector()[k])
            .map(|s| if s < ZERO { 0.0 } else { s })
            .collect();
        Some(Self { u: svd.U().to_owned(), values, v: svd.V().to_owned(), lengths })
    }

    /// The part Uᵀr of a vector in the image of J; zero along singular directions.
    pub fn along(&self, r: &Col<f64>) -> Vec<f64> {
        let along = self.u.transpose() * r;
        self.values.iter().enumerate().map(|(k, &s)| if s > 0.0 { along[k] } else { 0.0 }).collect()
    }

    /// The x that minimises |Jx − r|² + damping |Dx|².
    pub fn solve(&self, r: &Col<f64>, damping: f64) -> Vec<f64> {
        let along = self.along(r);
        let inverse = |s: f64| if s > 0.0 { s / (s * s + damping) } else { 0.0 };
        let parts: Vec<f64> =
            along.iter().zip(&self.values).map(|(a, &s)| a * inverse(s)).collect();
        self.combine(&parts)
    }

    /// Parameters of coefficients on the singular directions.
    fn combine(&self, parts: &[f64]) -> Vec<f64> {
        self.lengths
            .iter()
            .enumerate()
            .map(|(j, length)| {
                let sum: f64 = parts.iter().enumerate().map(|(k, x)| self.v[(j, k)] * x).sum();
                if *length > 0.0 { sum / length } else { sum }
            })
            .collect()
    }

    /// Direction k in the parameters.
    pub fn direction(&self, k: usize) -> Vec<f64> {
        let unit: Vec<f64> = (0..=k).map(|j| f64::from(u8::from(j == k))).collect();
        self.combine(&unit)
    }

    /// (JᵀJ)⁻¹x.
    pub fn inverse(&self, x: &[f64]) -> Vec<f64> {
        let part = |(k, &s): (usize, &f64)| {
            let dot: f64 = self.direction(k).iter().zip(x).map(|(v, x)| v * x).sum();
            if s > 0.0 { dot / (s * s) } else { 0.0 }
        };
        self.combine(&self.values.iter().enumerate().map(part).collect::<Vec<_>>())
    }
}
