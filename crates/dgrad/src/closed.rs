//! Averaged discrete gradients in closed form.

use real::Real;

/// The midpoint (a + b)/2. For a quadratic H, ∇̄H(a, b) = ∇H((a + b)/2).
#[inline(always)]
pub fn midpoint<R: Real, const D: usize>(a: [R; D], b: [R; D]) -> [R; D] {
    let mut middle = [R::zero(); D];
    for i in 0..D {
        middle[i] = (a[i] + b[i]) * 0.5;
    }
    middle
}

/// ∫₀¹ cos((1−η)a + ηb) dη = cos((a+b)/2)·sinc((b−a)/2): ∇̄H of H = sin y.
///
/// The form (sin b − sin a)/(b − a) suffers from cancellation as b → a. This form does not.
#[inline(always)]
pub fn mean_cosine<R: Real>(a: R, b: R) -> R {
    ((a + b) * 0.5).cos() * ((b - a) * 0.5).sinc()
}

/// ∫₀¹ sin((1−η)a + ηb) dη = sin((a+b)/2)·sinc((b−a)/2): ∇̄H of H = −cos y.
#[inline(always)]
pub fn mean_sine<R: Real>(a: R, b: R) -> R {
    ((a + b) * 0.5).sin() * ((b - a) * 0.5).sinc()
}
