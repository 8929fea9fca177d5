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
