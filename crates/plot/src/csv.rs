//! Comma-separated values (RFC 4180): a comparison of schemes, and fields of any table.
//!
//! Every number is written with the shortest digits that read back as the same `f64`; what is not
//! finite appears as `inf`, `-inf` or `NaN`.

use analysis::compare::Comparison;

/// The errors and times of a comparison of schemes as comma-separated values: one row per point,
/// with a header row.
///
/// | column | meaning |
/// |---|---|
/// | `quantity`, `scheme` | `y(T)`; identifier |
/// | `steps`, `tau` | steps of a path, step size |
/// | `error`, `se` | root-mean-square error; its standard error |
/// | `lo`, `hi` | ends of the interval of its size, the error of the reference included |
/// | `resolved` | whether the error is four times that of the reference |
/// | `min_s`, `median_s` | processor time of a path, empty where none was measured |
pub fn comparison_csv(comparison: &Comparison) -> String {
    let mut table = "quantity,scheme,steps,tau,error,se,lo,hi,resolved,min_s,median_s\n".to_owned();
    for candidate in &comparison.candidates {
        for point in &candidate.points {
            let times = point.time.map(|time| [time.best, time.median]);
            let [best, median] = times.map_or([const { String::new() }; 2], |times| {
                times.map(|time| format!("{time:e}"))
            });
            table += &format!(
                "y(T),{},{},{:e},{:e},{:e},{:e},{:e},{},{best},{median}\n",
                field(&candidate.scheme),
                point.steps,
                comparison.t_end / point.steps as f64,
                point.error,
                point.se,
                point.lo,
                point.hi,
                point.resolved,
            );
        }
    }
    table
}

/// Quotes a field when it holds a separator, a quote or a line break.
pub fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparison_has_a_row_for_every_point() {
        assert_eq!(
            comparison_csv(&crate::figure::tests::small_comparison()),
            "quantity,scheme,steps,tau,error,se,lo,hi,resolved,min_s,median_s\n\
             y(T),heun,8,1.25e-1,6.25e-2,1e-2,3.125e-2,1.25e-1,true,1e-6,2e-6\n\
             y(T),heun,16,6.25e-2,3.125e-2,1e-2,1.5625e-2,6.25e-2,false,,\n"
        );
    }

    #[test]
    fn separators_are_quoted() {
        assert_eq!(field("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
