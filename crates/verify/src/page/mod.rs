//! The report of a run: a page with verdicts, figures, measured orders and provenance, in one file
//! that needs no network and no script; a figure and a table of numbers for each panel.

mod csv;
mod outcome;

use std::{io::Result, path::Path};

use plot::{
    Document, Kind,
    figure::{convergence, evolution},
    files,
};
use schemes::BuiltIn;

use crate::results::{Claim, Clipped, Panel, Results};

pub use outcome::{Outcome, counts, verdicts};

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
    for panel in results.panels.iter().chain(&results.supplements) {
        files::write(&figures.join(format!("{}.svg", panel.id)), figure(panel))?;
        files::write(&data.join(format!("{}.csv", panel.id)), csv::csv(panel))?;
    }
    files::write(&folder.join("index.html"), page(results))
}

/// The figure of a panel as an SVG document.
fn figure(panel: &Panel) -> String {
    match panel.kind {
        Kind::Invariant => evolution(&panel.title, &panel.series),
        kind => convergence(&panel.title, kind, &panel.series).svg(),
    }
}

fn page(results: &Results) -> String {
    let title = "Structure-preserving simulation of damped stochastic Poisson systems";
    let mut page = Document::new("Casimir · reproduction report", title);
    let groups = groups(&results.claims);
    let kinds = [("What the paper proves", true), ("What is observed, without a proof", false)];
    let of_kind = |kind| groups.iter().filter(move |group| group[0].proven == kind);
    page.section("Summary");
    for (what, proven) in kinds {
        let worst = of_kind(proven).map(|group| worst(group));
        let (holding, others): (Vec<_>, Vec<_>) =
            worst.partition(|claim| Outcome::of(claim) == Outcome::Holds);
        let (hold, all) = (holding.len(), holding.len() + others.len());
        let words = |claim: &Claim| {
            format!("; {}: {} {}", Outcome::of(claim).word(), claim.id, claim.scheme)
        };
        let others: String = others.into_iter().map(words).collect();
        page.paragraph(&format!("{what}: {hold} of {all} statements hold{others}."));
    }
    page.paragraph("A statement is undecided, never passed, where an interval is too wide.");
    for claim in results.claims.iter().filter(|claim| Outcome::of(claim) == Outcome::Misprint) {
        let Claim { id, erratum, statement, .. } = claim;
        page.warning(&format!(
            "Misprint in the paper ({id}): {erratum} The statement as printed is refuted: \
             {statement}."
        ));
    }
    for (what, proven) in kinds {
        page.section(what);
        let head = ["Checks that hold", "Verdict", "Id", "Scheme", "Statement", "Evidence"];
        page.table(
            head,
            of_kind(proven).map(|group| {
                let scheme = if proven { "" } else { &group[0].scheme };
                let hold =
                    format!("{} of {}", Outcome::Holds.count(group.iter().copied()), group.len());
                let [verdict, id, _, _, evidence] = row(worst(group));
                [hold, verdict, id, scheme.into(), group[0].statement.clone(), evidence]
            }),
        );
    }
    for panel in results.panels.iter().chain(&results.supplements) {
        show(&mut page, panel, &results.claims);
    }
    page.section("Checks without a figure");
    checks(&mut page, results.claims.iter().filter(|claim| claim.panel.is_empty()));
    page.section("Schemes and provenance");
    page.facts(BuiltIn::ALL.map(|scheme| (scheme.id(), scheme.properties().long_times)));
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
         whole run is in results.json, the numbers of each figure in data/, the figures in figures/.",
    );
    page.html()
}

/// Claims about one statement: proven ones by statement, others by statement and scheme.
type Group<'a> = Vec<&'a Claim>;

/// The groups in the order in which the statements first appear.
fn groups(claims: &[Claim]) -> Vec<Group<'_>> {
    let key = |claim: &Claim| {
        let scheme = if claim.proven { String::new() } else { claim.scheme.clone() };
        (claim.id.clone(), claim.proven, scheme)
    };
    let mut groups: Vec<Group> = Vec::new();
    for claim in claims {
        match groups.iter_mut().find(|group| key(group[0]) == key(claim)) {
            Some(group) => group.push(claim),
            None => groups.push(vec![claim]),
        }
    }
    groups
}

/// The claim that decides: refuted if one is, else undecided if one is; a misprint counts only
/// where nothing else is left.
fn worst<'a>(group: &Group<'a>) -> &'a Claim {
    group.iter().min_by_key(|claim| Outcome::of(claim)).expect("a group has claims")
}

/// A section with a figure, what the paper says of it, and the checks on it.
fn show(page: &mut Document, panel: &Panel, claims: &[Claim]) {
    page.section(&panel.title);
    page.figures([(figure(panel), caption(panel.kind).into())]);
    // Where clipped increments matter.
    let clipped = panel.clipped.iter().map(|Clipped { scheme, tau, increments, share }| {
        let (exponent, percent) = (tau.log2(), 100.0 * share);
        format!(
            "{scheme} at τ = 2^{exponent}: {increments}, {percent:.0} % of the mean-square error. "
        )
    });
    page.facts([
        ("Panel", &panel.id),
        ("What the paper says", &panel.paper),
        ("Set-up", &panel.setup),
        ("Sample paths", &panel.samples.to_string()),
        ("Reference", &panel.reference),
        ("Clipped increments", &clipped.collect()),
        ("Paths left out", &panel.failures.join("; ")),
    ]);
    checks(page, claims.iter().filter(|claim| claim.panel == panel.id));
}

/// A table of claims.
fn checks<'a>(page: &mut Document, claims: impl Iterator<Item = &'a Claim>) {
    page.table(["Verdict", "Id", "Scheme", "Statement", "Evidence"], claims.map(row));
}

fn row(claim: &Claim) -> [String; 5] {
    let Claim { id, scheme, statement, evidence, .. } = claim;
    [Outcome::of(claim).word(), id, scheme, statement, evidence].map(str::to_owned)
}

/// How to read the figure.
fn caption(kind: Kind) -> &'static str {
    match kind {
        Kind::Strong => {
            "Root-mean-square error with 95 % error bars; dashed, in grey: reference slopes. In the \
             legend: fitted order ± half the width of its 95 % interval."
        }
        Kind::Weak => {
            "Size of the weak error, filled where it is positive and hollow where negative, with \
             95 % error bars; a bar without a lower cap reaches zero. In grey: reference slope."
        }
        Kind::Cost => "Path-steps, pilots included, for an interval of the given half-width.",
        Kind::Invariant => {
            "Above: the invariant along the path and, thin and black, its conformal law. Below: \
             relative defect of the law; a defect of zero is drawn at the mark 0."
        }
    }
}

#[cfg(test)]
mod tests;
