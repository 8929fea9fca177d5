//! Everything that is found out about a system, as data.

use serde::Serialize;

use super::{
    Bound, Casimirs, ClaimedInvariant, Fields, Finding, Hamiltonians, Noises, ProblemFindings,
    Region, Status, Structure,
};

/// The report on a system: its properties, what theory says of it, and its mistakes.
///
/// It prints as text and serializes as data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// Name of the system.
    pub system: String,
    /// Dimension D of the state.
    pub dimension: usize,
    /// Number M of noises.
    pub noises: usize,
    /// Whether the system is [of Langevin's kind](systems::run_time::Description::is_langevin).
    pub is_langevin: bool,
    /// Whether flows of its parts are known at run time.
    pub has_flows: bool,
    /// Whether Hamiltonians depend on time.
    pub depends_on_time: bool,
    /// The region of the points at which identities were checked.
    pub region: Region,
    /// Number of points at which identities were checked, with those around the initial value.
    pub points: usize,
    /// Whether the system is defined at every point that was tried.
    pub defined_everywhere: bool,
    /// Findings on the structure matrix B(y).
    pub structure: Structure,
    /// Findings on the Hamiltonians H₀, …, H_M.
    pub hamiltonians: Hamiltonians,
    /// Findings on the fields of an equation without B and H, of which structure and Hamiltonians
    /// say nothing; `None` of other systems.
    pub fields: Option<Fields>,
    /// Findings on the noise fields.
    pub noise: Noises,
    /// The invariants that the system claims.
    pub invariants: Vec<ClaimedInvariant>,
    /// The Casimirs of B, or the functions that all [fields](Self::fields) keep; `None` where rows
    /// belong to one path of very many components.
    pub casimirs: Option<Casimirs>,
    /// A function that bounds all paths, if one was found.
    pub bound: Option<Bound>,
    /// Findings on damping and initial value; `None` for a system alone.
    pub problem: Option<ProblemFindings>,
    /// Statements of the paper, and whether each applies.
    pub theorems: Vec<Theorem>,
    /// The orders that theory predicts for the schemes.
    pub orders: Vec<ExpectedOrder>,
    /// Recommended schemes, the scheme for paths first.
    pub recommended: Vec<Recommendation>,
    /// Mistakes in words: properties that a system must have or claims, found to be wrong; empty
    /// for a sound system.
    pub mistakes: Vec<String>,
    /// Properties that a system must have and that are undecided, in words with the reason.
    pub undecided: Vec<String>,
}

impl Inspection {
    /// Fills in the lists of mistakes and of undecided properties.
    pub(super) fn with_mistakes(mut self) -> Self {
        let structure = [
            ("structure(y, v) is not linear in v", &self.structure.linear),
            ("B(y) is not skew-symmetric", &self.structure.skew),
        ];
        let methods = self.hamiltonians.methods.iter().map(|(what, found)| (*what, found));
        let words = |(what, found): (&str, &Finding)| (found.status, format!("{what}: {found}"));
        let mut checks: Vec<_> = structure.into_iter().chain(methods).map(words).collect();
        if let Some(ProblemFindings { integral, .. }) = &self.problem {
            let what = "the integral of the damping is not the integral of its rate";
            checks.push((integral.agrees, format!("{what}: {integral}")));
        }
        for claim in &self.invariants {
            checks.extend(claim.mistakes.iter().map(|what| (Status::Fails, what.clone())));
            if claim.status() == Status::Unknown {
                checks.push((Status::Unknown, format!("the claim on {} is true", claim.name)));
            }
        }
        for (status, words) in checks {
            match status {
                Status::Fails => self.mistakes.push(words),
                Status::Unknown => self.undecided.push(format!("whether {words}")),
                Status::Holds => {}
            }
        }
        self
    }

    /// Whether a claim on a Casimir is true.
    pub(super) fn has_claimed_casimir(&self) -> bool {
        self.invariants.iter().any(|claim| claim.claimed_casimir && claim.status().holds())
    }

    /// Orders (strong, weak) that theory predicts for a scheme, by its identifier.
    pub fn order(&self, scheme: &str) -> Option<(f64, f64)> {
        let order = self.orders.iter().find(|order| order.scheme == scheme)?;
        Some((order.strong, order.weak))
    }
}

/// Whether a statement of the paper applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Applies {
    /// Applies: the assumptions hold at every point that was checked.
    Yes,
    /// Applies under a condition that points cannot decide: paths or steps stay in a ball or in
    /// the domain, or round-off hides a defect.
    Conditionally,
    /// Does not apply.
    No,
}

/// Statement of the paper, and whether it applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Theorem {
    /// Identifier of the statement, as in `STATEMENTS`.
    pub statement: &'static str,
    /// Whether the statement applies.
    pub applies: Applies,
}

/// The orders that theory predicts for a scheme while paths stay bounded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ExpectedOrder {
    /// The identifier of the scheme.
    pub scheme: &'static str,
    /// Strong order; a lower bound if `known` is `Unknown`.
    pub strong: f64,
    /// Weak order.
    pub weak: f64,
    /// `Unknown` if the strong order may be higher.
    pub known: Status,
}

/// Recommendation of a scheme for a purpose.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recommendation {
    /// Purpose: `paths` or `expectations`.
    pub purpose: &'static str,
    /// Identifier of the scheme.
    pub scheme: &'static str,
    /// Reason for the recommendation, in words.
    pub because: String,
}
