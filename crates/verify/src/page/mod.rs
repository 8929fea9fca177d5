//! The report of a run: a page with verdicts, figures, measured orders and provenance, in one file
//! that needs no network and no script; a figure and a table of numbers for each panel.

use std::{io::Result, path::Path};

use mc::{files, quoted};
use plot::{
    Document,
    figure::{convergence, evolution},
    series::relative_defect,
};

use crate::*;

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
    for panel in results.figures() {
        let id = &panel.id;
        files::write(&figures.join(format!("{id}.svg")), figure(panel))?;
        files::write(&data.join(format!("{id}.csv")), csv(panel))?;
    }
    files::write(&folder.join("index.html"), page(results))
}

/// The figure of a panel as an SVG document.
fn figure(panel: &Panel) -> String {
    match panel.kind {
        Kind::Invariant => evolution(&panel.title, &panel.series),
        kind => convergence(&panel.title, kind, &panel.series),
    }
}

/// The numbers of a panel as comma-separated values (RFC 4180): one row per point, with a header
/// row. A point of another kind has no row.
///
/// | column | meaning |
/// |---|---|
/// | `scheme`, `quantity` | as in [`Series`](plot::Series) |
/// | `tau`, `value` | step size; root-mean-square error (strong) or signed weak error (weak) |
/// | `se`, `lo`, `hi` | standard error, ends of the interval, empty where it is value ± 1.96 se |
/// | `t`, `value`, `exact` | time, value along the path, value by the conformal law |
/// | `relative_defect` | \|value − exact\| / \|exact\| |
/// | `accuracy`, `path_steps` | half-width asked for, path-steps taken |
fn csv(panel: &Panel) -> String {
    let columns = match panel.kind {
        Kind::Strong | Kind::Weak => "tau,value,se,lo,hi",
        Kind::Invariant => "t,value,exact,relative_defect",
        Kind::Cost => "accuracy,path_steps",
    };
    let mut table = format!("scheme,quantity,{columns}\n");
    for series in &panel.series {
        let name = format!("{},{}", quoted(&series.scheme), quoted(&series.quantity));
        for point in &series.points {
            let row = match (panel.kind, point) {
                (Kind::Strong | Kind::Weak, Point::Error { tau, value, se, lo, hi, .. }) => {
                    let [lo, hi] =
                        [lo, hi].map(|end| end.map_or(String::new(), |x| format!("{x:e}")));
                    format!("{tau:e},{value:e},{se:e},{lo},{hi}")
                }
                (Kind::Invariant, Point::Value { t, value, exact }) => {
                    format!("{t:e},{value:e},{exact:e},{:e}", relative_defect(*value, *exact))
                }
                (Kind::Cost, Point::Cost { accuracy, path_steps }) => {
                    format!("{accuracy:e},{path_steps}")
                }
                _ => continue,
            };
            table += &format!("{name},{row}\n");
        }
    }
    table
}

/// Numbers of claims with each outcome, in words.
pub fn counts<'a>(claims: impl Iterator<Item = &'a Claim> + Clone) -> String {
    let count = |outcome: &str| {
        let number = claims.clone().filter(|claim| claim.outcome() == outcome).count();
        format!("{number} {outcome}")
    };
    ["holds", "refuted", "misprint", "undecided"].map(count).join(", ")
}

