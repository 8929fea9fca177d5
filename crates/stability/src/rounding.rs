//! What rounding can do to a conformal law: the bound that the cases are held to.
//!
//! Write d for the relative distance F(y_n)e^{pΓ}/F(y₀) − 1 of a quadratic Casimir F (p = 2), u =
//! ε/2 for the unit roundoff. A step of `sexp` adds at most, in units of u:
//!
//! - 12 by the damping: in each half the factor is off by 2u (half an ulp of each of two neighbours
//!   between which it is chosen, and the rounding of the exponential) and the product by u, twice
//!   that in the square;
//! - 2 by the rounding of the sum z = ẑ + change;
//! - 20 by the rounding of the change, of size |z − ẑ| ≤ 2|z|: five operations on each component,
//!   twice that in the square;
//! - 16 by the equation not being solved better than 2ε|z|: F(z) − F(ẑ) = (z − z_k)·B∇h is at most
//!   4u|z|·2|z| and F is ½|z|²;
//! - what the robust solver reports as residual r, which adds 2r/|z|.
//!
//! Together 50u = 25ε; [`PER_STEP`] is the power of two above it. Γ itself is known to a relative ε
//! in every step, and so is the exponent of the law that is compared with: [`PER_DAMPING`]·ε·Σ|∫γ|.
//! Evaluating F and the quotient at the end: [`AT_END`]·ε. All of these are worst cases, as if
//! every rounding of every step went the same way.

/// Units of ε that a step adds at most.
const PER_STEP: f64 = 32.0;
/// Units of ε for each unit of ∫|γ|: p = 2 times one for each step's integral and one for the law's
/// exponent.
const PER_DAMPING: f64 = 4.0;
/// Units of ε of evaluating the law and F.
const AT_END: f64 = 8.0;

/// The largest relative distance from the law of a quadratic Casimir after `steps` steps with ∫|γ|
/// = `damping`.
pub(crate) fn law_bound(steps: u64, damping: f64) -> f64 {
    f64::EPSILON * (PER_STEP * steps as f64 + PER_DAMPING * damping + AT_END)
}
