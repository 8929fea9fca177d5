//! What was measured on a panel, as tables: fitted orders, errors at every step, or largest
//! defects.

use verify::results::{Kind, Panel, Point, Series};

use super::markup::{code, details, list, table};
use super::number::{scientific, step};
use super::prose::prose;
use crate::escape::escape;
use crate::panel::{QUANTILE, relative_defect};

/// The tables of a panel.
pub fn measured(panel: &Panel) -> String {
    let series = &panel.series;
    let heads = |more: &[&str]| -> Vec<String> {
        ["scheme", "quantity"].iter().chain(more).map(|head| (*head).to_owned()).collect()
    };
    let rows = |cells: fn(&Series) -> Vec<String>| series.iter().map(move |s| row(s, cells(s)));
    let tables = match panel.kind {
        Kind::Strong | Kind::Weak => {
            let heads = heads(&["order", "interval", "error at the finest step"]);
            format!("{}{}{}", table(&heads, rows(order)), methods(series), errors(series))
        }
        Kind::Invariant => table(&heads(&["largest relative defect", "points"]), rows(defect)),
        Kind::Cost => {
            let points = series.iter().flat_map(|s| s.points.iter().map(move |point| (s, point)));
            let rows = points.filter_map(|(series, point)| match *point {
                Point::Cost { accuracy, path_steps } => {
                    let numbers = [scientific(accuracy, 1), scientific(path_steps as f64, 2)];
                    Some(row(series, numbers.to_vec()))
                }
                _ => None,
            });
            table(&heads(&["half-width", "path-steps"]), rows)
        }
    };
    if tables.is_empty() { "<p>Nothing.</p>".to_owned() } else { tables }
}

/// Scheme and quantity, and what else stands in their row.
fn row(series: &Series, more: Vec<String>) -> Vec<String> {
    [vec![code(&series.scheme), prose(&series.quantity)], more].concat()
}

/// The fitted order, its interval, and the error at the finest step.
fn order(series: &Series) -> Vec<String> {
    let dash = || "—".to_owned();
    let order = series.rate.as_ref().map(|rate| prose(&format!("{:.2}", rate.estimate)));
    let interval = series.rate.as_ref().map(|rate| {
        let ends = prose(&format!("[{:.2}, {:.2}]", rate.lo, rate.hi));
        format!("{ends} {}", quiet(&interval_name(rate.confidence)))
    });
    let finest = errors_of(series).min_by(|a, b| a.0.total_cmp(&b.0));
    let finest =
        finest.map(|(tau, error)| format!("{error} {}", quiet(&format!("at {}", step(tau)))));
    [order, interval, finest].map(|cell| cell.unwrap_or_else(dash)).to_vec()
}

/// The largest defect, and of how many points.
fn defect(series: &Series) -> Vec<String> {
    let defects = series.points.iter().filter_map(|point| match *point {
        Point::Value { value, exact, .. } => Some(relative_defect(value, exact)),
        Point::Error { .. } | Point::Cost { .. } => None,
    });
    // A defect that is not a number must not hide behind smaller ones, as it would with `f64::max`.
    let largest = series.max_relative_defect.or_else(|| defects.max_by(f64::total_cmp));
    vec![
        largest.map_or("—".to_owned(), |defect| scientific(defect, 2)),
        series.points.len().to_string(),
    ]
}

fn quiet(text: &str) -> String {
    format!("<span class=\"quiet\">{text}</span>")
}

/// The name of an interval by its confidence.
pub fn interval_name(confidence: f64) -> String {
    format!("{}\u{202f}% interval", (1e4 * confidence).round() / 1e2)
}

/// How the orders were fitted.
fn methods(series: &[Series]) -> String {
    let items = series.iter().filter_map(|s| {
        let method = prose(&s.rate.as_ref()?.method);
        Some(format!("{}, {}: {method}", code(&s.scheme), prose(&s.quantity)))
    });
    details(false, "How the orders were fitted", &list("", items))
}

/// Step sizes, and errors with their intervals; a mark where an interval comes with a warning.
fn errors_of(series: &Series) -> impl Iterator<Item = (f64, String)> {
    series.points.iter().filter_map(|point| {
        let Point::Error { tau, value, se, lo, hi, warning } = point else { return None };
        let interval = match lo.zip(*hi) {
            Some((lo, hi)) => format!("[{}, {}]", scientific(lo, 2), scientific(hi, 2)),
            None => format!("± {}", scientific(QUANTILE * se, 1)),
        };
        let warning = warning.as_ref().map_or(String::new(), |warning| {
            format!(" <abbr title=\"{}\">(!)</abbr>", escape(warning))
        });
        Some((
            *tau,
            format!(
                "{} <span class=\"interval\">{interval}{warning}</span>",
                scientific(*value, 2)
            ),
        ))
    })
}

/// Errors of all series, one row per step.
fn errors(series: &[Series]) -> String {
    let mut steps: Vec<f64> = series.iter().flat_map(errors_of).map(|error| error.0).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    let names = series.iter().map(|s| format!("{}<br>{}", code(&s.scheme), prose(&s.quantity)));
    let heads: Vec<String> = std::iter::once("τ".to_owned()).chain(names).collect();
    let rows = steps.iter().map(|tau| {
        let error = |series: &Series| errors_of(series).find(|error| error.0 == *tau);
        let cells = series.iter().map(|s| error(s).map_or("—".to_owned(), |error| error.1));
        std::iter::once(step(*tau)).chain(cells).collect()
    });
    details(false, "Errors at every step, with 95\u{202f}% intervals", &table(&heads, rows))
}
