//! What B(y) is: skew, constant or not, Jacobi's identity.

use serde::Serialize;

use super::algebra::{largest, times};
use super::finding::Finding;
use super::points::{Numbers, Points};
use super::probe::{Matrix, Probe, matrix, slopes};

/// What B(y) is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Structure {
    /// B(y)v is linear in v.
    pub linear: Finding,
    /// Bᵢⱼ + Bⱼᵢ = 0.
    pub skew: Finding,
    /// ∂B = 0.
    pub constant: Finding,
    /// Σ_l Bᵢ_l ∂_l Bⱼₖ + cyclic = 0. The schemes and the theorems do not need it; a geometer does.
    pub jacobi: Finding,
}

impl Structure {
    pub(super) fn of(system: &dyn Probe, points: &Points) -> Self {
        let (mut linear, mut skew) = (Finding::new(), Finding::new());
        let (mut constant, mut jacobi) = (Finding::new(), Finding::new());
        let d = system.dimension();
        let mut numbers = Numbers::new();
        for y in &points.few {
            let (b, slopes) = (matrix(system, y), slopes(system, y));
            let size = largest(&b);
            let v: Vec<f64> = (0..d).map(|_| 3.0 * numbers.uniform()).collect();
            let (direct, by_columns) = (system.structure(y, &v), times(&b, &v));
            for i in 0..d {
                linear.see(direct[i] - by_columns[i], size * d as f64, y);
                for j in 0..=i {
                    skew.see(b[i][j] + b[j][i], size, y);
                }
            }
            let steepest = slopes.iter().map(largest).fold(0.0, f64::max);
            let extent = y.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            constant.see(steepest * extent, size, y);
            for i in 0..d {
                for j in 0..i {
                    for k in 0..j {
                        jacobi.see(
                            jacobiator(&b, &slopes, [i, j, k]),
                            size * steepest * d as f64,
                            y,
                        );
                    }
                }
            }
        }
        Self { linear, skew, constant, jacobi }
    }
}

/// Σ_l Bᵢ_l ∂_l Bⱼₖ + Bⱼ_l ∂_l Bₖᵢ + Bₖ_l ∂_l Bᵢⱼ.
fn jacobiator(b: &Matrix, slopes: &[Matrix], [i, j, k]: [usize; 3]) -> f64 {
    (0..b.len())
        .map(|l| b[i][l] * slopes[l][j][k] + b[j][l] * slopes[l][k][i] + b[k][l] * slopes[l][i][j])
        .sum()
}
