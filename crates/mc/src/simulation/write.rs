//! Paths into files. Numbers are the shortest texts that read back to the same bits.

use std::io::{self, Write};

use super::{NoiseOrigin, TimeSeries};

/// All paths below one another: `scheme`, `path`, and the columns that they have in common. The
/// path is its number, and `recorded` where the increments were given.
///
/// # Errors
/// Those of the writer; [`io::ErrorKind::InvalidInput`] when the paths do not have the same
/// columns.
pub fn write_csv(series: &[TimeSeries], out: &mut impl Write) -> io::Result<()> {
    let Some(first) = series.first() else { return Ok(()) };
    let names = |series: &TimeSeries| {
        series.columns.iter().map(|column| quoted(&column.name)).collect::<Vec<_>>()
    };
    let header = names(first);
    writeln!(out, "scheme,path,{}", header.join(","))?;
    for one in series {
        let found = names(one);
        if found != header {
            let message = format!(
                "all paths must have the columns {}, got {}",
                header.join(","),
                found.join(",")
            );
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let path = match one.noise {
            NoiseOrigin::Drawn { path, .. } => path.to_string(),
            NoiseOrigin::Recorded => "recorded".to_owned(),
        };
        for row in 0..one.times().len() {
            write!(out, "{},{path}", quoted(&one.scheme))?;
            for column in &one.columns {
                write!(out, ",{:?}", column.values[row])?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// All paths as an array of objects with the fields of [`TimeSeries`], and in them one array of
/// numbers for each column.
///
/// # Errors
/// Those of the writer.
pub fn write_json(series: &[TimeSeries], out: &mut impl Write) -> io::Result<()> {
    serde_json::to_writer(&mut *out, series)?;
    writeln!(out)
}

/// An entry with a comma, a quote or a line break goes between quotes, its own quotes doubled (RFC
/// 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
