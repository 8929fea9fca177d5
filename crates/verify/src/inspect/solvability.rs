//! Up to which step size the implicit equation of `sexp` is a contraction (paper, `lem:scheme`).
//!
//! C(k, τ) = τ(½‖B′‖‖∇H₀‖ + ‖B‖‖∇²H₀‖) + √(2kτ|log τ|) Σₘ (½‖B′‖‖∇Hₘ‖ + ‖B‖‖∇²Hₘ‖) < 1.

use serde::Serialize;

use super::algebra::{eigenvalues, gram, norm, spectral_norm};
use super::points::Points;
use super::probe::{Matrix, Probe, matrix, pick, slopes};

/// The norms of the contraction constant, each the largest over the points that were looked at.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solvability {
    /// ‖B‖.
    pub structure: f64,
    /// A bound of ‖B′‖ = max ‖Σ v_l ∂_l B‖ over unit vectors v: the root of ‖Σ_l (∂_l B)ᵀ∂_l B‖.
    pub structure_slope: f64,
    /// ‖∇H₀‖, …, ‖∇H_M‖.
    pub gradients: Vec<f64>,
    /// ‖∇²H₀‖, …, ‖∇²H_M‖.
    pub hessians: Vec<f64>,
}

impl Solvability {
    pub(super) fn of(system: &dyn Probe, points: &Points) -> Self {
        let count = system.noises() + 1;
        let mut norms = Self {
            structure: 0.0,
            structure_slope: 0.0,
            gradients: vec![0.0; count],
            hessians: vec![0.0; count],
        };
        for y in &points.many {
            norms.structure = norms.structure.max(spectral_norm(&matrix(system, y)));
            let stacked: Matrix = slopes(system, y).into_iter().flatten().collect();
            let square = eigenvalues(gram(&stacked)).last().map_or(0.0, |&square| square.max(0.0));
            norms.structure_slope = norms.structure_slope.max(square.sqrt());
            for m in 0..count {
                let weights = pick(system, m);
                norms.gradients[m] =
                    norms.gradients[m].max(norm(&system.dual_gradient(y, &weights)));
                norms.hessians[m] =
                    norms.hessians[m].max(spectral_norm(&system.hessian(y, &weights)));
            }
        }
        norms
    }

    /// The Lipschitz constant of B∇Hₘ in the step.
    fn of_hamiltonian(&self, m: usize) -> f64 {
        0.5 * self.structure_slope * self.gradients[m] + self.structure * self.hessians[m]
    }

    /// C(k, τ) for truncation order `k` and step size 0 < `tau` < 1.
    #[must_use]
    pub fn contraction(&self, k: u32, tau: f64) -> f64 {
        let noises: f64 = (1..self.gradients.len()).map(|m| self.of_hamiltonian(m)).sum();
        tau * self.of_hamiltonian(0) + (2.0 * f64::from(k) * tau * tau.ln().abs()).sqrt() * noises
    }

    /// The largest τ̄ such that C(k, τ) < 1 for all τ < τ̄; 1 where truncated increments end before
    /// the bound does.
    #[must_use]
    pub fn largest_step(&self, k: u32) -> f64 {
        // Down from 1 on a grid, to the first step below which C never reaches one; C rises from
        // zero with τ up to 1/e.
        let grid = |n: u32| f64::powf(2.0, -f64::from(n) / 16.0);
        // NaN contracts nowhere.
        let contracts = |tau: f64| self.contraction(k, tau) < 1.0;
        let Some(n) = (1..16 * 1000).rev().find(|&n| !contracts(grid(n))) else { return 1.0 };
        if n + 1 == 16 * 1000 {
            return 0.0;
        }
        let (mut below, mut above) = (grid(n + 1), grid(n));
        for _ in 0..60 {
            let middle = 0.5 * (below + above);
            if contracts(middle) { below = middle } else { above = middle }
        }
        below
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_step_solves_the_equation() {
        let pendulum = Solvability {
            structure: 1.0,
            structure_slope: 0.0,
            gradients: vec![9.0; 2],
            hessians: vec![1.0; 2],
        };
        for k in [1, 2, 4] {
            let tau = pendulum.largest_step(k);
            assert!((pendulum.contraction(k, tau) - 1.0).abs() < 1e-9, "{k}: {tau}");
            assert!(pendulum.contraction(k, 0.5 * tau) < 1.0);
        }
        let nothing = Solvability { structure: 0.0, ..pendulum.clone() };
        assert_eq!(nothing.largest_step(4), 1.0);
        // Nothing is solvable where a norm is infinite or unknown.
        for bad in [f64::INFINITY, f64::NAN] {
            assert_eq!(Solvability { structure: bad, ..pendulum.clone() }.largest_step(4), 0.0);
        }
    }
}
