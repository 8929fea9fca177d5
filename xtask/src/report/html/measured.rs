//! What was measured on a panel, as tables: fitted orders, errors at every step, or largest
//! defects.

use verify::results::{Kind, Panel, Point, Rate, Series};

use super::number::{fixed, quantity, scientific, step};
use super::prose::prose;
use crate::report::escape::escape;
use crate::report::figure::QUANTILE;
use crate::report::relative_defect;

/// The tables of a panel.
pub fn measured(panel: &Panel) -> String {
    if panel.series.is_empty() {
        return "<p>Nothing.</p>".to_owned();
    }
    match panel.kind {
        Kind::Strong | Kind::Weak => {
            format!("{}{}{}", orders(panel), methods(panel), errors(panel))
        }
        Kind::Invariant => defects(panel),
        Kind::Cost => costs(panel),
    }
}

fn orders(panel: &Panel) -> String {
    let rows: String = panel
        .series
        .iter()
        .map(|series| {
            let order = series.rate.as_ref().map_or("<td>—</td><td>—</td>".to_owned(), |rate| {
                format!("<td>{}</td><td>{}</td>", fixed(rate.estimate, 2), interval(rate))
            });
            let finest = errors_of(series)
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map_or("—".to_owned(), |(tau, text)| {
                    format!("{text} <span class=\"quiet\">at {}</span>", step(tau))
                });
            format!("<tr>{}{order}<td>{finest}</td></tr>", names(series))
        })
        .collect();
    format!(
        "<div class=\"wide\"><table class=\"numbers\"><thead><tr><th>scheme</th><th>quantity</th><th>order</th>\
         <th>interval</th><th>error at the finest step</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )
}

/// Path-steps for each accuracy.
fn costs(panel: &Panel) -> String {
    let rows: String = panel
        .series
        .iter()
        .flat_map(|series| series.points.iter().map(move |point| (series, point)))
        .filter_map(|(series, point)| match point {
            Point::Cost { accuracy, path_steps } => Some(format!(
                "<tr>{}<td>{}</td><td>{}</td></tr>",
                names(series),
                scientific(*accuracy, 1),
                scientific(*path_steps as f64, 2)
            )),
            _ => None,
        })
        .collect();
    format!(
        "<div class=\"wide\"><table class=\"numbers\"><thead><tr><th>method</th><th>quantity</th><th>half-width</th>\
         <th>path-steps</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )
}

fn names(series: &Series) -> String {
    format!(
        "<th><code>{}</code></th><td>{}</td>",
        escape(&series.scheme),
        quantity(&series.quantity)
    )
}

fn interval(rate: &Rate) -> String {
    format!(
        "[{}, {}] <span class=\"quiet\">{}\u{202f}%</span>",
        fixed(rate.lo, 2),
        fixed(rate.hi, 2),
        (1e4 * rate.confidence).round() / 1e2
    )
}

/// An error with its interval, and a mark where the interval comes with a warning.
fn with_interval(value: f64, se: f64, ends: Option<(f64, f64)>, warning: Option<&str>) -> String {
    let interval = match ends {
        Some((lo, hi)) => {
            format!("{} [{}, {}]", scientific(value, 2), scientific(lo, 2), scientific(hi, 2))
        }
        None => format!("{} ± {}", scientific(value, 2), scientific(QUANTILE * se, 1)),
    };
    match warning {
        Some(warning) => format!("{interval} <abbr title=\"{}\">(!)</abbr>", escape(warning)),
        None => interval,
    }
}

/// How the orders were fitted: said once if it is the same for all.
fn methods(panel: &Panel) -> String {
    let fitted: Vec<(&Series, &str)> = panel
        .series
        .iter()
        .filter_map(|s| s.rate.as_ref().map(|r| (s, r.method.as_str())))
        .filter(|(_, method)| !method.is_empty())
        .collect();
    let Some((_, first)) = fitted.first() else {
        return String::new();
    };
    if fitted.iter().all(|(_, method)| method == first) {
        return format!("<p class=\"quiet\">Orders: {}.</p>", prose(first.trim_end_matches('.')));
    }
    let items: String = fitted
        .iter()
        .map(|(series, method)| {
            let (scheme, of) = (escape(&series.scheme), quantity(&series.quantity));
            format!("<li><code>{scheme}</code>, {of}: {}</li>", prose(method))
        })
        .collect();
    format!("<details><summary>How the orders were fitted</summary><ul>{items}</ul></details>")
}

/// Step sizes and errors with their intervals.
fn errors_of(series: &Series) -> impl Iterator<Item = (f64, String)> {
    series.points.iter().filter_map(|p| match p {
        Point::Error { tau, value, se, lo, hi, warning } => {
            Some((*tau, with_interval(*value, *se, lo.zip(*hi), warning.as_deref())))
        }
        Point::Value { .. } | Point::Cost { .. } => None,
    })
}

/// Errors of all series, one row per step.
fn errors(panel: &Panel) -> String {
    let mut steps: Vec<f64> = panel.series.iter().flat_map(errors_of).map(|e| e.0).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    steps.dedup();
    if steps.is_empty() {
        return String::new();
    }
    let heads: String = panel
        .series
        .iter()
        .map(|s| {
            format!("<th><code>{}</code><br>{}</th>", escape(&s.scheme), quantity(&s.quantity))
        })
        .collect();
    let rows: String = steps
        .iter()
        .map(|tau| {
            let cells: String = panel
                .series
                .iter()
                .map(|series| {
                    errors_of(series)
                        .find(|e| e.0 == *tau)
                        .map_or("<td>—</td>".to_owned(), |e| format!("<td>{}</td>", e.1))
                })
                .collect();
            format!("<tr><th>{}</th>{cells}</tr>", step(*tau))
        })
        .collect();
    format!(
        "<details><summary>Errors at every step, with 95\u{202f}% intervals</summary><div class=\"wide\">\
         <table class=\"numbers\"><thead><tr><th>τ</th>{heads}</tr></thead><tbody>{rows}</tbody></table></div></details>"
    )
}

fn defects(panel: &Panel) -> String {
    let rows: String = panel
        .series
        .iter()
        .map(|series| {
            let largest = series.max_relative_defect.or_else(|| largest_defect(series));
            let largest = largest.map_or("—".to_owned(), |d| scientific(d, 2));
            let steps = series.points.len();
            format!("<tr>{}<td>{largest}</td><td>{steps}</td></tr>", names(series))
        })
        .collect();
    format!(
        "<div class=\"wide\"><table class=\"numbers\"><thead><tr><th>scheme</th><th>quantity</th>\
         <th>largest relative defect</th><th>points</th></tr></thead><tbody>{rows}</tbody></table></div>"
    )
}

fn largest_defect(series: &Series) -> Option<f64> {
    let defects = series.points.iter().filter_map(|p| match *p {
        Point::Value { value, exact, .. } => Some(relative_defect(value, exact)),
        Point::Error { .. } | Point::Cost { .. } => None,
    });
    // A defect that is not a number must not hide behind smaller ones, as it would with `f64::max`.
    defects.max_by(f64::total_cmp)
}
