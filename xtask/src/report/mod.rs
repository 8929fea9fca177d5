//! The report of a run: a page that opens without a network, one figure and one table of numbers
//! per panel.
//!
//! ```text
//! index.html            verdicts, figures and provenance in one self-contained file
//! figures/<panel>.svg   the figures alone, for a paper or a talk
//! data/<panel>.csv      the numbers behind them
//! ```

mod csv;
mod escape;
mod figure;
mod html;
mod label;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use verify::results::{Panel, Results};

use crate::output::write;

pub use figure::{GrowthCurve, WorkPlot, WorkPoint, growth_figure, work_figure};

/// Writes the report of `results` into the existing directory `dir`.
///
/// Each file appears whole or not at all: a reader never sees half a page, and an interrupted run
/// leaves the previous report as it was.
///
/// # Errors
///
/// When a figure cannot be drawn or a file cannot be written.
pub fn write_report(results: &Results, dir: &Path) -> Result<()> {
    let (figures, data) = (dir.join("figures"), dir.join("data"));
    for folder in [&figures, &data] {
        fs::create_dir_all(folder).with_context(|| format!("creating {}", folder.display()))?;
    }
    let mut drawings = Vec::new();
    for panel in results.panels.iter().chain(&results.supplements) {
        let drawing = figure::figure(panel).with_context(|| format!("drawing {}", panel.id))?;
        let stem = file_stem(&panel.id);
        write(&figures.join(format!("{stem}.svg")), drawing.as_bytes())?;
        write(&data.join(format!("{stem}.csv")), csv::csv(panel).as_bytes())?;
        drawings.push(drawing);
    }
    write(&dir.join("index.html"), html::page(results, &drawings).as_bytes())
}

/// The name of a panel's files: its id, without what could leave the folder.
fn file_stem(id: &str) -> String {
    id.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// The quantity a strong or invariant figure shows: the error at the final time, or whatever comes
/// first.
fn main_quantity(panel: &Panel) -> &str {
    const FINAL_TIME: &str = "y(T)";
    let mut quantities = panel.series.iter().map(|s| s.quantity.as_str());
    let first = quantities.clone().next().unwrap_or("");
    quantities.find(|q| *q == FINAL_TIME).unwrap_or(first)
}

/// |value − exact| / |exact|, and zero where the two agree.
fn relative_defect(value: f64, exact: f64) -> f64 {
    if value == exact { 0.0 } else { ((value - exact) / exact).abs() }
}

#[cfg(test)]
mod tests {
    use verify::results::{Kind, Point, Provenance, SCHEMA, Series};

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

    #[test]
    fn agreement_has_no_defect_even_at_zero() {
        assert_eq!(relative_defect(0.0, 0.0), 0.0);
        assert_eq!(relative_defect(1.5, -1.0), 2.5);
        assert_eq!(relative_defect(1.0, 0.0), f64::INFINITY);
    }
}
