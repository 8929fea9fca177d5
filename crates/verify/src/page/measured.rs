//! What was measured on a panel, as tables: fitted orders, errors at every step, or largest
//! defects.

use plot::{
    escape,
    series::{QUANTILE, relative_defect},
};

use super::{
    markup::{code, details, list, quiet, table},
    number::{scientific, step},
    prose::prose,
};
use crate::results::{Kind, Panel, Point, Series};

type Rows = Vec<Vec<String>>;

/// The tables of a panel.
pub fn measured(panel: &Panel) -> String {
    let series = &panel.series;
    let (heads, rows): (&[&str], fn(&Series) -> Rows) = match panel.kind {
        Kind::Strong | Kind::Weak => (&["order", "interval", "error at the finest step"], order),
        Kind::Invariant => (&["largest relative defect", "points"], defect),
        Kind::Cost => (&["half-width", "path-steps"], costs),
    };
    let rows = series.iter().flat_map(|s| {
        let name = vec![code(&s.scheme), prose(&s.quantity)];
        rows(s).into_iter().map(move |row| [name.clone(), row].concat())
    });
    let numbers = table(["scheme", "quantity"].iter().chain(heads), rows);
    let tables = numbers + &methods(series) + &errors(series);
    if tables.is_empty() { "<p>Nothing.</p>".into() } else { tables }
}

/// Half-widths and the path-steps that they took.
fn costs(series: &Series) -> Rows {
    let costs = series.points.iter().filter_map(|point| match *point {
        Point::Cost { accuracy, path_steps } => {
            Some(vec![scientific(accuracy, 1), scientific(path_steps as f64, 2)])
        }
        _ => None,
    });
    costs.collect()
}

/// The fitted order, its interval, and the error at the finest step.
fn order(series: &Series) -> Rows {
    let rate = series.rate.as_ref();
    let order = rate.map(|rate| prose(&format!("{:.2}", rate.estimate)));
    let interval = rate.map(|rate| {
        let ends = prose(&format!("[{:.2}, {:.2}]", rate.lo, rate.hi));
        format!("{ends} {}", quiet(&interval_name(rate.confidence)))
    });
    let finest = errors_of(series).min_by(|a, b| a.0.total_cmp(&b.0));
    let finest = finest.map(|(tau, error)| error + " " + &quiet(&format!("at {}", step(tau))));
    vec![[order, interval, finest].map(or_dash).into()]
}

/// The largest defect, and of how many points.
fn defect(series: &Series) -> Rows {
    let defects = series.points.iter().filter_map(|point| match *point {
        Point::Value { value, exact, .. } => Some(relative_defect(value, exact)),
        _ => None,
    });
    // A defect that is not a number must not hide behind smaller ones, as it would with `f64::max`.
    let largest = series.max_relative_defect.or_else(|| defects.max_by(f64::total_cmp));
    let largest = or_dash(largest.map(|defect| scientific(defect, 2)));
    vec![vec![largest, series.points.len().to_string()]]
}

fn or_dash(cell: Option<String>) -> String {
    cell.unwrap_or("—".into())
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
        let value = scientific(*value, 2);
        Some((*tau, format!("{value} <span class=\"interval\">{interval}{warning}</span>")))
    })
}

/// Errors of all series, one row per step.
fn errors(series: &[Series]) -> String {
    let mut steps: Vec<f64> = series.iter().flat_map(errors_of).map(|error| error.0).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    let names = series.iter().map(|s| format!("{}<br>{}", code(&s.scheme), prose(&s.quantity)));
    let heads = std::iter::once("τ".into()).chain(names);
    let rows = steps.iter().map(|tau| {
        let cells = series.iter().map(|s| {
            let error = errors_of(s).find(|error| error.0 == *tau);
            or_dash(error.map(|error| error.1))
        });
        std::iter::once(step(*tau)).chain(cells).collect()
    });
    details(false, "Errors at every step, with 95\u{202f}% intervals", &table(heads, rows))
}
