//! What a verdict means to a reader, and the badge that says so.

use verify::results::{Claim, Verdict};

/// A verdict, with refutations that a documented misprint explains set apart; ordered from best to
/// worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
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
    pub fn of(claim: &Claim) -> Self {
        match claim.verdict {
            Verdict::Holds => Self::Holds,
            Verdict::Undecided => Self::Undecided,
            Verdict::Refuted if claim.erratum.is_empty() => Self::Refuted,
            Verdict::Refuted => Self::Misprint,
        }
    }

    /// The outcome as a predicate.
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Misprint => "refuted: misprint in the statement",
            Self::Undecided => "undecided",
            Self::Refuted => "refuted",
        }
    }

    /// A coloured badge that also says the outcome in words.
    pub fn badge(self) -> String {
        let (class, sign) = match self {
            Self::Holds => ("holds", "✓"),
            Self::Misprint => ("misprint", "✎"),
            Self::Undecided => ("undecided", "?"),
            Self::Refuted => ("refuted", "✗"),
        };
        format!(
            "<span class=\"badge {class}\"><span aria-hidden=\"true\">{sign}</span> {}</span>",
            self.words()
        )
    }
}
