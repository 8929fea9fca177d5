//! What a verdict means to a reader.

use verify::results::{Claim, Verdict};

/// A verdict, with refutations that a documented misprint explains set apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The measurement supports the statement.
    Holds,
    /// The measurement contradicts the statement as printed, and a misprint is documented.
    Misprint,
    /// The measurement cannot decide.
    Undecided,
    /// The measurement contradicts the statement.
    Refuted,
}

impl Outcome {
    /// The outcome of one claim.
    #[must_use]
    pub fn of(claim: &Claim) -> Self {
        match claim.verdict {
            Verdict::Holds => Self::Holds,
            Verdict::Undecided => Self::Undecided,
            Verdict::Refuted if claim.erratum.is_empty() => Self::Refuted,
            Verdict::Refuted => Self::Misprint,
        }
    }

    /// The outcome as a predicate.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Misprint => "refuted: misprint in the statement",
            Self::Undecided => "undecided",
            Self::Refuted => "refuted",
        }
    }
}
