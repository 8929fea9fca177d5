//! Writers of results.

use std::io::{self, Write};

use super::{
    Series, StudyResult,
    summary::{CROWDED, Place, Quantile, Summary},
};
use crate::simulation::quoted;

impl StudyResult {
    /// Writes one row for each time, observable and quantity, as CSV with the columns `t`,
    /// `observable`, `quantity`, `value`, `lo`, `hi` and `note`. `lo` and `hi` are the ends of the
    /// 95 % interval. What is not known is empty. Numbers are written in the shortest form that is
    /// read back to the same bits.
    ///
    /// | quantity | value |
    /// |---|---|
    /// | `count`, `not finite` | number of values, and of those that are not finite and left out |
    /// | `mean` | mean with interval; a note says why there is none |
    /// | `variance`, `deviation` | variance, standard deviation |
    /// | `least`, `largest` | smallest and largest value |
    /// | `q0.05` … | quantile with interval; a note says why there is no value |
    /// | `below grid`, `above grid` | number of values outside of the bins |
    ///
    /// Histograms and the record are among the fields, which serialize.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{COLUMNS}")?;
        write_rows(&self.series, "", out)
    }
}

/// The columns of [`write_rows`].
pub const COLUMNS: &str = "t,observable,quantity,value,lo,hi,note";

/// Writes the rows of [`StudyResult::write_csv`], each after the text `before`.
///
/// # Errors
/// Those of the writer.
pub fn write_rows(series: &[Series], before: &str, out: &mut impl Write) -> io::Result<()> {
    for Series { observable, points } in series {
        let name = quoted(observable);
        for point @ Summary { time, .. } in points {
            for (quantity, [value, lo, hi], note) in rows(point) {
                writeln!(out, "{before}{time:?},{name},{quantity},{value},{lo},{hi},{note}")?;
            }
        }
    }
    Ok(())
}

type Row<'a> = (String, [String; 3], &'a str);

fn rows(point: &Summary) -> Vec<Row<'_>> {
    let text = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:?}"));
    let row = |name: &str, value: Option<f64>, interval: Option<(f64, f64)>| {
        let (lo, hi) = interval.unzip();
        (name.to_owned(), [value, lo, hi].map(text), "")
    };
    let count = |name: &str, count: u64| {
        (name.to_owned(), [count.to_string(), String::new(), String::new()], "")
    };
    let mut rows = vec![
        count("count", point.count),
        count("not finite", point.not_finite),
        row("mean", point.mean, point.mean_interval),
        row("variance", point.variance, None),
        row("deviation", point.deviation, None),
        row("least", point.least, None),
        row("largest", point.largest, None),
    ];
    rows[2].2 = point.interval_note.as_deref().unwrap_or_default();
    rows.extend(point.quantiles.iter().map(|&Quantile { level, value, lo, hi, place }| {
        let note = match place {
            Place::Inside | Place::NoValues => "",
            Place::BelowGrid => "below the grid",
            Place::AboveGrid => "above the grid",
            Place::Crowded => CROWDED,
        };
        (format!("q{level}"), [value, lo, hi].map(text), note)
    }));
    if let Some(histogram) = &point.histogram {
        rows.push(count("below grid", histogram.below));
        rows.push(count("above grid", histogram.above));
    }
    rows
}
