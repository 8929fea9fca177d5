//! The numbers behind a figure as comma-separated values (RFC 4180).
//!
//! Every number is written with the shortest digits that read back as the same `f64`; what is not
//! finite appears as `inf`, `-inf` or `NaN`.

use analysis::{
    compare::{Comparison, Time},
    results::{Kind, Panel, Point},
};

use crate::panel::relative_defect;

/// The numbers of a panel as comma-separated values (RFC 4180): one row per point, with a header
/// row.
///
/// | column | meaning |
/// |---|---|
/// | `scheme`, `quantity` | as in [`Series`](analysis::results::Series) |
/// | `tau`, `value` | step size; root-mean-square error (strong) or signed weak error (weak) |
/// | `se`, `lo`, `hi` | standard error, ends of the interval, empty where it is value ± 1.96 se |
/// | `t`, `value`, `exact` | time, value along the path, value by the conformal law |
/// | `relative_defect` | \|value − exact\| / \|exact\| |
/// | `accuracy`, `path_steps` | half-width asked for, path-steps taken |
pub fn csv(panel: &Panel) -> String {
    let columns = match panel.kind {
        Kind::Strong | Kind::Weak => "tau,value,se,lo,hi",
        Kind::Invariant => "t,value,exact,relative_defect",
        Kind::Cost => "accuracy,path_steps",
    };
    let row = |point: &Point| match (panel.kind, point) {
        (Kind::Strong | Kind::Weak, Point::Error { tau, value, se, lo, hi, .. }) => {
            let [lo, hi] = [lo, hi].map(|end| end.map_or(String::new(), |end| format!("{end:e}")));
            Some(format!("{tau:e},{value:e},{se:e},{lo},{hi}"))
        }
        (Kind::Invariant, Point::Value { t, value, exact }) => {
            Some(format!("{t:e},{value:e},{exact:e},{:e}", relative_defect(*value, *exact)))
        }
        (Kind::Cost, Point::Cost { accuracy, path_steps }) => {
            Some(format!("{accuracy:e},{path_steps}"))
        }
        // A point of another kind has no row in this table.
        _ => None,
    };
    let mut table = format!("scheme,quantity,{columns}\n");
    for series in &panel.series {
        let name = format!("{},{}", field(&series.scheme), field(&series.quantity));
        table.extend(series.points.iter().filter_map(row).map(|row| format!("{name},{row}\n")));
    }
    table
}

/// The errors and times of a comparison of schemes as comma-separated values: one row per point,
/// with a header row.
///
/// | column | meaning |
/// |---|---|
/// | `quantity`, `scheme` | `y(T)`, or `E[φ]`; identifier |
/// | `steps`, `tau` | steps of a path, step size |
/// | `error`, `se` | root-mean-square error, or signed bias; its standard error |
/// | `lo`, `hi` | ends of the interval of its size, the error of the reference included |
/// | `resolved` | whether a strong error is four times that of the reference |
/// | `min_s`, `median_s` | processor time of a path, empty where none was measured |
pub fn comparison_csv(comparison: &Comparison) -> String {
    let mut table = "quantity,scheme,steps,tau,error,se,lo,hi,resolved,min_s,median_s\n".to_owned();
    let end = |end: Option<f64>| end.map_or(String::new(), |end| format!("{end:e}"));
    let time = |time: Option<Time>| {
        let [min, median] = [time.map(|time| time.min_s), time.map(|time| time.median_s)].map(end);
        format!("{min},{median}")
    };
    for series in &comparison.strong.series {
        for point in &series.points {
            let (lo, hi) = (end(point.lo), end(point.hi));
            table += &format!(
                "y(T),{},{},{:e},{:e},{:e},{lo},{hi},{},{}\n",
                field(&series.scheme),
                point.steps,
                point.tau,
                point.error,
                point.se,
                point.resolved,
                time(point.time)
            );
        }
    }
    for observable in comparison.weak.iter().flat_map(|weak| &weak.observables) {
        for series in &observable.series {
            for point in &series.points {
                table += &format!(
                    "{},{},{},{:e},{:e},{:e},{:e},{:e},,{}\n",
                    field(&format!("E[{}]", observable.name)),
                    field(&series.scheme),
                    point.steps,
                    point.tau,
                    point.bias,
                    point.se,
                    point.lo,
                    point.hi,
                    time(point.time)
                );
            }
        }
    }
    table
}

/// Quotes a field when it holds a separator, a quote or a line break.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use analysis::results::Series;

    use super::*;

    fn panel(kind: Kind, quantity: &str, points: Vec<Point>) -> Panel {
        let series = Series {
            scheme: "sexp".into(),
            quantity: quantity.into(),
            points,
            rate: None,
            max_relative_defect: None,
        };
        Panel {
            id: "test".into(),
            kind,
            title: String::new(),
            setup: String::new(),
            paper: String::new(),
            samples: 1,
            reference: String::new(),
            failures: Vec::new(),
            clipped: Vec::new(),
            differences: Vec::new(),
            series: vec![series],
        }
    }

    #[test]
    fn errors_read_back_bit_for_bit() {
        let (tau, value, se) = (2f64.powi(-14), 0.1 + 0.2, 1.0 / 3.0 * 1e-300);
        let table = csv(&panel(Kind::Strong, "y(T)", vec![Point::normal(tau, value, se)]));
        let mut lines = table.lines();
        assert_eq!(lines.next(), Some("scheme,quantity,tau,value,se,lo,hi"));
        let fields: Vec<&str> = lines.next().unwrap_or("").split(',').collect();
        assert_eq!(fields[..2], ["sexp", "y(T)"]);
        let numbers: Vec<f64> = fields[2..].iter().filter_map(|f| f.parse().ok()).collect();
        assert_eq!(numbers, [tau, value, se]);
        let point = Point::Error { tau, value, se, lo: Some(0.25), hi: Some(0.5), warning: None };
        assert!(csv(&panel(Kind::Strong, "y(T)", vec![point])).ends_with(",2.5e-1,5e-1\n"));
    }

    #[test]
    fn invariants_carry_their_relative_defect() {
        let point = Point::Value { t: 0.5, value: 3.0, exact: -2.0 };
        let table = csv(&panel(Kind::Invariant, "C", vec![point]));
        assert_eq!(
            table,
            "scheme,quantity,t,value,exact,relative_defect\nsexp,C,5e-1,3e0,-2e0,2.5e0\n"
        );
    }

    #[test]
    fn a_comparison_has_a_row_for_every_point() {
        assert_eq!(
            comparison_csv(&crate::figure::small_comparison()),
            "quantity,scheme,steps,tau,error,se,lo,hi,resolved,min_s,median_s\n\
             y(T),heun,8,1.25e-1,6.25e-2,1e-2,3.125e-2,1.25e-1,true,1e-6,2e-6\n\
             y(T),heun,16,6.25e-2,3.125e-2,1e-2,1.5625e-2,6.25e-2,false,,\n\
             E[y1],heun,8,1.25e-1,-2.5e-1,1e-2,1.25e-1,5e-1,,,\n"
        );
    }

    #[test]
    fn separators_are_quoted_and_no_points_leave_the_header() {
        assert_eq!(field("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(csv(&panel(Kind::Weak, "y1", vec![])), "scheme,quantity,tau,value,se,lo,hi\n");
    }
}
