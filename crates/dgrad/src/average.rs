//! ∇̄H by Gauss–Legendre on the gradient.

use real::Real;

use crate::legendre::{QuadratureError, Rule, fixed_rule};

/// A gradient ∇H, written for every [`Real`].
pub trait GradientField<const D: usize> {
    /// ∇H(y).
    fn gradient<R: Real>(&self, y: [R; D]) -> [R; D];
}

/// The rule with N nodes as a constant of the code that uses it.
struct Fixed<const N: usize>;

impl<const N: usize> Fixed<N> {
    const RULE: ([f64; N], [f64; N]) = fixed_rule::<N>();
}

/// ∇̄H(a, b) ≈ Σ wᵢ ∇H(a + ηᵢ(b − a)) with N nodes: exact to round-off when ∇H is a polynomial of degree ≤ 2N − 1,
/// else an error of order |b − a|^{2N}. N is a constant so that the loop unrolls inside a block kernel.
#[inline(always)]
pub fn averaged<const N: usize, R: Real, F: GradientField<D>, const D: usize>(
    field: &F,
    a: [R; D],
    b: [R; D],
) -> [R; D] {
    let (nodes, weights) = Fixed::<N>::RULE;
    let mut mean = [R::zero(); D];
    for k in 0..N {
        let gradient = field.gradient(between(a, b, nodes[k]));
        for i in 0..D {
            mean[i] = mean[i] + gradient[i] * weights[k];
        }
    }
    mean
}

/// a + η(b − a).
#[inline(always)]
fn between<R: Real, const D: usize>(a: [R; D], b: [R; D], eta: f64) -> [R; D] {
    let mut y = a;
    for i in 0..D {
        y[i] = a[i] + (b[i] - a[i]) * eta;
    }
    y
}

/// ∇̄H(a, b) with n nodes and an estimate of its error, ‖∇̄ₙH − ∇̄₂ₙ₊₁H‖∞.
///
/// For a smooth H the finer rule is far more accurate, so the estimate is the error of the coarser one; the finer
/// value is returned.
///
/// # Errors
/// [`QuadratureError::Nodes`] unless n and 2n + 1 are sizes of a rule.
pub fn averaged_with_error<F: GradientField<D>, const D: usize>(
    field: &F,
    a: [f64; D],
    b: [f64; D],
    n: usize,
) -> Result<([f64; D], f64), QuadratureError> {
    let coarse = averaged_by(field, a, b, &Rule::new(n)?);
    let fine = averaged_by(field, a, b, &Rule::new(2 * n + 1)?);
    let mut error = 0.0;
    for i in 0..D {
        error = f64::max(error, (coarse[i] - fine[i]).abs());
    }
    Ok((fine, error))
}

fn averaged_by<F: GradientField<D>, const D: usize>(field: &F, a: [f64; D], b: [f64; D], rule: &Rule) -> [f64; D] {
    let mut mean = [0.0; D];
    for (&eta, &weight) in rule.nodes().iter().zip(rule.weights()) {
        let gradient = field.gradient(between(a, b, eta));
        for i in 0..D {
            mean[i] += gradient[i] * weight;
        }
    }
    mean
}
