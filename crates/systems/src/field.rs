//! Vector fields that follow from a system: f = B∇h, and the Itô correction.

use dgrad::GradientField;
use real::{Real, ScalarFunction, VectorFunction, directional};

use crate::PoissonSystem;

/// h(y) = H₀(y)dt + Σ Hₘ(y)dwₘ as a function of y.
pub(crate) struct Energy<'a, S: ?Sized, const M: usize> {
    pub(crate) system: &'a S,
    pub(crate) dt: f64,
    pub(crate) dw: [f64; M],
}

impl<S: PoissonSystem<D, M> + ?Sized, const D: usize, const M: usize> ScalarFunction<D>
    for Energy<'_, S, M>
{
    #[inline(always)]
    fn value<R: Real>(&self, y: [R; D]) -> R {
        self.system.energy(y, self.dt, self.dw)
    }
}

/// The Hamiltonian increment h of one step as a gradient field, for quadratures of any order.
pub struct HamiltonianIncrement<'a, S: ?Sized, const M: usize> {
    /// The system whose Hamiltonians are weighed.
    pub system: &'a S,
    /// Weight of H₀.
    pub dt: f64,
    /// Weights of H₁ … H_M.
    pub dw: [f64; M],
}

impl<S: PoissonSystem<D, M> + ?Sized, const D: usize, const M: usize> GradientField<D>
    for HamiltonianIncrement<'_, S, M>
{
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D]) -> [R; D] {
        self.system.gradient(y, self.dt, self.dw)
    }
}

struct VectorField<'a, S: ?Sized, const M: usize> {
    system: &'a S,
    dt: f64,
    dw: [f64; M],
}

impl<S: PoissonSystem<D, M> + ?Sized, const D: usize, const M: usize> VectorFunction<D, D>
    for VectorField<'_, S, M>
{
    #[inline(always)]
    fn value<R: Real>(&self, y: [R; D]) -> [R; D] {
        vector_field(self.system, y, self.dt, self.dw)
    }
}

/// f(y) = B(y)∇h(y): f₀dt + Σ fₘdwₘ.
#[inline(always)]
pub fn vector_field<S: PoissonSystem<D, M> + ?Sized, R: Real, const D: usize, const M: usize>(
    system: &S,
    y: [R; D],
    dt: f64,
    dw: [f64; M],
) -> [R; D] {
    system.structure(y, system.gradient(y, dt, dw))
}

/// (B∇h)′(y)·v, the derivative of [`vector_field`] in the direction v; it includes the derivative
/// of B.
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
    directional(&VectorField { system, dt, dw }, y, v).1
}

/// The weights (0, eₘ) that pick fₘ out of [`vector_field`].
#[inline(always)]
#[must_use]
pub fn unit_noise<const M: usize>(m: usize) -> [f64; M] {
    let mut dw = [0.0; M];
    dw[m] = 1.0;
    dw
}

/// ½Σₘ fₘ′(y)fₘ(y), the drift that turns the Stratonovich equation into an Itô equation. The
/// derivative includes that of B; one evaluation on dual numbers for each noise.
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

/// Σ_{m<l} A_ml \[fₘ, f_l\](y) with [f, g] = g′f − f′g, for a skew matrix A: the field that a step
/// of strong order one adds for the Lévy areas A. As Σ_l f_l′gₗ with g_l = Σₘ A_ml fₘ: one
/// directional derivative for each noise.
#[inline(always)]
pub(crate) fn commutators<
    S: PoissonSystem<D, M> + ?Sized,
    R: Real,
    const D: usize,
    const M: usize,
>(
    system: &S,
    y: [R; D],
    areas: [[f64; M]; M],
) -> [R; D] {
    let mut sum = [R::zero(); D];
    if M < 2 {
        return sum;
    }
    for l in 0..M {
        let mut weights = [0.0; M];
        for m in 0..M {
            weights[m] = areas[m][l];
        }
        let direction = vector_field(system, y, 0.0, weights);
        let derivative = vector_field_derivative(system, y, 0.0, unit_noise(l), direction);
        for i in 0..D {
            sum[i] = sum[i] + derivative[i];
        }
    }
    sum
}

/// Relative steps from y at which [`noises_commute`] looks: three scales, both sides, irrational
/// ratios between components.
const PROBES: [f64; 5] = [0.0, 0.011, -0.013, 0.17, -0.19];

/// Whether the noise fields fₘ = B∇Hₘ commute around `y`: [fₘ, f_l] = 0 up to rounding, that is up
/// to 64 ε of the two terms of which it is the difference, at `y` and at four points near it that
/// are in the domain. Fields that are analytic and commute on an open set commute everywhere; that
/// they do so at a handful of points by accident has probability zero.
#[must_use]
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
        system.check_domain(point).is_err() || commute_at(system, point)
    })
}

fn commute_at<S: PoissonSystem<D, M> + ?Sized, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
) -> bool {
    let field = |m: usize| vector_field(system, y, 0.0, unit_noise(m));
    let along = |of: usize, direction: usize| {
        vector_field_derivative(system, y, 0.0, unit_noise(of), field(direction))
    };
    (0..M).all(|l| {
        (0..l).all(|m| {
            let (one, other) = (along(l, m), along(m, l));
            (0..D).all(|i| {
                (one[i] - other[i]).abs() <= 64.0 * f64::EPSILON * (one[i].abs() + other[i].abs())
            })
        })
    })
}
