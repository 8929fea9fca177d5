//! The report of a run: a page with verdicts, figures, measured orders and provenance, in one file
//! that needs no network and no script; a figure and a table of numbers for each panel.

mod csv;
mod outcome;

use std::{io::Result, path::Path};

use plot::{
    Document, Kind,
    figure::{convergence, evolution},
    files,
    series::relative_defect,
};

use crate::results::{Claim, Clipped, Panel, Point, Results, Series};

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
    let kinds = [("What the paper proves", true), ("What is observed, without a proof", false)]
        .map(|(what, proven)| (what, groups.iter().filter(move |group| group[0].proven == proven)));
    page.section("Summary");
    for (what, groups) in kinds.clone() {
        page.paragraph(&format!("{what}: {}.", summary(groups)));
    }
    page.paragraph("A statement is undecided, never passed, where an interval is too wide.");
    for claim in results.claims.iter().filter(|claim| Outcome::of(claim) == Outcome::Misprint) {
        let Claim { id, erratum, statement, .. } = claim;
        page.warning(&format!(
            "Misprint in the paper ({id}): {erratum} The statement as printed is refuted: \
             {statement}."
        ));
    }
    for (what, groups) in kinds {
        page.section(what);
        let head =
            ["Verdict", "Checks that hold", "Statement", "Id", "Scheme", "What was measured"];
        page.table(head, groups.map(|group| row(group)));
    }
    for panel in results.panels.iter().chain(&results.supplements) {
        show(&mut page, panel, &results.claims);
    }
    page.section("All checks");
    let checks = results.claims.iter().map(|claim| {
        let Claim { id, panel, scheme, statement, evidence, .. } = claim;
        [Outcome::of(claim).word(), id, panel, scheme, statement, evidence]
    });
    page.table(["Verdict", "Id", "Panel", "Scheme", "Statement", "Evidence"], checks);
    page.section("Schemes and provenance");
    page.facts(SCHEMES);
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

/// How many groups hold, and the others by name.
fn summary<'a>(groups: impl Iterator<Item = &'a Group<'a>>) -> String {
    let (mut hold, mut all, mut others) = (0, 0, String::new());
    for group in groups {
        all += 1;
        match Outcome::of(worst(group)) {
            Outcome::Holds => hold += 1,
            other => others += &format!("; {}: {} {}", other.word(), group[0].id, group[0].scheme),
        }
    }
    format!("{hold} of {all} statements hold{others}")
}

/// A group as a row, with the evidence that decides.
fn row(group: &Group) -> [String; 6] {
    let (claim, worst) = (group[0], worst(group));
    let scheme = if claim.proven { String::new() } else { claim.scheme.clone() };
    [
        Outcome::of(worst).word().into(),
        format!("{} of {}", Outcome::Holds.count(group.iter().copied()), group.len()),
        claim.statement.clone(),
        claim.id.clone(),
        scheme,
        worst.evidence.clone(),
    ]
}

/// What a series measured, as the cells of a row.
type Row = fn(&Series) -> Vec<String>;

/// A section with a figure, what the paper says of it, and what was measured.
fn show(page: &mut Document, panel: &Panel, claims: &[Claim]) {
    page.section(&panel.title);
    page.figures([(figure(panel), caption(panel.kind).into())]);
    let (head, row): (&[&str], Row) = match panel.kind {
        Kind::Strong | Kind::Weak => {
            (&["order", "95 % interval", "error at the finest step"], order)
        }
        Kind::Invariant => (&["largest relative defect"], defect),
        Kind::Cost => (&["smallest half-width", "path-steps"], cost),
    };
    let named = |series: &Series| {
        let mut cells = vec![series.scheme.clone(), series.quantity.clone()];
        cells.extend(row(series));
        cells
    };
    page.table([&["scheme", "quantity"], head].concat(), panel.series.iter().map(named));
    let mine: Vec<Claim> = claims.iter().filter(|claim| claim.panel == panel.id).cloned().collect();
    page.facts([
        ("Panel", panel.id.clone()),
        ("Verdicts", if mine.is_empty() { String::new() } else { counts(&mine) }),
        ("What the paper says", panel.paper.clone()),
        ("Set-up", panel.setup.clone()),
        ("Sample paths", panel.samples.to_string()),
        ("Reference", panel.reference.clone()),
        ("Clipped increments", panel.clipped.iter().map(clipped).collect()),
        ("Paths left out", panel.failures.join("; ")),
    ]);
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

fn order(series: &Series) -> Vec<String> {
    let (order, interval) = series.rate.as_ref().map_or(("—".into(), String::new()), |rate| {
        (format!("{:.2}", rate.estimate), format!("[{:.2}, {:.2}]", rate.lo, rate.hi))
    });
    let finest = series.points.last().map_or(String::new(), |point| match point {
        Point::Error { tau, value, se, .. } => {
            format!("{value:.1e} ± {se:.0e} at τ = 2^{}", tau.log2())
        }
        _ => String::new(),
    });
    vec![order, interval, finest]
}

fn defect(series: &Series) -> Vec<String> {
    let defects = series.points.iter().filter_map(|point| match *point {
        Point::Value { value, exact, .. } => Some(relative_defect(value, exact)),
        _ => None,
    });
    // A defect that is not a number must not hide behind smaller ones, as it would with `f64::max`.
    let largest = series.max_relative_defect.or_else(|| defects.max_by(f64::total_cmp));
    vec![largest.map_or("—".into(), |defect| format!("{defect:.1e}"))]
}

fn cost(series: &Series) -> Vec<String> {
    series.points.last().map_or(Vec::new(), |point| match point {
        Point::Cost { accuracy, path_steps } => vec![accuracy.to_string(), path_steps.to_string()],
        _ => Vec::new(),
    })
}

/// Where clipped increments matter.
fn clipped(Clipped { scheme, tau, increments, share }: &Clipped) -> String {
    format!(
        "{scheme} at τ = 2^{}: {increments}, {:.0} % of the mean-square error. ",
        tau.log2(),
        100.0 * share
    )
}

#[cfg(test)]
mod tests;
