//! The report of a run: a page with summary, statements, panels, supplements and provenance, in one
//! file that needs no network and no script; a figure and a table of numbers for each panel.

mod card;
mod csv;
mod group;
mod markup;
mod measured;
mod number;
mod outcome;
mod prose;
mod provenance;
mod statements;
mod summary;
pub mod terminal;
mod wording;

use std::{io::Result, path::Path};

use plot::{
    Document, Kind,
    figure::{convergence, evolution},
    files,
};

use crate::results::{Panel, Results};

pub use outcome::Outcome;

/// The page for `results`; `figures` are the drawings of its panels and then of its supplements, in
/// the same order.
fn page(results: &Results, figures: &[String]) -> String {
    let mut figures = figures.iter();
    let mut cards = |panels: &[Panel], comment: &str| {
        let card =
            |(panel, figure): (_, &String)| card::card(panel, figure, &results.claims, comment);
        let cards: String = panels.iter().zip(figures.by_ref()).map(card).collect();
        if cards.is_empty() { cards } else { format!("<div class=\"grid\">{cards}</div>") }
    };
    let statements = statements::statements(&results.claims, &results.panels);
    let panels = cards(&results.panels, "What the paper says");
    let supplements = cards(&results.supplements, "What it adds to the paper");
    let mut page = Document::new(wording::KICKER, wording::TITLE);
    let schemes = wording::SCHEMES.iter().map(|(id, name)| markup::entry(&markup::code(id), name));
    let schemes: String = schemes.collect();
    page.head(&format!("{}<dl class=\"schemes\">{schemes}</dl>\n", summary::summary(results)));
    for (title, content) in [
        ("Statements", statements),
        ("Panels", panels),
        ("Not in the paper", supplements),
        ("Provenance", provenance::provenance(&results.provenance)),
    ] {
        if !content.is_empty() {
            page.section(title);
            page.markup(&content);
        }
    }
    page.html()
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
        let stem = file_stem(&panel.id);
        files::write(&figures.join(format!("{stem}.svg")), drawing)?;
        files::write(&data.join(format!("{stem}.csv")), csv::csv(panel))?;
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

/// The name of a panel's files: its id, without what could leave the folder.
pub fn file_stem(id: &str) -> String {
    id.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use plot::Series;

    use super::*;
    use crate::results::{Claim, Evidence, Point, Provenance, SCHEMA, Verdict};

    /// A claim for tests.
    pub fn claim(id: &str, scheme: &str, proven: bool, verdict: Verdict, erratum: &str) -> Claim {
        let evidence = Evidence::Undecided { reason: "as it should be".into() };
        Claim {
            scheme: scheme.into(),
            verdict,
            proven,
            erratum: erratum.into(),
            ..Claim::new(id, format!("{scheme} has {id}"), evidence)
        }
    }

    #[test]
    fn an_unknown_statement_speaks_for_itself() {
        let proven = "The exact flow obeys the conformal law of homogeneous Casimirs and energies.";
        for (id, scheme, proven, words) in [
            ("exact-conformal", "sexp", true, proven),
            ("exact-conformal", "em", false, "em has exact-conformal"),
            ("new", "sexp", true, "sexp has new"),
        ] {
            let claim = claim(id, scheme, proven, Verdict::Holds, "");
            assert_eq!(wording::statement(&claim), words);
        }
    }

    fn panel(id: &str, kind: Kind, points: Vec<Point>) -> Panel {
        let series = |scheme: &str| Series {
            scheme: scheme.into(),
            quantity: "a<b".into(),
            points: points.clone(),
            rate: None,
            max_relative_defect: None,
        };
        Panel {
            id: id.into(),
            kind,
            title: "A & B".into(),
            setup: String::new(),
            paper: String::new(),
            samples: 1,
            reference: String::new(),
            failures: Vec::new(),
            clipped: Vec::new(),
            differences: Vec::new(),
            series: vec![series("sexp"), series("other")],
        }
    }

    /// Data no figure likes: none, a single point, zeros, what is not finite, and the ends of the
    /// range of `f64`.
    fn awkward() -> Vec<Panel> {
        let error = Point::normal;
        let value = |t, value, exact| Point::Value { t, value, exact };
        let errors = [
            vec![],
            vec![error(0.1, 1e-3, 0.0)],
            vec![error(0.1, 0.0, 0.0), error(0.05, 0.0, 0.0)],
            vec![error(0.1, f64::MAX, f64::MAX), error(0.05, -5e-324, f64::NAN)],
            vec![Point::Error {
                tau: 0.1,
                value: 1.0,
                se: 0.1,
                lo: Some(-1.0),
                hi: Some(f64::NAN),
                warning: Some("<w>".into()),
            }],
            vec![error(0.1, f64::NAN, 1.0), error(0.0, 1.0, 0.0), error(-1.0, 1.0, f64::INFINITY)],
            vec![value(0.0, 1.0, 1.0), error(0.1, 5e3, 1e4)],
        ];
        let values = [
            vec![],
            vec![value(0.0, 1.0, 1.0)],
            vec![value(0.0, 0.0, 0.0), value(2.0, 1.0, 0.0), value(1.0, 0.0, 0.0)],
            vec![value(0.0, f64::MAX, -f64::MAX), value(1.0, f64::NAN, 1.0)],
            vec![value(f64::NAN, 1.0, 1.0), value(1.0, f64::INFINITY, f64::NEG_INFINITY)],
        ];
        let mut panels = Vec::new();
        for (n, points) in errors.into_iter().enumerate() {
            panels.push(panel(&format!("strong-{n}"), Kind::Strong, points.clone()));
            panels.push(panel(&format!("weak-{n}"), Kind::Weak, points));
        }
        for (n, points) in values.into_iter().enumerate() {
            panels.push(panel(&format!("invariant-{n}"), Kind::Invariant, points));
        }
        panels
    }

    #[test]
    fn awkward_data_still_make_a_report() -> Result<()> {
        let dir = tempfile::tempdir()?;
        let results = Results {
            schema: SCHEMA,
            provenance: Provenance::default(),
            panels: awkward(),
            supplements: Vec::new(),
            claims: Vec::new(),
        };
        write_report(&results, dir.path())?;
        // A second run replaces the first.
        write_report(&results, dir.path())?;
        let page = fs::read_to_string(dir.path().join("index.html"))?;
        for panel in &results.panels {
            let figure = fs::read_to_string(dir.path().join(format!("figures/{}.svg", panel.id)))?;
            assert!(figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"));
            assert!(page.contains(&figure), "{} is not on the page", panel.id);
            assert!(dir.path().join(format!("data/{}.csv", panel.id)).is_file());
        }
        assert!(!page.contains("a<b") && page.contains("a&lt;b"));
        assert!(!page.contains("<script") && !page.contains("src="));
        Ok(())
    }

    #[test]
    fn file_names_stay_in_their_folder() {
        assert_eq!(file_stem("rigid-body-weak-y2"), "rigid-body-weak-y2");
        assert_eq!(file_stem("../x/y"), "___x_y");
    }
}