fn page(results: &Results) -> String {
    let mut page = Document::new(
        "Casimir · reproduction report",
        "Structure-preserving simulation of damped stochastic Poisson systems",
    );
    page.section("Summary");
    for (what, proven) in [("What the paper proves", true), ("What is observed", false)] {
        let checks = results.claims.iter().filter(|claim| claim.proven == proven);
        page.paragraph(&format!("{what}: {}.", counts(checks.clone())));
        table(&mut page, checks.filter(|claim| !["holds", "misprint"].contains(&claim.outcome())));
    }
    page.linked(
        ["Statement", "Verdict", "Checks", "Tightest interval of its order", "First of its panels"],
        statements(results),
    );
    page.paragraph("A statement is undecided, never passed, where an interval is too wide.");
    for claim in results.claims.iter().filter(|claim| claim.outcome() == "misprint") {
        let Claim { id, erratum, statement, .. } = claim;
        page.warning(&format!(
            "Misprint in the paper ({id}): {erratum} The statement as printed is refuted: \
             {statement}."
        ));
    }
    for panel in results.figures() {
        page.section(&panel.title);
        page.figures([(figure(panel), caption(panel.kind).into())]);
        // Where clipped increments matter.
        let clipped = panel.clipped.iter().map(|clipped| {
            let (exponent, percent) = (elementary::log2(clipped.tau), 100.0 * clipped.share);
            format!(
                "{} at τ = 2^{exponent}: {}, {percent:.0} % of the mean-square error. ",
                clipped.scheme, clipped.increments
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
        table(&mut page, results.claims.iter().filter(|claim| claim.panel == panel.id));
    }
    page.section("Checks without a figure");
    table(&mut page, results.claims.iter().filter(|claim| claim.panel.is_empty()));
    page.section("Schemes and provenance");
    page.facts(BuiltIn::ALL.map(|scheme| (scheme.id(), scheme.properties().long_times)));
    let from = &results.provenance;
    page.facts([
        ("Version", &from.version),
        ("Commit", &from.git),
        ("Compiler", &from.rustc),
        ("Processor", &from.cpu),
        ("Instruction set", &from.simd),
        ("Threads", &from.threads.to_string()),
        ("Seed", &from.seed.to_string()),
        ("Mode", &from.mode),
        ("Command", &from.command),
        ("Folder", &from.folder),
        ("Day", &from.day),
        ("Wall time", &format!("{:.1} s", from.wall_s)),
    ]);
    page.note(
        "The same seed gives the same bits on any number of threads and any instruction set. The \
         whole run is in results.json, the numbers of each figure in data/, the figures in figures/.",
    );
    page.html()
}

/// Rows of the summary, one for each statement, with the section of its first check.
fn statements(results: &Results) -> Vec<(Option<usize>, [String; 5])> {
    let panels: Vec<&Panel> = results.figures().collect();
    let mut ids: Vec<&str> = Vec::new();
    for claim in &results.claims {
        if !ids.contains(&&*claim.id) {
            ids.push(&claim.id);
        }
    }
    let rows = ids.into_iter().map(|id| {
        let checks = results.claims.iter().filter(move |claim| claim.id == id);
        let rates = checks.clone().filter_map(|claim| match &claim.measured {
            Evidence::Order { rate, .. } => rate.as_ref(),
            _ => None,
        });
        let tightest =
            rates.min_by(|one, other| (one.hi - one.lo).total_cmp(&(other.hi - other.lo)));
        let place = |claim: &Claim| panels.iter().position(|panel| panel.id == claim.panel);
        let panel = checks.clone().find_map(place);
        // The first section is the summary; after the panels come the checks without a figure.
        let section = 2 + panel.unwrap_or(panels.len());
        let title = panel.map_or("Checks without a figure", |n| &*panels[n].title);
        let interval = tightest.map_or(String::new(), |Rate { estimate, lo, hi, .. }| {
            format!("{estimate:.3} [{lo:.3}, {hi:.3}]")
        });
        let number = checks.clone().count().to_string();
        (Some(section), [id.into(), counts(checks), number, interval, title.into()])
    });
    rows.collect()
}

/// Adds a table of claims.
fn table<'a>(page: &mut Document, claims: impl Iterator<Item = &'a Claim>) {
    let rows = claims.map(|claim| {
        let Claim { id, scheme, statement, evidence, .. } = claim;
        [claim.outcome(), id, scheme, statement, evidence]
    });
    page.table(["Verdict", "Id", "Scheme", "Statement", "Evidence"], rows);
}

/// Explains how to read a figure.
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
