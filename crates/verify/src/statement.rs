//! Statements that are measured on their own and not on a panel.

use crate::results::{Claim, Verdict};

/// A statement with its measurement, a function `F` that yields its claims.
pub struct Statement<F> {
    /// Identifier, as in the claims it makes.
    pub id: &'static str,
    /// Measures it.
    pub measure: F,
}

/// A claim about a wrong method, with its measurement, a function `F` that yields the claim.
pub struct Twin<F> {
    /// The statement it is a twin of.
    pub claim: &'static str,
    /// The mistake.
    pub mistake: &'static str,
    /// Measures; the verdict must be *refuted*.
    pub measure: F,
}

/// A claim about no panel and no scheme; the fields that matter are given, the others can be
/// replaced.
pub fn claim(id: &str, statement: &str, verdict: Verdict, evidence: String) -> Claim {
    Claim {
        id: id.to_owned(),
        panel: String::new(),
        scheme: String::new(),
        statement: statement.to_owned(),
        verdict,
        evidence,
        proven: true,
        erratum: String::new(),
    }
}

/// Standard errors beyond which a measured mean contradicts its known value: the two-sided normal
/// quantile of a false alarm once in 1e5 runs.
pub const DEVIATIONS: f64 = 4.42;

/// The larger of two measurements, NaN if either is: a NaN must not be lost on the way to a
/// verdict.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Holds or refuted, for measurements that have no statistical error. A comparison with NaN is
/// false, hence refuted.
pub fn decide(holds: bool) -> Verdict {
    if holds { Verdict::Holds } else { Verdict::Refuted }
}
