//! What rounding can do to a conformal law: the bound that hard cases are held to.
//!
//! Write d for the relative distance F(y_n)e^{pΓ}/F(y₀) − 1 of a quadratic Casimir F (p = 2), and u
//! = ε/2 for the unit roundoff. A step of `sexp` adds at most, in units of u:
//!
//! - 12 by the damping: in each half the factor is off by 2u (half an ulp of each of the two
//!   neighbours between which it is chosen, and the rounding of the exponential) and the product by
//!   u, twice that in the square;
//! - 2 by the rounding of the sum z = ẑ + change;
//! - 20 by the rounding of the change, of size |z − ẑ| ≤ 2|z|: five operations on each component,
//!   twice that in the square;
//! - 16 by the tolerance 2ε|z| of the solver: F(z) − F(ẑ) = (z − z_k)·B∇h is at most 4u|z|·2|z|,
//!   and F is ½|z|².
//!
//! Together 50u = 25ε; `PER_STEP` is the power of two above it. Γ itself is known to a relative ε
//! in every step, and so is the exponent of the law that is compared with: `PER_DAMPING`·ε·Σ|∫γ|.
//! Evaluating F and the quotient at the end: `AT_END`·ε. All of these are worst cases, as if
//! every rounding of every step went the same way.
//!
//! A rotation by Cayley's map, z = y + f·w with w = y × s + (y × s) × s and f = 2/(1 + |s|²), adds
//! at most 55u whatever s is: 20 by f, which is off by 5u, since |z|² changes by 2z·w δf and z·w f
//! ≤ 2|y|²; twice 17½ by w and the sum, since |s|f ≤ 1 and |s|²f ≤ 2. With the damping a step of
//! `sexp-li` adds 67u, [`LINEARLY_IMPLICIT`] times `PER_STEP`. About an axis it is 26u, also with
//! the tangent that `nv` takes for s: see [`rotations`].
//!
//! A step that the robust solver takes adds its residual: see [`residual_share`].

/// Units of ε that a step adds at most.
pub const PER_STEP: f64 = 32.0;
/// What a step of `sexp-li` adds at most, in units of `PER_STEP`: 34ε.
pub const LINEARLY_IMPLICIT: f64 = 2.0;
/// The same for a step of so many rotations about axes, as those of `split` and `nv`: (13n + 6)ε.
pub const fn rotations(number: usize) -> f64 {
    (13 * number + 6) as f64 / PER_STEP
}
/// Units of ε for each unit of ∫|γ|: p = 2 times one for each step's integral and one for the law's
/// exponent.
const PER_DAMPING: f64 = 4.0;
/// Units of ε of evaluating the law and F.
const AT_END: f64 = 8.0;

/// The largest relative distance from the law of a quadratic Casimir after `steps` steps with ∫|γ|
/// = `damping`.
pub fn law_bound(steps: u64, damping: f64) -> f64 {
    f64::EPSILON * (PER_STEP * steps as f64 + PER_DAMPING * damping + AT_END)
}

/// What a residual ‖z − ψ(z)‖₁ adds at most: F(z) − F(ẑ) = (z + ẑ)·(z − ψ(z))/2, at most |z| times
/// the residual, and F = ½|z|².
pub fn residual_share(residual: f64, z: &[f64]) -> f64 {
    if residual == 0.0 { 0.0 } else { 2.0 * residual / length(z) }
}

/// |y|, without overflow or underflow of the squares.
pub fn length(y: &[f64]) -> f64 {
    y.iter().fold(0.0, |sum, y| f64::hypot(sum, *y))
}
