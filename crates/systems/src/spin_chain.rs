//! A classical Heisenberg chain in a fluctuating magnetic field.

use real::Real;

use crate::{
    Flows, ImplicitStep, Invariant, PoissonSystem, SystemError, cayley::cayley_cross,
    error::finite, system::no_invariant,
};

/// A classical Heisenberg chain of n = D/3 spins sᵢ ∈ ℝ³ in a fluctuating magnetic field with y =
/// (s₁, …, sₙ), B(y)v = (s₁ × v₁, …, sₙ × vₙ), H₀ = −J Σ sᵢ·sᵢ₊₁ − ½K Σ (sᵢᶻ)², and the same field
/// on all spins, Hₘ = −σ Σᵢ sᵢᵐ for m = x, y, z.
///
/// The three noises do not commute: [fₓ, f_y] rotates about z. Casimirs: ½|sᵢ|², of degree 2, one
/// per spin.
#[derive(Clone, Copy, Debug)]
pub struct SpinChain<const D: usize> {
    exchange: f64,
    anisotropy: f64,
    field: f64,
}

impl<const D: usize> SpinChain<D> {
    /// The chain with exchange J, anisotropy K and field strength σ. It does not compile unless D
    /// is a positive multiple of 3.
    ///
    /// # Errors
    /// [`SystemError::NonFiniteParameter`] unless all three are finite.
    pub fn new(exchange: f64, anisotropy: f64, field: f64) -> Result<Self, SystemError> {
        const { assert!(D > 0 && D.is_multiple_of(3), "a spin has three components") };
        Ok(Self {
            exchange: finite("the exchange J", exchange)?,
            anisotropy: finite("the anisotropy K", anisotropy)?,
            field: finite("the field strength σ", field)?,
        })
    }
}

/// Parts: the fluctuating field, the anisotropy, the bonds (1, 2), (3, 4), …, and the bonds (2, 3),
/// (4, 5), …. All are rotations, by Cayley's map; a bond turns both spins about their sum.
impl<const D: usize> Flows<D, 3> for SpinChain<D> {
    const PARTS: usize = 4;

    #[inline(always)]
    fn flow(&self, part: usize, mut y: [f64; D], dt: f64, dw: [f64; 3]) -> [f64; D] {
        match part {
            0 => {
                let axis = [-self.field * dw[0], -self.field * dw[1], -self.field * dw[2]];
                for i in (0..D).step_by(3) {
                    turn(&mut y, i, axis);
                }
            }
            1 => {
                for i in (0..D).step_by(3) {
                    let axis = [0.0, 0.0, -self.anisotropy * dt * y[i + 2]];
                    turn(&mut y, i, axis);
                }
            }
            _ => {
                let weight = -self.exchange * dt;
                for i in (3 * (part - 2)..D).step_by(6) {
                    if i + 3 < D {
                        let axis = [0, 1, 2].map(|j| weight * (y[i + j] + y[i + 3 + j]));
                        turn(&mut y, i, axis);
                        turn(&mut y, i + 3, axis);
                    }
                }
            }
        }
        y
    }
}

/// Spin yᵢ, yᵢ₊₁, yᵢ₊₂ turned by Cayley's map.
#[inline(always)]
fn turn<const D: usize>(y: &mut [f64; D], i: usize, axis: [f64; 3]) {
    [y[i], y[i + 1], y[i + 2]] = cayley_cross([y[i], y[i + 1], y[i + 2]], axis);
}

impl<const D: usize> PoissonSystem<D, 3> for SpinChain<D> {
    fn name(&self) -> &'static str {
        "spin-chain"
    }

    fn parameters(&self) -> String {
        format!("J = {}, K = {}, σ = {}", self.exchange, self.anisotropy, self.field)
    }

    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut turned = y;
        for i in (0..D).step_by(3) {
            turned[i] = y[i + 1] * v[i + 2] - y[i + 2] * v[i + 1];
            turned[i + 1] = y[i + 2] * v[i] - y[i] * v[i + 2];
            turned[i + 2] = y[i] * v[i + 1] - y[i + 1] * v[i];
        }
        turned
    }

    #[inline(always)]
    fn cayley<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut turned = y;
        for i in (0..D).step_by(3) {
            let spin = [y[i], y[i + 1], y[i + 2]];
            let next = cayley_cross(spin, [v[i], v[i + 1], v[i + 2]]);
            (turned[i], turned[i + 1], turned[i + 2]) = (next[0], next[1], next[2]);
        }
        turned
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; 3]) -> R {
        let mut energy = R::zero();
        for i in (0..D).step_by(3) {
            energy = energy - y[i + 2] * y[i + 2] * (0.5 * self.anisotropy * dt);
            for j in 0..3 {
                energy = energy - y[i + j] * (self.field * dw[j]);
                if i + 3 < D {
                    energy = energy - y[i + j] * y[i + 3 + j] * (self.exchange * dt);
                }
            }
        }
        energy
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; 3]) -> [R; D] {
        let mut gradient = y;
        for i in (0..D).step_by(3) {
            for j in 0..3 {
                let mut neighbours = R::zero();
                if i + 3 < D {
                    neighbours = neighbours + y[i + 3 + j];
                }
                if i >= 3 {
                    neighbours = neighbours + y[i + j - 3];
                }
                gradient[i + j] = neighbours * (-self.exchange * dt) - self.field * dw[j];
            }
            gradient[i + 2] = gradient[i + 2] - y[i + 2] * (self.anisotropy * dt);
        }
        gradient
    }

    /// [fₘ, f_l] = B∇{H_l, Hₘ} with {H_l, Hₘ} = σ² Σᵢ sᵢ·(eₘ × e_l). So the areas rotate all spins
    /// about one axis.
    #[inline(always)]
    fn commutators<R: Real>(&self, y: [R; D], areas: [[f64; 3]; 3]) -> [R; D] {
        let axis =
            [areas[1][2], -areas[0][2], areas[0][1]].map(|area| self.field * self.field * area);
        let mut turned = y;
        for i in (0..D).step_by(3) {
            turned[i] = y[i + 1] * axis[2] - y[i + 2] * axis[1];
            turned[i + 1] = y[i + 2] * axis[0] - y[i] * axis[2];
            turned[i + 2] = y[i] * axis[1] - y[i + 1] * axis[0];
        }
        turned
    }

    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::quadratic_casimir("C", "½|sᵢ|²"); D / 3]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        if index >= D / 3 {
            no_invariant(self.name(), index);
        }
        let s = [y[3 * index], y[3 * index + 1], y[3 * index + 2]];
        (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) * 0.5
    }

    const IMPLICIT_STEP: ImplicitStep =
        if D <= 6 { ImplicitStep::UnrolledFixedPoint } else { ImplicitStep::FixedPoint };
}
