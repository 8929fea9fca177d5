//! ∇̄H by Gauss–Legendre on the gradient.

use real::Real;

use crate::legendre::{QuadratureError, Rule, fixed_rule};

/// A gradient ∇H, written for every [`Real`].
pub trait GradientField<const D: usize> {
    /// ∇H(y).
    fn gradient<R: Real>(&self, y: [R; D]) -> [R; D];
}

/// ∇̄H(a, b) ≈ Σ wᵢ ∇H(a + ηᵢ(b − a)) with N nodes: exact to round-off when ∇H is a polynomial of
/// degree ≤ 2N − 1, else an error of order |b − a|^{2N}. N is a constant, so that the sum is
/// written out inside a block kernel; a kernel with more than 9 nodes is not vectorised.
///
/// The nodes lie symmetrically about the middle, and two gradients share a weight.
#[inline(always)]
pub fn averaged<const N: usize, R: Real, F: GradientField<D>, const D: usize>(
    field: &F,
    a: [R; D],
    b: [R; D],
) -> [R; D] {
    let (mut middle, mut difference) = (a, a);
    for i in 0..D {
        middle[i] = (a[i] + b[i]) * 0.5;
        difference[i] = b[i] - a[i];
    }
    let nodes = Nodes::<F, R, N, D> { field, middle, difference };
    let mut mean = nodes.first();
    // Written out up to 9 nodes: a loop of long bodies inside the loop over paths is unrolled too
    // late for that one to be vectorised. With more nodes it is a loop, which is slow and quick to
    // compile.
    if (4..10).contains(&N) {
        mean = nodes.add_pair(mean, 1);
    }
    if (6..10).contains(&N) {
        mean = nodes.add_pair(mean, 2);
    }
    if (8..10).contains(&N) {
        mean = nodes.add_pair(mean, 3);
    }
    if N > 9 {
        for k in 1..N / 2 {
            mean = nodes.add_pair(mean, k);
        }
    }
    if N > 1 && N % 2 == 1 { nodes.add_middle(mean) } else { mean }
}

/// A field along the way from a to b, at the nodes of the rule with N of them.
struct Nodes<'a, F, R, const N: usize, const D: usize> {
    field: &'a F,
    middle: [R; D],
    difference: [R; D],
}

impl<F: GradientField<D>, R: Real, const N: usize, const D: usize> Nodes<'_, F, R, N, D> {
    const RULE: ([f64; N], [f64; N]) = fixed_rule::<N>();

    /// The first pair, or the middle if there is no other node.
    #[inline(always)]
    fn first(&self) -> [R; D] {
        if N == 1 {
            return self.field.gradient(self.middle);
        }
        let mut mean = self.pair(0);
        for i in 0..D {
            mean[i] = mean[i] * Self::RULE.1[0];
        }
        mean
    }

    #[inline(always)]
    fn add_pair(&self, mean: [R; D], k: usize) -> [R; D] {
        plus(mean, self.pair(k), Self::RULE.1[k])
    }

    #[inline(always)]
    fn add_middle(&self, mean: [R; D]) -> [R; D] {
        plus(mean, self.field.gradient(self.middle), Self::RULE.1[N / 2])
    }

    /// The sum of the gradients at node k and its mirror image.
    #[inline(always)]
    fn pair(&self, k: usize) -> [R; D] {
        let distance = 0.5 - Self::RULE.0[k];
        let (mut lower, mut upper) = (self.middle, self.middle);
        for i in 0..D {
            let step = self.difference[i] * distance;
            lower[i] = lower[i] - step;
            upper[i] = upper[i] + step;
        }
        let (lower, upper) = (self.field.gradient(lower), self.field.gradient(upper));
        let mut sum = lower;
        for i in 0..D {
            sum[i] = lower[i] + upper[i];
        }
        sum
    }
}

/// mean + gradient·weight.
#[inline(always)]
fn plus<R: Real, const D: usize>(mut mean: [R; D], gradient: [R; D], weight: f64) -> [R; D] {
    for i in 0..D {
        mean[i] = mean[i] + gradient[i] * weight;
    }
    mean
}

/// ∇̄H(a, b) with n nodes and an estimate of its error, ‖∇̄ₙH − ∇̄₂ₙ₊₁H‖∞.
///
/// For a smooth H the finer rule is far more accurate, so the estimate is the error of the coarser
/// one; the finer value is returned.
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

fn averaged_by<F: GradientField<D>, const D: usize>(
    field: &F,
    a: [f64; D],
    b: [f64; D],
    rule: &Rule,
) -> [f64; D] {
    let mut mean = [0.0; D];
    for (&eta, &weight) in rule.nodes().iter().zip(rule.weights()) {
        let mut y = a;
        for i in 0..D {
            y[i] += (b[i] - a[i]) * eta;
        }
        mean = plus(mean, field.gradient(y), weight);
    }
    mean
}
