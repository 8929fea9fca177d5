//! The verdict table in the terminal.

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{Attribute, Cell, Color, ContentArrangement, Table};
use verify::results::{Claim, Results, Verdict};

/// One line a claim: what, on which panel, by which scheme, verdict, evidence.
pub fn verdicts(results: &Results) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_HORIZONTAL_ONLY).set_content_arrangement(ContentArrangement::Dynamic);
    table.set_header(["statement", "panel", "scheme", "verdict", "evidence"]);
    for claim in &results.claims {
        table.add_row([
            Cell::new(&claim.id),
            Cell::new(&claim.panel),
            Cell::new(&claim.scheme),
            verdict_cell(claim),
            Cell::new(&claim.evidence),
        ]);
    }
    table
}

fn verdict_cell(claim: &Claim) -> Cell {
    let (word, colour) = match claim.verdict {
        Verdict::Holds => ("holds", Color::Green),
        Verdict::Refuted if !claim.erratum.is_empty() => ("refuted (erratum)", Color::Yellow),
        Verdict::Refuted => ("refuted", Color::Red),
        Verdict::Undecided => ("undecided", Color::Yellow),
    };
    Cell::new(word).fg(colour).add_attribute(Attribute::Bold)
}

/// How many claims hold, are refuted, are undecided.
pub fn counts(claims: &[Claim]) -> String {
    let count = |verdict| claims.iter().filter(|claim| claim.verdict == verdict).count();
    format!(
        "{} statements hold, {} refuted, {} undecided",
        count(Verdict::Holds),
        count(Verdict::Refuted),
        count(Verdict::Undecided)
    )
}
