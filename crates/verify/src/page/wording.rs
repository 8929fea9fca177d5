//! What the report says about the paper beside the results.

use crate::results::Claim;

/// Title of the page.
pub const TITLE: &str = "Structure-preserving simulation of damped stochastic Poisson systems";

/// A line above the title.
pub const KICKER: &str = "Casimir · reproduction report";

/// Ids of schemes and what they stand for.
pub const SCHEMES: [(&str, &str); 7] = [
    ("sexp", "stochastic conformal exponential integrator, the method of the paper"),
    ("em", "Euler–Maruyama on the Itô form"),
    ("midpoint", "stochastic midpoint, damping included"),
    ("sexp-levy", "sexp with Lévy areas, not in the paper"),
    ("sexp-li", "sexp by a linear equation, not in the paper"),
    ("split", "exact flows in turn, not in the paper"),
    ("nv", "flows in turn, of weak order two, not in the paper"),
];

/// The statement that `claim` is a case of. Claims about what the paper does not prove speak for
/// themselves.
pub fn statement(claim: &Claim) -> &str {
    let found = STATEMENTS.iter().find(|(id, _)| claim.proven && *id == claim.id);
    found.map_or(&claim.statement, |(_, words)| words)
}

/// What the paper proves, by id.
const STATEMENTS: [(&str, &str); 11] = [
    (
        "strong-one",
        "With one noise sexp converges strongly with order 1: sup over n of (E‖y_n − y(t_n)‖²)^½ \
         ≤ C τ for k ≥ 2.",
    ),
    (
        "strong-half",
        "With several noises sexp converges strongly with order ½: sup over n of (E‖y_n − \
         y(t_n)‖²)^½ ≤ C τ^½ for k ≥ 1.",
    ),
    (
        "weak-one",
        "sexp converges weakly with order 1: |E φ(y_N) − E φ(y(T))| ≤ C τ for smooth test \
         functions φ and k ≥ 2.",
    ),
    (
        "conformal-casimir",
        "sexp keeps the conformal law C(y_n) = exp(−p ∫γ) C(y₀) of quadratic and linear Casimirs \
         C at every step, for any τ.",
    ),
    (
        "energy-balance",
        "With one noise sexp keeps the conformal law H(y_n) = exp(−p ∫γ) H(y₀) of a homogeneous \
         energy H at every step, for any τ.",
    ),
    (
        "truncation-moments",
        "Truncated increments ΔŴ stay close to ΔW: 0 ≤ E[ΔW²] − E[ΔŴ²] ≤ (1 + A) τ^(k+1), and \
         ‖ΔW − ΔŴ‖ in L^p ≤ C τ^((1+k)/2).",
    ),
    (
        "solvability",
        "The step has a unique solution once the contraction constant C(k, τ) is below 1.",
    ),
    (
        "exact-conformal",
        "The exact flow obeys the conformal law of homogeneous Casimirs and energies.",
    ),
    (
        "moment-bound",
        "The numerical solution is bounded almost surely: ‖y_n‖ ≤ (F(y₀)/m(F))^(1/p) exp ∫|γ| \
         for F = C or H with m(F) > 0.",
    ),
    (
        "local-exact",
        "A step of the exact flow has a remainder R with (E‖R‖²)^½ ≤ C τ^(3/2), ‖E R‖ ≤ C τ².",
    ),
    (
        "local-sexp",
        "One step of sexp has a Taylor remainder R with (E‖R‖²)^½ ≤ C τ^(3/2) and ‖E R‖ ≤ C τ².",
    ),
];
