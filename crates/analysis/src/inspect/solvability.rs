//! The contraction constant of the implicit equation of `sexp`.

use real::WIDTH;
use serde::Serialize;

use super::{
    algebra::norm,
    points::{Points, Region},
    probe::{Local, Probe},
    spectrum::spectral_norm,
};

/// The norms in the contraction constant of the implicit step of `sexp`,
///
/// C(k, τ) = τ(½‖B′‖‖∇H₀‖ + ‖B‖‖∇²H₀‖) + √(2kτ|log τ|) Σₘ (½‖B′‖‖∇Hₘ‖ + ‖B‖‖∇²Hₘ‖),
///
/// each the largest over the points, hence found by search: a supremum may be larger. For C(k, τ) <
/// 1 the step has exactly one solution (solvability lemma of the paper).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solvability {
    /// The region of the points.
    pub region: Region,
    /// The number of points.
    pub points: usize,
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
    pub(super) fn of(probe: &mut Probe<'_>, points: &Points) -> Self {
        let none = vec![0.0; probe.noises() + 1];
        let mut found = Self {
            region: points.region.clone(),
            points: points.for_suprema.len(),
            structure: 0.0,
            structure_slope: 0.0,
            gradients: none.clone(),
            hessians: none,
        };
        for chunk in points.for_suprema.chunks(WIDTH) {
            for Local { b, slopes, gradients, hessians, .. } in probe.locals(chunk) {
                found.structure = found.structure.max(spectral_norm(&b));
                found.structure_slope = found.structure_slope.max(spectral_norm(&slopes.concat()));
                for (most, slope) in found.gradients.iter_mut().zip(&gradients) {
                    *most = most.max(norm(slope));
                }
                for (most, hessian) in found.hessians.iter_mut().zip(&hessians) {
                    *most = most.max(spectral_norm(hessian));
                }
            }
        }
        found
    }

    /// ½‖B′‖‖∇Hₘ‖ + ‖B‖‖∇²Hₘ‖.
    fn lipschitz(&self, m: usize) -> f64 {
        0.5 * self.structure_slope * self.gradients[m] + self.structure * self.hessians[m]
    }

    /// C(k, τ) for truncation order `k` and step size 0 < `tau` < 1.
    pub fn contraction(&self, k: u32, tau: f64) -> f64 {
        let noises: f64 = (1..self.gradients.len()).map(|m| self.lipschitz(m)).sum();
        tau * self.lipschitz(0) + (2.0 * f64::from(k) * tau * tau.ln().abs()).sqrt() * noises
    }

    /// The largest τ̄ ≤ 1 with C(k, τ) < 1 for all τ < τ̄.
    pub fn largest_step(&self, k: u32) -> f64 {
        let grid = |n: u32| f64::powf(2.0, -f64::from(n) / 16.0);
        // False for NaN.
        let contracts = |tau: f64| self.contraction(k, tau) < 1.0;
        // The smallest τ of the grid without contraction, refined by bisection.
        let Some(n) = (1..16_000).rev().find(|&n| !contracts(grid(n))) else { return 1.0 };
        let (mut below, mut above) = (0.0, grid(n));
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
    fn the_largest_step_is_below_all_that_do_not_contract() {
        // C(1, τ) = τ/2 + √(2τ|ln τ|) is below one near τ = 1 again.
        let found = Solvability {
            region: Region::Ball(1.0),
            points: 1,
            structure: 1.0,
            structure_slope: 0.0,
            gradients: vec![1.0; 2],
            hessians: vec![0.5, 1.0],
        };
        for k in [1, 2, 4] {
            let tau = found.largest_step(k);
            assert!((found.contraction(k, tau) - 1.0).abs() < 1e-9, "{k}: {tau}");
            assert!(found.contraction(k, 0.5 * tau) < 1.0 && tau < 0.36, "{k}: {tau}");
        }
        assert!(found.contraction(1, 0.999) < 1.0 && found.contraction(1, 0.5) > 1.0);
        // Nothing is solvable where a norm is infinite or unknown, and all is where it is zero.
        let of = |structure| Solvability { structure, ..found.clone() }.largest_step(4);
        assert_eq!([0.0, f64::INFINITY, f64::NAN].map(of), [1.0, 0.0, 0.0]);
        // Without noise C is linear: 1/‖∇²H₀‖, for steps of 2⁻⁵⁰ as well; and all steps below 1.
        let alone = |hessian: f64| {
            let (gradients, hessians) = (vec![1.0], vec![hessian]);
            Solvability { gradients, hessians, ..found.clone() }.largest_step(4)
        };
        for size in [3.0, 2f64.powi(50)] {
            assert!((size * alone(size) - 1.0).abs() < 1e-9, "{size}");
        }
        assert_eq!((alone(0.999), alone(0.0)), (1.0, 1.0));
    }
}
