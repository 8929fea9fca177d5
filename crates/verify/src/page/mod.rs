//! The report of a run: a page with verdicts, figures, measured orders and provenance, in one file
//! that needs no network and no script; a figure and a table of numbers for each panel.

mod csv;
mod group;
mod outcome;
mod panel;
mod prose;

use std::{io::Result, path::Path};

use plot::{
    Document, Kind, escape,
    figure::{convergence, evolution},
    files,
};

use crate::results::{Claim, Panel, Results};
use group::Group;
use prose::prose;

pub use outcome::{Outcome, counts, verdicts};

/// Ids of schemes and what they stand for.
const SCHEMES: [(&str, &str); 7] = [
    ("sexp", "stochastic conformal exponential integrator, the method of the paper"),
    ("em", "Euler–Maruyama on the Itô form"),
    ("midpoint", "stochastic midpoint, damping included"),
    ("sexp-levy", "sexp with Lévy areas, not in the paper"),
    ("sexp-li", "sexp by a linear equation, not in the paper"),
    ("split", "exact flows in turn, not in the paper"),
    ("nv", "flows in turn, of weak order two, not in the paper"),
];

/// The page for `results`; `figures` are the drawings of its panels and then of its supplements, in
/// the same order.
fn page(results: &Results, figures: &[String]) -> String {
    let (proven, observed): (Vec<Group>, Vec<Group>) =
        Group::all(&results.claims).into_iter().partition(|group| group.first().proven);
    let title = "Structure-preserving simulation of damped stochastic Poisson systems";
    let mut page = Document::new("Casimir · reproduction report", title);
    let summary = [("proven statements", &proven), ("statements without a proof", &observed)]
        .map(|(what, groups)| group::summary(what, groups))
        .concat();
    page.head(&format!(
        "<p class=\"summary\">{summary}A statement is undecided, never passed, where an interval \
         is too wide.</p>\n"
    ));
    page.head(&group::misprints(&results.claims));

    page.section("Statements");
    for (what, groups) in [("What the paper proves", &proven), ("What is observed", &observed)] {
        let head = ["Verdict", what, "Scheme", "What was measured"];
        page.markup(&table(head, groups.iter().map(Group::row)));
    }
    let head = ["Verdict", "Statement", "Panel", "Scheme", "Evidence"];
    let checks = table(head, results.claims.iter().map(check));
    page.markup(&format!("<details><summary>All checks</summary>{checks}</details>"));
    let mut figures = figures.iter();
    for (title, panels) in [("Panels", &results.panels), ("Not in the paper", &results.supplements)]
    {
        if !panels.is_empty() {
            page.section(title);
            let cards = panels.iter().zip(figures.by_ref());
            let cards = cards.map(|(panel, figure)| panel::card(panel, figure, &results.claims));
            page.markup(&format!("<div class=\"grid\">{}</div>\n", cards.collect::<String>()));
        }
    }
    page.section("Schemes");
    page.facts(SCHEMES);
    page.section("Provenance");
    let from = &results.provenance;
    page.facts([
        ("Commit", &from.git),
        ("Compiler", &from.rustc),
        ("Processor", &from.cpu),
        ("Instruction set", &from.simd),
        ("Threads", &from.threads.to_string()),
        ("Seed", &from.seed.to_string()),
        ("Mode", &from.mode),
        ("Command", &from.command),
        ("Wall time", &format!("{:.1} s", from.wall_s)),
    ]);
    page.note(
        "The same seed gives the same bits on any number of threads and any instruction set. The \
         whole run is in results.json.",
    );
    page.html()
}

/// One claim as a row of a table.
fn check(claim: &Claim) -> Vec<String> {
    let words = prose(&claim.statement);
    let (panel, scheme) = (code(&claim.panel), code(&claim.scheme));
    vec![outcome::badge(Outcome::of(claim)), words, panel, scheme, prose(&claim.evidence)]
}

/// An identifier.
fn code(id: &str) -> String {
    if id.is_empty() { String::new() } else { format!("<code>{}</code>", escape(id)) }
}

/// A table of markup, which scrolls where it is too wide; nothing without rows.
fn table<'a>(
    head: impl IntoIterator<Item = &'a str>,
    rows: impl Iterator<Item = Vec<String>>,
) -> String {
    let row = |cells: Vec<String>| format!("<tr><td>{}</td></tr>\n", cells.join("</td><td>"));
    let rows: String = rows.map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    let head: String = head.into_iter().map(|name| format!("<th>{name}</th>")).collect();
    format!(
        "<div class=\"wide\"><table class=\"numbers\"><thead><tr>{head}</tr></thead>\n\
         <tbody>{rows}</tbody></table></div>\n"
    )
}

/// Writes the report of a run into a folder.
///
/// ```text
/// index.html            verdicts, figures and provenance in one file
/// figures/<panel>.svg   the figures alone, for a paper or a talk
/// data/<panel>.csv      the numbers behind them
/// ```
///
/// A reader never sees half a file; an interrupted run leaves the rest of the previous report.
///
/// # Errors
///
/// When a file cannot be written; the error names it.
pub fn write_report(results: &Results, folder: &Path) -> Result<()> {
    let (figures, data) = (folder.join("figures"), folder.join("data"));
    files::prepare(&figures)?;
    files::prepare(&data)?;
    let panels = results.panels.iter().chain(&results.supplements);
    let drawings: Vec<String> = panels.clone().map(panel_figure).collect();
    for (panel, drawing) in panels.zip(&drawings) {
        files::write(&figures.join(format!("{}.svg", panel.id)), drawing)?;
        files::write(&data.join(format!("{}.csv", panel.id)), csv::csv(panel))?;
    }
    files::write(&folder.join("index.html"), page(results, &drawings))
}

/// The figure of a panel as an SVG document.
fn panel_figure(panel: &Panel) -> String {
    match panel.kind {
        Kind::Invariant => evolution(&panel.title, &panel.series),
        kind => convergence(&panel.title, kind, &panel.series).svg(),
    }
}

#[cfg(test)]
mod tests;
