//! The damped stochastic free rigid body.

use real::Real;

use crate::{
    Flows, Form, ImplicitStep, Invariant, InvariantKind, PoissonSystem, SystemError,
    cayley::{cayley_cross, cross, turned_about},
    error::{finite, positive},
    system::no_invariant,
};

#[inline(always)]
fn half_square<R: Real>(y: [R; 3]) -> R {
    (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) * 0.5
}

const CASIMIR: Invariant = Invariant::quadratic_casimir("C", "½(y₁² + y₂² + y₃²)");

fn reciprocals<const N: usize>(
    mut inertia: [f64; N],
    symbol: &str,
) -> Result<[f64; N], SystemError> {
    for i in 0..N {
        inertia[i] = 1.0 / positive(&format!("{symbol}{}", i + 1), inertia[i])?;
    }
    Ok(inertia)
}

/// The free rigid body with M = 1 or 3 independent noises (Bréhier, Cohen and Komori 2025,
/// Example 2): B(y)v = y × v, H₀ = ½Σ yᵢ²/Iᵢ and Hₘ = ½yₘ²/Îₘ for m = 1 … M. The state y is the
/// angular momentum in the body frame.
///
/// Casimir: ½|y|², of degree 2, so the radius of the sphere of y is damped by e^{−∫γ}.
#[derive(Clone, Copy, Debug)]
pub struct RigidBody<const M: usize> {
    /// 1/Iᵢ.
    drift: [f64; 3],
    /// 1/Îₘ, zero where there is no noise.
    noise: [f64; M],
    /// The middle one of 1/Iᵢ.
    middle: f64,
}

impl RigidBody<3> {
    /// The body with moments of inertia I and three noises with moments Î.
    ///
    /// # Errors
    /// [`SystemError`] unless all moments are positive and finite.
    pub fn three_noises(inertia: [f64; 3], noise_inertia: [f64; 3]) -> Result<Self, SystemError> {
        Self::with_noises(inertia, noise_inertia)
    }
}

impl RigidBody<1> {
    /// The body with moments of inertia I and the single noise W₁ with moment Î₁.
    ///
    /// # Errors
    /// [`SystemError`] unless all moments are positive and finite.
    pub fn one_noise(inertia: [f64; 3], noise_inertia: f64) -> Result<Self, SystemError> {
        Self::with_noises(inertia, [noise_inertia])
    }
}

impl<const M: usize> RigidBody<M> {
    fn with_noises(inertia: [f64; 3], noise_inertia: [f64; M]) -> Result<Self, SystemError> {
        let drift = reciprocals(inertia, "I")?;
        let [a, b, c] = drift;
        let middle = a.min(b).max(a.max(b).min(c));
        Ok(Self { drift, noise: reciprocals(noise_inertia, "Î")?, middle })
    }

    /// kᵢ = dt/Iᵢ + dwᵢ/Îᵢ. The Hamiltonian increment is ½Σ kᵢyᵢ².
    #[inline(always)]
    fn coefficients<R: Real>(&self, dt: R, dw: [R; M]) -> [R; 3] {
        let mut k = [R::zero(); 3];
        for i in 0..3 {
            k[i] = dt * self.drift[i];
            if i < M {
                k[i] = k[i] + dw[i] * self.noise[i];
            }
        }
        k
    }
}

/// Parts ½yᵢ²((1/Iᵢ − k)dt + dwᵢ/Îᵢ): rotations about the axes. The Casimir ½k|y|²dt that they lack
/// moves nothing. With the middle one of 1/Iᵢ for k angles are least, and one part has no drift.
impl<const M: usize> Flows<3, M> for RigidBody<M> {
    const PARTS: usize = 3;

    const NOISE_PARTS: [Option<usize>; M] = {
        let mut parts = [None; M];
        let mut m = 0;
        while m < M {
            parts[m] = Some(m);
            m += 1;
        }
        parts
    };

    #[inline(always)]
    fn flow<R: Real>(&self, part: usize, y: [R; 3], dt: R, dw: [R; M]) -> [R; 3] {
        turned_about(part, y, self.coefficients(dt, dw)[part] - dt * self.middle, false)
    }

    #[inline(always)]
    fn precise_flow<R: Real>(&self, part: usize, y: [R; 3], dt: R, dw: [R; M]) -> [R; 3] {
        turned_about(part, y, self.coefficients(dt, dw)[part] - dt * self.middle, true)
    }

    #[inline(always)]
    fn drifts(&self, part: usize) -> bool {
        self.drift[part] != self.middle
    }
}

