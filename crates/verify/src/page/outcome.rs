//! What a verdict means to a reader.

use crate::results::{Claim, Verdict};

/// A verdict, with refutations that a documented misprint explains set apart.
///
/// The least of the outcomes of several claims is that of all together, so that a misprint counts
/// only where nothing else is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// The measurement contradicts the statement.
    Refuted,
    /// The measurement cannot decide.
    Undecided,
    /// The measurement supports the statement.
    Holds,
    /// The measurement contradicts the statement as printed, and a misprint is documented.
    Misprint,
}

impl Outcome {
    /// All outcomes in their order.
    pub const ALL: [Self; 4] = [Self::Refuted, Self::Undecided, Self::Holds, Self::Misprint];

    /// All but [`Holds`](Self::Holds).
    pub(crate) const BLEMISHES: [Self; 3] = [Self::Refuted, Self::Undecided, Self::Misprint];

    /// The outcome of one claim.
    pub fn of(claim: &Claim) -> Self {
        match claim.verdict {
            Verdict::Holds => Self::Holds,
            Verdict::Undecided => Self::Undecided,
            Verdict::Refuted if claim.erratum.is_empty() => Self::Refuted,
            Verdict::Refuted => Self::Misprint,
        }
    }

    /// The outcome in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Misprint => "misprint",
            Self::Undecided => "undecided",
            Self::Refuted => "refuted",
        }
    }

    /// The outcome as a predicate.
    pub fn words(self) -> &'static str {
        match self {
            Self::Misprint => "refuted: misprint in the statement",
            other => other.word(),
        }
    }

    /// How many of the claims have this outcome.
    pub fn count<'a>(self, claims: impl IntoIterator<Item = &'a Claim>) -> usize {
        claims.into_iter().filter(|claim| Self::of(claim) == self).count()
    }
}
