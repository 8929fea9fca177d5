//! Two classical spins in a fluctuating magnetic field, compiled.

use real::Real;
use systems::{ImplicitStep, Invariant};

use crate::*;

/// Two spins with y = (s₁, s₂), B(y)v = (s₁ × v₁, s₂ × v₂), H₀ = −J s₁·s₂ − ½K Σ (sᵢᶻ)², and the
/// same field on both, Hₘ = −σ(s₁ᵐ + s₂ᵐ) for m = x, y, z.
///
/// Lévy areas are drawn for compiled systems only. Where none are needed, take
/// [`SpinLattice`](systems::lattice::SpinLattice). The three noises do not commute: \[fₓ, f_y\]
/// rotates about z. Casimirs: ½|sᵢ|².
pub struct TwoSpins;

/// Exchange constant J.
const EXCHANGE: f64 = 1.0;
/// Anisotropy constant K.
const ANISOTROPY: f64 = 0.5;
/// Size σ of the random field.
const FIELD: f64 = 0.8;

pub fn spin_pair<G: Damping>(damping: G) -> Problem<TwoSpins, G, 6> {
    valid(Problem::new(TwoSpins, damping, [1.0, 0.0, 0.0, 0.0, 0.6, 0.8], 1.0))
}

impl PoissonSystem<6, 3> for TwoSpins {
    fn name(&self) -> &'static str {
        "spin-chain"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 6], v: [R; 6]) -> [R; 6] {
        let component = |i: usize| {
            let (spin, j, k) = (i / 3 * 3, (i + 1) % 3, (i + 2) % 3);
            y[spin + j] * v[spin + k] - y[spin + k] * v[spin + j]
        };
        [0, 1, 2, 3, 4, 5].map(component)
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 6], dt: f64, dw: [f64; 3]) -> R {
        let exchange = y[0] * y[3] + y[1] * y[4] + y[2] * y[5];
        let anisotropy = y[2] * y[2] + y[5] * y[5];
        let mut energy = exchange * (-EXCHANGE * dt) - anisotropy * (0.5 * ANISOTROPY * dt);
        for m in 0..3 {
            energy = energy - (y[m] + y[m + 3]) * (FIELD * dw[m]);
        }
        energy
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 6], dt: f64, dw: [f64; 3]) -> [R; 6] {
        let component = |i: usize| y[(i + 3) % 6] * (-EXCHANGE * dt) - FIELD * dw[i % 3];
        let weight = ANISOTROPY * dt;
        let (third, sixth) = (component(2) - y[2] * weight, component(5) - y[5] * weight);
        [component(0), component(1), third, component(3), component(4), sixth]
    }

    /// Commutators \[fₘ, f_l\] = B∇{H_l, Hₘ} with {H_l, Hₘ} = σ² Σᵢ sᵢ·(eₘ × e_l). So the areas
    /// rotate both spins about one axis.
    #[inline(always)]
    fn commutators<R: Real>(&self, y: [R; 6], areas: [[f64; 3]; 3]) -> [R; 6] {
        let [a, b, c] =
            [areas[1][2], -areas[0][2], areas[0][1]].map(|area| R::constant(FIELD * FIELD * area));
        self.structure(y, [a, b, c, a, b, c])
    }

    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::quadratic_casimir("C", "½|sᵢ|²"); 2]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 6]) -> R {
        let s = &y[3 * index..3 * index + 3];
        (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) * 0.5
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::UnrolledFixedPoint;
}