impl<const M: usize> PoissonSystem<3, M> for RigidBody<M> {
    fn name(&self) -> &'static str {
        "rigid-body"
    }

    fn parameters(&self) -> String {
        format!("1/I = {:?}, 1/Î = {:?}", self.drift, self.noise)
    }

    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        cross(y, v)
    }

    #[inline(always)]
    fn cayley<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        cayley_cross(y, v)
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; M]) -> R {
        let k = self.coefficients(dt, dw);
        (y[0] * y[0] * k[0] + y[1] * y[1] * k[1] + y[2] * y[2] * k[2]) * 0.5
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; M]) -> [R; 3] {
        let k = self.coefficients(dt, dw);
        [y[0] * k[0], y[1] * k[1], y[2] * k[2]]
    }

    /// With s = a + b and K = diag(k), the product (s/2) × K(s/2) has the first component
    /// ¼(k₃ − k₂)s₂s₃. It takes nine operations instead of eighteen.
    #[inline(always)]
    fn averaged_field<R: Real>(&self, a: [R; 3], b: [R; 3], dt: f64, dw: [f64; M]) -> [R; 3] {
        let k = self.coefficients(dt, dw);
        let s = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        [
            s[1] * s[2] * (0.25 * (k[2] - k[1])),
            s[2] * s[0] * (0.25 * (k[0] - k[2])),
            s[0] * s[1] * (0.25 * (k[1] - k[0])),
        ]
    }

    /// By Jacobi's identity [fₘ, f_l] = B∇{H_l, Hₘ}. Here {H_l, Hₘ} = ±y₁y₂y₃/(ÎₘÎ_l) with the sign
    /// of (eₘ × e_l)·y. So the sum is y × ∇(c y₁y₂y₃) with one number c.
    #[inline(always)]
    fn commutators<R: Real>(&self, y: [R; 3], areas: [[f64; M]; M]) -> [R; 3] {
        let mut c = 0.0;
        for m in 0..M {
            for l in m + 1..M {
                let weight = self.noise[m] * self.noise[l] * areas[m][l];
                c += if l == m + 1 { weight } else { -weight };
            }
        }
        // Multiply by c before the squares: a product of three large components could overflow
        // although c is small.
        let squares = [y[0] * y[0], y[1] * y[1], y[2] * y[2]];
        [
            y[0] * c * (squares[1] - squares[2]),
            y[1] * c * (squares[2] - squares[0]),
            y[2] * c * (squares[0] - squares[1]),
        ]
    }

    fn invariants(&self) -> Vec<Invariant> {
        vec![CASIMIR]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        match index {
            0 => half_square(y),
            _ => no_invariant(PoissonSystem::<3, M>::name(self), index),
        }
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::UnrolledFixedPoint;
}

/// The free rigid body with the single noise H₁ = cH₀ (Bréhier, Cohen and Komori 2025, Example 2):
/// B(y)v = y × v and H₀ = ½Σ yᵢ²/Iᵢ.
///
/// Casimir ½|y|² and energy H₀, both of degree 2.
#[derive(Clone, Copy, Debug)]
pub struct RigidBodyEnergy {
    /// The body without noise; its increment is H₀dt.
    body: RigidBody<0>,
    noise: f64,
}

impl RigidBodyEnergy {
    /// The body with moments of inertia I and noise of size c.
    ///
    /// # Errors
    /// [`SystemError`] unless all moments are positive and finite,
    /// [`SystemError`] unless c is finite.
    pub fn new(inertia: [f64; 3], c: f64) -> Result<Self, SystemError> {
        let body = RigidBody::with_noises(inertia, [])?;
        Ok(Self { body, noise: finite("the noise size c", c)? })
    }
}

impl Flows<3, 1> for RigidBodyEnergy {
    const PARTS: usize = 3;

    #[inline(always)]
    fn flow<R: Real>(&self, part: usize, y: [R; 3], dt: R, dw: [R; 1]) -> [R; 3] {
        self.body.flow(part, y, dt + dw[0] * self.noise, [])
    }

    #[inline(always)]
    fn precise_flow<R: Real>(&self, part: usize, y: [R; 3], dt: R, dw: [R; 1]) -> [R; 3] {
        self.body.precise_flow(part, y, dt + dw[0] * self.noise, [])
    }

    #[inline(always)]
    fn drifts(&self, part: usize) -> bool {
        self.body.drifts(part)
    }
}

impl PoissonSystem<3, 1> for RigidBodyEnergy {
    fn name(&self) -> &'static str {
        "rigid-body"
    }

    fn parameters(&self) -> String {
        format!("1/I = {:?}, c = {}", self.body.drift, self.noise)
    }

    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        cross(y, v)
    }

    #[inline(always)]
    fn cayley<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        cayley_cross(y, v)
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        self.body.energy(y, 1.0, []) * (dt + self.noise * dw[0])
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        self.body.gradient(y, dt + self.noise * dw[0], [])
    }

    fn invariants(&self) -> Vec<Invariant> {
        let energy = Invariant {
            name: "H",
            formula: "½(y₁²/I₁ + y₂²/I₂ + y₃²/I₃)",
            kind: InvariantKind::Energy,
            form: Form::Quadratic,
            degree: 2.0,
        };
        vec![CASIMIR, energy]
    }

    #[inline(always)]
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        match index {
            0 => half_square(y),
            1 => self.body.energy(y, 1.0, []),
            _ => no_invariant(self.name(), index),
        }
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::UnrolledFixedPoint;
}
