//! The numbers behind a figure of a panel.

use plot::{Kind, csv::field, series::relative_defect};
use stats::Point;

use crate::results::Panel;

/// The numbers of a panel as comma-separated values (RFC 4180): one row per point, with a header
/// row.
///
/// | column | meaning |
/// |---|---|
/// | `scheme`, `quantity` | as in [`Series`](plot::Series) |
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

#[cfg(test)]
mod tests {
    use plot::Series;

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
    fn no_points_leave_the_header() {
        assert_eq!(csv(&panel(Kind::Weak, "y1", vec![])), "scheme,quantity,tau,value,se,lo,hi\n");
    }
}
