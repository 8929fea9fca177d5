//! Writers of tables.

use std::io::{self, Write};

use super::TimeSeries;

/// Writes the tables of all paths as one CSV table with the columns `scheme`, `path` and those of
/// the tables. `path` is the number of the path. Numbers are written in the shortest
/// form that is read back to the same bits.
///
/// # Errors
/// Those of the writer. [`io::ErrorKind::InvalidInput`] if the columns of the paths differ.
pub fn write_csv(series: &[TimeSeries], out: &mut impl Write) -> io::Result<()> {
    let Some(first) = series.first() else { return Ok(()) };
    let names = |series: &TimeSeries| {
        let names = series.columns.iter().map(|column| quoted(&column.name));
        names.collect::<Vec<_>>().join(",")
    };
    let header = names(first);
    writeln!(out, "scheme,path,{header}")?;
    for one in series {
        let found = names(one);
        if found != header {
            let message = format!("all paths must have the columns {header}, got {found}");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let path = one.noise.path;
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

/// The entry in quotes if it contains a comma, a quote or a line break (RFC 4180).
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}
