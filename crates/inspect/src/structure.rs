//! B(y): skew symmetry, constancy, the Jacobi identity.

use serde::Serialize;

use super::Sight;
use crate::facts::{
    Batch, Finding, Purpose, Random, Status, combined, differences, moved, places, product, sum,
};

/// Properties of the structure matrix B(y).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Structure {
    /// Finding on linearity: B(y)v is linear in v.
    pub linear: Finding,
    /// Finding on skew symmetry: Bᵢⱼ + Bⱼᵢ = 0.
    pub skew: Finding,
    /// Finding on constancy: B is the same at all points.
    pub constant: Finding,
    /// Finding on the Jacobi identity Σ_l Bᵢ_l ∂_l Bⱼₖ + cyclic = 0, which makes B a Poisson
    /// structure. No scheme and no theorem of the paper needs it.
    pub jacobi: Finding,
}

impl Structure {
    pub(super) fn of(sight: &mut Sight<'_>) -> Self {
        let mut random = Random::new(Purpose::Vectors);
        let [u, v] = [0, 1].map(|_| sight.vectors(&mut random));
        let both: Batch = u.iter().zip(&v).map(|(u, v)| moved(u, 1.0, v)).collect();
        let [bu, bv, b_both] = [&u, &v, &both].map(|v| sight.probe.structure(&sight.states, v));
        let defect = |n: usize, i: usize| sum([b_both[n][i], -bu[n][i], -bv[n][i]]);
        let linear = sight.found(|n| (0..u[n].len()).map(|i| defect(n, i)).collect());
        // Bᵢⱼ + Bⱼᵢ = 0, or vᵀB(y)v = 0.
        let skew = sight.found(|n| match sight.matrices.get(n) {
            Some(b) => places(b.len()).map(|(i, j)| sum([b[i][j], b[j][i]])).collect(),
            None => vec![product(&v[n], &bv[n])],
        });
        let fixed = sight.probe.structure(&sight.states, &v[..1]);
        let constant = sight.found(|n| differences(&fixed[n], &fixed[0]));
        // The Jacobi identity for three covectors.
        let covectors = [u, v, sight.vectors(&mut random)];
        let turned = covectors.each_ref().map(|v| sight.probe.structure(&sight.states, v));
        let mut jacobi = vec![(0.0, 0.0); sight.states.len()];
        for k in 0..3 {
            let (a, b, c) = (&covectors[k], &covectors[(k + 1) % 3], &turned[(k + 2) % 3]);
            let along = sight.probe.structure_along(&sight.states, c, b);
            let terms = a.iter().zip(&along).map(|(a, along)| product(a, along));
            jacobi = combined(&jacobi, &terms.collect::<Vec<_>>());
        }
        let jacobi = sight.found(|n| vec![jacobi[n]]);
        Self { linear, skew, constant, jacobi }
    }

    /// Whether B(y)v is linear in v and B skew-symmetric.
    pub(super) fn sound(&self) -> Status {
        self.linear.status.min(self.skew.status)
    }
}
