//! B(y): skew symmetry, constancy, the Jacobi identity.

use serde::Serialize;

use super::{
    algebra::{Matrix, largest, times},
    erased::System,
    finding::Finding,
    points::{Points, Random},
};

/// Properties of the structure matrix B(y).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Structure {
    /// `structure(y, v)` = B(y)v is linear in v.
    pub linear: Finding,
    /// Bᵢⱼ + Bⱼᵢ = 0.
    pub skew: Finding,
    /// ∂B = 0.
    pub constant: Finding,
    /// The Jacobi identity Σ_l Bᵢ_l ∂_l Bⱼₖ + cyclic = 0, which makes B a Poisson structure. No
    /// scheme and no theorem of the paper needs it.
    pub jacobi: Finding,
}

impl Structure {
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let mut found = Self::default();
        let d = system.dimension();
        let mut random = Random::new();
        for y in &points.for_identities {
            let (b, derivatives) = (system.matrix(y), system.matrix_derivatives(y));
            let size = largest(b.iter().flatten());
            let v: Vec<f64> = (0..d).map(|_| 3.0 * random.uniform()).collect();
            found.linear.compare(&system.structure(y, &v), &times(&b, &v), size * d as f64, y);
            let slope = largest(&derivatives.concat().concat());
            found.constant.record(slope * largest(y), size, y);
            for i in 0..d {
                for j in 0..=i {
                    found.skew.record(b[i][j] + b[j][i], size, y);
                }
                for (j, k) in (0..i).flat_map(|j| (0..j).map(move |k| (j, k))) {
                    let defect = jacobiator(&b, &derivatives, [i, j, k]);
                    found.jacobi.record(defect, size * slope * d as f64, y);
                }
            }
        }
        found
    }
}

/// Σ_l Bᵢ_l ∂_l Bⱼₖ + Bⱼ_l ∂_l Bₖᵢ + Bₖ_l ∂_l Bᵢⱼ.
fn jacobiator(b: &Matrix, derivatives: &[Matrix], [i, j, k]: [usize; 3]) -> f64 {
    let term = |(l, d): (usize, &Matrix)| b[i][l] * d[j][k] + b[j][l] * d[k][i] + b[k][l] * d[i][j];
    derivatives.iter().enumerate().map(term).sum()
}
