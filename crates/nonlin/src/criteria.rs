//! When an iteration has converged: the same numbers for few unknowns and for many.

/// A path has converged when the estimate of ‖z − ψ(z)‖₁ is below this fraction of ‖z‖₁. Evaluating
/// ψ rounds each component of z by up to half an ulp, so smaller residuals carry no information.
pub const TOLERANCE: f64 = 2.0 * f64::EPSILON;

/// [`excess`] multiplies two changes. For unknowns of size r their product can be as small as
/// (εr)². This power of two prevents an underflow to zero, which would count as convergence, for r
/// down to 10⁻¹⁵⁵. For r above 10¹⁴⁵ the product may overflow, which counts as not converged.
pub const GUARD: f64 = (1u128 << 64) as f64;

/// Largest number of Newton iterations at one s of the homotopy. After a contraction by
/// [`CONTRACTION`] and then quadratic convergence, ten reach round-off. Twenty allow for slow
/// initial convergence.
pub const MAX_ITERATIONS: u32 = 20;

/// The largest ratio of successive changes of Newton's method.
pub const CONTRACTION: f64 = 0.5;

/// The smallest step in s. The first accepted step is about 0.5/‖ψ′‖ for few unknowns, so ‖ψ′‖ may
/// be up to 8000.
pub const MIN_STEP: f64 = 1.0 / 16384.0;

/// Changes that stagnate below √ε times the size of the unknowns are round-off. This is the
/// attainable accuracy at a double root, where I − sψ′ is singular. Near a regular root Newton's
/// method would converge from there.
pub const ROUND_OFF: f64 = 1.0 / (1u64 << 26) as f64;

/// The convergence test of fixed-point iteration: the excess of the residual over the tolerance, at
/// most zero if the iteration has converged, NaN if a number is not finite.
///
/// The last two changes c, c′ give the contraction c′/c and with it the next change c′²/c, which is
/// the residual. It must be below the tolerance. `size` is ‖z‖₁.
#[inline(always)]
#[must_use]
pub fn excess(change: f64, change_before: f64, size: f64) -> f64 {
    // A change c larger than z itself is an excursion and does not measure the contraction.
    let before = if change_before < size { change_before } else { size };
    let allowed = size * (GUARD * TOLERANCE);
    change * GUARD * change - allowed * before
}
