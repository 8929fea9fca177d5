//! What a verdict means to a reader, and the badge that says so.

use verify::results::{Claim, Verdict};

/// A verdict, with refutations that a documented misprint explains set apart; ordered from best to worst.
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

    /// A coloured badge that also says its verdict in words.
    pub fn badge(self) -> String {
        let (class, sign, words) = match self {
            Self::Holds => ("holds", "✓", "holds"),
            Self::Misprint => ("misprint", "✎", "refuted: misprint in the statement"),
            Self::Undecided => ("undecided", "?", "undecided"),
            Self::Refuted => ("refuted", "✗", "refuted"),
        };
        format!("<span class=\"badge {class}\"><span aria-hidden=\"true\">{sign}</span> {words}</span>")
    }

    /// `n` claims with this outcome, in words.
    pub fn counted(self, n: usize) -> String {
        let verb = |one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
        match self {
            Self::Holds => verb("holds", "hold"),
            Self::Misprint => verb("refuted by a misprint", "refuted by misprints"),
            Self::Undecided => format!("{n} undecided"),
            Self::Refuted => format!("{n} refuted"),
        }
    }
}
