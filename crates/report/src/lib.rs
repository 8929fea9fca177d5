//! **Figures, reports and pages of numerical experiments.**
//!
//! [`write_report`] turns a run into a page that opens without a network, a figure and a table of
//! numbers for each panel. Each part can be used alone: [`figure`] draws any curves as SVG,
//! [`Page`] writes Markdown, [`csv()`] tables of numbers, [`files`] whole files or none, [`Bars`]
//! shows progress.
//!
//! The figures are written as SVG without a library such as plotters: it rounds coordinates to
//! integers, dashes one by one, and has no indices and exponents in the font of a text. A page of
//! lines, markers and text needs no drawing backend, and the viewer sets the text in its own font.
//!
//! ```
//! use report::figure::{Curve, Figure, Measured, Plot, Spacing, Style};
//!
//! // Errors against the processor time that they cost.
//! let points = [1.0, 10.0, 100.0].map(|cost| Measured::new(cost, 1.0 / cost));
//! let figure = Figure {
//!     title: "Error against cost".into(),
//!     y_title: "error".into(),
//!     size: (268.0, 214.0),
//!     style: Style::Schemes,
//!     plots: vec![Plot {
//!         x_title: "processor time, s".into(),
//!         spacing: Spacing::Decades,
//!         lines: Vec::new(),
//!         curves: vec![Curve::new("heun", points)],
//!     }],
//! };
//! let svg = figure.svg();
//! assert!(svg.starts_with("<svg") && svg.contains("processor time, s") && svg.contains("heun"));
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`write_report`], [`Wording`] | HTML page, figures and tables of a whole run |
//! | [`figure`] | figures as SVG: convergence, evolution, error against cost, any curves |
//! | [`Document`] | HTML pages of one file |
//! | [`Page`], [`anchor`], [`distinct`], [`number`] | Markdown pages |
//! | [`csv()`], [`comparison_csv`] | the numbers of a panel, or of a comparison of schemes |
//! | [`cluster`] | the job script of a study in parts |
//! | [`files`] | whole files, folders that are checked before the computing |
//! | [`provenance`] | commit, compiler, processor, command, memory |
//! | [`Bars`], [`terminal`] | progress and verdicts on the terminal |
//! | [`Outcome`] | what a verdict means to a reader |
//! | [`Label`] | indices and exponents in names of quantities |

mod bars;
pub mod cluster;
mod csv;
mod escape;
pub mod figure;
pub mod files;
mod html;
mod label;
mod markdown;

mod outcome;
mod panel;
pub mod provenance;
pub mod terminal;

use std::{io::Result, path::Path};

use analysis::results::Results;

pub use analysis::number;
pub use bars::Bars;
pub use csv::{comparison_csv, csv};
pub use html::{Document, Wording};
pub use label::Label;
pub use markdown::{Page, anchor, distinct};
pub use outcome::Outcome;

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
pub fn write_report(results: &Results, wording: &Wording, folder: &Path) -> Result<()> {
    let (figures, data) = (folder.join("figures"), folder.join("data"));
    files::prepare(&figures)?;
    files::prepare(&data)?;
    let panels = results.panels.iter().chain(&results.supplements);
    let drawings: Vec<String> = panels.clone().map(figure::panel_figure).collect();
    for (panel, drawing) in panels.zip(&drawings) {
        let stem = panel::file_stem(&panel.id);
        files::write(&figures.join(format!("{stem}.svg")), drawing)?;
        files::write(&data.join(format!("{stem}.csv")), csv(panel))?;
    }
    files::write(&folder.join("index.html"), html::page(results, wording, &drawings))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use analysis::results::{Kind, Panel, Point, Provenance, SCHEMA, Series};

    use super::*;

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
        write_report(&results, &Wording::default(), dir.path())?;
        // A second run replaces the first.
        write_report(&results, &Wording::default(), dir.path())?;
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
}
