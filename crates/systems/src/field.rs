//! Vector fields of a system: f = B∇h, its derivatives, the Itô correction and commutators.

use dgrad::GradientField;
use real::{Real, ScalarFunction, VectorFunction, directional};

use crate::PoissonSystem;

/// The Hamiltonian increment h(y) = H₀(y)dt + Σ Hₘ(y)dwₘ of a system. As a [`ScalarFunction`] it is
/// h(y), as a [`GradientField`] ∇h(y), and as a [`VectorFunction`] the [`vector_field`] B(y)∇h(y).
pub struct HamiltonianIncrement<'a, S: ?Sized, const M: usize> {
    /// The system.
    pub system: &'a S,
    /// The weight of H₀.
    pub dt: f64,
    /// The weights of H₁ … H_M.
    pub dw: [f64; M],
}

impl<S: PoissonSystem<D, M> + ?Sized, const D: usize, const M: usize> ScalarFunction<D>
    for HamiltonianIncrement<'_, S, M>
{
    #[inline(always)]
    fn value<R: Real>(&self, y: [R; D]) -> R {
        self.system.energy(y, self.dt, self.dw)
    }
}

impl<S: PoissonSystem<D, M> + ?Sized, const D: usize, const M: usize> GradientField<D>
    for HamiltonianIncrement<'_, S, M>
{
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D]) -> [R; D] {
        self.system.gradient(y, self.dt, self.dw)
    }
}

impl<S: PoissonSystem<D, M> + ?Sized, const D: usize, const M: usize> VectorFunction<D, D>
    for HamiltonianIncrement<'_, S, M>
{
    #[inline(always)]
    fn value<R: Real>(&self, y: [R; D]) -> [R; D] {
        vector_field(self.system, y, self.dt, self.dw)
    }
}

/// The vector field B(y)∇h(y) = f₀(y)dt + Σ fₘ(y)dwₘ with fₘ = B∇Hₘ.
#[inline(always)]
pub fn vector_field<S: PoissonSystem<D, M> + ?Sized, R: Real, const D: usize, const M: usize>(
    system: &S,
    y: [R; D],
    dt: f64,
    dw: [f64; M],
) -> [R; D] {
    system.structure(y, system.gradient(y, dt, dw))
}

/// (B∇h)′(y)·v, the derivative of [`vector_field`] in the direction v, including that of B.
#[inline(always)]
pub fn vector_field_derivative<
    S: PoissonSystem<D, M> + ?Sized,
    R: Real,
    const D: usize,
    const M: usize,
>(
    system: &S,
    y: [R; D],
    dt: f64,
    dw: [f64; M],
    v: [R; D],
) -> [R; D] {
    directional(&HamiltonianIncrement { system, dt, dw }, y, v).1
}

/// The unit vector eₘ, m < M: with dt = 0 and dw = eₘ, [`vector_field`] is fₘ.
#[inline(always)]
pub fn unit_noise<const M: usize>(m: usize) -> [f64; M] {
    let mut dw = [0.0; M];
    dw[m] = 1.0;
    dw
}

/// ½Σₘ fₘ′(y)fₘ(y), the drift that converts the Stratonovich equation to the Itô equation. The
/// derivative includes that of B. It takes one evaluation on dual numbers per noise.
#[inline(always)]
pub fn ito_correction<S: PoissonSystem<D, M> + ?Sized, R: Real, const D: usize, const M: usize>(
    system: &S,
    y: [R; D],
) -> [R; D] {
    let mut correction = [R::zero(); D];
    for m in 0..M {
        let direction = vector_field(system, y, 0.0, unit_noise(m));
        let derivative = vector_field_derivative(system, y, 0.0, unit_noise(m), direction);
        for i in 0..D {
            correction[i] = correction[i] + derivative[i] * 0.5;
        }
    }
    correction
}

/// Relative distances from y of the points that [`noises_commute`] tests.
const PROBES: [f64; 5] = [0.0, 0.011, -0.013, 0.17, -0.19];

/// Whether the noise fields fₘ = B∇Hₘ commute around `y`.
///
/// The test is |[fₘ, f_l]| ≤ 64 ε (|f_l′fₘ| + |fₘ′f_l|) in every component, at `y` and at those of
/// four points near it that are in the domain. Analytic fields that commute on an open set commute
/// everywhere. Fields that do not commute pass at these points with probability zero.
pub fn noises_commute<S: PoissonSystem<D, M> + ?Sized, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
) -> bool {
    PROBES.iter().all(|&distance| {
        let mut point = y;
        for i in 0..D {
            // Multiples of the golden ratio, modulo one, differ in every component.
            let direction = 2.0 * ((i + 1) as f64 * 0.618_033_988_749_894_8).fract() - 1.0;
            point[i] += distance * direction * f64::max(1.0, y[i].abs());
        }
        // f_l′fₘ.
        let along = |l: usize, m: usize| {
            let direction = vector_field(system, point, 0.0, unit_noise(m));
            vector_field_derivative(system, point, 0.0, unit_noise(l), direction)
        };
        let commute = |l: usize, m: usize| {
            let (one, other) = (along(l, m), along(m, l));
            (0..D).all(|i| {
                (one[i] - other[i]).abs() <= 64.0 * f64::EPSILON * (one[i].abs() + other[i].abs())
            })
        };
        system.check_domain(point).is_err() || (0..M).all(|l| (0..l).all(|m| commute(l, m)))
    })
}
