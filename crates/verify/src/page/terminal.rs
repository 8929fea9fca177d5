//! The verdicts in the terminal.

use comfy_table::{
    Attribute, Cell, Color, ContentArrangement, Table, presets::UTF8_HORIZONTAL_ONLY,
};

use super::Outcome;
use crate::results::Claim;

/// A table with a row for each claim: what, on which panel, by which scheme, verdict, evidence.
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
    let [refuted, undecided, hold, misprinted] = Outcome::ALL.map(|outcome| outcome.count(claims));
    format!(
        "{hold} statements hold, {refuted} refuted, {misprinted} misprinted, {undecided} undecided"
    )
}
