//! The statements of the paper in words, for a group of claims that each name a case.

use verify::results::Claim;

/// What the paper proves, by id.
const PROVEN: [(&str, &str); 11] = [
    (
        "strong-one",
        "With one noise sexp converges strongly with order 1: sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ C τ for k ≥ 2.",
    ),
    (
        "strong-half",
        "With several noises sexp converges strongly with order ½: sup over n of (E‖y_n − y(t_n)‖²)^½ ≤ C τ^½ for k ≥ 1.",
    ),
    (
        "weak-one",
        "sexp converges weakly with order 1: |E φ(y_N) − E φ(y(T))| ≤ C τ for smooth test functions φ and k ≥ 2.",
    ),
    (
        "conformal-casimir",
        "sexp keeps the conformal law C(y_n) = exp(−p ∫γ) C(y₀) of quadratic and linear Casimirs C at every step, for any τ.",
    ),
    (
        "energy-balance",
        "With one noise sexp keeps the conformal law H(y_n) = exp(−p ∫γ) H(y₀) of a homogeneous energy H at every step, for any τ.",
    ),
    (
        "truncation-moments",
        "Truncated increments ΔŴ stay close to ΔW: 0 ≤ E[ΔW²] − E[ΔŴ²] ≤ (1 + A) τ^(k+1), and ‖ΔW − ΔŴ‖ in L^p ≤ C τ^((1+k)/2).",
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
        "The numerical solution is bounded almost surely: ‖y_n‖ ≤ (F(y₀)/m(F))^(1/p) exp ∫|γ| for F = C or H with m(F) > 0.",
    ),
    (
        "local-exact",
        "One step of the exact flow has a Taylor remainder R with (E‖R‖²)^½ ≤ C τ^(3/2) and ‖E R‖ ≤ C τ².",
    ),
    (
        "local-sexp",
        "One step of sexp has a Taylor remainder R with (E‖R‖²)^½ ≤ C τ^(3/2) and ‖E R‖ ≤ C τ².",
    ),
];

/// What the paper reports without a proof, by id and scheme.
const REPORTED: [(&str, &str, &str); 9] = [
    ("strong-one", "em", "Euler–Maruyama has strong order ½, with one noise as well."),
    ("strong-one", "midpoint", "With one noise midpoint has the strong order of sexp, 1."),
    (
        "strong-one",
        "sexp",
        "sexp has strong order 1 with one noise even where the theorems do not apply.",
    ),
    ("strong-half", "em", "Euler–Maruyama has strong order ½ with several noises."),
    ("strong-half", "midpoint", "With several noises midpoint has the strong order of sexp, ½."),
    (
        "conformal-casimir",
        "em",
        "The Casimir visibly leaves its conformal law along a path of Euler–Maruyama.",
    ),
    (
        "conformal-casimir",
        "midpoint",
        "The Casimir is close to its conformal law, but not on it, along a path of midpoint.",
    ),
    (
        "energy-balance",
        "em",
        "The energy visibly leaves its conformal law along a path of Euler–Maruyama.",
    ),
    (
        "energy-balance",
        "midpoint",
        "The energy is close to its conformal law, but not on it, along a path of midpoint.",
    ),
];

/// The statement that `claim` is a case of, or else what it says itself.
pub fn statement(claim: &Claim) -> &str {
    let words = if claim.proven {
        PROVEN.iter().find(|(id, _)| *id == claim.id).map(|(_, words)| *words)
    } else {
        REPORTED
            .iter()
            .find(|(id, scheme, _)| *id == claim.id && *scheme == claim.scheme)
            .map(|(_, _, words)| *words)
    };
    words.unwrap_or(&claim.statement)
}

#[cfg(test)]
mod tests {
    use verify::results::Verdict;

    use super::super::group::tests::claim;
    use super::*;

    #[test]
    fn an_unknown_statement_speaks_for_itself() {
        assert!(
            statement(&claim("strong-one", "sexp", true, Verdict::Holds, ""))
                .starts_with("With one noise sexp")
        );
        assert!(
            statement(&claim("strong-one", "em", false, Verdict::Holds, ""))
                .starts_with("Euler–Maruyama")
        );
        assert_eq!(
            statement(&claim("strong-one", "other", false, Verdict::Holds, "")),
            "other has strong-one"
        );
        assert_eq!(statement(&claim("new", "sexp", true, Verdict::Holds, "")), "sexp has new");
    }
}
