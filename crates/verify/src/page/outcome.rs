//! What a verdict means to a reader, on the page and in the terminal.

use comfy_table::{
    Attribute, Cell, Color, ContentArrangement, Table, presets::UTF8_HORIZONTAL_ONLY,
};

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

    /// How many of the claims have this outcome.
    pub fn count<'a>(self, claims: impl IntoIterator<Item = &'a Claim>) -> usize {
        claims.into_iter().filter(|claim| Self::of(claim) == self).count()
    }
}

/// A table for the terminal with a row for each claim: what, on which panel, by which scheme,
/// verdict, evidence.
pub fn verdicts(claims: &[Claim]) -> String {
    let mut table = Table::new();
    table.load_style(UTF8_HORIZONTAL_ONLY).set_content_arrangement(ContentArrangement::Dynamic);
    table.set_header(["statement", "panel", "scheme", "verdict", "evidence"]);
    for claim in claims {
        let outcome = Outcome::of(claim);
        let colour = match outcome {
            Outcome::Holds => Color::Green,
            Outcome::Misprint | Outcome::Undecided => Color::Yellow,
            Outcome::Refuted => Color::Red,
        };
        let verdict = Cell::new(outcome.word()).fg(colour).add_attribute(Attribute::Bold);
        let [id, panel, scheme, evidence] =
            [&claim.id, &claim.panel, &claim.scheme, &claim.evidence].map(Cell::new);
        table.add_row([id, panel, scheme, verdict, evidence]);
    }
    table.to_string()
}

/// How many claims hold, are refuted, are undecided, in words.
pub fn counts(claims: &[Claim]) -> String {
    use Outcome::{Holds, Misprint, Refuted, Undecided};
    let [hold, refuted, misprinted, undecided] =
        [Holds, Refuted, Misprint, Undecided].map(|outcome| outcome.count(claims));
    format!(
        "{hold} statements hold, {refuted} refuted, {misprinted} misprinted, {undecided} undecided"
    )
}
